//! References to cite for a result, as BibTeX.

use serde_json::Value;

/// All entries. The line before each has the words of which one must be [`used`].
const ENTRIES: &str = include_str!("citation.bib");

/// The BibTeX entries of what a result used, as far as its JSON says so, or all of them.
pub fn bibtex(result: Option<&Value>) -> String {
    let Some(result) = result else { return ENTRIES.into() };
    let used = [used(result), vec!["always"]].concat();
    let entries: Vec<&str> = ENTRIES
        .trim_end()
        .split("\n\n")
        .filter(|entry| {
            let mut when = entry.lines().take(1).flat_map(|line| line.split([' ', ',']));
            when.any(|word| used.contains(&word))
        })
        .collect();
    entries.join("\n\n") + "\n"
}

/// The schemes that a result, or each of several, used, and whether it used levels and Sobol
/// points.
pub fn used(result: &Value) -> Vec<&str> {
    if let Value::Array(all) = result {
        return all.iter().flat_map(used).collect();
    }
    // Where results have others in them. `inspect` names schemes elsewhere, and uses none.
    let mut found: Vec<&str> = ["runs", "candidates", "record"]
        .iter()
        .filter_map(|part| result.get(part))
        .flat_map(used)
        .collect();
    let scheme = result["scheme"].as_str();
    found.extend(scheme);
    // `expect` alone tells levels. Without noise each has one path; Sobol points have no areas.
    if let (Some(scheme), Some(samples)) = (scheme, result["levels"][0]["samples"].as_u64()) {
        found.push("levels");
        found.extend((samples > 1 && !scheme.ends_with("-levy")).then_some("points"));
    }
    found
}
