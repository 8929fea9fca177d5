//! From text to a graph, by recursive descent. It is written by hand for its messages: the errors
//! of a generated parser list rules of its grammar, these say what is missing and what to write.
//!
//! ```text
//! expression = [sign | "not"] operand, or two expressions with an operator between them
//! operand    = number | name | name "[" expression "]" | "(" expression ")"
//!            | name "(" expression ("," expression)* ")"
//!            | "sum" "(" name "in" expression ".." expression "," expression ")"
//! number     = digits ["." [digits]] [exponent] | "." digits [exponent]
//! name       = a letter or _, then letters, digits and _
//! ```

use std::{collections::HashSet, ops::Range};

use expression::{Graph, Id, Unary};

use crate::{
    FormulaError, Names,
    error::short,
    names::{Meaning, OfVectors},
};

/// The largest length of a text in bytes.
pub const MAX_BYTES: usize = 4_000_000;

/// The deepest nesting: open brackets, with a chain of signs and powers in each. It bounds the
/// recursion of the parser; everything after it is a loop.
pub const MAX_DEPTH: usize = 64;

/// The most terms of all sums of a formula.
const MAX_TERMS: usize = 100_000;

/// Binding strengths of operators, from the weakest to the strongest. So −x² is −(x²), 2^−x is
/// 2^(−x) and a^b^c is a^(b^c).
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
    let mut parser = Parser {
        text,
        names,
        graph,
        at: 0,
        last: "",
        depth: 0,
        conditions: HashSet::new(),
        indices: Vec::new(),
        terms: 0,
    };
    let bytes = text.len();
    if bytes > MAX_BYTES {
        let many = format!("the formula has {bytes} bytes, and at most {MAX_BYTES} are allowed");
        return parser.error(many, 0..0);
    }
    if text.trim().is_empty() {
        return parser.error("the formula is empty: write a number or an expression", 0..0);
    }
    parser.skip("");
    let value = parser.expression(OR)?;
    match parser.token() {
        "" => parser.number(value).map(|(id, _)| id),
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
        _ if whole > 0 && text[whole..].starts_with("..") => return &text[..whole],
        _ if whole > 0 => whole + usize::from(text[whole..].starts_with('.')),
        Some('.') if text.starts_with("..") => return &text[..2],
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

/// Characters of typesetters, and what to write instead.
const INSTEAD: [(char, &str); 12] = [
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
    ('=', "< or >"),
];

struct Parser<'a> {
    text: &'a str,
    names: &'a Names,
    graph: &'a mut Graph,
    /// The byte at which the next token begins.
    at: usize,
    /// Token before the next one.
    last: &'a str,
    /// Open brackets, signs and powers.
    depth: usize,
    /// Expressions that are one where something is true, and else zero.
    conditions: HashSet<Id>,
    /// Indices of sums with their values.
    indices: Vec<(&'a str, u32)>,
    /// Terms of sums so far.
    terms: usize,
}

/// Result of reading a part of a text.
type Parsed<T = Placed> = Result<T, FormulaError>;

/// A number, or the components of a vector, and its place in the text.
type Placed = (Vec<Id>, Range<usize>);

/// A number and its place in the text.
type Number = (Id, Range<usize>);

impl<'a> Parser<'a> {
    fn error<T>(&self, message: impl Into<String>, span: Range<usize>) -> Parsed<T> {
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
    fn unexpected<T>(&self, after_operand: bool) -> Parsed<T> {
        const MISSING: &str = "a number, a name or a bracket is missing";
        let (token, last) = (self.token(), self.last);
        let is_word = |c: char| is_letter(c) || c.is_ascii_digit() || c == '.';
        let shown = |word: &'a str| match word {
            "(" | ")" => "(…)",
            _ if word.chars().count() > 20 => "…",
            _ => word,
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
    fn expression(&mut self, least: u32) -> Parsed {
        let mut left = match self.token() {
            sign @ ("-" | "+") => {
                let start = self.at;
                self.skip(sign);
                let (ids, span) = self.deeper(SIGN)?;
                let signed = |graph: &mut Graph, id| if sign == "-" { graph.neg(id) } else { id };
                self.each(&ids, start..span.end, signed)?
            }
            "not" => {
                let start = self.at;
                self.skip("not");
                let inner = self.deeper(NOT)?;
                let [one, zero] = self.truths();
                let (id, span) = self.condition(inner)?;
                self.chosen(id, [zero, one], start..span.end)?
            }
            _ => self.operand()?,
        };
        loop {
            let operator = self.token();
            type Joined<'a> = fn(&mut Parser<'a>, &str, Placed, Placed) -> Parsed;
            let (binding, of_right, joined): (_, _, Joined<'a>) = match operator {
                "or" => (OR, AND, Self::decided),
                "and" => (AND, NOT, Self::decided),
                "<" | ">" | "<=" | ">=" if !self.conditions.contains(&left.0[0]) => {
                    (COMPARISON, SUM, Self::compared)
                }
                "+" | "-" => (SUM, PRODUCT, Self::combined),
                "*" | "/" => (PRODUCT, SIGN, Self::combined),
                "^" => (POWER, SIGN, Self::combined),
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
            left = joined(self, operator, left, right)?;
        }
    }

    /// The truth values one and zero.
    fn truths(&mut self) -> [Id; 2] {
        [1.0, 0.0].map(|value| self.graph.constant(value))
    }

    /// Demands a number.
    fn number(&self, (ids, span): Placed) -> Parsed<Number> {
        const VECTOR: &str = "this is a vector, where a number is wanted: write one of its \
                              components, or dot(a, b)";
        match ids[..] {
            [id] => Ok((id, span)),
            _ => self.error(VECTOR, span),
        }
    }

    /// Reads an expression in one more bracket, whose value must be a whole number that is known.
    fn whole(&mut self, least: u32) -> Parsed<(u32, Range<usize>)> {
        let value = self.deeper(least)?;
        let (id, span) = self.number(value)?;
        let whole = |x: &f64| x.fract() == 0.0 && (0.0..=1e6).contains(x);
        match self.graph.as_constant(id).filter(whole) {
            Some(number) => Ok((number as u32, span)),
            None => self.error("this must be a whole number, such as 3, i or i + 1", span),
        }
    }

    /// Demands a condition.
    fn condition(&self, value: Placed) -> Parsed<Number> {
        let (id, span) = self.number(value)?;
        match self.conditions.contains(&id) {
            true => Ok((id, span)),
            false => self.error("this is a number, where a condition is wanted: write x > 0", span),
        }
    }

    /// The first expression where a condition is true, else the second; a condition if both are.
    fn chosen(&mut self, condition: Id, of: [Id; 2], span: Range<usize>) -> Parsed {
        let truths = self.truths();
        let chosen = self.alone(span, |graph| {
            let half = graph.constant(0.5);
            graph.where_less(half, condition, of[0], of[1])
        })?;
        if of.iter().all(|id| truths.contains(id) || self.conditions.contains(id)) {
            self.conditions.insert(chosen.0[0]);
        }
        Ok(chosen)
    }

    fn decided(&mut self, operator: &str, left: Placed, right: Placed) -> Parsed {
        let ((a, left), (b, right)) = (self.condition(left)?, self.condition(right)?);
        let [one, zero] = self.truths();
        let of = if operator == "and" { [b, zero] } else { [one, b] };
        self.chosen(a, of, left.start..right.end)
    }

    fn compared(&mut self, operator: &str, left: Placed, right: Placed) -> Parsed {
        let ((a, left), (b, right)) = (self.number(left)?, self.number(right)?);
        let [one, zero] = self.truths();
        // a ≤ b is not b < a.
        let (x, y) = if matches!(operator, "<" | ">=") { (a, b) } else { (b, a) };
        let (yes, no) = if operator.len() == 1 { (one, zero) } else { (zero, one) };
        let span = left.start..right.end;
        let compared = self.alone(span, |graph| graph.where_less(x, y, yes, no))?;
        self.conditions.insert(compared.0[0]);
        Ok(compared)
    }

    /// An expression in one more bracket, sign or power.
    fn deeper(&mut self, least: u32) -> Parsed {
        if self.depth == MAX_DEPTH {
            let deep = format!("brackets, signs and powers are nested deeper than {MAX_DEPTH}");
            return self.error(deep, self.place());
        }
        self.depth += 1;
        let inner = self.expression(least);
        self.depth -= 1;
        inner
    }

    fn operand(&mut self) -> Parsed {
        let (token, span) = (self.token(), self.place());
        if token == "(" {
            let (mut inner, end) = self.bracket()?;
            return Ok((inner.swap_remove(0).0, span.start..end));
        }
        if token.starts_with(is_letter) {
            self.skip(token);
            return match self.token() {
                "(" => self.call(token, span),
                "[" => self.indexed(token, span),
                _ => self.name(token, span),
            };
        }
        match token.parse() {
            Ok(number) => {
                self.skip(token);
                self.alone(span, |graph| graph.constant(number))
            }
            Err(_) => self.unexpected(false),
        }
    }

    /// The expressions in a bracket, with commas between them, and its end.
    fn bracket(&mut self) -> Parsed<(Vec<Placed>, usize)> {
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

    fn name(&mut self, name: &str, span: Range<usize>) -> Parsed {
        if let Some((_, value)) = self.indices.iter().rev().find(|(index, _)| *index == name) {
            let value = f64::from(*value);
            return self.alone(span, |graph| graph.constant(value));
        }
        match self.names.meaning(name) {
            Some(Meaning::Variable(k)) => self.alone(span, |graph| graph.input(*k)),
            Some(Meaning::Value(value)) => self.alone(span, |graph| graph.constant(*value)),
            Some(Meaning::Vector(components)) => {
                Ok((components.iter().map(|&k| self.graph.input(k)).collect(), span))
            }
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

    /// `q[i]`: component i of the vector q, or else the name q and the number i, `q2`.
    fn indexed(&mut self, name: &str, at: Range<usize>) -> Parsed {
        let open = self.place();
        self.skip("[");
        let is_known =
            ["", "1"].iter().any(|k| self.names.meaning(&format!("{name}{k}")).is_some());
        let (index, place) = match self.whole(OR) {
            Err(_) if !is_known => return self.error(format!("`{name}` is no vector"), at),
            whole => whole?,
        };
        let end = self.place().end;
        match self.token() {
            token @ "]" => self.skip(token),
            _ => return self.error("this bracket is not closed: `]` is missing", open),
        }
        let Some(Meaning::Vector(components)) = self.names.meaning(name) else {
            return self.name(&format!("{name}{index}"), at.start..end);
        };
        match components.get((index as usize).wrapping_sub(1)) {
            Some(&k) => self.alone(at.start..end, |graph| graph.input(k)),
            None => {
                let count = components.len();
                self.error(format!("`{name}` has components 1 to {count}, got {index}"), place)
            }
        }
    }

    /// `sum(i in 1..3, q[i]^2)`: the expression is read for each i.
    fn sum(&mut self, at: Range<usize>) -> Parsed {
        const FORM: &str = "a sum is written sum(i in 1..3, q[i]^2)";
        self.skip("(");
        let (index, place) = (self.token(), self.place());
        if !is_name(index) {
            return self.error(FORM, place);
        }
        if self.names.meaning(index).is_some() || self.indices.iter().any(|(i, _)| *i == index) {
            let known = format!("`{index}` has a meaning already: choose another index");
            return self.error(known, place);
        }
        self.skip(index);
        self.expect("in", FORM)?;
        let (first, _) = self.whole(SUM)?;
        self.expect("..", FORM)?;
        let (last, place) = self.whole(SUM)?;
        self.expect(",", FORM)?;
        if last < first {
            return self.error(format!("this sum from {first} to {last} has no term"), place);
        }
        let begin = self.at;
        let mut sum = None;
        for k in first..=last {
            self.terms += 1;
            if self.terms > MAX_TERMS {
                return self.error(format!("the sums have more than {MAX_TERMS} terms"), at);
            }
            self.at = begin;
            self.indices.push((index, k));
            let term = self.deeper(OR);
            self.indices.pop();
            let term = term?;
            sum = Some(match sum {
                None => term,
                Some(sum) => self.combined("+", sum, term)?,
            });
        }
        let end = self.place().end;
        self.expect(")", "this sum is not closed: `)` is missing")?;
        Ok((sum.unwrap_or_default().0, at.start..end))
    }

    /// Goes behind a token that must stand here.
    fn expect(&mut self, token: &str, message: &str) -> Parsed<()> {
        match self.token() {
            found if found == token => {
                self.skip(found);
                Ok(())
            }
            _ => self.error(message, self.place()),
        }
    }

    fn call(&mut self, function: &str, at: Range<usize>) -> Parsed {
        let meaning = self.names.meaning(function);
        let expected = match meaning {
            Some(Meaning::Sum) => return self.sum(at),
            Some(Meaning::Unary(_) | Meaning::OfVectors(OfVectors::Norm)) => 1,
            Some(Meaning::Binary(_) | Meaning::OfVectors(_)) => 2,
            Some(Meaning::If) => 3,
            _ => return self.error(self.unknown_function(function), at),
        };
        let (arguments, end) = self.bracket()?;
        let (span, found) = (at.start..end, arguments.len());
        if found != expected {
            let s = if expected == 1 { "" } else { "s" };
            let wrong = format!("`{function}` takes {expected} argument{s}, got {found}");
            return self.error(wrong, span);
        }
        if let Some(Meaning::OfVectors(of)) = meaning {
            let (a, b) = (&arguments[0].0, &arguments[expected - 1].0);
            return match (of, a.len(), b.len()) {
                (_, m, n) if m != n => {
                    self.error(format!("these vectors have {m} and {n} components"), span)
                }
                (OfVectors::Cross, 3, _) => Ok((self.graph.cross(a, b).to_vec(), span)),
                (OfVectors::Cross, m, _) => {
                    self.error(format!("a cross product is of three components, got {m}"), span)
                }
                (OfVectors::Dot, ..) => self.alone(span, |graph| graph.dot(a, b)),
                (OfVectors::Norm, ..) => self.alone(span, |graph| {
                    let square = graph.dot(a, b);
                    graph.unary(Unary::Sqrt, square)
                }),
            };
        }
        let number = |(k, argument)| match (expected, k) {
            (3, 0) => self.condition(argument),
            _ => self.number(argument),
        };
        let numbers = arguments.into_iter().enumerate().map(|of| Ok(number(of)?.0));
        match (meaning, &numbers.collect::<Parsed<Vec<Id>>>()?[..]) {
            (Some(Meaning::Unary(unary)), &[a]) => self.alone(span, |graph| graph.unary(*unary, a)),
            (Some(Meaning::Binary(binary)), &[a, b]) => {
                self.alone(span, |graph| graph.binary(*binary, a, b))
            }
            (_, &[condition, a, b]) => self.chosen(condition, [a, b], span),
            _ => unreachable!("it has {expected} arguments"),
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

    fn combined(&mut self, operator: &str, (a, left): Placed, (b, right): Placed) -> Parsed {
        let span = left.start..right.end;
        let kind = |count| match count {
            1 => "a number".to_owned(),
            _ => format!("a vector of {count}"),
        };
        match (operator, a.len(), b.len()) {
            ("+" | "-", m, n) if m != n => {
                let wrong = format!("{} {operator} {} has no meaning", kind(m), kind(n));
                return self.error(wrong, span);
            }
            ("/", _, 1) if self.graph.is_zero(b[0]) => {
                return self.error("division by zero", right);
            }
            ("+" | "-", ..) | ("*", 1, _) | ("*" | "/", _, 1) | (_, 1, 1) => {}
            _ => return self.error("a product of vectors is dot(a, b) or cross(a, b)", span),
        }
        let of = |ids: &[Id], k: usize| ids[k.min(ids.len() - 1)];
        let pairs = (0..a.len().max(b.len())).map(|k| (of(&a, k), of(&b, k)));
        let pairs: Vec<(Id, Id)> = pairs.collect();
        self.each(&pairs, span, |graph, (a, b)| match operator {
            "+" => graph.add(a, b),
            "-" => graph.sub(a, b),
            "*" => graph.mul(a, b),
            "/" => graph.div(a, b),
            _ => raised(graph, a, b),
        })
    }

    /// Expressions of each of these, made at this place; constants must be finite.
    fn each<T: Copy>(
        &mut self,
        of: &[T],
        span: Range<usize>,
        make: impl Fn(&mut Graph, T) -> Id,
    ) -> Parsed {
        self.graph.set_place(span.clone());
        let ids: Vec<Id> = of.iter().map(|&of| make(self.graph, of)).collect();
        let mut constants = ids.iter().filter_map(|&id| self.graph.as_constant(id));
        match constants.find(|value| !value.is_finite()) {
            Some(value) => self.error(format!("this is not a finite number but {value}"), span),
            None => Ok((ids, span)),
        }
    }

    /// A number made at this place.
    fn alone(&mut self, span: Range<usize>, make: impl Fn(&mut Graph) -> Id) -> Parsed {
        self.each(&[()], span, |graph, ()| make(graph))
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
