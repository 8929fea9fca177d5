//! Weak orders, for one test function: 20 000 paths, and from 8 to 256 steps.

use mc::Observable;
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp};
use systems::{PoissonSystem, Problem};
use verify::{ReferenceSolution, StepSizes, weak_order};

use super::{
    Entry, Question, Truth,
    orders::{Uncorrected, order_entry},
    system::{Body, Rate, integrated, kubo, on_sphere},
    truncation,
};

fn entry<S, X, const D: usize, const M: usize>(
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
    let name = format!("{}: {name}", scheme.id());
    let sizes =
        |key| StepSizes { samples: 20_000, refinement: 1, ..StepSizes::new(8, truncation(), key) };
    let phi = Observable { name: "φ", function };
    let measure = move |sizes: &StepSizes| {
        weak_order(&scheme, &problem, phi, sizes, &ReferenceSolution::Independent)
    };
    order_entry(kind, name, Question::WeakOrder, truth, sizes, measure)
}

pub fn entries() -> Vec<Entry> {
    let [one, two] = [1.0, 2.0].map(Some);
    let kubo = |omega, sigma| kubo(omega, sigma, 1.0);
    let q = |y: [f64; 2]| y[0];
    let square = |y: [f64; 2]| y[0] * y[0];
    let idle = on_sphere(Body::top(2.0, 0.0));
    vec![
        entry("one noise", "q of Kubo, ω = σ = 1", Midpoint::default(), kubo(1.0, 1.0), q, one),
        entry("one noise", "q of Kubo, ω = σ = 1", EulerMaruyama, kubo(1.0, 1.0), q, one),
        entry("one noise", "q² of Kubo, ω = σ = 1", Heun, kubo(1.0, 1.0), square, one),
        // The error of order one is of size σ⁴τ, that of order two of size τ².
        entry("weak noise", "q of Kubo, ω = 3, σ = 0.3", Sexp::default(), kubo(3.0, 0.3), q, one),
        // Var Σ τW_n = ⅓ − ½τ + τ²/6.
        entry("additive noise", "(∫W)²", EulerMaruyama, integrated(), square, one),
        // Of the trapezoidal rule, ⅓ − τ²/12.
        entry("additive noise", "(∫W)²", Heun, integrated(), square, two),
        entry("Casimir noise", "y₁ of a top", Sexp::default(), idle.clone(), |y| y[0], two),
        entry("Casimir noise", "y₁ of a top", EulerMaruyama, idle, |y| y[0], one),
        entry("wrong limit", "q of Kubo", Uncorrected, kubo(1.0, 1.0), q, None),
    ]
}
