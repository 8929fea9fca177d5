//! Averages over the stationary law of a system, with intervals that have the error of the step in
//! them, and Lyapunov exponents.
//!
//! ```
//! use mc::{Observable, Setup};
//! use schemes::SexpLi;
//! use stationary::{Equilibrium, EquilibriumSettings};
//! use systems::{Constant, Pendulum, Problem};
//!
//! // y₁ turns under noise that its damping balances.
//! let problem = Problem::new(Pendulum::new(0.5)?, Constant::new(0.5)?, [0.2, 0.0], 16.0)?;
//! let scheme = SexpLi::new(problem.system(), problem.y0())?;
//! let kinetic = Observable { name: "y2²", function: |y: [f64; 2]| y[1] * y[1] };
//! let settings = EquilibriumSettings { chains: 32, ..EquilibriumSettings::new(160) };
//! let averages = Equilibrium::new(Setup::of(&problem, &scheme), settings);
//! let found = averages.run(&[&kinetic], 0.2)?;
//! assert!(found.reached() && found.means[0].half_width() < 0.2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Exact.** Where e^{−βH₀} is known to be stationary and flows are known, [`Metropolis`] makes
//! steps without a bias, see [`Equilibrium::exact`]. Everything about the bias below is for other
//! schemes.
//!
//! **Chains.** Some hundred independent paths run for a long time at 4τ, and the first of them also
//! at 2τ and τ with the same noise, as many as their variance over their cost asks for. The time
//! average of a chain is one sample: the standard error follows from the chains, not from a model
//! of their correlation. An average is that at 4τ over all chains and the mean of differences over
//! the first. Chains go on in
//! 32 batches of time; when these are full, two and two are joined, and the next 16 double the
//! time.
//!
//! **Where chains begin.** At the initial value, and then with the noise of every second, third and
//! fourth chain of four multiplied by 2, 3 and 4 for the time of the first batches, so that chains
//! begin far apart, in different wells, and on the leaf of the Casimirs. A chain that fails there
//! begins at the initial value.
//!
//! **Burn-in.** The last batch of the first half is sought whose mean over the chains differs from
//! that of the second half, by 3.5 standard errors, or whose variance over the chains is three
//! times as large. Twice the batches up to that one are left out; at least one, and at most half of
//! all.
//!
//! **Autocorrelation time** t = T Var(m)/2σ² with the variance of the mean m of a chain over the
//! time T and that of the observable: T/2t samples of a chain are as good as independent ones. It
//! contains the slowest motion that the average sees. Of an exponent the variance of a chain is at
//! most three times that of independent batches. Wells that chains keep are looked for in
//! components and other functions, whatever is averaged.
//!
//! **Exponents** are those of vectors in general directions, which begin anew with the first batch
//! that counts. A growth like a power of t is told from one that is exponential.
//!
//! **Bias of the step.** With the means m₀, m₁, m₂ at 4τ, 2τ, τ and the weak order p the bias of
//! m₂ is at most b = (m₂ − m₀)/(4ᵖ − 1), if it falls by 2ᵖ from a step to the next. Or e =
//! m₂ + c(m₂ − m₁) with c = 1/(2ᵖ − 1) is taken, and b = c(e − e′) with e′ from m₀ and m₁, if the
//! error of e falls by as much. The interval joins those of e + b and e − b, each with its standard
//! error over the chains; the shorter one of both ways is taken. Where m₁ − m₂ is significantly
//! more than m₀ − m₁ over 0.85·2ᵖ, or of the other sign, b = |m₀ − m₁| + |m₁ − m₂|. The steps are
//! halved where b is more than half of the sampling error, so that errors are as large as an
//! interval says, or where chains fail.
//!
//! **What nobody can tell** is said: averages that are not finite; chains that still drift, that
//! are shorter than twenty autocorrelation times, stay in wells that the average depends on, of
//! which a few decide, or of which more than one in a hundred failed. A well that no chain has
//! found is not known.

