//! Expressions as text.

use expression::{
    Binary::{Div, Max, Min, Mul, Sub},
    Graph, Id, Node,
    Unary::Neg,
    Values,
};

/// Parts whose text is longer are not written out: shared ones may make an endless text.
const LONGEST: usize = 160;

/// Binding strength of an expression: a sum, a product, a power or what needs no parentheses.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Binding {
    Sum,
    Product,
    Power,
    Whole,
}

/// An expression in words.
struct Words {
    text: String,
    binding: Binding,
    /// The constant, and the text of the other factors, which is empty if there are none.
    factors: (f64, String),
}

impl Words {
    /// The text, in parentheses if it binds less than `least`.
    fn within(&self, least: Binding) -> String {
        let text = &self.text;
        if self.binding < least { format!("({text})") } else { text.clone() }
    }
}

/// An expression in named inputs, in parentheses if it binds less than `least`; `…` where it is
/// long.
pub fn text(graph: &Graph, root: Id, names: &[String], least: Binding) -> String {
    use Binding::{Power, Product, Sum, Whole};
    let words = Values::new(graph.needed(&[root]), |id, words: &Values<Words>| {
        let (node, of) = (graph.node(id), |id, least| words[id].within(least));
        let factors = match node {
            Node::Constant(bits) => Some((f64::from_bits(bits), String::new())),
            Node::Unary(Neg, a) => {
                let (c, x) = &words[a].factors;
                Some((-c, x.clone()))
            }
            Node::Binary(Mul, a, b) => {
                let [(c, x), (d, y)] = [a, b].map(|id| &words[id].factors);
                let gap = if x.is_empty() || y.is_empty() { "" } else { " " };
                Some((c * d, format!("{x}{gap}{y}")))
            }
            Node::Binary(Div, a, b) => {
                let ((c, x), below) = (&words[a].factors, of(b, Power));
                Some(match x.is_empty() {
                    true => (c.signum(), format!("{}/{below}", number(c.abs()))),
                    false => (*c, format!("{x}/{below}")),
                })
            }
            _ => None,
        };
        let two = |a, b, between: &str| format!("{}{between}{}", of(a, Sum), of(b, Sum));
        let (text, binding) = match (node, &factors) {
            (_, Some(factors)) => product(factors),
            (Node::Input(k), _) => (names[k as usize].clone(), Whole),
            (Node::Unary(function, a), _) => (format!("{function}({})", of(a, Sum)), Whole),
            (Node::Binary(Min, a, b), _) => (format!("min({})", two(a, b, ", ")), Whole),
            (Node::Binary(Max, a, b), _) => (format!("max({})", two(a, b, ", ")), Whole),
            (Node::Binary(function, a, b), _) => {
                // a + b, or a − b, with the sign of b.
                let (c, x) = &words[b].factors;
                let sign = if (*c < 0.0) != (function == Sub) { " - " } else { " + " };
                let b = product(&(c.abs(), x.clone())).0;
                (format!("{}{sign}{b}", of(a, Sum)), Sum)
            }
            (Node::Power(a, n), _) => (format!("{}^{n}", of(a, Whole)), Power),
            (Node::Where([x, y, a, b]), _) => {
                (format!("(if {}: {})", two(x, y, " < "), two(a, b, " else ")), Whole)
            }
            (Node::Constant(_), None) => unreachable!("it has factors"),
        };
        let is_long = text.chars().count() > LONGEST;
        let (text, binding) = if is_long { ("(…)".into(), Whole) } else { (text, binding) };
        let mut words = Words { text, binding, factors: (1.0, String::new()) };
        words.factors =
            factors.filter(|_| !is_long).unwrap_or_else(|| (1.0, words.within(Product)));
        words
    });
    words[root].within(least)
}

/// The text of c·x from c and the text of x, which is empty if it is one.
fn product((c, x): &(f64, String)) -> (String, Binding) {
    let text = match (number(*c), &x[..]) {
        (one, "") => one,
        (one, _) if one == "1" => x.clone(),
        (minus, _) if minus == "-1" => format!("-{x}"),
        (c, _) => format!("{c} {x}"),
    };
    let binding = match x.is_empty() {
        _ if *c < 0.0 => Binding::Sum,
        true => Binding::Whole,
        false => Binding::Product,
    };
    (text, binding)
}

/// −x, if the text of x begins with a minus.
pub fn negated(graph: &mut Graph, id: Id) -> Option<Id> {
    is_negative(graph, id).then(|| graph.neg(id))
}

/// Whether the constants of a product have a negative product.
fn is_negative(graph: &Graph, id: Id) -> bool {
    match graph.node(id) {
        Node::Unary(Neg, a) => !is_negative(graph, a),
        Node::Binary(Mul, a, b) => is_negative(graph, a) != is_negative(graph, b),
        Node::Binary(Div, a, _) => is_negative(graph, a),
        _ => graph.as_constant(id).is_some_and(|c| c < 0.0),
    }
}

/// Formats a number with six digits.
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
        let short = |formula: &str| {
            let parsed = Formula::parse(formula, &names).unwrap();
            text(&parsed.graph, parsed.root, &variables, Binding::Sum)
        };
        for (formula, words) in [
            ("2*x*(0.8*y)", "1.6 x y"),
            ("x*(-0.8*y)*2", "-1.6 x y"),
            ("y + x*(-0.8*y)", "y - 0.8 x y"),
            ("y - x*(-0.8*y)", "y + 0.8 x y"),
            ("x^2 - 1", "x^2 - 1"),
            ("2*x/3", "2 x/3"),
            ("-3/(2*x*y)", "-3/(2 x y)"),
            ("(2*x*y)^2", "(2 x y)^2"),
            ("x + 2*(y - 1)", "x + 2 (y - 1)"),
        ] {
            assert_eq!(short(formula), words, "{formula}");
        }
        let long = Formula::parse(&vec!["sin(x + 0.25)"; 40].join("*y + "), &names).unwrap();
        let short = text(&long.graph, long.root, &variables, Binding::Sum);
        assert!(short.contains('…') && short.chars().count() < 200, "{short}");
    }
}
