//! Systems, dampings and the conformal defect that the tests share.

use kernels::Tuned;
use noise::Truncation;
use real::{Real, ScalarFunction, gradient};
use schemes::{BuiltIn, Scheme, SchemeError, Sexp, SexpLevy, SexpLi, Step};
use systems::{
    Constant, Cosine, Damping, Invariant, Linear, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3,
    PoissonSystem, RigidBody, RigidBodyEnergy, Sine,
};

pub const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];
pub const NOISE_INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

pub fn body() -> RigidBody<3> {
    RigidBody::three_noises(INERTIA, NOISE_INERTIA).unwrap()
}

/// Something to do with every system.
pub trait Visit {
    /// `y0` is the paper's initial value where the system is one of the paper.
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]);
}

/// The systems whose discrete gradient is exact.
pub fn every_system(visit: &mut impl Visit) {
    let momentum = [1.1f64.cos(), 0.0, 1.1f64.sin()];
    let populations = [0.2, 0.4, 0.6];
    visit.visit(&Pendulum::new(1.0).unwrap(), [0.2, 1.0]);
    visit.visit(&body(), momentum);
    visit.visit(&RigidBody::one_noise(INERTIA, 1.0).unwrap(), momentum);
    visit.visit(&RigidBodyEnergy::new(INERTIA, 1.0).unwrap(), momentum);
    visit.visit(&populations_1(), populations);
    visit.visit(&populations_2(), populations);
    visit.visit(&MaxwellBloch, [1.0, 2.0, 3.0]);
    visit.visit(&Poisson3::new(1.0).unwrap(), [1.0, 2.0, 3.0]);
}

/// D/3 spins in a row in a fluctuating field: B(y)v = (sᵢ × vᵢ), H₀ = −Σ sᵢ·sᵢ₊₁ − ¼Σ (sᵢᶻ)² and
/// Hₘ = −0.8 Σ sᵢᵐ, in more than three dimensions.
#[derive(Clone, Copy, Debug)]
pub struct Spins<const D: usize>;

impl<const D: usize> PoissonSystem<D, 3> for Spins<D> {
    fn name(&self) -> &'static str {
        "spins"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        let mut turned = y;
        for i in (0..D).step_by(3) {
            turned[i] = y[i + 1] * v[i + 2] - y[i + 2] * v[i + 1];
            turned[i + 1] = y[i + 2] * v[i] - y[i] * v[i + 2];
            turned[i + 2] = y[i] * v[i + 1] - y[i + 1] * v[i];
        }
        turned
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 3]) -> R {
        let mut energy = R::zero();
        for i in 0..D {
            energy = energy - y[i] * (0.8 * dw[i % 3]);
            if i % 3 == 2 {
                energy = energy - y[i] * y[i] * (0.25 * dt);
            }
            if i + 3 < D {
                energy = energy - y[i] * y[i + 3] * dt;
            }
        }
        energy
    }

    // Derivatives of derivatives in nine dimensions take minutes to compile.
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 3]) -> [R; D] {
        let mut gradient = y;
        for i in 0..D {
            let own = if i % 3 == 2 { 0.5 } else { 0.0 };
            let after = if i + 3 < D { y[i + 3] } else { R::zero() };
            let before = if i >= 3 { y[i - 3] } else { R::zero() };
            gradient[i] = -(after + before + y[i] * own) * dt - 0.8 * dw[i % 3];
        }
        gradient
    }

    /// The areas rotate all spins about one axis.
    #[inline(always)]
    fn commutators<R: Real>(&self, y: [R; D], areas: [[f64; 3]; 3]) -> [R; D] {
        let axis = [areas[1][2], -areas[0][2], areas[0][1]].map(|area| R::constant(0.64 * area));
        self.structure(y, std::array::from_fn(|i| axis[i % 3]))
    }

    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "½|sᵢ|²"); D / 3]
    }

    fn invariant<R: Real>(&self, index: usize, y: [R; D]) -> R {
        let s = &y[3 * index..3 * index + 3];
        (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]) * 0.5
    }
}

// As `kernels` does it for the systems of the paper, for the schemes that are wanted: kernels in
// six dimensions take long to compile.
impl Tuned<6, 3> for Spins<6> {
    fn scheme(
        scheme: BuiltIn,
        system: &Self,
        y0: [f64; 6],
    ) -> Result<Box<dyn Scheme<Self, 6, 3>>, SchemeError> {
        Ok(match scheme {
            BuiltIn::Sexp => Box::new(Sexp),
            BuiltIn::SexpLevy => Box::new(SexpLevy::new(system, y0)),
            BuiltIn::SexpLi => Box::new(SexpLi::new(system, y0)?),
            BuiltIn::SexpLiLevy => Box::new(SexpLi::with_areas(system, y0)?),
            _ => return Err(SchemeError::not_for(scheme.id(), "spins", "it is not tested")),
        })
    }
}

/// Those of the schemes that the system has; with areas only where its noises do not commute.
pub fn schemes_of<S: Tuned<D, M>, const D: usize, const M: usize>(
    schemes: &[BuiltIn],
    system: &S,
    y0: [f64; D],
) -> Vec<Box<dyn Scheme<S, D, M>>> {
    let made = schemes.iter().filter_map(|&kind| {
        let scheme = S::scheme(kind, system, y0).ok()?;
        (scheme.about().reads_areas || !kind.is_for_areas()).then_some(scheme)
    });
    made.collect()
}

