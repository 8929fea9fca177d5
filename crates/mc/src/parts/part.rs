//! One part of all work, with checkpoints.

use std::{
    fs, io,
    ops::Range,
    path::{Path, PathBuf},
};

use super::{
    JobError, Program, Share,
    lock::Lock,
    work::{Header, PartFile, Work, differs},
};
use crate::{
    Kept,
    checkpoint::file_error,
    files::tidy,
    ladder::{Nodes, Sum, driver::GROUP_PATHS},
    tree::{MergeTree, Node},
};

/// Path of the lock of a part.
fn lock_of(folder: &Path, share: Share) -> PathBuf {
    folder.join(format!(".lock.{}", share.file_name()))
}

/// Prefix of files with unfinished work that is not of groups.
pub const UNFINISHED: &str = "unfinished-";

/// Files with unfinished work that is not of groups.
fn unfinished(folder: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .filter(|file| file.file_name().to_string_lossy().starts_with(UNFINISHED))
        .map(|file| file.path())
}

/// Removes the file of a part, or its checkpoint, if there is one.
///
/// # Errors
/// [`JobError::File`] if the file exists and cannot be removed.
pub fn remove(folder: &Path, share: Share) -> Result<(), JobError> {
    let own = [folder.join(share.file_name()), lock_of(folder, share)];
    for file in own.into_iter().chain(unfinished(folder)) {
        match fs::remove_file(&file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(file_error("remove", &file)(error));
            }
            _ => {}
        }
    }
    Ok(())
}

/// A part with its file.
pub struct Part {
    share: Share,
    pub file: PartFile,
    /// Whether the file has work of an earlier run.
    pub resumes: bool,
    /// The nodes that were merged before.
    known: PartFile,
    _lock: Lock,
}

impl Part {
    pub fn open(folder: &Path, share: Share, program: &Program) -> Result<Self, JobError> {
        let (path, lock) = (folder.join(share.file_name()), lock_of(folder, share));
        let lock = Lock::take(&lock).map_err(file_error("write", &lock))?.map_err(|holder| {
            JobError::Refused(format!(
                "{share} in {} is being computed by {holder}; wait for its end, or stop it",
                folder.display()
            ))
        })?;
        if lock.is_sole {
            tidy(&path);
        }
        let file = PartFile::open(path, program, Some(share))?;
        // A folder that cannot be written is found now and not after hours.
        file.write()?;
        let known = PartFile::merged(folder, program)?;
        let resumes = !file.works.is_empty() || unfinished(folder).next().is_some();
        Ok(Self { share, file, resumes, known, _lock: lock })
    }

    /// Whether this part is all of the work.
    pub fn is_whole(&self) -> bool {
        self.share == Share::WHOLE
    }

    /// Computes this part of a piece of work. Returns the nodes of all groups if they were merged
    /// before, or if this part is the whole; those that are done if it is stopped and `incomplete`.
    pub fn collect<T: Kept>(
        &mut self,
        work: &Work<'_, T>,
        incomplete: bool,
    ) -> Result<Option<Nodes<T>>, JobError> {
        let is_whole = self.is_whole();
        let mut nodes = self.known.nodes(work)?;
        let (first, mut tree) = (nodes.last().map_or(0, Node::end), work.tree());
        let groups = self.share.range(&(first..work.groups()));
        let mut header = work.header(groups.clone(), groups.start);
        header.done = self.resume(work, first, &groups, &mut tree)?;
        // Reports the steps of groups that need not be computed.
        let before = first + header.done - groups.start;
        (work.ladder.progress)(before * GROUP_PATHS * work.ladder.steps_per_path());
        // What cannot be read back is known before the computing.
        work.entry(header.clone(), &[Node::leaf(0, work.ladder.nothing(work.new))])?;
        let mut kept = Ok(());
        let rest = header.done..groups.end;
        header.done = work.grow(&mut tree, rest, &mut |nodes, done| {
            if self.file.kept.is_due() {
                kept = self.record(work, Header { done, ..header.clone() }, nodes);
                if kept.is_ok() {
                    // A full disk may have room again at the next checkpoint; `finish` tells.
                    _ = self.file.write();
                }
            }
            kept.is_ok()
        });
        kept?;
        let stopped = !header.is_complete();
        self.record(work, header, &tree.nodes)?;
        if stopped && !(incomplete && is_whole) {
            self.file.write()?;
            return Err(JobError::Stopped);
        }
        nodes.extend(tree.nodes);
        Ok((is_whole || first == work.groups()).then_some(nodes))
    }

    /// Resumes the groups that a checkpoint has, where those before `known` are merged. Returns the
    /// first group that it lacks.
    fn resume<T: Kept>(
        &self,
        work: &Work<'_, T>,
        known: u64,
        groups: &Range<u64>,
        tree: &mut MergeTree<Sum<T>>,
    ) -> Result<u64, JobError> {
        let path = self.file.kept.file();
        let Some(entry) = self.file.works.get(work.name) else { return Ok(groups.start) };
        let found = &entry.header;
        work.check(path, found)?;
        if found.groups == *groups && found.paths == work.paths {
            tree.extend(work.nodes(path, entry)?);
            Ok(found.done)
        } else if self.known.has(work, found, known) {
            Ok(groups.start)
        } else if found.paths != work.paths {
            Err(work.other_paths(path, found))
        } else {
            let [found, here] = [&found.groups, groups].map(|groups| format!("{groups:?}"));
            Err(differs(path, work.name, "the groups", found, here))
        }
    }

    /// Puts nodes into the file in memory, without writing it.
    fn record<T: Kept>(
        &mut self,
        work: &Work<'_, T>,
        header: Header,
        nodes: &[Node<Sum<T>>],
    ) -> Result<(), JobError> {
        // The old ones make room first.
        self.file.works.remove(work.name);
        self.file.works.insert(work.name.to_owned(), work.entry(header, nodes)?);
        Ok(())
    }
}
