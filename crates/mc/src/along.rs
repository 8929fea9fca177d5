//! Quantities that a path collects along its way: the time, integrals over it, averages, and the
//! first passage of a function through zero.
//!
//! [`Collecting`] is a method whose states have their rows after those of another method, so that
//! whatever reads states can read them: tables, studies, expectations and step checks.
//!
//! **First passage.** At the ends of steps alone a passage is seen too late: the bias is of order
//! √τ, since a path that noise drives may be beyond zero between two ends that are not. Given both
//! ends a, b < 0, a Brownian motion of variance rate s passes zero within the step with the
//! probability exp(−2ab/(sτ)) (Gobet 2000), which leaves a bias of order τ. Whether it does is
//! decided by a number that is uniform on (0, 1) and comes from the last bits of the increments of
//! the step, which are independent of their leading ones but for rounding. So streams are the same
//! with and without events. Where no noise acts on the function, s is zero.

use std::sync::Arc;

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{PathMask, Row, WIDTH};
use schemes::{Method, Step, Stepper};
use systems::run_time::{Op, System, Weights};

use crate::Observe;

/// A function of the states of 32 paths.
pub type OfStates<'a> = Arc<dyn Observe + Send + Sync + 'a>;

/// What a path collects.
#[derive(Clone)]
pub enum Along<'a> {
    /// t.
    Time,
    /// ∫₀ᵗ v(y(s)) ds by the trapezoidal rule.
    Integral(OfStates<'a>),
    /// (1/t)∫₀ᵗ v(y(s)) ds; v(y(0)) at t = 0.
    Average(OfStates<'a>),
    /// Two numbers: one from the first passage on and before that zero; and the time of it, the
    /// time so far before.
    Passage(Passage<'a>),
}

/// The first time at which a function is positive.
#[derive(Clone)]
pub struct Passage<'a> {
    /// The function.
    pub phi: OfStates<'a>,
    /// Its variance rate s = Σₘ(∇φ·B∇Hₘ)², see [`variance_rate`]. None if passages are seen at the
    /// ends of steps only.
    pub variance: Option<Arc<VarianceRate<'a>>>,
    /// Whether the path stays where it is at the end of the step of its passage.
    pub stops: bool,
}

/// From the states of 32 paths and the middle of the step to a number for each.
pub type VarianceRate<'a> = dyn Fn(&[Row], f64, &mut Row) + Send + Sync + 'a;

/// s(y) = Σₘ(∇φ·B∇Hₘ)², for a system with one tile. `gradient` writes ∇φ.
pub fn variance_rate<'a>(
    system: &'a dyn System,
    gradient: impl Fn(&[Row], &mut [Row]) + Send + Sync + 'a,
) -> Arc<VarianceRate<'a>> {
    let description = system.description();
    let (dimension, noises) = (description.dimension, description.noises);
    let scratch_rows = description.scratch_rows();
    Arc::new(move |y: &[Row], t: f64, rate: &mut Row| {
        let zero = [0.0; WIDTH];
        let (mut slope, mut v, mut field) =
            (vec![zero; dimension], vec![zero; dimension], vec![zero; dimension]);
        let (mut scratch, mut dw) = (vec![zero; scratch_rows], vec![zero; noises]);
        gradient(y, &mut slope);
        *rate = zero;
        for m in 0..noises {
            dw.fill(zero);
            dw[m] = [1.0; WIDTH];
            let h = Weights { t, dw: &dw, ..Weights::NONE };
            system.apply(Op::Gradient { y }, 0..dimension, h, &mut v, &mut scratch);
            let along = Op::Structure { y, v: &v };
            system.apply(along, 0..dimension, Weights::NONE, &mut field, &mut scratch);
            for p in 0..WIDTH {
                let change: f64 = slope.iter().zip(&field).map(|(a, b)| a[p] * b[p]).sum();
                rate[p] += change * change;
            }
        }
    })
}

impl Along<'_> {
    /// How many numbers it has.
    pub fn rows(&self) -> usize {
        match self {
            Self::Time | Self::Integral(_) | Self::Average(_) => 1,
            Self::Passage(_) => 2,
        }
    }

    /// The function that is followed, of the state and of what is collected before; none of time.
    fn value(&self, rows: &[Row]) -> Row {
        let mut value = [0.0; WIDTH];
        match self {
            Self::Time => {}
            Self::Integral(v) | Self::Average(v) => v.evaluate(rows, PathMask::ALL, &mut value),
            Self::Passage(passage) => passage.phi.evaluate(rows, PathMask::ALL, &mut value),
        }
        value
    }
}

/// A method and what its paths collect.
pub struct Collecting<'a> {
    /// The method.
    pub method: Arc<dyn Method + 'a>,
    /// What is collected, row after row.
    pub quantities: Vec<Along<'a>>,
}

