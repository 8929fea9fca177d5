//! The shape of a scalar function, from its values: linear, quadratic or homogeneous, its degree
//! and its minimum on the unit sphere.

use serde::Serialize;

use super::{
    algebra::{Matrix, axis, largest, moved, norm},
    finding::{CLUSTER, Finding, Status, Term},
    points::Points,
    probe::{Batch, Probe},
    sight::Sight,
    spectrum::smallest_eigenvalue,
};

/// The kind of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// 0.
    Zero,
    /// βᵀy.
    Linear,
    /// ½yᵀQy.
    Quadratic,
    /// Homogeneous, but neither of these.
    Homogeneous,
    /// Not homogeneous: it has no conformal law.
    NotHomogeneous,
    /// Round-off hides whether it is homogeneous.
    Unknown,
}

impl Kind {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Linear => "linear",
            Self::Quadratic => "quadratic",
            Self::Homogeneous => "homogeneous",
            Self::NotHomogeneous => "not homogeneous",
            Self::Unknown => "cannot tell whether homogeneous",
        }
    }
}

/// The shape of a function F.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// Its kind.
    pub kind: Kind,
    /// The degree p of a homogeneous function.
    pub degree: Option<f64>,
    /// F(cy) = cᵖF(y).
    pub homogeneous: Finding,
    /// F is a polynomial of degree at most two, by third differences: the averaged gradient is the
    /// gradient at the midpoint.
    pub constant_hessian: Finding,
    /// m(F) of a homogeneous function.
    pub minimum: Option<Minimum>,
}

/// m(F) = min F over the unit sphere; if it is positive, F bounds all paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Minimum {
    /// The value: −‖β‖ of a linear function, half the smallest eigenvalue of a quadratic form, else
    /// the lowest value that a search found, which is no lower bound.
    pub value: f64,
    /// A bound of the rounding error of `value`.
    pub error: f64,
    /// Whether m(F) > 0.
    pub positive: Status,
    /// Whether it was found by a search.
    pub searched: bool,
    /// Whether the minimum is over the part of the sphere in the domain of the system only. The
    /// bound then holds as long as a path stays there.
    pub in_domain_only: bool,
}

