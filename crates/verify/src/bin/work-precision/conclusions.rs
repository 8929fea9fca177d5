//! Conclusions in words that are made from the numbers.

use analysis::compare::{Curve, Series, StrongPoint, WeakObservable, WeakPoint, cost_at, crossing};
use report::number;
use verify::setups::Kind;

use crate::results::{Case, in_microseconds};

/// Errors 10^{−k/2} that some curve reaches, from large to small.
pub fn targets(curves: &[Curve]) -> Vec<f64> {
    let reached = |&error: &f64| cheapest(curves, error).is_some();
    (-4..=16).map(|k| 10f64.powf(-0.5 * f64::from(k))).filter(reached).collect()
}

/// The costs of an error on the curves that reach it, with the numbers of these.
fn costs(curves: &[Curve], error: f64) -> impl Iterator<Item = (usize, f64)> {
    let cost = move |(n, curve): (usize, &Curve)| Some((n, cost_at(&curve.points, error)?));
    curves.iter().enumerate().filter_map(cost)
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
    let won: Vec<(usize, f64)> = targets(curves)
        .into_iter()
        .filter_map(|error| Some((winner(curves, error)?, error)))
        .collect();
    let words = won.chunk_by(|a, b| a.0 == b.0).map(|run| {
        let (scheme, from) = (&curves[run[0].0].scheme, number(run[0].1));
        let to = number(run[run.len() - 1].1);
        let errors = if from == to { format!("at {to}") } else { format!("from {from} to {to}") };
        format!("`{scheme}` {errors}")
    });
    let words = words.collect::<Vec<_>>().join(", ");
    if words.is_empty() { "no error is reached by two schemes".into() } else { words }
}

/// "0.55 to 0.90", the smallest and the largest of some numbers.
fn range(numbers: impl Iterator<Item = f64> + Clone) -> String {
    let least = number(numbers.clone().fold(f64::INFINITY, f64::min));
    let most = number(numbers.fold(0.0, f64::max));
    if least == most { least } else { format!("{least} to {most}") }
}

/// How the costs of two schemes compare at equal strong error.
fn compared(sexp: &Series<StrongPoint>, other: &Series<StrongPoint>) -> Option<String> {
    let found = crossing(&sexp.curve().points, &other.curve().points)?;
    let equal: Vec<String> = found.at.iter().map(|&error| number(error)).collect();
    let equal = match equal.join(" and ") {
        errors if errors.is_empty() => errors,
        errors => format!(", the same at {errors}"),
    };
    Some(format!(
        " From the error {} to {}, `{}` costs {} times what `{}` costs{equal}.",
        number(found.ratios.first()?.0),
        number(found.ratios.last()?.0),
        sexp.scheme,
        range(found.ratios.iter().map(|(_, ratio)| *ratio)),
        other.scheme
    ))
}

/// The strong conclusion of a case in a sentence or three.
pub fn strong(case: &Case) -> String {
    let others = case.series(|kind| !kind.conformal());
    let sexp = case.series(|kind| kind == Kind::Sexp).next();
    let compared: String = others.filter_map(|other| compared(sexp?, other)).collect();
    format!("Cheapest for a strong error: {}.{compared}", winners(&case.curves()))
}

/// At every strong error that the tables show: the cheapest conformal scheme in multiples of
/// `heun`, with the interval that follows from the errors; nothing where they reach no error in
/// common.
pub fn conformal(case: &Case) -> Option<String> {
    let heun = in_microseconds(case.series(|kind| kind == Kind::Heun).next()?);
    let conformal: Vec<_> = case.series(Kind::conformal).collect();
    let curves: Vec<Curve> = conformal.iter().copied().map(in_microseconds).collect();
    let multiples = targets(&case.curves()).into_iter().filter_map(|error| {
        let (best, cost) = cheapest(&curves, error)?;
        let multiple = cost / cost_at(&heun.points, error)?;
        let interval = interval(conformal[best], error, multiple)
            .map_or(String::new(), |ends| format!(" [{}]", ends.map(number).join(", ")));
        let scheme = &curves[best].scheme;
        Some(format!("{}{interval} at {} (`{scheme}`)", number(multiple), number(error)))
    });
    let words = multiples.collect::<Vec<_>>().join(", ");
    let prefix = format!("The cheapest conformal scheme in multiples of `{}`: ", heun.scheme);
    (!words.is_empty()).then(|| prefix + &words + ".")
}

