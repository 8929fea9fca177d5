//! Plain text with formulas as HTML: `2^-5`, `τ^((1+k)/2)`, `y_n`, `y2^2` and `1.8e-15` become what
//! they mean.

use std::sync::LazyLock;

use plot::escape;
use regex_lite::{Captures, Regex};

/// Patterns and their replacements, in the order in which they are applied.
static RULES: LazyLock<Vec<(Regex, &str)>> = LazyLock::new(|| {
    const LETTER: &str = "[A-Za-zÀ-ÿα-ωΑ-Ω]";
    const BEFORE: &str = "(^|[^A-Za-zÀ-ÿα-ωΑ-Ω0-9_])";
    // What is raised or lowered: a group in brackets, which it loses, or a signed word.
    const SCRIPT: &str =
        r"(?:\(((?:[^()]|\([^()]*\))*)\)|\{([^{}]*)\}|([-−+]?[A-Za-zα-ωΑ-Ω0-9½]+))";
    let rules = [
        // No line ends behind a relation, or between a letter and a relation or the step size.
        ("([=≤≥]) ".into(), "$1\u{a0}"),
        (format!("{BEFORE}({LETTER}) ([=≤≥τ])"), "$1$2\u{a0}$3"),
        (format!(r"([^\s])\^{SCRIPT}"), "$1<sup>$2$3$4</sup>"),
        // A name such as `relative_defect` has no index.
        (format!("{BEFORE}({LETTER})_{SCRIPT}"), "$1$2<sub>$3$4$5</sub>"),
        (r"\by([0-9])\b".into(), "y<sub>$1</sub>"),
        (r"(^|[ (\[>])-([0-9])".into(), "$1−$2"),
    ];
    rules.into_iter().map(|(pattern, with)| (regex(&pattern), with)).collect()
});

/// A number such as `1.8e-15`.
static POWER: LazyLock<Regex> = LazyLock::new(|| regex(r"\b([0-9]+(?:\.[0-9]+)?)e([-+]?[0-9]+)\b"));

fn regex(pattern: &str) -> Regex {
    Regex::new(pattern).expect("the patterns of this file are valid")
}

/// The text, escaped, with its scripts and powers of ten set as such.
pub fn prose(text: &str) -> String {
    let power = |found: &Captures| match &found[2] {
        "0" => found[1].into(),
        "-1" => found[0].parse().map_or(found[0].into(), |x: f64| x.to_string()),
        exponent => format!("{}·10^{{{}}}", &found[1], exponent.trim_start_matches('+')),
    };
    let text = POWER.replace_all(&escape(text), power).into_owned();
    RULES.iter().fold(text, |text, (rule, with)| rule.replace_all(&text, *with).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_typeset() {
        assert_eq!(prose("τ = 2^-5 … 2^-12"), "τ\u{a0}=\u{a0}2<sup>−5</sup> … 2<sup>−12</sup>");
        assert_eq!(prose("C τ^((1+k)/2) <"), "C\u{a0}τ<sup>(1+k)/2</sup> &lt;");
        assert_eq!(
            prose("(E‖y_n − y(t_n)‖²)^½"),
            "(E‖y<sub>n</sub> − y(t<sub>n</sub>)‖²)<sup>½</sup>"
        );
        assert_eq!(
            prose("φ = cos y3, y1^2"),
            "φ\u{a0}=\u{a0}cos y<sub>3</sub>, y<sub>1</sub><sup>2</sup>"
        );
        assert_eq!(prose("y₁^{ab} y₂^{−b}"), "y₁<sup>ab</sup> y₂<sup>−b</sup>");
        assert_eq!(prose("c τ_ref/τ"), "c\u{a0}τ<sub>ref</sub>/τ");
    }

    #[test]
    fn numbers_are_typeset() {
        assert_eq!(prose("defect: 1.8e-15"), "defect: 1.8·10<sup>−15</sup>");
        assert_eq!(prose("3.4e0, 5.6e-1, 5.4e16"), "3.4, 0.56, 5.4·10<sup>16</sup>");
        assert_eq!(prose("[-0.1, 0.3], 0.04"), "[−0.1, 0.3], 0.04");
    }

    #[test]
    fn everything_else_is_left_alone() {
        for text in [
            "relative_defect",
            "rigid-body-strong-3",
            "2eggs",
            "1e",
            "1.",
            "a ^ b",
            "of τ",
            "a b",
            "y10",
            "x^(",
            "by2",
            "^2",
            "e-5",
        ] {
            assert_eq!(prose(text), text);
        }
        assert_eq!(prose("<b>"), "&lt;b&gt;");
    }
}
