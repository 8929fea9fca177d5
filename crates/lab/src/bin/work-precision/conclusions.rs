//! Conclusions in words that are made from the numbers.

use report::number;
use verify::work_precision::{cost_at, crossing};

use crate::results::{Case, Curve, Kind, Series, StrongPoint, WeakObservable};

/// Errors 10^{−k/2} that some curve reaches, from large to small.
pub fn targets(curves: &[Curve]) -> Vec<f64> {
    let reached = |&error: &f64| cheapest(curves, error).is_some();
    (-4..=16).map(|k| 10f64.powf(-0.5 * f64::from(k))).filter(reached).collect()
}

/// The costs of an error on the curves that reach it, with the numbers of these.
fn costs(curves: &[Curve], error: f64) -> impl Iterator<Item = (usize, f64)> {
    let costs = curves.iter().map(move |curve| cost_at(&curve.points, error)).enumerate();
    costs.filter_map(|(n, cost)| Some((n, cost?)))
}

/// The cheapest curve at an error, by number, and its cost.
pub fn cheapest(curves: &[Curve], error: f64) -> Option<(usize, f64)> {
    costs(curves, error).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The same among at least two curves that reach the error.
pub fn winner(curves: &[Curve], error: f64) -> Option<usize> {
    cheapest(curves, error).filter(|_| costs(curves, error).count() > 1).map(|(n, _)| n)
}

/// "`heun` from 1e-1 to 1e-3, `sexp` at 3e-4" for the winners at the targets.
fn winners(curves: &[Curve]) -> String {
    let targets = targets(curves);
    let won = targets.iter().filter_map(|&error| Some((winner(curves, error)?, error)));
    let won: Vec<(usize, f64)> = won.collect();
    let words = won.chunk_by(|a, b| a.0 == b.0).map(|run| {
        let (best, first) = run[0];
        let (scheme, from, to) = (curves[best].scheme, number(first), number(run[run.len() - 1].1));
        if from == to {
            format!("`{scheme}` at {to}")
        } else {
            format!("`{scheme}` from {from} to {to}")
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
pub fn series(case: &Case, kind: Kind) -> impl Iterator<Item = &Series<StrongPoint>> {
    case.strong.series.iter().filter(move |series| series.kind == kind)
}

/// "0.55 to 0.90", the smallest and the largest of some numbers.
fn range(numbers: impl Iterator<Item = f64> + Clone) -> String {
    let least = number(numbers.clone().fold(f64::INFINITY, f64::min));
    let most = number(numbers.fold(0.0, f64::max));
    if least == most { least } else { format!("{least} to {most}") }
}

/// How the costs of two schemes compare at equal strong error.
fn compared(sexp: &Curve, other: &Curve) -> Option<String> {
    let ratios = crossing(&sexp.points, &other.points)?.ratios;
    Some(format!(
        " Between the errors {} and {}, which both reach, `{}` costs {} times what `{}` costs.",
        number(ratios.first()?.0),
        number(ratios.last()?.0),
        sexp.scheme,
        range(ratios.iter().map(|(_, ratio)| *ratio)),
        other.scheme
    ))
}

/// The strong conclusion of a case in a sentence or three.
pub fn strong(case: &Case) -> String {
    let others = series(case, Kind::OtherImplicit).chain(series(case, Kind::Explicit));
    let sexp = series(case, Kind::Sexp).next().map(Series::<StrongPoint>::curve);
    let compared: String =
        others.filter_map(|other| compared(sexp.as_ref()?, &other.curve())).collect();
    format!("Cheapest for a strong error: {}.{compared}", winners(&case.strong.curves()))
}

/// The weak conclusion for a test function.
pub fn weak(observable: &WeakObservable) -> String {
    format!("Cheapest for E[{}]: {}.", observable.name, winners(&observable.curves()))
}

/// Whether Lévy areas are worth their price at equal strong error; nothing for a case without them.
pub fn areas(case: &Case) -> Option<String> {
    let (sexp, levy) = (series(case, Kind::Sexp).next()?, series(case, Kind::SexpLevy).next()?);
    let ns = |series: &Series<StrongPoint>| {
        let each = |point: &StrongPoint| 1e9 * point.work.time.min_s / point.work.steps as f64;
        range(series.points.iter().map(each))
    };
    let found = crossing(&sexp.curve().points, &levy.curve().points)?;
    let (coarse, fine) = (found.ratios.first()?, found.ratios.last()?);
    let (last, beyond) = (&sexp.points.last()?.work, &levy.points.last()?.work);
    let [sexp_scheme, levy_scheme] = [sexp, levy].map(|series| format!("`{}`", series.scheme));
    let equal: Vec<String> = found.at.iter().map(|&error| number(error)).collect();
    let equal = match equal.as_slice() {
        [] => String::new(),
        equal => format!("; they cost the same at {}", equal.join(" and ")),
    };
    Some(format!(
        "A step of {sexp_scheme} takes {} ns, one of {levy_scheme} {} ns, with up to {} terms \
         behind each area. {sexp_scheme} costs {} times what {levy_scheme} costs at the strong \
         error {}, and {} times at {}{equal}. With {} steps {sexp_scheme} reaches {} and \
         {levy_scheme} {}.",
        ns(sexp),
        ns(levy),
        levy.points.iter().filter_map(|point| point.area_terms).max()?,
        number(coarse.1),
        number(coarse.0),
        number(fine.1),
        number(fine.0),
        last.steps,
        number(last.error),
        number(beyond.error)
    ))
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
        let curve = |scheme, scale: f64, power: i32| {
            let errors = (0..9).map(|k| 10f64.powf(-0.5 * f64::from(k)));
            let points = errors.map(|error| (error, scale * error.powi(-power))).collect();
            Curve { scheme, points }
        };
        // ε⁻² against 50 ε⁻¹: equal at 0.02.
        let curves = [curve("a", 1.0, 2), curve("b", 50.0, 1)];
        assert_eq!(winners(&curves), "`a` from 1.00 to 3.2e-2, `b` from 1.0e-2 to 1.0e-4");
        assert_eq!(winner(&curves[..1], 0.1), None);
    }
}
