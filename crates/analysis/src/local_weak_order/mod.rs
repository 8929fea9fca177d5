//! The weak order of one step, computed and not sampled.
//!
//! The error of one step in the mean of a test function φ is
//!
//! e(τ; φ) = E[φ(ψ_τ(y₀; ΔW))] − Σ_{k≤K} τᵏ/k! (Lᵏφ)(y₀),
//!
//! with the generator Lφ = f·∇φ + ½Σ fₘ·∇(fₘ·∇φ), f = B∇H₀ − γy, fₘ = B∇Hₘ. If it is of order
//! τ^{p+1} for all products of components of y − y₀ up to degree 2p + 1, and moments are bounded,
//! the scheme has the weak order p (Milstein, *Theory Probab. Appl.* 30, 1986; Milstein and
//! Tretyakov, *Stochastic Numerics for Mathematical Physics*, 2004, theorem 2.2.1). Neither part of
//! the error needs samples where the fields are polynomials:
//!
//! - `fields`: the fields as polynomials, from their values;
//! - `polynomial`, `generator`: Lᵏφ, to round-off;
//! - `hermite`: the mean over the increments, by a Gauss–Hermite rule for each;
//! - `slope`: the order, from errors at halved step sizes.

mod fields;
mod generator;
mod hermite;
mod polynomial;
mod slope;
#[cfg(test)]
mod tests;

use std::{collections::HashMap, fmt, sync::Arc};

use mc::Problem;
use real::{Row, WIDTH};
use schemes::{Method, Step};
use systems::Damping;

use crate::orders::{Steps, Subject};

use fields::Fields;
use generator::Generator;
use hermite::Rule;
use polynomial::{Exponents, degree, exponents_up_to};
use slope::Slope;

/// The local weak order: the error of one step in the mean is of order τ^`order`.
///
/// [`Display`](fmt::Display) words it.
#[derive(Clone, Debug)]
pub struct LocalWeakOrder {
    /// The local order p + 1, extrapolated to τ → 0: the lowest of all test functions.
    pub order: f64,
    /// How far it may be off: the last change of the extrapolation, and rounding errors.
    pub uncertainty: f64,
    /// The exponents α of a test function that has this order, Π((y − y₀)ᵢ/s)^{αᵢ}, where s is the
    /// size of y₀.
    pub function: Vec<u8>,
    /// Its errors, those of the largest step size first.
    pub errors: Vec<LocalError>,
    /// The state y₀ from which steps are taken, near the initial value of the problem.
    pub state: Vec<f64>,
    /// The factor of the noise, a power of two.
    pub amplification: f64,
    /// The degree of the vector fields.
    pub degree: usize,
}

/// The error of one step in the mean of a test function at one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalError {
    /// The step size.
    pub tau: f64,
    /// e(τ; φ).
    pub error: f64,
    /// How far it may be off by rounding, by quadrature, and by the end of the series.
    pub doubt: f64,
}

