//! Weak order two: flows of the Hamiltonians, one by one.

use std::marker::PhantomData;

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, Kernel, WIDTH, dispatch, unrolled};
use systems::{Flows, Linearity, PoissonSystem, TRIPLE_JUMP, run_time};

use crate::{
    Explicit, Scheme, SexpLiError, Step,
    increment::{SystemIncrement, constant},
    poisson_flow::PoissonFlow,
    sexp_li::has_linear_casimirs,
};

/// The scheme of Ninomiya and Victoir (*Appl. Math. Finance* 15, 2008) with Poisson flows and exact
/// damping, `nv`.
///
/// With the flow P₀ of H₀ for half a step, the flows Pₘ of Hₘ for the time ΔWₘ, and the two halves
/// of the damping, D,
///
/// y_{n+1} = P₀ D P_M ⋯ P₁ D P₀ y_n  or  P₀ D P₁ ⋯ P_M D P₀ y_n,
///
/// in turn, see [`Sweep`]. The error terms of order τ of the two orders of the noises are opposite,
/// and cancel over two steps: no coin is needed. (Over whole paths they cancel in the mean of both
/// as well.) For an even number of steps the expectation has an expansion in even powers of τ, up
/// to what flows that are not exact add.
///
/// - Orders: weak 2; strong 1 for one noise or commuting noises, else ½; order 2 without noise.
/// - Preserves the conformal law of every homogeneous Casimir that its flows preserve, for every τ
///   and every increment: none is truncated. It does not preserve an energy.
/// - Flows: those of [`Flows`] ([`Nv::of_parts`]), or for any system a method of order four that
///   keeps quadratic Casimirs ([`Nv::new`]).
/// - Cost per step: M + 2 flows. Explicit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nv<F> {
    flows: F,
    sweep: Sweep,
}

/// In which order the noises of a step follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sweep {
    /// First to last in even steps, last to first in odd ones.
    #[default]
    Alternating,
    /// First to last in every step. Of weak order one alone.
    Forward,
    /// Last to first in every step. The mean of a function over this and [`Forward`](Self::Forward)
    /// with the same increments is of weak order two.
    Backward,
}

/// The flows of the parts of a system, see [`Flows`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartFlows(());

/// Flows of order four of any system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageFlows {
    affine: bool,
}

impl Nv<PartFlows> {
    /// The scheme with the flows of the parts of a system.
    ///
    /// H₀ is composed symmetrically, with an error of second order. A noise whose Hamiltonian is in
    /// one part has the [precise flow](Flows::precise_flow) of that part; of others a symmetric
    /// composition makes a triple jump.
    pub fn of_parts() -> Self {
        Self { flows: PartFlows(()), sweep: Sweep::default() }
    }
}

impl Nv<StageFlows> {
    /// The scheme for any `system`. How B depends on y is found by [`systems::linearity`] at `y0`.
    /// Flows keep quadratic Casimirs where B is constant or affine, and linear ones elsewhere.
    ///
    /// # Errors
    /// [`SexpLiError::Structure`] if B is neither constant nor affine, unless the system names its
    /// Casimirs and all of them are linear.
    pub fn new<S, const D: usize, const M: usize>(
        system: &S,
        y0: [f64; D],
    ) -> Result<Self, SexpLiError>
    where
        S: PoissonSystem<D, M>,
    {
        Self::suited(system.name(), systems::linearity(system, y0), &system.invariants())
    }

    /// The scheme for a system known at run time.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`SexpLiError::LocalNoise`] if every component has a noise of its
    /// own.
    pub fn at_run_time(system: &dyn run_time::System) -> Result<Self, SexpLiError> {
        refuse_local_noise(system)?;
        Self::suited(system.name(), system.linearity(), &system.invariants())
    }

    fn suited(
        name: &str,
        linearity: Linearity,
        invariants: &[systems::Invariant],
    ) -> Result<Self, SexpLiError> {
        if linearity == Linearity::Other {
            has_linear_casimirs(ID, name, invariants)?;
        }
        let flows = StageFlows { affine: linearity == Linearity::Affine };
        Ok(Self { flows, sweep: Sweep::default() })
    }

    pub(crate) fn is_affine(&self) -> bool {
        self.flows.affine
    }
}

/// Checks that noises follow each other one by one.
pub(crate) fn refuse_local_noise(system: &dyn run_time::System) -> Result<(), SexpLiError> {
    match system.local_noise() {
        true => Err(SexpLiError::LocalNoise { scheme: ID, system: system.name().into() }),
        false => Ok(()),
    }
}

impl<F> Nv<F> {
    /// The scheme with the noises in another order.
    #[must_use]
    pub fn with_sweep(self, sweep: Sweep) -> Self {
        Self { sweep, ..self }
    }
}

