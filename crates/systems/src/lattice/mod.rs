//! Classical spins on a lattice.
//!
//! A [`SpinLattice`] has spins sᵢ ∈ ℝ³ on a chain, a square or a cubic lattice, with B(y)v = (sᵢ ×
//! vᵢ). Its Casimirs are the lengths of the spins: every scheme that keeps quadratic Casimirs keeps
//! each of them on its law.
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
mod formulas;
mod layout;
mod shape;

use std::ops::Range;

use dgrad::Rule;
use real::{Row, WIDTH, dispatch};

use crate::{
    Invariant, Linearity, SystemError,
    error::finite,
    paper::valid,
    run_time::{Description, Lanes, Layout, Op, Parts, System, Weights, derived},
};
use bonds::{CHUNK, Flow, Part};
use formulas::OnTile;
use layout::{OnPaths, OnePath, TILE_ROWS, TILE_SITES};

pub use formulas::Couplings;
pub use shape::{Direction, Shape};

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
    shape: Shape,
    directions: Vec<Direction>,
    couplings: Couplings,
    /// For one path: the offsets of each direction, and the last sites of each group of 32.
    offsets: Vec<((isize, isize), bool)>,
    ends: Option<Vec<u32>>,
    parts: Vec<Part>,
    description: Description,
}

impl SpinLattice {
    /// The lattice on rows of 32 paths.
    ///
    /// # Errors
    /// [`SystemError`] if a coupling is NaN or infinite.
    pub fn on_paths(shape: Shape, couplings: Couplings) -> Result<Self, SystemError> {
        let Couplings { exchange, anisotropy, field, noise, damping, .. } = couplings;
        finite("the exchange J", exchange)?;
        finite("the anisotropy K", anisotropy)?;
        field.iter().try_for_each(|&h| finite("the field h", h).map(drop))?;
        finite("the noise σ", noise)?;
        finite("the damping α", damping)?;
        let directions = shape.directions();
        let odd = (0..3).find(|&axis| shape.is_periodic(axis) && shape.sizes()[axis] % 2 == 1);
        let parts = Part::all(&shape, &couplings);
        let exact = if damping != 0.0 {
            Err("transverse damping has no exact flow; take sexp-li".into())
        } else if let Some(axis) = odd {
            let size = shape.sizes()[axis];
            Err(format!(
                "axis {} is periodic with {size} sites, and bonds are taken in turn from even and \
                 odd sites: take an even size, an open end or sexp-li",
                axis + 1
            ))
        } else {
            Ok(Parts { number: parts.len(), preferred: true, ..Parts::default() })
        };
        let sites = shape.sites();
        let noises = if couplings.local { 3 * sites } else { 3 };
        let rule = valid(Rule::new(1));
        let mut description = Description {
            parameters: couplings.describe(&shape),
            linearity: Linearity::Affine,
            always_solvable: true,
            has_bath: damping != 0.0,
            jacobi_holds: !couplings.local,
            parts: exact,
            invariants: match sites {
                ..=SPINS_NAMED => vec![Invariant::quadratic_casimir("C", "½|sᵢ|²"); sites],
                _ => vec![Invariant::quadratic_casimir("C", "½Σ|sᵢ|²")],
            },
            ..Description::new("spin-lattice", 3 * sites, noises, rule)
        };
        description.layout.local_noise = couplings.local;
        let offsets = Vec::new();
        Ok(Self { shape, directions, couplings, offsets, ends: None, parts, description })
    }

    /// The lattice on rows that hold one path.
    ///
    /// # Errors
    /// [`SystemError`] if a coupling is NaN or infinite.
    pub fn one_path(shape: Shape, couplings: Couplings) -> Result<Self, SystemError> {
        let mut lattice = Self::on_paths(shape, couplings)?;
        let Description { dimension, noises, .. } = lattice.description;
        let mut layout = Layout::one_path(dimension, noises, 3, TILE_ROWS);
        let Self { shape, directions, .. } = &lattice;
        let sites = shape.sites();
        // One more, since the last tile may be shorter.
        layout.reach = shape.farthest().div_ceil(TILE_SITES) + 1;
        if couplings.local {
            (layout.noise_rows, layout.local_noise) = (layout.rows, true);
        }
        let offsets = directions
            .iter()
            .map(|&direction| (shape.offsets(direction), shape.is_periodic(direction.axis)))
            .collect();
        let mut ends = vec![0; sites.div_ceil(WIDTH) * directions.len()];
        for site in 0..sites {
            for (d, &direction) in directions.iter().enumerate() {
                if shape.is_last(site, direction) {
                    ends[site / WIDTH * directions.len() + d] |= 1 << (site % WIDTH);
                }
            }
        }
        (lattice.offsets, lattice.ends) = (offsets, Some(ends));
        lattice.description.layout = layout;
        Ok(lattice)
    }

    /// The shape.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Component c of a site on path p.
    fn at(&self, y: &[Row], site: usize, c: usize, p: usize) -> f64 {
        let (row, lane) = self.description.layout.place(3 * site + c);
        y[row][lane + p]
    }

    /// The paths of a row, by their places in it.
    fn lanes(&self) -> Range<usize> {
        if self.ends.is_some() { 0..1 } else { 0..WIDTH }
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
        let (couplings, directions) = (self.couplings, self.directions.len());
        match &self.ends {
            None => {
                let layout = OnPaths { shape: &self.shape, directions: &self.directions };
                dispatch(OnTile { layout, directions, couplings, tile, op, h, out });
            }
            Some(ends) => {
                let sites = self.shape.sites();
                let layout = OnePath { sites, offsets: &self.offsets, ends };
                dispatch(OnTile { layout, directions, couplings, tile, op, h, out });
            }
        }
    }

    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, _: &mut [Row]) {
        let Couplings { exchange, anisotropy, field, noise, local, .. } = self.couplings;
        *out = [0.0; WIDTH];
        for p in self.lanes() {
            for site in 0..self.shape.sites() {
                let s = [0, 1, 2].map(|c| self.at(y, site, c, p));
                let up = self.directions.iter().filter(|direction| direction.up);
                for next in up.filter_map(|&direction| self.shape.neighbour(site, direction)) {
                    let product: f64 = (0..3).map(|c| s[c] * self.at(y, next, c, p)).sum();
                    out[p] -= exchange * h.dt * product;
                }
                out[p] -= 0.5 * anisotropy * h.dt * s[2] * s[2];
                for c in 0..3 {
                    let dw = if local { self.at(h.dw, site, c, p) } else { h.dw[c][p] };
                    out[p] -= (field[c] * h.dt + noise * dw) * s[c];
                }
            }
        }
    }

    fn flow(&self, part: usize, y: &mut [Row], h: Weights<'_>, _: &mut [Row]) {
        let (shape, couplings, part) = (&self.shape, self.couplings, self.parts[part]);
        match self.description.layout.lanes {
            Lanes::Paths => dispatch(Flow::<CHUNK> { shape, couplings, part, h, y }),
            Lanes::Components => dispatch(Flow::<1> { shape, couplings, part, h, y }),
        }
    }

    fn invariant(&self, index: usize, y: &[Row], out: &mut Row, _: &mut [Row]) {
        let sites = self.shape.sites();
        let spins = if sites <= SPINS_NAMED { index..index + 1 } else { 0..sites };
        *out = [0.0; WIDTH];
        for site in spins {
            for c in 0..3 {
                for p in self.lanes() {
                    out[p] += 0.5 * self.at(y, site, c, p).powi(2);
                }
            }
        }
    }
}
