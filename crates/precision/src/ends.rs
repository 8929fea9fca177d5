//! Errors of all schemes at all step sizes at the final time: strong errors, conformal defects and
//! biases from one pass.

use mc::{Observable, Statistic, View};
use stats::{CrossMoments, Moments};

/// Relative distance of an invariant from its conformal law at the final time.
pub(crate) type Defect<'a, const D: usize> = &'a (dyn Fn(usize, [f64; D]) -> f64 + Sync);

/// What is looked at, shared by all parts of the sum.
#[derive(Clone, Copy)]
pub(crate) struct Sight<'a, const D: usize> {
    /// Runs of the reference: the finest, and where expectations are extrapolated one of twice its
    /// step.
    pub references: usize,
    pub schemes: usize,
    /// Step sizes of every scheme; the runs of scheme s begin at `references` + s·`levels`.
    pub levels: usize,
    pub invariants: usize,
    pub defect: Defect<'a, D>,
    pub observables: &'a [Observable<D>],
    /// The number of the final time.
    pub last_time: u64,
}

/// The sums, with what is looked at.
pub(crate) struct Ends<'a, const D: usize> {
    sight: Sight<'a, D>,
    pub(crate) sums: Sums,
}

/// Errors of all schemes at all step sizes.
pub(crate) struct Sums {
    levels: usize,
    /// |y − y_ref|² by scheme.
    squares: Vec<CrossMoments>,
    /// Squared defects by run of a scheme and invariant.
    defects: Vec<Vec<Moments>>,
    /// By observable: φ of the reference, and for every run of a scheme φ and its difference to the
    /// reference.
    weak: Vec<WeakSums>,
}

struct WeakSums {
    reference: Moments,
    values: Vec<Moments>,
    differences: Vec<Moments>,
}

impl<'a, const D: usize> Ends<'a, D> {
    pub(crate) fn new(sight: Sight<'a, D>) -> Self {
        let runs = sight.schemes * sight.levels;
        let none = || vec![Moments::default(); runs];
        let sums = Sums {
            levels: sight.levels,
            squares: vec![CrossMoments::new(sight.levels); sight.schemes],
            defects: vec![vec![Moments::default(); sight.invariants]; runs],
            weak: sight
                .observables
                .iter()
                .map(|_| WeakSums {
                    reference: Moments::default(),
                    values: none(),
                    differences: none(),
                })
                .collect(),
        };
        Self { sight, sums }
    }

    fn observe_path(&mut self, states: &[real::Block<D>], p: usize) {
        let sight = self.sight;
        let exact = states[0].path(p);
        let of_run = |run: usize| states[sight.references + run].path(p);
        for (s, squares) in self.sums.squares.iter_mut().enumerate() {
            let square = |l: usize| {
                let y = of_run(s * sight.levels + l);
                (0..D).map(|i| (y[i] - exact[i]) * (y[i] - exact[i])).sum()
            };
            squares.add(&(0..sight.levels).map(square).collect::<Vec<f64>>());
        }
        for (run, defects) in self.sums.defects.iter_mut().enumerate() {
            for (index, squares) in defects.iter_mut().enumerate() {
                let defect = (sight.defect)(index, of_run(run));
                squares.add(defect * defect);
            }
        }
        for (sums, observable) in self.sums.weak.iter_mut().zip(sight.observables) {
            let mut reference = (observable.function)(exact);
            if sight.references > 1 {
                // An error Cτ + O(τ²) of the expectation is C·2τ + O(τ²) at twice the step.
                reference = 2.0 * reference - (observable.function)(states[1].path(p));
            }
            sums.reference.add(reference);
            for (run, (value, difference)) in
                sums.values.iter_mut().zip(&mut sums.differences).enumerate()
            {
                let phi = (observable.function)(of_run(run));
                value.add(phi);
                difference.add(phi - reference);
            }
        }
    }
}

impl Sums {
    /// Squared errors of scheme s by step size.
    pub(crate) fn squares(&self, s: usize) -> &CrossMoments {
        &self.squares[s]
    }

    /// Root-mean-square defects of scheme s at step size l.
    pub(crate) fn defects(&self, s: usize, l: usize) -> Vec<f64> {
        self.defects[s * self.levels + l].iter().map(|squares| squares.mean().sqrt()).collect()
    }

    /// φ number f of the reference.
    pub(crate) fn reference(&self, f: usize) -> Moments {
        self.weak[f].reference
    }

    /// φ number f of scheme s at step size l: itself, and its difference to the reference.
    pub(crate) fn weak(&self, f: usize, s: usize, l: usize) -> (Moments, Moments) {
        let run = s * self.levels + l;
        (self.weak[f].values[run], self.weak[f].differences[run])
    }
}

impl<const D: usize> Statistic<D> for Ends<'_, D> {
    fn observe(&mut self, view: &View<'_, D>) {
        if view.time == self.sight.last_time {
            for p in view.live.paths() {
                self.observe_path(view.states, p);
            }
        }
    }

    fn merge(&mut self, later: Self) {
        for (sum, more) in self.sums.squares.iter_mut().zip(&later.sums.squares) {
            sum.merge(more);
        }
        let moments = |sum: &mut [Moments], more: &[Moments]| {
            sum.iter_mut().zip(more).for_each(|(sum, more)| sum.merge(*more));
        };
        for (sum, more) in self.sums.defects.iter_mut().zip(&later.sums.defects) {
            moments(sum, more);
        }
        for (sum, more) in self.sums.weak.iter_mut().zip(&later.sums.weak) {
            sum.reference.merge(more.reference);
            moments(&mut sum.values, &more.values);
            moments(&mut sum.differences, &more.differences);
        }
    }
}
