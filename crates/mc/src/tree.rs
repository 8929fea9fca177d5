//! Sums on a fixed binary tree.

/// Merges parts in the order in which they are pushed, always two adjacent parts of the same size,
/// like carries in a binary counter. The tree depends on the number of parts alone, so the bits do
/// not depend on the thread or time of computation. Depth, memory and round-off are logarithmic.
pub struct MergeTree<T, F> {
    /// Parts with the binary logarithm of their number of leaves, strictly decreasing.
    parts: Vec<(u32, T)>,
    merge: F,
}

impl<T, F: Fn(&mut T, T)> MergeTree<T, F> {
    pub fn new(merge: F) -> Self {
        Self { parts: Vec::new(), merge }
    }

    pub fn push(&mut self, part: T) {
        let mut carry = (0, part);
        while let Some((size, mut left)) = self.parts.pop_if(|(size, _)| *size == carry.0) {
            (self.merge)(&mut left, carry.1);
            carry = (size + 1, left);
        }
        self.parts.push(carry);
    }

    /// The sum of all parts, or `None` without parts.
    pub fn finish(mut self) -> Option<T> {
        let (_, mut sum) = self.parts.pop()?;
        while let Some((_, mut left)) = self.parts.pop() {
            (self.merge)(&mut left, sum);
            sum = left;
        }
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_merged_in_order_on_a_balanced_tree() {
        let mut tree =
            MergeTree::new(|left: &mut String, right: String| *left = format!("({left}{right})"));
        for part in 0..7 {
            tree.push(part.to_string());
        }
        assert_eq!(tree.finish().unwrap(), "(((01)(23))((45)6))");
    }
}
