//! The averaged discrete gradient by Gauss–Legendre quadrature.

use real::{Degree, Real};

use crate::{legendre::fixed_rule, midpoint};

/// A gradient field ∇H on ℝᴰ, generic over [`Real`].
pub trait GradientField<const D: usize> {
    /// ∇H(y).
    fn gradient<R: Real>(&self, y: [R; D]) -> [R; D];
}

/// ∇̄H(a, b) ≈ Σ wᵢ ∇H(a + ηᵢ(b − a)) with N Gauss–Legendre nodes.
///
/// The sum is exact to round-off if ∇H is a polynomial of degree at most 2N − 1. Otherwise the
/// error is of order |b − a|^{2N}. N is a constant, so a block kernel contains the whole sum. A
/// kernel with more than 9 nodes or more than 4 dimensions is not vectorised.
#[inline(always)]
pub fn averaged<const N: usize, R: Real, F: GradientField<D>, const D: usize>(
    field: &F,
    a: [R; D],
    b: [R; D],
) -> [R; D] {
    let nodes = Nodes::<F, R, N, D>::new(field, a, b);
    if N == 1 {
        return field.gradient(nodes.middle);
    }
    let (first, weights) = const { (fixed_rule::<N>().0[0], fixed_rule::<N>().1) };
    let mean = nodes.add_pairs(times(nodes.pair(first), weights[0]));
    if N % 2 == 1 { plus(mean, field.gradient(nodes.middle), weights[N / 2]) } else { mean }
}

/// [`averaged`] with the nodes that a polynomial H of this degree needs: one up to degree two, two
/// up to four, three up to six; with eight for any other H.
///
/// The degrees share the points of eight nodes and the middle. The compiler knows the degree of an
/// inlined formula, but drops branches late: points of their own would cost it time.
#[inline(always)]
pub fn averaged_by_degree<R: Real, F: GradientField<D>, const D: usize>(
    field: &F,
    degree: Degree,
    a: [R; D],
    b: [R; D],
) -> [R; D] {
    let few = degree <= Degree::of(6);
    let (is_one, is_two) = (degree <= Degree::of(2), degree <= Degree::of(4));
    let nodes = Nodes::<F, R, 8, D>::new(field, a, b);
    let mut at_middle = nodes.middle;
    if is_one || (few && !is_two) {
        at_middle = field.gradient(at_middle);
    }
    if is_one {
        return at_middle;
    }
    let (two, three, eight) = const { (fixed_rule::<2>(), fixed_rule::<3>(), fixed_rule::<8>()) };
    let (node, weight) = match (is_two, few) {
        (true, _) => (two.0[0], two.1[0]),
        (_, true) => (three.0[0], three.1[0]),
        _ => (eight.0[0], eight.1[0]),
    };
    let mut mean = times(nodes.pair(node), weight);
    if !few {
        mean = nodes.add_pairs(mean);
    }
    if few && !is_two { plus(mean, at_middle, three.1[1]) } else { mean }
}

/// A field on the segment from a to b, at the N nodes of the rule. The nodes are symmetric about
/// the middle, and each pair has one weight.
struct Nodes<'a, F, R, const N: usize, const D: usize> {
    field: &'a F,
    middle: [R; D],
    difference: [R; D],
}

impl<'a, F: GradientField<D>, R: Real, const N: usize, const D: usize> Nodes<'a, F, R, N, D> {
    #[inline(always)]
    fn new(field: &'a F, a: [R; D], b: [R; D]) -> Self {
        let mut difference = a;
        for i in 0..D {
            difference[i] = b[i] - a[i];
        }
        Self { field, middle: midpoint(a, b), difference }
    }

    /// Adds the pairs after the first.
    ///
    /// Up to 9 nodes are written out. The compiler unrolls a loop with a long body too late for the
    /// enclosing loop over paths to be vectorised. More nodes, or nodes in more than four
    /// dimensions, are a loop, slow but quick to compile.
    #[inline(always)]
    fn add_pairs(&self, mut mean: [R; D]) -> [R; D] {
        if const { N > 9 || D > 4 } {
            for k in 1..N / 2 {
                mean = self.add_pair(mean, k);
            }
            return mean;
        }
        if const { N > 3 } {
            mean = self.add_pair(mean, 1);
        }
        if const { N > 5 } {
            mean = self.add_pair(mean, 2);
        }
        if const { N > 7 } {
            mean = self.add_pair(mean, 3);
        }
        mean
    }

    #[inline(always)]
    fn add_pair(&self, mean: [R; D], k: usize) -> [R; D] {
        let (nodes, weights) = const { fixed_rule::<N>() };
        plus(mean, self.pair(nodes[k]), weights[k])
    }

    /// The sum of the gradients at a node and at its mirror image.
    #[inline(always)]
    fn pair(&self, node: f64) -> [R; D] {
        let distance = 0.5 - node;
        let (mut lower, mut upper) = (self.middle, self.middle);
        for i in 0..D {
            let step = self.difference[i] * distance;
            lower[i] = lower[i] - step;
            upper[i] = upper[i] + step;
        }
        let (lower, upper) = (self.field.gradient(lower), self.field.gradient(upper));
        let mut sum = lower;
        for i in 0..D {
            sum[i] = lower[i] + upper[i];
        }
        sum
    }
}

/// gradient·weight.
#[inline(always)]
fn times<R: Real, const D: usize>(mut gradient: [R; D], weight: f64) -> [R; D] {
    for i in 0..D {
        gradient[i] = gradient[i] * weight;
    }
    gradient
}

/// mean + gradient·weight.
#[inline(always)]
fn plus<R: Real, const D: usize>(mut mean: [R; D], gradient: [R; D], weight: f64) -> [R; D] {
    for i in 0..D {
        mean[i] = mean[i] + gradient[i] * weight;
    }
    mean
}
