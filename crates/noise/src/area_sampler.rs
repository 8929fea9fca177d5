//! Samplers of Lévy areas given the increments, for a block of paths and for one path. Both call
//! the same functions, so they give the same bits.

use std::f64::consts::{SQRT_2, TAU};

use real::{Kernel, Row, Rows, dispatch};

use crate::{
    Purpose, StreamKey, area_terms::trigamma_after, box_muller::fill_pair, skew,
    stream::BlockStreams,
};

/// Sampler of the Lévy areas of Wiener processes on 32 consecutive paths, given the increments.
///
/// For an increment W = √h w over a step h the method of Mrongowius and Rößler (2022, *On the
/// approximation and simulation of iterated stochastic integrals*; comparison by Kastner and Rößler
/// 2023) begins with n terms of the Fourier series of the Brownian bridge,
///
/// W(t) = Wt/h + Σ_r [a_r (cos(2πrt/h) − 1) + b_r sin(2πrt/h)].
///
/// For each noise, a_r = √(h/2)/(πr) X_r and b_r = √(h/2)/(πr) Y_r with independent standard
/// normals X_r and Y_r. The constants −a_r make W(0) = 0. In A_ij = ½∫(W_i dW_j − W_j dW_i) one has
/// ∫ t sin(2πrt/h) dt = −h²/(2πr) over a step, and all other products are orthogonal. This gives
///
/// A_ij = (h/2π) Σ_{r≥1} (1/r)[X_r^i (Y_r^j − √2 w_j) − X_r^j (Y_r^i − √2 w_i)].
///
/// With a² = 2ψ₁(n+1) = 2Σ_{r>n} r⁻², where ψ₁ is the trigamma function, the terms r > n that
/// contain w sum up to (h/2π)·a(w_iΨ_j − w_jΨ_i) *exactly*, with a standard normal Ψ for each
/// noise. The others are normal given X, with a covariance that tends to a² times the identity:
/// they are replaced by (h/2π)·a g_ij with a standard normal for each pair.
/// [`area_error`](crate::area_error) bounds the error.
///
/// A path consumes its normals term by term and noise by noise, each (X, Y) one Box–Muller pair.
/// The normals of the tail follow: first Ψ, then g_12, g_13, …, g_23, …. If their number is odd,
/// the second normal of the last pair is dropped, so the streams are the only state between steps.
/// Steps may differ in size.
///
/// A method of strong order one needs areas with an error of at most h^{3/2} in each step:
///
/// ```
/// use noise::{AreaPath, AreaSampler, StepNoise, StreamKey, WienerRows};
/// use noise::{area_terms, strong_order_one_error};
///
/// let key = StreamKey { seed: 1, experiment: 7 };
/// let tau: f64 = 1.0 / 4096.0;
/// let terms = area_terms(strong_order_one_error(tau), tau, 3)?;
/// assert_eq!(terms, 11);
///
/// let mut wiener = WienerRows::new(key, 0);
/// let mut sampler = AreaSampler::new(key, 0, 3, terms);
/// let mut noise = StepNoise::with_areas(3);
/// wiener.increments(tau.sqrt(), &mut noise.increments);
/// sampler.areas(tau, &noise.increments, &mut noise.areas);
///
/// // Path 17 alone has the same areas.
/// let mut path = AreaPath::<3>::new(key, 17, terms);
/// let drawn = noise.path::<3>(17);
/// assert_eq!(path.areas(tau, drawn.increments), drawn.areas);
/// # Ok::<(), noise::NoiseError>(())
/// ```
#[derive(Debug)]
pub struct AreaSampler {
    streams: BlockStreams,
    series: Series,
    noises: usize,
    scratch: Rows,
}

/// n, and the amplitude a of the tail.
#[derive(Clone, Copy, Debug)]
struct Series {
    terms: usize,
    tail_amplitude: f64,
}

impl Series {
    fn new(terms: usize) -> Self {
        Self { terms, tail_amplitude: (2.0 * trigamma_after(terms)).sqrt() }
    }
}

impl AreaSampler {
    /// The sampler of `noises` noises on the paths `first_path` .. `first_path + 32`, with
    /// `terms` terms of the series, see [`area_terms`](crate::area_terms).
    pub fn new(key: StreamKey, first_path: u64, noises: usize, terms: usize) -> Self {
        Self {
            streams: BlockStreams::new(key.beside(Purpose::Areas), first_path),
            series: Series::new(terms),
            noises,
            scratch: Rows::zero(scratch_rows(noises)),
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
    /// The sampler of path `path` with `terms` terms of the series.
    pub fn new(key: StreamKey, path: u64, terms: usize) -> Self {
        let words = key.beside(Purpose::Areas).state(path).map(|word| [word]);
        Self { words, series: Series::new(terms) }
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
        skew(&upper.each_ref(), 0)
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

/// Number of scratch rows for a step of `noises` noises: four for each noise, and the normals of
/// the tail. M² places suffice for M(M+1)/2 normals and the one that is dropped.
fn scratch_rows(noises: usize) -> usize {
    noises * (noises + 4)
}

impl<const L: usize> Kernel for Draw<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { words, series: Series { terms, tail_amplitude }, step, dw, areas, scratch } =
            self;
        let noises = dw.len();
        let (w, scratch) = scratch.split_at_mut(noises);
        let (shift, scratch) = scratch.split_at_mut(noises);
        let (x, scratch) = scratch.split_at_mut(noises);
        let (z, tail) = scratch.split_at_mut(noises);
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
        // Ψ, then g; an odd number of normals is made even.
        let normals = noises * (noises + 1) / 2;
        let mut places = &mut tail[..normals.next_multiple_of(2)];
        while let [first, second, rest @ ..] = places {
            fill_pair(words, first, second, tail_amplitude, tail_amplitude);
            places = rest;
        }
        add_wedges(areas, w, tail);
        let (mut place, scale) = (noises, step / TAU);
        for i in 0..noises {
            for j in i + 1..noises {
                let (area, g) = (&mut areas[i * noises + j], &tail[place]);
                for p in 0..L {
                    area[p] = (area[p] + g[p]) * scale;
                }
                place += 1;
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
