//! What all checks look at: points, a system at clusters of them, and identities of derivatives.

use real::elementary::powf;
use serde::Serialize;

use crate::facts::{
    APART, Batch, CLUSTER, Finding, HALVINGS, Matrix, Probe, Purpose, Random, Status, Term, Values,
    differences, moved, norm, product, scaled, slopes,
};

/// The region of the points of an inspection.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Region {
    /// Box |yᵢ| ≤ r.
    Box(f64),
    /// Ball ‖y‖ ≤ r.
    Ball(f64),
    /// Neighbourhood of the initial value, within a tenth of its components.
    Near,
}

/// Points of a region in the domain of the system.
pub struct Points {
    pub region: Region,
    /// Points where identities are checked: the first points, and those added to them.
    pub for_identities: Batch,
    /// Number of random points in `for_identities`; the initial value comes next.
    pub random: usize,
    /// Points of the region, over which suprema are taken.
    pub for_suprema: Batch,
    /// Whether every point that was tried is in the domain.
    pub everywhere: bool,
}

/// Number of points for suprema, and least number of points and directions for identities. An
/// identity between polynomials that holds at one random point holds everywhere with probability
/// one; the other points are for other formulas.
const POINTS: [usize; 2] = [400, 24];
/// Numbers of points, as [`POINTS`], for a system of very many components near its initial value.
const NEAR: [usize; 2] = [96, 6];
/// Number of trials for each point wanted: enough for the positive cone in five dimensions.
const TRIES: usize = 64;
/// Halvings of the distance of points near the initial value, where the domain is a small part of
/// the region.
const NEARER: usize = 16;
/// Distances from the initial value, relative to its norm, of the points around it.
const AROUND: [f64; 4] = [1.0, 0.1, 0.01, 1e-3];

impl Points {
    /// Random points of the region that are in the domain. Where the domain is a small part of the
    /// region, points with positive components follow, and then points near the initial value.
    pub fn new(
        probe: &Probe<'_>,
        region: Region,
        y0: Option<&[f64]>,
    ) -> Result<Self, InspectError> {
        let d = probe.dimension();
        let [wanted, identities] = match region {
            Region::Near => NEAR,
            _ => [POINTS[0].max(2 * d), POINTS[1].max(2 * d)],
        };
        let (mut random, start) = (Random::new(Purpose::Points), y0.unwrap_or_default());
        let near = |share: f64, least: f64, random: &mut Random| -> Vec<f64> {
            start.iter().map(|x| x + share * random.uniform() * (x.abs() + least)).collect()
        };
        let (mut points, mut everywhere) = (Vec::new(), true);
        for attempt in 0..(TRIES + 2) * wanted {
            if points.len() == wanted {
                break;
            }
            let y = match region {
                Region::Near => near(0.1, 0.1, &mut random),
                _ if attempt / wanted > TRIES && y0.is_some() => {
                    // A domain may be narrow.
                    let share = 0.3 * f64::powi(0.5, (attempt % NEARER) as i32);
                    near(share, 0.1 * norm(start), &mut random)
                }
                _ => {
                    let mut y = region.point(d, &mut random);
                    if attempt / wanted >= TRIES {
                        y.iter_mut().for_each(|y| *y = y.abs());
                    }
                    y
                }
            };
            if probe.in_domain(&y) {
                points.push(y);
            } else {
                everywhere &= attempt >= TRIES * wanted;
            }
        }
        if points.len() < identities {
            return Err(InspectError::NoPoints { found: points.len(), wanted: identities });
        }
        let for_identities = points[..identities].to_vec();
        Ok(Self { region, for_identities, random: identities, for_suprema: points, everywhere })
    }

    /// Adds the initial value, and points around it.
    pub fn add_start(&mut self, probe: &Probe<'_>, y0: &[f64]) {
        let mut random = Random::new(Purpose::Around);
        let size = if norm(y0) > 0.0 { norm(y0) } else { 1.0 };
        self.for_identities.push(y0.to_vec());
        for distance in AROUND {
            let inside = probe.halved_into_domain(y0, size * distance, &random.vector(y0.len()));
            self.for_identities.extend(inside);
        }
    }
}

impl Region {
    fn point(&self, d: usize, random: &mut Random) -> Vec<f64> {
        match *self {
            Self::Box(half_side) => scaled(half_side, &random.vector(d)),
            Self::Near => Vec::new(),
            Self::Ball(radius) => {
                let direction: Vec<f64> = (0..d).map(|_| random.normals.normal()).collect();
                // Uniform in the ball; one point in four on the sphere, where suprema tend to be.
                let share = random.uniform().abs();
                let length =
                    if share < 0.25 { 1.0 } else { powf((share - 0.25) / 0.75, 1.0 / d as f64) };
                scaled(radius * length / norm(&direction), &direction)
            }
        }
    }
}

/// Reason why a system cannot be inspected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InspectError {
    /// Too few points of the region are in the domain of the system.
    #[error(
        "an inspection needs {wanted} points in the domain of the system, found {found}; with y0 it \
         searches around y0"
    )]
    NoPoints {
        /// Points found.
        found: usize,
        /// Points needed.
        wanted: usize,
    },
    /// The vector field or the energy is NaN or infinite at a point of the domain.
    #[error(
        "B grad H and the energy must be finite wherever check_domain is Ok, got {value} at \
         y = {at:?}"
    )]
    NotFinite {
        /// The point.
        at: Vec<f64>,
        /// The value.
        value: f64,
    },
}

