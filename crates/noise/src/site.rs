//! Wiener increments at the sites of one large path.

use real::{OutOfMemory, Row, WIDTH};

use crate::{StreamKey, WienerRows};

/// The bit of the experiment number that separates the streams of sites from those of paths.
pub const SITE_STREAM: u64 = 1 << 61;

/// Increments of independent Wiener processes, one for each number of the rows of a large path.
///
/// Rows are grouped in tiles, the last of which may have fewer. Every tile has 32 streams of its
/// own, with the key (seed, experiment, path, tile, lane), from which its rows are drawn one after
/// the other as by a [`WienerRows`]. So the bits of a tile do not depend on the order of the tiles,
/// nor on the thread that draws it. Numbers beyond the last component of the path are drawn too.
///
/// Memory: 1.3 KiB for each tile, whatever its length.
///
/// ```
/// use noise::{SiteNoise, StreamKey};
///
/// let key = StreamKey { seed: 1, experiment: 7 };
/// // A path of 1000 rows in tiles of 96.
/// let mut noise = SiteNoise::new(key, 0, 1000, 96)?;
/// let mut dw = real::Rows::zero(1000)?;
/// noise.tiles(&mut dw).fill(0.1);
///
/// // The same in two halves, on two threads.
/// let mut again = SiteNoise::new(key, 0, 1000, 96)?;
/// let mut same = real::Rows::zero(1000)?;
/// let (first, second) = again.tiles(&mut same).halves();
/// std::thread::scope(|threads| {
///     threads.spawn(|| second.fill(0.1));
///     first.fill(0.1);
/// });
/// assert_eq!(dw[..], same[..]);
/// # Ok::<(), real::OutOfMemory>(())
/// ```
#[derive(Clone, Debug)]
pub struct SiteNoise {
    tiles: Vec<WienerRows>,
    rows: usize,
    tile_rows: usize,
}

/// Some tiles of a path, with the rows that their increments go into.
#[derive(Debug)]
pub struct SiteTiles<'a> {
    tiles: &'a mut [WienerRows],
    dw: &'a mut [Row],
    tile_rows: usize,
}

impl SiteNoise {
    /// The noise of path number `path` with so many rows, in tiles of `tile_rows`.
    ///
    /// # Errors
    /// [`OutOfMemory`] if there is no memory for the streams.
    ///
    /// # Panics
    /// If `tile_rows` is zero.
    pub fn new(
        key: StreamKey,
        path: u32,
        rows: usize,
        tile_rows: usize,
    ) -> Result<Self, OutOfMemory> {
        let count = rows.div_ceil(tile_rows);
        let mut tiles = Vec::new();
        let bytes = count.saturating_mul(size_of::<WienerRows>());
        tiles.try_reserve_exact(count).map_err(|_| OutOfMemory { bytes })?;
        let key = StreamKey { experiment: key.experiment ^ SITE_STREAM, ..key };
        // 2³² streams a path: tiles that fit no memory would meet those of the next path.
        let first = u64::from(path) << 32;
        tiles.extend((0..count).map(|tile| WienerRows::new(key, first + (tile * WIDTH) as u64)));
        Ok(Self { tiles, rows, tile_rows })
    }

    /// All tiles, whose next increments go into `dw`.
    ///
    /// # Panics
    /// Unless `dw` has as many rows as the path.
    pub fn tiles<'a>(&'a mut self, dw: &'a mut [Row]) -> SiteTiles<'a> {
        assert_eq!(dw.len(), self.rows, "the rows of a path and of its increments");
        SiteTiles { tiles: &mut self.tiles, dw, tile_rows: self.tile_rows }
    }
}

impl SiteTiles<'_> {
    /// The number of tiles.
    #[must_use]
    pub fn count(&self) -> usize {
        self.tiles.len()
    }

    /// The first half of the tiles and the second, which may be empty.
    #[must_use]
    pub fn halves(self) -> (Self, Self) {
        let half = self.tiles.len().div_ceil(2);
        let rows = (half * self.tile_rows).min(self.dw.len());
        let (tiles, later) = self.tiles.split_at_mut(half);
        let (dw, later_dw) = self.dw.split_at_mut(rows);
        let tile_rows = self.tile_rows;
        (Self { tiles, dw, tile_rows }, Self { tiles: later, dw: later_dw, tile_rows })
    }

    /// Writes the next increments, each N(0, τ); `sqrt_tau` = √τ.
    pub fn fill(self, sqrt_tau: f64) {
        for (tile, dw) in self.tiles.iter_mut().zip(self.dw.chunks_mut(self.tile_rows)) {
            tile.increments(sqrt_tau, dw);
        }
    }
}

