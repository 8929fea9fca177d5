//! A system whose steps have no solution once the noise is large.

use real::Real;
use systems::PoissonSystem;

/// In two dimensions with H = y₁(y₂² + 1)·(t + W): y₂ = tan(… + t + W) has no value once the noise
/// is large.
pub struct Explosive;

impl PoissonSystem<2, 1> for Explosive {
    fn name(&self) -> &'static str {
        "explosive"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        y[0] * (y[1] * y[1] + 1.0) * (dt + dw[0])
    }
}
