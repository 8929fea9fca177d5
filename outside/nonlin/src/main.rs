//! Kepler's equation E − e sin E = M for 32 eccentricities at once, and alone: the same bits.

use nonlin::{BlockFixedPoint, BlockStatus, FixedPoint, Method, Solver};
use real::{Block, Real, WIDTH};

const MEAN_ANOMALY: f64 = 0.8;

/// E = M + e sin E.
#[derive(Clone, Copy)]
struct Kepler {
    eccentricity: f64,
}

impl FixedPoint<1> for Kepler {
    fn start(&self) -> [f64; 1] {
        [MEAN_ANOMALY]
    }
    #[inline(always)]
    fn map<R: Real>(&self, z: [R; 1]) -> [R; 1] {
        [z[0].sin() * self.eccentricity + MEAN_ANOMALY]
    }
}

/// Orbits from a circle to nearly a parabola.
#[derive(Clone, Copy)]
struct Orbits;

impl BlockFixedPoint<1> for Orbits {
    type Path = Kepler;
    #[inline(always)]
    fn path(&self, p: usize) -> Kepler {
        Kepler { eccentricity: 0.99 * p as f64 / (WIDTH - 1) as f64 }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let solver = Solver::new(Method::Newton);
    let (mut block, mut status) = (Block::<1>::zero(), BlockStatus::explicit());
    solver.solve_block(&Orbits, &mut block, &mut status);
    let mut worst: f64 = 0.0;
    for p in 0..WIDTH {
        let orbit = Orbits.path(p);
        let alone = solver.solve(&orbit);
        let [anomaly] = block.path(p);
        if status.failed.contains(p) || alone.z != [anomaly] {
            return Err(format!("orbit {p}: {anomaly} in the block, {:?} alone", alone).into());
        }
        worst = worst.max((anomaly - orbit.eccentricity * anomaly.sin() - MEAN_ANOMALY).abs());
    }
    let most = (0..WIDTH).map(|p| status.iterations(p)).max().unwrap_or(0);
    println!("{WIDTH} orbits, at most {most} iterations, largest residual {worst:.1e}");
    if worst > 4.0 * f64::EPSILON {
        return Err(format!("a residual of {worst:e} is no solution").into());
    }
    Ok(())
}
