//! The systems that are measured, and the schemes that make sense on each.

use lab::Compiled;
use schemes::{Midpoint, Scheme, Sexp, SexpLevy};
use systems::{
    Constant, Cosine, Damping, IntegerExponents, Linear, LotkaVolterra, MaxwellBloch, Pendulum,
    Poisson3, RigidBody, RigidBodyEnergy, Sine, SpinChain, SystemError,
};

/// Something to do with every system.
pub trait Visit {
    /// Why it could not be done.
    type Error: From<SystemError>;

    /// Does it with one system, its damping and its start, which are the paper's where the system
    /// is.
    ///
    /// # Errors
    /// Whatever the visitor's own.
    fn visit<S: Compiled<D, M>, G: Damping, const D: usize, const M: usize>(
        &mut self,
        name: &str,
        system: S,
        damping: G,
        y0: [f64; D],
    ) -> Result<(), Self::Error>;
}

/// Moments of inertia of the body and of its noises.
const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];
const NOISE_INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

/// (cos 1.1, 0, sin 1.1).
pub(crate) fn momentum() -> [f64; 3] {
    [real::elementary::cos(1.1), 0.0, real::elementary::sin(1.1)]
}

/// The rigid body with three noises and its damping ½ cos 2t, on which everything but the schemes
/// is measured.
///
/// # Errors
/// None: the numbers are valid.
pub(crate) fn rigid_body() -> Result<(RigidBody<3>, Cosine), SystemError> {
    Ok((RigidBody::three_noises(INERTIA, NOISE_INERTIA)?, Cosine::new(0.5, 2.0)?))
}

/// Visits every system: those of the paper, and two spins in a fluctuating field.
///
/// # Errors
/// The first of the visitor's.
pub fn visit_systems<V: Visit>(visitor: &mut V) -> Result<(), V::Error> {
    let (sine, cosine) = (Sine::new(1.0, 1.0)?, Cosine::new(0.5, 2.0)?);
    let populations = [0.2, 0.4, 0.6];
    visitor.visit("pendulum", Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0])?;
    let (body, _) = rigid_body()?;
    visitor.visit("rigid body, three noises", body, cosine, momentum())?;
    visitor.visit(
        "rigid body, one noise",
        RigidBody::one_noise(INERTIA, NOISE_INERTIA[0])?,
        cosine,
        momentum(),
    )?;
    visitor.visit(
        "rigid body, noise H₀",
        RigidBodyEnergy::new(INERTIA, 1.0)?,
        cosine,
        momentum(),
    )?;
    let polynomial = LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0)?;
    visitor.visit("lotka-volterra 1, 1", polynomial, sine, populations)?;
    let polynomial = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)?;
    visitor.visit("lotka-volterra 2, 2", polynomial, sine, populations)?;
    visitor.visit("maxwell-bloch", MaxwellBloch, cosine, [1.0, 2.0, 3.0])?;
    visitor.visit("poisson3", Poisson3::new(1.0)?, Linear::new(1.0)?, [1.0, 2.0, 3.0])?;
    let spins: SpinChain<6> = SpinChain::new(1.0, 0.5, 0.8)?;
    visitor.visit(
        "spin chain, two spins",
        spins,
        Constant::new(0.1)?,
        [1.0, 0.0, 0.0, 0.0, 0.6, 0.8],
    )
}

/// The schemes for a system; `sexp-levy` only where it differs from `sexp`.
#[must_use]
pub fn schemes_for<S: Compiled<D, M>, const D: usize, const M: usize>(
    system: &S,
    y0: [f64; D],
) -> Vec<Box<dyn Scheme<S, D, M>>> {
    let mut schemes: Vec<Box<dyn Scheme<S, D, M>>> = vec![S::sexp(Sexp::default())];
    let levy = SexpLevy::new(system, y0);
    if Scheme::<S, D, M>::needs_areas(&levy) {
        schemes.push(S::sexp_levy(levy));
    }
    schemes.push(S::midpoint(Midpoint::default()));
    schemes.push(S::heun());
    schemes.push(S::euler_maruyama());
    schemes
}
