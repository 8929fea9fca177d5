//! The formulas of a lattice on 32 spins, and the loops over the spins of a tile.

use std::ops::Range;

use real::{Kernel, Real, Row, WIDTH, derivatives};

use super::{
    Shape,
    layout::{SpinRows, Spins},
};
use crate::{
    cayley::{cayley_cross, cross},
    run_time::{Op, Weights},
};

/// The couplings of a lattice of spins: H₀ = −J Σ sᵢ·sⱼ over bonds − ½K Σ (sᵢᶻ)² − h·Σ sᵢ, noise σ
/// and transverse damping α.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Couplings {
    /// J; positive for a ferromagnet.
    pub exchange: f64,
    /// K; positive for an easy axis z.
    pub anisotropy: f64,
    /// h.
    pub field: [f64; 3],
    /// σ: Hₘ = −σsᵢᵐ at each site, or −σ Σ sᵢᵐ.
    pub noise: f64,
    /// Whether every site has three noises of its own; otherwise three are common to all.
    pub local: bool,
    /// α: the drift gets the term α sᵢ × (sᵢ × ∂H₀/∂sᵢ)/|sᵢ|.
    pub damping: f64,
}

/// The loop over the groups of a tile.
pub struct OnTile<'a, L> {
    pub layout: L,
    pub directions: usize,
    pub couplings: Couplings,
    pub tile: Range<usize>,
    pub op: Op<&'a [Row]>,
    pub h: Weights<'a>,
    pub out: &'a mut [Row],
}

impl<L: SpinRows> Kernel for OnTile<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { layout, directions, couplings, tile, op, h, out } = self;
        let groups = tile.len() / 3;
        macro_rules! on_each {
            (|$group:ident, $rows:ident| $value:expr) => {
                for $group in 0..groups {
                    let $rows = match L::PLANES {
                        true => [$group, $group + groups, $group + 2 * groups],
                        false => [3 * $group, 3 * $group + 1, 3 * $group + 2],
                    };
                    let value: Spins = $value;
                    for c in 0..3 {
                        out[$rows[c]] = value[c];
                    }
                }
            };
        }
        match op {
            Op::Structure { y: s, v } | Op::StructureAlong { u: s, v, .. } => {
                on_each!(|group, rows| on_lanes(at(s, rows), at(v, rows), cross))
            }
            Op::Cayley { y, v } => {
                on_each!(|group, rows| on_lanes(at(y, rows), at(v, rows), cayley_cross))
            }
            // −σ²s.
            Op::ItoCorrection { y } => on_each!(|group, rows| {
                let mut spins = at(&y[tile.clone()], rows);
                for c in 0..3 {
                    for p in 0..WIDTH {
                        spins[c][p] *= -(couplings.noise * couplings.noise);
                    }
                }
                spins
            }),
            Op::Gradient { y } => on_each!(|group, rows| {
                let spins = at(&y[tile.clone()], rows);
                let mut sum = [[0.0; WIDTH]; 3];
                for direction in 0..directions {
                    layout.add_neighbours(&tile, group, direction, y, &mut sum);
                }
                let noise = increments(couplings.local, h.dw, &tile, rows);
                couplings.gradient(spins, sum, noise, h.dt)
            }),
            Op::Hessian { y, u } => on_each!(|group, rows| {
                let (spins, along) = (at(&y[tile.clone()], rows), at(&u[tile.clone()], rows));
                let (mut sum, mut sum_along) = ([[0.0; WIDTH]; 3], [[0.0; WIDTH]; 3]);
                for direction in 0..directions {
                    layout.add_neighbours(&tile, group, direction, y, &mut sum);
                    layout.add_neighbours(&tile, group, direction, u, &mut sum_along);
                }
                couplings.hessian((spins, along), (sum, sum_along), h.dt)
            }),
            // {Hₘ, H_l} = σ² Σ sᵢ·(e_l × eₘ) for common noise.
            Op::AreaGradient { .. } => {
                let weight = couplings.noise * couplings.noise;
                // Rows 1, 2 and 5 have A₁₂, A₁₃ and A₂₃.
                let v = [(5, -weight), (2, weight), (1, -weight)]
                    .map(|(row, weight)| h.areas[row].map(|area| area * weight));
                on_each!(|group, rows| v)
            }
            Op::AreaHessian { .. } => on_each!(|group, rows| [[0.0; WIDTH]; 3]),
            Op::AveragedGradient { .. } | Op::AveragedHessian { .. } | Op::AveragedField { .. } => {
                unreachable!("averages are derived")
            }
        }
    }
}

