//! Compositions of flows.

use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Outcome, Solution};
use real::{Block, Kernel, WIDTH, dispatch, path, unrolled};
use systems::{Flows, probe::TRIPLE_JUMP};

use crate::{About, Nv, Scheme, Split, SplitH, Step};

/// A scheme that moves paths by flows and numbers, one after the other.
///
/// ```
/// use noise::Noise;
/// use schemes::{Composed, Composition, Paths, Scheme, Step, Times};
/// use systems::{Constant, Flows, Pendulum};
///
/// /// Each flow once, and the whole damping before.
/// struct LieTrotter;
/// impl<S: Flows<D, M>, const D: usize, const M: usize> Composition<S, D, M> for LieTrotter {
///     const ID: &'static str = "lie-trotter";
///     #[inline(always)]
///     fn compose<const N: usize>(&self, step: &Step, paths: &mut Paths<'_, S, D, M, N>) {
///         paths.scale(step.first_decay * step.second_decay);
///         (0..S::PARTS).for_each(|part| paths.flow(part, Times::step(step)));
///     }
/// }
/// let step = Step::new(&Constant::new(0.2)?, 0, 0.01)?;
/// let pendulum = Pendulum::new(1.0)?;
/// let next =
///     Composed(LieTrotter).step(&pendulum, &step, &Noise::increments([0.05]), [0.2, 1.0]);
/// assert!(next.outcome.converged());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Composition<S, const D: usize, const M: usize>: Send + Sync {
    /// Identifier in results.
    const ID: &'static str;

    /// Whether it reads space-time areas.
    const READS_SPACE_TIME: bool = false;

    /// Advances N paths by one step. Mark it `#[inline(always)]` and avoid closures: only inlined
    /// code is vectorised.
    fn compose<const N: usize>(&self, step: &Step, paths: &mut Paths<'_, S, D, M, N>);

    /// Both orders of the noises, see [`Scheme::both_orders`].
    fn both_orders(&self) -> Option<[Box<dyn Scheme<S, D, M>>; 2]> {
        None
    }
}

/// A [`Composition`] as a [`Scheme`]. No increment is truncated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Composed<C>(pub C);

/// The states of N paths that are moved: 32 or one.
pub struct Paths<'a, S, const D: usize, const M: usize, const N: usize> {
    system: &'a S,
    increments: [[f64; N]; M],
    /// None if none are drawn.
    space_time: &'a [[f64; N]],
    y: [[f64; N]; D],
}

/// The times of a flow: of H₀, and of the noises.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    dt: f64,
    noises: Noises,
    share: f64,
}

#[derive(Clone, Copy, Debug)]
enum Noises {
    None,
    One(usize),
    /// With a share of the space-time area, too.
    WithArea(usize, f64),
    All,
}

impl Times {
    /// τ and all increments.
    #[inline(always)]
    pub fn step(step: &Step) -> Self {
        Self { dt: step.tau, noises: Noises::All, share: 1.0 }
    }

    /// A time without noise.
    #[inline(always)]
    pub fn drift(dt: f64) -> Self {
        Self { dt, noises: Noises::None, share: 1.0 }
    }

    /// The increment of noise `m` without time.
    #[inline(always)]
    pub fn noise(m: usize) -> Self {
        Self { dt: 0.0, noises: Noises::One(m), share: 1.0 }
    }

    /// Shares of the increment and of the space-time area of noise `m`, without time.
    #[inline(always)]
    pub fn with_area(m: usize, [increment, area]: [f64; 2]) -> Self {
        Self { dt: 0.0, noises: Noises::WithArea(m, area), share: increment }
    }

    /// A share of these times.
    #[inline(always)]
    #[must_use]
    pub fn times(self, share: f64) -> Self {
        let noises = match self.noises {
            Noises::WithArea(m, area) => Noises::WithArea(m, share * area),
            noises => noises,
        };
        Self { dt: share * self.dt, share: share * self.share, noises }
    }
}

impl<S, const D: usize, const M: usize, const N: usize> Paths<'_, S, D, M, N> {
    /// Multiplies the states by a number.
    #[inline(always)]
    pub fn scale(&mut self, factor: f64) {
        for i in 0..D {
            for p in 0..N {
                self.y[i][p] *= factor;
            }
        }
    }

    /// Multiplies one component by a number.
    #[inline(always)]
    pub fn scale_one(&mut self, component: usize, factor: f64) {
        for p in 0..N {
            self.y[component][p] *= factor;
        }
    }
}

