//! Systems whose dimension and number of noises are known at run time only: the same bits as those
//! that the compiler knows.

use std::sync::Arc;

use mc::{
    Expect, Formulas, Ladder, Observable, Observe, Recording, Run, Setup, Simulation,
    StateFunction, Statistic, Study, StudySettings, View, bind,
    parts::{Job, Program, Share, Stop},
    study,
};
use noise::{StepNoise, Truncation};
use nonlin::BlockStatus;
use real::{PathMask, Real, Row, Rows, WIDTH};
use schemes::{Heun, Method, Step, Stepper};
use systems::{Constant, Damping, PoissonSystem, Problem};

use crate::ladder::KEY;

/// Sums of the increments of M noises, then of the areas of their pairs.
struct Sums;

impl Method for Sums {
    fn id(&self) -> &'static str {
        "sums"
    }
    fn reads_areas(&self) -> bool {
        true
    }
    fn clips_increments(&self) -> bool {
        false
    }
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(Summed(y.to_vec()))
    }
}

struct Summed(Vec<Row>);

impl Stepper for Summed {
    fn step(&mut self, _: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let rows = noise.increments.iter().chain(noise.areas.iter());
        for (y, row) in self.0.iter_mut().zip(rows) {
            (0..WIDTH).for_each(|p| y[p] += row[p]);
        }
        *status = BlockStatus::explicit();
    }
    fn state(&self) -> &[Row] {
        &self.0
    }
    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.0
    }
}

/// No formulas.
struct Nothing;

impl Formulas for Nothing {
    fn structure(&self, _: &[f64], _: &[f64]) -> Vec<f64> {
        Vec::new()
    }
    fn energy(&self, _: &[f64], _: f64, _: &[f64]) -> f64 {
        0.0
    }
    fn field(&self, _: &[f64], _: f64, _: &[f64]) -> Vec<f64> {
        Vec::new()
    }
    fn ito_correction(&self, _: &[f64]) -> Vec<f64> {
        Vec::new()
    }
    fn law(&self, _: usize, _: &[f64]) -> f64 {
        0.0
    }
}

fn problem<'a>(
    damping: &'a dyn Damping,
    noises: usize,
    y0: &[f64],
    formulas: impl Formulas + 'a,
) -> mc::Problem<'a> {
    mc::Problem {
        name: "turn".into(),
        parameters: String::new(),
        noises,
        y0: y0.into(),
        t_end: 1.0,
        damping,
        laws: Vec::new(),
        formulas: Box::new(formulas),
    }
}

/// The bits of all states at all times, path by path.
#[derive(Default, Debug, PartialEq)]
struct Bits(Vec<u64>);

impl Statistic for Bits {
    fn observe(&mut self, view: &View<'_>) {
        for run in 0..view.runs() {
            for row in view.state(run) {
                self.0.extend(view.live.paths().map(|p| row[p].to_bits()));
            }
            self.0.push(u64::from(view.clipped[run].0));
        }
    }
    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}

/// Sums over two finest steps, and over one of twice their size.
#[test]
fn a_number_of_noises_known_at_run_time_has_the_increments_and_areas_of_paths() {
    let damping = Constant::new(0.0).unwrap();
    let problem = problem(&damping, 3, &[0.0; 12], Nothing);
    let sums: Arc<dyn Method> = Arc::new(Sums);
    let runs = vec![Run::new(Arc::clone(&sums), 0), Run::new(sums, 1)];
    let ladder = Ladder::new(&problem, 2, 1, Truncation::none(), KEY, runs).unwrap();
    for path in [0, 41] {
        let bits = ladder.run_until(&Stop::default(), path, 1, Bits::default, &|_| ()).statistic.0;
        let fine = Recording::<3>::draw(KEY, path, 2, 1.0, true).unwrap();
        let coarse = fine.coarsened(2).unwrap();
        let mut expected = Vec::new();
        for recording in [&fine, &coarse] {
            let (dw, areas) = (recording.increments(), recording.areas().unwrap());
            let sum = |of: &dyn Fn(usize) -> f64| (0..dw.len()).fold(0.0, |sum, n| sum + of(n));
            expected.extend((0..3).map(|m| sum(&|n| dw[n][m]).to_bits()));
            for (m, l) in (0..9).map(|k| (k / 3, k % 3)) {
                let area = sum(&|n| if m < l { areas[n][m][l] } else { 0.0 });
                expected.push(area.to_bits());
            }
            expected.push(0);
        }
        let numbers = |bits: &[u64]| bits.iter().map(|&bits| f64::from_bits(bits)).collect();
        let (found, expected): (Vec<f64>, Vec<f64>) = (numbers(&bits), numbers(&expected));
        assert_eq!(found[..12], expected[..12], "path {path}");
        // A recording adds areas in another order.
        let differ = found.iter().zip(&expected).any(|(a, b)| (a - b).abs() > 1e-15);
        assert!(!differ && found.len() == expected.len(), "path {path}: {found:?} {expected:?}");
    }
}

