//! Part k of n, and why a job does not come to its end.

use std::{fmt, io, ops::Range, path::PathBuf};

use serde::{Deserialize, Serialize};

/// Part `number` of `of` parts, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    pub(super) number: u64,
    pub(super) of: u64,
}

impl Share {
    /// All work as one part.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Part `number` of `of`.
    ///
    /// # Errors
    /// [`JobError::Argument`] unless 1 ≤ `number` ≤ `of`.
    pub fn new(number: u64, of: u64) -> Result<Self, JobError> {
        let exists = (1..=of).contains(&number);
        exists.then_some(Self { number, of }).ok_or_else(|| {
            let why = format!("there is no part {number} of {of}: parts are numbered from 1");
            JobError::Argument(why)
        })
    }

    /// Items of a range that this part has: ⌊(k − 1)L/n⌋ to ⌊kL/n⌋ of L items. The parts cover all,
    /// and their lengths differ by at most one.
    pub(super) fn range(self, all: &Range<u64>) -> Range<u64> {
        let length = u128::from(all.end - all.start);
        let at = |k: u64| all.start + (u128::from(k) * length / u128::from(self.of)) as u64;
        at(self.number - 1)..at(self.number)
    }

    /// Name of the file of the part, whose number has leading zeros, so that names sort.
    pub fn file_name(self) -> String {
        let digits = self.of.to_string().len();
        format!("part-{:0digits$}-of-{}.bin", self.number, self.of)
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "part {} of {}", self.number, self.of)
    }
}

/// Numbers as an array specification of Slurm: "1-3,7".
pub fn array(numbers: &[u64]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b).map(|run| match run {
        [first, .., last] => format!("{first}-{last}"),
        run => run[0].to_string(),
    });
    runs.collect::<Vec<_>>().join(",")
}

/// Reason why a job did not come to its end. No such error loses what was in its folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// An invalid part, argument of a command line or number of threads. The text says which are
    /// possible.
    #[error("{0}")]
    Argument(String),
    /// A file or folder cannot be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    File {
        /// "read", "write", …
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A folder whose content cannot be used: a file is damaged, belongs to another study or is
    /// being computed by another process; or sums that cannot be written and read back. The text
    /// names file and work, and says what to do.
    #[error("{0}")]
    Refused(String),
    /// Parts are missing or have not come to their end.
    #[error("missing or incomplete: run these parts again: --array={}", array(parts))]
    Missing {
        /// Numbers of the parts.
        parts: Vec<u64>,
    },
    /// The computation was stopped. A checkpoint is written if the job has a folder.
    #[error("stopped; where there is a folder, the same command goes on from the checkpoint")]
    Stopped,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_a_range_once_and_evenly() {
        for (first, items) in [(0, 0), (0, 1), (5, 6), (0, 63), (128, 1000), (7, 7813)] {
            for of in [1, 2, 7, 64, 1000] {
                let mut end = first;
                for number in 1..=of {
                    let range = Share::new(number, of).unwrap().range(&(first..first + items));
                    assert_eq!(range.start, end);
                    let length = range.end - range.start;
                    assert!(length == items / of || length == items.div_ceil(of));
                    end = range.end;
                }
                assert_eq!(end, first + items);
            }
        }
    }

    #[test]
    fn numbers_become_an_array_specification() {
        assert_eq!(array(&[3]), "3");
        assert_eq!(array(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
    }

    #[test]
    fn names_of_files_sort_like_their_numbers() {
        let mut names: Vec<String> =
            (1..=120).map(|k| Share::new(k, 120).unwrap().file_name()).collect();
        let in_order = names.clone();
        names.sort();
        assert_eq!(names, in_order);
        assert_eq!(names[2], "part-003-of-120.bin");
    }
}
