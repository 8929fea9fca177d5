//! The language: what texts mean, and what is said about texts that mean nothing.

use formula::{Formula, NameError, Names};

fn names() -> Names {
    let mut names = Names::with_variables(&["y1", "y2", "θ"]).unwrap();
    names.parameter("k", 0.5).unwrap();
    names.parameter("sigma", -3.0).unwrap();
    names
}

const POINT: [f64; 3] = [3.0, 2.0, 0.25];

#[test]
fn precedences_are_those_of_mathematics() {
    let [a, b, t] = POINT;
    let table = [
        ("-y1^2", -(a * a)),
        ("(-y1)^2", a * a),
        ("y1 - y2 - θ", (a - b) - t),
        ("y1/y2/θ", (a / b) / t),
        ("y1/y2*θ", (a / b) * t),
        ("2^y2^y1", 256.0),
        ("(2^y2)^y1", 64.0),
        ("2^-y2", 0.25),
        ("-2^-2", -0.25),
        ("2*-y1", -6.0),
        ("- -y1", a),
        ("+y1 - +y2", a - b),
        ("y1*y2 + θ*4", 7.0),
        ("y1 + y2*θ^2", a + b * t * t),
        ("-y1*y2", -6.0),
        ("y1^2^0.5^0", 9.0),
        ("k*sigma", -1.5),
        ("1e-3", 1e-3),
        ("1.5E+2 + .5 + 2.", 152.5),
        ("  min( y1 , y2 )\n+ max(y1,\ty2) ", 5.0),
        ("abs(-y1) + sqrt(y2 + 7) + ln(1)", 6.0),
        ("exp(0) + cosh(0) + sinh(0) + tanh(0) + tan(0) + sin(0) + cos(0)", 3.0),
        ("y1^0 + y1^1 + y1^-1*y1 + y2^10", 1029.0),
        ("y1^0.5 - sqrt(y1)", 0.0),
        ("sin(pi)", formula_of_pi()),
    ];
    for (text, expected) in table {
        let value = Formula::parse(text, &names()).unwrap_or_else(|e| panic!("{e}")).value(&POINT);
        assert!((value - expected).abs() <= 4e-15 * expected.abs(), "{text}: {value} {expected}");
    }
}

/// sin of the number next to π.
fn formula_of_pi() -> f64 {
    std::f64::consts::PI.sin()
}

