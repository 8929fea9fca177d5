//! Whether chains stay in wells that an average depends on.
//!
//! Chains begin with too much noise, so that they fall into all wells, but not as often as the
//! stationary law has them. Where they do not cross, the chains that are in a well weigh it. An
//! average that depends little on the well does not show this by itself. So components, sums of
//! them and functions such as H₀ are watched, once in a batch at the longest step.
//!
//! With the mean a of a watched function over the first quarter of the time that is kept and the
//! mean b of an average over the rest, of each of n chains, z = r√(n − 1) with their correlation r
//! has variance one if the average forgets. A function **keeps** its wells where z of its own a and
//! b is more than 4, and an average **depends** on them where |z| is more than √(9 + 2 ln m) for
//! the m functions that keep theirs. An angle that diffuses without bound
//! keeps its value, but tells nothing about what comes later of cos q or p. Where a watched
//! function is conserved and differs from chain to chain, initial values are random parameters on
//! purpose, and nothing is tested.

use std::ops::Range;

use real::{PathMask, Row, WIDTH, elementary::ln};

use super::{
    chains::{Living, moments},
    rules::{CONSERVED, DEPENDS, KEEPS},
};
use mc::Observe;

/// Largest number of watched components, and of values of all chains in a batch.
const MAX_COMPONENTS: usize = 61;
const MAX_VALUES: usize = 1 << 18;
/// Number of sums over every third component: the directions of spins.
const SUMS: usize = 3;
/// Part of a mean up to which a deviation is round-off.
const ROUND_OFF: f64 = 1e-9;
/// Time between the middles of a quarter and the rest, over that of both.
const LAG: f64 = 0.5;

/// Functions of the state that are watched.
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    /// Functions such as H₀.
    pub functions: &'a [&'a dyn Observe],
    /// Names of the components of the state.
    pub names: &'a [String],
    /// Number of components of the state, and of chains.
    pub dimension: usize,
    pub chains: usize,
}

/// A well that chains keep and an average depends on.
pub struct Well {
    /// The function that tells wells apart.
    pub of: String,
    /// Length of a chain in times of crossing.
    pub crossings: f64,
}

impl Watched<'_> {
    /// The components that are watched, spread over all.
    fn components(&self) -> impl Iterator<Item = usize> {
        let shown = self.dimension.min((MAX_VALUES / self.chains).clamp(1, MAX_COMPONENTS));
        let dimension = self.dimension;
        (0..shown).map(move |k| k * dimension / shown)
    }

    /// Number of sums; zero where they would be components.
    fn sums(&self) -> usize {
        if self.dimension > SUMS { SUMS } else { 0 }
    }

    pub fn names(&self) -> Vec<String> {
        let components = self.components().map(|i| self.names[i].clone());
        let sums = (0..self.sums()).map(|first| {
            let two: Vec<&str> =
                self.names.iter().skip(first).step_by(SUMS).take(2).map(String::as_str).collect();
            format!("{} + …", two.join(" + "))
        });
        let functions = self.functions.iter().map(|function| function.name().to_owned());
        components.chain(sums).chain(functions).collect()
    }

    /// Values of the watched functions at 32 states.
    pub fn values(&self, y: &[Row]) -> Vec<Row> {
        let mut rows: Vec<Row> = self.components().map(|i| y[i]).collect();
        let mut sums = [[0.0; WIDTH]; SUMS];
        for (i, y) in y[..self.dimension].iter().enumerate() {
            sums[i % SUMS].iter_mut().zip(y).for_each(|(sum, y)| *sum += y);
        }
        rows.extend(&sums[..self.sums()]);
        rows.extend(self.functions.iter().map(|function| function.values(y, PathMask::ALL)));
        rows
    }

    /// The well that each of the first `count` averages in the rows from `main` on depends on, from
    /// batch number `first` on; `own` if those show wells themselves. `watched` is the first row of
    /// watched functions.
    pub fn wells(
        &self,
        living: &Living<'_>,
        (count, own, main, watched): (usize, bool, usize, usize),
        first: usize,
    ) -> Vec<Option<Well>> {
        let all = living.batches.len();
        let quarter = first + (all - first) / 4;
        let means = |row: usize, batches: Range<usize>| -> Vec<f64> {
            living.means(row, batches).collect()
        };
        let names = self.names();
        let ends = |row: usize| [first - 1, all - 1].map(|end| means(row, end..end + 1));
        if (watched..watched + names.len()).any(|row| is_conserved(&ends(row))) {
            return (0..count).map(|_| None).collect();
        }
        // Those that keep their wells, with what they were early.
        let root = (living.chains.len() as f64 - 1.0).sqrt();
        let keeps = |(k, name): (usize, &String)| {
            let early = means(watched + k, first - 1..quarter);
            let r = correlation(&early, &means(watched + k, quarter..all));
            (r * root > KEEPS).then(|| (name.clone(), early, r))
        };
        let keeping: Vec<_> = names.iter().enumerate().filter_map(keeps).collect();
        let least = (DEPENDS + 2.0 * ln(keeping.len().max(1) as f64)).sqrt();
        let well = |k: usize| {
            let late = means(main + k, quarter..all);
            let itself = correlation(&means(main + k, first..quarter), &late);
            let itself = (own && itself * root > KEEPS).then_some(("it", itself, itself));
            let (of, _, r) = keeping
                .iter()
                .map(|(name, early, r)| (&**name, correlation(early, &late).abs(), *r))
                .filter(|(_, depends, _)| depends * root > least)
                .chain(itself)
                .max_by(|a, b| a.1.total_cmp(&b.1))?;
            // The correlation falls by e in a time of crossing.
            Some(Well { of: of.into(), crossings: -ln(r) / LAG })
        };
        (0..count).map(well).collect()
    }
}

/// Whether the values of chains are the same early and late, and differ from chain to chain.
fn is_conserved([early, late]: &[Vec<f64>; 2]) -> bool {
    let (spread, _) = spread(early);
    let change = early.iter().zip(late).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    spread > 0.0 && change <= CONSERVED * spread
}

/// The deviation, zero if it is round-off, and the mean.
fn spread(values: &[f64]) -> (f64, f64) {
    let moments = moments(values.iter().copied());
    let (deviation, mean) = (moments.variance().sqrt(), moments.mean());
    (if deviation > ROUND_OFF * mean.abs() { deviation } else { 0.0 }, mean)
}

/// The correlation of values of chains; zero if one does not vary.
fn correlation(early: &[f64], late: &[f64]) -> f64 {
    let ((a, mean_a), (b, mean_b)) = (spread(early), spread(late));
    let products = early.iter().zip(late).map(|(x, y)| (x - mean_a) / a * ((y - mean_b) / b));
    if a * b > 0.0 { products.sum::<f64>() / (early.len() as f64 - 1.0) } else { 0.0 }
}
