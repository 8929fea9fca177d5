//! The shape of a scalar function: linear, quadratic or homogeneous, its degree and its minimum on
//! the unit sphere.

use real::{Bounded, Degree};
use serde::Serialize;

use super::{
    algebra::{
        Matrix, backward_error, dot, error_norm, largest, matrix_values, norm, size,
        smallest_eigenvalue, values,
    },
    erased::{Function, System},
    finding::{Finding, Status},
    points::Points,
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
    /// The degree p of a homogeneous function, by Euler's identity ∇F·y = pF.
    pub degree: Option<f64>,
    /// The error bound of the degree; zero for an integer.
    pub degree_error: f64,
    /// Euler's identity.
    pub homogeneous: Finding,
    /// The Hessian is constant, hence the averaged gradient is the gradient at the midpoint.
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
    /// A bound of the error of `value`.
    pub error: f64,
    /// How it is known that m(F) > 0.
    pub positive: Status,
    /// Whether the minimum is over the part of the sphere in the domain of the system only. The
    /// bound then holds as long as a path stays there.
    pub in_domain_only: bool,
}

impl Shape {
    pub(super) fn of(f: &dyn Function, system: &dyn System, points: &Points) -> Self {
        let [first, ..] = points.for_identities.as_slice() else {
            unreachable!("an inspection has points")
        };
        let (gradient, hessian) = (f.gradient(first), f.hessian(first));
        let (mut constant_gradient, mut constant_hessian) =
            (Finding::default(), Finding::default());
        let mut zero = true;
        for y in &points.for_identities {
            let slope = f.gradient(y);
            constant_gradient.compare(&slope, &gradient, y);
            // A Hessian may vanish to round-off of the gradient.
            let flat = largest(&values(&slope)) / points.extent();
            for (row, expected) in f.hessian(y).iter().zip(&hessian) {
                for (&a, &b) in row.iter().zip(expected) {
                    constant_hessian.record(a - b, a.value.abs() + b.value.abs() + flat, y);
                }
            }
            zero &= f.value(y).value == 0.0 && slope.iter().all(|x| x.value == 0.0);
        }
        let (degree, homogeneous) = degree(f, points);
        let kind = match (degree, homogeneous.status) {
            _ if zero => Kind::Zero,
            (_, Status::Unknown) => Kind::Unknown,
            (Some(p), _) if p.value == 1.0 && constant_gradient.holds() => Kind::Linear,
            (Some(p), _) if p.value == 2.0 && constant_hessian.holds() => Kind::Quadratic,
            (Some(_), _) => Kind::Homogeneous,
            (None, _) => Kind::NotHomogeneous,
        };
        let degree = degree.filter(|_| !matches!(kind, Kind::Zero | Kind::Unknown));
        let minimum = degree.map(|_| {
            let status = homogeneous.status.min(constant_hessian.status);
            match kind {
                Kind::Linear if points.everywhere => Minimum::of_linear(&gradient),
                Kind::Quadratic => Minimum::of_form(&hessian, status)
                    .everywhere_or(|| Minimum::by_search(&|y| f.value(y), system, points), points),
                _ => Minimum::by_search(&|y| f.value(y), system, points),
            }
        });
        Self {
            kind,
            degree: degree.map(|p| p.value),
            degree_error: degree.map_or(0.0, |p| p.error),
            homogeneous,
            constant_hessian,
            minimum,
        }
    }
}

/// p of Euler's identity ∇F·y = pF, computed where F is largest relative to its terms; an integer
/// if one is within its error bound, 0 for constants and ratios. And whether the identity holds at
/// all points.
fn degree(f: &dyn Function, points: &Points) -> (Option<Bounded>, Finding) {
    let euler = |y: &Vec<f64>| {
        let (gradient, y) =
            (f.gradient(y), y.iter().map(|&x| Bounded::variable(x)).collect::<Vec<_>>());
        (dot(&gradient, &y), size(&gradient, &y))
    };
    let terms: Vec<_> = points.for_identities.iter().map(|y| (f.value(y), euler(y))).collect();
    let mut identity = Finding::default();
    let relative = |(value, (_, size)): &(Bounded, (Bounded, f64))| {
        let relative = value.value.abs() / (size + value.value.abs());
        if relative.is_nan() { 0.0 } else { relative }
    };
    let Some((value, (slope, _))) = terms.iter().max_by(|a, b| relative(a).total_cmp(&relative(b)))
    else {
        return (None, identity);
    };
    let zero = slope.value == 0.0 && value.value == 0.0;
    let mut p = if zero { Bounded::exact(0.0) } else { *slope / *value };
    if (p.value - p.value.round()).abs() <= p.error {
        // Not −0.
        p = Bounded::exact(p.value.round() + 0.0);
    }
    p.degree = Degree::CONSTANT;
    for (y, (value, (slope, size))) in points.for_identities.iter().zip(&terms) {
        let scaled = *value * p;
        identity.record(*slope - scaled, size + scaled.value.abs(), y);
    }
    ((p.value.is_finite() && identity.holds()).then_some(p), identity)
}

