//! A damping of your own: a laser medium that is lossy only while a shutter is open.
//!
//! ```text
//! cargo run -p casimir-poisson --example own_damping
//! ```

use casimir::prelude::*;
use casimir::systems::{DampingFunction, MaxwellBloch};

/// γ(t) = γ₀ while frac(t) < `open`, else 0.
#[derive(Clone, Copy)]
struct Shutter {
    rate: f64,
    open: f64,
}

impl Shutter {
    /// ∫₀ᵗ γ: whole periods, and what is open of the last.
    fn until(&self, t: f64) -> f64 {
        self.rate * (t.floor() * self.open + (t - t.floor()).min(self.open))
    }
}

impl Damping for Shutter {
    fn rate(&self, t: f64) -> f64 {
        if t - t.floor() < self.open { self.rate } else { 0.0 }
    }
    fn integral(&self, a: f64, b: f64) -> f64 {
        self.until(b) - self.until(a)
    }
    fn describe(&self) -> String {
        format!("γ = {} for {} of every period", self.rate, self.open)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let shutter = Shutter { rate: 0.8, open: 0.3 };
    let problem = Problem::new(MaxwellBloch, shutter, [1.0, 2.0, 3.0], 4.0)?;
    let report = inspect_problem(&problem)?;
    println!("{}\n", report.problem.as_ref().map_or("", |problem| problem.damping.as_str()));
    assert!(report.mistakes.is_empty(), "{report}");

    // C = ½(y₂² + y₃²) falls in steps, and `sexp` follows its law through every edge of the
    // shutter.
    let (sexp, key) = (Sexp, StreamKey { seed: 1, experiment: 0 });
    let path = Simulation::new(Setup::of(&problem, &sexp), Truncation::new(4)?)
        .every(50)
        .path(400, key, 0)?;
    write_csv(&[path], &mut std::io::stdout())?;

    // The same as a function, integrated by quadrature: `inspect` sees that four nodes cannot find
    // the edges, says by how much, and cannot tell whether that matters. Smooth functions are
    // integrated to round-off.
    let by_quadrature = DampingFunction::new(move |t| shutter.rate(t), 4)?;
    let report =
        inspect_problem(&Problem::new(MaxwellBloch, by_quadrature, [1.0, 2.0, 3.0], 4.0)?)?;
    println!(
        "\nby quadrature: {}",
        report.problem.map_or(String::new(), |problem| problem.integral.to_string())
    );

    // A wrong integral is named.
    struct Wrong(Shutter);
    impl Damping for Wrong {
        fn rate(&self, t: f64) -> f64 {
            self.0.rate(t)
        }
        fn integral(&self, a: f64, b: f64) -> f64 {
            self.0.rate * (b - a)
        }
        fn describe(&self) -> String {
            "γ with a wrong integral".to_owned()
        }
    }
    let report =
        inspect_problem(&Problem::new(MaxwellBloch, Wrong(shutter), [1.0, 2.0, 3.0], 4.0)?)?;
    println!("{}", report.mistakes.join("\n"));
    Ok(())
}
