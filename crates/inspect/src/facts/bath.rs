//! Stationary laws: whether friction and noise are a heat bath, densities e^{−βH₀}, and volume.

use real::elementary::exp;
use serde::Serialize;
use systems::run_time::System;

use super::{
    Batch, Probe, Term, Values, ZERO, axis, dot, largest, lengths, moved, norm, null_space, seen,
    share, slopes,
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
        let bathed = probe.description().has_bath;
        // Of formulas the law holds on all leaves, of a lattice on that of the initial value.
        if bathed && probe.description().joined.is_empty() {
            states.iter_mut().for_each(|y| scale_spins(y, y0));
        }
        let d = y0.len();
        let drift = probe.field(&states, &probe.weights(0));
        let drift_divergence = divergence(&mut probe, 0, &states);
        let slope = probe.gradient(&states, &probe.weights(0));
        // A, B and C at each state, each with the size of its terms: of drift and damping, and of
        // each noise.
        let none = || [(); 3].map(|()| vec![(0.0, 0.0); states.len()]);
        let mut parts = vec![none()];
        let add = |to: &mut Term, x: f64| *to = (to.0 + x, to.1 + x.abs());
        if bathed {
            let power = along(&mut probe, &states, &drift, &energy);
            parts[0][1].iter_mut().zip(power).for_each(|(b, power)| add(b, power));
        }
        let mut heat = vec![vec![0.0; d]; states.len()];
        for (n, y) in states.iter().enumerate() {
            add(&mut parts[0][0][n], -drift_divergence[n]);
            for i in 0..d {
                add(&mut parts[0][0][n], rates[i]);
                add(&mut parts[0][1][n], -rates[i] * y[i] * slope[n][i]);
            }
        }
        for m in 1..=probe.noises() {
            let weights = probe.weights(m);
            let f = probe.field(&states, &weights);
            let of_divergence: Values<'_> = &|probe, y| divergence(probe, m, y);
            let power: Values<'_> = &|probe, y| {
                let f = probe.field(y, &weights);
                if bathed {
                    return along(probe, y, &f, &energy);
                }
                let g = probe.gradient(y, &probe.weights(0));
                f.iter().zip(&g).map(|(f, g)| dot(f, g)).collect()
            };
            let [(d, along_d), (s, along_s)] = [of_divergence, power]
                .map(|of| (of(&mut probe, &states), along(&mut probe, &states, &f, of)));
            let mut part = none();
            for n in 0..states.len() {
                add(&mut part[0][n], 0.5 * along_d[n]);
                add(&mut part[0][n], 0.5 * d[n].powi(2));
                add(&mut part[1][n], -0.5 * along_s[n]);
                add(&mut part[1][n], -d[n] * s[n]);
                add(&mut part[2][n], 0.5 * s[n] * s[n]);
                heat[n].iter_mut().zip(&f[n]).for_each(|(heat, f)| *heat += f * f);
            }
            parts.push(part);
        }
        // The sum of all but one part.
        let without = |left: Option<usize>| {
            let mut sums = none();
            for part in parts.iter().enumerate().filter(|(m, _)| Some(*m) != left).map(|all| all.1)
            {
                for (sum, term) in sums.iter_mut().flatten().zip(part.iter().flatten()) {
                    *sum = (sum.0 + term.0, sum.1 + term.1);
                }
            }
            sums
        };
        let terms = without(None);
        let size = largest(drift.iter().flatten());
        let zero = |(x, of): &Term| x.abs() <= ZERO * of.max(size);
        if terms.iter().flatten().all(zero) {
            return Self { any: true, ..Self::default() };
        }
        let beta = stationary(&terms);
        // Of formulas, a bath has a law by the volume of leaves, which is not that of y.
        if bathed && !probe.description().joined.is_empty() && !is_divergence_free(system, y0) {
            return Self { mismatch: vec![VOLUME.into()], ..Self::default() };
        }
        // A noise that spoils a bath: without it there is a temperature.
        let spoils = || {
            let of = |m: usize| Some((m, stationary(&without(Some(m)))?));
            let (m, beta) = (1..parts.len()).find_map(of)?;
            let kt = 1.0 / beta;
            Some(format!("noise {m} is not of the bath, which has kT = {kt:.6} without it"))
        };
        let mismatch = match beta {
            Some(_) => Vec::new(),
            None if bathed => vec![spoils().unwrap_or(BATHS.into())],
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
fn energy(probe: &mut Probe<'_>, y: &[Vec<f64>]) -> Vec<f64> {
    probe.energy(y, &probe.weights(0))
}

/// Part of the size of a derivative up to which it is zero: its error is a tenth of this.
const ERROR: f64 = 1e-13;

/// Derivatives of F along vectors; NaN where no step length resolves the derivative.
fn along(probe: &mut Probe<'_>, y: &[Vec<f64>], f: &Batch, value: Values<'_>) -> Vec<f64> {
    let known = |(slope, size): Term| match size.is_finite() {
        true if slope.abs() <= ERROR * size => 0.0,
        true => slope,
        false => f64::NAN,
    };
    slopes(probe, y, f, &lengths(y, f), value).into_iter().map(known).collect()
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
    let (d, weights) = (probe.dimension(), probe.weights(m));
    let slope = probe.gradient(y, &weights);
    trace(d, |i| probe.field_along(y, &[axis(d, i)], &slope, &weights))
}

/// Solves A + βB + β²C = 0 at all states for a common β > 0.
fn stationary([a, b, c]: &[Vec<Term>; 3]) -> Option<f64> {
    let all = || a.iter().zip(b).zip(c).map(|((a, b), c)| (*a, *b, *c));
    let of = |beta: f64, a: f64, b: f64, c: f64| a + beta * (b + beta * c);
    let vanishes = |beta: &f64| {
        let zero = |(a, b, c): (Term, Term, Term)| {
            of(*beta, a.0, b.0, c.0).abs() <= ZERO * of(*beta, a.1, b.1, c.1)
        };
        beta.is_finite() && *beta > 0.0 && all().all(zero)
    };
    let polished = |mut beta: f64| {
        for _ in 0..STEPS {
            let (mut up, mut down) = (0.0, 0.0);
            for (a, b, c) in all() {
                let slope = b.0 + 2.0 * beta * c.0;
                up += of(beta, a.0, b.0, c.0) * slope;
                down += slope * slope;
            }
            if down > 0.0 {
                beta -= up / down;
            }
        }
        beta
    };
    let roots = |((a, _), (b, _), (c, _)): (Term, Term, Term)| {
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
            let noise = (kt / first).sqrt();
            let words = format!("{name} has kT = {kt:.6}");
            match (noise - 1.0).abs() > ZERO {
                true => format!("{words}, its noise {noise:.6} times that of the first"),
                false => words,
            }
        }));
    }
    if words.is_empty() {
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
    let weights = probe.weights(0);
    for b in probe.matrix(&states) {
        let zero = ZERO * largest(b.iter().flatten());
        if !null_space(b, y0.len(), zero).0.is_empty() {
            return None;
        }
    }
    let along = |state: &Vec<f64>| {
        let at = |x: &f64| {
            let mut state = state.clone();
            state[place] = *x;
            state
        };
        probe.energy(&x.iter().map(at).collect::<Batch>(), &weights)
    };
    let energies: Batch = states.iter().map(along).collect();
    let (first, zero) = (&energies[0], ZERO * largest(energies.iter().flatten()));
    let alike = energies.iter().all(|energy| {
        let same = |(a, b): (&f64, &f64)| (a - b - (energy[0] - first[0])).abs() <= zero;
        energy.iter().zip(first).all(same)
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
    if probe.description().plain {
        let scale = size / norm(y0).max(1.0);
        let none =
            |m| divergence(&mut probe, m, &states).iter().all(|sum| sum.abs() <= ZERO * scale);
        return (0..=system.description().noises).all(none);
    }
    (0..d).all(|j| {
        let column = |i: usize| probe.structure_along(&states, &[axis(d, i)], &[axis(d, j)]);
        trace(d, column).iter().all(|sum| sum.abs() <= ZERO * size)
    })
}

/// Trace at each state: the sum over i of component i of column i.
pub fn trace(d: usize, mut column: impl FnMut(usize) -> Batch) -> Vec<f64> {
    let mut sums = Vec::new();
    for i in 0..d {
        let column = column(i);
        sums.resize(column.len(), 0.0);
        sums.iter_mut().zip(column).for_each(|(sum, column)| *sum += column[i]);
    }
    sums
}
