//! Stationary laws: whether friction and noise are a heat bath, densities e^{−βH₀}, and volume.

use real::elementary::exp;
use serde::Serialize;
use systems::run_time::System;

use super::{
    Batch, Probe, Term, Values, ZERO, axis, combined, dot, largest, lengths, moved, norm, rank,
    seen, share, slopes, sum,
};

/// Stationary densities of a system under damping and noise.
///
/// e^{−βH₀} is stationary if the Fokker–Planck residual A + βB + β²C vanishes: with rates γᵢ,
/// fₘ = B∇Hₘ and dₘ = ∇·fₘ, sₘ = fₘ·∇H₀, it is A = Σγᵢ − ∇·f₀ + ½Σ(fₘ·∇dₘ + dₘ²), C = ½Σsₘ² and
/// B = s₀ − Σγᵢyᵢ∂ᵢH₀ − ½Σ(fₘ·∇sₘ + 2dₘsₘ), where s₀ is zero without a bath that shifts increments.
/// Tested at 32 points around the initial value; spins of a lattice have their initial lengths at
/// these points: f₀ and fₘ are tangential, and so are the divergences.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bath {
    /// Inverse temperature β for which e^{−βH₀} is stationary, if there is one.
    pub beta: Option<f64>,
    /// Whether every function of H₀ is stationary.
    pub any: bool,
    /// Reasons why no e^{−βH₀} is stationary, component by component, in words.
    pub mismatch: Vec<String>,
}

/// Steps of Newton's method for β.
const STEPS: usize = 8;

impl Bath {
    /// Computes the stationary densities of a system; its components have constant damping `rates`.
    pub fn of(system: &dyn System, y0: &[f64], rates: &[f64]) -> Self {
        let (mut probe, mut states) = seen(system, y0);
        let description = probe.description;
        let (bathed, of_formulas) = (description.has_bath, !description.joined.is_empty());
        // Of formulas the law holds on all leaves, of a lattice on that of the initial value.
        if bathed && !of_formulas {
            states.iter_mut().for_each(|y| scale_spins(y, y0));
        }
        let drift = probe.field(&states, &probe.weights(0));
        let slope = probe.gradient(&states, &probe.weights(0));
        let divergences = divergence(&mut probe, 0, &states);
        let power = match bathed {
            true => along(&mut probe, &states, &drift, &energies),
            false => vec![0.0; states.len()],
        };
        let of_drift = |n: usize| {
            let friction = (0..y0.len()).map(|i| -rates[i] * states[n][i] * slope[n][i]);
            let a = sum([-divergences[n]].into_iter().chain(rates.iter().copied()));
            [a, sum([power[n]].into_iter().chain(friction)), (0.0, 0.0)]
        };
        // A, B and C at each state, each with the size of its terms: of drift and damping, and of
        // each noise.
        let mut parts: Vec<Vec<Term>> = vec![(0..states.len()).flat_map(of_drift).collect()];
        let mut heat = vec![vec![0.0; y0.len()]; states.len()];
        for m in 1..=probe.noises() {
            let weights = probe.weights(m);
            let f = probe.field(&states, &weights);
            let of_divergence: Values<'_> = &|probe, y| divergence(probe, m, y);
            let power: Values<'_> = &|probe, y| {
                let f = probe.field(y, &weights);
                if bathed {
                    return along(probe, y, &f, &energies);
                }
                let g = probe.gradient(y, &probe.weights(0));
                f.iter().zip(&g).map(|(f, g)| dot(f, g)).collect()
            };
            let [(d, along_d), (s, along_s)] = [of_divergence, power]
                .map(|of| (of(&mut probe, &states), along(&mut probe, &states, &f, of)));
            let of_noise = |n: usize| {
                [
                    sum([0.5 * along_d[n], 0.5 * d[n].powi(2)]),
                    sum([-0.5 * along_s[n], -d[n] * s[n]]),
                    sum([0.5 * s[n] * s[n]]),
                ]
            };
            parts.push((0..states.len()).flat_map(of_noise).collect());
            let squares = heat.iter_mut().flatten().zip(f.iter().flatten());
            squares.for_each(|(heat, f)| *heat += f * f);
        }
        // The sum of all but one part.
        let without = |left: Option<usize>| {
            let rest = parts.iter().enumerate().filter(|(m, _)| Some(*m) != left);
            let none = vec![(0.0, 0.0); parts[0].len()];
            rest.fold(none, |sums, (_, part)| combined(&sums, part))
        };
        let terms = without(None);
        let size = largest(drift.iter().flatten());
        if terms.iter().all(|(x, of)| x.abs() <= ZERO * of.max(size)) {
            return Self { any: true, ..Self::default() };
        }
        let beta = stationary(&terms);
        // Of formulas, a bath has a law by the volume of leaves, which is not that of y.
        if bathed && of_formulas && !is_divergence_free(system, y0) {
            return Self { mismatch: vec![VOLUME.into()], ..Self::default() };
        }
        let mismatch = match beta {
            Some(_) => Vec::new(),
            None if bathed => {
                // A noise that spoils a bath: without it there is a temperature.
                let of = |m: usize| Some((m, stationary(&without(Some(m)))?));
                let spoils = (1..parts.len()).find_map(of).map(|(m, beta)| {
                    let kt = 1.0 / beta;
                    format!("noise {m} is not of the bath, which has kT = {kt:.6} without it")
                });
                vec![spoils.unwrap_or(BATHS.into())]
            }
            None => mismatch(&states, &slope, &heat, rates),
        };
        Self { beta, any: false, mismatch }
    }
}

