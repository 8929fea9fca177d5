//! Everything that runs paths.

use anyhow::ensure;
use expectation::{Expect, ExpectSettings};
use kernels::Tuned;
use mc::{Ladder, Observable, Run, Setup, Simulation, bind};
use noise::{StreamKey, Truncation};
use schemes::BuiltIn;
use systems::{Constant, Pendulum, Problem};

use super::{Bits, Fed, accepted};

pub fn drivers(bits: &mut Bits) -> Fed {
    let [amplitude, t_end] = [(); 2].map(|()| bits.positive(8));
    let problem = accepted(Pendulum::new(amplitude).and_then(|system| {
        Problem::new::<1>(system, Constant::new(bits.number())?, bits.state(), t_end)
    }))?;
    let drawn = Truncation::new(bits.below(5) as u32);
    let truncation = if bits.one_in(3) { Truncation::none() } else { accepted(drawn)? };
    // From 2⁴⁰ on it is refused.
    let key = StreamKey { seed: bits.word(), experiment: bits.word() >> bits.below(64) };
    let em = Tuned::scheme(BuiltIn::EulerMaruyama, problem.system(), problem.y0())?;
    let mut few = |wild: u64, few: u64| {
        if bits.one_in(8) { bits.below(wild) } else { bits.below(few) }
    };
    match few(3, 3) {
        0 => {
            let (steps, path) = (bits.below(20), bits.word());
            let simulation = Simulation::new(Setup::of(&problem, &*em), truncation);
            let path = accepted(simulation.path(steps, key, path))?;
            let mut states = path.columns[1..=2].iter().flat_map(|column| &column.values);
            ensure!(states.all(|y| y.is_finite()), "{path:?}");
            ensure!(path.halted.is_none_or(|words| !words.is_empty()), "a failure without words");
        }
        1 => {
            let (levels, steps) = (few(200, 4) as usize, few(u64::MAX, 33));
            let runs = vec![Run::new(bind(&problem, &*em), few(300, 4) as usize)];
            accepted(Ladder::new(
                &mc::Problem::of(&problem),
                steps,
                levels,
                truncation,
                key,
                runs,
            ))?;
        }
        _ => {
            let order = if bits.one_in(2) { 1.0 } else { bits.number() };
            let settings = ExpectSettings {
                key: StreamKey { experiment: key.experiment >> bits.below(40), ..key },
                truncation,
                weak_order: Some(order),
                random_points: bits.one_in(2),
                coarsest_steps: bits.below(8),
                max_level: bits.below(30) as usize,
                max_cost: bits.below(200_000),
                ..Default::default()
            };
            let expect = Expect::with_scheme(Setup::of(&problem, &*em)).with(settings);
            let first = Observable { name: "y1", function: |y: [f64; 2]| y[0] };
            let result = expect.run(&[&first], bits.positive(8));
            let found = accepted(result)?.estimates[0].clone();
            let (lower, upper) = found.interval();
            // Without a mean there is none.
            let is_none = found.half_width() == f64::INFINITY;
            ensure!(is_none || lower <= upper, "interval [{lower}, {upper}]");
        }
    }
    Ok(())
}
