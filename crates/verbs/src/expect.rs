//! Expectations with intervals.

use std::ops::RangeInclusive;

use casimir::{
    expectation::{self, Estimate, ExpectSettings, WarningKind},
    real::elementary::ln,
};

use crate::{prelude::*, slopes, with_interval};
use scenes::{Changed, Nearby};

/// Expectations E[φ(y(T))] with 95 % intervals: `expect(of=["y1"], accuracy=1e-4)`.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Expect {
    /// Half-width of the 95 % intervals, instead of that of the scene
    #[cfg_attr(feature = "clap", arg(long, value_name = "ERROR", allow_negative_numbers = true))]
    #[serde(skip)]
    pub accuracy: Option<f64>,
    /// Test functions, instead of those of the scene; several by several `--of`
    #[cfg_attr(feature = "clap", arg(long, value_name = "FUNCTION"))]
    #[serde(skip)]
    pub of: Vec<String>,
    /// Parameters by which expectations are differentiated, instead of those of the scene; several
    /// with commas
    #[cfg_attr(feature = "clap", arg(long, value_delimiter = ',', value_name = "PARAMETER"))]
    #[serde(skip)]
    pub gradient: Vec<String>,
    /// Steps of the coarsest level. Default: chosen with the scheme; about eight in a unit of time
    /// for a scheme that is named, and with events or integrals
    #[cfg_attr(feature = "clap", arg(long, value_name = "STEPS"))]
    pub coarsest_steps: Option<Count>,
    /// Scheme and seed.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(skip)]
    pub scheme: SchemeAndSeed,
}

impl Verb for Expect {
    const NAME: &'static str = "expect";
    const STORES: Stores = Stores::Samples("samples.bin");
    const WRITES: bool = false;

    fn changes(&self) -> Changes {
        let (of, gradient) = (self.of.clone(), self.gradient.clone());
        let scheme = self.scheme.clone();
        Changes { accuracy: self.accuracy, of, gradient, scheme, ..Changes::default() }
    }

    fn meaning(&self) -> String {
        let steps = self.coarsest_steps.map(|steps| format!("coarsest steps = {steps}\n"));
        format!("verb = expect\n{}", steps.unwrap_or_default())
    }

    fn compute(&self, scene: &Scene, store: &Store<'_>, watch: &Watch) -> Done<Found> {
        let accuracy = wanted(scene)?;
        let nearby = if scene.gradient.is_empty() {
            None
        } else if jumps(scene).is_some() {
            Some(slopes::nearby(scene)?)
        } else {
            Some(nearby(scene)?)
        };
        let scene = nearby.as_ref().map_or(scene, |nearby| &nearby.scene);
        let (mut expect, mut settings, because) = chosen(scene)?;
        if let Some(nearby) = &nearby {
            expect = with_gradient(expect, nearby)?;
        }
        if let Some(steps) = self.coarsest_steps {
            settings.coarsest_steps = steps.0;
        }
        let start = Instant::now();
        let mut expect = expect.with(ExpectSettings { stop: watch.stop.clone(), ..settings });
        expect.checkpoint = store.samples();
        let mut found = watch
            .until("the first estimates", accuracy, |told| {
                let mut expect = expect;
                expect.told = Box::new(told);
                expect.run(&observed(&scene.expected), accuracy)
            })
            .map_err(|error| {
                if watch.stop.is_asked() {
                    Failure::Stopped("before the first estimates".into())
                } else {
                    error.into()
                }
            })?;
        let seconds = start.elapsed().as_secs_f64();
        // Components have names here.
        for warning in &mut found.warnings {
            if let WarningKind::Component(i) = warning.kind {
                let name = &scene.components[i - 1];
                warning.message.what = format!("the steps do not resolve {name}");
            }
        }
        let mut text = found.to_string();
        if let Some(because) = &because {
            text += &format!("{}: {because}\n", found.scheme);
        }
        text += &format!("{seconds:.2} s\n");
        let all = |of: &[Estimate]| {
            of.iter()
                .map(|one| with_interval(one, one.interval(), one.half_width()))
                .collect::<Value>()
        };
        let gradient = found.gradient.iter().map(|(parameter, of)| (parameter.clone(), all(of)));
        let reached = found.reached();
        let json = json!({
            "scheme": found.scheme, "because": because,
            "accuracy": found.accuracy, "reached": reached,
            "estimates": all(&found.estimates), "gradient": gradient.collect::<Value>(),
            "levels": found.levels, "single_steps": found.single_steps,
            "path_steps": found.cost, "seconds": seconds,
        });
        let warnings = found.warnings.iter().map(expectation::Warning::told);
        Ok(Found::of(scene, warnings, &text, json, Vec::new()).to(reached, Some(accuracy)))
    }
}