impl Sweep {
    /// Whether the noises of a step go from last to first.
    pub(crate) fn is_backward(self, step: &Step) -> bool {
        match self {
            Self::Alternating => step.number() % 2 == 1,
            Self::Forward => false,
            Self::Backward => true,
        }
    }
}

/// A state that is moved by the flows of Hamiltonians: paths, or rows of numbers.
pub(crate) trait Moved {
    /// Multiplies the state by a number.
    fn scale(&mut self, factor: f64);
    /// The flow of H₀ over half of the step.
    fn drift(&mut self);
    /// The flows of the Hₘ for the times ΔWₘ, the last first if `backward`.
    fn noises(&mut self, backward: bool);
}

/// The composition of flows.
#[inline(always)]
pub(crate) fn compose(backward: bool, step: &Step, state: &mut impl Moved) {
    state.drift();
    state.scale(step.first_decay);
    state.noises(backward);
    state.scale(step.second_decay);
    state.drift();
}

/// Paths of a compiled system: N = 32 or one.
struct Paths<'a, S, const D: usize, const M: usize, const N: usize> {
    system: &'a S,
    half_tau: f64,
    increments: [[f64; N]; M],
    y: [[f64; N]; D],
}

impl<S, const D: usize, const M: usize, const N: usize> Paths<'_, S, D, M, N> {
    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        for i in 0..D {
            for p in 0..N {
                self.y[i][p] *= factor;
            }
        }
    }

    /// Moves every path by a flow. Each flow is a loop of its own, since one that has all flows of a
    /// step would not be vectorised.
    #[inline(always)]
    fn move_each(&mut self, times: Times, flow: &impl Flow<S, D, M>) {
        let (start, mut next) = (self.y, self.y);
        for p in 0..N {
            let mut y = [0.0; D];
            for i in 0..D {
                y[i] = start[i][p];
            }
            let mut dw = [0.0; M];
            let dt = match times {
                Times::Same(time) => time,
                Times::Increments { m, share } => {
                    dw[m] = share * self.increments[m][p];
                    0.0
                }
            };
            let z = flow.from(self.system, y, dt, dw);
            for i in 0..D {
                next[i][p] = z[i];
            }
        }
        self.y = next;
    }
}

/// The times of a flow.
#[derive(Clone, Copy)]
enum Times {
    /// The same on every path.
    Same(f64),
    /// A share of the increments of noise m.
    Increments { m: usize, share: f64 },
}

impl Times {
    #[inline(always)]
    fn half(self) -> Self {
        match self {
            Self::Same(time) => Self::Same(0.5 * time),
            Self::Increments { m, share } => Self::Increments { m, share: 0.5 * share },
        }
    }
}

/// The flow of H₀dt + Σ Hₘdwₘ; a trait, since closures are not inlined for every instruction set.
trait Flow<S, const D: usize, const M: usize> {
    /// From y.
    fn from(&self, system: &S, y: [f64; D], dt: f64, dw: [f64; M]) -> [f64; D];
}

/// That of a part.
struct Part<const PRECISE: bool>(usize);

impl<S: Flows<D, M>, const PRECISE: bool, const D: usize, const M: usize> Flow<S, D, M>
    for Part<PRECISE>
{
    #[inline(always)]
    fn from(&self, system: &S, y: [f64; D], dt: f64, dw: [f64; M]) -> [f64; D] {
        if PRECISE {
            system.precise_flow(self.0, y, dt, dw)
        } else {
            system.flow(self.0, y, dt, dw)
        }
    }
}

impl<S: PoissonSystem<D, M>, const AFFINE: bool, const D: usize, const M: usize> Flow<S, D, M>
    for PoissonFlow<AFFINE>
{
    #[inline(always)]
    fn from(&self, system: &S, y: [f64; D], dt: f64, dw: [f64; M]) -> [f64; D] {
        let (step, noise) = (Step::without_damping(dt), Noise::increments(dw));
        let h = SystemIncrement { system, step, noise, number: PhantomData::<f64> };
        self.advance(h, constant(y)).0
    }
}

/// Paths with the flows of one kind.
struct Flowing<'a, F, S, const D: usize, const M: usize, const N: usize> {
    flows: F,
    paths: Paths<'a, S, D, M, N>,
}

