//! Geometric Brownian motion dX = σX ∘ dW by its exact solution, on noise that can be replayed: the
//! mean of X(1) over 10 000 paths beside e^{σ²/2}.

use noise::{StreamKey, Truncation, WienerPath};

const SIGMA: f64 = 0.4;
const PATHS: u64 = 10_000;
const STEPS: u32 = 16;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let key = StreamKey { seed: 1, experiment: 1 };
    let tau = 1.0 / f64::from(STEPS);
    let bound = Truncation::new(4)?.bound(tau)?;
    let (mut sum, mut squares, mut clipped) = (0.0, 0.0, 0);
    for path in 0..PATHS {
        let mut noise = WienerPath::<1>::new(key, path);
        let mut w = 0.0;
        for _ in 0..STEPS {
            let [dw] = noise.increments(tau.sqrt());
            clipped += u32::from(dw.abs() > bound);
            w += dw;
        }
        let x = (SIGMA * w).exp();
        sum += x;
        squares += x * x;
    }
    let mean = sum / PATHS as f64;
    let error = ((squares / PATHS as f64 - mean * mean) / PATHS as f64).sqrt();
    let exact = (0.5 * SIGMA * SIGMA).exp();
    println!("E[X(1)] = {mean:.4} ± {:.4}, exactly {exact:.4}", 2.0 * error);
    println!("{clipped} increments beyond ±{bound:.3}");
    // Four standard errors, at a fixed seed: this can only fail when the noise has changed.
    if (mean - exact).abs() > 4.0 * error {
        let off = (mean - exact).abs() / error;
        return Err(format!("the mean {mean} is {off:.1} standard errors off").into());
    }
    Ok(())
}
