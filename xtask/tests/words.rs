//! Rules for words that a program can check. `CONTRIBUTING.md` has the others.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Words that no first line of documentation starts with: it stands alone in rustdoc's lists.
const STARTS: [&str; 9] =
    ["That ", "Those ", "It ", "Its ", "They ", "Their ", "The same ", "Of ", "What "];
/// Beginnings of constants in the place of `MAX_` and `MIN_`.
const LIMITS: [&str; 4] = ["const MOST_", "const LEAST_", "const FEWEST_", "const MAXIMUM_"];

/// Longest line of a comment; tables may be longer. Code is formatted.
const COLUMNS: usize = 100;

/// All files of Rust under `folder`.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            sources(&path, found)?;
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
    Ok(())
}

/// The rule that a line breaks after the line before it.
fn broken(before: &str, line: &str) -> Option<&'static str> {
    let is_long = line.chars().count() > COLUMNS;
    let (before, line) = (before.trim_start(), line.trim_start());
    let first = line.strip_prefix("/// ").filter(|_| !before.starts_with("///"));
    let is_comment = line.starts_with("///") || line.starts_with("//!");
    let starts = first.is_some_and(|words| STARTS.iter().any(|start| words.starts_with(start)));
    match () {
        () if starts => Some("start with a noun or a verb"),
        () if is_comment && line.contains(" so many ") => Some("name the parameter"),
        () if is_long && line.starts_with("//") && !line.starts_with("//! |") => {
            Some("100 columns")
        }
        () if LIMITS.iter().any(|name| line.contains(name)) => Some("MAX_ or MIN_"),
        () => None,
    }
}

#[test]
fn words_keep_to_the_rules() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    sources(&root.join("gpu/src"), &mut files)?;
    for folder in fs::read_dir(root.join("crates"))? {
        sources(&folder?.path().join("src"), &mut files)?;
    }
    assert!(files.len() > 100, "{} files", files.len());
    let mut found = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file)?;
        let lines = text.lines().collect::<Vec<_>>();
        let pairs = std::iter::once("").chain(lines.iter().copied()).zip(&lines).zip(1..);
        found.extend(pairs.filter_map(|((before, line), number)| {
            broken(before, line).map(|rule| format!("{}:{number}: {rule}", file.display()))
        }));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    Ok(())
}

#[test]
fn each_rule_finds_its_line() {
    assert_eq!(broken("", "    /// Its noises."), Some("start with a noun or a verb"));
    assert_eq!(broken("/// Noises,", "/// Its number."), None);
    assert_eq!(broken("", "//! Takes so many noises."), Some("name the parameter"));
    assert_eq!(broken("", "pub const MOST_NOISES: usize = 1;"), Some("MAX_ or MIN_"));
    assert_eq!(broken("", "/// Number of noises."), None);
}
