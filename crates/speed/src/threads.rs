//! The same work on one thread, two, four and so on, and on all processors.

use std::thread::available_parallelism;

use lab::Compiled;
use mc::Run;
use schemes::Sexp;
use systems::{Problem, RigidBody};

use crate::rows::{ladder, pool, run_once};
use crate::stopwatch::repeat;
use crate::systems_list::{momentum, rigid_body};
use crate::{SpeedError, ThreadRow, Workload};

/// Powers of two below the number of processors, and that number.
fn counts(processors: usize) -> Vec<usize> {
    let mut counts: Vec<usize> = (0..usize::BITS)
        .map(|k| 1 << k)
        .take_while(|&threads: &usize| threads < processors)
        .collect();
    counts.push(processors);
    counts
}

pub(crate) fn rows(
    workload: &Workload,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<ThreadRow>, SpeedError> {
    let (body, damping) = rigid_body()?;
    let problem = Problem::new(body, damping, momentum(), workload.t_end())?;
    let sexp = RigidBody::<3>::sexp(Sexp::default());
    let ladder = ladder(&problem, workload.steps, 0, vec![Run::new(sexp.as_ref(), 0)])?;
    let mut rows: Vec<ThreadRow> = Vec::new();
    for threads in counts(available_parallelism().map_or(1, usize::from)) {
        progress(&format!("{threads} threads"));
        let pool = pool(threads)?;
        let times = pool.install(|| {
            repeat(workload.repetitions, || {
                run_once(&ladder, workload.paths);
            })
        });
        let first = rows.first().map_or(times.wall.best, |row| row.seconds.best);
        rows.push(ThreadRow { threads, seconds: times.wall, speedup: first / times.wall.best });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::counts;

    #[test]
    fn all_processors_come_last_and_once() {
        assert_eq!(counts(1), [1]);
        assert_eq!(counts(2), [1, 2]);
        assert_eq!(counts(6), [1, 2, 4, 6]);
        assert_eq!(counts(8), [1, 2, 4, 8]);
    }
}
