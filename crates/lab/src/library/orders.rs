//! Strong orders, with the defaults of [`StepSizes::new`] and sixteen coarsest steps.
//!
//! The orders are those of the theory: 1 of `sexp`, `midpoint` and `heun` with one noise or several
//! that commute, ½ with others; 1 of `sexp-levy`; ½ of Euler–Maruyama, and 1 with additive noise;
//! without noise that acts, those of the schemes for ordinary equations. They are limits as τ → 0.

use std::fmt::Display;

use noise::StreamKey;
use schemes::{EulerMaruyama, Explicit, Heun, Increment, Midpoint, Scheme, Sexp, SexpLevy};
use systems::{PoissonSystem, Problem};
use verify::{Decision, Order, StepSizes, strong_order};

use super::{
    Answer, Entry, OldRule, Question, Stated, Truth,
    system::{
        Body, Plane, Rate, START, UNDAMPED, damped_kubo, growth, kubo, on_sphere, planes, problem,
    },
    truncation,
};

/// Euler's scheme without the Itô correction: it converges to the Itô solution.
#[derive(Clone, Copy)]
pub struct Uncorrected;

impl Explicit for Uncorrected {
    const ID: &'static str = "uncorrected";

    #[inline(always)]
    fn advance<H: Increment>(&self, h: H, y: H::Vector) -> H::Vector {
        let step = h.step();
        y + (h.field(y) - y * (step.rate_at_start * step.tau))
    }
}

/// Path-steps of a scheme at all step sizes of these.
pub fn cost(sizes: &StepSizes) -> u64 {
    sizes.samples * 2 * sizes.reference_steps()
}

/// A question about an order, which is measured on these step sizes.
pub fn order_entry<E: Display>(
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
            Err(error) => return Answer::refused(error),
        };
        let stated = match order.decision {
            Decision::Order { order, .. } => Stated::order(order),
            Decision::WrongLimit => Stated::NoOrder,
            decision => Stated::undecided(decision),
        };
        let slope = match order.rate {
            Some(rate) => Stated::order(0.5 * (2.0 * rate.estimate).round()),
            None => Stated::undecided("no slope"),
        };
        Answer { stated, old: Some(slope), cost: cost(&sizes) }
    };
    Entry::new(kind, name, question, truth, Some(OldRule::FittedSlope), ask)
}

fn entry<S, X, const D: usize, const M: usize>(
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
    let name = format!("{}: {name}", scheme.id());
    let slow = scheme.reads_areas();
    let sizes = |key| StepSizes::new(16, truncation(), key);
    let measure = move |sizes: &StepSizes| strong_order(&scheme, &problem, sizes);
    Entry { slow, ..order_entry(kind, name, Question::StrongOrder, truth, sizes, measure) }
}

pub fn entries() -> Vec<Entry> {
    let (sexp, midpoint, em) = (Sexp::default(), Midpoint::default(), EulerMaruyama);
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
    let top = on_sphere(Body::top(0.0, 1.4));
    let idle = on_sphere(Body::top(2.0, 0.0));
    let body = |angle| on_sphere(leaning(angle));
    let sphere = on_sphere(Body::isotropic(0.6));
    let levy = SexpLevy::new(&leaning(1.0), START);
    vec![
        entry("one noise", "Kubo, ω = σ = 1", sexp, kubo(1.0, 1.0), one),
        entry("one noise", "Kubo, ω = σ = 1", midpoint, kubo(1.0, 1.0), one),
        entry("one noise", "Kubo, ω = σ = 1", Heun, kubo(1.0, 1.0), one),
        entry("one noise", "Kubo, ω = σ = 1", em, kubo(1.0, 1.0), half),
        entry("one noise", "geometric", Heun, growth.clone(), one),
        entry("one noise", "geometric", em, growth.clone(), half),
        entry("one noise", "time change of a top", sexp, top.clone(), one),
        entry("one noise", "time change of a top", em, top, half),
        entry("damping", "Kubo, γ = 20", sexp, damped(Rate::Constant(20.0)), one),
        entry("damping", "Kubo, γ jumps", sexp, damped(Rate::JUMP), one),
        entry("damping", "Kubo, γ jumps", em, damped(Rate::JUMP), half),
        entry("weak noise", "Kubo, ω = 6, σ = 0.1", sexp, kubo(6.0, 0.1), one),
        entry("weak noise", "Kubo, ω = 1, σ = 1e-3", sexp, kubo(1.0, 1e-3), one),
        entry("weak noise", "Kubo, ω = 1, σ = 0.03", em, kubo(1.0, 0.03), half),
        entry("additive noise", "oscillator", sexp, additive(1.0, 1.0, UNDAMPED), one),
        entry("additive noise", "oscillator", em, additive(1.0, 1.0, UNDAMPED), one),
        entry("additive noise", "integrated", Heun, additive(0.0, 1.0, UNDAMPED), one),
        entry("additive noise", "Langevin", sexp, additive(2.0, 2.0, Rate::Constant(0.7)), one),
        entry("commuting noises", "two planes", sexp, planes.clone(), one),
        entry("commuting noises", "two planes", em, planes, half),
        entry("other noises", "body, 1 rad apart", sexp, body(1.0), half),
        entry("other noises", "body, 1 rad apart", Heun, body(1.0), half),
        entry("other noises", "body, 1 rad apart", em, body(1.0), half),
        entry("other noises", "body, 1 rad apart", levy, body(1.0), one),
        entry("other noises", "sphere", sexp, sphere.clone(), half),
        entry("nearly commuting", "body, 0.03 rad apart", sexp, body(0.03), half),
        entry("nearly commuting", "body, 0.2 rad apart", midpoint, body(0.2), half),
        entry("Casimir noise", "top, H₁ = |y|²", sexp, idle.clone(), two),
        entry("Casimir noise", "top, H₁ = |y|²", em, idle, one),
        entry("wrong limit", "Kubo", Uncorrected, kubo(1.0, 1.0), None),
        entry("wrong limit", "geometric", Uncorrected, growth, None),
        entry("wrong limit", "sphere", Uncorrected, sphere, None),
    ]
}
