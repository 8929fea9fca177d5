//! From text to a graph, by the grammar in `formula.pest`.

use std::{ops::Range, sync::LazyLock};

use pest::{
    Parser,
    error::InputLocation,
    iterators::{Pair, Pairs},
    pratt_parser::{Assoc, Op, PrattParser},
};

use crate::{
    FormulaError, Id, Names,
    error::short,
    graph::{Binary, Graph, Unary},
    names::{self, Meaning},
};

/// The largest length of a text in bytes.
pub const MAX_BYTES: usize = 100_000;

/// The deepest nesting: open brackets, with a chain of signs and powers in each. It bounds the
/// recursion of the parser; everything after it is a loop.
pub const MAX_DEPTH: usize = 64;

#[allow(missing_docs)]
mod grammar {
    #[derive(pest_derive::Parser)]
    #[grammar = "formula.pest"]
    pub struct Grammar;
}
use grammar::{Grammar, Rule};

/// From the weakest to the strongest: sums, products, signs, powers. So −x² is −(x²), 2^−x is
/// 2^(−x) and a^b^c is a^(b^c).
static PRECEDENCES: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    PrattParser::new()
        .op(Op::infix(Rule::add, Assoc::Left) | Op::infix(Rule::subtract, Assoc::Left))
        .op(Op::infix(Rule::multiply, Assoc::Left) | Op::infix(Rule::divide, Assoc::Left))
        .op(Op::prefix(Rule::negative) | Op::prefix(Rule::positive))
        .op(Op::infix(Rule::power, Assoc::Right))
});

/// Whether `text` is a name.
pub(crate) fn is_name(text: &str) -> bool {
    Grammar::parse(Rule::name, text).is_ok_and(|pairs| pairs.as_str() == text)
}

/// Adds the expression that the text means to a graph, with the variables as inputs.
///
/// # Errors
/// [`FormulaError`] with the place in the text and what would be right.
pub fn parse(text: &str, names: &Names, graph: &mut Graph) -> Result<Id, FormulaError> {
    let bytes = text.len();
    if bytes > MAX_BYTES {
        let message = format!("the formula has {bytes} bytes, and at most {MAX_BYTES} are allowed");
        return Err(FormulaError::new(message, text, 0..0));
    }
    if text.trim().is_empty() {
        let message = "the formula is empty: write a number or an expression";
        return Err(FormulaError::new(message, text, 0..0));
    }
    brackets(text)?;
    match Grammar::parse(Rule::formula, text) {
        Ok(mut pairs) => {
            let mut builder = Builder { text, names, graph };
            let expression = pairs.next().unwrap_or_else(|| unreachable!("there is a formula"));
            builder.expression(expression.into_inner(), 0).map(|(id, _)| id)
        }
        Err(error) => {
            let at = match error.location {
                InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
            };
            Err(syntax_error(text, at))
        }
    }
}

/// Checks that brackets are in pairs and not too deep, before the parser follows them.
fn brackets(text: &str) -> Result<(), FormulaError> {
    let mut open = Vec::new();
    for (at, c) in text.char_indices() {
        let message = match c {
            '(' if open.len() == MAX_DEPTH => too_deep(),
            ')' if open.pop().is_none() => {
                "this bracket was not opened: remove it or write `(` before it".into()
            }
            '(' => {
                open.push(at);
                continue;
            }
            _ => continue,
        };
        return Err(FormulaError::new(message, text, at..at + 1));
    }
    match open.last() {
        Some(&at) => {
            let message = "this bracket is not closed: `)` is missing";
            Err(FormulaError::new(message, text, at..at + 1))
        }
        None => Ok(()),
    }
}

/// The token that starts `text`: a number, a name or one character.
fn first_token(text: &str) -> Option<&str> {
    let long = [Rule::number, Rule::name];
    let long = long.iter().find_map(|&rule| Grammar::parse(rule, text).ok());
    match long {
        Some(pairs) => Some(pairs.as_str()),
        None => text.chars().next().map(|c| &text[..c.len_utf8()]),
    }
}

/// Whether a number or a name may have the character.
fn is_word(c: char) -> bool {
    c.is_alphabetic() || c.is_ascii_digit() || matches!(c, '_' | '.')
}

/// The number or name that ends `text`, or its last character.
fn last_token(text: &str) -> Option<&str> {
    let word = text.trim_end_matches(is_word);
    if word.len() < text.len() {
        return Some(&text[word.len()..]);
    }
    text.char_indices().next_back().map(|(at, _)| &text[at..])
}

/// Characters that other languages and typesetters have.
fn instead_of(c: char) -> Option<&'static str> {
    Some(match c {
        '−' | '–' => "-",
        '·' | '×' | '⋅' | '∗' => "*",
        '÷' => "/",
        '²' => "^2",
        '³' => "^3",
        '√' => "sqrt(…)",
        '[' | '{' => "(",
        ']' | '}' => ")",
        ';' => ",",
        _ => return None,
    })
}

