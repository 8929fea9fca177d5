//! The systems of the paper as formulas, in the set-ups of its panels, against compiled ones.

use formula::{Definition, FormulaSystem};
use kernels::Tuned;
use noise::{StepNoise, StreamKey, Truncation, WienerRows, clip};
use nonlin::BlockStatus;
use real::{Block, PathMask, Row, Simd, WIDTH, limit_to};
use schemes::{BuiltIn, Step, run_time};
use systems::{Damping, Problem, paper};

use crate::paper as texts;

const KEY: StreamKey = StreamKey { seed: 7, experiment: 2 };

/// The states of 32 paths after all steps, path p with the noise of number `numbers[p]`, and those
/// that failed.
fn simulate<const M: usize>(
    (scheme, system): (&dyn run_time::Scheme, &FormulaSystem),
    (damping, y0, tau): (&dyn Damping, &[f64], f64),
    steps: u64,
    numbers: [usize; WIDTH],
) -> (Vec<Row>, PathMask) {
    let mut paths = scheme.stepper(system).unwrap();
    paths.state_mut().iter_mut().zip(y0).for_each(|(row, &y)| *row = [y; WIDTH]);
    let mut wiener = WienerRows::new(KEY, 0);
    let (mut drawn, mut clipped) = (Block::<M>::zero(), Block::<M>::zero());
    let (mut status, mut failed) = (BlockStatus::explicit(), PathMask::NONE);
    let bound = Truncation::new(4).unwrap().bound(tau).unwrap();
    let mut noise = StepNoise::zero(M);
    for n in 0..steps {
        wiener.increments(tau.sqrt(), &mut drawn.0);
        clip(&drawn.0, bound, &mut clipped.0);
        let used = if scheme.about().clips_increments { &clipped } else { &drawn };
        used.0.iter().zip(noise.increments.iter_mut()).for_each(|(row, dw)| {
            *dw = numbers.map(|number| row[number]);
        });
        paths.step(&Step::new(damping, n, tau).unwrap(), &noise, &mut status);
        failed = failed.or(status.failed);
    }
    (paths.state().to_vec(), failed)
}

/// The bits of numbers, any NaN being as good as another.
fn bits(row: &Row) -> [u64; WIDTH] {
    row.map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() })
}

