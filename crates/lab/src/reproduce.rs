//! Runs experiments and statements and collects their results.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Instant;

use verify::results::{Provenance, Results, SCHEMA};
use verify::{Progress, Settings};

use crate::experiment::Context;
use crate::panels::EXPERIMENTS;
use crate::statements::STATEMENTS;
use crate::supplement::SUPPLEMENTS;

/// A panel or statement that does not exist.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownPanel {
    /// What was asked for.
    pub id: String,
}

impl fmt::Display for UnknownPanel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let statements: Vec<&str> = STATEMENTS.iter().map(|statement| statement.id).collect();
        write!(
            f,
            "there is no panel or statement {:?}; the panels are {}; figures that are not in the paper: {}; statements \
             that are measured on their own: {} (all other statements are measured on the panels)",
            self.id,
            panel_ids().join(", "),
            SUPPLEMENTS.iter().map(|supplement| supplement.id).collect::<Vec<_>>().join(", "),
            statements.join(", ")
        )
    }
}

impl std::error::Error for UnknownPanel {}

/// All panels, in the order of the paper.
#[must_use]
pub fn panel_ids() -> Vec<&'static str> {
    EXPERIMENTS.iter().flat_map(|experiment| experiment.panels.iter().copied()).collect()
}

/// Checks that every id names a panel or a statement.
///
/// # Errors
/// [`UnknownPanel`] names the first that does not, and lists those that do.
pub fn check_ids(ids: &[String]) -> Result<(), UnknownPanel> {
    let known = |id: &str| {
        panel_ids().contains(&id)
            || STATEMENTS.iter().any(|statement| statement.id == id)
            || SUPPLEMENTS.iter().any(|supplement| supplement.id == id)
    };
    match ids.iter().find(|id| !known(id)) {
        None => Ok(()),
        Some(id) => Err(UnknownPanel { id: id.clone() }),
    }
}

/// First experiment numbers of the statements and of the supplements; the paper's experiments count
/// from 1.
const STATEMENT_NUMBERS: u64 = 1000;
const SUPPLEMENT_NUMBERS: u64 = 2000;

/// Runs the panels, statements and supplements in `only`, or all of them when it is empty, on the
/// current rayon pool.
///
/// Of the provenance, the seed, the mode and the timings by id are filled in; the rest is left to
/// the caller.
///
/// # Errors
/// [`UnknownPanel`] before anything is computed.
pub fn reproduce(
    settings: Settings,
    only: &[String],
    progress: &dyn Progress,
) -> Result<Results, UnknownPanel> {
    check_ids(only)?;
    let wanted = |id: &str| only.is_empty() || only.iter().any(|name| name == id);
    let mut wall_s_by_id = BTreeMap::new();
    let (mut panels, mut claims) = (Vec::new(), Vec::new());
    for (number, experiment) in (1u64..).zip(EXPERIMENTS) {
        let selection: Vec<&str> =
            experiment.panels.iter().copied().filter(|id| wanted(id)).collect();
        if selection.is_empty() {
            continue;
        }
        let start = Instant::now();
        let context = Context { settings, experiment: number, wanted: &selection, progress };
        let result = (experiment.run)(&context);
        panels.extend(result.panels);
        claims.extend(result.claims);
        wall_s_by_id.insert(selection.join(", "), start.elapsed().as_secs_f64());
    }
    for (number, statement) in (STATEMENT_NUMBERS..).zip(STATEMENTS) {
        if !wanted(statement.id) {
            continue;
        }
        let start = Instant::now();
        let context = Context { settings, experiment: number, wanted: &[], progress };
        claims.extend((statement.measure)(&context));
        wall_s_by_id.insert(statement.id.to_owned(), start.elapsed().as_secs_f64());
    }
    let mut supplements = Vec::new();
    for (number, supplement) in (SUPPLEMENT_NUMBERS..).zip(SUPPLEMENTS) {
        if !wanted(supplement.id) {
            continue;
        }
        let start = Instant::now();
        let context = Context { settings, experiment: number, wanted: &[], progress };
        let result = (supplement.run)(&context);
        supplements.extend(result.panels);
        claims.extend(result.claims);
        wall_s_by_id.insert(supplement.id.to_owned(), start.elapsed().as_secs_f64());
    }
    let mode = match settings.mode {
        verify::Mode::Paper => "paper",
        verify::Mode::Quick => "quick",
    };
    let provenance = Provenance {
        seed: settings.seed,
        mode: mode.to_owned(),
        wall_s_by_id,
        ..Provenance::default()
    };
    Ok(Results { schema: SCHEMA, provenance, panels, supplements, claims })
}