/// System at clusters of points.
pub struct Sight<'a> {
    pub probe: Probe<'a>,
    pub points: &'a Points,
    /// The states of all clusters: the points for identities, each followed by others near it.
    pub states: Batch,
    /// Matrices B at `states`; empty for a system of many components, which is checked along random
    /// directions instead.
    pub matrices: Vec<Matrix>,
}

/// Largest number of components of a system whose matrices are computed.
const MATRICES: usize = 24;
/// The length of a segment, relative to the distance of two points.
const SEGMENT: f64 = 0.1;

impl<'a> Sight<'a> {
    pub fn new(mut probe: Probe<'a>, points: &'a Points) -> Self {
        let mut random = Random::new(Purpose::Clusters);
        let mut states = Batch::new();
        for y in &points.for_identities {
            states.push(y.clone());
            for _ in 1..CLUSTER {
                // Components that are zero remain so.
                let near = y.iter().map(|y| y * (1.0 + APART * random.uniform()));
                let near: Vec<f64> = near.collect();
                states.push(if probe.in_domain(&near) { near } else { y.clone() });
            }
        }
        let small = probe.dimension() <= MATRICES && probe.is_one_tile();
        let matrices = if small { probe.matrix(&states) } else { Vec::new() };
        Self { probe, points, states, matrices }
    }

    /// One random vector for each cluster, repeated at all its states.
    pub fn vectors(&self, random: &mut Random) -> Batch {
        let points = self.points.for_identities.iter();
        points.flat_map(|y| vec![random.vector(y.len()); CLUSTER]).collect()
    }

    /// Random weights of all Hamiltonians.
    pub fn weights(&self, random: &mut Random) -> Vec<f64> {
        random.vector(1 + self.probe.noises())
    }

    /// Random weights of the Hamiltonians of noises.
    pub fn weights_of_noises(&self, random: &mut Random) -> Vec<f64> {
        let mut weights = self.weights(random);
        weights[0] = 0.0;
        weights
    }

    /// Records an identity whose terms are given at each state, beside others of the size `wide`.
    pub fn record(&self, finding: &mut Finding, terms: impl Fn(usize) -> Vec<Term>, wide: f64) {
        let terms: Vec<_> = (0..self.states.len()).map(terms).collect();
        for (at, cluster) in self.points.for_identities.iter().zip(terms.chunks(CLUSTER)) {
            finding.record(at, cluster, wide);
        }
    }

    /// Finding on an identity whose terms are given at each state.
    pub fn found(&self, terms: impl Fn(usize) -> Vec<Term>) -> Finding {
        let mut finding = Finding::default();
        self.record(&mut finding, terms, 0.0);
        finding
    }

    /// Records a = b at each state.
    pub fn compare(&self, finding: &mut Finding, a: &Batch, b: &Batch) {
        self.record(finding, |n| differences(&a[n], &b[n]), 0.0);
    }

    /// The ends of steps from each state.
    pub fn moved(&self, share: f64, steps: &Batch) -> Batch {
        self.states.iter().zip(steps).map(|(y, step)| moved(y, share, step)).collect()
    }

    /// Steps from each state towards the next point, shortened until they are in the domain.
    pub fn segments(&self) -> Batch {
        let points = &self.points.for_identities;
        let steps = points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| {
            let whole = moved(b, -1.0, a);
            let mut steps =
                (0..HALVINGS).map(|halvings| scaled(SEGMENT * f64::powi(0.5, halvings), &whole));
            let is_inside = |step: &Vec<f64>| {
                (1..=8).all(|k| self.probe.in_domain(&moved(a, f64::from(k) / 8.0, step)))
            };
            steps.find(is_inside).unwrap_or_else(|| vec![0.0; a.len()])
        });
        steps.flat_map(|step| vec![step; CLUSTER]).collect()
    }

    /// Whether `gradient` is the derivative of h along segments, where that is resolved.
    pub fn gradient(&mut self, weights: &[f64]) -> Finding {
        let steps = self.segments();
        let (middles, mut finding) = (self.moved(0.5, &steps), Finding::default());
        let energy: Values<'_> = &|probe, y| probe.energy(y, weights);
        // All values are on the segments.
        let slopes = slopes(&mut self.probe, &middles, &steps, &vec![0.125; steps.len()], energy);
        let gradients = self.probe.gradient(&middles, weights);
        let term = |n: usize| {
            let (along, size) = product(&gradients[n], &steps[n]);
            vec![(slopes[n].0 - along, slopes[n].1 + size)]
        };
        for (n, at) in self.points.for_identities.iter().enumerate() {
            let cluster = n * CLUSTER..(n + 1) * CLUSTER;
            if slopes[cluster.clone()].iter().all(|(_, size)| *size < f64::INFINITY) {
                finding.record(at, &cluster.map(term).collect::<Vec<_>>(), 0.0);
            }
        }
        if finding.points == 0 {
            finding.status = Status::Unknown;
        }
        finding
    }
}
