//! The expressions of a system in one graph.

use std::{collections::BTreeSet, iter::once, ops::Range};

use super::{
    Coordinate, MAX_EXPRESSIONS, average, cayley,
    definition::Formulas,
    flows::Term,
    sparse::{Field, Sparse, connected, consecutive, dot},
};
use real::Real;
use systems::{probe::vanish, run_time::Op};

use expression::{Binary, Graph, Id, Node, Tape, Unary, Weighted, forms, terms};

use crate::{
    Formula,
    words::{self, Binding},
};

/// Operations of a system as expressions, in groups of inputs: y, u, v, dt, dw, areas and t.
#[derive(Clone, Default)]
pub struct Expressions {
    pub graph: Graph,
    pub dimension: usize,
    pub noises: usize,
    /// H₀, H₁, …
    pub hamiltonians: Vec<Id>,
    /// The Hamiltonians Φ of heat baths, by their numbers, with u = −{H₀, Φ}/2kT.
    pub baths: Vec<(usize, Id)>,
    /// The entries of B in each row that are not zero, by their columns: those above the diagonal,
    /// and below the diagonal minus the entries.
    structure: Vec<Sparse>,
    /// The fields f₀, f₁, … of an equation without B and H, of which B is the identity and ∇Hₘ is
    /// fₘ; none of other systems.
    fields: Vec<Vec<Id>>,
    /// B(y)v.
    field: Vec<Id>,
    /// The operations that have expressions, with the groups of inputs (y, u, v) that are their
    /// arguments. ∇̄h(a, b) is that of a = y and b = u. None is the linearly implicit step if B is
    /// not affine, or elimination too long, and those of areas for more than [`MAX_NOISES`].
    operations: Vec<(Op<usize>, Vec<Id>)>,
    /// Flows of the parts, in a graph of their own; none if there is a term without one.
    pub flows: (Graph, Vec<Vec<Id>>),
}

/// The groups of inputs.
const Y: usize = 0;
const U: usize = 1;
const V: usize = 2;
const DT: usize = 3;
const DW: usize = 4;
/// The matrix of Lévy areas, of which the part above the diagonal is read.
const AREAS: usize = 5;
/// The time.
const TIME: usize = 6;

/// Times at which noises that depend on it are asked whether they commute.
const TIMES: [f64; 3] = [0.0, 0.618, 2.236];

/// The most noises whose Lévy areas are used.
const MAX_NOISES: usize = 16;

/// The number of areas; none where they are not used.
pub fn number_of_areas(noises: usize) -> usize {
    if noises <= MAX_NOISES { noises * noises } else { 0 }
}

