//! Whether one step has the coefficients of the equation as the step size tends to zero.
//!
//! A scheme that is stable converges to the solution if its error of one step against the
//! coefficients, δ = ψ_τ(y) − y − (B∇H₀ − γy + c)τ − Σ B∇Hₘ ΔWₘ with the Itô correction c = ½Σ
//! fₘ′fₘ, has E|δ|² = o(τ) and |Eδ| = o(τ) (Milstein, *Theory Probab. Appl.* 32, 1987). Both can
//! be seen in single steps, far below the step sizes at which whole paths can run. For Eδ the
//! increments are ±√τ with signs from the rows of a Hadamard matrix and their negatives: their
//! moments up to the third are those of normals, so the terms up to τ^{3/2} are averaged exactly.
//!
//! A law is the right one, whatever the paths, if the covariance of a step replaces its noise:
//! |Eδ| = o(τ) and |E[ΔyΔyᵀ] − Σ fₘfₘᵀτ| = o(τ) (Milstein, *Theory Probab. Appl.* 30, 1986).

use noise::{Noise, StreamKey, WienerPath};
use schemes::{Scheme, Step};
use systems::{Damping, PoissonSystem, Problem, ito_correction, unit_noise, vector_field};

use super::{StepSizes, visits::Visit};

/// What single steps show as τ → 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Consistency {
    /// Drift and noise are those of the equation, to this part of |y| per unit of time and per root
    /// of it.
    Consistent(f64),
    /// The drift or the noise of a step is wrong by this part.
    Inconsistent(f64),
    /// Neither shows, or steps fail.
    Unclear,
}

/// Paths whose states are taken.
const VISITS: usize = 64;
/// Step sizes, each a quarter of the one before.
const SCALES: i32 = 24;
/// Rounding errors of one step are this part of |y|, or less.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;
/// What is that many times as large as rounding errors is known to a tenth.
const SHOWN: f64 = 8.0;
/// Errors that fall with less than this exponent of τ may not vanish; those of the field have ½ or
/// more.
const FALLS: f64 = 0.25;
/// Defects must be known to this part of the motion of the paths: beside a component of 1e12, a
/// wrong coefficient of size one is round-off.
const KNOWN: f64 = 1e-3;
/// Errors that fall with less than this exponent do not vanish.
const STAYS: f64 = 0.1;

/// Compares steps from these states with the coefficients of the equation, for paths or for their
/// law alone.
pub fn consistency<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    visits: &[Visit<D>],
    law: bool,
) -> Consistency
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let visits = &visits[..visits.len().min(VISITS)];
    let t_end = problem.t_end();
    let coarsest = t_end / sizes.coarsest_steps as f64;
    let (mut drift, mut noise, mut motion) = (Vec::new(), Vec::new(), 0.0f64);
    for scale in 0..SCALES {
        let tau = coarsest * f64::powi(0.25, scale);
        let Some(errors) = errors(scheme, problem, sizes.key, visits, tau) else { continue };
        drift.push(Error { value: errors.drift / tau, floor: ROUND_OFF / tau });
        let value = if law { errors.covariance / tau } else { errors.noise / tau.sqrt() };
        motion = motion.max(errors.motion);
        noise.push(Error { value, floor: ROUND_OFF / tau.sqrt() });
    }
    match [vanishes(&drift), vanishes(&noise)] {
        [Consistency::Consistent(a), Consistency::Consistent(b)]
            if (a * t_end).max(b * t_end.sqrt()) <= KNOWN * motion =>
        {
            Consistency::Consistent(a.max(b))
        }
        [wrong @ Consistency::Inconsistent(_), _] | [_, wrong @ Consistency::Inconsistent(_)] => {
            wrong
        }
        _ => Consistency::Unclear,
    }
}

/// A relative error and what rounding makes of it.
struct Error {
    value: f64,
    floor: f64,
}

