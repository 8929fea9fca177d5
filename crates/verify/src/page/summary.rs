//! The run in one paragraph: what holds, by name what does not, and what it took.

use plot::escape;

use super::Outcome;
use super::{group::Group, number::duration, prose::prose};
use crate::results::Results;

/// The paragraphs at the head of the page.
pub fn summary(results: &Results) -> String {
    let (proven, reported) = Group::proven_and_reported(&results.claims);
    let provenance = &results.provenance;
    format!(
        r#"<p class="summary">{}{}A statement is undecided, never passed, where an interval is too
wide. The run covers {} panels in <em>{}</em> mode with seed {} and took {}.</p>
{}"#,
        verdicts("proven statements", &proven),
        verdicts("statements without a proof", &reported),
        results.panels.len(),
        escape(&provenance.mode),
        provenance.seed,
        duration(provenance.wall_s),
        misprints(proven.iter().chain(&reported)),
    )
}

/// How many groups hold, and the others by name.
fn verdicts(what: &str, groups: &[Group]) -> String {
    if groups.is_empty() {
        return String::new();
    }
    let of = |outcome| groups.iter().filter(move |group| group.verdict() == outcome);
    let hold = of(Outcome::Holds).count();
    let checks: usize = groups.iter().map(|group| group.claims.len()).sum();
    let mut text =
        format!("<strong>{hold} of {}</strong> {what} hold, in {checks} checks", groups.len());
    for outcome in Outcome::BLEMISHES {
        let names: Vec<String> = of(outcome).map(|group| group.link() + &group.scheme()).collect();
        if !names.is_empty() {
            let word = outcome.word();
            text += &format!("; <span class=\"{word}\">{word}: {}</span>", names.join(", "));
        }
    }
    text + ". "
}

/// What the documented misprints say, each in a paragraph of its own.
fn misprints<'a>(groups: impl Iterator<Item = &'a Group<'a>>) -> String {
    let misprints = groups.flat_map(|group| {
        let claims = group.claims.iter().filter(|c| Outcome::of(c) == Outcome::Misprint);
        claims.map(move |claim| {
            format!(
                r#"<p class="summary erratum"><b>Misprint in the paper</b> ({}{}): {}
The statement as printed is refuted: {}.</p>
"#,
                group.link(),
                group.scheme(),
                prose(&claim.erratum),
                prose(&claim.statement),
            )
        })
    });
    misprints.collect()
}

#[cfg(test)]
mod tests {
    use crate::results::{Claim, Provenance, SCHEMA, Verdict};

    use super::super::tests::claim;
    use super::*;

    fn summary_of(claims: Vec<Claim>) -> String {
        summary(&Results {
            schema: SCHEMA,
            provenance: Provenance::default(),
            panels: Vec::new(),
            supplements: Vec::new(),
            claims,
        })
    }

    #[test]
    fn what_does_not_hold_is_named() {
        let text = summary_of(vec![
            claim("a", "", true, Verdict::Holds, ""),
            claim("b", "", true, Verdict::Undecided, ""),
            claim("c", "", true, Verdict::Refuted, ""),
            claim("d", "", true, Verdict::Refuted, "p ≤ 2"),
            claim("d", "", true, Verdict::Holds, ""),
        ]);
        for words in [
            "<strong>2 of 4</strong> proven statements hold, in 5 checks;",
            "; <span class=\"refuted\">refuted: <a href=\"#statement-c\">",
            "<span class=\"undecided\">undecided: <a href=\"#statement-b\">",
            "(<a href=\"#statement-d\"><code>d</code></a>): p\u{a0}≤\u{a0}2",
        ] {
            assert!(text.contains(words), "{words} is not in {text}");
        }
    }

    #[test]
    fn a_clean_run_says_so() {
        let text = summary_of(vec![
            claim("a", "", true, Verdict::Holds, ""),
            claim("b", "", true, Verdict::Holds, ""),
            claim("a", "em", false, Verdict::Holds, ""),
        ]);
        assert!(text.contains("<strong>2 of 2</strong>"));
        assert!(text.contains("<strong>1 of 1</strong> statements without"));
        assert!(!["undecided:", "refuted:", "isprint"].iter().any(|word| text.contains(word)));
    }
}
