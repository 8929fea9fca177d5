//! A block is 32 paths and nothing else: same bits for every scheme, every system and every level
//! of instructions, whether a path is easy, needs the robust method or cannot be solved.

use crate::common::{Numbers, Visit, body, every_system, populations_2, schemes_of};
use crate::levy::Rotations;
use crate::own_schemes::{ConformalMidpoint, EulerWithAreas};
use kernels::Tuned;
use noise::{BlockNoise, Noise, StepNoise, StreamKey, Truncation, WienerRows, clip};
use nonlin::{BlockStatus, Method, Outcome, Solver};
use real::{Block, Simd, WIDTH, limit_to};
use schemes::{BuiltIn, Midpoint, Scheme, Sexp, SexpLevy, Step, WithSolver};
use systems::{Cosine, PoissonSystem};

const TAU: f64 = 0.05;
const STEPS: u64 = 40;
const POPULATIONS: [f64; 3] = [0.2, 0.4, 0.6];

fn bits<const D: usize>(z: [f64; D]) -> [u64; D] {
    // Sign and payload of a NaN are not specified.
    z.map(|x| if x.is_nan() { f64::NAN } else { x }.to_bits())
}

/// Drives a block and its 32 paths side by side, and counts the ways that the equations went.
struct SideBySide {
    level: Simd,
    /// [fast, robust, failed]
    ways: [u32; 3],
}

impl SideBySide {
    fn compare<S, const D: usize, const M: usize>(
        &mut self,
        scheme: &dyn Scheme<S, D, M>,
        system: &S,
        y0: [f64; D],
    ) where
        S: PoissonSystem<D, M>,
    {
        let key = StreamKey { seed: 9, experiment: 1 };
        let damping = Cosine::new(0.5, 2.0).unwrap();
        let truncation = Truncation::new(4).unwrap();
        let (bound, area_bound) =
            (truncation.bound(TAU).unwrap(), truncation.area_bound(TAU).unwrap());
        let mut numbers = Numbers(3);
        let mut wiener = WienerRows::new(key, 0);
        let mut block = Block::splat(y0);
        // A path that is no number from the start must not disturb the others.
        block.0[D - 1][13] = f64::NAN;
        let mut paths: Vec<[f64; D]> = (0..WIDTH).map(|p| block.path(p)).collect();
        let (mut dw, mut drawn) = (Block::<M>::zero(), StepNoise::with_areas(M));
        let mut status = BlockStatus::explicit();
        for n in 0..STEPS {
            let step = Step::new(&damping, n, TAU).unwrap();
            wiener.increments(TAU.sqrt(), &mut dw.0);
            clip(&dw.0, bound, &mut drawn.increments);
            // Some increments are far larger than truncation allows, so that the robust method has
            // work.
            for row in drawn.increments.iter_mut() {
                [4, 21].into_iter().for_each(|p| row[p] *= 8.0);
            }
            for p in 0..WIDTH {
                let areas = [(); M].map(|()| [(); M].map(|()| area_bound * numbers.next()));
                let increments = drawn.path(p).increments;
                drawn.set_path(p, &Noise { areas, ..Noise::increments(increments) });
            }
            let noise = BlockNoise::from(&drawn);
            scheme.step_block(system, &step, &noise, &mut block, &mut status);
            for p in 0..WIDTH {
                let single = scheme.step(system, &step, &noise.path(p), paths[p]);
                let (scheme, name) = (scheme.about().id, system.name());
                let place =
                    || format!("{scheme} of {name} at {:?}, step {n}, path {p}", self.level);
                assert_eq!(bits(single.z), bits(block.path(p)), "{}", place());
                assert_eq!(status.failed.contains(p), !single.outcome.converged(), "{}", place());
                match single.outcome {
                    Outcome::Fast { iterations } => {
                        assert_eq!(status.iterations(p), iterations, "{}", place());
                        self.ways[0] += 1;
                    }
                    Outcome::Robust { iterations, .. } => {
                        assert_eq!(status.iterations(p), iterations, "{}", place());
                        assert!(status.robust.contains(p), "{}", place());
                        self.ways[1] += 1;
                    }
                    Outcome::Failed { .. } => self.ways[2] += 1,
                }
                paths[p] = single.z;
            }
        }
    }
}

impl Visit for SideBySide {
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]) {
        use BuiltIn::{EulerMaruyama, Heun, Nv, Sexp, SexpLevy, SexpLi, SexpLiLevy, Split};
        let schemes = [Sexp, SexpLevy, SexpLi, SexpLiLevy, EulerMaruyama, Heun, Split, Nv];
        for scheme in schemes_of(&schemes, system, y0) {
            self.compare(&*scheme, system, y0);
        }
    }
}

/// One test: the limit belongs to the whole process.
#[test]
fn a_block_is_its_paths_at_every_level() {
    let mut seen = Vec::new();
    for &level in Simd::BUILT {
        limit_to(level);
        let mut side_by_side = SideBySide { level, ways: [0; 3] };
        every_system(&mut side_by_side);
        for method in [Method::FixedPoint, Method::Newton] {
            let (body, y0) = (body(), [0.6, 0.0, 0.8]);
            let solver = Solver::new(method);
            // Two systems are enough for methods that they do not prefer, and for the midpoint
            // rule, which asks of a system what `heun` asks.
            let sexp = WithSolver { formula: Sexp, solver };
            let midpoint = WithSolver { formula: Midpoint, solver };
            side_by_side.compare(&sexp, &body, y0);
            side_by_side.compare(&sexp, &populations_2(), POPULATIONS);
            side_by_side.compare(&midpoint, &body, y0);
            side_by_side.compare(&midpoint, &populations_2(), POPULATIONS);
            // Somebody else's formula goes through the same kernel.
            side_by_side.compare(&ConformalMidpoint { solver }, &body, y0);
        }
        let y0 = [0.6, 0.0, 0.8];
        // `sexp-levy` without closed forms: commutators and gradients by dual numbers. The system
        // has two noises, since a kernel for three takes five times as long to compile.
        side_by_side.compare(&SexpLevy::new(&Rotations, y0), &Rotations, y0);
        side_by_side.compare(&EulerWithAreas, &body(), y0);
        seen.push(side_by_side.ways);
    }
    let [fast, robust, failed] = seen[0];
    assert!(fast > 10_000 && robust > 100 && failed > 100, "{seen:?}");
    assert!(seen.iter().all(|ways| *ways == seen[0]), "{seen:?}");
}
