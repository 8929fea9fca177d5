//! Parts of the Hamiltonians whose flows are known.
//!
//! A function of linear functions ℓᵢ(y) = aᵢ·y in involution, aᵢᵀB(y)aⱼ = 0, keeps all of them. So
//! its field Σ ∂ᵢF(ℓ) B(y)aᵢ is a sum of commuting fields with constant weights, each affine in y
//! if B is: kicks, turns about an axis, and boosts. A pair of vectors under so(3) whose product is
//! the Hamiltonian turns about its sum. For any B, a field that changes nothing that it reads is a
//! kick, and one that multiplies components by what it does not change is a growth. Terms of none
//! of these forms are one part, whose steps preserve its energy.

use std::{cmp::Ordering, collections::BTreeSet, slice::from_ref};

use super::expressions::Expressions;
use expression::{Affine, Binary, Graph, Id, Node, Unary, forms, terms};

/// Systems with more components have no parts.
const MAX_COMPONENTS: usize = 100;

/// A part: a sum of terms of the Hamiltonians that has one flow.
#[derive(Clone)]
pub struct Part {
    pub terms: Vec<Term>,
    kind: Kind,
    /// The state after the flow, from y and the weights of the Hamiltonians.
    pub flow: Vec<Id>,
}

/// Terms of one Hamiltonian, and the form of their flow.
type Single = (Vec<Term>, Kind);

/// A term of a Hamiltonian.
#[derive(Clone, Debug)]
pub struct Term {
    /// Number of the Hamiltonian.
    pub of: usize,
    pub root: Id,
    pub factor: f64,
    /// Maximal subexpressions that are linear in y, with their directions.
    functions: Vec<(Id, Affine)>,
}

/// The form of a flow.
#[derive(Clone)]
enum Kind {
    /// Functions of linear functions.
    Linear(Vec<Linear>),
    /// A quadratic function for a constant B, with its shares in the Hamiltonians.
    Quadratic { field: Linear, shares: Vec<(usize, f64)> },
    /// Products of two vectors, by their components.
    Pairs(Vec<[[usize; 3]; 2]>),
    /// A field that changes some components, those `grown` by a factor, and reads others.
    Kick { changed: BTreeSet<usize>, grown: BTreeSet<usize>, read: BTreeSet<usize> },
    /// Terms without a known flow.
    Rest,
}

/// A linear function with its field.
#[derive(Clone)]
struct Linear {
    slopes: Affine,
    /// B(y)∇ℓ.
    field: Vec<Affine>,
    blocks: Vec<Block>,
}

/// Components that a linear field couples, x′ = Kx + …, with K³ = cK.
#[derive(Clone)]
struct Block {
    components: Vec<usize>,
    /// c.
    cube: f64,
    /// K times the field.
    second: Vec<Affine>,
}

impl Part {
    /// Whether its flow is not known.
    pub fn is_rest(&self) -> bool {
        matches!(self.kind, Kind::Rest)
    }

    /// Name of the form in words.
    pub fn kind(&self) -> &'static str {
        let is = |cube: fn(f64) -> bool, all: &[Linear]| {
            all.iter().flat_map(|one| &one.blocks).any(|block| cube(block.cube))
        };
        match &self.kind {
            Kind::Pairs(_) => "turn of pairs",
            Kind::Kick { grown, .. } if grown.is_empty() => "kick",
            Kind::Kick { .. } => "growth",
            Kind::Rest => "energy-preserving step",
            Kind::Quadratic { .. } => "exact flow",
            Kind::Linear(all) if is(|cube| cube < 0.0, all) => "turn",
            Kind::Linear(all) if is(|cube| cube > 0.0, all) => "boost",
            Kind::Linear(_) => "kick",
        }
    }
}

/// The parts of the Hamiltonians, the last of which is that without a flow, or else the longest.
pub fn parts(system: &mut Expressions) -> Vec<Part> {
    if system.dimension > MAX_COMPONENTS {
        return Vec::new();
    }
    let mut found: Vec<Single> = Vec::new();
    for (group, kind) in singles(system) {
        match found.iter_mut().find_map(|(terms, known)| known.joins(&kind).then_some(terms)) {
            Some(terms) => terms.extend(group),
            None => found.push((group, kind)),
        }
    }
    let mut parts = Vec::new();
    for (terms, kind) in found {
        let flow = kind.flow(system, &terms);
        let length = match kind {
            Kind::Rest => usize::MAX,
            _ => system.graph.needed(&flow).iter().filter(|needed| **needed).count(),
        };
        parts.push((length, Part { terms, kind, flow }));
    }
    parts.sort_by_key(|(length, _)| *length);
    parts.into_iter().map(|(_, part)| part).collect()
}

