//! **One study on many machines: parts, checkpoints, merging.**
//!
//! A [`Job`] says what a program does with its Monte Carlo: all of it here, a part of it, or merge
//! the parts that others computed. The program itself stays as it is:
//!
//! ```
//! use mc::{Kept, Ladder, Run, Statistic, View, bind, parts::{Job, Program, Share}};
//! # use noise::{StreamKey, Truncation};
//! # use schemes::Sexp;
//! # use systems::{Constant, Pendulum, Problem};
//! # #[derive(Default, serde::Serialize, serde::Deserialize)]
//! # struct Momentum { sum: f64 }
//! # impl Statistic for Momentum {
//! #     fn observe(&mut self, view: &View<'_>) {
//! #         self.sum += view.live.paths().map(|p| view.state(0)[1][p]).sum::<f64>();
//! #     }
//! #     fn merge(&mut self, later: Self) { self.sum += later.sum; }
//! # }
//! # let folder = tempfile::tempdir()?;
//! # let folder = folder.path();
//! # let program = || Program { name: "momentum".into(), ..Program::default() };
//! # let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 1.0)?;
//! # let key = StreamKey { seed: 1, experiment: 1 };
//! // A statistic of which everything is kept.
//! impl Kept for Momentum {
//!     type Sums = Self;
//!     fn sums(&self) -> &Self { self }
//!     fn sums_mut(&mut self) -> &mut Self { self }
//! }
//! let runs = vec![Run::new(bind(&problem, &Sexp), 0)];
//! let on = mc::Problem::of(&problem);
//! let ladder = Ladder::new(&on, 64, 6, Truncation::new(4)?, key, runs)?;
//! let study = |job: Job| {
//!     let measured = ladder.run_in(&job, "momentum", 4096, Momentum::default);
//!     let mean = measured.map(|measured| measured.statistic.sum / 4096.0);
//!     job.finish().map(|_| mean)
//! };
//! // Three tasks, on any machines, in any order, and then one that merges.
//! for number in [2, 3, 1] {
//!     study(Job::part(folder, Share::new(number, 3)?, program())?)?;
//! }
//! let merged = study(Job::merge(folder, program())?)?;
//! assert_eq!(merged, study(Job::here())?); // to the bit
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Statistics are merged on a fixed binary tree over groups of 128 paths. A part has a range of
//! groups and writes the largest subtrees of the tree within it, at most 2 log₂G of them. Whoever
//! merges completes the tree: the same bits in any number of parts. A last group that is not full
//! stays apart in the files: it alone is computed again when there are to be more paths.
//!
//! | file in the folder | content |
//! |---|---|
//! | `part-03-of-64.bin` | the nodes of a part; while it runs, its checkpoint |
//! | `merged.bin` | the nodes of all works that were merged, for extensions |

mod job;
mod lock;
mod merging;
mod part;
mod share;
mod work;

pub use job::{Job, Planned, Stop, limit_threads};
pub use merging::merged_paths;
pub use part::remove;
pub use share::{JobError, Share};

pub use crate::checkpoint::{Program, hash};
pub(crate) use work::Work;
