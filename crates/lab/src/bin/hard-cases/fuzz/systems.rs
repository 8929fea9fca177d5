//! Any system, with parameters that are mostly sound or mostly not.

use anyhow::ensure;
use systems::{
    IntegerExponents, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem,
    RealExponents, RigidBody, RigidBodyEnergy, SpinChain, SystemError,
};

use super::{Bits, Fed, accepted};

/// What is done with a system.
pub trait Visitor {
    /// One parameter in so many is any number.
    const WILD: u64;
    fn visit<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize>(
        bits: &mut Bits,
        system: S,
    ) -> Fed;
}

/// Visits a system, if its parameters are accepted.
pub fn visit<V: Visitor>(bits: &mut Bits) -> Fed {
    let p @ [a, b, c, d, e, f] = [(); 6].map(|()| bits.positive(V::WILD));
    match bits.below(9) {
        0 => one::<V, _, 2, 1>(bits, Pendulum::new(a), &p[..1]),
        1 => one::<V, _, 3, 3>(bits, RigidBody::three_noises([a, b, c], [d, e, f]), &p),
        2 => one::<V, _, 3, 1>(bits, RigidBody::one_noise([a, b, c], d), &p[..4]),
        3 => one::<V, _, 3, 1>(bits, RigidBodyEnergy::new([a, b, c], d), &p[..4]),
        4 => one::<V, _, 3, 1>(bits, LotkaVolterra::<RealExponents>::new(-a, -b, c), &p[..3]),
        5 => one::<V, _, 3, 1>(bits, LotkaVolterra::<IntegerExponents<2, 2>>::integer(a), &p[..1]),
        6 => one::<V, _, 3, 1>(bits, Poisson3::new(a), &p[..1]),
        7 => one::<V, _, 3, 1>(bits, Ok(MaxwellBloch), &[]),
        _ => one::<V, _, 6, 3>(bits, SpinChain::<6>::new(a, b, c), &p[..3]),
    }
}

fn one<V: Visitor, S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize>(
    bits: &mut Bits,
    system: Result<S, SystemError>,
    parameters: &[f64],
) -> Fed {
    let Some(system) = accepted(system)? else { return Ok(None) };
    ensure!(parameters.iter().all(|p| p.is_finite()), "accepted {parameters:?}");
    V::visit::<S, D, M>(bits, system)
}
