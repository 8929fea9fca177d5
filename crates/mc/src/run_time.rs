//! Problems whose system is known at run time, for the driver.

use std::{ops::Deref, sync::Arc};

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Row, Rows, WIDTH};
use schemes::{
    About, Listing, Method, Step, Stepper,
    run_time::{Scheme, SchemeError},
};
use systems::run_time::{self, InTime, Lanes, Op, Program, System, Weights};

use crate::{Coefficients, ConformalLaw, InTimeAt, Problem, Setup};

impl<'a> Problem<'a> {
    /// The problem with a system that is known at run time.
    pub fn at_run_time(problem: &'a run_time::Problem) -> Self {
        let system = problem.system();
        let description = system.description();
        let law = |(index, &invariant)| {
            ConformalLaw::new(invariant, move |y| {
                let mut out = [0.0; WIDTH];
                system.invariant(index, &Rows::splat(y), &mut out, &mut scratch(system));
                out[0]
            })
        };
        Self {
            name: description.name.clone(),
            parameters: description.parameters.clone(),
            noises: description.noises,
            silent: description.is_silent(),
            y0: problem.y0().into(),
            initial: None,
            t_end: problem.t_end(),
            damping: problem.damping(),
            friction: &[],
            laws: description.invariants.iter().enumerate().map(law).collect(),
            coefficients: Arc::new(|t, y| coefficients(system, t, y)),
            in_time: if description.depends_on_time {
                vec![Arc::new(Hamiltonians(system))]
            } else {
                vec![]
            },
            device: None,
        }
    }
}

impl<'a> Setup<'a> {
    /// A problem whose system is known at run time, and a scheme for it. Every statistic, study and
    /// expectation takes it.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use mc::{Setup, Simulation};
    /// use noise::{StreamKey, Truncation};
    /// use schemes::SexpLi;
    /// use systems::{Constant, lattice::{Couplings, Shape, SpinLattice}, run_time::Problem};
    ///
    /// // Four spins in a ring with a noise for each component.
    /// let couplings =
    ///     Couplings { exchange: 1.0, noise: 0.3, local: true, ..Couplings::default() };
    /// let ring = SpinLattice::on_paths(Shape::periodic(&[4])?, couplings)?;
    /// let scheme = SexpLi::at_run_time(&ring)?;
    /// let y0 = [1.0, 0.0, 0.0].repeat(4);
    /// let problem = Problem::new(Arc::new(ring), Arc::new(Constant::new(0.1)?), y0, 1.0)?;
    /// let setup = Setup::at_run_time(&problem, &scheme)?;
    /// let simulation = Simulation::new(setup, Truncation::new(4)?);
    /// let key = StreamKey { seed: 1, experiment: 0 };
    /// let paths = simulation.paths(64, key, 0..2)?;
    /// // Each length is on its law.
    /// assert!(paths[1].column("C4 defect").unwrap().iter().all(|defect| defect.abs() < 1e-13));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// The setup owns a scheme that is given in a box.
    ///
    /// # Errors
    /// Those of [`Scheme::stepper`]: the scheme is not for the system.
    /// [`SchemeError`] if rows of the system hold one path, which is for
    /// `lattice::LargePath`.
    pub fn at_run_time(
        problem: &'a run_time::Problem,
        scheme: impl Deref<Target: Scheme> + Send + Sync + 'a,
    ) -> Result<Self, SchemeError> {
        let scheme = bind_at_run_time(problem.system(), scheme)?;
        Ok(Self { problem: Problem::at_run_time(problem), scheme })
    }
}

/// A scheme on a system, both known at run time.
///
/// # Errors
/// Those of [`Setup::at_run_time`].
pub fn bind_at_run_time<'a>(
    system: &'a dyn System,
    scheme: impl Deref<Target: Scheme> + Send + Sync + 'a,
) -> Result<Arc<dyn Method + 'a>, SchemeError> {
    let description = system.description();
    if description.layout.lanes == Lanes::Components {
        return Err(SchemeError(format!(
            "rows of `{}` hold one path: take `lattice::LargePath`, or the layout for many paths",
            description.name
        )));
    }
    scheme.stepper(system)?;
    Ok(Arc::new(Bound { system, scheme }))
}

