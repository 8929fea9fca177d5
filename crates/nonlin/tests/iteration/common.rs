//! Equations that the tests share.

use nonlin::{BlockFixedPoint, BlockStatus, FirstSweep, FixedPoint, Method, Solver};
use real::{Block, Kernel, Real, WIDTH, dispatch};

/// zᵢ = cᵢ + r·Σⱼ Aᵢⱼ sin(zⱼ/r + bᵢⱼ), which scales with r: z is a solution for r where z/r is one
/// for 1.
///
/// Row sums of |A| below 1 make it a contraction in the maximum norm, whatever c and b are.
#[derive(Clone, Copy, Debug)]
pub struct SineMap<const D: usize> {
    pub matrix: [[f64; D]; D],
    pub phase: [[f64; D]; D],
    pub constant: [f64; D],
    pub start: [f64; D],
    pub scale: f64,
}

impl<const D: usize> SineMap<D> {
    /// The map with row sums of |A| equal to `contraction`, made of numbers in [−1, 1].
    pub fn new(contraction: f64, numbers: &[f64]) -> Self {
        let mut numbers = numbers.iter().copied().cycle();
        let mut next = || numbers.next().unwrap();
        let (mut matrix, mut phase) = ([[0.0; D]; D], [[0.0; D]; D]);
        for i in 0..D {
            let mut sum = 0.0;
            for j in 0..D {
                matrix[i][j] = next();
                phase[i][j] = 3.0 * next();
                sum += matrix[i][j].abs();
            }
            for j in 0..D {
                matrix[i][j] *= contraction / f64::max(sum, 1e-3);
            }
        }
        Self {
            matrix,
            phase,
            constant: [(); D].map(|()| 2.0 * next()),
            start: [(); D].map(|()| 2.0 * next()),
            scale: 1.0,
        }
    }

    pub fn scaled(mut self, scale: f64) -> Self {
        self.scale = scale;
        self.constant = self.constant.map(|c| c * scale);
        self.start = self.start.map(|c| c * scale);
        self
    }
}

impl<const D: usize> FixedPoint<D> for SineMap<D> {
    const FIRST_SWEEP: FirstSweep = FirstSweep::Long;

    #[inline(always)]
    fn start(&self) -> [f64; D] {
        self.start
    }

    #[inline(always)]
    fn map<R: Real>(&self, z: [R; D]) -> [R; D] {
        let mut next = [R::zero(); D];
        for i in 0..D {
            let mut sum = R::zero();
            for j in 0..D {
                sum = sum + (z[j] / self.scale + self.phase[i][j]).sin() * self.matrix[i][j];
            }
            next[i] = sum * self.scale + self.constant[i];
        }
        next
    }
}

/// The same equation for Newton's method, which then begins with its long first sweep.
#[derive(Clone, Copy, Debug)]
pub struct PrefersNewton<E>(pub E);

impl<E: FixedPoint<D>, const D: usize> FixedPoint<D> for PrefersNewton<E> {
    const METHOD: Method = Method::Newton;
    const FIRST_SWEEP: FirstSweep = FirstSweep::Long;

    #[inline(always)]
    fn start(&self) -> [f64; D] {
        self.0.start()
    }

    #[inline(always)]
    fn map<R: Real>(&self, z: [R; D]) -> [R; D] {
        self.0.map(z)
    }
}

/// One equation for each path.
#[derive(Clone, Copy)]
pub struct Equations<E>(pub [E; WIDTH]);

impl<E: FixedPoint<D>, const D: usize> BlockFixedPoint<D> for Equations<E> {
    type Path = E;
    #[inline(always)]
    fn path(&self, p: usize) -> E {
        self.0[p]
    }
}

struct SolveKernel<'a, E, const D: usize> {
    solver: Solver,
    equations: &'a Equations<E>,
    z: &'a mut Block<D>,
    status: &'a mut BlockStatus,
}

impl<E: FixedPoint<D>, const D: usize> Kernel for SolveKernel<'_, E, D> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        self.solver.solve_block(self.equations, self.z, self.status);
    }
}

/// Solves a block on the current level, from values that must not matter.
pub fn solve_block<E: FixedPoint<D>, const D: usize>(
    solver: Solver,
    equations: &Equations<E>,
) -> (Block<D>, BlockStatus) {
    let (mut z, mut status) = (Block::splat([f64::NAN; D]), BlockStatus::explicit());
    dispatch(SolveKernel { solver, equations, z: &mut z, status: &mut status });
    (z, status)
}

pub fn norm<const D: usize>(x: [f64; D]) -> f64 {
    x.iter().map(|component| component.abs()).sum()
}

pub fn difference<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    norm(std::array::from_fn::<_, D, _>(|i| a[i] - b[i]))
}

/// ‖z − ψ(z)‖₁.
pub fn residual<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> f64 {
    difference(z, equation.map(z))
}

/// A small generator of numbers in [−1, 1).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 * 2f64.powi(-52) - 1.0
    }

    pub fn take(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}