/// Whether errors vanish as τ → 0, from those above rounding.
fn vanishes(errors: &[Error]) -> Consistency {
    let shown: Vec<f64> = errors
        .iter()
        .take_while(|error| error.value > SHOWN * error.floor)
        .map(|error| error.value)
        .collect();
    // |Eδ|/τ and (E|δ|²/τ)^½ with τ a quarter as large.
    let exponents: Vec<f64> =
        shown.windows(2).map(|pair| 0.5 * (pair[0] / pair[1]).log2()).collect();
    match (&shown[..], &exponents[..]) {
        // Nothing but rounding, from the first or the second step size on.
        ([] | [_], _) => match errors.get(shown.len()) {
            Some(error) => Consistency::Consistent(error.value.max(error.floor)),
            None => Consistency::Unclear,
        },
        (&[.., last], &[.., exponent]) if exponent >= FALLS => Consistency::Consistent(last),
        (&[.., last], &[.., before, exponent]) if exponent.abs().max(before.abs()) <= STAYS => {
            Consistency::Inconsistent(last)
        }
        _ => Consistency::Unclear,
    }
}

/// What steps of one size show, as parts of |y|.
struct Errors {
    /// Root mean square of |Eδ|.
    drift: f64,
    /// Root mean square of |δ|.
    noise: f64,
    /// Root mean square of |E[ΔyΔyᵀ] − Σ fₘfₘᵀτ| over |y|√Σ|fₘ|².
    covariance: f64,
    /// Size of the coefficients times T and √T.
    motion: f64,
}

/// Errors of steps from these states; `None` if a tenth of the steps fail, or y = 0.
fn errors<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    key: StreamKey,
    visits: &[Visit<D>],
    tau: f64,
) -> Option<Errors> {
    let (system, damping, t_end) = (problem.system(), problem.damping(), problem.t_end());
    let (mut drift, mut noise, mut covariance, mut motion) = (0.0, 0.0, 0.0, 0.0);
    let (mut size, mut scale, mut failed) = (0.0, 0.0, 0);
    for (path, visit) in (0..).zip(visits) {
        let y = visit.state;
        let step = Step::new(damping, (visit.t / tau).round() as u64, tau).ok()?;
        // The coefficients of the equation in Itô's form.
        let field: [f64; D] = vector_field(system, y, 1.0, [0.0; M]);
        let correction: [f64; D] = ito_correction(system, y);
        let a: [f64; D] =
            std::array::from_fn(|i| field[i] + correction[i] - step.rate_at_start * y[i]);
        let b: [[f64; D]; M] = std::array::from_fn(|m| vector_field(system, y, 0.0, unit_noise(m)));
        // Δy, and its error δ.
        let change = |dw: [f64; M]| {
            let solution = scheme.step(system, &step, &Noise::increments(dw), y);
            let change: [f64; D] = std::array::from_fn(|i| solution.z[i] - y[i]);
            let exact = |i: usize| a[i] * tau + (0..M).map(|m| b[m][i] * dw[m]).sum::<f64>();
            let error: [f64; D] = std::array::from_fn(|i| change[i] - exact(i));
            let good = solution.outcome.converged() && error.iter().all(|e| e.is_finite());
            good.then_some((change, error))
        };
        let normal = change(WienerPath::<M>::new(key, path).increments(tau.sqrt()));
        let signed: Option<Vec<_>> =
            signs::<M>().map(|signs| change(signs.map(|sign| sign * tau.sqrt()))).collect();
        let (Some((_, normal)), Some(signed)) = (normal, signed) else {
            failed += 1;
            continue;
        };
        let number = signed.len() as f64;
        let mean = |i: usize| signed.iter().map(|(_, error)| error[i]).sum::<f64>() / number;
        let wrong = |i: usize, j: usize| {
            let product = signed.iter().map(|(change, _)| change[i] * change[j]).sum::<f64>();
            product / number - tau * b.iter().map(|b| b[i] * b[j]).sum::<f64>()
        };
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        let noises = square(b.as_flattened());
        drift += square(&std::array::from_fn::<f64, D, _>(mean));
        noise += square(&normal);
        covariance += (0..D).map(|i| (0..D).map(|j| wrong(i, j).powi(2)).sum::<f64>()).sum::<f64>();
        motion += square(&a) * t_end * t_end + noises * t_end;
        size += square(&y);
        scale += square(&y) * noises;
    }
    let usable = 10 * failed <= visits.len() && size > 0.0;
    usable.then(|| Errors {
        drift: (drift / size).sqrt(),
        noise: (noise / size).sqrt(),
        covariance: if scale > 0.0 { (covariance / scale).sqrt() } else { 0.0 },
        motion: (motion / size).sqrt(),
    })
}