impl Expressions {
    /// The expressions of a system; or of the `rest` of it, the terms of another graph.
    pub fn new(formulas: &Formulas, rest: Option<(&Graph, &[Term])>) -> Self {
        let (dimension, noises) = (formulas.dimension, formulas.hamiltonians.len() - 1);
        let structure = vec![Sparse::new(); dimension];
        let mut new = Self { dimension, noises, structure, ..Self::default() };
        let (y, t) = (new.inputs(Y), new.inputs(TIME)[0]);
        let variable = |k: usize| Some(y.get(k).copied().unwrap_or(t));
        let mut import =
            |formula: &Formula| new.graph.copy(Some(&formula.graph), &[formula.root], variable)[0];
        new.hamiltonians = formulas.hamiltonians.iter().map(&mut import).collect();
        let temperatures: Vec<Id> = formulas.temperatures.iter().map(&mut import).collect();
        let fields = formulas.fields.iter();
        new.fields = fields.map(|of| of.iter().map(&mut import).collect()).collect();
        for ((i, j), formula) in &formulas.structure {
            let above = import(formula);
            new.structure[*i].insert(*j, above);
            new.structure[*j].insert(*i, above);
        }
        if let Some((other, terms)) = rest {
            new.hamiltonians.fill(new.graph.constant(0.0));
            for term in terms {
                let root = new.graph.copy(Some(other), &[term.root], variable)[0];
                new.graph.add_to(&mut new.hamiltonians[term.of], root, term.factor);
            }
        }
        if formulas.ito {
            let correction = new.corrected();
            average::add_all(&mut new.graph, &mut new.fields[0], &correction, -1.0);
        }
        let [u, v] = [U, V].map(|group| new.inputs(group));
        let directions: Sparse = u.iter().copied().enumerate().collect();
        new.field = new.field_at(&v.into_iter().enumerate().collect());
        let field = new.field.clone();
        let field_along = new.along(&field, &directions);
        let weights = new.weights();
        // ∇(H₀w₀ + H₁w₁ + …), with w + u dt for baths.
        new.baths = new.shifts(&temperatures);
        let weighted: Vec<Weighted> =
            new.hamiltonians.iter().copied().zip(weights.clone()).collect();
        let shifted = new.shifted(&weighted, |_, shift, _| shift);
        let sum = |k: usize| {
            let fields = new.fields.iter().map(|field| field[k]);
            let direct: Vec<Weighted> = fields.zip(weights.clone()).collect();
            // Drift and noises may share terms.
            let shared = terms(&mut new.graph, &direct);
            let sums = [direct, shared].map(|products| new.graph.sum(products));
            let [direct, shared] = sums.map(|sum| new.graph.needed(&[sum]).len());
            sums[usize::from(shared < direct)]
        };
        let gradient = match new.fields.is_empty() {
            true => new.graph.reverse(&shifted, &Vec::from_iter(0..dimension)),
            false => (0..dimension).map(sum).collect(),
        };
        let hessian = new.along(&gradient, &directions);
        // Of ∇̄h, u is taken at the middle, and stands for itself until h is averaged.
        let own = new.group(TIME).end;
        let averaged = match &*new.baths {
            [] => average::averaged_gradient(&mut new.graph, &weighted, &y, &u),
            &[(first, _), ..] => {
                let middle = average::point(&mut new.graph, &y, &u, 0.0);
                let own_weights = new.shifted(&weighted, |graph, _, m| graph.input(own + m));
                let averaged = average::averaged_gradient(&mut new.graph, &own_weights, &y, &u);
                let shifts = new.shift_values();
                let shifts = average::at(&mut new.graph, &shifts, &middle);
                new.graph.copy(None, &averaged, |k| Some(shifts[k.checked_sub(own + first)?]))
            }
        };
        let correction = new.corrected();
        new.operations = vec![
            (Op::Structure { y: Y, v: V }, field),
            (Op::StructureAlong { y: Y, u: U, v: V }, field_along),
            (Op::Gradient { y: Y }, gradient),
            (Op::Hessian { y: Y, u: U }, hessian),
            (Op::ItoCorrection { y: Y }, correction),
        ];
        if !new.is_plain() {
            new.operations.push((Op::AveragedGradient { a: Y, b: U }, averaged));
        }
        if noises <= MAX_NOISES {
            let gradient = new.bracketed();
            if noises > 1 {
                let hessian = new.along(&gradient, &directions);
                new.operations.push((Op::AreaHessian { y: Y, u: U }, hessian));
            }
            new.operations.push((Op::AreaGradient { y: Y }, gradient));
        }
        if let Some(solution) = new.solved(&y) {
            new.operations.push((Op::Cayley { y: Y, v: V }, solution));
        }
        new
    }

    /// The Hamiltonians of baths at these temperatures, which are the last, with their u.
    fn shifts(&mut self, temperatures: &[Id]) -> Vec<(usize, Id)> {
        if temperatures.is_empty() {
            return Vec::new();
        }
        let (drift, first) = (self.field_of(0), self.noises + 1 - temperatures.len());
        let shift = |(m, &kt): (usize, &Id)| {
            // {H₀, Φ} = −∇ΦᵀB∇H₀.
            let slope = self.gradient(self.hamiltonians[m]);
            let bracket = dot(&mut self.graph, &slope, &drift);
            let half = self.graph.scale(bracket, 0.5);
            (m, self.graph.div(half, kt))
        };
        (first..).zip(temperatures).map(shift).collect()
    }

    /// The u of all baths.
    fn shift_values(&self) -> Vec<Id> {
        self.baths.iter().map(|(_, u)| *u).collect()
    }

