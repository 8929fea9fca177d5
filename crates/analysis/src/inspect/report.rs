//! The report: its data and its text.

use std::fmt::{Display, Formatter, Result};

use serde::Serialize;
use systems::Linearity;

use super::{
    advice::{Override, WithoutIteration, word},
    casimirs::{Casimirs, FoundCasimir},
    damping::DampingIntegral,
    erased::System,
    finding::{Finding, Status},
    function::{Kind, Minimum, Shape},
    hamiltonian::Hamiltonians,
    invariants::ClaimedInvariant,
    logarithms::LogarithmicCasimir,
    noises::Noises,
    pilot::Pilot,
    points::{Points, Region},
    problem::{Bound, ProblemFindings},
    recommendation::{Recommendation, long_times, recommendations},
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
    /// What `sexp-li` and `nv` say of the system.
    pub without_iteration: WithoutIteration,
    /// The schemes to take, that for paths first.
    pub recommended: Vec<Recommendation>,
    /// The methods that are worth writing out.
    pub overrides: Vec<Override>,
    /// Every property that a system must have or claims and that was found wrong, in words; empty
    /// for a sound system.
    pub mistakes: Vec<String>,
    /// Every property that a system must have and that cannot be told, in words with the reason.
    pub undecided: Vec<String>,
}

/// Whose quadrature `averaged_gradient` is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Quadrature {
    /// That of the system, which may be wrong.
    OfTheSystem,
    /// Our own, of a system from texts.
    Ours,
}

/// Least relative error of `averaged_gradient` that is a mistake and not that of a quadrature: the
/// points of the check are further apart than a step is long.
const POOR_QUADRATURE: f64 = 1e-3;

/// A bound of the step size below this helps no one.
const USELESS_STEP: f64 = 1e-6;

