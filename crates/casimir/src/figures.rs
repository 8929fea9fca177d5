//! What the other crates find, as data of figures.

use analysis::compare::{Comparison, ErrorPoint};
use plot::figure::{self, Bins, Curve, Law, Measured, Plot};
use study::Summary;

/// The law of an observable in time, or of another [`Series`](study::Series), for
/// [`bands`](figure::bands).
pub fn law(points: &[Summary]) -> Law {
    let all = |of: &dyn Fn(&Summary) -> Option<f64>| -> Vec<f64> {
        points.iter().map(|point| of(point).unwrap_or(f64::NAN)).collect()
    };
    let quantiles = points
        .iter()
        .map(|point| &point.quantiles)
        .find(|all| !all.is_empty())
        .into_iter()
        .flatten()
        .enumerate()
        .map(|(k, quantile)| (quantile.level, all(&|point| point.quantiles.get(k)?.value)));
    Law {
        x: points.iter().map(|point| point.time).collect(),
        mean: all(&|point| point.mean),
        interval: [
            all(&|point| Some(point.mean_interval?.0)),
            all(&|point| Some(point.mean_interval?.1)),
        ],
        quantiles: quantiles.collect(),
    }
}

/// The histogram of an observable with this name at one time as an SVG document.
pub fn histogram(title: &str, observable: &str, summary: &Summary) -> String {
    let (lo, width, counts) = summary
        .histogram
        .as_ref()
        .map_or((0.0, 1.0, &[][..]), |found| (found.grid.lo, found.grid.width, &found.counts));
    figure::histogram(
        title,
        &format!("{observable} at t = {}", summary.time),
        Bins { lo, width, counts, all: if counts.is_empty() { 0 } else { summary.count } },
        summary.quantile(0.5).and_then(|quantile| quantile.value),
        summary.mean,
    )
}

/// The strong errors of a comparison with their intervals against the time and against the steps of
/// a path, as an SVG document. Points that the reference does not resolve are left out.
pub fn comparison(comparison: &Comparison) -> String {
    let plot = |x_title: &str, decades, cost: fn(&ErrorPoint) -> Option<f64>| {
        let curves = comparison.candidates.iter().map(|candidate| {
            Curve::new(
                &candidate.scheme,
                candidate.points.iter().filter(|point| point.resolved).filter_map(|point| {
                    let ErrorPoint { error: y, lo, hi, .. } = *point;
                    Some(Measured { x: cost(point)?, y, lo, hi })
                }),
            )
        });
        Plot { x_title: x_title.into(), decades, curves: curves.collect() }
    };
    let time = |point: &ErrorPoint| Some(1e6 * point.time?.best);
    figure::side_by_side(
        &format!("{}: strong error against cost", comparison.system),
        "RMS error of y(T)",
        vec![
            plot("processor time of a path, μs", true, time),
            plot("steps of a path", false, |point| Some(point.steps as f64)),
        ],
    )
}

#[cfg(test)]
mod tests {
    use analysis::{
        Spread,
        compare::{Candidate, Choice, Keeps, Outcome, Sampled},
    };

    use super::*;

    /// Points that the reference does not resolve are left out, and times are in microseconds.
    #[test]
    fn a_comparison_is_drawn_against_time_and_steps() {
        let point = |k: i32| ErrorPoint {
            steps: 8 << k,
            error: 0.1 * 0.5f64.powi(k),
            lo: 0.05 * 0.5f64.powi(k),
            hi: 0.2 * 0.5f64.powi(k),
            resolved: k < 3,
            defect: Some(1e-3),
            time: Some(Spread { best: 1e-6 * 10f64.powi(k), median: 1.0, worst: 2.0 }),
        };
        let found = Comparison {
            system: "a<b".into(),
            dimension: 3,
            noises: 1,
            t_end: 1.0,
            damped: true,
            wanted: 1e-3,
            sampled: Sampled::default(),
            reference_error: 1e-3,
            candidates: vec![Candidate {
                scheme: "heun".into(),
                asked: 1e-3,
                points: (0..4).map(point).collect(),
                outcome: Outcome::NotReached { needs: None },
                keeps: Keeps::default(),
            }],
            choice: Choice::NoneReaches,
            stopped: None,
            wall_s: 1.0,
        };
        let svg = comparison(&found);
        let words = ["a&lt;b: strong error against cost", "processor time of a path, μs", "heun"];
        words.iter().for_each(|words| assert!(svg.contains(words), "{words}"));
        let places = |line: &str| -> Option<Vec<String>> {
            let points = line.strip_prefix("<polyline")?.split("points=\"").nth(1)?;
            let points = points.split('"').next()?.split(' ');
            Some(points.filter_map(|at| Some(at.split_once(',')?.0.to_owned())).collect())
        };
        let curves = svg.lines().filter_map(places).filter(|places| places.len() == 3);
        let curves: Vec<_> = curves.collect();
        assert_eq!(curves.len(), 2);
        // The marks of 1, 10 and 100 are where the points are.
        let mark = |k: i32| {
            let is_mark =
                |text: &&str| text.contains(&format!(">{k}</tspan>")) && text.contains("middle");
            let mark = svg.split("<text x=\"").find(is_mark).unwrap();
            mark.split('"').next().unwrap().to_owned()
        };
        assert_eq!(curves[0], [0, 1, 2].map(mark));
    }
}