/// Columns of B whose entries are affine in y: those of k are the field of yₖ.
type Columns = Vec<Vec<Affine>>;

/// Each term of the Hamiltonians with its flow; linear terms of one Hamiltonian are one, and so is
/// the product of two vectors.
fn singles(system: &mut Expressions) -> Vec<Single> {
    let columns = columns(system);
    let vectors = columns.as_ref().map_or(Vec::new(), vectors);
    let mut found = Vec::new();
    for m in 0..=system.noises {
        let mut all = all_terms(system, m);
        if let Some(columns) = &columns {
            join_linear(system, columns, m, &mut all);
            found.extend(quadratic(system, columns, m, &mut all));
            spare(system, &vectors, &mut all);
            while let Some(pair) = pair(system, &vectors, &mut all) {
                found.push(pair);
            }
        }
        for term in all {
            let linear = columns.as_ref().and_then(|columns| linear_kind(columns, &term));
            let kind = linear.or_else(|| kick(system, &term)).unwrap_or(Kind::Rest);
            found.push((vec![term], kind));
        }
    }
    found
}

/// The columns of B, if it is affine.
fn columns(system: &Expressions) -> Option<Columns> {
    let shapes = forms(&system.graph, system.dimension);
    let entry = |i: usize, k: usize| match i.cmp(&k) {
        Ordering::Less => shapes[system.structure[i][k - i - 1].index()].clone(),
        Ordering::Equal => Some(Affine::default()),
        Ordering::Greater => {
            Some(shapes[system.structure[k][i - k - 1].index()].as_ref()?.times(-1.0))
        }
    };
    let column = |k: usize| (0..system.dimension).map(|i| entry(i, k)).collect();
    (0..system.dimension).map(column).collect()
}

/// Makes one term of the linear ones of a Hamiltonian, if there are several.
fn join_linear(system: &mut Expressions, columns: &Columns, m: usize, all: &mut Vec<Term>) {
    let is_linear = |term: &Term| matches!(&term.functions[..], [(id, _)] if *id == term.root);
    let mut sum = Affine::default();
    for term in all.iter().filter(|term| is_linear(term)) {
        sum.add(term.factor, &term.functions[0].1);
    }
    if sum.slopes.len() > 1 && Linear::new(columns, sum.clone()).is_some() {
        all.retain(|term| !is_linear(term));
        let y = system.states();
        let root = sum.expression(&mut system.graph, &y);
        all.push(Term { of: m, root, factor: 1.0, functions: vec![(root, sum)] });
    }
}

/// The quadratic terms of a Hamiltonian, if B is constant and their motion is one of oscillators
/// that are not coupled; they are taken out.
fn quadratic(
    system: &mut Expressions,
    columns: &Columns,
    m: usize,
    all: &mut Vec<Term>,
) -> Option<Single> {
    if columns.iter().flatten().any(|entry| !entry.slopes.is_empty()) {
        return None;
    }
    let y: Vec<usize> = (0..system.dimension).collect();
    let degrees = system.graph.degrees(&all.iter().map(|term| term.root).collect::<Vec<_>>(), &y);
    let degree = |term: &Term| degrees[term.root.index()];
    let is_quadratic = |term: &Term| matches!(degree(term), Some(..=2));
    if !all.iter().any(|term| degree(term) == Some(2)) {
        return None;
    }
    let few: Vec<Term> = all.iter().filter(|term| is_quadratic(term)).cloned().collect();
    let weighted: Vec<(Id, Id)> =
        few.iter().map(|term| (term.root, system.graph.constant(term.factor))).collect();
    let gradient = system.graph.reverse(&weighted, &y);
    let shapes = forms(&system.graph, system.dimension);
    let mut field = vec![Affine::default(); system.dimension];
    for (slope, column) in gradient.iter().zip(columns) {
        let slope = shapes[slope.index()].as_ref()?;
        field.iter_mut().zip(column).for_each(|(sum, entry)| sum.add(entry.constant, slope));
    }
    let field = Linear { slopes: Affine::default(), blocks: blocks(&field)?, field };
    let cubes = || field.blocks.iter().map(|block| block.cube);
    if cubes().any(|cube| cube > 0.0) || !cubes().any(|cube| cube < 0.0) {
        return None;
    }
    all.retain(|term| !is_quadratic(term));
    Some((few, Kind::Quadratic { field, shares: vec![(m, 1.0)] }))
}

