//! Whether the invariants that a system lists are what it claims.

use serde::Serialize;
use systems::{Form, InvariantKind};

use super::{
    algebra::{dot, largest, norm, times},
    erased::System,
    finding::Finding,
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
                let product = times(&b, &gradient);
                let size = largest(b.iter().flatten()) * norm(&gradient) * y.len() as f64;
                casimir.compare(&product, &vec![0.0; y.len()], size, y);
                for m in 0..=system.noises() {
                    let hamiltonian = system.hamiltonian(m).gradient(y);
                    let change = dot(&gradient, &times(&b, &hamiltonian));
                    conserved.record(change, size * norm(&hamiltonian), y);
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
            let mut values = points.for_identities.iter().map(|y| f.value(y));
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

    fn mistakes(&self, claimed: Form) -> Vec<String> {
        let Self { name, claimed_casimir, claimed_degree, casimir, conserved, shape, .. } = self;
        let mut mistakes = Vec::new();
        if *claimed_casimir && !casimir.holds {
            let but = if conserved.holds {
                "it is a function of the Hamiltonian or another constant of the motion"
            } else {
                "the flow changes it"
            };
            mistakes.push(format!(
                "is claimed as a Casimir and is none: B∇{name} is not zero ({casimir}); {but}"
            ));
        }
        if !*claimed_casimir && !conserved.holds {
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
            None => mistakes.push("is not homogeneous and hence has no conformal law".into()),
            Some(degree) if (degree - claimed_degree).abs() > 1e-9 * degree.abs() => mistakes.push(
                format!("is claimed to have degree {claimed_degree} and has degree {degree}"),
            ),
            Some(_) if claimed != shape.kind => mistakes.push(format!(
                "is claimed as {} and is {}",
                claimed.name(),
                shape.kind.name()
            )),
            Some(_) => {}
        }
        mistakes
    }
}
