//! The scenes of the gallery, and the pages about scenes.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

use crate::common::{json, succeeds};

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

/// A number of a scene by its key.
fn number(scene: &str, key: &str) -> f64 {
    let value = scene.lines().find_map(|line| line.strip_prefix(&format!("{key} = ")));
    let value = value.and_then(|value| value.split_whitespace().next());
    value.and_then(|value| value.parse().ok()).unwrap_or_else(|| panic!("no {key} in {scene}"))
}

#[test]
#[ignore = "long: run by the gate"]
fn every_scene_runs_and_has_expectations() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in scenes() {
        let text = succeeds(path, &["new", &name]);
        assert_eq!(text, read(&format!("scenes/{name}.toml")));
        let file = format!("{name}.toml");
        fs::write(path.join(&file), &text).unwrap();
        let inspection = succeeds(path, &["inspect", &file]);
        assert!(!inspection.contains("Mistakes\n"), "{name}: {inspection}");
        let steps = (number(&text, "steps") / 8.0).floor().to_string();
        // Statistics of 4096 spins take a minute.
        let paths = if name == "quench" { "1" } else { "128" };
        let run = succeeds(path, &["run", &file, "--paths", paths, "--steps", &steps]);
        assert!(run.contains(&format!("{name}-run")), "{run}");
        assert!(path.join(format!("{name}-run/index.html")).is_file());
        if !text.contains("[expect]") {
            continue;
        }
        let loose = (16.0 * number(&text, "accuracy")).to_string();
        let found = succeeds(path, &["expect", &file, "--accuracy", &loose]);
        assert!(found.contains("E["), "{name}: {found}");
    }
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

/// The code blocks of a page in this language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    let blocks = page.split(&fence).skip(1);
    blocks.map(|block| block.split("```").next().unwrap().to_owned()).collect()
}

/// What a program printed without its seconds.
fn timeless(text: &str) -> Vec<String> {
    let is_time = |text: &str| text.strip_suffix(" s").is_some_and(|n| n.parse::<f64>().is_ok());
    let line = |line: &str| match line.rsplit_once(", ") {
        _ if is_time(line) => String::new(),
        Some((rest, seconds)) if is_time(seconds) => rest.to_owned(),
        _ => line.to_owned(),
    };
    text.trim().lines().map(line).collect()
}

#[test]
fn the_worked_example_prints_what_the_page_says() {
    let page = read("docs/scenes.md");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("spin.toml"), &blocks(&page, "toml")[0]).unwrap();
    let texts: Vec<Vec<String>> = blocks(&page, "text").iter().map(|text| timeless(text)).collect();
    let printed = succeeds(path, &["run", "spin.toml", "--write", "csv,npz"]);
    assert!(texts.contains(&timeless(&printed)), "{printed}");
    let printed = succeeds(path, &["expect", "spin.toml"]);
    assert!(texts.contains(&timeless(&printed)), "{printed}");
    reads_in_python(&blocks(&page, "python"), path);
}

/// Runs the Python of the page in a folder with results. `CASIMIR_PYTHON` names another Python.
fn reads_in_python(programs: &[String], folder: &Path) {
    let python = std::env::var("CASIMIR_PYTHON").unwrap_or("python3".into());
    let run =
        |program: &str| Command::new(&python).args(["-c", program]).current_dir(folder).output();
    assert_eq!(programs.len(), 3);
    for program in programs {
        let module = program.lines().next().expect("an import");
        if !run(module).is_ok_and(|output| output.status.success()) {
            println!("not tried, since `{python}` does not do `{module}`");
            continue;
        }
        let output = run(program).expect("Python starts");
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !output.stdout.is_empty(), "{program}\n{errors}");
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
