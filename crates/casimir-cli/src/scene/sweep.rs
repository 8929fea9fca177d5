//! A scene at several values of its parameters.

use std::{ops::Range, str::FromStr};

use casimir::formula::{Formula, Names, nearest};
use serde::{Deserialize, Serialize};

use super::{
    Changes, Scene,
    file::{SceneFile, SystemTable},
    read,
    source::{Read, Source},
    values::{At, MOST_VALUES, Parameter, Text, Values},
};

/// `--set NAME=VALUES`: the values of a parameter, instead of those of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Set {
    /// The parameter.
    pub name: String,
    /// Its values as they are written.
    pub values: Vec<String>,
}

impl FromStr for Set {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, values) = text.split_once('=').ok_or_else(|| {
            format!("`{text}` has no value: write NAME=VALUE, or NAME=0.1,0.2,0.5")
        })?;
        let values: Values = values.parse()?;
        Ok(Self::new(name.trim(), &values))
    }
}

impl Set {
    fn new(name: &str, values: &Values) -> Self {
        Self {
            name: name.into(),
            values: values.0.iter().map(|Text(value)| value.clone()).collect(),
        }
    }
}

/// A parameter that is varied.
pub struct Varied {
    /// Its name.
    pub name: String,
    /// Its values.
    pub values: Vec<f64>,
}

/// One combination of the values.
pub struct Combination {
    /// `sigma = 0.1, J = 2`; empty if nothing is varied.
    pub label: String,
    /// The number of the value of each parameter that is varied.
    pub places: Vec<usize>,
    /// The scene with these values.
    pub scene: Scene,
}

/// A scene at every combination of the values that are varied; the last parameter changes fastest.
pub struct Sweep {
    /// What is varied; nothing if there is one combination.
    pub varied: Vec<Varied>,
    /// The scenes; at least one.
    pub combinations: Vec<Combination>,
}

impl Sweep {
    /// The scenes of a text, with the changes that a command line makes.
    ///
    /// # Errors
    /// [`SceneError`](super::SceneError) as that of [`Scene::new`], or about what is varied.
    pub fn new(source: &Source, changes: &Changes) -> Read<Self> {
        let file = read::parse(source)?;
        let sets = sets(source, &file, &changes.scheme.sets)?;
        for (set, place) in &sets {
            key(source, &file.system, &set.name, place.clone())?;
        }
        let numbers = sets.iter().map(|(set, _)| set.values.len() as u64);
        let number = numbers.fold(1u64, u64::saturating_mul);
        if number > MOST_VALUES {
            let message = format!("{number} combinations are too many: at most {MOST_VALUES}");
            return Err(source.error(sets[0].1.clone(), message));
        }
        let is_varied = |set: &Set| set.values.len() > 1;
        let varied = sets.iter().filter(|(set, _)| is_varied(set)).map(|(set, place)| {
            let value = |text: &String| value(source, (&set.name, text), place.clone());
            let values = set.values.iter().map(value).collect::<Read<_>>()?;
            Ok(Varied { name: set.name.clone(), values })
        });
        let combination = |k: usize| {
            let (mut rest, mut words, mut places, mut of_one) = (k, vec![], vec![], vec![]);
            for (set, _) in sets.iter().rev() {
                let (place, Set { name, values }) = (rest % set.values.len(), set);
                rest /= values.len();
                if is_varied(set) {
                    words.insert(0, format!("{name} = {}", values[place]));
                    places.insert(0, place);
                }
                of_one.insert(0, Set { name: name.clone(), values: vec![values[place].clone()] });
            }
            let mut changes = changes.clone();
            changes.scheme.sets = of_one;
            let mut scene = Scene::new(source.clone(), &changes)?;
            if changes.independent {
                scene.settings.key.experiment = k as u64;
            }
            Ok(Combination { label: words.join(", "), places, scene })
        };
        Ok(Self {
            varied: varied.collect::<Read<_>>()?,
            combinations: (0..number as usize).map(combination).collect::<Read<_>>()?,
        })
    }
}

/// A set, and where it stands if it is of the scene.
type Placed = (Set, Option<Range<usize>>);

/// What the scene and the command line set, which goes before.
fn sets(source: &Source, file: &SceneFile, given: &[Set]) -> Read<Vec<Placed>> {
    let mut sets: Vec<Placed> = file
        .sweep
        .iter()
        .map(|(name, values)| (Set::new(name, values), Some(values.span())))
        .collect();
    for (k, set) in given.iter().enumerate() {
        if given[..k].iter().any(|before| before.name == set.name) {
            return Err(source.error(None, format!("--set {} is given twice", set.name)));
        }
        match sets.iter_mut().find(|(known, _)| known.name == set.name) {
            Some(known) => *known = (set.clone(), None),
            None => sets.push((set.clone(), None)),
        }
    }
    match sets.iter().find(|(set, _)| set.values.is_empty()) {
        Some((set, place)) => {
            Err(source.error(place.clone(), format!("`{}` needs a value", set.name)))
        }
        None => Ok(sets),
    }
}

/// The value of a parameter.
fn value(source: &Source, (name, text): (&str, &str), place: Option<Range<usize>>) -> Read<f64> {
    let formula = Formula::parse(text, &Names::new());
    let value = formula.map_err(|error| error.message).and_then(|formula| {
        let value = formula.value(&[]);
        value.is_finite().then_some(value).ok_or_else(|| format!("it is {value}"))
    });
    value.map_err(|why| source.error(place, format!("{name} = {text}: {why}")))
}

/// The key of a parameter that is set.
fn key(
    source: &Source,
    system: &SystemTable,
    name: &str,
    place: Option<Range<usize>>,
) -> Read<At<String>> {
    match system.parameters.keys().find(|key| key.as_str() == name) {
        Some(key) => Ok(key.clone()),
        // A system of the project knows its parameters itself.
        None if system.name.is_some() => Ok(At::new(0..0, name.into())),
        None => {
            let known: Vec<&str> = system.parameters.keys().map(|key| key.as_str()).collect();
            let hint = nearest(name, &known);
            let known = match known[..] {
                [] => "this scene has none".into(),
                _ => format!("there are {}", known.join(", ")),
            };
            Err(source.error(place, format!("no parameter `{name}` to set; {known}{hint}")))
        }
    }
}

/// Gives the parameters of a scene the values that are set, one each.
pub fn settle(source: &Source, file: &mut SceneFile, given: &[Set]) -> Read<()> {
    for (Set { name, values }, place) in sets(source, file, given)? {
        let [text] = &values[..] else {
            let message = format!(
                "`{name}` has {} values, and only `run` and `plan` vary parameters: choose one by \
                 --set {name}={}",
                values.len(),
                values[0]
            );
            return Err(source.error(place, message));
        };
        value(source, (&name, text), place.clone())?;
        let key = key(source, &file.system, &name, place)?;
        let system = &mut file.system;
        let at = system.parameters.get(&key).map_or(0..0, |before| before.span());
        system.parameters.insert(key, At::new(at, Parameter::One(Text(text.clone()))));
    }
    Ok(())
}