/// Change of a parameter over its size to begin with, and wanted distance of what is nearby over
/// its size.
const CHANGE: f64 = 1e-7;
/// Distances over sizes that are near the wanted one.
const DISTANCES: RangeInclusive<f64> = 1e-8..=1e-6;
/// Factor of changes that nothing shows, and the number of trials.
const MORE: f64 = 1e3;
const TRIALS: usize = 12;
/// Exponents of the distance in the change, of a function that has a derivative.
const LINEAR: RangeInclusive<f64> = 0.5..=1.5;
/// Distance over the size that is more than rounding errors.
const SEEN: f64 = 1e-12;
/// Part of a difference from which on curvature is most of it.
const CURVED: f64 = 0.5;
/// Growth of distances of paths beside which no derivative along them has a mean.
const GROWTH: f64 = 1e5;

/// Search for the change of a parameter.
struct Trial {
    /// A change of 10⁻⁷ of the parameter.
    first: f64,
    change: f64,
    /// The change and the distance before.
    before: Option<(f64, f64)>,
    settled: bool,
    /// Part of a difference that curvature adds; one if all of it may be.
    curvature: f64,
}

impl Trial {
    /// Returns to the first change, which is small beside the parameter.
    fn give_up(&mut self, curvature: f64) {
        (self.change, self.settled, self.curvature) = (self.first, true, curvature);
    }

    /// Chooses the next change from the distance by the last one, or settles.
    fn next(&mut self, distance: f64) {
        if distance == 0.0 {
            if self.change < 1.0f64.max(self.first / CHANGE) {
                self.change *= MORE;
            } else {
                self.give_up(0.0);
            }
        } else if distance.is_nan() || DISTANCES.contains(&distance) {
            self.settled = true;
        } else {
            if self
                .before
                .filter(|(_, before)| before.min(distance) > SEEN)
                .map(|(change, before)| ln(distance / before) / ln(self.change / change))
                .is_some_and(|p| p.is_finite() && !LINEAR.contains(&p))
            {
                return self.give_up(1.0);
            }
            self.before = distance.is_finite().then_some((self.change, distance));
            self.change *= (CHANGE / distance).clamp(1.0 / MORE, MORE);
        }
    }
}

/// Nearby scenes, each parameter changed so much that states or test functions differ by 10⁻⁷ of
/// their size. Where differences do not grow like the change, as those of k² at k = 0, it is 10⁻⁷
/// of the parameter.
pub(crate) fn nearby(scene: &Scene) -> Done<Nearby> {
    let growth = chosen(scene)?.0.growth();
    if growth > GROWTH {
        let until = scene.settings.until;
        let rate = ln(growth) / until;
        let words = format!(
            "no derivative along paths: nearby ones separate as exp({rate:.2} t), by {growth:.0e} \
             until {until}, and derivatives grow as much. Take an earlier time"
        );
        return Err(refused(scene, words));
    }
    let distances = |nearby: &Nearby| -> Done<Vec<f64>> {
        Ok(with_gradient(chosen(&nearby.scene)?.0, nearby)?
            .distances(&observed(&nearby.scene.expected)))
    };
    let trial =
        |first| Trial { first, change: first, before: None, settled: false, curvature: 0.0 };
    let mut trials: Vec<Trial> = slopes::changes(scene, CHANGE)?.into_iter().map(trial).collect();
    let at = |trials: &[Trial], part: f64| {
        scene.nearby(&trials.iter().map(|one| part * one.change).collect::<Vec<_>>())
    };
    for _ in 0..TRIALS {
        let distances = distances(&at(&trials, 1.0)?)?;
        trials
            .iter_mut()
            .zip(distances)
            .filter(|(one, _)| !one.settled)
            .for_each(|(one, distance)| one.next(distance));
        if trials.iter().all(|one| one.settled) {
            break;
        }
    }
    // Half of a change gives half of a difference, but for its curvature.
    let slopes = |part: f64| -> Done<Vec<f64>> {
        let nearby = at(&trials, part)?;
        Ok(distances(&nearby)?
            .into_iter()
            .zip(&nearby.changed)
            .map(|(distance, one)| distance / one.change)
            .collect())
    };
    let [wholes, halves] = [slopes(1.0)?, slopes(0.5)?];
    for ((one, whole), half) in trials.iter_mut().zip(wholes).zip(halves) {
        let curvature = 2.0 * (whole / half - 1.0).abs();
        if one.curvature == 0.0 && curvature.is_finite() {
            one.curvature = curvature;
            if curvature > CURVED {
                one.give_up(1.0);
            }
        }
    }
    let mut nearby = at(&trials, 1.0)?;
    for (changed, one) in nearby.changed.iter_mut().zip(&trials) {
        changed.curvature = one.curvature;
    }
    Ok(nearby)
}

