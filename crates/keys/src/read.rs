//! From a text to the keys of a scene, and the constants in it.

use std::{fmt::Display, ops::Range, slice::from_ref};

use casimir::formula::{Names, nearest};

use crate::{At, Name, Parameter, Read, SceneFile, Settings, SystemTable, Text, Wrong, refuse};

/// A scene that is being read.
pub struct Reading {
    /// Keys of the scene.
    pub file: SceneFile,
    /// Parameters of the scene.
    pub constants: Constants,
    /// Settings of the simulation.
    pub settings: Settings,
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
        let span = error.span().unwrap_or_default();
        let (before, rest) = text.split_at_checked(span.start).unwrap_or_default();
        let item = rest.get(..span.len()).unwrap_or_default();
        let message = match message.strip_prefix("invalid type: ") {
            Some(of) if of.ends_with("expected a map") && !of.starts_with("sequence") => format!(
                "got {item}, where values have names: write {{ p = {item} }}, with a name such as \
                 that of a component for p"
            ),
            Some(of) if of.contains("expected a sequence") || of.contains("expected an array") => {
                wanted_list(before.trim_end(), item, rest)
            }
            _ => message,
        };
        // A key that is missing somewhere has no place.
        let place =
            error.span().filter(|span| !span.is_empty() || !message.starts_with("missing key"));
        // "unknown key `x`, expected one of `a`, `b`".
        let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        let hint = match words[..] {
            _ if !message.starts_with("unknown key") => String::new(),
            ["temperature", ..] => "; a bath has a table of its own: [bath]".into(),
            [key, ref known @ ..] => nearest(key, known),
            [] => String::new(),
        };
        Wrong::new(place, message + &hint)
    })
}

/// The error for an item in the place of a list, which may be one of several in a list.
fn wanted_list(before: &str, item: &str, rest: &str) -> String {
    let mut quoted = false;
    let mut ends = |c| {
        quoted ^= c == '"';
        !quoted && matches!(c, ']' | '\n')
    };
    let items = match before.ends_with('[') {
        true => rest.split(&mut ends).next().unwrap_or(item).trim(),
        false if before.trim_end_matches(['=', ' ']).ends_with("noise") => item,
        false => return format!("got {item}, where a list is wanted: write [{item}]"),
    };
    format!(
        "got {item}, where a list is wanted for each noise, row or pair: write [[{items}]], a list \
         of lists"
    )
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
pub fn taken(name: &Name) -> Wrong {
    let message = "is a column of the tables already, as laws (C1, H0), `t` and `path` are: choose \
                   another name";
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
            // The name of a lattice is a word.
            let is_word = system.name.is_some() && **key == "lattice";
            let (Parameter::One(_), false) = (&**value, is_word) else { continue };
            let others: Vec<&str> = system.parameters.keys().map(|other| &***other).collect();
            let value = constant(&value.texts()[0], &none).map_err(|wrong| {
                wrong.instead(&others, "a parameter cannot use another one: write the value")
            })?;
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

impl At<Parameter> {
    /// The numbers or formulas, all at the place of the parameter.
    pub fn texts(&self) -> Vec<At<Text>> {
        let texts = match &**self {
            Parameter::One(text) => from_ref(text),
            Parameter::Many(texts) => texts,
            Parameter::Switch(_) => &[],
        };
        texts.iter().map(|text| At::new(self.span(), text.clone())).collect()
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
impl Reading {
    /// Checks that all given parameters have names of the text `known`, or are for baths.
    pub fn know(&self, known: &str) -> Read<()> {
        let words = known.split(|c: char| !c.is_alphanumeric());
        let known: Vec<&str> = words.filter(|word| word.starts_with(char::is_alphabetic)).collect();
        let baths = self.file.bath.iter();
        let texts = baths.flat_map(|bath| bath.transverse.values().chain([&bath.temperature]));
        for key in self.file.system.parameters.keys() {
            if !known.contains(&&***key) && !texts.clone().any(|text| text.0.contains(&**key)) {
                refuse!(key, "unknown parameter `{}`{}", **key, among(key, &known));
            }
        }
        Ok(())
    }

    /// A parameter, if it is given.
    pub fn get(&self, name: &str) -> Option<&At<Parameter>> {
        let mut given = self.file.system.parameters.iter();
        given.find(|(key, _)| key.as_str() == name).map(|(_, value)| value)
    }

    /// A number, or the default.
    pub fn number(&self, name: &str, default: f64) -> Read<f64> {
        match self.get(name) {
            Some(at) if !matches!(**at, Parameter::One(_)) => {
                refuse!(at, "`{name}` is a number, such as {default}")
            }
            _ => Ok(self.list(name, &[default])?[0]),
        }
    }

    /// A list of numbers, or the default. One number is a list of one.
    pub fn list(&self, name: &str, default: &[f64]) -> Read<Vec<f64>> {
        match self.get(name).map(|at| (at, &**at)) {
            None => Ok(default.to_vec()),
            Some((at, Parameter::Switch(_))) => {
                refuse!(at, "`{name}` is a list of numbers, such as {default:?}")
            }
            Some((at, _)) => at.texts().iter().map(|text| constant(text, &Names::new())).collect(),
        }
    }

    /// Three numbers, or the default.
    pub fn three(&self, name: &str, default: [f64; 3]) -> Read<[f64; 3]> {
        self.list(name, &default)?.try_into().map_err(|list: Vec<f64>| {
            self.error(name, format_args!("`{name}` has three numbers, got {}", list.len()))
        })
    }

    /// `true` or `false`, or the default.
    pub fn switch(&self, name: &str, default: bool) -> Read<bool> {
        match self.get(name).map(|at| (at, &**at)) {
            None => Ok(default),
            Some((_, Parameter::Switch(switch))) => Ok(*switch),
            Some((at, _)) => refuse!(at, "`{name}` is true or false"),
        }
    }

    /// A result for a parameter, with its error there.
    pub fn checked<T>(&self, name: &str, result: Result<T, impl Display>) -> Read<T> {
        result.map_err(|error| self.error(name, error))
    }

    /// An error at a parameter.
    fn error(&self, name: &str, message: impl Display) -> Wrong {
        Wrong::new(self.place(name), message)
    }

    /// The place of a parameter, if it is given.
    pub fn place(&self, name: &str) -> Option<Range<usize>> {
        self.get(name).map(At::span)
    }
}
