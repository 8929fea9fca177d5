//! The report as text.

use std::fmt::{Display, Formatter, Result};

use super::{
    Applies, Casimirs, ClaimedInvariant, ExpectedOrder, Fields, Finding, FoundCasimir, Inspection,
    Minimum, ProblemFindings, Recommendation, Region, Shape, Status, Structure, Theorem,
};
use crate::facts::TIME;

/// Largest number of Casimirs and of claims that are printed.
const LISTED: usize = 12;

impl Display for Inspection {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        writeln!(f, "{}", self.lines().join("\n"))?;
        let lists = [("Cannot tell", &self.undecided), ("Mistakes", &self.mistakes)];
        for (head, list) in lists.iter().filter(|(_, list)| !list.is_empty()) {
            writeln!(f, "{head}\n  - {}", list.join("\n  - "))?;
        }
        f.write_str(if self.mistakes.is_empty() { "No mistakes found." } else { "" })
    }
}

/// Formats a property with its label.
fn row(label: &str, text: impl Display) -> String {
    format!("  {label:<9}{text}")
}

impl Inspection {
    fn lines(&self) -> Vec<String> {
        let Self { system, dimension, noises, points, region, hamiltonians: h, .. } = self;
        let domain = if self.defined_everywhere { "" } else { " in its domain" };
        let head =
            format!("{system}: D = {dimension}, M = {noises}; {points} points with {region}");
        let mut lines = vec![head + domain];
        match &self.fields {
            None => lines.push(row("B(y)", &self.structure)),
            Some(fields) => lines.extend(fields.lines(*noises)),
        }
        let shapes = h.shapes.iter().enumerate();
        lines.extend(shapes.map(|(m, shape)| row(&format!("H{m}"), shape)));
        if h.discrete_gradient.points > 0 {
            let not_exact = format!(
                "by quadrature: relative error {:.1e} over a tenth of the region, less in a step",
                h.quadrature_error
            );
            // The combining macron takes a character, but no width.
            lines.push(row("∇̄h ", format!(" {}", h.discrete_gradient.words("exact", &not_exact))));
        }
        if *noises > 0 && self.fields.is_none() {
            lines
                .push(row("noises", h.proportional.words("multiples of H0", "no multiples of H0")));
        }
        if *noises > 1 {
            let (yes, no) = ("commute", "do not commute: strong order 1 needs Lévy areas");
            lines.push(row("", self.noise.commute.words(yes, no)));
        }
        if h.depend_on_time {
            let words = match self.fields {
                None => "H depends on it, B does not: Casimirs are kept, energies are not",
                Some(_) => "the fields depend on it",
            };
            lines.push(row("time", format!("{words}; seen at t = {TIME}")));
        }
        let claims = self.invariants.iter().map(|invariant| {
            let ClaimedInvariant { name, formula, shape, .. } = invariant;
            let kind = if invariant.claimed_casimir { "Casimir" } else { "energy" };
            let status = invariant.status().words(["WRONG, see below", "cannot tell", "holds"]);
            row(name, format!("{formula}: {kind} ({status}); {shape}"))
        });
        lines.extend(some(claims));
        lines.extend(match &self.casimirs {
            Some(casimirs) => casimirs.lines(self.fields.is_some()),
            None => vec![row("Casimirs", "not searched in so large a system")],
        });
        if let Some(ProblemFindings { damping, integral, radius }) = &self.problem {
            lines.push(row("damping", format!("{damping}; {integral}")));
            let in_domain_only = self.bound.as_ref().is_some_and(|b| b.minimum.in_domain_only);
            let inside = if in_domain_only { " while they are in the domain" } else { "" };
            let bound = radius.map(|r| format!("stay within ‖y‖ ≤ {}{inside}", length(r)));
            lines.push(row("paths", bound.as_deref().unwrap_or("no bound was found")));
        }
        if !self.theorems.is_empty() {
            lines.push("Statements of the paper".into());
        }
        lines.extend(grouped(self.theorems.iter().map(|Theorem { statement, applies }| {
            let applies = match applies {
                Applies::Yes => "they apply",
                Applies::Conditionally => "under a condition",
                Applies::No => "they do not apply",
            };
            (*statement, applies.to_owned())
        })));
        lines.push("Expected orders, strong / weak".into());
        lines.extend(grouped(self.orders.iter().map(|order| {
            let ExpectedOrder { scheme, strong, weak, known } = order;
            let known = if known.holds() { "" } else { " at least" };
            (*scheme, format!("{strong}{known} / {weak}"))
        })));
        lines.extend(self.recommended.iter().map(|Recommendation { purpose, scheme, because }| {
            format!("Take {scheme} for {purpose}: {because}")
        }));
        lines
    }
}

