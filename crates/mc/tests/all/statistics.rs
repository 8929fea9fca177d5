//! Statistics of final states against the states themselves, and recordings against their numbers.

use mc::{
    Ladder, Recording, Reference, Run, Setup, Simulation, StrongErrors, TimeChange, WorstTimes,
    bind,
};
use noise::Truncation;
use real::{Row, WIDTH};
use schemes::{EulerMaruyama, Sexp};
use systems::{Damping, PoissonSystem};

use crate::ladder::{KEY, Keep, body};

const PATHS: usize = 70;

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    values.sum::<f64>() / PATHS as f64
}

fn close(found: f64, exact: f64) -> bool {
    (found - exact).abs() <= 1e-12 * exact.abs()
}

fn square(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum()
}

/// Runs 0 to 3: the reference, then a series from coarse to fine, and the last one exchanged.
fn with_runs<T>(use_it: impl FnOnce(&Ladder<'_>, Truncation) -> T) -> T {
    let (problem, euler, k) = (body(), EulerMaruyama, Truncation::new(2).unwrap());
    let sexp = Sexp;
    let runs = vec![
        Run::new(bind(&problem, &sexp), 0),
        Run::new(bind(&problem, &euler), 3),
        Run::new(bind(&problem, &euler), 2),
        Run::swapped(bind(&problem, &euler), 2),
    ];
    use_it(&Ladder::new(&mc::Problem::of(&problem), 64, 3, k, KEY, runs).unwrap(), k)
}

/// The states of all runs at coarse time n.
fn states(ladder: &Ladder<'_>, n: u64) -> Vec<Vec<[f64; 3]>> {
    ladder.run(PATHS as u64, || Keep::new(n, 4), &|_| ()).statistic.runs
}

#[test]
fn strong_errors_are_mean_squares_of_distances() {
    with_runs(|ladder, _| {
        let series = [vec![1, 2], vec![3]];
        let new = || StrongErrors::new(Reference::Run(0), &series, ladder.coarse_steps());
        let errors = ladder.run(PATHS as u64, new, &|_| ()).statistic;
        let last = states(ladder, 8);
        let distance =
            |a: usize, b: usize| mean((0..PATHS).map(|p| square(last[a][p], last[b][p])));
        for (s, runs) in series.iter().enumerate() {
            for (r, &run) in runs.iter().enumerate() {
                assert!(close(errors.at_end(s).errors.mean(r), distance(run, 0)), "{s} {r}");
            }
        }
        let differences = &errors.at_end(0).differences;
        assert!(differences.length() == 1 && close(differences.mean(0), distance(1, 2)));
        assert_eq!(errors.at_end(1).differences.length(), 0);
        // At other times, and at that where the difference of two runs is largest.
        let at = |n: u64, run: usize, from: usize| {
            let states = states(ladder, n);
            mean((0..PATHS).map(|p| square(states[run][p], states[from][p])))
        };
        let new = || WorstTimes::new(vec![[1, 0], [3, 2]], ladder.coarse_steps());
        let times = ladder.run(PATHS as u64, new, &|_| ()).statistic.times();
        for (time, [run, from]) in times.iter().zip([[1, 0], [3, 2]]) {
            let largest = (1..=8).map(|n| at(n, run, from)).fold(0.0, f64::max);
            assert!(close(at(*time, run, from), largest));
        }
        let new = || StrongErrors::new(Reference::Run(0), &series, 8).and_at(&[times[0], 3]);
        let errors = ladder.run(PATHS as u64, new, &|_| ()).statistic;
        assert!(close(errors.at_time(0).errors.mean(0), at(times[0], 1, 0)));
        assert!(close(errors.at_time(1).errors.mean(0), at(3, 3, 0)));
        assert_eq!(errors.at_time(1).errors.count(), PATHS as u64);
    });
}

/// Which paths of a run have a clipped increment.
struct Clipped(Vec<bool>);

impl mc::Statistic for Clipped {
    fn observe(&mut self, view: &mc::View<'_>) {
        if view.time == 8 {
            self.0.extend(view.live.paths().map(|p| view.clipped[1].contains(p)));
        }
    }
    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}

#[test]
fn clipped_paths_have_their_share_of_the_mean_square() {
    with_runs(|ladder, _| {
        let series = [vec![1], vec![0]];
        let new = || StrongErrors::new(Reference::Run(0), &series, ladder.coarse_steps());
        let errors = ladder.run(PATHS as u64, new, &|_| ()).statistic;
        let clipped = ladder.run(PATHS as u64, || Clipped(Vec::new()), &|_| ()).statistic.0;
        let last = states(ladder, 8);
        let error = |p: usize| square(last[1][p], last[0][p]);
        let exact =
            mean((0..PATHS).filter(|&p| clipped[p]).map(error)) / mean((0..PATHS).map(error));
        assert!(0.0 < exact && exact < 1.0, "{exact}");
        assert!(close(errors.clipped_share(0, 0), exact));
        // The reference has no error, and no share of it.
        assert_eq!(errors.clipped_share(1, 0), 0.0);
    });
}

/// Random time n + 1 + W₁ after step n of the finest level.
struct Steps;

impl TimeChange for Steps {
    fn advance(&self, n: u64, dw: &[Row], _normals: &Row, random_time: &mut Row) {
        for p in 0..WIDTH {
            random_time[p] += dw[0][p] + if n == 63 { 64.0 } else { 0.0 };
        }
    }
}

#[test]
fn errors_against_an_exact_solution_are_taken_at_the_random_time() {
    let (problem, sexp) = (body(), Sexp);
    let k = Truncation::new(2).unwrap();
    let runs = vec![Run::new(bind(&problem, &sexp), 0)];
    let ladder = Ladder::new(&mc::Problem::of(&problem), 64, 3, k, KEY, runs)
        .unwrap()
        .with_time_change(&Steps);
    let solution = |s: f64| vec![s, 0.0, 0.0];
    let series = [vec![0]];
    let new = || StrongErrors::new(Reference::Exact(&solution), &series, ladder.coarse_steps());
    let errors = ladder.run(PATHS as u64, new, &|_| ()).statistic;
    let last = ladder.run(PATHS as u64, || Keep::new(8, 1), &|_| ()).statistic.runs;
    let exact = mean((0..PATHS).map(|p| {
        let recording = Recording::<3>::draw(KEY, p as u64, 64, 1.0, false).unwrap();
        let w: f64 = recording.increments().iter().map(|dw| dw[0]).sum();
        square(last[0][p], [64.0 + w, 0.0, 0.0])
    }));
    assert!(close(errors.at_end(0).errors.mean(0), exact));
}

#[test]
fn the_defect_of_a_scheme_that_leaves_the_law_is_relative_to_the_law() {
    let problem = body();
    let k = Truncation::new(4).unwrap();
    let table =
        Simulation::new(Setup::of(&problem, &EulerMaruyama), k).every(8).path(16, KEY, 7).unwrap();
    let (casimir, defects) = (table.column("C").unwrap(), table.column("C defect").unwrap());
    let start: f64 = problem.system().invariant(0, problem.y0());
    for ((t, value), defect) in table.times().iter().zip(casimir).zip(defects) {
        let law = start * (-2.0 * problem.damping().integral(0.0, *t)).exp();
        assert!((defect - (value / law - 1.0)).abs() < 1e-14, "{t}");
    }
    assert!(defects[2].abs() > 1e-3, "{defects:?}");
}

#[test]
fn a_recording_knows_its_step_and_reads_steps_that_agree() {
    let drawn = Recording::<2>::draw(KEY, 0, 8, 2.0, true).unwrap();
    assert_eq!((drawn.tau(), drawn.increments().len()), (0.25, 8));
    assert_eq!(drawn.coarsened(4).unwrap().tau(), 1.0);
    for t_end in [-1.0, 0.0, f64::INFINITY] {
        assert!(Recording::<2>::draw(KEY, 0, 8, t_end, false).is_err(), "{t_end}");
    }
    // Steps may differ by 1e-9 of themselves, whatever their size.
    for tau in [1e-6, 1.0, 1e6] {
        let read = |factor: f64| {
            let text = format!("tau,dW1\n{tau:e},1\n{:e},1\n", tau * factor);
            text.parse::<Recording<1>>()
        };
        assert!(read(1.0 + 0.9e-9).is_ok() && read(1.0 - 0.9e-9).is_ok(), "{tau}");
        for factor in [1.0 + 1.1e-9, 1.0 - 1.1e-9] {
            let refused = read(factor).unwrap_err().to_string();
            assert!(refused.starts_with("line 3, column tau: all steps"), "{tau} {refused}");
        }
    }
    for bad in ["-0.1", "0", "inf", "NaN"] {
        let error = format!("tau,dW1\n0.1,1\n{bad},1\n").parse::<Recording<1>>().unwrap_err();
        assert!(error.to_string().starts_with("line 3, column tau: a step size"), "{error}");
    }
    // Columns of areas of two noises, and of ten.
    let two = Recording::<2>::new(0.5, vec![[1.0, 2.0]]).unwrap();
    let two = two.with_areas(vec![[[0.0, 0.25], [0.0; 2]]]).unwrap();
    assert_eq!(two.to_string(), "tau,dW1,dW2,A12\n0.5,1.0,2.0,0.25\n");
    let ten = Recording::<10>::draw(KEY, 0, 1, 1.0, true).unwrap();
    let header = ten.to_string().lines().next().unwrap().to_owned();
    assert!(header.starts_with("tau,dW1,dW2,") && header.contains(",dW10,A1_2,A1_3,"), "{header}");
    assert_eq!(header.split(',').count(), 1 + 10 + 45);
    assert_eq!(ten.to_string().parse::<Recording<10>>().unwrap(), ten);
}
