//! Equations by their fields, against derivatives by hand.

use formula::{Definition, Equation, FormulaSystem, Which};
use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, WIDTH};
use schemes::{BuiltIn, EulerMaruyama, Heun, HeunLevy, Midpoint, Sexp, Step, run_time::Scheme};
use systems::{
    Constant,
    run_time::{Op, System, Weights},
};

/// dx = (tx − y²)dt + xy dW₁ + y dW₂, dy = sin x dt + dW₁ + x² dW₂.
fn definition(ito: bool) -> Definition {
    let words = |texts: [&str; 2]| texts.map(String::from).to_vec();
    let noises = vec![words(["x*y", "1"]), words(["y", "x^2"])];
    let equation = Equation { drift: words(["t*x - y^2", "sin(x)"]), noises, ito };
    let (state, equation) = (words(["x", "y"]), Some(equation));
    Definition { name: "by hand".into(), state, equation, ..Definition::default() }
}

fn system(ito: bool) -> FormulaSystem {
    FormulaSystem::new(&definition(ito), &Y).unwrap()
}

const Y: [f64; 2] = [0.7, -0.4];
const T: f64 = 0.3;

fn drift([x, y]: [f64; 2]) -> [f64; 2] {
    [T * x - y * y, x.sin()]
}

fn noises([x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    [[x * y, 1.0], [y, x * x]]
}

/// ½Σ g′g.
fn correction([x, y]: [f64; 2]) -> [f64; 2] {
    [0.5 * (x * y * y + x + x * x), x * y]
}

/// \[g₁, g₂\] = g₂′g₁ − g₁′g₂.
fn bracket([x, y]: [f64; 2]) -> [f64; 2] {
    [1.0 - y * y - x.powi(3), 2.0 * x * x * y]
}

/// The drift, the noises and their commutator with factors.
fn sum(y: [f64; 2], drift: [f64; 2], [dt, dw1, dw2, area]: [f64; 4]) -> [f64; 2] {
    let ([g1, g2], c) = (noises(y), bracket(y));
    std::array::from_fn(|i| dt * drift[i] + dw1 * g1[i] + dw2 * g2[i] + area * c[i])
}

#[track_caller]
fn near(found: &[Row], expected: [f64; 2]) {
    for (row, expected) in found.iter().zip(expected) {
        assert!((row[9] - expected).abs() < 4e-15, "{found:?} {expected:?}");
    }
}

#[test]
fn operations_are_those_of_fields() {
    let (y, u, v) = (Rows::splat(&Y), Rows::splat(&[0.2, 0.5]), Rows::splat(&[3.0, -2.0]));
    let (dw, areas) =
        ([[0.3; WIDTH], [-0.1; WIDTH]], [[0.0; WIDTH], [0.05; WIDTH], [9.0; WIDTH], [0.0; WIDTH]]);
    let h = Weights { t: T, dt: 0.2, dw: &dw, areas: &areas };
    for ito in [false, true] {
        let system = system(ito);
        let mut scratch = Rows::zero(system.description().scratch_rows());
        let mut of = |op: Op<&[Row]>| {
            let mut out = Rows::zero(2);
            system.apply(op, 0..2, h, &mut out, &mut scratch);
            out
        };
        let (f, c) = (drift(Y), correction(Y));
        let f = std::array::from_fn(|i| if ito { f[i] - c[i] } else { f[i] });
        near(&of(Op::Gradient { y: &y }), sum(Y, f, [0.2, 0.3, -0.1, 0.0]));
        near(&of(Op::Structure { y: &y, v: &v }), [3.0, -2.0]);
        near(&of(Op::StructureAlong { y: &y, u: &u, v: &v }), [0.0; 2]);
        near(&of(Op::ItoCorrection { y: &y }), c);
        near(&of(Op::AreaGradient { y: &y }), sum(Y, f, [0.0, 0.0, 0.0, -0.05]));
        if !ito {
            let [x, q] = Y;
            let slope = [
                0.2 * (T * 0.2 - 2.0 * q * 0.5) + 0.3 * (q * 0.2 + x * 0.5) - 0.1 * 0.5,
                0.2 * x.cos() * 0.2 - 0.1 * 2.0 * x * 0.2,
            ];
            near(&of(Op::Hessian { y: &y, u: &u }), slope);
        }
        let description = system.description();
        assert!(description.plain && description.depends_on_time && !description.noises_commute);
        assert!(
            !description.has_guard && description.parts.is_err() && !description.is_quadratic()
        );
        let mut energy = [1.0; WIDTH];
        system.energy(&y, h, &mut energy, &mut scratch);
        assert_eq!(energy, [0.0; WIDTH]);
    }
}

#[test]
fn drift_and_noises_may_share_terms() {
    let words = |texts: [&str; 2]| texts.map(String::from).to_vec();
    let (drift, noises) = (words(["x*y", "x*y/7"]), vec![words(["x*y/3", "-x*y"])]);
    let equation = Some(Equation { drift, noises, ito: false });
    let system = FormulaSystem::new(&Definition { equation, ..definition(false) }, &Y).unwrap();
    let (y, dw, mut out) = (Rows::splat(&Y), [[0.3; WIDTH]], Rows::zero(2));
    let mut scratch = Rows::zero(system.description().scratch_rows());
    let h = Weights { dt: 0.2, dw: &dw, ..Weights::NONE };
    system.apply(Op::Gradient { y: &y }, 0..2, h, &mut out, &mut scratch);
    let xy = Y[0] * Y[1];
    near(&out, [xy * (0.2 + 0.3 / 3.0), xy * (0.2 / 7.0 - 0.3)]);
}

/// A step on increments 0.3 and −0.1 and the area 0.05, of the size τ = 0.2 about the time T.
fn step(scheme: &dyn Scheme) -> Rows {
    let system = system(false);
    let mut stepper = scheme.stepper(&system).unwrap();
    stepper.state_mut().copy_from_slice(&Rows::splat(&Y));
    let mut noise = StepNoise::none(2, true);
    (noise.increments[0], noise.increments[1]) = ([0.3; WIDTH], [-0.1; WIDTH]);
    noise.areas[1] = [0.05; WIDTH];
    let mut status = BlockStatus::explicit();
    stepper.step(&Step::new(&Constant::new(0.0).unwrap(), 1, 0.2).unwrap(), &noise, &mut status);
    assert!(status.failed.is_empty());
    let mut end = Rows::zero(2);
    end.copy_from_slice(stepper.state());
    end
}

#[test]
fn steps_are_those_of_fields() {
    let field = |y: [f64; 2], area: f64| sum(y, drift(y), [0.2, 0.3, -0.1, area]);
    let plus = |a: [f64; 2], b: [f64; 2], c: f64| [a[0] + c * b[0], a[1] + c * b[1]];
    let first = field(Y, 0.0);
    let heun = plus(plus(Y, first, 0.5), field(plus(Y, first, 1.0), 0.0), 0.5);
    near(&step(&Heun), heun);
    near(&step(&HeunLevy::<true>), plus(heun, bracket(Y), 0.05));
    near(&step(&HeunLevy::<false>), heun);
    near(&step(&EulerMaruyama), plus(plus(Y, first, 1.0), correction(Y), 0.2));
    let mut z = Y;
    for _ in 0..200 {
        z = plus(Y, field(plus(plus(Y, Y, -0.5), z, 0.5), 0.0), 1.0);
    }
    near(&step(&Midpoint), z);
}

#[test]
fn schemes_of_hamiltonians_are_refused() {
    let system = system(true);
    for scheme in BuiltIn::ALL {
        let made = scheme.at_run_time(&system);
        assert_eq!(made.is_ok(), scheme.is_for_plain(), "{}", scheme.id());
    }
    let refused = Scheme::stepper(&Sexp, &system).err().unwrap().to_string();
    assert!(refused.contains("the scheme is not for `by hand`: an equation of drift"), "{refused}");
}

#[test]
fn what_it_is_told_is_found() {
    let one = |noises: &[[&str; 2]], y0: [f64; 2]| {
        let words = |texts: &[&str; 2]| texts.map(String::from).to_vec();
        let noises = noises.iter().map(words).collect();
        let equation = Equation { drift: words(&["1/x", "0"]), noises, ito: true };
        FormulaSystem::new(&Definition { equation: Some(equation), ..definition(true) }, &y0)
    };
    let commuting = one(&[["x", "0"], ["2*x", "y"]], Y).unwrap();
    let description = commuting.description();
    assert!(description.noises_commute && description.has_guard && !description.depends_on_time);
    assert!(description.additive.iter().all(Option::is_none));
    assert!(commuting.check_domain(&[0.0, 1.0]).is_err());
    assert_eq!(one(&[["0", "3"]], Y).unwrap().description().additive, [Some(vec![1])]);
    assert!(!commuting.has_kinks() && one(&[["abs(x)", "0"]], Y).unwrap().has_kinks());
    // The derivative of Itô's correction.
    let wrong = one(&[["0", "sqrt(y)"]], [1.0, 0.0]).err().unwrap();
    assert_eq!(wrong.which, Which::Field(1, 2));
    assert_eq!(one(&[["0", "sqrt(y)"]], [0.0, 1.0]).err().unwrap().which, Which::Field(0, 1));
    // As it was understood.
    let equations = one(&[["x", "0"]], Y).unwrap().equations(&[false, true]);
    assert_eq!(equations[1], "dy = 0 - γ y dt".replace("0 ", ""));
    assert!(equations[0].contains("∘ dW1") && equations[0].contains("0.5 x"), "{equations:?}");
}
