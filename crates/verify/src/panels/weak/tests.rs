//! Variance times cost of three estimators of E[φ(y_τ)] − E[φ(y_{τ/2})].

use mc::{Ladder, Observable, Run, Statistic, View, bind};
use noise::StreamKey;
use schemes::Sexp;
use stats::CrossMoments;
use systems::{RigidBody, paper::rigid_body_three_noises};

use crate::{compiled, panels::weak_observables, truncation};

/// φ(coarse), φ(fine), the plain and the antithetic difference of every test function at the final
/// time.
struct Estimates {
    observables: Vec<Observable<3>>,
    last_time: u64,
    moments: Vec<CrossMoments>,
}

impl Statistic for Estimates {
    fn observe(&mut self, view: &View<'_>) {
        if view.time != self.last_time {
            return;
        }
        for (observable, moments) in self.observables.iter().zip(&mut self.moments) {
            for p in view.live.paths() {
                let [coarse, fine, swapped] =
                    [0, 1, 2].map(|run| (observable.function)(view.path(run, p)));
                moments.add(&[coarse, fine, coarse - fine, coarse - 0.5 * (fine + swapped)]);
            }
        }
    }

    fn merge(&mut self, later: Self) {
        for (sum, more) in self.moments.iter_mut().zip(&later.moments) {
            sum.merge(more);
        }
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len().is_multiple_of(2) {
        0.5 * (values[middle - 1] + values[middle])
    } else {
        values[middle]
    }
}

/// With 4096 paths a variance is known to 5 % or so; the smallest advantage that is asserted is a
/// factor of 2.
#[test]
fn antithetic_estimators_are_the_narrowest_per_path_step() {
    const PATHS: u64 = 4096;
    let problem = rigid_body_three_noises(1.0);
    let observables = weak_observables();
    let sexp = compiled::<_, RigidBody<3>, 3, 3>(Sexp);
    let mut variances = Vec::new();
    println!("| τ | independent | plain difference | antithetic | its variance / τ² |");
    for exponent in [6, 8, 10] {
        let runs = vec![
            Run::new(bind(&problem, sexp.as_ref()), 1),
            Run::new(bind(&problem, sexp.as_ref()), 0),
            Run::swapped(bind(&problem, sexp.as_ref()), 0),
        ];
        let key = StreamKey { seed: 1, experiment: exponent };
        let ladder =
            Ladder::new(&mc::Problem::of(&problem), 2 << exponent, 1, truncation(), key, runs)
                .unwrap();
        let statistic = || Estimates {
            observables: observables.clone(),
            last_time: ladder.coarse_steps(),
            moments: vec![CrossMoments::new(4); observables.len()],
        };
        let measured = ladder.run(PATHS, statistic, &|_| ()).statistic.moments;
        // Steps: one coarse and two fine for each coarse one, and twice the fine ones with the
        // twin.
        let steps = (1u64 << exponent) as f64;
        let work = measured.iter().map(|moments| {
            let variance = |i: usize| PATHS as f64 * moments.covariance_of_means(i, i);
            [
                3.0 * steps * (variance(0) + variance(1)),
                3.0 * steps * variance(2),
                5.0 * steps * variance(3),
            ]
        });
        let work: Vec<[f64; 3]> = work.collect();
        for (observable, [independent, plain, antithetic]) in observables.iter().zip(&work) {
            assert!(
                2.0 * antithetic < *plain && plain < independent,
                "{} at 2^-{exponent}",
                observable.name
            );
        }
        let [independent, plain, antithetic] =
            [0, 1, 2].map(|i| median(work.iter().map(|row| row[i]).collect()));
        let relative = antithetic / (5.0 * steps) * steps * steps;
        println!(
            "| 2^-{exponent} | {independent:.1e} | {plain:.1e} | {antithetic:.1e} | \
             {relative:.1e} |"
        );
        variances.push(relative);
    }
    // The premise of the allocation: the variance falls like τ². From 2^-6 to 2^-10, an order of ½
    // more or less is a factor of 16.
    assert!((0.25..4.0).contains(&(variances[2] / variances[0])), "{variances:?}");
}
