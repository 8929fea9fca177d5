//! Pilot paths: where the paths of a problem go.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::WIDTH;
use schemes::{Implicit, Increment, Step, run_time::Scheme};
use serde::Serialize;
use systems::{Damping, run_time};

use super::random::{Purpose, Random};

/// Pilot paths of a problem, at whose states identities are checked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pilot {
    /// The number of paths.
    pub paths: usize,
    /// The number of states.
    pub states: usize,
    /// The time that all paths reached: less than T if a step had no solution or left the domain.
    pub until: f64,
}

const PATHS: usize = 4;
/// Steps of a path.
const STEPS: u64 = 128;
/// Every so many steps a state is kept.
const EVERY: u64 = 16;
/// Increments are clipped at this many standard deviations.
const CLIPPED: f64 = 3.0;

/// The midpoint rule between half steps of exact damping: stable where the flow is, and convergent
/// to the Stratonovich solution. Of the system it uses B and ∇h alone.
struct ConformalMidpoint;

impl Implicit for ConformalMidpoint {
    const ID: &'static str = "conformal midpoint";
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        start + h.field((start + z) * 0.5)
    }
}

/// Simulates a few paths, and keeps some of their states: paths that a step has no solution on, or
/// that leave the domain, end.
pub fn pilot_paths(
    system: &dyn run_time::System,
    damping: &dyn Damping,
    y0: &[f64],
    t_end: f64,
) -> (Pilot, Vec<Vec<f64>>) {
    let tau = t_end / STEPS as f64;
    let (mut states, mut until) = (Vec::new(), t_end);
    let pilot = |states: &[Vec<f64>], until| Pilot { paths: PATHS, states: states.len(), until };
    let Ok(mut paths) = Scheme::stepper(&ConformalMidpoint, system) else {
        return (pilot(&states, 0.0), states);
    };
    paths.state_mut().iter_mut().zip(y0).for_each(|(row, &y)| *row = [y; WIDTH]);
    let mut random = Random::new(Purpose::Paths);
    let mut noise = StepNoise::zero(system.description().noises);
    let mut live: Vec<usize> = (0..PATHS).collect();
    for n in 0..STEPS {
        for increment in noise.increments.iter_mut().flat_map(|row| &mut row[..PATHS]) {
            *increment = tau.sqrt() * random.normals.normal().clamp(-CLIPPED, CLIPPED);
        }
        let Ok(step) = Step::new(damping, n, tau) else { break };
        let mut status = BlockStatus::explicit();
        paths.step(&step, &noise, &mut status);
        let state = |p: usize| paths.state().iter().map(|row| row[p]).collect::<Vec<_>>();
        let ends =
            |p: &usize| status.failed.contains(*p) || system.check_domain(&state(*p)).is_err();
        if live.iter().any(ends) {
            until = f64::min(until, n as f64 * tau);
            live.retain(|p| !ends(p));
        }
        if (n + 1) % EVERY == 0 {
            states.extend(live.iter().map(|&p| state(p)));
        }
    }
    (pilot(&states, until), states)
}