    /// The weights of Hamiltonians with the drift of those of baths, for which `shift` may put
    /// something else, from u and the number of the Hamiltonian.
    fn shifted(
        &mut self,
        weighted: &[Weighted],
        shift: impl Fn(&mut Graph, Id, usize) -> Id,
    ) -> Vec<Weighted> {
        let mut all = weighted.to_vec();
        for &(m, u) in &self.baths {
            let u = shift(&mut self.graph, u, m);
            all[m].1 = self.graph.add_product(weighted[m].1, u, weighted[0].1);
        }
        all
    }

    /// The inputs of a group.
    fn group(&self, group: usize) -> Range<usize> {
        let (d, m) = (self.dimension, self.noises);
        consecutive([d, d, d, 1, m, number_of_areas(m), 1])[group].clone()
    }

    fn inputs(&mut self, group: usize) -> Vec<Id> {
        self.graph.inputs(self.group(group))
    }

    /// The weights of the Hamiltonians, dt and dw.
    fn weights(&mut self) -> Vec<Id> {
        [self.inputs(DT), self.inputs(DW)].concat()
    }

    /// Names of the inputs; those that no formula shows have any.
    pub fn names(&self, state: &[String]) -> Vec<String> {
        let mut names = state.to_vec();
        names.resize(self.group(TIME).end, "t".into());
        names
    }

    /// The flow of a part from y, with the weights of the Hamiltonians, at time t.
    pub fn flow(&self, part: usize, graph: &mut Graph, y: &[Id], weights: &[Id], t: Id) -> Vec<Id> {
        let (d, first) = (self.dimension, self.group(DT).start);
        let input = |k: usize| match k {
            _ if k < d => y[k],
            _ => weights.get(k - first).copied().unwrap_or(t),
        };
        graph.copy(Some(&self.flows.0), &self.flows.1[part], |k| Some(input(k)))
    }

    /// The components of y.
    pub fn states(&mut self) -> Vec<Id> {
        self.inputs(Y)
    }

    /// The number of the component that an expression is.
    pub fn component(&self, id: Id) -> Option<usize> {
        self.graph.as_input(id).filter(|&k| k < self.dimension)
    }

    /// The components that expressions use.
    pub fn reads(&self, roots: &[Id]) -> BTreeSet<usize> {
        self.graph.needed(roots).into_iter().filter_map(|id| self.component(id)).collect()
    }

    /// Σ c·w for the weights w of Hamiltonians and factors c.
    pub fn weighted(&mut self, shares: &[(usize, f64)]) -> Id {
        let mut sum = self.graph.constant(0.0);
        for &(m, factor) in shares {
            let weight = self.graph.input(self.group(DT).start + m);
            self.graph.add_to(&mut sum, weight, factor);
        }
        sum
    }

    /// B∇F of a term with its weight.
    pub fn field_of_term(&mut self, term: &Term) -> Sparse {
        let weight = self.weighted(&[(term.of, term.factor)]);
        let gradient = self.slopes(&[(term.root, weight)]);
        self.times(&gradient)
    }

    /// The gradient of a sum of functions of y, each with its weight.
    pub fn slopes(&mut self, weighted: &[Weighted]) -> Sparse {
        self.graph.slopes(weighted, |k| k < self.dimension)
    }

    fn gradient(&mut self, function: Id) -> Sparse {
        let one = self.graph.constant(1.0);
        self.slopes(&[(function, one)])
    }

    /// r with x′ = rx for the change x′ of component k; none if there is no such r, or it depends
    /// on the component.
    pub fn rate(&mut self, change: Id, k: usize) -> Option<Id> {
        if self.graph.degree(change, |i| i == k)? > 1 {
            return None;
        }
        let [zero, one] = [0.0, 1.0].map(|x| self.graph.constant(x));
        let at_zero = self.graph.copy(None, &[change], |i| (i == k).then_some(zero))[0];
        let rate = self.graph.forward(&[change], |i| (i == k).then_some(one))[0];
        (self.graph.is_zero(at_zero) && !self.reads(&[rate]).contains(&k)).then_some(rate)
    }

    /// Whether this is an equation without B and H.
    pub fn is_plain(&self) -> bool {
        !self.fields.is_empty()
    }

