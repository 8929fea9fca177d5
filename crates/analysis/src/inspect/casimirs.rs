//! All linear and quadratic Casimirs of B, from B alone.

use real::{Bounded, Real};
use serde::Serialize;

use super::{
    algebra::{
        Matrix, backward_error, dot, echelon, error_norm, largest, norm, singular_vectors, size,
        smallest_eigenvalue, times, values,
    },
    erased::System,
    facts::Form,
    finding::{Finding, Status},
    function::Minimum,
    logarithms::LogarithmicCasimir,
    points::Points,
};

/// A Casimir that follows from B alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FoundCasimir {
    /// The formula with the coefficients of this system, to six digits.
    pub formula: String,
    /// 1 for βᵀy, 2 for ½yᵀQy.
    pub degree: u32,
    /// β, or the rows of Q one after the other.
    pub coefficients: Vec<f64>,
    /// A bound of the error of each coefficient.
    pub coefficient_error: f64,
    /// B∇C = 0, with these coefficients.
    pub casimir: Finding,
    /// m(C).
    pub minimum: Minimum,
}

impl FoundCasimir {
    fn new(degree: u32, x: Coefficients, system: &dyn System, points: &Points) -> Self {
        let Coefficients { values: coefficients, error: coefficient_error } = x;
        let d = system.dimension();
        let bounded: Vec<_> =
            coefficients.iter().map(|&c| coefficient(c, coefficient_error)).collect();
        let mut casimir = Finding::default();
        for y in &points.for_identities {
            let state: Vec<_> = y.iter().map(|&x| Bounded::variable(x)).collect();
            let gradient =
                if degree == 1 { bounded.clone() } else { times(&square(&bounded, d), &state) };
            for row in system.matrix(y) {
                casimir.record(dot(&row, &gradient), size(&row, &gradient), y);
            }
        }
        let at = |y: &[f64]| value(degree, &bounded, y);
        let search = || Minimum::by_search(&at, system, points);
        let minimum = if degree == 2 {
            Minimum::of_form(&square(&bounded, d), Status::Shown).everywhere_or(search, points)
        } else {
            search()
        };
        let formula = formula(degree, &coefficients, d);
        Self { formula, degree, coefficients, coefficient_error, casimir, minimum }
    }

    /// C.
    pub fn form(&self) -> Form {
        Form { degree: self.degree, coefficients: self.coefficients.clone() }
    }
}

/// Coefficients with a bound of the error of each.
pub(super) struct Coefficients {
    pub(super) values: Vec<f64>,
    pub(super) error: f64,
}

/// A coefficient; zeros and integers were recognised and are exact.
pub(super) fn coefficient(value: f64, error: f64) -> Bounded {
    let exact = value == value.round();
    let rounded = Bounded::constant(value);
    Bounded { error: if exact { 0.0 } else { error.max(rounded.error) }, ..rounded }
}

fn value(degree: u32, coefficients: &[Bounded], y: &[f64]) -> Bounded {
    let y: Vec<_> = y.iter().map(|&x| Bounded::variable(x)).collect();
    match degree {
        1 => dot(coefficients, &y),
        _ => dot(&times(&square(coefficients, y.len()), &y), &y) * Bounded::exact(0.5),
    }
}

/// The places (i, j), i ≤ j, of a symmetric matrix.
pub(super) fn places(d: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..d).flat_map(move |i| (i..d).map(move |j| (i, j)))
}

/// `2 y1 + y2 − 0.5 y3`, coefficients to six digits.
pub(super) fn formula(degree: u32, coefficients: &[f64], d: usize) -> String {
    let (squares, products): (Vec<_>, Vec<_>) = places(d).partition(|(i, j)| i == j);
    let term = |(i, j): (usize, usize)| match (degree, i == j) {
        (1, _) => (coefficients[i], format!("y{}", i + 1)),
        (_, true) => (0.5 * coefficients[i * d + i], format!("y{}²", i + 1)),
        (_, false) => (coefficients[i * d + j], format!("y{} y{}", i + 1, j + 1)),
    };
    sum_of_terms(squares.into_iter().chain(products.into_iter().filter(|_| degree == 2)).map(term))
}

