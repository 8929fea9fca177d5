//! Vector fields of a system: f = B∇h, its derivatives, the Itô correction and commutators.

use dgrad::GradientField;
use real::{
    Bounded, Degree, Partial, Real, ScalarFunction, along, derivatives, fixed, golden, seeded,
    unrolled,
};

use crate::PoissonSystem;

/// The Hamiltonian increment h(y) = H₀(y)dt + Σ Hₘ(y)dwₘ of a system. As a [`ScalarFunction`] it is
/// h(y), and as a [`GradientField`] ∇h(y).
pub struct HamiltonianIncrement<'a, S, const M: usize> {
    /// The system.
    pub system: &'a S,
    /// The weight of H₀.
    pub dt: f64,
    /// The weights of H₁ … H_M.
    pub dw: [f64; M],
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> ScalarFunction<D>
    for HamiltonianIncrement<'_, S, M>
{
    #[inline(always)]
    fn value<R: Real>(&self, y: [R; D]) -> R {
        self.system.energy(y, self.dt, self.dw)
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> GradientField<D>
    for HamiltonianIncrement<'_, S, M>
{
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D]) -> [R; D] {
        self.system.gradient(y, self.dt, self.dw)
    }
}

/// The vector field B(y)∇h(y) = f₀(y)dt + Σ fₘ(y)dwₘ with fₘ = B∇Hₘ.
#[inline(always)]
pub fn vector_field<S: PoissonSystem<D, M>, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
    dt: f64,
    dw: [f64; M],
) -> [R; D] {
    system.structure(y, system.gradient(y, dt, dw))
}

/// (B∇h)′(y)·v, the derivative of [`vector_field`] in the direction v, including that of B.
#[inline(always)]
pub fn vector_field_derivative<S: PoissonSystem<D, M>, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
    dt: f64,
    dw: [f64; M],
    v: [R; D],
) -> [R; D] {
    derivatives(vector_field(system, along(y, v), dt, dw))
}

/// The unit vector eₘ, m < M: with dt = 0 and dw = eₘ, [`vector_field`] is fₘ.
#[inline(always)]
pub fn unit_noise<const M: usize>(m: usize) -> [f64; M] {
    let mut dw = [0.0; M];
    dw[m] = 1.0;
    dw
}

/// ½Σₘ fₘ′(y)fₘ(y), the drift that converts the Stratonovich equation to the Itô equation. The
/// derivative includes that of B. It takes one evaluation on dual numbers per noise.
#[inline(always)]
pub fn ito_correction<S: PoissonSystem<D, M>, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
) -> [R; D] {
    let mut correction = [R::zero(); D];
    unrolled!(R: m in 0..M => {
        let direction = vector_field(system, y, 0.0, unit_noise(m));
        let derivative = vector_field_derivative(system, y, 0.0, unit_noise(m), direction);
        for i in 0..D {
            correction[i] = correction[i] + derivative[i] * 0.5;
        }
    });
    correction
}

/// Σ_{m<l} A_ml ∇{Hₘ, H_l}(y) for a skew matrix A of Lévy areas, with {F, G} = ∇FᵀB∇G.
///
/// Where Jacobi's identity holds ([`jacobi_holds`]), \[fₘ, f_l\] = −B∇{Hₘ, H_l}, so that
/// [`commutators`](PoissonSystem::commutators) are −B times this gradient.
///
/// With Gₘ = Σ_l A_ml ∇H_l it is Σₘ (∇²Hₘ B Gₘ + ½∇ₓ(∇HₘᵀB(x)Gₘ)), the second gradient being that
/// of B alone: a directional derivative of ∇Hₘ for each noise.
#[inline(always)]
pub fn area_gradient<S: PoissonSystem<D, M>, R: Real, const D: usize, const M: usize>(
    system: &S,
    y: [R; D],
    areas: [[f64; M]; M],
) -> [R; D] {
    let mut sum = [R::zero(); D];
    if M < 2 {
        return sum;
    }
    unrolled!(R: m in 0..M => {
        let other = system.gradient(y, 0.0, areas[m]);
        let direction = system.structure(y, other);
        let slope = system.gradient(along(y, direction), 0.0, unit_noise(m));
        unrolled!(R: k in 0..D => {
            let column: [Partial<R>; D] = system.structure(seeded(y, k), fixed(other));
            let mut bent = R::zero();
            for i in 0..D {
                bent = bent + slope[i].value * column[i].derivative();
            }
            sum[k] = sum[k] + (slope[k].derivative() + bent * 0.5);
        });
    });
    sum
}

