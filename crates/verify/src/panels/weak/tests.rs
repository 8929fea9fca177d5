//! Variance times cost of three estimators of E[φ(y_τ)] − E[φ(y_{τ/2})].

use analysis::FinalMoments;
use mc::{Run, View};
use noise::StreamKey;
use systems::paper::rigid_body_three_noises;

use super::difference_ladder;
use crate::{Compiled, panels::weak_observables};

/// With 4096 paths a variance is known to 5 % or so; the smallest advantage that is asserted is a
/// factor of 2.
#[test]
fn antithetic_estimators_are_the_narrowest_per_path_step() {
    const PATHS: u64 = 4096;
    let problem = rigid_body_three_noises(1.0);
    let sexp = Compiled::of(&problem).sexp();
    let observables = weak_observables();
    let mut variances = Vec::new();
    println!("| τ | independent | plain difference | antithetic | its variance / τ² |");
    for exponent in [6, 8, 10] {
        let scheme = || sexp.scheme.clone();
        let runs = vec![Run::new(scheme(), 1), Run::new(scheme(), 0), Run::swapped(scheme(), 0)];
        let key = StreamKey { seed: 1, experiment: exponent };
        let steps = (1u64 << exponent) as f64;
        let ladder = difference_ladder(&sexp.problem, 1.0 / steps, key, runs);
        // φ(coarse), φ(fine), the plain and the antithetic difference of every test function.
        let values = |view: &View<'_>, rows: &mut [real::Row]| {
            for (rows, observable) in rows.chunks_exact_mut(4).zip(&observables) {
                for p in view.live.paths() {
                    let phi = |run| (observable.function)(view.path(run, p));
                    let [coarse, fine, swapped] = [0, 1, 2].map(phi);
                    let plain = coarse - fine;
                    let antithetic = coarse - 0.5 * (fine + swapped);
                    let numbers = [coarse, fine, plain, antithetic];
                    rows.iter_mut().zip(numbers).for_each(|(row, number)| row[p] = number);
                }
            }
        };
        let new = || FinalMoments::new(ladder.coarse_steps(), 4 * observables.len(), &values);
        let moments = ladder.run(PATHS, new, &|_| ()).statistic.moments;
        // Steps: one coarse and two fine for each coarse one, and twice the fine ones with the
        // twin.
        let mut work = [const { Vec::new() }; 3];
        for n in 0..observables.len() {
            let variance =
                |i: usize| PATHS as f64 * moments.covariance_of_means(4 * n + i, 4 * n + i);
            let [a, b, plain, antithetic] = [0, 1, 2, 3].map(variance);
            let products = [3.0 * (a + b), 3.0 * plain, 5.0 * antithetic].map(|work| steps * work);
            let [independent, plain, antithetic] = products;
            let name = observables[n].name;
            assert!(2.0 * antithetic < plain && plain < independent, "{name} at 2^-{exponent}");
            work.iter_mut().zip(products).for_each(|(all, product)| all.push(product));
        }
        let [independent, plain, antithetic] = work.map(|mut all| {
            all.sort_by(f64::total_cmp);
            0.5 * (all[5] + all[6])
        });
        let relative = antithetic * steps / 5.0;
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
