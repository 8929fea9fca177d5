//! The run in one paragraph: what holds, by name what does not, and what it took.

use verify::results::Results;

use super::group::Group;
use super::number::duration;
use super::outcome::Outcome;
use super::prose::prose;
use crate::report::escape::escape;

/// The paragraphs at the head of the page.
pub fn summary(results: &Results) -> String {
    let (proven, reported): (Vec<Group>, Vec<Group>) =
        Group::all(&results.claims).into_iter().partition(|group| group.first().proven);
    let misprinted =
        proven.iter().any(|g| g.verdict() == Outcome::Holds && g.tally(Outcome::Misprint) > 0);
    let mut sentences = Vec::new();
    if !proven.is_empty() {
        sentences.push(format!(
            "{} that the paper proves {} put to {}: {}{}.",
            counted(proven.len(), "statement", "statements"),
            if proven.len() == 1 { "was" } else { "were" },
            counted(checks(&proven), "check", "checks"),
            strong(&proven),
            if misprinted { ", apart from what is misprinted" } else { "" },
        ));
        sentences.extend(named("refuted", "Refuted", &proven, Outcome::Refuted));
        sentences.extend(named("undecided", "Undecided", &proven, Outcome::Undecided));
    }
    if !reported.is_empty() {
        sentences.push(format!(
            "{} without a proof {} put to {}: {}.",
            counted(reported.len(), "observation", "observations"),
            if reported.len() == 1 { "was" } else { "were" },
            counted(checks(&reported), "check", "checks"),
            strong(&reported)
        ));
        sentences.extend(named("refuted", "Refuted", &reported, Outcome::Refuted));
        sentences.extend(named("undecided", "Undecided", &reported, Outcome::Undecided));
    }
    if [&proven, &reported].into_iter().flatten().any(|group| group.tally(Outcome::Undecided) > 0) {
        sentences.push(
            "An interval too wide to decide counts as undecided, never as a pass.".to_owned(),
        );
    }
    let provenance = &results.provenance;
    sentences.push(format!(
        "The run covers {} in <em>{}</em> mode with seed {} and took {}.",
        counted(results.panels.len(), "panel", "panels"),
        escape(&provenance.mode),
        provenance.seed,
        duration(provenance.wall_s),
    ));
    format!("<p class=\"summary\">{}</p>\n{}", sentences.join(" "), misprints(results))
}

fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

fn checks(groups: &[Group]) -> usize {
    groups.iter().map(|group| group.claims.len()).sum()
}

/// How many groups have which verdict.
fn strong(groups: &[Group]) -> String {
    let tally = |outcome| groups.iter().filter(|group| group.verdict() == outcome).count();
    let parts: Vec<String> =
        [Outcome::Holds, Outcome::Refuted, Outcome::Undecided, Outcome::Misprint]
            .into_iter()
            .map(|outcome| (outcome, tally(outcome)))
            .filter(|(outcome, n)| *n > 0 || *outcome == Outcome::Holds)
            .map(|(outcome, n)| match outcome {
                Outcome::Holds if n > 1 && n == groups.len() => {
                    format!("<strong>all {n} hold</strong>")
                }
                Outcome::Holds => format!("<strong>{}</strong>", counted(n, "holds", "hold")),
                Outcome::Misprint => {
                    format!("<strong>{}</strong>", counted(n, "is misprinted", "are misprinted"))
                }
                _ => format!("<strong>{} {}</strong>", counted(n, "is", "are"), outcome.words()),
            })
            .collect();
    match &parts[..] {
        [init @ .., last] if !init.is_empty() => format!("{} and {last}", init.join(", ")),
        _ => parts.concat(),
    }
}

/// The groups with a verdict by name, if there are any.
fn named(class: &str, title: &str, groups: &[Group], verdict: Outcome) -> Option<String> {
    let names: Vec<String> =
        groups.iter().filter(|group| group.verdict() == verdict).map(link).collect();
    (!names.is_empty())
        .then(|| format!("<span class=\"{class}\">{title}: {}.</span>", names.join(", ")))
}

fn link(group: &Group) -> String {
    let claim = group.first();
    let scheme = if claim.proven { String::new() } else { format!(" {}", escape(&claim.scheme)) };
    format!("<a href=\"#{}\"><code>{}{scheme}</code></a>", group.anchor(), escape(&claim.id))
}

/// What the documented misprints say, each in a paragraph of its own.
fn misprints(results: &Results) -> String {
    Group::all(&results.claims)
        .iter()
        .flat_map(|group| group.claims.iter().map(move |claim| (group, claim)))
        .filter(|(_, claim)| Outcome::of(claim) == Outcome::Misprint)
        .map(|(group, claim)| {
            format!(
                "<p class=\"summary erratum\"><b>Misprint in the paper</b> ({}): {} The statement as printed is \
                 refuted: {}.</p>\n",
                link(group),
                prose(&claim.erratum),
                prose(&claim.statement),
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use verify::results::{Claim, Provenance, SCHEMA, Verdict};

    use super::super::group::tests::claim;
    use super::*;

    fn summary_of(claims: Vec<Claim>) -> String {
        let (panels, supplements) = (Vec::new(), Vec::new());
        summary(&Results {
            schema: SCHEMA,
            provenance: Provenance::default(),
            panels,
            supplements,
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
            "4 statements that the paper proves were put to 5 checks: <strong>2 hold</strong>, \
             <strong>1 is refuted</strong> and <strong>1 is undecided</strong>, apart from what is misprinted.",
            "Refuted: <a href=\"#statement-c\">",
            "Undecided: <a href=\"#statement-b\">",
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
        assert!(text.contains("<strong>all 2 hold</strong>") && text.contains("1 observation"));
        assert!(
            !text.contains("ndecided") && !text.contains("efuted") && !text.contains("isprint")
        );
    }
}
