//! The figures of a run.

use std::collections::BTreeMap;

use casimir::{
    figures::{histogram, law},
    mc::{Role, TimeSeries, parts::hash},
    plot::{
        self,
        figure::{Projection, Trace, bands, evolution, lines, maps, picture, strip},
    },
    stats::Point,
    study::{Joint, Kind, Series, StudyResult},
};

use super::{Array, page::TABLE};
use crate::Results;
use scenes::{self, MAX_COMPONENTS, Scene, digits, model::Grid};

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
        let plain = |c: char| if c.is_alphanumeric() { c } else { '-' };
        let file = name.chars().take(LONGEST).map(plain).collect();
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
            let in_time = names.into_iter().map(|name| {
                let svg = lines(name, "time t", drawn.title(name), &traces(results, "t", name));
                Figure::of("time", name, svg, format!("{name} in time on {}.", paths(results)))
            });
            vec![("In time", in_time.collect())]
        }
    };
    sections.push(("Phase portraits", portraits(scene, results)));
    sections.push(("The lattice", lattice(scene, results).into_iter().collect()));
    sections.push(("Correlations and structure factors", spectra(results)));
    sections.push(("The sphere", sphere(scene, results)));
    sections.push(("Conserved but for the damping", laws(results)));
    sections.retain(|(title, figures)| !figures.is_empty() || *title == TABLE);
    sections
}