/// Why there is no local weak order.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocalWeakOrderError {
    /// There is no scheme to take the mean over.
    #[error("a local weak order needs at least one scheme, got none")]
    NoScheme,
    /// A scheme reads Lévy areas, for which there is no quadrature.
    #[error(
        "a local weak order needs a scheme that reads increments only; {scheme} reads Levy areas"
    )]
    ReadsAreas {
        /// The scheme.
        scheme: &'static str,
    },
    /// The grid of increments would be too large.
    #[error("a local weak order needs at most {most} noises, got {given}")]
    Noises {
        /// The number of noises of the system.
        given: usize,
        /// The most.
        most: usize,
    },
    /// There would be too many polynomials.
    #[error("a local weak order needs at most {most} dimensions, got {given}")]
    Dimension {
        /// The dimension of the system.
        given: usize,
        /// The most.
        most: usize,
    },
    /// γ is not constant.
    #[error(
        "a local weak order needs a constant damping rate; it is {start} at t = 0 and {rate} at \
         t = {at}"
    )]
    Damping {
        /// γ(0).
        start: f64,
        /// A time.
        at: f64,
        /// γ then.
        rate: f64,
    },
    /// A vector field B∇Hₘ agrees with no polynomial.
    #[error(
        "a local weak order needs polynomial vector fields; B grad H{hamiltonian} is no polynomial \
         of degree {most} or less"
    )]
    NotPolynomial {
        /// m; 0 is the drift.
        hamiltonian: usize,
        /// The largest degree that was tried.
        most: usize,
    },
    /// Steps fail before there are enough errors.
    #[error(
        "a local weak order needs steps with increments that are not truncated; one of {scheme} \
         fails at tau = {tau:e}"
    )]
    StepFails {
        /// The scheme.
        scheme: &'static str,
        /// The smallest step size at which one fails.
        tau: f64,
    },
    /// Errors do not exceed their own uncertainty at enough step sizes.
    #[error(
        "a local weak order needs errors above round-off at {needed} step sizes, got {got} at \
         most: the scheme is exact in the mean for the test functions, or nearly so"
    )]
    RoundOff {
        /// The number of errors above round-off.
        got: usize,
        /// The number that an order needs.
        needed: usize,
    },
    /// The slopes of the errors of a test function show no order, and are lower than the orders of
    /// all others.
    #[error(
        "the errors of one step show no order: for the powers {function:?} of the components \
         slopes are {slopes:.2?}, largest steps first"
    )]
    Unclear {
        /// The exponents of the test function.
        function: Vec<u8>,
        /// log₂(e(τ)/e(τ/2)).
        slopes: Vec<f64>,
    },
}

/// The largest number of noises: 10⁵ nodes of the grid.
const MOST_NOISES: usize = 5;
/// The largest dimension: 12 870 monomials of degree eight, which the generator meets.
const MOST_DIMENSION: usize = 8;
/// The largest degree of a test function: 2p + 1 for p = 2.
const TESTS: usize = 5;
/// Applications of the generator.
const TERMS: usize = 6;
/// Numbers of nodes for each noise: quadrature errors are of order τⁿ for the smaller number n, and
/// their difference shows them.
const NODES: [usize; 2] = [8, 10];
/// Rounding errors of a state after one step, for states of size one.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// An error is used if it exceeds its doubt by this factor.
const CLEAR: f64 = 100.0;
/// Step sizes, each half of the one before.
const STEP_SIZES: i32 = 30;
/// Errors for a slope with an uncertainty.
const LEAST_ERRORS: usize = 4;
/// Between the local order of a scheme that solves another equation, one, and that of one that does
/// not, two or more.
const CONSISTENT: f64 = 1.5;
/// The largest uncertainty of an order.
const UNCLEAR: f64 = 0.2;