/// The reason why there are no derivatives along paths, if there are none.
pub(crate) fn jumps(scene: &Scene) -> Option<String> {
    if scene.model.has_kinks() {
        let words = "B or a Hamiltonian has abs, min or max, whose field jumps: take a smooth \
                     function, such as sqrt(x^2 + d^2)";
        return Some(words.into());
    }
    let phi = scene.expected.iter().find(|phi| !phi.quantity.is_continuous())?;
    Some(format!(
        "{} is no smooth function of the state: take one, such as tanh((x - a)/d) for x > a",
        phi.name
    ))
}

/// Adds derivatives by parameters: along paths, or by likelihood ratios where paths do not see
/// jumps.
fn with_gradient<'a>(
    expect: expectation::Expect<'a>,
    Nearby { scene, changed }: &'a Nearby,
) -> Done<expectation::Expect<'a>> {
    let jumps = jumps(scene);
    let mut all = Vec::new();
    for Changed { parameter, change, offset, curvature, is_observed, scene: near, .. } in changed {
        let refused =
            |why: &str| Err(refused(scene, format!("no derivative by `{parameter}`{why}")));
        if let (Some(jumps), true) = (&jumps, is_observed) {
            return refused(&format!(", which is in what is observed, and {jumps}"));
        }
        let end = |scene: &Scene| (scene.settings.until, scene.settings.steps);
        if end(scene) != end(near) {
            return refused(": it changes the time of the end");
        }
        all.push(expectation::Nearby {
            parameter: parameter.clone(),
            change: *change,
            offset: *offset,
            curvature: *curvature,
            expect: chosen(near)?.0.starting(None),
            observables: observed(&near.expected),
        });
    }
    let Some(jumps) = jumps else { return Ok(expect.with_gradient(all)?) };
    let systems = changed.iter().map(|near| near.scene.model.system());
    let nearby = (scene.model.system(), all.into_iter().zip(systems).collect());
    expect
        .with_scores(&observed(&scene.expected), nearby)
        .map_err(|error| refused(scene, format!("{error}; and along paths there is none: {jumps}")))
}

/// The accuracy that is wanted of a scene.
fn wanted(scene: &Scene) -> Done<f64> {
    let name = scene.observables.first().map_or("y1", |observable| &*observable.name);
    let lacks = |what: &str, option: &str, line: &str| {
        let message = format!("{what}: give {option}, or in the scene\n  [expect]\n  {line}");
        refused(scene, message)
    };
    if scene.expected.is_empty() {
        let [option, line] = [format!("--of {name}"), format!("of = [\"{name}\"]")];
        return Err(lacks("nothing is expected", &option, &line));
    }
    let none = || lacks("no accuracy is wanted", "--accuracy 1e-3", "accuracy = 1e-3");
    scene.accuracy.ok_or_else(none)
}

/// The scheme that is named; or all that go with it is chosen: points, levels and order.
fn chosen(scene: &Scene) -> Done<(expectation::Expect<'_>, ExpectSettings, Option<String>)> {
    let settings = &scene.settings;
    let fastest = scene.model.fastest();
    let with = ExpectSettings { key: settings.key, fastest, ..ExpectSettings::default() };
    let jumps = !scene.gradient.is_empty() && jumps(scene).is_some();
    let collects = scene.collects() && (jumps || scene.gradient.is_empty());
    // Scores have weak order one.
    let is_plain = !collects && !jumps;
    if let Some(chosen) = scene.model.expect().filter(|_| settings.scheme == AUTO && is_plain) {
        return Ok((chosen.starting(settings.random.clone()), with, None));
    }
    let (scheme, because) = scheme(scene);
    let with = ExpectSettings {
        truncation: settings.truncation,
        coarsest_steps: coarsest_steps(settings.until),
        weak_order: BuiltIn::named(&scheme)
            .filter(|_| is_plain)
            .map(|scheme| scheme.properties().weak),
        ..with
    };
    let setup = scene.setup(&scheme)?;
    Ok((
        expectation::Expect::with_scheme(if collects { scene.collecting(setup) } else { setup }),
        with,
        because,
    ))
}