/// The figures of the statistics of observables.
fn of_study(
    drawn: &scenes::FigureSettings,
    names: &[&String],
    study: &StudyResult,
) -> Vec<Section> {
    let levels = study.record.quantiles.iter().map(|level| digits(100.0 * level));
    let levels = levels.collect::<Vec<_>>().join(" %, ");
    let (paths, mut in_time, mut at_end) = (study.record.paths, Vec::new(), Vec::new());
    for series in names.iter().filter_map(|name| study.series(name)) {
        let (Series { observable: name, points, .. }, last) = (series, series.last());
        let band = if points.iter().all(|point| point.quantiles.is_empty()) {
            "Band: 95 % intervals; dashes: estimate.".into()
        } else {
            format!("Bands between the quantiles {levels} %; line: median; dashes: mean.")
        };
        let svg = bands(name, "time t", drawn.title(name), &law(points));
        let caption = format!("{name} in time, {paths} paths. {band}");
        in_time.push(Figure::of("time", name, svg, caption));
        if last.histogram.is_some() {
            let caption = format!(
                "The law of {name} at t = {}, {} paths: density; line: median; dashes: mean.",
                last.time, last.count
            );
            at_end.push(Figure::of("end", name, histogram(name, name, last), caption));
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
    let trace = |(path, table): (usize, &TimeSeries)| {
        let [x, y] = [x, y].map(|name| table.column(name).unwrap_or_default().iter().copied());
        Trace { name: format!("path {path}"), points: x.zip(y).collect() }
    };
    results.tables.iter().enumerate().take(SHOWN_PATHS).map(trace).collect()
}

fn portraits(scene: &Scene, results: &Results) -> Vec<Figure> {
    let names = &scene.components;
    let pairs: &[(usize, usize)] = match names.len() {
        3 => &[(0, 1), (1, 2), (0, 2)],
        dimension if dimension > MAX_COMPONENTS => &[],
        dimension => &(1..dimension).step_by(2).map(|i| (i - 1, i)).collect::<Vec<_>>(),
    };
    let few = pairs.iter().take(PORTRAITS).map(|&(i, j)| [names[i].clone(), names[j].clone()]);
    let pairs = scene.drawn.portraits.clone().unwrap_or_else(|| few.collect());
    let portrait = |[x, y]: &[String; 2]| {
        let svg = lines(&format!("{y} against {x}"), x, &**y, &traces(results, x, y));
        let on = paths(results);
        let caption = format!("{y} against {x} on {on}; the marker is the initial value.");
        Figure::of("portrait", &format!("{x}\0{y}"), svg, caption)
    };
    pairs.iter().map(portrait).collect()
}

/// Correlations and structure factors of the first path along each axis, at the last time and some
/// before.
fn spectra(results: &Results) -> Vec<Figure> {
    let [(_, _, times), arrays @ ..] = &results.spectra[..] else { return Vec::new() };
    let between = times.len().saturating_sub(1).div_ceil(SHOWN_TIMES - 1).max(1);
    let of_axis = ["distance in cells", "wave number, in reciprocal vectors over the length"];
    let figure = |((name, shape, values), x): (&Array, &str)| {
        let trace = |(time, row): (&f64, &[f64])| {
            let points = row.iter().enumerate().map(|(k, value)| (k as f64, *value));
            Trace { name: format!("t = {}", digits(*time)), points: points.collect() }
        };
        let rows = times.iter().zip(values.chunks(shape[2]));
        // The last one, and those a distance before it.
        let rows = rows
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
            .step_by(between)
            .map(trace)
            .collect::<Vec<_>>();
        let traces: Vec<Trace> = rows.into_iter().rev().collect();
        let axis = format!("{name} along its axis, path 0, at {} times.", traces.len());
        Figure::of("spectrum", name, lines(name, x, &**name, &traces), axis)
    };
    arrays.iter().zip(of_axis.into_iter().cycle()).map(figure).collect()
}

/// Joint laws, autocorrelations and spectra.
fn dependence(drawn: &scenes::FigureSettings, study: &StudyResult) -> Vec<Figure> {
    let joint = study.joint.iter().map(|Joint { names: [a, b], grids, counts, outside }| {
        let [x, y] = grids.map(|grid| (grid.edge(0), grid.edge(grid.bins)));
        let [columns, rows] = grids.map(|grid| grid.bins as usize);
        // Roots, so that the tails are seen.
        let root = |k: usize| (counts[(k % columns) * rows + k / columns] as f64).sqrt();
        let values: Vec<f64> = (0..columns * rows).map(root).collect();
        let svg = picture(&format!("{b} and {a}"), (x, a), (y, b), columns, &values);
        let caption = format!(
            "The joint law of {a} and {b} at the end: roots of counts, {outside} of {} paths \
             outside.",
            study.record.paths
        );
        Figure::of("joint", &format!("{a}\0{b}"), svg, caption)
    });
    let lagged = study.lagged.iter().map(|Series { observable: name, kind, points }| {
        let (axis, more) = match kind {
            Kind::Spectrum => {
                ("angular frequency", " Its integral over all frequencies is the variance.")
            }
            _ => ("lag", ""),
        };
        let caption = format!("{name} against the {axis}. Band: 95 % intervals.{more}");
        Figure::of("lag", name, bands(name, axis, drawn.title(name), &law(points)), caption)
    });
    joint.chain(lagged).collect()
}

/// The third components of the spins of path 0: a plane at several times, or a chain in time.
fn lattice(scene: &Scene, results: &Results) -> Option<Figure> {
    let (table, &columns) = (results.tables.first()?, scene.sizes.first()?);
    let times = table.times();
    let last = times.len().checked_sub(1)?; // None if path 0 was not begun
    let plane = scene.sizes.iter().take(2).product::<usize>();
    let spins = (0..plane)
        .map(|site| table.column(&scene.components[3 * site + 2]))
        .collect::<Option<Vec<_>>>()?;
    let (svg, what) = if scene.sizes.len() == 1 {
        let ends = (0.0, times[last]);
        let values = spins.concat();
        let spins = (1.0, (spins.len() + 1) as f64);
        (picture("spins", (ends, "time t"), (spins, "spin"), times.len(), &values), "in time")
    } else {
        let at = |k: usize| k * last / (PICTURES - 1);
        let picture = |k: usize| {
            let values = spins.iter().map(|spin| spin[at(k)]).collect();
            (format!("t = {}", digits(times[at(k)])), values)
        };
        let pictures: Vec<(String, Vec<f64>)> = (0..PICTURES).map(picture).collect();
        (strip("spins", columns, &pictures), "at several times")
    };
    let caption = format!("z components of the spins of path 0 {what}: blue is up, red is down.");
    Some(Figure::new("lattice", svg, caption))
}

/// The vorticity of path 0 at several times, in two projections; none of other systems.
fn sphere(scene: &Scene, results: &Results) -> Vec<Figure> {
    let Some(table) = results.tables.first() else { return Vec::new() };
    let times = table.times();
    let Some(last) = times.len().checked_sub(1) else { return Vec::new() };
    let columns = scene.components.iter().map(|name| table.column(name));
    let Some(columns) = columns.collect::<Option<Vec<_>>>() else { return Vec::new() };
    let drawn = |(name, words, projection): (&str, &str, Projection)| {
        let grid = Grid { sines: projection.sines(LATITUDES), longitudes: 2 * LATITUDES };
        let map = |k: usize| {
            let at = k * last / (PICTURES - 1);
            let state: Vec<f64> = columns.iter().map(|column| column[at]).collect();
            Some((format!("t = {}", digits(times[at])), scene.model.vorticity(&state, &grid)?))
        };
        let all = (0..PICTURES).map(map).collect::<Option<Vec<_>>>()?;
        let caption = format!(
            "Vorticity of path 0 at several times, {words}: blue turns eastward, red westward."
        );
        let svg = maps("vorticity", projection, grid.longitudes, &all);
        Some(Figure::new(name, svg, caption))
    };
    let projections = [
        ("mollweide", "areas as they are (Mollweide)", Projection::Mollweide),
        ("vorticity", "latitude and longitude", Projection::Equirectangular),
    ];
    projections.into_iter().filter_map(drawn).collect()
}

/// Casimirs and energies with their conformal law and the defect from it.
fn laws(results: &Results) -> Vec<Figure> {
    let Some(first) = results.tables.first() else { return Vec::new() };
    let largest = |name: &str| {
        let columns = results.tables.iter().filter_map(|table| table.column(name));
        columns.flatten().fold(0.0f64, |largest, defect| largest.max(defect.abs()))
    };
    let columns = first.columns.iter().enumerate();
    let mut defects: Vec<(usize, &str, f64)> = columns
        .filter_map(|(k, column)| match &column.role {
            Role::Defect { of, .. } => Some((k, &**of, largest(&column.name))),
            _ => None,
        })
        .collect();
    // Those that deviate most, of many.
    if defects.len() > SHOWN_LAWS {
        defects.sort_by(|a, b| b.2.total_cmp(&a.2));
        defects.truncate(SHOWN_LAWS);
    }
    let drawn = |(k, name, largest): (usize, &str, f64)| {
        let series = |(path, table): (usize, &TimeSeries)| {
            let Role::Defect { law, .. } = &table.columns.get(k)?.role else { return None };
            let both = table.column(name)?.iter().zip(law);
            let points = table.times().iter().zip(both);
            let point = |(&t, (&value, &exact))| Point::Value { t, value, exact };
            Some(plot::Series {
                scheme: format!("path {path}"),
                quantity: name.into(),
                points: points.map(point).collect(),
                ..plot::Series::default()
            })
        };
        let tables = results.tables.iter().enumerate().take(SHOWN_PATHS);
        let series: Vec<plot::Series> = tables.filter_map(series).collect();
        let caption = format!(
            "{name} on {}: values with the conformal law e^(−p∫γ) {name}(y(0)) above, relative \
             defects below; the largest is {largest:.1e}.",
            paths(results)
        );
        Figure::of("law", name, evolution(name, &series), caption)
    };
    defects.into_iter().map(drawn).collect()
}