/// Degree of h as a polynomial in y that its formula shows. The compiler knows it of an inlined
/// formula.
#[inline(always)]
pub fn degree<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    dt: f64,
    dw: [f64; M],
) -> Degree {
    system.energy([Degree::VARIABLE; D], dt, dw)
}

/// Whether the formula of h shows a polynomial of degree at most two in y. Then ∇h is affine and
/// ∇̄h(a, b) = ∇h((a+b)/2). The compiler answers it for an inlined formula.
#[inline(always)]
pub fn is_quadratic<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    dt: f64,
    dw: [f64; M],
) -> bool {
    degree(system, dt, dw) <= Degree::of(2)
}

/// Distances from y of the points that [`noises_commute`] tests, relative to max(1, |yᵢ|).
const DISTANCES: [f64; 4] = [0.011, 0.17, 0.9, 3.0];
/// Directions in which the points lie; their opposites are used as well.
const DIRECTIONS: u32 = 4;
/// Halvings of a distance until the point is in the domain.
const HALVINGS: u32 = 60;
/// Least number of points.
const MIN_POINTS: usize = 3;

/// Whether the noise fields fₘ = B∇Hₘ commute.
///
/// It is `true` if every component of [fₘ, f_l] is zero within its own rounding error, which
/// [`Bounded`] bounds, at `y` and at points around it in several directions, moved towards `y` into
/// the domain, at three points at least; and if the formulas are not made of pieces. Analytic
/// fields that commute on an open set commute everywhere, and fields that do not pass at such
/// points with probability zero. Pieces (a condition, a square root) may act where no point is, so
/// the answer is `false`: it is safe, and costs areas.
pub fn noises_commute<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
) -> bool {
    shown_around(system, y, |system, y, m, l| {
        let (f, g) = (vector_field(system, y, 0.0, unit_noise(l)), unit_noise(m));
        let one =
            vector_field_derivative(system, y, 0.0, unit_noise(l), vector_field(system, y, 0.0, g));
        let other = vector_field_derivative(system, y, 0.0, g, f);
        std::array::from_fn(|i| one[i] - other[i])
    })
}

/// Whether \[fₘ, f_l\] = −B∇{Hₘ, H_l} for all noises, which Jacobi's identity for B implies, shown
/// as in [`noises_commute`].
pub fn jacobi_holds<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
) -> bool {
    shown_around(system, y, |system, y, m, l| {
        let mut areas = [[0.0; M]; M];
        (areas[m][l], areas[l][m]) = (1.0, -1.0);
        let field = system.structure(y, area_gradient(system, y, areas));
        let commutators = system.commutators(y, areas);
        std::array::from_fn(|i| commutators[i] + field[i])
    })
}

/// Whether the `defect` of every two noises m < l vanishes around y.
fn shown_around<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
    defect: fn(&S, [Bounded; D], usize, usize) -> [Bounded; D],
) -> bool {
    let in_domain = |y: &[f64]| system.check_domain(std::array::from_fn(|i| y[i])).is_ok();
    let defects = |y: &[Bounded]| {
        let y: [Bounded; D] = std::array::from_fn(|i| y[i]);
        (0..M).flat_map(|l| (0..l).flat_map(move |m| defect(system, y, m, l))).collect()
    };
    M < 2 || vanish(&y, in_domain, defects)
}