    /// B·v.
    fn times(&mut self, v: &Sparse) -> Sparse {
        if self.is_plain() {
            return v.clone();
        }
        let Self { graph, structure, .. } = self;
        let rows: BTreeSet<usize> = v.keys().flat_map(|&k| structure[k].keys()).copied().collect();
        let mut field = Sparse::new();
        for i in rows {
            let mut sum = graph.constant(0.0);
            for (&column, &above) in &structure[i] {
                let Some(&v) = v.get(&column) else { continue };
                let add = if column < i { Graph::sub_product } else { Graph::add_product };
                sum = add(graph, sum, above, v);
            }
            if !graph.is_zero(sum) {
                field.insert(i, sum);
            }
        }
        field
    }

    /// All components of B·v.
    fn field_at(&mut self, v: &Sparse) -> Vec<Id> {
        let field = self.times(v);
        let mut all = vec![self.graph.constant(0.0); self.dimension];
        field.into_iter().for_each(|(k, component)| all[k] = component);
        all
    }

    /// Whether B or a Hamiltonian has a logarithm, a root or a quotient.
    pub fn have_domain(&self) -> bool {
        let all = [&self.hamiltonians[..], &self.field, &self.fields.concat()].concat();
        self.graph.uses(&all, |node| match node {
            Node::Unary(Unary::Ln | Unary::Sqrt, _) => true,
            Node::Binary(Binary::Div, _, by) => {
                self.graph.as_constant(by).is_none_or(|by| by == 0.0)
            }
            _ => false,
        })
    }

    /// Factors of divisors and of arguments of logarithms in Hamiltonians, as functions of y.
    pub fn walls(&self) -> Option<Tape> {
        let of = |id: Id| match self.graph.node(id) {
            Node::Binary(Binary::Div, _, of) | Node::Unary(Unary::Ln, of) => Some(of),
            _ => None,
        };
        let needed = self.graph.needed(&self.hamiltonians);
        let (mut open, mut walls): (Vec<Id>, _) =
            (needed.into_iter().filter_map(of).collect(), vec![]);
        while let Some(id) = open.pop() {
            match self.graph.node(id) {
                Node::Constant(_) => {}
                Node::Unary(Unary::Abs | Unary::Neg | Unary::Sqrt, a)
                | Node::Power(a, _)
                | Node::Binary(Binary::Div, a, _) => open.push(a),
                Node::Binary(Binary::Mul, a, b) => open.extend([a, b]),
                _ => walls.push(id),
            }
        }
        walls.sort_unstable();
        walls.dedup();
        let t = self.group(TIME).start as u32;
        walls.retain(|&wall| !self.graph.uses(&[wall], |node| node == Node::Input(t)));
        (!walls.is_empty()).then(|| self.tape(&walls, [Y]))
    }

    /// Whether a Hamiltonian, or the temperature of a bath, depends on time.
    pub fn depend_on_time(&self) -> bool {
        let t = self.group(TIME).start as u32;
        let shifts = self.shift_values();
        let all = [&self.hamiltonians[..], &shifts, &self.fields.concat()].concat();
        self.graph.uses(&all, |node| node == Node::Input(t))
    }

    /// H₀ + H₁ + … and the components of B(y)(1, 2, …), a sum that is finite where all are.
    pub fn guard(&mut self) -> Id {
        let ones = vec![self.graph.constant(1.0); self.hamiltonians.len()];
        let mut sum = self.graph.dot(&self.hamiltonians, &ones);
        // No two entries cancel, as they would if all numbers were one.
        let v = (0..self.dimension).map(|k| (k, self.graph.constant(1.0 + k as f64))).collect();
        for component in self.field_at(&v) {
            sum = self.graph.add(sum, component);
        }
        for (component, n) in self.fields.iter().flatten().zip(1..) {
            self.graph.add_to(&mut sum, *component, f64::from(n));
        }
        sum
    }

    /// The largest degrees of B(y) and of H₀, H₁, … in y.
    pub fn degrees(&self) -> [Option<u32>; 2] {
        [&self.field, &self.hamiltonians].map(|roots| {
            let degrees = self.graph.degrees(roots, |k| k < self.dimension);
            degrees.into_iter().try_fold(0, |most, degree| Some(degree?.max(most)))
        })
    }

    /// The derivatives of functions of y along a direction.
    fn along(&mut self, roots: &[Id], direction: &Sparse) -> Vec<Id> {
        self.graph.forward(roots, |k| direction.get(&k).copied())
    }

