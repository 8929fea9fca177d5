//! Problems with exactly known answers, and how often the answers of `expectation::Expect` and of
//! `analysis::strong_order` and `weak_order` are true.
//!
//! An [`Entry`] is a question with its truth, a closed form, and settings as a user would choose
//! them. It is asked with many seeds. An answer that is *stated* may be false, in the share
//! [`Question::tolerated`] at most. An answer that is *undecided* says so and is not false, but too
//! many of them are no use.

mod kubo;
mod law;
mod normal;
mod orders;
mod sphere;
pub mod system;

use std::fmt::Display;

use expectation::{Expect, ExpectSettings, Expectation};
use mc::{Observable, Setup};
use noise::{StreamKey, Truncation};
use rayon::prelude::*;
use schemes::Scheme;
use statrs::distribution::{Binomial, DiscreteCDF};
use systems::Problem;
use verify::streams;

use system::{Chosen, Rate};

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Question {
    /// The strong order of a scheme, with the defaults of [`analysis::StepSizes::new`].
    StrongOrder,
    /// Its weak order.
    WeakOrder,
    /// E[φ(y(T))] with a given scheme, on random points.
    Expectation,
    /// E[φ(y(T))] with everything chosen, by [`expectation::Expect`].
    Chosen,
}

impl Question {
    /// The share of the stated answers that may be false: none of the orders that are named has to
    /// be, and an interval at 95 % may miss in a few more than 5 %.
    pub fn tolerated(self) -> f64 {
        match self {
            Self::StrongOrder | Self::WeakOrder => 0.01,
            Self::Expectation | Self::Chosen => 0.07,
        }
    }
}

/// A number or an order; none where the scheme converges to something else, and has no order.
type Truth = Option<f64>;

/// What is said.
pub enum Stated {
    /// From and to; an order is an interval of one number.
    Interval(f64, f64),
    /// The scheme converges to something else.
    NoOrder,
    /// Nothing, for this reason.
    Undecided(String),
}

/// Rounding errors of a truth, relative to one.
const ROUNDING: f64 = 1e-13;

impl Stated {
    /// Whether something false is stated.
    fn misses(&self, truth: Truth) -> bool {
        match (self, truth) {
            (Self::Undecided(_), _) | (Self::NoOrder, None) => false,
            (&Self::Interval(lo, hi), Some(truth)) => {
                !(lo - ROUNDING..=hi + ROUNDING).contains(&truth)
            }
            _ => true,
        }
    }
}

/// What is stated, and its path-steps.
type Answer = (Stated, u64);

/// Of a question that is refused.
fn refused(error: impl Display) -> Answer {
    (Stated::Undecided(error.to_string()), 0)
}

/// Answers with the noise of a key.
type Ask = Box<dyn Fn(StreamKey) -> Answer + Send + Sync>;

/// A question with a known answer.
pub struct Entry {
    /// What sort of problem it is.
    pub kind: &'static str,
    /// The problem.
    pub name: String,
    /// What is asked.
    pub question: Question,
    /// What is true: a number or an order, none where there is no order.
    pub truth: Option<f64>,
    /// Its place in the library, which says which noise it has.
    number: u64,
    ask: Ask,
    /// The same expectation with everything chosen.
    chosen: Option<Ask>,
}

impl Entry {
    fn new(
        kind: &'static str,
        name: impl Into<String>,
        question: Question,
        truth: Truth,
        ask: impl Fn(StreamKey) -> Answer + Send + Sync + 'static,
    ) -> Self {
        let (name, ask) = (name.into(), Box::new(ask));
        Self { kind, name, question, truth, number: 0, ask, chosen: None }
    }

    /// The entry that asks for the same expectation with everything chosen.
    fn take_chosen(&mut self) -> Option<Self> {
        let Self { kind, truth, .. } = *self;
        let (name, question) = (self.name.clone(), Question::Chosen);
        let ask = self.chosen.take()?;
        Some(Self { kind, name, question, truth, number: 0, ask, chosen: None })
    }
}

/// All entries.
pub fn entries() -> Vec<Entry> {
    let mut entries = Vec::new();
    for part in
        [orders::entries, kubo::entries, normal::entries, sphere::entries, normal::rare_entries]
    {
        entries.extend(part());
    }
    let chosen: Vec<Entry> = entries.iter_mut().filter_map(Entry::take_chosen).collect();
    entries.extend(chosen);
    entries.iter_mut().zip(0..).for_each(|(entry, number)| entry.number = number);
    entries
}

/// Asks these entries with the seeds 1 … `seeds`, or with fewer where answers have taken `most`
/// path-steps. An entry has the same streams in any selection.
pub fn ask(entries: &[Entry], seeds: u64, most: u64) -> Vec<Total> {
    let total = |entry: &Entry| {
        let mut total = Total::default();
        for seed in 1..=seeds {
            if total.cost > most {
                break;
            }
            let key = StreamKey { seed, experiment: streams::LIBRARY + entry.number };
            total.add(entry.truth, (entry.ask)(key));
        }
        total
    };
    entries.par_iter().map(total).collect()
}