/// Whether functions of y are zero within their own rounding errors, which [`Bounded`] bounds, at
/// `y` and at points [`around`] it, three at least, and their formulas are not made of pieces.
pub fn vanish(
    y: &[f64],
    in_domain: impl Fn(&[f64]) -> bool,
    functions: impl Fn(&[Bounded]) -> Vec<Bounded>,
) -> bool {
    let points = around(y, in_domain);
    let vanish_at = |point: &Vec<f64>| {
        let point: Vec<Bounded> = point.iter().map(|&x| Bounded::variable(x)).collect();
        let (values, piecewise) = Bounded::piecewise(|| functions(&point));
        !piecewise && values.iter().all(|x| x.value.abs() <= x.error && x.error.is_finite())
    };
    points.len() >= MIN_POINTS && points.iter().all(vanish_at)
}

/// Component i of direction number n, between −1 and 1: multiples of the golden ratio, modulo one,
/// differ in every component.
pub fn direction(n: u32, dimension: usize, i: usize) -> f64 {
    2.0 * golden(f64::from(n) * dimension as f64 + (i + 1) as f64) - 1.0
}

/// y, and points around it in several directions, moved towards y into the domain.
pub fn around(y: &[f64], in_domain: impl Fn(&[f64]) -> bool) -> Vec<Vec<f64>> {
    let mut points = vec![y.to_vec()];
    for (n, distance) in (0..2 * DIRECTIONS).flat_map(|n| DISTANCES.map(|distance| (n, distance))) {
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        let inside = (0..HALVINGS).find_map(|halvings| {
            let length = distance * f64::powi(0.5, halvings as i32);
            let component = |(i, y): (usize, &f64)| {
                let direction = direction(n / 2, points[0].len(), i);
                y + sign * direction * length * f64::max(1.0, y.abs())
            };
            let point: Vec<f64> = y.iter().enumerate().map(component).collect();
            in_domain(&point).then_some(point)
        });
        points.extend(inside.filter(|point| !points.contains(point)));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_around_lie_in_many_directions_at_every_distance() {
        let y = [0.5, -40.0, 3.0];
        let points = around(&y, |_| true);
        assert_eq!((points.len(), &points[0][..]), (1 + 2 * 4 * 4, &y[..]));
        // What is left of each offset in units of its distance and of the component, if not below
        // one.
        let direction = |n: usize| -> [f64; 3] {
            let scale = [1.0, 40.0, 3.0];
            std::array::from_fn(|i| (points[n][i] - y[i]) / (DISTANCES[(n - 1) % 4] * scale[i]))
        };
        let mut numbers = Vec::new();
        for first in (1..33).step_by(4) {
            for n in first..first + 4 {
                // The same direction at four distances, and its opposite after it.
                let opposite = if (first / 4) % 2 == 0 { first } else { first - 4 };
                let sign = if opposite == first { 1.0 } else { -1.0 };
                for i in 0..3 {
                    let (one, same) = (direction(n)[i], sign * direction(opposite)[i]);
                    assert!((one - same).abs() < 1e-11 && one.abs() < 1.0, "{n} {i}");
                }
            }
            if (first / 4) % 2 == 0 {
                numbers.extend(direction(first));
            }
        }
        // Twelve multiples of the golden ratio, modulo one: no two are closer than F₇⁻¹ = 1/13
        // of the circle, or 2/13 of [−1, 1), less a little.
        numbers.sort_by(f64::total_cmp);
        assert!(numbers.windows(2).all(|pair| pair[1] - pair[0] > 0.1), "{numbers:?}");
    }

    #[test]
    fn points_around_are_drawn_into_the_domain() {
        let y = [1e-3, 2.0, 3.0];
        let points = around(&y, |y| y[0] > 0.0);
        assert!(points.iter().all(|point| point[0] > 0.0) && points.len() > 16);
        // Those that were inside at once stay where they are.
        let all = around(&y, |_| true);
        assert!(all.iter().filter(|point| point[0] > 0.0).all(|point| points.contains(point)));
    }
}
