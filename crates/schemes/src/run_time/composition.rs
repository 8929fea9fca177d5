//! Compositions of flows for systems known at run time.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows};
use systems::{
    probe::TRIPLE_JUMP,
    run_time::{Description, Lanes, Move, Parts, Program, System, Weights},
};

use super::{Scheme, SchemeError};
use crate::{About, Nv, Sexp, Split, Step, Stepper, Sweep};

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
    fn about(&self) -> About {
        About::new("split")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let number = parts("split", system)?.number;
        let flows = symmetric(number, [1.0, 1.0], None);
        let moves = [Move::Scale(0)].into_iter().chain(flows).chain([Move::Scale(1)]);
        Ok(Box::new(CompositionStepper::new(system, vec![moves.collect()])?))
    }
}

impl Scheme for Nv {
    fn about(&self) -> About {
        About::new("nv")
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
        )?))
    }
}

/// Moves in turn.
struct CompositionStepper<'a> {
    system: &'a dyn System,
    /// The pieces of a step; steps take them in turn.
    steps: Vec<Vec<Piece>>,
    /// The part without a flow.
    rest: Option<Box<dyn Stepper + 'a>>,
    state: Rows,
    /// The result of a program; empty where there is none.
    next: Rows,
    /// A share of the noise.
    part: StepNoise,
    scratch: Rows,
}

/// Moves of a step that are done at once.
enum Piece {
    /// Flows of which the system has made a program.
    Program(Box<dyn Program>),
    /// One move.
    Move(Move),
}

impl<'a> CompositionStepper<'a> {
    fn new(system: &'a dyn System, steps: Vec<Vec<Move>>) -> Result<Self, SchemeError> {
        let description = system.description();
        let rest = system.rest().map(|rest| Scheme::stepper(&Sexp, rest)).transpose()?;
        let last = description.parts.as_ref().map_or(0, |parts| parts.number - 1);
        let is_rest =
            |one: &Move| rest.is_some() && matches!(one, Move::Flow { part, .. } if *part == last);
        let pieces = |moves: &[Move]| match system.compose(moves) {
            Some(program) => vec![Piece::Program(program)],
            None => moves.iter().copied().map(Piece::Move).collect(),
        };
        let step = |moves: Vec<Move>| -> Vec<Piece> {
            let runs = moves.chunk_by(|one, next| !is_rest(one) && !is_rest(next));
            runs.flat_map(|run| match run {
                [one] if is_rest(one) => vec![Piece::Move(*one)],
                run => pieces(run),
            })
            .collect()
        };
        let steps: Vec<_> = steps.into_iter().map(step).collect();
        let is_program = |piece: &Piece| matches!(piece, Piece::Program(_));
        let next = if steps.iter().flatten().any(is_program) { description.layout.rows } else { 0 };
        Ok(Self {
            system,
            steps,
            rest,
            state: Rows::zero(description.layout.rows),
            next: Rows::zero(next),
            part: StepNoise::zero(description.layout.noise_rows),
            scratch: Rows::zero(description.scratch_rows()),
        })
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
        let Self { system, steps, rest, state, next, part: part_of_noise, scratch } = self;
        let number = step.number() as usize % steps.len();
        let factors = [step.first_decay, step.second_decay];
        let t = step.t + 0.5 * step.tau;
        let mut shares = (f64::NAN, None);
        for piece in &mut steps[number] {
            match piece {
                Piece::Program(program) => {
                    let h = Weights { t, dt: step.tau, dw: &noise.increments, ..Weights::NONE };
                    program.run(&[state], &factors, h, next);
                    std::mem::swap(state, next);
                }
                Piece::Move(Move::Scale(k)) => {
                    state.iter_mut().flatten().for_each(|y| *y *= factors[*k]);
                }
                Piece::Move(Move::Flow { part, drift, noise: share, only }) => {
                    let is_whole = (*share, *only) == (1.0, None);
                    if !is_whole && shares != (*share, *only) {
                        shares = (*share, *only);
                        for (m, row) in part_of_noise.increments.iter_mut().enumerate() {
                            let share =
                                if only.is_none_or(|only| only == m) { *share } else { 0.0 };
                            let all = row.iter_mut().zip(&noise.increments[m]);
                            all.for_each(|(to, dw)| *to = share * dw);
                        }
                    }
                    let dw = if is_whole { noise } else { &*part_of_noise };
                    let dt = *drift * step.tau;
                    match rest {
                        Some(rest) => {
                            rest.state_mut().copy_from_slice(state);
                            rest.step(&step.undamped(dt), dw, status);
                            state.copy_from_slice(rest.state());
                            // Stays so until the end of the step.
                            status.failed.paths().for_each(|p| state[0][p] = f64::NAN);
                        }
                        None => {
                            let h = Weights { t, dt, dw: &dw.increments, ..Weights::NONE };
                            system.flow(*part, state, h, scratch);
                        }
                    }
                }
            }
        }
        if system.description().layout.lanes == Lanes::Paths {
            status.fail_where_not_finite(state);
        }
    }
}