/// The local weak order of a scheme, or of the mean over several schemes, on a problem with
/// polynomial vector fields and constant damping.
///
/// With several schemes E[φ(ψ)] is the mean of those of all of them: that is a scheme that tosses a
/// coin, such as that of Ninomiya and Victoir (*Appl. Math. Finance* 15, 2008), with flows forwards
/// or backwards.
///
/// - Test functions are all monomials in y − y₀ up to degree five, which decide weak orders up to
///   two.
/// - The state y₀ is moved from the initial value of the problem, which may be special, by a tenth
///   to a fifth of its components.
/// - Terms of low order may hide where the noise is weak or strong. So it is also multiplied by a
///   power of two that makes it as strong as the drift, and the lower order counts. A scheme whose
///   drift has an Itô correction, such as `em`, is for the noise as it is: with another noise its
///   local order is one, and is not counted.
/// - Increments are not truncated, also not for schemes for which a driver does so: the order is
///   that of the formula. [`Truncation`](noise::Truncation) of order k changes means by τᵏ, up to
///   logarithms (Milstein, Repin and Tretyakov, *SIAM J. Numer. Anal.* 40, 2002).
/// - The order is the lowest of all test functions. A term of low order that is so small that it is
///   below round-off at every step size is not seen; where it begins to show, no order is named.
///
/// It takes some hundredths of a second in three dimensions with three noises, and some tenths of a
/// second in six.
///
/// ```
/// use schemes::Sexp;
/// use systems::{Constant, Problem, RigidBody};
/// use analysis::local_weak_order;
///
/// let body = RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0])?;
/// let problem = Problem::new(body, Constant::new(0.2)?, [0.6, 0.0, 0.8], 1.0)?;
/// let found = local_weak_order(&mc::Problem::of(&problem), &[mc::bind(&problem, &Sexp)])?;
/// assert!((found.order - 2.0).abs() < 0.05 && (found.weak_order() - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Of a system from formulas:
///
/// ```
/// use std::sync::Arc;
///
/// use formula::{Definition, FormulaSystem};
/// use mc::Setup;
/// use schemes::Midpoint;
/// use systems::{Constant, run_time::Problem};
/// use analysis::local_weak_order;
///
/// let words = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect::<Vec<_>>();
/// let oscillator = Definition {
///     name: "oscillator".into(),
///     state: words(&["p", "q"]),
///     structure: vec![words(&["-1"])],
///     energy: "p^2/2 + q^4/4".into(),
///     noises: words(&["q^2/2", "p*q/3"]),
///     ..Definition::default()
/// };
/// let (y0, damping) = ([0.2, 1.0], Constant::new(0.5)?);
/// let system = FormulaSystem::new(&oscillator, &y0)?;
/// let problem = Problem::new(Arc::new(system), Arc::new(damping), y0.into(), 1.0)?;
/// let Setup { problem, scheme } = Setup::at_run_time(&problem, &Midpoint)?;
/// let found = local_weak_order(&problem, &[scheme])?;
/// assert!((found.weak_order() - 1.0).abs() < 0.05 && found.degree == 3, "{found}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LocalWeakOrderError`] says what a local weak order needs: a scheme that reads increments only,
/// polynomial fields, a constant γ, at most five noises and eight dimensions, steps that succeed,
/// and errors that show an order above round-off.
pub fn local_weak_order(
    problem: &Problem<'_>,
    schemes: &[Arc<dyn Method + '_>],
) -> Result<LocalWeakOrder, LocalWeakOrderError> {
    let gamma = check(problem, schemes)?;
    let (state, scale) = generic(&problem.y0);
    let fields = Fields::new(&*problem.formulas, problem.noises, gamma, &state, scale)?;
    let at = |amplification: f64| {
        of_amplified(problem, schemes, &fields, (&state, scale), amplification)
    };
    let (as_it_is, balance) = (at(1.0), fields.balance(scale));
    if balance == 1.0 {
        return as_it_is;
    }
    match (as_it_is, at(balance)) {
        // The scheme is for the noise as it is.
        (as_it_is, Ok(amplified)) if amplified.order < CONSISTENT => as_it_is,
        (as_it_is, Err(_)) => as_it_is,
        (Err(_), amplified) => amplified,
        (Ok(one), Ok(other)) => {
            // The lower order, or the more certain one if they agree.
            let difference = one.order - other.order;
            let amplified = match difference.abs() <= one.uncertainty + other.uncertainty {
                true => other.uncertainty < one.uncertainty,
                false => difference > 0.0,
            };
            Ok(if amplified { other } else { one })
        }
    }
}

/// The local order with the noises of the fields multiplied by a number, from steps at a state of
/// the size given.
fn of_amplified(
    problem: &Problem<'_>,
    schemes: &[Arc<dyn Method + '_>],
    fields: &Fields,
    (state, scale): (&[f64], f64),
    amplification: f64,
) -> Result<LocalWeakOrder, LocalWeakOrderError> {
    let fields = fields.amplified(amplification);
    let functions = Functions::new(state.len(), scale);
    let mut series = Generator::new(&fields).powers(&functions.exponents, TERMS);
    let mut factorial = 1.0;
    for (k, row) in series.iter_mut().enumerate() {
        factorial *= k.max(1) as f64;
        row.iter_mut().zip(&functions.sizes).for_each(|(value, size)| *value /= factorial * size);
    }
    let largest = largest_step(&series, problem.t_end);
    constant_rate(problem.damping, largest)?;
    let subjects = schemes.iter().map(|scheme| Subject { problem, scheme });
    let mut means = Means {
        steps: subjects.map(Steps::new).collect(),
        grids: NODES.map(|n| Rule::new(n).grid(problem.noises)),
        state,
        scale,
        amplification,
        functions: &functions,
    };
    // The errors of all test functions, for each step size.
    let (mut table, mut failure) = (Vec::new(), None);
    for halvings in 0..STEP_SIZES {
        let tau = largest * f64::powi(0.5, halvings);
        match means.errors(&series, tau) {
            Ok(errors) => table.push(errors),
            Err(failed) => {
                table.clear();
                failure = Some(failed);
            }
        }
    }
    drop(means);
    let Lowest { slope, function, errors } =
        lowest(&table, &functions.exponents).map_err(|error| match (failure, error) {
            (Some(failed), LocalWeakOrderError::RoundOff { .. }) => failed,
            (_, error) => error,
        })?;
    let (order, uncertainty) = (slope.order, slope.uncertainty);
    let (state, degree) = (state.to_vec(), fields.degree());
    Ok(LocalWeakOrder { order, uncertainty, function, errors, state, amplification, degree })
}

/// The lowest order of the test functions.
struct Lowest {
    slope: Slope,
    function: Exponents,
    errors: Vec<LocalError>,
}

/// The lowest order, from the errors of all test functions for each step size.
///
/// Of the functions whose order may be the lowest within its uncertainty, the one is taken that has
/// the smallest uncertainty.
fn lowest(
    table: &[Vec<LocalError>],
    exponents: &[Exponents],
) -> Result<Lowest, LocalWeakOrderError> {
    let (mut found, mut unclear, mut got) = (Vec::new(), Vec::new(), 0);
    for (n, function) in exponents.iter().enumerate() {
        let column: Vec<LocalError> = table.iter().map(|row| row[n]).collect();
        let clear = |error: &LocalError| error.error.abs() > CLEAR * error.doubt;
        // The finest of them without a gap, and of one sign: errors of the other one are of terms
        // of higher order.
        let end = column.iter().rposition(clear).map_or(0, |last| last + 1);
        let sign = column[..end].last().map_or(1.0, |last| last.error.signum());
        let other = |error: &LocalError| !clear(error) || error.error * sign <= 0.0;
        let start = column[..end].iter().rposition(other).map_or(0, |n| n + 1);
        let errors = &column[start..end];
        got = got.max(errors.len());
        let Some(slope) = slope::extrapolated(errors) else { continue };
        match slope.uncertainty <= UNCLEAR {
            true => found.push((slope, function, errors.to_vec())),
            false => unclear.push((function, errors.to_vec())),
        }
    }
    let highest = |(slope, ..): &(Slope, _, _)| slope.order + slope.uncertainty;
    let bound = found.iter().map(highest).fold(f64::INFINITY, f64::min);
    // Slopes of the finest steps that fall below the order would be those of another term.
    let all = found.iter().map(|(_, function, errors)| (*function, errors));
    let others = unclear.iter().map(|(function, errors)| (*function, errors));
    for (function, errors) in all.chain(others) {
        let slopes = slope::slopes(errors);
        if slopes.last().is_some_and(|&last| last < bound - UNCLEAR) {
            return Err(LocalWeakOrderError::Unclear { function: function.clone(), slopes });
        }
    }
    let (slope, function, errors) = found
        .into_iter()
        .filter(|(slope, ..)| slope.order - slope.uncertainty <= bound)
        .min_by(|(one, ..), (other, ..)| one.uncertainty.total_cmp(&other.uncertainty))
        .ok_or(LocalWeakOrderError::RoundOff { got, needed: LEAST_ERRORS })?;
    Ok(Lowest { slope, function: function.clone(), errors })
}

impl LocalWeakOrder {
    /// The weak order p.
    pub fn weak_order(&self) -> f64 {
        self.order - 1.0
    }
}

impl fmt::Display for LocalWeakOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { order, uncertainty, errors, .. } = self;
        // Adding zero takes the sign from −0.
        let weak = (100.0 * self.weak_order()).round() / 100.0 + 0.0;
        let reach = crate::number(*uncertainty);
        write!(f, "local order {order:.3} ± {reach}, weak order {weak:.2}")?;
        if let [first, .., last] = &errors[..] {
            let (from, to) = (crate::number(first.tau), crate::number(last.tau));
            write!(f, " (steps from {from} to {to})")?;
        }
        Ok(())
    }
}

