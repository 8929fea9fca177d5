//! Sites of a crystal, their couplings and their neighbours.

use super::{Cell, Couplings, Pair, Shape};
use crate::{SystemError, error::finite};

/// A bond of all pairs of a kind: −J s·s′ + D·(s × s′).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond {
    /// The pair: s is that of the first cell, s′ the other.
    pub pair: Pair,
    /// J.
    pub exchange: f64,
    /// D.
    pub antisymmetric: [f64; 3],
}

/// Spins of a site of the unit cell: anisotropy K, noise σ and transverse damping α.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// K.
    pub anisotropy: f64,
    /// σ.
    pub noise: f64,
    /// α.
    pub damping: f64,
}

/// Cells with spins of several materials.
///
/// Sites are counted along the first axis, then over the sites of a cell, then along the others:
/// site b of the cell (x, y, z) has the number x + L₁(b + n(y + L₂z)).
#[derive(Clone, Debug, PartialEq)]
pub struct Crystal {
    /// The unit cell.
    pub cell: Cell,
    /// Numbers of cells, and ends.
    pub shape: Shape,
    /// The bonds.
    pub bonds: Vec<Bond>,
    /// A material for each site of the cell.
    pub materials: Vec<Material>,
}

/// A neighbour of the sites number `at` of all cells.
#[derive(Clone, Copy, Debug)]
pub struct Neighbour {
    pub at: usize,
    pub to: usize,
    pub cells: [isize; 3],
    /// Number of its coupling.
    pub coupling: usize,
}

/// J and D of a neighbour.
pub type Coupling = (f64, [f64; 3]);

impl Crystal {
    /// A simple cubic lattice of one material.
    pub(super) fn cubic(shape: Shape, couplings: &Couplings) -> Self {
        let &Couplings { exchange, anisotropy, noise, damping, .. } = couplings;
        let cell = Cell::named("cubic").unwrap_or_else(|| unreachable!());
        let bond = |pair| Bond { pair, exchange, antisymmetric: [0.0; 3] };
        let bonds = cell.pairs(3, 0).into_iter().map(bond).collect();
        Self { cell, shape, bonds, materials: vec![Material { anisotropy, noise, damping }] }
    }

    /// Lattice, bonds and materials in words.
    pub(super) fn describe(&self) -> String {
        let of_bond = |bond: &Bond| {
            let Bond { pair: Pair { from, to, cells, .. }, exchange, antisymmetric } = bond;
            format!("J = {exchange}, D = {antisymmetric:?} from {from} to {to} + {cells:?}")
        };
        let of_material = |of: &Material| {
            let Material { anisotropy, noise, damping } = of;
            format!("K = {anisotropy}, σ = {noise}, α = {damping}")
        };
        let bonds = self.bonds.iter().map(of_bond);
        let all: Vec<_> = self.materials.iter().map(of_material).chain(bonds).collect();
        format!("{} {}; {}", self.cell.name, self.shape.describe(), all.join("; "))
    }

    /// The number of sites.
    #[must_use]
    pub fn sites(&self) -> usize {
        self.shape.sites() * self.materials.len()
    }

    /// The number of its site in the cell, and the cell, of a site.
    #[must_use]
    pub fn coordinates(&self, site: usize) -> (usize, [usize; 3]) {
        let ([along, across, _], each) = (self.shape.sizes(), self.materials.len());
        let (row, x) = (site / along, site % along);
        let (cell, b) = (row / each, row % each);
        (b, [x, cell % across, cell / across])
    }

    /// The place of a site in units of the lattice constant.
    #[must_use]
    pub fn place(&self, site: usize) -> [f64; 3] {
        let (b, cell) = self.coordinates(site);
        self.cell.place(b, cell.map(|cells| cells as f64))
    }

    /// The site at number b of a cell that is `cells` further, if there is one.
    pub(super) fn site(&self, b: usize, cell: [usize; 3], cells: [isize; 3]) -> Option<usize> {
        let along = |axis| self.shape.coordinate(axis, cell[axis] as isize + cells[axis]);
        let ([along_first, across, _], [x, y, z]) =
            (self.shape.sizes(), [along(0)?, along(1)?, along(2)?]);
        Some(x + along_first * (b + self.materials.len() * (y + across * z)))
    }

    /// Checks numbers and ends, and drops bonds that no pair has.
    pub(super) fn checked(mut self) -> Result<Self, SystemError> {
        let (sizes, shape, each) = (self.shape.sizes(), &self.shape, self.cell.sites.len());
        let sites = sizes.iter().try_fold(each, |all, &size| all.checked_mul(size));
        let wrong = |words: String| Err(SystemError(words));
        if self.materials.len() != each || sites.is_none_or(|sites| sites > 1 << 48) {
            return wrong(format!("a cell of {each} sites needs {each} materials, and 2^48 sites"));
        }
        let is_there = |bond: &Bond| (0..3).all(|a| bond.pair.cells[a].unsigned_abs() < sizes[a]);
        self.bonds.retain(is_there);
        for Bond { pair, exchange, antisymmetric } in &self.bonds {
            finite("the exchange J", *exchange)?;
            for d in antisymmetric {
                finite("the vector D", *d)?;
            }
            for axis in 0..3 {
                let (size, far) = (sizes[axis], pair.cells[axis].unsigned_abs());
                // Around a shorter ring two bonds join the same spins.
                if shape.is_periodic(axis) && size <= 2 * far {
                    return wrong(format!(
                        "axis {} is periodic with {size} cells, and bonds reach {far}: take at \
                         least {}",
                        axis + 1,
                        2 * far + 1
                    ));
                }
            }
        }
        for Material { anisotropy, noise, damping } in &self.materials {
            finite("the anisotropy K", *anisotropy)?;
            finite("the noise σ", *noise)?;
            finite("the damping α", *damping)?;
        }
        Ok(self)
    }

    /// The neighbours of all sites of a cell, those of a pair one after the other, and couplings.
    pub(super) fn neighbours(&self) -> (Vec<Neighbour>, Vec<Coupling>) {
        let (mut neighbours, mut couplings) = (Vec::new(), Vec::<Coupling>::new());
        for Bond { pair: Pair { from, to, cells, .. }, exchange, antisymmetric: d } in &self.bonds {
            let mut number = |coupling: Coupling| {
                couplings.iter().position(|known| *known == coupling).unwrap_or_else(|| {
                    couplings.push(coupling);
                    couplings.len() - 1
                })
            };
            // D·(s × s′) = −D·(s′ × s).
            let back = number((*exchange, d.map(|d| if d == 0.0 { 0.0 } else { -d })));
            let there = number((*exchange, *d));
            let behind = cells.map(|cells| -cells);
            neighbours.push(Neighbour { at: *to, to: *from, cells: behind, coupling: back });
            neighbours.push(Neighbour { at: *from, to: *to, cells: *cells, coupling: there });
        }
        (neighbours, couplings)
    }
}
