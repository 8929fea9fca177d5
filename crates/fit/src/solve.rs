//! The parameters, their intervals and χ².

use std::fmt::Write;

use expectation::short;
use faer::{Col, Mat};
use mc::parts::Stop;
use stats::{CONFIDENCE, Warning, chi_square_p_value, diagonal, two_sided};

use crate::{
    Data, Effort, Moment, Replicate,
    linear::{Singular, Whitening},
};

/// Settings of a fit.
#[derive(Clone, Debug)]
pub struct FitSettings {
    /// Paths of a replicate to begin with; 256 unless set, and at least 2048 for quantiles.
    pub paths: u64,
    /// Paths of all evaluations, each counted as its factor of steps, after which neither paths nor
    /// steps are doubled; 2²⁴ unless set.
    pub most: u64,
    /// Request to end: the fit is of the best parameters so far, with a warning.
    pub stop: Stop,
}

impl Default for FitSettings {
    fn default() -> Self {
        Self { paths: 256, most: 1 << 24, stop: Stop::default() }
    }
}

/// Reason why there is no fit.
#[derive(Debug, thiserror::Error)]
pub enum FitError<E> {
    /// The model has no moments at the start, or nowhere near it.
    #[error("the model has no moments")]
    Model(E),
    /// There are too few moments.
    #[error(
        "{parameters} parameters take as many moments that vary independently, got {moments}: give \
         more, or start where the model has them"
    )]
    Few {
        /// Number of parameters.
        parameters: usize,
        /// Number of moments that vary.
        moments: usize,
    },
    /// Moments are infinite or not a number.
    #[error(
        "a moment of the model or a derivative is not finite at {0}: start nearer to the \
         parameters, or take more steps"
    )]
    NotFinite(String),
    /// A combination of the parameters changes no moment, by more than Monte Carlo errors.
    #[error("{words}")]
    Unidentified {
        /// Names of the parameters and the combination that is free.
        direction: Vec<(String, f64)>,
        /// Description of the combination.
        words: String,
    },
}

/// Fitted parameters.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Names of the parameters.
    pub names: Vec<String>,
    /// The parameters θ̂.
    pub values: Vec<f64>,
    /// Covariance of θ̂, Monte Carlo errors included.
    pub covariance: Vec<Vec<f64>>,
    /// Standard errors of θ̂ by Monte Carlo alone.
    pub monte_carlo: Vec<f64>,
    /// Bounds on the bias of the step in θ̂.
    pub bias_bound: Vec<f64>,
    /// Squares of residuals in the inverse of their covariance.
    pub chi_square: f64,
    /// Degrees of freedom of χ².
    pub degrees: usize,
    /// Probability of a larger χ² if the model is right; `None` without degrees of freedom.
    pub probability: Option<f64>,
    /// Moments of the model at θ̂.
    pub moments: Vec<f64>,
    /// Half-widths of their 95 % intervals.
    pub bands: Vec<f64>,
    /// Last effort.
    pub effort: Effort,
    /// Number of evaluations of the model.
    pub evaluations: u32,
    /// Whether Monte Carlo or step errors, which intervals have, widen one by more than a tenth.
    pub widened: bool,
    /// Warnings for a reader; also of what widens the intervals.
    pub warnings: Vec<Warning>,
}

impl Fit {
    /// Half-width of the 95 % interval of parameter k.
    pub fn half_width(&self, k: usize) -> f64 {
        two_sided(CONFIDENCE, None) * self.covariance[k][k].sqrt() + self.bias_bound[k]
    }

    /// The 95 % interval of parameter k.
    pub fn interval(&self, k: usize) -> (f64, f64) {
        (self.values[k] - self.half_width(k), self.values[k] + self.half_width(k))
    }

    /// Whether nothing speaks against the fit. Intervals may be wider than the data make them.
    pub fn is_good(&self) -> bool {
        // One of the warnings says that.
        self.warnings.len() == usize::from(self.widened)
    }
}

/// Replicates of the moments at θ with some effort.
pub type Model<'a, E> = dyn FnMut(&[f64], &Effort) -> Result<Vec<Replicate>, E> + 'a;
type At<'a, E> = dyn FnMut(&[f64]) -> Result<Point, FitError<E>> + 'a;

/// Step, in errors of the data, below which the search ends.
const CLOSE: f64 = 1e-3;
/// Largest number of steps of a search.
const STEPS: usize = 60;
/// Damping of a first step that is not a whole one, its factor, and its largest value.
const DAMPING: f64 = 1e-2;
const FACTOR: f64 = 10.0;
const MOST: f64 = 1e6;
/// Part that Monte Carlo errors and the bias may add to an interval.
const PART: f64 = 0.1;
/// Standard errors of a singular value by which it is not zero.
const SEEN: f64 = 2.0;
/// Part of a singular direction that a parameter has at least if it is named.
const LEAST: f64 = 0.05;
/// Distance from the least squares, in errors of the data, with which a search may end.
const NEAR: f64 = 0.05;
/// Probability of χ² below which a model is wrong.
const WRONG: f64 = 1e-3;
/// Paths of a replicate that quantiles take.
const FOR_QUANTILES: u64 = 2048;

