//! The report: its data and its text.

use std::fmt::{Display, Formatter, Result};

use schemes::{BuiltIn, SexpLi, run_time::Scheme};
use serde::{Serialize, Serializer};
use systems::{Linearity, run_time::System};

use super::{
    casimirs::{Casimirs, FoundCasimir, LogarithmicCasimir},
    finding::{Finding, Status},
    hamiltonian::Hamiltonians,
    invariants::ClaimedInvariant,
    noises::Noises,
    pilot::Pilot,
    points::Region,
    problem::{Bound, ProblemFindings},
    recommendation::Recommendation,
    shape::{Kind, Minimum, Shape},
    solvability::Solvability,
    structure::Structure,
    theory::{Applies, ExpectedOrder, Theorem},
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
    /// Number of these points, with those around the initial value and on pilot paths.
    pub points: usize,
    /// The pilot paths; `None` for a system alone.
    pub pilot: Option<Pilot>,
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
    /// The Casimirs of B; `None` where rows belong to one path of very many components.
    pub casimirs: Option<Casimirs>,
    /// A function that bounds all paths, if one was found.
    pub bound: Option<Bound>,
    /// The norms of the contraction constant of the implicit step, for up to 24 components.
    pub solvability: Option<Solvability>,
    /// What damping and initial value add; `None` for a system alone.
    pub problem: Option<ProblemFindings>,
    /// Methods that a compiled system has written out, with what they should be.
    pub own_methods: Vec<(&'static str, Finding)>,
    /// Which statements of the paper apply.
    pub theorems: Vec<Theorem>,
    /// The orders that theory predicts for the schemes.
    pub orders: Vec<ExpectedOrder>,
    /// Which schemes apply to the system.
    pub schemes: Schemes,
    /// The schemes to take, that for paths first.
    pub recommended: Vec<Recommendation>,
    /// Every property that a system must have or claims and that was found wrong, in words; empty
    /// for a sound system.
    pub mistakes: Vec<String>,
    /// Every property that a system must have and that cannot be told, in words with the reason.
    pub undecided: Vec<String>,
}

/// Which of the schemes that are not for every system apply to one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Schemes {
    /// How B depends on y.
    #[serde(serialize_with = "as_word")]
    pub structure: Linearity,
    /// Why `sexp-li` refuses the system, if it does.
    pub sexp_li_refused: Option<String>,
    /// Whether it truncates increments, since a step may have no solution.
    pub truncates: bool,
    /// Why `split` refuses the system.
    pub split_refused: Option<String>,
    /// Whether Lévy areas are drawn for the system.
    pub draws_areas: bool,
}

impl Schemes {
    pub(super) fn of(system: &dyn System, draws_areas: bool) -> Self {
        let scheme = SexpLi::at_run_time(system);
        Self {
            structure: system.description().linearity,
            truncates: scheme.as_ref().is_ok_and(Scheme::clips_increments),
            sexp_li_refused: scheme.err().map(|refused| refused.to_string()),
            split_refused: system.description().parts.clone().err(),
            draws_areas,
        }
    }
}

/// `constant`, `affine` or `other`.
fn word(structure: Linearity) -> String {
    format!("{structure:?}").to_lowercase()
}

fn as_word<S: Serializer>(
    structure: &Linearity,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    serializer.serialize_str(&word(*structure))
}

/// Least relative error of `averaged_gradient` that is a mistake and not that of a quadrature: the
/// points of the check are further apart than a step is long.
const POOR_QUADRATURE: f64 = 1e-3;

/// Most Casimirs that are printed.
const LISTED: usize = 12;

/// A bound of the step size below this helps no one.
const USELESS_STEP: f64 = 1e-6;