/// Reason why no law is tested.
const VOLUME: &str = "fields B∇H have a divergence: e^(-βH0) is a law by the volume of the leaves, \
                      which is not tested";

/// Reason why no e^{−βH₀} is stationary with a bath.
const BATHS: &str = "baths have one temperature, and there is neither other damping nor other \
                     noise: transverse damping α of spins of one length |s| balances noise of each \
                     spin with σ² = 2α kT/|s|";

/// Values of H₀.
pub fn energies(probe: &mut Probe<'_>, y: &[Vec<f64>]) -> Vec<f64> {
    probe.energy(y, &probe.weights(0))
}

/// Part of the size of a derivative up to which it is zero: its error is a tenth of this.
const ERROR: f64 = 1e-13;

/// Derivatives of F along vectors; NaN where no step length resolves the derivative.
fn along(probe: &mut Probe<'_>, y: &[Vec<f64>], f: &Batch, value: Values<'_>) -> Vec<f64> {
    let slopes = slopes(probe, y, f, &lengths(y, f), value).into_iter();
    let known = slopes.map(|(slope, size)| match size.is_finite() {
        true if slope.abs() <= ERROR * size => 0.0,
        true => slope,
        false => f64::NAN,
    });
    known.collect()
}

/// Scales each spin of `y` to the length of that spin in `y0`.
fn scale_spins(y: &mut [f64], y0: &[f64]) {
    for (spin, first) in y.chunks_mut(3).zip(y0.chunks(3)) {
        let length = norm(first) / norm(spin);
        spin.iter_mut().for_each(|x| *x *= length);
    }
}

/// Divergence ∇·fₘ.
fn divergence(probe: &mut Probe<'_>, m: usize, y: &[Vec<f64>]) -> Vec<f64> {
    let weights = probe.weights(m);
    let slope = probe.gradient(y, &weights);
    trace(&probe.field_columns(y, &slope, &weights))
}

/// Solves A + βB + β²C = 0 at all states for a common β > 0, from A, B and C of each.
fn stationary(terms: &[Term]) -> Option<f64> {
    let all = || terms.as_chunks::<3>().0.iter();
    let of = |beta: f64, [a, b, c]: [f64; 3]| a + beta * (b + beta * c);
    let vanishes = |beta: &f64| {
        let zero = |terms: &[Term; 3]| {
            of(*beta, terms.map(|term| term.0)).abs() <= ZERO * of(*beta, terms.map(|term| term.1))
        };
        beta.is_finite() && *beta > 0.0 && all().all(zero)
    };
    let polished = |mut beta: f64| {
        for _ in 0..STEPS {
            let (mut up, mut down) = (0.0, 0.0);
            for &[(a, _), (b, _), (c, _)] in all() {
                let slope = b + 2.0 * beta * c;
                up += of(beta, [a, b, c]) * slope;
                down += slope * slope;
            }
            if down > 0.0 {
                beta -= up / down;
            }
        }
        beta
    };
    let roots = |&[(a, _), (b, _), (c, _)]: &[Term; 3]| {
        let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
        // Without cancellation.
        let q = -0.5 * (b + root.copysign(b));
        [q / c, a / q]
    };
    all().flat_map(roots).map(polished).find(vanishes)
}

