//! Compositions of flows for systems known at run time.

use std::sync::Arc;

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, elementary::ln};
use systems::{
    Damping,
    probe::TRIPLE_JUMP,
    run_time::{Description, Lanes, Move, Op, Parts, Program, System, Weights},
};

use super::{Scheme, SchemeError};
use crate::{About, Baoab, Nv, Sexp, Split, Step, Stepper, Sweep};

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

/// The parts of a system in which each noise has a flow of its own.
fn parts_by_noise<'a>(scheme: &str, system: &'a dyn System) -> Result<&'a Parts, SchemeError> {
    let parts = parts(scheme, system)?;
    let Description { name, noises, .. } = system.description();
    match parts.of_noise.len() < *noises {
        true => {
            let reason = "the flow of each Hamiltonian is not known";
            Err(SchemeError::parts(scheme, name, reason))
        }
        false => Ok(parts),
    }
}

/// The flow of noise m.
fn noise(parts: &Parts, m: usize) -> Vec<Move> {
    match parts.of_noise[m] {
        Some(part) => vec![Move::Flow { part, drift: 0.0, noise: 1.0, only: Some(m) }],
        None => TRIPLE_JUMP
            .iter()
            .flat_map(|&share| symmetric(parts.number, [0.0, share], Some(m)))
            .collect(),
    }
}

impl Scheme for Nv {
    fn about(&self) -> About {
        About::new("nv")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let parts = parts_by_noise("nv", system)?;
        let noises = system.description().noises;
        let half = || symmetric(parts.number, [0.5, 0.0], None);
        let moves = |order: Vec<usize>| -> Vec<Move> {
            let noises = order.into_iter().flat_map(|m| noise(parts, m));
            let inner = [Move::Scale(0)].into_iter().chain(noises).chain([Move::Scale(1)]);
            half().chain(inner).chain(half()).collect()
        };
        let (forward, backward) =
            (moves((0..noises).collect()), moves((0..noises).rev().collect()));
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

impl Scheme for Baoab {
    fn about(&self) -> About {
        About::new("baoab")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let parts = parts_by_noise("baoab", system)?;
        let description = system.description();
        if !description.noises_commute {
            let reason = "its noises do not commute; take nv";
            return Err(SchemeError::parts("baoab", &description.name, reason));
        }
        let half = |part| Move::Flow { part, drift: 0.5, noise: 0.0, only: None };
        let before = (0..parts.number).rev().map(half).collect();
        let after = (0..parts.number).map(half).collect();
        let middle = (0..description.noises).flat_map(|m| noise(parts, m)).collect();
        let stepper = |moves| CompositionStepper::new(system, vec![moves]);
        let own = (0..description.noises).map(|m| self.friction_of(system, m));
        Ok(Box::new(BaoabStepper {
            friction: &self.friction,
            own: own.collect(),
            noise: StepNoise::zero(description.layout.noise_rows),
            halves: vec![[1.0; 2]; self.friction.len()],
            pieces: [stepper(before)?, stepper(middle)?, stepper(after)?],
        }))
    }
}

/// States at which a noise is looked at.
const POINTS: [f64; 2] = [0.3, 0.9];

impl Baoab {
    /// The friction of the components that a constant noise moves; none if these have several, or
    /// if the noise depends on the state.
    fn friction_of(&self, system: &dyn System, m: usize) -> Option<usize> {
        let description = system.description();
        if self.friction.is_empty() || description.layout.local_noise {
            return None;
        }
        let mut scratch = Rows::zero(description.scratch_rows());
        let [mut dw, mut slope] =
            [description.layout.noise_rows, description.dimension].map(Rows::zero);
        dw[m] = [1.0; real::WIDTH];
        let h = Weights { dw: &dw, ..Weights::NONE };
        let mut field = |size: f64| {
            let d = description.dimension;
            let y: Vec<f64> = (0..d).map(|i| size + 0.1 * i as f64).collect();
            let (y, mut field) = (Rows::splat(&y), Rows::zero(d));
            system.apply(Op::Gradient { y: &y }, 0..d, h, &mut slope, &mut scratch);
            let op = Op::Structure::<&[Row]> { y: &y, v: &slope };
            system.apply(op, 0..d, Weights::NONE, &mut field, &mut scratch);
            field.iter().map(|row| row[0]).collect::<Vec<_>>()
        };
        let [first, second] = POINTS.map(&mut field);
        let moved: Vec<usize> = (0..first.len()).filter(|&i| first[i] != 0.0).collect();
        let of = |all: &Vec<usize>| moved.iter().all(|i| all.contains(i));
        let one = self.friction.iter().position(|(_, all)| of(all));
        one.filter(|_| first == second)
    }
}

/// Halves of the flows of H₀ around friction and noise.
struct BaoabStepper<'a> {
    friction: &'a [(Arc<dyn Damping>, Vec<usize>)],
    /// The friction of what each noise moves, if it is one.
    own: Vec<Option<usize>>,
    noise: StepNoise,
    /// Factors of friction over the halves of a step.
    halves: Vec<[f64; 2]>,
    /// Before, noise, and after.
    pieces: [CompositionStepper<'a>; 3],
}

/// √((1 − e^{−2Γ})/2Γ)/d₂ with e^{−Γ} = d₁d₂: what makes the noise between two halves of friction
/// exact.
fn exact([first, second]: [f64; 2]) -> f64 {
    let decay = first * second;
    let integral = -ln(decay);
    let mean = match integral.abs() < 1e-4 {
        true => 1.0 - integral + integral * integral * (2.0 / 3.0),
        false => (1.0 - decay * decay) / (2.0 * integral),
    };
    mean.sqrt() / second
}

impl Stepper for BaoabStepper<'_> {
    fn state(&self) -> &[Row] {
        self.pieces[2].state()
    }

    fn state_mut(&mut self) -> &mut [Row] {
        self.pieces[2].state_mut()
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let Self { friction, own, noise: scaled, halves, pieces: [before, middle, after] } = self;
        let all = [step.first_decay, step.second_decay];
        for (halves, (damping, _)) in halves.iter_mut().zip(*friction) {
            *halves = [0, 1].map(|k| step.decay(&**damping, k));
        }
        before.state.copy_from_slice(&after.state);
        before.step(step, noise, status);
        let mut failed = status.failed;
        let damp = |state: &mut Rows, k: usize| {
            state.iter_mut().flatten().for_each(|y| *y *= all[k]);
            for ((_, components), halves) in friction.iter().zip(&*halves) {
                let rows = components.iter().copied();
                rows.for_each(|i| state[i].iter_mut().for_each(|y| *y *= halves[k]));
            }
        };
        middle.state.copy_from_slice(&before.state);
        damp(&mut middle.state, 0);
        for ((row, dw), own) in scaled.increments.iter_mut().zip(&*noise.increments).zip(own) {
            let factor = own.map_or(1.0, |k| exact([0, 1].map(|half| all[half] * halves[k][half])));
            row.iter_mut().zip(dw).for_each(|(row, dw)| *row = factor * dw);
        }
        middle.step(step, scaled, status);
        failed = failed.or(status.failed);
        damp(&mut middle.state, 1);
        after.state.copy_from_slice(&middle.state);
        after.step(step, noise, status);
        status.failed = status.failed.or(failed);
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
