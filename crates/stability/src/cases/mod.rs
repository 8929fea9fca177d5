//! The hard cases, one family a file.

mod anti_damping;
mod big_steps;
mod equilibria;
mod extreme_normals;
mod large_noise;
mod lotka_volterra;
mod near_equal;
mod no_noise;
mod rough_damping;
mod scales;
mod sharp_hamiltonian;
mod stiff_damping;
mod stiff_hamiltonian;

use noise::StreamKey;
use real::elementary::{cos, sin};
use systems::{Cosine, PoissonSystem, RigidBody, SystemError};

use crate::Effort;
use crate::method::Method;
use crate::path::Stop;
use crate::results::{Case, Row, Verdict};

/// One family by its name.
pub(crate) struct Entry {
    pub(crate) id: &'static str,
    pub(crate) run: fn(&Context) -> Case,
}

/// All families.
pub(crate) const CASES: [Entry; 13] = [
    Entry { id: "stiff-damping", run: stiff_damping::case },
    Entry { id: "anti-damping", run: anti_damping::case },
    Entry { id: "rough-damping", run: rough_damping::case },
    Entry { id: "large-noise", run: large_noise::case },
    Entry { id: "extreme-normals", run: extreme_normals::case },
    Entry { id: "big-steps", run: big_steps::case },
    Entry { id: "scales", run: scales::case },
    Entry { id: "equilibria", run: equilibria::case },
    Entry { id: "near-equal", run: near_equal::case },
    Entry { id: "sharp-hamiltonian", run: sharp_hamiltonian::case },
    Entry { id: "stiff-hamiltonian", run: stiff_hamiltonian::case },
    Entry { id: "lotka-volterra", run: lotka_volterra::case },
    Entry { id: "no-noise", run: no_noise::case },
];

/// Experiments of this crate count from here; those of `precision` are below.
const FIRST_EXPERIMENT: u64 = 1 << 33;

/// What a case is told.
pub(crate) struct Context {
    pub(crate) id: &'static str,
    /// Number of the case, so that no two share noise.
    pub(crate) number: u64,
    pub(crate) seed: u64,
    pub(crate) effort: Effort,
}

impl Context {
    pub(crate) fn key(&self) -> StreamKey {
        StreamKey { seed: self.seed, experiment: FIRST_EXPERIMENT + self.number }
    }

    /// `full`, or `quick` where seconds count.
    pub(crate) fn many(&self, full: u64, quick: u64) -> u64 {
        match self.effort {
            Effort::Full => full,
            Effort::Quick => quick,
        }
    }
}

/// What a case says beside its rows.
pub(crate) struct Words {
    pub(crate) title: &'static str,
    pub(crate) setup: &'static str,
    pub(crate) mathematics: &'static str,
    pub(crate) quantity: &'static str,
    pub(crate) guarantee: &'static str,
    pub(crate) varied: &'static str,
}

impl Words {
    pub(crate) fn with(self, context: &Context, rows: Vec<Row>) -> Case {
        Case {
            id: context.id.to_owned(),
            title: self.title.to_owned(),
            setup: self.setup.to_owned(),
            mathematics: self.mathematics.to_owned(),
            quantity: self.quantity.to_owned(),
            guarantee: self.guarantee.to_owned(),
            varied: self.varied.to_owned(),
            rows,
        }
    }
}

/// What is claimed of a scheme in a setting.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Claim {
    /// The figure is at most this, until the end.
    AtMost(f64),
    /// The figure is at most this as long as the path lasts; it may end in a typed error.
    AtMostOrStops(f64),
    /// The figure exceeds this, or the path ends in a typed error.
    Exceeds(f64),
    /// Nothing.
    Nothing,
}

/// A figure and how its path ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    pub(crate) figure: f64,
    pub(crate) stop: Option<Stop>,
}

impl Claim {
    fn verdict(self, measured: Measured) -> Verdict {
        let Measured { figure, stop } = measured;
        match self {
            // A NaN is not at most anything.
            Self::AtMost(bound) if stop.is_none() && figure <= bound => Verdict::Holds,
            Self::AtMostOrStops(bound) if figure <= bound => Verdict::Holds,
            Self::Exceeds(bound) if stop.is_some() || figure > bound => Verdict::FailsAsItMust,
            Self::Nothing if figure.is_finite() || stop.is_some() => Verdict::Observed,
            _ => Verdict::Refuted,
        }
    }

    /// The row of a scheme in a setting.
    pub(crate) fn row(
        self,
        setting: &str,
        x: Option<f64>,
        scheme: &str,
        measured: Measured,
    ) -> Row {
        let bound = match self {
            Self::AtMost(bound) | Self::AtMostOrStops(bound) | Self::Exceeds(bound) => Some(bound),
            Self::Nothing => None,
        };
        Row {
            setting: setting.to_owned(),
            x,
            scheme: scheme.to_owned(),
            measured: measured.figure.is_finite().then_some(measured.figure),
            exact: None,
            bound: bound.filter(|bound| bound.is_finite()),
            error: measured.stop.map(|stop| stop.to_string()),
            verdict: self.verdict(measured),
        }
    }
}

/// The parameters of the cases are valid, so a constructor that refuses one is a bug here.
pub(crate) fn valid<T>(constructed: Result<T, SystemError>) -> T {
    constructed.unwrap_or_else(|error| unreachable!("the set-ups are valid: {error}"))
}

pub(crate) const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];
pub(crate) const NOISE_INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

/// The rigid body of the paper with three noises.
pub(crate) fn body() -> RigidBody<3> {
    valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA))
}

/// Its start, on the unit sphere.
pub(crate) fn body_start() -> [f64; 3] {
    [cos(1.1), 0.0, sin(1.1)]
}

/// γ = ½ cos 2t.
pub(crate) fn half_cosine() -> Cosine {
    valid(Cosine::new(0.5, 2.0))
}

/// |F(y)e^{p·damping}/F(y₀) − 1| of invariant number `index`.
pub(crate) fn defect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    index: usize,
    degree: f64,
    (y0, y): ([f64; D], [f64; D]),
    damping: f64,
) -> f64 {
    let law = system.invariant(index, y0) * (-degree * damping).exp();
    (system.invariant(index, y) / law - 1.0).abs()
}

/// √Σ yᵢ², without overflow or underflow of the squares.
pub(crate) fn length<const D: usize>(y: [f64; D]) -> f64 {
    let largest = y.iter().fold(0.0f64, |largest, component| largest.max(component.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * y.iter().map(|component| (component / largest).powi(2)).sum::<f64>().sqrt()
}

/// Every scheme in every setting.
pub(crate) fn grid<T>(
    settings: &[T],
    noises: usize,
    mut row: impl FnMut(&T, Method) -> Row,
) -> Vec<Row> {
    let mut rows = Vec::new();
    for setting in settings {
        rows.extend(Method::all(noises).into_iter().map(|method| row(setting, method)));
    }
    rows
}

/// What the residual that a robust solve reports may add to the relative distance from the law of a
/// quadratic Casimir: F(z) − F(ẑ) = (z + ẑ)·(z − ψ(z))/2, at most |z| times the residual, and F =
/// ½|z|².
pub(crate) fn residual_share<const D: usize>(outcome: nonlin::Outcome, y: [f64; D]) -> f64 {
    match outcome {
        nonlin::Outcome::Robust { residual, .. } => 2.0 * residual / length(y),
        _ => 0.0,
    }
}
