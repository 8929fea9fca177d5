//! Compositions of flows for systems known at run time.

use std::sync::Arc;

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, elementary::exp};
use systems::{
    Damping,
    probe::TRIPLE_JUMP,
    run_time::{Description, Lanes, Move, Op, Parts, Program, System, Weights, palindrome},
};

use super::{Scheme, SchemeError};
use crate::{About, Baoab, Nv, Sexp, Split, SplitH, Step, Stepper, Sweep};

/// The parts of a system.
fn parts<'a>(scheme: &str, system: &'a dyn System) -> Result<&'a Parts, SchemeError> {
    let Description { name, parts, .. } = system.description();
    parts.as_ref().map_err(|reason| SchemeError::parts(scheme, name, reason))
}

impl Scheme for Split {
    fn about(&self) -> About {
        About::new("split")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let number = parts("split", system)?.number;
        let flows = palindrome(number, [1.0, 1.0, 0.0], None);
        let moves = [Move::Scale(0)].into_iter().chain(flows).chain([Move::Scale(1)]);
        Ok(Box::new(CompositionStepper::new(system, vec![moves.collect()], &[])?))
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

/// The flow of noise m for shares of its increment and its space-time area.
fn noise(parts: &Parts, m: usize, [increment, area]: [f64; 2]) -> Vec<Move> {
    let only = Some(m);
    let all = |share: &f64| palindrome(parts.number, [0.0, share * increment, share * area], only);
    match parts.of_noise[m] {
        Some(part) => vec![Move::Flow { part, drift: 0.0, noise: increment, area, only }],
        None => TRIPLE_JUMP.iter().flat_map(all).collect(),
    }
}

impl Scheme for Nv {
    fn about(&self) -> About {
        About::new("nv")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let parts = parts_by_noise("nv", system)?;
        let noises = system.description().noises;
        let half = || palindrome(parts.number, [0.5, 0.0, 0.0], None);
        let moves = |order: Vec<usize>| -> Vec<Move> {
            let noises = order.into_iter().flat_map(|m| noise(parts, m, [1.0, 0.0]));
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
            &[],
        )?))
    }
}

/// Friction on components, with its rates.
pub type Frictions = [(Arc<dyn Damping>, Vec<usize>)];

/// All damping of a half of the step, 0 or 1.
fn damp(friction: &Frictions, half: usize) -> impl Iterator<Item = Move> {
    let of = |(k, (_, components)): (usize, &(Arc<dyn Damping>, Vec<usize>))| {
        let factor = 2 + 2 * k + half;
        components.iter().map(|&component| Move::ScaleOne { component, factor }).collect::<Vec<_>>()
    };
    let friction: Vec<Move> = friction.iter().enumerate().flat_map(of).collect();
    [Move::Scale(half)].into_iter().chain(friction)
}

/// The flows of H₀ for a share of the step, in their order or from the last to the first.
fn drift(parts: &Parts, share: f64, backward: bool) -> impl Iterator<Item = Move> {
    let number = parts.number;
    (0..number).map(move |k| Move::Flow {
        part: if backward { number - 1 - k } else { k },
        drift: share,
        noise: 0.0,
        area: 0.0,
        only: None,
    })
}

/// The parts of a system whose noises commute.
fn commuting<'a>(scheme: &str, system: &'a dyn System) -> Result<&'a Parts, SchemeError> {
    let parts = parts_by_noise(scheme, system)?;
    let Description { name, noises_commute, .. } = system.description();
    match noises_commute {
        true => Ok(parts),
        false => {
            let reason = "its noises do not commute; take nv";
            Err(SchemeError::parts(scheme, name, reason))
        }
    }
}

impl Scheme for Baoab {
    fn about(&self) -> About {
        About::new("baoab")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let parts = commuting("baoab", system)?;
        let noises = system.description().noises;
        let kicks = (0..noises).flat_map(|m| noise(parts, m, [1.0, 0.0]));
        let own: Option<Vec<_>> = (0..noises).map(|m| self.frictions_of(system, m)).collect();
        // Noises that are made exact come after friction, others in its middle.
        let [first, second] = [0, 1].map(|half| damp(&self.friction, half));
        let moves: Vec<Move> = drift(parts, 0.5, true).chain(first).collect();
        let moves = match own {
            Some(_) => moves.into_iter().chain(second).chain(kicks).collect::<Vec<_>>(),
            None => moves.into_iter().chain(kicks).chain(second).collect(),
        };
        let moves = moves.into_iter().chain(drift(parts, 0.5, false)).collect();
        let mut stepper = CompositionStepper::new(system, vec![moves], &self.friction)?;
        stepper.own = own.unwrap_or_default();
        Ok(Box::new(stepper))
    }
}

