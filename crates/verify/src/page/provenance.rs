//! Where a run comes from, how long it took, and how to read its files.

use super::{
    markup::{code, entry, table},
    number::duration,
};
use crate::results::Provenance;

/// The section of the provenance.
pub fn provenance(from: &Provenance) -> String {
    let facts = [
        ("Commit", &from.git),
        ("Compiler", &from.rustc),
        ("Processor", &from.cpu),
        ("Instruction set", &from.simd),
        ("Threads", &from.threads.to_string()),
        ("Seed", &from.seed.to_string()),
        ("Mode", &from.mode),
        ("Command", &from.command),
        ("Wall time", &duration(from.wall_s)),
    ];
    let facts: String = facts.iter().map(|(name, value)| entry(name, &code(value))).collect();
    let times = from.wall_s_by_id.iter().map(|(id, seconds)| vec![code(id), duration(*seconds)]);
    format!(
        r#"<div class="two"><div><dl class="facts">{facts}</dl>
<p class="quiet">The same seed gives the same bits on any number of threads and any instruction
set.</p>
<p class="quiet">The whole run is in <a href="results.json">results.json</a>; CSV files name their
columns in the first line.</p></div>
<div>{}</div></div>"#,
        table(["panel or statement", "wall time"], times)
    )
}
