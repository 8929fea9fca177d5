//! The report: its data and its text.

use std::fmt::{Display, Formatter, Result};

use serde::Serialize;

use super::{
    casimirs::Casimirs,
    erased::System,
    finding::Finding,
    function::{Kind, Minimum, Shape},
    hamiltonian::Hamiltonians,
    invariants::ClaimedInvariant,
    noises::Noises,
    points::{Points, Region},
    problem::{Bound, ProblemFindings},
    solvability::Solvability,
    structure::Structure,
    theory::{Applies, ExpectedOrder, Theorem, orders, theorems},
};

/// The report on a system: its properties, what theory says of it, and its mistakes.
///
/// It prints as text and serializes as data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Name of the system.
    pub system: String,
    /// D.
    pub dimension: usize,
    /// M.
    pub noises: usize,
    /// The region of the points at which identities were checked.
    pub region: Region,
    /// Number of these points.
    pub points: usize,
    /// Whether the system is defined at every point that was tried.
    pub defined_everywhere: bool,
    /// B(y).
    pub structure: Structure,
    /// H₀, …, H_M.
    pub hamiltonians: Hamiltonians,
    /// The noise fields.
    pub noise: Noises,
    /// The invariants that the system claims.
    pub invariants: Vec<ClaimedInvariant>,
    /// The linear and quadratic Casimirs of B.
    pub casimirs: Casimirs,
    /// A function that bounds all paths, if one was found.
    pub bound: Option<Bound>,
    /// The norms of the contraction constant of the implicit step.
    pub solvability: Solvability,
    /// What damping and initial value add; `None` for a system alone.
    pub problem: Option<ProblemFindings>,
    /// Which statements of the paper apply.
    pub theorems: Vec<Theorem>,
    /// The orders that theory predicts for the schemes.
    pub orders: Vec<ExpectedOrder>,
    /// Every property that a system must have or claims and that was found wrong, in words; empty
    /// for a sound system.
    pub mistakes: Vec<String>,
}

/// Least relative error of `averaged_gradient` that is a mistake and not that of a quadrature: the
/// points of the check are further apart than a step is long.
const POOR_QUADRATURE: f64 = 1e-3;

impl Inspection {
    /// The report on a system alone.
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let structure = Structure::of(system, points);
        let hamiltonians = Hamiltonians::of(system, points);
        let noise = Noises::of(system, points);
        let invariants = ClaimedInvariant::all(system, points);
        let casimirs = Casimirs::of(system, points);
        let bound = Bound::of(&hamiltonians, &casimirs);
        Self {
            system: system.name().into(),
            dimension: system.dimension(),
            noises: system.noises(),
            region: points.region.clone(),
            points: points.for_identities.len(),
            defined_everywhere: points.everywhere,
            solvability: Solvability::of(system, points),
            problem: None,
            theorems: theorems(&structure, &hamiltonians, &casimirs, &invariants, bound.as_ref()),
            orders: orders(&noise),
            mistakes: Vec::new(),
            structure,
            hamiltonians,
            noise,
            invariants,
            casimirs,
            bound,
        }
    }

    /// Lists what is wrong.
    pub(super) fn with_mistakes(mut self) -> Self {
        let Self { structure, hamiltonians: h, noise, .. } = &self;
        let mut must_hold = vec![
            (&structure.linear, "structure(y, v) is not linear in v"),
            (&structure.skew, "B(y) is not skew-symmetric"),
            (&h.linear, "energy(y, dt, dw) is not linear in (dt, dw)"),
            (&h.gradient, "gradient is not the gradient of energy"),
            (&h.averaged_gradient, "averaged_gradient(y, y) is not the gradient of energy at y"),
            (
                &h.averaged_field,
                "averaged_field(a, b) is not structure((a+b)/2, averaged_gradient(a, b))",
            ),
            (&h.prediction, "the residual of the predicted step exceeds the bound given with it"),
            (&noise.commutators, "commutators is not what follows from B and the energy"),
        ];
        if h.discrete_gradient.defect > POOR_QUADRATURE {
            let what = "averaged_gradient(a, b)·(b − a) is not the change of energy";
            must_hold.push((&h.discrete_gradient, what));
        }
        if let Some(problem) = self.problem.as_ref().filter(|problem| !problem.integral_agrees) {
            let what = "the integral of the damping is not the integral of its rate";
            must_hold.push((&problem.integral, what));
        }
        let fails = must_hold.into_iter().filter(|(finding, _)| !finding.holds);
        self.mistakes = fails.map(|(finding, what)| format!("{what}: {finding}")).collect();
        self.mistakes.extend(self.invariants.iter().flat_map(|i| i.mistakes.iter().cloned()));
        self
    }

    /// (strong, weak) order that theory predicts for a scheme, by its identifier.
    pub fn order(&self, scheme: &str) -> Option<(f64, f64)> {
        let order = self.orders.iter().find(|order| order.scheme == scheme)?;
        Some((order.strong, order.weak))
    }

    /// Whether a statement of the paper applies, by its identifier; `None` if it is about systems
    /// with another number of noises.
    pub fn applies(&self, statement: &str) -> Option<Applies> {
        let theorem = self.theorems.iter().find(|theorem| theorem.statement == statement)?;
        Some(theorem.applies)
    }
}

