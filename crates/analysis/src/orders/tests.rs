//! The arithmetic of orders, and what is decided, on numbers that are made up.

use noise::{BlockNoise, Noise, StreamKey, Truncation};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, Real, WIDTH};
use schemes::{About, Scheme, Step};
use stats::{CrossMoments, Rate};
use systems::PoissonSystem;

use super::{
    Decision, Limit, More, OneStep, Order, StepSizes,
    decision::{self, undecided},
    wrong_limit,
};

const AGREES: Limit = Limit::Agrees { distance: 1e-3 };

fn rate(estimate: f64, lo: f64, hi: f64) -> Rate {
    // At the confidence of a contradiction already, so that nothing is widened.
    Rate { estimate, lo, hi, confidence: 0.999, ..Rate::default() }
}

fn one_step(order: f64) -> Option<OneStep> {
    Some(OneStep { order, tau: 1e-6, amplification: 16.0, mean: None })
}

#[test]
fn one_step_of_integer_order_leaves_two_orders_possible() {
    let orders = |order: f64| one_step(order).unwrap().strong_orders().collect::<Vec<_>>();
    assert_eq!(orders(1.0), [0.5]);
    assert_eq!(orders(1.5), [1.0]);
    assert_eq!(orders(2.0), [1.0, 1.5]);
    assert_eq!(orders(3.0), [2.0, 2.5]);
    let known = |mean: f64| OneStep { mean: Some(mean), ..one_step(2.0).unwrap() };
    assert_eq!(known(2.0).strong_orders().collect::<Vec<_>>(), [1.0]);
    assert_eq!(known(3.0).strong_orders().collect::<Vec<_>>(), [1.5]);
}

/// The order, whether the points show it, or what would decide.
fn told(decision: &Decision) -> Result<(f64, bool), Option<More>> {
    match decision {
        Decision::Order { order, shown } => Ok((*order, *shown)),
        Decision::Undecided { more, .. } => Err(Some(*more)),
        _ => Err(None),
    }
}

#[test]
fn a_strong_order_is_named_where_one_is_left_that_the_points_do_not_exceed() {
    let of = |lo: f64, hi: f64, step: f64| {
        told(&decision::strong(Some(&rate(0.5 * (lo + hi), lo, hi)), one_step(step), AGREES))
    };
    let finer = Err(Some(More::Steps));
    assert_eq!(of(0.9, 1.1, 1.5), Ok((1.0, true)));
    // The points fall faster still, or too slowly for the order of one step.
    assert_eq!((of(1.2, 1.4, 1.5), of(0.7, 0.9, 1.5)), (Ok((1.0, false)), finer));
    // Of orders one and 1½ the points leave one, or both.
    assert_eq!((of(0.9, 1.1, 2.0), of(1.3, 1.6, 2.0)), (Ok((1.0, true)), finer));
    assert_eq!(told(&decision::strong(Some(&rate(1.0, 0.9, 1.1)), None, AGREES)), finer);
}

#[test]
fn nothing_is_named_without_a_good_fit_and_a_limit() {
    let of = |rate: Option<&Rate>, limit: Limit| {
        let strong = decision::strong(rate, one_step(1.5), limit);
        assert_eq!(decision::weak(rate, |_| Some(0.0), limit), strong);
        told(&strong)
    };
    let good = rate(1.0, 0.9, 1.1);
    let [paths, steps] = [More::Paths, More::Steps].map(|more| Err(Some(more)));
    let differs = Limit::Differs { distance: 1.0 };
    assert_eq!((of(Some(&good), differs), of(None, differs)), (Err(None), Err(None)));
    assert_eq!((of(Some(&good), AGREES), of(None, AGREES)), (Ok((1.0, true)), paths));
    for limit in [Limit::Unclear { distance: 1.0 }, Limit::Unchecked] {
        assert_eq!(of(Some(&good), limit), steps);
    }
    assert_eq!(of(Some(&Rate { p_value: Some(1e-6), ..good.clone() }), AGREES), steps);
    // An interval of ½ is narrow enough; one twice as wide takes four times as many paths.
    assert_eq!(of(Some(&rate(1.0, 0.75, 1.25)), AGREES), Ok((1.0, true)));
    assert_eq!(of(Some(&rate(1.0, f64::NAN, 1.5)), AGREES), paths);
    let wide = decision::strong(Some(&rate(1.0, 0.5, 1.5)), one_step(1.5), AGREES);
    assert!(wide.to_string().contains("4 times as many paths"), "{wide}");
}

