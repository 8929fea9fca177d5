//! Samplers of Lévy areas given the increments, for a block of paths and for one path. Both call
//! the same functions, so they give the same bits.

use std::f64::consts::{SQRT_2, TAU};

use real::{Block, Kernel, dispatch};

use crate::{
    AreaBlock, StreamKey, area_method::AreaMethod, box_muller::fill_pair, stream::BlockStreams,
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

/// Sampler of the Lévy areas of M Wiener processes on 32 consecutive paths, given the increments.
///
/// A path consumes its normals term by term and noise by noise, each (X, Y) one Box–Muller pair.
/// The normals of the tail follow: first Ψ, then g_12, g_13, …, g_23, …. If their number is odd,
/// the second normal of the last pair is dropped, so the streams are the only state between steps.
/// Steps may differ in size.
///
/// A method of strong order one needs areas with an error of at most h^{3/2} in each step:
///
/// ```
/// use noise::{AreaBlock, AreaMethod, AreaPath, AreaSampler, StreamKey, WienerBlock};
/// use noise::{stratonovich, strong_order_one_error};
/// use real::Block;
///
/// let key = StreamKey { seed: 1, experiment: 7 };
/// let tau: f64 = 1.0 / 4096.0;
/// let (method, terms) = AreaMethod::cheapest(strong_order_one_error(tau), tau, 3)?;
/// assert_eq!((method, terms), (AreaMethod::MrongowiusRoessler, 11));
///
/// let mut noise = WienerBlock::<3>::new(key, 0);
/// let mut sampler = AreaSampler::<3>::new(key, 0, method, terms);
/// let (mut dw, mut areas) = (Block::zero(), AreaBlock::zero());
/// noise.increments(tau.sqrt(), &mut dw);
/// sampler.areas(tau, &dw, &mut areas);
///
/// // Path 17 alone has the same areas; J_ij + J_ji = W_i W_j.
/// let mut path = AreaPath::<3>::new(key, 17, method, terms);
/// let (w, a) = (dw.path(17), path.areas(tau, dw.path(17)));
/// assert_eq!(a, areas.path(17));
/// let j = stratonovich(w, a);
/// assert!((j[0][2] + j[2][0] - w[0] * w[2]).abs() < 1e-18);
/// # Ok::<(), noise::NoiseError>(())
/// ```
#[derive(Clone, Debug)]
pub struct AreaSampler<const M: usize> {
    streams: BlockStreams,
    series: Series,
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

impl<const M: usize> AreaSampler<M> {
    /// The sampler of paths `first_path` .. `first_path + 32`, by `method` with `terms` terms of
    /// the series. [`AreaMethod::cheapest`] chooses both.
    pub fn new(key: StreamKey, first_path: u64, method: AreaMethod, terms: usize) -> Self {
        Self {
            streams: BlockStreams::new(key.of_areas(), first_path),
            series: Series::new(method, terms),
        }
    }

    /// The areas over the next step of size `step` > 0, given its *untruncated* increments `dw`.
    ///
    /// With fewer than two noises the areas are zero and nothing is drawn.
    #[inline]
    pub fn areas(&mut self, step: f64, dw: &Block<M>, areas: &mut AreaBlock<M>) {
        *areas = AreaBlock::zero();
        if M > 1 {
            let words = &mut self.streams.0;
            dispatch(Draw { words, series: self.series, step, dw: &dw.0, areas: &mut areas.0 });
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
                areas: &mut upper,
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
struct Draw<'a, const M: usize, const L: usize> {
    words: &'a mut [[u64; L]; 4],
    series: Series,
    step: f64,
    dw: &'a [[f64; L]; M],
    areas: &'a mut [[[f64; L]; M]; M],
}

/// Scratch rows of L paths, aligned as blocks are.
#[repr(align(64))]
struct Rows<const M: usize, const L: usize>([[f64; L]; M]);

impl<const M: usize, const L: usize> Rows<M, L> {
    #[inline(always)]
    fn zero() -> Self {
        Self([[0.0; L]; M])
    }
}

impl<const M: usize, const L: usize> Kernel for Draw<'_, M, L> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { words, series: Series { method, terms, tail_amplitude }, step, dw, areas } =
            self;
        let per_root = 1.0 / step.sqrt();
        // w = W/√h, and √2 w.
        let (mut w, mut shift) = (Rows::<M, L>::zero(), Rows::<M, L>::zero());
        for i in 0..M {
            for p in 0..L {
                w.0[i][p] = dw[i][p] * per_root;
                shift.0[i][p] = w.0[i][p] * SQRT_2;
            }
        }
        let (mut x, mut z) = (Rows::<M, L>::zero(), Rows::<M, L>::zero());
        for r in 1..=terms {
            let weight = 1.0 / r as f64;
            for i in 0..M {
                fill_pair(words, &mut x.0[i], &mut z.0[i], weight, 1.0);
                for p in 0..L {
                    z.0[i][p] -= shift.0[i][p];
                }
            }
            add_wedges(areas, &x.0, &z.0);
        }
        let tail = draw_tail::<M, L>(words, method.tail_normals(M), tail_amplitude);
        match method {
            AreaMethod::Fourier => {}
            AreaMethod::Milstein => add_wedges(areas, &w.0, &tail.0[0]),
            AreaMethod::Wiktorsson => {
                add_pairs(areas, &tail, 0);
                add_given_w(areas, &w, &tail);
            }
            AreaMethod::MrongowiusRoessler => {
                // The first M places of the tail are aΨ.
                add_wedges(areas, &w.0, &tail.0[0]);
                add_pairs(areas, &tail, M);
            }
        }
        let scale = step / TAU;
        for i in 0..M {
            for j in i + 1..M {
                for p in 0..L {
                    areas[i][j][p] *= scale;
                }
            }
        }
    }
}

/// A_ij += x_i z_j − x_j z_i.
#[inline(always)]
fn add_wedges<const M: usize, const L: usize>(
    areas: &mut [[[f64; L]; M]; M],
    x: &[[f64; L]; M],
    z: &[[f64; L]; M],
) {
    for i in 0..M {
        for j in i + 1..M {
            for p in 0..L {
                areas[i][j][p] += x[i][p] * z[j][p] - x[j][p] * z[i][p];
            }
        }
    }
}

/// The normals of a tail, numbered row by row. M² places suffice for M(M+1)/2 normals and the one
/// that is dropped.
#[repr(align(64))]
struct Tail<const M: usize, const L: usize>([[[f64; L]; M]; M]);

/// Draws `count` normals for each path and multiplies them by `amplitude`.
#[inline(always)]
fn draw_tail<const M: usize, const L: usize>(
    words: &mut [[u64; L]; 4],
    count: usize,
    amplitude: f64,
) -> Tail<M, L> {
    let mut tail = Tail([[[0.0; L]; M]; M]);
    let mut places = &mut tail.0.as_flattened_mut()[..count.next_multiple_of(2)];
    while let [first, second, rest @ ..] = places {
        fill_pair(words, first, second, amplitude, amplitude);
        places = rest;
    }
    tail
}

/// A_ij += a g_ij; the a g_ij begin at place `first` of the tail.
#[inline(always)]
fn add_pairs<const M: usize, const L: usize>(
    areas: &mut [[[f64; L]; M]; M],
    tail: &Tail<M, L>,
    first: usize,
) {
    let mut place = first;
    for i in 0..M {
        for j in i + 1..M {
            let g = &tail.0[place / M][place % M];
            for p in 0..L {
                areas[i][j][p] += g[p];
            }
            place += 1;
        }
    }
}

/// A += [(Gw)wᵀ − w(Gw)ᵀ]/(1 + √(1+|w|²)); the entries i < j of the skew G are the first places of
/// the tail.
#[inline(always)]
fn add_given_w<const M: usize, const L: usize>(
    areas: &mut [[[f64; L]; M]; M],
    w: &Rows<M, L>,
    tail: &Tail<M, L>,
) {
    let mut gw = Rows::<M, L>::zero();
    let mut norm = Rows::<1, L>::zero();
    let mut place = 0;
    for i in 0..M {
        for p in 0..L {
            norm.0[0][p] += w.0[i][p] * w.0[i][p];
        }
        for j in i + 1..M {
            let g = &tail.0[place / M][place % M];
            for p in 0..L {
                gw.0[i][p] += g[p] * w.0[j][p];
                gw.0[j][p] -= g[p] * w.0[i][p];
            }
            place += 1;
        }
    }
    for i in 0..M {
        for p in 0..L {
            gw.0[i][p] /= 1.0 + (1.0 + norm.0[0][p]).sqrt();
        }
    }
    add_wedges(areas, &gw.0, &w.0);
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
