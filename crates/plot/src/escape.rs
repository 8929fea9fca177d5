//! Text made safe for HTML and SVG.

/// Replaces the characters that have a meaning in markup, so that the result stands for `text` in
/// element content and in quoted attributes.
pub fn escape(text: &str) -> String {
    let (mut escaped, mut same) = (String::new(), [0; 4]);
    for c in text.chars() {
        escaped += match c {
            '&' => "&amp;",
            '<' => "&lt;",
            '>' => "&gt;",
            '"' => "&quot;",
            '\'' => "&#39;",
            // XML 1.0 knows no other control characters, not even as references.
            _ if c.is_control() && !"\t\n\r".contains(c) => "\u{fffd}",
            _ => c.encode_utf8(&mut same),
        };
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_becomes_text() {
        assert_eq!(
            escape("<b a=\"1\" c='2'>x & y</b>"),
            "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;x &amp; y&lt;/b&gt;"
        );
        assert_eq!(escape("τ < 2⁻⁵\n"), "τ &lt; 2⁻⁵\n");
        assert_eq!(escape("a\u{0}b"), "a\u{fffd}b");
    }
}
