//! Parts of the Hamiltonians whose flows are known.
//!
//! A function of linear functions ℓᵢ(y) = aᵢ·y in involution, aᵢᵀB(y)aⱼ = 0, keeps all of them. So
//! its field Σ ∂ᵢF(ℓ) B(y)aᵢ is a sum of commuting fields with constant weights, each affine in y
//! if B is: kicks, turns about an axis, and boosts. A pair of vectors under so(3) whose product is
//! the Hamiltonian turns about its sum. For any B, a field that changes nothing that it reads is a
//! kick, and one that multiplies components by what it does not change is a growth. Terms of none
//! of these forms are one part, whose steps preserve its energy.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::{expressions::Expressions, sparse::Field};
use expression::{
    Affine,
    Binary::{Div, Max, Mul},
    Graph, Id, Node,
    Unary::{Cos, Cosh, Exp, Sin, Sinc, Sinh, Sqrt},
    Weighted, forms, terms,
};

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
    Linear(Involution),
    /// A quadratic function for a constant B, with its shares in the Hamiltonians.
    Quadratic { field: Linear, shares: Vec<(usize, f64)> },
    /// Products of two vectors, by their components, which are `taken`.
    Pairs { pairs: Vec<[[usize; 3]; 2]>, taken: BTreeSet<usize> },
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
    field: Field,
    motions: Vec<Motion>,
}

/// Linear functions in involution, none a multiple of another.
#[derive(Clone, Default)]
struct Involution {
    all: Vec<Linear>,
    /// Numbers of the functions whose first slope is of a component, or whose field moves it.
    near: HashMap<usize, Vec<usize>>,
}

impl Involution {
    /// The function that this is a multiple of, and the factor.
    fn multiple(&self, slopes: &Affine) -> Option<(usize, f64)> {
        let known = self.near.get(slopes.slopes.keys().next()?)?;
        known.iter().find_map(|&n| Some((n, slopes.over(&self.all[n].slopes)?)))
    }

    /// Whether all brackets with a function are zero.
    fn commutes(&self, one: &Linear) -> bool {
        let near = one.slopes.slopes.keys().filter_map(|k| self.near.get(k)).flatten();
        BTreeSet::from_iter(near).into_iter().all(|&n| self.all[n].commutes(one))
    }

    fn push(&mut self, one: Linear) {
        let components = one.slopes.slopes.keys().take(1).chain(one.field.keys());
        for &k in components {
            self.near.entry(k).or_default().push(self.all.len());
        }
        self.all.push(one);
    }
}

/// A component x whose third derivative along the field is c times its first.
#[derive(Clone)]
struct Motion {
    component: usize,
    /// c.
    cube: f64,
    /// The second derivative of x.
    second: Affine,
}

impl Part {
    /// Whether its flow is not known.
    pub fn is_rest(&self) -> bool {
        matches!(self.kind, Kind::Rest)
    }

    /// Name of the form in words.
    pub fn kind(&self) -> &'static str {
        match &self.kind {
            Kind::Pairs { .. } => "turn of pairs",
            Kind::Kick { grown, .. } if grown.is_empty() => "kick",
            Kind::Kick { .. } => "growth",
            Kind::Rest => "energy-preserving step",
            Kind::Quadratic { .. } => "exact flow",
            Kind::Linear(known) => {
                let mut motions = known.all.iter().flat_map(|one| &one.motions);
                match motions.clone().any(|motion| motion.cube < 0.0) {
                    true => "turn",
                    false if motions.any(|motion| motion.cube > 0.0) => "boost",
                    false => "kick",
                }
            }
        }
    }
}

/// The parts of the Hamiltonians, the last of which is that without a flow, or else the longest.
pub fn parts(system: &mut Expressions) -> Vec<Part> {
    let mut found: Vec<Single> = Vec::new();
    for (group, kind) in singles(system) {
        match found.iter_mut().find_map(|(terms, known)| known.joins(&kind).then_some(terms)) {
            Some(terms) => terms.extend(group),
            None => found.push((group, kind)),
        }
    }
    let part = |(terms, kind): Single| Part { flow: kind.flow(system, &terms), terms, kind };
    let mut parts: Vec<Part> = found.into_iter().map(part).collect();
    parts.sort_by_cached_key(|part| match part.kind {
        Kind::Rest => usize::MAX,
        _ => system.graph.needed(&part.flow).len(),
    });
    parts
}

