//! A compiled system as one that is known at run time.

use std::ops::Range;

use dgrad::Rule;
use real::{Kernel, Row, WIDTH, along, derivatives, dispatch, exactly, fixed, path};

use super::{Description, Op, System, Weights, derived};
use crate::{
    PoissonSystem, SystemError, always_solvable, area_gradient, is_quadratic, ito_correction,
    jacobi_holds, linearity, noises_commute, paper::valid,
};

/// Nodes of the rule for derivatives of the averaged gradient. The gradient itself is that of the
/// compiled system.
const NODES: usize = 8;

/// A [`PoissonSystem`] as a [`System`]: every method has the same bits as that of the compiled
/// system on each path.
pub struct Compiled<S, const D: usize, const M: usize> {
    system: S,
    description: Description,
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Compiled<S, D, M> {
    const NO_NOISE: [Row; M] = [[0.0; WIDTH]; M];

    /// The system; how B depends on y is found at `y0`.
    pub fn new(system: S, y0: [f64; D]) -> Self {
        Self { description: Description::of(&system, y0), system }
    }
}

impl Description {
    /// Description of a compiled system; how B depends on y and whether the noises commute is found
    /// at `y0` and around it.
    pub fn of<S, const D: usize, const M: usize>(system: &S, y0: [f64; D]) -> Self
    where
        S: PoissonSystem<D, M>,
    {
        let nodes = if is_quadratic(system, 1.0, [1.0; M]) { 1 } else { NODES };
        let rule = valid(Rule::new(nodes));
        Self {
            parameters: system.parameters(),
            linearity: linearity(system, y0),
            always_solvable: always_solvable(system, y0),
            parts: Err("flows of compiled systems are for compiled schemes".into()),
            invariants: system.invariants(),
            jacobi_holds: jacobi_holds(system, y0),
            noises_commute: noises_commute(system, y0),
            ..Self::new(system.name(), D, M, rule)
        }
    }
}

/// An operation on 32 paths.
struct OnPaths<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    op: Op<&'a [Row; D]>,
    dt: f64,
    dw: &'a [Row; M],
    areas: &'a [Row],
    out: &'a mut [Row; D],
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Kernel for OnPaths<'_, S, D, M> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { system: s, op, dt, dw, areas, out } = self;
        // One loop for each operation, which writes into memory of its own, so that each is
        // vectorised.
        let mut rows = [[0.0; WIDTH]; D];
        macro_rules! on_each {
            ($p:ident => $value:expr) => {
                for $p in 0..WIDTH {
                    let value = $value;
                    for i in 0..D {
                        rows[i][$p] = value[i];
                    }
                }
            };
        }
        match op {
            Op::Structure { y, v } => on_each!(p => s.structure(path(y, p), path(v, p))),
            Op::StructureAlong { y, u, v } => on_each!(p => {
                derivatives(s.structure(along(path(y, p), path(u, p)), fixed(path(v, p))))
            }),
            Op::Gradient { y } => on_each!(p => s.gradient(path(y, p), dt, path(dw, p))),
            Op::Hessian { y, u } => on_each!(p => {
                derivatives(s.gradient(along(path(y, p), path(u, p)), dt, path(dw, p)))
            }),
            Op::AveragedGradient { a, b } => {
                on_each!(p => s.averaged_gradient(path(a, p), path(b, p), dt, path(dw, p)));
            }
            Op::AveragedField { a, b } => {
                on_each!(p => s.averaged_field(path(a, p), path(b, p), dt, path(dw, p)));
            }
            Op::Cayley { y, v } => on_each!(p => s.cayley(path(y, p), path(v, p))),
            Op::ItoCorrection { y } => on_each!(p => ito_correction(s, path(y, p))),
            Op::AreaGradient { y } => {
                on_each!(p => area_gradient(s, path(y, p), skew(areas, p)));
            }
            Op::AreaHessian { y, u } => on_each!(p => {
                derivatives(area_gradient(s, along(path(y, p), path(u, p)), skew(areas, p)))
            }),
            Op::AveragedHessian { .. } => unreachable!("it is derived"),
        }
        *out = rows;
    }
}

/// The skew matrix of the areas of path p.
#[inline(always)]
fn skew<const M: usize>(rows: &[Row], p: usize) -> [[f64; M]; M] {
    let mut areas = [[0.0; M]; M];
    for m in 0..M {
        for l in m + 1..M {
            areas[m][l] = rows[m * M + l][p];
            areas[l][m] = -areas[m][l];
        }
    }
    areas
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> System for Compiled<S, D, M> {
    fn description(&self) -> &Description {
        &self.description
    }

    fn apply(
        &self,
        op: Op<&[Row]>,
        _: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        if let Op::AveragedHessian { .. } = op {
            return derived(self, op, h, out, scratch);
        }
        let count = out.len();
        let out = out.try_into().unwrap_or_else(|_| panic!("{D} rows are needed, got {count}"));
        let dw = if op.reads_weights() { exactly(h.dw) } else { &Self::NO_NOISE };
        dispatch(OnPaths {
            system: &self.system,
            op: op.map(exactly),
            dt: h.dt,
            dw,
            areas: h.areas,
            out,
        });
    }

    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, _: &mut [Row]) {
        for p in 0..WIDTH {
            out[p] = self.system.energy(path(exactly(y), p), h.dt, path(exactly(h.dw), p));
        }
    }

    fn invariant(&self, index: usize, y: &[Row], out: &mut Row, _: &mut [Row]) {
        for p in 0..WIDTH {
            out[p] = self.system.invariant(index, path(exactly(y), p));
        }
    }

    fn check_domain(&self, y: &[f64]) -> Result<(), SystemError> {
        self.system.check_domain(std::array::from_fn(|i| y[i]))
    }
}
