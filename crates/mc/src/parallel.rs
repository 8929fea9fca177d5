//! Parallel work on numbered items.

use std::{
    collections::BTreeMap,
    ops::Range,
    sync::{Mutex, PoisonError},
};

use rayon::prelude::*;

/// The results of `work` for all items in their order, computed on the current rayon pool.
///
/// Rayon's code does not depend on the type of the results. So it is compiled once, and not for
/// every statistic in every crate that runs a ladder.
pub fn in_parallel<R: Send>(items: Range<u64>, work: &(dyn Fn(u64) -> R + Sync)) -> Vec<R> {
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
