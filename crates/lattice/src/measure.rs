//! Magnetisation, energy, correlations and structure factors of the spins of one path.

use rayon::prelude::*;
use real::{Row, Rows, WIDTH};
use serde::{Deserialize, Serialize};
use systems::{
    lattice::{Crystal, SpinLattice},
    run_time::System,
};

use crate::fourier::{Complex, transform, turn, turned, twiddles};

/// Means over the spins of a lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Means {
    /// The mean spin.
    pub spin: [f64; 3],
    /// H₀ over the number of spins.
    pub energy: f64,
    /// The mean spin of each site of the cell.
    pub of_sites: Vec<[f64; 3]>,
}

/// Correlations and structure factors along the axes of a lattice.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spectra {
    /// For each axis a the mean of s·s′ over spins at the same site of cells that are r further
    /// along a, for r from 0; up to half of a periodic axis.
    pub correlations: Vec<Vec<f64>>,
    /// For each axis a S(q) = |Σ s e^{−iq·r}|²/N at q = k b_a/L_a for k from 0 to L_a, with the
    /// reciprocal vector b_a, q·r = 2πk(n + u)/L_a at fraction u of cell n.
    pub structures: Vec<Vec<f64>>,
}

/// The most cells of an axis with spectra, whose sums take the square of their number.
const MAX_CELLS: usize = 1 << 13;
/// Pieces of all sites, or of all lines, that are summed one by one.
const PIECES: usize = 64;

/// A function of each of the pieces of 0..n, in parallel, in their order.
fn pieces<T: Send>(n: usize, of: impl Fn(std::ops::Range<usize>) -> T + Sync) -> Vec<T> {
    let each = n.div_ceil(PIECES);
    let piece = |k: usize| of((k * each).min(n)..((k + 1) * each).min(n));
    (0..PIECES).into_par_iter().map(piece).collect()
}

impl Means {
    /// The means at a state and a time.
    #[must_use]
    pub fn of(lattice: &SpinLattice, y: &[Row], t: f64) -> Self {
        let (crystal, layout) = (lattice.crystal(), lattice.description().layout);
        let (sites, each) = (crystal.sites() as f64, crystal.materials.len());
        let tiles = y.len().div_ceil(layout.tile_rows);
        let energies: Vec<f64> = (0..tiles)
            .into_par_iter()
            .map_init(
                || Rows::zero(lattice.description().scratch_rows()),
                |scratch, tile| {
                    let end = ((tile + 1) * layout.tile_rows).min(y.len());
                    lattice.energy_of_tile(y, t, tile * layout.tile_rows..end, scratch)
                },
            )
            .collect();
        let of_sites = Planes::of(lattice, y).of_sites(each);
        let all = |c: usize| of_sites.iter().map(|sum| sum[c]).sum::<f64>() / sites;
        let spin = [0, 1, 2].map(all);
        let cells = sites / each as f64;
        let of_sites = of_sites.into_iter().map(|sum| sum.map(|sum| sum / cells)).collect();
        Self { spin, energy: energies.iter().sum::<f64>() / sites, of_sites }
    }
}

/// Sums of spins over the planes of cells across each axis: [axis][site of the cell and plane].
struct Planes([Vec<[f64; 3]>; 3]);

impl Planes {
    fn of(lattice: &SpinLattice, y: &[Row]) -> Self {
        let (crystal, sizes) = (lattice.crystal(), lattice.shape().sizes());
        let each = crystal.materials.len();
        let none = || Self(sizes.map(|size| vec![[0.0; 3]; each * size]));
        // Rows of cells along the first axis.
        let rows = pieces(crystal.sites() / sizes[0], |rows| {
            let mut sums = none();
            for row in rows {
                let (b, [_, y_cell, z_cell]) = crystal.coordinates(row * sizes[0]);
                let mut sum = [0.0; 3];
                for x in 0..sizes[0] {
                    let s = lattice.spin(y, row * sizes[0] + x, 0);
                    for c in 0..3 {
                        sums.0[0][b * sizes[0] + x][c] += s[c];
                        sum[c] += s[c];
                    }
                }
                for c in 0..3 {
                    sums.0[1][b * sizes[1] + y_cell][c] += sum[c];
                    sums.0[2][b * sizes[2] + z_cell][c] += sum[c];
                }
            }
            sums
        });
        let mut all = none();
        for (axis, more) in rows.iter().flat_map(|Self(sums)| sums.iter().enumerate()) {
            for (sum, more) in all.0[axis].iter_mut().zip(more) {
                (0..3).for_each(|c| sum[c] += more[c]);
            }
        }
        all
    }

