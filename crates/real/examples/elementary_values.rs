//! Prints arguments and values of the elementary functions, as bits, for
//! `crates/real/tools/reference_values.py --measure`, which compares them with many digits and
//! prints the errors that the module documents.

use real::elementary::{
    cos, deficit_versine, exp, half_turn, ln, minus_two_ln, sin, sin_cos_absolute, sinc, split_unit,
};

/// A small generator of equidistributed numbers.
struct Uniform(u64);

impl Uniform {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        let word = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d);
        low + (high - low) * (((word >> 12) as f64 + 0.5) * 2f64.powi(-52))
    }
}

type Function = (&'static str, fn(f64) -> f64);

const FUNCTIONS: [Function; 12] = [
    ("sin", sin),
    ("cos", cos),
    ("sinc", sinc),
    ("sin_half_turn", |r| half_turn(r).1 / half_turn(r).2),
    ("cos_half_turn", |r| half_turn(r).0 / half_turn(r).2),
    ("exp", exp),
    ("ln", ln),
    ("ln_unit", |u| -0.5 * minus_two_ln(split_unit(u).0, split_unit(u).1)),
    ("sin_absolute", |x| sin_cos_absolute(x).0),
    ("cos_absolute", |x| sin_cos_absolute(x).1),
    ("deficit", |x| deficit_versine(x).0),
    ("versine", |x| deficit_versine(x).1),
];

fn main() {
    let mut uniform = Uniform(0x1234_5678_9abc_def1);
    for i in 0..250_000 {
        for (name, function) in FUNCTIONS {
            let x = match (name, i % 4) {
                ("sin" | "cos" | "sinc" | "sin_absolute" | "cos_absolute", 0) => {
                    uniform.between(-4.0, 4.0)
                }
                ("sin" | "cos" | "sinc" | "sin_absolute" | "cos_absolute", 1) => {
                    uniform.between(-0.8, 0.8)
                }
                ("sin" | "cos" | "sinc" | "sin_absolute" | "cos_absolute", 2) => {
                    uniform.between(-50.0, 50.0)
                }
                ("sin" | "cos" | "sinc" | "sin_absolute" | "cos_absolute", _) => {
                    uniform.between(-1_048_576.0, 1_048_576.0)
                }
                ("sin_half_turn" | "cos_half_turn", _) => uniform.between(-0.5, 0.5),
                ("deficit" | "versine", _) => uniform.between(-0.7, 0.7),
                ("exp", 0 | 1) => uniform.between(-0.4, 0.4),
                ("exp", 2) => uniform.between(-745.2, -708.0),
                ("exp", _) => uniform.between(-708.0, 709.8),
                ("ln", 0 | 1) => uniform.between(0.6, 1.5),
                ("ln", 2) => uniform.between(0.0, 10.0),
                ("ln", _) => uniform.between(-1073.0, 1024.0).exp2(),
                ("ln_unit", 0 | 1) => uniform.between(0.4, 1.0),
                _ => uniform.between(0.0, 1.0),
            };
            println!("{name} {:016x} {:016x}", x.to_bits(), function(x).to_bits());
        }
    }
}
