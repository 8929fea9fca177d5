//! Sources of the noise of the finest steps.

use noise::{AreaMethod, StepNoise, StreamKey, WienerRows, strong_order_one_error};

use crate::LadderError;

/// Writes the noise of the next finest step of a block.
pub type NextNoise<'a, N> = Box<dyn FnMut(&mut N) + Send + 'a>;

/// A source of increments and Lévy areas, for noise that is not drawn from the streams of a key. N
/// is the noise of a step, for M noises [`BlockNoise<M>`](noise::BlockNoise).
pub trait NoiseSource<N>: Sync {
    /// The untruncated noise of the 32 paths from `first_path` on, one finest step per call.
    fn block(&self, first_path: u64) -> NextNoise<'_, N>;

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
impl<N, F: Fn(u64) -> NextNoise<'static, N> + Sync> NoiseSource<N> for F {
    fn block(&self, first_path: u64) -> NextNoise<'_, N> {
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
    /// Without areas, or with those of so many noises. Their error is at most τ^{3/2}, as strong
    /// order 1 requires.
    pub(crate) fn new(
        key: StreamKey,
        tau: f64,
        area_noises: Option<usize>,
    ) -> Result<Self, LadderError> {
        let method = AreaMethod::MrongowiusRoessler;
        let terms = area_noises.map(|m| method.terms_for(strong_order_one_error(tau), tau, m));
        Ok(Self { key, tau, areas: terms.transpose()?.map(|terms| (method, terms)) })
    }
}

impl<N: StepNoise> NoiseSource<N> for Drawn {
    fn block(&self, first_path: u64) -> NextNoise<'_, N> {
        let mut increments = WienerRows::new(self.key, first_path);
        let mut areas = self
            .areas
            .and_then(|(method, terms)| N::area_draw(self.key, first_path, method, terms));
        Box::new(move |noise| {
            noise.draw(&mut increments, self.tau.sqrt());
            if let Some(draw) = &mut areas {
                draw(self.tau, noise);
            }
        })
    }
}
