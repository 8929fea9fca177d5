//! `casimir --citation`: what to cite.

use std::path::Path;

use casimir_cli::{
    citation::{bibtex, used},
    failure::{Done, Failure},
    scene::{Changes, Scene},
    verbs::scheme,
};
use serde_json::{Value, json};

use super::{print, source};

/// Prints all entries, or those of a file.
pub fn citation(file: Option<&Path>) -> Done {
    let result = file.map(read).transpose()?;
    print(&bibtex(result.as_ref()))
}

/// The JSON of a file; of a scene the scheme that a run takes.
fn read(file: &Path) -> Done<Value> {
    let source = source(file)?;
    if source.name.ends_with(".toml") {
        return Ok(json!({ "scheme": scheme(&Scene::new(source, &Changes::default())?).0 }));
    }
    let wrong = |why: &str| {
        let name = &source.name;
        Failure::Usage(format!("{name}: {why}; give a scene, or results as --json prints them"))
    };
    let found = serde_json::from_str(&source.text).map_err(|error| wrong(&error.to_string()))?;
    match used(&found)[..] {
        [] => Err(wrong("names no scheme that was used")),
        _ => Ok(found),
    }
}
