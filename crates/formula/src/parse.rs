//! From text to a graph, by recursive descent. It is written by hand for its messages: the errors
//! of a generated parser list rules of its grammar, these say what is missing and what to write.
//!
//! ```text
//! expression = [sign | "not"] operand, or two expressions with an operator between them
//! operand    = number | name | name "(" expression ("," expression)* ")" | "(" expression ")"
//! number     = digits ["." [digits]] [exponent] | "." digits [exponent]
//! name       = a letter or _, then letters, digits and _
//! ```

use std::{collections::HashSet, ops::Range};

use crate::{
    FormulaError, Id, Names,
    error::short,
    graph::{Graph, Unary},
    names::Meaning,
};

/// The largest length of a text in bytes.
pub const MAX_BYTES: usize = 100_000;

/// The deepest nesting: open brackets, with a chain of signs and powers in each. It bounds the
/// recursion of the parser; everything after it is a loop.
pub const MAX_DEPTH: usize = 64;

/// How tightly operators bind, from the weakest to the strongest. So −x² is −(x²), 2^−x is 2^(−x)
/// and a^b^c is a^(b^c).
const OR: u32 = 0;
const AND: u32 = 1;
const NOT: u32 = 2;
const COMPARISON: u32 = 3;
const SUM: u32 = 4;
const PRODUCT: u32 = 5;
const SIGN: u32 = 6;
const POWER: u32 = 7;

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
    let conditions = HashSet::new();
    let mut parser = Parser { text, names, graph, at: 0, last: "", depth: 0, conditions };
    parser.skip("");
    let (id, _) = parser.expression(OR)?;
    match parser.token() {
        "" => Ok(id),
        _ => parser.unexpected(true),
    }
}

fn is_letter(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

/// Whether `text` is a name.
pub(crate) fn is_name(text: &str) -> bool {
    text.starts_with(is_letter) && first_token(text) == text
}

/// The token that starts `text`: a number, a name or one character; empty at the end.
fn first_token(text: &str) -> &str {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let whole = digits(0);
    let fraction = if text[whole..].starts_with('.') { digits(whole + 1) } else { 0 };
    let mut end = match text.chars().next() {
        Some(c) if is_letter(c) => {
            let is_other = |c| !is_letter(c) && !char::is_ascii_digit(&c);
            return &text[..text.find(is_other).unwrap_or(text.len())];
        }
        _ if fraction > 0 => whole + 1 + fraction,
        _ if whole > 0 => whole + usize::from(text[whole..].starts_with('.')),
        Some('<' | '>') => return &text[..1 + usize::from(text[1..].starts_with('='))],
        c => return &text[..c.map_or(0, char::len_utf8)],
    };
    if text[end..].starts_with(['e', 'E']) {
        let first = end + 1 + usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits(first);
        end = if exponent > 0 { first + exponent } else { end };
    }
    &text[..end]
}

/// Characters that typesetters have, and what to write.
const INSTEAD: [(char, &str); 11] = [
    ('−', "-"),
    ('·', "*"),
    ('×', "*"),
    ('²', "^2"),
    ('³', "^3"),
    ('√', "sqrt(…)"),
    ('≤', "<="),
    ('≥', ">="),
    ('&', "and"),
    ('|', "or"),
    ('!', "not"),
];

struct Parser<'a> {
    text: &'a str,
    names: &'a Names,
    graph: &'a mut Graph,
    /// The byte at which the next token begins.
    at: usize,
    /// The token before it.
    last: &'a str,
    /// Open brackets, signs and powers.
    depth: usize,
    /// Expressions that are one where something is true, and else zero.
    conditions: HashSet<Id>,
}

/// An expression and its place in the text.
type Placed = (Id, Range<usize>);

impl<'a> Parser<'a> {
    fn error<T>(&self, message: impl Into<String>, span: Range<usize>) -> Result<T, FormulaError> {
        Err(FormulaError::new(message, self.text, span))
    }

