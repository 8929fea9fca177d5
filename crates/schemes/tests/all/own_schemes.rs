//! Schemes that a user writes: what holds for the schemes of this crate holds for them.

use noise::{Noise, Truncation};
use nonlin::Solver;
use real::{Real, elementary};
use schemes::{Explicit, Implicit, Increment, Scheme, Split, Step};
use systems::{Constant, Flows, PoissonSystem};

use crate::common::body;

/// Euler's method with Lévy areas: y_{n+1} = y_n + B∇h + Σ A_ml \[fₘ, f_l\].
pub struct EulerWithAreas;

impl Explicit for EulerWithAreas {
    const ID: &'static str = "euler-with-areas";
    const READS_AREAS: bool = true;
    const CLIPS_INCREMENTS: bool = false;

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        y + h.field(y) + h.commutators(y)
    }
}

/// The midpoint rule with exact damping: ψ(ẑ, z) = ẑ + B(z̄)∇h(z̄), z̄ = (ẑ+z)/2.
pub struct ConformalMidpoint {
    pub solver: Solver,
}

impl Implicit for ConformalMidpoint {
    const ID: &'static str = "conformal-midpoint";
    const EXACT_DAMPING: bool = true;
    const SOLVER: Option<fn(&Self) -> Solver> = Some(|scheme| scheme.solver);

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        start + h.field((start + z) * 0.5)
    }
}

/// y + ⅛Σ B(yₖ)∇h(yₖ) with yₖ = y + ⅛k B(y)∇h(y), k = 1 … 6: a stage stores six results.
pub struct Wide;

impl Explicit for Wide {
    const ID: &'static str = "wide";

    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let first = h.field(y);
        let points = [1, 2, 3, 4, 5, 6].map(|k| y + first * (0.125 * f64::from(k)));
        points.into_iter().fold(y, |z, point| z + h.field(point) * 0.125)
    }
}

#[test]
fn what_a_formula_declares_its_scheme_says() {
    fn declared(scheme: &dyn Scheme<systems::RigidBody<3>, 3, 3>) -> (&str, bool, bool) {
        (scheme.about().id, scheme.about().reads_areas, scheme.about().clips_increments)
    }
    let midpoint = ConformalMidpoint { solver: Solver::default() };
    assert_eq!(declared(&EulerWithAreas), ("euler-with-areas", true, false));
    assert_eq!(declared(&midpoint), ("conformal-midpoint", false, true));
    // One noise has no areas.
    let turning = systems::RigidBody::one_noise([2.0, 1.0, 2.0 / 3.0], 1.0).unwrap();
    assert!(!reads_areas(&EulerWithAreas, &turning));
}

fn reads_areas<S>(scheme: &impl Scheme<S, 3, 1>, _system: &S) -> bool {
    scheme.about().reads_areas
}

#[test]
fn areas_move_an_explicit_scheme() {
    let bound = Truncation::new(4).unwrap().area_bound(0.01).unwrap();
    let step = schemes::Step::new(&systems::Constant::new(0.3).unwrap(), 0, 0.01).unwrap();
    let without = Noise::increments([0.1, -0.05, 0.02]);
    let mut areas = [[0.0; 3]; 3];
    (areas[0][1], areas[1][0]) = (bound, -bound);
    let y = [0.6, 0.0, 0.8];
    let [with, without] = [Noise { areas, ..without }, without]
        .map(|noise| EulerWithAreas.step(&body(), &step, &noise, y).z);
    let commutator: [f64; 3] = systems::PoissonSystem::commutators(&body(), y, areas);
    assert_eq!(with, std::array::from_fn(|i| without[i] + commutator[i]));
    assert_ne!(with, without);
}

/// The plane turned by the angle −(dt + dw).
struct Turning;

impl PoissonSystem<2, 1> for Turning {
    fn name(&self) -> &'static str {
        "turning"
    }
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * (dt + dw[0]))
    }
}

impl Flows<2, 1> for Turning {
    const PARTS: usize = 1;
    const EXACT: bool = true;

    #[inline(always)]
    fn flow<R: Real>(&self, _: usize, y: [R; 2], dt: R, dw: [R; 1]) -> [R; 2] {
        let (sin, cos) = (dt + dw[0]).sin_cos();
        [cos * y[0] + sin * y[1], cos * y[1] - sin * y[0]]
    }
}

/// Of flows as users write them: sines are those of `real`, not of the platform.
#[test]
fn functions_in_flows_have_the_same_bits_on_every_machine() {
    for n in 1..2000 {
        let tau = 0.003 * f64::from(n);
        let step = Step::new(&Constant::new(0.0).unwrap(), 0, tau).unwrap();
        let next = Split.step(&Turning, &step, &Noise::increments([0.0]), [1.0, 0.0]).z;
        let (sin, cos) = elementary::sin_cos(tau);
        assert_eq!(next.map(f64::to_bits), [cos.to_bits(), (-sin).to_bits()], "{tau}");
    }
}
