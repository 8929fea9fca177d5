//! What a hard case is.

use anyhow::Result;
use noise::StreamKey;
use serde::Serialize;

use crate::{Arguments, row::Row};

/// A family of hard inputs.
#[derive(Serialize)]
pub struct Case {
    /// Identifier.
    pub id: &'static str,
    /// The title.
    pub title: &'static str,
    /// System, damping, steps and noise.
    pub setup: &'static str,
    /// What exact mathematics says.
    pub mathematics: &'static str,
    /// What the measured figure is.
    pub quantity: &'static str,
    /// What is guaranteed, and why.
    pub guarantee: &'static str,
    /// What the settings vary.
    pub varied: &'static str,
    /// Runs all schemes in all settings.
    #[serde(skip)]
    pub rows: fn(&Context) -> Rows,
}

/// The quantity of most cases.
pub const SQUARED_LENGTH: &str =
    "largest relative distance of |y|² from its law, before a path ends";

/// All schemes in all settings of a case.
pub type Rows = Result<Vec<Row>>;

/// What a case needs to run.
pub struct Context<'a> {
    pub key: StreamKey,
    pub arguments: &'a Arguments,
}

/// The rows of every setting.
pub fn each<T>(settings: impl IntoIterator<Item = T>, rows: impl FnMut(T) -> Rows) -> Rows {
    Ok(settings.into_iter().map(rows).collect::<Result<Vec<_>>>()?.concat())
}
