//! What 10⁵ paths of a damped rigid body with three noises do: means, quantiles and histograms in
//! time. Writes a table, all of the result, and two figures.
//!
//! ```text
//! cargo run --release -p casimir-poisson --example many_paths
//! ```

use casimir::figures::{histogram, law};
use casimir::plot::figure::bands;
use casimir::prelude::*;
use casimir::systems::{Cosine, RigidBody};
use std::fs::{File, write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0])?;
    let problem = Problem::new(body, Cosine::new(0.5, 2.0)?, [0.45, 0.0, 0.89], 10.0)?;
    let observables = [
        Observable { name: "y1", function: |y: [f64; 3]| y[0] },
        Observable { name: "y3", function: |y: [f64; 3]| y[2] },
        Observable { name: "y1 y2", function: |y: [f64; 3]| y[0] * y[1] },
    ];
    let key = StreamKey { seed: 1, experiment: 0 };
    // 400 steps, 40 times, 10⁵ paths.
    let settings = StudySettings::new(400, 40, 100_000, Truncation::new(4)?, key);
    let result = Study::new(&Setup::of(&problem, &Sexp), &observables, &settings)?.run();

    let y1 = result.series("y1").ok_or("y1 is observed")?;
    for point in y1.points.iter().step_by(10) {
        let (mean, (lo, hi)) = point.mean.zip(point.mean_interval).ok_or("no path is left")?;
        println!("t = {}: mean {mean:.4} in [{lo:.4}, {hi:.4}]", point.time);
    }
    for quantile in &y1.last().quantiles {
        // A quantile outside of the grid of the histogram has no value.
        if let Some(value) = quantile.value {
            println!("{} % of the paths end below {value:.3}", 100.0 * quantile.level);
        }
    }
    result.warnings.iter().for_each(|warning| println!("{warning}"));

    let folder = std::env::temp_dir();
    result.write_csv(&mut File::create(folder.join("study.csv"))?)?;
    write(folder.join("study.json"), serde_json::to_string(&result)?)?;
    write(folder.join("study-y1.svg"), bands("y1 in time", "time t", "y1", &law(&y1.points)))?;
    write(folder.join("study-y1-end.svg"), histogram("y1 at the end", "y1", y1.last()))?;
    println!("study.csv, study.json, study-y1.svg and study-y1-end.svg in {}", folder.display());
    Ok(())
}
