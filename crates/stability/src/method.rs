//! The schemes that every case is run with.

use nonlin::{Solution, Solver};
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, Step};
use systems::PoissonSystem;

/// A scheme, with the solver it starts with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// `sexp`, fixed point first.
    Sexp,
    /// `sexp`, Newton first.
    SexpNewton,
    /// `sexp-levy`: differs from `sexp` for several noises that do not commute.
    SexpLevy,
    /// `midpoint`.
    Midpoint,
    /// `heun`.
    Heun,
    /// `em`.
    EulerMaruyama,
}

/// Increments and Lévy areas of one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noise<const M: usize> {
    pub(crate) dw: [f64; M],
    pub(crate) areas: [[f64; M]; M],
}

impl<const M: usize> Noise<M> {
    pub(crate) fn increments(dw: [f64; M]) -> Self {
        Self { dw, areas: [[0.0; M]; M] }
    }
}

impl Method {
    /// Every scheme that differs from the others with M noises.
    pub(crate) fn all(noises: usize) -> Vec<Self> {
        let all = [
            Self::Sexp,
            Self::SexpNewton,
            Self::SexpLevy,
            Self::Midpoint,
            Self::Heun,
            Self::EulerMaruyama,
        ];
        all.into_iter().filter(|method| noises > 1 || *method != Self::SexpLevy).collect()
    }

    /// Its name in results.
    pub(crate) fn id(self) -> &'static str {
        match self {
            Self::Sexp => "sexp",
            Self::SexpNewton => "sexp-newton",
            Self::SexpLevy => "sexp-levy",
            Self::Midpoint => "midpoint",
            Self::Heun => "heun",
            Self::EulerMaruyama => "em",
        }
    }

    /// Whether it keeps the conformal laws: the three forms of `sexp`.
    pub(crate) fn conformal(self) -> bool {
        matches!(self, Self::Sexp | Self::SexpNewton | Self::SexpLevy)
    }

    /// One step. `levy` is the scheme with Lévy areas for this system.
    pub(crate) fn step<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        self,
        system: &S,
        levy: &SexpLevy,
        step: &Step,
        noise: Noise<M>,
        y: [f64; D],
    ) -> Solution<D> {
        match self {
            Self::Sexp => Sexp { solver: Solver::new(nonlin::Method::FixedPoint) }
                .step(system, step, noise.dw, y),
            Self::SexpNewton => {
                Sexp { solver: Solver::new(nonlin::Method::Newton) }.step(system, step, noise.dw, y)
            }
            Self::SexpLevy => levy.step_with_areas(system, step, noise.dw, noise.areas, y),
            Self::Midpoint => Midpoint::default().step(system, step, noise.dw, y),
            Self::Heun => Heun.step(system, step, noise.dw, y),
            Self::EulerMaruyama => EulerMaruyama.step(system, step, noise.dw, y),
        }
    }
}
