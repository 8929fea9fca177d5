//! Classical spins on a lattice.
//!
//! A [`SpinLattice`] has spins sᵢ ∈ ℝ³ on a chain, a square, a cubic lattice or any [`Crystal`],
//! with B(y)v = (sᵢ × vᵢ). Its Casimirs are the lengths of the spins: every scheme that keeps
//! quadratic Casimirs keeps each of them on its law.
//!
//! **Transverse damping.** Bv with v = ∇H₀dt + α(s × ∇H₀)dt/|s| + Σ∇HₘdWₘ is of the form of the
//! equation and leaves the lengths alone. With |s| = 1 and local noise it is the stochastic
//! Landau–Lifshitz equation
//!
//! ds = (s × ∇H₀ + αs × (s × ∇H₀)) dt − σs × ∘dW.
//!
//! **Temperature.** On the product of spheres s × (s × ∇H₀) is minus the tangential gradient of H₀,
//! and the noise has the generator ½σ²Δ. The precession s × ∇H₀ keeps H₀ and volumes. So exp(−βH₀)
//! is stationary where α∇H₀e^{−βH₀} = ½σ²β∇H₀e^{−βH₀}: σ² = 2α/β, see
//! [`noise_at_temperature`]. The damping does not act on the noise here. Where it does, as in the
//! equation dsᵢ = sᵢ × (1 + αsᵢ×)(∇H₀dt − σ∘dW), the noise has the generator ½σ²(1 + α²)Δ, and
//! σ² = 2α/(β(1 + α²)).

mod bonds;
mod cell;
mod crystal;
mod field;
mod formulas;
mod layout;
mod shape;

use std::ops::Range;

use dgrad::Rule;
use real::{Row, WIDTH, dispatch};

use crate::{
    Invariant, Linearity, SystemError,
    cayley::cross,
    error::finite,
    paper::valid,
    run_time::{Description, InTime, Lanes, Layout, Op, Parts, System, Weights, derived},
};
use bonds::{CHUNK, Flow, Part};
use field::OnSpins;
use formulas::{OnTile, energy_on_tile};
use layout::{OnPaths, OnePath, Sites, TILE_ROWS, TILE_SITES, place};

pub use cell::{Cell, LATTICES, Pair};
pub use crystal::{Bond, Crystal, Material};
pub use field::Field;
pub use formulas::Couplings;
pub use shape::Shape;

/// σ = √(2α/β) at the temperature 1/β: with local noise and |s| = 1 the equilibrium is exp(−βH₀).
///
/// ```
/// let (alpha, beta) = (0.1, 5.0);
/// let sigma = systems::lattice::noise_at_temperature(alpha, 1.0 / beta);
/// assert_eq!(sigma, 0.2);
/// ```
#[must_use]
pub fn noise_at_temperature(damping: f64, temperature: f64) -> f64 {
    (2.0 * damping * temperature).sqrt()
}

/// Classical spins on a lattice: H₀ = −J Σ sᵢ·sⱼ − ½K Σ (sᵢᶻ)² − h·Σ sᵢ, noise that is common or
/// local, and transverse damping; see the [module](self).
///
/// The state has the components x, y and z of spin 1, then of spin 2, and so on. With
/// [`on_paths`](Self::on_paths) rows hold 32 paths, with [`one_path`](Self::one_path) they hold one
/// path of many spins.
///
/// ```
/// use systems::lattice::{Couplings, Shape, SpinLattice};
/// use systems::run_time::System;
///
/// let couplings = Couplings { exchange: 1.0, noise: 0.1, local: true, ..Couplings::default() };
/// let lattice = SpinLattice::one_path(Shape::periodic(&[100, 100, 100])?, couplings)?;
/// assert_eq!(lattice.description().noises, 3_000_000);
/// # Ok::<(), systems::SystemError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SpinLattice {
    sites: Sites,
    field: Field,
    local: bool,
    damped: bool,
    parts: Vec<Part>,
    description: Description,
}

impl SpinLattice {
    /// The lattice on rows of 32 paths.
    ///
    /// # Errors
    /// [`SystemError`] if a coupling is NaN or infinite.
    pub fn on_paths(shape: Shape, couplings: Couplings) -> Result<Self, SystemError> {
        Self::cubic(shape, couplings, Lanes::Paths)
    }

    /// The lattice on rows that hold one path.
    ///
    /// # Errors
    /// [`SystemError`] if a coupling is NaN or infinite.
    pub fn one_path(shape: Shape, couplings: Couplings) -> Result<Self, SystemError> {
        Self::cubic(shape, couplings, Lanes::Components)
    }

    fn cubic(shape: Shape, couplings: Couplings, lanes: Lanes) -> Result<Self, SystemError> {
        let crystal = Crystal::cubic(shape, &couplings);
        let words = couplings.describe(&crystal.shape);
        let mut lattice = Self::new(crystal, couplings.field, couplings.local, lanes)?;
        lattice.description.parameters = words;
        Ok(lattice)
    }

