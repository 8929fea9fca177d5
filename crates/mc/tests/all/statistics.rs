//! What a ladder shows to statistics: clipped paths and random times.

use mc::{Run, Statistic, TimeChange, View, bind};
use noise::{Truncation, WienerPath};
use real::{Row, WIDTH};
use schemes::EulerMaruyama;

use crate::ladder::{KEY, body, ladder};

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
    let ladder = ladder(&problem, (64, 3), 2, runs).unwrap().with_time_change(&Steps);
    let two = ladder.run(PATHS, || vec![Seen(Vec::new()), Seen(Vec::new())]).statistic;
    let [seen, same] = &two[..] else { panic!("two statistics") };
    assert_eq!(seen.0, same.0);
    let (mut clipped, bounds) = (0, [64.0, 8.0].map(|steps: f64| k.bound(1.0 / steps).unwrap()));
    for (path, (time, found)) in seen.0.iter().enumerate() {
        let mut wiener = WienerPath::<3>::new(KEY, path as u64);
        let steps: Vec<[f64; 3]> = (0..64).map(|_| wiener.increments(0.125)).collect();
        let w: f64 = steps.iter().map(|dw| dw[0]).sum();
        assert!((time - 64.0 - w).abs() < 1e-12);
        let beyond = [(1, bounds[0]), (8, bounds[1])].map(|(fine, bound)| {
            let sum = |steps: &[[f64; 3]], m: usize| steps.iter().map(|dw| dw[m]).sum::<f64>();
            steps.chunks(fine).any(|steps| (0..3).any(|m| sum(steps, m).abs() > bound))
        });
        assert_eq!(*found, beyond, "path {path}");
        clipped += u64::from(beyond[1]);
    }
    assert!(0 < clipped && clipped < PATHS, "{clipped}");
}
