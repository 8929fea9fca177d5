//! The report in words.

use std::fmt;

use super::expected::Applies;
use super::finding::Finding;
use super::points::Region;
use super::shape::{Kind, Minimum, Shape};
use super::{Inspection, Structure};

/// The discrete gradient may be a quadrature; worse than this it is a mistake, since a step is
/// shorter than the distance at which it was looked at.
const POOR_QUADRATURE: f64 = 1e-3;

/// Everything that is wrong.
pub(super) fn mistakes(inspection: &Inspection) -> Vec<String> {
    let Inspection { structure, hamiltonians, noise, .. } = inspection;
    let mut mistakes = Vec::new();
    let mut must = |finding: &Finding, what: &str| {
        if !finding.holds {
            mistakes.push(format!("{what}: relative defect {}", Defect(finding)));
        }
    };
    must(&structure.linear, "structure(y, v) is not linear in v");
    must(&structure.skew, "B(y) is not skew-symmetric");
    must(&hamiltonians.linear, "energy(y, dt, dw) is not linear in (dt, dw)");
    must(&hamiltonians.gradient, "gradient is not the gradient of energy");
    must(
        &hamiltonians.averaged_gradient,
        "averaged_gradient(y, y) is not the gradient of energy at y",
    );
    must(
        &hamiltonians.averaged_field,
        "averaged_field(a, b) is not structure((a+b)/2, averaged_gradient(a, b))",
    );
    must(
        &hamiltonians.short_step,
        "short_step does not solve b = a + averaged_field(a, b) within the bound that it gives",
    );
    must(
        &hamiltonians.short_steps,
        "short_steps is not short_step of each of its two paths, to the bit",
    );
    must(&noise.commutators, "commutators is not what follows from B and the energy");
    if hamiltonians.discrete_gradient.defect > POOR_QUADRATURE {
        must(
            &hamiltonians.discrete_gradient,
            "averaged_gradient(a, b)·(b − a) is not the change of energy",
        );
    }
    for invariant in &inspection.invariants {
        mistakes.extend(invariant.mistakes.iter().cloned());
    }
    if let Some(problem) = inspection.problem.as_ref().filter(|problem| !problem.integral_agrees) {
        mistakes.push(format!(
            "integral of the damping is not the integral of its rate: {}",
            Defect(&problem.integral)
        ));
    }
    mistakes
}

/// `2.0e0 at y = (0.31, −1.2)`.
struct Defect<'a>(&'a Finding);

impl fmt::Display for Defect<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Finding { defect, at, .. } = self.0;
        let at: Vec<String> = at.iter().map(|x| format!("{x:.3}")).collect();
        write!(f, "{defect:.1e} at ({})", at.join(", "))
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Box(half_side) => write!(f, "|yᵢ| ≤ {half_side}"),
            Self::Ball(radius) => write!(f, "‖y‖ ≤ {radius:.4}"),
        }
    }
}

impl fmt::Display for Structure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.linear.holds {
            return write!(f, "structure(y, v) is NOT linear in v, {}", Defect(&self.linear));
        }
        if self.skew.holds {
            write!(f, "skew-symmetric")?;
        } else {
            write!(f, "NOT skew-symmetric, defect {}", Defect(&self.skew))?;
        }
        write!(f, "; {}", if self.constant.holds { "constant" } else { "varies with y" })?;
        if self.jacobi.holds {
            write!(f, "; Jacobi's identity holds: a Poisson structure")
        } else {
            write!(
                f,
                "; Jacobi's identity does not hold (defect {:.1e}), which no statement needs",
                self.jacobi.defect
            )
        }
    }
}

