//! Sources of the noise of the finest steps.

use noise::{AreaMethod, AreaSampler, BlockNoise, StreamKey, WienerBlock, strong_order_one_error};

use crate::LadderError;

/// Writes the noise of the next finest step of a block.
pub type NextNoise<'a, const M: usize> = Box<dyn FnMut(&mut BlockNoise<M>) + Send + 'a>;

/// A source of increments and Lévy areas, for noise that is not drawn from the streams of a key.
pub trait NoiseSource<const M: usize>: Sync {
    /// The untruncated noise of the 32 paths from `first_path` on, one finest step per call.
    fn block(&self, first_path: u64) -> NextNoise<'_, M>;

    /// Checks that the source has the noise of `steps` equal steps on [0, `t_end`], with areas if
    /// the scheme `area_reader` reads them. By default it has.
    ///
    /// # Errors
    /// [`LadderError::RecordedSteps`], [`LadderError::Duration`] or [`LadderError::NoAreas`].
    fn check(
        &self,
        t_end: f64,
        steps: u64,
        area_reader: Option<&'static str>,
    ) -> Result<(), LadderError> {
        let _ = (t_end, steps, area_reader);
        Ok(())
    }
}

/// A function of `first_path` is a source.
impl<const M: usize, F: Fn(u64) -> NextNoise<'static, M> + Sync> NoiseSource<M> for F {
    fn block(&self, first_path: u64) -> NextNoise<'_, M> {
        self(first_path)
    }
}

/// Increments drawn from the streams of a key, and their Lévy areas if a scheme reads them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn {
    key: StreamKey,
    tau: f64,
    areas: Option<(AreaMethod, usize)>,
}

impl Drawn {
    /// The error of the areas is at most τ^{3/2}, as strong order 1 requires.
    pub(crate) fn new<const M: usize>(
        key: StreamKey,
        tau: f64,
        with_areas: bool,
    ) -> Result<Self, LadderError> {
        let method = AreaMethod::MrongowiusRoessler;
        let terms = with_areas.then(|| method.terms_for(strong_order_one_error(tau), tau, M));
        Ok(Self { key, tau, areas: terms.transpose()?.map(|terms| (method, terms)) })
    }
}

impl<const M: usize> NoiseSource<M> for Drawn {
    fn block(&self, first_path: u64) -> NextNoise<'_, M> {
        let mut increments = WienerBlock::new(self.key, first_path);
        let mut areas = self
            .areas
            .map(|(method, terms)| AreaSampler::<M>::new(self.key, first_path, method, terms));
        Box::new(move |noise| {
            increments.increments(self.tau.sqrt(), &mut noise.increments);
            if let Some(sampler) = &mut areas {
                sampler.areas(self.tau, &noise.increments, &mut noise.areas);
            }
        })
    }
}