/// Counts of answers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Total {
    /// Answers.
    pub asked: u64,
    /// Those that state something.
    pub stated: u64,
    /// Those that state something false.
    pub missed: u64,
    /// Path-steps of all.
    pub cost: u64,
    /// A reason for an undecided answer.
    pub reason: String,
    /// Sum of the half-widths of the stated intervals.
    half_widths: f64,
    /// Sums of the squares and of the fourth powers of the distances of their middles from the
    /// truth.
    powers: [f64; 2],
}

impl Total {
    fn add(&mut self, truth: Truth, (stated, cost): Answer) {
        self.asked += 1;
        self.cost += cost;
        self.missed += u64::from(stated.misses(truth));
        if let (&Stated::Interval(lo, hi), Some(truth)) = (&stated, truth) {
            self.half_widths += 0.5 * (hi - lo);
            let square = (0.5 * (lo + hi) - truth).powi(2);
            self.powers[0] += square;
            self.powers[1] += square * square;
        }
        match stated {
            Stated::Undecided(reason) => self.reason = reason,
            _ => self.stated += 1,
        }
    }

    /// The mean half-width over 1.96 times the root mean square of the errors, one for intervals of
    /// normal errors without bias; and its relative standard error, half of that of the mean
    /// square.
    pub fn relative_width(&self) -> (f64, f64) {
        let n = self.stated as f64;
        let [square, fourth] = self.powers.map(|sum| sum / n);
        let width = self.half_widths / n / (1.96 * square.sqrt());
        (width, 0.5 * ((fourth / (square * square) - 1.0) / n).sqrt())
    }

    /// Whether the share of false answers is above `tolerated`.
    pub fn refuted(&self, tolerated: f64, chance: f64) -> bool {
        above(tolerated, chance, self.missed, self.stated)
    }
}

/// Whether a share is above `tolerated`: with that share, so many of all have a probability of at
/// most `chance`.
pub fn above(tolerated: f64, chance: f64, these: u64, all: u64) -> bool {
    let at_least = || Binomial::new(tolerated, all).map(|law| law.sf(these - 1));
    these > 0 && at_least().is_ok_and(|probability| probability <= chance)
}

#[test]
fn binomial_tails() {
    assert!(!above(0.07, 0.01, 1, 20) && above(0.07, 0.01, 6, 20));
    // P(X ≥ 1) = 1 − 0.93²⁰.
    let tail = 1.0 - 0.93f64.powi(20);
    assert!(above(0.07, 1.0001 * tail, 1, 20) && !above(0.07, 0.9999 * tail, 1, 20));
}

/// How E[φ] is asked for.
#[derive(Clone, Copy)]
struct How {
    accuracy: f64,
    steps: u64,
}

/// With eight coarsest steps.
impl From<f64> for How {
    fn from(accuracy: f64) -> Self {
        Self { accuracy, steps: 8 }
    }
}

/// Truncation k of everything here, the one that the guide recommends.
fn truncation() -> Truncation {
    systems::paper::valid(Truncation::new(4))
}

/// Most levels of an expectation, and path-steps that it may cost: seconds.
const MAX_LEVEL: usize = 12;
const MAX_COST: u64 = 30_000_000;

/// 1 where an event happens, else 0.
fn indicator(happens: bool) -> f64 {
    f64::from(u8::from(happens))
}

/// The problem E[φ(y(T))] = `truth`, asked of `scheme`.
fn expected<S, X, const D: usize, const M: usize>(
    (kind, name): (&'static str, impl Into<String>),
    scheme: X,
    problem: Problem<S, Rate, D>,
    function: fn([f64; D]) -> f64,
    how: impl Into<How>,
    truth: f64,
) -> Entry
where
    S: Chosen<D, M> + Clone + 'static,
    X: Scheme<S, D, M> + 'static,
{
    let (observable, how) = (Observable { name: "φ", function }, how.into());
    let answer = move |expect: Expect<'_>| match expect.run(&[&observable], how.accuracy) {
        Ok(result) => (stated(&result), result.cost),
        Err(error) => refused(error),
    };
    let same = problem.clone();
    let with = |key| ExpectSettings { key, max_cost: MAX_COST, ..Default::default() };
    let chosen = move |key: StreamKey| answer(S::expect(&same).with(with(key)));
    let ask = move |key: StreamKey| {
        let settings = ExpectSettings {
            truncation: truncation(),
            random_points: true,
            coarsest_steps: how.steps,
            max_level: MAX_LEVEL,
            ..with(key)
        };
        answer(Expect::with_scheme(Setup::of(&problem, &scheme)).with(settings))
    };
    let entry = Entry::new(kind, name, Question::Expectation, Some(truth), ask);
    Entry { chosen: Some(Box::new(chosen)), ..entry }
}

/// The interval of the only φ, if it may be believed.
fn stated(result: &Expectation) -> Stated {
    if result.reached() {
        let (lo, hi) = result.estimates[0].interval();
        return Stated::Interval(lo, hi);
    }
    let reasons: Vec<String> = result.warnings.iter().map(ToString::to_string).collect();
    Stated::Undecided(reasons.join("; "))
}
