//! Sums on a fixed binary tree.

/// The sum over the 2^level leaves from leaf number `first` on, where 2^level divides `first`.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Node<T> {
    /// Number of the first leaf.
    pub first: u64,
    /// Binary logarithm of the number of leaves.
    pub level: u32,
    /// Sum over the leaves.
    pub sum: T,
}

impl<T> Node<T> {
    /// A single leaf.
    pub fn leaf(first: u64, sum: T) -> Self {
        Self { first, level: 0, sum }
    }

    /// Number of the leaf after the last one.
    pub fn end(&self) -> u64 {
        self.first + (1 << self.level)
    }

    /// Whether `later` is the right half of a node of which this is the left half.
    fn precedes<U>(&self, later: &Node<U>) -> bool {
        self.level == later.level
            && self.end() == later.first
            && self.first.is_multiple_of(2 << self.level)
    }
}

/// Merges nodes in the order of their leaves: two halves of a node of the tree, as soon as both are
/// there, like carries in a binary counter.
///
/// The tree depends on the number of leaves alone. So the bits depend neither on the thread or time
/// of computation nor on how leaves were gathered into nodes before. Depth, memory and round-off
/// are logarithmic.
pub struct MergeTree<T> {
    /// The largest nodes of the tree that cover the leaves so far.
    pub nodes: Vec<Node<T>>,
    /// Function that merges the second sum into the first.
    pub merge: fn(&mut T, T),
    /// Number of the first leaf that is not part of larger nodes, as those after it.
    pub whole: u64,
}

impl<T> MergeTree<T> {
    pub fn new(merge: fn(&mut T, T)) -> Self {
        Self::of_whole(merge, u64::MAX)
    }

    /// A tree that merges leaf number `whole` and those after it in [`finish`](Self::finish) only,
    /// so that they can be replaced until then. If it is the last one, the bits are the same.
    pub fn of_whole(merge: fn(&mut T, T), whole: u64) -> Self {
        Self { nodes: Vec::new(), merge, whole }
    }

    /// Adds a node that begins where the last one ends.
    pub fn push(&mut self, mut node: Node<T>) {
        let joins =
            |left: &Node<T>, node: &Node<T>| node.end() <= self.whole && left.precedes(node);
        while let Some(mut left) = self.nodes.pop_if(|left| joins(left, &node)) {
            (self.merge)(&mut left.sum, node.sum);
            node = Node { level: left.level + 1, ..left };
        }
        self.nodes.push(node);
    }

    /// Adds nodes in their order.
    pub fn extend(&mut self, nodes: impl IntoIterator<Item = Node<T>>) {
        nodes.into_iter().for_each(|node| self.push(node));
    }

    /// The sum of all leaves, which begin with leaf 0; `None` without leaves.
    pub fn finish(self) -> Option<T> {
        let sums = self.nodes.into_iter().rev().map(|node| node.sum);
        sums.reduce(|later, mut sum| {
            (self.merge)(&mut sum, later);
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::*;

    fn join(left: &mut String, right: String) {
        *left = format!("({left}{right})");
    }

    fn nodes(leaves: Range<u64>) -> Vec<Node<String>> {
        let mut tree = MergeTree::new(join);
        leaves.for_each(|leaf| tree.push(Node::leaf(leaf, leaf.to_string())));
        tree.nodes
    }

    fn finished(nodes: impl IntoIterator<Item = Node<String>>) -> String {
        let mut tree = MergeTree::new(join);
        nodes.into_iter().for_each(|node| tree.push(node));
        tree.finish().unwrap()
    }

    #[test]
    fn leaves_are_merged_in_order_on_a_balanced_tree() {
        assert_eq!(finished(nodes(0..7)), "(((01)(23))((45)6))");
    }

    #[test]
    fn leaves_gathered_in_any_ranges_make_the_same_tree() {
        for leaves in 1..=40 {
            let whole = finished(nodes(0..leaves));
            for a in 0..=leaves {
                for b in a..=leaves {
                    let parts = [nodes(0..a), nodes(a..b), nodes(b..leaves)];
                    assert_eq!(finished(parts.concat()), whole, "{a} {b} {leaves}");
                }
            }
        }
    }

    #[test]
    fn a_last_leaf_that_is_kept_apart_changes_no_bit() {
        for leaves in 1..=40 {
            let mut tree = MergeTree::of_whole(join, leaves - 1);
            nodes(0..leaves - 1).into_iter().for_each(|node| tree.push(node));
            tree.push(Node::leaf(leaves - 1, (leaves - 1).to_string()));
            assert_eq!(tree.nodes.last().map(|node| node.level), Some(0));
            assert_eq!(tree.finish().unwrap(), finished(nodes(0..leaves)), "{leaves}");
        }
    }

    #[test]
    fn a_range_is_covered_by_few_nodes() {
        // At most two of each size, one at either end.
        for (a, b) in [(1, 1023), (3, 1000), (511, 513), (0, 1024)] {
            let most = 2 * (b as f64).log2().ceil() as usize;
            assert!(nodes(a..b).len() <= most, "{a} {b}");
        }
    }
}
