//! Wiener increments from scrambled Sobol points, by a Brownian bridge.

use std::{collections::VecDeque, sync::Arc};

use real::{Row, WIDTH};

use crate::{
    NoiseError, ScrambledSobol, StreamKey, inverse_normal::fill_normals, sobol::point_number,
};

/// Increments of M independent Wiener processes over N equal steps of [0, T], from points of
/// [`ScrambledSobol`]: randomised quasi-Monte Carlo.
///
/// A point has a dimension for every noise and every time node, and
/// [`inverse_normal`](crate::inverse_normal) makes a normal of each coordinate. A Brownian bridge
/// makes paths of the normals (Caflisch and Moskowitz 1995): W(T) = √T·Z, and between two known
/// nodes r and t, W(s) = W(r) + (s − r)/(t − r)·(W(t) − W(r)) + √((s − r)(t − s)/(t − r))·Z.
/// The first dimensions are the W_m(T) of all noises, then the values at T/2, then those at the
/// quarters, and so on: the points are most even in the first dimensions. A node lies in the middle
/// of its interval, rounded down to a step.
///
/// Each path is a path of M Wiener processes, up to the 53 bits of its uniforms. Means over the
/// paths of a scramble are unbiased; the error of a mean is estimated from independent scrambles.
/// For smooth functionals it decreases faster than that of Monte Carlo. Take 2^m points from point
/// 0 on: other numbers lose most of that.
///
/// **Replay**: a path is a function of (seed, experiment, scramble, point) and of N, M and T alone,
/// the same bits in a block and alone, at every level of instructions. With other N or M the same
/// point is another path.
///
/// ```
/// use noise::{QuasiWiener, StreamKey};
///
/// // Eight steps of two noises on [0, 1]. Mean of W_1(1)² over 1024 points of one scramble.
/// let key = StreamKey { seed: 1, experiment: 7 };
/// let noise = QuasiWiener::new(key, 0, 8, 2, 1.0)?;
/// let mut increments = vec![[0.0; 32]; noise.dimensions()];
/// let mut sum = 0.0;
/// for first_point in (0..1024).step_by(32) {
///     noise.block(first_point, &mut increments);
///     for p in 0..32 {
///         let end: f64 = (0..8).map(|n| increments[n * 2][p]).sum();
///         sum += end * end;
///     }
/// }
/// // The standard error of Monte Carlo would be √(2/1024) = 0.044.
/// assert!((sum / 1024.0 - 1.0).abs() < 0.005);
///
/// // Point 100 alone: the same numbers.
/// noise.block(96, &mut increments);
/// let path = noise.path(100);
/// assert!((0..16).all(|row| path[row] == increments[row][4]));
/// # Ok::<(), noise::NoiseError>(())
/// ```
#[derive(Clone, Debug)]
pub struct QuasiWiener {
    sobol: ScrambledSobol,
    key: StreamKey,
    nodes: Arc<[BridgeNode]>,
    noises: usize,
}

impl QuasiWiener {
    /// The largest number of dimensions, 2²⁴. Those above [`ScrambledSobol::DIMENSIONS`] have
    /// independent random words.
    pub const MAX_DIMENSIONS: usize = 1 << 24;

    /// `noises` Wiener processes over `steps` equal steps of [0, `t_end`], from scramble number
    /// `scramble` of the key. Without noises there are no dimensions.
    ///
    /// # Errors
    /// [`NoiseError`] unless `steps` and `t_end` are positive and finite, and above
    /// [`MAX_DIMENSIONS`](Self::MAX_DIMENSIONS).
    pub fn new(
        key: StreamKey,
        scramble: u64,
        steps: u64,
        noises: usize,
        t_end: f64,
    ) -> Result<Self, NoiseError> {
        NoiseError::unless_positive("the number of steps", steps as f64)?;
        NoiseError::unless_positive("the end of time", t_end)?;
        let most = Self::MAX_DIMENSIONS;
        let dimensions = u128::from(steps) * noises as u128;
        if dimensions > most as u128 {
            return Err(NoiseError(format!(
                "{steps} steps of {noises} noises have more than {most} dimensions"
            )));
        }
        let nodes = if noises == 0 { Vec::new() } else { bridge(steps as usize, t_end) };
        Ok(Self {
            sobol: ScrambledSobol::new(key, scramble, dimensions as usize),
            key,
            nodes: nodes.into(),
            noises,
        })
    }

    /// Increments from another scramble of the key. Both share what does not depend on the
    /// scramble.
    #[must_use]
    pub fn of_scramble(&self, scramble: u64) -> Self {
        let sobol = ScrambledSobol::new(self.key, scramble, self.dimensions());
        Self { sobol, key: self.key, nodes: Arc::clone(&self.nodes), noises: self.noises }
    }

    /// Number of dimensions of the points, and of increments of a path: steps times noises.
    pub fn dimensions(&self) -> usize {
        self.sobol.dimensions()
    }