/// The terms of a Hamiltonian that depend on y.
fn all_terms(system: &mut Expressions, m: usize) -> Vec<Term> {
    let (mut open, mut found) = (vec![(system.hamiltonians[m], 1.0)], Vec::new());
    while let Some((root, factor)) = open.pop() {
        let one = system.graph.constant(1.0);
        for (root, weight) in terms(&mut system.graph, &[(root, one)]) {
            let graph = &system.graph;
            let factor = factor * graph.as_constant(weight).unwrap_or(1.0);
            match graph.node(root) {
                Node::Binary(Binary::Div, a, c) if graph.as_constant(c).is_some() => {
                    open.push((a, factor / graph.as_constant(c).unwrap_or(1.0)));
                }
                Node::Binary(Binary::Mul, a, b)
                    if graph.scaled(a).or(graph.scaled(b)).is_some() =>
                {
                    let [(x, c), (y, d)] = [a, b].map(|id| graph.scaled(id).unwrap_or((id, 1.0)));
                    open.push((system.graph.mul(x, y), factor * c * d));
                }
                _ => found.push((root, factor)),
            }
        }
    }
    let shapes = forms(&system.graph, system.dimension);
    let term = |(root, factor)| {
        let functions = linear_functions(&system.graph, &shapes, root);
        (!functions.is_empty()).then_some(Term { of: m, root, factor, functions })
    };
    found.into_iter().filter_map(term).collect()
}

/// The maximal subexpressions of a function that are linear in y, with their directions.
fn linear_functions(graph: &Graph, shapes: &[Option<Affine>], root: Id) -> Vec<(Id, Affine)> {
    let (mut open, mut seen, mut found) = (vec![root], BTreeSet::new(), Vec::new());
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        match &shapes[id.index()] {
            Some(form) if form.slopes.is_empty() => {}
            Some(form) => {
                found.push((id, Affine { constant: 0.0, slopes: form.slopes.clone() }));
            }
            None => open.extend(graph.node(id).operands()),
        }
    }
    found
}

/// The flow of a function of linear functions in involution, if B is affine.
fn linear_kind(columns: &Columns, term: &Term) -> Option<Kind> {
    let mut all = Kind::Linear(Vec::new());
    for (_, slopes) in &term.functions {
        let one = Kind::Linear(vec![Linear::new(columns, slopes.clone())?]);
        if !all.joins(&one) {
            return None;
        }
    }
    Some(all)
}

impl Linear {
    fn new(columns: &Columns, slopes: Affine) -> Option<Self> {
        let mut field = vec![Affine::default(); columns.len()];
        for (&k, &slope) in &slopes.slopes {
            field.iter_mut().zip(&columns[k]).for_each(|(sum, entry)| sum.add(slope, entry));
        }
        Some(Self { slopes, blocks: blocks(&field)?, field })
    }

    /// c with the field c times another.
    fn over(&self, other: &Self) -> Option<f64> {
        let moves = other.field.iter().position(|form| !form.is_zero())?;
        let ratio = self.field[moves].over(&other.field[moves])?;
        let is_multiple = |(own, other): (&Affine, &Affine)| own.is_multiple(ratio, other);
        self.field.iter().zip(&other.field).all(is_multiple).then_some(ratio)
    }

    /// Whether {ℓ, ℓ′} = 0.
    fn commutes(&self, other: &Self) -> bool {
        let mut bracket = Affine::default();
        for (&k, &slope) in &other.slopes.slopes {
            bracket.add(slope, &self.field[k]);
        }
        bracket.is_zero()
    }
}

