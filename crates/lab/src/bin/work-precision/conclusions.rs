//! Conclusions in words that are made from the numbers.

use report::number;
use verify::work_precision::{cost_at, crossing};

use crate::results::{Case, Curve, Kind, Series, StrongPoint, WeakObservable};

/// Errors 10^{−k/2} that some curve reaches, from large to small.
pub fn targets(curves: &[Curve]) -> Vec<f64> {
    let reached = |error: f64| curves.iter().any(|curve| cost_at(curve, error).is_some());
    (-4..=16).map(|k| 10f64.powf(-0.5 * f64::from(k))).filter(|&error| reached(error)).collect()
}

/// The cheapest curve at an error, by number, and its cost.
pub fn cheapest(curves: &[Curve], error: f64) -> Option<(usize, f64)> {
    let costs =
        curves.iter().enumerate().filter_map(|(n, curve)| Some((n, cost_at(curve, error)?)));
    costs.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The same among at least two curves that reach the error.
pub fn winner(curves: &[Curve], error: f64) -> Option<usize> {
    let reached = curves.iter().filter(|curve| cost_at(curve, error).is_some()).count();
    cheapest(curves, error).filter(|_| reached > 1).map(|(n, _)| n)
}

/// "`heun` from 1e-1 to 1e-3, `sexp` at 3e-4" for the winners at the targets.
fn winners(names: &[&str], curves: &[Curve]) -> String {
    let mut runs: Vec<(usize, f64, f64)> = Vec::new();
    for error in targets(curves) {
        match (winner(curves, error), runs.last_mut()) {
            (Some(best), Some(run)) if run.0 == best => run.2 = error,
            (Some(best), _) => runs.push((best, error, error)),
            (None, _) => {}
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

/// The strong errors of the schemes of a kind.
pub fn series(case: &Case, kind: Kind) -> impl Iterator<Item = &Series<StrongPoint>> + Clone {
    case.strong.series.iter().filter(move |series| series.kind == kind)
}

/// How the costs of two schemes compare at equal strong error.
fn compared(sexp: &Series<StrongPoint>, other: &Series<StrongPoint>) -> Option<String> {
    let ratios = crossing(&sexp.curve(), &other.curve())?.ratios;
    let fold = |pick: fn(f64, f64) -> f64| ratios.iter().map(|(_, ratio)| *ratio).reduce(pick);
    let (least, most) = (fold(f64::min)?, fold(f64::max)?);
    let cost = if (least * 100.0).round() == (most * 100.0).round() {
        format!("{} times", number(least))
    } else {
        format!("{} to {} times", number(least), number(most))
    };
    Some(format!(
        " Between the errors {} and {}, which both reach, `{}` costs {cost} what `{}` costs.",
        number(ratios.first()?.0),
        number(ratios.last()?.0),
        sexp.scheme,
        other.scheme
    ))
}

/// The strong conclusion of a case in a sentence or three.
pub fn strong(case: &Case) -> String {
    let names: Vec<&str> = case.strong.series.iter().map(|series| series.scheme).collect();
    let curves: Vec<Curve> = case.strong.series.iter().map(Series::<StrongPoint>::curve).collect();
    let others = series(case, Kind::OtherImplicit).chain(series(case, Kind::Explicit));
    let compared: String = series(case, Kind::Sexp)
        .flat_map(|sexp| others.clone().filter_map(|other| compared(sexp, other)))
        .collect();
    format!("Cheapest for a strong error: {}.{compared}", winners(&names, &curves))
}

/// The weak conclusion for a test function.
pub fn weak(observable: &WeakObservable) -> String {
    let names: Vec<&str> = observable.series.iter().map(|series| series.scheme).collect();
    let curves: Vec<Curve> = observable.series.iter().map(|series| series.curve()).collect();
    format!("Cheapest for E[{}]: {}.", observable.name, winners(&names, &curves))
}

/// Whether Lévy areas are worth their price at equal strong error; nothing for a case without them.
pub fn areas(case: &Case) -> Option<String> {
    let (sexp, levy) = (series(case, Kind::Sexp).next()?, series(case, Kind::SexpLevy).next()?);
    let per_step = |series: &Series<StrongPoint>| {
        let ns = |point: &StrongPoint| 1e9 * point.work.time.min_s / point.work.steps as f64;
        let costs = series.points.iter().map(ns);
        let (least, most) =
            (costs.clone().fold(f64::INFINITY, f64::min), costs.fold(0.0, f64::max));
        format!("`{}` takes {} to {} ns", series.scheme, number(least), number(most))
    };
    let terms = levy.points.iter().filter_map(|point| point.area_terms);
    let steps = format!(
        "A step of {}, one of {}, with {} to {} terms behind each area",
        per_step(sexp),
        per_step(levy),
        terms.clone().min()?,
        terms.max()?
    );
    let found = crossing(&sexp.curve(), &levy.curve())?;
    let at = |end: Option<&(f64, f64)>| {
        let &(error, ratio) = end?;
        let (cheap, dear, times) = if ratio >= 1.0 {
            (levy.scheme, sexp.scheme, ratio)
        } else {
            (sexp.scheme, levy.scheme, 1.0 / ratio)
        };
        let (error, times) = (number(error), number(times));
        Some(format!("at {error}, `{cheap}` is {times} times cheaper than `{dear}`"))
    };
    let (coarse, fine) = (at(found.ratios.first())?, at(found.ratios.last())?);
    let equal: Vec<String> = found.at.iter().map(|&error| number(error)).collect();
    let verdict = if equal.is_empty() {
        format!("it is the same one throughout: {coarse}; {fine}")
    } else {
        format!(
            "it depends on the error which one is cheaper: {coarse}; {fine}; they cost the same at {}",
            equal.join(" and ")
        )
    };
    let (last, beyond) = (&sexp.points.last()?.work, &levy.points.last()?.work);
    let beyond = if last.error > beyond.error {
        format!(
            " With {} steps `{}` is still at {}; `{}` reaches {} with {} steps.",
            last.steps,
            sexp.scheme,
            number(last.error),
            levy.scheme,
            number(beyond.error),
            beyond.steps
        )
    } else {
        String::new()
    };
    Some(format!("{steps}. At equal strong error, {verdict}.{beyond}"))
}

/// All conclusions of a case in one paragraph, for the terminal.
pub fn all(case: &Case) -> String {
    let mut parts = vec![format!("{}: {}", case.id, strong(case))];
    parts.extend(areas(case));
    parts.extend(case.weak.observables.iter().map(weak));
    parts.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn winners_are_grouped() {
        let curve = |scale: f64, power: i32| -> Curve {
            let errors = (0..9).map(|k| 10f64.powf(-0.5 * f64::from(k)));
            errors.map(|error| (error, scale * error.powi(-power))).collect()
        };
        // ε⁻² against 50 ε⁻¹: equal at 0.02.
        let curves = [curve(1.0, 2), curve(50.0, 1)];
        assert_eq!(
            winners(&["a", "b"], &curves),
            "`a` from 1.00 to 3.2e-2, `b` from 1.0e-2 to 1.0e-4"
        );
        assert_eq!(winner(&curves[..1], 0.1), None);
    }
}
