//! The shape of a lattice: sizes, boundaries, and who is whose neighbour.

use crate::SystemError;

/// A chain, a square or a cubic lattice, periodic or open. Site x + L₁(y + L₂z) is that of the
/// coordinates (x, y, z).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shape {
    sizes: [usize; 3],
    periodic: [bool; 3],
}

impl Shape {
    /// The lattice with one to three sizes, open at all ends.
    ///
    /// # Errors
    /// [`SystemError`] unless there are one to three sizes, all of them positive, whose
    /// product is at most 2⁴⁸.
    pub fn open(sizes: &[usize]) -> Result<Self, SystemError> {
        Self::new(sizes, false)
    }

    /// The lattice with one to three sizes, periodic along each axis. An axis of size one or two is
    /// open: its sites would be their own neighbours, or be joined twice.
    ///
    /// # Errors
    /// Errors of [`open`](Self::open).
    pub fn periodic(sizes: &[usize]) -> Result<Self, SystemError> {
        Self::new(sizes, true)
    }

    /// The lattice with one to three sizes, [open](Self::open) or [periodic](Self::periodic).
    ///
    /// # Errors
    /// Errors of [`open`](Self::open).
    pub fn new(given: &[usize], periodic: bool) -> Result<Self, SystemError> {
        let mut sizes = [1; 3];
        let sites = given.iter().try_fold(1usize, |sites, &size| sites.checked_mul(size));
        let fits = sites.is_some_and(|sites| sites > 0 && sites <= 1 << 48);
        if !(1..=3).contains(&given.len()) || !fits {
            return Err(SystemError(format!(
                "a lattice has one to three sizes, each at least 1, of 2^48 sites at most, got \
                 {given:?}"
            )));
        }
        sizes[..given.len()].copy_from_slice(given);
        Ok(Self { sizes, periodic: sizes.map(|size| periodic && size > 2) })
    }

    /// The sizes; 1 for axes that the lattice does not have.
    #[must_use]
    pub fn sizes(&self) -> [usize; 3] {
        self.sizes
    }

    /// Whether an axis is periodic.
    #[must_use]
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.periodic[axis]
    }

    /// The number of sites.
    #[must_use]
    pub fn sites(&self) -> usize {
        self.sizes.iter().product()
    }

    /// The coordinate along an axis, counted around a periodic one; none beyond an open end.
    pub(super) fn coordinate(&self, axis: usize, at: isize) -> Option<usize> {
        match usize::try_from(at) {
            Ok(inside) if inside < self.sizes[axis] => Some(inside),
            _ if !self.periodic[axis] => None,
            _ => Some(at.rem_euclid(self.sizes[axis] as isize) as usize),
        }
    }

    /// The neighbour of a site along an axis, `up` or down, if there is one.
    #[must_use]
    pub fn neighbour(&self, site: usize, axis: usize, up: bool) -> Option<usize> {
        let stride: usize = self.sizes[..axis].iter().product();
        let at = site / stride % self.sizes[axis];
        let next = self.coordinate(axis, at as isize + if up { 1 } else { -1 })?;
        Some(site - at * stride + next * stride)
    }

    /// Sizes and boundaries in words.
    pub(super) fn describe(&self) -> String {
        let axes = (0..3).filter(|&axis| axis == 0 || self.sizes[axis] > 1);
        let axes: Vec<String> = axes
            .map(|axis| {
                let end = if self.periodic[axis] { "periodic" } else { "open" };
                format!("{} {end}", self.sizes[axis])
            })
            .collect();
        axes.join(" × ")
    }
}
