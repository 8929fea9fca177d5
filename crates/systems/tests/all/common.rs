//! All systems of the paper at random points, and ways to spoil them.

use real::{Real, ScalarFunction, gradient};
use systems::{
    LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody, RigidBodyEnergy,
};

/// Something to check of every system.
pub trait Check {
    /// Checks `system`; `around` draws points where it is defined, from numbers in [−1, 1].
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    );
}

/// Where random points are taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// [−2, 2] in each component.
    Box,
    /// [0.3, 1.7]: positive, away from the poles.
    Positive,
}

impl Region {
    pub fn point<const D: usize>(self, numbers: &mut Numbers) -> [f64; D] {
        [(); D].map(|()| match self {
            Self::Box => 2.0 * numbers.next(),
            Self::Positive => 1.0 + 0.7 * numbers.next(),
        })
    }
}

pub const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];
pub const NOISE_INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

/// Every system, with noise sizes and scales that are not 1.
pub fn every_system(check: &mut impl Check) {
    use Region::{Box, Positive};
    check.check(&Pendulum::new(0.7).unwrap(), Box);
    check.check(&RigidBody::three_noises(INERTIA, NOISE_INERTIA).unwrap(), Box);
    check.check(&RigidBody::one_noise(INERTIA, 1.5).unwrap(), Box);
    check.check(&RigidBodyEnergy::new(INERTIA, 0.7).unwrap(), Box);
    check.check(&LotkaVolterra::<1, 1>::new(1.0).unwrap(), Positive);
    check.check(&LotkaVolterra::<2, 2>::new(1.3).unwrap(), Positive);
    check.check(&LotkaVolterra::<3, 2>::new(0.5).unwrap(), Positive);
    check.check(&MaxwellBloch, Box);
    check.check(&Poisson3::new(0.7).unwrap(), Box);
}

/// An invariant as a function, to be differentiated.
pub struct InvariantFunction<'a, S, const M: usize> {
    pub system: &'a S,
    pub index: usize,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> ScalarFunction<D>
    for InvariantFunction<'_, S, M>
{
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.system.invariant(self.index, y)
    }
}

pub fn invariant_gradient<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    index: usize,
    y: [f64; D],
) -> [f64; D] {
    gradient(&InvariantFunction::<S, M> { system, index }, y)
}

/// The matrix B(y), column by column.
pub fn matrix<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
) -> [[f64; D]; D] {
    let mut b = [[0.0; D]; D];
    for j in 0..D {
        let mut unit = [0.0; D];
        unit[j] = 1.0;
        let column = system.structure(y, unit);
        for i in 0..D {
            b[i][j] = column[i];
        }
    }
    b
}

pub fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|i| a[i] * b[i]).sum()
}

/// Σ|aᵢ||Bᵢⱼ||vⱼ|: what the terms of aᵀBv add up to when nothing cancels.
pub fn size<const D: usize>(a: [f64; D], b: [[f64; D]; D], v: [f64; D]) -> f64 {
    let mut sum = 0.0;
    for i in 0..D {
        for j in 0..D {
            sum += (a[i] * b[i][j] * v[j]).abs();
        }
    }
    sum
}

/// B and h of a system, and nothing else.
pub struct Plain<'a, S>(pub &'a S);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M> for Plain<'_, S> {
    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        self.0.structure(y, v)
    }
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        self.0.energy(y, dt, dw)
    }
}

/// A small generator of numbers in [−1, 1).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 * 2f64.powi(-52) - 1.0
    }

    pub fn vector<const D: usize>(&mut self) -> [f64; D] {
        [(); D].map(|()| self.next())
    }
}
