//! The exact flows of a lattice, for splitting.

use real::{Kernel, Row, WIDTH};

use super::{
    formulas::Couplings,
    layout::{OnePath, Spins},
    shape::Shape,
};
use crate::{cayley::cayley_cross, run_time::Weights};

/// The parts: field and noise, the anisotropy, and for each axis the bonds from even and from odd
/// coordinates. All flows are rotations, by Cayley's map; a bond turns both spins about their sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// h and the noise.
    Field,
    /// K.
    Anisotropy,
    /// The bonds along an axis from coordinates of this parity.
    Bonds { axis: usize, odd: bool },
}

impl Part {
    /// All parts of a lattice.
    pub fn all(shape: &Shape, couplings: &Couplings) -> Vec<Self> {
        let mut parts = vec![Self::Field];
        if couplings.anisotropy != 0.0 {
            parts.push(Self::Anisotropy);
        }
        for axis in (0..3).filter(|&axis| shape.sizes()[axis] > 1) {
            parts.push(Self::Bonds { axis, odd: false });
            if shape.sizes()[axis] > 2 {
                parts.push(Self::Bonds { axis, odd: true });
            }
        }
        parts
    }
}

/// The flow of a part, on rows of 32 paths if `on_paths`, else on those of one path.
pub struct Flow<'a> {
    pub shape: &'a Shape,
    pub couplings: &'a Couplings,
    pub on_paths: bool,
    pub part: Part,
    pub h: Weights<'a>,
    pub y: &'a mut [Row],
}

impl Kernel for Flow<'_> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let sites = self.shape.sites();
        if self.on_paths {
            for site in 0..sites {
                self.on_block(site);
            }
        } else {
            for site in 0..sites {
                self.on_site(site);
            }
        }
    }
}

impl Flow<'_> {
    /// The second site of the bond of this part that begins at a site.
    #[inline(always)]
    fn bond(&self, site: usize, axis: usize, odd: bool) -> Option<usize> {
        let begins = self.shape.coordinate(site, axis) % 2 == usize::from(odd);
        let up = super::Direction { axis, up: true };
        if begins { self.shape.neighbour(site, up) } else { None }
    }

    /// The axis about which a spin turns in a part that has no bonds.
    #[inline(always)]
    fn axis(&self, s: [f64; 3], noise: [f64; 3]) -> [f64; 3] {
        let Couplings { anisotropy, field, noise: sigma, .. } = *self.couplings;
        match self.part {
            Part::Anisotropy => [0.0, 0.0, -anisotropy * self.h.dt * s[2]],
            _ => [0, 1, 2].map(|c| -(field[c] * self.h.dt + sigma * noise[c])),
        }
    }

    #[inline(always)]
    fn on_block(&mut self, site: usize) {
        let rows =
            |site: usize, y: &[Row]| -> Spins { [y[3 * site], y[3 * site + 1], y[3 * site + 2]] };
        let mut spins = rows(site, self.y);
        let Part::Bonds { axis, odd } = self.part else {
            let first = if self.couplings.local { 3 * site } else { 0 };
            let noise = [self.h.dw[first], self.h.dw[first + 1], self.h.dw[first + 2]];
            for p in 0..WIDTH {
                let s = lane(&spins, p);
                set(&mut spins, p, cayley_cross(s, self.axis(s, lane(&noise, p))));
            }
            self.y[3 * site..3 * site + 3].copy_from_slice(&spins);
            return;
        };
        let Some(next) = self.bond(site, axis, odd) else { return };
        let mut other = rows(next, self.y);
        let weight = -self.couplings.exchange * self.h.dt;
        for p in 0..WIDTH {
            let (a, b) = turned(lane(&spins, p), lane(&other, p), weight);
            set(&mut spins, p, a);
            set(&mut other, p, b);
        }
        self.y[3 * site..3 * site + 3].copy_from_slice(&spins);
        self.y[3 * next..3 * next + 3].copy_from_slice(&other);
    }

    #[inline(always)]
    fn on_site(&mut self, site: usize) {
        let sites = self.shape.sites();
        let place = |site: usize| [0, 1, 2].map(|c| OnePath::place(sites, site, c));
        let spin = |y: &[Row], place: [(usize, usize); 3]| place.map(|(row, lane)| y[row][lane]);
        let here = place(site);
        let s = spin(self.y, here);
        let Part::Bonds { axis, odd } = self.part else {
            let noise = match self.couplings.local {
                true => spin(self.h.dw, here),
                false => [0, 1, 2].map(|m| self.h.dw[m][0]),
            };
            let moved = cayley_cross(s, self.axis(s, noise));
            (0..3).for_each(|c| self.y[here[c].0][here[c].1] = moved[c]);
            return;
        };
        let Some(next) = self.bond(site, axis, odd) else { return };
        let there = place(next);
        let weight = -self.couplings.exchange * self.h.dt;
        let (a, b) = turned(s, spin(self.y, there), weight);
        for c in 0..3 {
            self.y[here[c].0][here[c].1] = a[c];
            self.y[there[c].0][there[c].1] = b[c];
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
fn lane(spins: &Spins, p: usize) -> [f64; 3] {
    [spins[0][p], spins[1][p], spins[2][p]]
}

#[inline(always)]
fn set(spins: &mut Spins, p: usize, s: [f64; 3]) {
    for c in 0..3 {
        spins[c][p] = s[c];
    }
}