/// The blocks of a field, if each has a closed form.
fn blocks(field: &[Affine]) -> Option<Vec<Block>> {
    let mut open: BTreeSet<usize> = (0..field.len()).filter(|&k| !field[k].is_zero()).collect();
    let changes = open.clone();
    let joined =
        |i: usize, j: usize| field[i].slopes.contains_key(&j) || field[j].slopes.contains_key(&i);
    let mut blocks = Vec::new();
    while let Some(first) = open.pop_first() {
        let (mut components, mut next) = (vec![first], 0);
        while next < components.len() {
            let more: Vec<usize> =
                open.iter().copied().filter(|&k| joined(components[next], k)).collect();
            more.iter().for_each(|k| _ = open.remove(k));
            components.extend(more);
            next += 1;
        }
        components.sort_unstable();
        // The derivative of forms along the field.
        let along = |forms: &[Affine]| -> Vec<Affine> {
            let of = |form: &Affine| {
                let mut sum = Affine::default();
                for (&k, &slope) in form.slopes.iter().filter(|(k, _)| changes.contains(k)) {
                    sum.add(slope, &field[k]);
                }
                sum
            };
            forms.iter().map(of).collect()
        };
        let own: Vec<Affine> = components.iter().map(|&k| field[k].clone()).collect();
        let second = along(&own);
        let third = along(&second);
        let cube = match third.iter().position(|form| !form.is_zero()) {
            None => 0.0,
            Some(k) => third[k].over(&own[k])?,
        };
        if !third.iter().zip(&own).all(|(third, own)| third.is_multiple(cube, own)) {
            return None;
        }
        blocks.push(Block { components, cube, second });
    }
    Some(blocks)
}

/// For each component k of a vector under so(3), on which B acts as y ↦ y × v: the vector from k
/// on.
fn vectors(columns: &Columns) -> Vec<Option<[usize; 3]>> {
    // The two components that the field of yₖ turns as y × eₖ does.
    let axis = |k: usize| {
        let field = &columns[k];
        let mut moved = (0..field.len()).filter(|&i| !field[i].is_zero());
        let (i, j, None) = (moved.next()?, moved.next()?, moved.next()) else { return None };
        let turns = |i: usize, j: usize| {
            field[i] == Affine::input(j) && field[j] == Affine::input(i).times(-1.0)
        };
        [[i, j], [j, i]].into_iter().find(|&[i, j]| turns(i, j))
    };
    let vector = |k: usize| {
        let [i, j] = axis(k)?;
        (axis(i) == Some([j, k]) && axis(j) == Some([k, i])).then_some([k, i, j])
    };
    (0..columns.len()).map(vector).collect()
}

/// Takes the middle one of three squares of a vector under so(3) from all of them: |y|² moves
/// nothing. Angles are least then, and one part less turns.
fn spare(system: &Expressions, vectors: &[Option<[usize; 3]>], all: &mut Vec<Term>) {
    let square = |all: &[Term], k: usize| {
        all.iter().position(|term| match system.graph.node(term.root) {
            Node::Power(x, 2) => system.graph.node(x) == Node::Input(k as u32),
            _ => false,
        })
    };
    for vector in vectors.iter().flatten().filter(|[k, i, j]| k < i && k < j) {
        if let [Some(a), Some(b), Some(c)] = vector.map(|k| square(all, k)) {
            let mut factors = [a, b, c].map(|n| all[n].factor);
            factors.sort_unstable_by(f64::total_cmp);
            [a, b, c].iter().for_each(|&n| all[n].factor -= factors[1]);
            all.retain(|term| term.factor != 0.0);
        }
    }
}

/// A product of two vectors of so(3) among the terms, which it takes out.
fn pair(
    system: &Expressions,
    vectors: &[Option<[usize; 3]>],
    all: &mut Vec<Term>,
) -> Option<Single> {
    let graph = &system.graph;
    let product = |i: usize, j: usize, factor: f64| {
        all.iter().position(|term| {
            let Node::Binary(Binary::Mul, a, b) = graph.node(term.root) else { return false };
            let both = [graph.node(a), graph.node(b)];
            let is = |i: usize, j: usize| both == [i, j].map(|k| Node::Input(k as u32));
            term.factor == factor && (is(i, j) || is(j, i))
        })
    };
    let found = all.iter().find_map(|term| {
        let Node::Binary(Binary::Mul, a, b) = graph.node(term.root) else { return None };
        let (Node::Input(a), Node::Input(b)) = (graph.node(a), graph.node(b)) else { return None };
        let [one, other] = [(*vectors.get(a as usize)?)?, (*vectors.get(b as usize)?)?];
        let of = |k: usize| product(one[k], other[k], term.factor);
        let places = [of(0)?, of(1)?, of(2)?];
        one.iter().all(|k| !other.contains(k)).then_some((places, [one, other]))
    });
    let (mut places, vectors) = found?;
    places.sort_unstable();
    let terms = places.into_iter().rev().map(|k| all.remove(k)).collect();
    Some((terms, Kind::Pairs(vec![vectors])))
}

