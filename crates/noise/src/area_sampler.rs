//! Samplers of Lévy areas given the increments, for a block of paths and for one path. Both call
//! the same functions, so they give the same bits.

use std::f64::consts::{SQRT_2, TAU};

use real::{Kernel, Row, Rows, dispatch};

use crate::{
    StreamKey, area_method::AreaMethod, box_muller::fill_pair, step::zero_rows,
    stream::BlockStreams,
};

/// The bit of the experiment number that separates the streams of areas from those of increments.
/// Increments are therefore the same whether areas are drawn or not.
pub const AREA_STREAM: u64 = 1 << 62;

impl StreamKey {
    /// The key of the area streams: [`AREA_STREAM`] flipped.
    pub(crate) fn of_areas(self) -> Self {
        Self { experiment: self.experiment ^ AREA_STREAM, ..self }
    }
}

/// Sampler of the Lévy areas of Wiener processes on 32 consecutive paths, given the increments.
///
/// A path consumes its normals term by term and noise by noise, each (X, Y) one Box–Muller pair.
/// The normals of the tail follow: first Ψ, then g_12, g_13, …, g_23, …. If their number is odd,
/// the second normal of the last pair is dropped, so the streams are the only state between steps.
/// Steps may differ in size.
///
/// A method of strong order one needs areas with an error of at most h^{3/2} in each step:
///
/// ```
/// use noise::{AreaMethod, AreaPath, AreaSampler, StepNoise, StreamKey, WienerRows};
/// use noise::{stratonovich, strong_order_one_error};
///
/// let key = StreamKey { seed: 1, experiment: 7 };
/// let tau: f64 = 1.0 / 4096.0;
/// let (method, terms) = AreaMethod::cheapest(strong_order_one_error(tau), tau, 3)?;
/// assert_eq!((method, terms), (AreaMethod::MrongowiusRoessler, 11));
///
/// let mut wiener = WienerRows::new(key, 0);
/// let mut sampler = AreaSampler::new(key, 0, 3, method, terms);
/// let mut noise = StepNoise::with_areas(3);
/// wiener.increments(tau.sqrt(), &mut noise.increments);
/// sampler.areas(tau, &noise.increments, &mut noise.areas);
///
/// // Path 17 alone has the same areas; J_ij + J_ji = W_i W_j.
/// let mut path = AreaPath::<3>::new(key, 17, method, terms);
/// let drawn = noise.path::<3>(17);
/// let (w, a) = (drawn.increments, path.areas(tau, drawn.increments));
/// assert_eq!(a, drawn.areas);
/// let j = stratonovich(w, a);
/// assert!((j[0][2] + j[2][0] - w[0] * w[2]).abs() < 1e-18);
/// # Ok::<(), noise::NoiseError>(())
/// ```
#[derive(Debug)]
pub struct AreaSampler {
    streams: BlockStreams,
    series: Series,
    noises: usize,
    scratch: Rows,
}

/// The method, n, and the amplitude of its tail.
#[derive(Clone, Copy, Debug)]
struct Series {
    method: AreaMethod,
    terms: usize,
    tail_amplitude: f64,
}

impl Series {
    fn new(method: AreaMethod, terms: usize) -> Self {
        Self { method, terms, tail_amplitude: AreaMethod::tail_amplitude(terms) }
    }
}

impl AreaSampler {
    /// The sampler of `noises` noises on the paths `first_path` .. `first_path + 32`, by `method`
    /// with `terms` terms of the series. [`AreaMethod::cheapest`] chooses both.
    ///
    /// # Panics
    /// If there is no memory for it.
    pub fn new(
        key: StreamKey,
        first_path: u64,
        noises: usize,
        method: AreaMethod,
        terms: usize,
    ) -> Self {
        Self {
            streams: BlockStreams::new(key.of_areas(), first_path),
            series: Series::new(method, terms),
            noises,
            scratch: zero_rows(scratch_rows(noises)),
        }
    }

    /// The areas over the next step of size `step` > 0, given its *untruncated* increments `dw`, a
    /// row for each noise; `areas` has the rows of [`StepNoise::areas`](crate::StepNoise).
    ///
    /// With fewer than two noises the areas are zero and nothing is drawn.
    ///
    /// # Panics
    /// If there are fewer rows.
    pub fn areas(&mut self, step: f64, dw: &[Row], areas: &mut [Row]) {
        let Self { streams, series, noises, scratch } = self;
        areas.fill([0.0; real::WIDTH]);
        if *noises > 1 {
            let (words, dw) = (&mut streams.0, &dw[..*noises]);
            dispatch(Draw { words, series: *series, step, dw, areas, scratch });
        }
    }
}

/// Sampler of the Lévy areas of one path, with the same bits as that path of an [`AreaSampler`].
#[derive(Clone, Debug)]
pub struct AreaPath<const M: usize> {
    words: [[u64; 1]; 4],
    series: Series,
}

impl<const M: usize> AreaPath<M> {
    /// The sampler of path `path`, by `method` with `terms` terms of the series.
    pub fn new(key: StreamKey, path: u64, method: AreaMethod, terms: usize) -> Self {
        Self {
            words: key.of_areas().state(path).map(|word| [word]),
            series: Series::new(method, terms),
        }
    }

    /// The skew matrix of areas over the next step of size `step` > 0, given its *untruncated*
    /// increment `dw`.
    pub fn areas(&mut self, step: f64, dw: [f64; M]) -> [[f64; M]; M] {
        let mut upper = [[[0.0]; M]; M];
        if M > 1 {
            Draw {
                words: &mut self.words,
                series: self.series,
                step,
                dw: &dw.map(|w| [w]),
                areas: upper.as_flattened_mut(),
                scratch: &mut vec![[0.0]; scratch_rows(M)],
            }
            .run();
        }
        let mut areas = [[0.0; M]; M];
        for i in 0..M {
            for j in 0..M {
                areas[i][j] = upper[i][j][0] - upper[j][i][0];
            }
        }
        areas
    }
}

