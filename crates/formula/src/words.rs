//! Expressions as text.

use crate::{
    Graph, Id,
    graph::{Binary, Node, Unary},
};

/// A text longer than this is not read by anyone.
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
pub fn text(graph: &Graph, id: Id, names: &[String], least: Binding) -> String {
    let words = Words { graph, names };
    match words.write(id, least, LONGEST as isize) {
        Some(text) if text.chars().count() <= LONGEST => text,
        _ => "(…)".into(),
    }
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

struct Words<'a> {
    graph: &'a Graph,
    names: &'a [String],
}

impl Words<'_> {
    /// None if it is longer than `room`: shared subexpressions may make an endless text.
    fn write(&self, id: Id, least: Binding, room: isize) -> Option<String> {
        if room < 0 {
            return None;
        }
        let of = |id, least| self.write(id, least, room - 2);
        let two = |a, b, sign: &str, least: [Binding; 2]| {
            let first = of(a, least[0])?;
            let second = self.write(b, least[1], room - first.len() as isize)?;
            Some(format!("{first}{sign}{second}"))
        };
        use Binding::{Power, Product, Sum, Whole};
        let (text, binding) = match self.graph.node(id) {
            Node::Constant(bits) => {
                let text = number(f64::from_bits(bits));
                let binding = if text.starts_with('-') { Sum } else { Whole };
                (text, binding)
            }
            Node::Input(k) => (self.names.get(k as usize)?.clone(), Whole),
            Node::Unary(Unary::Neg, a) => (format!("-{}", of(a, Product)?), Sum),
            Node::Unary(function, a) => (format!("{function}({})", of(a, Sum)?), Whole),
            Node::Binary(Binary::Add, a, b) => (two(a, b, " + ", [Sum, Product])?, Sum),
            Node::Binary(Binary::Sub, a, b) => (two(a, b, " - ", [Sum, Product])?, Sum),
            Node::Binary(Binary::Mul, a, b) => match self.graph.as_constant(b) {
                Some(c) if c < 0.0 => (two(b, a, " ", [Sum, Product])?, Sum),
                Some(_) => (two(b, a, " ", [Product, Product])?, Product),
                None => (two(a, b, " ", [Product, Product])?, Product),
            },
            Node::Binary(Binary::Div, a, b) => (two(a, b, "/", [Product, Power])?, Product),
            Node::Binary(function @ (Binary::Min | Binary::Max), a, b) => {
                let name = if function == Binary::Min { "min" } else { "max" };
                (format!("{name}({})", two(a, b, ", ", [Sum, Sum])?), Whole)
            }
            Node::Power(a, n) => (format!("{}^{n}", of(a, Whole)?), Power),
            Node::Where([x, y, a, b]) => {
                let (condition, cases) =
                    (two(x, y, " < ", [Sum, Sum])?, two(a, b, " else ", [Sum, Sum])?);
                (format!("(if {condition}: {cases})"), Whole)
            }
        };
        Some(if binding < least { format!("({text})") } else { text })
    }
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
            let text = text(parsed.graph(), parsed.root(), &variables, Binding::Sum);
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
        assert_eq!(text(long.graph(), long.root(), &variables, Binding::Sum), "(…)");
    }
}
