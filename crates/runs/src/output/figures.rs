//! The figures of a run.

use std::{array, collections::BTreeMap, iter::zip};

use casimir::{
    figures::{histogram, law},
    mc::{Role, parts::hash},
    plot::{
        self,
        figure::{Projection, Trace, bands, evolution, lines, maps, picture, strip},
    },
    stats::Point,
    study::{Joint, Kind},
};

use super::{page::TABLE, *};
use scenes::{FigureSettings, MAX_COMPONENTS, model::Grid};

/// A drawing with its file and the words below it.
pub struct Figure {
    /// Name of the figure, such as `time-q`.
    pub name: String,
    /// Name of the file without `.svg`; see [`distinct`].
    pub file: String,
    /// The SVG document.
    pub svg: String,
    /// Caption of the figure.
    pub caption: String,
}

impl Figure {
    /// A drawing with its name.
    pub fn new(name: impl Into<String>, svg: String, caption: impl Into<String>) -> Self {
        let (name, caption) = (name.into(), caption.into());
        let file =
            name.chars().take(LONGEST).map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
        Self { name, file, svg, caption }
    }

    /// A drawing of something with a name.
    pub fn of(what: &str, name: &str, svg: String, caption: String) -> Self {
        Self::new(format!("{what}-{name}"), svg, caption)
    }
}

/// Characters of the name of a figure in that of its file, which has at most 255 bytes.
const LONGEST: usize = 48;

/// Makes the names of files distinct: figures whose files would have one name, where capital
/// letters are small ones too, have a hash of their own name in it.
pub fn distinct<'a>(figures: impl Iterator<Item = &'a mut Figure>) {
    let mut all = BTreeMap::<String, Vec<_>>::new();
    for figure in figures {
        all.entry(figure.file.to_lowercase()).or_default().push(figure);
    }
    for figure in all.into_values().filter(|same| same.len() > 1).flatten() {
        figure.file += &format!("-{}", &hash(&figure.name)[..8]);
    }
}