    /// The derivatives of the components of a vector.
    fn vector_along(&mut self, vector: &Sparse, direction: &Sparse) -> Sparse {
        let roots: Vec<Id> = vector.values().copied().collect();
        vector.keys().copied().zip(self.along(&roots, direction)).collect()
    }

    /// ∂∇̄h(y, u)/∂u·v; none if there is no ∇̄h.
    pub fn averaged_along(&mut self) -> Option<Vec<Id>> {
        let averaged = self.of(&Op::AveragedGradient { a: (), b: () })?.1.clone();
        let (first, v) = (self.group(U).start, self.inputs(V));
        Some(self.graph.forward(&averaged, |k| v.get(k.checked_sub(first)?).copied()))
    }

    /// ½Σₘ fₘ′fₘ.
    fn corrected(&mut self) -> Vec<Id> {
        let mut correction = vec![self.graph.constant(0.0); self.dimension];
        for m in 1..self.hamiltonians.len() {
            let field = self.field_of(m);
            for (k, slope) in self.vector_along(&field, &field) {
                self.graph.add_to(&mut correction[k], slope, 0.5);
            }
        }
        correction
    }

    /// Σ_{m<l} A_ml ∇{Hₘ, H_l}, or −Σ_{m<l} A_ml \[fₘ, f_l\] where B is the identity.
    fn bracketed(&mut self) -> Vec<Id> {
        let fields = self.noise_fields();
        if self.is_plain() {
            let mut sum = vec![self.graph.constant(0.0); self.dimension];
            for (m, l) in (0..fields.len()).flat_map(|l| (0..l).map(move |m| (m, l))) {
                let area = self.graph.input(self.group(AREAS).start + m * self.noises + l);
                for (f, g, sign) in [(m, l, -1.0), (l, m, 1.0)] {
                    for (k, slope) in self.vector_along(&fields[g], &fields[f]) {
                        let term = self.graph.mul(slope, area);
                        self.graph.add_to(&mut sum[k], term, sign);
                    }
                }
            }
            return sum;
        }
        let mut brackets = Vec::new();
        for m in 0..self.noises {
            let slope = self.gradient(self.hamiltonians[m + 1]);
            for (l, field) in fields.iter().enumerate().skip(m + 1) {
                let area = self.graph.input(self.group(AREAS).start + m * self.noises + l);
                brackets.push((dot(&mut self.graph, &slope, field), area));
            }
        }
        self.graph.reverse(&brackets, &Vec::from_iter(self.group(Y)))
    }

    /// Whether \[fₘ, f_l\] = 0 for all noises, and whether it is −B∇{Hₘ, H_l}, as
    /// [`vanish`] finds around `y0`; without H the latter is not asked. False if there are too many
    /// noises or expressions.
    pub fn commutators(&mut self, y0: &[f64]) -> [bool; 2] {
        if !(2..=MAX_NOISES).contains(&self.noises) {
            return [self.noises < 2; 2];
        }
        let fields = self.noise_fields();
        let size = self.graph.size();
        let (mut commutators, mut defects) = (Vec::new(), Vec::new());
        for (m, f) in fields.iter().enumerate() {
            let slope = self.gradient(self.hamiltonians[m + 1]);
            for g in &fields[m + 1..] {
                let turned = if self.is_plain() {
                    Sparse::new()
                } else {
                    let bracket = dot(&mut self.graph, &slope, g);
                    let v = self.gradient(bracket);
                    self.times(&v)
                };
                let [moved, other] = [(g, f), (f, g)].map(|(f, g)| self.vector_along(f, g));
                let changed: BTreeSet<usize> =
                    [&turned, &moved, &other].into_iter().flat_map(Sparse::keys).copied().collect();
                for i in changed {
                    let zero = self.graph.constant(0.0);
                    let of = |vector: &Sparse| vector.get(&i).copied().unwrap_or(zero);
                    let [turned, moved, other] = [&turned, &moved, &other].map(of);
                    commutators.push(self.graph.sub(moved, other));
                    defects.push(self.graph.add(commutators[commutators.len() - 1], turned));
                }
                if self.graph.size() - size > MAX_EXPRESSIONS {
                    return [false; 2];
                }
            }
        }
        let [commute, holds] =
            [commutators, defects].map(|expressions| self.vanish(&expressions, y0));
        [commute, holds || self.is_plain()]
    }

