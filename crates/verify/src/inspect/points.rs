//! The points at which a system is inspected.

use noise::{StreamKey, WienerPath};
use serde::Serialize;

use super::{algebra::norm, erased::System, error::InspectError};

/// The region of the points of an inspection.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Region {
    /// |yᵢ| ≤ this.
    Box(f64),
    /// ‖y‖ ≤ this.
    Ball(f64),
}

/// Points of a region in the domain of the system.
pub struct Points {
    pub region: Region,
    /// The first points, where identities are checked.
    pub for_identities: Vec<Vec<f64>>,
    /// All points, over which suprema are taken.
    pub for_suprema: Vec<Vec<f64>>,
    /// Whether every point that was tried is in the domain.
    pub everywhere: bool,
}

/// Number of points for suprema.
const SUPREMA: usize = 400;
/// Least number of points for identities. An analytic identity that holds at one random point holds
/// everywhere with probability one; the other points are for formulas with cases.
const IDENTITIES: usize = 24;
/// Points tried for each one wanted: enough for the positive cone in five dimensions.
const TRIES: usize = 64;

/// Random numbers, the same in every run.
pub struct Random {
    normals: WienerPath<1>,
    drawn: u64,
}

const KEY: StreamKey = StreamKey { seed: 0x1257_ec71, experiment: 0 };

impl Random {
    pub fn new() -> Self {
        Self { normals: WienerPath::new(KEY, 0), drawn: 0 }
    }

    /// Uniform in [−1, 1), from the seeds of paths, which are mixed words.
    pub fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        (KEY.path_seed(self.drawn) >> 11) as f64 * f64::EPSILON - 1.0
    }
}

impl Points {
    /// Random points of the region that are in the domain. Where the domain is a small part of the
    /// region, points with positive components follow, and then points near `start`.
    pub fn new(
        system: &dyn System,
        region: Region,
        start: Option<&[f64]>,
    ) -> Result<Self, InspectError> {
        let d = system.dimension();
        let identities = IDENTITIES.max(2 * d);
        let wanted = SUPREMA.max(identities);
        let mut random = Random::new();
        let (mut points, mut everywhere) = (Vec::new(), true);
        for attempt in 0..(TRIES + 2) * wanted {
            if points.len() == wanted {
                break;
            }
            let y: Vec<f64> = match (attempt / wanted, start) {
                (0..TRIES, _) => region.point(d, &mut random),
                (TRIES, _) | (_, None) => {
                    region.point(d, &mut random).into_iter().map(f64::abs).collect()
                }
                (_, Some(start)) => start
                    .iter()
                    .map(|x| x + 0.3 * random.uniform() * (x.abs() + 0.1 * norm(start)))
                    .collect(),
            };
            if system.in_domain(&y) {
                points.push(y);
            } else if attempt < TRIES * wanted {
                everywhere = false;
            }
        }
        if points.len() < identities {
            return Err(InspectError::NoPoints { found: points.len(), wanted: identities });
        }
        let for_identities = points[..identities].to_vec();
        Ok(Self { region, for_identities, for_suprema: points, everywhere })
    }
}

impl Region {
    fn point(&self, d: usize, random: &mut Random) -> Vec<f64> {
        match *self {
            Self::Box(half_side) => (0..d).map(|_| half_side * random.uniform()).collect(),
            Self::Ball(radius) => {
                let direction: Vec<f64> = (0..d).map(|_| random.normals.normal()).collect();
                // Uniform in the ball; one point in four on the sphere, where suprema tend to be.
                let share = random.uniform().abs();
                let length =
                    if share < 0.25 { 1.0 } else { ((share - 0.25) / 0.75).powf(1.0 / d as f64) };
                let scale = radius * length / norm(&direction);
                direction.into_iter().map(|x| x * scale).collect()
            }
        }
    }
}