impl Inspection {
    /// The report on a system alone.
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let structure = Structure::of(system, points);
        let hamiltonians = Hamiltonians::of(system, points);
        let noise = Noises::of(system, points);
        let invariants = ClaimedInvariant::all(system, points);
        let casimirs = Casimirs::of(system, points);
        let bound = Bound::of(&structure, &hamiltonians, &casimirs);
        let without_iteration = system.without_iteration(&points.for_identities[0]);
        Self {
            system: system.name().into(),
            dimension: system.dimension(),
            noises: system.noises(),
            region: points.region.clone(),
            points: points.for_identities.len(),
            pilot: points.pilot,
            defined_everywhere: points.everywhere,
            solvability: Solvability::of(system, points),
            problem: None,
            theorems: theorems(
                &structure,
                &hamiltonians,
                &casimirs,
                &noise,
                &invariants,
                bound.as_ref(),
            ),
            orders: orders(&noise, without_iteration.draws_areas),
            without_iteration,
            recommended: Vec::new(),
            overrides: system.overrides(&points.for_identities),
            mistakes: Vec::new(),
            undecided: Vec::new(),
            structure,
            hamiltonians,
            noise,
            invariants,
            casimirs,
            bound,
        }
        .with_recommendations(true)
    }

    /// With the schemes to take, with damping or without.
    pub(super) fn with_recommendations(mut self, damped: bool) -> Self {
        self.recommended = recommendations(&self, damped);
        self
    }

    /// Lists what is wrong, and what cannot be told.
    pub(super) fn with_mistakes(mut self, quadrature: Quadrature) -> Self {
        let Self { structure, hamiltonians: h, noise, invariants, .. } = &self;
        let check = |finding: &Finding, what| (finding.status, format!("{what}: {finding}"));
        let mut checks = vec![
            check(&structure.linear, "structure(y, v) is not linear in v"),
            check(&structure.skew, "B(y) is not skew-symmetric"),
            check(&h.linear, "energy(y, dt, dw) is not linear in (dt, dw)"),
            check(&h.gradient, "gradient is not the gradient of energy"),
            check(
                &h.averaged_gradient,
                "averaged_gradient(y, y) is not the gradient of energy at y",
            ),
            check(
                &h.averaged_field,
                "averaged_field(a, b) is not structure((a+b)/2, averaged_gradient(a, b))",
            ),
            check(
                &h.prediction,
                "the residual of the predicted step exceeds the bound given with it",
            ),
            check(&noise.commutators, "commutators is not what follows from B and the energy"),
        ];
        // The error of a quadrature is no mistake.
        let poor = quadrature == Quadrature::OfTheSystem && h.quadrature_error > POOR_QUADRATURE;
        if !h.discrete_gradient.refuted() || poor {
            let what = "averaged_gradient(a, b)·(b − a) is not the change of energy";
            checks.push(check(&h.discrete_gradient, what));
        }
        if let Some(ProblemFindings { integral, .. }) = &self.problem {
            let what = "the integral of the damping is not the integral of its rate";
            checks.push((integral.agrees, format!("{what}: {integral}")));
        }
        let all = |status| checks.iter().filter(move |check| check.0 == status);
        let mistakes = all(Status::Refuted).map(|check| check.1.clone());
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

    /// Whether a statement of the paper applies, by its identifier; `None` if it is about systems
    /// with another number of noises.
    pub fn applies(&self, statement: &str) -> Option<Applies> {
        let theorem = self.theorems.iter().find(|theorem| theorem.statement == statement)?;
        Some(theorem.applies)
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
        self.write_casimirs(f)?;
        if let Some(problem) = &self.problem {
            row(f, "damping", format!("{}; {}", problem.damping, problem.integral))?;
            match (problem.radius, &self.bound) {
                (Some(radius), Some(bound)) => {
                    let inside = if bound.minimum.in_domain_only {
                        " while they are in the domain"
                    } else {
                        ""
                    };
                    let found = match bound.status {
                        Status::Shown => "",
                        _ => " if that bound, found by search, holds",
                    };
                    let radius = length(radius);
                    row(f, "paths", format!("stay within ‖y‖ ≤ {radius}{inside}{found}"))?;
                }
                _ => row(f, "paths", "no bound was found")?,
            }
        }
        self.write_theory(f)?;
        let list = |lines: &[String]| lines.join("\n  - ");
        if !self.undecided.is_empty() {
            writeln!(f, "Cannot tell\n  - {}", list(&self.undecided))?;
        }
        if !self.mistakes.is_empty() {
            return write!(f, "Mistakes\n  - {}", list(&self.mistakes));
        }
        let but = if self.hamiltonians.discrete_gradient.refuted() {
            " but the error of ∇̄h"
        } else {
            ""
        };
        write!(f, "No mistakes found{but}.")
    }
}

impl Inspection {
    fn write_properties(&self, f: &mut Formatter<'_>) -> Result {
        let h = &self.hamiltonians;
        row(f, "B(y)", &self.structure)?;
        for (m, shape) in h.shapes.iter().enumerate() {
            match (h.noise_size, &h.proportional) {
                (Some(c), Some(finding)) if m == 1 => {
                    row(f, "H1", format!("c H0 up to a constant, c = {c} ({finding})"))?;
                }
                _ => row(f, &format!("H{m}"), shape)?,
            }
        }
        let gradient = &h.discrete_gradient;
        let exact = match gradient.status {
            Status::Refuted => {
                format!("NOT exact: relative error {:.1e} in h(b) − h(a)", h.quadrature_error)
            }
            Status::Unknown => format!("exact? {gradient}"),
            _ => format!("exact ({gradient})"),
        };
        // The combining macron takes a character, but no width.
        row(f, "∇̄h ", format!(" {exact}"))?;
        if self.noises > 1 {
            let commute = &self.noise.commute;
            let text = match commute.status {
                Status::Refuted => "do not commute: strong order 1 needs Lévy areas",
                Status::Unknown => "commute?",
                _ => "commute: strong order 1 needs no Lévy areas",
            };
            row(f, "noises", format!("{text}{LINE}({commute})"))?;
        }
        for invariant in &self.invariants {
            let ClaimedInvariant { name, formula, shape, .. } = invariant;
            let kind = if invariant.claimed_casimir { "Casimir" } else { "energy" };
            let status = match invariant.status() {
                Status::Refuted => "WRONG, see below",
                status => status.name(),
            };
            row(f, name, format!("{formula}: {kind} ({status}); {shape}"))?;
        }
        Ok(())
    }