    /// Sums over all planes.
    fn of_sites(&self, each: usize) -> Vec<[f64; 3]> {
        let of = |sums: &[[f64; 3]]| [0, 1, 2].map(|c| sums.iter().map(|sum| sum[c]).sum());
        self.0[2].chunks(self.0[2].len() / each).map(of).collect()
    }

    /// S(q) along an axis.
    fn structure(&self, crystal: &Crystal, axis: usize) -> Vec<f64> {
        let size = crystal.shape.sizes()[axis];
        let turns: Vec<[f64; 2]> = (0..size).map(|k| turn(k, size)).collect();
        let at = |k: usize| {
            let (mut re, mut im) = ([0.0; 3], [0.0; 3]);
            for (b, sums) in self.0[axis].chunks(size).enumerate() {
                let fraction = crystal.cell.sites[b][axis];
                let here = turned(k as f64 * fraction / size as f64);
                for (n, sum) in sums.iter().enumerate() {
                    let [c, s] = turns[k * n % size];
                    let [cos, sin] = [c * here[0] - s * here[1], c * here[1] + s * here[0]];
                    for i in 0..3 {
                        re[i] += sum[i] * cos;
                        im[i] -= sum[i] * sin;
                    }
                }
            }
            let square: f64 = (0..3).map(|c| re[c] * re[c] + im[c] * im[c]).sum();
            square / crystal.sites() as f64
        };
        (0..=size).map(at).collect()
    }
}

impl Spectra {
    /// Correlations and structure factors of a state, along the axes with more than one cell and
    /// up to 8192.
    #[must_use]
    pub fn of(lattice: &SpinLattice, y: &[Row]) -> Self {
        let planes = Planes::of(lattice, y);
        let axes =
            || (0..3).filter(|&axis| (2..=MAX_CELLS).contains(&lattice.shape().sizes()[axis]));
        Self {
            correlations: axes().map(|axis| correlation(lattice, y, axis)).collect(),
            structures: axes().map(|axis| planes.structure(lattice.crystal(), axis)).collect(),
        }
    }
}

/// The mean of s·s′ by distance along an axis: from |FFT|² of lines that are filled up with zeros
/// to twice their length (Wiener and Khinchin).
fn correlation(lattice: &SpinLattice, y: &[Row], axis: usize) -> Vec<f64> {
    let (crystal, shape) = (lattice.crystal(), lattice.shape());
    let (size, sites) = (shape.sizes()[axis], crystal.sites());
    let (lines, n) = (sites / size, (2 * size).next_power_of_two());
    let twiddles = twiddles(n);
    let stride = match axis {
        0 => 1,
        1 => shape.sizes()[0] * crystal.materials.len(),
        _ => sites / size,
    };
    // The first site of a line.
    let begin = |line: usize| line / stride * (stride * size) + line % stride;
    let power = pieces(lines.div_ceil(WIDTH), |blocks| {
        let (mut power, mut x) = (vec![0.0; n], vec![[[0.0; WIDTH]; 2]; n]);
        for block in blocks {
            let ahead = block * WIDTH..((block + 1) * WIDTH).min(lines);
            // s₁ + is₂ first, then s₃.
            for parts in [&[0, 1][..], &[2]] {
                x.fill([[0.0; WIDTH]; 2]);
                for (p, line) in ahead.clone().enumerate() {
                    for (k, x) in x.iter_mut().take(size).enumerate() {
                        let s = lattice.spin(y, begin(line) + k * stride, 0);
                        parts.iter().enumerate().for_each(|(part, c)| x[part][p] = s[*c]);
                    }
                }
                transform(&mut x, &twiddles);
                let square = |[re, im]: &Complex| -> f64 {
                    (0..WIDTH).map(|p| re[p] * re[p] + im[p] * im[p]).sum()
                };
                power.iter_mut().zip(&x).for_each(|(sum, x)| *sum += square(x));
            }
        }
        power
    });
    let total = |k: usize| power.iter().map(|piece| piece[k]).sum::<f64>();
    let power: Vec<f64> = (0..n).map(total).collect();
    let cosines: Vec<f64> = (0..n).map(|k| turn(k, n)[0]).collect();
    let open = |r: usize| {
        let terms = power.iter().enumerate().map(|(k, power)| power * cosines[k * r % n]);
        terms.sum::<f64>() / n as f64
    };
    let open: Vec<f64> = (0..size).map(open).collect();
    if shape.is_periodic(axis) {
        let around = |r: usize| if r == 0 { 0.0 } else { open[size - r] };
        (0..=size / 2).map(|r| (open[r] + around(r)) / sites as f64).collect()
    } else {
        (0..size).map(|r| open[r] / ((size - r) * lines) as f64).collect()
    }
}
