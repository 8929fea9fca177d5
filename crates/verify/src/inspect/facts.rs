//! What a run has to know of a system, found in milliseconds.

use real::{Row, WIDTH, elementary};
use systems::{
    Linearity,
    run_time::{Problem, System, Weights},
};

use super::{
    algebra::{Matrix, axis, dot, echelon, norm, singular_vectors, times, transposed},
    casimirs::{UNKNOWNS, formula, places, readable, symmetric},
    damping::DampingIntegral,
    finding::Status,
    points::{Purpose, Random},
    recommendation::Kept,
};

/// βᵀy, or ½yᵀQy.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// 1 or 2.
    pub degree: u32,
    /// β, or the rows of Q one after the other.
    pub coefficients: Vec<f64>,
}

impl Form {
    /// The formula in y1, y2, …, coefficients to six digits.
    pub fn formula(&self) -> String {
        let d = match self.degree {
            1 => self.coefficients.len(),
            _ => self.coefficients.len().isqrt(),
        };
        formula(self.degree, &self.coefficients, d)
    }

    /// The value at y.
    pub fn value(&self, y: &[f64]) -> f64 {
        match self.degree {
            1 => dot(&self.coefficients, y),
            _ => {
                let rows = self.coefficients.chunks(y.len()).zip(y);
                0.5 * rows.map(|(row, component)| component * dot(row, y)).sum::<f64>()
            }
        }
    }
}

/// What a run has to know of a problem: which laws it obeys.
///
/// Identities are tested in floating point at 32 random points around the initial value, without
/// the bounds of round-off of [`inspect`](super::inspect()): what is found holds to 10⁻⁹ of its
/// terms there. Casimirs are sought in each part of the state that B does not join with others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Linear Casimirs, then quadratic ones that are no products of these.
    pub casimirs: Vec<Form>,
    /// Whether every Hₘ is a multiple of H₀, up to a constant.
    pub proportional: bool,
    /// The degree of H₀, if it is homogeneous.
    pub degree: Option<f64>,
    /// Whether there is damping.
    pub damped: bool,
    /// That the integral of the damping is not the integral of its rate.
    pub mistake: Option<String>,
}

/// What is relative to its terms below this is zero.
const ZERO: f64 = 1e-9;
/// Points in all for at most so many unknowns; a matrix of low rank has few equations at a point.
const SURPLUS: usize = 2;

impl Facts {
    /// Those of a problem whose system has one path in each place of a row.
    pub fn of(problem: &Problem) -> Self {
        let system = problem.system();
        let integral = DampingIntegral::of(problem.damping(), problem.t_end());
        let wrong = format!("the integral of the damping is not that of its rate: {integral}");
        let mut probe = Probe {
            system,
            y0: problem.y0(),
            scratch: vec![[0.0; WIDTH]; system.scratch_rows()],
            random: Random::new(Purpose::Points),
        };
        let y = probe.points();
        let (proportional, degree) = probe.energies(&y);
        Self {
            casimirs: probe.casimirs(&y),
            proportional,
            degree,
            damped: !integral.none,
            mistake: (integral.agrees == Status::Refuted).then_some(wrong),
        }
    }

    /// The degree p of the law H₀(y(t)) = e^{−p∫γ}H₀(y₀), if there is one; any without damping.
    pub fn energy_law(&self) -> Option<f64> {
        let degree = self.degree.or((!self.damped).then_some(0.0));
        degree.filter(|_| self.proportional)
    }

    /// What a scheme has to care for. Lévy areas are not drawn for systems known at run time.
    pub fn kept(&self) -> Kept {
        let (casimirs, energy) = (!self.casimirs.is_empty(), self.energy_law().is_some());
        Kept { casimirs, energy, areas: false }
    }
}

/// Components up to which [`fastest`] looks at the matrix of the derivative.
const MOST_COMPONENTS: usize = 64;
/// Squarings of that matrix: ρ is found to the factor 1 ± 64·ln κ/2²⁰, κ its condition.
const SQUARINGS: i32 = 20;