/// `2 a − b`, coefficients to six digits and without those that are zero.
pub(super) fn sum_of_terms(terms: impl Iterator<Item = (f64, String)>) -> String {
    let mut formula = String::new();
    for (coefficient, symbol) in terms.filter(|(coefficient, _)| *coefficient != 0.0) {
        let sign = match (formula.is_empty(), coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let size = (coefficient.abs() * 1e6).round() / 1e6;
        let size = if size == 1.0 { String::new() } else { format!("{size} ") };
        formula += &format!("{sign}{size}{symbol}");
    }
    formula
}

/// The linear and quadratic Casimirs of B.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Casimirs {
    /// A basis of the linear ones, then one of the quadratic ones. A scheme that preserves these
    /// preserves their linear combinations.
    pub found: Vec<FoundCasimir>,
    /// Functions that are almost Casimirs: their `casimir` is refuted, with its defect, or unknown.
    pub nearly: Vec<FoundCasimir>,
    /// How it is known that there are no others.
    pub complete: Status,
    /// A positive definite quadratic Casimir, which bounds all paths: the projection of ½‖y‖² onto
    /// the quadratic Casimirs, if it is positive definite.
    pub definite: Option<FoundCasimir>,
    /// Whether quadratic Casimirs were searched for: only where their D(D+1)/2 coefficients are no
    /// more than 300.
    pub quadratic_sought: bool,
    /// A basis of those that are sums of logarithms of coordinates.
    pub logarithmic: Vec<LogarithmicCasimir>,
}

/// Most unknowns of a singular value decomposition: it takes a tenth of a second.
pub(super) const UNKNOWNS: usize = 300;
/// Singular values below this part of the largest one belong to almost-Casimirs.
const NEARLY: f64 = 1e-3;
/// Most almost-Casimirs that are listed.
const LISTED: usize = 3;

impl Casimirs {
    /// Solves B(y)∇C(y) = 0 for the coefficients of C at all points, by singular values: zero are
    /// those below the error of the equations. Then evaluates B∇C of each solution with its own
    /// round-off.
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let d = system.dimension();
        let quadratic_sought = d * (d + 1) / 2 <= UNKNOWNS;
        let complete = if quadratic_sought { Status::Shown } else { Status::Unknown };
        let (found, nearly) = (Vec::new(), Vec::new());
        let logarithmic = LogarithmicCasimir::all(system, points);
        let mut all =
            Self { found, nearly, complete, definite: None, quadratic_sought, logarithmic };
        for degree in 1..=if quadratic_sought { 2 } else { 1 } {
            let unknowns = if degree == 1 { d } else { d * (d + 1) / 2 };
            let Solution { sigma, vectors, error, zero } =
                Solution::of(degree, unknowns, system, points);
            let few = sigma.iter().filter(|s| **s > error && **s <= NEARLY * sigma[0]).count();
            if sigma.iter().any(|s| s.is_nan()) {
                all.complete = Status::Unknown;
            }
            // The angle of the subspace is at most the error over the gap (Wedin 1972); reduction
            // to echelon form with complete pivoting adds up one for each of the other vectors.
            let gap = sigma.iter().copied().filter(|s| *s > error).fold(f64::INFINITY, f64::min);
            let angle = (error / gap).max(f64::EPSILON) * (zero + 1) as f64;
            let candidate = |mut x: Coefficients| {
                if degree == 2 {
                    x.values = symmetric(&x.values, d);
                }
                FoundCasimir::new(degree, x, system, points)
            };
            for x in echelon(vectors[unknowns - zero..].to_vec()) {
                let casimir = candidate(readable(x, angle));
                if casimir.casimir.holds() {
                    all.found.push(casimir);
                } else {
                    all.complete = Status::Unknown;
                    all.nearly.push(casimir);
                }
            }
            let near = vectors[unknowns - zero - few..unknowns - zero].iter().rev().take(LISTED);
            // A function with just these coefficients.
            let exactly =
                |x: &Vec<f64>| Coefficients { error: 0.0, ..readable(x.clone(), NEARLY * NEARLY) };
            all.nearly.extend(near.map(|x| candidate(exactly(x))));
        }
        all.definite = definite(&all.found, d)
            .map(|x| FoundCasimir::new(2, x, system, points))
            .filter(|casimir| casimir.casimir.holds());
        all
    }
}

