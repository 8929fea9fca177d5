//! Problems with exactly known answers, and how often the answers of `mc::Expect` and of
//! `analysis::strong_order` and `weak_order` are true.
//!
//! An [`Entry`] is a question with its truth, a closed form, and settings as a user would choose
//! them. It is asked with many seeds. An answer that is *stated* may be false, in the share
//! [`Question::tolerated`] at most. An answer that is *undecided* says so and is not false, but too
//! many of them are no use.
//!
//! Some entries have a twin: what an older rule states of the same samples. The library must refute
//! it, or it could not tell.

mod errors;
mod kubo;
mod law;
mod normal;
mod orders;
mod rare;
mod sphere;
mod summary;
pub(crate) mod system;

use std::fmt::Display;

use mc::{
    Expect, Observable, Setup,
    expect::{Estimate, Expectation},
    parts::Job,
};
use noise::{StreamKey, Truncation};
use schemes::Scheme;
use systems::Problem;

use system::{Chosen, Rate};
use verify::streams;

use summary::Counted;
pub use summary::{Row, Total, by_kind, by_old_rule};

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Question {
    /// The strong order of a scheme, with the defaults of [`analysis::StepSizes::new`].
    StrongOrder,
    /// Its weak order.
    WeakOrder,
    /// Its root-mean-square error at a step size.
    StrongError,
    /// E[φ(y(T))] with a given scheme, on random points.
    Expectation,
    /// E[φ(y(T))] with everything chosen, by [`mc::Expect`].
    Chosen,
}

impl Question {
    /// The share of the stated answers that may be false: none of the orders that are named has to
    /// be, and an interval at 95 % may miss in a few more than 5 %.
    pub fn tolerated(self) -> f64 {
        match self {
            Self::StrongOrder | Self::WeakOrder => 0.01,
            Self::StrongError | Self::Expectation | Self::Chosen => 0.07,
        }
    }

    /// The words for tables.
    pub fn words(self) -> &'static str {
        match self {
            Self::StrongOrder => "strong order",
            Self::WeakOrder => "weak order",
            Self::StrongError => "strong error",
            Self::Expectation => "expectation",
            Self::Chosen => "expectation, all chosen",
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
    fn order(order: f64) -> Self {
        Self::Interval(order, order)
    }

    fn undecided(reason: impl Display) -> Self {
        Self::Undecided(reason.to_string())
    }

    fn decided(&self) -> bool {
        !matches!(self, Self::Undecided(_))
    }

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

/// One answer.
pub struct Answer {
    /// What is stated.
    pub stated: Stated,
    /// What the old rule states, if the entry has one.
    pub old: Option<Stated>,
    /// Path-steps.
    pub cost: u64,
}

impl Answer {
    /// Of a question that is refused.
    fn refused(error: impl Display) -> Self {
        Self { stated: Stated::undecided(error), old: None, cost: 0 }
    }
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
    /// The old rule that is its twin.
    pub old_rule: Option<OldRule>,
    /// Its place in the library, which says which noise it has.
    number: u64,
    /// Whether an answer takes seconds: it is asked with every fourth seed.
    slow: bool,
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
        old_rule: Option<OldRule>,
        ask: impl Fn(StreamKey) -> Answer + Send + Sync + 'static,
    ) -> Self {
        let (name, ask) = (name.into(), Box::new(ask));
        Self { kind, name, question, truth, old_rule, number: 0, slow: false, ask, chosen: None }
    }
}

impl Entry {
    /// The entry that asks for the same expectation with everything chosen.
    fn take_chosen(&mut self) -> Option<Self> {
        let Self { kind, truth, .. } = *self;
        let (name, question) = (self.name.clone(), Question::Chosen);
        let ask = self.chosen.take()?;
        let (old_rule, number, slow, chosen) = (None, 0, false, None);
        Some(Self { kind, name, question, truth, old_rule, number, slow, ask, chosen })
    }
}

/// A rule that was in use, and what it states of the same samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OldRule {
    /// Standard errors and the bias alone: a sample variance of zero is believed.
    NothingMissed,
    /// Nothing asks whether the steps resolve the motion: the levels of the pilot and one more.
    NoResolution,
    /// The order nearest to the fitted slope.
    FittedSlope,
    /// Errors against the finest run of the same scheme.
    FinestRun,
}

impl OldRule {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::NothingMissed, Self::NoResolution, Self::FittedSlope, Self::FinestRun];

    /// The words for tables.
    pub fn words(self) -> &'static str {
        match self {
            Self::NothingMissed => "a variance of zero is believed: no missed events",
            Self::NoResolution => "nobody asks whether the steps resolve the motion",
            Self::FittedSlope => "the order is the multiple of ½ that is nearest to the slope",
            Self::FinestRun => "errors against the finest run of the same scheme",
        }
    }

    /// The interval of an expectation by this rule, if it is short enough.
    fn interval(estimate: &Estimate, accuracy: f64) -> Stated {
        let half_width = Estimate { missed: 0.0, ..estimate.clone() }.half_width();
        if half_width <= accuracy {
            Stated::Interval(estimate.value - half_width, estimate.value + half_width)
        } else {
            Stated::undecided("the interval is too long")
        }
    }
}

