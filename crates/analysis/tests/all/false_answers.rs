//! What `inspect` once said falsely, each with what it must not say again.

use formula::Definition;
use inspect::{Applies, InspectSettings, Inspection, Status};
use real::Real;
use systems::{Damping, DampingFunction, PoissonSystem};

use super::{applies, constant, inspect_alone as inspect, system, texts};

/// The report on texts alone.
fn alone(definition: &Definition) -> Inspection {
    let y0 = vec![1.0; definition.state.len()];
    inspect::inspect(&system(definition, &y0), &InspectSettings::default()).unwrap()
}

/// The report on texts from an initial value, with damping on [0, 1].
fn with(definition: &Definition, y0: &[f64], damping: &dyn Damping) -> Inspection {
    let settings = InspectSettings {
        y0: Some(y0.to_vec()),
        damping: Some((damping, 1.0)),
        areas: false,
        ..InspectSettings::default()
    };
    inspect::inspect(&system(definition, y0), &settings).unwrap()
}

/// A spin (a, b, c) with two noises, beside an oscillator (q, p).
fn beside(first_entry: &str, noises: [&str; 2]) -> Definition {
    let first = format!("{first_entry} b 0 0");
    let energy = "a^2 + b^2/2 + c^2/4 + (q^2 + p^2)/2";
    texts("a b c q p", &[&first, "-a 0 0", "0 0", "1"], energy, &noises)
}

/// Energies in the plane.
fn plane(energy: &str, noises: &[&str]) -> Definition {
    texts("x y", &["1"], energy, noises)
}

#[test]
fn a_stiff_block_does_not_hide_that_noises_do_not_commute() {
    // The noises turn the oscillator at the rate 1e7.
    let stiff = ["a + 1e7*(q^2 + p^2)/2", "b + 1e7*(q^2 + p^2)/2"];
    let report = alone(&beside("-c", stiff));
    assert_eq!(report.noise.commute.status, Status::Fails, "{report}");
    assert_eq!(report.order("sexp"), Some((0.5, 1.0)));
}

#[test]
fn an_almost_casimir_is_none() {
    // A defect of 1e-10 in so(3), skew.
    let report = alone(&beside("-c+1e-10*a^2", ["a", "b"]));
    assert!(report.casimirs.as_ref().unwrap().found.is_empty(), "{report}");
    assert_eq!(applies(&report, "conformal-casimir"), Some(Applies::No), "{report}");
}

#[test]
fn a_rounded_constant_proves_nothing() {
    // Noises along axes at the angle π/2, whose cosine is 6e-17; sin(1e-9 x) beside y.
    let turned = beside("-c", ["a", "a + 6.123233995736766e-17*b"]);
    let long_wave = plane("(x^2 + y^2)/2", &["sin(1e-9*x)", "y"]);
    for report in [alone(&turned), alone(&long_wave)] {
        assert_eq!(report.noise.commute.status, Status::Unknown, "{report}");
        let order = report.orders.iter().find(|order| order.scheme == "sexp").unwrap();
        assert_eq!(order.known, Status::Unknown, "{report}");
        assert_eq!(report.recommended[0].scheme, "sexp-levy");
    }
    // A small ball is not printed as zero.
    let text = with(&turned, &[1e-7, 0.0, 1e-8, 0.0, 0.0], &constant(0.0)).to_string();
    assert!(text.contains("‖y‖ ≤ 2.0100e-7") && !text.contains("‖y‖ ≤ 0.0000"), "{text}");
}

/// γ = 2t, with a wrong integral.
struct WrongIntegral;

impl Damping for WrongIntegral {
    fn rate(&self, t: f64) -> f64 {
        2.0 * t
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        0.5 * (b * b - a * a)
    }
    fn describe(&self) -> String {
        "given".to_owned()
    }
}

#[test]
fn a_wrong_integral_is_a_mistake() {
    let report = with(&plane("(x^2 + y^2)/2", &[]), &[1.0, 0.0], &WrongIntegral);
    assert_eq!(report.mistakes.len(), 1);
    assert!(report.mistakes[0].contains("integral of the damping"), "{report}");
    // The energy would bound paths.
    assert_eq!(report.problem.as_ref().unwrap().radius, None);
}

/// In the plane, each with one strange thing.
#[derive(Clone, Copy, PartialEq)]
enum Strange {
    /// B jumps from J to 2J at y₁ = 0.
    Jump,
    /// H₁ = |y₂|.
    Kink,
    /// H₀ is zero but for a bump about (1, 0).
    Bump,
    /// A power that eight nodes do not average.
    Power,
}

impl PoissonSystem<2, 2> for Strange {
    fn name(&self) -> &'static str {
        "strange"
    }
    fn structure<R: Real>(&self, y: [R; 2], v: [R; 2]) -> [R; 2] {
        let (one, two) = (R::one(), R::constant(2.0));
        let s = if *self == Self::Jump { R::where_less(R::zero(), y[0], two, one) } else { one };
        [s * v[1], -(s * v[0])]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 2]) -> R {
        let square = (y[0] * y[0] + y[1] * y[1]) * 0.5;
        match self {
            Self::Jump => square * (dt + dw[0]),
            Self::Kink => {
                square * dt + R::where_less(R::zero(), y[1], y[1], -y[1]) * (dw[0] + dw[1])
            }
            Self::Bump => {
                let distance = ((y[0] - 1.0) * (y[0] - 1.0) + y[1] * y[1]) * 1e6;
                let inside = (-distance + 1.0).powi(3);
                R::where_less(distance, R::one(), inside, R::zero()) * dt + square * dw[0]
            }
            Self::Power => (y[0].powi(20) + y[1].powi(20)) * (dt + dw[0]),
        }
    }
}