impl Display for Inspection {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(
            f,
            "{}: D = {}, M = {}; checked at {} points with {}{}",
            self.system,
            self.dimension,
            self.noises,
            self.points,
            self.region,
            if self.defined_everywhere { "" } else { " in its domain" }
        )?;
        self.write_properties(f)?;
        self.write_casimirs(f)?;
        if let Some(problem) = &self.problem {
            let agrees = if problem.integral_agrees { "agree" } else { "DISAGREE, see below" };
            row(f, "damping", format!("{}; rate and integral {agrees}", problem.damping))?;
            let bound = problem.radius.map(|radius| format!("stay within ‖y‖ ≤ {radius:.4}"));
            row(f, "paths", bound.as_deref().unwrap_or("no bound was found"))?;
        }
        self.write_theory(f)?;
        if self.mistakes.is_empty() {
            return write!(f, "No mistakes found.");
        }
        write!(f, "Mistakes")?;
        self.mistakes.iter().try_for_each(|mistake| write!(f, "\n  - {mistake}"))
    }
}

impl Inspection {
    fn write_properties(&self, f: &mut Formatter<'_>) -> Result {
        row(f, "B(y)", &self.structure)?;
        for (m, shape) in self.hamiltonians.shapes.iter().enumerate() {
            match self.hamiltonians.noise_size {
                Some(c) if m == 1 => row(f, "H1", format!("c H0 with c = {c}"))?,
                _ => row(f, &format!("H{m}"), shape)?,
            }
        }
        // The combining macron takes a character, but no width.
        let label = "∇̄h ";
        let gradient = &self.hamiltonians.discrete_gradient;
        let kind = if gradient.holds { "exact" } else { "quadrature" };
        let error = gradient.defect;
        row(f, label, format!(" {kind}: relative error {error:.1e} in h(b) − h(a)"))?;
        if self.noises > 1 {
            let [not, no] = if self.noise.commute.holds { ["", "no "] } else { ["do not ", ""] };
            row(f, "noises", format!("{not}commute: strong order 1 needs {no}Lévy areas"))?;
        }
        for ClaimedInvariant { name, formula, shape, mistakes, claimed_casimir, .. } in
            &self.invariants
        {
            let kind = if *claimed_casimir { "Casimir" } else { "energy" };
            let wrong = if mistakes.is_empty() { "" } else { " (WRONG, see below)" };
            row(f, name, format!("{formula}: {kind}{wrong}; {shape}"))?;
        }
        Ok(())
    }

    fn write_casimirs(&self, f: &mut Formatter<'_>) -> Result {
        let Casimirs { found, definite, quadratic_sought } = &self.casimirs;
        let sought = if *quadratic_sought { "linear or quadratic" } else { "linear" };
        let none = if found.is_empty() { " none" } else { "" };
        writeln!(f, "  Casimirs of B, {sought}:{none}")?;
        for casimir in found {
            let (formula, degree, minimum) = (&casimir.formula, casimir.degree, casimir.minimum);
            writeln!(f, "    {formula}; degree {degree}, m = {minimum}")?;
        }
        match definite {
            Some(sum) if found.len() > 1 => {
                writeln!(f, "    a positive definite sum: {}, m = {}", sum.formula, sum.minimum)
            }
            _ => Ok(()),
        }
    }

    fn write_theory(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(f, "Which statements of the paper apply")?;
        for theorem in &self.theorems {
            let applies = match theorem.applies {
                Applies::Yes => "yes",
                Applies::InDomain => "in the domain",
                Applies::Conditionally => "conditional",
                Applies::No => "no",
            };
            writeln!(f, "  {applies:<13}  {}: {}", theorem.statement, theorem.says)?;
            writeln!(f, "                 {}", theorem.because)?;
        }
        let orders = self.orders.iter();
        let orders = orders.map(|o| format!("{} {} / {}", o.scheme, o.strong, o.weak));
        let orders: Vec<String> = orders.collect();
        writeln!(f, "Expected orders, strong / weak\n  {}", orders.join(",  "))?;
        let step = |k| format!("{:.1e} for k = {k}", self.solvability.largest_step(k));
        writeln!(
            f,
            "Implicit steps of sexp with {} are contractions, C(k, τ) < 1, for τ below\n  {}",
            self.solvability.region,
            [1, 2, 4].map(step).join(", ")
        )
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "relative defect {:.1e} at {:.3?}", self.defect, self.at)
    }
}

/// A property with its label.
fn row(f: &mut Formatter<'_>, label: &str, text: impl Display) -> Result {
    writeln!(f, "  {label:<9}{text}")
}

impl Display for Region {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Box(half_side) => write!(f, "|yᵢ| ≤ {half_side}"),
            Self::Ball(radius) => write!(f, "‖y‖ ≤ {radius:.4}"),
        }
    }
}

impl Display for Structure {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if !self.linear.holds {
            return write!(f, "structure(y, v) is NOT linear in v, see below");
        }
        let skew = if self.skew.holds { "skew-symmetric" } else { "NOT skew-symmetric, see below" };
        let constant = if self.constant.holds { "constant" } else { "depends on y" };
        write!(f, "{skew}; {constant}; ")?;
        if self.jacobi.holds {
            write!(f, "a Poisson structure (Jacobi identity holds)")
        } else {
            let defect = self.jacobi.defect;
            write!(f, "no Poisson structure (Jacobi identity has defect {defect:.1e}), not needed")
        }
    }
}

impl Display for Minimum {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { value, positive, in_domain_only } = *self;
        // A small value may be round-off.
        let value = if value.abs() < 1e-6 { 0.0 } else { value };
        let positive = if positive { " > 0" } else { "" };
        let domain = if in_domain_only { " on the domain" } else { "" };
        write!(f, "{value:.4}{positive}{domain}")
    }
}

impl Display for Shape {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str(self.kind.name())?;
        if let Some(degree) = self.degree {
            let separator = if self.kind == Kind::Homogeneous { " of" } else { "," };
            write!(f, "{separator} degree {degree}")?;
        }
        self.minimum.map_or(Ok(()), |minimum| write!(f, ", m = {minimum}"))
    }
}