impl Inspection {
    /// Lists what is wrong, and what cannot be told.
    pub(super) fn with_mistakes(mut self) -> Self {
        let Self { structure, hamiltonians: h, invariants, .. } = &self;
        let check = |finding: &Finding, what| (finding.status, format!("{what}: {finding}"));
        let mut checks = vec![
            check(&structure.linear, "structure(y, v) is not linear in v"),
            check(&structure.skew, "B(y) is not skew-symmetric"),
            check(&structure.derivative, "structure_along is not the derivative of structure"),
            check(&h.linear, "energy(y, dt, dw) is not linear in (dt, dw)"),
            check(&h.hessian, "hessian is not the derivative of gradient"),
            check(
                &h.averaged_field,
                "averaged_field(a, b) is not structure((a+b)/2, averaged_gradient(a, b))",
            ),
        ];
        let gradient = h.gradient.iter();
        checks.extend(gradient.map(|g| check(g, "gradient is not the gradient of energy")));
        // What follows from a wrong gradient is the same mistake.
        if !h.gradient.as_ref().is_some_and(Finding::fails) {
            let what = "averaged_gradient(y, y) is not the gradient at y";
            checks.push(check(&h.averaged_gradient, what));
            // The error of a quadrature is no mistake.
            let poor = h.own_average && h.quadrature_error > POOR_QUADRATURE;
            if !h.discrete_gradient.fails() || poor {
                let what = "averaged_gradient(a, b)·(b − a) is not the change of energy";
                checks.push(check(&h.discrete_gradient, what));
            }
        }
        let own = self.own_methods.iter();
        checks.extend(own.map(|(what, finding)| check(finding, what)));
        if let Some(ProblemFindings { integral, .. }) = &self.problem {
            let what = "the integral of the damping is not the integral of its rate";
            checks.push((integral.agrees, format!("{what}: {integral}")));
        }
        let all = |status| checks.iter().filter(move |check| check.0 == status);
        let mistakes = all(Status::Fails).map(|check| check.1.clone());
        let mistakes = mistakes.chain(invariants.iter().flat_map(|i| i.mistakes.clone()));
        let undecided = all(Status::Unknown).map(|check| format!("whether {}", check.1));
        let claims = invariants.iter().filter(|i| i.status() == Status::Unknown);
        let claims = claims.map(|i| format!("whether the claim on {} is true", i.name));
        (self.mistakes, self.undecided) = (mistakes.collect(), undecided.chain(claims).collect());
        self
    }

    /// (strong, weak) order that theory predicts for a scheme, by its identifier.
    pub fn order(&self, scheme: &str) -> Option<(f64, f64)> {
        let order = self.orders.iter().find(|order| order.scheme == scheme)?;
        Some((order.strong, order.weak))
    }

    /// Whether B is sound and a Casimir was found, or is claimed and may be one.
    fn has_casimirs(&self) -> bool {
        let found = |c: &Casimirs| !c.found.is_empty() || !c.logarithmic.is_empty();
        let mut claims = self.invariants.iter().filter(|claim| claim.claimed_casimir);
        self.structure.sound() != Status::Fails
            && (self.casimirs.as_ref().is_some_and(found)
                || claims.any(|claim| claim.status() != Status::Fails))
    }
}

impl Display for Inspection {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { system, dimension, noises, points, region, .. } = self;
        let domain = if self.defined_everywhere { "" } else { " in its domain" };
        write!(f, "{system}: D = {dimension}, M = {noises}; ")?;
        match &self.pilot {
            Some(Pilot { paths, states, until }) => {
                let random = points - states;
                writeln!(f, "{random} points with {region} or near y₀{domain}")?;
                writeln!(f, "  and {states} states of {paths} paths, followed to t = {until}")?;
            }
            None => writeln!(f, "{points} points with {region}{domain}")?,
        }
        self.write_properties(f)?;
        if let Some(casimirs) = &self.casimirs {
            casimirs.write(f)?;
        }
        if let Some(problem) = &self.problem {
            row(f, "damping", format!("{}; {}", problem.damping, problem.integral))?;
            let text = match (problem.radius, &self.bound) {
                (Some(radius), Some(Bound { minimum, .. })) => {
                    let inside =
                        if minimum.in_domain_only { " while they are in the domain" } else { "" };
                    format!("stay within ‖y‖ ≤ {}{inside}", length(radius))
                }
                _ => "no bound was found".into(),
            };
            row(f, "paths", text)?;
        }
        self.write_theory(f)?;
        let list = |lines: &[String]| lines.join("\n  - ");
        if !self.undecided.is_empty() {
            writeln!(f, "Cannot tell\n  - {}", list(&self.undecided))?;
        }
        if !self.mistakes.is_empty() {
            return write!(f, "Mistakes\n  - {}", list(&self.mistakes));
        }
        let inexact = self.hamiltonians.discrete_gradient.fails();
        write!(f, "No mistakes found{}.", if inexact { " but the error of ∇̄h" } else { "" })
    }
}

/// Lists of names that have the same words.
fn grouped<'a>(all: impl Iterator<Item = (&'a str, String)>) -> Vec<(String, String)> {
    let mut groups: Vec<(String, String)> = Vec::new();
    for (name, words) in all {
        match groups.iter_mut().find(|(same, _)| *same == words) {
            Some((_, names)) => *names += &format!(", {name}"),
            None => groups.push((words, name.into())),
        }
    }
    groups
}

