//! What all checks look at: a system at clusters of points, and identities of derivatives.

use super::{
    algebra::{Matrix, dot, largest, moved},
    finding::{CLUSTER, Finding, Term, differences, product},
    points::Points,
    probe::{Batch, Probe},
    random::Random,
    shape::Values,
};

/// A system at clusters of points.
pub struct Sight<'a> {
    pub probe: Probe<'a>,
    pub points: &'a Points,
    /// The states of all clusters.
    pub states: Batch,
    /// B at these; none of a system of many components, which is looked at along random directions
    /// instead.
    pub matrices: Vec<Matrix>,
}

/// Most components of a system whose matrices are looked at.
const MATRICES: usize = 24;
/// Halvings of a segment until it is in the domain.
const HALVINGS: usize = 40;
/// The length of a segment, relative to the distance of two points.
const SEGMENT: f64 = 0.1;

impl<'a> Sight<'a> {
    pub fn new(mut probe: Probe<'a>, points: &'a Points) -> Self {
        let states = points.clusters(&probe);
        let small = probe.dimension() <= MATRICES && probe.is_one_tile();
        let matrices = if small { probe.matrix(&states) } else { Vec::new() };
        Self { probe, points, states, matrices }
    }

    /// A random vector for each cluster, at all its states.
    pub fn vectors(&self, random: &mut Random) -> Batch {
        let d = self.probe.dimension();
        let mut vector = || (0..d).map(|_| random.uniform()).collect::<Vec<_>>();
        self.points.for_identities.iter().flat_map(|_| vec![vector(); CLUSTER]).collect()
    }

    /// Random weights of all Hamiltonians.
    pub fn weights(&self, random: &mut Random) -> Vec<f64> {
        (0..=self.probe.noises()).map(|_| random.uniform()).collect()
    }

    /// Records an identity whose terms are given at each state.
    pub fn record(&self, finding: &mut Finding, terms: impl IntoIterator<Item = Vec<Term>>) {
        let terms: Vec<_> = terms.into_iter().collect();
        for (at, cluster) in self.points.for_identities.iter().zip(terms.chunks(CLUSTER)) {
            finding.record(at, cluster, 0.0);
        }
    }

    /// Records a = b at each state.
    pub fn compare(&self, finding: &mut Finding, a: &Batch, b: &Batch) {
        self.record(finding, a.iter().zip(b).map(|(a, b)| differences(a, b)));
    }

    /// The ends of steps from each state.
    pub fn moved(&self, share: f64, steps: &Batch) -> Batch {
        self.states.iter().zip(steps).map(|(y, step)| moved(y, share, step)).collect()
    }

    /// From each state towards the next point, as long as it is in the domain.
    pub fn segments(&self) -> Batch {
        let points = &self.points.for_identities;
        let segment = |n: usize| {
            let (a, b) = (&points[n], &points[(n + 1) % points.len()]);
            let step = |halvings: usize| -> Vec<f64> {
                let share = SEGMENT * f64::powi(0.5, halvings as i32);
                a.iter().zip(b).map(|(a, b)| share * (b - a)).collect()
            };
            let inside = |step: &Vec<f64>| {
                (1..=8).all(|k| self.probe.in_domain(&moved(a, f64::from(k) / 8.0, step)))
            };
            let step = (0..HALVINGS).map(step).find(inside).unwrap_or_else(|| vec![0.0; a.len()]);
            vec![step; CLUSTER]
        };
        (0..points.len()).flat_map(segment).collect()
    }

    /// Whether `gradient` is the derivative of h along segments, where that is resolved.
    pub fn gradient(&mut self, weights: &[f64]) -> Finding {
        let steps = self.segments();
        let (middles, mut finding) = (self.moved(0.5, &steps), Finding::default());
        let energy: Values<'_> = &|probe, y| probe.energy(y, weights);
        // All values are on the segments.
        let slopes = slopes(&mut self.probe, &middles, &steps, &vec![0.125; steps.len()], energy);
        let gradients = self.probe.gradient(&middles, weights);
        let term = |((slope, size), (gradient, step)): (Term, (&Vec<f64>, &Vec<f64>))| {
            let (along, terms) = product(gradient, step);
            vec![(slope - along, size + terms)]
        };
        let terms: Vec<_> =
            slopes.into_iter().zip(gradients.iter().zip(&steps)).map(term).collect();
        for (at, cluster) in self.points.for_identities.iter().zip(terms.chunks(CLUSTER)) {
            if cluster.iter().all(|terms| terms[0].1 < f64::INFINITY) {
                finding.record(at, cluster, 0.0);
            }
        }
        finding.seen()
    }
}

/// Weights of the differences F(y + kh) − F(y − kh) in the derivative, of orders eight and six.
const WEIGHTS: [[f64; 4]; 2] =
    [[4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0], [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0]];
/// Lengths h, each half of the one before, of which the best is taken.
const LENGTHS: i32 = 8;
/// Below this part of the terms the error of a derivative is taken for round-off.
const ROUNDING: f64 = 1e-14;
/// A derivative with an error above this part of its terms is not resolved.
const RESOLVED: f64 = 1e-9;

/// The derivative of F along vectors at each state, from these lengths on, and a size whose
/// round-off is its error: infinite where the domain is too narrow or no length resolves F.
pub fn slopes(
    probe: &mut Probe<'_>,
    y: &Batch,
    along: &Batch,
    lengths: &[f64],
    f: Values<'_>,
) -> Vec<Term> {
    let mut best = vec![(0.0, f64::INFINITY); y.len()];
    for halvings in 0..LENGTHS {
        let length = |n: usize| lengths[n] * f64::powi(0.5, halvings);
        let mut side = |k: i32| {
            let at = |n: usize| moved(&y[n], f64::from(k) * length(n), &along[n]);
            let states: Batch = (0..y.len()).map(at).collect();
            let values = f(probe, &states);
            (states, values)
        };
        let sides = [1, 2, 3, 4].map(|k| [k, -k].map(&mut side));
        for n in 0..y.len() {
            let mut inside = sides.iter().flatten().map(|(states, _)| &states[n]);
            if !inside.all(|y| probe.in_domain(y)) {
                continue;
            }
            let differences: Vec<f64> =
                sides.iter().map(|[up, down]| up.1[n] - down.1[n]).collect();
            let [fine, coarse] = WEIGHTS.map(|weights| dot(&weights, &differences) / length(n));
            let size = largest(sides.iter().flatten().map(|(_, values)| &values[n])) / length(n);
            let apart = (fine - coarse).abs();
            let error = apart / ROUNDING + 0.1 * size;
            if error < best[n].1 && apart <= RESOLVED * size {
                best[n] = (fine, error);
            }
        }
    }
    best.into_iter().map(|(slope, error)| (slope, slope.abs() + error)).collect()
}
