//! Hamiltonians that are stiff or vary sharply, and discrete gradients of equal arguments.

use analysis::worse;
use anyhow::Result;
use dgrad::{GradientField, averaged_with_error};
use real::Real;
use systems::{
    Constant, HamiltonianIncrement, IntegerExponents, Invariant, LotkaVolterra, Pendulum, Poisson3,
    PoissonSystem, RealExponents, RigidBodyEnergy,
    paper::{INERTIA, half_cosine, rigid_body_start},
};
use verify::rounding::length;

use crate::{
    Case, Context, Rows, each,
    paths::{CASIMIR, Experiment, Law},
    row::Row,
    schemes::Family,
};

/// A Hamiltonian whose frequencies are far above 1/τ.
///
/// Rigid body with noise H₀, moments of inertia (2, 1, 2/3)/ω, γ = ½cos 2t, 256 steps of τ = 1/64.
///
/// |y|² and H₀ decay as e^(−2∫γ) for every ω, the order of the body's frequencies.
pub const STIFF: Case = Case {
    id: "stiff-hamiltonian",
    quantity: "largest relative distance of |y|² and H₀ from their laws",
    guarantee: "`sexp` is on both laws to rounding, or ends with a typed error; `sexp-li`, `split` \
                and `nv` are on that of |y|². The phase is not guaranteed. From ω = 1000 on `em` and `heun` must be off by more than one.",
    varied: "ω",
    rows: stiff,
};

/// From here on ωτ is above 6 and explicit schemes multiply the fast components by about as much in
/// every step.
const EXPLICIT_FAILS: f64 = 1e3;

/// H₀ is a quadratic form whose largest coefficient is three times its smallest, so that rounding
/// in it is at most three times that in ½|y|².
const LAWS: Law = Law { invariants: &[0, 1], weight: 3.0, counts_continuation: true, ..CASIMIR };

fn stiff(context: &Context) -> Rows {
    each([1.0, 10.0, 100.0, 1e3, 1e4], |omega| {
        let system = (RigidBodyEnergy::new(INERTIA.map(|i| i / omega), 1.0)?, half_cosine());
        let fails = |family| omega >= EXPLICIT_FAILS && family == Family::Explicit;
        let experiment = Experiment::new(context, system, rigid_body_start(), (256, 1.0 / 64.0))?;
        experiment.with_parts().law_rows(omega, &LAWS, |family| fails(family).then_some(1.0))
    })
}

/// A Hamiltonian that varies faster than the nodes of the quadrature resolve.
///
/// Rigid body with H = ½(y₁²/2 + y₂² + 3y₃²/2) + sin(κy₁)/κ as drift and as noise, γ = 0, 64 steps
/// of τ = 1/16; discrete gradient with eight Gauss–Legendre nodes.
///
/// |y|² and H are constant. Any discrete gradient keeps |y|², only an exact one H.
pub const SHARP: Case = Case {
    id: "sharp-hamiltonian",
    quantity: "largest distance of ½|y|² (relative) and of H (absolute) from the start",
    guarantee: "`sexp` and `sexp-li` keep |y|² to rounding, `sexp` also H to rounding and the error of eight nodes, \
                Σ|Δy₁|·min(2, (8!)⁴/(17·16!³)·(κΔy₁)¹⁶); or it ends with a typed error.",
    varied: "κ",
    rows: sharp,
};

/// The rigid body with a rippled energy, whose discrete gradient is the default of the trait.
struct Rippled {
    body: RigidBodyEnergy,
    kappa: f64,
}

impl PoissonSystem<3, 1> for Rippled {
    fn name(&self) -> &'static str {
        "rippled-body"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        self.body.structure(y, v)
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        let ripple = (y[0] * self.kappa).sin() / self.kappa;
        self.body.energy(y, dt, dw) + ripple * (dt + dw[0])
    }
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> [R; 3] {
        let [first, second, third] = self.body.gradient(y, dt, dw);
        [first + (y[0] * self.kappa).cos() * (dt + dw[0]), second, third]
    }
    fn cayley<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        self.body.cayley(y, v)
    }
    fn invariants(&self) -> Vec<Invariant> {
        self.body.invariants()
    }
    /// The Casimir is that of the body.
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        self.body.invariant(index, y)
    }
}

/// The largest error of eight nodes for the mean of cos(κy₁) over a step of length `d` in y₁: its
/// 16th derivative is at most (κd)¹⁶, and no mean is off by more than two. The constant of eight
/// Gauss–Legendre nodes on [0, 1] is (8!)⁴/(17·(16!)³).
fn quadrature_error(kappa: f64, d: f64) -> f64 {
    let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
    let constant = factorial(8).powi(4) / (17.0 * factorial(16).powi(3));
    (constant * (kappa * d).abs().powi(16)).min(2.0)
}

