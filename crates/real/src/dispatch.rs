//! Run-time dispatch of block kernels; the only file that names instruction sets.

use std::sync::atomic::{AtomicU8, Ordering};

use multiversion::{multiversion, target::match_target};

/// A computation on blocks of paths, compiled for every [`Level`].
///
/// A kernel is written as plain scalar loops over paths, which the compiler vectorises for each
/// level. Every level gives the same bits, because Rust never contracts a·b + c to a fused
/// operation and because kernels call no libm and sum nothing across paths in floating point.
///
/// Mark `run` and everything it calls on each path `#[inline(always)]`: only inlined code is
/// compiled for the vector instructions. Use functions, since closures are not reliably inlined.
pub trait Kernel {
    /// The result.
    type Output;
    /// Computes the result.
    fn run(self) -> Self::Output;
}

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// The minimum of the target: SSE2 on x86-64, NEON on AArch64.
    Baseline = 0,
    /// 256-bit vectors.
    Avx2 = 1,
    /// 512-bit vectors.
    Avx512 = 2,
}

impl Level {
    /// The widest level that this machine supports and [`limit_to`] allows.
    pub fn current() -> Self {
        Self::available().min(Self::limit())
    }

    /// The widest level that kernels are compiled for. Builds with debug assertions, as for `cargo
    /// test`, have no [`Avx512`](Self::Avx512): it would take a third of their time.
    pub const WIDEST: Self = if cfg!(debug_assertions) { Self::Avx2 } else { Self::Avx512 };

    /// The widest level that this machine supports, up to [`WIDEST`](Self::WIDEST).
    pub fn available() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if Self::WIDEST == Self::Avx512
                && is_x86_feature_detected!("avx512f")
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
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

static LIMIT: AtomicU8 = AtomicU8::new(Level::Avx512 as u8);

/// Limits the whole process to `level` from now on. This changes speed, not results. If the machine
/// does not support `level`, the widest level that it supports is used ([`Level::current`]).
pub fn limit_to(level: Level) {
    LIMIT.store(level as u8, Ordering::Relaxed);
}

/// Runs the version of `kernel` compiled for [`Level::current`].
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    match Level::limit() {
        Level::Baseline => baseline(kernel),
        #[cfg(not(debug_assertions))]
        Level::Avx512 => up_to_avx512(kernel),
        _ => up_to_avx2(kernel),
    }
}

// Each function below contains the kernel once, for its own level, and calls the next function on a
// machine without that level. Compiling kernels is most of the cost of compiling the workspace.

#[cfg(not(debug_assertions))]
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
