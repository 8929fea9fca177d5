//! Pages in Markdown: paragraphs wrapped at 100 columns, tables, figures.

use std::{collections::HashSet, io::Result, path::Path};

use crate::files;

/// The most characters in a line of a paragraph.
const COLUMNS: usize = 100;

/// A page that is written from top to bottom, with its figures.
///
/// ```
/// use report::Page;
///
/// let mut page = Page::new("Errors");
/// page.paragraph("All errors are at the final time.");
/// page.table(["scheme", "error"], [["`em`", "0.01"]]);
/// assert_eq!(
///     page.text(),
///     "# Errors\n\nAll errors are at the final time.\n\n\
///      | scheme | error |\n|---|---|\n| `em` | 0.01 |\n"
/// );
/// ```
#[derive(Clone, Debug)]
pub struct Page {
    text: String,
    figures: Vec<(String, String)>,
}

impl Page {
    /// A page with a title.
    pub fn new(title: &str) -> Self {
        Self { text: format!("# {title}\n"), figures: Vec::new() }
    }

    /// A heading; level 2 is that of a section.
    pub fn heading(&mut self, level: usize, words: &str) {
        self.block(&format!("{} {words}", "#".repeat(level)));
    }

    /// A paragraph, or several that are separated by empty lines; line breaks in it do not matter.
    pub fn paragraph(&mut self, words: impl AsRef<str>) {
        for paragraph in words.as_ref().split("\n\n").filter(|text| !text.trim().is_empty()) {
            self.block(&wrapped(paragraph, ""));
        }
    }

    /// A list with a bullet for each item; nothing without items.
    pub fn list(&mut self, items: impl IntoIterator<Item = String>) {
        let item = |item: String| format!("- {}\n", wrapped(&item, "  "));
        let items: String = items.into_iter().map(item).collect();
        if !items.is_empty() {
            self.block(&items);
        }
    }

    /// A table; bars and line breaks in its cells are made harmless, and a column without any
    /// content is left out.
    pub fn table<H, R>(
        &mut self,
        head: impl IntoIterator<Item = H>,
        rows: impl IntoIterator<Item = R>,
    ) where
        H: AsRef<str>,
        R: IntoIterator<Item: AsRef<str>>,
    {
        let cell = |text: &str| text.replace('|', "\\|").replace('\n', " ");
        let cells = |row: R| row.into_iter().map(|text| cell(text.as_ref())).collect();
        let rows: Vec<Vec<String>> = rows.into_iter().map(cells).collect();
        let head: Vec<String> = head.into_iter().map(|text| text.as_ref().into()).collect();
        let filled = |n: &usize| {
            rows.is_empty() || rows.iter().any(|row| row.get(*n).is_some_and(|c| !c.is_empty()))
        };
        let shown: Vec<usize> = (0..head.len()).filter(filled).collect();
        let line = |row: &Vec<String>| {
            let cells = shown.iter().filter_map(|n| row.get(*n)).map(|cell| format!(" {cell} |"));
            format!("|{}\n", cells.collect::<String>())
        };
        let rule = "---|".repeat(shown.len());
        let rows: String = rows.iter().map(line).collect();
        self.block(&format!("{}|{rule}\n{rows}", line(&head)));
    }

    /// Lines that keep their breaks and spaces.
    pub fn verbatim(&mut self, lines: &str) {
        self.block(&format!("```text\n{}\n```", lines.trim_end()));
    }

    /// A figure with its name as a file and its description.
    pub fn figure(&mut self, name: &str, description: &str, svg: String) {
        self.block(&format!("![{description}](figures/{name})"));
        self.figures.push((name.into(), svg));
    }

    fn block(&mut self, text: &str) {
        self.text.push_str(&format!("\n{}\n", text.trim_end()));
    }

    /// The page so far.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Writes the page, and its figures into the folder `figures` beside it.
    ///
    /// # Errors
    ///
    /// When a folder cannot be created or a file cannot be written.
    pub fn write(&self, file: &Path) -> Result<()> {
        let figures = files::folder(file).join("figures");
        if !self.figures.is_empty() {
            files::prepare(&figures)?;
        }
        for (name, svg) in &self.figures {
            files::write(&figures.join(name), svg)?;
        }
        files::write(file, &self.text)
    }
}

/// The anchor of a heading.
pub fn anchor(heading: &str) -> String {
    let mut anchor = heading.to_lowercase().replace(' ', "-");
    anchor.retain(|c| c.is_alphanumeric() || c == '-');
    anchor
}

/// The different entries in the order of their first appearance.
pub fn distinct<T: Eq + std::hash::Hash + Clone>(entries: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut seen = HashSet::new();
    entries.into_iter().filter(|entry| seen.insert(entry.clone())).collect()
}

/// Words in lines that are short enough; all lines but the first begin with `indent`.
fn wrapped(words: &str, indent: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        // At the beginning of a line these words would have another meaning.
        let marks = ["-", "+", "*", ">", "=", "1."].contains(&word) || word.starts_with(['#', '|']);
        let fits = |line: &String| format!("{indent}{line} {word}").chars().count() <= COLUMNS;
        match lines.last_mut() {
            Some(line) if marks || fits(line) => *line += &format!(" {word}"),
            _ => lines.push(word.into()),
        }
    }
    lines.join(&format!("\n{indent}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_short_and_keep_all_words() {
        let words = ["ein", "word", "–", "γτ", "-", "1."].map(|word| format!("{word} ")).concat();
        let words = words.repeat(50);
        let text = wrapped(&words, "  ");
        assert!(text.lines().count() > 5);
        assert!(text.lines().all(|line| line.chars().count() <= COLUMNS + 2));
        assert!(
            text.lines().skip(1).all(|line| line.starts_with("  ") && !line.starts_with("  -"))
        );
        assert!(text.split_whitespace().eq(words.split_whitespace()));
    }

    #[test]
    fn cells_stay_in_their_table() {
        let mut page = Page::new("a");
        page.table(["x", "nothing"], [["a | b\nc", ""]]);
        assert!(page.text().ends_with("| x |\n|---|\n| a \\| b c |\n"), "{}", page.text());
        assert_eq!(anchor("`stiff` Long times, 2"), "stiff-long-times-2");
        assert_eq!(distinct([2, 1, 2]), [2, 1]);
    }
}
