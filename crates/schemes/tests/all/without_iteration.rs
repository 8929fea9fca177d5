//! Schemes keep Casimirs in every step, and `sexp-li` and `split` also for increments that no
//! truncation bounds. And wrong ones do not.

use crate::common::{
    Numbers, Spins, Visit, any_areas, any_damping, any_increments, any_state, any_step, body,
    conformal_defect, every_system, populations_1, populations_2, schemes_of,
};
use kernels::Tuned;
use noise::Noise;
use real::Real;
use schemes::{BuiltIn, Explicit, Increment, Scheme, SchemeError, SexpLi, Split, Step};
use systems::{
    Constant, Form, Invariant, InvariantKind, MaxwellBloch, Pendulum, Poisson3, PoissonSystem,
};

const SAMPLES: usize = 2000;
/// In the units of [`conformal_defect`]: rounding alone, there is no solver. Each of the terms that
/// are counted there is rounded at most eight times, half an ε each.
const ALLOWED: f64 = 4.0;
pub const MOMENTUM: [f64; 3] = [0.45, 0.0, 0.89];

/// The largest defect of a Casimir over random steps, of which nearly all have a solution.
fn largest_defect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    system: &S,
    y0: [f64; D],
) -> f64 {
    let mut numbers = Numbers(8);
    let (mut largest, mut unsolved) = (0.0f64, 0);
    for _ in 0..SAMPLES {
        let damping = any_damping(&mut numbers);
        let step = any_step(&mut numbers, damping.as_ref());
        let dw = any_increments(&mut numbers, step.tau);
        let y = any_state(&mut numbers, system, y0);
        let areas = match scheme.about().reads_areas {
            true => any_areas(&mut numbers, step.tau),
            false => [[0.0; M]; M],
        };
        let solution = scheme.step(system, &step, &Noise { areas, ..Noise::increments(dw) }, y);
        if !solution.outcome.converged() {
            unsolved += 1;
            continue;
        }
        for (index, invariant) in system.invariants().iter().enumerate() {
            if invariant.kind == InvariantKind::Casimir {
                let defect = conformal_defect(system, index, &step, dw, y, solution.z);
                largest = largest.max(defect);
            }
        }
    }
    assert!(unsolved <= SAMPLES / 100, "{}: {unsolved}", system.name());
    largest
}

struct KeepsCasimirs(usize);

impl Visit for KeepsCasimirs {
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]) {
        use BuiltIn::{Nv, SexpLevy, SexpLi, SexpLiLevy, Split};
        for scheme in schemes_of(&[SexpLi, SexpLevy, SexpLiLevy, Split, Nv], system, y0) {
            let name = system.name();
            let roundings = match (scheme.about().id, name, M) {
                ("sexp-li", ..) => 1.0,
                // The commutators are three more terms; areas reach twice the increments squared.
                ("sexp-levy" | "sexp-li-levy", ..) => 2.0,
                // Five or seven maps, each of which is rounded.
                ("split", ..) => 8.0,
                // Of `nv` so many maps.
                (_, "rigid-body", 3) => 13.0,
                (_, "rigid-body", _) if system.invariants().len() == 1 => 11.0,
                (_, "maxwell-bloch", _) => 7.0,
                _ => 25.0,
            };
            let largest = largest_defect(&*scheme, system, y0);
            assert!(largest <= roundings * ALLOWED, "{} on {name}: {largest}", scheme.about().id);
            self.0 += 1;
        }
    }
}

#[test]
fn casimirs_are_kept() {
    let mut keeps = KeepsCasimirs(0);
    every_system(&mut keeps);
    keeps.visit(&Spins::<6>, [0.6, 0.0, 0.8, 0.0, 1.0, 0.0]);
    // `sexp-li` nine times, two with areas on two systems, two of flows on six.
    assert_eq!(keeps.0, 9 + 2 * 2 + 2 * 6);
}

/// A step of so(3) with v or B from the wrong place, or with a sign.
#[derive(Clone, Copy)]
enum Wrong {
    /// B at the beginning.
    OldStructure,
    /// ẑ + a − b for Cayley's ẑ + a + b, where a is odd in v and b even.
    Sign,
}

impl Explicit for Wrong {
    const ID: &'static str = "wrong";

    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let start = y * h.step().first_decay;
        let v = h.averaged_gradient(start, start + h.field(start));
        let z = match self {
            Self::OldStructure => start + h.structure(start, v),
            Self::Sign => start * 2.0 - h.cayley(start, v * -1.0),
        };
        z * h.step().second_decay
    }
}

#[test]
fn wrong_steps_do_not_keep_casimirs() {
    for wrong in [Wrong::OldStructure, Wrong::Sign] {
        let largest = largest_defect(&wrong, &body(), MOMENTUM);
        assert!(largest > 1e6, "{largest}");
    }
}

