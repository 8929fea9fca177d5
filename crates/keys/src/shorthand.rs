//! Short forms of a state and of B: vectors, and blocks.

use std::collections::{BTreeMap, HashMap};

use casimir::formula::{self, Formula, Names, nearest};

use crate::{At, Listed, Name, Read, Structure, is_column, refuse, taken, words};

/// The components of a state, and vectors of them.
pub struct State {
    /// The names of the components, each where it is written.
    pub components: Vec<Name>,
    /// The names of vectors and of their components.
    pub vectors: Vec<(String, Vec<String>)>,
}

/// Forms that an entry of `state` may have.
const FORMS: &str = "a name, or vectors such as q[1..3], s[xyz] or s[1..4][xyz]";

/// The most components that one entry makes.
const MOST: u32 = 100_000;

impl State {
    /// The state that `state` means: a name is a component, `q[1..3]` the vector q of q1, q2 and
    /// q3, `s[xyz]` the vector s of sx, sy and sz, `s[1..2][xyz]` the vectors s1 and s2 of such
    /// components.
    pub fn new(entries: &[Name]) -> Read<Self> {
        let mut state = Self { components: Vec::new(), vectors: Vec::new() };
        for entry in entries {
            let Some(vectors) = vectors(entry) else {
                refuse!(entry, "`{}` is neither {FORMS}", **entry);
            };
            if vectors.is_empty() {
                state.components.push(entry.clone());
            }
            for (vector, parts) in vectors {
                let of: Vec<String> = parts.iter().map(|part| format!("{vector}{part}")).collect();
                state.components.extend(of.iter().map(|of| At::new(entry.span(), of.clone())));
                state.vectors.push((vector, of));
            }
        }
        match state.components.iter().find(|name| is_column(name)) {
            Some(name) => Err(taken(name)),
            None => Ok(state),
        }
    }

    /// The components of what an argument names: a component, a vector, or several, `s[1..3]`.
    fn of(&self, argument: &str) -> Option<Vec<Vec<usize>>> {
        let numbers: HashMap<&str, usize> =
            self.components.iter().enumerate().rev().map(|(k, name)| (&***name, k)).collect();
        let place = |name: &str| numbers.get(name).copied();
        let one = |name: &str| match self.vectors.iter().find(|(vector, _)| vector == name) {
            Some((_, components)) => components.iter().map(|name| place(name)).collect(),
            None => Some(vec![place(name)?]),
        };
        match argument.split_once('[') {
            Some((name, numbers)) => {
                range(numbers.strip_suffix(']')?)?.map(|k| one(&format!("{name}{k}"))).collect()
            }
            None => Some(vec![one(argument)?]),
        }
    }
}

/// The vectors that an entry makes, each with the ends of its components; none of a component.
fn vectors(entry: &str) -> Option<Vec<(String, Vec<String>)>> {
    let Some((name, brackets)) = entry.split_once('[') else { return Some(Vec::new()) };
    let parts: Option<Vec<_>> = brackets.strip_suffix(']')?.split("][").map(parts).collect();
    match &parts?[..] {
        [parts] => Some(vec![(name.into(), parts.clone())]),
        [first, parts] if first.len() * parts.len() <= MOST as usize => {
            Some(first.iter().map(|k| (format!("{name}{k}"), parts.clone())).collect())
        }
        _ => None,
    }
}

/// Parts in a bracket: letters, or numbers from and to.
fn parts(bracket: &str) -> Option<Vec<String>> {
    match bracket.chars().count() > 1 && bracket.chars().all(char::is_alphabetic) {
        true => Some(bracket.chars().map(String::from).collect()),
        false => Some(range(bracket)?.map(|k| k.to_string()).collect()),
    }
}

/// The numbers of a range such as `1..3`.
fn range(text: &str) -> Option<impl Iterator<Item = u32> + use<>> {
    let (first, last) = text.split_once("..")?;
    let (first, last) = (first.trim().parse().ok()?, last.trim().parse().ok()?);
    (first <= last && last <= MOST).then_some(first..=last)
}

/// The entries of B as texts.
pub fn structure(state: (&State, &Names), at: &At<Structure>) -> Read<formula::Structure> {
    Ok(match &**at {
        Listed::List(rows) => formula::Structure::Rows(rows.iter().map(words).collect()),
        Listed::Text(text) => formula::Structure::Entries(blocks(state, text, at)?),
    })
}

