//! A block is 32 equations and nothing else: the same bits alone, at every level, and beside any
//! neighbours.

use crate::common::{Equations, Numbers, PrefersNewton, SineMap, solve_block};
use crate::predicted::{Predicted, map};
use nonlin::{FixedPoint, Method, Outcome, Solver};
use real::{Simd, WIDTH, limit_to};

const METHODS: [Method; 2] = [Method::FixedPoint, Method::Newton];

/// Easy, slow and non-contracting maps, some that start at NaN or infinity: every way a path can
/// go.
fn mixed<const D: usize>(seed: u64) -> Equations<SineMap<D>> {
    let mut numbers = Numbers(seed);
    Equations(std::array::from_fn(|p| {
        let contraction = [0.02, 0.3, 0.97, 4.0][p % 4] * (1.5 + 0.5 * numbers.next());
        let mut map = SineMap::new(contraction, &numbers.take(24));
        map.start[0] = match p {
            13 => f64::NAN,
            22 => f64::INFINITY,
            _ => map.start[0],
        };
        if p == 5 {
            map.constant[0] = f64::NAN;
        }
        map
    }))
}

fn bits<const D: usize>(z: [f64; D]) -> [u64; D] {
    // Sign and payload of a NaN are not specified.
    z.map(|x| if x.is_nan() { f64::NAN } else { x }.to_bits())
}

/// Adds to the counts [fast, robust, failed].
fn compare<E: FixedPoint<D>, const D: usize>(
    solver: Solver,
    equations: &Equations<E>,
    seen: &mut [u32; 3],
) {
    let (z, status) = solve_block(solver, equations);
    for p in 0..WIDTH {
        let single = solver.solve(&equations.0[p]);
        assert_eq!(bits(single.z), bits(z.path(p)), "{:?} path {p}", solver.method);
        let (way, iterations, residual) = match single.outcome {
            Outcome::Fast { iterations } => (0, iterations, 0.0),
            Outcome::Robust { iterations, residual } => (1, iterations, residual),
            Outcome::Failed { residual } => (2, 0, residual),
        };
        assert_eq!((status.robust.contains(p), status.failed.contains(p)), (way == 1, way == 2));
        assert_eq!(status.iterations(p), iterations);
        assert_eq!(bits([residual]), bits([status.residual(p)]));
        seen[way] += 1;
    }
}

/// [fast, robust, failed] counts.
fn block_is_its_paths<const D: usize>() -> [u32; 3] {
    let mut seen = [0; 3];
    for seed in 1..=20 {
        let equations = mixed::<D>(seed);
        for method in METHODS {
            compare(Solver::new(method), &equations, &mut seen);
        }
        compare(Solver::default(), &Equations(equations.0.map(PrefersNewton)), &mut seen);
    }
    seen
}

/// One test: the limit belongs to the whole process.
#[test]
fn a_block_is_its_paths_at_every_level() {
    for &level in Simd::BUILT {
        limit_to(level);
        for seen in
            [block_is_its_paths::<1>(), block_is_its_paths::<2>(), block_is_its_paths::<3>()]
        {
            // All three ways were gone, so all three were compared.
            assert!(seen.iter().all(|&count| count >= 100), "{seen:?}");
        }
    }
}

#[test]
fn few_sweeps_are_the_same_sweeps_in_a_block() {
    let equations = mixed::<2>(5);
    for max_sweeps in 0..6 {
        for method in METHODS {
            let solver = Solver { method: Some(method), max_sweeps, settle: max_sweeps % 2 == 0 };
            compare(solver, &equations, &mut [0; 3]);
        }
        let solver = Solver { max_sweeps, ..Solver::default() }.settled();
        compare(solver, &Equations(equations.0.map(PrefersNewton)), &mut [0; 3]);
    }
}

/// Good, bad and absent predictions.
#[test]
fn predictions_are_the_same_in_a_block() {
    let (map, mut numbers) = (map(), Numbers(5));
    let exact = Solver::default().solve(&map).z;
    let paths = std::array::from_fn(|p| {
        let off = 10f64.powi(-(p as i32)) * numbers.next();
        let bound = [0.0, 10.0 * off.abs(), f64::INFINITY, f64::NAN][p % 4];
        Predicted { map, prediction: [exact[0] + off, exact[1]], bound }
    });
    let mut seen = [0; 3];
    compare(Solver::default(), &Equations(paths), &mut seen);
    assert_eq!(seen[0], WIDTH as u32);
}
