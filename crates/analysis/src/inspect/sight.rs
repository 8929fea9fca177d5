//! What all checks look at: a system at clusters of points, and identities of derivatives.

use dgrad::Rule;

use super::{
    algebra::{largest, moved},
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

    /// Whether f(y + s) − f(y) = ∫₀¹ f′(y + ηs)s dη along segments, by Gauss–Legendre quadrature on
    /// segments short enough for it.
    pub fn derivative(
        &mut self,
        value: impl Fn(&mut Probe<'a>, &Batch) -> Batch,
        slope: impl Fn(&mut Probe<'a>, &Batch, &Batch) -> Batch,
    ) -> Finding {
        let mut finding = Finding::default();
        let (mut steps, mut open) = (self.segments(), vec![true; self.points.for_identities.len()]);
        let start = value(&mut self.probe, &self.states);
        for _ in 0..SHORTER {
            let ends = self.moved(1.0, &steps);
            let end = value(&mut self.probe, &ends);
            let [fine, coarse] = NODES.map(|nodes| {
                let rule = Rule::new(nodes).unwrap_or_else(|error| unreachable!("{error}"));
                let mut sums = vec![vec![(0.0, 0.0); start[0].len()]; start.len()];
                for (&node, &weight) in rule.nodes().iter().zip(rule.weights()) {
                    let at = self.moved(node, &steps);
                    for (sum, slope) in sums.iter_mut().zip(slope(&mut self.probe, &at, &steps)) {
                        for (sum, slope) in sum.iter_mut().zip(slope) {
                            *sum = (sum.0 + weight * slope, sum.1 + weight * slope.abs());
                        }
                    }
                }
                sums
            });
            let terms = |n: usize| -> Vec<Term> {
                let term = |i: usize| {
                    let (sum, size) = fine[n][i];
                    (end[n][i] - start[n][i] - sum, end[n][i].abs() + start[n][i].abs() + size)
                };
                (0..start[n].len()).map(term).collect()
            };
            for (k, at) in self.points.for_identities.iter().enumerate() {
                if !open[k] {
                    continue;
                }
                let members = CLUSTER * k..CLUSTER * (k + 1);
                let cluster: Vec<_> = members.clone().map(terms).collect();
                let size = largest(cluster.iter().flatten().map(|term| &term.1));
                let apart = members
                    .clone()
                    .flat_map(|n| fine[n].iter().zip(&coarse[n]).map(|(a, b)| (a.0 - b.0).abs()));
                if apart.fold(0.0, f64::max) <= RESOLVED * size {
                    finding.record(at, &cluster, 0.0);
                    open[k] = false;
                } else {
                    steps[members].iter_mut().flatten().for_each(|x| *x *= 0.25);
                }
            }
            if !open.contains(&true) {
                break;
            }
        }
        finding.seen()
    }
}
