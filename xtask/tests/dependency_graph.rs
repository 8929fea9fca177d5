//! The dependencies between the crates: fails if a crate depends on one that the table below does
//! not allow. Only normal and build dependencies count; tests may use any crate.

use std::process::Command;

use serde_json::Value;

/// Crates, by the names of their libraries, and what they may depend on, in the order of the
/// layers; see `docs/architecture.md`.
const ALLOWED: &str = "\
real:
noise: real
dgrad: real
nonlin: real
systems: real dgrad
expression: real
formula: expression systems dgrad real
schemes: real systems dgrad nonlin noise
kernels: schemes systems
stats: real
mc: stats real schemes systems noise nonlin
lattice: mc schemes systems nonlin noise real
matrix: mc schemes systems nonlin dgrad noise real
study: mc stats noise real
expectation: mc schemes systems nonlin stats noise real
fit: expectation mc systems stats noise real
stationary: expectation study mc schemes systems nonlin stats noise real
inspect: mc schemes systems noise real
analysis: inspect mc stats formula schemes systems nonlin noise real
plot: stats real
casimir: plot analysis inspect stationary expectation study lattice mc stats formula schemes systems \
    nonlin dgrad noise real
keys: casimir
scenes: keys casimir kernels matrix
runs: scenes casimir
verbs: runs scenes fit casimir
gpu: mc formula expression schemes systems nonlin noise real
cli: verbs scenes casimir gpu
verify: plot analysis expectation mc stats kernels schemes systems nonlin dgrad noise real
xtask:";

fn allowed() -> impl Iterator<Item = (&'static str, Vec<&'static str>)> {
    let line = |line: &'static str| line.split_once(':').expect("a colon");
    ALLOWED.lines().map(line).map(|(name, rest)| (name, rest.split_whitespace().collect()))
}

/// What cargo prints.
fn cargo(arguments: &[&str]) -> anyhow::Result<String> {
    let folder = env!("CARGO_MANIFEST_DIR");
    let output = Command::new(env!("CARGO")).args(arguments).current_dir(folder).output()?;
    let errors = String::from_utf8_lossy(&output.stderr);
    anyhow::ensure!(output.status.success(), "cargo {arguments:?}: {errors}");
    Ok(String::from_utf8(output.stdout)?)
}

/// The name of a package's library: packages are called `casimir-noise` and so on.
fn library(package: &str) -> &str {
    match package {
        "casimir-poisson" => "casimir",
        _ => package.strip_prefix("casimir-").unwrap_or(package),
    }
}

fn metadata() -> anyhow::Result<Value> {
    let arguments = ["metadata", "--format-version", "1", "--no-deps", "--offline"];
    Ok(serde_json::from_str(&cargo(&arguments)?)?)
}

fn members(metadata: &Value) -> impl Iterator<Item = (&str, &Value)> {
    metadata["packages"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|package| Some((library(package["name"].as_str()?), package)))
}

/// `from -> to` for every dependency that is not in the table, and every crate that is not in it.
fn forbidden(metadata: &Value) -> Vec<String> {
    let names: Vec<&str> = members(metadata).map(|(name, _)| name).collect();
    let mut found = Vec::new();
    for (name, package) in members(metadata) {
        let Some((_, allowed)) = allowed().find(|(member, _)| *member == name) else {
            found.push(format!("{name} is not in the table"));
            continue;
        };
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            // The kind is null for a normal dependency. The name is that of the package, not an
            // alias.
            let to = library(dependency["name"].as_str().unwrap_or_default());
            if dependency["kind"] != "dev" && names.contains(&to) && !allowed.contains(&to) {
                found.push(format!("{name} -> {to}"));
            }
        }
    }
    found
}

#[test]
fn every_dependency_is_in_the_table() -> anyhow::Result<()> {
    let found = forbidden(&metadata()?);
    assert!(found.is_empty(), "{}", found.join("\n"));
    Ok(())
}

#[test]
fn the_table_names_every_crate_and_points_one_way() -> anyhow::Result<()> {
    let metadata = metadata()?;
    let mut names: Vec<&str> = members(&metadata).map(|(name, _)| name).collect();
    let layers: Vec<&str> = allowed().map(|(name, _)| name).collect();
    let mut table = layers.clone();
    names.sort_unstable();
    table.sort_unstable();
    assert_eq!(names, table);
    // Whatever a crate may depend on comes before it: no circle is possible.
    for (i, (name, allowed)) in allowed().enumerate() {
        assert!(allowed.iter().all(|to| layers[..i].contains(to)), "{name}");
    }
    Ok(())
}

/// The same check on a workspace with wrong dependencies must fail.
#[test]
fn wrong_dependencies_are_found() -> anyhow::Result<()> {
    let mut metadata = metadata()?;
    let packages = metadata["packages"].as_array_mut().expect("packages");
    for package in packages.iter_mut() {
        let dependencies = package["dependencies"].clone();
        let mut dependencies = dependencies.as_array().cloned().unwrap_or_default();
        match package["name"].as_str() {
            Some("casimir-real") => {
                dependencies.push(serde_json::json!({"name": "casimir-mc", "kind": null}))
            }
            Some("casimir-systems") => {
                dependencies.push(serde_json::json!({"name": "casimir-nonlin", "kind": "build"}));
                dependencies.push(serde_json::json!({"name": "casimir-schemes", "kind": "dev"}));
            }
            _ => {}
        }
        package["dependencies"] = Value::Array(dependencies);
    }
    packages.push(serde_json::json!({"name": "attic", "dependencies": []}));
    let mut found = forbidden(&metadata);
    found.sort_unstable();
    assert_eq!(found, ["attic is not in the table", "real -> mc", "systems -> nonlin"]);
    Ok(())
}

/// What the program reads and writes does not come with the library.
#[test]
fn the_library_has_no_dependency_of_the_program() -> anyhow::Result<()> {
    let tree = |package: &str| -> anyhow::Result<Vec<String>> {
        let arguments = "tree --offline --locked --edges normal --prefix none -p";
        let names = cargo(&arguments.split(' ').chain([package]).collect::<Vec<_>>())?;
        Ok(names.lines().filter_map(|line| Some(line.split(' ').next()?.into())).collect())
    };
    let (library, program) = (tree("casimir-poisson")?, tree("casimir-cli")?);
    for dependency in ["clap", "toml", "schemars", "indexmap"] {
        let has = |names: &[String]| names.iter().any(|name| name == dependency);
        assert!(has(&program) && !has(&library), "{dependency}");
    }
    Ok(())
}
