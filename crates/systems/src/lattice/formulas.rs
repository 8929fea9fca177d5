//! The formulas of a lattice on 32 spins, and the loops over the spins of a tile.

use std::ops::Range;

use real::{Kernel, Real, Row, WIDTH, derivatives};

use super::{
    Shape,
    layout::{MaterialRows, OnePath, SpinRows, Spins},
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
    pub local: bool,
    /// Whether there is transverse damping.
    pub damped: bool,
    /// Rows of the field h: three for all groups, or for each.
    pub field: &'a [Row],
    pub tile: Range<usize>,
    pub op: Op<&'a [Row]>,
    pub h: Weights<'a>,
    pub out: &'a mut [Row],
}

impl<L: SpinRows> Kernel for OnTile<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { layout, local, damped, field, tile, op, h, out } = self;
        let (groups, first) = (tile.len() / 3, tile.start / 3);
        macro_rules! on_each {
            (|$group:ident, $rows:ident| $value:expr) => {
                for $group in 0..groups {
                    let $rows = if L::PLANES {
                        [$group, $group + groups, $group + 2 * groups]
                    } else {
                        [3 * $group, 3 * $group + 1, 3 * $group + 2]
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
                let noise = &layout.materials(first + group).noise;
                for c in 0..3 {
                    for p in 0..WIDTH {
                        spins[c][p] *= -(noise[p] * noise[p]);
                    }
                }
                spins
            }),
            Op::Gradient { y } => on_each!(|group, rows| {
                let (spins, exchange) =
                    (at(&y[tile.clone()], rows), layout.exchange(first + group, y));
                let begin = if local { tile.start } else { 0 };
                let noise = if local { rows } else { [0, 1, 2] }.map(|row| &h.dw[begin + row]);
                let of = layout.materials(first + group);
                gradient(of, damped, spins, &exchange, [field_of(field, group), noise], h.dt)
            }),
            Op::Hessian { y, u } => on_each!(|group, rows| {
                let states = [y, u].map(|y| at(&y[tile.clone()], rows));
                let exchanges = [y, u].map(|y| layout.exchange(first + group, y));
                let of = layout.materials(first + group);
                hessian(of, damped, states, exchanges, field_of(field, group), h.dt)
            }),
            // {Hₘ, H_l} = σ² Σ sᵢ·(e_l × eₘ) for common noise.
            Op::AreaGradient { .. } => on_each!(|group, rows| {
                let noise = &layout.materials(first + group).noise;
                // Rows 1, 2 and 5 have A₁₂, A₁₃ and A₂₃.
                [(5, -1.0), (2, 1.0), (1, -1.0)].map(|(row, sign): (usize, f64)| {
                    std::array::from_fn(|p| h.areas[row][p] * (sign * (noise[p] * noise[p])))
                })
            }),
            Op::AreaHessian { .. } => on_each!(|group, rows| [[0.0; WIDTH]; 3]),
            Op::AveragedGradient { .. } | Op::AveragedHessian { .. } | Op::AveragedField { .. } => {
                unreachable!("averages are derived")
            }
        }
    }
}

/// Rows of the field on a group, of those of a tile or of a constant field.
#[inline(always)]
fn field_of(field: &[Row], group: usize) -> [&Row; 3] {
    let begin = if field.len() == 3 { 0 } else { 3 * group };
    [0, 1, 2].map(|c| &field[begin + c])
}

real::kernel! {
    /// The energy of the spins of a tile of one path: −½s·Σ(Js′ + D × s′) − ½Ks_z² − h·s.
    pub fn energy_on_tile(
        layout: OnePath<'a>,
        field: &'a [Row],
        tile: Range<usize>,
        y: &'a [Row]
    ) -> f64 {
        let (groups, mut sum) = (tile.len() / 3, [0.0; WIDTH]);
        for group in 0..groups {
            let number = tile.start / 3 + group;
            let s = at(&y[tile.clone()], [group, group + groups, group + 2 * groups]);
            let (exchange, field) = (layout.exchange(number, y), field_of(field, group));
            let anisotropy = &layout.materials(number).anisotropy;
            for p in 0..WIDTH {
                for c in 0..3 {
                    sum[p] -= s[c][p] * (0.5 * exchange[c][p] + field[c][p]);
                }
                sum[p] -= 0.5 * anisotropy[p] * s[2][p] * s[2][p];
            }
        }
        sum.iter().sum::<f64>()
    }
}

/// The spins in these rows.
#[inline(always)]
fn at(rows: &[Row], [x, y, z]: [usize; 3]) -> Spins {
    [rows[x], rows[y], rows[z]]
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
}

/// The v of 32 spins, from exchange, field and noise.
#[inline(always)]
fn gradient(
    of: &MaterialRows,
    damped: bool,
    spins: Spins,
    exchange: &Spins,
    [field, noise]: [[&Row; 3]; 2],
    dt: f64,
) -> Spins {
    let [mut x, mut y, mut z] = spins;
    for p in 0..WIDTH {
        let lane = |rows: [&Row; 3]| [rows[0][p], rows[1][p], rows[2][p]];
        let (sum, acts) = (lane(exchange.each_ref()), [lane(field), lane(noise)]);
        let v = at_spin(of, damped, p, [x[p], y[p], z[p]], sum, acts, dt);
        (x[p], y[p], z[p]) = (v[0], v[1], v[2]);
    }
    [x, y, z]
}

/// The derivative of the v of 32 spins along others.
#[inline(always)]
fn hessian(
    of: &MaterialRows,
    damped: bool,
    [spins, along]: [Spins; 2],
    exchanges: [Spins; 2],
    field: [&Row; 3],
    dt: f64,
) -> Spins {
    let [mut x, mut y, mut z] = spins;
    for p in 0..WIDTH {
        let lane = |spins: &Spins| [spins[0][p], spins[1][p], spins[2][p]];
        let s = real::along([x[p], y[p], z[p]], lane(&along));
        let exchange = real::along(lane(&exchanges[0]), lane(&exchanges[1]));
        let acts = [field.map(|row| row[p]), [0.0; 3]];
        let v = derivatives(at_spin(of, damped, p, s, exchange, acts, dt));
        (x[p], y[p], z[p]) = (v[0], v[1], v[2]);
    }
    [x, y, z]
}

/// The v of spin p: −(F dt + σ dw) − α dt (s × F)/|s| with the field F = −∂H₀/∂s = Σ(Js′ + D × s′)
/// + K s_z e_z + h on it.
#[inline(always)]
fn at_spin<R: Real>(
    of: &MaterialRows,
    damped: bool,
    p: usize,
    s: [R; 3],
    sum: [R; 3],
    [[x, y, z], noise]: [[f64; 3]; 2],
    dt: f64,
) -> [R; 3] {
    let field = [sum[0] + x, sum[1] + y, sum[2] + (s[2] * of.anisotropy[p] + z)];
    let mut v = [R::zero(); 3];
    for c in 0..3 {
        v[c] = -(field[c] * dt + noise[c] * of.noise[p]);
    }
    if damped {
        let turned = cross(s, field);
        let weight = inverse_length(s) * (-of.damping[p] * dt);
        for c in 0..3 {
            v[c] = v[c] + turned[c] * weight;
        }
    }
    v
}

/// 1/|s|, and 0 where there is no spin.
#[inline(always)]
fn inverse_length<R: Real>(s: [R; 3]) -> R {
    let square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    R::where_less(R::zero(), square, R::constant(1.0) / square.sqrt(), R::zero())
}
