//! Space-time areas as the driver draws them.

use mc::drawn;
use noise::{DyadicLadder, StepNoise, StreamKey};
use real::WIDTH;

/// H has the variance τ/12 at each step size and is independent of ΔW: five standard errors of the
/// means over n samples are exceeded in 6e-7 of all cases. The twin: other variances by a tenth.
#[test]
fn space_time_areas_have_their_law() {
    let (tau, levels, steps) = (0.25, 2, 4096);
    let source = drawn(StreamKey { seed: 3, experiment: 1 }, tau, None).unwrap();
    let mut next = source(0);
    let mut ladder = DyadicLadder::new(levels, &StepNoise::zero(2).with_space_time());
    let mut sums = vec![[0.0; 3]; levels + 1];
    let mut counts = vec![0.0; levels + 1];
    for _ in 0..steps {
        let complete = ladder.push(|noise| next(noise));
        for level in 0..=complete {
            let noise = ladder.whole(level);
            let size = tau * f64::from(1 << level);
            for p in 0..WIDTH {
                let [h, other] = [0, 1].map(|m| noise.space_time[m][p] / (size / 12.0).sqrt());
                let dw = noise.increments[0][p] / size.sqrt();
                for (sum, x) in sums[level].iter_mut().zip([h * h - 1.0, h * dw, h * other]) {
                    *sum += x;
                }
                counts[level] += 1.0;
            }
        }
    }
    for (sums, n) in sums.iter().zip(counts) {
        let [square, with_dw, with_other] = sums.map(|sum| sum / n);
        let error = 5.0 / f64::sqrt(n);
        assert!(square.abs() < 2f64.sqrt() * error && square.abs() < 0.09, "{square}");
        assert!(with_dw.abs() < error && with_other.abs() < error, "{with_dw} {with_other}");
    }
}
