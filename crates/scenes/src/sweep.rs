//! A scene at several values of its parameters.

use std::{collections::HashSet, ops::Range, sync::Arc};

use casimir::formula::{Formula, Names};
use indexmap::IndexMap;
use keys::*;

use super::Scene;

/// A parameter with its chosen values.
pub struct Varied {
    /// Name of the parameter.
    pub name: String,
    /// Values of the parameter.
    pub values: Vec<f64>,
    /// Values as they are written.
    texts: Vec<String>,
    /// Place of the values if the scene has them.
    place: Option<Range<usize>>,
}

impl Varied {
    /// Whether results have an axis for the parameter: `--set` with one value settles it.
    fn is_axis(&self) -> bool {
        self.values.len() > 1 || self.place.is_some()
    }

    /// The parameter with one of its values, such as `sigma = 0.1`.
    pub fn words(&self, place: usize) -> String {
        format!("{} = {}", self.name, self.texts[place])
    }
}

/// Gives a parameter of a scene a value as it is written.
fn put(file: &mut SceneFile, name: &str, value: String) {
    let parameters = &mut file.system.parameters;
    let value = Parameter::One(Text(value));
    match parameters.iter_mut().find(|(key, _)| key.as_str() == name) {
        Some((_, at)) => *at = At::new(at.span(), value),
        // A system of the project knows its parameters itself.
        None => _ = parameters.insert(At::new(0..0, name.into()), At::new(0..0, value)),
    }
}

/// One combination of the values.
pub struct Combination {
    /// Label such as `sigma = 0.1, J = 2`; empty if nothing is varied.
    pub label: String,
    /// Parameters that are varied, with their values.
    pub values: Vec<(String, f64)>,
    /// The number of the value of each parameter that is varied.
    pub places: Vec<usize>,
    /// The scene with these values.
    pub scene: Scene,
}

impl Combination {
    /// Prefix for words about the combination.
    pub fn prefix(&self) -> String {
        if self.label.is_empty() { String::new() } else { format!("{}: ", self.label) }
    }
}

/// A scene at every combination of the values that are varied; the last parameter changes fastest.
pub struct Sweep {
    /// Varied parameters: those of `[sweep]`, even with one value only, and of `--set` with
    /// several.
    pub varied: Vec<Varied>,
    /// The scenes; at least one.
    pub combinations: Vec<Combination>,
}

impl Sweep {
    /// The scenes of a text, with the changes that a command line makes.
    ///
    /// # Errors
    /// [`SceneError`] like that of [`Scene::new`], or about the varied parameters.
    pub fn new(source: &Source, changes: &Changes) -> Result<Self, SceneError> {
        source.located(Self::of(source, changes, false))
    }

    /// The combinations as scenes of their own, for verbs of one scene.
    ///
    /// # Errors
    /// Those of [`Sweep::new`].
    pub fn apart(source: &Source, changes: &Changes) -> Result<Vec<Combination>, SceneError> {
        Ok(source.located(Self::of(source, changes, true))?.combinations)
    }

    /// The scene of the first combination.
    pub fn scene(&self) -> &Scene {
        &self.combinations[0].scene
    }

    /// All combinations; `apart` with changes of their own, which choose their values.
    fn of(source: &Source, changes: &Changes, apart: bool) -> Read<Self> {
        let file = parse(&source.text)?;
        let mut varied = chosen(&file, &changes.scheme.sets)?;
        let numbers = varied.iter().map(|one| one.values.len() as u64);
        let number = numbers.fold(1, u64::saturating_mul);
        if number > MAX_VALUES {
            refuse!(
                varied[0].place.clone(),
                "{number} combinations are too many: at most {MAX_VALUES}"
            );
        }
        // One for all scenes, which may be many.
        let changes = Arc::new(changes.clone());
        let combination = |k: usize| {
            let (mut file, mut changes) = (file.clone(), Arc::clone(&changes));
            // The last parameter changes fastest.
            let (mut rest, mut chosen) = (k, Vec::new());
            for one in varied.iter().rev() {
                chosen.insert(0, (one, rest % one.values.len()));
                rest /= one.values.len();
            }
            let set = |(one, place): &(&Varied, usize)| {
                let text = one.texts[*place].clone();
                Set { name: one.name.clone(), values: vec![text] }
            };
            let sets: Vec<Set> = chosen.iter().map(set).collect();
            sets.iter().for_each(|set| put(&mut file, &set.name, set.values[0].clone()));
            if apart {
                Arc::make_mut(&mut changes).scheme.sets = sets;
            }
            let mut scene = Scene::of(source, file, &changes, !apart)?;
            if changes.independent {
                scene.settings.key.experiment = k as u64;
            }
            let axes = || chosen.iter().filter(|(one, _)| one.is_axis());
            let words: Vec<String> = axes().map(|(one, place)| one.words(*place)).collect();
            let value = |(one, place): &(&Varied, usize)| (one.name.clone(), one.values[*place]);
            Ok(Combination {
                label: words.join(", "),
                values: axes().map(value).collect(),
                places: axes().map(|(_, place)| *place).collect(),
                scene,
            })
        };
        let combinations = (0..number as usize).map(combination).collect::<Read<_>>()?;
        varied.retain(Varied::is_axis);
        Ok(Self { varied, combinations })
    }
}