/// Shortest step of the search; the error of the minimum is of the order of its square.
const SHORTEST: f64 = 1e-7;
/// Starts of the search.
const STARTS: usize = 8;

impl Minimum {
    /// −‖β‖.
    fn of_linear(beta: &[Bounded]) -> Self {
        let value = -norm(&values(beta));
        let error = error_norm(beta) + f64::EPSILON * beta.len() as f64 * value.abs();
        Self { value, error, positive: Status::Refuted, in_domain_only: false }
    }

    /// Of ½yᵀQy, by the smallest eigenvalue. `form` says how it is known that this is the function.
    pub(super) fn of_form(q: &Matrix<Bounded>, form: Status) -> Self {
        let entries = matrix_values(q);
        let value = 0.5 * smallest_eigenvalue(&entries);
        let size = norm(&entries.concat());
        let error =
            0.5 * (error_norm(q.iter().flatten()) + backward_error(q.len(), q.len()) * size);
        let positive = match (value > error, value < -error) {
            (true, _) => form,
            (_, true) => Status::Refuted,
            _ => Status::Unknown,
        };
        Self { value, error, positive, in_domain_only: false }
    }

    /// This minimum over the whole sphere if it is positive or the domain is everywhere.
    pub(super) fn everywhere_or(self, search: impl Fn() -> Self, points: &Points) -> Self {
        if self.positive.holds() || points.everywhere { self } else { search() }
    }

    /// A compass search on the sphere from the best points: steps along the axes, halved when none
    /// helps. A negative value refutes m(F) > 0; a positive one proves nothing.
    pub(super) fn by_search(
        f: &dyn Fn(&[f64]) -> Bounded,
        system: &dyn System,
        points: &Points,
    ) -> Self {
        let on_sphere = |y: &[f64]| {
            let length = norm(y);
            let y: Vec<f64> = y.iter().map(|x| x / length).collect();
            let value = f(&y).value;
            (system.in_domain(&y) && value.is_finite()).then_some((value, y))
        };
        let mut starts: Vec<_> = points.for_suprema.iter().filter_map(|y| on_sphere(y)).collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let size = largest(starts.iter().map(|(value, _)| value));
        let mut least = Bounded::exact(f64::INFINITY);
        for (mut lowest, mut y) in starts.into_iter().take(STARTS) {
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
            let found = f(&y);
            if found.value < least.value {
                least = found;
            }
        }
        let Bounded { value, error, .. } = least;
        // The search ends at a distance of the order of its step from a minimum.
        let resolved = error + SHORTEST * size;
        let positive = if value < -error {
            Status::Refuted
        } else if value > resolved && value.is_finite() {
            Status::Found
        } else {
            Status::Unknown
        };
        Self { value, error, positive, in_domain_only: !points.everywhere }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::tests::by_hand::{ByHand, Given, at, close, exact, within},
        *,
    };

