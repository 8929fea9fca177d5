//! From a text to the keys of a scene, and the constants in it.

use std::{fmt::Display, ops::Range};

use casimir::formula::{Names, nearest};

use super::{
    file::{SceneFile, SystemTable},
    run::Settings,
    source::{Read, Wrong},
    values::{At, Parameter, Text},
};
use crate::refuse;

/// A scene that is being read.
pub struct Reading<'a> {
    /// Keys of the scene.
    pub file: &'a SceneFile,
    /// Parameters of the scene.
    pub constants: &'a Constants,
    /// Settings of the simulation.
    pub settings: &'a Settings,
}

impl Reading<'_> {
    /// An error about the initial value.
    pub fn initial_error(&self, message: impl Display) -> Wrong {
        Wrong::new(self.settings.initial_place.clone(), message)
    }
}

/// Words that list the known names, or the one nearest to `name`.
pub fn among(name: &str, known: &[&str]) -> String {
    match known {
        [] => "; there is none".into(),
        _ => format!("; there are {}{}", known.join(", "), nearest(name, known)),
    }
}

/// The keys of a scene.
pub fn parse(text: &str) -> Read<SceneFile> {
    toml::from_str(text).map_err(|error| {
        let message = error
            .message()
            .replace("unknown field", "unknown key")
            .replace("missing field", "missing key");
        // A key that is missing somewhere has no place.
        let place =
            error.span().filter(|span| !span.is_empty() || !message.starts_with("missing key"));
        // "unknown key `x`, expected one of `a`, `b`".
        let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        let hint = match words[..] {
            ["temperature", ..] if message.starts_with("unknown key") => {
                "; a bath has a table of its own: [bath]".into()
            }
            [key, ref known @ ..] if message.starts_with("unknown key") => nearest(key, known),
            _ => String::new(),
        };
        Wrong::new(place, message + &hint)
    })
}

/// Whether tables may have a column of this name beside components and observables: what a row is
/// of, or a conformal law C, C1, …, H and H0 and its defect.
pub fn is_column(name: &str) -> bool {
    let law = name.trim_end_matches(" defect");
    let number = law.strip_prefix('C').or(law.strip_prefix('H'));
    ["scheme", "path", "t"].contains(&name)
        || number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The error for a name that a column of the tables has already.
pub fn taken(name: &At<String>) -> Wrong {
    let message = "is a column of the tables already: choose another name";
    Wrong::new(name, format_args!("`{}` {message}", **name))
}

/// Parameters with values.
pub struct Constants {
    /// Names and values of the parameters that are numbers.
    pub numbers: Vec<(String, f64)>,
    /// The parameters as names for formulas.
    pub names: Names,
}

impl Constants {
    /// The values of parameters that are numbers.
    pub fn new(system: &SystemTable) -> Read<Self> {
        let (mut numbers, mut names, none) = (Vec::new(), Names::new(), Names::new());
        for (key, value) in &system.parameters {
            let Parameter::One(text) = &**value else { continue };
            if system.name.is_some() && **key == "lattice" {
                continue; // a word
            }
            let value = constant(&At::new(value.span(), text.clone()), &none)?;
            if **key == "t" {
                refuse!(key, "`t` is the time in the rate of damping");
            }
            names.parameter(key, value).map_err(|error| Wrong::new(key, error))?;
            numbers.push((key.to_string(), value));
        }
        Ok(Self { numbers, names })
    }

    /// The value of a formula of the parameters.
    pub fn value(&self, text: &At<Text>) -> Read<f64> {
        constant(text, &self.names)
    }
}

fn constant(text: &At<Text>, names: &Names) -> Read<f64> {
    let value = text.formula(names)?.value(&[]);
    if !value.is_finite() {
        refuse!(text, "this must be finite, and is {value}");
    }
    Ok(value)
}

/// The parameters of a system of the project.
impl<'a> Reading<'a> {
    /// Checks that all given parameters have known names, or are for baths.
    pub fn know(&self, known: &[&str]) -> Read<()> {
        let baths = self.file.bath.iter();
        let texts = baths.flat_map(|bath| bath.transverse.values().chain([&bath.temperature]));
        let texts: Vec<&str> = texts.map(|text| &*text.0).collect();
        let is_known = |key: &str| known.contains(&key) || texts.iter().any(|of| of.contains(key));
        let mut keys = self.file.system.parameters.keys();
        if let Some(key) = keys.find(|key| !is_known(key)) {
            refuse!(key, "unknown parameter `{}`{}", **key, among(key, known));
        }
        Ok(())
    }

    /// A parameter, if it is given.
    pub fn get(&self, name: &str) -> Option<&'a At<Parameter>> {
        let mut given = self.file.system.parameters.iter();
        given.find(|(key, _)| key.as_str() == name).map(|(_, value)| value)
    }

    /// A number, or the default.
    pub fn number(&self, name: &str, default: f64) -> Read<f64> {
        match self.get(name).map(|value| &**value) {
            None => Ok(default),
            Some(Parameter::One(text)) => self.constant(name, text),
            Some(_) => refuse!(self.place(name), "`{name}` is a number, such as {default}"),
        }
    }

    /// A list of numbers, or the default. One number is a list of one.
    pub fn list(&self, name: &str, default: &[f64]) -> Read<Vec<f64>> {
        let texts = match self.get(name).map(|value| &**value) {
            None => return Ok(default.to_vec()),
            Some(Parameter::One(text)) => std::slice::from_ref(text),
            Some(Parameter::Many(texts)) => texts,
            Some(Parameter::Switch(_)) => {
                refuse!(self.place(name), "`{name}` is a list of numbers, such as {default:?}")
            }
        };
        texts.iter().map(|text| self.constant(name, text)).collect()
    }

    /// Three numbers, or the default.
    pub fn three(&self, name: &str, default: [f64; 3]) -> Read<[f64; 3]> {
        let list = self.list(name, &default)?;
        let number = list.len();
        list.try_into()
            .map_err(|_| self.error(name, format_args!("`{name}` has three numbers, got {number}")))
    }

    /// `true` or `false`, or the default.
    pub fn switch(&self, name: &str, default: bool) -> Read<bool> {
        match self.get(name).map(|value| &**value) {
            None => Ok(default),
            Some(Parameter::Switch(switch)) => Ok(*switch),
            Some(_) => refuse!(self.place(name), "`{name}` is true or false"),
        }
    }

    /// An error at a parameter.
    pub fn error(&self, name: &str, message: impl Display) -> Wrong {
        Wrong::new(self.place(name), message)
    }

    /// The place of a parameter, if it is given.
    pub fn place(&self, name: &str) -> Option<Range<usize>> {
        self.get(name).map(At::span)
    }

    fn constant(&self, name: &str, text: &Text) -> Read<f64> {
        let place = self.place(name).unwrap_or_default();
        constant(&At::new(place, text.clone()), &Names::new())
    }
}
