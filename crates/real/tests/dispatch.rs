//! A kernel gives the same bits at every level. One test: the limit belongs to the whole process.

use real::{Block, Dual, Kernel, Real, Simd, WIDTH, dispatch, limit_to};

/// A chain of everything a formula may use, with a select and a division, so that contraction,
/// reassociation or a libm call anywhere would show in the last bits.
#[inline(always)]
fn formula<R: Real>(x: R, y: R) -> R {
    let turn = x.sin() * y.cos() + (x * 0.5).sinc();
    let growth = (y * 0.25).exp() / (x * x + 1.0).sqrt() + (x * x + 0.1).ln();
    R::where_less(y, x, turn + growth, turn - growth) + x * y + x.powi(3)
}

struct Iterate<'a> {
    y: &'a mut Block<2>,
    derivative: &'a mut Block<1>,
}

impl Kernel for Iterate<'_> {
    type Output = u64;
    #[inline(always)]
    fn run(self) -> u64 {
        let mut above = 0;
        for p in 0..WIDTH {
            let [a, b] = self.y.path(p);
            let next = formula(Dual::variable(a), Dual::fixed(b));
            // Folded back into (−2, 2), so that the iteration neither settles nor overflows.
            self.y.set_path(p, [next.value.sin() * 2.0, next.derivative().cos() * 2.0]);
            self.derivative.0[0][p] = next.derivative();
            above += if next.value > 0.0 { 1 } else { 0 };
        }
        above
    }
}

fn run(level: Simd) -> Vec<(u64, [u64; 3])> {
    limit_to(level);
    assert_eq!(Simd::current(), Simd::available().min(level));
    let mut y = Block::zero();
    for p in 0..WIDTH {
        y.set_path(p, [0.1 * p as f64 - 1.5, 1.7 - 0.09 * p as f64]);
    }
    let mut derivative = Block::zero();
    let mut seen = Vec::new();
    for _ in 0..500 {
        let above = dispatch(Iterate { y: &mut y, derivative: &mut derivative });
        for p in 0..WIDTH {
            let [a, b] = y.path(p);
            seen.push((above, [a, b, derivative.0[0][p]].map(f64::to_bits)));
        }
    }
    seen
}

#[test]
fn every_level_gives_the_same_bits() {
    let baseline = run(Simd::BUILT[0]);
    for &level in Simd::BUILT {
        assert!(run(level) == baseline, "{} differs", level.name());
    }
    // The chain is chaotic: the paths did not all fall on one orbit, so equality says something.
    let last: std::collections::HashSet<_> =
        baseline[baseline.len() - WIDTH..].iter().map(|(_, bits)| bits[0]).collect();
    assert!(last.len() > WIDTH / 2, "{}", last.len());
    assert_eq!(
        [Simd::Baseline, Simd::Avx2, Simd::Avx512].map(Simd::name),
        ["baseline", "avx2", "avx512"]
    );
}
