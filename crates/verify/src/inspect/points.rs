//! The points at which a system is inspected.

use noise::{StreamKey, WienerPath};
use serde::Serialize;

use super::{algebra::norm, erased::System, error::InspectError, pilot::Pilot};

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
    /// The first points, and what was added to them: where identities are checked.
    pub for_identities: Vec<Vec<f64>>,
    /// The number of random points among them, with which those for suprema begin.
    pub random: usize,
    /// Points of the region, over which suprema are taken.
    pub for_suprema: Vec<Vec<f64>>,
    /// Whether every point that was tried is in the domain.
    pub everywhere: bool,
    /// States of pilot paths among the points.
    pub pilot: Option<Pilot>,
}

/// Number of points for suprema.
const SUPREMA: usize = 400;
/// Least number of points for identities, in as many directions. An identity between polynomials
/// that holds at one random point holds everywhere with probability one; the other points are for
/// other formulas.
const IDENTITIES: usize = 24;
/// Points tried for each one wanted: enough for the positive cone in five dimensions.
const TRIES: usize = 64;
/// Halvings of the distance of points near the initial value, where the domain is a small part of
/// the region.
const NEARER: usize = 16;
/// Distances from the initial value, relative to its norm, of the points around it, and halvings
/// of them until a point is in the domain.
const AROUND: [f64; 4] = [1.0, 0.1, 0.01, 1e-3];
const HALVINGS: i32 = 40;

/// Random numbers, the same in every run.
pub struct Random {
    pub normals: WienerPath<1>,
    key: StreamKey,
    drawn: u64,
}

/// What random numbers are for.
#[derive(Clone, Copy)]
pub enum Purpose {
    Points,
    Around,
    Paths,
    Vectors,
    Weights,
    Areas,
}

const KEY: StreamKey = StreamKey { seed: 0x1257_ec71, experiment: 0 };

impl Random {
    /// Numbers that are independent of those for other purposes: a vector that is parallel to the
    /// point would hide much.
    pub fn new(purpose: Purpose) -> Self {
        let key = StreamKey { experiment: purpose as u64, ..KEY };
        Self { normals: WienerPath::new(key, 0), key, drawn: 0 }
    }

    /// Uniform in [−1, 1), from the seeds of paths, which are mixed words.
    pub fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        (self.key.path_seed(self.drawn) >> 11) as f64 * f64::EPSILON - 1.0
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
        let mut random = Random::new(Purpose::Points);
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
                (_, Some(start)) => {
                    // A domain may be narrow.
                    let share = 0.3 * f64::powi(0.5, (attempt % NEARER) as i32);
                    let size = |x: f64| x.abs() + 0.1 * norm(start);
                    start.iter().map(|&x| x + share * random.uniform() * size(x)).collect()
                }
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
        let random = identities;
        Ok(Self { region, for_identities, random, for_suprema: points, everywhere, pilot: None })
    }

    /// The largest ‖y‖ of the points for identities.
    pub fn extent(&self) -> f64 {
        self.for_identities.iter().map(|y| norm(y)).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Whether point n for identities is the initial value or a state of a pilot path.
    pub fn on_path(&self, n: usize) -> bool {
        let states = |pilot: &Pilot| self.for_identities.len() - pilot.states;
        self.pilot.is_some_and(|pilot| n == self.random || n >= states(&pilot))
    }

    /// Adds the initial value, points around it, and the states of pilot paths.
    pub fn with_paths(
        mut self,
        system: &dyn System,
        y0: &[f64],
        (pilot, states): (Pilot, Vec<Vec<f64>>),
    ) -> Self {
        let mut random = Random::new(Purpose::Around);
        let size = if norm(y0) > 0.0 { norm(y0) } else { 1.0 };
        let mut around = vec![y0.to_vec()];
        for distance in AROUND {
            let direction: Vec<f64> = y0.iter().map(|_| random.uniform()).collect();
            around.extend((0..HALVINGS).find_map(|halvings| {
                let length = size * distance * f64::powi(0.5, halvings);
                let y: Vec<f64> = y0.iter().zip(&direction).map(|(y, d)| y + length * d).collect();
                system.in_domain(&y).then_some(y)
            }));
        }
        self.for_identities.extend(around.into_iter().chain(states));
        self.pilot = Some(pilot);
        self
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