impl fmt::Display for Minimum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { value, positive, in_domain_only } = *self;
        // What is not clearly positive may be round-off.
        let value = if value.abs() < 1e-6 { 0.0 } else { value };
        let domain = if in_domain_only { " on the domain" } else { "" };
        write!(f, "{value:.4}{}{domain}", if positive { " > 0" } else { "" })
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(degree) = self.degree else { return write!(f, "not homogeneous") };
        match self.kind {
            Kind::Homogeneous => write!(f, "homogeneous of degree {degree}")?,
            kind => write!(f, "{}, degree {degree}", kind.word())?,
        }
        self.minimum.map_or(Ok(()), |minimum| write!(f, ", m = {minimum}"))
    }
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plural = |n: usize| if n == 1 { "" } else { "s" };
        writeln!(
            f,
            "{}: {} dimension{}, {} noise{}; seen at {} points with {}{}",
            self.system,
            self.dimension,
            plural(self.dimension),
            self.noises,
            plural(self.noises),
            self.points,
            self.region,
            if self.defined_everywhere { "" } else { " where it is defined" }
        )?;
        writeln!(f, "  B(y)     {}", self.structure)?;
        for (m, shape) in self.hamiltonians.shapes.iter().enumerate() {
            match self.hamiltonians.noise_size {
                Some(c) if m == 1 => writeln!(f, "  H1       c H0 with c = {c}")?,
                _ => writeln!(f, "  H{m:<8}{shape}")?,
            }
        }
        let gradient = &self.hamiltonians.discrete_gradient;
        if gradient.holds {
            writeln!(f, "  ∇̄h       exact: ∇̄h(a, b)·(b − a) = h(b) − h(a) to round-off")?;
        } else {
            writeln!(
                f,
                "  ∇̄h       by quadrature, relative error {:.1e} a tenth of the region apart",
                gradient.defect
            )?;
        }
        if self.noises > 1 {
            let commute = self.noise.commute.holds;
            let words = if commute {
                "commute: no Lévy areas needed"
            } else {
                "do not commute: strong order 1 takes Lévy areas"
            };
            writeln!(f, "  noises   {words}")?;
        }
        for invariant in &self.invariants {
            let kind = if invariant.claimed_casimir { "Casimir" } else { "energy" };
            let verdict = if invariant.mistakes.is_empty() {
                kind.to_owned()
            } else {
                format!("claimed as {kind}: WRONG, see below")
            };
            writeln!(
                f,
                "  {:<9}{}: {verdict}; {}",
                invariant.name, invariant.formula, invariant.shape
            )?;
        }
        if self.casimirs.found.is_empty() {
            writeln!(f, "  Casimirs of B, linear or quadratic: none")?;
        } else {
            writeln!(f, "  Casimirs of B, linear or quadratic:")?;
        }
        for casimir in &self.casimirs.found {
            writeln!(
                f,
                "    {}; degree {}, m = {}",
                casimir.formula, casimir.degree, casimir.minimum
            )?;
        }
        if let Some(sum) = self.casimirs.definite.as_ref().filter(|_| self.casimirs.found.len() > 1)
        {
            writeln!(f, "    among their sums {}, m = {}", sum.formula, sum.minimum)?;
        }
        if !self.casimirs.quadratic_sought {
            writeln!(f, "    (quadratic ones were not looked for in so many dimensions)")?;
        }
        if let Some(problem) = &self.problem {
            let agrees = if problem.integral_agrees {
                "its integral agrees with it"
            } else {
                "its integral is WRONG, see below"
            };
            writeln!(f, "  damping  {}; {agrees}", problem.damping)?;
            match problem.radius {
                Some(radius) => writeln!(f, "  paths    stay within ‖y‖ ≤ {radius:.4}")?,
                None => writeln!(f, "  paths    nothing found that bounds them")?,
            }
        }
        writeln!(f, "Which of the paper's statements apply")?;
        for theorem in &self.theorems {
            let applies = match theorem.applies {
                Applies::Yes => "yes",
                Applies::InDomain => "in the domain",
                Applies::Conditionally => "depends",
                Applies::No => "no",
            };
            writeln!(f, "  {applies:<13}  {}: {}", theorem.statement, theorem.says)?;
            writeln!(f, "                 {}", theorem.because)?;
        }
        writeln!(f, "Orders to expect, strong / weak")?;
        let orders: Vec<String> = self
            .orders
            .iter()
            .map(|order| format!("{} {} / {}", order.scheme, order.strong, order.weak))
            .collect();
        writeln!(f, "  {}", orders.join(",  "))?;
        let steps: Vec<String> = [1, 2, 4]
            .iter()
            .map(|&k| format!("{:.1e} for k = {k}", self.solvability.largest_step(k)))
            .collect();
        writeln!(
            f,
            "Sufficient for sexp: C(k, τ) < 1 in {} for τ up to {}",
            self.solvability_region,
            steps.join(", ")
        )?;
        if self.mistakes.is_empty() {
            write!(f, "No mistakes found.")
        } else {
            write!(f, "Mistakes")?;
            for mistake in &self.mistakes {
                write!(f, "\n  - {mistake}")?;
            }
            Ok(())
        }
    }
}