    /// The next token.
    fn token(&self) -> &'a str {
        first_token(&self.text[self.at..])
    }

    /// The place of the next token.
    fn place(&self) -> Range<usize> {
        self.at..self.at + self.token().len()
    }

    /// Goes behind the next token.
    fn skip(&mut self, token: &'a str) {
        let rest = &self.text[self.at + token.len()..];
        self.at = self.text.len() - rest.trim_start_matches([' ', '\t', '\r', '\n']).len();
        self.last = token;
    }

    /// The error at a token that cannot stand here.
    fn unexpected<T>(&self, after_operand: bool) -> Result<T, FormulaError> {
        const MISSING: &str = "a number, a name or a bracket is missing";
        let (token, last) = (self.token(), self.last);
        let is_word = |c: char| is_letter(c) || c.is_ascii_digit() || c == '.';
        let shown = |word: &str| match word {
            "(" | ")" => "(…)".to_owned(),
            _ if word.chars().count() > 20 => "…".to_owned(),
            _ => word.to_owned(),
        };
        let message = match token.chars().next() {
            None => format!("{MISSING} at the end"),
            Some('*') if last == "*" => "unknown operator: write ^ for a power".into(),
            Some('<' | '>') if after_operand => {
                "comparisons stand alone: write a < b and b < c for a < b < c".into()
            }
            Some(c) if after_operand && (is_word(c) || c == '(') => {
                format!("an operator is missing: write {}*{}", shown(last), shown(token))
            }
            Some(',') if after_operand => {
                "a comma stands only between arguments of functions; decimals have a point".into()
            }
            Some(')') if after_operand || self.depth == 0 => {
                "this bracket was not opened: remove it or write `(` before it".into()
            }
            Some(c) if is_word(c) && c != '.' || "+-*/^,)<>".contains(c) => {
                format!("{MISSING} before `{}`", short(token))
            }
            Some(c) => {
                let known = INSTEAD.iter().find(|(typeset, _)| *typeset == c);
                let hint = known.map_or(String::new(), |(_, write)| format!(": write `{write}`"));
                format!("unexpected character `{}`{hint}", c.escape_debug())
            }
        };
        self.error(message, self.place())
    }

    /// The expression of operators that bind at least so tightly.
    fn expression(&mut self, least: u32) -> Result<Placed, FormulaError> {
        let mut left = match self.token() {
            sign @ ("-" | "+") => {
                let start = self.at;
                self.skip(sign);
                let (id, span) = self.deeper(SIGN)?;
                self.finish(start..span.end, |graph| if sign == "-" { graph.neg(id) } else { id })?
            }
            "not" => {
                let start = self.at;
                self.skip("not");
                let (id, span) = self.deeper(NOT)?;
                let [one, zero] = self.truths();
                self.condition((id, span.clone()))?;
                self.chosen(id, [zero, one], start..span.end)?
            }
            _ => self.operand()?,
        };
        loop {
            let operator = self.token();
            let (binding, of_right) = match operator {
                "or" => (OR, AND),
                "and" => (AND, NOT),
                "<" | ">" | "<=" | ">=" if !self.conditions.contains(&left.0) => (COMPARISON, SUM),
                "+" | "-" => (SUM, PRODUCT),
                "*" | "/" => (PRODUCT, SIGN),
                "^" => (POWER, SIGN),
                _ => return Ok(left),
            };
            if binding < least {
                return Ok(left);
            }
            self.skip(operator);
            let right = match binding {
                POWER => self.deeper(of_right)?,
                _ => self.expression(of_right)?,
            };
            left = match binding {
                OR | AND => self.joined(operator, left, right)?,
                COMPARISON => self.compared(operator, left, right)?,
                _ => self.combined(operator, left, right)?,
            };
        }
    }

    /// One and zero.
    fn truths(&mut self) -> [Id; 2] {
        [1.0, 0.0].map(|value| self.graph.constant(value))
    }

    /// Demands a condition.
    fn condition(&self, (id, span): Placed) -> Result<(), FormulaError> {
        match self.conditions.contains(&id) {
            true => Ok(()),
            false => self.error("this is a number, where a condition is wanted: write x > 0", span),
        }
    }

    /// The first expression where a condition is true, else the second; a condition if both are.
    fn chosen(
        &mut self,
        condition: Id,
        of: [Id; 2],
        span: Range<usize>,
    ) -> Result<Placed, FormulaError> {
        let truths = self.truths();
        let [a, b] = of;
        let chosen = self.finish(span, |graph| {
            let half = graph.constant(0.5);
            graph.where_less(half, condition, a, b)
        })?;
        if of.iter().all(|id| truths.contains(id) || self.conditions.contains(id)) {
            self.conditions.insert(chosen.0);
        }
        Ok(chosen)
    }

    fn joined(
        &mut self,
        operator: &str,
        left: Placed,
        right: Placed,
    ) -> Result<Placed, FormulaError> {
        let (a, b, span) = (left.0, right.0, left.1.start..right.1.end);
        self.condition(left)?;
        self.condition(right)?;
        let [one, zero] = self.truths();
        self.chosen(a, if operator == "and" { [b, zero] } else { [one, b] }, span)
    }

    fn compared(
        &mut self,
        operator: &str,
        (a, left): Placed,
        (b, right): Placed,
    ) -> Result<Placed, FormulaError> {
        let [one, zero] = self.truths();
        let compared = self.finish(left.start..right.end, |graph| match operator {
            "<" => graph.where_less(a, b, one, zero),
            ">" => graph.where_less(b, a, one, zero),
            "<=" => graph.where_less(b, a, zero, one),
            _ => graph.where_less(a, b, zero, one),
        })?;
        self.conditions.insert(compared.0);
        Ok(compared)
    }

    /// An expression in one more bracket, sign or power.
    fn deeper(&mut self, least: u32) -> Result<Placed, FormulaError> {
        if self.depth == MAX_DEPTH {
            let message = format!("brackets, signs and powers are nested deeper than {MAX_DEPTH}");
            return self.error(message, self.place());
        }
        self.depth += 1;
        let inner = self.expression(least);
        self.depth -= 1;
        inner
    }

    fn operand(&mut self) -> Result<Placed, FormulaError> {
        let (token, span) = (self.token(), self.place());
        if token == "(" {
            let (mut inner, end) = self.bracket()?;
            return Ok((inner.remove(0).0, span.start..end));
        }
        if token.starts_with(is_letter) {
            self.skip(token);
            return match self.token() {
                "(" => self.call(token, span),
                _ => self.name(token, span),
            };
        }
        match token.parse() {
            Ok(number) => {
                self.skip(token);
                self.finish(span, |graph| graph.constant(number))
            }
            Err(_) => self.unexpected(false),
        }
    }

    /// The expressions in a bracket, with commas between them, and its end.
    fn bracket(&mut self) -> Result<(Vec<Placed>, usize), FormulaError> {
        let (open, is_call) = (self.place(), self.last.starts_with(is_letter));
        self.skip("(");
        let mut inner = Vec::new();
        loop {
            inner.push(self.deeper(OR)?);
            let end = self.place().end;
            match self.token() {
                token @ ")" => {
                    self.skip(token);
                    return Ok((inner, end));
                }
                token @ "," if is_call => self.skip(token),
                "" => return self.error("this bracket is not closed: `)` is missing", open),
                _ => return self.unexpected(true),
            }
        }
    }

    fn name(&mut self, name: &str, span: Range<usize>) -> Result<Placed, FormulaError> {
        match self.names.meaning(name) {
            Some(Meaning::Variable(k)) => self.finish(span, |graph| graph.input(k)),
            Some(Meaning::Value(value)) => self.finish(span, |graph| graph.constant(value)),
            Some(Meaning::Word) => {
                self.error(format!("`{name}` stands between conditions, such as x > 0"), span)
            }
            Some(_) => self.error(format!("`{name}` is a function: write {name}(…)"), span),
            None => {
                let hint = match name {
                    "e" => "; the nearest is `exp(1)`".to_owned(),
                    _ => self.names.nearest(name, false),
                };
                let message = format!("unknown name `{}`{hint}", short(name));
                let error = FormulaError::new(message, self.text, span);
                Err(FormulaError { unknown_name: Some(name.to_owned()), ..error })
            }
        }
    }

    fn call(&mut self, function: &str, at: Range<usize>) -> Result<Placed, FormulaError> {
        let meaning = self.names.meaning(function);
        let expected = match meaning {
            Some(Meaning::Unary(_)) => "1 argument",
            Some(Meaning::Binary(_)) => "2 arguments",
            Some(Meaning::If) => "3 arguments",
            _ => return self.error(self.unknown_function(function), at),
        };
        let (arguments, end) = self.bracket()?;
        let span = at.start..end;
        match (meaning, &arguments[..]) {
            (Some(Meaning::Unary(unary)), [(a, _)]) => {
                self.finish(span, |graph| graph.unary(unary, *a))
            }
            (Some(Meaning::Binary(binary)), [(a, _), (b, _)]) => {
                self.finish(span, |graph| graph.binary(binary, *a, *b))
            }
            (Some(Meaning::If), [condition, (a, _), (b, _)]) => {
                self.condition(condition.clone())?;
                self.chosen(condition.0, [*a, *b], span)
            }
            (_, found) => {
                let found = found.len();
                self.error(format!("`{function}` takes {expected}, got {found}"), span)
            }
        }
    }

    fn unknown_function(&self, name: &str) -> String {
        if self.names.meaning(name).is_some() {
            let name = short(name);
            return format!("`{name}` is no function: write {name}*(…) for a product");
        }
        let hint = match name {
            "log" => "; the nearest is `ln`".to_owned(),
            "pow" => "; the nearest is `x^p`".to_owned(),
            _ => self.names.nearest(name, true),
        };
        format!("unknown function `{}`{hint}", short(name))
    }

    fn combined(
        &mut self,
        operator: &str,
        (a, left): Placed,
        (b, right): Placed,
    ) -> Result<Placed, FormulaError> {
        if operator == "/" && self.graph.is_zero(b) {
            return self.error("division by zero", right);
        }
        self.finish(left.start..right.end, |graph| match operator {
            "+" => graph.add(a, b),
            "-" => graph.sub(a, b),
            "*" => graph.mul(a, b),
            "/" => graph.div(a, b),
            _ => raised(graph, a, b),
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