/// A function of the state at many points.
pub type Values<'f> = &'f dyn Fn(&mut Probe<'_>, &[Vec<f64>]) -> Vec<f64>;

/// The ratio of the lengths of two states of the same direction, and another for domains that end.
const STRETCH: [f64; 2] = [2.0, 0.5];
/// The length of the steps of third differences, relative to another state, and their halvings
/// until all are in the domain.
const STEP: f64 = 0.3;
const HALVINGS: i32 = 12;

impl Shape {
    pub(super) fn of(sight: &mut Sight<'_>, f: Values<'_>) -> Self {
        let Sight { probe, points, states, locals } = sight;
        let values = f(probe, states);
        let factor = |at: &Vec<f64>| {
            let inside =
                |c: &&f64| probe.in_domain(&at.iter().map(|x| **c * x).collect::<Vec<_>>());
            STRETCH.iter().find(inside).copied()
        };
        let factors: Vec<f64> = points
            .for_identities
            .iter()
            .flat_map(|at| [factor(at).unwrap_or(1.0); CLUSTER])
            .collect();
        let scaled: Batch =
            states.iter().zip(&factors).map(|(y, c)| y.iter().map(|x| c * x).collect()).collect();
        let stretched = f(probe, &scaled);
        let constant_hessian = third_differences(probe, points, states, f);
        let zero = values.iter().chain(&stretched).all(|x| *x == 0.0);
        let typical = largest(&values);
        // The degree is read where F is largest.
        let moving = (0..values.len()).filter(|&n| factors[n] != 1.0);
        let best = moving.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()));
        let degree = best.map_or(f64::NAN, |n| (stretched[n] / values[n]).ln() / factors[n].ln());
        let degree = if zero { 0.0 } else { short(degree) + 0.0 };
        let mut homogeneous = match degree.fract() == 0.0 {
            true => Finding::default(),
            false => Finding::fitted(),
        };
        if degree.is_finite() {
            let term = |n: usize| -> Vec<Term> {
                let expected = factors[n].powf(degree) * values[n];
                vec![(stretched[n] - expected, stretched[n].abs() + expected.abs())]
            };
            let terms: Vec<_> = (0..values.len()).map(term).collect();
            for (at, cluster) in points.for_identities.iter().zip(terms.chunks(CLUSTER)) {
                homogeneous.record(at, cluster, typical);
            }
        } else {
            homogeneous.status = match typical.is_finite() {
                true => Status::Fails,
                false => Status::Unknown,
            };
        }
        let kind = match homogeneous.status {
            _ if zero => Kind::Zero,
            Status::Unknown => Kind::Unknown,
            Status::Fails => Kind::NotHomogeneous,
            Status::Holds if degree == 1.0 && constant_hessian.holds() => Kind::Linear,
            Status::Holds if degree == 2.0 && constant_hessian.holds() => Kind::Quadratic,
            Status::Holds => Kind::Homogeneous,
        };
        let law = matches!(kind, Kind::Linear | Kind::Quadratic | Kind::Homogeneous);
        let minimum = (law && !locals.is_empty()).then(|| match kind {
            Kind::Linear if points.everywhere => Minimum::of_linear(&coefficients(probe, f)),
            Kind::Quadratic if points.everywhere => Minimum::of_form(&matrix(probe, f)),
            _ => Minimum::by_search(probe, points, f),
        });
        Self { kind, degree: law.then_some(degree), homogeneous, constant_hessian, minimum }
    }
}

/// The number of at most nine decimals that is nearest, if round-off explains the difference.
fn short(x: f64) -> f64 {
    let rounded = (x * 1e9).round() / 1e9;
    if (x - rounded).abs() <= 1e-12 * (1.0 + x.abs()) { rounded } else { x }
}

/// F(a + 3b) − 3F(a + 2b) + 3F(a + b) − F(a), where all are in the domain.
fn third_differences(
    probe: &mut Probe<'_>,
    points: &Points,
    states: &Batch,
    f: Values<'_>,
) -> Finding {
    let all = &points.for_identities;
    let step = |n: usize| {
        let b = &all[(n + 1) % all.len()];
        let lengths = (0..HALVINGS).map(|halvings| STEP * f64::powi(0.5, halvings));
        let inside = |length: &f64| {
            (1..=3).all(|k| probe.in_domain(&moved(&all[n], f64::from(k) * length, b)))
        };
        lengths.into_iter().find(inside).map(|length| b.iter().map(|x| length * x).collect())
    };
    let steps: Vec<Option<Vec<f64>>> = (0..all.len()).map(step).collect();
    let at = |k: f64| -> Batch {
        let step = |n: usize| steps[n / CLUSTER].as_ref();
        let moved = |(n, y): (usize, &Vec<f64>)| step(n).map_or(y.clone(), |b| moved(y, k, b));
        states.iter().enumerate().map(moved).collect()
    };
    let values = [0.0, 1.0, 2.0, 3.0].map(|k| f(probe, &at(k)));
    let mut finding = Finding::default();
    for (n, y) in all.iter().enumerate().filter(|(n, _)| steps[*n].is_some()) {
        let term = |n: usize| {
            let terms = [values[3][n], -3.0 * values[2][n], 3.0 * values[1][n], -values[0][n]];
            vec![(terms.iter().sum(), terms.iter().map(|x| x.abs()).sum())]
        };
        let cluster: Vec<Vec<Term>> = (CLUSTER * n..CLUSTER * (n + 1)).map(term).collect();
        finding.record(y, &cluster, 0.0);
    }
    finding.seen()
}

