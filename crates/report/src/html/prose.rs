//! Plain text with formulas as HTML: `2^-5`, `τ^((1+k)/2)`, `y_n`, `y2^2` and `1.8e-15` become what
//! they mean.

use crate::escape::escape;

/// The text, escaped, with its scripts and powers of ten set as such.
pub fn prose(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut html = String::new();
    let mut at = 0;
    while at < chars.len() {
        let (piece, next) =
            formula(&chars, at).unwrap_or_else(|| (escape(&chars[at].to_string()), at + 1));
        html.push_str(&piece);
        at = next;
    }
    html
}

/// The formula that begins at a place, and where it ends.
fn formula(chars: &[char], at: usize) -> Option<(String, usize)> {
    let before = |n: usize| at.checked_sub(n).map(|place| chars[place]);
    let after = |n: usize| chars.get(at + n).copied();
    let tagged = |tag: &str, (inner, end): (&[char], usize)| {
        (format!("<{tag}>{}</{tag}>", prose(&inner.iter().collect::<String>())), end)
    };
    match chars[at] {
        ' ' if before(1).is_some_and(|c| binds(before(2), c, after(1))) => {
            Some(("\u{a0}".to_owned(), at + 1))
        }
        '^' if at > 0 => script(chars, at + 1).map(|inner| tagged("sup", inner)),
        // A name such as `relative_defect` has no index.
        '_' if before(1).is_some_and(char::is_alphabetic) && !before(2).is_some_and(is_word) => {
            script(chars, at + 1).map(|inner| tagged("sub", inner))
        }
        'y' if !before(1).is_some_and(is_word) && !after(2).is_some_and(is_word) => {
            let index = after(1).filter(char::is_ascii_digit)?;
            Some((format!("y<sub>{index}</sub>"), at + 2))
        }
        '-' if after(1).is_some_and(|c| c.is_ascii_digit())
            && before(1).is_none_or(|c| " ([".contains(c)) =>
        {
            Some(("−".to_owned(), at + 1))
        }
        c if c.is_ascii_digit() && !before(1).is_some_and(|c| is_word(c) || c == '.') => {
            power_of_ten(chars, at)
        }
        _ => None,
    }
}

/// Whether no line may end between `left` and `right`: behind a relation, and between a single
/// letter and a relation or the step size.
fn binds(before_left: Option<char>, left: char, right: Option<char>) -> bool {
    let relation = |c: char| "=≤≥".contains(c);
    let single = left.is_alphabetic() && !before_left.is_some_and(is_word);
    relation(left) || single && right.is_some_and(|c| relation(c) || c == 'τ')
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// What is raised or lowered: a group in brackets, which it loses, or a signed word.
fn script(chars: &[char], start: usize) -> Option<(&[char], usize)> {
    let close = match chars.get(start)? {
        '(' => ')',
        '{' => '}',
        _ => {
            let signs = usize::from("-−+".contains(chars[start]));
            let word = chars[start + signs..]
                .iter()
                .take_while(|c| c.is_alphabetic() || c.is_ascii_digit() || **c == '½');
            let end = start + signs + word.count();
            return (end > start + signs).then(|| (&chars[start..end], end));
        }
    };
    let mut depth = 0_usize;
    for (place, c) in chars.iter().enumerate().skip(start) {
        if *c == chars[start] {
            depth += 1;
        } else if *c == close {
            depth -= 1;
            if depth == 0 {
                return Some((&chars[start + 1..place], place + 1));
            }
        }
    }
    None
}

/// A number such as `1.8e-15`.
fn power_of_ten(chars: &[char], start: usize) -> Option<(String, usize)> {
    let digits =
        |from: usize| from + chars[from..].iter().take_while(|c| c.is_ascii_digit()).count();
    let mut mantissa = digits(start);
    if chars.get(mantissa) == Some(&'.') {
        mantissa = digits(mantissa + 1);
    }
    if chars.get(mantissa) != Some(&'e') {
        return None;
    }
    let sign = usize::from(matches!(chars.get(mantissa + 1), Some('-' | '+')));
    let end = digits((mantissa + 1 + sign).min(chars.len()));
    let exponent: i32 = chars[mantissa + 1..end].iter().collect::<String>().parse().ok()?;
    let number: String = chars[start..mantissa].iter().collect();
    let html = match exponent {
        0 => number,
        -1 => format!("{number}e-1").parse::<f64>().ok()?.to_string(),
        _ => format!("{number}·10<sup>{}</sup>", exponent.to_string().replace('-', "−")),
    };
    (!chars.get(end).copied().is_some_and(is_word)).then_some((html, end))
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
