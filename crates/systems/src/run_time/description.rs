//! Properties of a system known at run time, as data.

use dgrad::Rule;
use real::WIDTH;

use super::Parts;
use crate::{Invariant, Linearity};

/// Meaning of the 32 numbers of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lanes {
    /// Numbers of 32 paths: row i is component i.
    Paths,
    /// Numbers of one path. Those beyond its last component are zero and stay so.
    Components,
}

/// Layout of a state and of its noises in rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Meaning of the numbers of a row.
    pub lanes: Lanes,
    /// Number of rows of a state.
    pub rows: usize,
    /// Number of rows of a tile; the last tile may have fewer. B(y)v on a tile depends on y and v
    /// there.
    pub tile_rows: usize,
    /// Largest distance in tiles at which ∇h and ∇²h on a tile read their arguments, counted around
    /// from the last tile to the first.
    pub reach: usize,
    /// Number of components of a site. They follow each other in a state and are in different rows.
    pub site: usize,
    /// Number of rows of the increments of all noises.
    pub noise_rows: usize,
    /// Whether every component has a noise of its own, in the row and place of the component.
    /// Otherwise noise m is in row m.
    pub local_noise: bool,
}

impl Layout {
    /// Rows of one path in tiles of `tile_rows` rows, with noise m in row m. Each tile has the
    /// first components of its sites, then the second ones, and so on.
    #[must_use]
    pub fn one_path(dimension: usize, noises: usize, site: usize, tile_rows: usize) -> Self {
        let rows = site * (dimension / site).div_ceil(WIDTH);
        let reach = rows.div_ceil(tile_rows.max(1));
        let lanes = Lanes::Components;
        Self { lanes, rows, tile_rows, reach, site, noise_rows: noises, local_noise: false }
    }

    /// Whether there is more than one tile.
    #[must_use]
    pub fn is_tiled(&self) -> bool {
        self.tile_rows < self.rows
    }

    /// Row and place in it of a component, on path 0. If rows belong to one path, it is its only
    /// place; otherwise path p is p places further.
    #[must_use]
    pub fn place(&self, component: usize) -> (usize, usize) {
        if self.lanes == Lanes::Paths {
            return (component, 0);
        }
        let (site, inside) = (component / self.site, component % self.site);
        let most = self.tile_rows / self.site;
        let tile = site / (most * WIDTH);
        let place = site % (most * WIDTH);
        let plane = (self.rows / self.site - tile * most).min(most);
        (tile * self.tile_rows + inside * plane + place / WIDTH, place % WIDTH)
    }
}

/// Properties of a system known at run time.
#[derive(Clone, Debug)]
pub struct Description {
    /// The name of the system in reports.
    pub name: String,
    /// The parameters of the system in reports, for example `c = 0.5`.
    pub parameters: String,
    /// Number of components of a path.
    pub dimension: usize,
    /// Number of noises.
    pub noises: usize,
    /// Layout of a state in rows.
    pub layout: Layout,
    /// Dependence of B on y.
    pub linearity: Linearity,
    /// Components in groups that B joins, by an entry or by what an entry reads; empty if they are
    /// not known.
    pub joined: Vec<Vec<usize>>,
    /// Whether z = y + B((y+z)/2)·v has a solution for every v, see
    /// [`always_solvable`](crate::always_solvable).
    pub always_solvable: bool,
    /// The Gauss–Legendre rule for ∇̄h: n nodes are exact if ∇h is a polynomial of degree at most
    /// 2n − 1.
    pub rule: Rule,
    /// Whether Hamiltonians depend on time. B does not.
    pub depends_on_time: bool,
    /// Whether the system is an equation of drift and noises alone, without B and Hamiltonians: as
    /// operations B is the identity and ∇Hₘ the field fₘ, and there is neither ∇̄h nor an energy.
    pub plain: bool,
    /// Whether a heat bath shifts the increments of noises, so that
    /// [`Op::Gradient`](super::Op::Gradient) is more than ∇h.
    pub has_bath: bool,
    /// Parts with known flows, or why there are none.
    pub parts: Result<Parts, String>,
    /// The functions that obey the conformal law.
    pub invariants: Vec<Invariant>,
    /// Whether the system has [`Op::AreaGradient`](super::Op::AreaGradient), and −B times it was
    /// shown to be Σ_{m<l} A_ml \[fₘ, f_l\], as Jacobi's identity for B implies.
    pub jacobi_holds: bool,
    /// Whether the noises were shown to commute, see [`noises_commute`](crate::noises_commute), so
    /// that no areas are needed.
    pub noises_commute: bool,
    /// For each noise the components that fₘ moves, if fₘ does not depend on y; `None` if it does,
    /// and empty if nothing is known.
    pub additive: Vec<Option<Vec<usize>>>,
    /// Whether the fields fₘ of the noises are constant, and the second derivatives of f₀ along
    /// them zero, as in Langevin dynamics.
    pub is_langevin: bool,
    /// Whether paths may leave the domain of the system where their steps are still finite, as
    /// behind the pole of a logarithm. Then [`guard`](super::System::guard) is asked after every
    /// step.
    pub has_guard: bool,
    /// Rows of scratch for an operation that is not [derived](super::derived) from others.
    pub own_scratch_rows: usize,
}

impl Description {
    /// Whether no noise moves any component, as far as that is known.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        let moves_none = |moved: &Option<Vec<usize>>| moved.as_ref().is_some_and(Vec::is_empty);
        self.additive.len() == self.noises && self.additive.iter().all(moves_none)
    }

    /// A system on rows of 32 paths in one tile, with noise m in row m, any B, no parts, no
    /// invariants and no guard.
    ///
    /// ∇h is affine for a rule with one node.
    #[must_use]
    pub fn new(name: impl Into<String>, dimension: usize, noises: usize, rule: Rule) -> Self {
        Self {
            name: name.into(),
            parameters: String::new(),
            dimension,
            noises,
            layout: Layout {
                lanes: Lanes::Paths,
                rows: dimension,
                tile_rows: dimension,
                reach: 1,
                site: 1,
                noise_rows: noises,
                local_noise: false,
            },
            linearity: Linearity::Other,
            joined: Vec::new(),
            always_solvable: false,
            rule,
            depends_on_time: false,
            plain: false,
            has_bath: false,
            parts: Err("it names no parts".into()),
            invariants: Vec::new(),
            jacobi_holds: false,
            noises_commute: noises < 2,
            additive: Vec::new(),
            is_langevin: false,
            has_guard: false,
            own_scratch_rows: 0,
        }
    }

    /// Whether h is a polynomial of degree at most two, so that ∇̄h(a, b) = ∇h((a+b)/2). What
    /// [`Op::Gradient`](super::Op::Gradient) adds is then taken at (a+b)/2 too.
    #[must_use]
    pub fn is_quadratic(&self) -> bool {
        self.rule.nodes().len() == 1
    }

    /// Rows of scratch for any operation. Every thread has them; operations that are derived from
    /// others are for systems with one tile, so that one large path has none for them.
    #[must_use]
    pub fn scratch_rows(&self) -> usize {
        let derived = if self.layout.is_tiled() { 0 } else { 4 * self.layout.rows };
        derived + self.own_scratch_rows
    }
}