/// The rate of the fastest motion about y₀ without noise, in radians or e-foldings per time: the
/// spectral radius ρ of f′(y₀) with f = B∇H₀, by Gelfand's formula ρ = lim ‖f′ᵏ‖^{1/k}. Zero with
/// more than 64 components, and where f′(y₀) is not finite.
pub fn fastest(system: &dyn System, y0: &[f64]) -> f64 {
    let d = y0.len();
    if d > MOST_COMPONENTS || d == 0 {
        return 0.0;
    }
    let rows = |y: &[f64]| y.iter().map(|&y| [y; WIDTH]).collect::<Vec<Row>>();
    let (y, noise) = (rows(y0), vec![[0.0; WIDTH]; system.noises()]);
    let h = Weights { dt: 1.0, dw: &noise };
    let (mut scratch, zero) = (vec![[0.0; WIDTH]; system.scratch_rows()], rows(&vec![0.0; d]));
    let mut slope = zero.clone();
    system.gradient(0..d, &y, h, &mut slope, &mut scratch);
    // The columns (∂B·u)∇H₀ + B∇²H₀u of f′.
    let mut column = |j: usize| -> Vec<f64> {
        let u = rows(&axis(d, j));
        let [mut turned, mut curved, mut moved] = [0; 3].map(|_| zero.clone());
        system.structure_along(0..d, &y, &u, &slope, &mut turned, &mut scratch);
        system.hessian(0..d, &y, &u, h, &mut curved, &mut scratch);
        system.structure(0..d, &y, &curved, &mut moved, &mut scratch);
        turned.iter().zip(&moved).map(|(a, b)| a[0] + b[0]).collect()
    };
    let mut power: Matrix = transposed(&(0..d).map(&mut column).collect());
    let mut log_radius = 0.0;
    for n in 0..=SQUARINGS {
        let size = power.iter().map(|row| norm(row)).fold(0.0, f64::max);
        if size == 0.0 || !size.is_finite() {
            return 0.0;
        }
        log_radius += elementary::ln(size) * f64::powi(0.5, n);
        power.iter_mut().flatten().for_each(|x| *x /= size);
        let columns = transposed(&power);
        power = power.iter().map(|row| times(&columns, row)).collect();
    }
    elementary::exp(log_radius)
}

/// 32 points, and the columns of B there.
type AtPoints = (Vec<Row>, Vec<Vec<Row>>);

/// A system at 32 points at a time.
struct Probe<'a> {
    system: &'a dyn System,
    y0: &'a [f64],
    scratch: Vec<Row>,
    random: Random,
}

