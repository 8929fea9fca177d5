//! Where a formula has no value.

use crate::{Formula, FormulaError};

impl Formula {
    /// Why the formula has no finite value at a point: its first operation that is not finite
    /// although its operands are, as `this is NaN for -0.3`. None if it has one: an infinite
    /// operand that is divided by does no harm.
    ///
    /// # Panics
    /// Unless the point has a number for each variable.
    #[must_use]
    pub fn explain(&self, point: &[f64]) -> Option<FormulaError> {
        assert_eq!(point.len(), self.variables.len(), "numbers of a point");
        let (graph, root, text) = (&self.graph, self.root, &self.text);
        let values = graph.values(&[root], point);
        if values[root.index()].is_finite() {
            return None;
        }
        let needed = graph.needed(&[root]);
        let id = graph.ids().find(|id| needed[id.index()] && !values[id.index()].is_finite())?;
        let operands = graph.node(id).operands().map(|operand| values[operand.index()].to_string());
        let operands = operands.collect::<Vec<_>>().join(" and ");
        let of = if operands.is_empty() { "" } else { " for " };
        let message = format!("this is {}{of}{operands}", values[id.index()]);
        Some(FormulaError::new(message, text, graph.place(id).unwrap_or(0..text.len())))
    }
}
