//! Averages over the stationary law, and Lyapunov exponents.

use casimir::{
    inspect::facts::{Growth, gibbs_marginal, growth, is_divergence_free},
    mc::{Friction, RunError},
    plot::figure::{Trace, lines},
    stationary::{self, Averages, EquilibriumSettings, StationaryMean},
};

use crate::{
    prelude::*,
    slopes::{nearby, slopes},
    with_interval,
};
use scenes::{Read, digits, refuse};

/// Averages over the stationary law with 95 % intervals that include the step error:
/// `equilibrium(of=["q^2"], accuracy=1e-3)`. Autocorrelation times, burn-in and histograms are in
/// its JSON.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Equilibrium {
    /// Half-width of the 95 % intervals, instead of that of the scene
    #[cfg_attr(feature = "clap", arg(long, value_name = "ERROR", allow_negative_numbers = true))]
    #[serde(skip)]
    pub accuracy: Option<f64>,
    /// Test functions, instead of those of the scene; several by several `--of`
    #[cfg_attr(feature = "clap", arg(long, value_name = "FUNCTION"))]
    #[serde(skip)]
    pub of: Vec<String>,
    /// Parameters by which averages over exp(-H0/kT) are differentiated; several with commas
    #[cfg_attr(feature = "clap", arg(long, value_delimiter = ',', value_name = "PARAMETER"))]
    #[serde(skip)]
    pub gradient: Vec<String>,
    /// Limits of the chains.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub chains: Chains,
}

/// The largest Lyapunov exponents `"λ1"`, … and `"their sum"`, with 95 % intervals.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Lyapunov {
    /// Number of exponents, from the largest on
    #[cfg_attr(feature = "clap", arg(long, default_value_t = Lyapunov::default().count))]
    pub count: Count,
    /// Half-width of the 95 % intervals
    #[cfg_attr(feature = "clap", arg(
        long,
        value_name = "ERROR",
        allow_negative_numbers = true,
        default_value_t = Lyapunov::default().accuracy
    ))]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub accuracy: f64,
    /// Limits of the chains.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(flatten)]
    pub chains: Chains,
}

impl Default for Lyapunov {
    fn default() -> Self {
        Self { count: Count(1), accuracy: 0.01, chains: Chains::default() }
    }
}

/// Number and length of chains.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Chains {
    /// Number of chains
    #[cfg_attr(feature = "clap", arg(long, default_value_t = Chains::default().chains))]
    pub chains: Count,
    /// Maximum number of path-steps
    #[cfg_attr(feature = "clap", arg(long, default_value_t = Chains::default().path_steps))]
    pub path_steps: Count,
    /// Steps to `until`, for the first averages, instead of those of the scene
    #[cfg_attr(feature = "clap", arg(long, value_parser = scenes::count))]
    #[serde(skip)]
    pub steps: Option<u64>,
    /// Scheme and seed.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(skip)]
    pub scheme: SchemeAndSeed,
}

impl Default for Chains {
    fn default() -> Self {
        let (chains, path_steps) = (Count(256), Count(10_000_000_000));
        Self { chains, path_steps, steps: None, scheme: SchemeAndSeed::default() }
    }
}

impl Chains {
    fn changes(&self, accuracy: Option<f64>) -> Changes {
        let (steps, scheme) = (self.steps, self.scheme.clone());
        Changes { steps, accuracy, scheme, ..Changes::default() }
    }

    fn meaning(&self, exponents: u64) -> String {
        let chains = self.chains.0;
        format!("chains = {chains}\nexponents = {exponents}\nlayout = {LAYOUT}\n")
    }
}

/// Version of the layout of chains in their file.
const LAYOUT: u32 = 4;

impl Verb for Equilibrium {
    const NAME: &'static str = "equilibrium";
    const STORES: Stores = Stores::Samples("chains.bin");

    fn changes(&self) -> Changes {
        let (of, gradient) = (self.of.clone(), self.gradient.clone());
        Changes { of, gradient, ..self.chains.changes(self.accuracy) }
    }

    fn meaning(&self) -> String {
        self.chains.meaning(0)
    }

    fn compute(&self, scene: &Scene, store: &Store<'_>, watch: &Watch) -> Done<Found> {
        average(scene, None, scene.accuracy, (&self.chains, store, watch))
    }
}

impl Verb for Lyapunov {
    const NAME: &'static str = "lyapunov";
    const STORES: Stores = Stores::Samples("chains.bin");

    fn changes(&self) -> Changes {
        self.chains.changes(None)
    }

    fn meaning(&self) -> String {
        self.chains.meaning(self.count.0)
    }

