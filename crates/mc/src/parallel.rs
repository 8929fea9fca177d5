//! Parallel work on numbered items.

use std::{
    collections::BTreeMap,
    mem,
    ops::Range,
    sync::{Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use rayon::prelude::*;

use crate::tree::{MergeTree, Node};

/// Largest number of tasks per thread in a wave, enough that no thread waits long at its end.
const TASKS: u64 = 8;
/// Seconds that a wave of single items, `TASKS` per thread, may take: no more is lost when it is
/// interrupted.
const LONG_S: f64 = 1.0;
/// Seconds that a wave of quicker items is to take: they are gathered into tasks, so that threads
/// seldom wait for each other.
const SHORT_S: f64 = 0.05;
/// Largest factor by which a wave grows.
const GROWTH: u64 = 16;

/// Adds the results for some items to a tree, in waves of tasks on the current rayon pool.
/// `compute` gives `None` when it is stopped. `after` sees the tree and the next item after each
/// wave, and says whether to go on. Returns the first item without result.
///
/// A task is a run of items, which it merges. The first wave has one item for each thread, so that
/// little is lost when slow ones are interrupted.
pub fn grow<T: Send>(
    tree: &mut MergeTree<T>,
    items: Range<u64>,
    compute: &(dyn Fn(u64) -> Option<T> + Sync),
    after: &mut dyn FnMut(&[Node<T>], u64) -> bool,
) -> u64 {
    let threads = rayon::current_num_threads() as u64;
    let (mut next, mut wave) = (items.start, threads);
    while next < items.end {
        let start = Instant::now();
        let end = items.end.min(next + wave);
        // A power of two, and tasks that begin at multiples of it: each is a node of the tree.
        let size = wave.div_ceil(TASKS * threads).next_power_of_two();
        let (merge, whole) = (tree.merge, tree.whole);
        let task = |number: u64| {
            let mut own = MergeTree::of_whole(merge, whole);
            for item in next.max(number * size)..end.min((number + 1) * size) {
                let Some(sum) = compute(item) else { break };
                own.push(Node::leaf(item, sum));
            }
            own.nodes
        };
        let results = in_parallel(next / size..end.div_ceil(size), &task);
        for node in results.into_iter().flatten() {
            // Those after a task that was stopped are lost.
            if node.first == next {
                next = node.end();
                tree.push(node);
            }
        }
        if !after(&tree.nodes, next) || next < end {
            break;
        }
        let per_second = wave as f64 / start.elapsed().as_secs_f64();
        let items_in = |seconds: f64| (seconds * per_second) as u64;
        let single = items_in(LONG_S).min(TASKS * threads);
        wave = single.max(items_in(SHORT_S)).clamp(threads, GROWTH * wave);
    }
    next
}

/// The results of `work` for all items in their order, computed on the current rayon pool.
///
/// Rayon's code does not depend on the type of the results. So it is compiled once, and not for
/// every statistic in every crate that runs a ladder.
pub fn in_parallel<R: Send>(items: Range<u64>, work: &(dyn Fn(u64) -> R + Sync)) -> Vec<R> {
    let results = Mutex::new(BTreeMap::new());
    for_each(items, &|item| {
        let result = work(item);
        locked(&results).insert(item, result);
    });
    mem::take(&mut *locked(&results)).into_values().collect()
}

/// The content of a mutex, also after a panic of a thread that had it.
pub fn locked<T>(content: &Mutex<T>) -> MutexGuard<'_, T> {
    content.lock().unwrap_or_else(PoisonError::into_inner)
}

fn for_each(items: Range<u64>, work: &(dyn Fn(u64) + Sync)) {
    items.into_par_iter().for_each(work);
}

#[cfg(test)]
mod tests {
    use super::{MergeTree, Node, grow, in_parallel};

    fn join(left: &mut String, right: String) {
        *left = format!("({left}{right})");
    }

    #[test]
    fn tasks_of_quick_items_make_the_tree_of_single_ones() {
        // Enough of them that waves grow to tasks of many items.
        for items in [3..4, 0..1000, 517..20_000] {
            let (mut single, mut grown) = (MergeTree::new(join), MergeTree::new(join));
            items.clone().for_each(|item| single.push(Node::leaf(item, item.to_string())));
            let compute = |item: u64| Some(item.to_string());
            let next = grow(&mut grown, items.clone(), &compute, &mut |_, _| true);
            assert_eq!(next, items.end);
            assert!(grown.nodes == single.nodes);
        }
    }

    #[test]
    fn items_after_one_that_was_stopped_are_lost() {
        for first in [0, 1, 100, 4321] {
            let compute = |item: u64| (item < first || item > first + 3).then(|| item.to_string());
            let (mut tree, mut single) = (MergeTree::new(join), MergeTree::new(join));
            assert_eq!(grow(&mut tree, 0..10_000, &compute, &mut |_, _| true), first);
            (0..first).for_each(|item| single.push(Node::leaf(item, item.to_string())));
            assert!(tree.nodes == single.nodes);
        }
    }

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let squares = in_parallel(3..1000, &|item| item * item);
        assert_eq!(squares, (3..1000).map(|item| item * item).collect::<Vec<_>>());
        assert!(in_parallel(5..5, &|item| item).is_empty());
    }
}
