//! Parameters of a scene from data.

use std::path::PathBuf;

use ::fit::{
    Data, Effort, FitError, FitSettings, Moment, NearbySetup, Paths, Replicate, Statistic,
};
use casimir::{
    expectation::written,
    mc::Checkpoint,
    plot::figure::{Law, Sampled, Trace, fitted, lines},
    real::elementary::{cos, sin},
};

use crate::{Settled, data::read, expect, lines_of, prelude::*, source};
use scenes::Source;

/// Largest number of radians of the fastest motion that steps follow.
const MAX_TURNS: f64 = 1e6;

/// Parameters from means, variances, quantiles or samples of data, with 95 % intervals.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Fit {
    /// The data as CSV: moments or samples
    #[cfg_attr(feature = "clap", arg(value_name = "DATA", index = 2))]
    #[schemars(skip)]
    pub data: PathBuf,
    /// Text of the data, in place of a file.
    #[cfg_attr(feature = "clap", arg(skip))]
    #[schemars(skip)]
    pub table: Option<String>,
    /// Parameters to find, instead of those of the scene: I1,sigma
    #[cfg_attr(
        feature = "clap",
        arg(long = "of", value_name = "PARAMETERS", value_delimiter = ',')
    )]
    #[schemars(skip)]
    pub parameters: Vec<String>,
    /// Path-steps after which neither paths nor steps are doubled
    #[cfg_attr(feature = "clap", arg(long, default_value_t = Fit::default().path_steps))]
    pub path_steps: Count,
    /// Scheme and seed.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(skip)]
    pub scheme: SchemeAndSeed,
}

impl Default for Fit {
    fn default() -> Self {
        Self {
            data: PathBuf::new(),
            table: None,
            parameters: Vec::new(),
            path_steps: Count(1_000_000_000),
            scheme: SchemeAndSeed::default(),
        }
    }
}

impl Verb for Fit {
    const NAME: &'static str = "fit";
    const STORES: Stores = Stores::Samples("moments.bin");
    const WRITES: bool = false;

    fn changes(&self) -> Changes {
        Changes { scheme: self.scheme.clone(), ..Changes::default() }
    }

    fn meaning(&self) -> String {
        let data = self.source().map_or(String::new(), |source| source.text);
        format!("fit of = {}\n{data}\n", self.parameters.join(","))
    }

