//! Values, gradients and Hessian products of random expressions against dual numbers of another
//! project. The tolerance is a bound of the round-off of each expression, by `real::Bounded`.

use formula::{Formula, Names};
use num_dual::{Dual64, HyperDual64};
use real::{Bounded, Dual};

use crate::expression::{Expression, Random, VARIABLES, hessian};

/// The order of operations differs from that of the bound, and the oracle rounds too.
const FACTOR: f64 = 16.0;
/// Squares and cubes of intermediate results may underflow, in another order or in the oracle.
const UNDERFLOW: f64 = 1e-50;

/// What was compared and what could not be: not finite, no bound, or next to an edge.
#[derive(Default, Debug)]
struct Seen {
    values: usize,
    slopes: usize,
    products: usize,
    skipped: usize,
    /// Ours is not finite, by an intermediate result that overflows.
    overflows: usize,
}

impl Seen {
    /// Compares one number with its oracle; whether it could.
    fn agrees(&mut self, ours: f64, theirs: f64, bound: Bounded, what: &str) -> bool {
        let tolerance = FACTOR * bound.error + UNDERFLOW;
        let loose = tolerance > 1e-3 * (1.0 + theirs.abs());
        if !theirs.is_finite() || !bound.value.is_finite() || tolerance.is_nan() || loose {
            return false;
        }
        if !ours.is_finite() {
            self.overflows += 1;
            return false;
        }
        let error = (ours - theirs).abs();
        assert!(error <= tolerance, "{what}: {ours:e} for {theirs:e} ± {tolerance:e}");
        true
    }
}

/// Compares everything at a random point; the expression is parsed from its text.
fn check(expression: &Expression, random: &mut Random, seen: &mut Seen) {
    let text = expression.text();
    let names = Names::with_variables(&VARIABLES).unwrap();
    let formula = match Formula::parse(&text, &names) {
        Ok(formula) => formula,
        Err(error) => {
            let constant = ["this is not a finite number", "division by zero"];
            assert!(constant.iter().any(|what| error.message.starts_with(what)), "{text}: {error}");
            seen.skipped += 1;
            return;
        }
    };
    let (x, u) = ([(); 3].map(|()| random.number()), [(); 3].map(|()| random.number()));
    if expression.is_at_an_edge(&x.map(Bounded::variable)) {
        seen.skipped += 1;
        return;
    }
    let what = format!("{text} at {x:?} along {u:?}");
    let bound = expression.value(&x.map(Bounded::variable));
    if !seen.agrees(formula.value(&x), expression.oracle(&x), bound, &what) {
        seen.skipped += 1;
        return;
    }
    seen.values += 1;
    let mut gradient = [0.0; 3];
    formula.gradient(&[0, 1, 2]).evaluate_one(&[&x], &mut gradient);
    let is_piecewise = ["abs", "min", "max"].iter().any(|name| text.contains(name));
    if is_piecewise && gradient.iter().any(|slope| slope.is_nan()) {
        // A piece that is not chosen has no derivative.
        return;
    }
    let mut product = [0.0; 3];
    hessian(&formula).evaluate_one(&[&x, &u], &mut product);
    for i in 0..3 {
        let at = |k: usize| if k == i { 1.0 } else { 0.0 };
        let duals = [0, 1, 2].map(|k| Dual64::new(x[k], at(k)));
        let bounds = [0, 1, 2].map(|k| {
            let [x, one, u] = [x[k], at(k), u[k]].map(Bounded::variable);
            Dual::new(Dual::new(x, one), Dual::new(u, Bounded::exact(0.0)))
        });
        let bound = expression.value::<Dual<Dual<Bounded>>>(&bounds);
        let theirs = expression.oracle(&duals).eps;
        let slope = bound.value.derivative();
        seen.slopes += usize::from(seen.agrees(gradient[i], theirs, slope, &what));
        let hyper = [0, 1, 2].map(|k| HyperDual64::new(x[k], at(k), u[k], 0.0));
        let theirs = expression.oracle(&hyper).eps1eps2;
        let curvature = bound.derivative().derivative();
        seen.products += usize::from(seen.agrees(product[i], theirs, curvature, &what));
    }
}

#[test]
fn random_expressions_agree_with_dual_numbers() {
    let mut random = Random::new(1);
    let mut seen = Seen::default();
    for n in 0..20_000 {
        let expression = Expression::random(&mut random, 1 + n % 5);
        check(&expression, &mut random, &mut seen);
    }
    // Nearly nothing was lost.
    let all = seen.values + seen.slopes + seen.products;
    assert!(seen.overflows < all / 1000 && seen.skipped < seen.values, "{seen:?}");
    assert!(seen.values > 8_000 && seen.slopes > 20_000 && seen.products > 20_000, "{seen:?}");
}