/// Adds the areas of one step of L paths to `areas`, which must be zero.
struct Draw<'a, const L: usize> {
    words: &'a mut [[u64; L]; 4],
    series: Series,
    step: f64,
    /// A row for each of M noises.
    dw: &'a [[f64; L]],
    /// M rows of M.
    areas: &'a mut [[f64; L]],
    scratch: &'a mut [[f64; L]],
}

/// The rows that a step of so many noises needs: five times a row for each noise, and the normals
/// of the tail. M² places suffice for M(M+1)/2 normals and the one that is dropped.
fn scratch_rows(noises: usize) -> usize {
    noises * (noises + 5)
}

impl<const L: usize> Kernel for Draw<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self {
            words,
            series: Series { method, terms, tail_amplitude },
            step,
            dw,
            areas,
            scratch,
        } = self;
        let noises = dw.len();
        let (w, scratch) = scratch.split_at_mut(noises);
        let (shift, scratch) = scratch.split_at_mut(noises);
        let (x, scratch) = scratch.split_at_mut(noises);
        let (z, scratch) = scratch.split_at_mut(noises);
        let (gw, tail) = scratch.split_at_mut(noises);
        let per_root = 1.0 / step.sqrt();
        // w = W/√h, and √2 w.
        for i in 0..noises {
            for p in 0..L {
                w[i][p] = dw[i][p] * per_root;
                shift[i][p] = w[i][p] * SQRT_2;
            }
        }
        for r in 1..=terms {
            let weight = 1.0 / r as f64;
            for i in 0..noises {
                fill_pair(words, &mut x[i], &mut z[i], weight, 1.0);
                for p in 0..L {
                    z[i][p] -= shift[i][p];
                }
            }
            add_wedges(areas, x, z);
        }
        draw_tail(
            words,
            &mut tail[..method.tail_normals(noises).next_multiple_of(2)],
            tail_amplitude,
        );
        match method {
            AreaMethod::Fourier => {}
            AreaMethod::Milstein => add_wedges(areas, w, tail),
            AreaMethod::Wiktorsson => {
                add_pairs(areas, noises, tail);
                add_given_w(areas, w, tail, gw, shift);
            }
            AreaMethod::MrongowiusRoessler => {
                // The first M places of the tail are aΨ.
                add_wedges(areas, w, tail);
                add_pairs(areas, noises, &tail[noises..]);
            }
        }
        let scale = step / TAU;
        for i in 0..noises {
            for j in i + 1..noises {
                for p in 0..L {
                    areas[i * noises + j][p] *= scale;
                }
            }
        }
    }
}

/// A_ij += x_i z_j − x_j z_i; x has a row for each noise, z at least.
#[inline(always)]
fn add_wedges<const L: usize>(areas: &mut [[f64; L]], x: &[[f64; L]], z: &[[f64; L]]) {
    let noises = x.len();
    for i in 0..noises {
        for j in i + 1..noises {
            let area = &mut areas[i * noises + j];
            for p in 0..L {
                area[p] += x[i][p] * z[j][p] - x[j][p] * z[i][p];
            }
        }
    }
}

/// Draws normals for all places, an even number, and multiplies them by `amplitude`.
#[inline(always)]
fn draw_tail<const L: usize>(
    words: &mut [[u64; L]; 4],
    mut places: &mut [[f64; L]],
    amplitude: f64,
) {
    while let [first, second, rest @ ..] = places {
        fill_pair(words, first, second, amplitude, amplitude);
        places = rest;
    }
}

/// A_ij += a g_ij, pair by pair.
#[inline(always)]
fn add_pairs<const L: usize>(areas: &mut [[f64; L]], noises: usize, tail: &[[f64; L]]) {
    let mut place = 0;
    for i in 0..noises {
        for j in i + 1..noises {
            let (area, g) = (&mut areas[i * noises + j], &tail[place]);
            for p in 0..L {
                area[p] += g[p];
            }
            place += 1;
        }
    }
}

/// A += [(Gw)wᵀ − w(Gw)ᵀ]/(1 + √(1+|w|²)); the entries i < j of the skew G are the first places of
/// the tail. `norm` has a row at least.
#[inline(always)]
fn add_given_w<const L: usize>(
    areas: &mut [[f64; L]],
    w: &[[f64; L]],
    tail: &[[f64; L]],
    gw: &mut [[f64; L]],
    norm: &mut [[f64; L]],
) {
    let (noises, norm) = (w.len(), &mut norm[0]);
    gw.fill([0.0; L]);
    *norm = [0.0; L];
    let mut place = 0;
    for i in 0..noises {
        for p in 0..L {
            norm[p] += w[i][p] * w[i][p];
        }
        for j in i + 1..noises {
            let g = &tail[place];
            for p in 0..L {
                gw[i][p] += g[p] * w[j][p];
                gw[j][p] -= g[p] * w[i][p];
            }
            place += 1;
        }
    }
    for row in gw.iter_mut() {
        for p in 0..L {
            row[p] /= 1.0 + (1.0 + norm[p]).sqrt();
        }
    }
    add_wedges(areas, gw, w);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_experiments_share_the_streams_of_their_areas() {
        for experiment in [0, 5, AREA_STREAM, AREA_STREAM | 5, u64::MAX] {
            let areas = StreamKey { seed: 3, experiment }.of_areas();
            assert_eq!(areas, StreamKey { seed: 3, experiment: experiment ^ (1 << 62) });
            assert_eq!(areas.of_areas().experiment, experiment);
        }
    }
}
