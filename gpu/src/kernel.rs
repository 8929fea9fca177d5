//! The kernel of a plan: a thread for each path, which draws its noise, sums it to the steps of all
//! runs, takes these, and writes the states at the times that are wanted.
//!
//! **Memory.** A path has a column of words: the components of each run, the state of its streams
//! with what they have left over, the numbers of clipped increments, and a mark. It is read at the
//! beginning of a launch and written at the end. A launch begins and ends with a coarsest step.
//!
//! **Marks.** A path that meets what is left to the processor, a step that is not solved or a state
//! that is not finite, is marked and goes no further.

use expression::{OUT, SCRATCH};
use real::Real;
use schemes::Sweeps;

use crate::{
    number::normal_pair,
    plan::{Code, Plan, RunPlan},
    ptx::{self, Label, Number, Word, line},
};

/// The name of the kernel.
pub const NAME: &str = "march";
/// The parameters: addresses of the memory, the states, the numbers and the slots; the number of
/// paths, of the finest step before the launch, and of those in it.
pub const PARAMETERS: [&str; 7] =
    ["memory", "states", "numbers", "slots", "paths", "before", "steps"];
/// The slot of a coarsest step whose states are not wanted.
pub const NO_SLOT: u64 = u64::MAX;
/// Numbers before the tables of runs: √τ and √(τ/12).
pub const HEAD: usize = 2;
/// Numbers for each run before the tables: its largest increment, and the place of its table.
pub const HEAD_OF_RUN: usize = 2;

/// Numbers and words of the memory of a path, in their order.
struct Registers {
    runs: Vec<Vec<Number>>,
    streams: Vec<Stream>,
    clipped: Vec<Word>,
    mark: Word,
}

/// A stream of normals, and the one that is left over if they are odd in number.
struct Stream {
    state: [Word; 4],
    spare: Option<Number>,
}

/// Rows of the memory of a path.
pub fn memory_rows(plan: &Plan<'_>) -> usize {
    let stream = 4 + plan.noises % 2;
    let streams = 1 + usize::from(plan.space_time);
    plan.runs.len() * (plan.dimension + 1) + streams * stream + 1
}

impl Registers {
    /// Reads or writes the memory of a path, one row after the other.
    fn move_all(
        &self,
        mut address: Word,
        stride: Word,
        number: fn(Number, Word),
        word: fn(Word, Word),
    ) {
        let mut next = || {
            let at = address;
            address = address.plus(stride);
            at
        };
        self.runs.iter().flatten().for_each(|&y| number(y, next()));
        for Stream { state, spare } in &self.streams {
            state.iter().for_each(|&part| word(part, next()));
            spare.iter().for_each(|&spare| number(spare, next()));
        }
        self.clipped.iter().for_each(|&count| word(count, next()));
        word(self.mark, next());
    }
}

/// Registers of a launch besides: addresses, and the number of the step.
struct Launch {
    numbers: Word,
    before: Word,
    /// Number of the finest step, counted from 1.
    n: Word,
    /// Where a path goes that is marked.
    failed: Label,
}

/// The text of the kernel.
pub fn kernel(plan: &Plan<'_>) -> String {
    ptx::kernel(NAME, &PARAMETERS, || body(plan))
}

