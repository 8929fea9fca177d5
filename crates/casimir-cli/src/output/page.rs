//! The report of a run.

use casimir::plot::Document;

use super::{AT_END, digits, figures::Section, rows_at_end};
use crate::{commands::Results, scene::Scene};

/// The page with all figures.
pub fn page(scene: &Scene, results: &Results, figures: &[Section]) -> String {
    let Results { scheme, because, known, tables, study, check, seconds } = results;
    let paths = results.paths();
    let settings = &scene.settings;
    let law = settings.random.as_ref().map(|random| random.law.clone());
    let initial = law.unwrap_or_else(|| numbers(&settings.initial));
    let mut page = Document::new("casimir run", &scene.title);
    let first = tables.first();
    page.section("What was computed");
    let reason = because.as_ref().map_or(String::new(), |because| format!(": {because}"));
    let tau = settings.until / settings.steps as f64;
    let steps =
        format!("0 to {} in {} steps of {}", settings.until, settings.steps, digits(Some(tau)));
    page.facts([
        ("system", first.map_or(String::new(), |table| table.system.clone())),
        ("damping", first.map_or(String::new(), |table| table.damping.clone())),
        ("initial value", initial),
        ("time", steps),
        ("scheme", format!("{scheme}{reason}")),
        ("paths", format!("{paths}, seed {}", settings.key.seed)),
        ("computing", format!("{seconds:.2} s of wall time")),
        ("program", format!("casimir {}", env!("CARGO_PKG_VERSION"))),
    ]);
    let warnings = results.warnings(scene);
    known.mistake.iter().chain(&warnings).for_each(|warning| page.warning(warning));
    for (title, figures) in figures {
        page.section(title);
        if let (Some(study), "At the end") = (study, *title) {
            page.table(AT_END, rows_at_end(&study.series, Some(study).zip(check.as_ref())));
            page.note(
                "The interval is that of sampling. The step error of the mean, and in brackets that \
                 of the deviation, follows from a few paths with half the step; ? where these are \
                 too few to tell.",
            );
        }
        page.figures(figures.iter().map(|drawn| (drawn.svg.clone(), drawn.caption.clone())));
    }
    let known = known.text(&scene.components);
    if !known.is_empty() {
        page.section("What the system is");
        page.verbatim("see casimir inspect for more", &known);
    }
    page.section("The scene");
    page.verbatim(&scene.source.name, &scene.source.text);
    page.html()
}

/// `(0.2, 0.4)`, shortened where there are many.
fn numbers(values: &[f64]) -> String {
    const SHOWN: usize = 12;
    let mut words: Vec<String> =
        values.iter().take(SHOWN).map(|value| digits(Some(*value))).collect();
    if values.len() > SHOWN {
        words.push(format!("… {} in all", values.len()));
    }
    format!("({})", words.join(", "))
}
