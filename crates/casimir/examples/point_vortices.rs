//! Two point vortices in a fluctuating strain: two noises that do not commute, with and without
//! Lévy areas.
//!
//! ```text
//! cargo run -p casimir-poisson --example point_vortices
//! ```

use std::f64::consts::TAU;

use casimir::dgrad::averaged;
use casimir::mc::{Recording, Setup, Simulation, StateFunction};
use casimir::prelude::*;
use casimir::schemes::SexpLevy;
use casimir::systems::{HamiltonianIncrement, SystemError};

/// y = (x₁, y₁, x₂, y₂), Γᵢẋᵢ = ∂H/∂yᵢ, Γᵢẏᵢ = −∂H/∂xᵢ.
struct Vortices {
    circulations: [f64; 2],
    strain: f64,
}

impl PoissonSystem<4, 2> for Vortices {
    fn name(&self) -> &'static str {
        "point-vortices"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 4], v: [R; 4]) -> [R; 4] {
        let [one, other] = self.circulations;
        [v[1] / one, -(v[0] / one), v[3] / other, -(v[2] / other)]
    }

    /// H₀ = −Γ₁Γ₂ ln r²/4π; H₁ = ½σ Σ Γᵢ(xᵢ² − yᵢ²) and H₂ = σ Σ Γᵢxᵢyᵢ strain the plane along two
    /// pairs of axes.
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 4], dt: f64, dw: [f64; 2]) -> R {
        let [one, other] = self.circulations;
        let (dx, dy) = (y[0] - y[2], y[1] - y[3]);
        let along =
            (y[0] * y[0] - y[1] * y[1]) * (0.5 * one) + (y[2] * y[2] - y[3] * y[3]) * (0.5 * other);
        let across = y[0] * y[1] * one + y[2] * y[3] * other;
        (dx * dx + dy * dy).ln() * (-one * other / (2.0 * TAU) * dt)
            + along * (self.strain * dw[0])
            + across * (self.strain * dw[1])
    }

    /// By hand, since eight nodes of a dual logarithm are slow to compile; `inspect` compares it
    /// with the energy.
    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; 4], dt: f64, dw: [f64; 2]) -> [R; 4] {
        let [one, other] = self.circulations;
        let (dx, dy) = (y[0] - y[2], y[1] - y[3]);
        let pull = (dx * dx + dy * dy).recip() * (-one * other / TAU * dt);
        let (s, t) = (self.strain * dw[0], self.strain * dw[1]);
        [
            dx * pull + (y[0] * s + y[1] * t) * one,
            dy * pull + (y[0] * t - y[1] * s) * one,
            (y[2] * s + y[3] * t) * other - dx * pull,
            (y[2] * t - y[3] * s) * other - dy * pull,
        ]
    }

    /// Four nodes: good to round-off for the distance that a vortex goes in a step, and inexact
    /// across the region.
    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; 4], b: [R; 4], dt: f64, dw: [f64; 2]) -> [R; 4] {
        averaged::<4, _, _, 4>(&HamiltonianIncrement { system: self, dt, dw }, a, b)
    }

    /// Two strains make a rotation: [f₁, f₂] = 2σ²(−y, x) for each vortex; compared, too.
    #[inline(always)]
    fn commutators<R: Real>(&self, y: [R; 4], areas: [[f64; 2]; 2]) -> [R; 4] {
        let turn = 2.0 * self.strain * self.strain * areas[0][1];
        [-(y[1] * turn), y[0] * turn, -(y[3] * turn), y[2] * turn]
    }

    fn check_domain(&self, y: [f64; 4]) -> Result<(), SystemError> {
        let apart = y[0] != y[2] || y[1] != y[3];
        let refused = SystemError::OutsideDomain {
            component: 1,
            value: y[0],
            domain: "two vortices that are apart",
        };
        if apart { Ok(()) } else { Err(refused) }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pair = Vortices { circulations: [1.0, 0.7], strain: 0.15 };
    let problem = Problem::new(pair, Constant::new(0.05)?, [0.5, 0.0, -0.5, 0.1], 4.0)?;
    println!("{}\n", inspect_problem(&problem)?);

    // One path with its areas, at two step sizes: the same noise, joined.
    let fine = Recording::<2>::draw(StreamKey { seed: 3, experiment: 0 }, 0, 4096, 4.0, true)?;
    let (sexp, levy) = (Sexp, SexpLevy::new(problem.system(), problem.y0()));
    let distance = |y: [f64; 4]| (y[0] - y[2]).hypot(y[1] - y[3]);
    let follow = |scheme: &dyn Scheme<Vortices, 4, 2>, recording: &Recording<2>| {
        Simulation::new(Setup::of(&problem, scheme), Truncation::new(4)?)
            .every(recording.increments().len() as u64 / 4)
            .observing(StateFunction::new("distance", distance))
            .recorded(recording)
            .map_err(Box::<dyn std::error::Error>::from)
    };
    let reference = follow(&levy, &fine)?;
    println!(
        "distance of the vortices at t = {:?}\n  4096 steps: {:.6?}",
        reference.times(),
        reference.column("distance")
    );
    for steps in [64, 256, 1024] {
        let coarse = fine.coarsened(4096 / steps)?;
        for scheme in [&sexp as &dyn Scheme<Vortices, 4, 2>, &levy] {
            let path = follow(scheme, &coarse)?;
            let last = |series: &casimir::mc::TimeSeries| {
                series.column("distance").and_then(|column| column.last().copied())
            };
            let error = last(&path).zip(last(&reference)).map(|(a, b)| (a - b).abs());
            println!(
                "  {steps:4} steps, {:9}: error {:.1e}",
                scheme.id(),
                error.unwrap_or(f64::NAN)
            );
        }
    }
    Ok(())
}