/// Groups names by their words, one line per group.
fn grouped<'a>(all: impl Iterator<Item = (&'a str, String)>) -> Vec<String> {
    let mut lines: Vec<(String, String)> = Vec::new();
    for (name, words) in all {
        match lines.iter_mut().find(|(same, _)| *same == words) {
            Some((_, names)) => *names += &format!(", {name}"),
            None => lines.push((words, name.into())),
        }
    }
    lines.iter().map(|(words, names)| format!("  {words}: {names}")).collect()
}

/// The first lines of a list; every part of a lattice claims the same.
fn some(lines: impl Iterator<Item = String>) -> Vec<String> {
    let mut lines: Vec<String> = lines.collect();
    let all = lines.len();
    lines.dedup();
    lines.truncate(LISTED);
    if lines.len() < all {
        lines.push(format!("    and {} more", all - lines.len()));
    }
    lines
}

impl Casimirs {
    fn lines(&self, plain: bool) -> Vec<String> {
        let Self { found, complete, definite, logarithmic } = self;
        let (what, identity) = match plain {
            true => ("Functions that all fields keep", "f·∇C"),
            false => ("Casimirs of B", "B∇C"),
        };
        let others = match (found.is_empty(), complete) {
            (true, true) => ": none",
            (false, true) => "",
            (_, false) => "; there may be others",
        };
        let line = |FoundCasimir { formula, minimum, casimir, .. }: &FoundCasimir| {
            format!("    {formula}; m = {minimum}; {identity} = 0 {casimir}")
        };
        let mut lines = vec![format!("  {what}, linear or quadratic{others}")];
        lines.extend(some(found.iter().map(line)));
        for FoundCasimir { formula, minimum, .. } in definite.iter().filter(|_| found.len() > 1) {
            let formula = if found.len() > LISTED { "of all" } else { formula };
            lines.push(format!("    a positive definite sum: {formula}, m = {minimum}"));
        }
        lines.extend(logarithmic.iter().map(line));
        lines
    }
}

impl Fields {
    fn lines(&self, noises: usize) -> Vec<String> {
        let volume = self.divergence.words("none, volume is kept", "of some field");
        let additive = self.additive.words("additive", "multiplicative");
        let all = [row("∇·f", volume), row("noises", additive)];
        all.into_iter().take(if noises > 0 { 2 } else { 1 }).collect()
    }
}

impl Finding {
    /// Answers `yes` if the finding holds, `yes?` if it is undecided, else `no`; adds the finding.
    fn words(&self, yes: &str, no: &str) -> String {
        let answer = self.status.words([no, yes, yes]);
        format!("{answer}{} ({self})", self.status.words(["", "?", ""]))
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { status, defect, at, points, .. } = self;
        match status {
            _ if *points == 0 => f.write_str("not looked at"),
            Status::Holds if *defect == 0.0 => f.write_str("exactly"),
            Status::Holds => write!(f, "to {defect:.0e} of its terms"),
            Status::Unknown => write!(f, "cannot tell: {defect:.0e} of its terms at {}", point(at)),
            Status::Fails => write!(f, "off by {defect:.1e} of its terms at {}", point(at)),
        }
    }
}

/// Formats a point; of more than eight components the first three are printed.
fn point(at: &[f64]) -> String {
    if at.len() > 8 { format!("{:.3?}…", &at[..3]) } else { format!("{at:.3?}") }
}

/// Formats a length with four decimals, or in scientific notation where these say little.
fn length(x: f64) -> String {
    if x == 0.0 || (0.01..1e6).contains(&x) { format!("{x:.4}") } else { format!("{x:.4e}") }
}

impl Display for Region {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Box(half_side) => write!(f, "|yᵢ| ≤ {half_side}"),
            Self::Ball(radius) => write!(f, "‖y‖ ≤ {}", length(*radius)),
            Self::Near => f.write_str("y near y₀, along random directions"),
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
        write!(f, "{skew}; {constant}; {jacobi}")
    }
}

impl Display for Minimum {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self.positive {
            Status::Unknown => write!(f, "about 0")?,
            known => write!(f, "{:.4e}{}", self.value, known.words(["", "", " > 0"]))?,
        }
        f.write_str(if self.in_domain_only { " on the domain" } else { "" })
    }
}

impl Display for Shape {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { degree, homogeneous, minimum } = self;
        match degree {
            Some(degree) => write!(f, "homogeneous of degree {degree} ({homogeneous})")?,
            None if self.is_zero() => f.write_str("zero")?,
            None if homogeneous.fails() => write!(f, "not homogeneous ({homogeneous})")?,
            None => write!(f, "cannot tell whether homogeneous ({homogeneous})")?,
        }
        minimum.map_or(Ok(()), |minimum| write!(f, ", m = {minimum}"))
    }
}