mod chains;
mod growth;
mod metropolis;
mod report;
mod rules;
mod tangents;
mod wells;

use std::sync::Arc;

use noise::{Purpose, StreamKey, Truncation};
use real::{Row, WIDTH};

use chains::{BATCHES, BINS, Chains, Gather, SPREADING};
use expectation::{ExpectSettings, Told};
use mc::{Checkpoint, Observe, Problem, RunError, Setup, demand, parts::Stop};
use rules::{HEAT, MAX_REVIVALS};
use wells::Watched;

pub use metropolis::Metropolis;
pub use report::{Averages, StationaryMean};
pub use tangents::Tangents;

/// The quantities that are averaged along chains.
#[derive(Clone, Copy)]
pub(crate) enum Averaged<'a> {
    /// Test functions, differentiated by some parameters.
    Of(&'a [&'a dyn Observe], &'a [Slope<'a>]),
    /// The last rows of a state, by their number, which have grown since the last start.
    Growth(usize),
}

impl<'a> Averaged<'a> {
    pub fn count(self) -> usize {
        match self {
            Self::Of(observables, _) => observables.len(),
            Self::Growth(count) => count,
        }
    }

    /// The parameters by which averages are differentiated.
    pub fn slopes(self) -> &'a [Slope<'a>] {
        if let Self::Of(_, slopes) = self { slopes } else { &[] }
    }

    fn names(self) -> Vec<String> {
        match self {
            Self::Of(observables, _) => observables.iter().map(|phi| phi.name().into()).collect(),
            // Of one, the sum of all is itself.
            Self::Growth(1) => vec!["λ1".into()],
            Self::Growth(count) => {
                (1..count).map(|n| format!("λ{n}")).chain(["their sum".into()]).collect()
            }
        }
    }
}

/// A parameter θ of a stationary law e^{−βH₀}: ∂⟨φ⟩/∂θ = ⟨∂φ/∂θ⟩ − Cov(φ, ∂(βH₀)/∂θ) on leaves that
/// do not depend on θ.
pub struct Slope<'a> {
    /// Name of the parameter.
    pub parameter: String,
    /// ∂(βH₀)/∂θ.
    pub weight: Box<dyn Observe + 'a>,
    /// ∂φ/∂θ of every test function; none if they do not depend on θ.
    pub of: Vec<Box<dyn Observe + 'a>>,
}

/// Settings of an [`Equilibrium`].
#[derive(Clone, Debug)]
pub struct EquilibriumSettings {
    /// The key of all noise, with an experiment number below 2⁴⁰; seed 1 and experiment 0 unless
    /// set.
    pub key: StreamKey,
    /// Truncation of increments of schemes that need it; of order four unless set.
    pub truncation: Truncation,
    /// The weak order of the scheme; one unless set.
    pub weak_order: f64,
    /// Steps τ on [0, T], which become a multiple of 256. The first averages are over T.
    pub steps: u64,
    /// Number of chains, which becomes a multiple of 32; 256 unless set.
    pub chains: u64,
    /// Largest number of path-steps; 10¹⁰ unless set. The computation ends where more are needed.
    pub max_cost: u64,
    /// Flag that ends the computation early, with the averages so far.
    pub stop: Stop,
}

impl EquilibriumSettings {
    /// The settings for `steps` steps on [0, T].
    pub fn new(steps: u64) -> Self {
        let ExpectSettings { key, truncation, max_cost, stop, .. } = ExpectSettings::default();
        Self { key, truncation, weak_order: 1.0, steps, chains: 256, max_cost, stop }
    }

    /// Number of chains in whole blocks.
    fn blocks_of_chains(&self) -> u64 {
        self.chains.next_multiple_of(WIDTH as u64)
    }
}

