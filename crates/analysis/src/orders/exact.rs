//! An exact solution on sampled paths.

use mc::{TimeChange, View};
use real::{Row, WIDTH};

/// An exact solution at the final time, a function of a random time ([`TimeChange`]).
pub struct Exact<'a> {
    /// The random time, carried along each path.
    pub time_change: &'a dyn TimeChange,
    /// y(T) as a function of the random time at T.
    solution: Box<dyn Fn(f64) -> Vec<f64> + Sync + 'a>,
}

impl<'a> Exact<'a> {
    /// The solution y(T) as a function of the random time at T, which `time_change` carries along
    /// each path.
    pub fn new<Y: Into<Vec<f64>>>(
        time_change: &'a dyn TimeChange,
        solution: impl Fn(f64) -> Y + Sync + 'a,
    ) -> Self {
        Self { time_change, solution: Box::new(move |time| solution(time).into()) }
    }

    /// The solutions of the paths of a block that are live; zero on the others.
    pub fn rows(&self, view: &View<'_>, dimension: usize) -> Vec<Row> {
        let mut rows = vec![[0.0; WIDTH]; dimension];
        for p in view.live.paths() {
            let solution = (self.solution)(view.random_time[p]);
            rows.iter_mut().zip(solution).for_each(|(row, y)| row[p] = y);
        }
        rows
    }
}