    /// Writes the increments of points `first_point` .. `first_point + 32`: row n·M + m is ΔW_m
    /// over step n.
    ///
    /// # Panics
    /// For points from 2³² on, unless 32 divides `first_point`, and unless there is a row for every
    /// dimension. Nothing is written then.
    #[inline]
    pub fn block(&self, first_point: u64, increments: &mut [Row]) {
        assert_eq!(increments.len(), self.dimensions(), "there is a row for every dimension");
        assert!(first_point.is_multiple_of(WIDTH as u64), "blocks begin at multiples of 32");
        fill_block(self, point_number(first_point), increments);
    }

    /// The increments of one point, with the same bits: number n·M + m is ΔW_m over step n.
    ///
    /// # Panics
    /// For points from 2³² on.
    pub fn path(&self, point: u64) -> Vec<f64> {
        let mut rows = vec![[0.0]; self.dimensions()];
        self.fill(point_number(point), &mut rows);
        rows.into_flattened()
    }

    /// The increments of all dimensions of L points from point `first` on.
    #[inline(always)]
    fn fill<const L: usize>(&self, first: u32, rows: &mut [[f64; L]]) {
        let Self { sobol, nodes, noises, .. } = self;
        let (mut high, mut words, mut normals) = ([0; WIDTH], [0; L], [0.0; L]);
        // First the values W_m at the nodes.
        let mut d = 0;
        for node in nodes.iter() {
            for m in 0..*noises {
                sobol.fill(d, &mut high, first, &mut words);
                fill_normals(&words, &mut normals, node.deviation);
                d += 1;
                let row = |n: usize| (n - 1) * noises + m;
                if node.node == node.right {
                    rows[row(node.node)] = normals;
                    continue;
                }
                let right = rows[row(node.right)];
                let left = if node.left == 0 { [0.0; L] } else { rows[row(node.left)] };
                let middle = &mut rows[row(node.node)];
                for p in 0..L {
                    middle[p] = (left[p] + node.weight * (right[p] - left[p])) + normals[p];
                }
            }
        }
        // Then their differences, the last step first.
        for later in (*noises..rows.len()).rev() {
            let (before, after) = rows.split_at_mut(later);
            let (before, after) = (&before[later - noises], &mut after[0]);
            for p in 0..L {
                after[p] -= before[p];
            }
        }
    }
}

/// A time node of the bridge. Nodes are counted from 1 at the end of the first step; W(0) = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BridgeNode {
    /// The node itself, and the nodes on its left and right; itself is the right one of the last.
    node: usize,
    left: usize,
    right: usize,
    /// Weight of W(right) − W(left).
    weight: f64,
    /// Standard deviation given both neighbours.
    deviation: f64,
}

/// The nodes of `steps` steps, in the order of their dimensions: breadth first.
fn bridge(steps: usize, t_end: f64) -> Vec<BridgeNode> {
    let deviation = t_end.sqrt();
    let mut nodes = vec![BridgeNode { node: steps, left: 0, right: steps, weight: 0.0, deviation }];
    let mut intervals = VecDeque::from([(0, steps)]);
    while let Some((left, right)) = intervals.pop_front() {
        if right - left > 1 {
            let node = left.midpoint(right);
            let [before, after, whole] =
                [node - left, right - node, right - left].map(|n| n as f64);
            let variance = before * after / whole * (t_end / steps as f64);
            let (weight, deviation) = (before / whole, variance.sqrt());
            nodes.push(BridgeNode { node, left, right, weight, deviation });
            intervals.extend([(left, node), (node, right)]);
        }
    }
    nodes
}

real::kernel! {
    /// The increments of a block of points.
    fn fill_block(noise: &'a QuasiWiener, first: u32, rows: &'a mut [Row]) {
        noise.fill(first, rows);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bridge_is_breadth_first() {
        let order = |steps| bridge(steps, 1.0).iter().map(|node| node.node).collect::<Vec<_>>();
        assert_eq!(order(1), [1]);
        assert_eq!(order(2), [2, 1]);
        assert_eq!(order(3), [3, 1, 2]);
        assert_eq!(order(7), [7, 3, 1, 5, 2, 4, 6]);
        assert_eq!(order(8), [8, 4, 2, 6, 1, 3, 5, 7]);
        // On [0, 32], the quarter of eight steps is the middle of [0, 16].
        let quarter = BridgeNode { node: 2, left: 0, right: 4, weight: 0.5, deviation: 2.0 };
        assert_eq!(bridge(8, 32.0)[2], quarter);
    }

    const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };

    #[test]
    fn bad_input_is_named() {
        let new = |steps, noises, t_end| QuasiWiener::new(KEY, 0, steps, noises, t_end);
        for (steps, t_end, got) in
            [(0, 1.0, "steps must be positive and finite, got 0"), (1, -1.0, "got -1")]
        {
            let error = new(steps, 1, t_end).unwrap_err().to_string();
            assert!(error.ends_with(got), "{error}");
        }
        assert!(new(1, 1, 0.0).is_err() && new(1, 1, f64::INFINITY).is_err());
        assert!(new(1, 0, f64::NAN).unwrap_err().to_string().ends_with("got NaN"));
        for (steps, noises) in [(1 << 23, 3), (u64::MAX, 2), (1, usize::MAX)] {
            let error = new(steps, noises, 1.0).unwrap_err();
            assert!(error.to_string().contains(&format!("{steps} steps of {noises} noises")));
        }
    }
}