/// Averages over the stationary law of a problem whose coefficients do not depend on time.
pub struct Equilibrium<'a> {
    /// The problem and its scheme.
    pub setup: Setup<'a>,
    /// Settings of the chains.
    pub settings: EquilibriumSettings,
    /// Callback with the progress, whenever averages are formed.
    pub told: Box<Told<'a>>,
    /// Checkpoint of the chains, written every few seconds. Chains go on from it, with the same
    /// bits; it is removed when the accuracy is reached.
    pub checkpoint: Option<&'a Checkpoint>,
    /// Functions, such as H₀, that show, beside components, whether chains stay in wells.
    pub watched: Vec<&'a dyn Observe>,
    /// Names of the components; y1, y2, … unless set.
    pub components: Vec<String>,
    /// β where steps have no bias, see [`exact`](Self::exact).
    pub beta: Option<f64>,
    /// Parameters by which averages are differentiated, to the same accuracy.
    pub slopes: Vec<Slope<'a>>,
}

/// Number of step sizes of a chain whose step has a bias.
pub(crate) const LEVELS: usize = 3;
/// Largest number of halvings of the steps.
const MAX_HALVINGS: u32 = 20;

impl<'a> Equilibrium<'a> {
    /// Averages of a problem with a scheme.
    pub fn new(setup: Setup<'a>, settings: EquilibriumSettings) -> Self {
        Self {
            setup,
            settings,
            told: Box::new(|_, _| ()),
            checkpoint: None,
            watched: Vec::new(),
            components: Vec::new(),
            beta: None,
            slopes: Vec::new(),
        }
    }

    /// Averages over e^{−βH₀} without a bias of the step.
    pub fn exact(
        problem: Problem<'a>,
        sampler: Metropolis<'a>,
        settings: EquilibriumSettings,
    ) -> Self {
        let (problem, beta) = (Problem { noises: sampler.noises(), ..problem }, sampler.beta);
        let setup = Setup { problem, scheme: Arc::new(sampler) };
        Self { beta: Some(beta), ..Self::new(setup, settings) }
    }

    /// The averages of test functions, each to the half-width `accuracy` of its 95 % interval.
    ///
    /// # Errors
    /// [`RunError`] if a setting is out of range, the scheme cannot be run, all chains would be the
    /// same, the checkpoint is damaged or of another computation, or it was stopped before the
    /// first averages.
    pub fn run(&self, observables: &[&dyn Observe], accuracy: f64) -> Result<Averages, RunError> {
        if observables.is_empty() {
            return Err(RunError::Setting("averages need at least one test function".into()));
        }
        self.averages(&self.setup, Averaged::Of(observables, &self.slopes), accuracy)
    }

    /// The `count` largest Lyapunov exponents, in 1/time, and the sum of several, by [tangent
    /// vectors](Tangents).
    ///
    /// # Errors
    /// As [`run`](Self::run), and if there are fewer components than exponents.
    pub fn lyapunov(&self, count: usize, accuracy: f64) -> Result<Averages, RunError> {
        let most = self.setup.problem.y0.len();
        if self.beta.is_some() {
            let what = "exponents are those of paths, which exact steps do not follow";
            return Err(RunError::Setting(what.into()));
        }
        let allowed = (1..=most).contains(&count);
        let range = "from 1 to that of components";
        RunError::unmet([(allowed, "number of exponents", range, count as f64)])?;
        let rows = if count == 1 { 1 } else { count + 1 };
        let mut setup = self.setup.clone();
        setup.scheme = Arc::new(Tangents { method: setup.scheme, dimension: most, count });
        self.averages(&setup, Averaged::Growth(rows), accuracy)
    }