fn body(plan: &Plan<'_>) {
    let [memory, states, numbers, slots, paths, before, steps] =
        PARAMETERS.map(|name| Word::by("ld.param.u64", format_args!("[{name}]")));
    line("mov.u32 %r1, %ctaid.x;");
    line("mov.u32 %r2, %ntid.x;");
    line("mov.u32 %r3, %tid.x;");
    line("mad.lo.u32 %r4, %r1, %r2, %r3;");
    let path = Word::by("cvt.u64.u32", "%r4");
    let end = Label::new();
    path.is("ge", paths).jump(end);

    let (stride, column) = (paths << 3, path << 3);
    let of_path = memory.plus(column);
    let state = |_: &RunPlan| (0..plan.dimension).map(|_| Number::new()).collect();
    let stream = || Stream {
        state: [(); 4].map(|()| Word::new()),
        spare: (plan.noises % 2 == 1).then(Number::new),
    };
    let registers = Registers {
        runs: plan.runs.iter().map(state).collect(),
        streams: (0..1 + usize::from(plan.space_time)).map(|_| stream()).collect(),
        clipped: plan.runs.iter().map(|_| Word::new()).collect(),
        mark: Word::new(),
    };
    let load = |to: Word, at: Word| to.set(Word::load(at, 0));
    registers.move_all(of_path, stride, |to, at| to.set(Number::load(at, 0)), load);
    registers.mark.is("ne", 0u64).jump(end);

    let launch = Launch { numbers, before, n: before.plus(1u64), failed: Label::new() };
    let last = before.plus(steps);
    let (again, next, done) = (Label::new(), Label::new(), Label::new());
    again.here();
    // The noise of the last steps of all levels.
    let rows = plan.noises * (1 + usize::from(plan.space_time));
    let fresh = || (0..rows).map(|_| Number::new()).collect::<Vec<_>>();
    let whole: Vec<_> = (0..=plan.levels).map(|_| fresh()).collect();
    let first_half: Vec<_> = (0..=plan.levels).map(|_| fresh()).collect();
    draw(plan, &registers, &launch, &whole[0]);
    for level in 0..=plan.levels {
        for (number, run) in plan.runs.iter().enumerate().filter(|(_, run)| run.level == level) {
            step(plan, &registers, &launch, (number, run), &whole[level]);
        }
        if level < plan.levels {
            let joins = Label::new();
            ((launch.n >> level as u32) & 1u64).is("eq", 0u64).jump(joins);
            first_half[level + 1].iter().zip(&whole[level]).for_each(|(to, &dw)| to.set(dw));
            next.jump();
            joins.here();
            let joined = join(&first_half[level + 1], &whole[level], plan.noises);
            whole[level + 1].iter().zip(joined).for_each(|(to, dw)| to.set(dw));
        }
    }
    // The states at a time that is wanted.
    let number = (launch.n.minus(before) >> plan.levels as u32).minus(1u64);
    let slot = Word::load(slots.plus(number << 3), 0);
    slot.is("eq", NO_SLOT).jump(next);
    let rows = (plan.runs.len() * (plan.dimension + 1)) as u64;
    let mut at = states.plus(slot.times(rows).times(stride)).plus(column);
    for (run, clipped) in registers.runs.iter().zip(&registers.clipped) {
        let count = Number::Constant(0).copied();
        line(format_args!("cvt.rn.f64.u64 {count}, {clipped};"));
        for value in run.iter().chain([&count]) {
            value.store(at);
            at = at.plus(stride);
        }
    }
    next.here();
    launch.n.set(launch.n.plus(1u64));
    last.is("ge", launch.n).jump(again);
    done.jump();
    launch.failed.here();
    registers.mark.set(1u64);
    done.here();
    registers.move_all(of_path, stride, Number::store, Word::store);
    end.here();
    line("ret;");
}

/// Draws the noise of a finest step.
fn draw(plan: &Plan<'_>, registers: &Registers, launch: &Launch, noise: &[Number]) {
    for (kind, Stream { state, spare }) in registers.streams.iter().enumerate() {
        let rows = &noise[kind * plan.noises..][..plan.noises];
        let size = Number::read(launch.numbers, 8 * kind);
        let fill = |rows: &[Number]| {
            let mut words = *state;
            for pair in rows.chunks(2) {
                let [one, other] = normal_pair(&mut words);
                pair[0].set(one * size);
                match (pair.get(1), spare) {
                    (Some(second), _) => second.set(other * size),
                    (None, Some(spare)) => spare.set(other),
                    (None, None) => unreachable!("an odd number of noises has a spare normal"),
                }
            }
            state.iter().zip(words).for_each(|(part, word)| part.set(word));
        };
        match spare {
            None => fill(rows),
            Some(spare) => {
                // Every second step begins with the normal that is left over.
                let (begins, filled) = (Label::new(), Label::new());
                (launch.n & 1u64).is("eq", 0u64).jump(begins);
                fill(rows);
                filled.jump();
                begins.here();
                rows[0].set(*spare * size);
                if rows.len() > 1 {
                    fill(&rows[1..]);
                }
                filled.here();
            }
        }
    }
}

