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
        if d == 0 {
            return Err(InspectError::NoComponents);
        }
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

#[cfg(test)]
mod tests {
    use super::{
        super::tests::by_hand::{ByHand, at},
        *,
    };

    #[test]
    fn points_are_found_in_a_cone_and_near_a_start() {
        // The positive cone in twelve dimensions has a share of 1/4096.
        let cone =
            ByHand { dimension: 12, inside: |y| y.iter().all(|x| *x > 0.0), ..ByHand::default() };
        let points = Points::new(&cone, Region::Ball(2.0), None).unwrap();
        assert_eq!((points.for_suprema.len(), points.random, points.everywhere), (400, 24, false));
        assert!(points.for_suprema.iter().all(|y| norm(y) <= 2.0 + 1e-12));
        let wide = ByHand { dimension: 13, ..ByHand::default() };
        assert_eq!(Points::new(&wide, Region::Box(1.0), None).unwrap().random, 26);
        // A spot about the start: within a third of |xᵢ| + |x|/10, and down to 2⁻¹⁵ of that.
        let spot = ByHand {
            inside: |y| (y[0] + 100.0).abs() < 0.01 && y[1].abs() < 0.01,
            ..ByHand::default()
        };
        let points = Points::new(&spot, Region::Ball(200.0), Some(&[-100.0, 0.0])).unwrap();
        assert!(points.for_suprema.len() >= 24 && points.for_suprema.len() < 400);
        let nowhere = ByHand { inside: |_| false, ..ByHand::default() };
        let none = Points::new(&nowhere, Region::Ball(200.0), Some(&[-100.0, 0.0])).err();
        assert_eq!(none, Some(InspectError::NoPoints { found: 0, wanted: 24 }));
    }

    #[test]
    fn states_of_paths_are_those_at_the_start_and_at_the_end() {
        let system = ByHand::default();
        let around = |y0: [f64; 2], states: Vec<Vec<f64>>| {
            let pilot = Pilot { paths: 1, states: states.len(), until: 1.0 };
            at(&[&[1.0, 0.0], &[0.0, 4.0]]).with_paths(&system, &y0, (pilot, states))
        };
        let points = around([300.0, -400.0], vec![vec![6.0, 8.0], vec![1.0, 1.0]]);
        let on_path: Vec<usize> =
            (0..points.for_identities.len()).filter(|&n| points.on_path(n)).collect();
        assert_eq!((points.for_identities.len(), on_path), (9, vec![2, 7, 8]));
        assert!(!at(&[&[1.0]]).on_path(0));
        assert!((400.0..1300.0).contains(&points.extent()), "{}", points.extent());
        assert_eq!(at(&[&[3.0, -4.0], &[0.0, 4.0]]).extent(), 5.0);
        // Around it at 1, 0.1, 0.01 and 0.001 of its norm 500, or of one for zero.
        for (y0, size) in [([300.0, -400.0], 500.0), ([0.0; 2], 1.0)] {
            let points = around(y0, Vec::new());
            for (n, y) in points.for_identities[3..].iter().enumerate() {
                let away = (y[0] - y0[0]).hypot(y[1] - y0[1]) * 10f64.powi(n as i32) / size;
                assert!((0.05..2f64.sqrt()).contains(&away), "{n}: {away}");
            }
        }
        // Halved until it is in the domain, 40 times at most.
        let narrow = ByHand { inside: |y| y[0].hypot(y[1]) < 1e-5, ..ByHand::default() };
        let pilot = Pilot { paths: 1, states: 0, until: 1.0 };
        let points = at(&[&[1.0, 0.0]]).with_paths(&narrow, &[0.0; 2], (pilot, Vec::new()));
        assert_eq!(points.for_identities.len(), 1 + 1 + 4);
        let lengths = points.for_identities[2..].iter().map(|y| norm(y));
        assert!(lengths.into_iter().all(|length| (5e-6..1e-5).contains(&length)));
        let never = ByHand { inside: |y| y[0] == 0.0, ..ByHand::default() };
        let points = at(&[&[1.0, 0.0]]).with_paths(&never, &[0.0; 2], (pilot, Vec::new()));
        assert_eq!(points.for_identities.len(), 1 + 1);
    }
}
