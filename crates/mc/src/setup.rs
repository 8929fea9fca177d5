//! A problem and a scheme of any dimension, with any number of noises.

use std::{ops::Deref, sync::Arc};

use noise::{Purpose, StepNoise, StreamKey};
use nonlin::BlockStatus;
use real::{Block, Row, Rows, elementary::exp, exactly};
use schemes::{About, Device, Method, Scheme, Step, Stepper};
use systems::{
    Damping, Invariant, InvariantKind, PoissonSystem, ito_correction, run_time::InTime, unit_noise,
    vector_field,
};

use crate::Friction;

/// A problem of any dimension with any number of noises: all that a driver needs beside the steps
/// of schemes. [`of`](Self::of) makes that of a [`systems::Problem`],
/// [`at_run_time`](Self::at_run_time) that of a system known at run time.
///
/// Paths start at `y0` at time 0 and end at `t_end`, which must be positive and finite.
#[derive(Clone)]
pub struct Problem<'a> {
    /// Name of the system.
    pub name: String,
    /// Parameters of the system, as far as it describes them.
    pub parameters: String,
    /// Number of noises.
    pub noises: usize,
    /// Whether all noises are known to be zero at all states, or there are none.
    pub silent: bool,
    /// The initial value, whose length is the dimension; one possible value if it is random.
    pub y0: Vec<f64>,
    /// Random initial values in place of `y0`.
    pub initial: Option<Initial<'a>>,
    /// The final time T.
    pub t_end: f64,
    /// The damping γ.
    pub damping: &'a dyn Damping,
    /// Friction on single components besides; see [`Setup::with_friction`].
    pub friction: &'a [Friction],
    /// The functions that obey the conformal law, which tables have as columns.
    pub laws: Vec<ConformalLaw<'a>>,
    /// The coefficients of the equation at a time and a state.
    pub coefficients: Arc<CoefficientsAt<'a>>,
    /// Hamiltonians that change with time, and such functions that paths integrate or follow. See
    /// [`DriveResolution`](crate::DriveResolution).
    pub in_time: Vec<Arc<dyn InTimeAt + 'a>>,
    /// A machine that advances paths where it can, with the bits of this one.
    pub device: Option<&'a dyn Device>,
}

/// Functions of time and the state.
pub trait InTimeAt: Send + Sync {
    /// The functions of time at a state.
    fn at(&self, y: &[f64]) -> Box<dyn InTime + '_>;
}

/// Random initial values.
#[derive(Clone)]
pub struct Initial<'a> {
    /// Law of the initial values in words.
    pub law: String,
    /// Writes the states of the 32 paths of a block, from the key of streams of their own and the
    /// number of its first path.
    pub draw: Arc<Draw<'a>>,
}

type Draw<'a> = dyn Fn(StreamKey, u64, &mut [Row]) + Send + Sync + 'a;

/// A function F that obeys the conformal law F(y(t)) = e^{−p∫γ}F(y(0)); with friction on single
/// components, a function of which all monomials decay alike.
#[derive(Clone)]
pub struct ConformalLaw<'a> {
    /// Symbol of F in results, for example `C` or `H`.
    pub name: String,
    /// The degree p.
    pub degree: f64,
    /// Whether F is a Casimir.
    pub casimir: bool,
    /// The function F.
    pub value: Arc<Function<'a>>,
    /// Factor of F, from the integrals of all dampings; `None` for e^{−p∫γ}, without friction.
    pub decay: Option<Arc<Function<'a>>>,
}

/// A function of the state.
type Function<'a> = dyn Fn(&[f64]) -> f64 + Send + Sync + 'a;

impl<'a> ConformalLaw<'a> {
    pub(crate) fn new(
        Invariant { name, degree, kind, .. }: Invariant,
        value: impl Fn(&[f64]) -> f64 + Send + Sync + 'a,
    ) -> Self {
        let casimir = kind == InvariantKind::Casimir;
        Self { name: name.into(), degree, casimir, value: Arc::new(value), decay: None }
    }

    /// F(y(t))/F(y(0)) from the integrals of all [dampings](Problem::dampings) from 0 to t.
    pub fn decay(&self, integrals: &[f64]) -> f64 {
        let plain = || exp(-self.degree * integrals[0]);
        self.decay.as_ref().map_or_else(plain, |decay| decay(integrals))
    }
}

