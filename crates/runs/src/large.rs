//! Paths of a large lattice, one after the other.

use std::{path::Path, time::Instant};

use casimir::{
    lattice::{Follow, LargePath, Record},
    mc::{
        Checkpoint, files,
        parts::{Job, hash},
    },
    real::Row,
    schemes::BuiltIn,
};

use crate::{
    Results, Settled, Watch,
    failure::{Done, refuse},
    output::npz_bytes,
    run::means,
};
use scenes::{Combination, Scene, model::Large};

/// Checks that the paths of a large lattice can be computed by a scheme.
pub fn check(scene: &Scene, large: &Large, scheme: &str) -> Done {
    let wrong = |why: String| scene.source.error(scene.settings.scheme_place.clone(), why);
    BuiltIn::named(scheme)
        .ok_or_else(|| wrong(format!("no scheme `{scheme}`")))?
        .at_run_time(&*large.lattice)
        .map_err(|error| wrong(error.to_string()))?;
    if scene.collects() {
        return refuse("integrals, times and events of large lattices are not collected");
    }
    Ok(())
}

/// Computes the paths of a scene.
pub fn compute(
    combination: &Combination,
    large: &Large,
    (scheme, because): Settled,
    job: &Job,
    watch: &Watch,
) -> Done<Option<Results>> {
    let (start, scene, prefix) = (Instant::now(), &combination.scene, combination.prefix());
    if !job.is_whole() {
        let words = "a lattice of so many spins is one path on all threads, and has no parts";
        return refuse(format!("{words}: `casimir run` goes on after a stop"));
    }
    let settings = &scene.settings;
    let (steps, lattice) = (settings.steps, &large.lattice);
    let built_in = BuiltIn::named(&scheme).expect("it was checked").at_run_time(&**lattice)?;
    let every = steps / settings.times;
    let follow = Follow {
        lattice,
        steps,
        every,
        spectra_every: every * (settings.times / settings.snapshots),
    };
    let of_sweep =
        if prefix.is_empty() { String::new() } else { hash(&prefix)[..8].to_owned() + "-" };
    let (mut tables, mut records) = (Vec::new(), Vec::new());
    for path in 0..settings.paths {
        let problem = large.path(path)?;
        let of_path = if settings.paths > 1 { format!("path {path}") } else { "path".into() };
        let name = format!("{of_sweep}{path}");
        let checkpoint = job.checkpoint(&name);
        let (truncation, key) = (settings.truncation, settings.key);
        let one = LargePath::new(&problem, &*built_in, steps, truncation, key, path)
            .map_err(|error| scene.steps_error(error))?;
        let folder = checkpoint.as_ref().and_then(|checkpoint| checkpoint.file().parent());
        let mut keep = |step: u64, y: &[Row]| match folder {
            Some(folder) => snapshot(folder, &format!("{name}-{step}"), large, y),
            None => Ok(()),
        };
        let found = watch.under(&format!("{prefix}{of_path}"), steps, |told| {
            follow.path(one, checkpoint.as_ref(), &watch.stop, told, &mut keep)
        })?;
        if let Some(failure) = checkpoint.as_ref().and_then(Checkpoint::failure) {
            watch.progress.say(&format!("warning: no checkpoint: {failure}"));
        }
        tables.push(large.table(scene, (&scheme, path), &found));
        records.push(found);
        if watch.stop.is_asked() {
            break;
        }
    }
    Ok(Some(Results {
        scheme,
        because,

        means: means(scene, &tables),
        tables,
        study: None,
        check: None,
        spectra: Record::spectra_of(&records),
        seconds: start.elapsed().as_secs_f64(),
    }))
}

/// Writes the spins of a path at a time: [third, second axis, site of the cell, first axis, 3].
fn snapshot(folder: &Path, name: &str, large: &Large, y: &[Row]) -> std::io::Result<()> {
    let crystal = large.lattice.crystal();
    let [first, second, third] = crystal.shape.sizes();
    let spins = (0..crystal.sites()).flat_map(|site| large.lattice.spin(y, site, 0)).collect();
    files::write(
        &folder.join(format!("spins-{name}.npz")),
        npz_bytes([(
            "spins".into(),
            vec![third, second, crystal.materials.len(), first, 3],
            spins,
        )])?,
    )
}