    /// Whether expressions are zero around `y0`, at several times.
    fn vanish(&self, expressions: &[Id], y0: &[f64]) -> bool {
        let times = if self.depend_on_time() { &TIMES[..] } else { &TIMES[..1] };
        times.iter().all(|&t| {
            let finite = |y: &[f64]| self.numbers(expressions, y, t).iter().all(|x| x.is_finite());
            vanish(y0, finite, |y| self.numbers(expressions, y, t))
        })
    }

    /// The components that each noise moves, if its field does not depend on y.
    pub fn additive(&mut self) -> Vec<Option<Vec<usize>>> {
        let fields = self.noise_fields();
        let moved = |field: Sparse| {
            let (moved, changes): (Vec<usize>, Vec<Id>) = field.into_iter().unzip();
            self.reads(&changes).is_empty().then_some(moved)
        };
        fields.into_iter().map(moved).collect()
    }

    /// Whether the fields of noises are constant, and the second derivatives of f₀ along them zero.
    pub fn is_langevin(&mut self, y0: &[f64]) -> bool {
        if !(1..=MAX_NOISES).contains(&self.noises) {
            return false;
        }
        let fields = self.noise_fields();
        let mut all = fields.iter().flat_map(Sparse::values);
        if !all.all(|&x| self.graph.as_constant(x).is_some()) {
            return false;
        }
        let drift = self.field_of(0);
        let (size, mut bent) = (self.graph.size(), Vec::new());
        for f in &fields {
            let along = self.vector_along(&drift, f);
            for g in &fields {
                bent.extend(self.vector_along(&along, g).into_values());
            }
            if self.graph.size() - size > MAX_EXPRESSIONS {
                return false;
            }
        }
        self.vanish(&bent, y0)
    }

    /// Values of functions of y at a time, in numbers of any type.
    fn numbers<R: Real>(&self, roots: &[Id], y: &[R], t: f64) -> Vec<R> {
        self.graph.values(roots, |k| y.get(k).copied().unwrap_or(R::constant(t)))
    }

    /// B∇Hₘ of all noises.
    fn noise_fields(&mut self) -> Vec<Sparse> {
        (1..=self.noises).map(|m| self.field_of(m)).collect()
    }

    /// B∇Hₘ of one Hamiltonian, with what baths add to that of H₀; or fₘ.
    fn field_of(&mut self, m: usize) -> Sparse {
        if let Some(field) = self.fields.get(m) {
            let all = field.iter().copied().enumerate();
            return all.filter(|&(_, component)| !self.graph.is_zero(component)).collect();
        }
        let one = self.graph.constant(1.0);
        let baths = self.baths.iter().filter(|_| m == 0);
        let shifts = baths.map(|&(m, u)| (self.hamiltonians[m], u));
        let weighted: Vec<_> = once((self.hamiltonians[m], one)).chain(shifts).collect();
        let gradient = self.slopes(&weighted);
        self.times(&gradient)
    }

    /// The coordinates of momenta, as [`super::FormulaSystem::coordinates`] has them.
    pub fn coordinates(&mut self, momenta: &[usize]) -> Vec<Option<Coordinate>> {
        let slopes = self.gradient(self.hamiltonians[0]);
        let coordinate = |&p: &usize| {
            let (component, b) = self.structure[p].iter().find_map(|(&column, &above)| {
                let b = self.graph.as_constant(above)?;
                (self.structure[column].len() == 1).then_some((column, b))
            })?;
            let slope = slopes.get(&p).copied();
            let rate = slope.and_then(|slope| self.rate(slope, p));
            let mass = match rate.and_then(|rate| self.graph.as_constant(rate)) {
                Some(rate) => Ok(1.0 / (rate * b * b)),
                None => {
                    let reads = slope.map_or(BTreeSet::new(), |slope| self.reads(&[slope]));
                    Err(reads.into_iter().find(|&k| k != p))
                }
            };
            Some(Coordinate { component, mass })
        };
        momenta.iter().map(coordinate).collect()
    }

