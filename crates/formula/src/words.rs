//! Expressions as text.

use crate::{
    Graph, Id,
    graph::{Binary, Node, Unary},
};

/// Parts whose text is longer are not written out: shared ones may make an endless text.
const LONGEST: usize = 160;

/// How tightly an expression binds: a sum, a product, a power or what needs no parentheses.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Binding {
    Sum,
    Product,
    Power,
    Whole,
}

/// An expression in named inputs, in parentheses if it binds less than `least`; `…` where it is
/// long.
pub fn text(graph: &Graph, root: Id, names: &[String], least: Binding) -> String {
    use Binding::{Power, Product, Sum, Whole};
    let needed = graph.needed(&[root]);
    let mut texts = vec![(String::new(), Whole); graph.len()];
    let write = |texts: &[(String, Binding)], id: Id, least: Binding| {
        let (text, binding) = &texts[id.index()];
        if *binding < least { format!("({text})") } else { text.clone() }
    };
    for id in graph.ids().filter(|id| needed[id.index()]) {
        let of = |id, least| write(&texts, id, least);
        let two = |a, b, sign: &str, [first, second]: [Binding; 2]| {
            format!("{}{sign}{}", of(a, first), of(b, second))
        };
        let (text, binding) = match graph.node(id) {
            Node::Constant(bits) => {
                let text = number(f64::from_bits(bits));
                let binding = if text.starts_with('-') { Sum } else { Whole };
                (text, binding)
            }
            Node::Input(k) => (names[k as usize].clone(), Whole),
            Node::Unary(Unary::Neg, a) => (format!("-{}", of(a, Product)), Sum),
            Node::Unary(function, a) => (format!("{function}({})", of(a, Sum)), Whole),
            Node::Binary(Binary::Add, a, b) => (two(a, b, " + ", [Sum, Product]), Sum),
            Node::Binary(Binary::Sub, a, b) => (two(a, b, " - ", [Sum, Product]), Sum),
            Node::Binary(Binary::Mul, a, b) => match graph.as_constant(b) {
                Some(c) if c < 0.0 => (two(b, a, " ", [Sum, Product]), Sum),
                Some(_) => (two(b, a, " ", [Product; 2]), Product),
                None => (two(a, b, " ", [Product; 2]), Product),
            },
            Node::Binary(Binary::Div, a, b) => (two(a, b, "/", [Product, Power]), Product),
            Node::Binary(Binary::Min, a, b) => {
                (format!("min({})", two(a, b, ", ", [Sum; 2])), Whole)
            }
            Node::Binary(Binary::Max, a, b) => {
                (format!("max({})", two(a, b, ", ", [Sum; 2])), Whole)
            }
            Node::Power(a, n) => (format!("{}^{n}", of(a, Whole)), Power),
            Node::Where([x, y, a, b]) => {
                let condition = two(x, y, " < ", [Sum; 2]);
                (format!("(if {condition}: {})", two(a, b, " else ", [Sum; 2])), Whole)
            }
        };
        let is_long = text.chars().count() > LONGEST;
        texts[id.index()] = if is_long { ("(…)".into(), Whole) } else { (text, binding) };
    }
    write(&texts, root, least)
}

/// x, if the expression is −x or c·x with c < 0, without its sign.
pub fn negated(graph: &mut Graph, id: Id) -> Option<Id> {
    let negative = match graph.node(id) {
        Node::Unary(Unary::Neg, _) => true,
        Node::Binary(Binary::Mul, _, c) => graph.as_constant(c).is_some_and(|c| c < 0.0),
        _ => graph.as_constant(id).is_some_and(|c| c < 0.0),
    };
    negative.then(|| graph.neg(id))
}

/// Six digits.
fn number(x: f64) -> String {
    let digits = format!("{x:.5e}").parse().unwrap_or(x);
    match x.abs() {
        0.0 | 1e-4..1e6 => format!("{digits}"),
        _ => format!("{digits:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Formula, Names};

    #[test]
    fn a_text_means_its_formula() {
        let variables = ["x".to_owned(), "y".to_owned()];
        let mut names = Names::with_variables(&variables).unwrap();
        names.parameter("k", 0.5).unwrap();
        for formula in [
            "x + y*k",
            "-(x - y)^3/(1 + x^2)",
            "k*(x - y)*(x + y)",
            "exp(-x)*sin(y)/(x*y)",
            "-3*x",
            "max(x, -y) - min(2, y)",
            "x - (y - 1)",
            "2 - (x + y)",
            "x/(y/3)",
            "(x + y)^2*1e-9",
            "abs(x)*y",
            "1e300*x",
            "x/y/(x + 2)",
            "-x^2",
            "(-x)^3",
            "5 - -x",
        ] {
            let parsed = Formula::parse(formula, &names).unwrap();
            let text = text(&parsed.graph, parsed.root, &variables, Binding::Sum);
            // A product is written without a sign.
            let spoken = text.replace(" + ", "+").replace(" - ", "-").replace(", ", ",");
            let again = Formula::parse(&spoken.replace(' ', "*"), &names);
            let again = again.unwrap_or_else(|error| panic!("{formula}: {text}: {error}"));
            for at in [[0.7, 1.3], [-1.1, 0.4]] {
                let (one, other) = (parsed.value(&at), again.value(&at));
                assert!((one - other).abs() <= 1e-5 * one.abs(), "{formula}: {text}");
            }
        }
        let long = Formula::parse(&vec!["sin(x + 0.25)"; 40].join("*y + "), &names).unwrap();
        let short = text(&long.graph, long.root, &variables, Binding::Sum);
        assert!(short.contains('…') && short.chars().count() < 200, "{short}");
    }
}
