//! Expectations in words.

use std::{fmt, mem::discriminant};

use super::report::{Estimate, Expectation, Warning};

/// Each expectation with its interval and the parts of it, what it cost, decisions and warnings.
impl fmt::Display for Expectation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scheme, estimates, accuracy, cost, levels, decisions, warnings } = self;
        let names: Vec<String> = estimates.iter().map(|one| format!("E[{}]", one.name)).collect();
        let longest = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        for (estimate, name) in estimates.iter().zip(&names) {
            writeln!(f, "{name:longest$} = {estimate}")?;
        }
        let finest = levels.iter().map(|level| level.tau).fold(f64::INFINITY, f64::min);
        let cost = *cost as f64;
        writeln!(f, "{scheme} with steps down to {finest:.2e}, {cost:.2e} path-steps")?;
        for decision in decisions {
            writeln!(f, "{decision}")?;
        }
        for (n, warning) in warnings.iter().enumerate() {
            let alike = |other: &&Warning| {
                other.observable().is_some() && discriminant(*other) == discriminant(warning)
            };
            if warnings[..n].iter().any(|before| alike(&before)) {
                continue;
            }
            write!(f, "warning: {warning}")?;
            let others = warnings[n + 1..].iter().filter(alike).filter_map(Warning::observable);
            let others: Vec<&str> =
                others.filter(|one| Some(*one) != warning.observable()).collect();
            if !others.is_empty() {
                write!(f, "; the same of {}", others.join(", "))?;
            }
            writeln!(f)?;
        }
        if !self.reached() {
            writeln!(f, "the accuracy {accuracy:.1e} was NOT reached")?;
        }
        Ok(())
    }
}

/// The value to two digits of the half-width, and the parts of that.
impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let half_width = self.half_width();
        let decimals = match half_width > 0.0 && half_width.is_finite() {
            true => (1.0 - half_width.log10().floor()).clamp(0.0, 17.0) as usize,
            false => 6,
        };
        let sampling = f64::hypot(self.quantile * self.standard_error, self.missed);
        write!(
            f,
            "{:.decimals$} ± {half_width:.1e} (95 %): sampling {sampling:.1e}, bias at most {:.1e}",
            self.value, self.bias_bound
        )?;
        if self.judged.all() { Ok(()) } else { write!(f, "; NOT to be believed") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expect::{Judged, Limit};

    #[test]
    fn an_expectation_says_what_it_is_and_what_it_lacks() {
        let estimate = |name: &str, standard_error: f64| Estimate {
            name: name.into(),
            value: 0.123_456_789,
            standard_error,
            quantile: 2.0,
            bias: 0.0,
            bias_bound: 3e-5,
            missed: 0.0,
            alpha: None,
            beta: None,
            failed: 0,
            judged: Judged { variance: true, bias: true, resolution: true },
        };
        let mut found = Expectation {
            scheme: "sexp",
            estimates: vec![estimate("y1", 2e-5), estimate("cos y1", 0.0)],
            accuracy: 1e-4,
            cost: 1234,
            levels: Vec::new(),
            decisions: vec!["a reason".into()],
            warnings: Vec::new(),
        };
        let text = found.to_string();
        let first = "E[y1]     = 0.123457 ± 7.0e-5 (95 %): sampling 4.0e-5, bias at most 3.0e-5\n";
        assert!(found.reached() && text.starts_with(first), "{text}");
        assert!(text.contains("\nE[cos y1] = 0.123457 ± 3.0e-5"), "{text}");
        assert!(text.ends_with("path-steps\na reason\n") && text.contains("1.23e3"), "{text}");

        found.warnings.push(Warning::Limit(Limit::Cost { max_cost: 1000 }));
        found.estimates[0].missed = 1e-3;
        found.estimates[1].judged.bias = false;
        let text = found.to_string();
        assert!(text.contains("± 1.0e-3 (95 %): sampling 1.0e-3"), "{text}");
        assert!(text.contains("bias at most 3.0e-5; NOT to be believed\n"), "{text}");
        let last = "warning: the accuracy was not reached with the 1000 path-steps allowed\nthe \
                    accuracy 1.0e-4 was NOT reached\n";
        assert!(text.ends_with(last), "{text}");
    }
}