/// A section of figures.
pub type Section = (&'static str, Vec<Figure>);

/// Paths in a figure; more hide each other.
const SHOWN_PATHS: usize = 4;
/// Times in a figure of correlations.
const SHOWN_TIMES: usize = 4;
/// Laws in a report.
const SHOWN_LAWS: usize = 6;
/// Pictures of a lattice.
const PICTURES: usize = 6;
/// Latitudes of a map of the sphere.
const LATITUDES: usize = 48;
/// Phase portraits in a report.
const PORTRAITS: usize = 3;

/// All figures of a run by section; that of the table at the end may have none.
pub fn all(scene: &Scene, results: &Results) -> Vec<Section> {
    let drawn = &scene.drawn;
    let names: Vec<&String> = match &drawn.show {
        Some(show) => show.iter().collect(),
        None => results.series().iter().map(|series| &series.observable).collect(),
    };
    let mut sections = match &results.study {
        Some(study) => of_study(drawn, &names, study),
        None => {
            let figure = |name: &String| {
                Figure::of(
                    "time",
                    name,
                    lines(name, "time t", drawn.title(name), &traces(results, "t", name)),
                    format!("{name} in time on {}.", paths(results)),
                )
            };
            vec![("In time", names.into_iter().map(figure).collect())]
        }
    };
    sections.extend([
        ("Phase portraits", portraits(scene, results)),
        ("The lattice", lattice(scene, results).into_iter().collect()),
        ("Correlations and structure factors", spectra(results)),
        ("The sphere", sphere(scene, results).unwrap_or_default()),
        ("Conserved but for the damping", laws(results)),
    ]);
    sections.retain(|(title, figures)| !figures.is_empty() || *title == TABLE);
    sections
}

/// The figures of the statistics of observables.
fn of_study(drawn: &FigureSettings, names: &[&String], study: &StudyResult) -> Vec<Section> {
    let levels = study
        .record
        .quantiles
        .iter()
        .map(|level| digits(100.0 * level))
        .collect::<Vec<_>>()
        .join(" %, ");
    let (paths, mut in_time, mut at_end) = (study.record.paths, Vec::new(), Vec::new());
    for series in names.iter().filter_map(|name| study.series(name)) {
        let (Series { observable: name, points, .. }, last) = (series, series.last());
        let band = if points.iter().all(|point| point.quantiles.is_empty()) {
            "Band: 95 % intervals; dashes: estimate.".into()
        } else {
            format!("Bands between the quantiles {levels} %; line: median; dashes: mean.")
        };
        in_time.push(Figure::of(
            "time",
            name,
            bands(name, "time t", drawn.title(name), &law(points)),
            format!("{name} in time, {paths} paths. {band}"),
        ));
        if last.histogram.is_some() {
            at_end.push(Figure::of(
                "end",
                name,
                histogram(name, name, last),
                format!(
                    "The law of {name} at t = {}, {} paths: density; line: median; dashes: mean.",
                    last.time, last.count
                ),
            ));
        }
    }
    vec![("In time", in_time), (TABLE, at_end), ("Dependence", dependence(drawn, study))]
}

/// Words for the paths in a figure: `path 0`, or how many of how many.
fn paths(results: &Results) -> String {
    match results.tables.len() {
        1 => "path 0".into(),
        all @ ..=SHOWN_PATHS => format!("{all} paths"),
        all => format!("the first {SHOWN_PATHS} of {all} paths"),
    }
}

/// A column of the first tables against another.
fn traces(results: &Results, x: &str, y: &str) -> Vec<Trace> {
    results
        .tables
        .iter()
        .enumerate()
        .take(SHOWN_PATHS)
        .map(|(path, table)| {
            let [x, y] = [x, y].map(|name| table.column(name).unwrap_or_default().iter().copied());
            Trace { name: format!("path {path}"), points: x.zip(y).collect() }
        })
        .collect()
}

fn portraits(scene: &Scene, results: &Results) -> Vec<Figure> {
    let names = &scene.components;
    let pairs: &[(usize, usize)] = match names.len() {
        3 => &[(0, 1), (1, 2), (0, 2)],
        dimension if dimension > MAX_COMPONENTS => &[],
        dimension => &(1..dimension).step_by(2).map(|i| (i - 1, i)).collect::<Vec<_>>(),
    };
    let few = pairs.iter().take(PORTRAITS).map(|&(i, j)| [names[i].clone(), names[j].clone()]);
    let portrait = |[x, y]: [String; 2]| {
        let title = format!("{y} against {x}");
        let svg = lines(&title, &x, &*y, &traces(results, &x, &y));
        Figure::of(
            "portrait",
            &format!("{x}\0{y}"),
            svg,
            format!("{title} on {}; the marker is the initial value.", paths(results)),
        )
    };
    let pairs = scene.drawn.portraits.clone().unwrap_or_else(|| few.collect());
    pairs.into_iter().map(portrait).collect()
}

/// Correlations and structure factors of the first path along each axis, at the last time and some
/// before.
fn spectra(results: &Results) -> Vec<Figure> {
    let [(_, _, times), arrays @ ..] = &results.spectra[..] else { return Vec::new() };
    let between = times.len().saturating_sub(1).div_ceil(SHOWN_TIMES - 1).max(1);
    let of_axis = ["distance in cells", "wave number, in reciprocal vectors over the length"];
    let figure = |((name, shape, values), x): (&Array, &str)| {
        // The last one, and those a distance before it.
        let mut traces: Vec<Trace> = zip(times, values.chunks(shape[2]))
            .rev()
            .step_by(between)
            .map(|(&time, row)| Trace {
                name: at(time),
                points: row.iter().enumerate().map(|(k, value)| (k as f64, *value)).collect(),
            })
            .collect();
        traces.reverse();
        Figure::of(
            "spectrum",
            name,
            lines(name, x, &**name, &traces),
            format!("{name} along its axis, path 0, at {} times.", traces.len()),
        )
    };
    zip(arrays, of_axis.into_iter().cycle()).map(figure).collect()
}

/// Words for a time.
fn at(time: f64) -> String {
    format!("t = {}", digits(time))
}

/// The table of path 0, and places in it for several pictures; none if it was not begun.
fn pictured(results: &Results) -> Option<(&TimeSeries, [usize; PICTURES])> {
    let table = results.tables.first()?;
    let last = table.times().len().checked_sub(1)?;
    Some((table, array::from_fn(|k| k * last / (PICTURES - 1))))
}

/// Joint laws, autocorrelations and spectra.
fn dependence(drawn: &FigureSettings, study: &StudyResult) -> Vec<Figure> {
    let joint = study.joint.iter().map(|Joint { names: [a, b], grids, counts, outside }| {
        let [x, y] = grids.map(|grid| (grid.edge(0), grid.edge(grid.bins)));
        let [columns, rows] = grids.map(|grid| grid.bins as usize);
        // Roots, so that the tails are seen.
        let values: Vec<f64> = (0..columns * rows)
            .map(|k| (counts[(k % columns) * rows + k / columns] as f64).sqrt())
            .collect();
        Figure::of(
            "joint",
            &format!("{a}\0{b}"),
            picture(&format!("{b} and {a}"), (x, a), (y, b), columns, &values),
            format!(
                "The joint law of {a} and {b} at the end: roots of counts, {outside} of {} paths \
             outside.",
                study.record.paths
            ),
        )
    });
    let lagged = study.lagged.iter().map(|Series { observable: name, kind, points }| {
        let (axis, more) = match kind {
            Kind::Spectrum => {
                ("angular frequency", " Its integral over all frequencies is the variance.")
            }
            _ => ("lag", ""),
        };
        Figure::of(
            "lag",
            name,
            bands(name, axis, drawn.title(name), &law(points)),
            format!("{name} against the {axis}. Band: 95 % intervals.{more}"),
        )
    });
    joint.chain(lagged).collect()
}

/// The third components of the spins of path 0: a plane at several times, or a chain in time.
fn lattice(scene: &Scene, results: &Results) -> Option<Figure> {
    let ((table, places), &columns) = (pictured(results)?, scene.sizes.first()?);
    let (times, plane) = (table.times(), scene.sizes.iter().take(2).product::<usize>());
    let spins = (0..plane)
        .map(|site| table.column(&scene.components[3 * site + 2]))
        .collect::<Option<Vec<_>>>()?;
    let (svg, what) = if scene.sizes.len() == 1 {
        let ends = ((0.0, times[times.len() - 1]), "time t");
        let sites = ((1.0, (spins.len() + 1) as f64), "spin");
        (picture("spins", ends, sites, times.len(), &spins.concat()), "in time")
    } else {
        (
            strip(
                "spins",
                columns,
                &places.map(|k| (at(times[k]), spins.iter().map(|spin| spin[k]).collect())),
            ),
            "at several times",
        )
    };
    Some(Figure::new(
        "lattice",
        svg,
        format!("z components of the spins of path 0 {what}: blue is up, red is down."),
    ))
}

/// The vorticity of path 0 at several times, in two projections; none of other systems.
fn sphere(scene: &Scene, results: &Results) -> Option<Vec<Figure>> {
    let (table, places) = pictured(results)?;
    let columns = scene.components.iter().map(|name| table.column(name));
    let columns = columns.collect::<Option<Vec<_>>>()?;
    let drawn = |name, words, projection: Projection| {
        let grid = Grid { sines: projection.sines(LATITUDES), longitudes: 2 * LATITUDES };
        let maps_of = places.iter().map(|&k| {
            let state: Vec<f64> = columns.iter().map(|column| column[k]).collect();
            Some((at(table.times()[k]), scene.model.vorticity(&state, &grid)?))
        });
        let all = maps_of.collect::<Option<Vec<_>>>()?;
        let svg = maps("vorticity", projection, grid.longitudes, &all);
        let caption = format!(
            "Vorticity of path 0 at several times, {words}: blue turns eastward, red westward."
        );
        Some(Figure::new(name, svg, caption))
    };
    Some(vec![
        drawn("mollweide", "areas as they are (Mollweide)", Projection::Mollweide)?,
        drawn("vorticity", "latitude and longitude", Projection::Equirectangular)?,
    ])
}

/// Casimirs and energies with their conformal law and the defect from it.
fn laws(results: &Results) -> Vec<Figure> {
    let tables = &results.tables;
    let largest = |name: &str| {
        tables
            .iter()
            .filter_map(|table| table.column(name))
            .flatten()
            .fold(0.0f64, |largest, defect| largest.max(defect.abs()))
    };
    let mut defects = Vec::new();
    for (k, column) in tables.iter().take(1).flat_map(|table| table.columns.iter().enumerate()) {
        if let Role::Defect { of, .. } = &column.role {
            defects.push((k, of, largest(&column.name)));
        }
    }
    // Those that deviate most, of many.
    if defects.len() > SHOWN_LAWS {
        defects.sort_by(|a, b| b.2.total_cmp(&a.2));
        defects.truncate(SHOWN_LAWS);
    }
    let figure = |(k, name, largest): (usize, &String, f64)| {
        let series = tables.iter().enumerate().take(SHOWN_PATHS).filter_map(|(path, table)| {
            let Role::Defect { law, .. } = &table.columns.get(k)?.role else { return None };
            let points = zip(table.times(), zip(table.column(name)?, law))
                .map(|(&t, (&value, &exact))| Point::Value { t, value, exact });
            Some(plot::Series {
                scheme: format!("path {path}"),
                quantity: name.clone(),
                points: points.collect(),
                ..plot::Series::default()
            })
        });
        let svg = evolution(name, &series.collect::<Vec<_>>());
        let caption = format!(
            "{name} on {}: values with the conformal law e^(−p∫γ) {name}(y(0)) above, relative \
             defects below; the largest is {largest:.1e}.",
            paths(results)
        );
        Figure::of("law", name, svg, caption)
    };
    defects.into_iter().map(figure).collect()
}
