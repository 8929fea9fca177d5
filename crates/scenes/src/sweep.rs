//! A scene at several values of its parameters.

use std::{collections::HashSet, ops::Range, sync::Arc};

use casimir::formula::{Formula, Names};

use super::{
    At, Changes, Constants, Listed, MAX_VALUES, Parameter, Read, Scene, SceneError, SceneFile, Set,
    Source, Text, among, parse, refuse,
};

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

    /// Gives the parameter of a scene one of the values.
    fn put(&self, file: &mut SceneFile, place: usize) {
        let parameters = &mut file.system.parameters;
        let found = parameters.iter().find(|(key, _)| key.as_str() == self.name);
        // A system of the project knows its parameters itself.
        let (key, at) = found.map_or_else(
            || (At::new(0..0, self.name.clone()), 0..0),
            |(key, value)| (key.clone(), value.span()),
        );
        let value = Parameter::One(Text(self.texts[place].clone()));
        parameters.insert(key, At::new(at, value));
    }
}

/// One combination of the values.
pub struct Combination {
    /// Label such as `sigma = 0.1, J = 2`; empty if nothing is varied.
    pub label: String,
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

/// One combination as a scene of its own.
pub struct Apart {
    /// Label such as `sigma = 0.1, J = 2`; empty if nothing is varied.
    pub label: String,
    /// Parameters that are varied, with their values.
    pub values: Vec<(String, f64)>,
    /// The scene.
    pub scene: Scene,
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
        source.located(Self::of(source, changes))
    }

    /// The combinations as scenes of their own, for verbs of one scene.
    ///
    /// # Errors
    /// Those of [`Sweep::new`].
    pub fn apart(source: &Source, changes: &Changes) -> Result<Vec<Apart>, SceneError> {
        let (_, varied, number) = source.located(Self::axes(source, changes))?;
        let apart = |k: usize| {
            let (mut changes, mut words, mut values) = (changes.clone(), Vec::new(), Vec::new());
            let sets = &mut changes.scheme.sets;
            sets.clear();
            for (one, place) in varied.iter().zip(places(&varied, k)) {
                let texts = vec![one.texts[place].clone()];
                sets.push(Set { name: one.name.clone(), values: texts });
                if one.is_axis() {
                    words.push(one.words(place));
                    values.push((one.name.clone(), one.values[place]));
                }
            }
            let scene = Scene::new(source.clone(), &changes)?;
            Ok(Apart { label: words.join(", "), values, scene })
        };
        (0..number).map(apart).collect()
    }

    /// The scene of the first combination.
    pub fn scene(&self) -> &Scene {
        &self.combinations[0].scene
    }

    fn of(source: &Source, changes: &Changes) -> Read<Self> {
        let (file, mut varied, number) = Self::axes(source, changes)?;
        // One for all scenes, which may be many.
        let changes = &Arc::new(changes.clone());
        let combination = |k: usize| {
            let (mut words, mut axes, mut file) = (Vec::new(), Vec::new(), file.clone());
            for (one, place) in varied.iter().zip(places(&varied, k)) {
                one.put(&mut file, place);
                if one.is_axis() {
                    words.push(one.words(place));
                    axes.push(place);
                }
            }
            let mut scene = Scene::of(source, file, changes, true)?;
            if changes.independent {
                scene.settings.key.experiment = k as u64;
            }
            Ok(Combination { label: words.join(", "), places: axes, scene })
        };
        let combinations = (0..number).map(combination).collect::<Read<_>>()?;
        varied.retain(Varied::is_axis);
        Ok(Self { varied, combinations })
    }

    /// The keys of a scene, the parameters with chosen values, and the number of combinations.
    fn axes(source: &Source, changes: &Changes) -> Read<(SceneFile, Vec<Varied>, usize)> {
        let file = parse(&source.text)?;
        let varied = chosen(&file, &changes.scheme.sets)?;
        let numbers = varied.iter().map(|one| one.values.len() as u64);
        let number = numbers.fold(1u64, u64::saturating_mul);
        if number > MAX_VALUES {
            refuse!(
                varied[0].place.clone(),
                "{number} combinations are too many: at most {MAX_VALUES}"
            );
        }
        Ok((file, varied, number as usize))
    }
}

/// The number of the value of each parameter in a combination.
fn places(varied: &[Varied], combination: usize) -> Vec<usize> {
    let mut rest = combination;
    let mut places: Vec<usize> = Vec::new();
    for one in varied.iter().rev() {
        places.push(rest % one.values.len());
        rest /= one.values.len();
    }
    places.reverse();
    places
}

