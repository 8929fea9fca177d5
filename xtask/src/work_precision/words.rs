//! What the numbers say, in words that are made from them.

use precision::results::{Case, StrongSeries, WeakObservable};
use precision::{cost_at, crossing};

use super::curves::{strong_costs, weak_costs};

/// A number in three significant digits, as it is read most easily.
pub fn number(x: f64) -> String {
    if !x.is_finite() || x == 0.0 {
        return format!("{x}");
    }
    match x.abs() {
        size if (99.95..1e5).contains(&size) => format!("{x:.0}"),
        size if (9.995..99.95).contains(&size) => format!("{x:.1}"),
        size if (0.0995..9.995).contains(&size) => format!("{x:.2}"),
        _ => format!("{x:.1e}"),
    }
}

/// Errors 10^{−k/2} that some curve reaches, from large to small.
pub fn targets(curves: &[Vec<(f64, f64)>]) -> Vec<f64> {
    let reached = |error: f64| curves.iter().any(|curve| cost_at(curve, error).is_some());
    (-4..=16).map(|k| 10f64.powf(-0.5 * f64::from(k))).filter(|&error| reached(error)).collect()
}

/// The cheapest curve at an error, by number, among at least two that reach it.
pub fn cheapest(curves: &[Vec<(f64, f64)>], error: f64) -> Option<usize> {
    let costs: Vec<(usize, f64)> = curves
        .iter()
        .enumerate()
        .filter_map(|(n, curve)| Some((n, cost_at(curve, error)?)))
        .collect();
    let best = costs.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (costs.len() > 1).then_some(best.0)
}

/// "`heun` from 1e-1 to 1e-3, `sexp` at 3e-4" for the winners at the targets.
fn winners(names: &[&str], curves: &[Vec<(f64, f64)>]) -> String {
    let mut runs: Vec<(usize, f64, f64)> = Vec::new();
    for error in targets(curves) {
        let Some(best) = cheapest(curves, error) else { continue };
        match runs.last_mut() {
            Some(run) if run.0 == best => run.2 = error,
            _ => runs.push((best, error, error)),
        }
    }
    let words = runs.iter().map(|&(best, from, to)| {
        if from == to {
            format!("`{}` at {}", names[best], number(from))
        } else {
            format!("`{}` from {} to {}", names[best], number(from), number(to))
        }
    });
    let words: Vec<String> = words.collect();
    if words.is_empty() {
        "no error is reached by two schemes".to_owned()
    } else {
        words.join(", ")
    }
}

fn strong_series<'a>(case: &'a Case, scheme: &str) -> Option<&'a StrongSeries> {
    case.strong.series.iter().find(|series| series.scheme == scheme)
}

/// How the costs of two schemes compare at equal strong error: "costs a to b times as much as
/// `other`".
pub fn compared(case: &Case, first: &str, second: &str) -> Option<String> {
    let (one, other) = (strong_series(case, first)?, strong_series(case, second)?);
    let found = crossing(&strong_costs(one), &strong_costs(other))?;
    let fold =
        |pick: fn(f64, f64) -> f64| found.ratios.iter().map(|(_, ratio)| *ratio).reduce(pick);
    let (least, most) = (fold(f64::min)?, fold(f64::max)?);
    let ends = (found.ratios.first()?.0, found.ratios.last()?.0);
    let cost = if (least * 100.0).round() == (most * 100.0).round() {
        format!("{} times", number(least))
    } else {
        format!("{} to {} times", number(least), number(most))
    };
    Some(format!(
        "between the errors {} and {}, which both reach, `{first}` costs {cost} what `{second}` costs",
        number(ends.0),
        number(ends.1)
    ))
}

/// The strong conclusion of a case in a sentence or three.
pub fn strong(case: &Case) -> String {
    let names: Vec<&str> = case.strong.series.iter().map(|series| series.scheme.as_str()).collect();
    let curves: Vec<Vec<(f64, f64)>> = case.strong.series.iter().map(strong_costs).collect();
    let mut text = format!("Cheapest for a strong error: {}.", winners(&names, &curves));
    let pairs = [("sexp", "heun"), ("sexp", "midpoint"), ("sexp", "em")];
    let compared: Vec<String> = pairs.iter().filter_map(|(a, b)| compared(case, a, b)).collect();
    for sentence in compared {
        let mut letters = sentence.chars();
        let capital = letters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
        text += &format!(" {capital}{}.", letters.as_str());
    }
    text
}

