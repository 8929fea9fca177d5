//! Where a run comes from, how long it took, and how to read its files.

use verify::results::Provenance;

use super::number::duration;
use crate::report::csv::{ERROR_COLUMNS, VALUE_COLUMNS};
use crate::report::escape::escape;

/// The section of the provenance.
pub fn provenance(provenance: &Provenance) -> String {
    let threads = provenance.threads.to_string();
    let seed = provenance.seed.to_string();
    let wall = duration(provenance.wall_s);
    let facts = [
        ("Commit", &provenance.git),
        ("Compiler", &provenance.rustc),
        ("Processor", &provenance.cpu),
        ("Instruction set", &provenance.simd),
        ("Threads", &threads),
        ("Seed", &seed),
        ("Mode", &provenance.mode),
        ("Command", &provenance.command),
        ("Wall time", &wall),
    ];
    let facts: String = facts
        .iter()
        .map(|(name, value)| format!("<dt>{name}</dt><dd><code>{}</code></dd>", escape(value)))
        .collect();
    let times: String = provenance
        .wall_s_by_id
        .iter()
        .map(|(id, s)| {
            format!("<tr><th><code>{}</code></th><td>{}</td></tr>", escape(id), duration(*s))
        })
        .collect();
    let times = if times.is_empty() {
        String::new()
    } else {
        format!(
            "<table class=\"numbers\"><thead><tr><th>panel or statement</th><th>wall time</th></tr></thead>\
             <tbody>{times}</tbody></table>"
        )
    };
    format!(
        "<div class=\"two\"><div><dl class=\"facts\">{facts}</dl>\n<p class=\"quiet\">The results are the same, bit for bit, for the same seed on any number of threads \
         and any instruction set.</p>\n\
         <p class=\"quiet\">Columns of the CSV files: <code>{ERROR_COLUMNS}</code> for errors, where <code>value</code> is \
         the root-mean-square or the signed weak error and <code>se</code> its standard error; \
         <code>{VALUE_COLUMNS}</code> for invariants, where <code>exact</code> is the conformal law and \
         <code>relative_defect</code> is |value − exact| / |exact|. The whole run is in \
         <a href=\"results.json\">results.json</a>.</p></div>\n<div>{times}</div></div>"
    )
}