/// Each term of the Hamiltonians with its flow; linear terms of one Hamiltonian are one, and so is
/// the product of two vectors.
fn singles(system: &mut Expressions) -> Vec<Single> {
    let columns = system.columns();
    let vectors = columns.as_deref().map_or(Vec::new(), vectors);
    let mut found = Vec::new();
    for m in 0..=system.noises {
        let mut all = all_terms(system, m);
        if let Some(columns) = &columns {
            join_linear(system, columns, m, &mut all);
            found.extend(quadratic(system, columns, m, &mut all));
            spare(system, &vectors, &mut all);
            found.extend(pairs(system, &vectors, &mut all));
        }
        for term in all {
            let linear = columns.as_ref().and_then(|columns| linear_kind(columns, &term));
            let kind = linear.or_else(|| kick(system, &term)).unwrap_or(Kind::Rest);
            found.push((vec![term], kind));
        }
    }
    found
}

/// Makes one term of the linear ones of a Hamiltonian, if there are several.
fn join_linear(system: &mut Expressions, columns: &[Field], m: usize, all: &mut Vec<Term>) {
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
    columns: &[Field],
    m: usize,
    all: &mut Vec<Term>,
) -> Option<Single> {
    if columns.iter().flat_map(BTreeMap::values).any(|entry| !entry.slopes.is_empty()) {
        return None;
    }
    let roots: Vec<Id> = all.iter().map(|term| term.root).collect();
    let degrees = system.graph.degrees(&roots, |k| k < system.dimension);
    if !degrees.contains(&Some(2)) {
        return None;
    }
    let mut degrees = degrees.into_iter();
    let (few, rest): (Vec<Term>, Vec<Term>) =
        all.iter().cloned().partition(|_| matches!(degrees.next(), Some(Some(..=2))));
    let weighted: Vec<Weighted> =
        few.iter().map(|term| (term.root, system.graph.constant(term.factor))).collect();
    let gradient = system.slopes(&weighted);
    let slopes: Vec<Id> = gradient.values().copied().collect();
    let forms = forms(&system.graph, &slopes, system.dimension);
    let mut field = Field::new();
    for (k, slope) in gradient {
        let slope = forms[slope].as_ref()?;
        for (&i, entry) in &columns[k] {
            field.entry(i).or_default().add(entry.constant, slope);
        }
    }
    let field = Linear::with_field(Affine::default(), field)?;
    let cubes = || field.motions.iter().map(|motion| motion.cube);
    if cubes().any(|cube| cube > 0.0) || !cubes().any(|cube| cube < 0.0) {
        return None;
    }
    *all = rest;
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
                Node::Binary(Div, a, c) if graph.as_constant(c).is_some() => {
                    open.extend(graph.as_constant(c).map(|c| (a, factor / c)));
                }
                Node::Binary(Mul, a, b) if graph.scaled(a).or(graph.scaled(b)).is_some() => {
                    let [(x, c), (y, d)] = [a, b].map(|id| graph.scaled(id).unwrap_or((id, 1.0)));
                    open.push((system.graph.mul(x, y), factor * c * d));
                }
                _ => found.push((root, factor)),
            }
        }
    }
    let term = |(root, factor)| {
        let functions = linear_functions(&system.graph, root, system.dimension);
        (!functions.is_empty()).then_some(Term { of: m, root, factor, functions })
    };
    found.into_iter().filter_map(term).collect()
}

/// The maximal subexpressions of a function that are linear in y, with their directions.
fn linear_functions(graph: &Graph, root: Id, dimension: usize) -> Vec<(Id, Affine)> {
    let forms = forms(graph, &[root], dimension);
    let (mut open, mut seen, mut found) = (vec![root], BTreeSet::new(), Vec::new());
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        match &forms[id] {
            Some(form) if form.slopes.is_empty() => {}
            Some(form) => found.push((id, Affine { constant: 0.0, ..form.clone() })),
            None => open.extend(graph.node(id).operands()),
        }
    }
    found
}

/// The flow of a function of linear functions in involution, if B is affine.
fn linear_kind(columns: &[Field], term: &Term) -> Option<Kind> {
    let mut all = Involution::default();
    for (_, slopes) in &term.functions {
        if all.multiple(slopes).is_none() {
            let one = Linear::new(columns, slopes.clone())?;
            if !all.commutes(&one) {
                return None;
            }
            all.push(one);
        }
    }
    Some(Kind::Linear(all))
}

