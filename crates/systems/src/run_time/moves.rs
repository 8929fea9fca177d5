//! Compositions of flows of a system known at run time.

/// Parts of a system whose flows are known, see [`Flows`](crate::Flows).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parts {
    /// Number of parts.
    pub number: usize,
    /// For each noise m the part that has all of Hₘ, `None` where it is spread over several. Empty
    /// where the flow of a single noise is not known.
    pub of_noise: Vec<Option<usize>>,
    /// Whether paths take flows unless another scheme is named, since its steps are dear.
    pub preferred: bool,
    /// Parts in words, such as `kick by q^2/2`; empty where there are none.
    pub words: Vec<String>,
}

/// A move of a composition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Multiplies the state by the factor of this number.
    Scale(usize),
    /// Multiplies one component by the factor of this number.
    ScaleOne {
        /// Number of the component.
        component: usize,
        /// Number of the factor.
        factor: usize,
    },
    /// Follows the flow of a part.
    Flow {
        /// Number of the part.
        part: usize,
        /// Share of the weight of H₀.
        drift: f64,
        /// Share of the weights of the noises.
        noise: f64,
        /// Share of their space-time areas, which are added to these weights.
        area: f64,
        /// The only noise that moves, `None` for all.
        only: Option<usize>,
    },
}

/// The flows of all parts, φ₀(½) ⋯ φ_{P−1}(½) φ_P(1) φ_{P−1}(½) ⋯ φ₀(½), for shares of the
/// weights of H₀, of the noises, and of their space-time areas.
pub fn palindrome(
    parts: usize,
    [drift, noise, area]: [f64; 3],
    only: Option<usize>,
) -> impl Iterator<Item = Move> {
    let last = parts - 1;
    (0..=last).chain((0..last).rev()).map(move |part| {
        let share = if part < last { 0.5 } else { 1.0 };
        let [drift, noise, area] = [drift, noise, area].map(|of| share * of);
        Move::Flow { part, drift, noise, area, only }
    })
}
