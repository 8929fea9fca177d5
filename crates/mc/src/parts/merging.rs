//! Merging the parts in a folder.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use super::{
    JobError, Outcome, Plan, Planned, Program, Share,
    balance::{Load, Shares},
    file::{Entry, Header, Index, PartFile, Place, file_error, foreign},
    job::Work,
};
use crate::{driver::GROUP_PATHS, tree::Node};

/// The file of what was merged.
pub const MERGED: &str = "merged.json";

/// What was merged before.
pub struct Known(pub PartFile);

impl Known {
    /// What is left to be computed of planned works.
    pub fn left(&self, plan: &Plan) -> Vec<Load> {
        let load = |work: &Planned| {
            let merged = self.0.works.get(&work.name);
            let merged = merged.map_or(0, |entry| entry.header.whole(work.items));
            let (name, groups) = (work.name.clone(), merged.min(work.groups)..work.groups);
            Load { name, groups, steps: work.steps }
        };
        plan.works.iter().map(load).collect()
    }

    /// Its nodes of a piece of work, from the first group on: all of them, or fewer if there are
    /// more paths now.
    pub fn nodes<T>(&self, work: &Work<'_, T>) -> Result<Vec<Node<T>>, JobError> {
        let path = &self.0.path;
        let Some(entry) = self.0.works.get(work.name) else { return Ok(Vec::new()) };
        let header = &entry.header;
        work.check(path, header)?;
        if header.paths > work.paths && work.round.is_some() {
            // A round that is smaller this time is drawn anew.
            return Ok(Vec::new());
        }
        if header.groups.start != work.groups.start || header.paths > work.paths {
            return Err(foreign(path, work.name, "a number of paths", header.paths, work.paths));
        }
        let (whole, mut nodes) = (header.whole(work.paths), entry.nodes(path, work)?);
        nodes.retain(|node| node.end() <= whole);
        Ok(nodes)
    }

    /// Whether the groups of a part are no longer needed, where those before `known` are merged:
    /// they are merged, maybe in a study of fewer paths that was merged and extended since.
    pub fn has<T>(&self, work: &Work<'_, T>, part: &Header, known: u64) -> bool {
        let merged = self.0.works.get(work.name).map_or(0, |entry| entry.header.paths);
        part.groups.end <= known || (part.paths < work.paths && part.paths <= merged)
    }
}

/// The number of paths of each piece of work that was merged in a folder.
///
/// # Errors
/// [`JobError`] if the file cannot be read, is damaged or is of another program.
pub fn merged_paths(folder: &Path, program: &Program) -> Result<BTreeMap<String, u64>, JobError> {
    let works = PartFile::open(folder.join(MERGED), program, None)?.works;
    Ok(works.into_iter().map(|(name, entry)| (name, entry.header.paths)).collect())
}

/// The parts in a folder, by piece of work.
pub struct Merging {
    works: BTreeMap<String, Vec<(Share, Place)>>,
    /// The parts that have a file.
    parts: BTreeSet<Share>,
    known: Known,
    missing: BTreeSet<u64>,
    next_round: Option<String>,
    shares: Shares,
}

impl Merging {
    pub fn open(folder: &Path, program: &Program) -> Result<Self, JobError> {
        let known = Known(PartFile::open(folder.join(MERGED), program, None)?);
        let (mut works, mut parts) = (BTreeMap::<String, Vec<_>>::new(), BTreeSet::new());
        for path in part_files(folder)? {
            let index = Index::read(&path, program)?;
            parts.insert(index.part);
            for (name, place) in index.works {
                works.entry(name).or_default().push((index.part, place));
            }
        }
        if parts.is_empty() && known.0.works.is_empty() {
            return Err(JobError::NoParts(folder.to_owned()));
        }
        let (missing, shares) = (BTreeSet::new(), Shares::default());
        Ok(Self { works, parts, known, missing, next_round: None, shares })
    }

    /// Divides these works as their parts did.
    pub fn balance(&mut self, plan: &Plan) {
        self.shares = Shares::new(self.known.left(plan), self.of());
    }

    /// The number of parts.
    fn of(&self) -> u64 {
        self.parts.iter().map(|part| part.of()).max().unwrap_or(0)
    }