/// The interval of a multiple of the cost of the base scheme at an equal error.
///
/// With an error of order p in the step size, an error that is r times that of the base scheme at
/// the same steps costs r^{1/p} times as much at equal error. So the interval of r at the measured
/// steps nearest to `error` gives that of the multiple; p is the slope of the errors between the
/// two measured neighbours.
fn interval(series: &Series<StrongPoint>, error: f64, multiple: f64) -> Option<[f64; 2]> {
    let usable: Vec<_> =
        series.points.iter().filter(|point| point.resolved && point.time.is_some()).collect();
    let pairs = usable.windows(2).rev();
    let pair = { pairs }.find(|pair| pair[1].error <= error && error <= pair[0].error)?;
    let steps = pair[1].steps as f64 / pair[0].steps as f64;
    let order = (pair[0].error / pair[1].error).ln() / steps.ln();
    let away = |point: &StrongPoint| (point.error / error).ln().abs();
    let nearest = if away(pair[0]) < away(pair[1]) { pair[0] } else { pair[1] };
    let ratio = nearest.ratio.filter(|_| order > 0.0)?;
    Some([ratio.lo, ratio.hi].map(|end| multiple * (end / ratio.value).powf(1.0 / order)))
}

/// (accuracy, seconds of an estimate) of all schemes.
pub fn weak_curves(observable: &WeakObservable) -> Vec<Curve> {
    observable.series.iter().map(Series::<WeakPoint>::curve).collect()
}

/// The weak conclusion for a test function.
pub fn weak(observable: &WeakObservable) -> String {
    format!("Cheapest for E[{}]: {}.", observable.name, winners(&weak_curves(observable)))
}

/// Whether Lévy areas are worth their price at equal strong error; nothing for a case without them.
pub fn areas(case: &Case) -> Option<String> {
    let of = |kind: Kind| case.series(move |of| of == kind).next();
    let (sexp, levy) = (of(Kind::Sexp)?, of(Kind::SexpLevy)?);
    let ns = |series: &Series<StrongPoint>| {
        let each = |point: &StrongPoint| Some(1e9 * point.time?.min_s / point.steps as f64);
        range(series.points.iter().filter_map(each))
    };
    Some(format!(
        "A step of `{}` takes {} ns, one of `{}` {} ns, with up to {} terms per area.{}",
        sexp.scheme,
        ns(sexp),
        levy.scheme,
        ns(levy),
        levy.points.iter().filter_map(|point| point.area_terms).max()?,
        compared(sexp, levy)?
    ))
}

#[cfg(test)]
mod tests {
    use analysis::compare::{Ratio, Time};

    use super::*;

    #[test]
    fn multiples_have_the_interval_of_the_ratio_at_the_nearest_steps() {
        let time = Some(Time {
            min_s: 1e-6,
            median_s: 1e-6,
            max_s: 1e-6,
            repetitions: 1,
            paths: 1,
            failed: 0,
        });
        // Errors of order ½; the finer point has the ratio 2 within a tenth.
        let point = |steps: u64, ratio| StrongPoint {
            steps,
            tau: 1.0 / steps as f64,
            error: (steps as f64).powf(-0.5),
            se: 0.0,
            lo: None,
            hi: None,
            resolved: true,
            ratio,
            error_exact_areas: None,
            area_terms: None,
            defects: Vec::new(),
            time,
        };
        let known = Ratio { value: 2.0, lo: 2.0 / 1.1, hi: 2.0 * 1.1 };
        let points = vec![point(16, None), point(64, Some(known))];
        let series = Series { scheme: "a".to_owned(), points };
        // Twice the error costs four times as much, and so the interval is the square.
        let [lo, hi] = interval(&series, 0.13, 5.0).unwrap();
        assert!((lo * 1.21 / 5.0 - 1.0).abs() < 1e-12 && (hi / 5.0 / 1.21 - 1.0).abs() < 1e-12);
        // Nearer to the coarse point, which has no ratio, and beyond both.
        assert_eq!(interval(&series, 0.24, 5.0), None);
        assert_eq!(interval(&series, 0.1, 5.0), None);
    }

    #[test]
    fn winners_are_grouped() {
        let curve = |scheme: &str, scale: f64, power: i32| {
            let errors = (0..9).map(|k| 10f64.powf(-0.5 * f64::from(k)));
            let points = errors.map(|error| (error, scale * error.powi(-power))).collect();
            Curve { scheme: scheme.to_owned(), points }
        };
        // ε⁻² against 50 ε⁻¹: equal at 0.02.
        let curves = [curve("a", 1.0, 2), curve("b", 50.0, 1)];
        assert_eq!(winners(&curves), "`a` from 1.00 to 3.2e-2, `b` from 1.0e-2 to 1.0e-4");
        assert_eq!(winner(&curves[..1], 0.1), None);
    }
}