impl Probe<'_> {
    /// 32 points of the domain, as far from y₀ as its size where possible.
    fn points(&mut self) -> Vec<Row> {
        let size = match norm(self.y0) {
            0.0 => 1.0,
            length => 0.3 * length,
        };
        let mut y: Vec<Row> = self.y0.iter().map(|&y| [y; WIDTH]).collect();
        for p in 0..WIDTH {
            let shift: Vec<f64> =
                self.y0.iter().map(|y| self.random.uniform() * (y.abs() + size)).collect();
            let at = |halvings: i32| -> Vec<f64> {
                let share = f64::powi(0.5, halvings);
                self.y0.iter().zip(&shift).map(|(y, shift)| y + share * shift).collect()
            };
            let inside = (0..40).map(at).find(|y| self.system.check_domain(y).is_ok());
            for (row, y) in y.iter_mut().zip(inside.into_iter().flatten()) {
                row[p] = y;
            }
        }
        y
    }

    /// ∇h for a unit weight of H₀ (0) or of Hₘ.
    fn gradient(&mut self, y: &[Row], m: usize) -> Vec<Row> {
        let mut dw = vec![[0.0; WIDTH]; self.system.noises()];
        if m > 0 {
            dw[m - 1] = [1.0; WIDTH];
        }
        let h = Weights { dt: if m == 0 { 1.0 } else { 0.0 }, dw: &dw };
        let mut out = vec![[0.0; WIDTH]; y.len()];
        self.system.gradient(0..y.len(), y, h, &mut out, &mut self.scratch);
        out
    }

    /// Whether all noises are multiples of H₀, and the degree of H₀.
    fn energies(&mut self, y: &[Row]) -> (bool, Option<f64>) {
        let slope = self.gradient(y, 0);
        let noises = (1..=self.system.noises()).map(|m| self.gradient(y, m));
        let all: Vec<Vec<Row>> = noises.collect();
        let flat = slope.as_flattened();
        let proportional = all.iter().all(|noise| multiple(flat, noise.as_flattened()).is_some());
        let dw = vec![[0.0; WIDTH]; all.len()];
        let mut energy = [0.0; WIDTH];
        self.system.energy(y, Weights { dt: 1.0, dw: &dw }, &mut energy, &mut self.scratch);
        // Euler's identity y·∇H₀ = pH₀.
        let euler: Row =
            std::array::from_fn(|p| y.iter().zip(&slope).map(|(y, g)| y[p] * g[p]).sum());
        let degree = multiple(&energy, &euler).filter(|degree| *degree != 0.0);
        (proportional, degree.map(nearby_integer))
    }

    /// The columns of B at the points.
    fn matrix(&mut self, y: &[Row]) -> Vec<Vec<Row>> {
        let d = y.len();
        let column = |j| {
            let unit: Vec<Row> = axis(d, j).into_iter().map(|x| [x; WIDTH]).collect();
            let mut out = vec![[0.0; WIDTH]; d];
            self.system.structure(0..d, y, &unit, &mut out, &mut self.scratch);
            out
        };
        (0..d).map(column).collect()
    }

    /// The parts of the state that B joins: by an entry, or by what an entry depends on.
    fn parts(&mut self, y: &[Row], matrix: &[Vec<Row>]) -> Vec<Vec<usize>> {
        let d = y.len();
        let mut label: Vec<usize> = (0..d).collect();
        let mut join = |i: usize, j: usize| {
            let (one, other) = (label[i], label[j]);
            label.iter_mut().filter(|label| **label == other).for_each(|label| *label = one);
        };
        let is_zero = |row: &Row| row.iter().all(|x| *x == 0.0);
        let v: Vec<Row> = y.iter().map(|_| [self.random.uniform(); WIDTH]).collect();
        for j in 0..d {
            let unit: Vec<Row> = axis(d, j).into_iter().map(|x| [x; WIDTH]).collect();
            let mut along = vec![[0.0; WIDTH]; d];
            self.system.structure_along(0..d, y, &unit, &v, &mut along, &mut self.scratch);
            let moved = |i: &usize| !is_zero(&matrix[j][*i]) || !is_zero(&along[*i]);
            (0..d).filter(moved).for_each(|i| join(i, j));
        }
        let part = |one: usize| (0..d).filter(|i| label[*i] == one).collect::<Vec<_>>();
        (0..d).map(part).filter(|part| !part.is_empty()).collect()
    }

    /// Linear and quadratic Casimirs, part by part.
    fn casimirs(&mut self, y: &[Row]) -> Vec<Form> {
        let d = y.len();
        let first = self.matrix(y);
        let parts = self.parts(y, &first);
        let (mut linear, mut quadratic) = (Vec::new(), Vec::new());
        let mut states = vec![(y.to_vec(), first)];
        for part in parts {
            let size = part.len();
            let ones = null_space(&equations(1, &part, &states[..1]), size);
            let unknowns = size * (size + 1) / 2;
            let mut twos = Matrix::new();
            let rank = size - ones.len();
            if self.system.linearity() != Linearity::Constant && unknowns <= UNKNOWNS && rank > 0 {
                while states.len() * WIDTH * rank < SURPLUS * unknowns {
                    let y = self.points();
                    let matrix = self.matrix(&y);
                    states.push((y, matrix));
                }
                let found = null_space(&equations(2, &part, &states), unknowns);
                twos = beyond(found, products(&ones, size));
            }
            let whole = |degree: u32, coefficients: Vec<f64>| {
                let mut all = vec![0.0; d.pow(degree)];
                match degree {
                    1 => part.iter().zip(coefficients).for_each(|(i, c)| all[*i] = c),
                    _ => {
                        for (k, c) in symmetric(&coefficients, size).into_iter().enumerate() {
                            all[part[k / size] * d + part[k % size]] = c;
                        }
                    }
                }
                Form { degree, coefficients: all }
            };
            let readable = |x| readable(x, ZERO).values;
            linear.extend(echelon(ones).into_iter().map(|x| whole(1, readable(x))));
            quadratic.extend(echelon(twos).into_iter().map(|x| whole(2, readable(x))));
        }
        linear.into_iter().chain(quadratic).collect()
    }
}

