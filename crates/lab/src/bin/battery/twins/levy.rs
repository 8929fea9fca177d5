//! Twins of strong order one with several noises: Lévy areas of the wrong sign, and areas that are
//! not those of the path.

use ::systems::RigidBody;
use ::systems::paper::rigid_body_start;
use noise::{AreaBlock, AreaMethod, AreaPath, StreamKey, strong_order_one_error};
use nonlin::{BlockStatus, Solution};
use real::{Block, WIDTH};
use schemes::{Scheme, SexpLevy, Step};
use verify::results::Claim;

use super::orders::{strong, three_noises};
use crate::experiment::Context;

/// `sexp-levy` on other areas than it is given.
struct OtherAreas<F> {
    id: &'static str,
    levy: SexpLevy,
    areas: F,
}

impl<F> Scheme<RigidBody<3>, 3, 3> for OtherAreas<F>
where
    F: Fn(&Step, [f64; 3], [[f64; 3]; 3]) -> [[f64; 3]; 3] + Send + Sync,
{
    fn id(&self) -> &'static str {
        self.id
    }

    fn step_block(
        &self,
        system: &RigidBody<3>,
        step: &Step,
        dw: &Block<3>,
        y: &mut Block<3>,
        status: &mut BlockStatus,
    ) {
        self.levy.step_block(system, step, dw, y, status);
    }

    fn step(&self, system: &RigidBody<3>, step: &Step, dw: [f64; 3], y: [f64; 3]) -> Solution<3> {
        self.levy.step(system, step, dw, y)
    }

    fn needs_areas(&self) -> bool {
        true
    }

    fn step_block_with_areas(
        &self,
        system: &RigidBody<3>,
        step: &Step,
        dw: &Block<3>,
        areas: &AreaBlock<3>,
        y: &mut Block<3>,
        status: &mut BlockStatus,
    ) {
        let mut other = AreaBlock::zero();
        for p in 0..WIDTH {
            other.set_path(p, (self.areas)(step, dw.path(p), areas.path(p)));
        }
        self.levy.step_block_with_areas(system, step, dw, &other, y, status);
    }
}

fn measure(
    context: &Context<'_>,
    id: &'static str,
    areas: impl Fn(&Step, [f64; 3], [[f64; 3]; 3]) -> [[f64; 3]; 3] + Send + Sync,
) -> Claim {
    let problem = three_noises();
    let wrong = OtherAreas { id, levy: SexpLevy::new(&problem.system, rigid_body_start()), areas };
    strong(context, "strong-one-levy", &problem, &wrong, 1.0)
}

pub(super) fn wrong_sign(context: &Context<'_>) -> Claim {
    measure(context, "sexp-levy, wrong sign", |_, _, areas| areas.map(|row| row.map(|area| -area)))
}

pub(super) fn without_areas(context: &Context<'_>) -> Claim {
    measure(context, "sexp-levy, zero areas", |_, _, _| [[0.0; 3]; 3])
}

/// Areas with the right law given the increments, drawn for each step of each step size by itself:
/// the stream is keyed by the bits of the increments, so that the twin is reproducible.
pub(super) fn fresh_areas(context: &Context<'_>) -> Claim {
    measure(context, "sexp-levy, fresh areas", |step, dw, _| {
        let [a, b, c] = dw.map(f64::to_bits);
        let key = StreamKey { seed: a ^ b.rotate_left(21), experiment: c ^ step.tau.to_bits() };
        let (method, terms) = AreaMethod::cheapest(strong_order_one_error(step.tau), step.tau, 3)
            .unwrap_or_else(|error| unreachable!("steps of a study are small: {error}"));
        AreaPath::<3>::new(key, 0, method, terms).areas(step.tau, dw)
    })
}