    fn compute(&self, scene: &Scene, store: &Store<'_>, watch: &Watch) -> Done<Found> {
        let begun = Instant::now();
        let observables = scene.observables.iter().map(|phi| &phi.name);
        let known = scene.components.iter().chain(observables).map(|name| &**name);
        let mut known: Vec<&str> = known.collect();
        known.sort_unstable();
        known.dedup();
        let (names, data) = read(&self.source()?, &known)?;
        let start = self.start(scene)?;
        let intervals = Paths::intervals(&data)?;
        // An even number of steps in all, of which two have a radian of the fastest motion at most.
        let turns = (scene.model.fastest() * data.until()).ceil().min(MAX_TURNS) as u64;
        let steps = 2 * intervals * coarsest_steps(data.until()).max(turns).div_ceil(intervals);
        let (truncation, key) = (scene.settings.truncation, scene.settings.key);
        let (mut changes, mut scheme_of) = (None::<Vec<f64>>, None);
        // Evaluations of the model in their order: a fit that goes on takes them again.
        let kept = store.samples().map_or(Ok(None), Checkpoint::read::<Vec<Kept>>)?;
        let (mut kept, mut done) = (kept.unwrap_or_default(), 0);
        let mut model = |theta: &[f64], effort: &Effort| -> Done<Vec<Replicate>> {
            let values = start.iter().zip(theta).map(|((name, _), x)| (name.clone(), *x));
            let here = scene.at(&names, &values.collect::<Vec<_>>())?;
            let nearby = match &changes {
                Some(changes) => here.nearby(changes)?,
                None => {
                    if let Some(why) = expect::jumps(&here) {
                        return Err(refused(&here, format!("moments have no derivative: {why}")));
                    }
                    expect::nearby(&here)?
                }
            };
            changes = Some(nearby.changed.iter().map(|one| one.change).collect::<Vec<_>>());
            let (id, _) = scheme_of.get_or_insert_with(|| chosen(&nearby.scene));
            if let Some((at, of, found)) = kept.get(done)
                && (&at[..], of) == (theta, effort)
            {
                done += 1;
                return Ok(found.clone());
            }
            let near = nearby.changed.iter().map(|one| {
                let (setup, observables) = (one.scene.setup(id)?, observed(&one.scene.expected));
                Ok(NearbySetup { setup, change: one.change, observables })
            });
            let (setup, near) = (nearby.scene.setup(id)?, near.collect::<Done<_>>()?);
            let paths = Paths::new(setup, data.until(), observed(&nearby.scene.expected), near);
            let found =
                watch.under("moments", effort.all_paths() * effort.steps * steps * 3 / 2, |told| {
                    paths.moments(&data, (steps, effort), (key, truncation), (&watch.stop, told))
                });
            watch.check()?;
            let found = found?;
            kept.truncate(done);
            kept.push((theta.to_vec(), *effort, found.clone()));
            done += 1;
            if let Some(file) = store.samples().filter(|file| file.is_due()) {
                _ = file.write(&kept);
            }
            Ok(found)
        };
        let evaluation = (steps * 3 / 2) * (1 + start.len() as u64);
        let settings = FitSettings {
            most: self.path_steps.0 / evaluation,
            stop: watch.stop.clone(),
            ..FitSettings::default()
        };
        let found = ::fit::fit(&data, &start, &settings, &mut model);
        match store.samples() {
            Some(file) if watch.stop.is_asked() => _ = file.write(&kept),
            file => file.map_or((), Checkpoint::remove),
        }
        let found = found.map_err(|error| match error {
            FitError::Model(failure) => failure,
            error @ FitError::Few { .. } => Failure::Usage(error.to_string()),
            error => Failure::Run(error.to_string()),
        })?;
        let (scheme, because) = scheme_of.unwrap_or_default();
        let mut text: String = start
            .iter()
            .enumerate()
            .map(|(k, (name, begin))| {
                let half = found.half_width(k);
                let value = written(found.values[k], half);
                format!("{name} = {value} ± {half:.1e} (95 %), from {begin}\n")
            })
            .collect();
        let probability = found.probability.map_or(String::new(), |p| format!(", p = {p:.2}"));
        let (chi, degrees) = (found.chi_square, found.degrees);
        text += &format!("χ² = {chi:.1} with {degrees} degrees of freedom{probability}\n");
        let (paths, steps) = (found.effort.all_paths(), steps * found.effort.steps);
        text += &format!("{scheme}, {paths} paths of {steps} steps, {} times\n", found.evaluations);
        let constant = data.moments.len() - degrees - start.len();
        if constant > 0 {
            text += &format!("{constant} combinations of moments do not vary\n");
        }
        text += &lines_of(&found.warnings);
        let seconds = begun.elapsed().as_secs_f64();
        text += &format!("{seconds:.2} s\n");
        let parameter = |k: usize| {
            let (lo, hi) = found.interval(k);
            json!({
                "name": found.names[k], "value": found.values[k], "lo": lo, "hi": hi,
                "half_width": found.half_width(k), "start": start[k].1,
                "monte_carlo": found.monte_carlo[k], "bias_bound": found.bias_bound[k],
            })
        };
        let moment = |i: usize| {
            let Moment { time, of, statistic, value } = data.moments[i];
            json!({
                "time": time, "observable": names[of], "statistic": word(statistic),
                "value": value, "error": data.error(i),
                "fitted": found.moments[i], "half_width": found.bands[i],
            })
        };
        let json = json!({
            "scheme": scheme, "because": because,
            "parameters": (0..start.len()).map(parameter).collect::<Value>(),
            "covariance": found.covariance, "chi_square": chi, "degrees": degrees,
            "probability": found.probability, "paths": paths, "steps": steps,
            "evaluations": found.evaluations, "reached": found.is_good(), "seconds": seconds,
            "moments": (0..data.moments.len()).map(moment).collect::<Value>(),
        });
        let mut figures = curves(&names, &data, &found);
        for j in 0..start.len() {
            figures.extend((j + 1..start.len()).map(|k| contours(&found, [j, k])));
        }
        let good = found.is_good();
        Ok(Found::of(scene, found.warnings, &text, json, figures).to(good, None))
    }
}

/// An evaluation of the model that is done.
type Kept = (Vec<f64>, Effort, Vec<Replicate>);

impl Fit {
    fn source(&self) -> Done<Source> {
        self.table
            .as_ref()
            .map_or_else(|| source("data", &self.data), |text| Ok(Source::new("data", text)))
    }

