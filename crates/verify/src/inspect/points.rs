//! Where a system is looked at.

use noise::{StreamKey, WienerPath};
use serde::Serialize;

use super::InspectError;
use super::algebra::norm;
use super::probe::Probe;

/// The region that points are taken from.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Region {
    /// |yᵢ| ≤ this.
    Box(f64),
    /// ‖y‖ ≤ this.
    Ball(f64),
}

/// Points of a region where the system is defined.
pub(super) struct Points {
    pub(super) region: Region,
    /// For identities.
    pub(super) few: Vec<Vec<f64>>,
    /// For suprema; the few are among them.
    pub(super) many: Vec<Vec<f64>>,
    /// Whether every point that was tried is in the domain.
    pub(super) everywhere: bool,
}

/// Suprema are sampled at this many points.
const MANY: usize = 400;
/// Identities are looked at here at so many points: analytic identities that hold at one random
/// point hold everywhere with probability one, the rest is for formulas with cases.
const FEW: usize = 24;
/// Points tried for each one wanted: enough for the positive cone in five dimensions.
const TRIES: usize = 64;

/// The numbers are the same in every run.
const KEY: StreamKey = StreamKey { seed: 0x1257_ec71, experiment: 0 };

/// Random numbers.
pub(super) struct Numbers {
    normals: WienerPath<1>,
    drawn: u64,
}

impl Numbers {
    pub(super) fn new() -> Self {
        Self { normals: WienerPath::new(KEY, 0), drawn: 0 }
    }

    /// Uniform in [−1, 1): the seeds of paths are mixed words.
    pub(super) fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        (KEY.path_seed(self.drawn) >> 11) as f64 * f64::EPSILON - 1.0
    }
}

impl Points {
    /// Points of the region in the domain; where the domain is a small part of it, points with
    /// positive components or near `start` are taken as well.
    pub(super) fn new(
        system: &dyn Probe,
        region: Region,
        start: Option<&[f64]>,
    ) -> Result<Self, InspectError> {
        let d = system.dimension();
        let few = FEW.max(2 * d);
        let wanted = MANY.max(few);
        let mut numbers = Numbers::new();
        let (mut many, mut tried, mut everywhere) = (Vec::new(), 0, true);
        while many.len() < wanted && tried < TRIES * wanted {
            tried += 1;
            let y = region.point(d, &mut numbers);
            if system.in_domain(&y) {
                many.push(y);
            } else {
                everywhere = false;
            }
        }
        // A positive cone in many dimensions, then the neighbourhood of a point that is known to be
        // in the domain.
        let positive = |y: Vec<f64>| y.into_iter().map(f64::abs).collect::<Vec<f64>>();
        for near_start in [false, true] {
            for _ in 0..wanted {
                if many.len() >= wanted {
                    break;
                }
                let y = match start {
                    Some(start) if near_start => start
                        .iter()
                        .map(|x| x + 0.3 * numbers.uniform() * (x.abs() + 0.1 * norm(start)))
                        .collect(),
                    _ => positive(region.point(d, &mut numbers)),
                };
                if system.in_domain(&y) {
                    many.push(y);
                }
            }
        }
        if many.len() < few {
            return Err(InspectError::NoPoints { found: many.len(), wanted: few });
        }
        Ok(Self { region, few: many[..few].to_vec(), many, everywhere })
    }
}

impl Region {
    fn point(&self, d: usize, numbers: &mut Numbers) -> Vec<f64> {
        match *self {
            Self::Box(half_side) => (0..d).map(|_| half_side * numbers.uniform()).collect(),
            Self::Ball(radius) => {
                let direction: Vec<f64> = (0..d).map(|_| numbers.normals.normal()).collect();
                // Uniform in the ball; one point in four on its boundary, where suprema tend to be.
                let share = numbers.uniform().abs();
                let length =
                    if share < 0.25 { 1.0 } else { ((share - 0.25) / 0.75).powf(1.0 / d as f64) };
                let scale = radius * length / norm(&direction);
                direction.into_iter().map(|x| x * scale).collect()
            }
        }
    }
}