impl Linear {
    fn new(columns: &[Field], slopes: Affine) -> Option<Self> {
        let mut field = Field::new();
        for (&k, &slope) in &slopes.slopes {
            for (&i, form) in &columns[k] {
                field.entry(i).or_default().add(slope, form);
            }
        }
        Self::with_field(slopes, field)
    }

    fn with_field(slopes: Affine, mut field: Field) -> Option<Self> {
        field.retain(|_, form| !form.is_zero());
        Some(Self { slopes, motions: motions(&field)?, field })
    }

    /// c with the field c times another.
    fn over(&self, other: &Self) -> Option<f64> {
        let (k, form) = other.field.iter().next()?;
        let ratio = self.field.get(k)?.over(form)?;
        let is_multiple = |(form, of): (&Affine, &Affine)| form.is_multiple(ratio, of);
        let same = self.field.keys().eq(other.field.keys());
        (same && self.field.values().zip(other.field.values()).all(is_multiple)).then_some(ratio)
    }

    /// Whether {ℓ, ℓ′} = 0.
    fn commutes(&self, other: &Self) -> bool {
        along(&other.slopes, &self.field).is_zero()
    }

    /// Advances y by the flow of the field for a time.
    fn turn(&self, graph: &mut Graph, time: Id, y: &mut [Id]) {
        let start = y.to_vec();
        for Motion { component: k, cube, second } in &self.motions {
            let rate = if *cube == 0.0 { 1.0 } else { cube.abs().sqrt() };
            let angle = graph.scale(time, rate);
            let [odd, even] = by_cube(graph, angle, *cube);
            let forms = [self.field[k].times(1.0 / rate), second.times(1.0 / (rate * rate))];
            let [first, second] = forms.map(|form| form.expression(graph, &start));
            let change = graph.mul(first, odd);
            let change = graph.add_product(change, second, even);
            y[*k] = graph.add(start[*k], change);
        }
    }
}

/// The motion of each component, if it has a closed form.
fn motions(field: &Field) -> Option<Vec<Motion>> {
    let mut motions: Vec<Motion> = Vec::new();
    for (&component, first) in field {
        let second = along(first, field);
        let third = along(&second, field);
        // That of the component before saves a sine and a cosine.
        let known = motions.last().map(|known| known.cube);
        let known = known.filter(|&cube| third.is_multiple(cube, first));
        let cube = if third.is_zero() { 0.0 } else { known.or(third.over(first))? };
        motions.push(Motion { component, cube, second });
    }
    Some(motions)
}

/// The derivative of a form along a field.
fn along(form: &Affine, field: &Field) -> Affine {
    let mut sum = Affine::default();
    for (k, &slope) in &form.slopes {
        field.get(k).into_iter().for_each(|field| sum.add(slope, field));
    }
    sum
}

