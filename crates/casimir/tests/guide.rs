//! The guide's programs are the examples that are compiled and run.

use std::fs::read_to_string;
use std::path::Path;

#[test]
fn the_blocks_of_the_guide_are_in_the_examples() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let guide = read_to_string(here.join("../../docs/guide.md")).unwrap();
    let example = read_to_string(here.join("examples/charged_particle.rs")).unwrap();
    let mut blocks = Vec::new();
    let mut lines = guide.lines();
    while let Some(line) = lines.next() {
        if line == "```rust,ignore" {
            let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            blocks.push(block.join("\n"));
        }
    }
    assert_eq!(blocks.len(), 8);
    // The other two programs are shown in part.
    for (block, other) in [(7, "which_scheme"), (5, "study")] {
        let other = read_to_string(here.join(format!("examples/{other}.rs"))).unwrap();
        assert!(other.contains(&blocks.remove(block)));
    }
    assert_eq!(blocks.join("\n\n") + "\n", example);
}