/// The flow of a field that reads nothing that it changes, or multiplies what it changes.
fn kick(system: &mut Expressions, term: &Term) -> Option<Kind> {
    let field = system.field_of_term(term);
    let changed: BTreeSet<usize> =
        (0..field.len()).filter(|&k| !system.graph.is_zero(field[k])).collect();
    let (mut grown, mut read) = (BTreeSet::new(), BTreeSet::new());
    for &k in &changed {
        let mut reads = system.reads(&[field[k]]);
        if reads.contains(&k) {
            let rate = system.rate(field[k], k)?;
            reads = system.reads(&[rate]);
            grown.insert(k);
        }
        read.extend(reads);
    }
    changed.is_disjoint(&read).then_some(Kind::Kick { changed, grown, read })
}

impl Kind {
    /// Takes in another form, if the sum has a flow of this form.
    fn joins(&mut self, other: &Self) -> bool {
        match (self, other) {
            (Self::Linear(known), Self::Linear(new)) => {
                let is_new = |one: &&Linear| {
                    !known.iter().any(|known| one.slopes.over(&known.slopes).is_some())
                };
                let new: Vec<Linear> = new.iter().filter(is_new).cloned().collect();
                let commute = new.iter().all(|one| known.iter().all(|known| known.commutes(one)));
                if commute {
                    known.extend(new);
                }
                commute
            }
            (Self::Quadratic { field, shares }, Self::Quadratic { field: other, shares: more }) => {
                let Some(ratio) = other.over(field) else { return false };
                shares.extend(more.iter().map(|&(m, share)| (m, ratio * share)));
                true
            }
            (Self::Rest, Self::Rest) => true,
            (Self::Pairs(known), Self::Pairs(new)) => {
                let new: Vec<_> =
                    new.iter().filter(|pair| !known.contains(pair)).copied().collect();
                let sites: BTreeSet<usize> = known.iter().flatten().flatten().copied().collect();
                let apart = new.iter().flatten().flatten().all(|k| !sites.contains(k));
                if apart {
                    known.extend(new);
                }
                apart
            }
            (Self::Kick { changed, grown, read }, Self::Kick { changed: c, grown: g, read: r }) => {
                // No component both grows and is pushed.
                let apart = grown.intersection(c).all(|k| g.contains(k))
                    && g.intersection(changed).all(|k| grown.contains(k))
                    && changed.union(c).all(|k| !read.contains(k) && !r.contains(k));
                if apart {
                    changed.extend(c);
                    grown.extend(g);
                    read.extend(r);
                }
                apart
            }
            _ => false,
        }
    }

    /// The state after the flow.
    fn flow(&self, system: &mut Expressions, terms: &[Term]) -> Vec<Id> {
        let mut y = system.states();
        match self {
            Self::Linear(all) => {
                let angles: Vec<Id> = all.iter().map(|one| angle(system, one, terms)).collect();
                for (one, angle) in all.iter().zip(angles) {
                    one.turn(&mut system.graph, angle, &mut y);
                }
            }
            Self::Quadratic { field, shares } => {
                let time = system.weighted(shares);
                field.turn(&mut system.graph, time, &mut y);
            }
            Self::Rest => {}
            Self::Pairs(pairs) => {
                for vectors in pairs {
                    let of_pair = |term: &&Term| {
                        let reads = system.reads(&[term.root]);
                        vectors.iter().all(|vector| reads.contains(&vector[0]))
                    };
                    let terms: Vec<Term> = terms.iter().filter(of_pair).cloned().collect();
                    let time = system.weight(&terms);
                    turn_pair(&mut system.graph, time, vectors, &mut y);
                }
            }
            Self::Kick { grown, .. } => {
                let zero = system.graph.constant(0.0);
                let [mut rates, mut changes] = [(); 2].map(|()| vec![zero; y.len()]);
                for term in terms {
                    let field = system.field_of_term(term);
                    for (k, &change) in field.iter().enumerate() {
                        let rate = grown.contains(&k).then(|| system.rate(change, k)).flatten();
                        let sum = if rate.is_some() { &mut rates[k] } else { &mut changes[k] };
                        *sum = system.graph.add(*sum, rate.unwrap_or(change));
                    }
                }
                for k in 0..y.len() {
                    let factor = system.graph.unary(Unary::Exp, rates[k]);
                    let grown = system.graph.mul(y[k], factor);
                    y[k] = system.graph.add(grown, changes[k]);
                }
            }
        }
        y
    }
}