/// The error at the byte where the grammar did not go on.
fn syntax_error(text: &str, at: usize) -> FormulaError {
    let rest = text[at..].trim_start();
    let at = text.len() - rest.len();
    let before = text[..at].trim_end();
    let Some(token) = first_token(rest) else {
        return FormulaError::new(format!("{MISSING} at the end"), text, at..at);
    };
    let mut span = at..at + token.len();
    let found = token.chars().next().unwrap_or_default();
    let starts_operand = |c: char| is_word(c) || c == '(';
    let after_operand = before.chars().next_back().is_some_and(|c| is_word(c) || c == ')');
    let is_strange = !(starts_operand(found) || "+-*/^,)".contains(found));
    let message = if found == '*' && before.ends_with('*') {
        "unknown operator: write ^ for a power".into()
    } else if after_operand && starts_operand(found) && !is_strange {
        let last = last_token(before).unwrap_or_default();
        if names::is_function(last) {
            span = before.len() - last.len()..before.len();
            no_arguments(last)
        } else {
            let shown = |word: &str| match word {
                "(" | ")" => "(…)".to_owned(),
                _ if word.chars().count() > 20 => "…".to_owned(),
                _ => word.to_owned(),
            };
            format!("an operator is missing: write {}*{}", shown(last), shown(token))
        }
    } else if after_operand && found == ',' {
        "a comma stands only between arguments of min and max; decimals have a point".into()
    } else if is_strange || found == '.' {
        let hint = instead_of(found).map_or(String::new(), |write| format!(": write `{write}`"));
        format!("unexpected character `{}`{hint}", found.escape_debug())
    } else {
        format!("{MISSING} before `{}`", short(token))
    };
    FormulaError::new(message, text, span)
}

const MISSING: &str = "a number, a name or a bracket is missing";

fn too_deep() -> String {
    format!("brackets, signs and powers are nested deeper than {MAX_DEPTH}")
}

fn no_arguments(function: &str) -> String {
    format!("`{function}` is a function: write {function}(…)")
}

fn unknown(what: &str, name: &str, nearest: Option<String>) -> String {
    let hint = nearest.map_or(String::new(), |nearest| format!("; the nearest is `{nearest}`"));
    format!("unknown {what} `{}`{hint}", short(name))
}

struct Builder<'a> {
    text: &'a str,
    names: &'a Names,
    graph: &'a mut Graph,
}

/// An expression and its place in the text.
type Placed = (Id, Range<usize>);

fn place(pair: &Pair<'_, Rule>) -> Range<usize> {
    pair.as_span().start()..pair.as_span().end()
}

