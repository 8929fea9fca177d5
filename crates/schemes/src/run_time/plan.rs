//! How the operations of a formula are executed: stages, tiles and memory.

use systems::run_time::{Op, Recorded};

/// Where an argument is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// In memory of the tile.
    Slot(usize),
    /// In a whole buffer.
    Buffer(usize),
}

/// An operation with places in memory. Its result goes into a slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    pub operation: Computation,
    pub slot: usize,
}

/// What is computed. Numbers beside sources are those of nodes with factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Computation {
    /// fx·x, with the product of the factors of up to two nodes.
    Multiple { x: (Source, usize) },
    /// fx·x ± fy·y.
    Combination { x: (Source, Option<usize>), y: (Source, Option<usize>), minus: bool },
    /// An operation of the system; states that it reads whole are in buffers.
    Of(Op<Source>),
}

/// Operations that every tile can do when the stages before are complete.
#[derive(Clone, Debug, Default)]
pub struct Stage {
    pub instructions: Vec<Planned>,
    /// Slots that are stored in buffers after the last instruction.
    pub stores: Vec<(usize, usize)>,
}

/// The plan for a formula.
#[derive(Clone, Debug, Default)]
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
        let mut count = vec![0; nodes.len()];
        nodes.iter().flat_map(|node| node.arguments()).for_each(|x| count[x] += 1);
        results.iter().for_each(|&x| count[x] += 1);
        // Multiples that only one sum or difference reads are computed there.
        let mut absorbed = vec![false; nodes.len()];
        for &node in nodes {
            if let Recorded::Sum(x, y) | Recorded::Difference(x, y) = node {
                for x in [x, y] {
                    absorbed[x] |= count[x] == 1 && matches!(nodes[x], Recorded::Multiple(_));
                }
            }
        }
        // The stage of each node, and who reads it when.
        let is_input = |x: usize| matches!(nodes[x], Recorded::Input(_));
        let mut stage = vec![0; nodes.len()];
        for n in 0..nodes.len() {
            let whole = !nodes[n].is_local();
            let after = |x: usize| stage[x] + usize::from(whole && !is_input(x));
            stage[n] = nodes[n].arguments().map(after).max().unwrap_or(0);
        }
        // An absorbed multiple is read by its reader, in that one's stage.
        for n in 0..nodes.len() {
            for x in nodes[n].arguments() {
                if absorbed[x] {
                    stage[x] = stage[n];
                }
            }
        }
        // The first stage that may overwrite a node tile by tile.
        let mut free_from = stage.clone();
        for n in 0..nodes.len() {
            let after = stage[n] + usize::from(!nodes[n].is_local());
            nodes[n].arguments().for_each(|x| free_from[x] = free_from[x].max(after));
        }
        let stored = |n: usize| results.contains(&n) || free_from[n] > stage[n];
        let mut plan = Self::default();
        // Which node is in each buffer. The inputs are the first nodes.
        let mut content: Vec<usize> = (0..nodes.len()).filter(|&n| is_input(n)).collect();
        let mut buffer: Vec<usize> = (0..nodes.len()).collect();
        plan.stages = vec![Stage::default(); stage.iter().max().map_or(0, |stages| stages + 1)];
        for s in 0..plan.stages.len() {
            let of_stage = |n: &usize| stage[*n] == s && !is_input(*n) && !absorbed[*n];
            let mut slots = Slots::default();
            let mut slot = vec![usize::MAX; nodes.len()];
            let mut released = vec![false; nodes.len()];
            let of_stage: Vec<usize> = (0..nodes.len()).filter(of_stage).collect();
            for (place, &n) in of_stage.iter().enumerate() {
                let source = |x: usize| match slot[x] {
                    usize::MAX => Source::Buffer(buffer[x]),
                    slot => Source::Slot(slot),
                };
                let operation = operation(nodes, n, &absorbed, &source);
                let own = slots.take();
                slot[n] = own;
                plan.stages[s].instructions.push(Planned { operation, slot: own });
                // Slots that no later instruction of this stage reads, and that are not stored.
                for &m in &of_stage[..=place] {
                    let read_later =
                        of_stage[place + 1..].iter().any(|&k| reads_slot(nodes, k, m, &absorbed));
                    if !read_later && !stored(m) && !released[m] {
                        slots.give_back(slot[m]);
                        released[m] = true;
                    }
                }
            }
            plan.slots = plan.slots.max(slots.most);
            for &n in of_stage.iter().filter(|&&n| stored(n)) {
                // A buffer whose content no later stage reads, and no tile of this stage whole.
                let is_free = |&x: &usize| {
                    let keeps = results.contains(&x) || (is_input(x) && !consumed);
                    !keeps && free_from[x] <= s
                };
                let own = content.iter().position(is_free).unwrap_or(content.len());
                content.resize(content.len().max(own + 1), n);
                content[own] = n;
                buffer[n] = own;
                plan.stages[s].stores.push((slot[n], own));
            }
        }
        plan.buffers = content.len();
        plan.results = results.iter().map(|&n| buffer[n]).collect();
        plan
    }
}

/// Whether node k reads node m, itself or through a multiple that it absorbs.
fn reads_slot(nodes: &[Recorded], k: usize, m: usize, absorbed: &[bool]) -> bool {
    nodes[k].arguments().any(|x| x == m || (absorbed[x] && nodes[x].arguments().any(|y| y == m)))
}

/// The operation of node n.
fn operation(
    nodes: &[Recorded],
    n: usize,
    absorbed: &[bool],
    source: &dyn Fn(usize) -> Source,
) -> Computation {
    let with_factor = |x: usize| match nodes[x] {
        Recorded::Multiple(inner) if absorbed[x] => (source(inner), Some(x)),
        _ => (source(x), None),
    };
    match nodes[n] {
        Recorded::Input(_) => unreachable!("inputs are not computed"),
        Recorded::Multiple(x) => Computation::Multiple { x: (source(x), n) },
        Recorded::Sum(x, y) => {
            Computation::Combination { x: with_factor(x), y: with_factor(y), minus: false }
        }
        Recorded::Difference(x, y) => {
            Computation::Combination { x: with_factor(x), y: with_factor(y), minus: true }
        }
        Recorded::Of(op) => Computation::Of(op.map(source)),
    }
}

/// The slots in use.
#[derive(Default)]
struct Slots {
    used: Vec<bool>,
    most: usize,
}

impl Slots {
    fn take(&mut self) -> usize {
        let free = self.used.iter().position(|used| !used);
        let slot = free.unwrap_or(self.used.len());
        if slot == self.used.len() {
            self.used.push(false);
        }
        self.used[slot] = true;
        self.most = self.most.max(self.used.len());
        slot
    }

    fn give_back(&mut self, slot: usize) {
        self.used[slot] = false;
    }
}