impl Scheme for SplitH {
    fn about(&self) -> About {
        About { reads_space_time: true, ..About::new("split-h") }
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let parts = commuting("split-h", system)?;
        if system.description().depends_on_time {
            let reason = "Hamiltonians depend on time, which costs it its order; take nv";
            return Err(SchemeError::parts("split-h", &system.description().name, reason));
        }
        let noises = system.description().noises;
        let kicks =
            |increment, area| (0..noises).flat_map(move |m| noise(parts, m, [increment, area]));
        let damp = |half| damp(&self.friction, half);
        // A symmetric step of H₀ and damping over a half of the step, or over all of it.
        let over = |half: usize| {
            drift(parts, 0.25, false).chain(damp(half)).chain(drift(parts, 0.25, true))
        };
        let delta = self.delta;
        let moves: Vec<Move> = match delta == 0.0 {
            true => kicks(0.5, 1.0)
                .chain(drift(parts, 0.5, false))
                .chain(damp(0))
                .chain(damp(1))
                .chain(drift(parts, 0.5, true))
                .chain(kicks(0.5, -1.0))
                .collect(),
            false => kicks(0.5 - delta, 1.0)
                .chain(over(0))
                .chain(kicks(2.0 * delta, 0.0))
                .chain(over(1))
                .chain(kicks(0.5 - delta, -1.0))
                .collect(),
        };
        Ok(Box::new(CompositionStepper::new(system, vec![moves], &self.friction)?))
    }
}

/// States and times at which a noise is looked at.
const POINTS: [f64; 2] = [0.3, 0.9];
const TIMES: [f64; 3] = [0.0, 0.618, 2.236];

impl Baoab {
    /// The frictions of all components that a constant noise moves; none if these differ, or if the
    /// noise depends on the state.
    fn frictions_of(&self, system: &dyn System, m: usize) -> Option<Vec<usize>> {
        let description = system.description();
        if description.layout.local_noise {
            return None;
        }
        let mut scratch = Rows::zero(description.scratch_rows());
        let [mut dw, mut slope] =
            [description.layout.noise_rows, description.dimension].map(Rows::zero);
        dw[m] = [1.0; real::WIDTH];
        let mut field = |t: f64, size: f64| {
            let d = description.dimension;
            let h = Weights { t, dw: &dw, ..Weights::NONE };
            let y: Vec<f64> = (0..d).map(|i| size + 0.1 * i as f64).collect();
            let (y, mut field) = (Rows::splat(&y), Rows::zero(d));
            system.apply(Op::Gradient { y: &y }, 0..d, h, &mut slope, &mut scratch);
            let op = Op::Structure::<&[Row]> { y: &y, v: &slope };
            system.apply(op, 0..d, Weights::NONE, &mut field, &mut scratch);
            field.iter().map(|row| row[0]).collect::<Vec<_>>()
        };
        let mut moved = Vec::new();
        for t in TIMES {
            let [first, second] = POINTS.map(|size| field(t, size));
            if first != second {
                return None;
            }
            moved.extend((0..first.len()).filter(|&i| first[i] != 0.0));
        }
        let mut all = Vec::new();
        for (k, (_, components)) in self.friction.iter().enumerate() {
            match moved.iter().filter(|i| components.contains(i)).count() {
                0 => {}
                count if count == moved.len() => all.push(k),
                _ => return None,
            }
        }
        Some(all)
    }
}

/// √((1 − e^{−2Γ})/2Γ): what makes the noise after friction with the integral Γ exact.
fn exact(integral: f64) -> f64 {
    let mean = match integral.abs() < 1e-4 {
        true => 1.0 - integral + integral * integral * (2.0 / 3.0),
        false => (1.0 - exp(-2.0 * integral)) / (2.0 * integral),
    };
    mean.sqrt()
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
    friction: &'a Frictions,
    /// The factors of damping over both halves, and of each friction.
    factors: Vec<f64>,
    /// The frictions of what each noise moves, after which it is made exact; empty where noises are
    /// taken as they are.
    own: Vec<Vec<usize>>,
    /// Integrals of friction over the step.
    integrals: Vec<f64>,
    /// Whether a move reads space-time areas.
    reads_space_time: bool,
    /// Increments, and space-time areas after them, as programs read them.
    rows: Vec<Row>,
}

