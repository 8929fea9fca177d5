//! Sources of the noise of the finest steps.

use noise::{AreaSampler, StepNoise, StreamKey, WienerRows, area_terms, strong_order_one_error};

use crate::LadderError;

/// Writes the noise of the next finest step of a block; areas if there are rows for them.
pub type NextNoise<'a> = Box<dyn FnMut(&mut StepNoise) + Send + 'a>;

/// A source of increments and Lévy areas, for noise that is not drawn from the streams of a key.
pub trait NoiseSource: Sync {
    /// The untruncated noise of the 32 paths from `first_path` on, one finest step per call.
    fn block(&self, first_path: u64) -> NextNoise<'_>;

    /// Checks that the source has so many noises on `steps` equal steps of [0, `t_end`], with areas
    /// if the scheme `area_reader` reads them. By default it has.
    ///
    /// # Errors
    /// [`LadderError::Recording`].
    fn check(
        &self,
        noises: usize,
        t_end: f64,
        steps: u64,
        area_reader: Option<&'static str>,
    ) -> Result<(), LadderError> {
        let _ = (noises, t_end, steps, area_reader);
        Ok(())
    }
}

/// A function of `first_path` is a source.
impl<F: Fn(u64) -> NextNoise<'static> + Sync> NoiseSource for F {
    fn block(&self, first_path: u64) -> NextNoise<'_> {
        self(first_path)
    }
}

/// Increments drawn from the streams of a key, and their Lévy areas if a scheme reads them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn {
    key: StreamKey,
    tau: f64,
    /// The number of noises that have areas, and of the terms of these.
    areas: Option<(usize, usize)>,
}

impl Drawn {
    /// Without areas, or with those of so many noises. Their error is at most τ^{3/2}, as strong
    /// order 1 requires.
    pub(crate) fn new(
        key: StreamKey,
        tau: f64,
        area_noises: Option<usize>,
    ) -> Result<Self, LadderError> {
        let areas = area_noises.map(|noises| {
            let terms = area_terms(strong_order_one_error(tau), tau, noises)?;
            Ok::<_, LadderError>((noises, terms))
        });
        Ok(Self { key, tau, areas: areas.transpose()? })
    }
}

impl NoiseSource for Drawn {
    fn block(&self, first_path: u64) -> NextNoise<'_> {
        let mut increments = WienerRows::new(self.key, first_path);
        let areas = self.areas;
        let mut areas =
            areas.map(|(noises, terms)| AreaSampler::new(self.key, first_path, noises, terms));
        Box::new(move |noise| {
            increments.increments(self.tau.sqrt(), &mut noise.increments);
            if let Some(areas) = &mut areas {
                areas.areas(self.tau, &noise.increments, &mut noise.areas);
            }
        })
    }
}
