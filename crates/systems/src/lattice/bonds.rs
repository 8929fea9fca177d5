//! The exact flows of a lattice, for splitting.

use real::{Kernel, Row, WIDTH, path};

use super::{
    Bond, Crystal, Material,
    layout::{Sites, place},
};
use crate::{cayley::cayley_cross, run_time::Weights};

/// The parts: field and noise, the anisotropy, and for each kind of bonds those from even and from
/// odd coordinates, or all if no two of them share a spin. All flows are rotations, by Cayley's
/// map; a bond turns both spins about their sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// h and the noise.
    Field,
    /// K.
    Anisotropy,
    /// The bonds of a kind; where an axis is given those from coordinates of this parity.
    Bonds { bond: usize, from: Option<(usize, bool)> },
}

impl Part {
    /// All parts of a lattice, or why they have no flows.
    pub fn all(crystal: &Crystal) -> Result<Vec<Self>, String> {
        let (mut parts, shape) = (vec![Self::Field], &crystal.shape);
        if crystal.materials.iter().any(|of| of.anisotropy != 0.0) {
            parts.push(Self::Anisotropy);
        }
        for (bond, Bond { pair, antisymmetric, .. }) in crystal.bonds.iter().enumerate() {
            if *antisymmetric != [0.0; 3] {
                return Err("antisymmetric exchange has no exact flow".into());
            }
            if pair.from != pair.to {
                parts.push(Self::Bonds { bond, from: None });
                continue;
            }
            let far = |axis: usize| pair.cells[axis].unsigned_abs();
            let axis = (0..3).find(|&axis| far(axis) > 0).unwrap_or(0);
            let (size, twice) = (shape.sizes()[axis], 2 * far(axis));
            if shape.is_periodic(axis) && !size.is_multiple_of(twice) {
                let even = if twice == 2 { "an even size".into() } else { format!("{twice}k") };
                return Err(format!(
                    "axis {} is periodic with {size} sites, and bonds are taken in turn from even \
                     and odd sites: take {even}, an open end or sexp-li",
                    axis + 1
                ));
            }
            parts.push(Self::Bonds { bond, from: Some((axis, false)) });
            if size > twice {
                parts.push(Self::Bonds { bond, from: Some((axis, true)) });
            }
        }
        Ok(parts)
    }
}

/// Paths that are turned at once.
pub const CHUNK: usize = 8;

/// The number of a site's x of the first path, how many numbers further its y is, and the paths.
#[inline(always)]
fn place_of<const L: usize>(sites: usize, site: usize) -> (usize, usize, usize) {
    if L == CHUNK {
        return (3 * WIDTH * site, WIDTH, WIDTH);
    }
    let (begin, plane) = place(sites, site);
    (begin, plane, L)
}

#[inline(always)]
fn get<const L: usize>(numbers: &[f64], (begin, plane): (usize, usize)) -> [[f64; L]; 3] {
    let mut spins = [[0.0; L]; 3];
    for c in 0..3 {
        spins[c].copy_from_slice(&numbers[begin + c * plane..][..L]);
    }
    spins
}

#[inline(always)]
fn put<const L: usize>(numbers: &mut [f64], (begin, plane): (usize, usize), s: &[[f64; L]; 3]) {
    for c in 0..3 {
        numbers[begin + c * plane..][..L].copy_from_slice(&s[c]);
    }
}

/// The flow of a part; L is [`CHUNK`] for rows of paths, 1 for rows of one path.
pub struct Flow<'a, const L: usize> {
    pub sites: &'a Sites,
    pub local: bool,
    pub field: [f64; 3],
    pub part: Part,
    pub h: Weights<'a>,
    pub y: &'a mut [Row],
}

impl<const L: usize> Kernel for Flow<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { sites: Sites { crystal, .. }, local, field, part, h, y } = self;
        let sites = crystal.sites();
        let (y, noises) = (y.as_flattened_mut(), h.dw.as_flattened());
        for site in 0..sites {
            let ((begin, plane, paths), (b, cell)) =
                (place_of::<L>(sites, site), crystal.coordinates(site));
            if let Part::Bonds { bond, from } = part {
                let Bond { pair, exchange, .. } = crystal.bonds[bond];
                let in_turn = |(axis, odd): (usize, bool)| {
                    cell[axis] / pair.cells[axis].unsigned_abs() % 2 == usize::from(odd)
                };
                let begins = b == pair.from && from.is_none_or(in_turn);
                let next = if begins { crystal.site(pair.to, cell, pair.cells) } else { None };
                let Some(next) = next else { continue };
                let (other, other_plane, _) = place_of::<L>(sites, next);
                for q in (0..paths).step_by(L) {
                    let mut spins: [[f64; L]; 3] = get(y, (begin + q, plane));
                    let mut others: [[f64; L]; 3] = get(y, (other + q, other_plane));
                    for p in 0..L {
                        let (a, b) = turned(path(&spins, p), path(&others, p), -exchange * h.dt);
                        set(&mut spins, p, a);
                        set(&mut others, p, b);
                    }
                    put(y, (other + q, other_plane), &others);
                    put(y, (begin + q, plane), &spins);
                }
                continue;
            }
            let Material { anisotropy, noise, .. } = crystal.materials[b];
            let of_noise = if local { (begin, plane) } else { (0, WIDTH) };
            for q in (0..paths).step_by(L) {
                let mut spins: [[f64; L]; 3] = get(y, (begin + q, plane));
                let mut dw = [[0.0; L]; 3];
                if part == Part::Field {
                    dw = get(noises, (of_noise.0 + q, of_noise.1));
                }
                for p in 0..L {
                    let (s, dw) = (path(&spins, p), path(&dw, p));
                    let axis = match part {
                        Part::Anisotropy => [0.0, 0.0, -anisotropy * h.dt * s[2]],
                        _ => [0, 1, 2].map(|c| -(field[c] * h.dt + noise * dw[c])),
                    };
                    set(&mut spins, p, cayley_cross(s, axis));
                }
                put(y, (begin + q, plane), &spins);
            }
        }
    }
}

/// Both spins of a bond, turned about their sum.
#[inline(always)]
fn turned(a: [f64; 3], b: [f64; 3], weight: f64) -> ([f64; 3], [f64; 3]) {
    let axis = [weight * (a[0] + b[0]), weight * (a[1] + b[1]), weight * (a[2] + b[2])];
    (cayley_cross(a, axis), cayley_cross(b, axis))
}

#[inline(always)]
fn set<const L: usize>(spins: &mut [[f64; L]; 3], p: usize, s: [f64; 3]) {
    for c in 0..3 {
        spins[c][p] = s[c];
    }
}
