//! Whether the invariants that a system lists are what it claims.

use serde::Serialize;
use systems::InvariantKind;

use super::{
    algebra::{axis, dot, largest, moved},
    finding::{Finding, Status, Term},
    probe::{Batch, Probe},
    random::{Purpose, Random},
    shape::{Shape, Values},
    sight::Sight,
};

/// An invariant that a system claims, and what was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimedInvariant {
    /// Its symbol.
    pub name: &'static str,
    /// Its formula.
    pub formula: &'static str,
    /// Whether the claim is a Casimir (else an energy).
    pub claimed_casimir: bool,
    /// The claimed degree.
    pub claimed_degree: f64,
    /// B∇F = 0.
    pub casimir: Finding,
    /// ∇F·B∇Hₘ = 0 for every m: without damping F is constant along every path.
    pub conserved: Finding,
    /// The shape of F.
    pub shape: Shape,
    /// What is wrong with the claim, in words; empty for a true one.
    pub mistakes: Vec<String>,
}

/// Noises whose flows are looked at.
const NOISES: usize = 8;
/// Below this part of the terms the error of a derivative is taken for round-off.
const ROUNDING: f64 = 1e-14;

impl ClaimedInvariant {
    pub(super) fn all(sight: &mut Sight<'_>) -> Vec<Self> {
        let claims = sight.probe.description().invariants.clone();
        (0..claims.len()).map(|index| Self::of(sight, index, claims[index])).collect()
    }

    fn of(sight: &mut Sight<'_>, index: usize, claim: systems::Invariant) -> Self {
        let f: Values<'_> = &|probe, y| probe.invariant(index, y);
        let (mut casimir, mut conserved) = (Finding::default(), Finding::default());
        let (states, mut random) = (sight.states.clone(), Random::new(Purpose::Areas));
        // ∇F along B and along the flows is zero: along all columns of a small B.
        let (columns, flows): (Vec<Batch>, Vec<Vec<f64>>) = match sight.locals.len() {
            0 => (vec![sight.vectors(&mut random)], vec![sight.weights(&mut random)]),
            _ => {
                let (d, noises) = (sight.probe.dimension(), sight.probe.noises());
                let weights = (0..=noises.min(NOISES)).map(|m| sight.probe.weights(m));
                ((0..d).map(|j| vec![axis(d, j)]).collect(), weights.collect())
            }
        };
        let flows = flows.iter().map(|weights| sight.probe.gradient(&states, weights)).collect();
        for (finding, vectors) in [(&mut casimir, columns), (&mut conserved, flows)] {
            let along = |v: &Batch| {
                let field = sight.probe.structure(&states, v);
                slopes(&mut sight.probe, &states, &field, f)
            };
            let all: Vec<Vec<Term>> = vectors.iter().map(along).collect();
            let at = |n: usize| all.iter().map(|terms| terms[n]).collect();
            sight.record(finding, (0..states.len()).map(at));
        }
        let mut invariant = Self {
            name: claim.name,
            formula: claim.formula,
            claimed_casimir: claim.kind == InvariantKind::Casimir,
            claimed_degree: claim.degree,
            casimir,
            conserved,
            shape: Shape::of(sight, f),
            mistakes: Vec::new(),
        };
        let values = f(&mut sight.probe, &states);
        let mistakes = match values.iter().find(|value| !value.is_finite()) {
            Some(value) => {
                vec![format!("is listed, but invariant({index}, y) returns {value} in the domain")]
            }
            None => invariant.mistakes(),
        };
        let named = format!("{} = {}", claim.name, claim.formula);
        invariant.mistakes = mistakes.into_iter().map(|what| format!("{named} {what}")).collect();
        invariant
    }

    /// Whether the claim is true.
    pub(super) fn status(&self) -> Status {
        let kind = if self.claimed_casimir { &self.casimir } else { &self.conserved };
        if !self.mistakes.is_empty() {
            return Status::Fails;
        }
        kind.status.min(self.shape.homogeneous.status)
    }

    fn mistakes(&self) -> Vec<String> {
        let Self { claimed_degree, casimir, conserved, shape, .. } = self;
        let mut mistakes = Vec::new();
        if self.claimed_casimir && casimir.fails() {
            let but = match conserved.status {
                Status::Holds => {
                    ", a function of the Hamiltonian or another constant of the motion"
                }
                _ => "",
            };
            mistakes.push(format!("is claimed as a Casimir and is none{but}: B∇F ({casimir})"));
        } else if !self.claimed_casimir && conserved.fails() {
            mistakes
                .push(format!("is claimed as an energy, and the flow changes it ({conserved})"));
        }
        match shape.degree {
            Some(degree) if degree != *claimed_degree => mistakes.push(format!(
                "is claimed to have degree {claimed_degree} and has degree {degree}"
            )),
            None if shape.homogeneous.fails() => {
                let off = &shape.homogeneous;
                mistakes.push(format!("is not homogeneous and hence has no conformal law ({off})"));
            }
            _ => {}
        }
        mistakes
    }
}

/// Weights of the differences F(y + kh) − F(y − kh) in the derivative, of orders eight and six.
const WEIGHTS: [[f64; 4]; 2] =
    [[4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0], [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0]];
/// Steps relative to the size of a state, of which the best is taken.
const STEPS: i32 = 8;

/// The derivative of F along vectors, at each state, and a size whose round-off is its error.
fn slopes(probe: &mut Probe<'_>, y: &Batch, along: &[Vec<f64>], f: Values<'_>) -> Vec<Term> {
    let direction = |n: usize| &along[n % along.len()];
    let lengths: Vec<f64> = (0..y.len())
        .map(|n| 0.1 * largest(&y[n]).max(f64::MIN_POSITIVE) / largest(direction(n)).max(1e-300))
        .collect();
    let mut best = vec![(0.0, f64::INFINITY); y.len()];
    for halvings in 0..STEPS {
        let length = |n: usize| lengths[n] * f64::powi(0.5, halvings);
        let at = |k: i32| -> Batch {
            (0..y.len()).map(|n| moved(&y[n], f64::from(k) * length(n), direction(n))).collect()
        };
        let mut side = |k: i32| {
            let states = at(k);
            let values = f(probe, &states);
            (states, values)
        };
        let sides = [1, 2, 3, 4].map(|k| [k, -k].map(&mut side));
        for n in 0..y.len() {
            let mut inside = sides.iter().flatten().map(|(states, _)| &states[n]);
            if !inside.all(|y| probe.in_domain(y)) {
                continue;
            }
            let differences: Vec<f64> =
                sides.iter().map(|[up, down]| up.1[n] - down.1[n]).collect();
            let [fine, coarse] = WEIGHTS.map(|weights| dot(&weights, &differences) / length(n));
            let size = largest(sides.iter().flatten().map(|(_, values)| &values[n])) / length(n);
            let error = (fine - coarse).abs() / ROUNDING + 0.1 * size;
            if error < best[n].1 {
                best[n] = (fine, error);
            }
        }
    }
    best.into_iter().map(|(slope, error)| (slope, slope.abs() + error)).collect()
}