    pub fn finish(self) -> Result<Outcome, JobError> {
        if !self.missing.is_empty() {
            return Err(JobError::Missing { parts: self.missing.into_iter().collect() });
        }
        self.known.0.write()?;
        let next = self.next_round;
        next.map_or(Ok(Outcome::Complete), |work| Err(JobError::NextRound { work }))
    }

    /// The nodes of all groups, if the parts have them.
    pub fn collect<T>(&mut self, work: &Work<'_, T>) -> Result<Option<Vec<Node<T>>>, JobError> {
        let mut tree = work.tree();
        self.known.nodes(work)?.into_iter().for_each(|node| tree.push(node));
        let known = tree.nodes().last().map_or(work.groups.start, Node::end);
        if known < work.groups.end {
            let mut places = self.works.remove(work.name).unwrap_or_default();
            places.retain(|(_, place)| !self.known.has(work, &place.header, known));
            places.sort_by_key(|(_, place)| (place.header.groups.start, place.header.groups.end));
            if places.is_empty() {
                self.not_begun(work.name);
                return Ok(None);
            }
            if !self.are_complete(work, known, &places)? {
                return Ok(None);
            }
            for (_, place) in &places {
                let nodes = place.entry()?.nodes(&place.path, work)?;
                nodes.into_iter().for_each(|node| tree.push(node));
            }
        }
        let mut header = work.header(work.groups.clone());
        header.done = header.groups.end;
        let nodes = tree.into_nodes();
        self.known.0.works.insert(work.name.to_owned(), Entry::new(header, &nodes, work)?);
        Ok(Some(nodes))
    }
}

impl Merging {
    /// No part has begun a piece of work: its paths follow from those that are merged now, or all
    /// parts are missing that have no file.
    fn not_begun(&mut self, work: &str) {
        let of = self.of();
        let exists = |number| self.parts.iter().any(|part| part.number() == number);
        let missing: Vec<u64> = (1..=of).filter(|&number| !exists(number)).collect();
        if missing.is_empty() {
            self.next_round.get_or_insert_with(|| work.to_owned());
        }
        self.missing.extend(missing);
    }

    /// Whether the files have all groups from group `known` on. Remembers which parts have not.
    fn are_complete<T>(
        &mut self,
        work: &Work<'_, T>,
        known: u64,
        places: &[(Share, Place)],
    ) -> Result<bool, JobError> {
        let (share, first) = &places[0];
        let (mut before, mut next, mut all) = (first, known, true);
        let mut complete = BTreeSet::new();
        for (part, place) in places {
            let (path, header) = (&place.path, &place.header);
            work.check(path, header)?;
            if header.paths != work.paths {
                let (found, here) = (header.paths, work.paths);
                return Err(foreign(path, work.name, "a number of paths", found, here));
            }
            if part.of() != share.of() {
                let (found, here) = (part.of(), share.of());
                return Err(foreign(path, work.name, "a number of parts", found, here));
            }
            if header.groups.is_empty() {
                complete.insert(part.number());
                continue;
            }
            all &= header.groups.start <= next && header.is_complete();
            if header.groups.start < next {
                let (first, second) = (before.path.clone(), path.clone());
                let (from, to) = (header.groups.start * GROUP_PATHS, next * GROUP_PATHS - 1);
                let work = work.name.to_owned();
                return Err(JobError::Overlap { first, second, work, from, to });
            }
            if header.is_complete() {
                complete.insert(part.number());
            }
            (before, next) = (place, header.groups.end);
        }
        if all && next == work.groups.end {
            return Ok(true);
        }
        // Which parts would have had the groups that are missing; where the parts were divided by
        // another plan, all that are not complete.
        let groups = known..work.groups.end;
        let wanted = |number: &u64| {
            Share::new(*number, share.of())
                .is_ok_and(|part| !self.shares.range(work.name, part, &groups).is_empty())
        };
        let others = (1..=share.of()).filter(|number| !complete.contains(number));
        let others: Vec<u64> = others.collect();
        let missing: Vec<u64> = others.iter().copied().filter(wanted).collect();
        self.missing.extend(if missing.is_empty() { others } else { missing });
        Ok(false)
    }
}

/// The files of parts in a folder, sorted by name.
fn part_files(folder: &Path) -> Result<Vec<PathBuf>, JobError> {
    let entries = fs::read_dir(folder).map_err(file_error("read", folder))?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.map_err(file_error("read", folder))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("part-") && name.ends_with(".json") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}