/// β of βᵀy.
fn coefficients(probe: &mut Probe<'_>, f: Values<'_>) -> Vec<f64> {
    let d = probe.dimension();
    let axes: Batch = (0..d).map(|i| axis(d, i)).collect();
    f(probe, &axes)
}

/// Q of ½yᵀQy.
fn matrix(probe: &mut Probe<'_>, f: Values<'_>) -> Matrix {
    let d = probe.dimension();
    let alone = coefficients(probe, f);
    let pairs: Batch = (0..d * d).map(|n| moved(&axis(d, n / d), 1.0, &axis(d, n % d))).collect();
    let values = f(probe, &pairs);
    (0..d).map(|i| (0..d).map(|j| values[i * d + j] - alone[i] - alone[j]).collect()).collect()
}

/// Shortest step of the search; the error of the minimum is of the order of its square.
const SHORTEST: f64 = 1e-7;
/// Starts of the search, and the most steps from each.
const STARTS: usize = 8;
const STEPS: usize = 400;

impl Minimum {
    /// −‖β‖.
    pub(super) fn of_linear(beta: &[f64]) -> Self {
        let value = -norm(beta);
        let error = f64::EPSILON * beta.len() as f64 * value.abs();
        Self { value, error, positive: Status::Fails, searched: false, in_domain_only: false }
    }

    /// The minimum of ½yᵀQy, by the smallest eigenvalue.
    pub(super) fn of_form(q: &Matrix) -> Self {
        let value = 0.5 * smallest_eigenvalue(q);
        // Backward stable, with a modest multiple of u‖Q‖ (Golub and Van Loan 2013, section 8.6).
        let error = 4.0 * f64::EPSILON * q.len() as f64 * norm(&q.concat());
        let positive = match (value > error, value < -error) {
            (true, _) => Status::Holds,
            (_, true) => Status::Fails,
            _ => Status::Unknown,
        };
        Self { value, error, positive, searched: false, in_domain_only: false }
    }

    /// A compass search on the sphere from the best points: steps along the axes, halved when none
    /// helps. A negative value refutes m(F) > 0; a positive one proves nothing.
    pub(super) fn by_search(probe: &mut Probe<'_>, points: &Points, f: Values<'_>) -> Self {
        let unit = |y: &Vec<f64>| {
            let length = norm(y);
            y.iter().map(|x| x / length).collect::<Vec<_>>()
        };
        let mut on_sphere = |states: Batch| -> Vec<(f64, Vec<f64>)> {
            let inside: Batch = states.iter().map(unit).filter(|y| probe.in_domain(y)).collect();
            let values = if inside.is_empty() { Vec::new() } else { f(probe, &inside) };
            let mut found: Vec<_> = values.into_iter().zip(inside).collect();
            found.retain(|(value, _)| value.is_finite());
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            found
        };
        let starts = on_sphere(points.for_suprema.clone());
        let size = largest(starts.iter().map(|(value, _)| value));
        let mut least = f64::INFINITY;
        for (mut lowest, mut y) in starts.into_iter().take(STARTS) {
            let mut step = 0.5;
            for _ in 0..STEPS {
                let d = y.len();
                let moves = (0..2 * d)
                    .map(|k| moved(&y, if k < d { step } else { -step }, &axis(d, k % d)));
                match on_sphere(moves.collect()).into_iter().next() {
                    Some((value, found)) if value < lowest => (lowest, y) = (value, found),
                    _ if step <= SHORTEST => break,
                    _ => step *= 0.5,
                }
            }
            least = least.min(lowest);
        }
        // The search ends at a distance of the order of its step from a minimum.
        let error = SHORTEST * size;
        let positive = if least < -f64::EPSILON * size {
            Status::Fails
        } else if least > error && least.is_finite() {
            Status::Holds
        } else {
            Status::Unknown
        };
        let in_domain_only = !points.everywhere;
        Self { value: least, error, positive, searched: true, in_domain_only }
    }
}