impl Method for Collecting<'_> {
    fn id(&self) -> &'static str {
        self.method.id()
    }

    fn reads_areas(&self) -> bool {
        self.method.reads_areas()
    }

    fn clips_increments(&self) -> bool {
        self.method.clips_increments()
    }

    fn stack(&self) -> usize {
        self.method.stack()
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let inner = self.method.start(y);
        let mut rows = inner.state().to_vec();
        let mut values = Vec::new();
        for quantity in &self.quantities {
            let value = quantity.value(&rows);
            match quantity {
                Along::Time | Along::Integral(_) => rows.push([0.0; WIDTH]),
                Along::Average(_) => rows.push(value),
                Along::Passage(_) => rows.extend([value.map(passed), [0.0; WIDTH]]),
            }
            values.push(value);
        }
        let (before, stopped) = (inner.state().to_vec(), PathMask::NONE);
        Box::new(Collector { inner, quantities: &self.quantities, before, rows, values, stopped })
    }
}

fn passed(phi: f64) -> f64 {
    f64::from(u8::from(phi > 0.0))
}

struct Collector<'a> {
    inner: Box<dyn Stepper + 'a>,
    quantities: &'a [Along<'a>],
    /// The state before the last step.
    before: Vec<Row>,
    /// The state and what was collected.
    rows: Vec<Row>,
    /// The functions at the state.
    values: Vec<Row>,
    /// The paths that stay where they are.
    stopped: PathMask,
}

impl Stepper for Collector<'_> {
    fn state(&self) -> &[Row] {
        &self.rows
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        self.inner.step(step, noise, status);
        let (before, tau, number) = (&mut self.before, step.tau, step.number() as f64);
        let mut first = before.len();
        before.copy_from_slice(&self.rows[..first]);
        let state = self.inner.state_mut();
        for p in self.stopped.paths() {
            state.iter_mut().zip(&*before).for_each(|(y, before)| y[p] = before[p]);
        }
        self.rows[..first].copy_from_slice(state);
        for (quantity, value) in self.quantities.iter().zip(&mut self.values) {
            let next = quantity.value(&self.rows);
            let rows = &mut self.rows[first..first + quantity.rows()];
            first += rows.len();
            match (quantity, rows) {
                (Along::Time, [time]) => time.fill(step.t + tau),
                (Along::Integral(_), [sum]) => {
                    for p in 0..WIDTH {
                        sum[p] += tau * (0.5 * (value[p] + next[p]));
                    }
                }
                (Along::Average(_), [mean]) => {
                    for p in 0..WIDTH {
                        let of_step = 0.5 * (value[p] + next[p]);
                        mean[p] += (of_step - mean[p]) / (number + 1.0);
                    }
                }
                (Along::Passage(passage), [crossed, time]) => {
                    let ends = (&*value, &next);
                    passage.advance(before, ends, step, noise, crossed, time);
                    if passage.stops {
                        let passed = (0..WIDTH).filter(|&p| crossed[p] > 0.0);
                        passed.for_each(|p| self.stopped.insert(p));
                    }
                }
                _ => unreachable!("each quantity has its number of rows"),
            }
            *value = next;
        }
    }
}

impl Passage<'_> {
    /// Marks the paths that pass zero within a step from `before`, with φ at both ends.
    fn advance(
        &self,
        before: &[Row],
        (a, b): (&Row, &Row),
        step: &Step,
        noise: &StepNoise,
        crossed: &mut Row,
        time: &mut Row,
    ) {
        let between = |p: usize| a[p] < 0.0 && b[p] < 0.0 && crossed[p] == 0.0;
        let mut rate = [0.0; WIDTH];
        if let Some(variance) = self.variance.as_ref().filter(|_| (0..WIDTH).any(between)) {
            variance(before, step.t + 0.5 * step.tau, &mut rate);
        }
        for p in (0..WIDTH).filter(|&p| crossed[p] == 0.0).collect::<Vec<_>>() {
            let share = if b[p] > 0.0 {
                // Where a straight line passes.
                if a[p] < 0.0 { a[p] / (a[p] - b[p]) } else { 0.5 }
            } else if rate[p] > 0.0
                && uniform(noise, step, p) < (-2.0 * a[p] * b[p] / (rate[p] * step.tau)).exp()
            {
                0.5
            } else {
                time[p] = step.t + step.tau;
                continue;
            };
            crossed[p] = 1.0;
            time[p] = step.t + step.tau * share.clamp(0.0, 1.0);
        }
    }
}

/// A number that is uniform on (0, 1), from the bits of the increments of path p in a step.
fn uniform(noise: &StepNoise, step: &Step, p: usize) -> f64 {
    let mixed =
        noise.increments.iter().fold(step.number(), |hash, row| mix(hash ^ row[p].to_bits()));
    ((mixed >> 11) as f64 + 0.5) * 2f64.powi(-53)
}

/// The output function of SplitMix64 (Steele, Lea and Flood 2014), a bijection.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