/// The singular values and vectors of the equations, and how many values are zero.
struct Solution {
    sigma: Vec<f64>,
    vectors: Matrix,
    error: f64,
    zero: usize,
}

impl Solution {
    /// From the points for identities; from more of them while other points contradict it. A B of
    /// low rank has few equations at a point.
    fn of(degree: u32, unknowns: usize, system: &dyn System, points: &Points) -> Self {
        let more = &points.for_suprema[points.random..];
        let mut equations = Equations::default();
        points.for_identities.iter().for_each(|y| equations.add(degree, system, y));
        let mut taken = 0;
        loop {
            let (sigma, vectors) = singular_vectors(&equations.rows, unknowns);
            let entries = (equations.rows.len() * unknowns) as f64;
            let error = equations.error + backward_error(1, 1) * entries.sqrt() * sigma[0];
            let zero = sigma.iter().filter(|s| **s <= error).count();
            let mut fresh = Equations::default();
            let next = taken + points.random.min(more.len() - taken);
            more[taken..next].iter().for_each(|y| fresh.add(degree, system, y));
            let residuals = vectors[unknowns - zero..].iter().map(|x| norm(&times(&fresh.rows, x)));
            let contradicted = residuals.fold(0.0, f64::max) > error + fresh.error;
            if !contradicted || taken == next {
                return Self { sigma, vectors, error, zero };
            }
            equations.rows.append(&mut fresh.rows);
            equations.error = equations.error.hypot(fresh.error);
            taken = next;
        }
    }
}

/// bᵀ∇C(y) = 0 for every row b of B(y), as rows of length one.
#[derive(Default)]
pub(super) struct Equations {
    pub(super) rows: Matrix,
    /// A bound of the Frobenius norm of the errors of the rows.
    pub(super) error: f64,
}

impl Equations {
    fn add(&mut self, degree: u32, system: &dyn System, y: &[f64]) {
        let y_exact: Vec<_> = y.iter().map(|&x| Bounded::variable(x)).collect();
        for b in system.matrix(y) {
            let row: Vec<Bounded> = match degree {
                1 => b,
                _ => places(y.len())
                    .map(|(i, j)| match i == j {
                        true => b[i] * y_exact[i],
                        false => b[i] * y_exact[j] + b[j] * y_exact[i],
                    })
                    .collect(),
            };
            self.push(&row);
        }
    }

    /// A row; one of round-off says nothing.
    pub(super) fn push(&mut self, row: &[Bounded]) {
        let (length, error) = (norm(&values(row)), error_norm(row));
        if length > error {
            self.rows.push(row.iter().map(|x| x.value / length).collect());
            self.error = self.error.hypot(error / length);
        }
    }
}

/// The rows of the symmetric matrix with x at [`places`].
pub(super) fn symmetric(x: &[f64], d: usize) -> Vec<f64> {
    let mut q = vec![0.0; d * d];
    for ((i, j), &x) in places(d).zip(x) {
        (q[i * d + j], q[j * d + i]) = (x, x);
    }
    q
}

/// The multiple of the solution whose smallest coefficient is ±1 and whose first one is positive.
/// Coefficients within `error` of zero or, relatively, of an integer are made exact.
pub(super) fn readable(mut x: Vec<f64>, error: f64) -> Coefficients {
    let size = largest(&x);
    x.iter_mut().filter(|c| c.abs() <= error * size).for_each(|c| *c = 0.0);
    let smallest = x.iter().filter(|c| **c != 0.0).fold(f64::INFINITY, |m, c| m.min(c.abs()));
    let sign = x.iter().find(|c| **c != 0.0).map_or(1.0, |c| c.signum());
    let error = error * size / smallest;
    for c in &mut x {
        *c *= sign / smallest;
        if (*c - c.round()).abs() <= error {
            *c = c.round();
        }
    }
    Coefficients { values: x, error }
}

