//! What a run has to know of a system, found in milliseconds: [`Facts`], and the rule for the
//! default scheme, [`Conserved`].
//!
//! Here is what `inspect` is made of, too: a system at many states, identities
//! with three answers, and the search for Casimirs. The bits of all this are the same on every
//! machine.

mod algebra;
mod bath;
mod damping;
mod ergodic;
mod finding;
mod form;
mod probe;
mod random;
mod scheme;
mod search;

use std::sync::Arc;

use mc::ConformalLaw;
use real::WIDTH;
use systems::run_time::{Problem, System};

// What facts and inspections are made of.
pub(crate) use {algebra::*, finding::*, form::*, probe::*, random::*, search::*};
use {bath::energies, ergodic::derivative};

pub use bath::{Bath, gibbs_marginal, is_divergence_free};
pub use damping::DampingIntegral;
pub use ergodic::{Growth, Span, growth, span};
pub use finding::{Finding, Status};
pub use form::Form;
pub use scheme::{Conserved, is_damped};

/// Facts about a problem that a run needs: the laws that the problem obeys.
///
/// Identities are tested at 32 random points around the initial value: what is found holds to 10⁻⁹
/// of its terms there. The bits are the same on every machine. `inspect` tests more,
/// and more sharply.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// Linear Casimirs, then quadratic ones that are not products of these; of an equation without
    /// B the functions that drift and noises keep.
    pub casimirs: Vec<Form>,
    /// Whether every Hₘ is a multiple of H₀, up to a constant, and none depends on time.
    pub proportional: bool,
    /// The degree of H₀, if it is homogeneous.
    pub degree: Option<f64>,
    /// Whether there is damping.
    pub damped: bool,
    /// Message if the integral of the damping is not the integral of its rate.
    pub mistake: Option<String>,
}

impl Facts {
    /// The facts of a problem whose system has one path in each place of a row.
    pub fn of(problem: &Problem) -> Self {
        let integral = DampingIntegral::of(problem.damping(), problem.t_end());
        let (system, y0) = (problem.system(), problem.y0());
        let (mut probe, y) = seen(system, y0);
        // Euler's identity y·∇H₀ = pH₀.
        let slopes = probe.gradient(&y, &probe.weights(0));
        let euler: Vec<f64> = y.iter().zip(&slopes).map(|(y, slope)| dot(y, slope)).collect();
        let degree = multiple(&energies(&mut probe, &y), &euler);
        Self {
            casimirs: casimirs_around(system, y0),
            proportional: is_proportional(system, y0),
            degree: degree.filter(|d| *d != 0.0 && !system.description().plain).map(nearby_integer),
            damped: !integral.none,
            mistake: integral.mistake(),
        }
    }

    /// The laws of Casimirs C1, C2, … and of the energy H0 of this system.
    pub fn laws<'a>(&'a self, system: &'a dyn System) -> Vec<ConformalLaw<'a>> {
        let casimirs = self.casimirs.iter().zip(1..).map(|(form, k)| form.law(format!("C{k}")));
        let of_energy = self.energy_law().map(|degree| {
            let value = Arc::new(move |y: &[f64]| energy(system, y));
            ConformalLaw { name: "H0".into(), degree, casimir: false, value, decay: None }
        });
        casimirs.chain(of_energy).collect()
    }

    /// Degree p of the law H₀(y(t)) = e^{−p∫γ}H₀(y₀), if there is one; arbitrary without damping.
    pub fn energy_law(&self) -> Option<f64> {
        let degree = self.degree.or((!self.damped).then_some(0.0));
        degree.filter(|_| self.proportional)
    }
}

/// Probe of a system, and 32 points around y₀.
fn seen<'a>(system: &'a dyn System, y0: &[f64]) -> (Probe<'a>, Batch) {
    let probe = Probe::new(system);
    let states = around(&probe, y0, &mut Random::new(Purpose::Points));
    (probe, states)
}

/// Whether every Hₘ is a multiple of H₀, up to a constant, and none depends on time.
fn is_proportional(system: &dyn System, y0: &[f64]) -> bool {
    let (mut probe, y) = seen(system, y0);
    let mut slope = |m: usize| probe.gradient(&y, &probe.weights(m)).concat();
    let (description, drift) = (system.description(), slope(0));
    !description.depends_on_time
        && !description.has_bath
        && !description.plain
        && (1..=description.noises).all(|m| multiple(&drift, &slope(m)).is_some())
}

/// Energy H₀(y) of a system with one path in each place of a row.
pub fn energy(system: &dyn System, y: &[f64]) -> f64 {
    energies(&mut Probe::new(system), &[y.to_vec()])[0]
}

/// The linear and quadratic Casimirs of a system, as [`Facts`] have them.
pub fn casimirs_around(system: &dyn System, y0: &[f64]) -> Vec<Form> {
    let mut random = Random::new(Purpose::Points);
    let mut forms = casimirs(&mut Probe::new(system), |probe| around(probe, y0, &mut random)).forms;
    forms.retain(|form| form.degree > 0);
    forms
}

/// Largest number of components for which [`fastest`] computes the matrix of the derivative.
const MAX_COMPONENTS: usize = 64;
/// Squarings of that matrix: ρ is found to the factor 1 ± 64·ln κ/2²⁰, κ its condition.
const SQUARINGS: u32 = 20;

/// The rate of the fastest motion about y₀ without noise, in radians or e-foldings per time: the
/// spectral radius ρ of f′(y₀) with f = B∇H₀, by Gelfand's formula ρ = lim ‖f′ᵏ‖^{1/k}. Zero with
/// more than 64 components, and where f′(y₀) is not finite.
pub fn fastest(system: &dyn System, y0: &[f64]) -> f64 {
    let d = y0.len();
    if d > MAX_COMPONENTS || d == 0 {
        return 0.0;
    }
    let mut probe = Probe::new(system);
    let weights = probe.weights(0);
    let radius = spectral_radius(derivative(&mut probe, y0, &weights).1, SQUARINGS);
    if radius.is_finite() { radius } else { 0.0 }
}

/// Draws 32 points of the domain, as far from y₀ as its size where possible.
fn around(probe: &Probe<'_>, y0: &[f64], random: &mut Random) -> Batch {
    let size = if norm(y0) == 0.0 { 1.0 } else { 0.3 * norm(y0) };
    let mut point = || {
        let shift: Vec<f64> = y0.iter().map(|y| random.uniform() * (y.abs() + size)).collect();
        probe.halved_into_domain(y0, 1.0, &shift).unwrap_or_else(|| y0.to_vec())
    };
    (0..WIDTH).map(|_| point()).collect()
}

/// Factor c with b = c·a, if there is one.
fn multiple(a: &[f64], b: &[f64]) -> Option<f64> {
    let c = share(a, b);
    let scale = largest(b) + c.abs() * largest(a);
    a.iter().zip(b).all(|(a, b)| (b - c * a).abs() <= ZERO * scale).then_some(c)
}

/// Rounds x to an integer if one is within the relative distance 10⁻⁹, else conserves x.
fn nearby_integer(x: f64) -> f64 {
    if (x - x.round()).abs() <= ZERO * x.abs() { x.round() } else { x }
}