    /// The baths that are linear friction, with the component and the rate.
    pub fn friction(&mut self) -> Vec<(usize, usize, f64)> {
        let baths = self.baths.clone().into_iter().enumerate();
        let rate = |(n, (m, u)): (usize, (usize, Id))| {
            let field = self.field_of(m);
            let (&k, &noise) = field.first_key_value().filter(|_| field.len() == 1)?;
            self.graph.as_constant(noise)?;
            let drift = self.graph.mul(u, noise);
            let rate = self.rate(drift, k)?;
            Some((n, k, -self.graph.as_constant(rate)?))
        };
        baths.filter_map(rate).collect()
    }

    /// The power of heat: the change of E[H₀] in time by noises, the drift that baths give them,
    /// and friction with these rates on components, ½Σ fₘ·∇(fₘ·∇H₀) + Σ uₘ fₘ·∇H₀ − Σ γᵢyᵢ∂H₀/∂yᵢ.
    pub fn heat(&mut self, noises: &[usize], friction: &[(usize, f64)]) -> Tape {
        let slope = self.gradient(self.hamiltonians[0]);
        let mut heat = self.graph.constant(0.0);
        for &m in noises {
            let field = self.field_of(m + 1);
            let power = dot(&mut self.graph, &field, &slope);
            let bent = self.gradient(power);
            let bent = dot(&mut self.graph, &field, &bent);
            self.graph.add_to(&mut heat, bent, 0.5);
            if let Some(&(_, u)) = self.baths.iter().find(|bath| bath.0 == m + 1) {
                heat = self.graph.add_product(heat, u, power);
            }
        }
        for &(i, rate) in friction {
            let Some(&slope) = slope.get(&i) else { continue };
            let y = self.graph.input(i);
            let lost = self.graph.mul(y, slope);
            self.graph.add_to(&mut heat, lost, -rate);
        }
        self.tape(&[heat], [Y])
    }

    /// The components of B∇H₀, B∇H₁, … at y that depend on t, in a graph with t as its input.
    pub fn in_time(mut self, y: &[f64]) -> (Graph, Vec<Id>) {
        let fields: Vec<Id> =
            (0..=self.noises).flat_map(|m| self.field_of(m).into_values()).collect();
        let mut graph = Graph::new();
        let t = graph.input(0);
        let y: Vec<Id> = y.iter().map(|&y| graph.constant(y)).collect();
        let input = |k: usize| Some(y.get(k).copied().unwrap_or(t));
        let mut roots = graph.copy(Some(&self.graph), &fields, input);
        roots.retain(|&root| graph.uses(&[root], |node| node == Node::Input(0)));
        (graph, roots)
    }

    /// The equation, a text for each component: `dp = -q dt + 0.5 ∘ dW1`; those `damped` have −γy.
    pub fn equations(mut self, state: &[String], damped: &[bool]) -> Vec<String> {
        let mut fields = vec![Vec::new(); self.dimension];
        for m in 0..=self.noises {
            self.field_of(m).into_iter().for_each(|(i, field)| fields[i].push((m, field)));
        }
        let names = self.names(state);
        let equation = |(i, name): (usize, &String)| {
            let mut text = format!("d{name} =");
            for &(m, field) in &fields[i] {
                let minus = words::negated(&mut self.graph, field);
                text += match (minus, text.ends_with('=')) {
                    (Some(_), true) => " -",
                    (Some(_), false) => " - ",
                    (None, true) => " ",
                    (None, false) => " + ",
                };
                let factor = minus.unwrap_or(field);
                if self.graph.as_constant(factor) != Some(1.0) {
                    text += &(words::text(&self.graph, factor, &names, Binding::Product) + " ");
                }
                text += &if m == 0 { "dt".into() } else { format!("∘ dW{m}") };
            }
            match (damped[i], text.ends_with('=')) {
                (true, _) => text + &format!(" - γ {name} dt"),
                (false, true) => text + " 0",
                (false, false) => text,
            }
        };
        state.iter().enumerate().map(equation).collect()
    }