    fn write_casimirs(&self, f: &mut Formatter<'_>) -> Result {
        let Casimirs { found, nearly, complete, definite, quadratic_sought, logarithmic } =
            &self.casimirs;
        let sought = if *quadratic_sought { "linear or quadratic" } else { "linear" };
        let none = match (found.is_empty(), complete) {
            (true, Status::Shown) => " none (shown)",
            (true, _) => " none found",
            _ => "",
        };
        writeln!(f, "  Casimirs of B, {sought}, coefficients to six digits:{none}")?;
        for FoundCasimir { formula, degree, minimum, casimir, .. } in found {
            writeln!(f, "    {formula}; degree {degree}, m = {minimum}; B∇C = 0 {casimir}")?;
        }
        for FoundCasimir { formula, casimir, .. } in nearly {
            let is = if casimir.refuted() { "not" } else { "perhaps" };
            writeln!(f, "    {is} {formula}: B∇C has {casimir}")?;
        }
        for FoundCasimir { formula, minimum, .. } in definite.iter().filter(|_| found.len() > 1) {
            writeln!(f, "    a positive definite sum: {formula}, m = {minimum}")?;
        }
        logarithmic.iter().try_for_each(|LogarithmicCasimir { formula, casimir, .. }| {
            writeln!(f, "  and with logarithms: {formula}; B∇C = 0 {casimir}")
        })
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
        let mut orders: Vec<(String, Vec<&str>)> = Vec::new();
        for ExpectedOrder { scheme, strong, weak, known } in &self.orders {
            let known = match known {
                Status::Shown => "",
                Status::Found => " (found)",
                _ => " at least",
            };
            let order = format!("{strong}{known} / {weak}");
            match orders.iter_mut().find(|(same, _)| *same == order) {
                Some((_, schemes)) => schemes.push(scheme),
                None => orders.push((order, vec![scheme])),
            }
        }
        let orders: Vec<_> =
            orders.iter().map(|(order, of)| format!("{order}: {}", of.join(", "))).collect();
        writeln!(f, "Expected orders, strong / weak\n  {}", orders.join("\n  "))?;
        let constant = self.without_iteration.structure == Linearity::Constant;
        let mut over: Vec<(&str, Vec<&str>)> = Vec::new();
        for ExpectedOrder { scheme, .. } in &self.orders {
            let words = long_times(scheme, constant);
            match over.iter_mut().find(|(same, _)| *same == words) {
                Some((_, schemes)) => schemes.push(scheme),
                None => over.push((words, vec![scheme])),
            }
        }
        let over: Vec<_> =
            over.iter().map(|(words, of)| format!("{}: {words}", of.join(", "))).collect();
        writeln!(f, "Over long times\n  {}", over.join("\n  "))?;
        self.write_solvability(f)?;
        self.write_advice(f)
    }