/// The weak conclusion for a test function.
pub fn weak(observable: &WeakObservable) -> String {
    let names: Vec<&str> = observable.series.iter().map(|series| series.scheme.as_str()).collect();
    let curves: Vec<Vec<(f64, f64)>> = observable.series.iter().map(weak_costs).collect();
    format!("Cheapest for E[{}]: {}.", observable.name, winners(&names, &curves))
}

/// Whether Lévy areas are worth their price at equal strong error; nothing for a case without them.
pub fn areas(case: &Case) -> Option<String> {
    let (sexp, levy) = (strong_series(case, "sexp")?, strong_series(case, "sexp-levy")?);
    let per_step = |series: &StrongSeries| {
        let costs = series.points.iter().map(|point| 1e9 * point.time.min_s / point.steps as f64);
        (costs.clone().fold(f64::INFINITY, f64::min), costs.fold(0.0, f64::max))
    };
    let (plain, dear) = (per_step(sexp), per_step(levy));
    let terms = levy.points.iter().filter_map(|point| point.area_terms);
    let steps = format!(
        "A step of `sexp` takes {} to {} ns, one of `sexp-levy` {} to {} ns, with {} to {} terms behind each area",
        number(plain.0),
        number(plain.1),
        number(dear.0),
        number(dear.1),
        terms.clone().min()?,
        terms.max()?
    );
    let found = crossing(&strong_costs(sexp), &strong_costs(levy))?;
    let ratio = |n: Option<&(f64, f64)>| n.map(|&(error, ratio)| (number(error), ratio));
    let ((coarse, first), (fine, last)) =
        (ratio(found.ratios.first())?, ratio(found.ratios.last())?);
    let which = |ratio: f64| {
        if ratio >= 1.0 {
            format!("`sexp-levy` is {} times cheaper than `sexp`", number(ratio))
        } else {
            format!("`sexp` is {} times cheaper than `sexp-levy`", number(1.0 / ratio))
        }
    };
    let verdict = match found.at.as_slice() {
        [] => format!(
            "it is the same one throughout: at {coarse}, {}; at {fine}, {}",
            which(first),
            which(last)
        ),
        at => format!(
            "it depends on the error which one is cheaper: at {coarse}, {}; at {fine}, {}; they cost the same at {}",
            which(first),
            which(last),
            at.iter().map(|error| number(*error)).collect::<Vec<_>>().join(" and ")
        ),
    };
    let beyond = levy
        .points
        .last()
        .filter(|point| sexp.points.last().is_some_and(|last| last.error > point.error));
    let beyond = beyond.map_or(String::new(), |point| {
        let steps = sexp.points.last().map_or(0, |last| last.steps);
        format!(
            " With {steps} steps `sexp` is still at {}; `sexp-levy` reaches {} with {} steps.",
            number(sexp.points.last().map_or(f64::NAN, |last| last.error)),
            number(point.error),
            point.steps
        )
    });
    Some(format!("{steps}. At equal strong error, {verdict}.{beyond}"))
}

/// All conclusions of a case in one paragraph, for the terminal.
pub fn conclusion(case: &Case) -> String {
    let mut parts = vec![format!("{}: {}", case.id, strong(case))];
    parts.extend(areas(case));
    parts.extend(case.weak.observables.iter().map(weak));
    parts.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let read = [0.0, 0.25, 3.16, 27.18, 1234.6, 1e-3, 3.2e-15, 4e7].map(number);
        assert_eq!(read, ["0", "0.25", "3.16", "27.2", "1235", "1.0e-3", "3.2e-15", "4.0e7"]);
    }

    #[test]
    fn winners_are_grouped() {
        let curve = |scale: f64, power: i32| -> Vec<(f64, f64)> {
            (0..9)
                .map(|k| 10f64.powf(-0.5 * f64::from(k)))
                .map(|error| (error, scale * error.powi(-power)))
                .collect()
        };
        // ε⁻² against 50 ε⁻¹: equal at 0.02.
        let curves = [curve(1.0, 2), curve(50.0, 1)];
        assert_eq!(
            winners(&["a", "b"], &curves),
            "`a` from 1.00 to 3.2e-2, `b` from 1.0e-2 to 1.0e-4"
        );
        assert_eq!(cheapest(&curves[..1], 0.1), None);
    }
}