/// The coefficients of dy = (f₀ − γy)dt + Σₘ fₘ ∘ dWₘ with fₘ = B∇Hₘ at a time and a state.
#[derive(Clone, Debug)]
pub struct Coefficients {
    /// The drift f₀.
    pub drift: Vec<f64>,
    /// The fields f₁, … of the noises.
    pub noises: Vec<Vec<f64>>,
    /// ½Σₘ fₘ′fₘ, the drift that Itô's form of the equation has besides.
    pub correction: Vec<f64>,
}

/// Function from a time and a state to the coefficients.
pub type CoefficientsAt<'a> = dyn Fn(f64, &[f64]) -> Coefficients + Send + Sync + 'a;

/// A problem and a scheme for it: the input of a simulation, a study, an expectation or an order.
///
/// ```
/// use std::sync::Arc;
///
/// use mc::{Coefficients, Problem, Setup, Simulation};
/// use noise::{StepNoise, StreamKey, Truncation};
/// use nonlin::BlockStatus;
/// use real::Row;
/// use schemes::{About, Method, Step, Stepper};
/// use systems::Constant;
///
/// /// dy = dW by Euler's method, in any dimension.
/// struct Walk;
/// struct Walked(Vec<Row>);
///
/// impl Method for Walk {
///     fn about(&self) -> About { About::new("euler") }
///     fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
///         Box::new(Walked(y.to_vec()))
///     }
/// }
/// impl Stepper for Walked {
///     fn step(&mut self, _: &Step, noise: &StepNoise, status: &mut BlockStatus) {
///         let (y, dw) = (self.0.as_flattened_mut(), noise.increments.as_flattened());
///         y.iter_mut().zip(dw).for_each(|(y, dw)| *y += dw);
///         *status = BlockStatus::explicit();
///     }
///     fn state(&self) -> &[Row] { &self.0 }
///     fn state_mut(&mut self) -> &mut [Row] { &mut self.0 }
/// }
///
/// /// dyᵢ = dWᵢ.
/// fn coefficients(_t: f64, y: &[f64]) -> Coefficients {
///     let axis = |m: usize| (0..y.len()).map(|i| f64::from(u8::from(i == m))).collect();
///     let (drift, correction) = (vec![0.0; y.len()], vec![0.0; y.len()]);
///     Coefficients { drift, noises: (0..y.len()).map(axis).collect(), correction }
/// }
///
/// let (dimension, damping) = (5, Constant::new(0.0)?);
/// let problem = Problem {
///     name: "walk".into(),
///     parameters: String::new(),
///     noises: dimension,
///     silent: false,
///     y0: vec![0.0; dimension],
///     initial: None,
///     t_end: 1.0,
///     damping: &damping,
///     friction: &[],
///     laws: Vec::new(),
///     coefficients: Arc::new(coefficients),
///     in_time: Vec::new(),
///     device: None,
/// };
/// let setup = Setup { problem, scheme: Arc::new(Walk) };
/// let simulation = Simulation::new(setup, Truncation::none());
/// let tables = simulation.paths(16, StreamKey { seed: 1, experiment: 0 }, 0..3)?;
/// assert_eq!(tables[2].column("y5").map(<[f64]>::len), Some(17));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Setup<'a> {
    /// The problem.
    pub problem: Problem<'a>,
    /// The scheme on the system of this problem.
    pub scheme: Arc<dyn Method + 'a>,
}

/// A scheme on a level of a ladder. Its steps consist of 2^level finest steps.
pub struct Run<'a> {
    /// The scheme on the system of the problem of the ladder, see [`bind`].
    pub scheme: Arc<dyn Method + 'a>,
    /// The level; 0 is the finest.
    pub level: usize,
    /// Whether the two increments in every step of the level above are exchanged. The result is the
    /// antithetic path (Giles and Szpruch 2014), with the same law and the same coarse path.
    pub swapped: bool,
}

impl<'a> Run<'a> {
    /// A run of the scheme on the increments in their order.
    pub fn new(scheme: Arc<dyn Method + 'a>, level: usize) -> Self {
        Self { scheme, level, swapped: false }
    }

    /// A run of the scheme on exchanged increments.
    pub fn swapped(scheme: Arc<dyn Method + 'a>, level: usize) -> Self {
        Self { scheme, level, swapped: true }
    }
}

