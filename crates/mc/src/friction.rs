//! Friction on single components of the state.

use std::sync::{Arc, OnceLock};

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, elementary::exp, golden};
use schemes::{About, Listing, Method, Step, Stepper};
use systems::Damping;

use crate::{Coefficients, ConformalLaw, Problem, Setup, ladder::driver::all_finite};

/// Friction −γ(t)yᵢ on some components i, besides the damping of all of them: with several, and
/// the damping γ₀ of the problem, dy = (B∇H₀ − Γy)dt + Σ B∇Hₘ ∘ dWₘ with Γ = diag(γ₀ + γ₁, …).
///
/// Every scheme takes it exactly, in two halves of a step around its own step, so that orders one
/// and weak order two remain. ∫γ over the halves is that of [`Damping::integral`].
///
/// ```
/// use std::sync::Arc;
/// use mc::{Friction, Setup};
/// use schemes::Sexp;
/// use systems::{Constant, MaxwellBloch, Problem};
///
/// // Without field the polarisation decays with its own rate.
/// let problem = Problem::new(MaxwellBloch, Constant::new(0.0)?, [0.0, 1.0, 0.0], 2.0)?;
/// let friction = [Friction { damping: Arc::new(Constant::new(0.5)?), components: vec![1, 2] }];
/// let setup = Setup::of(&problem, &Sexp).with_friction(&friction);
/// // The Casimir ½(y₂² + y₃²) decays with both of its components.
/// assert!((setup.problem.laws[0].decay(&[0.0, 1.0]) - (-2f64).exp()).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Friction {
    /// The damping γ.
    pub damping: Arc<dyn Damping>,
    /// The components, counted from zero.
    pub components: Vec<usize>,
}

impl Friction {
    /// The rates and components, as schemes take them that have friction inside.
    pub fn inside(friction: &[Self]) -> Vec<(Arc<dyn Damping>, Vec<usize>)> {
        friction.iter().map(|one| (Arc::clone(&one.damping), one.components.clone())).collect()
    }

    /// Puts a method between two halves of friction.
    pub fn around<'a>(method: Arc<dyn Method + 'a>, all: &'a [Self]) -> Arc<dyn Method + 'a> {
        if all.is_empty() {
            return method;
        }
        Arc::new(Damped { method, friction: all, factors: Default::default() })
    }

    /// The formulas of the damping of all components up to `t_end`, and of friction.
    pub fn describe(all: &[Self], damping: &dyn Damping, t_end: f64) -> String {
        let acts = all.is_empty() || damping.integral(0.0, t_end) != 0.0;
        let mut formulas = Vec::from_iter(acts.then(|| damping.describe()));
        formulas.extend(all.iter().map(|Self { damping, components }| {
            let names: Vec<String> = components.iter().map(|i| format!("y{}", i + 1)).collect();
            format!("{} on {}", damping.describe(), names.join(", "))
        }));
        formulas.join("; ")
    }

    /// Rates γᵢ(t) of `dimension` components by friction.
    pub fn rates(all: &[Self], t: f64, dimension: usize) -> Vec<f64> {
        let mut rates = vec![0.0; dimension];
        for Self { damping, components } in all {
            components.iter().for_each(|&i| rates[i] += damping.rate(t));
        }
        rates
    }
}

impl<'a> Setup<'a> {
    /// Adds friction to the problem and the scheme; drops laws that it breaks.
    #[must_use]
    pub fn with_friction(self, friction: &'a [Friction]) -> Self {
        Self {
            problem: self.problem.with_friction(friction),
            scheme: Friction::around(self.scheme, friction),
        }
    }
}

impl<'a> Problem<'a> {
    /// Adds friction to the problem, for schemes that have it: those of [`Setup::with_friction`].
    #[must_use]
    pub fn with_friction(self, friction: &'a [Friction]) -> Self {
        if friction.is_empty() {
            return self;
        }
        let problem = Self { friction, ..self };
        let ends = TIMES.map(|part| {
            let end = part * problem.t_end;
            let all = problem.dampings().map(|damping| damping.integral(0.0, end));
            let all: Vec<f64> = all.collect();
            // Of the size of one, so that no factor underflows.
            let size = all.iter().fold(f64::MIN_POSITIVE, |size, one| size.max(one.abs()));
            all.iter().map(|one| one / size).collect()
        });
        let Self { laws, coefficients: undamped, y0, .. } = problem.clone();
        let laws = laws.into_iter().filter_map(|law| decaying(law, friction, &y0, &ends)).collect();
        let coefficients = Arc::new(move |t: f64, y: &[f64]| {
            let mut at: Coefficients = undamped(t, y);
            let rates = Friction::rates(friction, t, y.len());
            at.drift.iter_mut().zip(rates).zip(y).for_each(|((drift, rate), y)| *drift -= rate * y);
            at
        });
        Self { laws, coefficients, ..problem }
    }
}