    fn compute(&self, scene: &Scene, store: &Store<'_>, watch: &Watch) -> Done<Found> {
        average(
            scene,
            Some(self.count.0 as usize),
            Some(self.accuracy),
            (&self.chains, store, watch),
        )
    }
}

/// Averages of a scene, or `exponents` Lyapunov exponents.
fn average(
    scene: &Scene,
    exponents: Option<usize>,
    wanted: Option<f64>,
    (chains, store, watch): (&Chains, &Store<'_>, &Watch),
) -> Done<Found> {
    // Without a wish, the first averages that chains are long enough for.
    let accuracy = wanted.unwrap_or(f64::MAX);
    let nearby = if scene.changes.gradient.is_empty() { None } else { Some(nearby(scene)?) };
    let scene = nearby.as_ref().map_or(scene, |nearby| &nearby.scene);
    scene.source.located(check(scene, exponents.is_none()))?;
    let ((mut scheme, mut because), start) = (scheme(scene), Instant::now());
    let (model, run) = (&scene.model, &scene.settings);
    let auto = run.scheme == AUTO;
    // Unless a scheme is named, averages are exact where they can be.
    let exact = (auto && exponents.is_none()).then(|| model.metropolis()).transpose();
    let (exact, inexact) = exact.map_or_else(|reason| (None, Some(reason)), |exact| (exact, None));
    if exact.is_none()
        && auto
        && !model.friction().is_empty()
        && model.scheme(BuiltIn::Baoab).is_ok()
    {
        scheme = BuiltIn::Baoab.id().into();
        because = Some("friction and noise are one exact step, and its weak order is 2".into());
    }
    // Averages need steps that resolve the fastest motion, whatever paths are stored at.
    let resolving = 4.0 * model.fastest() * run.until;
    let steps = match chains.steps {
        None if resolving > 0.0 => run.steps.min(resolving.ceil() as u64),
        _ => run.steps,
    };
    let settings = EquilibriumSettings {
        key: run.key,
        truncation: run.truncation,
        weak_order: BuiltIn::named(&scheme).map_or(1.0, |scheme| scheme.properties().weak),
        chains: chains.chains.0,
        max_cost: chains.path_steps.0,
        stop: watch.stop.clone(),
        ..EquilibriumSettings::new(steps)
    };
    let setup = scene.setup(&scheme)?;
    let mut equilibrium = match exact {
        Some(sampler) => {
            because = None;
            stationary::Equilibrium::exact(setup.problem, sampler, settings)
        }
        None => stationary::Equilibrium::new(setup, settings),
    };
    // That of exact averages is known by now.
    let beta = equilibrium.beta.or_else(|| model.bath()?.beta);
    let kt = beta.map(|beta| 1.0 / beta);
    // Exact moves follow no path, so that chains would leave for ever; others fail.
    if let Some(beta) = equilibrium.beta
        && let Growth::Falls(i) = growth(model.system(), &scene.problem().y0, beta)
    {
        let along = i.map_or(String::new(), |i| format!(" along {}", scene.components[i]));
        let words =
            format!("no stationary law: H0 falls without bound{along}, so that exp(-H0/kT)");
        let remedy = "for functions of an angle name a scheme that follows paths, such as baoab";
        return Err(Failure::Run(format!("{words} has no integral; {remedy}")));
    }
    equilibrium.components.clone_from(&scene.components);
    equilibrium.watched = observed(&scene.energy);
    equilibrium.checkpoint = store.samples();
    let phi = observed(averaged(scene));
    if let Some(nearby) = &nearby {
        equilibrium.slopes = slopes(nearby, averaged)?;
    }
    let found = watch
        .until("chains come to their law", accuracy, |told| {
            let equilibrium = stationary::Equilibrium { told: Box::new(told), ..equilibrium };
            match exponents {
                None => equilibrium.run(&phi, accuracy),
                Some(count) => equilibrium.lyapunov(count, accuracy),
            }
        })
        .map_err(|error| match error {
            RunError::Stopped => Failure::Stopped("before the first averages".into()),
            RunError::Ladder(error) => scene.steps_error(error).into(),
            error => refused(scene, error),
        })?;
    let mut text = found.to_string();
    if let Some(because) = &because {
        text += &format!("{scheme}: {because}\n");
    }
    match (exponents, kt) {
        (Some(count), _) => text += &contraction(scene, &found, count),
        (None, Some(kt)) => {
            let kt = digits(kt);
            text += &format!("exp(-H0/kT) is stationary with kT = {kt}, if it has an integral\n");
            if let Some(reason) = inexact {
                text += &format!("averages have a bias of the step, since {reason}\n");
            }
        }
        _ => {}
    }
    text += &format!("{:.2} s\n", start.elapsed().as_secs_f64());
    let mean = |mean: &StationaryMean| with_interval(mean, mean.interval(), mean.half_width());
    let all = |means: &[StationaryMean]| means.iter().map(mean).collect::<Value>();
    let reached = found.reached();
    let mut json = json!(found);
    json["because"] = json!(because);
    json["kT"] = json!(kt);
    json["reached"] = reached.into();
    json["estimates"] = all(&found.means);
    json["accuracy"] = json!(wanted);
    json["gradient"] = found.gradient.iter().map(|(name, of)| (name.clone(), all(of))).collect();
    let figures = found.means.iter().filter_map(|mean| drawn(scene, mean, kt)).collect();
    Ok(Found::of(
        scene,
        found
            .means
            .iter()
            .filter_map(|mean| Some(mean.unknown.clone()?.about(&mean.name)))
            .chain(found.unknown.iter().cloned()),
        &text,
        json,
        figures,
    )
    .to(reached, wanted))
}

/// The functions that are averaged: unless some are named, all there are.
fn averaged(scene: &Scene) -> Vec<&Observable> {
    let of: Vec<_> = match &*scene.expected {
        [] => scene.observables.iter().chain(&scene.energy).collect(),
        named => named.iter().collect(),
    };
    of.into_iter().filter(|phi| phi.quantity.is_of_state()).collect()
}

/// Refuses a scene without a stationary law, and averages that are not functions of the state.
fn check(scene: &Scene, averages: bool) -> Read<()> {
    let model = &scene.model;
    if model.system().description().depends_on_time {
        refuse!(
            None,
            "a system that depends on time has no stationary law: if it is periodic, make its \
             phase a component, by a canonical pair (phi, J) with w*J in H0 and phi for w*t"
        );
    }
    if model.constant_rates().is_none() {
        refuse!(None, "a damping that depends on time has no stationary law");
    }
    if let (true, Some(Observable { name, .. })) =
        (averages, scene.expected.iter().find(|phi| !phi.quantity.is_of_state()))
    {
        refuse!(
            None,
            "averages over the stationary law are of functions of the state alone: leave out \
             `{name}`"
        );
    }
    Ok(())
}

/// The sum of all exponents beside what it must be, where fields B∇H have no divergence, so that
/// damping alone contracts volume.
fn contraction(scene: &Scene, found: &Averages, count: usize) -> String {
    let (problem, system, d) = (scene.problem(), scene.model.system(), scene.components.len());
    let by_damping =
        count == d && !system.description().has_bath && is_divergence_free(system, &problem.y0);
    let Some(sum) = found.means.last().filter(|_| by_damping) else { return String::new() };
    let rate = Friction::rates(scene.model.friction(), 0.0, d).iter().sum::<f64>()
        + d as f64 * problem.damping.rate(0.0);
    let (own, off) = (digits(-rate), sum.mean + rate);
    format!("volume contracts by -Σγᵢ = {own}: the sum differs by {off:.1e}\n")
}

/// The density of an average, beside that of e^{−H₀/kT} where this is known.
fn drawn(scene: &Scene, mean: &StationaryMean, kt: Option<f64>) -> Option<Figure> {
    let histogram = mean.histogram.as_ref()?;
    let (grid, counts) = (&histogram.grid, &histogram.counts);
    let all = counts.iter().sum::<u64>() + histogram.below + histogram.above;
    let first = counts.iter().position(|&count| count > 0)?;
    let last = counts.iter().rposition(|&count| count > 0)?;
    let x: Vec<f64> = (first..=last).map(|k| grid.edge(k as u32) + 0.5 * grid.width).collect();
    let trace = |name: &str, density: Vec<f64>| Trace {
        name: name.into(),
        points: x.iter().copied().zip(density).collect(),
    };
    let density = |&count: &u64| count as f64 / (all as f64 * grid.width);
    let chains = trace("chains", counts[first..=last].iter().map(density).collect());
    let place = scene.components.iter().position(|name| *name == mean.name);
    let known = kt.zip(place).and_then(|(kt, place)| {
        gibbs_marginal(scene.model.system(), &scene.problem().y0, place, 1.0 / kt, &x)
    });
    let known = known.map(|known| known.iter().map(|y| y / grid.width).collect());
    let mut traces = vec![chains];
    traces.extend(known.map(|known| trace("exp(-H0/kT)", known)));
    let name = &*mean.name;
    Some(Figure::of(
        "density",
        name,
        lines(name, name, "density", &traces),
        format!("The stationary density of {name}."),
    ))
}