/// Moves of a step that are done at once.
enum Piece {
    /// Flows of which the system has made a program.
    Program(Box<dyn Program>),
    /// One move.
    Move(Move),
}

impl<'a> CompositionStepper<'a> {
    fn new(
        system: &'a dyn System,
        steps: Vec<Vec<Move>>,
        friction: &'a Frictions,
    ) -> Result<Self, SchemeError> {
        let description = system.description();
        let rest = system.rest().map(|rest| Scheme::stepper(&Sexp, rest)).transpose()?;
        let last = description.parts.as_ref().map_or(0, |parts| parts.number - 1);
        let is_rest =
            |one: &Move| rest.is_some() && matches!(one, Move::Flow { part, .. } if *part == last);
        let pieces = |moves: &[Move]| match system.compose(moves) {
            Some(program) => vec![Piece::Program(program)],
            None => moves.iter().copied().map(Piece::Move).collect(),
        };
        let reads = |one: &Move| matches!(one, Move::Flow { area, .. } if *area != 0.0);
        let reads_space_time = steps.iter().flatten().any(reads);
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
            friction,
            factors: vec![1.0; 2 + 2 * friction.len()],
            own: Vec::new(),
            integrals: vec![0.0; friction.len()],
            reads_space_time,
            rows: Vec::new(),
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
        let Self { system, steps, rest, state, next, part: part_of_noise, scratch, rows, .. } =
            self;
        let number = step.number() as usize % steps.len();
        let factors = &mut self.factors;
        (factors[0], factors[1]) = (step.first_decay, step.second_decay);
        for (halves, (damping, _)) in factors[2..].chunks_mut(2).zip(self.friction) {
            (halves[0], halves[1]) = (step.decay(&**damping, 0), step.decay(&**damping, 1));
        }
        if self.reads_space_time || !self.own.is_empty() {
            rows.clear();
            rows.extend_from_slice(&noise.increments);
            if !self.own.is_empty() {
                for (integral, (damping, _)) in self.integrals.iter_mut().zip(self.friction) {
                    *integral = damping.integral(step.t, step.t + step.tau);
                }
            }
            for (row, own) in rows.iter_mut().zip(&self.own) {
                let friction: f64 = own.iter().map(|&k| self.integrals[k]).sum();
                let factor = exact(step.damping_integral() + friction);
                row.iter_mut().for_each(|dw| *dw *= factor);
            }
            if self.reads_space_time {
                rows.extend_from_slice(&noise.space_time);
            }
        }
        let all: &[Row] = if rows.is_empty() { &noise.increments } else { rows };
        let (increments, areas) = all.split_at(noise.increments.len());
        let rows_are_plain = all.len() == noise.increments.len() && self.own.is_empty();
        let t = step.t + 0.5 * step.tau;
        let mut shares = (f64::NAN, 0.0, None);
        for piece in &mut steps[number] {
            match piece {
                Piece::Program(program) => {
                    let h = Weights { t, dt: step.tau, dw: all, ..Weights::NONE };
                    program.run(&[state], factors, h, next);
                    std::mem::swap(state, next);
                }
                Piece::Move(Move::Scale(k)) => {
                    state.iter_mut().flatten().for_each(|y| *y *= factors[*k]);
                }
                Piece::Move(Move::ScaleOne { component, factor }) => {
                    state[*component].iter_mut().for_each(|y| *y *= factors[*factor]);
                }
                Piece::Move(Move::Flow { part, drift, noise: share, area, only }) => {
                    let is_whole = (*share, *area, *only) == (1.0, 0.0, None) && rows_are_plain;
                    if !is_whole && shares != (*share, *area, *only) {
                        shares = (*share, *area, *only);
                        for (m, row) in part_of_noise.increments.iter_mut().enumerate() {
                            let moves = only.is_none_or(|only| only == m);
                            let [share, area] = if moves { [*share, *area] } else { [0.0; 2] };
                            let all = row.iter_mut().zip(&increments[m]);
                            all.for_each(|(to, dw)| *to = share * dw);
                            if area != 0.0 {
                                let all = row.iter_mut().zip(&areas[m]);
                                all.for_each(|(to, h)| *to += area * h);
                            }
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