/// Number of points beside y₀ at which a function is compared.
const POINTS: usize = 8;
/// Times at which decays are compared, as parts of T.
const TIMES: [f64; 3] = [0.2, 0.6, 1.0];
/// Relative difference below which the factors of points are equal.
const EQUAL: f64 = 1e-9;

/// The state after damping alone, from the integrals of all dampings.
fn damped(y: &[f64], friction: &[Friction], integrals: &[f64]) -> Vec<f64> {
    let mut sums = vec![integrals[0]; y.len()];
    for (Friction { components, .. }, integral) in friction.iter().zip(&integrals[1..]) {
        components.iter().for_each(|&i| sums[i] += integral);
    }
    y.iter().zip(sums).map(|(y, sum)| y * exp(-sum)).collect()
}

/// A law with its decay by friction; none if points decay differently, so that friction breaks it.
fn decaying<'a>(
    law: ConformalLaw<'a>,
    friction: &'a [Friction],
    y0: &[f64],
    ends: &[Vec<f64>],
) -> Option<ConformalLaw<'a>> {
    let size = y0.iter().fold(0.0, |size: f64, y| size.max(y.abs())).max(0.1);
    let moved = |(i, y): (usize, &f64)| y + 0.3 * size * (0.2 + golden(i as f64));
    let point = |k| (1 + k * y0.len()..).zip(y0).map(moved).collect();
    let points: Vec<Vec<f64>> = (0..POINTS).map(point).collect();
    let value = Arc::clone(&law.value);
    let ratio =
        move |y: &[f64], integrals: &[f64]| value(&damped(y, friction, integrals)) / value(y);
    let alike = |integrals: &Vec<f64>| {
        let factor = ratio(&points[0], integrals);
        points.iter().all(|y| (ratio(y, integrals) / factor - 1.0).abs() <= EQUAL)
    };
    if !ends.iter().all(alike) {
        return None;
    }
    let decay = move |integrals: &[f64]| ratio(&points[0], integrals);
    Some(ConformalLaw { decay: Some(Arc::new(decay)), ..law })
}

/// Number of step sizes whose factors are known to all blocks of paths, and of these factors.
const SIZES: usize = 8;
const FACTORS: usize = 1 << 15;

/// A method between two halves of friction.
struct Damped<'a> {
    method: Arc<dyn Method + 'a>,
    friction: &'a [Friction],
    /// Step sizes with the factors of the halves of their first steps, found once and not for every
    /// block.
    factors: [OnceLock<(f64, Vec<OnceLock<f64>>)>; SIZES],
}

impl Damped<'_> {
    /// Factor of friction number k over a half of a step, number `half` of all.
    fn factor(&self, k: usize, step: &Step, half: u64) -> f64 {
        let new = || step.decay(&*self.friction[k].damping, half % 2);
        let empty = || (step.tau, vec![OnceLock::new(); FACTORS]);
        let mut known = self.factors.iter().map(|of_size| of_size.get_or_init(empty));
        let place = half as usize * self.friction.len() + k;
        let of_size = known.find(|(tau, _)| *tau == step.tau);
        match of_size.and_then(|(_, factors)| factors.get(place)) {
            Some(factor) => *factor.get_or_init(new),
            None => new(),
        }
    }
}

impl Method for Damped<'_> {
    fn about(&self) -> About {
        self.method.about()
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(DampedStepper { inner: self.method.start(y), of: self })
    }
}

/// A stepper between two halves of friction.
struct DampedStepper<'a> {
    inner: Box<dyn Stepper + 'a>,
    of: &'a Damped<'a>,
}

impl DampedStepper<'_> {
    /// Multiplies the damped components by their factors over a half of a step, number `half`.
    fn scale(&mut self, step: &Step, half: u64) {
        let state = self.inner.state_mut();
        for (k, friction) in self.of.friction.iter().enumerate() {
            multiply(state, &friction.components, self.of.factor(k, step, half));
        }
    }
}

real::kernel! {
    /// Multiplies components.
    fn multiply(state: &'a mut [Row], components: &'a [usize], factor: f64) {
        for &i in components {
            state[i].iter_mut().for_each(|y| *y *= factor);
        }
    }
}

impl Stepper for DampedStepper<'_> {
    fn state(&self) -> &[Row] {
        self.inner.state()
    }

    fn state_mut(&mut self) -> &mut [Row] {
        self.inner.state_mut()
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let half = 2 * step.number();
        self.scale(step, half);
        self.inner.step(step, noise, status);
        self.scale(step, half + 1);
        if !all_finite(self.inner.state()) {
            status.fail_where_not_finite(self.inner.state());
        }
    }

    fn listing(&mut self, step: &Step) -> Option<Listing<'_>> {
        let (of, half) = (self.of, 2 * step.number());
        let factors = |half| {
            of.friction.iter().enumerate().flat_map(move |(k, friction)| {
                let factor = of.factor(k, step, half);
                friction.components.iter().map(move |&i| (i, factor))
            })
        };
        let mut listing = self.inner.listing(step)?;
        listing.before.splice(0..0, factors(half));
        listing.after.extend(factors(half + 1));
        Some(listing)
    }
}
