//! Where the spins of a lattice are in the rows of a state.
//!
//! The formulas of the lattice are written for 32 spins at once: those of one site on 32 paths, or
//! those of 32 consecutive sites on one path.

use std::ops::Range;

use real::{Row, WIDTH};

use super::shape::{Direction, Shape};

/// Sites of a tile of one large path; a power of two. Its states take 24 KiB each.
pub const TILE_SITES: usize = 1024;
/// Rows of such a tile.
pub const TILE_ROWS: usize = 3 * TILE_SITES / WIDTH;

/// 32 spins: rows of their x, y and z.
pub type Spins = [Row; 3];

/// A layout of the spins.
pub trait SpinRows: Copy + Sync {
    /// Whether the x of all spins of a tile come first, then the y, then the z.
    const PLANES: bool;
    /// Adds to `sum` the spins next to those of a group in a direction, where there are some.
    fn add_neighbours(
        self,
        tile: &Range<usize>,
        group: usize,
        direction: usize,
        y: &[Row],
        sum: &mut Spins,
    );
}

/// Component c of site i in row 3i + c, on 32 paths.
#[derive(Clone, Copy)]
pub struct OnPaths<'a> {
    pub shape: &'a Shape,
    pub directions: &'a [Direction],
}

impl SpinRows for OnPaths<'_> {
    const PLANES: bool = false;

    #[inline(always)]
    fn add_neighbours(
        self,
        tile: &Range<usize>,
        group: usize,
        direction: usize,
        y: &[Row],
        sum: &mut Spins,
    ) {
        let neighbour = self.shape.neighbour(tile.start / 3 + group, self.directions[direction]);
        if let Some(site) = neighbour {
            add(sum, [&y[3 * site], &y[3 * site + 1], &y[3 * site + 2]]);
        }
    }
}

/// Tiles of [`TILE_SITES`] sites of one path: the x of all of them, then the y, then the z. The
/// last tile has the groups of 32 that are left.
#[derive(Clone, Copy)]
pub struct OnePath<'a> {
    pub sites: usize,
    /// Offsets inside and across a periodic end, and whether the axis is periodic.
    pub offsets: &'a [((isize, isize), bool)],
    /// For each group of 32 sites and direction, the sites that are the last ones.
    pub ends: &'a [u32],
}

/// The number of the x of a site among those of one path, and how many numbers further its y is, as
/// [`Layout::place`](crate::run_time::Layout::place) says: by constants, which saves divisions.
#[inline(always)]
pub fn place(sites: usize, site: usize) -> (usize, usize) {
    let tile = site / TILE_SITES;
    let left = (sites - tile * TILE_SITES).next_multiple_of(WIDTH);
    let plane = if left < TILE_SITES { left } else { TILE_SITES };
    (tile * TILE_ROWS * WIDTH + site % TILE_SITES, plane)
}

impl OnePath<'_> {
    /// The spins at sites first to first + 31, if they are on one tile.
    #[inline(always)]
    fn place_of(self, first: isize, y: &[Row]) -> Option<[&Row; 3]> {
        if first < 0 || first as usize + WIDTH > self.sites {
            return None;
        }
        let (begin, plane) = place(self.sites, first as usize);
        if first as usize % TILE_SITES + WIDTH > plane {
            return None;
        }
        let numbers = y.as_flattened();
        Some([
            numbers[begin..].first_chunk()?,
            numbers[begin + plane..].first_chunk()?,
            numbers[begin + 2 * plane..].first_chunk()?,
        ])
    }

    /// The spins at sites first to first + 31; zero outside of the lattice.
    #[inline(always)]
    fn load(self, first: isize, y: &[Row]) -> Spins {
        match self.place_of(first, y) {
            Some([x, y, z]) => [*x, *y, *z],
            None => self.load_each(first, y),
        }
    }

    /// Loads the spins site by site, where they are on two tiles or at an end.
    #[cold]
    #[inline(never)]
    fn load_each(self, first: isize, y: &[Row]) -> Spins {
        let (numbers, mut spins) = (y.as_flattened(), [[0.0; WIDTH]; 3]);
        for lane in 0..WIDTH {
            let site = first + lane as isize;
            if site >= 0 && (site as usize) < self.sites {
                let (begin, plane) = place(self.sites, site as usize);
                for c in 0..3 {
                    spins[c][lane] = numbers[begin + c * plane];
                }
            }
        }
        spins
    }
}

impl SpinRows for OnePath<'_> {
    const PLANES: bool = true;

    #[inline(always)]
    fn add_neighbours(
        self,
        tile: &Range<usize>,
        group: usize,
        direction: usize,
        y: &[Row],
        sum: &mut Spins,
    ) {
        let number = tile.start / 3 + group;
        let first = (number * WIDTH) as isize;
        let ends = self.ends[number * self.offsets.len() + direction];
        let ((inside, across), periodic) = self.offsets[direction];
        if ends == 0 {
            return match self.place_of(first + inside, y) {
                Some(spins) => add(sum, spins),
                None => add(sum, self.load_each(first + inside, y).each_ref()),
            };
        }
        let near = self.load(first + inside, y);
        let far = if periodic { self.load(first + across, y) } else { [[0.0; WIDTH]; 3] };
        // Products with 1 and 0 and no choice, of which the compiler makes one of addresses.
        let mut weights = [[0.0; WIDTH]; 2];
        for p in 0..WIDTH {
            let end = f64::from(ends >> p & 1);
            (weights[0][p], weights[1][p]) = (1.0 - end, end);
        }
        for c in 0..3 {
            for p in 0..WIDTH {
                sum[c][p] += near[c][p] * weights[0][p] + far[c][p] * weights[1][p];
            }
        }
    }
}

/// Adds spins.
#[inline(always)]
fn add(sum: &mut Spins, [x, y, z]: [&Row; 3]) {
    let [sum_x, sum_y, sum_z] = sum;
    for p in 0..WIDTH {
        sum_x[p] += x[p];
    }
    for p in 0..WIDTH {
        sum_y[p] += y[p];
    }
    for p in 0..WIDTH {
        sum_z[p] += z[p];
    }
}
