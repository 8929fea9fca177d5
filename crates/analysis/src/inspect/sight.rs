//! What all checks look at: a system at clusters of points, and identities of derivatives.

use super::points::Points;
use crate::facts::{
    Batch, CLUSTER, Finding, Matrix, Probe, Random, Term, Values, differences, moved, product,
    slopes,
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

    /// Records an identity whose terms are given at each state, beside others of the size `wide`.
    pub fn record(
        &self,
        finding: &mut Finding,
        terms: impl IntoIterator<Item = Vec<Term>>,
        wide: f64,
    ) {
        let terms: Vec<_> = terms.into_iter().collect();
        for (at, cluster) in self.points.for_identities.iter().zip(terms.chunks(CLUSTER)) {
            finding.record(at, cluster, wide);
        }
    }

    /// What is found of an identity whose terms are given at each state.
    pub fn found(&self, terms: impl IntoIterator<Item = Vec<Term>>) -> Finding {
        let mut finding = Finding::default();
        self.record(&mut finding, terms, 0.0);
        finding
    }

    /// Records a = b at each state.
    pub fn compare(&self, finding: &mut Finding, a: &Batch, b: &Batch) {
        self.record(finding, a.iter().zip(b).map(|(a, b)| differences(a, b)), 0.0);
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
        let terms = slopes.into_iter().zip(gradients.iter().zip(&steps));
        let terms = terms.map(|((slope, size), (gradient, step))| {
            let (along, terms) = product(gradient, step);
            vec![(slope - along, size + terms)]
        });
        let terms: Vec<_> = terms.collect();
        for (at, cluster) in self.points.for_identities.iter().zip(terms.chunks(CLUSTER)) {
            if cluster.iter().all(|terms| terms[0].1 < f64::INFINITY) {
                finding.record(at, cluster, 0.0);
            }
        }
        finding.seen()
    }
}
