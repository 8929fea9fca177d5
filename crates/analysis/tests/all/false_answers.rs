//! What `inspect` once said falsely, each with what it must not say again.

use analysis::inspect::{Applies, InspectSettings, Inspection, Status};
use formula::Definition;
use real::Real;
use systems::{Damping, DampingFunction, PoissonSystem, Problem, SystemError};

use super::{applies, constant, inspect_alone as inspect, inspect_problem, system, texts};

/// The report on texts alone.
fn alone(definition: &Definition) -> Inspection {
    let y0 = vec![1.0; definition.state.len()];
    analysis::inspect(&system(definition, &y0), &InspectSettings::default()).unwrap()
}

/// The report on texts from an initial value, with damping on [0, 1].
fn with(definition: &Definition, y0: &[f64], damping: &dyn Damping) -> Inspection {
    let settings =
        InspectSettings { y0: Some(y0.to_vec()), damping: Some((damping, 1.0)), areas: false };
    analysis::inspect(&system(definition, y0), &settings).unwrap()
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

/// A rate and its integral, with a factor that makes it wrong.
struct Given<R, I>(R, I, f64);

impl<R: Fn(f64) -> f64 + Send + Sync, I: Fn(f64) -> f64 + Send + Sync> Damping for Given<R, I> {
    fn rate(&self, t: f64) -> f64 {
        (self.0)(t)
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        self.2 * ((self.1)(b) - (self.1)(a))
    }
    fn describe(&self) -> String {
        "given".to_owned()
    }
}

/// A pulse of the rate `height` from `start` on, of this width, with its integral.
fn pulse(start: f64, width: f64, height: f64) -> impl Damping {
    let inside = move |t: f64| t >= start && t < start + width;
    let rate = move |t: f64| if inside(t) { height } else { 0.0 };
    Given(rate, move |t: f64| height * (t - start).clamp(0.0, width), 1.0)
}

fn integral(damping: impl Damping) -> analysis::inspect::DampingIntegral {
    let oscillator = plane("(x^2 + y^2)/2", &[]);
    with(&oscillator, &[1.0, 1.0], &damping).problem.unwrap().integral
}

#[test]
fn a_pulse_that_a_quadrature_misses_is_seen_and_its_integral_is_no_mistake() {
    for (start, width) in [(0.37, 1e-4), (0.123_456, 1e-3), (0.5, 0.01), (0.6123, 0.3)] {
        let height = 1.5 / width;
        let right = integral(pulse(start, width, height));
        assert_eq!(right.agrees, Status::Holds, "{start} {width}: {right}");
        let pulse = pulse(start, width, height);
        let missed = integral(DampingFunction::new(move |t| pulse.rate(t), 8).unwrap());
        assert_eq!(missed.agrees, Status::Unknown, "{start} {width}: {missed}");
        assert!((missed.expected - 1.5).abs() < 1e-9, "{missed}");
        assert!(missed.to_string().contains("DISAGREE"));
    }
}

#[test]
fn what_the_quadrature_misses_is_no_mistake() {
    // Pulses far narrower than the distance of the nodes.
    for width in [1e-6, 1e-7, 1e-8, 1e-9, 1e-12] {
        let found = integral(pulse(0.371_23, width, 1.5 / width));
        assert_ne!(found.agrees, Status::Fails, "{width}: {found}");
        assert!(width < 1e-8 || found.agrees == Status::Holds, "{width}: {found}");
    }
    // Oscillations faster than the nodes.
    for frequency in [1e4, 1e5, 1e6, 1e8] {
        let found = integral(systems::Cosine::new(1.0, frequency).unwrap());
        assert_ne!(found.agrees, Status::Fails, "{frequency}: {found}");
        assert!(frequency > 1e5 || found.agrees == Status::Holds, "{frequency}: {found}");
    }
    for periods in [4.0, 1024.0, 3000.0, 1e5] {
        let on = move |t: f64| if (t * periods).fract() < 0.5 { 2.0 } else { 0.0 };
        let until = move |t: f64| {
            let x = t * periods;
            (x.floor() + (2.0 * x.fract()).min(1.0)) / periods
        };
        let found = integral(Given(on, until, 1.0));
        assert_ne!(found.agrees, Status::Fails, "{periods}: {found}");
    }
    // Kicks that no rate shows.
    let kicks = integral(Given(|_| 1.0, |t: f64| t + 0.1 * (t * 777.7).floor(), 1.0));
    assert_eq!(kicks.agrees, Status::Unknown, "{kicks}");
}

#[test]
fn a_wrong_integral_is_still_a_mistake() {
    let wrong = Given(|t: f64| 2.0 * t, |t: f64| 0.5 * t * t, 1.0);
    let report = with(&plane("(x^2 + y^2)/2", &[]), &[1.0, 0.0], &wrong);
    assert_eq!(report.mistakes.len(), 1);
    assert!(report.mistakes[0].contains("integral of the damping"), "{report}");

    for factor in [1.01, 1.0 + 1e-5, 0.0, -1.0] {
        let smooth = integral(Given(|t: f64| 1.0 + t * t, |t: f64| t + t * t * t / 3.0, factor));
        assert_eq!(smooth.agrees, Status::Fails, "{factor}: {smooth}");
        let wave =
            integral(Given(|t: f64| (30.0 * t).cos(), |t: f64| (30.0 * t).sin() / 30.0, factor));
        assert_eq!(wave.agrees, Status::Fails, "{factor}: {wave}");
    }
    let nothing = integral(Given(|_| 0.0, |t: f64| t, 1.0));
    assert_eq!(nothing.agrees, Status::Fails, "{nothing}");
    let nowhere = integral(Given(|t: f64| if t > 0.5 { f64::NAN } else { 1.0 }, |t: f64| t, 1.0));
    assert_eq!(nowhere.agrees, Status::Fails, "{nowhere}");
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

/// A domain that is a narrow strip.
#[derive(Clone)]
struct Strip;

impl PoissonSystem<2, 1> for Strip {
    fn name(&self) -> &'static str {
        "strip"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * dt) + y[1] * dw[0]
    }
    fn check_domain(&self, y: [f64; 2]) -> Result<(), SystemError> {
        let inside = (y[0] - 100.0).abs() < 0.03;
        let outside = SystemError::OutsideDomain { component: 1, value: y[0], domain: "a strip" };
        if inside { Ok(()) } else { Err(outside) }
    }
}

#[test]
fn a_narrow_domain_is_found_around_the_initial_value() {
    let problem = Problem::new(Strip, constant(0.0), [100.0, 1.0], 1.0).unwrap();
    let report = inspect_problem(&problem).unwrap();
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
    let report = with(&pendulum, &[1.0, 0.5], &Given(|t: f64| 0.5 / t.sqrt(), f64::sqrt, 1.0));
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
