//! Compositions of flows for systems known at run time.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, elementary::exp};
use systems::{
    probe::TRIPLE_JUMP,
    run_time::{Description, Lanes, Move, Parts, Program, System, Weights, palindrome},
};

use super::{Scheme, SchemeError, scheme::Made};
use crate::{
    About, Baoab, Listing, Nv, Sexp, SexpH, Split, SplitH, Step, Stepper, Sweep, baoab::Friction,
    built_in::DO_NOT_COMMUTE,
};

/// The parts of a system.
pub fn parts<'a>(scheme: &str, system: &'a dyn System) -> Result<&'a Parts, SchemeError> {
    let Description { name, parts, .. } = system.description();
    parts.as_ref().map_err(|reason| SchemeError::parts(scheme, name, reason))
}

impl Scheme for Split {
    fn about(&self) -> About {
        About::new("split")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a> {
        let flows = palindrome(parts("split", system)?.number, [1.0, 1.0, 0.0], None).collect();
        let moves = [vec![Move::Scale(0)], flows, vec![Move::Scale(1)]].concat();
        Ok(Box::new(CompositionStepper::new(system, vec![moves], &[])?))
    }
}

/// The parts of a system in which each noise has a flow of its own.
pub fn parts_by_noise<'a>(scheme: &str, system: &'a dyn System) -> Result<&'a Parts, SchemeError> {
    let parts = parts(scheme, system)?;
    let Description { name, noises, .. } = system.description();
    if parts.of_noise.len() < *noises {
        let reason = "the flow of each Hamiltonian is not known";
        return Err(SchemeError::parts(scheme, name, reason));
    }
    Ok(parts)
}

/// The flow of noise m for shares of its increment and its space-time area. Where it is not known,
/// symmetric steps `of` shares make it up.
fn noise_by(
    part: Option<usize>,
    m: usize,
    [increment, area]: [f64; 2],
    of: impl Fn([f64; 2]) -> Vec<Move>,
) -> Vec<Move> {
    match part {
        Some(part) => vec![Move::Flow { part, drift: 0.0, noise: increment, area, only: Some(m) }],
        None => TRIPLE_JUMP.iter().flat_map(|c| of([c * increment, c * area])).collect(),
    }
}

/// [`noise_by`] the flows of all parts.
fn noise(parts: &Parts, m: usize, shares: [f64; 2]) -> Vec<Move> {
    noise_by(parts.of_noise[m], m, shares, |[increment, area]| {
        palindrome(parts.number, [0.0, increment, area], Some(m)).collect()
    })
}