/// Moments at θ, in units of the errors of the data.
struct Point {
    theta: Vec<f64>,
    replicates: Vec<Replicate>,
    mean: Replicate,
    residual: Col<f64>,
    slopes: Mat<f64>,
    singular: Singular,
}

impl Point {
    fn square(&self) -> f64 {
        self.residual.squared_norm_l2()
    }

    /// Distance of the moments to the least squares of the linear model.
    fn distance(&self) -> f64 {
        self.singular.along(&self.residual).iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

/// The mean of replicates.
fn mean(all: &[Replicate]) -> Replicate {
    let over = |of: &dyn Fn(&Replicate) -> &Vec<f64>| {
        let sum = |i| all.iter().map(|one| of(one)[i]).sum::<f64>() / all.len() as f64;
        (0..of(&all[0]).len()).map(sum).collect()
    };
    Replicate {
        values: over(&|one| &one.values),
        coarse: over(&|one| &one.coarse),
        slopes: (0..all[0].slopes.len()).map(|k| over(&|one| &one.slopes[k])).collect(),
        covariance: all[0].covariance.clone(),
        failed: all.iter().map(|one| one.failed).sum(),
    }
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Parameters with a start and their names, by the least squares of the moments of `data`.
///
/// `model` gives replicates of the moments at θ with some effort, at least one. It is asked for the
/// same noise each time.
///
/// # Errors
/// [`FitError`]. An error of the model away from the start shortens the step.
pub fn fit<E>(
    data: &Data,
    start: &[(String, f64)],
    settings: &FitSettings,
    model: &mut Model<'_, E>,
) -> Result<Fit, FitError<E>> {
    let least = if data.moments.iter().any(Moment::is_quantile) { FOR_QUANTILES } else { 1 };
    let mut effort = Effort { paths: settings.paths.max(least), steps: 1 };
    let (mut evaluations, mut spent) = (0, 0);
    let mut theta: Vec<f64> = start.iter().map(|(_, value)| *value).collect();
    let names: Vec<String> = start.iter().map(|(name, _)| name.clone()).collect();
    let (parameters, mut to) = (start.len(), data.whitening.clone());
    let mut weighted = data.observations.is_empty();
    let mut last = None;
    loop {
        let moments = to.map.nrows();
        if parameters > moments {
            return Err(FitError::Few { parameters, moments });
        }
        let mut at = |theta: &[f64]| {
            (evaluations, spent) = (evaluations + 1, spent + effort.all_paths() * effort.steps);
            point((data, &to), &names, theta, model(theta, &effort).map_err(FitError::Model)?)
        };
        let (found, settled) = match (at(&theta), last) {
            (Err(_), Some(fit)) if settings.stop.is_asked() => return Ok(stopped(fit)),
            (here, _) => search(here?, &mut at, &settings.stop)?,
        };
        let mut fit = judged(&to, &names, &found, effort);
        fit.evaluations = evaluations;
        let unseen = unidentified(&to, &names, &found);
        let widths = (0..parameters).map(|k| fit.half_width(k));
        if unseen.is_none() && !widths.chain([fit.chi_square]).all(f64::is_finite) {
            // They overflow where the search is lost.
            return Err(not_finite(&names, &found.theta));
        }
        if settings.stop.is_asked() {
            return Ok(stopped(fit));
        }
        theta = found.theta.clone();
        let mut next = effort;
        for k in 0..parameters {
            let whole = fit.covariance[k][k];
            let own = (whole - fit.monte_carlo[k].powi(2)).max(0.0);
            if whole > own * (1.0 + PART).powi(2) || unseen.is_some() {
                next.paths = 2 * effort.paths;
            }
            if fit.bias_bound[k] > PART * fit.half_width(k) {
                next.steps = 2 * effort.steps;
            }
        }
        let affordable = spent + 4 * next.all_paths() * next.steps <= settings.most;
        let exact = found.singular.values.contains(&0.0);
        let mut again = next != effort && affordable && !(exact && unseen.is_some());
        if again {
            effort = next;
        }
        if let (true, Some(own)) = (again || !weighted, of_model(data, &found.mean)) {
            (to, weighted, again) = (own, true, true);
        }
        if again {
            last = Some(fit);
            continue;
        }
        if let Some(error) = unseen {
            return Err(error);
        }
        let wrong = fit.probability.filter(|p| *p < WRONG).map(|p| {
            let reason =
                format!("χ² = {:.1} with {} degrees, p = {p:.1e}", fit.chi_square, fit.degrees);
            Warning::new("the model does not fit the data").with_reason(reason)
        });
        let (failed, all) = (found.mean.failed, effort.all_paths());
        let lost = format!("{failed} of {all} paths failed and are in no moment");
        let wide = "Monte Carlo errors or step errors widen the intervals by more than a tenth";
        let others = [
            (failed > 0, &*lost, "take more steps"),
            (!settled, "the search did not settle", "start nearer to the parameters"),
            (next != effort, wide, "allow more path-steps"),
        ];
        let others = others.into_iter().filter(|(holds, ..)| *holds);
        let others = others.map(|(_, what, remedy)| Warning::new(what).with_remedy(remedy));
        fit.warnings.extend(wrong.into_iter().chain(others));
        fit.widened = next != effort;
        return Ok(fit);
    }
}

/// A fit that was stopped.
fn stopped(mut fit: Fit) -> Fit {
    let warning = Warning::new("the search was stopped before its end");
    fit.warnings.push(warning.with_remedy("go on with it"));
    fit
}

/// Errors of samples by the covariance of the model: that of the same samples is large where their
/// variance is, by chance, and would give the weights a bias (Altonji and Segal, *J. Bus. Econ.
/// Stat.* 14, 1996).
fn of_model(data: &Data, mean: &Replicate) -> Option<Whitening> {
    let (all, observations) = (&mean.covariance, &data.observations);
    let number = all.len().min(observations.len());
    Whitening::of(number, |i, j| all[i][j] / observations[i] as f64)
}

fn not_finite<E>(names: &[String], theta: &[f64]) -> FitError<E> {
    let pairs = names.iter().zip(theta).map(|(name, value)| format!("{name} = {value}"));
    FitError::NotFinite(pairs.collect::<Vec<_>>().join(", "))
}

/// Moments at θ in units of the errors of the data.
fn point<E>(
    (data, to): (&Data, &Whitening),
    names: &[String],
    theta: &[f64],
    replicates: Vec<Replicate>,
) -> Result<Point, FitError<E>> {
    let mean = mean(&replicates);
    let values: Vec<f64> = data.moments.iter().map(|moment| moment.value).collect();
    let residual = to.difference(&values, &mean.values);
    let slopes = to.columns(&mean.slopes);
    let finite = residual.is_all_finite() && slopes.is_all_finite();
    let singular =
        Singular::of(&slopes).filter(|_| finite).ok_or_else(|| not_finite(names, theta))?;
    Ok(Point { theta: theta.to_vec(), replicates, mean, residual, slopes, singular })
}

/// The method of Levenberg and Marquardt; the first trial of each step is Gauss and Newton's.
/// Returns whether the last step was short.
fn search<E>(
    mut here: Point,
    at: &mut At<'_, E>,
    stop: &Stop,
) -> Result<(Point, bool), FitError<E>> {
    let mut damping = 0.0;
    for _ in 0..STEPS {
        if here.distance() < CLOSE {
            break;
        }
        let step = here.singular.solve(&here.residual, damping);
        let next: Vec<f64> = here.theta.iter().zip(&step).map(|(x, d)| x + d).collect();
        match at(&next) {
            Ok(found) if found.square() < here.square() => {
                here = found;
                damping = if damping > DAMPING { damping / FACTOR } else { 0.0 };
            }
            _ if stop.is_asked() => break,
            Err(error) if damping > MOST => return Err(error),
            Ok(_) if damping > MOST => break,
            _ => damping = (FACTOR * damping).max(DAMPING),
        }
    }
    let settled = here.distance() < NEAR;
    Ok((here, settled))
}

/// The intervals and χ² at the end of a search.
fn judged(to: &Whitening, names: &[String], found: &Point, effort: Effort) -> Fit {
    let Point { replicates, mean, residual, slopes, singular, .. } = found;
    let (p, all) = (names.len(), replicates.len() as f64);
    // Errors of the mean over replicates; one replicate is exact.
    let factor = if all > 1.0 { 1.0 / (all * (all - 1.0)) } else { 0.0 };
    let units = diagonal(&vec![1.0; p]);
    let mut covariance: Vec<_> = units.iter().map(|unit| singular.inverse(unit)).collect();
    let bias = to.difference(&mean.values, &mean.coarse);
    let mut errors = Mat::<f64>::identity(residual.nrows(), residual.nrows());
    errors += &bias * bias.transpose();
    let mut monte_carlo = vec![0.0; p];
    for one in replicates {
        let apart = to.difference(&one.values, &mean.values);
        let by = one.slopes.iter().zip(&mean.slopes).map(|(a, b)| minus(a, b)).collect::<Vec<_>>();
        // The gradient Jᵀr of this replicate beside that of the mean.
        let gradient = to.columns(&by).transpose() * residual - slopes.transpose() * &apart;
        let of = singular.inverse(&gradient.iter().copied().collect::<Vec<_>>());
        errors += faer::Scale(factor) * (&apart * apart.transpose());
        for k in 0..p {
            monte_carlo[k] += factor * of[k] * of[k];
            (0..p).for_each(|j| covariance[k][j] += factor * of[k] * of[j]);
        }
    }
    // The least squares in the norm of all errors.
    let whitened = Whitening::of(errors.nrows(), |i, j| errors[(i, j)]).and_then(|to| {
        let (r, slopes) = (&to.map * residual, &to.map * slopes);
        let along = Singular::of(&slopes)?.along(&r);
        Some(r.squared_norm_l2() - along.iter().map(|x| x * x).sum::<f64>())
    });
    let (chi_square, degrees) = (whitened.unwrap_or(f64::NAN), residual.nrows() - p);
    let band = |i: usize| {
        let slope = |k: usize| mean.slopes[k][i];
        let sum = |k: usize| (0..p).map(|j| slope(k) * covariance[k][j] * slope(j)).sum::<f64>();
        two_sided(CONFIDENCE, None) * (0..p).map(sum).sum::<f64>().max(0.0).sqrt()
    };
    Fit {
        names: names.to_vec(),
        values: found.theta.clone(),
        bias_bound: singular.solve(&bias, 0.0).iter().map(|x| x.abs()).collect(),
        monte_carlo: monte_carlo.iter().map(|square| square.sqrt()).collect(),
        chi_square,
        degrees,
        probability: chi_square_p_value(chi_square, degrees),
        bands: (0..mean.values.len()).map(band).collect(),
        moments: mean.values.clone(),
        covariance,
        effort,
        evaluations: 0,
        widened: false,
        warnings: Vec::new(),
    }
}

/// The parameter or the combination of parameters that changes no moment, if there is one.
fn unidentified<E>(to: &Whitening, names: &[String], found: &Point) -> Option<FitError<E>> {
    let Point { replicates, mean, singular, .. } = found;
    let all = replicates.len() as f64;
    // Whether moments change by s along a direction, up to Monte Carlo errors.
    let hidden = |direction: &[f64], s: f64| {
        let along = |of: &Replicate| -> Vec<f64> {
            let sum = |i| of.slopes.iter().zip(direction).map(|(row, v)| row[i] * v).sum();
            (0..of.values.len()).map(sum).collect()
        };
        let whole = along(mean);
        let apart = |one| to.difference(&along(one), &whole).squared_norm_l2();
        let error = replicates.iter().map(apart).sum::<f64>() / (all * (all - 1.0).max(1.0));
        s * s <= SEEN * SEEN * error
    };
    let of = |k: usize| (singular.direction(k), singular.values[k]);
    let (mut direction, _) = (0..names.len()).rev().map(of).find(|(v, s)| hidden(v, *s))?;
    let mut involved: Vec<usize> = (0..names.len())
        .filter(|j| {
            let length = singular.lengths[*j];
            direction[*j].abs() * if length > 0.0 { length } else { 1.0 } > LEAST
        })
        .collect();
    // The errors of a parameter that changes nothing look like the changes of others.
    let unit = |j: usize| (0..names.len()).map(|i| f64::from(u8::from(i == j))).collect::<Vec<_>>();
    if let Some(&j) = involved.iter().find(|j| hidden(&unit(**j), singular.lengths[**j])) {
        (direction, involved) = (unit(j), vec![j]);
    }
    let mut words = String::from("the data do not tell the parameters apart: ");
    _ = match involved[..] {
        [j] if singular.lengths[j] > 0.0 => {
            let name = &names[j];
            write!(words, "they change with `{name}` by no more than sampling errors; fix it")
        }
        [j] => write!(words, "they do not depend on `{}`; fix it", names[j]),
        [j, l] => {
            let ratio = -direction[j] / direction[l];
            let sign = if ratio < 0.0 { '-' } else { '+' };
            let ratio = short(ratio.abs());
            let (x, y) = (&names[j], &names[l]);
            write!(words, "they change with {x} {sign} {ratio} {y} alone; fix one of both")
        }
        _ => {
            let all = involved
                .iter()
                .map(|&j| format!("{} by {}", names[j], short(direction[j])))
                .collect::<Vec<_>>()
                .join(", ");
            write!(words, "they do not change with {all} together; fix one of them")
        }
    };
    let direction = involved.iter().map(|&j| (names[j].clone(), direction[j])).collect();
    Some(FitError::Unidentified { direction, words })
}