    #[test]
    fn minima_have_the_errors_of_their_coefficients() {
        let linear = Minimum::of_linear(&[within(3.0, 0.1), within(-4.0, 0.2)]);
        let error = 0.1f64.hypot(0.2) + 10.0 * f64::EPSILON;
        assert!(linear.value == -5.0 && close(linear.error, error), "{linear:?}");
        // Half the smaller eigenvalue, and half the Frobenius norm of the errors.
        let of = |least: f64, form| {
            let rows = vec![vec![within(least, 0.3), within(0.0, 0.4)], exact(&[0.0, 4.0])];
            Minimum::of_form(&rows, form)
        };
        let error = 0.5 * (0.5 + 16.0 * f64::EPSILON * 20f64.sqrt());
        let two = of(2.0, Status::Found);
        assert!(close(two.value, 1.0) && close(two.error, error), "{two:?}");
        assert_eq!((two.positive, of(2.0, Status::Shown).positive), (Status::Found, Status::Shown));
        // ±½ within ¼, and 0.2 within 0.25.
        let signs = [0.51, 0.49, -0.49, -0.51].map(|x| of(x, Status::Shown).positive);
        assert_eq!(signs, [Status::Shown, Status::Unknown, Status::Unknown, Status::Refuted]);
        // A search is for what is not positive everywhere where the domain is not everywhere.
        let (below, found) = (of(-2.0, Status::Shown), Minimum { value: 7.0, ..two });
        let inside = Points { everywhere: false, ..at(&[]) };
        let value = |minimum: Minimum, points| minimum.everywhere_or(|| found, points).value;
        assert_eq!((value(two, &inside), value(below, &inside)), (two.value, 7.0));
        assert_eq!(value(below, &at(&[])), below.value);
    }

    #[test]
    fn a_search_tells_the_sign_beyond_its_error_and_its_step() {
        let points = Points { everywhere: false, ..at(&[&[2.0, 1.0], &[0.0, 3.0]]) };
        let system = ByHand::default();
        let search = |f: &dyn Fn(&[f64]) -> Bounded| Minimum::by_search(f, &system, &points);
        let constant = |value, error| search(&|_| within(value, error));
        assert_eq!(constant(0.3, 0.29).positive, Status::Found);
        assert_eq!(constant(0.3, 0.31).positive, Status::Unknown);
        assert_eq!(constant(-0.3, 0.31).positive, Status::Unknown);
        assert_eq!(constant(-0.3, 0.29).positive, Status::Refuted);
        assert_eq!((constant(-0.3, 0.25).value, constant(-0.3, 0.25).error), (-0.3, 0.25));
        assert!(constant(0.3, 0.0).in_domain_only);
        // The least value, at (0, ±1), is told from zero beyond 1e-7 of the largest start, 0.8.
        let above = |least: f64| search(&|y| Bounded::exact(y[0] * y[0] + least));
        assert!((above(1e-3).value - 1e-3).abs() < 1e-13, "{:?}", above(1e-3));
        assert_eq!((above(9e-8).positive, above(7e-8).positive), (Status::Found, Status::Unknown));
        // Nowhere finite, or nowhere in the domain.
        let nowhere = ByHand { inside: |_| false, ..ByHand::default() };
        let none = Minimum::by_search(&|_| Bounded::exact(1.0), &nowhere, &points);
        for found in [constant(f64::NAN, 0.0), none] {
            assert_eq!((found.value, found.positive), (f64::INFINITY, Status::Unknown));
        }
    }

    /// F with these values, slopes and Hessians at (3, 4) and (0, 1).
    fn shape(
        value: fn(&[f64]) -> Bounded,
        gradient: fn(&[f64]) -> Vec<Bounded>,
        hessian: fn(&[f64]) -> Matrix<Bounded>,
    ) -> Shape {
        let points = at(&[&[3.0, 4.0], &[0.0, 1.0]]);
        Shape::of(&Given { value, gradient, hessian }, &ByHand::default(), &points)
    }

    fn flat(_: &[f64]) -> Matrix<Bounded> {
        vec![exact(&[0.0; 2]); 2]
    }

