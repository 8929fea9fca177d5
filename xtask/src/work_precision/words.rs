//! The conclusions in words, made from the numbers.

use precision::results::{Case, StrongSeries, WeakObservable};
use precision::{cost_at, crossing};
use report::number;

use super::curves::{strong_costs, weak_costs};

/// Errors 10^{−k/2} that some curve reaches, from large to small.
pub fn targets(curves: &[Vec<(f64, f64)>]) -> Vec<f64> {
    let reached = |error: f64| curves.iter().any(|curve| cost_at(curve, error).is_some());
    (-4..=16).map(|k| 10f64.powf(-0.5 * f64::from(k))).filter(|&error| reached(error)).collect()
}

/// The cheapest curve at an error, by number, among at least two that reach it.
pub fn cheapest(curves: &[Vec<(f64, f64)>], error: f64) -> Option<usize> {
    let costs = curves.iter().enumerate().filter_map(|(n, c)| Some((n, cost_at(c, error)?)));
    let best = costs.clone().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (costs.count() > 1).then_some(best.0)
}

/// The series of a scheme.
pub fn strong_series<'a>(case: &'a Case, scheme: &str) -> Option<&'a StrongSeries> {
    case.strong.series.iter().find(|series| series.scheme == scheme)
}

/// "`heun` from 1e-1 to 1e-3, `sexp` at 3e-4" for the cheapest schemes at the targets.
fn winners<'a>(curves: impl Iterator<Item = (&'a str, Vec<(f64, f64)>)>) -> String {
    let (names, curves): (Vec<&str>, Vec<_>) = curves.unzip();
    let mut runs: Vec<(usize, f64, f64)> = Vec::new();
    for error in targets(&curves) {
        let Some(best) = cheapest(&curves, error) else { continue };
        match runs.last_mut() {
            Some(run) if run.0 == best => run.2 = error,
            _ => runs.push((best, error, error)),
        }
    }
    let words = |&(best, from, to): &(usize, f64, f64)| match from == to {
        true => format!("`{}` at {}", names[best], number(from)),
        false => format!("`{}` from {} to {}", names[best], number(from), number(to)),
    };
    match &runs[..] {
        [] => "no error is reached by two schemes".to_owned(),
        runs => runs.iter().map(words).collect::<Vec<_>>().join(", "),
    }
}

/// How the cost of `sexp` compares with that of another scheme at equal strong error.
fn compared(case: &Case, other: &str) -> Option<String> {
    let (one, two) = (strong_series(case, "sexp")?, strong_series(case, other)?);
    let ratios = crossing(&strong_costs(one), &strong_costs(two))?.ratios;
    let all = || ratios.iter().map(|(_, ratio)| *ratio);
    let (least, most) = (number(all().reduce(f64::min)?), number(all().reduce(f64::max)?));
    let range = if least == most { least } else { format!("{least} to {most}") };
    Some(format!(
        " Between the errors {} and {}, which both reach, `sexp` costs {range} times what `{other}` \
         costs.",
        number(ratios.first()?.0),
        number(ratios.last()?.0)
    ))
}

/// The strong conclusion of a case.
pub fn strong(case: &Case) -> String {
    let series = case.strong.series.iter();
    let curves = series.map(|series| (series.scheme.as_str(), strong_costs(series)));
    let others = ["heun", "midpoint", "em"].into_iter();
    let compared: String = others.filter_map(|other| compared(case, other)).collect();
    format!("Cheapest for a strong error: {}.{compared}", winners(curves))
}

/// The weak conclusion for a test function.
pub fn weak(observable: &WeakObservable) -> String {
    let series = observable.series.iter();
    let curves = series.map(|series| (series.scheme.as_str(), weak_costs(series)));
    format!("Cheapest for E[{}]: {}.", observable.name, winners(curves))
}

/// Whether Lévy areas are worth their price at equal strong error; none for a case without them.
pub fn areas(case: &Case) -> Option<String> {
    let (sexp, levy) = (strong_series(case, "sexp")?, strong_series(case, "sexp-levy")?);
    let step = |series: &StrongSeries| {
        let costs = series.points.iter().map(|point| 1e9 * point.time.min_s / point.steps as f64);
        let (least, most) = (costs.clone().reduce(f64::min)?, costs.reduce(f64::max)?);
        Some(format!("{} to {} ns", number(least), number(most)))
    };
    let terms = levy.points.iter().filter_map(|point| point.area_terms);
    let found = crossing(&strong_costs(levy), &strong_costs(sexp))?;
    let ratio = |&(error, ratio): &(f64, f64)| format!("{} at {}", number(ratio), number(error));
    let equal: Vec<String> = found.at.iter().map(|error| number(*error)).collect();
    let equal = if equal.is_empty() { "no error".to_owned() } else { equal.join(" and ") };
    let last = |series: &StrongSeries| {
        let point = series.points.last()?;
        Some(format!("`{}` reaches {}", series.scheme, number(point.error)))
    };
    Some(format!(
        "A step of `sexp` takes {}, one of `sexp-levy` {}, with {} to {} terms behind each area. At \
         equal strong error `sexp-levy` costs {} and {} times what `sexp` costs; they cost the same \
         at {equal}. With {} steps {} and {}.",
        step(sexp)?,
        step(levy)?,
        terms.clone().min()?,
        terms.max()?,
        ratio(found.ratios.first()?),
        ratio(found.ratios.last()?),
        sexp.points.last()?.steps,
        last(sexp)?,
        last(levy)?
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn winners_are_grouped() {
        let curve = |scale: f64, power: i32| -> Vec<(f64, f64)> {
            (0..9)
                .map(|k| 10f64.powf(-0.5 * f64::from(k)))
                .map(|error| (error, scale * error.powi(-power)))
                .collect()
        };
        // ε⁻² against 50 ε⁻¹: equal at 0.02.
        let curves = [("a", curve(1.0, 2)), ("b", curve(50.0, 1))];
        assert_eq!(cheapest(&[curves[0].1.clone()], 0.1), None);
        assert_eq!(
            winners(curves.into_iter()),
            "`a` from 1.00 to 3.2e-2, `b` from 1.0e-2 to 1.0e-4"
        );
    }
}