    fn averages(
        &self,
        setup: &Setup<'_>,
        of: Averaged<'_>,
        accuracy: f64,
    ) -> Result<Averages, RunError> {
        let Self { settings, told, checkpoint, watched: functions, .. } = self;
        self.check(accuracy)?;
        let number = settings.blocks_of_chains() as usize;
        let dimension = setup.problem.y0.len();
        let own: Vec<String> = (1..=dimension).map(|i| format!("y{i}")).collect();
        let names = if self.components.len() == dimension { &self.components } else { &own };
        let watched = Watched { functions, names, dimension, chains: number };
        self.demand(of, watched)?;
        let mut chains =
            checkpoint.map_or(Ok(None), Checkpoint::read)?.unwrap_or_else(|| self.begin(of));
        let averages = |chains: &Chains| {
            let scheme = setup.scheme.about().id;
            Averages::new(chains, settings, (of, scheme, self.beta), accuracy, watched)
        };
        let mut found = chains.has_averages().then(|| averages(&chains));
        let mut reached = false;
        loop {
            if chains.is_due() {
                let now = averages(&chains);
                let half_width = now.half_width();
                told(half_width, (accuracy / half_width).powi(2).min(1.0));
                let halves = now.wants_shorter_steps() && chains.halvings < MAX_HALVINGS;
                // Averages that shorter steps do not make finite.
                let fails = now.fails && halves;
                let few_revivals = chains.halvings < MAX_REVIVALS;
                let helps = few_revivals || 2 * chains.failed() <= chains.failed_before;
                let hopeful = half_width.is_finite() && (!fails || helps) || fails && few_revivals;
                let since = chains.spent - chains.spent_before;
                let limited = now.is_out_of_reach(since, settings.max_cost);
                let (is_reached, wanted) = (now.reached(), now.wanted);
                let paired = wanted.clamp(1.0, number as f64) as usize;
                let paired = paired.next_multiple_of(WIDTH).min(number);
                found = Some(now);
                let shorter = fails || halves && chains.doubled;
                let more = if shorter { 2 * BATCHES } else { BATCHES };
                let ends =
                    chains.spent.saturating_add(self.cost(&chains, more)) > settings.max_cost;
                if !hopeful || ends || chains.doubled && (limited || is_reached && !halves) {
                    reached = is_reached;
                    break;
                }
                if shorter {
                    chains.halve();
                } else if !chains.is_settled && wanted > 0.0 && paired != chains.paired {
                    chains.pair(paired);
                } else if chains.is_full() {
                    chains.is_settled = true;
                    chains.double(of);
                }
            }
            let pilot_cost = chains.spent.saturating_add(self.cost(&chains, 1));
            if chains.number < chains.spread && pilot_cost > settings.max_cost {
                return Err(RunError::PilotCost { pilot_cost, max_cost: settings.max_cost });
            }
            let goes_on = self.advance(setup, (of, watched), &mut chains)?;
            if let Some(checkpoint) = checkpoint.filter(|to| goes_on && to.is_due()) {
                _ = checkpoint.write(&chains);
            }
            if !goes_on {
                break;
            }
        }
        match checkpoint {
            Some(checkpoint) if reached => checkpoint.remove(),
            Some(checkpoint) => _ = checkpoint.write(&chains),
            None => {}
        }
        found.ok_or(RunError::Stopped)
    }

    /// Chains that have not begun.
    fn begin(&self, of: Averaged<'_>) -> Chains {
        let all = self.settings.blocks_of_chains() as usize;
        let sizes = match of {
            _ if self.beta.is_some() => (1, all),
            Averaged::Of(..) => (LEVELS, (all / 4).next_multiple_of(WIDTH)),
            Averaged::Growth(_) => (LEVELS, all),
        };
        Chains::new(&self.settings, of, sizes, self.setup.problem.t_end)
    }

    fn check(&self, accuracy: f64) -> Result<(), RunError> {
        let Self { setup: Setup { problem, .. }, settings, .. } = self;
        let EquilibriumSettings { steps, chains, weak_order, .. } = *settings;
        if problem.silent && problem.initial.is_none() {
            let same = "without noise and with one initial value all chains are the same: give a \
                        law of initial values";
            return Err(RunError::Setting(same.into()));
        }
        let (few, enough) = ((1..=1 << 40).contains(&steps), (32..=1 << 20).contains(&chains));
        RunError::unmet([
            (accuracy > 0.0 && accuracy.is_finite(), "accuracy", "positive and finite", accuracy),
            (few, "number of steps", "from 1 to 2^40", steps as f64),
            (enough, "number of chains", "from 32 to 2^20", chains as f64),
            ((0.5..=8.0).contains(&weak_order), "weak order", "from 1/2 to 8", weak_order),
        ])
    }