/// The spins in these rows.
#[inline(always)]
fn at(rows: &[Row], [x, y, z]: [usize; 3]) -> Spins {
    [rows[x], rows[y], rows[z]]
}

/// The increments at a group: its own, or those of all sites.
#[inline(always)]
fn increments(local: bool, dw: &[Row], tile: &Range<usize>, rows: [usize; 3]) -> Spins {
    if local { at(&dw[tile.clone()], rows) } else { [dw[0], dw[1], dw[2]] }
}

/// A function of two vectors on each lane.
#[inline(always)]
fn on_lanes(a: Spins, b: Spins, function: impl Fn([f64; 3], [f64; 3]) -> [f64; 3]) -> Spins {
    // Each row by its name: a loop over the components makes scattered stores of them.
    let [mut x, mut y, mut z] = a;
    for p in 0..WIDTH {
        let value = function([x[p], y[p], z[p]], [b[0][p], b[1][p], b[2][p]]);
        (x[p], y[p], z[p]) = (value[0], value[1], value[2]);
    }
    [x, y, z]
}

impl Couplings {
    /// Shape and couplings in words.
    pub(super) fn describe(self, shape: &Shape) -> String {
        let Self { exchange, anisotropy, field, noise, local, damping } = self;
        let kind = if local { "local" } else { "common" };
        format!(
            "{}, J = {exchange}, K = {anisotropy}, h = {field:?}, σ = {noise} ({kind}), \
             α = {damping}",
            shape.describe()
        )
    }

    #[inline(always)]
    fn gradient(self, spins: Spins, sum: Spins, noise: Spins, dt: f64) -> Spins {
        let [mut x, mut y, mut z] = spins;
        for p in 0..WIDTH {
            let lane = |spins: &Spins| [spins[0][p], spins[1][p], spins[2][p]];
            let v = self.at_spin([x[p], y[p], z[p]], lane(&sum), lane(&noise), dt);
            (x[p], y[p], z[p]) = (v[0], v[1], v[2]);
        }
        [x, y, z]
    }

    #[inline(always)]
    fn hessian(self, (spins, along): (Spins, Spins), sums: (Spins, Spins), dt: f64) -> Spins {
        let [mut x, mut y, mut z] = spins;
        for p in 0..WIDTH {
            let lane = |spins: &Spins| [spins[0][p], spins[1][p], spins[2][p]];
            let s = real::along([x[p], y[p], z[p]], lane(&along));
            let sum = real::along(lane(&sums.0), lane(&sums.1));
            let v = derivatives(self.at_spin(s, sum, [0.0; 3], dt));
            (x[p], y[p], z[p]) = (v[0], v[1], v[2]);
        }
        [x, y, z]
    }

    /// The v of a spin: −(F dt + σ dw) − α dt (s × F)/|s| with the field F = −∂H₀/∂s =
    /// JΣs′ + K s_z e_z + h on it.
    #[inline(always)]
    fn at_spin<R: Real>(self, s: [R; 3], sum: [R; 3], noise: [f64; 3], dt: f64) -> [R; 3] {
        let ([x, y, z], j) = (self.field, self.exchange);
        let field = [sum[0] * j + x, sum[1] * j + y, sum[2] * j + (s[2] * self.anisotropy + z)];
        let mut v = [R::zero(); 3];
        for c in 0..3 {
            v[c] = -(field[c] * dt + noise[c] * self.noise);
        }
        if self.damping != 0.0 {
            let turned = cross(s, field);
            let weight = inverse_length(s) * (-self.damping * dt);
            for c in 0..3 {
                v[c] = v[c] + turned[c] * weight;
            }
        }
        v
    }
}

/// 1/|s|, and 0 where there is no spin.
#[inline(always)]
fn inverse_length<R: Real>(s: [R; 3]) -> R {
    let square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    R::where_less(R::zero(), square, R::constant(1.0) / square.sqrt(), R::zero())
}
