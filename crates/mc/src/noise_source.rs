//! Where the noise of the finest steps comes from.

use noise::{AreaMethod, AreaSampler, BlockNoise, StreamKey, WienerBlock, strong_order_one_error};

use crate::LadderError;

/// Fills in the noise of the next step of a block.
pub type NextNoise<'a, const M: usize> = Box<dyn FnMut(&mut BlockNoise<M>) + Send + 'a>;

/// Where increments and Lévy areas come from, if they are not drawn from a family of streams.
pub trait NoiseSource<const M: usize>: Sync {
    /// The noise of the 32 paths from `first_path` on, finest step after finest step. It is given
    /// as it is drawn: what is clipped is clipped later.
    fn block(&self, first_path: u64) -> NextNoise<'_, M>;
}

impl<const M: usize, F: Fn(u64) -> NextNoise<'static, M> + Sync> NoiseSource<M> for F {
    fn block(&self, first_path: u64) -> NextNoise<'_, M> {
        self(first_path)
    }
}

/// Increments of a family of streams, and their Lévy areas where they are wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn {
    key: StreamKey,
    tau: f64,
    areas: Option<(AreaMethod, usize)>,
}

impl Drawn {
    /// Areas are drawn after Mrongowius and Rößler, with an error of no more than τ^{3/2} as strong
    /// order 1 asks.
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
