//! Without noise `sexp`, `sexp-li`, `midpoint`, `split` and `heun` have order two and `em` order
//! one, with damping, on every system; and damping at the wrong time has order one.

use crate::common::{Visit, body, every_system, schemes_of};
use kernels::Tuned;
use noise::Noise;
use schemes::{BuiltIn, Heun, Midpoint, Scheme, Sexp, Step};
use systems::{Damping, Flows, MaxwellBloch, PoissonSystem, Sine, ito_correction, vector_field};

const T: f64 = 1.0;
/// Errors behave like cτᵖ(1 + dτ): between τ = 2⁻⁷ and 2⁻⁸ the observed order is p + dτ/ln 4, off
/// by 0.1 when the remainder is d = 18, and by 1 when the order is wrong.
const WINDOW: f64 = 0.1;
const EXPONENTS: [i32; 2] = [7, 8];

fn damping() -> Sine {
    // γ(0) and γ(T) differ, so that a splitting that is wrong at both ends does not cancel.
    Sine::new(1.5, 1.3).unwrap()
}

/// y(T) by `advance`, with 2^exponent steps.
fn march<const D: usize>(
    y0: [f64; D],
    exponent: i32,
    advance: impl Fn(&Step, [f64; D]) -> [f64; D],
) -> [f64; D] {
    let tau = T / 2f64.powi(exponent);
    (0..1 << exponent).fold(y0, |y, n| advance(&Step::new(&damping(), n, tau).unwrap(), y))
}

/// y(T) by the classical Runge–Kutta scheme with 2¹⁰ steps, error of order 10⁻¹²; with the Itô
/// correction of the drift for `em`, which integrates another equation when the noise is switched
/// off.
fn reference<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y0: [f64; D],
    corrected: bool,
) -> [f64; D] {
    let slope = |t: f64, y: [f64; D]| -> [f64; D] {
        let field = vector_field(system, y, 1.0, [0.0; M]);
        let correction = ito_correction(system, y);
        std::array::from_fn(|i| {
            field[i] - damping().rate(t) * y[i] + if corrected { correction[i] } else { 0.0 }
        })
    };
    let plus = |y: [f64; D], h: f64, k: [f64; D]| std::array::from_fn(|i| y[i] + h * k[i]);
    let h = T / 1024.0;
    (0..1024).fold(y0, |y, n| {
        let t = f64::from(n) * h;
        let k1 = slope(t, y);
        let k2 = slope(t + 0.5 * h, plus(y, 0.5 * h, k1));
        let k3 = slope(t + 0.5 * h, plus(y, 0.5 * h, k2));
        let k4 = slope(t + h, plus(y, h, k3));
        std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    })
}

fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// log₂ of the ratio of the errors at the two step sizes.
fn order<const D: usize>(
    y0: [f64; D],
    exact: [f64; D],
    advance: impl Fn(&Step, [f64; D]) -> [f64; D],
) -> f64 {
    let [coarse, fine] = EXPONENTS.map(|exponent| distance(march(y0, exponent, &advance), exact));
    (coarse / fine).log2()
}

/// Whether an observed order may be this one.
fn in_window(observed: f64, order: f64) -> bool {
    (observed - order).abs() < WINDOW
}

struct Orders;

impl Visit for Orders {
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]) {
        use BuiltIn::{EulerMaruyama, Heun, Midpoint, Sexp, SexpLi, Split};
        let schemes = [Sexp, Midpoint, Heun, SexpLi, Split, EulerMaruyama];
        for scheme in schemes_of(&schemes, system, y0) {
            let (name, is_em) = (system.name(), scheme.about().id == "em");
            let observed = order(y0, reference(system, y0, is_em), |step, y| {
                scheme.step(system, step, &Noise::increments([0.0; M]), y).z
            });
            let expected = if is_em { 1.0 } else { 2.0 };
            assert!(in_window(observed, expected), "{} on {name}: {observed}", scheme.about().id);
        }
    }
}

#[test]
fn deterministic_orders() {
    every_system(&mut Orders);
}

#[test]
fn damping_at_the_wrong_time_has_order_one() {
    let y0 = [1.1f64.cos(), 0.0, 1.1f64.sin()];
    let exact = reference(&body(), y0, false);
    type Wrong = fn(&mut Step);
    let cases: [(&dyn Scheme<_, 3, 3>, Wrong); 3] = [
        // Both halves before the step: it keeps the conformal law, so only the order tells.
        (&Sexp, |step| {
            step.first_decay *= step.second_decay;
            step.second_decay = 1.0;
        }),
        // The rate of the midpoint rule, or of the corrector of Heun, at the start of the step.
        (&Midpoint, |step| step.rate_at_middle = step.rate_at_start),
        (&Heun, |step| step.rate_at_end = step.rate_at_start),
    ];
    for (scheme, wrong) in cases {
        let observed = order(y0, exact, |step, y| {
            let mut step = *step;
            wrong(&mut step);
            scheme.step(&body(), &step, &Noise::increments([0.0; 3]), y).z
        });
        assert!(in_window(observed, 1.0), "{}: {observed}", scheme.about().id);
    }
    // Flows in a row, and not there and back.
    let y0 = [1.0, 2.0, 3.0];
    let in_a_row = order(y0, reference(&MaxwellBloch, y0, false), |step, y| {
        let damped = y.map(|x| x * step.first_decay);
        let flow = |y, part| MaxwellBloch.flow(part, y, step.tau, [0.0]);
        (0..2).fold(damped, flow).map(|x| x * step.second_decay)
    });
    assert!(in_window(in_a_row, 1.0), "{in_a_row}");
}