#[test]
fn pieces_and_powers_are_not_smoothed_over() {
    let report = inspect(&Strange::Jump).unwrap();
    assert!(report.structure.constant.fails(), "{report}");
    assert_ne!(applies(&report, "solvability"), Some(Applies::Yes));
    for case in [Strange::Jump, Strange::Kink] {
        let report = inspect(&case).unwrap();
        let one = report.orders.iter().filter(|order| order.strong == 1.0);
        assert!(one.clone().count() > 3 && one.into_iter().all(|o| o.known == Status::Holds));
    }
    let bump = &inspect(&Strange::Bump).unwrap().hamiltonians.shapes[0];
    assert_eq!(bump.homogeneous.status, Status::Holds);
    let ratio = &alone(&plane("x^2/(x^2 + y^2)", &["(x^2 + y^2)/2"])).hamiltonians.shapes[0];
    assert!(ratio.homogeneous.holds() && ratio.degree == Some(0.0), "{ratio}");
    // An energy that is kept only nearly is not said to be kept.
    let advice = &inspect(&Strange::Power).unwrap().recommended[0];
    assert!(advice.scheme != "sexp" || advice.because.contains("error"));
}

#[test]
fn without_noise_orders_are_those_of_differential_equations() {
    let report = alone(&plane("(x^2 + y^2)/2 + x^4/4", &["0*y"]));
    let orders = ["sexp", "em"].map(|scheme| report.order(scheme));
    assert_eq!(orders, [Some((2.0, 2.0)), Some((1.0, 1.0))]);
}

#[test]
fn an_order_on_special_paths_is_not_told() {
    // The second noise turns one oscillator by what the other does. No path leaves c = d = 0, where
    // the noises commute.
    let energy = "(a^2 + b^2 + c^2 + d^2)/2";
    let noises = ["(a^2 + b^2)/2", "a*(c^2 + d^2)/2"];
    let unexcited = texts("a b c d", &["1 0 0", "0 0", "1"], energy, &noises);
    let known = |y0: [f64; 4]| {
        let report = with(&unexcited, &y0, &constant(0.1));
        assert!(report.noise.commute.fails(), "{report}");
        report.orders[0].known
    };
    assert_eq!(known([1.0, 0.5, 0.0, 0.0]), Status::Unknown);
    assert_eq!(known([1.0, 0.5, 0.1, 0.0]), Status::Holds);
}

#[test]
fn few_equations_make_no_casimir() {
    // B(y) = uwᵀ − wuᵀ of rank two in ten dimensions, u = (y₂², y₃², …), w = (y₁y₄ + 1, …).
    let y = |i: usize| format!("y{}", i % 10);
    let u = |i: usize| format!("{}^2", y(i + 1));
    let w = |i: usize| format!("({}*{}+1)", y(i), y(i + 3));
    let entry = |i: usize, j: usize| format!("{}*{}-{}*{} ", u(i), w(j), w(i), u(j));
    let row = |i: usize| (i + 1..10).map(|j| entry(i, j)).collect::<String>();
    let rows: Vec<String> = (0..9).map(row).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let state: String = (0..10).map(|i| y(i) + " ").collect();
    let casimirs = alone(&texts(&state, &rows, "y0^2 + y1^2", &["y0"])).casimirs.unwrap();
    assert!(casimirs.found.is_empty() && casimirs.complete, "{casimirs:?}");
}

#[test]
fn a_narrow_domain_is_found_around_the_initial_value() {
    let strip = plane("(x^2 + y^2)/2 + ln(9e-4 - (x - 100)^2)", &["y"]);
    let report = with(&strip, &[100.0, 1.0], &constant(0.0));
    assert!(!report.defined_everywhere && report.mistakes.is_empty(), "{report}");
}

#[test]
fn without_damping_there_is_an_energy_to_keep() {
    let pendulum = plane("y^2/2 + x^4", &["0.3*(y^2/2 + x^4)"]);
    let report = |rate| with(&pendulum, &[1.0, 0.5], &constant(rate));
    let (damped, undamped) = (report(0.1), report(0.0));
    assert_eq!(applies(&damped, "energy-balance"), Some(Applies::No), "{damped}");
    assert!(damped.recommended[0].because.contains("but for the noise"));
    assert_eq!(applies(&undamped, "energy-balance"), Some(Applies::Conditionally), "{undamped}");
    assert!(undamped.recommended[0].because.contains("it keeps the energy"));
    assert_eq!([&damped, &undamped].map(|report| report.recommended[0].scheme), ["sexp"; 2]);
    // A rate that is not finite has no order for those who read it.
    let rate = DampingFunction::new(|t: f64| 0.5 / t.sqrt(), 8).unwrap();
    let report = with(&pendulum, &[1.0, 0.5], &rate);
    let orders = ["heun", "sexp"].map(|scheme| report.order(scheme));
    assert_eq!(orders, [None, Some((1.0, 1.0))], "{report}");
    assert_eq!(report.recommended[0].scheme, "sexp");
}

#[test]
fn several_noises_that_are_one_have_an_energy_to_keep() {
    let quartic = |size: f64| format!("{size}*(y^4/2 + x^4/4)");
    let [energy, first, second] = [1.0, 0.5, -0.3].map(quartic);
    let report = alone(&plane(&energy, &[&first, &second]));
    assert_eq!(applies(&report, "energy-balance"), Some(Applies::Yes), "{report}");
    assert_eq!(report.recommended[0].scheme, "sexp");
}