impl Inspection {
    fn write_properties(&self, f: &mut Formatter<'_>) -> Result {
        let h = &self.hamiltonians;
        row(f, "B(y)", &self.structure)?;
        for (m, shape) in h.shapes.iter().enumerate() {
            match h.noise_size {
                Some(c) if m == 1 => row(f, "H1", format!("c H0 up to a constant, c = {c}"))?,
                _ => row(f, &format!("H{m}"), shape)?,
            }
        }
        let not_exact = format!("NOT exact: relative error {:.1e}", h.quadrature_error);
        // The combining macron takes a character, but no width.
        row(f, "∇̄h ", format!(" {}", h.discrete_gradient.words("exact", &not_exact)))?;
        if self.noises > 1 {
            let (yes, no) = ("commute", "do not commute: strong order 1 needs Lévy areas");
            row(f, "noises", self.noise.commute.words(yes, no))?;
        }
        let claims = self.invariants.iter().map(|invariant| {
            let ClaimedInvariant { name, formula, shape, .. } = invariant;
            let kind = if invariant.claimed_casimir { "Casimir" } else { "energy" };
            let status = match invariant.status() {
                Status::Fails => "WRONG, see below",
                status => status.name(),
            };
            format!("{name:<9}{formula}: {kind} ({status}); {shape}")
        });
        // Every part of a lattice claims the same.
        let mut claims: Vec<String> = claims.collect();
        let all = claims.len();
        claims.dedup();
        claims.iter().try_for_each(|claim| writeln!(f, "  {claim}"))?;
        if claims.len() < all {
            row(f, "", format!("{all} claims of this kind"))?;
        }
        Ok(())
    }

    fn write_theory(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(f, "Which statements of the paper apply")?;
        for Theorem { statement, says, applies, because } in &self.theorems {
            let applies = match applies {
                Applies::Yes => "yes",
                Applies::Conditionally => "conditional",
                Applies::No => "no",
            };
            writeln!(f, "  {applies:<13}  {statement}: {says}\n{:17}{because}", "")?;
        }
        let orders = self.orders.iter().map(|ExpectedOrder { scheme, strong, weak, known }| {
            let known = if known.holds() { "" } else { " at least" };
            (*scheme, format!("{strong}{known} / {weak}"))
        });
        writeln!(f, "Expected orders, strong / weak")?;
        for (order, schemes) in grouped(orders) {
            writeln!(f, "  {order}: {schemes}")?;
        }
        let constant = self.schemes.structure == Linearity::Constant;
        let named = self.orders.iter().filter_map(|order| BuiltIn::named(order.scheme));
        let over = named.map(|scheme| (scheme.id(), scheme.long_times(constant).to_owned()));
        writeln!(f, "Over long times")?;
        for (words, schemes) in grouped(over) {
            writeln!(f, "  {schemes}: {words}")?;
        }
        self.write_advice(f)
    }

    fn write_advice(&self, f: &mut Formatter<'_>) -> Result {
        if let Some(solvability) = &self.solvability {
            solvability.write(f)?;
        }
        let Schemes { structure, sexp_li_refused, truncates, .. } = &self.schemes;
        match sexp_li_refused {
            Some(reason) => writeln!(f, "{reason}")?,
            None => {
                let solved = match truncates {
                    true => "a step may have no solution, so increments are truncated",
                    false => "every step has a solution",
                };
                writeln!(f, "sexp-li applies: B is {} in y, {solved}", word(*structure))?;
            }
        }
        for Recommendation { purpose, scheme, because } in &self.recommended {
            writeln!(f, "Take {scheme} for {}: {because}", purpose.replace('-', " "))?;
        }
        if self.schemes.split_refused.is_none() {
            writeln!(f, "split applies: the flows of parts are known")?;
        } else if self.has_casimirs() {
            writeln!(f, "split keeps every Casimir, if you can write the flows of parts of H")?;
        }
        Ok(())
    }
}

impl Casimirs {
    fn write(&self, f: &mut Formatter<'_>) -> Result {
        let Self { found, complete, definite, quadratic_sought, logarithmic } = self;
        let sought = if *quadratic_sought { "linear or quadratic" } else { "linear" };
        let none = match (found.is_empty(), complete) {
            (true, true) => " none",
            (true, false) => " none found",
            _ => "",
        };
        writeln!(f, "  Casimirs of B, {sought}, coefficients to six digits:{none}")?;
        for FoundCasimir { formula, form, minimum, casimir } in found.iter().take(LISTED) {
            let degree = form.degree;
            writeln!(f, "    {formula}; degree {degree}, m = {minimum}; B∇C = 0 {casimir}")?;
        }
        if found.len() > LISTED {
            writeln!(f, "    and {} more", found.len() - LISTED)?;
        }
        for FoundCasimir { formula, minimum, .. } in definite.iter().filter(|_| found.len() > 1) {
            let formula = if found.len() > LISTED { "of all" } else { formula };
            writeln!(f, "    a positive definite sum: {formula}, m = {minimum}")?;
        }
        logarithmic.iter().try_for_each(|LogarithmicCasimir { formula, casimir, .. }| {
            writeln!(f, "  and with logarithms: {formula}; B∇C = 0 {casimir}")
        })
    }
}

