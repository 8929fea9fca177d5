//! Where the spins of a lattice are in the rows of a state.
//!
//! The formulas of the lattice are written for 32 spins at once: those of one site on 32 paths, or
//! those of 32 consecutive sites on one path.

use std::collections::HashMap;

use real::{Row, WIDTH};

use super::{
    Material,
    crystal::{Coupling, Crystal, Neighbour},
};

/// Sites of a tile of one large path; a power of two. Its states take 24 KiB each.
pub const TILE_SITES: usize = 1024;
/// Rows of such a tile.
pub const TILE_ROWS: usize = 3 * TILE_SITES / WIDTH;

/// 32 spins: rows of their x, y and z.
pub type Spins = [Row; 3];

/// Materials of the sites of a group: K, σ and α.
#[derive(Clone, Debug)]
pub struct MaterialRows {
    pub anisotropy: Row,
    pub noise: Row,
    pub damping: Row,
}

impl MaterialRows {
    /// Rows of the materials by number.
    fn new(number: impl Fn(usize) -> Option<usize>, materials: &[Material]) -> Self {
        let row = |of: fn(&Material) -> f64| {
            std::array::from_fn(|p| number(p).map_or(0.0, |number| of(&materials[number])))
        };
        Self {
            anisotropy: row(|of| of.anisotropy),
            noise: row(|of| of.noise),
            damping: row(|of| of.damping),
        }
    }
}

/// A layout of the spins.
pub trait SpinRows: Copy + Sync {
    /// Whether the x of all spins of a tile come first, then the y, then the z.
    const PLANES: bool;

    /// Materials of a group, by its number.
    fn materials(&self, number: usize) -> &MaterialRows;

    /// Σ Js′ + D × s′ over the neighbours of the spins of a group.
    fn exchange(self, number: usize, y: &[Row]) -> Spins;
}

/// The sites of a lattice: what both layouts read.
#[derive(Clone, Debug)]
pub struct Sites {
    pub crystal: Crystal,
    pub neighbours: Vec<Neighbour>,
    pub couplings: Vec<Coupling>,
    /// Rows of one material, for each site of the cell.
    alone: Vec<MaterialRows>,
    /// Patterns of groups of 32 sites of one path, and that of each group.
    patterns: Vec<Pattern>,
    of_group: Vec<u32>,
}

/// Neighbours and materials of 32 sites.
#[derive(Clone, Debug)]
struct Pattern {
    /// For each coupling how much further neighbours are, and the sites that have them.
    neighbours: Vec<(Coupling, Vec<(isize, u32)>)>,
    materials: MaterialRows,
}

/// Origin of a pattern: number of the neighbour, distance and sites; and for each site its
/// number in the cell.
type Key = (Vec<(usize, isize, u32)>, Vec<usize>);

impl Sites {
    pub fn new(crystal: Crystal) -> Self {
        let (neighbours, couplings) = crystal.neighbours();
        let materials = &crystal.materials;
        let alone = |b: usize| MaterialRows::new(|_| Some(b), materials);
        let alone = (0..materials.len()).map(alone).collect();
        let (patterns, of_group) = (Vec::new(), Vec::new());
        Self { crystal, neighbours, couplings, alone, patterns, of_group }
    }

    /// Finds the patterns of groups of one path. Returns the largest distance of neighbours,
    /// counted around.
    pub fn group(&mut self) -> usize {
        let (sites, mut known, mut farthest) = (self.crystal.sites(), HashMap::new(), 0);
        for first in (0..sites).step_by(WIDTH) {
            let lanes = first..(first + WIDTH).min(sites);
            let at: Vec<_> = lanes.map(|site| self.crystal.coordinates(site)).collect();
            let mut key: Key = (Vec::new(), at.iter().map(|(b, _)| *b).collect());
            for (number, neighbour) in self.neighbours.iter().enumerate() {
                let begin = key.0.len();
                for (p, &(_, cell)) in at.iter().enumerate().filter(|(_, at)| at.0 == neighbour.at)
                {
                    let Some(next) = self.crystal.site(neighbour.to, cell, neighbour.cells) else {
                        continue;
                    };
                    let far = next as isize - (first + p) as isize;
                    match key.0[begin..].iter_mut().find(|(_, known, _)| *known == far) {
                        Some((.., lanes)) => *lanes |= 1 << p,
                        None => key.0.push((number, far, 1 << p)),
                    }
                }
            }
            if let Some(&pattern) = known.get(&key) {
                self.of_group.push(pattern);
                continue;
            }
            let of = |&(_, far, _): &(usize, isize, u32)| {
                far.unsigned_abs().min(sites - far.unsigned_abs())
            };
            farthest = key.0.iter().map(of).fold(farthest, usize::max);
            let with = |(k, coupling): (usize, &Coupling)| {
                let mine =
                    key.0.iter().filter(|(number, ..)| self.neighbours[*number].coupling == k);
                (*coupling, mine.map(|&(_, far, lanes)| (far, lanes)).collect::<Vec<_>>())
            };
            let with = self.couplings.iter().enumerate().map(with);
            let neighbours = with.filter(|(_, far)| !far.is_empty()).collect();
            let materials = MaterialRows::new(|p| key.1.get(p).copied(), &self.crystal.materials);
            self.of_group.push(self.patterns.len() as u32);
            known.insert(key, self.patterns.len() as u32);
            self.patterns.push(Pattern { neighbours, materials });
        }
        farthest
    }
}

