//! The page with what was computed.

use casimir::plot::Document;

use super::*;
use scenes::MAX_COMPONENTS;

/// The section of figures that has the table at the end.
pub const TABLE: &str = "At the end";

impl Outcomes<'_> {
    /// The page with these figures.
    pub fn page(&self, figures: &[Section]) -> String {
        let mut page = Document::new("casimir run", &self.sweep.scene().title);
        page.section("What was computed");
        page.facts(self.facts());
        self.warnings().iter().for_each(|warning| page.warning(&warning.to_string()));
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
        let known = |(one, _): Run<'_>| one.scene.model.known().text(&one.scene.components);
        if let Some(known) = self.single().map(known).filter(|known| !known.is_empty()) {
            page.section("What the system is");
            page.verbatim("see casimir inspect for more", &known);
        }
        page.section("The scene");
        let source = &self.sweep.scene().source;
        page.verbatim(&source.name, &source.text);
        page.html()
    }

    /// Terms with their descriptions.
    fn facts(&self) -> Vec<(String, String)> {
        let settings = &self.sweep.scene().settings;
        let seed = settings.key.seed;
        let fact = |term: &str, what: String| (term.to_owned(), what);
        let program = fact("program", format!("casimir {}", env!("CARGO_PKG_VERSION")));
        let Some((_, results)) = self.single() else {
            let mut keys = self.sweep.combinations.iter().map(|one| one.scene.settings.key);
            let noise = if keys.all(|key| key == settings.key) { "the same" } else { "others" };
            let varied = self.sweep.varied.iter();
            let facts = [
                fact("runs", self.computed()),
                fact("random numbers", format!("seed {seed}, {noise} for each combination")),
                program,
            ];
            return varied.map(|one| (one.name.clone(), list(&one.values))).chain(facts).collect();
        };
        let (system, damping) = results
            .tables
            .first()
            .map_or_else(Default::default, |table| (table.system.clone(), table.damping.clone()));
        let law = settings.random.as_ref().map(|random| random.law.clone());
        let (until, steps) = (settings.until, settings.steps);
        let tau = digits(until / steps as f64);
        vec![
            fact("system", system),
            fact("damping", damping),
            fact("initial value", law.unwrap_or_else(|| numbers(&settings.initial))),
            fact("time", format!("0 to {until} in {steps} steps of {tau}")),
            fact(
                "scheme",
                results.scheme.clone()
                    + &results.because.as_ref().map_or(String::new(), |why| format!(": {why}")),
            ),
            fact("paths", format!("{}, seed {seed}", results.paths())),
            fact("computing", format!("{:.2} s of wall time", results.seconds)),
            program,
        ]
    }
}

/// Formats a list, such as `0.2, 0.4`.
fn list(values: &[f64]) -> String {
    values.iter().map(|value| digits(*value)).collect::<Vec<_>>().join(", ")
}

/// Formats a point, such as `(0.2, 0.4)`, shortened where there are many numbers.
fn numbers(values: &[f64]) -> String {
    match values.get(..MAX_COMPONENTS) {
        Some(first) if values.len() > first.len() => {
            format!("({}, … {} in all)", list(first), values.len())
        }
        _ => format!("({})", list(values)),
    }
}