impl<'a> Problem<'a> {
    /// The problem with a system that the compiler knows.
    pub fn of<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
    ) -> Self {
        let system = problem.system();
        let law = |(index, invariant)| {
            ConformalLaw::new(invariant, move |y| system.invariant(index, array(y)))
        };
        Self {
            name: system.name().into(),
            parameters: system.parameters(),
            noises: M,
            silent: M == 0,
            y0: problem.y0().into(),
            initial: None,
            t_end: problem.t_end(),
            damping: problem.damping(),
            friction: &[],
            laws: system.invariants().into_iter().enumerate().map(law).collect(),
            coefficients: Arc::new(|_, y| {
                let y = array(y);
                let field = |dt, dw| vector_field(system, y, dt, dw).into();
                Coefficients {
                    drift: field(1.0, [0.0; M]),
                    noises: (0..M).map(|m| field(0.0, unit_noise(m))).collect(),
                    correction: ito_correction::<_, f64, D, M>(system, y).into(),
                }
            }),
            in_time: Vec::new(),
            device: None,
        }
    }

    /// The damping of all components, and the friction.
    pub fn dampings(&self) -> impl Iterator<Item = &'a dyn Damping> + use<'a> {
        [self.damping].into_iter().chain(self.friction.iter().map(|friction| &*friction.damping))
    }

    /// The states of 32 paths from path number `first` on at time 0.
    pub fn start(&self, key: StreamKey, first: u64) -> Vec<Row> {
        let mut rows = Rows::splat(&self.y0).to_vec();
        if let Some(Initial { draw, .. }) = &self.initial {
            draw(key.beside(Purpose::InitialValues), first, &mut rows);
        }
        rows
    }

    /// The formulas of all dampings.
    pub fn describe_damping(&self) -> String {
        Friction::describe(self.friction, self.damping, self.t_end)
    }
}

impl<'a> Setup<'a> {
    /// A problem and a scheme that the compiler knows.
    pub fn of<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        problem: &'a systems::Problem<S, G, D>,
        scheme: &'a dyn Scheme<S, D, M>,
    ) -> Self {
        Self { problem: Problem::of(problem), scheme: bind(problem, scheme) }
    }

    /// The states of 32 paths at time 0 from `y0`, one possible value if it is random, with the
    /// rows that they have [collected](Self::collecting).
    pub fn start(&self) -> Vec<Row> {
        self.scheme.start(&Rows::splat(&self.problem.y0)).state().to_vec()
    }
}

/// A scheme on the system of a problem.
///
/// The compiler knows both, and their kernel reads the noise of a step in place.
pub fn bind<'a, S: Sync, G, const D: usize, const M: usize>(
    problem: &'a systems::Problem<S, G, D>,
    scheme: &'a dyn Scheme<S, D, M>,
) -> Arc<dyn Method + 'a> {
    Arc::new(Bound { system: problem.system(), scheme })
}

/// A scheme that the method owns, on the system of a problem; see [`bind`].
pub fn bind_owned<'a, S: Sync, G, const D: usize, const M: usize>(
    problem: &'a systems::Problem<S, G, D>,
    scheme: Box<dyn Scheme<S, D, M> + 'a>,
) -> Arc<dyn Method + 'a> {
    Arc::new(Bound { system: problem.system(), scheme })
}

fn array<const D: usize>(y: &[f64]) -> [f64; D] {
    y.try_into().unwrap_or_else(|_| panic!("got {} numbers instead of {D}", y.len()))
}

struct Bound<'a, S, B> {
    system: &'a S,
    scheme: B,
}

impl<'a, S, B, const D: usize, const M: usize> Method for Bound<'a, S, B>
where
    S: Sync,
    B: Deref<Target = dyn Scheme<S, D, M> + 'a> + Send + Sync,
{
    /// Newton's method and continuation have a dozen matrices in an optimised build, and up to 160
    /// (measured) in one that is not optimised. Stack that is not used is only reserved.
    fn about(&self) -> About {
        About { stack: (1 << 19) + 256 * 8 * D * D, ..self.scheme.about() }
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let Self { system, scheme } = self;
        Box::new(BlockState { system: *system, scheme: &**scheme, y: Block(*exactly(y)) })
    }
}

/// A block of paths of a scheme on a system.
struct BlockState<'a, S, const D: usize, const M: usize> {
    system: &'a S,
    scheme: &'a (dyn Scheme<S, D, M> + 'a),
    y: Block<D>,
}

impl<S: Sync, const D: usize, const M: usize> Stepper for BlockState<'_, S, D, M> {
    fn state(&self) -> &[Row] {
        &self.y.0
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.y.0
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        self.scheme.step_block(self.system, step, &noise.into(), &mut self.y, status);
    }
}
