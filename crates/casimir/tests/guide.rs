//! The guide's programs are the examples that are compiled and run.

use std::fs::read_to_string;
use std::path::Path;

/// A file beside this package.
fn read(file: &str) -> String {
    read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap()
}

/// The blocks of a page that are shown and not run.
fn blocks(page: &str) -> Vec<String> {
    let mut blocks = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if line == "```rust,ignore" {
            let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            blocks.push(block.join("\n"));
        }
    }
    blocks
}

#[test]
fn the_block_of_the_cluster_page_is_in_the_example() {
    let blocks = blocks(&read("../../docs/cluster.md"));
    assert_eq!(blocks.len(), 1);
    assert!(read("examples/in_parts.rs").contains(&blocks[0]));
}

/// A listing is compiled as a reader pastes it: no line is hidden, and statements have a `main`.
#[test]
fn the_first_listings_are_tested_as_they_are_shown() {
    for page in ["../../README.md", "../../docs/start.md"] {
        let page = read(page);
        let listings: Vec<&str> = page.split("```rust\n").skip(1).collect();
        assert_eq!(listings.len(), 1);
        let code = &listings[0][..listings[0].find("```").unwrap()];
        assert!(!code.lines().any(|line| line == "#" || line.starts_with("# ")), "{code}");
        assert!(code.contains("\nfn main() -> Result<"), "{code}");
    }
}

#[test]
fn the_blocks_of_the_guide_are_in_the_examples() {
    let mut blocks = blocks(&read("../../docs/guide.md"));
    let example = read("examples/charged_particle.rs");
    assert_eq!(blocks.len(), 8);
    // The other two programs are shown in part.
    for (block, other) in [(7, "which_scheme"), (5, "many_paths")] {
        let other = read(&format!("examples/{other}.rs"));
        assert!(other.contains(&blocks.remove(block)));
    }
    assert_eq!(blocks.join("\n\n") + "\n", example);
}