#[test]
fn a_weak_order_above_one_may_hide_a_lower_one() {
    let of = |lo: f64, hi: f64, share: Option<f64>| {
        told(&decision::weak(Some(&rate(lo, lo, hi)), |_| share, AGREES))
    };
    let [paths, steps] = [More::Paths, More::Steps].map(|more| Err(Some(more)));
    assert_eq!(of(1.9, 2.1, Some(0.1)), Ok((2.0, false)));
    assert_eq!((of(1.9, 2.1, Some(0.11)), of(1.9, 2.1, None)), (paths, paths));
    // Nothing is lower than one, whatever its share.
    assert_eq!(of(0.9, 1.1, Some(1.0)), Ok((1.0, true)));
    // Between the orders, or none of them.
    assert_eq!((of(1.4, 1.6, Some(0.0)), of(4.1, 4.3, Some(0.0))), (steps, steps));
    assert_eq!(of(3.9, 4.1, Some(0.0)), Ok((4.0, false)));
}

#[test]
fn a_decision_settles_the_interval_or_warns() {
    let mut fitted = rate(1.3, 1.2, 1.4);
    let mut settled = |decision: Decision| {
        let mut order = Order { rate: Some(fitted.clone()), ..order(decision, AGREES) };
        order.settle();
        fitted = order.rate.unwrap();
        fitted.clone()
    };
    let named = settled(Decision::Order { order: 1.0, shown: false });
    assert_eq!((named.lo, named.hi, named.warning), (1.0, 1.4, None));
    let named = settled(Decision::Order { order: 1.5, shown: false });
    assert_eq!((named.lo, named.hi), (1.0, 1.5));
    let first = settled(undecided(More::Paths, "why")).warning.unwrap();
    assert_eq!(first, "undecided: why; more paths would decide");
    let both = settled(Decision::WrongLimit).warning;
    assert_eq!(both, Some(format!("{first}; {}", Decision::WrongLimit)));
}

fn order(decision: Decision, limit: Limit) -> Order {
    let one_step = one_step(1.5);
    Order {
        points: Vec::new(),
        rate: Some(rate(1.25, 1.0, 1.5)),
        one_step,
        limit,
        decision,
        failed: 0,
    }
}

#[test]
fn an_order_says_what_it_rests_on() {
    let shown = order(Decision::Order { order: 1.0, shown: true }, AGREES);
    let fitted = "fitted 1.25 [1.00, 1.50]";
    let agrees = "at most 1.0e-3 from the reference";
    assert_eq!(shown.to_string(), format!("order 1; {fitted}; {agrees}"));
    assert_eq!(shown.order(), Some(1.0));
    let hidden = order(Decision::Order { order: 1.0, shown: false }, AGREES);
    let still = "shown by one step at τ = 1e-6 and 16 times the noise";
    let text = format!("order 1; {fitted}; {still}; {agrees}");
    assert_eq!(hidden.to_string(), text);
    let failed = Order { failed: 3, ..hidden };
    assert_eq!(failed.to_string(), format!("{text}; 3 paths failed and are left out"));
    let wrong = order(Decision::WrongLimit, Limit::Differs { distance: 0.5 });
    assert!(wrong.to_string().ends_with("; 5.0e-1 from the reference"), "{wrong}");
    assert_eq!(wrong.order(), None);
}

