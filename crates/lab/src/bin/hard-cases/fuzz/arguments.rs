//! The command line of this program.

use anyhow::ensure;
use clap::Parser;

use super::{Bits, Fed, Target};
use crate::Arguments;

pub const TARGET: Target = Target {
    name: "command line",
    checks: "every list of arguments is parsed or refused",
    cost: 4,
    feed,
};

/// Words that mean something, so that arguments come to be parsed at all.
const WORDS: [&str; 11] = [
    "--quick",
    "--seed",
    "--only",
    "--out",
    "--page",
    "--inputs",
    "--",
    "-",
    "",
    "18446744073709551615",
    "-1",
];

fn feed(bits: &mut Bits) -> Fed {
    let mut arguments = vec!["stability".to_owned()];
    for _ in 0..bits.below(7) {
        let word = match bits.below(4) {
            0 | 1 => WORDS[bits.below(WORDS.len() as u64) as usize].to_owned(),
            2 => format!("{:?}", bits.number()),
            _ => (0..bits.below(6))
                .filter_map(|_| char::from_u32(bits.below(0x11_0000) as u32))
                .collect(),
        };
        arguments.push(if bits.one_in(8) { format!("--seed={word}") } else { word });
    }
    match Arguments::try_parse_from(&arguments) {
        Ok(_) => Ok(Some(0)),
        Err(error) => {
            ensure!(!error.to_string().is_empty(), "no message for {arguments:?}");
            Ok(None)
        }
    }
}
