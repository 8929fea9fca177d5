//! From a text to the keys of a scene, and the constants in it.

use casimir::formula::{Formula, Names};
use indexmap::IndexMap;
use toml::Spanned;

use super::{
    file::{SceneFile, SystemTable},
    source::{Read, Source},
    values::{Parameter, Text},
};

/// The keys of a scene.
pub fn parse(source: &Source) -> Read<SceneFile> {
    toml::from_str(&source.text).map_err(|error| {
        let message = error.message().replace("unknown field", "unknown key");
        let message = message.replace("missing field", "missing key");
        match error.span() {
            // A key that is missing somewhere has no place.
            Some(span) if !span.is_empty() || !message.starts_with("missing key") => {
                source.error(span, with_nearest(&message))
            }
            _ => source.error_of_all(message),
        }
    })
}

/// Adds the nearest known key to "unknown key `x`, expected one of `a`, `b`".
fn with_nearest(message: &str) -> String {
    let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let (Some((key, known)), true) = (words.split_first(), message.starts_with("unknown key"))
    else {
        return message.to_owned();
    };
    let nearest = known
        .iter()
        .map(|known| (strsim::damerau_levenshtein(key, known), known))
        .filter(|(distance, _)| *distance <= (key.chars().count() / 3).max(1))
        .min();
    match nearest {
        Some((_, nearest)) => format!("{message}; the nearest is `{nearest}`"),
        None => message.to_owned(),
    }
}

/// Parameters with values.
pub struct Constants {
    /// Names and values of the parameters that are numbers.
    pub numbers: Vec<(String, f64)>,
    names: Names,
}

impl Constants {
    /// The values of parameters that are numbers.
    pub fn new(source: &Source, system: &SystemTable) -> Read<Self> {
        let (mut numbers, mut names, none) = (Vec::new(), Names::new(), Names::new());
        for (key, value) in &system.parameters {
            let Parameter::One(text) = value.get_ref() else { continue };
            let text = Spanned::new(value.span(), text.clone());
            let value = constant(source, &text, &none)?;
            let name = key.get_ref();
            if name == "t" {
                return Err(source.error(key.span(), "`t` is the time in the rate of damping"));
            }
            let taken = |error| source.error(key.span(), error);
            names.parameter(name, value).map_err(taken)?;
            numbers.push((name.clone(), value));
        }
        Ok(Self { numbers, names })
    }

    /// The value of a formula of the parameters.
    pub fn value(&self, source: &Source, text: &Spanned<Text>) -> Read<f64> {
        constant(source, text, &self.names)
    }
}

fn constant(source: &Source, text: &Spanned<Text>, names: &Names) -> Read<f64> {
    let formula = Formula::parse(&text.get_ref().0, names);
    let formula = formula.map_err(|error| source.formula_error(text, &error))?;
    let value = formula.value(&[]);
    match value.is_finite() {
        true => Ok(value),
        false => Err(source.error(text.span(), format!("this must be finite, and is {value}"))),
    }
}

/// The parameters of a system of the project.
pub struct Parameters<'a> {
    source: &'a Source,
    given: &'a IndexMap<Spanned<String>, Spanned<Parameter>>,
}

impl<'a> Parameters<'a> {
    /// Those of this table, which may have these names only.
    pub fn new(source: &'a Source, system: &'a SystemTable, known: &[&str]) -> Read<Self> {
        let given = &system.parameters;
        match given.keys().find(|key| !known.contains(&key.get_ref().as_str())) {
            Some(key) => {
                let name = key.get_ref();
                let message = match known {
                    [] => format!("unknown parameter `{name}`: this system has none"),
                    _ => format!("unknown parameter `{name}`; there are {}", known.join(", ")),
                };
                Err(source.error(key.span(), message))
            }
            None => Ok(Self { source, given }),
        }
    }

    fn get(&self, name: &str) -> Option<&'a Spanned<Parameter>> {
        let found = self.given.iter().find(|(key, _)| key.get_ref() == name);
        found.map(|(_, value)| value)
    }

    /// A number, or the default.
    pub fn number(&self, name: &str, default: f64) -> Read<f64> {
        match self.get(name).map(|value| (value.get_ref(), value.span())) {
            None => Ok(default),
            Some((Parameter::One(text), span)) => self.constant(text, span),
            Some((_, span)) => {
                let message = format!("`{name}` is a number, such as {default}");
                Err(self.source.error(span, message))
            }
        }
    }

    /// A list of numbers, if it is given. One number is a list of one.
    pub fn list(&self, name: &str) -> Read<Option<Vec<f64>>> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let texts = match value.get_ref() {
            Parameter::One(text) => std::slice::from_ref(text),
            Parameter::Many(texts) => texts,
            Parameter::Switch(_) => {
                let message = format!("`{name}` is a list of numbers, such as [1, 2, 3]");
                return Err(self.source.error(value.span(), message));
            }
        };
        let value = |text| self.constant(text, value.span());
        texts.iter().map(value).collect::<Read<_>>().map(Some)
    }

    /// Three numbers, or the default.
    pub fn three(&self, name: &str, default: [f64; 3]) -> Read<[f64; 3]> {
        let Some(list) = self.list(name)? else { return Ok(default) };
        let wrong = |list: Vec<f64>| {
            self.error(name, format!("`{name}` has three numbers, got {}", list.len()))
        };
        list.try_into().map_err(wrong)
    }

    /// `true` or `false`, or the default.
    pub fn switch(&self, name: &str, default: bool) -> Read<bool> {
        match self.get(name).map(|value| (value.get_ref(), value.span())) {
            None => Ok(default),
            Some((Parameter::Switch(switch), _)) => Ok(*switch),
            Some((_, span)) => Err(self.source.error(span, format!("`{name}` is true or false"))),
        }
    }

    /// An error at a parameter.
    pub fn error(&self, name: &str, message: impl std::fmt::Display) -> super::SceneError {
        match self.get(name) {
            Some(value) => self.source.error(value.span(), message),
            None => self.source.error_of_all(message),
        }
    }

    /// Whether a parameter is given.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    fn constant(&self, text: &Text, span: std::ops::Range<usize>) -> Read<f64> {
        constant(self.source, &Spanned::new(span, text.clone()), &Names::new())
    }
}