#[test]
fn step_sizes_halve_down_to_the_reference() {
    let key = StreamKey { seed: 1, experiment: 1 };
    let sizes = StepSizes { levels: 3, ..StepSizes::new(5, Truncation::none(), key) };
    assert_eq!((sizes.reference_steps(), sizes.sizes()), (80, 5));
    assert_eq!([0, 1, 2].map(|index| sizes.level(index)), [4, 3, 2]);
    assert_eq!(sizes.taus(2.0), [5.0, 10.0, 20.0, 40.0, 80.0].map(|steps| 2.0 / steps));
    // One run at the finest size and its halves: twice the reference.
    assert_eq!(sizes.cost(), 160 * sizes.samples);
    let allowed = |sizes: StepSizes| sizes.check(1).is_ok();
    assert!(
        allowed(sizes.clone())
            && allowed(StepSizes { levels: 46, coarsest_steps: 1, ..sizes.clone() })
    );
    assert!(!allowed(StepSizes { levels: 47, coarsest_steps: 1, ..sizes.clone() }));
    assert!(!allowed(StepSizes { levels: 0, ..sizes.clone() }));
    assert!(!allowed(StepSizes { coarsest_steps: 0, ..sizes.clone() }));
    // Sixteen times as many steps, and twice that, fit 64 bits.
    assert!(allowed(StepSizes { coarsest_steps: 1 << 58, ..sizes.clone() }));
    assert!(!allowed(StepSizes { coarsest_steps: 1 << 59, ..sizes.clone() }));
    assert!(sizes.check(5).is_ok() && sizes.check(6).is_err());
}

#[test]
fn a_limit_is_wrong_where_most_of_the_error_does_not_shrink() {
    // Squares c + a·4^{2 − l} against the solution at l = 0, 1, 2, and of the last difference.
    let of = |c: f64, a: f64, own: f64| {
        let (mut errors, mut differences) = (CrossMoments::new(3), CrossMoments::new(2));
        for path in 0..100 {
            let size = if path % 2 == 0 { 1.001 } else { 0.999 };
            errors.add(&[16.0, 4.0, 1.0].map(|growth| size * (c + a * growth)));
            differences.add(&[4.0 * own, own].map(|square| size * square));
        }
        wrong_limit(&errors, &differences)
    };
    // Squares that fall like τ, by four in two halvings, leave the constant (4·near − far)/3.
    let near = |found: Option<f64>| found.is_some_and(|distance| (distance - 1.0).abs() < 1e-3);
    assert!(near(of(1.0, 0.0, 0.01)));
    // The root of the square of near is compared with 4.84 times that of the last difference.
    assert!(near(of(1.0, 0.0, 0.0425)) && of(1.0, 0.0, 0.043).is_none());
    // That is c − 4a, above half of near = c + a for a below c/9.
    assert!(near(of(0.901, 0.099, 0.01)) && of(0.899, 0.101, 0.01).is_none());
    assert_eq!(wrong_limit(&CrossMoments::new(1), &CrossMoments::new(0)), None);
}

/// A field (1, 0), for time and for noise.
pub struct Anything;

impl PoissonSystem<2, 1> for Anything {
    fn name(&self) -> &'static str {
        "anything"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        v
    }
    fn energy<R: Real>(&self, y: [R; 2], _dt: f64, _dw: [f64; 1]) -> R {
        y[0]
    }
}

/// A step as a function of t, τ, ΔW and y; it fails where that is NaN.
pub struct Single(pub fn(f64, f64, f64, [f64; 2]) -> [f64; 2]);

impl Scheme<Anything, 2, 1> for Single {
    fn about(&self) -> About {
        About::new("single")
    }
    fn step_block(
        &self,
        system: &Anything,
        step: &Step,
        noise: &BlockNoise<1>,
        y: &mut Block<2>,
        status: &mut BlockStatus,
    ) {
        *status = BlockStatus::explicit();
        for p in 0..WIDTH {
            let Solution { z, outcome } = self.step(system, step, &noise.path(p), y.path(p));
            y.set_path(p, z);
            status.set(p, outcome);
        }
    }
    fn step(&self, _: &Anything, step: &Step, noise: &Noise<1>, y: [f64; 2]) -> Solution<2> {
        let z = (self.0)(step.t, step.tau, noise.increments[0], y);
        Solution { z, outcome: Outcome::Fast { iterations: 1 } }.checked()
    }
}
