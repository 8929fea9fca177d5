//! An equation that solves itself is believed as far as its bound says, and not beyond.

mod common;

use common::{Equations, Numbers, SineMap, difference, residual, solve_block};
use nonlin::{FirstSweep, FixedPoint, Method, Outcome, Solver};
use real::{Real, WIDTH};

/// A contraction with a solution of its own.
#[derive(Clone, Copy, Debug)]
struct Predicted {
    map: SineMap<2>,
    found: [f64; 2],
    bound: f64,
}

impl FixedPoint<2> for Predicted {
    const METHOD: Method = Method::Newton;
    const FIRST_SWEEP: FirstSweep = FirstSweep::Predicted;
    fn start(&self) -> [f64; 2] {
        self.map.start()
    }
    #[inline(always)]
    fn map<R: Real>(&self, z: [R; 2]) -> [R; 2] {
        self.map.map(z)
    }
    #[inline(always)]
    fn predict(&self) -> ([f64; 2], f64) {
        (self.found, self.bound)
    }
}

fn map() -> SineMap<2> {
    SineMap::new(0.5, &[0.3, -0.8, 0.1, 0.9, -0.4, 0.7, 0.2])
}

/// ‖z − ψ(z)‖₁ may be 2ε‖z‖₁.
fn allowed(z: [f64; 2]) -> f64 {
    2.0 * f64::EPSILON * (z[0].abs() + z[1].abs())
}

#[test]
fn a_bound_of_round_off_is_believed() {
    let map = map();
    // Not the solution: what is believed is the bound.
    let found = [0.75, -1.25];
    for bound in [0.0, allowed(found)] {
        let solution = Solver::default().solve(&Predicted { map, found, bound });
        assert_eq!((solution.z, solution.outcome), (found, Outcome::Fast { iterations: 1 }));
    }
}

#[test]
fn beyond_it_sweeps_go_on_from_there() {
    let map = map();
    let exact = Solver::default().solve(&map).z;
    let near = exact.map(|x| x * (1.0 + 1e-11));
    for bound in [allowed(near) * (1.0 + 4.0 * f64::EPSILON), 1e-9, 1e300] {
        let solution = Solver::default().solve(&Predicted { map, found: near, bound });
        // From there one Newton step is enough; from the start it is not.
        assert_eq!(solution.outcome, Outcome::Fast { iterations: 2 }, "{bound}");
        assert!(difference(solution.z, exact) < 1e-14);
    }
    let far = Solver::new(Method::Newton).solve(&map);
    assert!(matches!(far.outcome, Outcome::Fast { iterations } if iterations > 2), "{far:?}");
}

#[test]
fn without_a_bound_they_begin_at_the_start() {
    let map = map();
    let plain = Solver::new(Method::Newton).solve(&map);
    let Outcome::Fast { iterations } = plain.outcome else { panic!("{plain:?}") };
    let exact = plain.z;
    // Neither a good candidate nor one that is no number is looked at.
    for found in [exact, [f64::NAN, 1.0], [f64::INFINITY; 2]] {
        for bound in [f64::INFINITY, f64::NAN] {
            let solution = Solver::default().solve(&Predicted { map, found, bound });
            assert_eq!(solution.z, plain.z);
            assert_eq!(solution.outcome, Outcome::Fast { iterations: 1 + iterations });
        }
    }
}

/// Says that it solves itself, and does not.
#[derive(Clone, Copy, Debug)]
struct Silent(SineMap<2>);

impl FixedPoint<2> for Silent {
    const METHOD: Method = Method::Newton;
    const FIRST_SWEEP: FirstSweep = FirstSweep::Predicted;
    fn start(&self) -> [f64; 2] {
        self.0.start()
    }
    #[inline(always)]
    fn map<R: Real>(&self, z: [R; 2]) -> [R; 2] {
        self.0.map(z)
    }
}

#[test]
fn one_that_has_no_solution_of_its_own_is_solved_all_the_same() {
    let map = map();
    let (plain, silent) =
        (Solver::new(Method::Newton).solve(&map), Solver::default().solve(&Silent(map)));
    assert_eq!(silent.z, plain.z);
}

/// A bound of zero for what is no number.
#[test]
fn an_infinity_is_no_solution() {
    let map = map();
    for found in [[f64::INFINITY, 1.0], [1.0, f64::NEG_INFINITY], [f64::NAN, 0.0]] {
        for bound in [0.0, 1e-20] {
            let solution = Solver::default().solve(&Predicted { map, found, bound });
            assert!(solution.outcome.converged());
            assert!(residual(&map, solution.z) < 1e-14, "{solution:?}");
        }
    }
}

/// Told the other method, the solver makes its sweeps from the start.
#[test]
fn another_method_does_not_ask() {
    let map = map();
    let own = Predicted { map, found: [0.75, -1.25], bound: 0.0 };
    let solution = Solver::new(Method::FixedPoint).solve(&own);
    assert!(residual(&map, solution.z) < 1e-13, "{solution:?}");
}

#[test]
fn a_block_is_its_paths() {
    let map = map();
    let exact = Solver::default().solve(&map).z;
    let mut numbers = Numbers(5);
    let paths: [Predicted; WIDTH] = std::array::from_fn(|p| {
        let off = 10f64.powi(-(p as i32)) * numbers.next();
        let bound = [0.0, 10.0 * off.abs(), f64::INFINITY, f64::NAN][p % 4];
        Predicted { map, found: [exact[0] + off, exact[1]], bound }
    });
    let (z, status) = solve_block(Solver::default(), &Equations(paths));
    for p in 0..WIDTH {
        let alone = Solver::default().solve(&paths[p]);
        assert_eq!(z.path(p), alone.z, "path {p}");
        assert_eq!(alone.outcome, Outcome::Fast { iterations: status.iterations(p) });
    }
}