/// For each component k of a vector under so(3), on which B acts as y ↦ y × v: the vector from k
/// on.
fn vectors(columns: &[Field]) -> Vec<Option<[usize; 3]>> {
    // The two components that the field of yₖ turns as y × eₖ does.
    let axis = |k: usize| {
        let [(&i, one), (&j, other)] = Vec::from_iter(&columns[k])[..] else { return None };
        let is = |form: &Affine, k: usize, sign: f64| *form == Affine::input(k).times(sign);
        let turns = |sign: f64| is(one, j, sign) && is(other, i, -sign);
        if turns(1.0) { Some([i, j]) } else { turns(-1.0).then_some([j, i]) }
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
    let square = |(n, term): (usize, &Term)| match system.graph.node(term.root) {
        Node::Power(x, 2) => Some((system.component(x)?, n)),
        _ => None,
    };
    let squares: HashMap<usize, usize> = all.iter().enumerate().filter_map(square).collect();
    for vector in vectors.iter().flatten().filter(|[k, i, j]| k < i && k < j) {
        if let [Some(a), Some(b), Some(c)] = vector.map(|k| squares.get(&k).copied()) {
            let mut factors = [a, b, c].map(|n| all[n].factor);
            factors.sort_unstable_by(f64::total_cmp);
            [a, b, c].iter().for_each(|&n| all[n].factor -= factors[1]);
        }
    }
    all.retain(|term| term.factor != 0.0);
}

/// The products of two vectors of so(3) among the terms, which it takes out.
fn pairs(system: &Expressions, vectors: &[Option<[usize; 3]>], all: &mut Vec<Term>) -> Vec<Single> {
    let places: HashMap<[usize; 2], usize> =
        all.iter().enumerate().filter_map(|(n, term)| Some((product(system, term)?, n))).collect();
    let (mut found, mut taken) = (Vec::new(), BTreeSet::new());
    for term in all.iter() {
        let pair = || {
            let vectors = product(system, term)?.map(|k| vectors[k]);
            let [Some(one), Some(other)] = vectors else { return None };
            let of = |k: usize| {
                let mut both = [one[k], other[k]];
                both.sort_unstable();
                places.get(&both).copied()
            };
            let terms = [of(0)?, of(1)?, of(2)?];
            let is_pair =
                terms.iter().all(|&n| all[n].factor == term.factor && !taken.contains(&n))
                    && one.iter().all(|k| !other.contains(k));
            is_pair.then_some((terms, [one, other]))
        };
        if let Some((terms, vectors)) = pair() {
            taken.extend(terms);
            let components = vectors.iter().flatten().copied().collect();
            let kind = Kind::Pairs { pairs: vec![vectors], taken: components };
            found.push((terms.map(|n| all[n].clone()).to_vec(), kind));
        }
    }
    let mut n = 0..;
    all.retain(|_| !n.next().is_some_and(|n| taken.contains(&n)));
    found
}

/// The components, in their order, whose product a term is.
fn product(system: &Expressions, term: &Term) -> Option<[usize; 2]> {
    let Node::Binary(Mul, a, b) = system.graph.node(term.root) else { return None };
    let mut both = [system.component(a)?, system.component(b)?];
    both.sort_unstable();
    Some(both)
}

/// The flow of a field that reads nothing that it changes, or multiplies what it changes.
fn kick(system: &mut Expressions, term: &Term) -> Option<Kind> {
    let field = system.field_of_term(term);
    let changed: BTreeSet<usize> = field.keys().copied().collect();
    let (mut grown, mut read) = (BTreeSet::new(), BTreeSet::new());
    for (k, change) in field {
        let mut reads = system.reads(&[change]);
        if reads.contains(&k) {
            let rate = system.rate(change, k)?;
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
                let is_new = |one: &&Linear| known.multiple(&one.slopes).is_none();
                let new: Vec<&Linear> = new.all.iter().filter(is_new).collect();
                let commute = new.iter().all(|one| known.commutes(one));
                if commute {
                    new.into_iter().for_each(|one| known.push(one.clone()));
                }
                commute
            }
            (Self::Quadratic { field, shares }, Self::Quadratic { field: other, shares: more }) => {
                let Some(ratio) = other.over(field) else { return false };
                shares.extend(more.iter().map(|&(m, share)| (m, ratio * share)));
                true
            }
            (Self::Rest, Self::Rest) => true,
            (Self::Pairs { pairs, taken }, Self::Pairs { pairs: new, taken: t }) => {
                let is_known = new.iter().all(|pair| pairs.contains(pair));
                let apart = taken.is_disjoint(t);
                if !is_known && apart {
                    pairs.extend(new);
                    taken.extend(t);
                }
                is_known || apart
            }
            (Self::Kick { changed, grown, read }, Self::Kick { changed: c, grown: g, read: r }) => {
                // No component both grows and is pushed.
                let apart = changed.is_disjoint(r)
                    && c.is_disjoint(read)
                    && c.intersection(changed).all(|k| grown.contains(k) == g.contains(k));
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
            Self::Linear(known) => {
                let angles = angles(system, known, terms);
                for (one, angle) in known.all.iter().zip(angles) {
                    one.turn(&mut system.graph, angle, &mut y);
                }
            }
            Self::Quadratic { field, shares } => {
                let time = system.weighted(shares);
                field.turn(&mut system.graph, time, &mut y);
            }
            Self::Rest => {}
            Self::Pairs { pairs, .. } => {
                let mut of: HashMap<_, Vec<_>> = HashMap::new();
                for term in terms {
                    of.entry(product(system, term)).or_default().push((term.of, term.factor));
                }
                for vectors in pairs {
                    let mut first = vectors.map(|vector| vector[0]);
                    first.sort_unstable();
                    let time = system.weighted(&of[&Some(first)]);
                    turn_pair(&mut system.graph, time, vectors, &mut y);
                }
            }
            Self::Kick { grown, .. } => {
                let zero = system.graph.constant(0.0);
                let [mut rates, mut changes] = [(); 2].map(|()| vec![zero; y.len()]);
                for term in terms {
                    for (k, change) in system.field_of_term(term) {
                        let rate = grown.contains(&k).then(|| system.rate(change, k)).flatten();
                        let sum = if rate.is_some() { &mut rates[k] } else { &mut changes[k] };
                        *sum = system.graph.add(*sum, rate.unwrap_or(change));
                    }
                }
                for k in 0..y.len() {
                    let factor = system.graph.unary(Exp, rates[k]);
                    y[k] = system.graph.add_product(changes[k], y[k], factor);
                }
            }
        }
        y
    }
}

/// Turns two vectors about their sum s: a′ = a × s and b′ = b × s for a time. Each gets its length
/// back, since rounding errors of the same angles would add up.
fn turn_pair(graph: &mut Graph, time: Id, vectors: &[[usize; 3]; 2], y: &mut [Id]) {
    let [a, b] = vectors.map(|vector| vector.map(|k| y[k]));
    let total = [0, 1, 2].map(|k| graph.add(a[k], b[k]));
    // sin(ωt)/ω and (1 − cos ωt)/ω² with ω = |s|, which may be zero.
    let square = graph.dot(&total, &total);
    let (rate, half_time) = (graph.unary(Sqrt, square), graph.scale(time, 0.5));
    let half = graph.mul(rate, half_time);
    let [sinc, cos] = [Sinc, Cos].map(|function| graph.unary(function, half));
    let scaled = graph.mul(time, sinc);
    let (first, second) = (graph.mul(scaled, cos), graph.power(scaled, 2));
    let second = graph.scale(second, 0.5);
    for (vector, known) in vectors.iter().zip([a, b]) {
        let turned = graph.cross(&known, &total);
        let twice = graph.cross(&turned, &total);
        let moved = [0, 1, 2].map(|k| {
            let change = graph.mul(turned[k], first);
            let change = graph.add_product(change, twice[k], second);
            graph.add(known[k], change)
        });
        // 1 + ½(|a|² − |a′|²)/|a|², and 1 where a is zero.
        let [before, after] = [known, moved].map(|vector| graph.dot(&vector, &vector));
        let (lost, least) = (graph.sub(before, after), graph.constant(f64::MIN_POSITIVE));
        let before = graph.binary(Max, before, least);
        let share = graph.div(lost, before);
        let share = graph.scale(share, 0.5);
        for k in 0..3 {
            y[vector[k]] = graph.add_product(moved[k], moved[k], share);
        }
    }
}

/// The weights of the fields of linear functions: Σ w ∂F/∂ℓ over the terms.
fn angles(system: &mut Expressions, known: &Involution, terms: &[Term]) -> Vec<Id> {
    let mut sums = vec![system.graph.constant(0.0); known.all.len()];
    for term in terms {
        let roots: Vec<Id> = term.functions.iter().map(|(id, _)| *id).collect();
        let weight = system.weighted(&[(term.of, term.factor)]);
        let slopes = system.graph.reverse_at(&[(term.root, weight)], &roots);
        for ((_, function), slope) in term.functions.iter().zip(slopes) {
            if let Some((n, share)) = known.multiple(function) {
                system.graph.add_to(&mut sums[n], slope, share);
            }
        }
    }
    sums
}

/// The numbers a, b of exp(tK) = 1 + aK + bK² for K³ = cK with c = 0, −1 or 1, by the sign of
/// `cube`: t and ½t², sin t and 1 − cos t, sinh t and cosh t − 1.
fn by_cube(graph: &mut Graph, time: Id, cube: f64) -> [Id; 2] {
    let functions = match cube {
        0.0 => {
            let square = graph.power(time, 2);
            return [time, graph.scale(square, 0.5)];
        }
        ..0.0 => [Sin, Cos],
        _ => [Sinh, Cosh],
    };
    // Of half of the angle, so that nothing cancels.
    let half = graph.scale(time, 0.5);
    let [odd, even] = functions.map(|function| graph.unary(function, half));
    [even, odd].map(|other| {
        let product = graph.mul(odd, other);
        graph.scale(product, 2.0)
    })
}
