//! Strong orders, with the defaults of [`StepSizes::new`] and sixteen coarsest steps; and weak
//! orders for one test function, with 20 000 paths and from 8 to 256 steps.
//!
//! The orders are those of the theory: 1 of `sexp`, `midpoint` and `heun` with one noise or several
//! that commute, ½ with others; 1 of `sexp-levy`; ½ of Euler–Maruyama, and 1 with additive noise;
//! without noise that acts, those of the schemes for ordinary equations. They are limits as τ → 0.

use std::fmt::Display;

use analysis::{Decision, Order, StepSizes, strong_order, weak_order};
use mc::{Observable, Setup};
use noise::StreamKey;
use schemes::{EulerMaruyama, Explicit, Heun, Increment, Midpoint, Scheme, Sexp, SexpLevy};
use systems::{PoissonSystem, Problem};

use super::{
    Entry, Question, Stated, Truth, refused,
    system::{
        Body, Plane, Rate, START, UNDAMPED, damped_kubo, growth, integrated, kubo, on_sphere,
        planes, problem,
    },
    truncation,
};

/// Euler's scheme without the Itô correction: it converges to the Itô solution.
#[derive(Clone, Copy)]
struct Uncorrected;

impl Explicit for Uncorrected {
    const ID: &'static str = "uncorrected";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let step = h.step();
        y + (h.field(y) - y * (step.rate_at_start * step.tau))
    }
}

/// A question about an order, which is measured on these step sizes.
fn order_entry<E: Display>(
    kind: &'static str,
    name: String,
    question: Question,
    truth: Truth,
    sizes: impl Fn(StreamKey) -> StepSizes + Send + Sync + 'static,
    measure: impl Fn(&StepSizes) -> Result<Order, E> + Send + Sync + 'static,
) -> Entry {
    let ask = move |key: StreamKey| {
        let sizes = sizes(key);
        let order = match measure(&sizes) {
            Ok(order) => order,
            Err(error) => return refused(error),
        };
        let stated = match order.decision {
            Decision::Order { order, .. } => Stated::Interval(order, order),
            Decision::WrongLimit => Stated::NoOrder,
            decision => Stated::Undecided(decision.to_string()),
        };
        (stated, sizes.samples * 2 * sizes.reference_steps())
    };
    Entry::new(kind, name, question, truth, ask)
}

fn strong<S, X, const D: usize, const M: usize>(
    kind: &'static str,
    name: &str,
    scheme: X,
    problem: Problem<S, Rate, D>,
    truth: Truth,
) -> Entry
where
    S: PoissonSystem<D, M> + 'static,
    X: Scheme<S, D, M> + 'static,
{
    let name = format!("{}: {name}", scheme.about().id);
    let sizes = |key| StepSizes::new(16, truncation(), key);
    let measure = move |sizes: &StepSizes| strong_order(&Setup::of(&problem, &scheme), sizes);
    order_entry(kind, name, Question::StrongOrder, truth, sizes, measure)
}

fn weak<S, X, const D: usize, const M: usize>(
    kind: &'static str,
    name: &str,
    scheme: X,
    problem: Problem<S, Rate, D>,
    function: fn([f64; D]) -> f64,
    truth: Truth,
) -> Entry
where
    S: PoissonSystem<D, M> + 'static,
    X: Scheme<S, D, M> + 'static,
{
    let name = format!("{}: {name}", scheme.about().id);
    let sizes =
        |key| StepSizes { samples: 20_000, refinement: 1, ..StepSizes::new(8, truncation(), key) };
    let phi = Observable { name: "φ", function };
    let measure =
        move |sizes: &StepSizes| weak_order(&Setup::of(&problem, &scheme), &phi, sizes, None);
    order_entry(kind, name, Question::WeakOrder, truth, sizes, measure)
}

pub fn entries() -> Vec<Entry> {
    let (sexp, midpoint, em) = (Sexp, Midpoint, EulerMaruyama);
    let [half, one, two] = [0.5, 1.0, 2.0].map(Some);
    let kubo = |omega, sigma| kubo(omega, sigma, 1.0);
    let damped = |rate| damped_kubo(1.0, 1.0, rate, 1.0);
    let additive = |a, b, rate| problem(Plane::additive(a, b), rate, [1.0, 0.0], 1.0);
    let growth = growth(UNDAMPED);
    let planes = planes([1.0, -2.0], [[1.0, 0.5], [0.3, -0.6]]);
    let leaning = |angle: f64| Body {
        a: [1.0, 0.5, 1.0 / 3.0],
        ..Body::linear([[0.0, 0.0, 1.0], [angle, 0.0, 1.0]])
    };
    let idle = on_sphere(Body::top(2.0, 0.0));
    let body = |angle| on_sphere(leaning(angle));
    let sphere = on_sphere(Body::isotropic(0.6));
    let levy = SexpLevy::new(&leaning(1.0), START);
    let (q, first) = (|y: [f64; 2]| y[0], |y: [f64; 3]| y[0]);
    let square = |y: [f64; 2]| y[0] * y[0];
    vec![
        strong("one noise", "Kubo, ω = σ = 1", sexp, kubo(1.0, 1.0), one),
        strong("one noise", "Kubo, ω = σ = 1", em, kubo(1.0, 1.0), half),
        strong("one noise", "geometric", Heun, growth.clone(), one),
        strong("damping", "Kubo, γ jumps", sexp, damped(Rate::JUMP), one),
        strong("weak noise", "Kubo, ω = 1, σ = 1e-3", sexp, kubo(1.0, 1e-3), one),
        strong("additive noise", "oscillator", em, additive(1.0, 1.0, UNDAMPED), one),
        strong("commuting noises", "two planes", sexp, planes.clone(), one),
        strong("other noises", "body, 1 rad apart", sexp, body(1.0), half),
        strong("other noises", "body, 1 rad apart", levy, body(1.0), one),
        strong("nearly commuting", "body, 0.03 rad apart", sexp, body(0.03), half),
        strong("Casimir noise", "top, H₁ = |y|²", sexp, idle.clone(), two),
        strong("wrong limit", "Kubo", Uncorrected, kubo(1.0, 1.0), None),
        strong("wrong limit", "sphere", Uncorrected, sphere, None),
        weak("one noise", "q of Kubo, ω = σ = 1", midpoint, kubo(1.0, 1.0), q, one),
        // Var Σ τW_n = ⅓ − ½τ + τ²/6.
        weak("additive noise", "(∫W)²", em, integrated(), square, one),
        // Of the trapezoidal rule, ⅓ − τ²/12.
        weak("additive noise", "(∫W)²", Heun, integrated(), square, two),
        weak("Casimir noise", "y₁ of a top", em, idle, first, one),
        weak("wrong limit", "q of Kubo", Uncorrected, kubo(1.0, 1.0), q, None),
    ]
}