/// Describes each component whose noise and damping do not balance; `heat` has the squared noises.
fn mismatch(states: &Batch, slope: &Batch, heat: &Batch, rates: &[f64]) -> Vec<String> {
    let mut words = Vec::new();
    let mut temperatures: Vec<(String, f64)> = Vec::new();
    for (i, rate) in rates.iter().enumerate() {
        let name = format!("y{}", i + 1);
        match (*rate != 0.0, heat.iter().any(|heat| heat[i] > 0.0)) {
            (false, false) => {}
            (true, false) => words.push(format!("{name} is damped and not heated")),
            (false, true) => words.push(format!("{name} is heated and not damped")),
            (true, true) => {
                // 2γy·kT = D∂H₀ by least squares.
                let damped: Vec<f64> = states.iter().map(|y| 2.0 * rate * y[i]).collect();
                let heated = heat.iter().zip(slope).map(|(heat, slope)| heat[i] * slope[i]);
                let heated: Vec<f64> = heated.collect();
                let (kt, size) = (share(&damped, &heated), largest(&heated));
                let rest = moved(&heated, -kt, &damped);
                match rest.iter().all(|rest| rest.abs() <= ZERO * size) {
                    true => temperatures.push((name, kt)),
                    false => words.push(format!("the temperature of {name} depends on the state")),
                }
            }
        }
    }
    let first = temperatures.first().map_or(0.0, |(_, kt)| *kt);
    if temperatures.iter().any(|(_, kt)| (kt / first - 1.0).abs() > ZERO) {
        words.extend(temperatures.iter().map(|(name, kt)| {
            let mut words = format!("{name} has kT = {kt:.6}");
            let noise = (kt / first).sqrt();
            if (noise - 1.0).abs() > ZERO {
                words += &format!(", its noise {noise:.6} times that of the first");
            }
            words
        }));
    }
    if words.is_empty() && heat.iter().flatten().chain(rates).all(|rate| *rate == 0.0) {
        words
            .push("the flow of H0 does not keep volume, so that e^(-βH0) is not stationary".into());
    } else if words.is_empty() {
        words.push("noise and damping do not balance: no e^(-βH0) is stationary".into());
    }
    words
}

/// Density of component number `place` at the points `x` under e^{−βH₀}, normalized to the sum one.
/// `None` unless B is invertible and H₀ is a function of this component plus one of the others, as
/// kinetic energies are: otherwise the density is an integral over the other components.
pub fn gibbs_marginal(
    system: &dyn System,
    y0: &[f64],
    place: usize,
    beta: f64,
    x: &[f64],
) -> Option<Vec<f64>> {
    let (mut probe, states) = seen(system, y0);
    if probe.matrix(&states).into_iter().any(|b| rank(b, y0.len()) < y0.len()) {
        return None;
    }
    let along = states.into_iter().map(|mut state| {
        let points = x.iter().map(|x| {
            state[place] = *x;
            state.clone()
        });
        energies(&mut probe, &points.collect::<Batch>())
    });
    let energies: Batch = along.collect();
    let (first, zero) = (&energies[0], ZERO * largest(energies.iter().flatten()));
    let alike = energies.iter().all(|energy| {
        let mut pairs = energy.iter().zip(first);
        pairs.all(|(a, b)| (a - b - (energy[0] - first[0])).abs() <= zero)
    });
    let least = first.iter().copied().fold(f64::INFINITY, f64::min);
    let density: Vec<f64> = first.iter().map(|energy| exp(-beta * (energy - least))).collect();
    let sum: f64 = density.iter().sum();
    alike.then(|| density.iter().map(|x| x / sum).collect())
}

/// Whether Σᵢ∂ᵢBᵢⱼ vanishes for every j, at 32 points: fields B∇H have no divergence then. Of an
/// equation without B whether no field has one.
pub fn is_divergence_free(system: &dyn System, y0: &[f64]) -> bool {
    let (mut probe, states) = seen(system, y0);
    let d = y0.len();
    let size = largest(probe.matrix(&states).iter().flatten().flatten());
    if probe.description.plain {
        let scale = size / norm(y0).max(1.0);
        return (0..=probe.noises())
            .all(|m| divergence(&mut probe, m, &states).iter().all(|x| x.abs() <= ZERO * scale));
    }
    (0..d).all(|j| {
        let axes = (0..d).map(|i| [axis(d, i)]);
        let columns = axes.map(|along| probe.structure_along(&states, &along, &[axis(d, j)]));
        trace(&columns.collect::<Vec<_>>()).iter().all(|sum| sum.abs() <= ZERO * size)
    })
}

/// Trace at each state: the sum over i of component i of column i.
fn trace(columns: &[Batch]) -> Vec<f64> {
    let at = |n: usize| columns.iter().enumerate().map(|(i, column)| column[n][i]).sum();
    (0..columns.first().map_or(0, Vec::len)).map(at).collect()
}