/// The rows of a Hadamard matrix and their negatives: any two columns are orthogonal, and odd
/// moments vanish.
fn signs<const M: usize>() -> impl Iterator<Item = [f64; M]> {
    let rows = M.next_power_of_two();
    (0..2 * rows).map(move |row| {
        let sign = if row < rows { 1.0 } else { -1.0 };
        std::array::from_fn(|m| if (row & m).count_ones().is_multiple_of(2) { sign } else { -sign })
    })
}

#[cfg(test)]
mod tests {
    use systems::{Constant, paper::valid};

    use super::{
        super::tests::{Anything, Single},
        *,
    };

    #[test]
    fn signs_have_the_moments_of_normals_up_to_the_third() {
        let signs: Vec<[f64; 5]> = signs().collect();
        let n = signs.len() as f64;
        for i in 0..5 {
            assert_eq!(signs.iter().map(|s| s[i]).sum::<f64>(), 0.0);
            for j in 0..5 {
                let second: f64 = signs.iter().map(|s| s[i] * s[j]).sum();
                assert_eq!(second / n, f64::from(u8::from(i == j)));
                for k in 0..5 {
                    assert_eq!(signs.iter().map(|s| s[i] * s[j] * s[k]).sum::<f64>(), 0.0);
                }
            }
        }
    }

    #[test]
    fn what_vanishes_and_what_stays() {
        let of = |value: fn(f64) -> f64| {
            let error = |n| {
                let tau = f64::powi(0.25, n);
                Error { value: value(tau).max(1e-17 / tau), floor: ROUND_OFF / tau }
            };
            vanishes(&(0..SCALES).map(error).collect::<Vec<_>>())
        };
        assert!(matches!(of(|tau| 3.0 * tau), Consistency::Consistent(d) if d < 1e-6));
        assert!(matches!(of(|tau| tau.sqrt()), Consistency::Consistent(d) if d < 1e-3));
        assert!(matches!(of(|_| 0.0), Consistency::Consistent(_)));
        let Consistency::Inconsistent(part) = of(|tau| tau + 1e-5) else { panic!() };
        assert!((1e-5..2e-5).contains(&part), "{part}");
        assert_eq!(of(|tau| tau.powf(-0.5)), Consistency::Unclear);
    }

    #[test]
    fn an_error_stays_or_vanishes_by_its_last_two_exponents() {
        let of = |values: &[f64], floor: f64| {
            vanishes(&values.iter().map(|&value| Error { value, floor }).collect::<Vec<_>>())
        };
        // Quarters of τ: factors 4^{¼} and 4^{0.1} of two values are the exponents at the edges.
        let factor = |exponent: f64| 4f64.powf(-exponent);
        let last_two = |a: f64, b: f64| of(&[1.0, factor(a), factor(a) * factor(b)], 1e-9);
        assert!(matches!(last_two(-1.0, 0.251), Consistency::Consistent(_)));
        assert_eq!(last_two(1.0, 0.249), Consistency::Unclear);
        let stays = factor(0.099) * factor(0.099);
        assert_eq!(last_two(0.099, 0.099), Consistency::Inconsistent(stays));
        let grows = factor(-0.099) * factor(-0.099);
        assert_eq!(last_two(-0.099, -0.099), Consistency::Inconsistent(grows));
        assert_eq!(last_two(0.101, 0.099), Consistency::Unclear);
        assert_eq!(last_two(0.099, 0.101), Consistency::Unclear);
        assert_eq!(last_two(-0.2, 0.05), Consistency::Unclear);
        // What is eight times rounding is known; the first that is not bounds the rest.
        assert_eq!(of(&[7.9, 1.0], 1.0), Consistency::Consistent(7.9));
        assert_eq!(of(&[8.1, 1.0], 1.0), Consistency::Consistent(1.0));
        assert_eq!(of(&[8.1, 0.5, 9.0], 1.0), Consistency::Consistent(1.0));
        assert_eq!((of(&[8.1], 1.0), of(&[], 1.0)), (Consistency::Unclear, Consistency::Unclear));
        assert_eq!(of(&[8.1, 8.1], 1.0), Consistency::Unclear);
    }