/// The projection of the identity onto the span of the quadratic forms, if it is positive definite.
/// It averages over all symmetries of the span; of Casimirs ½|sᵢ|² of parts sᵢ of y it is the sum.
fn definite(found: &[FoundCasimir], d: usize) -> Option<Coefficients> {
    let add = |sum: &mut [f64], factor: f64, q: &[f64]| {
        sum.iter_mut().zip(q).for_each(|(x, y)| *x += factor * y);
    };
    // An orthonormal basis by Gram and Schmidt.
    let mut basis: Matrix = Vec::new();
    let mut projection = vec![0.0; d * d];
    let mut error = 0.0;
    for casimir in found.iter().filter(|casimir| casimir.degree == 2) {
        let mut q = casimir.coefficients.clone();
        for known in &basis {
            let share = dot(&q, known);
            add(&mut q, -share, known);
        }
        let length = dot(&q, &q).sqrt();
        q.iter_mut().for_each(|x| *x /= length);
        let trace = (0..d).map(|i| q[i * d + i]).sum();
        add(&mut projection, trace, &q);
        basis.push(q);
        error += (casimir.coefficient_error / length).max(f64::EPSILON) * (d * d) as f64;
    }
    let smallest = smallest_eigenvalue(&square(&projection, d));
    (!basis.is_empty() && smallest > error).then(|| readable(projection, error))
}

