//! Run-time dispatch of block kernels; the only file that names instruction sets.

use std::sync::atomic::{AtomicU8, Ordering};

#[cfg(any(avx2_alone, not(debug_assertions)))]
use multiversion::{multiversion, target::match_target};

/// A computation on blocks of paths, compiled for every [`Simd`].
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

/// A function that runs as a [`Kernel`], whose references live for `'a`.
///
/// ```
/// real::kernel! {
///     /// Adds weight·value.
///     pub fn add(sum: &'a mut [real::Row], value: &'a [real::Row], weight: f64) {
///         for (sum, value) in sum.as_flattened_mut().iter_mut().zip(value.as_flattened()) {
///             *sum += value * weight;
///         }
///     }
/// }
/// let mut sum = [[1.0; 32]];
/// add(&mut sum, &[[2.0; 32]], 0.5);
/// assert_eq!(sum, [[2.0; 32]]);
/// ```
#[macro_export]
macro_rules! kernel {
    ($(#[$about:meta])* $visible:vis fn $name:ident($($field:ident: $type:ty),*)
        $(-> $output:ty)? $body:block) => {
        $(#[$about])*
        #[inline]
        $visible fn $name<'a>($($field: $type),*) $(-> $output)? {
            struct Fields<'a> {
                $($field: $type),*
            }
            impl<'a> $crate::Kernel for Fields<'a> {
                type Output = ($($output)?);
                #[inline(always)]
                fn run(self) -> Self::Output {
                    let Self { $($field),* } = self;
                    $body
                }
            }
            $crate::dispatch(Fields { $($field),* })
        }
    };
}

/// An instruction set that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Simd {
    /// The minimum of the target: SSE2 on x86-64, NEON on AArch64.
    Baseline = 0,
    /// 256-bit vectors.
    Avx2 = 1,
    /// 512-bit vectors.
    Avx512 = 2,
}

impl Simd {
    const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// The levels that kernels are compiled for, the narrowest first.
    ///
    /// Debug builds, as for `cargo test`, have one alone: that of the machine which builds them, up
    /// to AVX2. Compiling the others would take most of their time.
    pub const BUILT: &[Self] = if cfg!(avx2_alone) {
        &[Self::Avx2]
    } else if cfg!(debug_assertions) {
        &[Self::Baseline]
    } else {
        &Self::ALL
    };

    /// The widest level that this machine supports and [`limit_to`] allows.
    pub fn current() -> Self {
        Self::available().min(Self::limit()).max(Self::BUILT[0])
    }

    /// The widest level that this machine supports and kernels are compiled for.
    pub fn available() -> Self {
        let built = |level| Self::BUILT.contains(&level);
        #[cfg(target_arch = "x86_64")]
        {
            if built(Self::Avx512)
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
            {
                return Self::Avx512;
            }
            if built(Self::Avx2) && is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::BUILT[0]
    }

    fn limit() -> Self {
        Self::ALL[usize::from(LIMIT.load(Ordering::Relaxed))]
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

static LIMIT: AtomicU8 = AtomicU8::new(Simd::Avx512 as u8);

/// Limits the whole process to `level` from now on. This changes speed, not results. If the machine
/// does not support `level`, the widest level that it supports is used ([`Simd::current`]).
pub fn limit_to(level: Simd) {
    LIMIT.store(level as u8, Ordering::Relaxed);
}

/// Runs the version of `kernel` compiled for [`Simd::current`].
///
/// # Panics
/// In a debug build that was built on a machine with AVX2 and runs on one without.
#[inline]
pub fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(avx2_alone)]
    return avx2_alone(kernel);
    #[cfg(all(debug_assertions, not(avx2_alone)))]
    return baseline(kernel);
    #[cfg(not(debug_assertions))]
    match Simd::limit() {
        Simd::Baseline => baseline(kernel),
        Simd::Avx2 => up_to_avx2(kernel),
        Simd::Avx512 => up_to_avx512(kernel),
    }
}

#[cfg(avx2_alone)]
#[multiversion(targets("x86_64+avx2"))]
fn avx2_alone<K: Kernel>(kernel: K) -> K::Output {
    match_target! {
        "x86_64+avx2" => kernel.run(),
        _ => {
            drop(kernel);
            panic!("this debug build has kernels for AVX2 alone: build it on this machine")
        }
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

#[cfg(not(debug_assertions))]
#[multiversion(targets("x86_64+avx2"))]
fn up_to_avx2<K: Kernel>(kernel: K) -> K::Output {
    match_target! {
        "x86_64+avx2" => kernel.run(),
        _ => baseline(kernel),
    }
}

#[cfg(not(avx2_alone))]
#[inline(never)]
fn baseline<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}