impl Solvability {
    fn write(&self, f: &mut Formatter<'_>) -> Result {
        let Self { points, region, .. } = self;
        let steps = [1, 2, 4].map(|k| (k, self.largest_step(k)));
        if steps[0].1 < USELESS_STEP {
            return writeln!(
                f,
                "Implicit steps of sexp: no useful bound of τ, the norms at {points} points with \
                 {region} are too large\n  (a singular point?); the solver reports a step that it \
                 cannot solve"
            );
        }
        let steps = steps.map(|(k, step)| format!("{step:.1e} for k = {k}")).join(", ");
        writeln!(
            f,
            "Implicit steps of sexp are contractions, C(k, τ) < 1, for τ below\n  {steps}\n  by the \
             largest norms found at {points} points with {region}"
        )
    }
}

impl Finding {
    /// `yes` if it holds, `yes?` if that cannot be told, else `no`; with the finding.
    fn words(&self, yes: &str, no: &str) -> String {
        match self.status {
            Status::Fails => format!("{no} ({self})"),
            Status::Unknown => format!("{yes}? ({self})"),
            Status::Holds => format!("{yes} ({self})"),
        }
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { status, defect, at, .. } = self;
        match status {
            _ if self.points == 0 => f.write_str("not looked at"),
            Status::Holds if *defect == 0.0 => f.write_str("exactly"),
            Status::Holds => write!(f, "to {defect:.0e} of its terms"),
            Status::Unknown => write!(f, "cannot tell: {defect:.0e} of its terms at {}", point(at)),
            Status::Fails => write!(f, "off by {defect:.1e} of its terms at {}", point(at)),
        }
    }
}

/// A point, of which the first components are printed.
fn point(at: &[f64]) -> String {
    match at {
        [_, _, _, _, _, _, _, _, _, ..] => {
            format!("[{:.3}, {:.3}, {:.3}, …]", at[0], at[1], at[2])
        }
        all => format!("{all:.3?}"),
    }
}

/// The next line of a row.
const LINE: &str = "\n           ";

/// A length with four decimals, or digits where these say little.
fn length(x: f64) -> String {
    if x == 0.0 || (0.01..1e6).contains(&x) { format!("{x:.4}") } else { format!("{x:.4e}") }
}

/// A property with its label.
fn row(f: &mut Formatter<'_>, label: &str, text: impl Display) -> Result {
    writeln!(f, "  {label:<9}{text}")
}

impl Display for Region {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Box(half_side) => write!(f, "|yᵢ| ≤ {half_side}"),
            Self::Ball(radius) => write!(f, "‖y‖ ≤ {}", length(*radius)),
            Self::Near => f.write_str("|yᵢ| near that of y₀, along random directions"),
        }
    }
}

impl Display for Structure {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { linear, skew, constant, jacobi, .. } = self;
        if linear.fails() {
            return write!(f, "structure(y, v) is NOT linear in v, see below");
        }
        let skew = skew.words("skew-symmetric", "NOT skew-symmetric, see below");
        let constant = match constant.status {
            Status::Fails => "depends on y".into(),
            _ => constant.words("constant", ""),
        };
        let jacobi = jacobi.words("Jacobi identity", "no Jacobi identity, not needed");
        write!(f, "{skew}{LINE}{constant}; {jacobi}")
    }
}

impl Display for Minimum {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { value, error, positive, in_domain_only } = *self;
        match positive {
            Status::Unknown if value.abs() <= error => write!(f, "0 to {error:.0e}")?,
            Status::Unknown => write!(f, "{value:.1e}, sign cannot be told")?,
            Status::Fails => write!(f, "{value:.4e}")?,
            Status::Holds => write!(f, "{value:.4e} > 0")?,
        }
        f.write_str(if in_domain_only { " on the domain" } else { "" })
    }
}

impl Display for Shape {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { kind, degree, homogeneous, minimum, .. } = self;
        f.write_str(kind.name())?;
        if let Some(degree) = degree {
            let separator = if *kind == Kind::Homogeneous { " of" } else { "," };
            write!(f, "{separator} degree {degree}")?;
        }
        if *kind != Kind::Zero {
            write!(f, " ({homogeneous})")?;
        }
        minimum.map_or(Ok(()), |minimum| write!(f, ", m = {minimum}"))
    }
}