    /// A crystal in a field, with noise that is `local` or common to all spins, on rows of 32 paths
    /// or of one path.
    ///
    /// # Errors
    /// [`SystemError`] if a number is NaN or infinite, there is not a material for each site of the
    /// cell, or a periodic axis is too short for its bonds.
    pub fn new(
        crystal: Crystal,
        field: impl Into<Field>,
        local: bool,
        lanes: Lanes,
    ) -> Result<Self, SystemError> {
        let (crystal, field) = (crystal.checked()?, field.into());
        let depends_on_time = matches!(&field, Field::Of { depends_on_time: true, .. });
        let own_scratch_rows = match &field {
            Field::Constant(h) => {
                h.iter().try_for_each(|&h| finite("the field h", h).map(drop))?;
                0
            }
            Field::Of { scratch_rows, .. } => *scratch_rows,
        };
        let damped = crystal.materials.iter().any(|of| of.damping != 0.0);
        let parts = Part::all(&crystal);
        let exact = match &parts {
            _ if damped => Err("transverse damping has no exact flow".into()),
            _ if own_scratch_rows > 0 => Err("a field by formulas has no flow".into()),
            Err(reason) => Err(reason.clone()),
            Ok(parts) => Ok(Parts { number: parts.len(), preferred: true, ..Parts::default() }),
        };
        let (sites, words) = (crystal.sites(), crystal.describe());
        let noises = if local { 3 * sites } else { 3 };
        let silent = lanes == Lanes::Paths && crystal.materials.iter().all(|of| of.noise == 0.0);
        let mut description = Description {
            parameters: words,
            linearity: Linearity::Affine,
            always_solvable: true,
            depends_on_time,
            has_bath: damped,
            jacobi_holds: !local,
            additive: if silent { vec![Some(Vec::new()); noises] } else { Vec::new() },
            parts: exact,
            invariants: match sites {
                ..=SPINS_NAMED => vec![Invariant::quadratic_casimir("C", "½|sᵢ|²"); sites],
                _ => vec![Invariant::quadratic_casimir("C", "½Σ|sᵢ|²")],
            },
            ..Description::new("spin-lattice", 3 * sites, noises, valid(Rule::new(1)))
        };
        description.layout.local_noise = local;
        let mut sites = Sites::new(crystal);
        if lanes == Lanes::Components {
            let mut layout = Layout::one_path(description.dimension, noises, 3, TILE_ROWS);
            // One more, since the last tile may be shorter.
            layout.reach = sites.group().div_ceil(TILE_SITES) + 1;
            if local {
                (layout.noise_rows, layout.local_noise) = (layout.rows, true);
            }
            description.layout = layout;
        }
        if own_scratch_rows > 0 {
            let layout = &description.layout;
            description.own_scratch_rows = layout.tile_rows.min(layout.rows) + own_scratch_rows;
        }
        let parts = parts.unwrap_or_default();
        Ok(Self { sites, field, local, damped, parts, description })
    }

    /// The numbers of cells.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.sites.crystal.shape
    }

    /// The crystal.
    #[must_use]
    pub fn crystal(&self) -> &Crystal {
        &self.sites.crystal
    }

    fn is_one_path(&self) -> bool {
        self.description.layout.lanes == Lanes::Components
    }

    /// Rows of the field on a tile: three if it is constant.
    fn field_on<'a>(
        &self,
        t: f64,
        tile: &Range<usize>,
        constant: &'a mut [Row; 3],
        scratch: &'a mut [Row],
    ) -> &'a [Row] {
        match &self.field {
            Field::Constant(h) => {
                *constant = h.map(|h| [h; WIDTH]);
                constant
            }
            Field::Of { of, .. } => {
                let (rows, scratch) = scratch.split_at_mut(tile.len());
                for (group, rows) in rows.chunks_exact_mut(3).enumerate() {
                    of(t, &self.places(tile.start / 3 + group), rows, scratch);
                }
                rows
            }
        }
    }

    /// H₀ of the spins of a tile of one path; that of a bond is shared by its spins.
    #[must_use]
    pub fn energy_of_tile(
        &self,
        y: &[Row],
        t: f64,
        tile: Range<usize>,
        scratch: &mut [Row],
    ) -> f64 {
        let mut constant = [[0.0; WIDTH]; 3];
        let field = self.field_on(t, &tile, &mut constant, scratch);
        let layout = OnePath(&self.sites, self.sites.crystal.sites());
        energy_on_tile(layout, field, tile, y)
    }

    /// A spin of path p.
    #[must_use]
    pub fn spin(&self, y: &[Row], site: usize, p: usize) -> [f64; 3] {
        if !self.is_one_path() {
            return [0, 1, 2].map(|c| y[3 * site + c][p]);
        }
        let (begin, plane) = place(self.sites.crystal.sites(), site);
        [0, 1, 2].map(|c| y.as_flattened()[begin + c * plane])
    }

    /// The places of a group.
    fn places(&self, number: usize) -> [Row; 3] {
        let crystal = &self.sites.crystal;
        if !self.is_one_path() {
            return crystal.place(number).map(|r| [r; WIDTH]);
        }
        let mut places = [[0.0; WIDTH]; 3];
        for p in 0..WIDTH.min(crystal.sites() - number * WIDTH) {
            let place = crystal.place(number * WIDTH + p);
            (0..3).for_each(|c| places[c][p] = place[c]);
        }
        places
    }

    /// The paths of a row, by their places in it.
    fn lanes(&self) -> Range<usize> {
        if self.is_one_path() { 0..1 } else { 0..WIDTH }
    }
}

