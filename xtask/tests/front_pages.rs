//! The README of each published crate is the beginning of its documentation: the promise and the
//! first listing, which is compiled and run there. `WRITE=1 cargo test -p xtask` writes them.

use std::{env, fs, io, path::Path};

const END: &str = "Part of Casimir, structure-preserving simulation of damped stochastic Poisson \
                   systems.\nAll of it as one dependency is the crate `casimir-poisson`.\n";

/// Links of rustdoc as plain words: `[`Real`](x)` and `[`Real`]` are `Real`.
fn plain(line: &str) -> String {
    let mut words = String::new();
    let mut rest = line;
    while let Some((before, after)) = rest.split_once('[') {
        let Some((name, after)) = after.split_once(']') else { break };
        // Indices of arrays stay.
        let is_link = name.starts_with('`') || after.starts_with('(');
        let name = if is_link { name.into() } else { format!("[{name}]") };
        words += &format!("{before}{name}");
        rest = match after.strip_prefix('(').filter(|_| is_link) {
            Some(target) => target.split_once(')').map_or("", |(_, after)| after),
            None => after,
        };
    }
    words + rest
}

/// The README of a crate with this documentation; none without a listing.
fn read_me(package: &str, source: &str) -> Option<String> {
    let lines = source.lines().map_while(|line| line.strip_prefix("//!"));
    let lines: Vec<&str> = lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect();
    let fence = |line: &&str| line.starts_with("```");
    let first = lines.iter().position(fence)?;
    let last = first + 1 + lines[first + 1..].iter().position(fence)?;
    let mut text = format!("# {package}\n\n");
    lines[..first].iter().for_each(|line| text += &format!("{}\n", plain(line)));
    text += "```rust\n";
    let shown = lines[first + 1..last].iter().filter(|line| !line.starts_with("# "));
    shown.for_each(|line| text += &format!("{line}\n"));
    Some(text + "```\n\n" + END)
}

#[test]
fn front_pages_are_the_beginning_of_the_documentation() -> io::Result<()> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let mut number = 0;
    for folder in fs::read_dir(crates)? {
        let folder = folder?.path();
        let manifest = fs::read_to_string(folder.join("Cargo.toml"))?;
        if !manifest.contains("readme = \"README.md\"") {
            continue;
        }
        number += 1;
        let package = manifest.lines().find_map(|line| line.strip_prefix("name = \""));
        let package = package.expect("a name").trim_end_matches('"');
        let source = fs::read_to_string(folder.join("src/lib.rs"))?;
        let (file, text) = (folder.join("README.md"), read_me(package, &source));
        let text = text.unwrap_or_else(|| panic!("{package} has no listing"));
        if env::var_os("WRITE").is_some() {
            fs::write(&file, &text)?;
        }
        assert_eq!(fs::read_to_string(&file)?, text, "{}", file.display());
    }
    assert!(number >= 10, "{number}");
    Ok(())
}

#[test]
fn links_become_words() {
    assert_eq!(plain("A [`Scheme`] on [x](y::z), y[0]."), "A `Scheme` on x, y[0].");
}
