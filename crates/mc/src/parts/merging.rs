//! Merging the parts in a folder.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use super::{
    JobError, Program, Share,
    work::{Header, PartFile, Work, differs},
};
use crate::{Kept, checkpoint::file_error, ladder::Nodes, tree::Node};

/// The file `merged.bin` with the nodes that were merged before.
impl PartFile {
    pub fn merged(folder: &Path, program: &Program) -> Result<Self, JobError> {
        Self::open(folder.join("merged.bin"), program, None)
    }

    /// The merged nodes of a piece of work, from the first group on: all of them, or fewer if there
    /// are more paths now.
    pub fn nodes<T: Kept>(&self, work: &Work<'_, T>) -> Result<Nodes<T>, JobError> {
        let path = self.kept.file();
        let Some(entry) = self.works.get(work.name) else { return Ok(Vec::new()) };
        work.check(path, &entry.header)?;
        if entry.header.paths > work.paths {
            return Err(work.other_paths(path, &entry.header));
        }
        let mut nodes = work.nodes(path, entry)?;
        nodes.retain(|node| node.end() <= entry.header.whole(work.paths));
        Ok(nodes)
    }

    /// Whether the groups of a part are no longer needed, where those before `known` are merged:
    /// they are merged, maybe in a study of fewer paths that was merged and extended since.
    pub fn has<T>(&self, work: &Work<'_, T>, part: &Header, known: u64) -> bool {
        let merged = self.works.get(work.name).map_or(0, |entry| entry.header.paths);
        part.groups.end <= known || (part.paths < work.paths && part.paths <= merged)
    }
}

/// The number of paths of each piece of work that was merged in a folder.
///
/// # Errors
/// [`JobError`] if the file cannot be read, is damaged or is of another program.
pub fn merged_paths(folder: &Path, program: &Program) -> Result<BTreeMap<String, u64>, JobError> {
    let works = PartFile::merged(folder, program)?.works.into_iter();
    Ok(works.map(|(name, entry)| (name, entry.header.paths)).collect())
}

/// The groups that a part has of a piece of work. The sums stay in its file.
struct Place {
    path: PathBuf,
    part: Share,
    header: Header,
}

/// The parts in a folder, by piece of work.
pub struct Merging {
    works: BTreeMap<String, Vec<Place>>,
    /// Largest number of parts that a file says.
    of: u64,
    program: Program,
    known: PartFile,
    missing: BTreeSet<u64>,
}

impl Merging {
    pub fn open(folder: &Path, program: &Program) -> Result<Self, JobError> {
        let known = PartFile::merged(folder, program)?;
        let (mut works, mut of) = (BTreeMap::<String, Vec<_>>::new(), 0);
        for entry in fs::read_dir(folder).map_err(file_error("read", folder))? {
            let path = entry.map_err(file_error("read", folder))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if !(name.starts_with("part-") && name.ends_with(".bin")) {
                continue;
            }
            let file = PartFile::open(path.clone(), program, None)?;
            let Some(part) = file.part else { continue };
            of = of.max(part.of);
            for (name, entry) in file.works {
                let place = Place { path: path.clone(), part, header: entry.header };
                works.entry(name).or_default().push(place);
            }
        }
        if of == 0 && known.works.is_empty() {
            let text = format!("there are no parts in {}", folder.display());
            return Err(JobError::Refused(text));
        }
        Ok(Self { works, of, program: program.clone(), known, missing: BTreeSet::new() })
    }

    pub fn finish(self) -> Result<(), JobError> {
        if self.missing.is_empty() {
            self.known.write()
        } else {
            Err(JobError::Missing { parts: self.missing.into_iter().collect() })
        }
    }

    /// The nodes of all groups, if the parts have them.
    pub fn collect<T: Kept>(&mut self, work: &Work<'_, T>) -> Result<Option<Nodes<T>>, JobError> {
        let mut tree = work.tree();
        tree.extend(self.known.nodes(work)?);
        let known = tree.nodes.last().map_or(0, Node::end);
        if known < work.groups() {
            let mut places = self.works.remove(work.name).unwrap_or_default();
            places.retain(|place| !self.known.has(work, &place.header, known));
            places.sort_by_key(|Place { header: Header { groups, .. }, path, .. }| {
                (groups.start, groups.end, path.clone())
            });
            if !self.are_complete(work, known, &places)? {
                return Ok(None);
            }
            for Place { path, header, .. } in places {
                let file = PartFile::open(path.clone(), &self.program, None)?;
                let entry = file.works.get(work.name).filter(|entry| entry.header == header);
                let replaced = || {
                    let file = path.display();
                    let text = format!("{file} was replaced while it was merged: merge again");
                    JobError::Refused(text)
                };
                let entry = entry.ok_or_else(replaced)?;
                tree.extend(work.nodes(&path, entry)?);
            }
        }
        let (header, nodes) = (work.header(0..work.groups(), work.groups()), tree.nodes);
        self.known.works.insert(work.name.to_owned(), work.entry(header, &nodes)?);
        Ok(Some(nodes))
    }

    /// Whether the files have all groups from group `known` on. Records the parts that lack some,
    /// and refuses if no part does, since then an earlier merge is lost.
    fn are_complete<T: Kept>(
        &mut self,
        work: &Work<'_, T>,
        known: u64,
        places: &[Place],
    ) -> Result<bool, JobError> {
        let of = places.first().map_or(self.of.max(1), |place| place.part.of);
        let (mut before, mut next, mut all, mut complete) = (None, known, true, BTreeSet::new());
        for place in places {
            let Place { path, part, header } = place;
            work.check(path, header)?;
            if header.paths != work.paths {
                let (other, lost) = (work.other_paths(path, header), self.lost(work.name));
                return Err(if header.paths < work.paths {
                    JobError::Refused(format!("{other}. Or it was extended: {lost}"))
                } else {
                    other
                });
            }
            if part.of != of {
                return Err(differs(path, work.name, "a number of parts", part.of, of));
            }
            if header.is_complete() {
                complete.insert(part.number);
            }
            if header.groups.is_empty() {
                continue;
            }
            if header.groups.start < next {
                let (one, other) = (before.unwrap_or(path).display(), path.display());
                let text =
                    format!("{one} and {other} both have paths of {}: delete one", work.name);
                return Err(JobError::Refused(text));
            }
            all &= header.groups.start == next && header.is_complete();
            (before, next) = (Some(path), header.groups.end);
        }
        if all && next == work.groups() {
            return Ok(true);
        }
        // Those parts that would have had groups, and are not complete.
        let groups = known..work.groups();
        let (some, none): (Vec<u64>, Vec<u64>) = (1..=of)
            .filter(|number| !complete.contains(number))
            .partition(|&number| !Share { number, of }.range(&groups).is_empty());
        let parts = if some.is_empty() { none } else { some };
        if parts.is_empty() {
            return Err(self.lost(work.name));
        }
        self.missing.extend(parts);
        Ok(false)
    }

    /// Error of a file of merged nodes that lacks paths of `work` which were merged before.
    fn lost(&self, work: &str) -> JobError {
        JobError::Refused(format!(
            "{} lacks paths of {work} that were merged before: put it back, or delete part-*.bin \
             and run all parts again",
            self.known.kept.file().display()
        ))
    }
}