/// γ, if everything is as it must be.
fn check(
    problem: &Problem<'_>,
    schemes: &[Arc<dyn Method + '_>],
) -> Result<f64, LocalWeakOrderError> {
    if schemes.is_empty() {
        return Err(LocalWeakOrderError::NoScheme);
    }
    if let Some(scheme) = schemes.iter().find(|scheme| scheme.reads_areas()) {
        return Err(LocalWeakOrderError::ReadsAreas { scheme: scheme.id() });
    }
    let (noises, dimension) = (problem.noises, problem.y0.len());
    if noises > MOST_NOISES {
        return Err(LocalWeakOrderError::Noises { given: noises, most: MOST_NOISES });
    }
    if dimension > MOST_DIMENSION {
        return Err(LocalWeakOrderError::Dimension { given: dimension, most: MOST_DIMENSION });
    }
    constant_rate(problem.damping, problem.t_end)
}

/// γ, if it is the same at times until `end`.
fn constant_rate(damping: &dyn Damping, end: f64) -> Result<f64, LocalWeakOrderError> {
    let start = damping.rate(0.0);
    for n in 1..=TIMES {
        let at = end * f64::from(n) / f64::from(TIMES);
        let rate = damping.rate(at);
        if rate != start {
            return Err(LocalWeakOrderError::Damping { start, at, rate });
        }
    }
    Ok(start)
}

/// Times at which the damping is looked at.
const TIMES: u32 = 13;

/// A state near the initial value, and its size as a power of two. Components are moved away from
/// zero by a tenth to a fifth, keep their signs, and have twelve binary digits or so.
fn generic(y0: &[f64]) -> (Vec<f64>, f64) {
    let largest = y0.iter().fold(0.0, |size: f64, y| size.max(y.abs()));
    let scale = if largest > 0.0 { largest.log2().round().exp2() } else { 1.0 };
    let moved = |(i, &y): (usize, &f64)| {
        let part = 0.1 + 0.1 * ((i + 1) as f64 * 0.618_033_988_749_894_8).fract();
        let moved = if y == 0.0 { part * scale } else { y * (1.0 + part) };
        let unit = scale.min(moved.abs().log2().round().exp2()) / 4096.0;
        (moved / unit).round() * unit
    };
    (y0.iter().enumerate().map(moved).collect(), scale)
}

/// A step size at which the terms of the series fall, as a power of two.
fn largest_step(series: &[Vec<f64>], t_end: f64) -> f64 {
    let size = |row: &Vec<f64>| row.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    let rate = |(k, row): (usize, &Vec<f64>)| size(row).powf(1.0 / k as f64);
    let rate = series.iter().enumerate().skip(1).map(rate).fold(0.0, f64::max);
    if rate > 0.0 { (1.0 / rate).log2().floor().exp2() } else { t_end }
}

/// All monomials φ of degree one to [`TESTS`] in x = y − y₀.
struct Functions {
    exponents: Vec<Exponents>,
    /// scale^|α|.
    sizes: Vec<f64>,
    /// Each is a variable times an earlier one, or alone.
    factors: Vec<(usize, Option<usize>)>,
    /// The derivatives of each: factors and earlier monomials, or none for 1.
    derivatives: Vec<Vec<(f64, Option<usize>)>>,
}

impl Functions {
    fn new(dimension: usize, scale: f64) -> Self {
        let exponents = exponents_up_to(dimension, TESTS).split_off(1);
        let numbers: HashMap<&Exponents, usize> =
            exponents.iter().enumerate().map(|(n, alpha)| (alpha, n)).collect();
        let derivatives = |alpha: &Exponents| -> Vec<(usize, f64, Option<usize>)> {
            let present = (0..dimension).filter(|&i| alpha[i] > 0);
            let derivative = |i: usize| {
                let mut lower = alpha.clone();
                lower[i] -= 1;
                (i, f64::from(alpha[i]), numbers.get(&lower).copied())
            };
            present.map(derivative).collect()
        };
        let all: Vec<_> = exponents.iter().map(derivatives).collect();
        let factors = all.iter().map(|all| (all[0].0, all[0].2)).collect();
        let without = |all: &Vec<(usize, f64, Option<usize>)>| {
            all.iter().map(|&(_, factor, lower)| (factor, lower)).collect()
        };
        let derivatives = all.iter().map(without).collect();
        let sizes = exponents.iter().map(|alpha| scale.powi(degree(alpha) as i32)).collect();
        Self { sizes, factors, derivatives, exponents }
    }
}

/// Means of test functions after one step.
struct Means<'a> {
    steps: Vec<Steps<'a>>,
    grids: [Vec<(f64, Vec<f64>)>; 2],
    state: &'a [f64],
    scale: f64,
    amplification: f64,
    functions: &'a Functions,
}