    fn write_solvability(&self, f: &mut Formatter<'_>) -> Result {
        let Solvability { points, region, .. } = &self.solvability;
        let steps = [1, 2, 4].map(|k| (k, self.solvability.largest_step(k)));
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

    fn write_advice(&self, f: &mut Formatter<'_>) -> Result {
        let WithoutIteration { structure, refused, truncates, areas_refused, .. } =
            &self.without_iteration;
        match refused {
            Some(reason) => writeln!(f, "{reason}")?,
            None => {
                let solved = if *truncates {
                    "a step may have no solution, so increments are truncated"
                } else {
                    "every step has a solution"
                };
                writeln!(f, "sexp-li applies: B is {} in y, {solved}", word(*structure))?;
            }
        }
        if let (None, Some(reason)) = (refused, areas_refused) {
            writeln!(f, "{reason}")?;
        }
        for Recommendation { purpose, scheme, because } in &self.recommended {
            writeln!(f, "Take {scheme} {}: {because}", purpose.name())?;
        }
        if self.has_casimirs() {
            writeln!(f, "split keeps every Casimir, if you can write the flows of parts of H")?;
        }
        if !self.overrides.is_empty() {
            writeln!(f, "Worth writing out")?;
        }
        for Override { method, schemes, gains } in &self.overrides {
            writeln!(f, "  {method}, for {schemes}: {gains}")?;
        }
        Ok(())
    }

    /// Whether B is sound and a Casimir was found, or is claimed and may be one.
    fn has_casimirs(&self) -> bool {
        let Casimirs { found, logarithmic, .. } = &self.casimirs;
        let mut claims = self.invariants.iter().filter(|claim| claim.claimed_casimir);
        self.structure.sound() != Status::Refuted
            && (!found.is_empty()
                || !logarithmic.is_empty()
                || claims.any(|claim| claim.status() != Status::Refuted))
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { status, defect, round_off, at, points, .. } = self;
        match status {
            Status::Shown if self.points == 0 => write!(f, "shown"),
            Status::Shown => write!(f, "shown, to {round_off:.0e}"),
            Status::Found => write!(f, "found at {points} points, to {round_off:.0e}"),
            Status::Unknown => write!(f, "too much round-off, {round_off:.0e}, at {at:.3?}"),
            Status::Refuted => {
                write!(f, "defect {defect:.1e} at {at:.3?}, round-off {round_off:.0e}")
            }
        }
    }
}

impl Display for DampingIntegral {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { defect, relative, at, given, expected, resolution, .. } = self;
        if self.agrees.holds() {
            write!(
                f,
                "rate and integral agree to {relative:.0e}, pulses below {resolution:.0e} aside"
            )?;
        } else {
            let rough = if self.rough > 0 { ", and the rate jumps or has pulses" } else { "" };
            write!(
                f,
                "rate and integral DISAGREE by {defect:.1e} in a step from t = {at:.4} on\
                 {LINE}∫₀ᵀγ = {given:.6} in 1024 steps, {expected:.6} by quadrature{rough}"
            )?;
        }
        match self.longest_step {
            Some(step) if step < self.t_end => {
                write!(f, "{LINE}and to 1e-6 for steps of {step:.2e}, and of halves of it")
            }
            Some(_) => Ok(()),
            None => write!(f, "{LINE}and not to 1e-6 for steps of T/1024"),
        }
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
        }
    }
}

impl Display for Structure {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { linear, skew, constant, jacobi } = self;
        if linear.refuted() {
            return write!(f, "structure(y, v) is NOT linear in v, see below");
        }
        let is = |finding: &Finding, yes, no| match finding.status {
            Status::Refuted => format!("{no} ({finding})"),
            Status::Unknown => format!("{yes}? ({finding})"),
            _ => format!("{yes} ({finding})"),
        };
        let skew = is(skew, "skew-symmetric", "NOT skew-symmetric, see below");
        let constant = match constant.status {
            Status::Refuted => "depends on y".into(),
            _ => is(constant, "constant", ""),
        };
        let jacobi = is(jacobi, "Jacobi identity", "no Jacobi identity, not needed");
        write!(f, "{skew}{LINE}{constant}; {jacobi}")
    }
}

impl Display for Minimum {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { value, error, positive, in_domain_only } = *self;
        let domain = if in_domain_only { " on the domain" } else { "" };
        match positive {
            Status::Unknown if value.abs() <= error => write!(f, "0 to {error:.0e}")?,
            Status::Unknown => write!(f, "{value:.1e}, sign cannot be told")?,
            Status::Refuted => write!(f, "{value:.4e}")?,
            status => write!(f, "{value:.4e} > 0 ({})", status.name())?,
        }
        f.write_str(domain)
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
        write!(f, " ({homogeneous})")?;
        minimum.map_or(Ok(()), |minimum| write!(f, ", m = {minimum}"))
    }
}