/// The noise of two steps together: sums of increments, and ½(H + H′) + ¼(ΔW − ΔW′).
fn join(first: &[Number], second: &[Number], noises: usize) -> Vec<Number> {
    let increments = (0..noises).map(|m| first[m] + second[m]);
    let areas = (noises..first.len()).map(|k| {
        let difference = first[k - noises] - second[k - noises];
        (first[k] + second[k]) * 0.5 + difference * 0.25
    });
    increments.chain(areas).collect()
}

/// The numbers of a step of a run.
type Numbers = [Number];

/// A step of a run.
fn step(
    plan: &Plan<'_>,
    registers: &Registers,
    launch: &Launch,
    (number, run): (usize, &RunPlan),
    noise: &[Number],
) {
    let level = run.level as u32;
    let head = 8 * (HEAD + HEAD_OF_RUN * number);
    let place = Word::load(launch.numbers, head + 8);
    let of_launch = (launch.n >> level).minus(launch.before >> level).minus(1u64);
    let row = place.plus(of_launch.times(run.columns as u64));
    let table = launch.numbers.plus(row << 3);
    let numbers: Vec<Number> =
        (0..run.columns).map(|column| Number::read(table, 8 * column)).collect();
    let mut noise = noise.to_vec();
    if run.clips {
        let bound = Number::read(launch.numbers, head);
        for dw in &mut noise[..plan.noises] {
            *dw = clip(*dw, bound, registers.clipped[number]);
        }
    }
    noise.iter_mut().zip(&run.noise).for_each(|(dw, &at)| *dw = *dw * numbers[at]);
    if !run.reads_space_time {
        noise.truncate(plan.noises);
    }
    let y = &registers.runs[number];
    let mut now = y.clone();
    run.before.iter().for_each(|&(i, at)| now[i] = now[i] * numbers[at]);
    let result = fresh_copies(&now);
    match &run.programs[..] {
        [one] => advance(run, one, &numbers, &now, &noise, &result, launch.failed),
        all => {
            // Steps, counted from 0, take two programs in turn.
            let (second, both) = (Label::new(), Label::new());
            ((launch.n >> level) & 1u64).is("eq", 0u64).jump(second);
            advance(run, &all[0], &numbers, &now, &noise, &result, launch.failed);
            both.jump();
            second.here();
            advance(run, &all[1], &numbers, &now, &noise, &result, launch.failed);
            both.here();
        }
    }
    let mut next = result;
    run.after.iter().for_each(|&(i, at)| next[i] = next[i] * numbers[at]);
    y.iter().zip(&next).for_each(|(y, next)| y.set(*next));
    let guard = run.guard.iter().map(|guard| evaluate(guard, &numbers, &[&y[..]], &[])[0].size());
    let sizes = y.iter().map(|y| y.size()).chain(guard);
    let sum = sizes.fold(Number::from(0.0), |sum, size| sum + size);
    sum.is("lt", f64::INFINITY).jump_unless(launch.failed);
}

fn fresh_copies(values: &[Number]) -> Vec<Number> {
    values.iter().map(|_| Number::new()).collect()
}

/// An increment, clipped to ± a bound, and one more in the count if that changes it.
fn clip(dw: Number, bound: Number, count: Word) -> Number {
    const SIGN: u64 = 1 << 63;
    let clipped = Number::new();
    let inside = Label::new();
    clipped.set(dw);
    dw.size().is("gt", bound).jump_unless(inside);
    dw.size().is("lt", f64::INFINITY).jump_unless(inside);
    clipped.set((bound.bits() | (dw.bits() & SIGN)).number());
    count.set(count.plus(1u64));
    inside.here();
    clipped
}