impl Means<'_> {
    /// The means of φ and of |φ| over the grid number `grid` and over all schemes.
    fn of(&mut self, grid: usize, tau: f64) -> Result<[Vec<f64>; 2], LocalWeakOrderError> {
        let factors = &self.functions.factors;
        let mut means = [(); 2].map(|()| vec![0.0; factors.len()]);
        let mut values: Vec<Row> = vec![[0.0; WIDTH]; factors.len()];
        let root = self.amplification * tau.sqrt();
        let share = 1.0 / self.steps.len() as f64;
        for steps in &mut self.steps {
            let (scheme, damping) = (steps.subject.scheme.id(), steps.subject.problem.damping);
            let fails = || LocalWeakOrderError::StepFails { scheme, tau };
            let step = Step::new(damping, 0, tau).map_err(|_| fails())?;
            for nodes in self.grids[grid].chunks(WIDTH) {
                for (m, row) in steps.noises[0].increments.iter_mut().enumerate() {
                    row.iter_mut().zip(nodes).for_each(|(dw, (_, x))| *dw = root * x[m]);
                }
                let (rows, live) = steps.step(&step, self.state, nodes.len());
                if live.paths().count() < nodes.len() {
                    return Err(fails());
                }
                for (n, &(i, rest)) in factors.iter().enumerate() {
                    let rest = rest.map_or([1.0; WIDTH], |rest| values[rest]);
                    for p in 0..WIDTH {
                        values[n][p] = rest[p] * ((rows[i][p] - self.state[i]) / self.scale);
                    }
                    for ((weight, _), value) in nodes.iter().zip(&values[n]) {
                        means[0][n] += share * weight * value;
                        means[1][n] += share * weight * value.abs();
                    }
                }
            }
        }
        Ok(means)
    }

    /// The errors of one step for all test functions. A rounding error of the state counts as much
    /// as the derivative of φ, on average.
    fn errors(
        &mut self,
        series: &[Vec<f64>],
        tau: f64,
    ) -> Result<Vec<LocalError>, LocalWeakOrderError> {
        let [fewer, _] = self.of(0, tau)?;
        let [means, sizes] = self.of(1, tau)?;
        let powers: Vec<f64> = (0..series.len()).map(|k| tau.powi(k as i32)).collect();
        let error = |n: usize| {
            let term = |k: usize| powers[k] * series[k][n];
            let exact: f64 = (0..series.len()).map(term).sum();
            let derivative: f64 = self.functions.derivatives[n]
                .iter()
                .map(|&(factor, lower)| factor * lower.map_or(1.0, |lower| sizes[lower]))
                .sum();
            let rounding = ROUNDING * (derivative + sizes[n] + exact.abs());
            let quadrature = (means[n] - fewer[n]).abs();
            let rest = term(TERMS).abs() + term(TERMS - 1).abs();
            let doubt = rounding + quadrature + rest;
            LocalError { tau, error: means[n] - exact, doubt }
        };
        Ok((0..means.len()).map(error).collect())
    }
}