/// B without its closed form of the linear equation.
#[derive(Clone, Copy)]
struct Eliminated<S>(S);

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> PoissonSystem<D, M> for Eliminated<S> {
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

/// The closed form and the elimination solve z = y + B((y+z)/2)v.
fn both_solve<S: PoissonSystem<D, M> + Copy, const D: usize, const M: usize>(system: S) {
    let mut numbers = Numbers(3);
    for n in 0..500 {
        let y: [f64; D] = [(); D].map(|()| 2.0 * numbers.next());
        let size = [0.01, 1.0, 30.0][n % 3];
        let v: [f64; D] = [(); D].map(|()| size * numbers.next());
        for z in [system.cayley(y, v), Eliminated(system).cayley(y, v)] {
            let middle = std::array::from_fn(|i| 0.5 * (y[i] + z[i]));
            let field: [f64; D] = system.structure(middle, v);
            let length: f64 = y.iter().chain(&z).map(|x| x.abs()).sum();
            for i in 0..D {
                let residual = (z[i] - y[i] - field[i]).abs();
                // Backward stability: z to round-off times the condition, the equation times ‖v‖.
                let allowed = 64.0 * f64::EPSILON * length * (1.0 + size) * (1.0 + size);
                assert!(residual <= allowed, "{} {size}: {residual:e}", system.name());
            }
        }
    }
}

#[test]
fn closed_forms_and_elimination_solve_the_linear_equation() {
    both_solve(body());
    both_solve(MaxwellBloch);
    both_solve(Pendulum::new(1.0).unwrap());
    both_solve(Poisson3::new(1.0).unwrap());
}

/// J with H₀ = y₁⁴/4 + y₂²/2, H₁ = y₁² and H₂ = y₁y₂, so that {H₁, H₂} = −2y₁².
struct Quartic;

impl PoissonSystem<2, 2> for Quartic {
    fn name(&self) -> &'static str {
        "quartic"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 2]) -> R {
        let squares = y[0] * y[0];
        (squares * squares * 0.25 + y[1] * y[1] * 0.5) * dt + squares * dw[0] + y[0] * y[1] * dw[1]
    }
}

#[test]
fn a_step_with_a_constant_structure_is_that_by_hand() {
    let (y0, damping) = ([0.7, 0.4], Constant::new(0.6).unwrap());
    let gradient = |[q, p]: [f64; 2], h: f64, [a, b]: [f64; 2]| {
        [h * q.powi(3) + 2.0 * a * q + b * p, h * p + b * q]
    };
    let field = |v: [f64; 2]| [-v[1], v[0]];
    let plus = |a: [f64; 2], b: [f64; 2], s: f64| [a[0] + s * b[0], a[1] + s * b[1]];
    let (tau, dw, area) = (0.1, [0.3, -0.2], 0.05);
    let step = Step::new(&damping, 0, tau).unwrap();
    let noise = Noise { areas: [[0.0, area], [-area, 0.0]], ..Noise::increments(dw) };
    let start = y0.map(|y| y * (-0.03f64).exp());
    let middle = plus(start, field(gradient(start, tau, dw)), 0.5);
    let end = plus(start, field(gradient(middle, tau, dw)), 1.0);
    // Simpson's rule averages cubic gradients; the term of the area is −A₁₂∇{H₁, H₂} = 4A₁₂y₁e₁.
    let [first, last] = [start, end].map(|y| gradient(y, tau, dw));
    let between = gradient(plus(start, end, 1.0).map(|y| 0.5 * y), tau, dw);
    let mean = plus(plus(first, last, 1.0), between, 4.0).map(|v| v / 6.0);
    for (scheme, of_area) in [
        (SexpLi::new(&Quartic, y0).unwrap(), 0.0),
        (SexpLi::with_areas(&Quartic, y0).unwrap(), 4.0 * area * middle[0]),
    ] {
        let exact = plus(start, field(plus(mean, [of_area, 0.0], 1.0)), 1.0);
        let found = scheme.step(&Quartic, &step, &noise, y0).z;
        let distance = (0..2).map(|i| (found[i] - exact[i] * (-0.03f64).exp()).abs()).sum::<f64>();
        assert!(distance < 32.0 * f64::EPSILON, "{found:?} {exact:?}");
    }
}

/// 400 steps with increments of this many standard deviations, none clipped; the distance from the
/// law of the Casimir.
fn with_large_noise<S: PoissonSystem<3, M>, const M: usize>(
    scheme: &impl Scheme<S, 3, M>,
    system: &S,
    mut y: [f64; 3],
    deviations: f64,
) -> f64 {
    assert!(!scheme.about().clips_increments);
    let mut numbers = Numbers(4);
    let damping = Constant::new(0.2).unwrap();
    let before = system.invariant(0, y);
    let mut law = 1.0f64;
    let mut largest = 0.0f64;
    for n in 0..400 {
        let step = Step::new(&damping, n, 0.0625).unwrap();
        let dw = [(); M].map(|()| deviations * 0.25 * (1.0 + numbers.next().abs()));
        let dw = dw.map(|x| if numbers.next() < 0.0 { -x } else { x });
        let solution = scheme.step(system, &step, &Noise::increments(dw), y);
        assert!(solution.outcome.converged(), "{} step {n}", scheme.about().id);
        y = solution.z;
        law *= (-2.0 * step.damping_integral()).exp();
        largest = largest.max((system.invariant(0, y) / (law * before) - 1.0).abs());
    }
    largest
}

