//! Parallel work on numbered items.

use std::{
    collections::BTreeMap,
    ops::Range,
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use rayon::prelude::*;

use crate::tree::{MergeTree, Node};

/// Most items per thread in a wave, enough that no thread waits long at its end.
const PER_THREAD: u64 = 8;
/// Waves of quick items grow up to this time; a wave of slow ones has one item per thread, so that
/// little is lost when it is interrupted.
const LONG: Duration = Duration::from_secs(2);

/// Adds the results for some items to a tree, in waves. `compute` gives `None` when it is stopped.
/// `after` sees the tree and the next item after each wave, and says whether to go on. Returns the
/// first item without result.
pub fn grow<T: Send, F: Fn(&mut T, T)>(
    tree: &mut MergeTree<T, F>,
    items: Range<u64>,
    compute: &(dyn Fn(u64) -> Option<T> + Sync),
    after: &mut dyn FnMut(&[Node<T>], u64) -> bool,
) -> u64 {
    let threads = rayon::current_num_threads() as u64;
    let (mut next, mut wave) = (items.start, threads);
    while next < items.end {
        let start = Instant::now();
        let end = items.end.min(next + wave);
        let results = in_parallel(next..end, compute);
        for sum in results.into_iter().map_while(|result| result) {
            tree.push(Node::leaf(next, sum));
            next += 1;
        }
        if !after(tree.nodes(), next) || next < end {
            break;
        }
        let elapsed = start.elapsed();
        if elapsed > LONG {
            wave = threads;
        } else if 2 * elapsed < LONG {
            wave = (2 * wave).min(threads * PER_THREAD);
        }
    }
    next
}

/// The results of `work` for all items in their order, computed on the current rayon pool.
///
/// Rayon's code does not depend on the type of the results. So it is compiled once, and not for
/// every statistic in every crate that runs a ladder.
fn in_parallel<R: Send>(items: Range<u64>, work: &(dyn Fn(u64) -> R + Sync)) -> Vec<R> {
    let results = Mutex::new(BTreeMap::new());
    for_each(items, &|item| {
        let result = work(item);
        results.lock().unwrap_or_else(PoisonError::into_inner).insert(item, result);
    });
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_values().collect()
}

fn for_each(items: Range<u64>, work: &(dyn Fn(u64) + Sync)) {
    items.into_par_iter().for_each(work);
}

#[cfg(test)]
mod tests {
    use super::in_parallel;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let squares = in_parallel(3..1000, &|item| item * item);
        assert_eq!(squares, (3..1000).map(|item| item * item).collect::<Vec<_>>());
        assert!(in_parallel(5..5, &|item| item).is_empty());
    }
}