/// The parameters chosen by the scene and by the command line, which takes precedence.
fn chosen(file: &SceneFile, given: &[Set]) -> Read<Vec<Varied>> {
    let own = file.sweep.iter().map(|(name, at)| (name.as_str(), (&at.0, Some(at.span()))));
    let mut all: IndexMap<&str, (&Vec<String>, Option<Range<usize>>)> = own.collect();
    for (k, Set { name, values }) in given.iter().enumerate() {
        if given[..k].iter().any(|before| before.name == *name) {
            refuse!(None, "--set {name} is given twice");
        }
        all.insert(name, (values, None));
    }
    let known: Vec<&str> = file.system.parameters.keys().map(|key| key.as_str()).collect();
    let varied = all.into_iter().map(|(name, (texts, place))| {
        if texts.is_empty() {
            refuse!(place, "`{name}` needs a value");
        }
        if !known.contains(&name) && file.system.name.is_none() {
            refuse!(place, "no parameter `{name}` to set{}", among(name, &known));
        }
        let mut values = Vec::new();
        for text in texts {
            match Formula::parse(text, &Names::new()).map(|formula| formula.value(&[])) {
                Ok(value) if values.contains(&value) => {
                    refuse!(place, "`{name}` has the value {text} twice")
                }
                Ok(value) if value.is_finite() => values.push(value),
                Ok(value) => refuse!(place, "{name} = {text}: it is {value}"),
                Err(error) => refuse!(place, "{name} = {text}: {}", error.message),
            }
        }
        Ok(Varied { name: name.into(), values, texts: texts.clone(), place })
    });
    varied.collect()
}

/// Part of the change of a parameter by which numbers are generic: formulas with 0.500000001 have
/// the form of those nearby, while those with 0, ½ or 1 are simpler.
const GENERIC: f64 = 0.01;

/// A scene at generic parameters, and nearby ones in each of which one parameter is changed a
/// little.
pub struct Nearby {
    /// The scene, with parameters that differ from those given by a part of their change.
    pub scene: Scene,
    /// The changed scenes, one for each parameter.
    pub changed: Vec<Changed>,
}

/// A scene in which one parameter is changed a little.
pub struct Changed {
    /// Name of the parameter.
    pub parameter: String,
    /// Value of the parameter in the scene.
    pub value: f64,
    /// Change of the parameter.
    pub change: f64,
    /// Difference of the generic parameter from the one that was given.
    pub offset: f64,
    /// Part of a difference that curvature adds, if it was measured.
    pub curvature: f64,
    /// Whether what is observed may depend on the parameter: its texts name it, or H₀.
    pub is_observed: bool,
    /// The scene.
    pub scene: Scene,
}

