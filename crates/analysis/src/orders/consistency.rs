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

use mc::{Coefficients, Setup, demand};
use noise::{StepNoise, WienerRows};
use real::{PathMask, WIDTH, elementary::log2};
use schemes::Step;

use super::{
    Limit, StepSizes,
    one_step::Steps,
    runs::{Visit, state},
};

/// Number of paths whose states single steps start from.
pub const VISITS: usize = 64;
/// Number of step sizes, each a quarter of the one before.
const SCALES: i32 = 24;
/// Upper bound of the rounding errors of one step as a part of |y|.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;
/// Ratio to rounding errors from which an error is known to a tenth.
const SHOWN: f64 = 8.0;
/// Errors that fall with less than this exponent of τ may not vanish; those of the field have ½ or
/// more.
const FALLS: f64 = 0.25;
/// Defects must be known to this part of the motion of the paths: beside a component of 1e12, a
/// wrong coefficient of size one is round-off.
const KNOWN: f64 = 1e-3;
/// Errors that fall with less than this exponent do not vanish.
const STAYS: f64 = 0.1;

/// Compares steps from the states `visits` with the coefficients of the equation, for paths or for
/// their `law` alone: the limit is consistent, inconsistent or unchecked. It is unchecked where
/// steps fail or the measurement is stopped.
pub fn consistency(setup: &Setup<'_>, sizes: &StepSizes, visits: &[Visit], law: bool) -> Limit {
    let numbers = (setup.problem.y0.len() * setup.problem.noises * VISITS) as f64;
    if demand("coefficients", 8.0 * numbers).is_err() {
        return Limit::Unchecked;
    }
    let known = visits.iter().take(VISITS).map(|visit| {
        let at = (setup.problem.coefficients)(visit.t, &visit.state);
        Known { visit, at }
    });
    let (visits, mut steps) = (known.collect::<Vec<_>>(), Steps::new(setup));
    let t_end = setup.problem.t_end;
    let coarsest = t_end / sizes.coarsest_steps as f64;
    let (mut drift, mut noise, mut motion) = (Vec::new(), Vec::new(), 0.0f64);
    for scale in 0..SCALES {
        let tau = coarsest * f64::powi(0.25, scale);
        let found = errors(&mut steps, sizes, &visits, tau);
        if sizes.stop.is_asked() {
            return Limit::Unchecked;
        }
        let Some(errors) = found else { continue };
        drift.push(Error { value: errors.drift / tau, floor: ROUND_OFF / tau });
        let value = if law { errors.covariance / tau } else { errors.noise / tau.sqrt() };
        motion = motion.max(errors.motion);
        noise.push(Error { value, floor: ROUND_OFF / tau.sqrt() });
    }
    match [vanishes(&drift), vanishes(&noise)] {
        [Limit::Consistent { defect: a }, Limit::Consistent { defect: b }]
            if (a * t_end).max(b * t_end.sqrt()) <= KNOWN * motion =>
        {
            Limit::Consistent { defect: a.max(b) }
        }
        [wrong @ Limit::Inconsistent { .. }, _] | [_, wrong @ Limit::Inconsistent { .. }] => wrong,
        _ => Limit::Unchecked,
    }
}

/// Relative error of single steps, with its rounding error.
struct Error {
    value: f64,
    floor: f64,
}

/// Whether errors vanish as τ → 0, from those above rounding.
fn vanishes(errors: &[Error]) -> Limit {
    let shown = errors.iter().take_while(|error| error.value > SHOWN * error.floor);
    let shown: Vec<f64> = shown.map(|error| error.value).collect();
    // |Eδ|/τ and (E|δ|²/τ)^½ with τ a quarter as large.
    let exponents: Vec<f64> = shown.windows(2).map(|pair| 0.5 * log2(pair[0] / pair[1])).collect();
    match (&shown[..], &exponents[..]) {
        // Nothing but rounding, from the first or the second step size on.
        ([] | [_], _) => match errors.get(shown.len()) {
            Some(error) => Limit::Consistent { defect: error.value.max(error.floor) },
            None => Limit::Unchecked,
        },
        (&[.., defect], &[.., exponent]) if exponent >= FALLS => Limit::Consistent { defect },
        (&[.., defect], &[.., before, exponent]) if exponent.abs().max(before.abs()) <= STAYS => {
            Limit::Inconsistent { defect }
        }
        _ => Limit::Unchecked,
    }
}

/// Errors of steps of one size, as parts of |y|.
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

/// Visit with the coefficients of the equation there.
struct Known<'a> {
    visit: &'a Visit,
    at: Coefficients,
}

