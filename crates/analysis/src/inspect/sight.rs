//! What all checks look at: a system at clusters of points, and identities of derivatives.

use dgrad::Rule;

use super::{
    algebra::{dot, largest, moved},
    finding::{CLUSTER, Finding, Term, differences},
    points::Points,
    probe::{Batch, Local, Probe},
    random::Random,
};

/// A system at clusters of points.
pub struct Sight<'a> {
    pub probe: Probe<'a>,
    pub points: &'a Points,
    /// The states of all clusters.
    pub states: Batch,
    /// The system at these; none of a system of many components, which is looked at along random
    /// directions instead.
    pub locals: Vec<Local>,
}

/// Most components of a system whose matrices are looked at.
const MATRICES: usize = 24;
/// Nodes of the quadrature of a derivative, and of the one that tells its error.
const NODES: [usize; 2] = [16, 8];
/// Above this part of the terms the difference of the two is not resolved.
const RESOLVED: f64 = 1e-13;
/// Halvings of a segment until it is in the domain, and until the quadrature resolves it.
const HALVINGS: usize = 40;
const SHORTER: usize = 6;
/// The length of a segment, relative to the distance of two points.
const SEGMENT: f64 = 0.1;

impl<'a> Sight<'a> {
    pub fn new(mut probe: Probe<'a>, points: &'a Points) -> Self {
        let states = points.clusters(&probe);
        let small = probe.dimension() <= MATRICES && probe.is_one_tile();
        let locals = if small { probe.locals(&states) } else { Vec::new() };
        Self { probe, points, states, locals }
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

    /// Whether h(y + s) − h(y) = ∫₀¹ ∇h(y + ηs)·s dη along segments, by Gauss–Legendre quadrature
    /// on segments short enough for it.
    pub fn gradient(&mut self, weights: &[f64]) -> Finding {
        let mut finding = Finding::default();
        let points = &self.points.for_identities;
        let (mut steps, mut open) = (self.segments(), vec![true; points.len()]);
        let start = self.probe.energy(&self.states, weights);
        for _ in 0..SHORTER {
            let end = self.probe.energy(&self.moved(1.0, &steps), weights);
            let [fine, coarse] = NODES.map(|nodes| {
                let rule = Rule::new(nodes).unwrap_or_else(|error| unreachable!("{error}"));
                let mut sums = vec![(0.0, 0.0); start.len()];
                for (&node, &weight) in rule.nodes().iter().zip(rule.weights()) {
                    let slopes = self.probe.gradient(&self.moved(node, &steps), weights);
                    for (sum, (slope, step)) in sums.iter_mut().zip(slopes.iter().zip(&steps)) {
                        let slope = dot(slope, step);
                        *sum = (sum.0 + weight * slope, sum.1 + weight * slope.abs());
                    }
                }
                sums
            });
            let mut resolved = Vec::new();
            for (k, at) in points.iter().enumerate().filter(|(k, _)| open[*k]) {
                let members = CLUSTER * k..CLUSTER * (k + 1);
                let term = |n: usize| -> Term {
                    let (sum, size) = fine[n];
                    (end[n] - start[n] - sum, end[n].abs() + start[n].abs() + size)
                };
                let cluster: Vec<Term> = members.clone().map(term).collect();
                let size = largest(cluster.iter().map(|term| &term.1));
                let apart = members.clone().map(|n| (fine[n].0 - coarse[n].0).abs());
                if apart.fold(0.0, f64::max) <= RESOLVED * size {
                    let terms: Vec<_> = cluster.into_iter().map(|term| vec![term]).collect();
                    finding.record(at, &terms, 0.0);
                    resolved.push(k);
                } else {
                    steps[members].iter_mut().flatten().for_each(|x| *x *= 0.25);
                }
            }
            resolved.into_iter().for_each(|k| open[k] = false);
            if !open.contains(&true) {
                break;
            }
        }
        finding.seen()
    }
}
