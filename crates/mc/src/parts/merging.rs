//! Merging the parts in a folder.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use super::{
    JobError, Program, Share,
    file::{Entry, Header, PartFile, Place, file_error, foreign},
    work::Work,
};
use crate::{Kept, ladder::Nodes, tree::Node};

/// What was merged before, in the file `merged.bin`.
pub struct Known(PartFile);

impl Known {
    pub fn open(folder: &Path, program: &Program) -> Result<Self, JobError> {
        Ok(Self(PartFile::open(folder.join("merged.bin"), program, None)?))
    }

    /// Its nodes of a piece of work, from the first group on: all of them, or fewer if there are
    /// more paths now.
    pub fn nodes<T: Kept>(&self, work: &Work<'_, T>) -> Result<Nodes<T>, JobError> {
        let path = &self.0.path;
        let Some(entry) = self.0.works.get(&work.name) else { return Ok(Vec::new()) };
        let header = &entry.header;
        work.check(path, header)?;
        if header.paths > work.paths && work.round.is_some() {
            // A round that is smaller this time is drawn anew.
            return Ok(Vec::new());
        }
        if header.groups.start != work.groups.start || header.paths > work.paths {
            return Err(work.other_paths(path, header));
        }
        let (whole, mut nodes) = (header.whole(work.paths), entry.nodes(path, work)?);
        nodes.retain(|node| node.end() <= whole);
        Ok(nodes)
    }

    /// Whether the groups of a part are no longer needed, where those before `known` are merged:
    /// they are merged, maybe in a study of fewer paths that was merged and extended since.
    pub fn has<T>(&self, work: &Work<'_, T>, part: &Header, known: u64) -> bool {
        let merged = self.0.works.get(&work.name).map_or(0, |entry| entry.header.paths);
        part.groups.end <= known || (part.paths < work.paths && part.paths <= merged)
    }
}

/// The number of paths of each piece of work that was merged in a folder.
///
/// # Errors
/// [`JobError`] if the file cannot be read, is damaged or is of another program.
pub fn merged_paths(folder: &Path, program: &Program) -> Result<BTreeMap<String, u64>, JobError> {
    let works = Known::open(folder, program)?.0.works;
    Ok(works.into_iter().map(|(name, entry)| (name, entry.header.paths)).collect())
}

/// The parts in a folder, by piece of work.
pub struct Merging {
    works: BTreeMap<String, Vec<Place>>,
    /// The parts that have a file.
    parts: BTreeSet<Share>,
    known: Known,
    missing: BTreeSet<u64>,
    next_round: Option<String>,
}

impl Merging {
    pub fn open(folder: &Path, program: &Program) -> Result<Self, JobError> {
        let known = Known::open(folder, program)?;
        let (mut works, mut parts) = (BTreeMap::<String, Vec<_>>::new(), BTreeSet::new());
        for entry in fs::read_dir(folder).map_err(file_error("read", folder))? {
            let path = entry.map_err(file_error("read", folder))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with("part-") && name.ends_with(".bin") {
                let (part, places) = Place::all(&path, program)?;
                parts.insert(part);
                places.into_iter().for_each(|(name, place)| {
                    works.entry(name).or_default().push(place);
                });
            }
        }
        if parts.is_empty() && known.0.works.is_empty() {
            let folder = folder.display();
            return Err(JobError::Refused(format!("there are no parts in {folder}")));
        }
        Ok(Self { works, parts, known, missing: BTreeSet::new(), next_round: None })
    }

    pub fn finish(self) -> Result<(), JobError> {
        if !self.missing.is_empty() {
            return Err(JobError::Missing { parts: self.missing.into_iter().collect() });
        }
        self.known.0.write()?;
        self.next_round.map_or(Ok(()), |work| Err(JobError::NextRound { work }))
    }

    /// The nodes of all groups, if the parts have them.
    pub fn collect<T: Kept>(&mut self, work: &Work<'_, T>) -> Result<Option<Nodes<T>>, JobError> {
        let mut tree = work.tree();
        self.known.nodes(work)?.into_iter().for_each(|node| tree.push(node));
        let known = tree.nodes().last().map_or(work.groups.start, Node::end);
        if known < work.groups.end {
            let mut places = self.works.remove(&work.name).unwrap_or_default();
            places.retain(|place| !self.known.has(work, &place.header, known));
            places.sort_by_key(|Place { header, path, .. }| {
                (header.groups.start, header.groups.end, path.clone())
            });
            if !self.are_complete(work, known, &places)? {
                return Ok(None);
            }
            for place in &places {
                place.nodes(work)?.into_iter().for_each(|node| tree.push(node));
            }
        }
        let mut header = work.header(work.groups.clone());
        header.done = header.groups.end;
        let nodes = tree.into_nodes();
        self.known.0.works.insert(work.name.clone(), Entry::new(header, &nodes, work)?);
        Ok(Some(nodes))
    }

    /// Whether the files have all groups from group `known` on. Remembers which parts have not.
    fn are_complete<T: Kept>(
        &mut self,
        work: &Work<'_, T>,
        known: u64,
        places: &[Place],
    ) -> Result<bool, JobError> {
        let Some(first) = places.first() else {
            // No part has begun it: its paths follow from those that are merged now, or all parts
            // are missing that have no file.
            let of = self.parts.iter().map(|part| part.of()).max().unwrap_or(0);
            let exists = |number| self.parts.iter().any(|part| part.number() == number);
            let missing: Vec<u64> = (1..=of).filter(|&number| !exists(number)).collect();
            if missing.is_empty() {
                self.next_round.get_or_insert_with(|| work.name.clone());
            }
            self.missing.extend(missing);
            return Ok(false);
        };
        let (of, mut before, mut next, mut all) = (first.part.of(), first, known, true);
        let mut complete = BTreeSet::new();
        for place in places {
            let Place { path, part, header, .. } = place;
            work.check(path, header)?;
            if header.paths != work.paths {
                return Err(work.other_paths(path, header));
            }
            if part.of() != of {
                return Err(foreign(path, &work.name, "a number of parts", part.of(), of));
            }
            if header.is_complete() {
                complete.insert(part.number());
            }
            if header.groups.is_empty() {
                continue;
            }
            if header.groups.start < next {
                return Err(JobError::Refused(format!(
                    "{} and {} both have paths of {}: they are parts of different numbers of parts. \
                     Delete those of one number",
                    before.path.display(),
                    path.display(),
                    work.name
                )));
            }
            all &= header.groups.start == next && header.is_complete();
            (before, next) = (place, header.groups.end);
        }
        if all && next == work.groups.end {
            return Ok(true);
        }
        // Those parts that would have had groups, and are not complete.
        let groups = known..work.groups.end;
        let has_groups = |number| {
            Share::new(number, of).is_ok_and(|part: Share| !part.range(&groups).is_empty())
        };
        let others = (1..=of).filter(|number| !complete.contains(number));
        let (some, none): (Vec<u64>, Vec<u64>) = others.partition(|&number| has_groups(number));
        self.missing.extend(if some.is_empty() { none } else { some });
        Ok(false)
    }
}
