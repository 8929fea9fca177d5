//! The shape of a scalar function, from its values: whether it is homogeneous, its degree, and the
//! minimum of a linear or quadratic form on the unit sphere.

use real::elementary::{ln, powf};
use serde::Serialize;

use super::Sight;
use crate::facts::{
    Batch, CLUSTER, Finding, Form, Probe, Status, Values, axis, largest, moved, norm, scaled,
    smallest_eigenvalue, sum,
};

/// The shape of a function F.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// The degree p of a homogeneous function that is not zero.
    pub degree: Option<f64>,
    /// Finding on F(cy) = cᵖF(y). Without homogeneity there is no conformal law.
    pub homogeneous: Finding,
    /// Minimum m(F) of a linear or quadratic form that is defined everywhere.
    pub minimum: Option<Minimum>,
}

/// Minimum m(F) = min F over the unit sphere; if it is positive, F bounds all paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Minimum {
    /// Value of m(F): −‖β‖ of a linear function; half the smallest eigenvalue of a quadratic form,
    /// less its rounding error; the smallest βᵢ of a linear function on positive states; −∞ of
    /// logarithms.
    pub value: f64,
    /// Whether m(F) > 0.
    pub positive: Status,
    /// Whether the minimum is over positive states only, as all that were found in the domain are.
    /// The bound then holds as long as a path stays there.
    pub in_domain_only: bool,
}

/// Ratio of the lengths of two states of the same direction, and another for bounded domains.
const STRETCH: [f64; 2] = [2.0, 0.5];

impl Shape {
    pub(super) fn of(sight: &mut Sight<'_>, f: Values<'_>) -> Self {
        let values = f(&mut sight.probe, &sight.states);
        let factors = sight.points.for_identities.iter().flat_map(|at| {
            let inside = STRETCH.into_iter().find(|&c| sight.probe.in_domain(&scaled(c, at)));
            [inside.unwrap_or(1.0); CLUSTER]
        });
        let factors: Vec<f64> = factors.collect();
        let states: Batch = sight.states.iter().zip(&factors).map(|(y, c)| scaled(*c, y)).collect();
        let stretched = f(&mut sight.probe, &states);
        let zero = values.iter().chain(&stretched).all(|x| *x == 0.0);
        let typical = largest(&values);
        // The degree is read where F is largest.
        let moving = (0..values.len()).filter(|&n| factors[n] != 1.0);
        let best = moving.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()));
        let degree = best.map_or(f64::NAN, |n| ln(stretched[n] / values[n]) / ln(factors[n]));
        let degree = if zero { 0.0 } else { short(degree) + 0.0 };
        let same = |sight: &Sight<'_>, finding: &mut Finding, others: &dyn Fn(usize) -> f64| {
            sight.record(finding, |n| vec![sum([stretched[n], -others(n)])], typical);
        };
        let mut homogeneous =
            if degree.fract() == 0.0 { Finding::default() } else { Finding::fitted() };
        if degree.is_finite() {
            same(sight, &mut homogeneous, &|n| powf(factors[n], degree) * values[n]);
        } else {
            homogeneous.status = if typical.is_finite() { Status::Fails } else { Status::Unknown };
        }
        let degree = Some(degree).filter(|_| homogeneous.holds() && !zero);
        let whole = !sight.matrices.is_empty() && sight.points.everywhere;
        let of_form = degree.filter(|degree| whole && [1.0, 2.0].contains(degree));
        let minimum = of_form.and_then(|degree| {
            let (form, mut fitted) = (form(&mut sight.probe, degree as u32, f), Finding::fitted());
            same(sight, &mut fitted, &|n| form.value(&states[n]));
            fitted.holds().then(|| Minimum::of(&form, false))
        });
        Self { degree, homogeneous, minimum }
    }

    /// Whether F = 0.
    pub(super) fn is_zero(&self) -> bool {
        self.degree.is_none() && self.homogeneous.holds()
    }
}

/// Rounds to nine decimals if round-off explains the difference.
fn short(x: f64) -> f64 {
    let rounded = (x * 1e9).round() / 1e9;
    if (x - rounded).abs() <= 1e-12 * (1.0 + x.abs()) { rounded } else { x }
}

/// Fits β of βᵀy, or Q of ½yᵀQy, to values at unit vectors.
fn form(probe: &mut Probe<'_>, degree: u32, f: Values<'_>) -> Form {
    let d = probe.dimension();
    let axes: Batch = (0..d).map(|i| axis(d, i)).collect();
    let alone = f(probe, &axes);
    let pairs: Batch = (0..d * d).map(|n| moved(&axes[n / d], 1.0, &axes[n % d])).collect();
    let coefficients = match degree {
        1 => alone,
        _ => {
            let both = f(probe, &pairs);
            (0..d * d).map(|n| both[n] - alone[n / d] - alone[n % d]).collect()
        }
    };
    Form { degree, coefficients }
}

impl Minimum {
    /// Minimum of `form` on the whole sphere, or on its positive part where the domain has positive
    /// states only.
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
                // Of the products of rows that the spectral radius is made of.
                let error = 4.0 * f64::EPSILON * q.len() as f64 * norm(beta);
                (0.5 * smallest_eigenvalue(&q), error)
            }
        };
        let positive = match value {
            value if value > error => Status::Holds,
            value if value < -error => Status::Fails,
            _ => Status::Unknown,
        };
        Self { value: value - error, positive, in_domain_only }
    }
}
