//! The traits of schemes that are one formula on one path.

use nonlin::Solver;

use crate::Increment;

/// An explicit one-step scheme: y_{n+1} as a formula in y_n.
///
/// Every type with this trait is a [`Scheme`](crate::Scheme) for every system, with a vectorised
/// kernel. Increments and areas are truncated unless [`CLIPS_INCREMENTS`](Self::CLIPS_INCREMENTS)
/// is false.
///
/// ```
/// use noise::Noise;
/// use schemes::{Explicit, Increment, Scheme, Step};
/// use systems::{Constant, Pendulum};
///
/// /// Heun's method with exact damping: ẑ = e^{−∫γ}y_n, z = ẑ + ½(f(ẑ) + f(ẑ + f(ẑ))).
/// struct ExponentialHeun;
/// impl Explicit for ExponentialHeun {
///     const ID: &'static str = "exponential-heun";
///     #[inline(always)]
///     fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
///         let start = y * h.step().first_decay;
///         let first = h.field(start);
///         let z = start + (first + h.field(start + first)) * 0.5;
///         z * h.step().second_decay
///     }
/// }
/// let step = Step::new(&Constant::new(0.2)?, 0, 0.01)?;
/// let pendulum = Pendulum::new(1.0)?;
/// let next = ExponentialHeun.step(&pendulum, &step, &Noise::increments([0.05]), [0.2, 1.0]);
/// assert!(next.outcome.converged());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Explicit: Send + Sync {
    /// Identifier in results.
    const ID: &'static str;

    /// Whether the formula uses Lévy areas ([`Increment::commutators`]). If so, the driver draws
    /// them, which costs far more than drawing increments.
    const READS_AREAS: bool = false;

    /// Whether the driver truncates increments and areas.
    const CLIPS_INCREMENTS: bool = true;

    /// y_{n+1} from `y` = y_n. Mark it `#[inline(always)]` and avoid closures: only inlined code is
    /// vectorised.
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector;
}

/// An implicit one-step scheme: the equation z = ψ(ẑ, z).
///
/// Without exact damping, ẑ = y_n and y_{n+1} = z. With exact damping, ẑ = e^{−∫γ, first half} y_n
/// and y_{n+1} = e^{−∫γ, second half} z (Strang splitting).
///
/// Every type with this trait is a [`Scheme`](crate::Scheme) for every system, with a vectorised
/// kernel that solves the equation to round-off on 32 paths at a time ([`Solver`]).
///
/// ```
/// use noise::Noise;
/// use schemes::{Implicit, Increment, Scheme, Step};
/// use systems::{Constant, PoissonSystem, RigidBody};
///
/// /// The midpoint rule with exact damping: ψ(ẑ, z) = ẑ + B(z̄)∇h(z̄), z̄ = (ẑ+z)/2.
/// struct ConformalMidpoint;
/// impl Implicit for ConformalMidpoint {
///     const ID: &'static str = "conformal-midpoint";
///     const EXACT_DAMPING: bool = true;
///     #[inline(always)]
///     fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
///         start + h.field((start + z) * 0.5)
///     }
/// }
/// let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
/// let step = Step::new(&Constant::new(0.2)?, 0, 0.01)?;
/// let y0 = [0.6, 0.0, 0.8];
/// let y1 = ConformalMidpoint.step(&body, &step, &Noise::increments([0.1, -0.2, 0.1]), y0).z;
/// let ratio = body.invariant(0, y1) / body.invariant(0, y0);
/// assert!((ratio / (-2.0 * step.damping_integral()).exp() - 1.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an implicit formula",
    note = "a scheme is `Explicit`, `Implicit` or, for a system with `Flows`, a `Composition`"
)]
pub trait Implicit: Send + Sync {
    /// Identifier in results.
    const ID: &'static str;

    /// Whether the formula uses Lévy areas ([`Increment::commutators`]). If so, the driver draws
    /// them, which costs far more than drawing increments.
    const READS_AREAS: bool = false;

    /// Whether the driver truncates increments and areas. Otherwise a step may have no solution.
    const CLIPS_INCREMENTS: bool = true;

    /// Whether the damping is exact, in two halves before and after the equation.
    const EXACT_DAMPING: bool = false;

    /// Whether ψ(ẑ, z) = ẑ + averaged_field(ẑ, z), so that
    /// [`PoissonSystem::predict`](systems::PoissonSystem::predict) applies.
    const PREDICTED: bool = false;

    /// Whether ψ does not depend on z, so that nothing is solved. True for [`Explicit`] schemes.
    const EXPLICIT: bool = false;

    /// ψ(ẑ, z) with ẑ = `start`. It must contract in z for small steps. Mark it
    /// `#[inline(always)]` and avoid closures: only inlined code is vectorised.
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector;

    /// The options for solving the equation, if they are not the default ones, which the kernel is
    /// compiled for alone.
    const SOLVER: Option<fn(&Self) -> Solver> = None;
}

impl<F: Explicit> Implicit for F {
    const ID: &'static str = F::ID;
    const READS_AREAS: bool = F::READS_AREAS;
    const CLIPS_INCREMENTS: bool = F::CLIPS_INCREMENTS;
    const EXPLICIT: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, _z: H::Vector) -> H::Vector {
        self.advance(h, start)
    }
}