/// H₀ = ½(q² + p²), H₁ = ½q², H₂ = ½p², H₃ = ½(q² + p²).
struct Turn;

impl PoissonSystem<2, 3> for Turn {
    fn name(&self) -> &'static str {
        "turn"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 3]) -> R {
        let [a, b] = [dt + dw[0] + dw[2], dt + dw[1] + dw[2]];
        y[0] * y[0] * (0.5 * a) + y[1] * y[1] * (0.5 * b)
    }
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 3]) -> [R; 2] {
        [y[0] * (dt + dw[0] + dw[2]), y[1] * (dt + dw[1] + dw[2])]
    }
}

/// The formulas of the same system on slices.
struct TurnFormulas;

impl Formulas for TurnFormulas {
    fn structure(&self, _: &[f64], v: &[f64]) -> Vec<f64> {
        vec![v[1], -v[0]]
    }
    fn energy(&self, y: &[f64], dt: f64, dw: &[f64]) -> f64 {
        let [a, b] = [dt + dw[0] + dw[2], dt + dw[1] + dw[2]];
        y[0] * y[0] * (0.5 * a) + y[1] * y[1] * (0.5 * b)
    }
    fn field(&self, y: &[f64], dt: f64, dw: &[f64]) -> Vec<f64> {
        let [a, b] = [dt + dw[0] + dw[2], dt + dw[1] + dw[2]];
        vec![y[1] * b, -y[0] * a]
    }
    /// (f₁′)² = (f₂′)² = 0 and (f₃′)² = −1.
    fn ito_correction(&self, y: &[f64]) -> Vec<f64> {
        vec![-0.5 * y[0], -0.5 * y[1]]
    }
    fn law(&self, _: usize, _: &[f64]) -> f64 {
        unreachable!("there is none")
    }
}

/// `heun` on it, written on rows.
struct TurnHeun;

impl Method for TurnHeun {
    fn id(&self) -> &'static str {
        "heun"
    }
    fn reads_areas(&self) -> bool {
        false
    }
    fn clips_increments(&self) -> bool {
        false
    }
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let mut rows = Rows::zero(y.len()).unwrap();
        rows.copy_from_slice(y);
        Box::new(Turned(rows))
    }
}

struct Turned(Rows);

impl Stepper for Turned {
    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let [q, p] = &mut self.0[..] else { unreachable!("two components") };
        for k in 0..WIDTH {
            let dw = |m: usize| noise.increments[m][k];
            let [a, b] = [step.tau + dw(0) + dw(2), step.tau + dw(1) + dw(2)];
            let change = |q: f64, p: f64, rate: f64| {
                [p * b - q * (step.tau * rate), -(q * a) - p * (step.tau * rate)]
            };
            let first = change(q[k], p[k], step.rate_at_start);
            let second = change(q[k] + first[0], p[k] + first[1], step.rate_at_end);
            q[k] += (first[0] + second[0]) * 0.5;
            p[k] += (first[1] + second[1]) * 0.5;
        }
        *status = BlockStatus::explicit();
        status.fail_where_not_finite(&self.0);
    }
    fn state(&self) -> &[Row] {
        &self.0
    }
    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.0
    }
}

/// qp of any system that begins with them.
struct Product;

impl Observe for Product {
    fn name(&self) -> &str {
        "qp"
    }
    fn evaluate(&self, y: &[Row], live: PathMask, values: &mut Row) {
        live.paths().for_each(|p| values[p] = y[0][p] * y[1][p]);
    }
}

