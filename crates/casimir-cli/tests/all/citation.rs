//! `casimir --citation`: all that may be cited, and what a result used.

use std::fs;

use casimir::schemes::BuiltIn;
use serde_json::json;
use verbs::citation::bibtex;

use crate::common::{OSCILLATOR, fails, run, succeeds, with_scene};

/// The keys of entries.
fn keys(text: &str) -> Vec<&str> {
    let entries = text.lines().filter(|line| line.starts_with('@'));
    entries.map(|line| line.split(['{', ',']).nth(1).expect("a key")).collect()
}

const ALWAYS: [&str; 2] = ["Casimir", "BrehierCohenKomori2025"];
const SOBOL: [&str; 4] = ["Sobol1967", "JoeKuo2008", "Owen1995", "Burley2020"];

#[test]
fn every_entry_says_when_and_is_used_then() {
    let folder = tempfile::tempdir().unwrap();
    let all = succeeds(folder.path(), &["--citation"]);
    assert_eq!(all, bibtex(None));
    for entry in all.split("\n\n") {
        let lines: Vec<&str> = entry.trim_end().lines().collect();
        assert!(
            lines[0].starts_with("% ")
                && lines[0].contains(": when ") | lines[0].contains(": always"),
            "{entry}"
        );
        assert!(lines[1].starts_with('@') && lines.last() == Some(&"}"), "{entry}");
        let count = |c: char| entry.matches(c).count();
        assert_eq!(count('{'), count('}'), "{entry}");
    }
    // Together all schemes and an expectation use everything.
    let schemes = BuiltIn::ALL.iter().map(|scheme| json!({ "scheme": scheme.id() }));
    let expected = json!({ "scheme": "nv", "levels": [{ "samples": 2 }] });
    let exact = json!({ "scheme": "metropolis" });
    let used = bibtex(Some(&schemes.chain([expected, exact]).collect()));
    assert_eq!(used, all);
    // And every scheme but sexp has its own.
    for scheme in BuiltIn::ALL {
        let one = bibtex(Some(&json!({ "scheme": scheme.id() })));
        assert_eq!(keys(&one).len() > 2, scheme.id() != "sexp", "{one}");
    }
}

#[test]
fn the_software_is_that_of_the_citation_file() {
    let file = include_str!("../../../../CITATION.cff");
    let value = |key: &str| {
        let line = file.lines().find_map(|line| line.strip_prefix(key)).expect("a key");
        line.trim_matches([':', ' ', '"'])
    };
    let (version, date) = (value("version"), value("date-released"));
    assert_eq!(version, env!("CARGO_PKG_VERSION"));
    let all = bibtex(None);
    let software = all.split("\n\n").next().unwrap().replace(['{', '}'], "");
    for words in [
        format!("title = {},", value("title")),
        format!("year = {},", &date[..4]),
        format!("note = Version {version}, {date},"),
        format!("author = {},", value("  - name")),
    ] {
        assert!(software.contains(&words), "{words}: {software}");
    }
    let paper = value("    title");
    assert!(all.replace(['{', '}'], "").contains(paper), "{paper}");
}

#[test]
fn a_result_names_what_it_used() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    let cited = |of: &str| {
        let printed = succeeds(path, &["--citation", of]);
        let keys = keys(&printed).into_iter().filter(|key| !ALWAYS.contains(key));
        keys.map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(cited("scene.toml"), ["MentinkEtAl2010"]);
    succeeds(path, &["run", "scene.toml", "--scheme", "heun", "--write", "json"]);
    assert_eq!(cited("scene-run/paths.json"), ["Ruemelin1982"]);
    let many = "run scene.toml --scheme em --paths 128 --write json --out many";
    succeeds(path, &many.split(' ').collect::<Vec<_>>());
    assert_eq!(cited("many/study.json"), ["Maruyama1955"]);
    let sweep = succeeds(path, &["run", "scene.toml", "--set", "k=1,2", "--json"]);
    fs::write(path.join("sweep.json"), sweep).unwrap();
    assert_eq!(cited("sweep.json"), ["MentinkEtAl2010"]);
    let expect = |out: &str, scheme: &str| {
        succeeds(path, &["expect", "scene.toml", "--scheme", scheme, "--out", out]);
        cited(&format!("{out}/expect.json"))
    };
    assert_eq!(expect("points", "sexp"), [&["Giles2008"], &SOBOL[..]].concat());
    // Areas are drawn at random.
    assert_eq!(expect("areas", "sexp-levy"), ["MrongowiusRoessler2022", "Giles2008"]);
    // Without noise there is one path.
    let quiet = OSCILLATOR.replace("H = [\"s*q\"]\n", "").replace("s = 0.3", "");
    fs::write(path.join("scene.toml"), quiet).unwrap();
    assert_eq!(expect("quiet", "sexp"), ["Giles2008"]);
    succeeds(path, &["compare", "scene.toml", "--budget", "0.3", "--error", "0.1"]);
    let compared = cited("scene-compare/compare.json");
    assert!(["Maruyama1955", "Ruemelin1982"].iter().all(|one| compared.contains(&(*one).into())));
}

#[test]
fn what_is_no_result_is_refused() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    fs::write(path.join("other.json"), "{\"a\": [1]}").unwrap();
    fs::write(path.join("broken.json"), "{").unwrap();
    // It names many schemes, and uses none.
    fs::write(path.join("inspect.json"), succeeds(path, &["inspect", "scene.toml", "--json"]))
        .unwrap();
    for (of, words) in [
        ("nonsense", "cannot read the scene nonsense: No such file"),
        ("nonsense.toml", "cannot read the scene"),
        ("other.json", "other.json: names no scheme that was used; give a scene"),
        ("broken.json", "broken.json: EOF while"),
        ("inspect.json", "inspect.json: names no scheme"),
        (".", "Is a directory"),
    ] {
        fails(path, &["--citation", of], 2, &[words]);
    }
    fails(path, &["--citation", "scene.toml", "run", "scene.toml"], 2, &["--citation"]);
    // Without a command, help.
    assert_eq!(run(path, &[]).status.code(), Some(2));
}