    /// The parameters with the values of the scene.
    fn start(&self, scene: &Scene) -> Done<Vec<(String, f64)>> {
        let names = if self.parameters.is_empty() { &scene.fitted } else { &self.parameters };
        let wrong = |what: &str| {
            let all: Vec<&str> = scene.parameters.iter().map(|(name, _)| &**name).collect();
            refused(scene, format!("{what}; there are {}", all.join(", ")))
        };
        if names.is_empty() {
            return Err(wrong("nothing is fitted: name parameters by --of"));
        }
        names
            .iter()
            .map(|name| {
                scene
                    .parameters
                    .iter()
                    .find(|known| known.0 == *name)
                    .cloned()
                    .ok_or_else(|| wrong(&format!("no parameter `{name}` to fit")))
            })
            .collect()
    }
}

/// The scheme: unless one is named, that of weak order two, if the system has flows of parts.
fn chosen(scene: &Scene) -> Settled {
    if scene.settings.scheme == AUTO && scene.model.scheme(BuiltIn::Nv).is_ok() {
        (BuiltIn::Nv.id().into(), Some("parts have flows, and its weak order is 2".into()))
    } else {
        scheme(scene)
    }
}

/// A statistic as data name it.
fn word(statistic: Statistic) -> String {
    match statistic {
        Statistic::Mean => "mean".into(),
        Statistic::Variance => "variance".into(),
        Statistic::Quantile(level) => format!("q{level}"),
    }
}

/// Measured moments and those of the fit in time.
fn curves(names: &[String], data: &Data, found: &::fit::Fit) -> Vec<Figure> {
    let mut all: Vec<(String, Vec<usize>)> = Vec::new();
    for (i, moment) in data.moments.iter().enumerate() {
        let name = format!("{} {}", names[moment.of], word(moment.statistic));
        match all.iter_mut().find(|(known, _)| *known == name) {
            Some((_, places)) => places.push(i),
            None => all.push((name, vec![i])),
        }
    }
    let figure = |(name, mut places): (String, Vec<usize>)| {
        places.sort_by(|&i, &j| data.moments[i].time.total_cmp(&data.moments[j].time));
        let of = |x: &dyn Fn(usize) -> f64| places.iter().map(|&i| x(i)).collect::<Vec<_>>();
        let law = Law {
            x: of(&|i| data.moments[i].time),
            mean: of(&|i| found.moments[i]),
            interval: [-1.0, 1.0].map(|s| of(&|i| found.moments[i] + s * found.bands[i])),
            ..Law::default()
        };
        let bars = places.iter().map(|&i| -> Sampled {
            let (at, error) = (&data.moments[i], 1.96 * data.error(i));
            (at.time, at.value, Some((at.value - error, at.value + error)))
        });
        let svg = fitted(&name, "time t", &name, &law, &bars.collect::<Vec<_>>());
        Figure::of(
            "fit",
            &name,
            svg,
            format!("{name}: data with 95 % intervals, and the fit with its band."),
        )
    };
    all.into_iter().map(figure).collect()
}

/// Contours of χ² that hold two parameters with 68 % and 95 %, to second order.
fn contours(found: &::fit::Fit, [j, k]: [usize; 2]) -> Figure {
    let entry = |a: usize, b: usize| found.covariance[a][b];
    // The factor of Cholesky.
    let first = entry(j, j).sqrt();
    let [across, own] = [entry(j, k) / first, entry(k, k)];
    let own = (own - across * across).max(0.0).sqrt();
    let contour = |(name, square): (&str, f64)| Trace {
        name: name.into(),
        points: (0..=96)
            .map(|n| {
                let angle = std::f64::consts::TAU * f64::from(n) / 96.0;
                let (a, b) = (square.sqrt() * cos(angle), square.sqrt() * sin(angle));
                (found.values[j] + first * a, found.values[k] + across * a + own * b)
            })
            .collect(),
    };
    // −2 ln(1 − p) for two degrees of freedom.
    let traces: Vec<Trace> = [("68 %", 2.279), ("95 %", 5.991)].map(contour).into();
    let (x, y) = (&*found.names[j], &*found.names[k]);
    let name = format!("{x} {y}");
    Figure::of(
        "contours",
        &name,
        lines(&name, x, y, &traces),
        format!("{y} against {x}: contours of χ² by the covariance."),
    )
}