    /// Path-steps of `batches` batches.
    fn cost(&self, chains: &Chains, batches: usize) -> u64 {
        let each = chains.each(self.settings.blocks_of_chains());
        chains.batch_steps.saturating_mul(batches as u64).saturating_mul(each)
    }

    /// Refuses chains whose first averages, which need twice the time, take more path-steps than
    /// allowed, or that take more memory than there is.
    fn demand(&self, of: Averaged<'_>, watched: Watched<'_>) -> Result<(), RunError> {
        let (max_cost, begun) = (self.settings.max_cost, self.begin(of));
        let pilot_cost = self.cost(&begun, SPREADING as usize + 2 * BATCHES);
        if pilot_cost > max_cost {
            return Err(RunError::PilotCost { pilot_cost, max_cost });
        }
        let Watched { chains, dimension, .. } = watched;
        let vectors = if let Averaged::Growth(count) = of { count + 1 } else { 1 };
        let rows = begun.rows() + watched.names().len();
        // With batches that are joined, a batch that is gathered, and its histograms.
        let batches =
            3 * BATCHES / 2 * rows + 2 * rows + of.count() * (BINS as usize).div_ceil(WIDTH);
        let kept = batches + 3 * begun.levels * dimension * vectors;
        let what = format!("{chains} chains of {dimension} components");
        Ok(demand(what, 8.0 * kept as f64 * chains as f64)?)
    }

    /// Advances all chains by one batch; false if it was stopped.
    fn advance(
        &self,
        setup: &Setup<'_>,
        (of, watched): (Averaged<'_>, Watched<'_>),
        chains: &mut Chains,
    ) -> Result<bool, RunError> {
        let &EquilibriumSettings { key, truncation, ref stop, .. } = &self.settings;
        let mut batch = setup.clone();
        batch.problem.t_end = chains.tau * chains.batch_steps as f64;
        let family = (key, Purpose::Batch(chains.number));
        let (number, paired) = (self.settings.blocks_of_chains(), chains.paired as u64);
        let known = &*chains;
        // The states of a block at first.
        let first = |path| setup.scheme.start(&setup.problem.start(key, path)).state().to_vec();
        // Chains that choose their step come to rest again.
        let heated = if self.beta.is_some() { SPREADING / 2 } else { SPREADING };
        let (mut blocks, mut failures) = (Vec::new(), Vec::new());
        let all = [(0..paired, known.levels), (paired..number, 1)];
        for (paths, levels) in all.into_iter().filter(|(paths, _)| !paths.is_empty()) {
            let steps = known.batch_steps << (levels - 1);
            let count = paths.end - paths.start;
            let mut ladder = batch.ladder(steps, levels - 1, truncation, family, count)?;
            if known.number < heated {
                ladder = ladder.heated(|path| HEAT[path as usize % HEAT.len()]);
            }
            let ladder = ladder.starting(|run, path| {
                known
                    .states(run, path, watched.dimension)
                    .map_or_else(|| first(path), <[Row]>::to_vec)
            });
            let new =
                || Gather { of, levels, chains: known, blocks: Vec::new(), weights: Vec::new() };
            let found = ladder.run_until(stop, paths.start, count, new);
            blocks.extend(found.statistic.blocks);
            failures.extend(found.failures);
        }
        if stop.is_asked() {
            return Ok(false);
        }
        chains.take(blocks, failures, &first, watched);
        if self.beta.is_some() {
            chains.adapt(watched.dimension, setup.problem.t_end / BATCHES as f64);
        }
        Ok(true)
    }
}