/// Largest number of spins with an invariant each; of more spins the invariant is the sum.
const SPINS_NAMED: usize = 16;

impl System for SpinLattice {
    fn description(&self) -> &Description {
        &self.description
    }

    fn apply(
        &self,
        op: Op<&[Row]>,
        tile: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        if op.is_average() {
            return derived(self, op, h, out, scratch);
        }
        let &Self { ref sites, local, damped, .. } = self;
        let is_read = matches!(op, Op::Gradient { .. } | Op::Hessian { .. });
        let mut constant = [[0.0; WIDTH]; 3];
        let field =
            if is_read { self.field_on(h.t, &tile, &mut constant, scratch) } else { &constant };
        if self.is_one_path() {
            let layout = OnePath(sites, sites.crystal.sites());
            dispatch(OnTile { layout, local, damped, field, tile, op, h, out });
        } else {
            let layout = OnPaths(sites);
            dispatch(OnTile { layout, local, damped, field, tile, op, h, out });
        }
    }

    /// Fields on some of the spins of each path, if they depend on time.
    fn in_time(&self, y: &[f64]) -> Option<Box<dyn InTime>> {
        let Field::Of { of, depends_on_time: true, scratch_rows } = &self.field else {
            return None;
        };
        if self.is_one_path() {
            return None;
        }
        let rows = |rows: usize| vec![[0.0; WIDTH]; rows];
        let Description { dimension, noises, .. } = self.description;
        let (mut v, mut scratch) = (rows(dimension), rows(self.description.scratch_rows()));
        let y: Vec<Row> = y.iter().map(|&y| [y; WIDTH]).collect();
        let h = Weights { t: 0.0, dt: 1.0, dw: &rows(noises), areas: &[] };
        self.apply(Op::Gradient { y: &y }, 0..dimension, h, &mut v, &mut scratch);
        let acts = |site: usize| [0, 1, 2].map(|c| -v[3 * site + c][0]);
        Some(Box::new(OnSpins::new(of.clone(), *scratch_rows, self.crystal(), acts)))
    }

    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, scratch: &mut [Row]) {
        let crystal = &self.sites.crystal;
        *out = [0.0; WIDTH];
        for site in 0..crystal.sites() {
            let (b, cell) = crystal.coordinates(site);
            let Material { anisotropy, noise, .. } = crystal.materials[b];
            let field = match &self.field {
                Field::Constant(h) => *h,
                Field::Of { of, .. } => {
                    let mut rows = [[0.0; WIDTH]; 3];
                    of(h.t, &crystal.place(site).map(|r| [r; WIDTH]), &mut rows, scratch);
                    rows.map(|row| row[0])
                }
            };
            let mine = crystal.bonds.iter().filter(|bond| bond.pair.from == b);
            let mine: Vec<(usize, &Bond)> = mine
                .filter_map(|bond| Some((crystal.site(bond.pair.to, cell, bond.pair.cells)?, bond)))
                .collect();
            for p in self.lanes() {
                let s = self.spin(y, site, p);
                for (next, Bond { exchange, antisymmetric: d, .. }) in &mine {
                    let next = self.spin(y, *next, p);
                    let product: f64 = (0..3).map(|c| s[c] * next[c]).sum();
                    out[p] -= exchange * h.dt * product;
                    let turned = cross(s, next);
                    out[p] += h.dt * (d[0] * turned[0] + d[1] * turned[1] + d[2] * turned[2]);
                }
                out[p] -= 0.5 * anisotropy * h.dt * s[2] * s[2];
                let dw = if self.local {
                    self.spin(h.dw, site, p)
                } else {
                    [0, 1, 2].map(|c| h.dw[c][p])
                };
                for c in 0..3 {
                    out[p] -= (field[c] * h.dt + noise * dw[c]) * s[c];
                }
            }
        }
    }

    fn flow(&self, part: usize, y: &mut [Row], h: Weights<'_>, _: &mut [Row]) {
        let &Self { ref sites, local, ref parts, .. } = self;
        let part = parts[part];
        // Others have no flows.
        let Field::Constant(field) = self.field else { return };
        match self.description.layout.lanes {
            Lanes::Paths => dispatch(Flow::<CHUNK> { sites, local, field, part, h, y }),
            Lanes::Components => dispatch(Flow::<1> { sites, local, field, part, h, y }),
        }
    }

    fn invariant(&self, index: usize, y: &[Row], out: &mut Row, _: &mut [Row]) {
        let sites = self.sites.crystal.sites();
        let spins = if sites <= SPINS_NAMED { index..index + 1 } else { 0..sites };
        *out = [0.0; WIDTH];
        for site in spins {
            for p in self.lanes() {
                self.spin(y, site, p).iter().for_each(|s| out[p] += 0.5 * s.powi(2));
            }
        }
    }
}
