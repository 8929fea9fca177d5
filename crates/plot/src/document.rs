//! A page of sections with paragraphs, figures and tables, in one file.

use crate::escape;

/// Number of bytes from which a cell of a table is broken into lines.
const LONG: usize = 60;
const STYLE: &str = include_str!("style.css");

/// A page that opens without a network and without scripts.
///
/// ```
/// let mut page = plot::Document::new("casimir run top.toml", "Heavy top");
/// page.section("Paths");
/// page.paragraph("Four paths.");
/// page.table(["t", "G3"], [["1", "0.9"]]);
/// assert!(page.html().contains("<h2>Paths</h2>"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Document {
    kicker: String,
    title: String,
    navigation: String,
    body: String,
    sections: usize,
}

impl Document {
    /// Creates an empty page. `kicker` is a line above the title.
    pub fn new(kicker: &str, title: &str) -> Self {
        let (kicker, title) = (escape(kicker), escape(title));
        Self { kicker, title, ..Self::default() }
    }

    /// Begins a section.
    pub fn section(&mut self, title: &str) {
        self.body += self.end();
        self.sections += 1;
        let (n, title) = (self.sections, escape(title));
        self.navigation += &format!("<a href=\"#section-{n}\">{title}</a> ");
        self.body += &format!("<section id=\"section-{n}\"><h2>{title}</h2>\n");
    }

    /// Closing tag of the open section, if there is one.
    fn end(&self) -> &'static str {
        if self.sections > 0 { "</section>\n" } else { "" }
    }

    /// Adds a paragraph.
    pub fn paragraph(&mut self, words: &str) {
        self.body += &format!("<p class=\"lead\">{}</p>\n", escape(words));
    }

    /// Adds a paragraph that warns.
    pub fn warning(&mut self, words: &str) {
        self.body += &format!("<p class=\"lead erratum\">{}</p>\n", escape(words));
    }

    /// Adds a list of terms with their definitions.
    pub fn facts(&mut self, facts: impl IntoIterator<Item = (impl AsRef<str>, impl AsRef<str>)>) {
        self.body += "<dl class=\"facts\">";
        for (term, what) in facts {
            let [term, what] = [term.as_ref(), what.as_ref()].map(escape);
            if !what.is_empty() {
                self.body += &format!("<dt>{term}</dt><dd>{what}</dd>");
            }
        }
        self.body += "</dl>\n";
    }

    /// Adds figures side by side where the window is wide, each an SVG document with the words
    /// below it.
    pub fn figures(&mut self, figures: impl IntoIterator<Item = (String, String)>) {
        self.body += "<div class=\"grid\">";
        for (svg, caption) in figures {
            self.body += &format!(
                "<figure class=\"card\"><div class=\"paper\">{svg}</div>\
                 <figcaption>{}</figcaption></figure>",
                escape(&caption)
            );
        }
        self.body += "</div>\n";
    }

    /// Adds a table with a header; adds nothing without rows.
    pub fn table<H: AsRef<str>, R: IntoIterator<Item = C>, C: AsRef<str>>(
        &mut self,
        header: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = R>,
    ) {
        self.linked(header, rows.into_iter().map(|row| (None, row)));
    }

    /// Adds a table whose rows begin with a link to the section of this number, counted from one.
    pub fn linked<H: AsRef<str>, R: IntoIterator<Item = C>, C: AsRef<str>>(
        &mut self,
        header: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = (Option<usize>, R)>,
    ) {
        let mut rows = rows.into_iter().peekable();
        if rows.peek().is_none() {
            return;
        }
        self.body += "<div class=\"card\"><div class=\"wide\"><table class=\"numbers\"><thead><tr>";
        for cell in header {
            self.body += &format!("<th>{}</th>", escape(cell.as_ref()));
        }
        self.body += "</tr></thead><tbody>";
        for (mut section, row) in rows {
            self.body += "<tr>";
            for cell in row {
                let cell = escape(cell.as_ref());
                let class = if cell.len() > LONG { " class=\"long\"" } else { "" };
                self.body += &match section.take() {
                    Some(n) => format!("<td{class}><a href=\"#section-{n}\">{cell}</a></td>"),
                    None => format!("<td{class}>{cell}</td>"),
                };
            }
            self.body += "</tr>\n";
        }
        self.body += "</tbody></table></div></div>\n";
    }

    /// Adds lines as they are, hidden until asked for by their title.
    pub fn verbatim(&mut self, title: &str, lines: &str) {
        let (title, lines) = (escape(title), escape(lines));
        self.body += &format!(
            "<details class=\"card\"><summary>{title}</summary><div class=\"wide\">\
             <pre>{lines}</pre></div></details>\n"
        );
    }

    /// Adds a line in small print.
    pub fn note(&mut self, words: &str) {
        self.body += &format!("<p><span class=\"quiet\">{}</span></p>\n", escape(words));
    }

    /// Page as an HTML document.
    pub fn html(self) -> String {
        let end = self.end();
        let Self { kicker, title, navigation, body, .. } = self;
        format!(
            r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{title}</title>
<style>
{STYLE}</style>
</head>
<body>
<header class="top"><p class="kicker">{kicker}</p>
<h1>{title}</h1>
<nav>{navigation}</nav></header>
<main>
{body}{end}</main>
</body>
</html>
"#
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_escaped_and_sections_closed() {
        let mut page = Document::new("a<b", "c & d");
        for title in ["One", "Two"] {
            page.section(title);
            page.warning("x < y");
            page.verbatim("e", "1 < 2");
            page.facts([("h < i", "j < k")]);
            page.figures([("<svg></svg>".into(), "f & g".into())]);
        }
        let html = page.html();
        assert_eq!(html.matches("<section").count(), html.matches("</section>").count());
        for words in
            ["a&lt;b", "c &amp; d", "x &lt; y", "1 &lt; 2", "f &amp; g", "h &lt; i", "#section-2"]
        {
            assert!(html.contains(words), "{words}");
        }
        assert!(!html.contains("<script") && !html.contains("src="));
    }
}