    #[test]
    fn errors_of_steps_are_parts_of_the_states() {
        // γ = ½ at (3, 4): a = (1, 0) − (1.5, 2) and b = (1, 0). A step adds τ/2 to its first
        // component and ΔW/4 to its second one.
        let scheme = Single(|_, tau, dw, y| {
            if y[0] < 0.0 {
                return [f64::NAN; 2];
            }
            [y[0] - 0.5 * tau + dw + 0.5 * tau, y[1] - 2.0 * tau + 0.25 * dw]
        });
        let damping = valid(Constant::new(0.5));
        let problem = valid(Problem::new(Anything, damping, [3.0, 4.0], 2.0));
        let key = StreamKey { seed: 1, experiment: 1 };
        let good = Visit { t: 0.0, state: [3.0, 4.0] };
        let failing = Visit { state: [-3.0, 4.0], ..good };
        let of = |visits: &[Visit<2>]| errors(&scheme, &problem, key, visits, 0.25);
        let found = of(&[good; 2]).unwrap();
        let close = |found: f64, exact: f64| {
            assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
        };
        close(found.drift, 0.125 / 5.0);
        let dw = [0, 1].map(|path| WienerPath::<1>::new(key, path).increments(0.5)[0]);
        let square = dw.map(|dw| 0.125 * 0.125 + dw * dw / 16.0);
        close(found.noise, (0.5 * (square[0] + square[1])).sqrt() / 5.0);
        // Δy = (±½, −½ ± ⅛): its square less (¼, 0, 0).
        let covariance = 2.0 * 0.0625f64.powi(2) + (0.25f64 + 0.015_625).powi(2);
        close(found.covariance, covariance.sqrt() / 5.0);
        // |a|²T² + |b|²T.
        close(found.motion, (4.25f64 * 4.0 + 2.0).sqrt() / 5.0);
        // A tenth of the steps may fail.
        let visits = [&[good; 9][..], &[failing]].concat();
        close(of(&visits).unwrap().drift, 0.125 / 5.0);
        assert!(of(&[&[good; 8][..], &[failing]].concat()).is_none());
        assert!(of(&[Visit { state: [0.0; 2], ..good }]).is_none());
        // The drift is wrong by a tenth of |y|, told to an eighth; without it, the noise is wrong.
        let sizes = StepSizes::new(4, noise::Truncation::none(), key);
        let told = |scheme: &Single| consistency(scheme, &problem, &sizes, &[good; 4], false);
        let Consistency::Inconsistent(part) = told(&scheme) else { panic!("{:?}", told(&scheme)) };
        assert!((part - 0.1).abs() < 0.1 / SHOWN, "{part}");
        let right = Single(|_, tau, dw, y| [y[0] - 0.5 * tau + dw, y[1] - 2.0 * tau]);
        assert!(matches!(told(&right), Consistency::Consistent(part) if part < 1e-6));
        let noisy = Single(|_, tau, dw, y| [y[0] - 0.5 * tau + dw, y[1] - 2.0 * tau + 0.25 * dw]);
        assert!(matches!(told(&noisy), Consistency::Inconsistent(part) if part > 0.01));
    }
}
