//! Runs a block kernel on the widest instruction set of the machine, chosen at run time.
//!
//! The one place where instruction sets are named. A kernel is written as plain scalar loops over
//! paths; the compiler vectorises it once for each level below. Rust never contracts a·b + c, the
//! kernels call no libm and reduce nothing across paths in floating point, so every level gives the
//! same bits.

use std::sync::atomic::{AtomicU8, Ordering};

use multiversion::multiversion;
use multiversion::target::match_target;

/// A piece of work on blocks of paths.
///
/// `run` and everything it calls on each path must be `#[inline(always)]`: only what is inlined
/// into the dispatched function is compiled for the vector instructions. Closures are not reliably
/// inlined there; use functions.
pub trait Kernel {
    /// What the work returns.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

/// Instruction sets that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// What every machine of the target has (SSE2 on x86-64, NEON on AArch64).
    Baseline = 0,
    /// 256-bit vectors.
    Avx2 = 1,
    /// 512-bit vectors.
    Avx512 = 2,
}

impl Level {
    /// The widest level that this machine has and that [`limit_to`] allows.
    #[must_use]
    pub fn current() -> Self {
        Self::available().min(Self::limit())
    }

    /// The widest level that this machine has.
    #[must_use]
    pub fn available() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
            {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Baseline
    }

    fn limit() -> Self {
        match LIMIT.load(Ordering::Relaxed) {
            0 => Self::Baseline,
            1 => Self::Avx2,
            _ => Self::Avx512,
        }
    }

    /// The name used in reports: `avx512`, `avx2` or `baseline`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

static LIMIT: AtomicU8 = AtomicU8::new(Level::Avx512 as u8);

/// Allows no level above `level` from now on, in the whole process; results do not change, only
/// speed.
pub fn limit_to(level: Level) {
    LIMIT.store(level as u8, Ordering::Relaxed);
}

/// Runs `kernel` compiled for [`Level::current`].
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    match Level::limit() {
        Level::Avx512 => up_to_avx512(kernel),
        Level::Avx2 => up_to_avx2(kernel),
        Level::Baseline => baseline(kernel),
    }
}

// Every function below has the kernel once, for its own level, and hands a machine that has less to
// the next one: compiling the kernels is most of what compiling the workspace costs.

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw"))]
fn up_to_avx512<K: Kernel>(kernel: K) -> K::Output {
    match_target! {
        "x86_64+avx512f+avx512vl+avx512dq+avx512bw" => kernel.run(),
        _ => up_to_avx2(kernel),
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn up_to_avx2<K: Kernel>(kernel: K) -> K::Output {
    match_target! {
        "x86_64+avx2" => kernel.run(),
        _ => baseline(kernel),
    }
}

#[inline(never)]
fn baseline<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}
