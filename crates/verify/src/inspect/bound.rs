//! What keeps all paths in a ball (paper, `cor:exist` and `cor:num`).

use serde::Serialize;
use systems::{Damping, PoissonSystem, Problem};

use super::casimirs::{Casimirs, FoundCasimir};
use super::finding::Finding;
use super::hamiltonian::Hamiltonians;
use super::probe::{Of, Probe, pick};
use super::shape::Minimum;

/// A function F with a conformal law and m(F) > 0: ‖y(t)‖ ≤ (F(y₀)/m(F))^{1/p} e^{−∫γ}.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// F.
    pub function: String,
    /// p.
    pub degree: f64,
    /// m(F).
    pub minimum: Minimum,
}

impl Bound {
    /// One that holds everywhere before one that holds in the domain; a Casimir before the energy.
    pub(super) fn of(hamiltonians: &Hamiltonians, casimirs: &Casimirs) -> Option<Self> {
        let casimir = |found: &FoundCasimir| Self {
            function: found.formula.clone(),
            degree: f64::from(found.degree),
            minimum: found.minimum,
        };
        let energy = hamiltonians.noise_size.and_then(|_| {
            let shape = &hamiltonians.shapes[0];
            Some(Self {
                function: "H₀".to_owned(), degree: shape.degree?, minimum: shape.minimum?
            })
        });
        let candidates = casimirs.definite.iter().chain(&casimirs.found).map(casimir).chain(energy);
        let positive = candidates.filter(|bound| bound.minimum.positive && bound.degree > 0.0);
        positive.min_by_key(|bound| bound.minimum.in_domain_only)
    }
}

/// What follows for one initial value problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProblemFindings {
    /// γ in words.
    pub damping: String,
    /// `integral` is the integral of `rate`, on pieces of [0, T], by quadrature.
    pub integral: Finding,
    /// Whether it is so to six digits on all pieces but the few in which γ may jump, and over the
    /// whole of [0, T].
    pub integral_agrees: bool,
    /// The largest ‖y(t)‖ that any path reaches on [0, T], where something bounds it.
    pub radius: Option<f64>,
}

/// Pieces of [0, T].
const PIECES: u32 = 1024;
/// Nodes on each of them: round-off for any γ that is smooth on a thousandth of [0, T].
const NODES: usize = 8;
/// Where γ is smooth, integral and quadrature agree to this: far above the error of any closed form
/// and of any quadrature that a damping should use, far below that of a wrong formula.
const AGREEMENT: f64 = 1e-6;
/// Pieces in which γ may jump or bend; the quadrature is wrong in them by no more than the piece.
const JUMPS: u32 = PIECES / 64;

impl ProblemFindings {
    pub(super) fn of<S, G, const D: usize, const M: usize>(
        problem: &Problem<S, G, D>,
        hamiltonians: &Hamiltonians,
        casimirs: &Casimirs,
        bound: Option<&Bound>,
    ) -> Self
    where
        S: PoissonSystem<D, M>,
        G: Damping,
    {
        let rule = dgrad::Rule::new(NODES)
            .unwrap_or_else(|error| unreachable!("a constant number of nodes: {error}"));
        let time = |n: u32| problem.t_end * f64::from(n) / f64::from(PIECES);
        let mut integral = Finding::new();
        // −∫γ at its largest, over the whole and the half steps alike.
        let (mut damped, mut least, mut total) = (0.0, 0.0f64, 0.0);
        let (mut disagreeing, mut difference) = (0, 0.0);
        for n in 0..PIECES {
            let (a, b) = (time(n), time(n + 1));
            let size = rule.integrate(a, b, |t| problem.damping.rate(t).abs());
            let exact = rule.integrate(a, b, |t| problem.damping.rate(t));
            total += size;
            let given = problem.damping.integral(a, b);
            let scale = size.max(total / f64::from(n + 1));
            integral.see(given - exact, scale, &[a]);
            let agree = (given - exact).abs() <= AGREEMENT * scale;
            disagreeing += u32::from(!agree);
            difference += given - exact;
            damped += given;
            least = least.min(damped);
        }
        let system = Of::<S, D, M>(&problem.system);
        let radius = bound.map(|bound| {
            let value = value_at(&system, hamiltonians, casimirs, bound, &problem.y0);
            (value / bound.minimum.value).powf(1.0 / bound.degree) * (-least).exp()
        });
        let integral_agrees = disagreeing <= JUMPS
            && difference.abs() <= total * f64::from(disagreeing.max(1)) / f64::from(PIECES);
        Self { damping: problem.damping.describe(), integral, integral_agrees, radius }
    }
}

/// F(y).
fn value_at(
    system: &dyn Probe,
    hamiltonians: &Hamiltonians,
    casimirs: &Casimirs,
    bound: &Bound,
    y: &[f64],
) -> f64 {
    let known = casimirs
        .definite
        .iter()
        .chain(&casimirs.found)
        .find(|casimir| casimir.formula == bound.function);
    match known {
        Some(casimir) => casimir.value(y),
        None => {
            assert!(hamiltonians.noise_size.is_some(), "the only other bound is the energy");
            system.energy(y, &pick(system, 0))
        }
    }
}