/// Turns two vectors about their sum s: a′ = a × s and b′ = b × s for a time.
fn turn_pair(graph: &mut Graph, time: Id, vectors: &[[usize; 3]; 2], y: &mut [Id]) {
    let [a, b] = vectors.map(|vector| vector.map(|k| y[k]));
    let total = [0, 1, 2].map(|k| graph.add(a[k], b[k]));
    // sin(ωt)/ω and (1 − cos ωt)/ω² with ω = |s|, which may be zero.
    let square = graph.dot(&total, &total);
    let (rate, half_time) = (graph.unary(Unary::Sqrt, square), graph.scale(time, 0.5));
    let half = graph.mul(rate, half_time);
    let [sinc, cos] = [Unary::Sinc, Unary::Cos].map(|function| graph.unary(function, half));
    let scaled = graph.mul(time, sinc);
    let (first, second) = (graph.mul(scaled, cos), graph.power(scaled, 2));
    let second = graph.scale(second, 0.5);
    for (vector, known) in vectors.iter().zip([a, b]) {
        let turned = graph.cross(&known, &total);
        let twice = graph.cross(&turned, &total);
        for k in 0..3 {
            let (one, two) = (graph.mul(turned[k], first), graph.mul(twice[k], second));
            let change = graph.add(one, two);
            y[vector[k]] = graph.add(known[k], change);
        }
    }
}

/// The weight of the field of a linear function: Σ w ∂F/∂ℓ over the terms.
fn angle(system: &mut Expressions, one: &Linear, terms: &[Term]) -> Id {
    let mut sum = system.graph.constant(0.0);
    for term in terms {
        let roots: Vec<Id> = term.functions.iter().map(|(id, _)| *id).collect();
        let weight = system.weight(from_ref(term));
        let slopes = system.graph.reverse_at(&[(term.root, weight)], &roots);
        for ((_, slopes_of), slope) in term.functions.iter().zip(slopes) {
            if let Some(share) = slopes_of.over(&one.slopes) {
                let share = system.graph.scale(slope, share);
                sum = system.graph.add(sum, share);
            }
        }
    }
    sum
}

impl Linear {
    /// Advances y by the flow of the field for a time.
    fn turn(&self, graph: &mut Graph, time: Id, y: &mut [Id]) {
        let start = y.to_vec();
        for Block { components, cube, second } in &self.blocks {
            let rate = if *cube == 0.0 { 1.0 } else { cube.abs().sqrt() };
            let angle = graph.scale(time, rate);
            let weights = by_cube(graph, angle, *cube);
            for (&k, second) in components.iter().zip(second) {
                let forms = [self.field[k].times(1.0 / rate), second.times(1.0 / (rate * rate))];
                let [first, second] = [0, 1].map(|n| {
                    let form = forms[n].expression(graph, &start);
                    graph.mul(form, weights[n])
                });
                let change = graph.add(first, second);
                y[k] = graph.add(start[k], change);
            }
        }
    }
}

/// The numbers a, b of exp(tK) = 1 + aK + bK² for K³ = cK with c = 0, −1 or 1, by the sign of
/// `cube`: t and ½t², sin t and 1 − cos t, sinh t and cosh t − 1.
fn by_cube(graph: &mut Graph, time: Id, cube: f64) -> [Id; 2] {
    let functions = match cube {
        0.0 => {
            let square = graph.power(time, 2);
            return [time, graph.scale(square, 0.5)];
        }
        ..0.0 => [Unary::Sin, Unary::Cos],
        _ => [Unary::Sinh, Unary::Cosh],
    };
    // Of half of the angle, so that nothing cancels.
    let half = graph.scale(time, 0.5);
    let [odd, even] = functions.map(|function| graph.unary(function, half));
    let twice = graph.scale(odd, 2.0);
    [graph.mul(twice, even), graph.mul(twice, odd)]
}