/// A scheme on a system, both known at run time.
struct Bound<'a, B> {
    system: &'a dyn System,
    scheme: B,
}

impl<B: Deref<Target: Scheme> + Send + Sync> Method for Bound<'_, B> {
    fn about(&self) -> About {
        let about = self.scheme.about();
        About { reads_areas: self.system.description().noises > 1 && about.reads_areas, ..about }
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let mut stepper =
            self.scheme.stepper(self.system).unwrap_or_else(|error| panic!("{error}"));
        stepper.state_mut().copy_from_slice(y);
        match self.system.guard() {
            Some(guard) => Box::new(Guarded { stepper, guard }),
            None => stepper,
        }
    }
}

/// A stepper whose paths fail where the guard of the system is not finite.
struct Guarded<'a> {
    stepper: Box<dyn Stepper + 'a>,
    guard: Box<dyn Program>,
}

impl Stepper for Guarded<'_> {
    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        self.stepper.step(step, noise, status);
        // At the end of the step.
        let h = Weights { t: step.t + step.tau, ..Weights::NONE };
        let mut value = [[0.0; WIDTH]];
        self.guard.run(&[self.stepper.state()], &[], h, &mut value);
        status.fail_where_not_finite(&value);
    }

    fn listing(&mut self, step: &Step) -> Option<Listing<'_>> {
        let guard = Some((&mut *self.guard, step.t + step.tau));
        Some(Listing { guard, ..self.stepper.listing(step)? })
    }

    fn state(&self) -> &[Row] {
        self.stepper.state()
    }

    fn state_mut(&mut self) -> &mut [Row] {
        self.stepper.state_mut()
    }
}

/// Rows for any operation of a system.
fn scratch(system: &dyn System) -> Rows {
    Rows::zero(system.description().scratch_rows())
}

/// Coefficients at the time `t` and the state `y`, computed on all places of a row.
fn coefficients(system: &dyn System, t: f64, y: &[f64]) -> Coefficients {
    let y = &Rows::splat(y)[..];
    let first = |rows: Vec<Row>| rows.iter().map(|row| row[0]).collect();
    let field = |k| first(field(system, t, y, k));
    let h = Weights { t, ..Weights::NONE };
    Coefficients {
        drift: field(0),
        noises: (1..=system.description().noises).map(field).collect(),
        correction: first(apply(system, Op::ItoCorrection { y }, h)),
    }
}

/// fₖ = B∇Hₖ at 32 states.
fn field(system: &dyn System, t: f64, y: &[Row], k: usize) -> Vec<Row> {
    let noises = 1..=system.description().noises;
    let dw: Vec<Row> = noises.map(|m| [f64::from(u8::from(m == k)); WIDTH]).collect();
    let h = Weights { t, dt: f64::from(u8::from(k == 0)), dw: &dw, areas: &[] };
    let v = apply(system, Op::Gradient { y }, h);
    apply(system, Op::Structure { y, v: &v }, h)
}

/// Rows that an operation of a system writes.
fn apply(system: &dyn System, op: Op<&[Row]>, h: Weights<'_>) -> Vec<Row> {
    let mut out = vec![[0.0; WIDTH]; system.description().dimension];
    system.apply(op, 0..out.len(), h, &mut out, &mut scratch(system));
    out
}

/// Hamiltonians that change with time.
struct Hamiltonians<'a>(&'a dyn System);

/// Functions that the system gives, else all fields at single times.
impl InTimeAt for Hamiltonians<'_> {
    fn at(&self, y: &[f64]) -> Box<dyn InTime + '_> {
        self.0.in_time(y).unwrap_or_else(|| Box::new(Sampled { system: self.0, y: y.into() }))
    }
}

struct Sampled<'a> {
    system: &'a dyn System,
    y: Vec<f64>,
}

impl InTime for Sampled<'_> {
    fn values(&self, times: &Row) -> Vec<Row> {
        let (y, noises) = (&Rows::splat(&self.y)[..], self.system.description().noises);
        let fields = |t: f64| (0..=noises).flat_map(move |k| field(self.system, t, y, k));
        let at = times.map(|t| fields(t).map(|row| row[0]).collect::<Vec<_>>());
        (0..at[0].len()).map(|i| std::array::from_fn(|p| at[p][i])).collect()
    }
}