fn sharp(context: &Context) -> Rows {
    let kappas = [1.0, 10.0, 100.0, 1e3, 1e4];
    let experiment = |kappa| {
        let system = Rippled { body: RigidBodyEnergy::new(INERTIA, 1.0)?, kappa };
        let start = rigid_body_start();
        Experiment::new(context, (system, Constant::new(0.0)?), start, (64, 1.0 / 16.0))
    };
    let casimir = each(kappas, |kappa| {
        let setting = format!("Casimir, κ = {kappa}");
        experiment(kappa)?.law_rows(setting, &CASIMIR, |_| None)
    })?;
    let energy = each(kappas, |kappa| {
        let experiment = experiment(kappa)?;
        experiment.rows(format!("energy, κ = {kappa}"), |row, scheme, paths| {
            let states = &paths[0].states;
            let value = |y: &[f64; 3]| experiment.problem.system().energy(*y, 1.0, [0.0]);
            let distances = states.iter().map(|y| (value(y) - value(&states[0])).abs());
            let worst = distances.fold(0.0, f64::max);
            let steps = states.windows(2).map(|pair| pair[1][0] - pair[0][0]);
            let quadrature: f64 = steps.map(|d| quadrature_error(kappa, d) * d.abs()).sum();
            // H and |∇H| are at most about two, so that rounding in H is no more than four times
            // that in ½|y|². The argument κy₁ has a rounding of its own, ε κ/κ.
            let bound = quadrature + 4.0 * experiment.distance(paths, &CASIMIR, scheme).bound;
            let row = row.with_figure(worst);
            let conformal = scheme.family == Family::Conformal;
            Ok(if conformal { row.guaranteed(worst <= bound, bound) } else { row })
        })
    })?;
    Ok([casimir, energy].concat())
}

/// Discrete gradients at a = b and next to it.
///
/// ∇̄h(a, b) of the pendulum (sine), the three-dimensional Poisson system (cosine), and
/// Lotka–Volterra with integer and real exponents; bᵢ = aᵢ(1 ± distance), signs alternate.
///
/// ∇̄h(a, b) = ∫₀¹∇h((1−η)a + ηb)dη is smooth, with ∇̄h(a, a) = ∇h(a). (H(b) − H(a))/(b − a)
/// cancels as b → a.
pub const NEAR_EQUAL: Case = Case {
    id: "near-equal",
    quantity: "largest error of a component relative to |∇h|, against 49 Gauss–Legendre nodes",
    guarantee: "32ε at every distance.",
    varied: "distance",
    rows: near_equal,
};

/// Rounding of ∇̄: each of at most 49 terms of either sum is rounded a few times, but the errors of
/// a sum of positive weights that add up to one do not exceed those of its largest terms: 8ε for
/// the terms and 24·½ε twice for the sums. At a distance of a tenth the 12 nodes of real powers
/// leave (0.1)²⁴ of a function whose derivatives grow like n!.
const BOUND: f64 = 32.0 * f64::EPSILON;

fn near_equal(_: &Context) -> Rows {
    let integer = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)?;
    let real = LotkaVolterra::<RealExponents>::new(-1.0, -1.5, 1.0)?;
    each([0.0, f64::EPSILON, 1e-12, 1e-8, 1e-4, 1e-2, 1e-1], |distance| {
        let ulp = distance == f64::EPSILON;
        let setting = if ulp { "one ulp".into() } else { distance.to_string() };
        let row = |name, error| Row::new(&setting, name, None).with_figure(error).at_most(BOUND);
        Ok(vec![
            row("sine", error(&Pendulum::new(1.0)?, [0.3, 1.2], distance)?),
            row("cosine", error(&Poisson3::new(1.0)?, [1.0, 2.0, 3.0], distance)?),
            row("polynomial", error(&integer, [0.2, 0.4, 0.6], distance)?),
            row("real powers", error(&real, [0.2, 0.4, 0.6], distance)?),
        ])
    })
}

/// The largest error of a component of ∇̄h(a, b), relative to |∇h|, against a rule with 2·24 + 1
/// nodes; NaN if a component is.
fn error<S: PoissonSystem<D, 1>, const D: usize>(
    system: &S,
    a: [f64; D],
    distance: f64,
) -> Result<f64> {
    let mut b = a;
    for i in 0..D {
        b[i] += a[i] * distance * if i % 2 == 0 { 1.0 } else { -1.0 };
    }
    let field = HamiltonianIncrement { system, dt: 0.75, dw: [0.5] };
    let (exact, _) = averaged_with_error(&field, a, b, 24)?;
    let mean = system.averaged_gradient(a, b, 0.75, [0.5]);
    let size = length(field.gradient(a));
    Ok((0..D).map(|i| (mean[i] - exact[i]).abs() / size).fold(0.0, worse))
}