#[test]
fn increments_of_a_hundred_deviations_are_solved_and_conserve() {
    let body = body();
    let [li_body, li_light] = [
        SexpLi::new(&body, MOMENTUM).unwrap(),
        SexpLi::new(&MaxwellBloch, [1.0, 2.0, 3.0]).unwrap(),
    ];
    for deviations in [1.0, 10.0, 100.0] {
        for defect in [
            with_large_noise(&li_body, &body, MOMENTUM, deviations),
            with_large_noise(&Split, &body, MOMENTUM, deviations),
            with_large_noise(&li_light, &MaxwellBloch, [1.0, 2.0, 3.0], deviations),
            with_large_noise(&Split, &MaxwellBloch, [1.0, 2.0, 3.0], deviations),
        ] {
            // A walk of 400 steps of a few roundings each: √400 · 8 ε, and the law itself 400 ε.
            assert!(defect < 600.0 * f64::EPSILON, "{deviations}: {defect:e}");
        }
    }
}

/// sl(2): B(y)v = K(y × v) with K = diag(1, 1, −1), Casimir y₁² + y₂² − y₃². A(v) has real
/// eigenvalues for some v.
struct Hyperbolic;

impl PoissonSystem<3, 1> for Hyperbolic {
    fn name(&self) -> &'static str {
        "hyperbolic"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let x = [y[0], y[1], -y[2]];
        [x[1] * v[2] - x[2] * v[1], x[2] * v[0] - x[0] * v[2], x[0] * v[1] - x[1] * v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) * (0.5 * (dt + dw[0]))
    }
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "½(y₁² + y₂² − y₃²)")]
    }
    fn invariant<R: Real>(&self, _index: usize, y: [R; 3]) -> R {
        (y[0] * y[0] + y[1] * y[1] - y[2] * y[2]) * 0.5
    }
}

/// B(y) = y₃²J, with Casimirs of these forms named.
struct Squared(&'static [Form]);

impl PoissonSystem<3, 1> for Squared {
    fn name(&self) -> &'static str {
        "squared"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let square = y[2] * y[2];
        [-(square * v[1]), square * v[0], R::zero()]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        y[0] * y[0] * dt + y[1] * dw[0]
    }
    fn invariants(&self) -> Vec<Invariant> {
        let casimir = |form: &Form| match form {
            Form::Linear => Invariant::linear_casimir("C", "y₃"),
            _ => Invariant::quadratic_casimir("C", "½y₃²"),
        };
        self.0.iter().map(casimir).collect()
    }
}

#[test]
fn the_kind_of_a_system_is_found() {
    let clips = |scheme: SexpLi| schemes::run_time::Scheme::about(&scheme).clips_increments;
    // Solvable for every v: nothing is clipped.
    assert!(!clips(SexpLi::new(&body(), MOMENTUM).unwrap()));
    assert!(!clips(SexpLi::new(&MaxwellBloch, [1.0, 2.0, 3.0]).unwrap()));
    assert!(!clips(SexpLi::new(&Pendulum::new(1.0).unwrap(), [0.2, 1.0]).unwrap()));
    // Real eigenvalues: increments are clipped, and a step that has no solution fails.
    assert!(clips(SexpLi::new(&Hyperbolic, [1.0, 0.0, 0.5]).unwrap()));
    let clipped = SexpLi::new(&Hyperbolic, [1.0, 0.0, 0.5]).unwrap();
    let largest = largest_defect(&clipped, &Hyperbolic, [1.0, 0.0, 0.5]);
    assert!(largest < 1e3, "{largest}");
    // B of the first populations is constant; else, if neither constant nor affine, Casimirs have
    // to be linear.
    assert!(!clips(SexpLi::new(&populations_1(), [0.2, 0.4, 0.6]).unwrap()));
    assert!(clips(SexpLi::new(&populations_2(), [0.2, 0.4, 0.6]).unwrap()));
    assert!(SexpLi::new(&Squared(&[Form::Linear]), [1.0; 3]).is_ok());
    let others: [&[Form]; 3] = [&[], &[Form::Quadratic], &[Form::Linear, Form::Quadratic]];
    for forms in others {
        let refused = SexpLi::new(&Squared(forms), [1.0; 3]);
        let Err(SchemeError(_)) = refused else { panic!("{refused:?}") };
        assert!(refused.unwrap_err().to_string().contains("sexp is for any B"));
    }
}
