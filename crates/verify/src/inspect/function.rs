//! The shape of a scalar function: linear, quadratic or homogeneous, its degree and its minimum on
//! the unit sphere.

use serde::Serialize;

use super::{
    algebra::{Matrix, dot, eigenvalues, largest, norm},
    erased::{Function, System},
    finding::{Finding, ROUND_OFF},
    points::Points,
};

/// The kind of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// βᵀy.
    Linear,
    /// ½yᵀQy.
    Quadratic,
    /// Homogeneous, but neither of these.
    Homogeneous,
    /// Not homogeneous: it has no conformal law.
    NotHomogeneous,
}

impl Kind {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Quadratic => "quadratic",
            Self::Homogeneous => "homogeneous",
            Self::NotHomogeneous => "not homogeneous",
        }
    }
}

/// The shape of a function F.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// Its kind.
    pub kind: Kind,
    /// The degree p of a homogeneous function, by Euler's identity ∇F·y = pF.
    pub degree: Option<f64>,
    /// The Hessian is constant, hence the averaged gradient is the gradient at the midpoint.
    pub constant_hessian: bool,
    /// m(F) of a homogeneous function.
    pub minimum: Option<Minimum>,
}

/// m(F) = min F over the unit sphere; if it is positive, F bounds all paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Minimum {
    /// The value: −‖β‖ of a linear function, half the smallest eigenvalue of a quadratic form, else
    /// found by a search.
    pub value: f64,
    /// Whether the value is positive by more than its error.
    pub positive: bool,
    /// Whether the minimum is over the part of the sphere in the domain of the system only. The
    /// bound then holds as long as a path stays there.
    pub in_domain_only: bool,
}

impl Shape {
    pub(super) fn of(f: &dyn Function, system: &dyn System, points: &Points) -> Self {
        let [first, others @ ..] = points.for_identities.as_slice() else {
            unreachable!("an inspection has points")
        };
        let (gradient, hessian) = (f.gradient(first), f.hessian(first));
        let (mut constant_gradient, mut constant_hessian) =
            (Finding::default(), Finding::default());
        for y in others {
            let (slope, curvature) = (f.gradient(y), f.hessian(y).concat());
            let size = norm(&slope) + norm(&gradient);
            constant_gradient.compare(&slope, &gradient, size, y);
            // A Hessian may vanish to round-off of the gradient.
            let size = largest(&curvature) + largest(hessian.iter().flatten()) + size / norm(y);
            constant_hessian.compare(&curvature, &hessian.concat(), size, y);
        }
        let degree = degree(f, points);
        let kind = match degree {
            Some(1.0) if constant_gradient.holds => Kind::Linear,
            Some(2.0) if constant_hessian.holds => Kind::Quadratic,
            Some(_) => Kind::Homogeneous,
            None => Kind::NotHomogeneous,
        };
        let minimum = degree.map(|_| match kind {
            Kind::Linear if points.everywhere => Minimum::exact(-norm(&gradient), norm(&gradient)),
            Kind::Quadratic if points.everywhere => Minimum::of_form(hessian),
            _ => Minimum::by_search(&|y| f.value(y), system, points),
        });
        Self { kind, degree, constant_hessian: constant_hessian.holds, minimum }
    }
}

/// A degree within this of an integer is that integer.
const INTEGER: f64 = 1e-9;

/// p of Euler's identity ∇F·y = pF: computed where F is largest relative to its gradient, and
/// checked at all points.
fn degree(f: &dyn Function, points: &Points) -> Option<f64> {
    let euler = |y: &Vec<f64>| {
        let gradient = f.gradient(y);
        (f.value(y), dot(&gradient, y), norm(&gradient) * norm(y))
    };
    let terms: Vec<_> = points.for_identities.iter().map(euler).collect();
    let relative = |(value, _, size): &(f64, f64, f64)| value.abs() / (size + value.abs());
    let best = terms.iter().max_by(|a, b| relative(a).total_cmp(&relative(b)))?;
    let p = best.1 / best.0;
    let p = if (p - p.round()).abs() < INTEGER { p.round() } else { p };
    let mut identity = Finding::default();
    for (y, (value, slope, size)) in points.for_identities.iter().zip(terms.iter()) {
        identity.record(slope - p * value, size + (p * value).abs(), y);
    }
    (p.is_finite() && p != 0.0 && identity.holds).then_some(p)
}

/// A minimum found by search counts as positive above this part of the largest value on the sphere.
const CLEARLY_POSITIVE: f64 = 1e-6;
/// Shortest step of the search; the error of the minimum is of the order of its square.
const SHORTEST: f64 = 1e-7;

impl Minimum {
    fn exact(value: f64, size: f64) -> Self {
        Self { value, positive: value > ROUND_OFF * size, in_domain_only: false }
    }

    /// Of ½yᵀQy.
    pub(super) fn of_form(q: Matrix) -> Self {
        let size = largest(q.iter().flatten());
        Self::exact(0.5 * eigenvalues(q).first().copied().unwrap_or(0.0), size)
    }

    /// A compass search on the sphere from the four best points: steps along the axes, halved when
    /// none helps.
    pub(super) fn by_search(
        f: &dyn Fn(&[f64]) -> f64,
        system: &dyn System,
        points: &Points,
    ) -> Self {
        let on_sphere = |y: &[f64]| {
            let length = norm(y);
            let y: Vec<f64> = y.iter().map(|x| x / length).collect();
            let value = f(&y);
            (system.in_domain(&y) && value.is_finite()).then_some((value, y))
        };
        let mut starts: Vec<_> = points.for_suprema.iter().filter_map(|y| on_sphere(y)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let size = largest(starts.iter().map(|(value, _)| value));
        let mut value = f64::INFINITY;
        for (mut lowest, mut y) in starts.into_iter().take(4) {
            let mut step = 0.5;
            while step > SHORTEST {
                let mut moves = (0..y.len()).flat_map(|i| [(i, step), (i, -step)]);
                let lower = moves.find_map(|(i, by)| {
                    let mut moved = y.clone();
                    moved[i] += by;
                    on_sphere(&moved).filter(|(value, _)| *value < lowest)
                });
                match lower {
                    Some(found) => (lowest, y) = found,
                    None => step *= 0.5,
                }
            }
            value = value.min(lowest);
        }
        Self {
            value,
            positive: value > CLEARLY_POSITIVE * size && value.is_finite(),
            in_domain_only: !points.everywhere,
        }
    }
}