impl<S: Flows<D, M>, const D: usize, const M: usize, const N: usize> Paths<'_, S, D, M, N> {
    /// The flow of a part.
    #[inline(always)]
    pub fn flow(&mut self, part: usize, times: Times) {
        self.part::<false>(part, times);
    }

    /// The precise flow of a part, see [`Flows::precise_flow`].
    #[inline(always)]
    pub fn precise_flow(&mut self, part: usize, times: Times) {
        self.part::<true>(part, times);
    }

    /// The flows of all parts: φ₀(½) ⋯ φ_{P−1}(½) φ_P(1) φ_{P−1}(½) ⋯ φ₀(½).
    #[inline(always)]
    pub fn symmetric(&mut self, times: Times) {
        // Numbers of parts are constants, so that each loop over paths has one flow.
        unrolled!(f64: part in 0..S::PARTS => {
            self.flow(part, if part + 1 < S::PARTS { times.times(0.5) } else { times });
        });
        unrolled!(f64: k in 0..S::PARTS => {
            if k > 0 {
                self.flow(S::PARTS - 1 - k, times.times(0.5));
            }
        });
    }

    /// The flows of all parts once, from the first to the last or backward.
    #[inline(always)]
    pub(crate) fn in_turn(&mut self, times: Times, backward: bool) {
        unrolled!(f64: k in 0..S::PARTS => {
            self.flow(if backward { S::PARTS - 1 - k } else { k }, times);
        });
    }

    /// The flow of noise m, precise or by a triple jump, for times without those of others.
    #[inline(always)]
    pub(crate) fn noise(&mut self, m: usize, times: Times) {
        match S::NOISE_PARTS[m] {
            Some(part) => self.precise_flow(part, times),
            None => {
                for share in TRIPLE_JUMP {
                    self.symmetric(times.times(share));
                }
            }
        }
    }

    /// Each flow is a loop of its own, since one with all flows of a step is not vectorised.
    #[inline(always)]
    fn part<const PRECISE: bool>(&mut self, part: usize, times: Times) {
        if matches!(times.noises, Noises::None) && !self.system.drifts(part) {
            return;
        }
        // From a copy: in place, `nv` on Maxwell–Bloch takes a fifth longer.
        let start = self.y;
        for p in 0..N {
            let y = path(&start, p);
            let mut dw = [0.0; M];
            match times.noises {
                Noises::None => {}
                Noises::One(m) => dw[m] = times.share * self.increments[m][p],
                Noises::WithArea(m, area) => {
                    dw[m] = times.share * self.increments[m][p] + area * self.space_time[m][p];
                }
                Noises::All => {
                    for m in 0..M {
                        dw[m] = times.share * self.increments[m][p];
                    }
                }
            }
            let z = if PRECISE {
                self.system.precise_flow(part, y, times.dt, dw)
            } else {
                self.system.flow(part, y, times.dt, dw)
            };
            for i in 0..D {
                self.y[i][p] = z[i];
            }
        }
    }
}

struct ComposedKernel<'a, C, S, const D: usize, const M: usize> {
    composition: &'a C,
    system: &'a S,
    step: Step,
    noise: BlockNoise<'a, M>,
    y: &'a mut Block<D>,
    status: &'a mut BlockStatus,
}

impl<C: Composition<S, D, M>, S, const D: usize, const M: usize> Kernel
    for ComposedKernel<'_, C, S, D, M>
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { composition, system, step, noise, y, status } = self;
        let increments = *noise.increments;
        let space_time = noise.space_time;
        let mut paths: Paths<'_, S, D, M, WIDTH> = Paths { system, increments, space_time, y: y.0 };
        composition.compose(&step, &mut paths);
        y.0 = paths.y;
        *status = BlockStatus::explicit();
        status.fail_where_not_finite(&y.0);
    }
}

/// The scheme of a composition: [`Composed`], and the compositions of this crate by themselves.
macro_rules! composed {
    ([$($c:ident)?] $scheme:ty, $inner:ty, $this:ident => $composition:expr) => {
        impl<$($c: Composition<S, D, M>,)? S: Flows<D, M>, const D: usize, const M: usize>
            Scheme<S, D, M> for $scheme
        {
            fn about(&self) -> About {
                About {
                    reads_space_time: <$inner as Composition<S, D, M>>::READS_SPACE_TIME,
                    ..About::new(<$inner as Composition<S, D, M>>::ID)
                }
            }

            fn step_block(
                &self,
                system: &S,
                step: &Step,
                noise: &BlockNoise<M>,
                y: &mut Block<D>,
                status: &mut BlockStatus,
            ) {
                let $this = self;
                let (composition, step, noise) = ($composition, *step, *noise);
                dispatch(ComposedKernel { composition, system, step, noise, y, status });
            }

            fn both_orders(&self) -> Option<[Box<dyn Scheme<S, D, M>>; 2]> {
                let $this = self;
                <$inner as Composition<S, D, M>>::both_orders(&$composition)
            }

            fn step(&self, system: &S, step: &Step, noise: &Noise<M>, y: [f64; D]) -> Solution<D> {
                let $this = self;
                let (increments, y) = (noise.increments.map(|dw| [dw]), y.map(|y| [y]));
                let space_time = &noise.space_time.map(|h| [h]);
                let mut paths: Paths<'_, S, D, M, 1> = Paths { system, increments, space_time, y };
                $composition.compose(step, &mut paths);
                let z = paths.y.map(|[y]| y);
                Solution { z, outcome: Outcome::Fast { iterations: 1 } }.checked()
            }
        }
    };
}

composed!([C] Composed<C>, C, this => &this.0);
composed!([] Split, Split, this => this);
composed!([] Nv, Nv, this => this);
composed!([] SplitH, SplitH, this => this);
