//! What belongs to expressions.

use std::ops::{Index, IndexMut};

use crate::{Id, graph::Graph};

/// A value of each of some expressions, which are in order, such as those that
/// [`Graph::needed`](crate::Graph::needed) gives.
#[derive(Clone, Debug)]
pub struct Values<T> {
    ids: Vec<Id>,
    values: Vec<T>,
}

impl<T> Values<T> {
    /// The value that `of` makes for each expression, from those before it.
    pub fn new(ids: Vec<Id>, mut of: impl FnMut(Id, &Self) -> T) -> Self {
        let values = Vec::with_capacity(ids.len());
        let mut made = Self { ids, values };
        for n in 0..made.ids.len() {
            let value = of(made.ids[n], &made);
            made.values.push(value);
        }
        made
    }

    /// One value for every expression of a graph.
    pub fn all(graph: &Graph, value: T) -> Self
    where
        T: Clone,
    {
        Self { ids: graph.ids().collect(), values: vec![value; graph.size()] }
    }

    /// The expressions.
    pub fn ids(&self) -> &[Id] {
        &self.ids
    }

    fn place(&self, id: Id) -> usize {
        // A whole graph has each at its number.
        if self.ids.get(id.index()) == Some(&id) {
            return id.index();
        }
        self.ids.binary_search(&id).expect("what an expression is made of is needed")
    }
}

/// # Panics
/// If the expression is none of those that have a value.
impl<T> Index<Id> for Values<T> {
    type Output = T;
    fn index(&self, id: Id) -> &T {
        &self.values[self.place(id)]
    }
}

impl<T> IndexMut<Id> for Values<T> {
    fn index_mut(&mut self, id: Id) -> &mut T {
        let place = self.place(id);
        &mut self.values[place]
    }
}