/// A step by a program: once, or sweep after sweep until it has a fixed point.
fn advance(
    run: &RunPlan,
    code: &Code,
    numbers: &Numbers,
    y: &[Number],
    noise: &[Number],
    result: &[Number],
    failed: Label,
) {
    let set = |to: &[Number], values: &[Number]| {
        to.iter().zip(values).for_each(|(to, &value)| to.set(value));
    };
    let Some((most, settle, [first, second])) = run.sweeps else {
        return set(result, &evaluate(code, numbers, &[y], noise));
    };
    let first = numbers[first];
    let start: Vec<Number> = y.iter().map(|&y| y * first).collect();
    let z: Vec<Number> = start.iter().map(|start| start.copied()).collect();
    let [change, before] = [(); 2].map(|()| Number::Constant(0).copied());
    let [again, evaluation, found, solved] = [(); 4].map(|()| Label::new());
    let [sweeps, evaluations, last] = [(); 3].map(|()| Word::new());
    [sweeps, last].iter().for_each(|count| count.set(0u64));
    let sum = |of: &dyn Fn(usize) -> Number| {
        (0..z.len()).fold(Number::from(0.0), |sum, i| sum + of(i).size())
    };
    again.here();
    evaluations.set(0u64);
    evaluation.here();
    let next = evaluate(code, numbers, &[&start, &z], noise);
    before.set(change);
    change.set(sum(&|i| next[i] - z[i]));
    set(&z, &next);
    evaluations.set(evaluations.plus(1u64));
    evaluations.is("lt", Sweeps::EVALUATIONS as u64).jump(evaluation);
    if settle {
        last.is("ne", 0u64).jump(solved);
    }
    excess(change, before, sum(&|i| z[i])).is("le", 0.0).jump(found);
    sweeps.set(sweeps.plus(1u64));
    sweeps.is("lt", u64::from(most)).jump(again);
    failed.jump();
    found.here();
    if settle {
        last.set(1u64);
        again.jump();
    }
    solved.here();
    let second = numbers[second];
    z.iter().zip(result).for_each(|(&z, result)| result.set(z * second));
}

/// The test of convergence of `nonlin`.
fn excess(change: Number, change_before: Number, size: Number) -> Number {
    use nonlin::criteria::{GUARD, TOLERANCE};
    let before = Real::where_less(change_before, size, change_before, size);
    let allowed = size * (GUARD * TOLERANCE);
    change * GUARD * change - allowed * before
}

/// The results of a program.
fn evaluate(code: &Code, numbers: &Numbers, states: &[&[Number]], noise: &[Number]) -> Vec<Number> {
    let mut varying = vec![None; code.constants.len()];
    for &(place, column) in &code.columns {
        varying[place] = Some(numbers[column]);
    }
    let number = |place: u32| {
        let place = place as usize;
        match (varying[place & !1], place & 1) {
            (Some(number), 0) => number,
            (Some(number), _) => -number,
            (None, _) => code.constants[place].into(),
        }
    };
    let mut scratch: Vec<Option<Number>> = Vec::new();
    let mut out: Vec<Option<Number>> = vec![None; code.outputs];
    for instruction in &code.instructions {
        let row = |place: expression::Place| {
            let row = place.row as usize;
            let known = match place.bank {
                SCRATCH => scratch[row],
                OUT => out[row],
                bank if (bank as usize) < states.len() => Some(states[bank as usize][row]),
                _ => Some(noise[row]),
            };
            known.expect("an instruction reads what was written before")
        };
        let value = instruction.value(row, number);
        // Registers of a state change before all results are read.
        let is_state = states.iter().any(|state| state.contains(&value));
        let value = if is_state { value.copied() } else { value };
        let row = instruction.to.row as usize;
        let bank = if instruction.to.bank == OUT { &mut out } else { &mut scratch };
        bank.resize(bank.len().max(row + 1), None);
        bank[row] = Some(value);
    }
    out.into_iter().map(|value| value.expect("a program writes all results")).collect()
}