    #[test]
    fn kinds_follow_from_the_degree_and_from_what_is_constant() {
        let quadratic = |y: &[f64]| Bounded::exact(0.5 * (y[0] * y[0] + y[1] * y[1]));
        let unit = |_: &[f64]| vec![exact(&[1.0, 0.0]), exact(&[0.0, 1.0])];
        let found = shape(quadratic, exact, unit);
        assert_eq!(
            (found.kind, found.degree, found.degree_error),
            (Kind::Quadratic, Some(2.0), 0.0)
        );
        assert!(close(found.minimum.unwrap().value, 0.5));
        // 1 + 1, and the slope 4 over the extent 5.
        assert!(close(found.constant_hessian.scale, 2.8), "{found:?}");
        // Of degree two with Hessians that differ.
        let bent = |y: &[f64]| vec![exact(&[1.0, y[0]]), exact(&[y[0], 1.0])];
        assert_eq!(shape(quadratic, exact, bent).kind, Kind::Homogeneous);
        let linear = shape(|y| Bounded::exact(y[0] - y[1]), |_| exact(&[1.0, -1.0]), flat);
        assert_eq!((linear.kind, linear.degree), (Kind::Linear, Some(1.0)));
        let least = linear.minimum.unwrap();
        assert!(close(least.value, -2f64.sqrt()) && close(least.error, f64::EPSILON * 8f64.sqrt()));
        // Of degree one with slopes that differ: |y₁| + |y₂|.
        let norm = shape(|y| Bounded::exact(y[0] + y[1]), |y| exact(&[y[0].signum(), 1.0]), flat);
        assert_eq!((norm.kind, norm.degree), (Kind::Linear, Some(1.0)));
        let zero = shape(|_| Bounded::exact(0.0), |_| exact(&[0.0; 2]), flat);
        assert_eq!((zero.kind, zero.degree, zero.minimum), (Kind::Zero, None, None));
        // Zero with a slope at one point, or with a value, is not zero.
        let slope = shape(|_| Bounded::exact(0.0), |y| exact(&[y[0], 0.0]), flat);
        assert_eq!((slope.kind, slope.degree), (Kind::NotHomogeneous, None));
        let one = shape(|_| Bounded::exact(1.0), |_| exact(&[0.0; 2]), flat);
        assert_eq!((one.kind, one.degree), (Kind::Homogeneous, Some(0.0)));
        let below = shape(|_| Bounded::exact(-1.0), |_| exact(&[0.0; 2]), flat);
        assert!(below.degree.is_some_and(|degree| degree.is_sign_positive()), "not −0");
        // Values with an error of 1e-9 of theirs.
        let rough = |y: &[f64]| within(y[0] + y[1], 1e-9 * (y[0] + y[1]));
        let unknown = shape(rough, |_| exact(&[1.0; 2]), flat);
        assert_eq!((unknown.kind, unknown.degree, unknown.minimum), (Kind::Unknown, None, None));
        // A Hessian is zero to round-off of the slopes: 5/extent = 1 for (3, 4) of length five.
        let slopes = |_: &[f64]| exact(&[3.0, -5.0]);
        let flat = shape(|y| Bounded::exact(3.0 * y[0] - 5.0 * y[1]), slopes, flat);
        assert_eq!(flat.constant_hessian.scale, 1.0);
    }

    #[test]
    fn a_degree_is_read_where_the_function_is_largest_and_has_its_error() {
        let points = at(&[&[1.0, 0.0], &[0.0, 2.0]]);
        let of = |value: fn(&[f64]) -> Bounded, gradient: fn(&[f64]) -> Vec<Bounded>| {
            degree(&Given { value, gradient, hessian: flat }, &points)
        };
        // ∇F·y = 5 and F = 2 ± 0.02 at the second point; at the first one F vanishes.
        let value = |y: &[f64]| within(y[1], 0.01 * y[1]);
        let (p, identity) = of(value, |_| vec![within(0.0, 0.0), within(2.5, 0.025)]);
        // Errors of a hundredth leave the identity unknown.
        assert!(p.is_none() && identity.status == Status::Unknown, "{p:?} {identity:?}");
        assert_eq!((identity.scale, identity.points), (10.0, 2));
        // Relative errors add up: 2.5 ± 2.5·2e-14 is told, and 2 + 1e-14 is two.
        let value = |y: &[f64]| within(y[1], 1e-14 * y[1]);
        let (p, _) = of(value, |_| vec![within(0.0, 0.0), within(2.5, 2.5e-14)]);
        let p = p.unwrap();
        assert!(p.value == 2.5 && (p.error / 5e-14 - 1.0).abs() < 0.02, "{p:?}");
        assert_eq!(p.degree, Bounded::exact(0.0).degree);
        let (p, _) = of(value, |_| vec![within(0.0, 0.0), within(2.0 + 1e-14, 2e-14)]);
        assert_eq!(p, Some(Bounded::exact(2.0)));
        // No power explains both.
        let (p, identity) = of(|y| Bounded::exact(y[0] + y[1]), |y| exact(&[1.0, y[1]]));
        assert!(p.is_none() && identity.refuted(), "{identity:?}");
    }
}
