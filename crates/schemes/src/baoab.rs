//! Friction and noise as one exact step between halves of the flows of H₀.

use std::sync::Arc;

use systems::Damping;

/// A rate of friction, and the components that it damps.
pub type Friction = (Arc<dyn Damping>, Vec<usize>);

/// Splitting for Langevin dynamics, `baoab` (Leimkuhler and Matthews, *Appl. Math. Res. Express*
/// 2013), for systems known at run time.
///
/// For a system with the parts 0 … P,
///
/// y_{n+1} = φ_P(½) ⋯ φ₀(½) O φ₀(½) ⋯ φ_P(½) y_n,
///
/// where φ_k(c) is the flow of part k of H₀ for cτ, and O the exact Ornstein–Uhlenbeck step: the
/// damping and friction of τ, and then the flows of the noises for ΔW√((1 − e^{−2Γ})/2Γ) with the
/// integral Γ of all damping over the step. So a momentum with friction and constant noise has the
/// law of the exact solution. Noises that depend on the state, or move components of different
/// friction, are taken as they are, in the middle of the damping. With H₀ = p²/2m + V(q) the
/// part P is V, and the step a kick, a drift, O, a drift, a kick.
///
/// - Orders: weak 2; strong 1; order 2 without noise. Noises must commute.
/// - ⟨q²⟩ of a harmonic oscillator is exact at every stable τ.
/// - Preserves the conformal law of every homogeneous Casimir that its flows preserve.
/// - Cost per step: 2P + 3 flows. Explicit.
#[derive(Clone, Default)]
pub struct Baoab {
    /// Rates of friction, and the components that each damps.
    pub(crate) friction: Vec<Friction>,
}

impl Baoab {
    /// The scheme for friction on components besides the damping of all of them.
    pub fn new(friction: impl IntoIterator<Item = Friction>) -> Self {
        Self { friction: friction.into_iter().collect() }
    }
}