impl<S: Flows<D, M>, const D: usize, const M: usize, const N: usize> Paths<'_, S, D, M, N> {
    /// The flows of all parts that move, composed symmetrically.
    #[inline(always)]
    fn symmetric(&mut self, times: Times) {
        // Numbers of parts are constants, so that each loop over paths has one flow.
        unrolled!(f64: part in 0..S::PARTS => {
            let times = if part + 1 < S::PARTS { times.half() } else { times };
            self.part(part, times);
        });
        unrolled!(f64: k in 0..S::PARTS => {
            if k > 0 {
                self.part(S::PARTS - 1 - k, times.half());
            }
        });
    }

    #[inline(always)]
    fn part(&mut self, part: usize, times: Times) {
        if matches!(times, Times::Increments { .. }) || self.system.drifts(part) {
            self.move_each(times, &Part::<false>(part));
        }
    }

    /// The flow of Hₘ for the time ΔWₘ.
    #[inline(always)]
    fn noise_by_parts(&mut self, m: usize) {
        if let Some(part) = S::NOISE_PARTS[m] {
            let times = Times::Increments { m, share: 1.0 };
            self.move_each(times, &Part::<true>(part));
        } else {
            for share in TRIPLE_JUMP {
                self.symmetric(Times::Increments { m, share });
            }
        }
    }
}

impl<S: Flows<D, M>, const D: usize, const M: usize, const N: usize> Moved
    for Flowing<'_, PartFlows, S, D, M, N>
{
    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        self.paths.scale(factor);
    }

    #[inline(always)]
    fn drift(&mut self) {
        self.paths.symmetric(Times::Same(self.paths.half_tau));
    }

    #[inline(always)]
    fn noises(&mut self, backward: bool) {
        if backward {
            unrolled!(f64: k in 0..M => { self.paths.noise_by_parts(M - 1 - k); });
        } else {
            unrolled!(f64: m in 0..M => { self.paths.noise_by_parts(m); });
        }
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize, const N: usize>
    Flowing<'_, StageFlows, S, D, M, N>
{
    #[inline(always)]
    fn flow(&mut self, times: Times) {
        if self.flows.affine {
            self.paths.move_each(times, &PoissonFlow::<true>);
        } else {
            self.paths.move_each(times, &PoissonFlow::<false>);
        }
    }
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize, const N: usize> Moved
    for Flowing<'_, StageFlows, S, D, M, N>
{
    #[inline(always)]
    fn scale(&mut self, factor: f64) {
        self.paths.scale(factor);
    }

    #[inline(always)]
    fn drift(&mut self) {
        self.flow(Times::Same(self.paths.half_tau));
    }

    #[inline(always)]
    fn noises(&mut self, backward: bool) {
        for k in 0..M {
            let m = if backward { M - 1 - k } else { k };
            self.flow(Times::Increments { m, share: 1.0 });
        }
    }
}

struct NvKernel<'a, F, S, const D: usize, const M: usize> {
    nv: Nv<F>,
    system: &'a S,
    step: Step,
    noise: BlockNoise<'a, M>,
    y: &'a mut Block<D>,
    status: &'a mut BlockStatus,
}

impl<'a, F: Copy, S, const D: usize, const M: usize> Kernel for NvKernel<'a, F, S, D, M>
where
    Flowing<'a, F, S, D, M, WIDTH>: Moved,
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { nv: Nv { flows, sweep }, system, step, noise, y, status } = self;
        let (half_tau, increments) = (0.5 * step.tau, *noise.increments);
        let mut state = Flowing { flows, paths: Paths { system, half_tau, increments, y: y.0 } };
        compose(M > 1 && sweep.is_backward(&step), &step, &mut state);
        y.0 = state.paths.y;
        *status = BlockStatus::explicit();
        status.fail_where_not_finite(&y.0);
    }
}

/// The scheme with flows of one kind, on systems that have them.
macro_rules! scheme {
    ($flows:ty, $system:ident) => {
        impl<S: $system<D, M>, const D: usize, const M: usize> Scheme<S, D, M> for Nv<$flows> {
            fn id(&self) -> &'static str {
                ID
            }

            fn reads_areas(&self) -> bool {
                false
            }

            fn clips_increments(&self) -> bool {
                false
            }

            fn step_block(
                &self,
                system: &S,
                step: &Step,
                noise: &BlockNoise<M>,
                y: &mut Block<D>,
                status: &mut BlockStatus,
            ) {
                dispatch(NvKernel { nv: *self, system, step: *step, noise: *noise, y, status });
            }

            fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
                let (half_tau, backward) = (0.5 * step.tau, M > 1 && self.sweep.is_backward(step));
                let (increments, y) = (noise.increments.map(|dw| [dw]), y.map(|y| [y]));
                let paths = Paths { system, half_tau, increments, y };
                let mut state = Flowing { flows: self.flows, paths };
                compose(backward, step, &mut state);
                let z = state.paths.y.map(|[y]| y);
                Solution { z, outcome: Outcome::Fast { iterations: 1 } }.checked()
            }
        }
    };
}

/// The identifier in results.
pub(crate) const ID: &str = "nv";

scheme!(PartFlows, Flows);
scheme!(StageFlows, PoissonSystem);

impl Nv<StageFlows> {
    pub(crate) fn sweep(&self) -> Sweep {
        self.sweep
    }
}
