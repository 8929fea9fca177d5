//! Whether the invariants that a system lists are what it claims.

use serde::Serialize;
use systems::{Form, InvariantKind};

use super::{
    algebra::{dot, size, times},
    erased::System,
    finding::{Finding, Status},
    function::{Kind, Shape},
    points::Points,
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

impl ClaimedInvariant {
    pub(super) fn all(system: &dyn System, points: &Points) -> Vec<Self> {
        let claims = system.invariants().into_iter().enumerate();
        let examined = claims.map(|(index, (claim, f))| {
            let (mut casimir, mut conserved) = (Finding::default(), Finding::default());
            for y in &points.for_identities {
                let (gradient, b) = (f.gradient(y), system.matrix(y));
                for (row, change) in b.iter().zip(times(&b, &gradient)) {
                    casimir.record(change, size(row, &gradient), y);
                }
                for m in 0..=system.noises() {
                    let flow = times(&b, &system.hamiltonian(m).gradient(y));
                    conserved.record(dot(&gradient, &flow), size(&gradient, &flow), y);
                }
            }
            let mut invariant = Self {
                name: claim.name,
                formula: claim.formula,
                claimed_casimir: claim.kind == InvariantKind::Casimir,
                claimed_degree: claim.degree,
                casimir,
                conserved,
                shape: Shape::of(&*f, system, points),
                mistakes: Vec::new(),
            };
            let mut values = points.for_identities.iter().map(|y| f.value(y).value);
            let mistakes = match values.find(|value| !value.is_finite()) {
                Some(value) => {
                    vec![format!(
                        "is listed, but invariant({index}, y) returns {value} in the domain"
                    )]
                }
                None => invariant.mistakes(claim.form),
            };
            let named = format!("{} = {}", claim.name, claim.formula);
            invariant.mistakes =
                mistakes.into_iter().map(|what| format!("{named} {what}")).collect();
            invariant
        });
        examined.collect()
    }

    /// How it is known that the claim is true.
    pub(super) fn status(&self) -> Status {
        let kind = if self.claimed_casimir { &self.casimir } else { &self.conserved };
        if !self.mistakes.is_empty() {
            return Status::Refuted;
        }
        kind.status.min(self.shape.homogeneous.status)
    }

    fn mistakes(&self, claimed: Form) -> Vec<String> {
        let Self { name, claimed_casimir, claimed_degree, casimir, conserved, shape, .. } = self;
        let mut mistakes = Vec::new();
        if *claimed_casimir && casimir.refuted() {
            let but = match conserved.status {
                Status::Refuted => "; the flow changes it",
                Status::Unknown => "",
                _ => "; it is a function of the Hamiltonian or another constant of the motion",
            };
            mistakes.push(format!(
                "is claimed as a Casimir and is none: B∇{name} is not zero ({casimir}){but}"
            ));
        }
        if !*claimed_casimir && conserved.refuted() {
            mistakes.push(format!(
                "is claimed as an energy, and the flow changes it: ∇{name}·B∇Hₘ ({conserved})"
            ));
        }
        let claimed = match claimed {
            Form::Linear => Kind::Linear,
            Form::Quadratic => Kind::Quadratic,
            Form::Homogeneous => Kind::Homogeneous,
        };
        match shape.degree {
            None if shape.kind == Kind::NotHomogeneous => mistakes.push(format!(
                "is not homogeneous and hence has no conformal law: ∇{name}·y = p{name} ({})",
                shape.homogeneous
            )),
            Some(degree) if (degree - claimed_degree).abs() > shape.degree_error => mistakes.push(
                format!("is claimed to have degree {claimed_degree} and has degree {degree}"),
            ),
            Some(_)
                if claimed != shape.kind && shape.constant_hessian.status != Status::Unknown =>
            {
                mistakes.push(format!(
                    "is claimed as {} and is {}",
                    claimed.name(),
                    shape.kind.name()
                ));
            }
            _ => {}
        }
        mistakes
    }
}
