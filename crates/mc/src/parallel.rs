//! Parallel work on numbered items.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

/// The results of `work` for all items in their order, computed on the current rayon pool.
///
/// Rayon's code does not depend on the type of the results. So it is compiled once, and not for
/// every statistic in every crate that runs a ladder.
pub(crate) fn in_parallel<R: Send>(items: Range<u64>, work: &(dyn Fn(u64) -> R + Sync)) -> Vec<R> {
    let slots: Vec<Mutex<Option<R>>> = items.clone().map(|_| Mutex::new(None)).collect();
    let first = items.start;
    for_each(items, &|item| {
        let result = work(item);
        *slots[(item - first) as usize].lock().unwrap_or_else(PoisonError::into_inner) =
            Some(result);
    });
    slots
        .into_iter()
        .map(|slot| slot.into_inner().unwrap_or_else(PoisonError::into_inner))
        .map(|result| result.unwrap_or_else(|| unreachable!("every item has been worked on")))
        .collect()
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