/// A sum of multiples of blocks, as the entries above the diagonal: in each stand the entries of
/// the blocks for these.
fn blocks(
    (state, names): (&State, &Names),
    text: &str,
    at: &At<Structure>,
) -> Read<BTreeMap<(usize, usize), String>> {
    let (mut gaps, mut found, mut rest) = (Vec::new(), Vec::new(), text);
    while let Some([gap, block, after]) = next_block(rest) {
        gaps.push(gap);
        found.push(block_of(state, block, at)?);
        rest = after;
    }
    if found.is_empty() {
        block_of(state, text.trim(), at)?;
    }
    let filled = |of: &[String]| {
        let all = gaps.iter().zip(of).map(|(gap, entry)| format!("{gap}{entry}"));
        all.collect::<String>() + rest
    };
    let none = vec!["0".to_owned(); found.len()];
    let mut sums: BTreeMap<(usize, usize), Vec<String>> = BTreeMap::new();
    for (k, block) in found.iter().enumerate() {
        for &(i, j, ref entry) in block {
            let (place, sign) = if i < j { ((i, j), "+") } else { ((j, i), "-") };
            if i == j {
                refuse!(at, "a block joins different components");
            }
            let sum = &mut sums.entry(place).or_insert_with(|| none.clone())[k];
            *sum = format!("({sum}{sign}{entry})");
        }
    }
    // Where all blocks are zero, so is a sum of multiples.
    let mut names = names.clone();
    // A name that stands twice is told elsewhere.
    let known = state.components.iter().filter(|name| names.variable(name).is_ok()).count();
    match Formula::parse(&filled(&none), &names) {
        Ok(zero) if zero.value(&vec![1.0; known]) == 0.0 => {}
        Err(error) if error.unknown_name.is_some() => {}
        _ => refuse!(at, "each term of B is a multiple of a block"),
    }
    Ok(sums.into_iter().map(|(place, of)| (place, filled(&of))).collect())
}

/// The kinds of blocks.
const BLOCKS: [&str; 3] = ["canonical", "spins", "rigid"];

/// The first block of a text, between what is before and after it.
fn next_block(text: &str) -> Option<[&str; 3]> {
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    let words = BLOCKS.iter().flat_map(|kind| text.match_indices(kind));
    let whole = words.filter(|(at, kind)| {
        !text[..*at].ends_with(is_letter) && !text[at + kind.len()..].starts_with(is_letter)
    });
    let (start, kind) = whole.min()?;
    let (gap, block) = text.split_at(start);
    let end = match block[kind.len()..].trim_start().starts_with('(') {
        true => block.find(')').map_or(block.len(), |at| at + 1),
        false => kind.len(),
    };
    let (block, after) = block.split_at(end);
    Some([gap, block, after])
}

/// Entries of B by their rows and columns.
type Block = Vec<(usize, usize, String)>;

/// The entries of one block.
fn block_of(state: &State, text: &str, at: &At<Structure>) -> Read<Block> {
    let (kind, given) = match text.split_once('(') {
        Some((kind, inner)) => match inner.strip_suffix(')') {
            Some(inner) => (kind.trim(), inner.split(',').map(str::trim).collect()),
            None => refuse!(at, "`{text}` ends without `)`"),
        },
        None => (text, Vec::new()),
    };
    if !BLOCKS.contains(&kind) {
        let hint = nearest(kind, BLOCKS);
        refuse!(
            at,
            "unknown block `{kind}`: B is rows of entries, or a sum of canonical(q, p), \
             spins(s1, s2, …) and rigid{hint}"
        );
    }
    let mut vectors = Vec::new();
    for argument in given {
        let Some(found) = state.of(argument) else {
            let vectors = state.vectors.iter().map(|(name, _)| name);
            let known = vectors.chain(state.components.iter().map(|name| &**name));
            refuse!(at, "`{argument}` is no part of the state{}", nearest(argument, known));
        };
        vectors.extend(found);
    }
    let all: Vec<usize> = (0..state.components.len()).collect();
    if kind == "canonical" {
        let (q, p) = match &vectors[..] {
            [] => all.split_at(all.len() / 2),
            [q, p] => (&q[..], &p[..]),
            _ => refuse!(at, "write canonical(q, p): positions and their momenta"),
        };
        if q.len() != p.len() {
            let (q, p) = (q.len(), p.len());
            refuse!(at, "canonical takes as many momenta as positions, got {q} and {p}");
        }
        return Ok(q.iter().zip(p).map(|(q, p)| (*q, *p, "1".into())).collect());
    }
    if vectors.is_empty() {
        vectors = all.chunks(3).map(<[usize]>::to_vec).collect();
    }
    let mut block = Vec::new();
    for vector in vectors {
        let [x, y, z] = vector[..] else {
            refuse!(at, "{kind} takes vectors of three components, got {}", vector.len());
        };
        // B(s)v = s × v.
        for (i, j, k) in [(x, y, z), (y, z, x), (z, x, y)] {
            block.push((j, i, state.components[k].to_string()));
        }
    }
    Ok(block)
}