/// a = b = −1: H = y₁y₂y₃.
pub fn populations_1() -> LotkaVolterra<1, 1> {
    LotkaVolterra::<1, 1>::new(1.0).unwrap()
}

/// a = −1, b = −2: H = y₁²y₂²y₃.
pub fn populations_2() -> LotkaVolterra<2, 2> {
    LotkaVolterra::<2, 2>::new(1.0).unwrap()
}

/// A point near y₀, or, for populations, in the positive octant.
pub fn any_state<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    numbers: &mut Numbers,
    system: &S,
    y0: [f64; D],
) -> [f64; D] {
    if system.name() == "lotka-volterra" {
        numbers.point([1.0; D], 0.8)
    } else {
        numbers.point(y0, 1.0)
    }
}

/// One of the four closed forms with coefficients up to 2.
pub fn any_damping(numbers: &mut Numbers) -> Box<dyn Damping> {
    let (a, b) = (2.0 * numbers.next(), 2.0 * numbers.next());
    match (numbers.next() * 2.0).floor() as i32 {
        -2 => Box::new(Constant::new(a).unwrap()),
        -1 => Box::new(Linear::new(0.1 * a).unwrap()),
        0 => Box::new(Sine::new(a, b).unwrap()),
        _ => Box::new(Cosine::new(a, b).unwrap()),
    }
}

/// Step number 0 … 49 of a size between 10⁻⁴ and 0.9, evenly on a logarithmic scale.
pub fn any_step(numbers: &mut Numbers, damping: &dyn Damping) -> Step {
    let tau = 0.009 * 100f64.powf(numbers.next());
    Step::new(damping, (25.0 + 25.0 * numbers.next()) as u64, tau).unwrap()
}

/// Increments spread over all that truncation with k = 4 lets through, the bounds included.
pub fn any_increments<const M: usize>(numbers: &mut Numbers, tau: f64) -> [f64; M] {
    let bound = Truncation::new(4).unwrap().bound(tau).unwrap();
    [(); M].map(|()| bound * (1.25 * numbers.next()).clamp(-1.0, 1.0))
}

/// Areas spread over all that truncation with k = 4 lets through.
pub fn any_areas<const M: usize>(numbers: &mut Numbers, tau: f64) -> [[f64; M]; M] {
    let bound = Truncation::new(4).unwrap().area_bound(tau).unwrap();
    let mut areas = [[0.0; M]; M];
    for m in 0..M {
        for l in m + 1..M {
            areas[m][l] = bound * (1.25 * numbers.next()).clamp(-1.0, 1.0);
            areas[l][m] = -areas[m][l];
        }
    }
    areas
}

struct InvariantFunction<'a, S, const M: usize> {
    system: &'a S,
    index: usize,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> ScalarFunction<D>
    for InvariantFunction<'_, S, M>
{
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.system.invariant(self.index, y)
    }
}

/// |F(y₁) − e^{−p∫γ}F(y₀)| in units of ε times the terms that make up F and the step.
///
/// F(z) − F(ẑ) = ∇̄F·(z − ẑ), so a component of z that is off by δ moves F by at most |∂F|δ. Each
/// component is ẑ plus a sum of |Bᵢⱼ||∇̄hⱼ|, of which every term is rounded a few times, and the
/// solver leaves some ulp of ‖z‖. The factors of the law add the rounding of ∫γ and of two
/// exponentials.
pub fn conformal_defect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    index: usize,
    step: &Step,
    dw: [f64; M],
    y0: [f64; D],
    y1: [f64; D],
) -> f64 {
    let degree = system.invariants()[index].degree;
    let function = InvariantFunction::<S, M> { system, index };
    let exponent = degree * step.damping_integral();
    let law = (-exponent).exp();
    let f0: f64 = system.invariant(index, y0);
    let f1: f64 = system.invariant(index, y1);

    let before = y0.map(|x| step.first_decay * x);
    let after = y1.map(|x| x / step.second_decay);
    let middle: [f64; D] = std::array::from_fn(|i| 0.5 * (before[i] + after[i]));
    let slopes = [before, after, middle].map(|y| gradient(&function, y).map(f64::abs));
    let discrete = system.averaged_gradient(before, after, step.tau, dw);
    let length: f64 = before.iter().chain(&after).map(|x| x.abs()).sum();
    let mut terms = 0.0;
    for i in 0..D {
        let mut size = length;
        for j in 0..D {
            let mut unit = [0.0; D];
            unit[j] = 1.0;
            size += (system.structure(middle, unit)[i] * discrete[j]).abs();
        }
        terms += slopes.iter().map(|slope| slope[i]).fold(0.0, f64::max) * size;
    }
    terms *= step.second_decay.powf(degree);
    terms += (1.0 + exponent.abs()) * (law * f0).abs();
    (f1 - law * f0).abs() / (f64::EPSILON * terms)
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

    pub fn point<const D: usize>(&mut self, centre: [f64; D], radius: f64) -> [f64; D] {
        centre.map(|c| c + radius * self.next())
    }
}