    /// The solution z of z = y + B((y+z)/2)v; none if B is not affine, or if it takes too many
    /// expressions.
    fn solved(&mut self, y: &[Id]) -> Option<Vec<Id>> {
        let matrix = self.cayley_matrix()?;
        let (d, zero) = (self.dimension, self.graph.constant(0.0));
        let at_zero = |k: usize| (k < d).then_some(zero);
        let constant = self.graph.copy(None, &self.field, at_zero);
        // y + ½(B(y)v + B(0)v).
        let mut right = y.to_vec();
        for (k, right) in right.iter_mut().enumerate() {
            let mut sum = self.field[k];
            self.graph.add_to(&mut sum, constant[k], 1.0);
            self.graph.add_to(right, sum, 0.5);
        }
        cayley::solve(&mut self.graph, matrix, right)
    }

    /// The columns of B, if it is affine: that of k is the field of yₖ.
    pub fn columns(&self) -> Option<Vec<Field>> {
        let above: Vec<Id> = self.structure.iter().flat_map(Sparse::values).copied().collect();
        let forms = forms(&self.graph, &above, self.dimension);
        let column = |(k, entries): (usize, &Sparse)| {
            // The entry in row i and column k, above the diagonal for i < k.
            let entry = |(&i, &above): (&usize, &Id)| {
                Some((i, forms[above].as_ref()?.times(if i < k { 1.0 } else { -1.0 })))
            };
            entries.iter().map(entry).collect()
        };
        self.structure.iter().enumerate().map(column).collect()
    }

    /// The rows of I − ½A(v), if B is affine.
    fn cayley_matrix(&mut self) -> Option<Vec<Sparse>> {
        let (columns, v) = (self.columns()?, self.inputs(V));
        let [zero, one] = [0.0, 1.0].map(|x| self.graph.constant(x));
        let mut matrix = vec![Sparse::new(); self.dimension];
        for (v, column) in v.into_iter().zip(&columns) {
            for (&i, entry) in column {
                for (&k, &slope) in &entry.slopes {
                    self.graph.add_to(matrix[i].entry(k).or_insert(zero), v, slope);
                }
            }
        }
        for (i, row) in matrix.iter_mut().enumerate() {
            row.values_mut().for_each(|entry| *entry = self.graph.scale(*entry, -0.5));
            self.graph.add_to(row.entry(i).or_insert(zero), one, 1.0);
        }
        Some(matrix)
    }

    /// The expressions of an operation, and the groups of inputs that its arguments are; none if it
    /// follows from others, or has no expression.
    pub fn of<P: Clone>(&self, op: &Op<P>) -> Option<&(Op<usize>, Vec<Id>)> {
        let op = op.clone().map(|_| ());
        self.operations.iter().find(|(known, _)| known.map(|_| ()) == op)
    }

    /// h from y, dt, dw and t.
    pub fn energy_tape(&mut self) -> Tape {
        let weights = self.weights();
        let energy = self.graph.dot(&self.hamiltonians, &weights);
        self.tape(&[energy], [Y, DT, DW, TIME])
    }

    /// Components in groups that B joins, by an entry or by what an entry reads.
    pub fn joined(&self) -> Vec<Vec<usize>> {
        if self.is_plain() {
            return vec![(0..self.dimension).collect()];
        }
        let of = |entries: &Sparse| {
            let above: Vec<Id> = entries.values().copied().collect();
            self.reads(&above).into_iter().chain(entries.keys().copied()).collect()
        };
        connected(&self.structure.iter().map(of).collect::<Vec<_>>())
    }

    /// The diagonal blocks of I − ½A(v): the number of rows, and the tape of entries row by row.
    pub fn cayley_blocks(&mut self) -> Vec<(usize, Tape)> {
        let Some(matrix) = self.cayley_matrix() else { return Vec::new() };
        let zero = self.graph.constant(0.0);
        let joined: Vec<Vec<usize>> =
            matrix.iter().map(|row| row.keys().copied().collect()).collect();
        let block = |components: Vec<usize>| {
            let row = |&i: &usize| {
                let row = &matrix[i];
                components.iter().map(move |k| row.get(k).copied().unwrap_or(zero))
            };
            let entries: Vec<Id> = components.iter().flat_map(row).collect();
            (components.len(), self.tape(&entries, [V]))
        };
        connected(&joined).into_iter().map(block).collect()
    }

    fn tape<const N: usize>(&self, roots: &[Id], groups: [usize; N]) -> Tape {
        Tape::new(&self.graph, roots, &groups.map(|group| self.group(group)))
    }
}
