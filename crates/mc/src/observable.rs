//! Test functions.

use std::array;

use real::{PathMask, Row, WIDTH, exactly, path};

/// A test function φ of states of any dimension.
pub trait Observe: Sync {
    /// Name of φ in results.
    fn name(&self) -> &str;

    /// Writes φ of the paths `live`, and anything for the others. Row i of `y` is component i.
    fn evaluate(&self, y: &[Row], live: PathMask, values: &mut Row);

    /// φ of the paths `live`.
    fn values(&self, y: &[Row], live: PathMask) -> Row {
        let mut values = [0.0; WIDTH];
        self.evaluate(y, live, &mut values);
        values
    }

    /// Whether φ is a smooth function of the state, so that it is no chance if it is the same on
    /// all paths; or is not, as the time of an event, which has no expansion in the step; if that
    /// is known.
    fn is_smooth(&self) -> Option<bool> {
        None
    }

    /// Order with which the error of the mean of φ falls, with a scheme of weak order one.
    fn weak_order(&self) -> f64 {
        1.0
    }
}

/// A test function φ of D components, such as a closure, with its name.
#[derive(Clone, Copy, Debug)]
pub struct StateFunction<F, const D: usize, N = String> {
    /// Name of φ in results, for example `y1` or `cos y3`.
    pub name: N,
    /// φ(y).
    pub function: F,
}

/// A test function φ given by a function pointer, not a closure, with its name.
pub type Observable<const D: usize> = StateFunction<fn([f64; D]) -> f64, D, &'static str>;

impl<F: Fn([f64; D]) -> f64 + Sync, const D: usize> StateFunction<F, D> {
    /// φ with its name in results.
    pub fn new(name: impl Into<String>, function: F) -> Self {
        Self { name: name.into(), function }
    }
}

impl<F, const D: usize, N> Observe for StateFunction<F, D, N>
where
    F: Fn([f64; D]) -> f64 + Sync,
    N: AsRef<str> + Sync,
{
    fn name(&self) -> &str {
        self.name.as_ref()
    }

    /// Copies states eight at a time: a function that reads what was stored just before, in other
    /// pieces, waits.
    fn evaluate(&self, y: &[Row], live: PathMask, values: &mut Row) {
        let (phi, y) = (&self.function, exactly(y));
        if live != PathMask::ALL {
            live.paths().for_each(|p| values[p] = phi(path(y, p)));
            return;
        }
        for p in (0..WIDTH).step_by(8) {
            let states: [[f64; D]; 8] = array::from_fn(|k| path(y, p + k));
            values[p..p + 8].copy_from_slice(&states.map(phi));
        }
    }
}

/// φ of the first path of a block.
pub fn value_at(observable: &dyn Observe, rows: &[Row]) -> f64 {
    observable.values(rows, PathMask::first(1))[0]
}

real::kernel! {
    /// Adds the rows `more` to the rows `sums`.
    pub fn add_rows(sums: &'a mut [Row], more: &'a [Row]) {
        let pairs = sums.as_flattened_mut().iter_mut().zip(more.as_flattened());
        pairs.for_each(|(sum, more)| *sum += more);
    }
}
