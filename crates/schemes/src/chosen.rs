//! Schemes whose formula is chosen by the system.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution};
use real::Block;
use systems::{PoissonSystem, run_time::System};

use crate::{
    About, Scheme, Sexp, SexpLevy, SexpLi, Step,
    kernel::about,
    run_time::{self, scheme::Made},
    sexp_levy::WithAreas,
    sexp_li::LinearlyImplicit,
};

/// Both traits of schemes for a type, given its [`About`] for several noises, and the formula for
/// `$M` noises. With one noise none with areas is compiled.
macro_rules! chosen {
    ($scheme:ty, |$this:ident, $M:ident| $about:expr, $formula:expr) => {
        impl $scheme {
            fn formula<S: PoissonSystem<D, $M>, const D: usize, const $M: usize>(
                self,
                _: &S,
            ) -> &dyn Scheme<S, D, $M> {
                let $this = self;
                $formula
            }
        }

        impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for $scheme {
            fn about(&self) -> About {
                let about = run_time::Scheme::about(self);
                About { reads_areas: M > 1 && about.reads_areas, ..about }
            }

            fn step_block(
                &self,
                system: &S,
                step: &Step,
                noise: &BlockNoise<M>,
                y: &mut Block<D>,
                status: &mut BlockStatus,
            ) {
                self.formula(system).step_block(system, step, noise, y, status);
            }

            fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
                self.formula(system).step(system, step, noise, y)
            }
        }

        impl run_time::Scheme for $scheme {
            fn about(&self) -> About {
                let $this = self;
                $about
            }

            fn stepper<'a>(&'a self, system: &'a dyn System) -> Made<'a> {
                const $M: usize = 2;
                let $this = self;
                let formula: &'static dyn run_time::Scheme = $formula;
                formula.stepper(system)
            }
        }
    };
}

chosen!(
    SexpLi,
    |li, M| {
        let id = if li.areas { "sexp-li-levy" } else { "sexp-li" };
        About { reads_areas: li.areas, clips_increments: li.clips, ..About::new(id) }
    },
    match (const { M > 1 } && li.areas, li.implicit) {
        (true, true) => &LinearlyImplicit::<true, true>,
        (true, false) => &LinearlyImplicit::<false, true>,
        (false, true) => &LinearlyImplicit::<true, false>,
        (false, false) => &LinearlyImplicit::<false, false>,
    }
);
chosen!(
    SexpLevy,
    |levy, M| About { reads_areas: !levy.commuting(), ..about::<WithAreas>() },
    if const { M > 1 } && !levy.commuting() { &WithAreas } else { &Sexp }
);
