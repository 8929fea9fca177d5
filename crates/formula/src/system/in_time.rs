//! What changes with time, as functions of it.

use real::{Bounded, Row};
use systems::run_time::InTime;

use crate::{Graph, Id, Tape};

/// Expressions in t.
pub struct Expressed {
    graph: Graph,
    roots: Vec<Id>,
    tape: Tape,
}

impl Expressed {
    /// Those of a graph whose only input is t.
    pub fn new((graph, roots): (Graph, Vec<Id>)) -> Self {
        let tape = Tape::new(&graph, &roots, std::slice::from_ref(&(0..1)));
        Self { graph, roots, tape }
    }
}

impl InTime for Expressed {
    fn values(&self, times: &Row) -> Vec<Row> {
        let mut out = vec![*times; self.roots.len()];
        self.tape.evaluate(&[&[*times]], &mut out, &mut vec![*times; self.tape.scratch_rows()]);
        out
    }

    fn bounds(&self, time: Bounded) -> Vec<Bounded> {
        let values = self.graph.values(&self.roots, &[time]);
        self.roots.iter().map(|root| values[root.index()]).collect()
    }
}
