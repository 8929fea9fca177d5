//! The page with what was computed.

use casimir::plot::Document;

use super::{Report, Run, Section, digits};
use crate::scene::Varied;

/// The section of figures that has the table at the end.
pub const TABLE: &str = "At the end";

impl Report<'_> {
    /// The page with these figures.
    pub fn page(&self, figures: &[Section]) -> String {
        let mut page = Document::new("casimir run", &self.scene.title);
        page.section("What was computed");
        page.facts(self.facts());
        self.warnings().iter().for_each(|warning| page.warning(warning));
        for (title, figures) in figures {
            page.section(title);
            if *title == TABLE {
                let mut table = self.table().into_iter();
                page.table(table.next().unwrap_or_default(), table);
                page.note(
                    "The interval is that of sampling. The step error of the mean, and in brackets \
                     that of the deviation, follows from a few paths with half the step; ? where \
                     these are too few to tell.",
                );
            }
            page.figures(figures.iter().map(|drawn| (drawn.svg.clone(), drawn.caption.clone())));
        }
        let known = self.single().map(|run| run.results.known.text(&self.scene.components));
        if let Some(known) = known.filter(|known| !known.is_empty()) {
            page.section("What the system is");
            page.verbatim("see casimir inspect for more", &known);
        }
        page.section("The scene");
        page.verbatim(&self.scene.source.name, &self.scene.source.text);
        page.html()
    }

    /// Terms and what they are.
    fn facts(&self) -> Vec<(String, String)> {
        let settings = &self.scene.settings;
        let seed = settings.key.seed;
        let program = ("program".into(), format!("casimir {}", env!("CARGO_PKG_VERSION")));
        let Some(Run { results, .. }) = self.single() else {
            let varied = self.sweep.varied.iter().map(|Varied { name, values }| {
                let values = values.iter().map(|value| digits(*value)).collect::<Vec<_>>();
                (name.clone(), values.join(", "))
            });
            let keys = self.sweep.combinations.iter().map(|one| one.scene.settings.key);
            let noise = if keys.is_sorted_by(|a, b| a == b) { "the same" } else { "others" };
            let noise = format!("seed {seed}, {noise} for each combination");
            let facts = [("runs".into(), self.computed()), ("random numbers".into(), noise)];
            return varied.chain(facts).chain([program]).collect();
        };
        let first = results.tables.first();
        let because = results.because.as_ref().map(|because| format!(": {because}"));
        let law = settings.random.as_ref().map(|random| random.law.clone());
        let (until, steps) = (settings.until, settings.steps);
        let tau = digits(until / steps as f64);
        let fact = |term: &str, what| (term.to_owned(), what);
        vec![
            fact("system", first.map_or(String::new(), |table| table.system.clone())),
            fact("damping", first.map_or(String::new(), |table| table.damping.clone())),
            fact("initial value", law.unwrap_or_else(|| numbers(&settings.initial))),
            fact("time", format!("0 to {until} in {steps} steps of {tau}")),
            fact("scheme", results.scheme.clone() + &because.unwrap_or_default()),
            fact("paths", format!("{}, seed {seed}", results.paths())),
            fact("computing", format!("{:.2} s of wall time", results.seconds)),
            program,
        ]
    }
}

/// `(0.2, 0.4)`, shortened where there are many.
fn numbers(values: &[f64]) -> String {
    const SHOWN: usize = 12;
    let mut words: Vec<String> =
        values.iter().take(SHOWN).map(|value| digits(*value)).collect();
    if values.len() > SHOWN {
        words.push(format!("… {} in all", values.len()));
    }
    format!("({})", words.join(", "))
}