#[test]
fn errors_name_the_place_and_what_would_be_right() {
    let table = [
        ("", 1, 1, "the formula is empty: write a number or an expression"),
        (" \n\t", 1, 1, "the formula is empty: write a number or an expression"),
        ("2y1", 1, 2, "an operator is missing: write 2*y1"),
        ("2 y1", 1, 3, "an operator is missing: write 2*y1"),
        ("y2 + 3θ", 1, 7, "an operator is missing: write 3*θ"),
        ("y1 y2", 1, 4, "an operator is missing: write y1*y2"),
        ("2(y1 + 1)", 1, 2, "an operator is missing: write 2*(…)"),
        ("(y1)(y2)", 1, 5, "an operator is missing: write (…)*(…)"),
        ("(y1 + 1)y2", 1, 9, "an operator is missing: write (…)*y2"),
        ("2sin(y1)", 1, 2, "an operator is missing: write 2*sin"),
        ("sin y1", 1, 1, "`sin` is a function: write sin(…)"),
        ("y1 + cos", 1, 6, "`cos` is a function: write cos(…)"),
        ("y1 + ", 1, 6, "a number, a name or a bracket is missing at the end"),
        ("y1 + *y2", 1, 6, "a number, a name or a bracket is missing before `*`"),
        ("()", 1, 2, "a number, a name or a bracket is missing before `)`"),
        ("sin()", 1, 5, "a number, a name or a bracket is missing before `)`"),
        ("min(y1,)", 1, 8, "a number, a name or a bracket is missing before `)`"),
        ("(y1 + 2*(y2)", 1, 1, "this bracket is not closed: `)` is missing"),
        ("y1 + 2)", 1, 7, "this bracket was not opened: remove it or write `(` before it"),
        ("y1 + yy2", 1, 6, "unknown name `yy2`; the nearest is `y2`"),
        ("y1\n+ sigm*y2", 2, 3, "unknown name `sigm`; the nearest is `sigma`"),
        ("alpha", 1, 1, "unknown name `alpha`"),
        ("e^y1", 1, 1, "unknown name `e`; the nearest is `exp(1)`"),
        ("log(y1)", 1, 1, "unknown function `log`; the nearest is `ln`"),
        ("sine(y1)", 1, 1, "unknown function `sine`; the nearest is `sin`"),
        ("erf(y1)", 1, 1, "unknown function `erf`"),
        ("y1(y2)", 1, 1, "`y1` is no function: write y1*(…) for a product"),
        ("y1 + sin(y1, y2)", 1, 6, "`sin` takes 1 argument, got 2"),
        ("max(y1)", 1, 1, "`max` takes 2 arguments, got 1"),
        ("y1**2", 1, 4, "unknown operator: write ^ for a power"),
        ("θ·y1", 1, 2, "unexpected character `·`: write `*`"),
        ("y1 − y2", 1, 4, "unexpected character `−`: write `-`"),
        ("y1²", 1, 3, "unexpected character `²`: write `^2`"),
        ("y1 = 2", 1, 4, "unexpected character `=`: write `< or >`"),
        (
            "1,5*y1",
            1,
            2,
            "a comma stands only between arguments of functions; decimals have a point",
        ),
        ("1e999", 1, 1, "this is not a finite number but inf"),
        ("y1 + ln(-1)", 1, 6, "this is not a finite number but NaN"),
        ("y1 + 1/(k - 0.5)", 1, 8, "division by zero"),
        ("y1 + (k - 0.5)^-2", 1, 6, "this is not a finite number but inf"),
        ("y1 < y2 < θ", 1, 9, "comparisons stand alone: write a < b and b < c for a < b < c"),
        ("y1 <", 1, 5, "a number, a name or a bracket is missing at the end"),
        ("< y1", 1, 1, "a number, a name or a bracket is missing before `<`"),
        ("y1 and y2 > 1", 1, 1, "this is a number, where a condition is wanted: write x > 0"),
        ("y1 > 1 or y2", 1, 11, "this is a number, where a condition is wanted: write x > 0"),
        ("not y1", 1, 5, "this is a number, where a condition is wanted: write x > 0"),
        ("if(y1, 1, 2)", 1, 4, "this is a number, where a condition is wanted: write x > 0"),
        ("if(y1 > 0, 1)", 1, 1, "`if` takes 3 arguments, got 2"),
        ("y1 > 0 && y2 > 0", 1, 8, "unexpected character `&`: write `and`"),
        ("y1 ≤ 2", 1, 4, "unexpected character `≤`: write `<=`"),
        ("and", 1, 1, "`and` stands between conditions, such as x > 0"),
        ("if", 1, 1, "`if` is a function: write if(…)"),
    ];
    for (text, line, column, message) in table {
        let error = Formula::parse(text, &names()).expect_err(text);
        let found = (error.line, error.column, error.message);
        assert_eq!(found, (line, column, message.to_owned()), "{text}");
    }
}

fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

#[test]
fn conditions_are_one_or_zero() {
    type Meaning = fn(f64, f64) -> f64;
    let table: [(&str, Meaning); 12] = [
        ("y1 < y2", |a, b| truth(a < b)),
        ("y1 > y2", |a, b| truth(a > b)),
        ("y1 <= y2", |a, b| truth(a <= b)),
        ("y1 >= y2", |a, b| truth(a >= b)),
        ("not y1 < y2", |a, b| truth(a >= b)),
        ("y1 > 0 and y2 > 0 or y1 < -1", |a, b| truth(a > 0.0 && b > 0.0 || a < -1.0)),
        ("y1 > 0 or y2 > 0 and y1 < -1", |a, b| truth(a > 0.0 || b > 0.0 && a < -1.0)),
        ("not (y1 > 0 or y2 > 0)", |a, b| truth(a <= 0.0 && b <= 0.0)),
        ("not y1 > 0 and y2 > 0", |a, b| truth(a <= 0.0 && b > 0.0)),
        ("if(y1 + 1 > y2*y2, y1, -y2)", |a, b| if a + 1.0 > b * b { a } else { -b }),
        ("2*(y1 > 0) - 1", |a, _| if a > 0.0 { 1.0 } else { -1.0 }),
        ("if(if(y1 > 0, y2 > 0, y2 < 0), 5, 7)", |a, b| {
            if if a > 0.0 { b > 0.0 } else { b < 0.0 } { 5.0 } else { 7.0 }
        }),
    ];
    for (text, meaning) in table {
        let formula = Formula::parse(text, &names()).unwrap_or_else(|error| panic!("{error}"));
        for a in [-2.0, -1.0, -0.0, 0.0, 0.5, 2.0] {
            for b in [-2.0, -1.0, -0.0, 0.0, 0.5, 2.0] {
                assert_eq!(formula.value(&[a, b, 0.0]), meaning(a, b), "{text} at {a}, {b}");
            }
        }
    }
    let constant = Formula::parse("1 < 2 and not 2 < 1", &names()).unwrap();
    assert_eq!(constant.value(&POINT), 1.0);
}

