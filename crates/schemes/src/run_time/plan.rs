//! How the operations of a formula are executed: stages, tiles and memory.

use systems::run_time::{Op, Recorded};

/// Place of an argument.
#[derive(Clone, Copy)]
pub enum Source {
    /// Memory of the tile.
    Slot(usize),
    /// A whole buffer.
    Buffer(usize),
}

/// A computation with arguments of type P. Numbers beside them are those of nodes with factors.
#[derive(Clone, Copy)]
pub enum Computation<P> {
    /// The argument times a factor.
    Multiple(P, usize),
    /// The sum or, if `minus`, the difference of two arguments, with factors.
    Combination { terms: [(P, Option<usize>); 2], minus: bool },
    /// An operation of the system; states that it reads whole are in buffers.
    Of(Op<P>),
}

impl<P> Computation<P> {
    fn map<Q>(self, mut f: impl FnMut(P) -> Q) -> Computation<Q> {
        match self {
            Self::Multiple(x, factor) => Computation::Multiple(f(x), factor),
            Self::Combination { terms, minus } => {
                Computation::Combination { terms: terms.map(|(x, factor)| (f(x), factor)), minus }
            }
            Self::Of(op) => Computation::Of(op.map(f)),
        }
    }
}

/// Operations that every tile can do when the stages before are complete.
#[derive(Default)]
pub struct Stage {
    /// Computations, each with the slot for its result.
    pub instructions: Vec<(Computation<Source>, usize)>,
    /// Slots that are stored in buffers after the last instruction.
    pub stores: Vec<(usize, usize)>,
}

/// The plan for a formula.
#[derive(Default)]
pub struct Plan {
    pub stages: Vec<Stage>,
    /// Number of slots of a tile, and of buffers with the inputs, which come first.
    pub slots: usize,
    pub buffers: usize,
    /// The buffers of the results.
    pub results: Vec<usize>,
}

impl Plan {
    /// The plan for `nodes` of which the `results` are wanted. Inputs may be overwritten if
    /// `consumed`.
    pub fn new(nodes: &[Recorded], results: &[usize], consumed: bool) -> Self {
        let all = 0..nodes.len();
        let is_input = |x: usize| matches!(nodes[x], Recorded::Input(_));
        let whole = |n: usize| usize::from(!nodes[n].is_local());
        let mut uses = vec![0; nodes.len()];
        let arguments = nodes.iter().flat_map(|node| node.arguments());
        arguments.chain(results.iter().copied()).for_each(|x| uses[x] += 1);
        // Multiples that only one sum or difference reads are computed there.
        let term = |x: usize| match nodes[x] {
            Recorded::Multiple(inner) if uses[x] == 1 => (inner, Some(x)),
            _ => (x, None),
        };
        let computation = |n: usize| match nodes[n] {
            Recorded::Input(_) => None,
            Recorded::Multiple(x) => Some(Computation::Multiple(x, n)),
            Recorded::Sum(x, y) | Recorded::Difference(x, y) => {
                let minus = matches!(nodes[n], Recorded::Difference(..));
                Some(Computation::Combination { terms: [term(x), term(y)], minus })
            }
            Recorded::Of(op) => Some(Computation::Of(op)),
        };
        let computations: Vec<_> = all.clone().map(computation).collect();
        let mut reads = vec![Vec::new(); nodes.len()];
        for (reads, computation) in reads.iter_mut().zip(&computations) {
            if let Some(computation) = computation {
                computation.map(|x| reads.push(x));
            }
        }
        let mut needed = vec![false; nodes.len()];
        results.iter().for_each(|&n| needed[n] = true);
        for n in all.clone().rev() {
            if needed[n] {
                reads[n].iter().for_each(|&x| needed[x] = true);
            }
        }
        let computed: Vec<usize> = all.clone().filter(|&n| needed[n] && !is_input(n)).collect();
        // The stage of each node, and the first one that may overwrite it tile by tile.
        let mut stage = vec![0; nodes.len()];
        for &n in &computed {
            let after = |&x: &usize| if is_input(x) { 0 } else { stage[x] + whole(n) };
            stage[n] = reads[n].iter().map(after).max().unwrap_or(0);
        }
        let mut free_from = stage.clone();
        for &n in &computed {
            let after = stage[n] + whole(n);
            reads[n].iter().for_each(|&x| free_from[x] = free_from[x].max(after));
        }
        let stored = |n: usize| results.contains(&n) || free_from[n] > stage[n];
        let mut plan = Self::default();
        // Which node is in each buffer, and where each node is. The inputs are the first nodes.
        let mut content: Vec<usize> = all.clone().filter(|&n| is_input(n)).collect();
        let mut place: Vec<Source> = all.map(Source::Buffer).collect();
        for s in 0..computed.iter().map(|&n| stage[n] + 1).max().unwrap_or(0) {
            let mut planned = Stage::default();
            let of_stage: Vec<usize> =
                computed.iter().copied().filter(|&n| stage[n] == s).collect();
            // The last instruction that reads the content of each slot.
            let mut last_reads: Vec<usize> = Vec::new();
            for (at, &n) in of_stage.iter().enumerate() {
                if let Some(computation) = computations[n] {
                    let slot = last_reads.iter().position(|&last| last < at);
                    let slot = slot.unwrap_or(last_reads.len());
                    last_reads.resize(last_reads.len().max(slot + 1), 0);
                    let last = of_stage.iter().rposition(|&reader| reads[reader].contains(&n));
                    last_reads[slot] = if stored(n) { usize::MAX } else { last.unwrap_or(at) };
                    planned.instructions.push((computation.map(|x| place[x]), slot));
                    place[n] = Source::Slot(slot);
                }
            }
            plan.slots = plan.slots.max(last_reads.len());
            for (&n, &(_, slot)) in of_stage.iter().zip(&planned.instructions) {
                if stored(n) {
                    // A buffer whose content no later stage reads, and no tile of this stage whole.
                    let is_free = |&x: &usize| {
                        let keeps = results.contains(&x) || (is_input(x) && !consumed);
                        !keeps && free_from[x] <= s
                    };
                    let own = content.iter().position(is_free).unwrap_or(content.len());
                    content.resize(content.len().max(own + 1), n);
                    content[own] = n;
                    place[n] = Source::Buffer(own);
                    planned.stores.push((slot, own));
                }
            }
            plan.stages.push(planned);
        }
        plan.buffers = content.len();
        let buffer = |n: &usize| content.iter().position(|x| x == n).unwrap_or(0);
        plan.results = results.iter().map(buffer).collect();
        plan
    }
}