const PRODUCT: [Observable<2>; 1] = [Observable { name: "qp", function: |y| y[0] * y[1] }];
const START: [f64; 2] = [1.0, 0.25];

fn compiled() -> Problem<Turn, Constant, 2> {
    Problem::new(Turn, Constant::new(0.5).unwrap(), START, 1.0).unwrap()
}

fn setup(damping: &Constant) -> Setup<'_> {
    Setup { problem: problem(damping, 3, &START, TurnFormulas), scheme: Arc::new(TurnHeun) }
}

#[test]
fn a_system_on_rows_has_the_bits_of_the_compiled_one_on_a_ladder() {
    let (one, damping) = (compiled(), Constant::new(0.5).unwrap());
    let Setup { problem, scheme } = setup(&damping);
    let k = Truncation::none();
    let runs = vec![
        Run::new(bind(&one, &Heun), 0),
        Run::new(bind(&one, &Heun), 2),
        Run::swapped(bind(&one, &Heun), 1),
    ];
    let ladder = Ladder::new(&mc::Problem::of(&one), 32, 2, k, KEY, runs).unwrap();
    let run = |level| Run::new(Arc::clone(&scheme), level);
    let runs = vec![run(0), run(2), Run::swapped(Arc::clone(&scheme), 1)];
    let other = Ladder::new(&problem, 32, 2, k, KEY, runs).unwrap();
    let bits = ladder.run(200, Bits::default, &|_| ()).statistic;
    assert_eq!(other.run(200, Bits::default, &|_| ()).statistic, bits);
}

#[test]
fn a_system_on_rows_has_the_bits_of_the_compiled_one_in_tables() {
    let (one, damping) = (compiled(), Constant::new(0.5).unwrap());
    let simulation = Simulation::new(Setup::of(&one, &Heun), Truncation::none()).every(3);
    let tables = simulation
        .observing(StateFunction::new("qp", |y: [f64; 2]| y[0] * y[1]))
        .paths(16, KEY, 5..40)
        .unwrap();
    let other = Simulation::new(setup(&damping), Truncation::none()).every(3);
    assert_eq!(other.observing(Product).paths(16, KEY, 5..40).unwrap(), tables);
}

/// A study, and parts of it: its files do not tell the two systems apart.
#[test]
fn a_system_on_rows_has_the_bits_of_the_compiled_one_in_a_study() {
    let (one, damping) = (compiled(), Constant::new(0.5).unwrap());
    let settings = StudySettings::new(16, 4, 1000, Truncation::none(), KEY);
    let result = study(&Setup::of(&one, &Heun), &PRODUCT, &settings, &|_| ()).unwrap();
    let other = Study::new(&setup(&damping), &[Product], &settings).unwrap();
    assert_eq!(other.run(&|_| ()), result);

    let folder = tempfile::tempdir().unwrap();
    let program = || Program { name: "study".into(), version: "1".into() };
    let part =
        |number| Job::part(folder.path(), Share::new(number, 2).unwrap(), program()).unwrap();
    let (first, second) = (part(1), part(2));
    let one = Study::new(&Setup::of(&one, &Heun), &PRODUCT, &settings).unwrap();
    assert!(one.run_in(&first, "study", &|_| ()).is_none());
    assert!(other.run_in(&second, "study", &|_| ()).is_none());
    first.finish().unwrap();
    second.finish().unwrap();
    let job = Job::merge(folder.path(), program()).unwrap();
    assert_eq!(other.run_in(&job, "study", &|_| ()), Some(result));
    job.finish().unwrap();
}

#[test]
fn a_system_on_rows_has_the_bits_of_the_compiled_one_in_an_expectation() {
    let (one, damping) = (compiled(), Constant::new(0.5).unwrap());
    for random_points in [true, false] {
        let found = Expect::with_scheme(Setup::of(&one, &Heun)).with_truncation(Truncation::none());
        let found = if random_points { found.with_random_points() } else { found };
        let found = found.with_coarsest_steps(4).run(&[&PRODUCT[0]], 0.02, &|_| ()).unwrap();
        let other = Expect::with_scheme(setup(&damping)).with_coarsest_steps(4);
        let other = if random_points { other.with_random_points() } else { other };
        assert_eq!(other.run(&[&Product], 0.02, &|_| ()), Ok(found));
    }
}
