//! Parts of equal work, not of equal numbers of groups.
//!
//! A work with four groups gives nothing to sixty of 64 parts, and many such works would all give
//! to the same four. So works are divided together: those with the longest groups first, each over
//! the parts that have least so far. Works with short groups fill up what is left.

use std::{collections::BTreeMap, ops::Range};

use super::Share;

/// Groups of a work that are still to be computed, and the path-steps of each.
#[derive(Clone, Debug)]
pub struct Load {
    pub name: String,
    pub groups: Range<u64>,
    pub steps: u64,
}

/// Which groups of each work the parts have.
#[derive(Clone, Debug, Default)]
pub struct Shares {
    /// By work, the end of what each part has. Other works are divided evenly.
    ends: BTreeMap<String, Vec<u64>>,
}

impl Shares {
    /// Divides these works among `of` parts.
    pub fn new(mut works: Vec<Load>, of: u64) -> Self {
        works.retain(|work| work.steps > 0 && !work.groups.is_empty());
        works.sort_by(|a, b| (b.steps, &a.name).cmp(&(a.steps, &b.name)));
        let mut loads = vec![0; of as usize];
        let mut ends = BTreeMap::new();
        for Load { name, groups, steps } in works {
            let counts = level(&loads, u128::from(groups.end - groups.start), u128::from(steps));
            let mut end = groups.start;
            let ends_of = counts.iter().zip(&mut loads).map(|(count, load)| {
                *load += count * u128::from(steps);
                end += *count as u64;
                end
            });
            ends.insert(name, ends_of.collect());
        }
        Self { ends }
    }

    /// What a part has of these groups of a work.
    pub fn range(&self, name: &str, share: Share, groups: &Range<u64>) -> Range<u64> {
        let Some(ends) = self.ends.get(name).filter(|ends| ends.last() == Some(&groups.end)) else {
            return share.range(groups);
        };
        let number = share.number() as usize;
        let start = if number == 1 { groups.start } else { ends[number - 2] };
        start..ends[number - 1]
    }
}

/// How many of `groups` with so many `steps` each part gets, so that the largest load becomes as
/// small as it can be.
fn level(loads: &[u128], groups: u128, steps: u128) -> Vec<u128> {
    let room = |level: u128| loads.iter().map(move |load| level.saturating_sub(*load) / steps);
    let least = loads.iter().copied().min().unwrap_or(0);
    // The smallest level with enough room.
    let (mut low, mut high) = (least, least + groups * steps);
    while low < high {
        let middle = low + (high - low) / 2;
        if room(middle).sum::<u128>() < groups { low = middle + 1 } else { high = middle }
    }
    let mut counts: Vec<u128> = room(high).collect();
    // Too many are those that reach the level itself.
    let mut surplus = counts.iter().sum::<u128>() - groups;
    for (count, load) in counts.iter_mut().zip(loads).rev() {
        if surplus > 0 && *count > 0 && load + *count * steps == high {
            *count -= 1;
            surplus -= 1;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn works_of_all_sizes_are_levelled() {
        let load = |name: &str, groups: u64, steps: u64| Load {
            name: name.into(),
            groups: 0..groups,
            steps,
        };
        let works = vec![
            load("fine", 3907, 5),
            load("few", 4, 900),
            load("more", 70, 300),
            load("c", 9, 7),
        ];
        let total: u64 = works.iter().map(|work| work.groups.end * work.steps).sum();
        for of in [1, 2, 7, 64] {
            let shares = Shares::new(works.clone(), of);
            let mut most = 0;
            let mut ends = vec![0; works.len()];
            for number in 1..=of {
                let share = Share::new(number, of).unwrap();
                let mut steps = 0;
                for (work, end) in works.iter().zip(&mut ends) {
                    let range = shares.range(&work.name, share, &work.groups);
                    assert_eq!(range.start, *end);
                    *end = range.end;
                    steps += (range.end - range.start) * work.steps;
                }
                most = most.max(steps);
            }
            assert_eq!(ends, works.iter().map(|work| work.groups.end).collect::<Vec<_>>());
            // No part has more than the mean by more than a short group, but for long ones.
            let mean = total.div_ceil(of);
            assert!(most <= (mean + 5).max(900), "{most} {mean} {of}");
        }
    }

    #[test]
    fn what_is_not_known_is_divided_evenly() {
        let shares = Shares::new(Vec::new(), 3);
        assert_eq!(shares.range("any", Share::new(2, 3).unwrap(), &(10..16)), 12..14);
    }
}
