//! The shape of a lattice: sizes, boundaries, and who is whose neighbour.

use crate::SystemError;

/// A chain, a square or a cubic lattice, periodic or open. Site x + L₁(y + L₂z) is that of the
/// coordinates (x, y, z).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shape {
    sizes: [usize; 3],
    periodic: [bool; 3],
}

/// A direction to a neighbour: an axis, and whether its coordinate grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction {
    /// 0, 1 or 2.
    pub axis: usize,
    /// Whether the coordinate grows.
    pub up: bool,
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

    /// The distance between the numbers of neighbours along an axis.
    fn stride(&self, axis: usize) -> usize {
        self.sizes[..axis].iter().product()
    }

    /// The coordinate of a site along an axis.
    fn coordinate(&self, site: usize, axis: usize) -> usize {
        site / self.stride(axis) % self.sizes[axis]
    }

    /// Whether a site is the last one in a direction.
    fn is_last(&self, site: usize, direction: Direction) -> bool {
        let end = if direction.up { self.sizes[direction.axis] - 1 } else { 0 };
        self.coordinate(site, direction.axis) == end
    }

    /// The difference of the number of a neighbour: inside, and across a periodic end.
    fn offsets(&self, direction: Direction) -> (isize, isize) {
        let stride = self.stride(direction.axis) as isize;
        let around = stride * (self.sizes[direction.axis] as isize - 1);
        if direction.up { (stride, -around) } else { (-stride, around) }
    }

    /// The neighbour of a site, if there is one.
    #[must_use]
    pub fn neighbour(&self, site: usize, direction: Direction) -> Option<usize> {
        let (inside, across) = self.offsets(direction);
        let last = self.is_last(site, direction);
        if last && !self.periodic[direction.axis] {
            return None;
        }
        site.checked_add_signed(if last { across } else { inside })
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