#[cfg(test)]
mod tests {
    use real::Rows;

    use super::*;

    const KEY: StreamKey = StreamKey { seed: 11, experiment: 4 };

    /// Fills halves of halves, the second ones first.
    fn backwards(tiles: SiteTiles<'_>, sqrt_tau: f64) {
        if tiles.count() < 2 {
            return tiles.fill(sqrt_tau);
        }
        let (first, second) = tiles.halves();
        backwards(second, sqrt_tau);
        backwards(first, sqrt_tau);
    }

    #[test]
    fn bits_do_not_depend_on_the_order_of_tiles() {
        // The last tile has an odd number of rows, so that normals are left for the next step.
        for (rows, tile) in [(1, 96), (96, 96), (97, 96), (1001, 96), (15, 3), (9, 3)] {
            let mut forward = SiteNoise::new(KEY, 2, rows, tile).unwrap();
            let mut other = forward.clone();
            let (mut dw, mut same) = (Rows::zero(rows).unwrap(), Rows::zero(rows).unwrap());
            for n in 1..5 {
                let sqrt_tau = 1.0 / f64::from(n);
                forward.tiles(&mut dw).fill(sqrt_tau);
                backwards(other.tiles(&mut same), sqrt_tau);
                assert_eq!(dw[..], same[..], "{rows} {tile}");
            }
        }
    }

    #[test]
    fn no_two_tiles_share_a_stream() {
        let mut seen = std::collections::HashSet::new();
        let mut count = 0;
        let mut dw = Rows::zero(40).unwrap();
        for experiment in [4, 5] {
            for path in [0, 1, u32::MAX] {
                let key = StreamKey { experiment, ..KEY };
                SiteNoise::new(key, path, 40, 2).unwrap().tiles(&mut dw).fill(1.0);
                for x in dw.iter().flatten() {
                    seen.insert(x.to_bits());
                    count += 1;
                }
            }
        }
        // And none with a path.
        WienerRows::new(KEY, 0).increments(1.0, &mut dw[..2]);
        dw[..2].iter().flatten().for_each(|x| assert!(!seen.contains(&x.to_bits())));
        // Of 2⁵² directions and radii each some may meet, but not here.
        assert_eq!(seen.len(), count);
    }

    #[test]
    fn increments_have_their_variance_and_no_correlation() {
        const ROWS: usize = 960;
        let mut noise = SiteNoise::new(KEY, 0, ROWS, 96).unwrap();
        let mut dw = Rows::zero(ROWS).unwrap();
        let (mut square, mut fourth, mut along, mut across) = (0.0, 0.0, 0.0, 0.0);
        let steps = 40;
        for _ in 0..steps {
            noise.tiles(&mut dw).fill(0.5);
            let x: Vec<f64> = dw.iter().flatten().map(|dw| 2.0 * dw).collect();
            for i in 0..x.len() {
                square += x[i] * x[i];
                fourth += x[i].powi(4);
                along += x[i] * x[(i + 1) % x.len()];
                across += x[i] * x[(i + 96 * WIDTH) % x.len()];
            }
        }
        let n = (ROWS * WIDTH * steps) as f64;
        // Standard errors √2, √96, 1 and 1 over √n; five of them.
        let error = 5.0 / n.sqrt();
        assert!((square / n - 1.0).abs() < 2f64.sqrt() * error, "{}", square / n);
        assert!((fourth / n - 3.0).abs() < 96f64.sqrt() * error, "{}", fourth / n);
        assert!((along / n).abs() < error && (across / n).abs() < error);
    }

    #[test]
    fn memory_that_is_not_there_is_named() {
        assert!(SiteNoise::new(KEY, 0, usize::MAX / 2, 3).is_err());
    }
}