/// The matrix with these rows of length d.
fn square<R: Copy>(coefficients: &[R], d: usize) -> Matrix<R> {
    coefficients.chunks(d).map(<[R]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            points::Region,
            tests::by_hand::{ByHand, at, close, exact, within},
        },
        *,
    };

    #[test]
    fn integers_are_exact_coefficients_and_others_are_not() {
        let of = |value, error| coefficient(value, error).error;
        assert_eq!((of(-3.0, 0.5), of(0.0, 0.5), of(0.5, 1e-3)), (0.0, 0.0, 1e-3));
        // At least as much as the constant of a formula.
        assert_eq!(of(0.1, 0.0), Bounded::constant(0.1).error);
        let tenth = coefficient(0.1, 1e-3);
        assert_eq!((tenth.value, tenth.degree), (0.1, Bounded::exact(0.1).degree));
    }

    #[test]
    fn formulas_have_signs_squares_and_products() {
        assert_eq!(formula(1, &[2.0, -1.0, 0.5], 3), "2 y1 − y2 + 0.5 y3");
        assert_eq!(formula(1, &[0.0, -1.234_567_8, 0.0], 3), "−1.234568 y2");
        assert_eq!(formula(1, &[0.0, 1.0, 1.0], 3), "y2 + y3");
        let q = symmetric(&[2.0, -1.0, 0.0, 0.0, 3.0, -4.0], 3);
        assert_eq!(q, [2.0, -1.0, 0.0, -1.0, 0.0, 3.0, 0.0, 3.0, -4.0]);
        assert_eq!(formula(2, &q, 3), "y1² − 2 y3² − y1 y2 + 3 y2 y3");
        // ½yᵀQy.
        assert_eq!(value(2, &exact(&q), &[1.0, 2.0, 3.0]).value, 1.0 - 18.0 - 2.0 + 18.0);
        assert_eq!(value(1, &exact(&q[..3]), &[1.0, 2.0, 3.0]).value, 0.0);
    }

    #[test]
    fn coefficients_are_made_readable_within_their_error() {
        let of = |x: &[f64], error| {
            let Coefficients { values, error } = readable(x.to_vec(), error);
            (values, error)
        };
        // 1e-9 is zero beside 0.4; the error grows as the smallest coefficient becomes one.
        let (values, error) = of(&[0.2, -0.4, 1e-9], 1e-8);
        assert!(values == [1.0, -2.0, 0.0] && close(error, 2e-8), "{values:?} {error}");
        // The first one is positive, and what is no integer stays.
        let (values, error) = of(&[-0.3, 0.7], 1e-3);
        assert!(values[0] == 1.0 && close(values[1], -7.0 / 3.0), "{values:?}");
        assert!(close(error, 1e-3 * 0.7 / 0.3), "{error}");
        // 2.00033 is an integer within 0.002 and not within 0.0002.
        assert_eq!(of(&[0.3, 0.6001], 1e-3).0, [1.0, 2.0]);
        assert_eq!(of(&[0.3, 0.6001], 1e-4).0, [1.0, 0.6001 / 0.3]);
    }

    fn form(degree: u32, diagonal: [f64; 3], coefficient_error: f64) -> FoundCasimir {
        let mut coefficients = vec![0.0; 9];
        (0..3).for_each(|i| coefficients[4 * i] = diagonal[i]);
        FoundCasimir {
            formula: String::new(),
            degree,
            coefficients,
            coefficient_error,
            casimir: Finding::default(),
            minimum: Minimum::of_form(&vec![exact(&[1.0])], Status::Shown),
        }
    }

    #[test]
    fn the_projection_of_the_identity_is_definite_beyond_its_error() {
        // (1, 1, 0) has the length √2; what (1, 1, 2) adds to it is (0, 0, 2).
        let [one, two] = [form(2, [1.0, 1.0, 0.0], 1e-3), form(2, [1.0, 1.0, 2.0], 2e-3)];
        let found = definite(&[one.clone(), two.clone()], 3).unwrap();
        assert_eq!(found.values, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        assert!(close(found.error, 9.0 * (1e-3 / 2f64.sqrt() + 1e-3)), "{}", found.error);
        let of = |error: f64| {
            let two = FoundCasimir { coefficient_error: error, ..two.clone() };
            definite(&[one.clone(), two], 3).is_some()
        };
        // Its smallest eigenvalue is one.
        assert!(of(0.21) && !of(0.23));
        let without = |casimir: FoundCasimir| definite(&[casimir], 3).is_none();
        assert!(without(one) && without(form(2, [1.0, 1.0, -1.0], 0.0)));
        assert!(without(form(1, [1.0; 3], 0.0)) && definite(&[], 3).is_none());
        // An exact one has the round-off of nine products.
        let sphere = definite(&[form(2, [1.0; 3], 0.0)], 3).unwrap();
        assert!(close(sphere.error, 9.0 * f64::EPSILON), "{}", sphere.error);
    }

    #[test]
    fn equations_have_length_one_and_the_errors_of_their_rows() {
        // The columns of B are (0, −4 ± 0.8) and (3 ± 0.3, 3).
        let system = ByHand {
            structure: |_, v| {
                let second = if v[1].value == 0.0 { 0.0 } else { 1.0 };
                let first = 1.0 - second;
                vec![
                    within(3.0 * second, 0.3 * second),
                    within(-4.0 * first + 3.0 * second, 0.8 * first),
                ]
            },
            ..ByHand::default()
        };
        let mut linear = Equations::default();
        linear.add(1, &system, &[2.0, 5.0]);
        assert_eq!(linear.rows, [[0.0, 1.0], [-0.8, 0.6]]);
        assert!(close(linear.error, 0.1f64.hypot(0.16)), "{}", linear.error);
        // b₁y₁, b₁y₂ + b₂y₁, b₂y₂: (0, 6, 15) ± (0, 0.6, 1.5) and (−8, −14, 15) ± (1.6, 4, 0).
        let mut quadratic = Equations::default();
        quadratic.add(2, &system, &[2.0, 5.0]);
        let lengths = [261f64.sqrt(), 485f64.sqrt()];
        let rows = [[0.0, 6.0, 15.0], [-8.0, -14.0, 15.0]];
        for (n, row) in quadratic.rows.iter().enumerate() {
            assert!((0..3).all(|i| close(row[i] * lengths[n], rows[n][i])), "{row:?}");
        }
        let error = (0.6f64.hypot(1.5) / lengths[0]).hypot(1.6f64.hypot(4.0) / lengths[1]);
        assert!((quadratic.error / error - 1.0).abs() < 1e-12, "{}", quadratic.error);
        // Round-off is no equation.
        let noise = ByHand { structure: |_, _| vec![within(0.1, 0.1); 2], ..ByHand::default() };
        linear = Equations::default();
        linear.add(1, &noise, &[2.0, 5.0]);
        assert!(linear.rows.is_empty() && linear.error == 0.0);
    }

    #[test]
    fn more_points_are_asked_while_they_contradict() {
        // Row one of B at y is y: the coefficients are perpendicular to all points.
        let system = ByHand {
            structure: |y, v| exact(&[y[0] * v[0].value + y[1] * v[1].value, 0.0]),
            ..ByHand::default()
        };
        let solution = |points: &[&[f64]]| {
            let points = Points { for_identities: vec![vec![3.0, 0.0]], random: 1, ..at(points) };
            Solution::of(1, 2, &system, &points)
        };
        let (x, y): (&[f64], &[f64]) = (&[3.0, 0.0], &[0.0, 2.0]);
        let alone = solution(&[x]);
        assert_eq!((alone.zero, &alone.sigma[..]), (1, &[1.0, 0.0][..]));
        assert!(close(alone.error, 8.0 * f64::EPSILON * 2f64.sqrt()), "{}", alone.error);
        // The next points agree: those after them are not asked.
        assert_eq!(solution(&[x, x, y]).zero, 1);
        assert_eq!((solution(&[x, y]).zero, solution(&[x, y, x]).zero), (0, 0));
    }

    #[test]
    fn coefficients_are_as_accurate_as_the_gap_of_the_singular_values_allows() {
        // Rows (0, 1, 0) and (0, 0.6, 0.8) at 24 points have σ² = 24·1.6 and 24·0.4.
        let system = ByHand {
            dimension: 3,
            structure: |_, v| {
                let [a, b] = [v[1].value, v[2].value];
                exact(&[0.0, a, 0.6 * a + 0.8 * b])
            },
            ..ByHand::default()
        };
        let points = Points::new(&system, Region::Box(2.0), None).unwrap();
        let casimirs = Casimirs::of(&system, &points);
        let linear = &casimirs.found[0];
        assert_eq!((linear.formula.as_str(), linear.degree), ("y1", 1));
        // 8ε√(48·3)·√(24·1.6) over the gap √(24·0.4), and one more for each of one vectors.
        let error = 8.0 * f64::EPSILON * 12.0 * 2.0 * 2.0;
        assert!(close(linear.coefficient_error, error), "{}", linear.coefficient_error / error);
        assert_eq!(casimirs.found[1].formula, "0.5 y1²");
        assert!(casimirs.found.len() == 2 && casimirs.complete == Status::Shown);
        assert!(
            casimirs.nearly.is_empty() && casimirs.definite.is_none() && casimirs.quadratic_sought
        );
    }

    #[test]
    fn almost_casimirs_are_listed_with_their_defect() {
        let system = ByHand {
            dimension: 3,
            structure: |_, v| exact(&[0.0, v[1].value, v[1].value + 1e-7 * v[2].value]),
            ..ByHand::default()
        };
        let points = Points::new(&system, Region::Box(2.0), None).unwrap();
        let casimirs = Casimirs::of(&system, &points);
        let nearly = &casimirs.nearly[0];
        assert_eq!((nearly.formula.as_str(), nearly.coefficient_error), ("y3", 0.0));
        assert!(nearly.casimir.refuted() && close(nearly.casimir.defect, 1e-7), "{nearly:?}");
        // Of the quadratic ones y₁y₃ and y₃², which have y₃ as a factor, are almost Casimirs.
        assert_eq!(casimirs.nearly.len(), 3, "{:?}", casimirs.nearly);
        assert_eq!(casimirs.complete, Status::Shown);
        // Nothing is complete where B is not finite.
        let unknown =
            ByHand { structure: |_, v| vec![within(f64::NAN, 0.0); v.len()], ..ByHand::default() };
        assert_eq!(Casimirs::of(&unknown, &at(&[&[1.0, 2.0]])).complete, Status::Unknown);
    }

    #[test]
    fn quadratic_casimirs_of_many_variables_are_not_sought() {
        let system = ByHand { dimension: 25, structure: |_, v| v.to_vec(), ..ByHand::default() };
        let points = Points::new(&system, Region::Box(2.0), None).unwrap();
        let casimirs = Casimirs::of(&system, &points);
        assert!(casimirs.found.is_empty() && casimirs.nearly.is_empty());
        assert_eq!((casimirs.complete, casimirs.quadratic_sought), (Status::Unknown, false));
    }
}