/// Errors of steps from the visited states; `None` if a tenth of the steps fail, or y = 0.
fn errors(
    steps: &mut Steps<'_>,
    sizes: &StepSizes,
    visits: &[Known<'_>],
    tau: f64,
) -> Option<Errors> {
    let noises = steps.setup.problem.noises;
    let (mut sums, mut failed) = ([0.0; 6], 0);
    // Normal increments, then signs.
    let mut increments = vec![Vec::new()];
    increments.extend(signs(noises).map(|signs| signs.map(|sign| sign * tau.sqrt()).collect()));
    for (block, visits) in (0..).zip(visits.chunks(WIDTH)) {
        let mut normals = StepNoise::zero(noises);
        let mut wiener = WienerRows::new(sizes.key, block * WIDTH as u64);
        wiener.increments(tau.sqrt(), &mut normals.increments);
        for (p, known) in visits.iter().enumerate() {
            if sizes.stop.is_asked() {
                return None;
            }
            increments[0] = state(&normals.increments, p);
            match squares(steps, known, tau, &increments) {
                Some(found) => sums.iter_mut().zip(found).for_each(|(sum, x)| *sum += x),
                None => failed += 1,
            }
        }
    }
    let [drift, noise, covariance, motion, size, scale] = sums;
    let usable = 10 * failed <= visits.len() && size > 0.0;
    usable.then(|| Errors {
        drift: (drift / size).sqrt(),
        noise: (noise / size).sqrt(),
        covariance: if scale > 0.0 { (covariance / scale).sqrt() } else { 0.0 },
        motion: (motion / size).sqrt(),
    })
}

/// Mean squares whose roots are the [`Errors`], of steps from one state, then |y|² and |y|²Σ|fₘ|²;
/// `None` if a step fails.
fn squares(
    steps: &mut Steps<'_>,
    Known { visit: Visit { t, state: y }, at }: &Known<'_>,
    tau: f64,
    increments: &[Vec<f64>],
) -> Option<[f64; 6]> {
    let (problem, b) = (&steps.setup.problem, &at.noises);
    let step = Step::new(problem.damping, (t / tau).round() as u64, tau).ok()?;
    let of_all = |of: &dyn Fn(usize) -> f64| (0..y.len()).map(of).collect::<Vec<f64>>();
    let a = of_all(&|i| at.drift[i] + at.correction[i] - step.rate_at_start * y[i]);
    let changes = changes(steps, &step, y, increments)?;
    // δ of each step.
    let errors = changes.iter().zip(increments).map(|(change, dw)| {
        let of_noise = |i: usize| b.iter().zip(dw).map(|(b, dw)| b[i] * dw).sum::<f64>();
        of_all(&|i| change[i] - (a[i] * tau + of_noise(i)))
    });
    let errors: Vec<Vec<f64>> = errors.collect();
    if errors.iter().flatten().any(|error| !error.is_finite()) {
        return None;
    }
    let number = (changes.len() - 1) as f64;
    let mean = of_all(&|i| errors[1..].iter().map(|error| error[i]).sum::<f64>() / number);
    let wrong = |i: usize, j: usize| {
        let product = changes[1..].iter().map(|change| change[i] * change[j]).sum::<f64>();
        product / number - tau * b.iter().map(|b| b[i] * b[j]).sum::<f64>()
    };
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let rows = of_all(&|i| square(&of_all(&|j| wrong(i, j))));
    let (size, noises, t_end) = (square(y), square(&b.concat()), problem.t_end);
    let motion = square(&a) * t_end * t_end + noises * t_end;
    let covariance = rows.iter().sum();
    Some([square(&mean), square(&errors[0]), covariance, motion, size, size * noises])
}

/// Changes Δy in steps from y on the given increments; `None` if a step fails.
fn changes(
    steps: &mut Steps<'_>,
    step: &Step,
    y: &[f64],
    increments: &[Vec<f64>],
) -> Option<Vec<Vec<f64>>> {
    let mut changes = Vec::with_capacity(increments.len());
    for increments in increments.chunks(WIDTH) {
        for (m, row) in steps.noises[0].increments.iter_mut().enumerate() {
            row.iter_mut().zip(increments).for_each(|(dw, increments)| *dw = increments[m]);
        }
        let (end, live) = steps.step(step, y, increments.len());
        if live != PathMask::first(increments.len()) {
            return None;
        }
        for p in 0..increments.len() {
            changes.push(y.iter().zip(end).map(|(y, end)| end[p] - y).collect());
        }
    }
    Some(changes)
}

/// The rows of a Hadamard matrix and their negatives: any two columns are orthogonal, and odd
/// moments vanish.
fn signs(noises: usize) -> impl Iterator<Item = impl Iterator<Item = f64>> {
    let rows = noises.next_power_of_two();
    (0..2 * rows).map(move |row| {
        let sign = if row < rows { 1.0 } else { -1.0 };
        let odd = move |m: usize| !(row & m).count_ones().is_multiple_of(2);
        (0..noises).map(move |m| if odd(m) { -sign } else { sign })
    })
}

#[cfg(test)]
mod tests {
    use noise::WienerPath;
    use systems::{Constant, Problem, paper::valid};

    use super::{
        super::tests::{Anything, Single},
        *,
    };

    #[test]
    fn signs_have_the_moments_of_normals_up_to_the_third() {
        let signs: Vec<Vec<f64>> = signs(5).map(Iterator::collect).collect();
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
        assert!(matches!(of(|tau| 3.0 * tau), Limit::Consistent { defect: d } if d < 1e-6));
        assert!(matches!(of(|tau| tau.sqrt()), Limit::Consistent { defect: d } if d < 1e-3));
        assert!(matches!(of(|_| 0.0), Limit::Consistent { .. }));
        let Limit::Inconsistent { defect: part } = of(|tau| tau + 1e-5) else { panic!() };
        assert!((1e-5..2e-5).contains(&part), "{part}");
        assert_eq!(of(|tau| tau.powf(-0.5)), Limit::Unchecked);
    }

    #[test]
    fn an_error_stays_or_vanishes_by_its_last_two_exponents() {
        let of = |values: &[f64], floor: f64| {
            vanishes(&values.iter().map(|&value| Error { value, floor }).collect::<Vec<_>>())
        };
        // Quarters of τ: factors 4^{¼} and 4^{0.1} of two values are the exponents at the edges.
        let factor = |exponent: f64| 4f64.powf(-exponent);
        let last_two = |a: f64, b: f64| of(&[1.0, factor(a), factor(a) * factor(b)], 1e-9);
        assert!(matches!(last_two(-1.0, 0.251), Limit::Consistent { .. }));
        assert_eq!(last_two(1.0, 0.249), Limit::Unchecked);
        let stays = factor(0.099) * factor(0.099);
        assert_eq!(last_two(0.099, 0.099), Limit::Inconsistent { defect: stays });
        let grows = factor(-0.099) * factor(-0.099);
        assert_eq!(last_two(-0.099, -0.099), Limit::Inconsistent { defect: grows });
        assert_eq!(last_two(0.101, 0.099), Limit::Unchecked);
        assert_eq!(last_two(0.099, 0.101), Limit::Unchecked);
        assert_eq!(last_two(-0.2, 0.05), Limit::Unchecked);
        // What is eight times rounding is known; the first that is not bounds the rest.
        assert_eq!(of(&[7.9, 1.0], 1.0), Limit::Consistent { defect: 7.9 });
        assert_eq!(of(&[8.1, 1.0], 1.0), Limit::Consistent { defect: 1.0 });
        assert_eq!(of(&[8.1, 0.5, 9.0], 1.0), Limit::Consistent { defect: 1.0 });
        assert_eq!((of(&[8.1], 1.0), of(&[], 1.0)), (Limit::Unchecked, Limit::Unchecked));
        assert_eq!(of(&[8.1, 8.1], 1.0), Limit::Unchecked);
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
        let key = noise::StreamKey { seed: 1, experiment: 1 };
        let sizes = StepSizes::new(4, noise::Truncation::none(), key);
        let good = || Visit { t: 0.0, state: vec![3.0, 4.0] };
        let failing = || Visit { t: 0.0, state: vec![-3.0, 4.0] };
        let setup = Setup::of(&problem, &scheme);
        let of = |good_ones: usize, others: &[Visit]| {
            let visits = [vec![good(); good_ones], others.to_vec()].concat();
            let at = |visit: &Visit| (setup.problem.coefficients)(visit.t, &visit.state);
            let known = visits.iter().map(|visit| Known { visit, at: at(visit) });
            errors(&mut Steps::new(&setup), &sizes, &known.collect::<Vec<_>>(), 0.25)
        };
        let found = of(2, &[]).unwrap();
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
        close(of(9, &[failing()]).unwrap().drift, 0.125 / 5.0);
        assert!(of(8, &[failing()]).is_none());
        assert!(of(0, &[Visit { t: 0.0, state: vec![0.0; 2] }]).is_none());
        // The drift is wrong by a tenth of |y|, told to an eighth; without it, the noise is wrong.
        let told = |scheme: &Single| {
            let setup = Setup::of(&problem, scheme);
            consistency(&setup, &sizes, &vec![good(); 4], false)
        };
        let Limit::Inconsistent { defect: part } = told(&scheme) else {
            panic!("{:?}", told(&scheme))
        };
        assert!((part - 0.1).abs() < 0.1 / SHOWN, "{part}");
        let right = Single(|_, tau, dw, y| [y[0] - 0.5 * tau + dw, y[1] - 2.0 * tau]);
        assert!(matches!(told(&right), Limit::Consistent { defect: part } if part < 1e-6));
        let noisy = Single(|_, tau, dw, y| [y[0] - 0.5 * tau + dw, y[1] - 2.0 * tau + 0.25 * dw]);
        assert!(matches!(told(&noisy), Limit::Inconsistent { defect: part } if part > 0.01));
    }
}
