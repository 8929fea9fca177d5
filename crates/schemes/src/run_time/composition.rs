//! Compositions of flows for systems known at run time.

use std::sync::Arc;

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, elementary::exp};
use systems::{
    Damping,
    probe::TRIPLE_JUMP,
    run_time::{Description, Lanes, Move, Parts, Program, System, Weights, palindrome},
};

use super::{Scheme, SchemeError};
use crate::{
    About, Baoab, Listing, Nv, Sexp, SexpH, Split, SplitH, Step, Stepper, Sweep,
    built_in::DO_NOT_COMMUTE,
};

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

/// The flow of noise m for shares of its increment and its space-time area. Where it is not known,
/// symmetric steps `of` shares make it up.
fn noise_by<I: IntoIterator<Item = Move>>(
    part: Option<usize>,
    m: usize,
    [increment, area]: [f64; 2],
    of: impl Fn([f64; 2]) -> I,
) -> Vec<Move> {
    match part {
        Some(part) => vec![Move::Flow { part, drift: 0.0, noise: increment, area, only: Some(m) }],
        None => TRIPLE_JUMP.iter().flat_map(|c| of([c * increment, c * area])).collect(),
    }
}

/// [`noise_by`] the flows of all parts.
fn noise(parts: &Parts, m: usize, shares: [f64; 2]) -> Vec<Move> {
    let all = |[increment, area]: [f64; 2]| {
        palindrome(parts.number, [0.0, increment, area], Some(m)).collect::<Vec<_>>()
    };
    noise_by(parts.of_noise[m], m, shares, all)
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

/// Refuses noises that do not commute.
fn commuting(scheme: &str, system: &dyn System) -> Result<(), SchemeError> {
    let Description { name, noises_commute, .. } = system.description();
    match noises_commute {
        true => Ok(()),
        false => Err(SchemeError::not_for(scheme, name, DO_NOT_COMMUTE)),
    }
}

impl Scheme for Baoab {
    fn about(&self) -> About {
        About::new("baoab")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let parts = parts_by_noise("baoab", system)?;
        commuting("baoab", system)?;
        let noises = system.description().noises;
        let kicks = (0..noises).flat_map(|m| noise(parts, m, [1.0, 0.0]));
        let additive = &system.description().additive;
        let of = |m| frictions_of(&self.friction, additive.get(m));
        let own: Option<Vec<_>> = (0..noises).map(of).collect();
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

/// Refuses a system that schemes with space-time areas have no order for.
fn of_order(scheme: &str, system: &dyn System) -> Result<(), SchemeError> {
    commuting(scheme, system)?;
    let Description { name, depends_on_time, .. } = system.description();
    match depends_on_time {
        false => Ok(()),
        true => {
            let reason = "Hamiltonians depend on time, which costs it its order; take nv";
            Err(SchemeError::not_for(scheme, name, reason))
        }
    }
}

/// Damping of a half of the step, 0 or 1, around or beside H₀ for a share of the step.
type Damped<'a> = &'a dyn Fn(f64, &[usize]) -> Vec<Move>;

impl SplitH {
    /// The moves of a step, from those of all noises for shares of increments and areas, and from a
    /// step of H₀ for a share of the step with halves of the damping.
    fn moves(&self, kicks: impl Fn(f64, f64) -> Vec<Move>, drift: Damped<'_>) -> Vec<Move> {
        let delta = self.delta;
        match delta == 0.0 {
            true => [kicks(0.5, 1.0), drift(1.0, &[0, 1]), kicks(0.5, -1.0)].concat(),
            false => [
                kicks(0.5 - delta, 1.0),
                drift(0.5, &[0]),
                kicks(2.0 * delta, 0.0),
                drift(0.5, &[1]),
                kicks(0.5 - delta, -1.0),
            ]
            .concat(),
        }
    }
}

impl Scheme for SplitH {
    fn about(&self) -> About {
        About { reads_space_time: true, ..About::new("split-h") }
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        let parts = parts_by_noise("split-h", system)?;
        of_order("split-h", system)?;
        let noises = system.description().noises;
        let kicks = |increment, area| {
            (0..noises).flat_map(|m| noise(parts, m, [increment, area])).collect()
        };
        let drift = |share: f64, halves: &[usize]| {
            let damping = halves.iter().flat_map(|&half| damp(&self.friction, half));
            let [there, back] = [false, true].map(|backward| drift(parts, 0.5 * share, backward));
            there.chain(damping).chain(back).collect()
        };
        let moves = self.moves(kicks, &drift);
        Ok(Box::new(CompositionStepper::new(system, vec![moves], &self.friction)?))
    }
}

impl Scheme for SexpH {
    fn about(&self) -> About {
        About { reads_space_time: true, clips_increments: self.clips, ..About::new("sexp-h") }
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
        of_order("sexp-h", system)?;
        let Description { noises, parts, .. } = system.description();
        // One more part: all of the system, without a flow.
        let (number, of_noise) =
            parts.as_ref().map_or((0, &[][..]), |parts| (parts.number, &parts.of_noise[..]));
        let whole = |drift, [noise, area]: [f64; 2], only| {
            [Move::Flow { part: number, drift, noise, area, only }]
        };
        let kick = |m: usize, shares| {
            let part = of_noise.get(m).copied().flatten();
            noise_by(part, m, shares, |shares| whole(0.0, shares, Some(m)))
        };
        let kicks =
            |increment, area| (0..*noises).flat_map(|m| kick(m, [increment, area])).collect();
        let drift = |share: f64, halves: &[usize]| {
            let damping = |of: usize| halves.iter().filter(move |&&half| half == of);
            let damping = |of| damping(of).flat_map(|&half| damp(&self.path.friction, half));
            damping(0).chain(whole(share, [0.0; 2], None)).chain(damping(1)).collect()
        };
        let moves = self.path.moves(kicks, &drift);
        let rest = (number, Scheme::stepper(&Sexp, system)?);
        let friction = &self.path.friction;
        Ok(Box::new(CompositionStepper::with_rest(system, vec![moves], friction, Some(rest))))
    }
}

/// The frictions of all components that an additive noise moves; none if these differ, or if the
/// noise depends on the state.
fn frictions_of(friction: &Frictions, noise: Option<&Option<Vec<usize>>>) -> Option<Vec<usize>> {
    let moved = noise?.as_ref()?;
    let mut all = Vec::new();
    for (k, (_, components)) in friction.iter().enumerate() {
        match moved.iter().filter(|i| components.contains(i)).count() {
            0 => {}
            count if count == moved.len() => all.push(k),
            _ => return None,
        }
    }
    Some(all)
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
    /// The part without a flow, and what stands for it.
    rest: Option<(usize, Box<dyn Stepper + 'a>)>,
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
    /// The factors by which increments are made exact, and integrals of friction over the step.
    exact: Vec<f64>,
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
    /// Moves of a system whose last part may have no flow.
    fn new(
        system: &'a dyn System,
        steps: Vec<Vec<Move>>,
        friction: &'a Frictions,
    ) -> Result<Self, SchemeError> {
        let rest = system.rest().map(|rest| Scheme::stepper(&Sexp, rest)).transpose()?;
        let last = system.description().parts.as_ref().map_or(0, |parts| parts.number - 1);
        Ok(Self::with_rest(system, steps, friction, rest.map(|rest| (last, rest))))
    }

    /// Moves beside the number of a part without a flow, and what stands for it.
    fn with_rest(
        system: &'a dyn System,
        steps: Vec<Vec<Move>>,
        friction: &'a Frictions,
        rest: Option<(usize, Box<dyn Stepper + 'a>)>,
    ) -> Self {
        let description = system.description();
        let last = rest.as_ref().map(|(part, _)| *part);
        let is_rest = |one: &Move| matches!(one, Move::Flow { part, .. } if Some(*part) == last);
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
        // Memory of a kind of pieces, if there are any: every block of paths has its own.
        let needed = |is: fn(&Piece) -> bool, rows| {
            if steps.iter().flatten().any(is) { rows } else { 0 }
        };
        let is_flow: fn(&Piece) -> bool = |piece| matches!(piece, Piece::Move(Move::Flow { .. }));
        let next = needed(|piece| matches!(piece, Piece::Program(_)), description.layout.rows);
        let part = needed(is_flow, description.layout.noise_rows);
        let scratch = needed(is_flow, description.scratch_rows());
        Self {
            system,
            steps,
            rest,
            state: Rows::zero(description.layout.rows),
            next: Rows::zero(next),
            part: StepNoise::zero(part),
            scratch: Rows::zero(scratch),
            friction,
            factors: vec![1.0; 2 + 2 * friction.len()],
            own: Vec::new(),
            exact: Vec::new(),
            integrals: vec![0.0; friction.len()],
            reads_space_time,
            rows: Vec::new(),
        }
    }

    /// Sets the factors of a step.
    fn set_factors(&mut self, step: &Step) {
        let Self { factors, friction, own, exact: exact_factors, integrals, .. } = self;
        (factors[0], factors[1]) = (step.first_decay, step.second_decay);
        for (halves, (damping, _)) in factors[2..].chunks_mut(2).zip(*friction) {
            (halves[0], halves[1]) = (step.decay(&**damping, 0), step.decay(&**damping, 1));
        }
        exact_factors.clear();
        if !own.is_empty() {
            for (integral, (damping, _)) in integrals.iter_mut().zip(*friction) {
                *integral = damping.integral(step.t, step.t + step.tau);
            }
        }
        exact_factors.extend(own.iter().map(|own| {
            let friction: f64 = own.iter().map(|&k| integrals[k]).sum();
            exact(step.damping_integral() + friction)
        }));
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
        self.set_factors(step);
        let Self { system, steps, rest, state, next, part: part_of_noise, scratch, rows, .. } =
            self;
        let number = step.number() as usize % steps.len();
        let factors = &self.factors;
        if self.reads_space_time || !self.own.is_empty() {
            rows.clear();
            rows.extend_from_slice(&noise.increments);
            for (row, factor) in rows.iter_mut().zip(&self.exact) {
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
                        Some((last, rest)) if last == part => {
                            rest.state_mut().copy_from_slice(state);
                            rest.step(&step.undamped(dt), dw, status);
                            state.copy_from_slice(rest.state());
                            // Stays so until the end of the step.
                            status.failed.paths().for_each(|p| state[0][p] = f64::NAN);
                        }
                        _ => {
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

    fn listing(&mut self, step: &Step) -> Option<Listing<'_>> {
        self.set_factors(step);
        let (count, noise) = (self.steps.len(), self.exact.clone());
        let number = step.number() as usize % count;
        let [Piece::Program(program)] = &mut self.steps[number][..] else { return None };
        let middle = step.t + 0.5 * step.tau;
        let listing = Listing::new(&mut **program, &self.factors, step.tau, middle);
        let reads_space_time = self.reads_space_time;
        Some(Listing { turn: (number, count), noise, reads_space_time, ..listing })
    }
}