impl Scheme for Nv {
    fn about(&self) -> About {
        About::new("nv")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a> {
        let parts = parts_by_noise("nv", system)?;
        let noises = 0..system.description().noises;
        let moves = |order: &mut dyn Iterator<Item = usize>| -> Vec<Move> {
            let half: Vec<_> = palindrome(parts.number, [0.5, 0.0, 0.0], None).collect();
            let kicks = order.flat_map(|m| noise(parts, m, [1.0, 0.0])).collect();
            [half.clone(), vec![Move::Scale(0)], kicks, vec![Move::Scale(1)], half].concat()
        };
        let (forward, backward) = (moves(&mut noises.clone()), moves(&mut noises.rev()));
        let steps = match self.sweep {
            Sweep::Alternating => vec![forward, backward],
            Sweep::Forward => vec![forward],
            Sweep::Backward => vec![backward],
        };
        Ok(Box::new(CompositionStepper::new(system, steps, &[])?))
    }
}

/// All damping of a half of the step, 0 or 1.
fn damp(friction: &[Friction], half: usize) -> Vec<Move> {
    let mut moves = vec![Move::Scale(half)];
    for (k, (_, components)) in friction.iter().enumerate() {
        let factor = 2 + 2 * k + half;
        moves.extend(components.iter().map(|&component| Move::ScaleOne { component, factor }));
    }
    moves
}

/// The flows of H₀ for a share of the step, in their order or from the last to the first.
fn drift(parts: &Parts, drift: f64, backward: bool) -> Vec<Move> {
    let flow = |part| Move::Flow { part, drift, noise: 0.0, area: 0.0, only: None };
    let mut flows: Vec<_> = (0..parts.number).map(flow).collect();
    if backward {
        flows.reverse();
    }
    flows
}

/// Refuses noises that do not commute.
fn commuting(scheme: &str, system: &dyn System) -> Result<(), SchemeError> {
    let Description { name, noises_commute, .. } = system.description();
    if !noises_commute {
        return Err(SchemeError::not_for(scheme, name, DO_NOT_COMMUTE));
    }
    Ok(())
}

impl Scheme for Baoab {
    fn about(&self) -> About {
        About::new("baoab")
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a> {
        let parts = parts_by_noise("baoab", system)?;
        commuting("baoab", system)?;
        let Description { noises, additive, .. } = system.description();
        let kicks = (0..*noises).flat_map(|m| noise(parts, m, [1.0, 0.0])).collect();
        let own = |m: usize| frictions_of(&self.friction, additive.get(m)?.as_ref()?);
        let own: Option<Vec<_>> = (0..*noises).map(own).collect();
        let [first, second] = [0, 1].map(|half| damp(&self.friction, half));
        // Noises that are made exact come after friction, others in its middle.
        let last = if own.is_some() { [second, kicks] } else { [kicks, second] }.concat();
        let [before, after] = [true, false].map(|backward| drift(parts, 0.5, backward));
        let moves = [before, first, last, after].concat();
        let stepper = CompositionStepper::new(system, vec![moves], &self.friction)?;
        Ok(Box::new(CompositionStepper { own: own.unwrap_or_default(), ..stepper }))
    }
}

/// Refuses a system that schemes with space-time areas have no order for.
fn of_order(scheme: &str, system: &dyn System) -> Result<(), SchemeError> {
    commuting(scheme, system)?;
    let Description { name, depends_on_time, .. } = system.description();
    if *depends_on_time {
        let reason = "Hamiltonians depend on time, which costs it its order; take nv";
        return Err(SchemeError::not_for(scheme, name, reason));
    }
    Ok(())
}

impl SplitH {
    /// The moves of a step, from those of each noise for shares of increment and area, and from a
    /// step of H₀ for a share of the step with halves of the damping, 0 or 1.
    fn moves(
        &self,
        noises: usize,
        kick: impl Fn(usize, [f64; 2]) -> Vec<Move>,
        drift: impl Fn(f64, &[usize]) -> Vec<Move>,
    ) -> Vec<Move> {
        let kicks = |shares| (0..noises).flat_map(|m| kick(m, shares)).collect();
        let delta = self.delta;
        if delta == 0.0 {
            return [kicks([0.5, 1.0]), drift(1.0, &[0, 1]), kicks([0.5, -1.0])].concat();
        }
        [
            kicks([0.5 - delta, 1.0]),
            drift(0.5, &[0]),
            kicks([2.0 * delta, 0.0]),
            drift(0.5, &[1]),
            kicks([0.5 - delta, -1.0]),
        ]
        .concat()
    }
}

impl Scheme for SplitH {
    fn about(&self) -> About {
        About { reads_space_time: true, ..About::new("split-h") }
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a> {
        let parts = parts_by_noise("split-h", system)?;
        of_order("split-h", system)?;
        let kick = |m, shares| noise(parts, m, shares);
        let damped_drift = |share: f64, halves: &[usize]| {
            let damping = halves.iter().flat_map(|&half| damp(&self.friction, half)).collect();
            let [there, back] = [false, true].map(|backward| drift(parts, 0.5 * share, backward));
            [there, damping, back].concat()
        };
        let moves = self.moves(system.description().noises, kick, damped_drift);
        Ok(Box::new(CompositionStepper::new(system, vec![moves], &self.friction)?))
    }
}

impl Scheme for SexpH {
    fn about(&self) -> About {
        About { reads_space_time: true, clips_increments: self.clips, ..About::new("sexp-h") }
    }

    fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a> {
        of_order("sexp-h", system)?;
        let Description { noises, parts, .. } = system.description();
        let friction = &self.path.friction;
        // One more part: all of the system, without a flow.
        let (part, of_noise) =
            parts.as_ref().map_or((0, &[][..]), |parts| (parts.number, &parts.of_noise[..]));
        let whole =
            |drift, [noise, area]: [f64; 2], only| Move::Flow { part, drift, noise, area, only };
        let kick = |m: usize, shares| {
            let own = of_noise.get(m).copied().flatten();
            noise_by(own, m, shares, |shares| vec![whole(0.0, shares, Some(m))])
        };
        let drift = |share: f64, halves: &[usize]| {
            let damping = |half| if halves.contains(&half) { damp(friction, half) } else { vec![] };
            [damping(0), vec![whole(share, [0.0; 2], None)], damping(1)].concat()
        };
        let moves = self.path.moves(*noises, kick, drift);
        let rest = (part, Scheme::stepper(&Sexp, system)?);
        Ok(Box::new(CompositionStepper::with_rest(system, vec![moves], friction, Some(rest))))
    }
}

/// The frictions of all components that an additive noise moves; none if these differ.
fn frictions_of(friction: &[Friction], moved: &[usize]) -> Option<Vec<usize>> {
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
    let mean = if integral.abs() < 1e-4 {
        1.0 - integral + integral * integral * (2.0 / 3.0)
    } else {
        (1.0 - exp(-2.0 * integral)) / (2.0 * integral)
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
    friction: &'a [Friction],
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
        friction: &'a [Friction],
    ) -> Result<Self, SchemeError> {
        let rest = system.rest().map(|rest| Scheme::stepper(&Sexp, rest)).transpose()?;
        let last = system.description().parts.as_ref().map_or(0, |parts| parts.number - 1);
        Ok(Self::with_rest(system, steps, friction, rest.map(|rest| (last, rest))))
    }

    /// Moves beside the number of a part without a flow, and what stands for it.
    fn with_rest(
        system: &'a dyn System,
        steps: Vec<Vec<Move>>,
        friction: &'a [Friction],
        rest: Option<(usize, Box<dyn Stepper + 'a>)>,
    ) -> Self {
        let description = system.description();
        let last = rest.as_ref().map(|(part, _)| *part);
        let is_rest = |one: &Move| matches!(one, Move::Flow { part, .. } if Some(*part) == last);
        let reads = |one: &Move| matches!(one, Move::Flow { area, .. } if *area != 0.0);
        let reads_space_time = steps.iter().flatten().any(reads);
        let step = |moves: Vec<Move>| -> Vec<Piece> {
            let runs = moves.chunk_by(|one, next| !is_rest(one) && !is_rest(next));
            runs.flat_map(|run| {
                let program = if is_rest(&run[0]) { None } else { system.compose(run) };
                match program {
                    Some(program) => vec![Piece::Program(program)],
                    None => run.iter().copied().map(Piece::Move).collect(),
                }
            })
            .collect()
        };
        let steps: Vec<_> = steps.into_iter().map(step).collect();
        // Memory of a kind of pieces, if there are any: every block of paths has its own.
        let pieces = || steps.iter().flatten();
        let has_programs = pieces().any(|piece| matches!(piece, Piece::Program(_)));
        let has_flows = pieces().any(|piece| matches!(piece, Piece::Move(Move::Flow { .. })));
        let if_needed = |needed, rows| if needed { rows } else { 0 };
        let next = if_needed(has_programs, description.layout.rows);
        let part = if_needed(has_flows, description.layout.noise_rows);
        let scratch = if_needed(has_flows, description.scratch_rows());
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
        let is_plain = !self.reads_space_time && self.own.is_empty();
        if !is_plain {
            rows.clear();
            rows.extend_from_slice(&noise.increments);
            for (row, factor) in rows.iter_mut().zip(&self.exact) {
                row.iter_mut().for_each(|dw| *dw *= factor);
            }
            if self.reads_space_time {
                rows.extend_from_slice(&noise.space_time);
            }
        }
        let all: &[Row] = if is_plain { &noise.increments } else { rows };
        let (increments, areas) = all.split_at(noise.increments.len());
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
                    let wanted = (*share, *area, *only);
                    let is_whole = wanted == (1.0, 0.0, None) && is_plain;
                    if !is_whole && shares != wanted {
                        shares = wanted;
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
