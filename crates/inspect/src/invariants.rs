//! Whether the invariants that a system lists are what it claims.

use serde::Serialize;
use systems::InvariantKind;

use super::{Sight, shape::Shape};
use crate::facts::{Batch, Finding, Purpose, Random, Status, Term, Values, axis, lengths, slopes};

/// Invariant that a system claims, and the findings on it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimedInvariant {
    /// Symbol of the invariant.
    pub name: &'static str,
    /// Formula of the invariant.
    pub formula: &'static str,
    /// Whether the claim is a Casimir (else an energy).
    pub claimed_casimir: bool,
    /// The claimed degree.
    pub claimed_degree: f64,
    /// Finding on B∇F = 0.
    pub casimir: Finding,
    /// Finding on ∇F·B∇Hₘ = 0 for every m: without damping F is constant along every path.
    pub conserved: Finding,
    /// The shape of F.
    pub shape: Shape,
    /// Mistakes of the claim, in words; empty for a true one.
    pub mistakes: Vec<String>,
}

/// Largest number of noises whose flows are checked.
const NOISES: usize = 8;

impl ClaimedInvariant {
    pub(super) fn all(sight: &mut Sight<'_>) -> Vec<Self> {
        let claims = sight.probe.description.invariants.clone();
        (0..claims.len()).map(|index| Self::of(sight, index, claims[index])).collect()
    }

    fn of(sight: &mut Sight<'_>, index: usize, claim: systems::Invariant) -> Self {
        let f: Values<'_> = &|probe, y| probe.invariant(index, y);
        let (states, mut random) = (sight.states.clone(), Random::new(Purpose::Areas));
        // ∇F along B and along the flows is zero: along all columns of a small B.
        let (columns, flows): (Vec<Batch>, Vec<Vec<f64>>) = match sight.matrices.len() {
            0 => (vec![sight.vectors(&mut random)], vec![sight.weights(&mut random)]),
            _ => {
                let (d, noises) = (sight.probe.dimension(), sight.probe.noises());
                let weights = (0..=noises.min(NOISES)).map(|m| sight.probe.weights(m));
                ((0..d).map(|j| vec![axis(d, j)]).collect(), weights.collect())
            }
        };
        let flows = flows.iter().map(|weights| sight.probe.gradient(&states, weights)).collect();
        let [casimir, conserved] = [columns, flows].map(|vectors: Vec<Batch>| {
            let along = vectors.iter().map(|v| {
                let field = sight.probe.structure(&states, v);
                slopes(&mut sight.probe, &states, &field, &lengths(&states, &field), f)
            });
            let all: Vec<Vec<Term>> = along.collect();
            sight.found(|n| all.iter().map(|terms| terms[n]).collect())
        });
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
        let infinite = values.iter().find(|value| !value.is_finite()).map(|value| {
            vec![format!("is listed, but invariant({index}, y) returns {value} in the domain")]
        });
        let mistakes = infinite.unwrap_or_else(|| invariant.mistakes());
        let mistakes = mistakes.iter();
        invariant.mistakes =
            mistakes.map(|what| format!("{} = {} {what}", claim.name, claim.formula)).collect();
        invariant
    }

    /// Whether the claim is true.
    pub(super) fn status(&self) -> Status {
        let kind = if self.claimed_casimir { &self.casimir } else { &self.conserved };
        match self.mistakes.is_empty() {
            true => kind.status.min(self.shape.homogeneous.status),
            false => Status::Fails,
        }
    }

    fn mistakes(&self) -> Vec<String> {
        let Self { claimed_degree: claimed, casimir, conserved, shape, .. } = self;
        let mut mistakes = Vec::new();
        if self.claimed_casimir && casimir.fails() {
            let constant = ", a function of the Hamiltonian or another constant of the motion";
            let but = if conserved.holds() { constant } else { "" };
            mistakes.push(format!("is claimed as a Casimir and is none{but}: B∇F ({casimir})"));
        } else if !self.claimed_casimir && conserved.fails() {
            mistakes
                .push(format!("is claimed as an energy, and the flow changes it ({conserved})"));
        }
        match shape.degree {
            Some(degree) if degree != *claimed => {
                mistakes
                    .push(format!("is claimed to have degree {claimed} and has degree {degree}"));
            }
            None if shape.homogeneous.fails() => mistakes.push(format!(
                "is not homogeneous and hence has no conformal law ({})",
                shape.homogeneous
            )),
            _ => {}
        }
        mistakes
    }
}
