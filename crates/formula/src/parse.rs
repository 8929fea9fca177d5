//! From text to a graph, by the grammar in `formula.pest`.

use std::{ops::Range, sync::LazyLock};

use pest::{
    Parser,
    error::InputLocation,
    iterators::{Pair, Pairs},
    pratt_parser::{Assoc, Op, PrattParser},
};

use crate::{
    FormulaError, FormulaErrorKind, Id, Names,
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
    if text.len() > MAX_BYTES {
        let kind = FormulaErrorKind::TooLong { bytes: text.len() };
        return Err(FormulaError::new(kind, text, 0..0));
    }
    if text.trim().is_empty() {
        return Err(FormulaError::new(FormulaErrorKind::Empty, text, 0..0));
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
        let error = |kind, at| Err(FormulaError::new(kind, text, at..at + 1));
        match c {
            '(' if open.len() == MAX_DEPTH => return error(FormulaErrorKind::TooDeep, at),
            '(' => open.push(at),
            ')' if open.pop().is_none() => return error(FormulaErrorKind::NotOpened, at),
            _ => {}
        }
    }
    match open.last() {
        Some(&at) => Err(FormulaError::new(FormulaErrorKind::NotClosed, text, at..at + 1)),
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
    let error = |kind, span: Range<usize>| FormulaError::new(kind, text, span);
    let Some(token) = first_token(rest) else {
        return error(FormulaErrorKind::MissingOperand { before: None }, at..at);
    };
    let span = at..at + token.len();
    let found = token.chars().next().unwrap_or_default();
    let starts_operand = |c: char| is_word(c) || c == '(';
    let ends_operand = |c: char| is_word(c) || c == ')';
    let after_operand = before.chars().next_back().is_some_and(ends_operand);
    if !(starts_operand(found) || "+-*/^,)".contains(found)) {
        let kind = FormulaErrorKind::UnexpectedCharacter { found, instead: instead_of(found) };
        return error(kind, span);
    }
    if found == '*' && before.ends_with('*') {
        return error(FormulaErrorKind::UnknownOperator { write: "^ for a power" }, span);
    }
    if after_operand && starts_operand(found) {
        let last = last_token(before).unwrap_or_default();
        return missing_operator(text, before.len() - last.len(), last, token, span);
    }
    if after_operand && found == ',' {
        return error(FormulaErrorKind::Comma, span);
    }
    if found == '.' {
        let kind = FormulaErrorKind::UnexpectedCharacter { found, instead: None };
        return error(kind, span);
    }
    error(FormulaErrorKind::MissingOperand { before: Some(token.to_owned()) }, span)
}

/// The error of `last` before `token` without an operator; a function without brackets, or a
/// product.
fn missing_operator(
    text: &str,
    start: usize,
    last: &str,
    token: &str,
    span: Range<usize>,
) -> FormulaError {
    if names::functions().any(|function| function == last) {
        let kind = FormulaErrorKind::NoArguments { function: last.to_owned() };
        return FormulaError::new(kind, text, start..start + last.len());
    }
    let shown = |word: &str, other: &'static str| match word {
        "(" | ")" => other.to_owned(),
        _ if word.chars().count() > 20 => "…".to_owned(),
        _ => word.to_owned(),
    };
    let write = format!("{}*{}", shown(last, "(…)"), shown(token, "(…)"));
    FormulaError::new(FormulaErrorKind::MissingOperator { write }, text, span)
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
    fn error<T>(&self, kind: FormulaErrorKind, span: Range<usize>) -> Result<T, FormulaError> {
        Err(FormulaError::new(kind, self.text, span))
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
                this.borrow_mut().signed(sign.as_rule() == Rule::negative, id, span)
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
                return self.error(FormulaErrorKind::TooDeep, place(&pair));
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
            None => {
                let name = name.to_owned();
                let kind = if names::functions().any(|function| function == name) {
                    FormulaErrorKind::NoArguments { function: name }
                } else {
                    let nearest = match name.as_str() {
                        "e" => Some("exp(1)".to_owned()),
                        _ => self.names.nearest(&name),
                    };
                    FormulaErrorKind::UnknownName { name, nearest }
                };
                self.error(kind, span)
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
        let binary = match function {
            "min" => Some(Binary::Min),
            "max" => Some(Binary::Max),
            _ => None,
        };
        let expected = match (unary, binary) {
            (Some(_), _) => 1,
            (_, Some(_)) => 2,
            _ => return self.error(self.unknown_function(function), at),
        };
        let found = inner.clone().count();
        if found != expected {
            let function = function.to_owned();
            return self
                .error(FormulaErrorKind::WrongArguments { function, expected, found }, span);
        }
        let mut arguments = Vec::new();
        for argument in inner {
            arguments.push(self.expression(argument.into_inner(), depth)?.0);
        }
        self.finish(span, |graph| match (unary, binary) {
            (Some(unary), _) => graph.unary(unary, arguments[0]),
            (_, Some(binary)) => graph.binary(binary, arguments[0], arguments[1]),
            _ => unreachable!("a function has arguments"),
        })
    }

    fn unknown_function(&self, name: &str) -> FormulaErrorKind {
        let name = name.to_owned();
        if self.names.meaning(&name).is_some() {
            return FormulaErrorKind::NotAFunction { name };
        }
        let nearest = match name.as_str() {
            "log" => Some("ln".to_owned()),
            "pow" => Some("x^p".to_owned()),
            _ => names::nearest(&name, names::functions()),
        };
        FormulaErrorKind::UnknownFunction { name, nearest }
    }

    fn signed(&mut self, minus: bool, id: Id, span: Range<usize>) -> Result<Placed, FormulaError> {
        self.finish(span, |graph| if minus { graph.neg(id) } else { id })
    }

    fn combined(
        &mut self,
        rule: Rule,
        (a, left): Placed,
        (b, right): Placed,
    ) -> Result<Placed, FormulaError> {
        if rule == Rule::divide && self.graph.is_zero(b) {
            return self.error(FormulaErrorKind::DivisionByZero, right);
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
                self.error(FormulaErrorKind::NotFinite { value }, span)
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