/// Component c of site i in row 3i + c, on 32 paths.
#[derive(Clone, Copy)]
pub struct OnPaths<'a>(pub &'a Sites);

impl SpinRows for OnPaths<'_> {
    const PLANES: bool = false;

    #[inline(always)]
    fn materials(&self, number: usize) -> &MaterialRows {
        &self.0.alone[self.0.crystal.coordinates(number).0]
    }

    #[inline(always)]
    fn exchange(self, number: usize, y: &[Row]) -> Spins {
        let Self(Sites { crystal, neighbours, couplings, .. }) = self;
        let ((b, cell), mut field) = (crystal.coordinates(number), [[0.0; WIDTH]; 3]);
        for (k, &coupling) in couplings.iter().enumerate() {
            let mut sum = [[0.0; WIDTH]; 3];
            for of in neighbours.iter().filter(|of| of.coupling == k && of.at == b) {
                if let Some(site) = crystal.site(of.to, cell, of.cells) {
                    add(&mut sum, [&y[3 * site], &y[3 * site + 1], &y[3 * site + 2]]);
                }
            }
            couple(coupling, &sum, &mut field);
        }
        field
    }
}

/// Tiles of [`TILE_SITES`] sites of one path: the x of all of them, then the y, then the z. The
/// last tile has the groups of 32 that are left.
#[derive(Clone, Copy)]
pub struct OnePath<'a>(pub &'a Sites, pub usize);

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
        if first < 0 || first as usize + WIDTH > self.1 {
            return None;
        }
        let (begin, plane) = place(self.1, first as usize);
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
            if site >= 0 && (site as usize) < self.1 {
                let (begin, plane) = place(self.1, site as usize);
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
    fn materials(&self, number: usize) -> &MaterialRows {
        &self.0.patterns[self.0.of_group[number] as usize].materials
    }

    #[inline(always)]
    fn exchange(self, number: usize, y: &[Row]) -> Spins {
        let mut field = [[0.0; WIDTH]; 3];
        let first = (number * WIDTH) as isize;
        let all = &self.0.patterns[self.0.of_group[number] as usize].neighbours[..];
        for (coupling, neighbours) in all {
            let mut sum = [[0.0; WIDTH]; 3];
            for &(far, lanes) in neighbours {
                if lanes == u32::MAX {
                    match self.place_of(first + far, y) {
                        Some(spins) => add(&mut sum, spins),
                        None => add(&mut sum, self.load_each(first + far, y).each_ref()),
                    }
                    continue;
                }
                let spins = self.load(first + far, y);
                // Products with 1 and 0: of a choice the compiler makes one of addresses.
                let mut weights = [0.0; WIDTH];
                for p in 0..WIDTH {
                    weights[p] = f64::from(lanes >> p & 1);
                }
                for c in 0..3 {
                    for p in 0..WIDTH {
                        sum[c][p] += spins[c][p] * weights[p];
                    }
                }
            }
            // The sum is not kept beside the field where it is all of it.
            if let (&(exchange, [0.0, 0.0, 0.0]), [_]) = (coupling, all) {
                sum.as_flattened_mut().iter_mut().for_each(|s| *s *= exchange);
                return sum;
            }
            couple(*coupling, &sum, &mut field);
        }
        field
    }
}

/// Adds J times a sum of spins, and D × it.
#[inline(always)]
fn couple((exchange, d): Coupling, sum: &Spins, field: &mut Spins) {
    for c in 0..3 {
        for p in 0..WIDTH {
            field[c][p] += sum[c][p] * exchange;
        }
    }
    if d != [0.0; 3] {
        for c in 0..3 {
            let [next, last] = [(c + 1) % 3, (c + 2) % 3];
            for p in 0..WIDTH {
                field[c][p] += d[next] * sum[last][p] - d[last] * sum[next][p];
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