/// All entries.
pub fn entries() -> Vec<Entry> {
    let mut entries = Vec::new();
    for part in [
        orders::entries,
        errors::entries,
        kubo::entries,
        normal::entries,
        sphere::entries,
        rare::entries,
    ] {
        entries.extend(part());
    }
    let chosen: Vec<Entry> = entries.iter_mut().filter_map(Entry::take_chosen).collect();
    entries.extend(chosen);
    entries.iter_mut().zip(0..).for_each(|(entry, number)| entry.number = number);
    entries
}

/// Asks these entries with the seeds 1 … `seeds`, as work of `job`: `None` where that gives no
/// results. An entry has the same streams in any selection.
///
/// The answers are functions of the entries and seeds alone.
pub fn ask(entries: &[Entry], seeds: u64, job: &Job) -> Option<Vec<Row>> {
    // By seed: more of them are further tasks.
    let asked = |seed: u64| {
        entries.iter().filter(move |entry| !entry.slow || seed % 4 == 1).map(move |e| (e, seed))
    };
    let questions: Vec<(&Entry, u64)> = (1..=seeds).flat_map(asked).collect();
    let answer = |n: u64| {
        let (entry, seed) = questions[n as usize];
        let answer = (entry.ask)(StreamKey { seed, experiment: streams::LIBRARY + entry.number });
        Some(Counted::new(entry, &answer))
    };
    let names: Vec<String> =
        entries.iter().map(|entry| format!("{:?} {}", entry.question, entry.name)).collect();
    let answers = job.tasks("library", &names.join("\n"), questions.len() as u64, answer)?;
    let row = |entry: &Entry| {
        let of_entry = questions.iter().zip(&answers).filter(|(of, _)| of.0.number == entry.number);
        Row::new(entry, of_entry.map(|(_, counted)| counted))
    };
    Some(entries.iter().map(row).collect())
}

/// How E[φ] is asked for.
#[derive(Clone, Copy)]
struct How {
    accuracy: f64,
    steps: u64,
    old_rule: Option<OldRule>,
}

impl How {
    /// With eight coarsest steps.
    fn to(accuracy: f64) -> Self {
        Self { accuracy, steps: 8, old_rule: None }
    }

    fn against(self, old_rule: OldRule) -> Self {
        Self { old_rule: Some(old_rule), ..self }
    }
}

/// Truncation k of everything here, the one that the guide recommends.
fn truncation() -> Truncation {
    systems::paper::valid(Truncation::new(4))
}

/// Most levels of an expectation, and path-steps that it may cost: seconds.
const MAX_LEVEL: usize = 12;
const MAX_COST: u64 = 30_000_000;
/// Path-steps of the pilot for each of the coarsest steps, with two noises at most.
const PILOT_STEPS: u64 = 32 * 128 * (1 + 5 + 10 + 20);

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
    how: How,
    truth: f64,
) -> Entry
where
    S: Chosen<D, M> + Clone + 'static,
    X: Scheme<S, D, M> + 'static,
{
    let same = problem.clone();
    let chosen = move |key: StreamKey| {
        let observable = Observable { name: "φ", function };
        let expect = S::expect(&same).with_key(key).with_max_cost(MAX_COST);
        match expect.run(&[&observable], how.accuracy, &|_| ()) {
            Ok(result) => Answer { stated: stated(&result), old: None, cost: result.cost },
            Err(error) => Answer::refused(error),
        }
    };
    let ask = move |key: StreamKey| {
        let observable = Observable { name: "φ", function };
        let run = |max_level: usize, max_cost: u64| {
            let expect = Expect::with_scheme(Setup::of(&problem, &scheme)).with_random_points();
            let expect = expect.with_key(key).with_truncation(truncation());
            let expect = expect.with_coarsest_steps(how.steps).with_max_level(max_level);
            expect.with_max_cost(max_cost).run(&[&observable], how.accuracy, &|_| ())
        };
        let result = match run(MAX_LEVEL, MAX_COST) {
            Ok(result) => result,
            Err(error) => return Answer::refused(error),
        };
        let stated = stated(&result);
        // An old rule stopped where the one in use goes on.
        let limits = |rule| match rule {
            OldRule::NothingMissed => (MAX_LEVEL, PILOT_STEPS * how.steps),
            _ => (3, MAX_COST),
        };
        let old = how.old_rule.map(limits).map(|(level, cost)| match run(level, cost) {
            Ok(result) => OldRule::interval(&result.estimates[0], how.accuracy),
            Err(error) => Stated::undecided(error),
        });
        Answer { stated, old, cost: result.cost }
    };
    let entry = Entry::new(kind, name, Question::Expectation, Some(truth), how.old_rule, ask);
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
