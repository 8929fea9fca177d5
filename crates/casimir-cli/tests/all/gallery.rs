//! The scenes of the gallery, and the pages about scenes.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;

use crate::common::{json, run, succeeds};

fn project(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file)
}

fn read(file: &str) -> String {
    fs::read_to_string(project(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The names of all files in `scenes/`.
fn scenes() -> BTreeSet<String> {
    let files = fs::read_dir(project("scenes")).expect("scenes/");
    files.map(|file| file.unwrap().path().file_stem().unwrap().to_str().unwrap().into()).collect()
}

/// The kinds of the parts of a scene, as the page lists them.
fn kinds(folder: &Path, file: &str) -> String {
    // Numbers of paths and steps do not matter: a scheme is refused before.
    let refused = ["split", "nv"].map(|scheme| {
        let output =
            run(folder, &["run", file, "--scheme", scheme, "--paths", "1", "--steps", "64"]);
        let said = String::from_utf8_lossy(&output.stderr);
        said.contains("needs a sum of parts with flows") || said.contains("has neither B nor H")
    });
    assert_eq!(refused[0], refused[1], "{file}");
    let found = json(folder, &["inspect", file, "--json"]);
    let kind = |part: &Value| part.as_str().unwrap().split(" by ").next().unwrap().to_owned();
    let kinds: Vec<String> = found["flows"].as_array().into_iter().flatten().map(kind).collect();
    let runs = kinds.chunk_by(|one, next| one == next).map(|run| match run.len() {
        1 => run[0].clone(),
        number => format!("{number} × {}", run[0]),
    });
    match (refused[0], kinds.is_empty()) {
        (true, _) => "–".into(),
        (false, true) => "built in".into(),
        (false, false) => runs.collect::<Vec<_>>().join(", "),
    }
}

#[test]
#[ignore = "long: run by the gate"]
fn the_page_says_which_scenes_have_flows() {
    let folder = tempfile::tempdir().unwrap();
    let page = read("docs/gallery.md");
    let table = page.split("| scene | parts |\n|---|---|\n").nth(1).expect("a table");
    let rows: BTreeSet<&str> = table.lines().take_while(|line| line.starts_with('|')).collect();
    let found = scenes().into_iter().map(|name| {
        let file = format!("{name}.toml");
        fs::write(folder.path().join(&file), read(&format!("scenes/{file}"))).unwrap();
        format!("| `{name}` | {} |", kinds(folder.path(), &file))
    });
    let found: BTreeSet<String> = found.collect();
    assert_eq!(rows, found.iter().map(String::as_str).collect());
}

/// All keys of a schema.
fn keys(schema: &Value, found: &mut BTreeSet<String>) {
    match schema {
        Value::Object(object) => {
            if let Some(Value::Object(properties)) = object.get("properties") {
                found.extend(properties.keys().cloned());
            }
            object.values().for_each(|value| keys(value, found));
        }
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn the_page_has_every_key_and_every_system() {
    let folder = tempfile::tempdir().unwrap();
    let mut all = BTreeSet::new();
    keys(&json(folder.path(), &["schema"]), &mut all);
    assert!(all.contains("H0") && all.contains("truncation"), "{all:?}");
    let list = succeeds(folder.path(), &["new", "--list"]);
    let systems = list.split("and their parameters:\n").nth(1).expect("systems");
    let systems = systems.lines().filter(|line| !line.starts_with("   "));
    all.extend(systems.map(|line| line.split_whitespace().next().expect("a name").to_owned()));
    let page = read("docs/scenes.md");
    for name in all {
        assert!(page.contains(&format!("| `{name}` |")), "no row for {name}");
    }
}

#[test]
fn every_scene_is_listed_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    let list = succeeds(folder.path(), &["new", "--list"]);
    let scenes_only = list.split("\nSystems of the project").next().unwrap();
    let listed = scenes_only.lines().skip(1).map(|line| {
        let (name, headline) = line.trim().split_once(' ').expect("a headline");
        assert!(headline.trim().len() > 10, "{line}");
        name
    });
    let page = read("docs/gallery.md");
    let figures = page.lines().filter_map(|line| line.strip_prefix("<!-- figure "));
    let shown = figures.map(|figure| figure.split(' ').next().unwrap());
    let names = scenes();
    assert_eq!(listed.map(str::to_owned).collect::<BTreeSet<_>>(), names);
    assert_eq!(shown.map(str::to_owned).collect::<BTreeSet<_>>(), names);
    for name in names {
        assert!(project(&format!("docs/figures/gallery-{name}.svg")).is_file(), "{name}");
        for words in [format!("`casimir new {name}`"), format!("(figures/gallery-{name}.svg)")] {
            assert!(page.contains(&words), "{words}");
        }
    }
}