#[test]
fn an_error_shows_its_line_with_carets() {
    let error = Formula::parse("y1 +\n θ*(γ + yy22 + 1)", &names()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 2, column 5: unknown name `γ`; the nearest is `k`\n   θ*(γ + yy22 + 1)\n      ^"
    );
    let long = format!("{}yy2 + {}", "y1 + ".repeat(30), "y2 + ".repeat(30) + "1");
    let shown = Formula::parse(&long, &names()).unwrap_err().to_string();
    let lines: Vec<&str> = shown.lines().collect();
    let line: Vec<char> = lines[1].chars().collect();
    assert!(line.len() < 100 && line[2] == '…' && line.last() == Some(&'…'), "{shown}");
    let place = lines[2].find('^').unwrap();
    assert_eq!(line[place..place + 3].iter().collect::<String>(), "yy2", "{shown}");
    assert_eq!(error.span, 10..12);
}

#[test]
fn limits_are_errors() {
    let deep = format!("{}y1{}", "(".repeat(100), ")".repeat(100));
    let message = |text: &str| Formula::parse(text, &names()).unwrap_err().message;
    let too_deep = "brackets, signs and powers are nested deeper than 64";
    assert_eq!(message(&deep), too_deep);
    assert_eq!(message(&("y1^".repeat(100) + "1")), too_deep);
    let too_long = "the formula has 4000001 bytes, and at most 4000000 are allowed";
    assert_eq!(message(&("y1 + ".repeat(800_000) + "1")), too_long);
    let fits = "y1 + ".repeat(19_000) + "1";
    assert_eq!(Formula::parse(&fits, &names()).unwrap().value(&POINT), 57_001.0);
}

#[test]
fn names_are_checked() {
    let mut names = names();
    let message = |result: Result<(), NameError>| result.unwrap_err().to_string();
    assert_eq!(message(names.variable("y1")), "`y1` is given twice, or a constant");
    assert_eq!(message(names.parameter("pi", 1.0)), "`pi` is given twice, or a constant");
    assert_eq!(
        message(names.parameter("sin", 1.0)),
        "`sin` is a word of formulas: choose another name"
    );
    for wrong in ["", "1x", "a b", "a-b", " a", "a ", "x²'", "min("] {
        let message = message(names.variable(wrong));
        assert!(message.starts_with(&format!("`{wrong}` is no name")), "{message}");
    }
    let not_finite = message(names.parameter("lambda", f64::NAN));
    assert_eq!(not_finite, "the parameter `lambda` must be finite, got NaN");
    assert_eq!(names.variables(), ["y1", "y2", "θ"]);
}

#[test]
fn a_value_that_is_not_finite_is_explained() {
    let explained = |text: &str| {
        let reason = Formula::parse(text, &names()).unwrap().explain(&[-0.5, 0.0, 2.0]).unwrap();
        (reason.message, reason.line, reason.column, text[reason.span].to_owned())
    };
    let table = [
        ("θ*ln(y1 - θ)", "this is NaN for -2.5", 3, "ln(y1 - θ)"),
        ("1 + 1/y2", "this is inf for 1 and 0", 5, "1/y2"),
        ("θ + sqrt(y1)", "this is NaN for -0.5", 5, "sqrt(y1)"),
        ("y1^1.5", "this is NaN for -0.5", 1, "y1^1.5"),
        ("y2*0 + y2^-1", "this is inf for 1 and 0", 8, "y2^-1"),
        ("exp(θ*1000)", "this is inf for 2000", 1, "exp(θ*1000)"),
        ("min(ln(y1), θ)", "this is NaN for -0.5", 5, "ln(y1)"),
    ];
    for (text, message, column, place) in table {
        let expected = (message.to_owned(), 1, column, place.to_owned());
        assert_eq!(explained(text), expected, "{text}");
    }
    let formula = Formula::parse("y1/y2", &names()).unwrap();
    assert_eq!(formula.explain(&POINT), None);
    let shown = formula.explain(&[1.0, 0.0, 0.0]).unwrap().to_string();
    assert_eq!(shown, "line 1, column 1: this is inf for 1 and 0\n  y1/y2\n  ^^^^^");
}
