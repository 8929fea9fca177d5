//! Fuzzing of the command line of this program.

use clap::Parser;
use stability::fuzz::{Bits, Report, Target};

/// Arbitrary words and numbers as arguments: parsed, or refused by a message.
pub fn target() -> Target {
    Target {
        name: "command line",
        checks: "every list of arguments is parsed or refused",
        cost: 4,
        run: parse,
    }
}

/// Words that mean something somewhere, so that arguments come to be parsed at all.
const WORDS: [&str; 18] = [
    "reproduce",
    "verify",
    "work-precision",
    "stability",
    "--quick",
    "--seed",
    "--only",
    "--out",
    "--page",
    "--threads",
    "--simd",
    "--inputs",
    "--seeds",
    "--",
    "-",
    "",
    "18446744073709551615",
    "-1",
];

fn parse(bits: &mut Bits) -> Result<Report, String> {
    let mut arguments = vec!["xtask".to_owned()];
    for _ in 0..bits.below(7) {
        let word = match bits.below(4) {
            0 | 1 => WORDS[bits.below(WORDS.len() as u64) as usize].to_owned(),
            2 => format!("{:?}", bits.number()),
            _ => (0..bits.below(6))
                .filter_map(|_| char::from_u32(bits.below(0x11_0000) as u32))
                .collect(),
        };
        arguments.push(if bits.below(8) == 0 { format!("--seed={word}") } else { word });
    }
    Ok(match crate::Arguments::try_parse_from(&arguments) {
        Ok(_) => Report::accepted(),
        Err(error) if error.to_string().is_empty() => {
            return Err(format!("no message for {arguments:?}"));
        }
        Err(_) => Report::refused(),
    })
}
