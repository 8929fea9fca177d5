//! Whether the invariants that a system claims are what they are claimed to be.

use serde::Serialize;
use systems::{Form, InvariantKind};

use super::algebra::{dot, largest, norm, times};
use super::finding::Finding;
use super::points::Points;
use super::probe::{Probe, matrix, pick};
use super::shape::{Claimed, Function, Kind, Shape};

/// An invariant that a system claims, and what it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimedInvariant {
    /// Its symbol.
    pub name: &'static str,
    /// Its formula.
    pub formula: &'static str,
    /// Whether a Casimir was claimed, or an energy.
    pub claimed_casimir: bool,
    /// The degree that was claimed.
    pub claimed_degree: f64,
    /// B∇F = 0.
    pub casimir: Finding,
    /// ∇F·B∇Hₘ = 0 for every m: without damping it is constant along every path.
    pub conserved: Finding,
    /// What kind of function it is.
    pub shape: Shape,
    /// What is wrong with the claim, in words; empty for a true one.
    pub mistakes: Vec<String>,
}

impl ClaimedInvariant {
    pub(super) fn all(system: &dyn Probe, points: &Points) -> Vec<Self> {
        let describe = |(index, claim): (usize, systems::Invariant)| {
            let f = Claimed { system, index };
            let (mut casimir, mut conserved) = (Finding::new(), Finding::new());
            for y in &points.few {
                let (gradient, b) = (f.gradient(y), matrix(system, y));
                let size = largest(&b) * norm(&gradient) * y.len() as f64;
                for x in times(&b, &gradient) {
                    casimir.see(x, size, y);
                }
                for m in 0..=system.noises() {
                    let hamiltonian = system.dual_gradient(y, &pick(system, m));
                    conserved.see(
                        dot(&gradient, &times(&b, &hamiltonian)),
                        size * norm(&hamiltonian),
                        y,
                    );
                }
            }
            let shape = Shape::of(&f, system, points);
            let mut claimed = Self {
                name: claim.name,
                formula: claim.formula,
                claimed_casimir: claim.kind == InvariantKind::Casimir,
                claimed_degree: claim.degree,
                casimir,
                conserved,
                shape,
                mistakes: Vec::new(),
            };
            claimed.mistakes = claimed.judged(claim.form);
            claimed
        };
        system.invariants().into_iter().enumerate().map(describe).collect()
    }

    fn judged(&self, form: Form) -> Vec<String> {
        let named = format!("{} = {}", self.name, self.formula);
        let mut mistakes = Vec::new();
        if self.claimed_casimir && !self.casimir.holds {
            let but = if self.conserved.holds {
                "it is a function of the Hamiltonian or another constant of the motion"
            } else {
                "the flow changes it"
            };
            mistakes.push(format!(
                "{named} is claimed as a Casimir and is none: B∇{} is not zero (relative size {:.1e}); {but}",
                self.name, self.casimir.defect
            ));
        }
        if !self.claimed_casimir && !self.conserved.holds {
            mistakes.push(format!(
                "{named} is claimed as an energy, and the flow changes it: ∇{}·B∇Hₘ has relative size {:.1e}",
                self.name, self.conserved.defect
            ));
        }
        match self.shape.degree {
            None => mistakes
                .push(format!("{named} is not homogeneous, so that it has no conformal law")),
            Some(degree) if (degree - self.claimed_degree).abs() > 1e-9 * degree.abs() => mistakes
                .push(format!(
                    "{named} is claimed to have degree {} and has degree {degree}",
                    self.claimed_degree
                )),
            Some(_) => {
                let claimed = match form {
                    Form::Linear => Kind::Linear,
                    Form::Quadratic => Kind::Quadratic,
                    Form::Homogeneous => Kind::Homogeneous,
                };
                if claimed != self.shape.kind {
                    mistakes.push(format!(
                        "{named} is claimed as {} and is {}",
                        claimed.word(),
                        self.shape.kind.word()
                    ));
                }
            }
        }
        mistakes
    }
}
