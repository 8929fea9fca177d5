//! Sources of the noise of the finest steps.

use noise::{AreaSampler, StepNoise, StreamKey, WienerRows, area_terms, strong_order_one_error};

use crate::LadderError;

/// Writes the noise of the next finest step τ of a block: increments, row m of variance τ on each
/// of 32 paths, and Lévy areas if there are rows for them, which are zero otherwise. Paths with
/// numbers that are not finite fail.
pub type NextNoise = Box<dyn FnMut(&mut StepNoise) + Send>;

/// From the number of the first path of a block to the untruncated noise of its 32 paths.
pub type NoiseSource<'a> = Box<dyn Fn(u64) -> NextNoise + Sync + 'a>;

/// The noise of a [`Ladder`](crate::Ladder) on finest steps τ: increments drawn from the streams of
/// a key; with `area_noises` the Lévy areas of so many noises, whose error is at most τ^{3/2}, as
/// strong order 1 requires.
///
/// # Errors
/// [`LadderError`] if areas would take too many terms.
pub fn drawn(
    key: StreamKey,
    tau: f64,
    area_noises: Option<usize>,
) -> Result<NoiseSource<'static>, LadderError> {
    let terms = |noises| area_terms(strong_order_one_error(tau), tau, noises);
    let areas = area_noises.map(|noises| Ok::<_, LadderError>((noises, terms(noises)?)));
    let areas = areas.transpose()?;
    Ok(Box::new(move |first_path| {
        let mut increments = WienerRows::new(key, first_path);
        let mut areas =
            areas.map(|(noises, terms)| AreaSampler::new(key, first_path, noises, terms));
        Box::new(move |noise| {
            increments.increments(tau.sqrt(), &mut noise.increments);
            if let Some(areas) = &mut areas {
                areas.areas(tau, &noise.increments, &mut noise.areas);
            }
        })
    }))
}
