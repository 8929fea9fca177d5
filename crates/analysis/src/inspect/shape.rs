//! The shape of a scalar function, from its values: linear, quadratic or homogeneous, its degree,
//! and the minimum of a form on the unit sphere.

use serde::Serialize;

use super::{
    algebra::{axis, largest, moved, norm, scaled},
    finding::{CLUSTER, Finding, Status, Term, sum},
    form::Form,
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
    /// m(F) of a linear or quadratic function that is defined everywhere.
    pub minimum: Option<Minimum>,
}

/// m(F) = min F over the unit sphere; if it is positive, F bounds all paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Minimum {
    /// −‖β‖ of a linear function, half the smallest eigenvalue of a quadratic form, less its
    /// rounding error; the smallest βᵢ of a linear function on positive states; −∞ of logarithms.
    pub value: f64,
    /// Whether m(F) > 0.
    pub positive: Status,
    /// Whether the minimum is over positive states only, as all that were found in the domain are.
    /// The bound then holds as long as a path stays there.
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
            let inside = STRETCH.into_iter().find(|&c| probe.in_domain(&scaled(c, at)));
            [inside.unwrap_or(1.0); CLUSTER]
        };
        let factors: Vec<f64> = points.for_identities.iter().flat_map(factor).collect();
        let stretch = |(y, c): (&Vec<f64>, &f64)| scaled(*c, y);
        let stretched = f(probe, &states.iter().zip(&factors).map(stretch).collect::<Batch>());
        let constant_hessian = third_differences(probe, points, states, f);
        let zero = values.iter().chain(&stretched).all(|x| *x == 0.0);
        let typical = largest(&values);
        // The degree is read where F is largest.
        let moving = (0..values.len()).filter(|&n| factors[n] != 1.0);
        let best = moving.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()));
        let degree = best.map_or(f64::NAN, |n| (stretched[n] / values[n]).ln() / factors[n].ln());
        let degree = if zero { 0.0 } else { short(degree) + 0.0 };
        let mut homogeneous =
            if degree.fract() == 0.0 { Finding::default() } else { Finding::fitted() };
        if degree.is_finite() {
            let term = |n: usize| vec![sum([stretched[n], -(factors[n].powf(degree) * values[n])])];
            let terms: Vec<_> = (0..values.len()).map(term).collect();
            for (at, cluster) in points.for_identities.iter().zip(terms.chunks(CLUSTER)) {
                homogeneous.record(at, cluster, typical);
            }
        } else {
            homogeneous.status = if typical.is_finite() { Status::Fails } else { Status::Unknown };
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
        let of_form = match kind {
            _ if locals.is_empty() || !points.everywhere => None,
            Kind::Linear => Some(1),
            Kind::Quadratic => Some(2),
            _ => None,
        };
        let minimum = of_form.map(|degree| Minimum::of(&form(probe, degree, f), false));
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
        let mut lengths = (0..HALVINGS).map(|halvings| STEP * f64::powi(0.5, halvings));
        let inside = |length: &f64| {
            (1..=3).all(|k| probe.in_domain(&moved(&all[n], f64::from(k) * length, b)))
        };
        lengths.find(inside).map(|length| scaled(length, b))
    };
    let steps: Vec<Option<Vec<f64>>> = (0..all.len()).map(step).collect();
    let at = |k: f64| -> Batch {
        let moved = |(n, y): (usize, &Vec<f64>)| match &steps[n / CLUSTER] {
            Some(step) => moved(y, k, step),
            None => y.clone(),
        };
        states.iter().enumerate().map(moved).collect()
    };
    let values = [0.0, 1.0, 2.0, 3.0].map(|k| f(probe, &at(k)));
    let mut finding = Finding::default();
    for (n, y) in all.iter().enumerate().filter(|(n, _)| steps[*n].is_some()) {
        let term = |n: usize| {
            let [a, b, c, d] = values.each_ref().map(|values| values[n]);
            vec![sum([d, -3.0 * c, 3.0 * b, -a])]
        };
        let cluster: Vec<Vec<Term>> = (CLUSTER * n..CLUSTER * (n + 1)).map(term).collect();
        finding.record(y, &cluster, 0.0);
    }
    finding.seen()
}

/// β of βᵀy, or Q of ½yᵀQy, from values at unit vectors.
fn form(probe: &mut Probe<'_>, degree: u32, f: Values<'_>) -> Form {
    let d = probe.dimension();
    let axes: Batch = (0..d).map(|i| axis(d, i)).collect();
    let alone = f(probe, &axes);
    let pairs: Batch = (0..d * d).map(|n| moved(&axes[n / d], 1.0, &axes[n % d])).collect();
    let coefficients = match degree {
        1 => alone,
        _ => (f(probe, &pairs).into_iter().enumerate())
            .map(|(n, both)| both - alone[n / d] - alone[n % d])
            .collect(),
    };
    Form { degree, coefficients }
}

impl Minimum {
    /// On the whole sphere, or on its positive part where the domain has positive states only.
    pub(super) fn of(form: &Form, positive_states: bool) -> Self {
        let beta = &form.coefficients;
        let least = beta.iter().copied().fold(f64::INFINITY, f64::min);
        let in_domain_only = form.degree == 1 && positive_states && least > 0.0;
        let (value, error) = match form.degree {
            0 => (f64::NEG_INFINITY, 0.0),
            1 if in_domain_only => (least, 0.0),
            1 => (-norm(beta), 0.0),
            _ => {
                let q = form.matrix();
                // Backward stable, with a modest multiple of u‖Q‖ (Golub and Van Loan 2013, section
                // 8.6).
                let error = 4.0 * f64::EPSILON * q.len() as f64 * norm(beta);
                (0.5 * smallest_eigenvalue(&q), error)
            }
        };
        let positive = match (value > error, value < -error) {
            (true, _) => Status::Holds,
            (_, true) => Status::Fails,
            _ => Status::Unknown,
        };
        Self { value: value - error, positive, in_domain_only }
    }
}
