//! Compositions of flows for systems known at run time.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows};
use systems::{
    TRIPLE_JUMP,
    run_time::{Description, Lanes, Move, Parts, Program, System, Weights},
};

use super::{Scheme, SchemeError};
use crate::{Nv, Split, Step, Stepper, nv::Sweep};

/// The parts of a system.
fn parts<'a>(scheme: &str, system: &'a dyn System) -> Result<&'a Parts, SchemeError> {
    let Description { name, parts, .. } = system.description();
    parts.as_ref().map_err(|reason| SchemeError::parts(scheme, name, reason))
}

/// The flows of all parts: φ₀(½) ⋯ φ_{P−1}(½) φ_P(1) φ_{P−1}(½) ⋯ φ₀(½).
fn symmetric(
    parts: usize,
    [drift, noise]: [f64; 2],
    only: Option<usize>,
) -> impl Iterator<Item = Move> {
    let last = parts - 1;
    (0..=last).chain((0..last).rev()).map(move |part| {
        let share = if part < last { 0.5 } else { 1.0 };
        Move::Flow { part, drift: share * drift, noise: share * noise, only }
    })
}

impl Scheme for Split {
    fn id(&self) -> &'static str {
        "split"
    }

    fn clips_increments(&self) -> bool {
        false
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let number = parts("split", system)?.number;
        let flows = symmetric(number, [1.0, 1.0], None);
        let moves = [Move::Scale(0)].into_iter().chain(flows).chain([Move::Scale(1)]);
        Ok(Box::new(CompositionStepper::new(system, vec![moves.collect()])))
    }
}

impl Scheme for Nv {
    fn id(&self) -> &'static str {
        "nv"
    }

    fn clips_increments(&self) -> bool {
        false
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let Parts { number, of_noise, .. } = parts("nv", system)?;
        let Description { name, noises, .. } = system.description();
        if of_noise.len() < *noises {
            let reason = "the flow of each Hamiltonian is not known";
            return Err(SchemeError::parts("nv", name, reason));
        }
        let noise = |m: usize| match of_noise[m] {
            Some(part) => vec![Move::Flow { part, drift: 0.0, noise: 1.0, only: Some(m) }],
            None => TRIPLE_JUMP
                .iter()
                .flat_map(|&share| symmetric(*number, [0.0, share], Some(m)))
                .collect(),
        };
        let half = || symmetric(*number, [0.5, 0.0], None);
        let moves = |order: Vec<usize>| -> Vec<Move> {
            let noises = order.into_iter().flat_map(noise);
            let inner = [Move::Scale(0)].into_iter().chain(noises).chain([Move::Scale(1)]);
            half().chain(inner).chain(half()).collect()
        };
        let (forward, backward) =
            (moves((0..*noises).collect()), moves((0..*noises).rev().collect()));
        Ok(Box::new(CompositionStepper::new(
            system,
            match self.sweep {
                Sweep::Alternating => vec![forward, backward],
                Sweep::Forward => vec![forward],
                Sweep::Backward => vec![backward],
            },
        )))
    }
}

/// Moves in turn.
struct CompositionStepper<'a> {
    system: &'a dyn System,
    /// Moves of a step, as one program if the system has it; steps take them in turn.
    steps: Vec<(Vec<Move>, Option<Box<dyn Program>>)>,
    state: Rows,
    next: Rows,
    dw: Rows,
    scratch: Rows,
}

impl<'a> CompositionStepper<'a> {
    fn new(system: &'a dyn System, steps: Vec<Vec<Move>>) -> Self {
        let description = system.description();
        let layout = description.layout;
        let steps: Vec<_> = steps
            .into_iter()
            .map(|moves| {
                let program = system.compose(&moves);
                (moves, program)
            })
            .collect();
        let is_compiled = steps.iter().all(|(_, program)| program.is_some());
        let [compiled, each] =
            [is_compiled, !is_compiled].map(|is| move |n| if is { n } else { 0 });
        Self {
            system,
            steps,
            state: Rows::zero(layout.rows),
            next: Rows::zero(compiled(layout.rows)),
            dw: Rows::zero(each(layout.noise_rows)),
            scratch: Rows::zero(each(description.scratch_rows())),
        }
    }
}

impl Stepper for CompositionStepper<'_> {
    fn state(&self) -> &[Row] {
        &self.state
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.state
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        *status = BlockStatus::explicit();
        let Self { system, steps, state, next, dw, scratch } = self;
        let which = step.number() as usize % steps.len();
        let (moves, program) = &mut steps[which];
        let factors = [step.first_decay, step.second_decay];
        let t = step.t + 0.5 * step.tau;
        if let Some(program) = program {
            let h = Weights { t, dt: step.tau, dw: &noise.increments, ..Weights::NONE };
            program.run(&[state], &factors, h, next);
            std::mem::swap(state, next);
        } else {
            let mut shares = (f64::NAN, None);
            for one in moves {
                match *one {
                    Move::Scale(k) => {
                        state.iter_mut().flatten().for_each(|y| *y *= factors[k]);
                    }
                    Move::Flow { part, drift, noise: share, only } => {
                        if shares != (share, only) {
                            shares = (share, only);
                            for (m, (to, from)) in dw.iter_mut().zip(&*noise.increments).enumerate()
                            {
                                let share =
                                    if only.is_none_or(|only| only == m) { share } else { 0.0 };
                                to.iter_mut().zip(from).for_each(|(to, dw)| *to = share * dw);
                            }
                        }
                        let h = Weights { t, dt: drift * step.tau, dw, ..Weights::NONE };
                        system.flow(part, state, h, scratch);
                    }
                }
            }
        }
        if system.description().layout.lanes == Lanes::Paths {
            status.fail_where_not_finite(state);
        }
    }
}
