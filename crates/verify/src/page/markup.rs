//! The elements that all sections use.

use std::{fmt::Display, iter};

use plot::escape;

use super::Outcome;
use crate::results::Claim;

/// An identifier.
pub fn code(id: &str) -> String {
    format!("<code>{}</code>", escape(id))
}

/// A term and what it is; nothing where it is nothing.
pub fn entry(term: &str, what: &str) -> String {
    if what.is_empty() { String::new() } else { format!("<dt>{term}</dt><dd>{what}</dd>") }
}

/// A table of numbers, which scrolls where it is too wide; nothing without rows.
///
/// The first cell of a row is its heading.
pub fn table(
    heads: impl IntoIterator<Item: Display>,
    rows: impl Iterator<Item = Vec<String>>,
) -> String {
    let heads: String = heads.into_iter().map(|head| format!("<th>{head}</th>")).collect();
    let row = |cells: Vec<String>| {
        let tags = iter::once("th").chain(iter::repeat("td"));
        let cells = tags.zip(cells).map(|(tag, text)| format!("<{tag}>{text}</{tag}>"));
        format!("<tr>{}</tr>", cells.collect::<String>())
    };
    let rows: String = rows.map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        r#"<div class="wide"><table class="numbers">
<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></div>"#
    )
}

/// A list; nothing without items.
pub fn list(class: &str, items: impl Iterator<Item = String>) -> String {
    let items: String = items.map(|item| format!("<li>{item}</li>\n")).collect();
    if items.is_empty() { items } else { format!("<ul class=\"{class}\">{items}</ul>") }
}

/// What opens on demand; nothing where there is nothing to see.
pub fn details(open: bool, title: &str, what: &str) -> String {
    if what.is_empty() {
        return String::new();
    }
    let open = if open { " open" } else { "" };
    format!("<details{open}><summary>{title}</summary>\n{what}</details>")
}

/// A coloured badge that also says an outcome in words.
pub fn badge(outcome: Outcome, words: &str) -> String {
    let class = outcome.word();
    let sign = match outcome {
        Outcome::Holds => '✓',
        Outcome::Misprint => '✎',
        Outcome::Undecided => '?',
        Outcome::Refuted => '✗',
    };
    format!("<span class=\"badge {class}\"><span aria-hidden=\"true\">{sign}</span> {words}</span>")
}

/// Less important words.
pub fn quiet(words: &str) -> String {
    format!("<span class=\"quiet\">{words}</span>")
}

/// The scheme that a claim is about, behind a point.
pub fn scheme(claim: &Claim) -> String {
    if claim.scheme.is_empty() { String::new() } else { format!(" · {}", code(&claim.scheme)) }
}