/// The parameters chosen by the scene and by the command line, which takes precedence.
fn chosen(file: &SceneFile, given: &[Set]) -> Read<Vec<Varied>> {
    let varied = |name: &str, texts: &[String], place| {
        let (name, values, texts) = (name.into(), Vec::new(), texts.to_vec());
        Varied { name, values, texts, place }
    };
    let own = file.sweep.iter();
    let mut all: Vec<Varied> =
        own.map(|(name, values)| varied(name, &values.0, Some(values.span()))).collect();
    for (k, Set { name, values }) in given.iter().enumerate() {
        if given[..k].iter().any(|before| before.name == *name) {
            refuse!(None, "--set {name} is given twice");
        }
        let set = varied(name, values, None);
        match all.iter_mut().find(|known| known.name == *name) {
            Some(known) => *known = set,
            None => all.push(set),
        }
    }
    let known: Vec<&str> = file.system.parameters.keys().map(|key| key.as_str()).collect();
    for Varied { name, values, texts, place } in &mut all {
        let place = place.clone();
        if texts.is_empty() {
            refuse!(place, "`{name}` needs a value");
        }
        if !known.contains(&&**name) && file.system.name.is_none() {
            refuse!(place, "no parameter `{name}` to set{}", among(name, &known));
        }
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
    }
    Ok(all)
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
    /// Scenes near that of a text with the changes that a command line makes; each parameter is
    /// changed by the second number beside its name.
    ///
    /// # Errors
    /// [`SceneError`] if there is no such parameter, or a changed scene is none.
    pub fn new(
        source: &Source,
        changes: &Changes,
        parameters: &[(String, f64)],
    ) -> Result<Self, SceneError> {
        source.located(Self::of(source, changes, parameters))
    }

    fn of(source: &Source, changes: &Changes, parameters: &[(String, f64)]) -> Read<Self> {
        let mut file = parse(&source.text)?;
        settle(&mut file, &changes.scheme.sets)?;
        let numbers = Constants::new(&file.system)?.numbers;
        let changes = Arc::new(changes.clone());
        let put = |file: &mut SceneFile, name: &str, value: f64| {
            let (values, texts) = (vec![value], vec![value.to_string()]);
            Varied { name: name.into(), values, texts, place: None }.put(file, 0);
        };
        let mut generic = Vec::new();
        for (k, (name, change)) in parameters.iter().enumerate() {
            let Some((_, value)) = numbers.iter().find(|(known, _)| known == name) else {
                let known: Vec<&str> = numbers.iter().map(|(known, _)| &known[..]).collect();
                refuse!(None, "no parameter `{name}` to differentiate by{}", among(name, &known));
            };
            if parameters[..k].iter().any(|(before, _)| before == name) {
                refuse!(None, "the derivative by `{name}` is asked for twice");
            }
            differentiable(&file, &numbers, name)?;
            let offset = GENERIC * (k + 1) as f64 * change;
            put(&mut file, name, value + offset);
            generic.push((name, offset, value + offset, *change));
        }
        let words = observed(&file, &changes);
        let near = |&(name, offset, value, change): &(&String, f64, f64, f64)| {
            let (mut file, near) = (file.clone(), value + change);
            put(&mut file, name, near);
            let (parameter, scene) = (name.clone(), Scene::of(source, file, &changes, false)?);
            let is_heat = |word: &String| word.strip_prefix("heat").is_some_and(is_number);
            let has_energy = words.contains("H0") || words.iter().any(is_heat);
            let is_observed = words.contains(name) || has_energy;
            let (change, curvature) = (near - value, 0.0);
            Ok(Changed { parameter, value, change, offset, curvature, is_observed, scene })
        };
        let changed = generic.iter().map(near).collect::<Read<_>>()?;
        Ok(Self { scene: Scene::of(source, file, &changes, false)?, changed })
    }
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_digit())
}

/// Words in the texts of what is observed.
fn observed(file: &SceneFile, changes: &Changes) -> HashSet<String> {
    let named = file.observe.values().chain(file.probabilities.values()).map(|text| &text.0);
    let of = file.expect.iter().flat_map(|table| table.of.iter().map(|text| &text.0));
    let events = file.events.values().map(|event| &event.0.when.0);
    let texts = named.chain(of).chain(events).chain(&changes.of);
    let words = |text: &String| -> Vec<String> {
        let is_of_word = |c: char| c.is_alphanumeric() || c == '_';
        text.split(|c| !is_of_word(c)).map(Into::into).collect()
    };
    texts.flat_map(words).collect()
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

/// Gives the parameters of a scene the values that the command line chooses, one each.
pub fn settle(file: &mut SceneFile, given: &[Set]) -> Read<()> {
    file.sweep.clear();
    for one in chosen(file, given)? {
        if let (name, [first, _, ..]) = (&one.name, &one.texts[..]) {
            refuse!(
                one.place.clone(),
                "`{name}` has {} values, and one is taken here: choose it by --set {name}={first}",
                one.values.len()
            );
        }
        one.put(file, 0);
    }
    Ok(())
}