impl Builder<'_> {
    fn error<T>(&self, message: String, span: Range<usize>) -> Result<T, FormulaError> {
        Err(FormulaError::new(message, self.text, span))
    }

    /// The expression of operands and operators in an expression nested in `depth` others.
    fn expression(&mut self, pairs: Pairs<'_, Rule>, depth: usize) -> Result<Placed, FormulaError> {
        let depth = depth + 1 + self.longest_chain(pairs.clone(), depth)?;
        // The closures of the Pratt parser share the builder.
        let this = std::cell::RefCell::new(self);
        PRECEDENCES
            .map_primary(|pair| this.borrow_mut().operand(pair, depth))
            .map_prefix(|sign, operand| {
                let (id, span) = operand?;
                let span = sign.as_span().start()..span.end;
                let is_minus = sign.as_rule() == Rule::negative;
                this.borrow_mut().finish(span, |graph| if is_minus { graph.neg(id) } else { id })
            })
            .map_infix(|left, operator, right| {
                let (left, right) = (left?, right?);
                this.borrow_mut().combined(operator.as_rule(), left, right)
            })
            .parse(pairs)
    }

    /// The longest chain of signs and powers, in which the Pratt parser calls itself.
    fn longest_chain(&self, pairs: Pairs<'_, Rule>, depth: usize) -> Result<usize, FormulaError> {
        let (mut longest, mut chain) = (0, 0);
        for pair in pairs {
            match pair.as_rule() {
                Rule::negative | Rule::positive | Rule::power => chain += 1,
                Rule::add | Rule::subtract | Rule::multiply | Rule::divide => chain = 0,
                _ => {}
            }
            longest = longest.max(chain);
            if depth + longest > MAX_DEPTH {
                return self.error(too_deep(), place(&pair));
            }
        }
        Ok(longest)
    }

    fn operand(&mut self, pair: Pair<'_, Rule>, depth: usize) -> Result<Placed, FormulaError> {
        let span = place(&pair);
        match pair.as_rule() {
            Rule::group => {
                let inner = pair.into_inner().next();
                let inner = inner.unwrap_or_else(|| unreachable!("a group is not empty"));
                self.expression(inner.into_inner(), depth).map(|(id, _)| (id, span))
            }
            Rule::number => {
                let value = pair.as_str().parse().unwrap_or(f64::NAN);
                self.finish(span, |graph| graph.constant(value))
            }
            Rule::name => self.name(pair.as_str(), span),
            Rule::call => self.call(pair, span, depth),
            rule => unreachable!("{rule:?} is no operand"),
        }
    }

    fn name(&mut self, name: &str, span: Range<usize>) -> Result<Placed, FormulaError> {
        match self.names.meaning(name) {
            Some(Meaning::Variable(k)) => self.finish(span, |graph| graph.input(k)),
            Some(Meaning::Value(value)) => self.finish(span, |graph| graph.constant(value)),
            None if names::is_function(name) => self.error(no_arguments(name), span),
            None => {
                let nearest = match name {
                    "e" => Some("exp(1)".to_owned()),
                    _ => self.names.nearest(name),
                };
                let error = FormulaError::new(unknown("name", name, nearest), self.text, span);
                Err(FormulaError { unknown_name: Some(name.to_owned()), ..error })
            }
        }
    }

    fn call(
        &mut self,
        pair: Pair<'_, Rule>,
        span: Range<usize>,
        depth: usize,
    ) -> Result<Placed, FormulaError> {
        let mut inner = pair.into_inner();
        let name = inner.next().unwrap_or_else(|| unreachable!("a call has a name"));
        let (function, at) = (name.as_str(), place(&name));
        let unary = Unary::NAMED.into_iter().find(|unary| unary.to_string() == function);
        let expected = match (unary, function) {
            (Some(_), _) => 1,
            (_, "min" | "max") => 2,
            _ => return self.error(self.unknown_function(function), at),
        };
        let found = inner.clone().count();
        if found != expected {
            let s = if expected == 1 { "" } else { "s" };
            let message = format!("`{function}` takes {expected} argument{s}, got {found}");
            return self.error(message, span);
        }
        let mut arguments = Vec::new();
        for argument in inner {
            arguments.push(self.expression(argument.into_inner(), depth)?.0);
        }
        self.finish(span, |graph| match unary {
            Some(unary) => graph.unary(unary, arguments[0]),
            None => {
                let binary = if function == "min" { Binary::Min } else { Binary::Max };
                graph.binary(binary, arguments[0], arguments[1])
            }
        })
    }

    fn unknown_function(&self, name: &str) -> String {
        if self.names.meaning(name).is_some() {
            let name = short(name);
            return format!("`{name}` is no function: write {name}*(…) for a product");
        }
        let nearest = match name {
            "log" => Some("ln".to_owned()),
            "pow" => Some("x^p".to_owned()),
            _ => names::nearest(name, names::functions()),
        };
        unknown("function", name, nearest)
    }

    fn combined(
        &mut self,
        rule: Rule,
        (a, left): Placed,
        (b, right): Placed,
    ) -> Result<Placed, FormulaError> {
        if rule == Rule::divide && self.graph.is_zero(b) {
            return self.error("division by zero".into(), right);
        }
        self.finish(left.start..right.end, |graph| match rule {
            Rule::add => graph.add(a, b),
            Rule::subtract => graph.sub(a, b),
            Rule::multiply => graph.mul(a, b),
            Rule::divide => graph.div(a, b),
            Rule::power => raised(graph, a, b),
            _ => unreachable!("{rule:?} is no operator"),
        })
    }

    /// An expression made at this place; constants must be finite.
    fn finish(
        &mut self,
        span: Range<usize>,
        make: impl FnOnce(&mut Graph) -> Id,
    ) -> Result<Placed, FormulaError> {
        self.graph.set_place(span.clone());
        let id = make(self.graph);
        match self.graph.as_constant(id) {
            Some(value) if !value.is_finite() => {
                self.error(format!("this is not a finite number but {value}"), span)
            }
            _ => Ok((id, span)),
        }
    }
}

/// a^b: a product for an integer constant b, a root for ½, else e^{b ln a}.
fn raised(graph: &mut Graph, a: Id, b: Id) -> Id {
    match graph.as_constant(b) {
        Some(p) if p == p.trunc() && p.abs() <= f64::from(i32::MAX) => graph.power(a, p as i32),
        Some(0.5) => graph.unary(Unary::Sqrt, a),
        _ => {
            let ln = graph.unary(Unary::Ln, a);
            let exponent = graph.mul(b, ln);
            graph.unary(Unary::Exp, exponent)
        }
    }
}
