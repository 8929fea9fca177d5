//! What kind of function something is: linear, quadratic, homogeneous of which degree.

use serde::Serialize;

use super::algebra::{dot, eigenvalues, largest, norm};
use super::finding::{Finding, ROUND_OFF};
use super::points::Points;
use super::probe::{Matrix, Probe, pick};

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

/// What kind of function something is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// Its kind.
    pub kind: Kind,
    /// Degree p of homogeneity by Euler's identity ∇F·y = pF, if there is one.
    pub degree: Option<f64>,
    /// The Hessian is constant: with it the averaged gradient is the gradient at the midpoint.
    pub constant_hessian: bool,
    /// m(F) of a homogeneous function.
    pub minimum: Option<Minimum>,
}

/// m(F) = min F over the unit sphere; positive, it bounds all paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Minimum {
    /// The value: half the smallest eigenvalue of a quadratic form, −‖β‖ of a linear one, else
    /// found by a search.
    pub value: f64,
    /// Whether it is positive; a value of the size of the error of the search is not.
    pub positive: bool,
    /// Whether only the part of the sphere was considered where the system is defined: the bound
    /// then holds as long as a path stays there.
    pub in_domain_only: bool,
}

/// A function with its derivatives.
pub(super) trait Function {
    fn value(&self, y: &[f64]) -> f64;
    fn gradient(&self, y: &[f64]) -> Vec<f64>;
    fn hessian(&self, y: &[f64]) -> Matrix;
}

/// H₀ or Hₘ of a system.
pub(super) struct Hamiltonian<'a> {
    pub(super) system: &'a dyn Probe,
    pub(super) m: usize,
}

impl Function for Hamiltonian<'_> {
    fn value(&self, y: &[f64]) -> f64 {
        self.system.energy(y, &pick(self.system, self.m))
    }
    fn gradient(&self, y: &[f64]) -> Vec<f64> {
        self.system.dual_gradient(y, &pick(self.system, self.m))
    }
    fn hessian(&self, y: &[f64]) -> Matrix {
        self.system.hessian(y, &pick(self.system, self.m))
    }
}

/// An invariant that a system claims.
pub(super) struct Claimed<'a> {
    pub(super) system: &'a dyn Probe,
    pub(super) index: usize,
}

impl Function for Claimed<'_> {
    fn value(&self, y: &[f64]) -> f64 {
        self.system.invariant(self.index, y)
    }
    fn gradient(&self, y: &[f64]) -> Vec<f64> {
        self.system.invariant_gradient(self.index, y)
    }
    fn hessian(&self, y: &[f64]) -> Matrix {
        self.system.invariant_hessian(self.index, y)
    }
}

impl Shape {
    pub(super) fn of(f: &dyn Function, system: &dyn Probe, points: &Points) -> Self {
        let degree = degree(f, points);
        let first = &points.few[0];
        let (gradient, hessian) = (f.gradient(first), f.hessian(first));
        let (mut constant_gradient, mut constant_hessian) = (Finding::new(), Finding::new());
        for y in &points.few[1..] {
            let here = f.gradient(y);
            let size = norm(&here) + norm(&gradient);
            for (a, b) in here.iter().zip(&gradient) {
                constant_gradient.see(a - b, size, y);
            }
            let here = f.hessian(y);
            // A Hessian may vanish to round-off of the gradient.
            let scale = largest(&here) + largest(&hessian) + size / norm(y);
            for (a, b) in here.iter().flatten().zip(hessian.iter().flatten()) {
                constant_hessian.see(a - b, scale, y);
            }
        }
        let kind = match degree {
            Some(1.0) if constant_gradient.holds => Kind::Linear,
            Some(2.0) if constant_hessian.holds => Kind::Quadratic,
            Some(_) => Kind::Homogeneous,
            None => Kind::NotHomogeneous,
        };
        let minimum = degree.map(|_| match kind {
            Kind::Linear if points.everywhere => Minimum::exact(-norm(&gradient), norm(&gradient)),
            Kind::Quadratic if points.everywhere => Minimum::of_form(hessian),
            _ => Minimum::by_search(f, system, points),
        });
        Self { kind, degree, constant_hessian: constant_hessian.holds, minimum }
    }
}

/// A degree within this of an integer is that integer.
const INTEGER: f64 = 1e-9;

/// p of Euler's identity ∇F·y = pF: read off where F is largest beside its gradient, then asked for
/// everywhere.
fn degree(f: &dyn Function, points: &Points) -> Option<f64> {
    let euler = |y: &Vec<f64>| {
        let gradient = f.gradient(y);
        (f.value(y), dot(&gradient, y), norm(&gradient) * norm(y))
    };
    let clear = |y: &&Vec<f64>| {
        let (value, _, size) = euler(y);
        value.abs() / (size + value.abs())
    };
    let best = points.few.iter().max_by(|a, b| clear(a).total_cmp(&clear(b)))?;
    let (value, slope, _) = euler(best);
    let p = slope / value;
    let p = if (p - p.round()).abs() < INTEGER { p.round() } else { p };
    let mut identity = Finding::new();
    for y in &points.few {
        let (value, slope, size) = euler(y);
        identity.see(slope - p * value, size + (p * value).abs(), y);
    }
    (p.is_finite() && p != 0.0 && identity.holds).then_some(p)
}

/// A minimum found by search is positive when it is more than this of the largest value on the
/// sphere.
const CLEARLY_POSITIVE: f64 = 1e-6;
/// The search stops at steps of this length, where the value is good to its square.
const SHORTEST: f64 = 1e-7;

impl Minimum {
    fn exact(value: f64, size: f64) -> Self {
        Self { value, positive: value > ROUND_OFF * size, in_domain_only: false }
    }

    /// Of ½yᵀQy.
    pub(super) fn of_form(q: Matrix) -> Self {
        let size = largest(&q);
        Self::exact(0.5 * eigenvalues(q).first().copied().unwrap_or(0.0), size)
    }

    /// Steps along the axes, back onto the sphere, shorter when none helps, from the few best
    /// directions.
    pub(super) fn by_search(f: &dyn Function, system: &dyn Probe, points: &Points) -> Self {
        let on_sphere = |y: &[f64]| {
            let length = norm(y);
            let y: Vec<f64> = y.iter().map(|x| x / length).collect();
            let value = f.value(&y);
            (system.in_domain(&y) && value.is_finite()).then_some((value, y))
        };
        let mut starts: Vec<(f64, Vec<f64>)> =
            points.many.iter().filter_map(|y| on_sphere(y)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let largest = starts.iter().fold(0.0, |m: f64, (value, _)| m.max(value.abs()));
        let mut value = f64::INFINITY;
        for (mut here, mut y) in starts.into_iter().take(4) {
            let mut step = 0.5;
            while step > SHORTEST {
                let moved = (0..y.len()).flat_map(|i| [step, -step].map(|by| (i, by))).find_map(
                    |(i, by)| {
                        let mut moved = y.clone();
                        moved[i] += by;
                        on_sphere(&moved).filter(|(value, _)| *value < here)
                    },
                );
                match moved {
                    Some((lower, there)) => (here, y) = (lower, there),
                    None => step *= 0.5,
                }
            }
            value = value.min(here);
        }
        Self {
            value,
            positive: value > CLEARLY_POSITIVE * largest && value.is_finite(),
            in_domain_only: !points.everywhere,
        }
    }
}
