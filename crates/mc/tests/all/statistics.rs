//! What a ladder shows to statistics: clipped paths and random times; and recordings against their
//! numbers.

use mc::{Ladder, Recording, Run, Statistic, TimeChange, View, bind};
use noise::Truncation;
use real::{Row, WIDTH};
use schemes::EulerMaruyama;

use crate::ladder::{KEY, body};

const PATHS: u64 = 70;

/// Random time W₁ after step n of the finest level, and 64 more after the last one.
struct Steps;

impl TimeChange for Steps {
    fn advance(&self, n: u64, dw: &[Row], _normals: &Row, random_time: &mut Row) {
        for p in 0..WIDTH {
            random_time[p] += dw[0][p] + if n == 63 { 64.0 } else { 0.0 };
        }
    }
}

/// The random time of each path, and which paths of each run have a clipped increment.
struct Seen(Vec<(f64, [bool; 2])>);

impl Statistic for Seen {
    fn observe(&mut self, view: &View<'_>) {
        if view.time == 8 {
            let clipped = |p| [0, 1].map(|run| view.clipped[run].contains(p));
            self.0.extend(view.live.paths().map(|p| (view.random_time[p], clipped(p))));
        }
    }
    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}

#[test]
fn statistics_see_random_times_and_clipped_paths() {
    let (problem, k) = (body(), Truncation::new(2).unwrap());
    let runs = vec![
        Run::new(bind(&problem, &EulerMaruyama), 0),
        Run::new(bind(&problem, &EulerMaruyama), 3),
    ];
    let ladder = Ladder::new(&mc::Problem::of(&problem), 64, 3, k, KEY, runs).unwrap();
    let ladder = ladder.with_time_change(&Steps);
    let two = ladder.run(PATHS, || vec![Seen(Vec::new()), Seen(Vec::new())], &|_| ()).statistic;
    let [seen, same] = &two[..] else { panic!("two statistics") };
    assert_eq!(seen.0, same.0);
    let (mut clipped, bounds) = (0, [64.0, 8.0].map(|steps: f64| k.bound(1.0 / steps).unwrap()));
    for (path, (time, found)) in seen.0.iter().enumerate() {
        let recording = Recording::draw(KEY, path as u64, 64, 1.0, 3, false).unwrap();
        let w: f64 = recording.rows().iter().map(|dw| dw[0]).sum();
        assert!((time - 64.0 - w).abs() < 1e-12);
        let beyond = [(1, bounds[0]), (8, bounds[1])].map(|(fine, bound)| {
            let sum = |steps: &[Vec<f64>], m: usize| steps.iter().map(|dw| dw[m]).sum::<f64>();
            let mut steps = recording.rows().chunks(fine);
            steps.any(|steps| (0..3).any(|m| sum(steps, m).abs() > bound))
        });
        assert_eq!(*found, beyond, "path {path}");
        clipped += u64::from(beyond[1]);
    }
    assert!(0 < clipped && clipped < PATHS, "{clipped}");
}

#[test]
fn a_recording_knows_its_step_and_reads_steps_that_agree() {
    let drawn = Recording::draw(KEY, 0, 8, 2.0, 2, true).unwrap();
    assert_eq!((drawn.tau(), drawn.rows().len(), drawn.rows()[7].len()), (0.25, 8, 3));
    for t_end in [-1.0, 0.0, f64::INFINITY] {
        assert!(Recording::draw(KEY, 0, 8, t_end, 2, false).is_err(), "{t_end}");
    }
    // Steps may differ by 1e-9 of themselves, whatever their size.
    for tau in [1e-6, 1.0, 1e6] {
        let read = |factor: f64| {
            let text = format!("tau,dW1\n{tau:e},1\n{:e},1\n", tau * factor);
            text.parse::<Recording>()
        };
        assert!(read(1.0 + 0.9e-9).is_ok() && read(1.0 - 0.9e-9).is_ok(), "{tau}");
        for factor in [1.0 + 1.1e-9, 1.0 - 1.1e-9] {
            let refused = read(factor).unwrap_err().to_string();
            assert!(refused.starts_with("line 3, column tau: all steps"), "{tau} {refused}");
        }
    }
    for bad in ["-0.1", "0", "inf", "NaN"] {
        let error = format!("tau,dW1\n0.1,1\n{bad},1\n").parse::<Recording>().unwrap_err();
        assert!(error.to_string().starts_with("line 3, column tau: a step size"), "{error}");
    }
    // Columns of areas of two noises, and of ten.
    let two = Recording::new(0.5, 2, vec![vec![1.0, 2.0, 0.25]]).unwrap();
    assert_eq!(two.to_string(), "tau,dW1,dW2,A12\n0.5,1.0,2.0,0.25\n");
    let ten = Recording::draw(KEY, 0, 1, 1.0, 10, true).unwrap();
    let header = ten.to_string().lines().next().unwrap().to_owned();
    assert!(header.starts_with("tau,dW1,dW2,") && header.contains(",dW10,A1_2,A1_3,"), "{header}");
    assert_eq!(header.split(',').count(), 1 + 10 + 45);
    assert_eq!(ten.to_string().parse::<Recording>().unwrap(), ten);
}
