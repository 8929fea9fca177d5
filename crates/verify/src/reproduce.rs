//! Runs experiments and collects their results.

use std::time::Instant;

use crate::*;

/// Identifiers of the panels and statements that experiments make.
pub fn ids(experiments: &[Experiment]) -> impl Iterator<Item = &'static str> {
    experiments.iter().flat_map(|(ids, _)| *ids).copied()
}

/// Runs the panels, statements and supplements in `only`, or all of them when it is empty, on the
/// current rayon pool, at the paper's sizes or at `quick` ones, and says on the standard error what
/// is running.
///
/// Seed, mode, threads and timings by id are filled in as provenance; the caller fills in the rest.
pub fn reproduce(seed: u64, quick: bool, only: &[&str]) -> Results {
    let mode = if quick { "quick" } else { "paper" };
    let provenance = Provenance::of_run(seed, mode);
    let mut results = Results { schema: SCHEMA, provenance, ..Results::default() };
    let families = [
        (streams::PANELS, EXPERIMENTS, &mut results.panels),
        (streams::STATEMENTS, STATEMENTS, &mut Vec::new()),
        (streams::SUPPLEMENTS, SUPPLEMENTS, &mut results.supplements),
    ];
    for (first, family, panels) in families {
        for (experiment, (ids, run)) in (first..).zip(family) {
            let wanted = |id: &str| only.is_empty() || only.contains(&id);
            let mut names = ids.to_vec();
            names.retain(|id| wanted(id));
            if names.is_empty() {
                continue;
            }
            let (names, start) = (names.join(", "), Instant::now());
            eprintln!("{names}");
            let mut found = run(&Conditions { seed, quick, experiment, id: ids[0] });
            // Of panels that are made together all are made.
            let other = |id: &str| ids.contains(&id) && !wanted(id);
            found.panels.retain(|panel| !other(&panel.id));
            found.claims.retain(|claim| !other(&claim.panel));
            panels.extend(found.panels);
            results.claims.extend(found.claims);
            let seconds = start.elapsed().as_secs_f64();
            results.provenance.wall_s_by_id.insert(names, seconds);
        }
    }
    results
}
