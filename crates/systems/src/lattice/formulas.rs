//! The formulas of a lattice on 32 spins, and the loops over the spins of a tile.

use std::ops::Range;

use real::{Kernel, Row, WIDTH};

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

    /// The field on a spin, −∂H₀/∂s = JΣs′ + K s_z e_z + h.
    #[inline(always)]
    fn field_on(self, s: [f64; 3], sum: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.field;
        let j = self.exchange;
        [sum[0] * j + x, sum[1] * j + y, sum[2] * j + (s[2] * self.anisotropy + z)]
    }

    #[inline(always)]
    fn gradient(self, spins: Spins, sum: Spins, noise: Spins, dt: f64) -> Spins {
        let damped = self.damping != 0.0;
        let [mut x, mut y, mut z] = spins;
        for p in 0..WIDTH {
            let s = [x[p], y[p], z[p]];
            let field = self.field_on(s, [sum[0][p], sum[1][p], sum[2][p]]);
            let mut v = [0.0; 3];
            for c in 0..3 {
                v[c] = -(field[c] * dt + noise[c][p] * self.noise);
            }
            if damped {
                let turned = cross(s, field);
                let weight = -self.damping * dt * inverse_length(s);
                for c in 0..3 {
                    v[c] += turned[c] * weight;
                }
            }
            (x[p], y[p], z[p]) = (v[0], v[1], v[2]);
        }
        [x, y, z]
    }

    /// With F the field on s and F′ that of the direction, without h: −F′ − α(u × F + s × F′ − (s ×
    /// F)(s·u)/|s|²)/|s|.
    #[inline(always)]
    fn hessian(self, (spins, along): (Spins, Spins), sums: (Spins, Spins), dt: f64) -> Spins {
        let [mut x, mut y, mut z] = spins;
        let linear = Self { field: [0.0; 3], ..self };
        for p in 0..WIDTH {
            let lane = |spins: &Spins| [spins[0][p], spins[1][p], spins[2][p]];
            let (s, u) = ([x[p], y[p], z[p]], lane(&along));
            let (field, moved) =
                (self.field_on(s, lane(&sums.0)), linear.field_on(u, lane(&sums.1)));
            let (bent, turned, plain) = (cross(u, field), cross(s, moved), cross(s, field));
            let inverse = inverse_length(s);
            let share = (s[0] * u[0] + s[1] * u[1] + s[2] * u[2]) * inverse * inverse;
            let mut v = [0.0; 3];
            for c in 0..3 {
                let transverse = (bent[c] + turned[c] - plain[c] * share) * inverse;
                v[c] = -(moved[c] + transverse * self.damping) * dt;
            }
            (x[p], y[p], z[p]) = (v[0], v[1], v[2]);
        }
        [x, y, z]
    }
}

/// 1/|s|, and 0 where there is no spin.
#[inline(always)]
fn inverse_length(s: [f64; 3]) -> f64 {
    let square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 }
}