/// bᵀ∇C(y) = 0 for every row b of B(y) on a part, at all points, as rows of length one.
fn equations(degree: u32, part: &[usize], states: &[AtPoints]) -> Matrix {
    let mut rows = Matrix::new();
    for (y, matrix) in states {
        for (p, &i) in (0..WIDTH).flat_map(|p| part.iter().map(move |i| (p, i))) {
            let b: Vec<f64> = part.iter().map(|&j| matrix[j][i][p]).collect();
            let row: Vec<f64> = match degree {
                1 => b,
                _ => places(part.len())
                    .map(|(k, l)| match k == l {
                        true => b[k] * y[part[k]][p],
                        false => b[k] * y[part[l]][p] + b[l] * y[part[k]][p],
                    })
                    .collect(),
            };
            let length = norm(&row);
            if length > 0.0 {
                rows.push(row.into_iter().map(|x| x / length).collect());
            }
        }
    }
    rows
}

/// A basis of the x with Ax = 0.
fn null_space(rows: &Matrix, unknowns: usize) -> Matrix {
    let (sigma, vectors) = singular_vectors(rows, unknowns);
    let zero = sigma.iter().filter(|s| **s <= ZERO * sigma[0]).count();
    vectors[unknowns - zero..].to_vec()
}

/// The products of linear forms, as quadratic ones.
fn products(linear: &Matrix, d: usize) -> Matrix {
    let product = |a: &[f64], b: &[f64]| {
        places(d).map(|(i, j)| a[i] * b[j] + a[j] * b[i]).collect::<Vec<_>>()
    };
    places(linear.len()).map(|(i, j)| product(&linear[i], &linear[j])).collect()
}

/// What a span has orthogonal to `known`, by Gram and Schmidt.
fn beyond(span: Matrix, known: Matrix) -> Matrix {
    let (mut basis, known_first) = (Matrix::new(), known.len());
    let mut kept = Matrix::new();
    for (n, mut x) in known.into_iter().chain(span).enumerate() {
        let before = norm(&x);
        for _ in 0..2 {
            for b in &basis {
                let share = dot(&x, b);
                x.iter_mut().zip(b).for_each(|(x, b)| *x -= share * b);
            }
        }
        let length = norm(&x);
        if length > 1e-6 * before {
            x.iter_mut().for_each(|x| *x /= length);
            basis.push(x.clone());
            if n >= known_first {
                kept.push(x);
            }
        }
    }
    kept
}

/// c with b = c·a, if there is one.
fn multiple(a: &[f64], b: &[f64]) -> Option<f64> {
    let square = dot(a, a);
    let c = if square > 0.0 { dot(a, b) / square } else { 0.0 };
    let largest = |x: &[f64]| x.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let scale = largest(b) + c.abs() * largest(a);
    let near = |(a, b): (&f64, &f64)| (b - c * a).abs() <= ZERO * scale;
    a.iter().zip(b).all(near).then_some(c)
}

fn nearby_integer(x: f64) -> f64 {
    if (x - x.round()).abs() <= ZERO * x.abs() { x.round() } else { x }
}