fn check<S: Tuned<D, M>, G: Damping, const D: usize, const M: usize>(
    panel: &str,
    problem: Problem<S, G, D>,
    definition: &Definition,
    steps: &[u64],
) {
    let (system, y0) = (problem.system(), problem.y0());
    let formulas = FormulaSystem::new(definition, &y0).unwrap();
    use BuiltIn::{EulerMaruyama, Heun, Midpoint, Nv, Sexp, SexpLi, Split};
    // A system from texts names no Casimir, so that sexp-li is for constant and affine B. Compiled
    // systems turn by Cayley's map, others move by the same flows.
    let mut schemes = Vec::new();
    let turns = matches!(system.name(), "rigid-body" | "maxwell-bloch");
    let flows: &[BuiltIn] = if turns { &[] } else { &[Split, Nv] };
    for &kind in [Sexp, Midpoint, EulerMaruyama, Heun, SexpLi].iter().chain(flows) {
        match (S::scheme(kind, system, y0), kind.at_run_time(&formulas)) {
            (Ok(compiled), Ok(at_run_time)) => schemes.push((compiled, at_run_time)),
            (Err(_), Err(_)) if flows.contains(&kind) && system.name() == "lotka-volterra" => {}
            (compiled, at_run_time) => {
                let one_names_casimirs = compiled.is_ok() && system.name() == "lotka-volterra";
                assert!(kind == SexpLi && at_run_time.is_err() && one_names_casimirs);
            }
        }
    }
    for &steps in steps {
        let tau = problem.t_end() / steps as f64;
        for (compiled, at_run_time) in &schemes {
            let mut wiener = WienerRows::new(KEY, 0);
            let (mut drawn, mut noise) = (Block::<M>::zero(), StepNoise::zero(M));
            let (mut y, mut status) = (Block::splat(y0), BlockStatus::explicit());
            let mut lost = PathMask::NONE;
            let bound = Truncation::new(4).unwrap().bound(tau).unwrap();
            let bound = if compiled.about().clips_increments { bound } else { f64::INFINITY };
            for n in 0..steps {
                wiener.increments(tau.sqrt(), &mut drawn.0);
                clip(&drawn.0, bound, &mut noise.increments);
                let step = Step::new(problem.damping(), n, tau).unwrap();
                compiled.step_block(system, &step, &(&noise).into(), &mut y, &mut status);
                lost = lost.or(status.failed);
            }
            let what = format!("{panel}, {}, {steps} steps", compiled.about().id);
            let setup = (problem.damping() as &dyn Damping, &y0[..], tau);
            let order = std::array::from_fn(|p| p);
            let (found, failed) = simulate::<M>((&**at_run_time, &formulas), setup, steps, order);
            assert_eq!(failed, lost, "{what}");
            let live = PathMask::ALL.without(lost);
            // Rounding errors of a step, some ε of the size, grow along a path by a factor that is
            // e⁵ at most here, and so by much less than 1000.
            let allowed = 1000.0 * f64::EPSILON * (steps as f64).sqrt();
            for p in live.paths() {
                let size: f64 = y.path(p).iter().map(|y| y.abs()).sum();
                for i in 0..D {
                    let error = (found[i][p] - y.0[i][p]).abs() / size;
                    assert!(error <= allowed, "{what}, y{} of path {p}: {error:e}", i + 1);
                }
            }
            // A path has the same bits at any place of a block, with any neighbours, and on every
            // instruction set.
            let moved = std::array::from_fn(|p| (7 * p + 5) % WIDTH);
            let (elsewhere, _) = simulate::<M>((&**at_run_time, &formulas), setup, steps, moved);
            for (row, other) in found.iter().zip(&elsewhere) {
                assert_eq!(bits(&moved.map(|p| row[p])), bits(other), "{what}: neighbours");
            }
            for &level in Simd::BUILT {
                limit_to(level);
                let (same, _) = simulate::<M>((&**at_run_time, &formulas), setup, steps, order);
                let equal = same.iter().zip(&found).all(|(a, b)| bits(a) == bits(b));
                assert!(equal, "{what}: {}", level.name());
            }
            limit_to(Simd::Avx512);
        }
    }
}

#[test]
fn the_panels_of_the_paper_have_the_same_results() {
    let body = texts::rigid_body(paper::INERTIA, paper::NOISE_INERTIA);
    let one_noise = Definition { noises: vec!["y1^2/(2*J1)".into()], ..body.clone() };
    let energy = Definition { noises: vec![body.energy.clone()], ..body.clone() };
    // 2⁻⁴ and 2⁻⁸ of the time of strong and weak errors, and the steps of the evolutions.
    let powers = [16, 256];
    check("pendulum-strong", paper::pendulum(), &texts::pendulum(1.0), &powers);
    check("rigid-body-casimir", paper::rigid_body_three_noises(10.0), &body, &[100]);
    check("rigid-body-strong-3, weak", paper::rigid_body_three_noises(1.0), &body, &powers);
    check("rigid-body-strong-1", paper::rigid_body_one_noise(), &one_noise, &powers);
    check("rigid-body-energy", paper::rigid_body_energy(10.0), &energy, &[100]);
    let two_two = texts::lotka_volterra(1.0);
    check("lotka-volterra-energy", paper::lotka_volterra_2_2(10.0), &two_two, &[100]);
    // With p = q = 1.
    let populations = Definition {
        structure: vec![vec!["-c".into(), "c".into()], vec!["-c".into()]].into(),
        energy: "y1*y2*y3".into(),
        noises: vec!["y1*y2*y3".into()],
        ..two_two
    };
    check("lotka-volterra-strong", paper::lotka_volterra_1_1(), &populations, &powers);
    check("maxwell-bloch-casimir", paper::maxwell_bloch(5.0), &texts::maxwell_bloch(), &[500]);
    check("maxwell-bloch-strong", paper::maxwell_bloch(1.0), &texts::maxwell_bloch(), &powers);
    let poisson3 = texts::poisson3(1.0);
    check("poisson3-casimir", paper::poisson3_casimir(2.0), &poisson3, &[100]);
    check("poisson3-strong", paper::poisson3_strong(), &poisson3, &powers);
}
