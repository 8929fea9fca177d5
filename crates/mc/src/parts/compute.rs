//! One part of all work, with checkpoints.

use std::{
    fs, io,
    ops::Range,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use super::{
    JobError, Outcome, Plan, Program, Share, atomic,
    balance::Shares,
    file::{Entry, Header, PartFile, file_error, foreign},
    job::Work,
    merging::{Known, MERGED},
};
use crate::{
    parallel::grow,
    tree::{MergeTree, Node},
};

/// Where the lock of a part is.
fn lock_of(folder: &Path, share: Share) -> PathBuf {
    folder.join(format!(".lock.{}", share.file_name()))
}

/// Removes the file of a part, or its checkpoint, if there is one.
///
/// # Errors
/// [`JobError::File`] if it is there and stays.
pub fn remove(folder: &Path, share: Share) -> Result<(), JobError> {
    for file in [folder.join(share.file_name()), lock_of(folder, share)] {
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
pub struct Computing {
    share: Share,
    file: PartFile,
    resumes: bool,
    written: Instant,
    known: Known,
    shares: Shares,
    _lock: atomic::Lock,
}

impl Computing {
    pub fn open(folder: &Path, share: Share, program: &Program) -> Result<Self, JobError> {
        let (path, lock) = (folder.join(share.file_name()), lock_of(folder, share));
        let lock = atomic::Lock::take(&lock).map_err(file_error("write", &lock))?;
        let busy = |holder| {
            let (part, folder) = (share.to_string(), folder.to_owned());
            JobError::Busy { part, folder, holder }
        };
        let lock = lock.map_err(busy)?;
        if lock.is_sole {
            atomic::tidy(&path);
        }
        let file = PartFile::open(path, program, Some(share))?;
        // A folder that cannot be written is found now and not after hours.
        file.write()?;
        let known = Known(PartFile::open(folder.join(MERGED), program, None)?);
        let resumes = !file.works.is_empty();
        Ok(Self {
            share,
            file,
            resumes,
            written: Instant::now(),
            known,
            shares: Shares::default(),
            _lock: lock,
        })
    }

    /// Divides these works so that parts have as much to do as each other.
    pub fn balance(&mut self, plan: &Plan) {
        self.shares = Shares::new(self.known.left(plan), self.share.of());
    }

    /// Whether its file has work from before.
    pub fn resumes(&self) -> bool {
        self.resumes
    }

    pub fn is_whole(&self) -> bool {
        self.share == Share::WHOLE
    }

    pub fn finish(self) -> Result<Outcome, JobError> {
        match (self.file.write(), self.is_whole()) {
            // The results are with the program already.
            (Err(error), true) => eprintln!("warning: no checkpoint: {error}"),
            (written, _) => written?,
        }
        Ok(if self.is_whole() { Outcome::Complete } else { Outcome::Part(self.share) })
    }

    /// The nodes of all groups if they were merged before, or if this part is the whole; those that
    /// are done if it is stopped and `incomplete`.
    pub fn collect<T: Send>(
        &mut self,
        work: &Work<'_, T>,
        interval: Duration,
        incomplete: bool,
    ) -> Result<Option<Vec<Node<T>>>, JobError> {
        let known = self.known.nodes(work)?;
        let first = known.last().map_or(work.groups.start, Node::end);
        let mut header =
            work.header(self.shares.range(work.name, self.share, &(first..work.groups.end)));
        let mut tree = work.tree();
        header.done = self.resume(work, first, &header, &mut tree)?;
        (work.skipped)(first - work.groups.start + header.done - header.groups.start);
        let rest = header.done..header.groups.end;
        // What cannot be read back is known before the computing.
        Entry::new(header.clone(), &[Node::leaf(header.done, (work.empty)())], work)?;
        let mut kept = Ok(());
        let done = grow(&mut tree, rest, work.compute, &mut |nodes, done| {
            if self.written.elapsed() >= interval && kept.is_ok() {
                kept = self.record(work, Header { done, ..header.clone() }, nodes);
                // A full disk may have room again when the next checkpoint is due.
                if let Err(error) = self.write() {
                    eprintln!("warning: no checkpoint: {error}");
                }
            }
            kept.is_ok()
        });
        kept?;
        let complete = done == header.groups.end;
        self.record(work, Header { done, ..header }, tree.nodes())?;
        if !complete {
            self.write()?;
            if !(incomplete && self.is_whole()) {
                return Err(JobError::Stopped);
            }
        }
        Ok((self.is_whole() || first == work.groups.end).then(|| {
            let mut nodes = known;
            nodes.extend(tree.into_nodes());
            nodes
        }))
    }

    /// Takes up what a checkpoint has of these groups, where those before `known` are merged.
    /// Returns the first group that it has not.
    fn resume<T, F: Fn(&mut T, T)>(
        &self,
        work: &Work<'_, T>,
        known: u64,
        header: &Header,
        tree: &mut MergeTree<T, F>,
    ) -> Result<u64, JobError> {
        let (path, groups) = (&self.file.path, &header.groups);
        let Some(entry) = self.file.works.get(work.name) else { return Ok(groups.start) };
        let found = &entry.header;
        work.check(path, found)?;
        if found.groups == *groups && found.paths == work.paths {
            entry.nodes(path, work)?.into_iter().for_each(|node| tree.push(node));
            return Ok(found.done);
        }
        if self.known.has(work, found, known) {
            return Ok(groups.start);
        }
        if found.paths != work.paths {
            return Err(foreign(path, work.name, "a number of paths", found.paths, work.paths));
        }
        let words = |groups: &Range<u64>| format!("{} to {}", groups.start, groups.end);
        Err(foreign(path, work.name, "the groups", words(&found.groups), words(groups)))
    }

    /// Puts nodes into the file, in memory.
    fn record<T>(
        &mut self,
        work: &Work<'_, T>,
        header: Header,
        nodes: &[Node<T>],
    ) -> Result<(), JobError> {
        self.file.works.insert(work.name.to_owned(), Entry::new(header, nodes, work)?);
        Ok(())
    }

    fn write(&mut self) -> Result<(), JobError> {
        // After a failure, too: a disk that is full is not asked again after every wave.
        self.written = Instant::now();
        self.file.write()
    }
}
