//! `casimir new`, `schema`, `doctor` and `--citation`: commands without a run.

use scenes::{
    Changes, Scene,
    gallery::{GALLERY, scene},
    model::PROJECT,
};
use serde_json::{Value, json};
use verbs::{
    citation::{bibtex, used},
    doctor::{EXPECTED, facts, self_test},
    scheme,
};

use super::*;

/// Prints a scene, or lists them.
pub fn new(name: Option<&str>, list: bool) -> Done {
    if !list {
        return print(scene(name.unwrap_or("empty")).map_err(Failure::Usage)?);
    }
    let mut list = String::from("Scenes, for casimir new NAME:\n");
    for (name, text) in GALLERY {
        let headline = text.lines().next().unwrap_or("").trim_start_matches(['#', ' ']);
        list += &format!("  {name:<18}{headline}\n");
    }
    list += "\nSystems of the project, for `name` in [system], and their parameters:\n";
    for (name, parameters, what, _) in PROJECT {
        list += &format!("  {name:<18}{what}\n");
        if !parameters.is_empty() {
            list += &format!("{:20}{parameters}\n", "");
        }
    }
    print(&list)
}

/// Prints the JSON schema of scenes, or of the options of a verb.
pub fn schema(verb: Option<&str>) -> Done {
    let Some(verb) = verb else { return print_json(&scenes::schema()) };
    let known = verbs::NAMES.join(", ");
    print_json(&verbs::options(verb).ok_or_else(|| {
        Failure::Usage(format!("no options of `{verb}`; there are those of {known}"))
    })?)
}

/// Prints facts and what the self-test found.
pub fn doctor() -> Done {
    print(&facts(option_env!("CASIMIR_COMMIT")))?;
    if cfg!(feature = "gpu") {
        let card = card().map_or_else(|why| why, |card| format!("{card:?}"));
        print(&format!("card          {card}\n"))?;
    }
    let (text, holds) = self_test(EXPECTED)?;
    print(&text)?;
    let words = "attach this text, the scene, the command, and what should have come out";
    if holds {
        print(&format!("To report a fault, {words}.\n"))
    } else {
        Err(Failure::Run(format!("a self-test fails: report it; {words}")))
    }
}

/// Prints all entries to cite, or those of a file.
pub fn citation(file: Option<&Path>) -> Done {
    print(&bibtex(file.map(results).transpose()?.as_ref()))
}

/// The JSON of a file; of a scene the scheme that a run takes.
fn results(file: &Path) -> Done<Value> {
    let source = source("scene", file)?;
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
