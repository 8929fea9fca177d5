//! The curves of a panel: the schemes of the paper, and further ones.

use schemes::{EulerMaruyama, Midpoint, Scheme, Sexp, SexpLi};
use systems::{Problem, paper::valid};

use crate::{Conditions, Method, PaperSystem, compiled};

/// A scheme with the name of its curve.
pub struct Curve<S, const D: usize, const M: usize> {
    pub name: &'static str,
    pub method: Method,
    pub scheme: Box<dyn Scheme<S, D, M>>,
}

impl<S, const D: usize, const M: usize> Curve<S, D, M> {
    pub fn new(method: Method, scheme: Box<dyn Scheme<S, D, M>>) -> Self {
        Self { name: method.id(), method, scheme }
    }
}

/// The schemes of the paper in the order of its legends, then those without iteration that are
/// wanted and are for this system.
pub fn curves<S: PaperSystem<D, M>, G, const D: usize, const M: usize>(
    conditions: &Conditions,
    problem: &Problem<S, G, D>,
) -> Vec<Curve<S, D, M>> {
    let mut curves = vec![
        Curve::new(Method::Sexp, compiled(Sexp)),
        Curve::new(Method::EulerMaruyama, compiled(EulerMaruyama)),
        Curve::new(Method::Midpoint, compiled(Midpoint)),
    ];
    curves.extend(without_iteration(conditions.further, problem));
    curves
}

/// The schemes without iteration among `methods` that are for this system.
pub fn without_iteration<S: PaperSystem<D, M>, G, const D: usize, const M: usize>(
    methods: &[Method],
    problem: &Problem<S, G, D>,
) -> Vec<Curve<S, D, M>> {
    let scheme = |method: &Method| match method {
        Method::SexpLi => Some(compiled(valid(SexpLi::new(problem.system(), problem.y0())))),
        Method::Split => S::by_parts().map(|[split, _]| split),
        _ => None,
    };
    let curve = |method: &Method| Some(Curve::new(*method, scheme(method)?));
    methods.iter().filter_map(curve).collect()
}
