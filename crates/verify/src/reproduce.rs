//! Runs experiments and collects their results.

use std::{collections::BTreeMap, time::Instant};

use plot::Progress;
use schemes::BuiltIn;

use crate::{
    Conditions, EXPERIMENTS, Experiment, STATEMENTS, SUPPLEMENTS,
    results::{Provenance, Results, SCHEMA},
    settings::Settings,
    streams,
};

/// The ids of what experiments make.
pub fn ids(experiments: &[Experiment]) -> impl Iterator<Item = &'static str> {
    experiments.iter().flat_map(|experiment| experiment.ids).copied()
}

/// Runs the panels, statements and supplements in `only`, or all of them when it is empty, on the
/// current rayon pool. The schemes in `further` are series of the panels that they are for, beside
/// those of the paper, whose numbers do not depend on them.
///
/// Of the provenance, the seed, the mode, the threads and the timings by id are filled in; the rest
/// is left to the caller.
pub fn reproduce(
    settings: Settings,
    only: &[&str],
    further: &[BuiltIn],
    progress: &dyn Progress,
) -> Results {
    let mut wall_s_by_id = BTreeMap::new();
    let (mut panels, mut supplements, mut claims) = (Vec::new(), Vec::new(), Vec::new());
    let families = [
        (streams::PANELS, EXPERIMENTS, true),
        (streams::STATEMENTS, STATEMENTS, false),
        (streams::SUPPLEMENTS, SUPPLEMENTS, false),
    ];
    for (first, family, of_paper) in families {
        for (experiment, member) in (first..).zip(family) {
            let mut wanted = member.ids.to_vec();
            wanted.retain(|id| only.is_empty() || only.contains(id));
            if wanted.is_empty() {
                continue;
            }
            let (names, start) = (wanted.join(", "), Instant::now());
            let wanted = &wanted;
            let conditions = Conditions { settings, experiment, wanted, further, progress };
            progress.begin(&names, 0);
            let found = (member.run)(&conditions);
            progress.end();
            if of_paper { &mut panels } else { &mut supplements }.extend(found.panels);
            claims.extend(found.claims);
            wall_s_by_id.insert(names, start.elapsed().as_secs_f64());
        }
    }
    let run = Provenance::of_run(settings.seed, settings.mode.id());
    let samples_times = settings.samples_times;
    let provenance = Provenance { wall_s_by_id, samples_times, ..run };
    Results { schema: SCHEMA, provenance, panels, supplements, claims }
}
