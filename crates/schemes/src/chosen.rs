//! Schemes whose formula is chosen by the system.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Solution};
use real::Block;
use systems::{PoissonSystem, run_time::System};

use crate::{
    Scheme, SchemeError, Sexp, SexpLevy, SexpLi, Step, Stepper, run_time, sexp_levy::WithAreas,
    sexp_li::LinearlyImplicit,
};

/// Both traits of schemes for a type, given functions for the identifier and for whether increments
/// are clipped, and the formula for `$M` noises. With one noise none with areas is compiled.
macro_rules! chosen {
    ($scheme:ty, $id:expr, $clips:expr, |$this:ident, $M:ident| $formula:expr) => {
        impl $scheme {
            fn formula<S: PoissonSystem<D, $M>, const D: usize, const $M: usize>(
                self,
                _: &S,
            ) -> &dyn Scheme<S, D, $M> {
                let $this = self;
                $formula
            }

            fn at_run_time_formula(self) -> &'static dyn run_time::Scheme {
                const $M: usize = 2;
                let $this = self;
                $formula
            }
        }

        impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for $scheme {
            fn id(&self) -> &'static str {
                ($id)(self)
            }

            fn reads_areas(&self) -> bool {
                M > 1 && self.at_run_time_formula().reads_areas()
            }

            fn clips_increments(&self) -> bool {
                ($clips)(self)
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
            fn id(&self) -> &'static str {
                ($id)(self)
            }

            fn reads_areas(&self) -> bool {
                self.at_run_time_formula().reads_areas()
            }

            fn clips_increments(&self) -> bool {
                ($clips)(self)
            }

            fn stepper<'a>(
                &'a self,
                system: &'a dyn System,
            ) -> Result<Box<dyn Stepper + 'a>, SchemeError> {
                self.at_run_time_formula().stepper(system)
            }
        }
    };
}

chosen!(SexpLi, Self::name, |li: &Self| li.clips, |this, M| {
    match (const { M > 1 } && this.areas, this.implicit) {
        (true, true) => &LinearlyImplicit::<true, true>,
        (true, false) => &LinearlyImplicit::<false, true>,
        (false, true) => &LinearlyImplicit::<true, false>,
        (false, false) => &LinearlyImplicit::<false, false>,
    }
});
chosen!(SexpLevy, |_| "sexp-levy", |_| true, |this, M| {
    if const { M > 1 } && !this.commuting() { &WithAreas } else { &Sexp }
});