impl Nearby {
    /// Scenes near one, in each of which a parameter of its gradient has another value.
    pub(super) fn of(scene: &Scene, by: &[f64]) -> Read<Self> {
        let Scene { source, changes, gradient, components, .. } = scene;
        let mut file = settled(source, changes)?;
        let numbers = Constants::new(&file.system)?.numbers;
        let mut generic = Vec::new();
        for (k, (name, change)) in gradient.iter().zip(by).enumerate() {
            let Some((_, value)) = numbers.iter().find(|(known, _)| known == name) else {
                if components.contains(name) {
                    refuse!(
                        None,
                        "`{name}` is a component, no parameter: make its initial value one, \
                         initial = [\"{name}0\"], and ask for {name}0"
                    );
                }
                let known: Vec<&str> = numbers.iter().map(|(known, _)| &known[..]).collect();
                refuse!(None, "no parameter `{name}` to differentiate by{}", among(name, &known));
            };
            if gradient[..k].contains(name) {
                refuse!(None, "the derivative by `{name}` is asked for twice");
            }
            differentiable(&file, &numbers, name)?;
            let offset = GENERIC * (k + 1) as f64 * change;
            put(&mut file, name, (value + offset).to_string());
            generic.push((name, offset, value + offset, change));
        }
        let words = observed(&file, changes);
        let is_heat = |word: &String| word.strip_prefix("heat").is_some_and(is_number);
        let has_energy = words.contains("H0") || words.iter().any(is_heat);
        let near = |(name, offset, value, change): (&String, f64, f64, &f64)| {
            let (mut file, near) = (file.clone(), value + change);
            put(&mut file, name, near.to_string());
            Ok(Changed {
                parameter: name.clone(),
                value,
                change: near - value,
                offset,
                curvature: 0.0,
                is_observed: words.contains(name) || has_energy,
                scene: Scene::of(source, file, changes, false)?,
            })
        };
        let changed = generic.into_iter().map(near).collect::<Read<_>>()?;
        Ok(Self { scene: Scene::of(source, file, changes, false)?, changed })
    }
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_digit())
}

/// Words in the texts of what is observed.
fn observed(file: &SceneFile, changes: &Changes) -> HashSet<String> {
    let named = file.observe.values().chain(file.probabilities.values()).map(|text| &text.0);
    let of = file.expect.iter().flat_map(|table| &table.of);
    let of = of.flat_map(|of| of.iter().map(|text| &text.0));
    let events = file.events.values().map(|event| &event.0.when.0);
    let texts = named.chain(of).chain(events).chain(&changes.of);
    let ends_word = |c: char| !(c.is_alphanumeric() || c == '_');
    texts.flat_map(|text| text.split(ends_word)).map(Into::into).collect()
}

/// Refuses a parameter of random initial values, or of a rate of damping with conditions.
fn differentiable(file: &SceneFile, numbers: &[(String, f64)], name: &str) -> Read<()> {
    let names = |without: &str| {
        let mut names = Names::new();
        for (known, value) in numbers.iter().filter(|(known, _)| known != without) {
            _ = names.parameter(known, *value);
        }
        let random = (1..=MAX_RANDOM).flat_map(|k| [format!("z{k}"), format!("u{k}")]);
        random.chain(["t".into()]).for_each(|variable| _ = names.variable(&variable));
        names
    };
    let (all, others) = (names(""), names(name));
    let parsed = |text: &At<Text>| Formula::parse(&text.0, &all).ok();
    let uses = |text: &At<Text>| Formula::parse(&text.0, &others).is_err();
    if let Listed::List(texts) = &*file.run.initial {
        let random = texts.iter().filter_map(parsed).any(|formula| !formula.reads().is_empty());
        if let Some(text) = texts.iter().find(|text| random && uses(text)) {
            refuse!(text, "no derivative by `{name}`: it changes the law of random initial values");
        }
    }
    let rates = file.damping.iter().flat_map(|table| table.rate.iter().chain(table.rates.values()));
    for rate in rates.filter(|rate| uses(rate)) {
        if parsed(rate).is_none_or(|formula| formula.has_conditions()) {
            refuse!(rate, "no derivative by `{name}`: the rate has conditions, which jump");
        }
    }
    Ok(())
}

/// Number of random numbers of each kind that initial values are asked for.
const MAX_RANDOM: usize = 64;

/// The keys of a scene, where parameters have the values that the command line chooses, one each.
pub fn settled(source: &Source, changes: &Changes) -> Read<SceneFile> {
    let mut file = parse(&source.text)?;
    file.sweep.clear();
    for Varied { name, texts, place, .. } in chosen(&file, &changes.scheme.sets)? {
        if let [first, _, ..] = &texts[..] {
            refuse!(
                place,
                "`{name}` has {} values, and one is taken here: choose it by --set {name}={first}",
                texts.len()
            );
        }
        put(&mut file, &name, texts[0].clone());
    }
    Ok(file)
}
