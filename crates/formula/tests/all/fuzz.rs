//! Texts that are no formulas end with an error that can be shown, and nothing else.

use formula::{Formula, MAX_BYTES, MAX_DEPTH, Names};

use crate::expression::{Random, VARIABLES, hessian};

const TOKENS: [&str; 40] = [
    "+", "-", "*", "/", "^", "(", ")", ",", "x", "y_1", "γ", "1", "2.5", "1e", "1e-3", ".", "sin",
    "sin(", "min(", "max", "cos", "ln(", " ", "\n", "é", "²", "−", "pi", "2x", "**", "e", "_", "0",
    "((", "))", "^-", "--", "1e308", "\u{200b}", "😀",
];

/// A text of random tokens, or of random bytes.
fn text(random: &mut Random) -> String {
    let length = random.below(24);
    if random.below(4) == 0 {
        let bytes: Vec<u8> = (0..length).map(|_| random.next() as u8).collect();
        return String::from_utf8_lossy(&bytes).into_owned();
    }
    (0..length).map(|_| TOKENS[random.below(TOKENS.len())]).collect()
}

fn run(count: usize) {
    let names = Names::with_variables(&VARIABLES).unwrap();
    let mut random = Random::new(3);
    let mut formulas = 0;
    for _ in 0..count {
        let text = text(&mut random);
        match Formula::parse(&text, &names) {
            Ok(formula) => {
                formulas += 1;
                let point = [(); 3].map(|()| random.number());
                let value = formula.value(&point);
                let reason = formula.explain(&point);
                assert_eq!(value.is_finite(), reason.is_none(), "{text}");
                if let Some(reason) = reason {
                    assert!(text.get(reason.span.clone()).is_some(), "{text}: {reason:?}");
                    assert!(!reason.to_string().is_empty());
                }
                let mut gradient = [0.0; 3];
                formula.gradient(&[0, 1, 2]).evaluate_one(&[&point], &mut gradient);
            }
            Err(error) => {
                assert!(text.get(error.span.clone()).is_some(), "{text}: {error:?}");
                assert!(error.line >= 1 && error.column >= 1);
                assert!(error.to_string().lines().count() == 3, "{error}");
            }
        }
    }
    println!("{formulas} of {count} texts are formulas");
    assert!(formulas > count / 200, "{formulas}");
}

#[test]
fn random_texts_end_with_a_formula_or_an_error() {
    run(20_000);
}

#[test]
#[ignore = "a minute in a release build"]
fn a_million_random_texts_end_with_a_formula_or_an_error() {
    run(1_000_000);
}

#[test]
#[ignore = "minutes in a release build"]
fn a_million_random_expressions_agree_with_dual_numbers() {
    let mut random = Random::new(11);
    let mut seen = crate::derivatives::Seen::default();
    for n in 0..1_000_000 {
        let expression = crate::expression::Expression::random(&mut random, 1 + n % 6);
        crate::derivatives::check(&expression, &mut random, &mut seen);
    }
    seen.check();
}

/// Long and deep texts: within the limits a formula, beyond them an error, and never a stack that
/// is too small, also in a thread with little of it.
#[test]
fn long_and_deep_texts_are_formulas_or_errors() {
    let names = Names::with_variables(&VARIABLES).unwrap();
    let deep =
        |n: usize, open: &str, close: &str| format!("{}x{}", open.repeat(n), close.repeat(n));
    let mut texts = Vec::new();
    for n in [MAX_DEPTH - 2, MAX_DEPTH - 1, MAX_DEPTH, MAX_DEPTH + 1, 1000, MAX_BYTES / 6] {
        let texts_of_n = [
            deep(n, "(", ")"),
            deep(n, "sin(", ")"),
            deep(n, "-", ""),
            deep(n, "x^", ""),
            deep(n, "-(x^", ")"),
            deep(n, "(", ""),
            deep(n, "", ")"),
            deep(n, "x+", ""),
            deep(n, "x*y_1-", ""),
            deep(n, "x/", ""),
            deep(n, "1,", ""),
            deep(n, "2 ", ""),
            format!("min({}x)", "x,".repeat(n)),
            "1".repeat(n),
            "x".repeat(n),
            "^".repeat(n),
        ];
        texts.extend(texts_of_n);
    }
    let small = std::thread::Builder::new().stack_size(512 * 1024);
    let run = move || {
        for text in texts {
            match Formula::parse(&text, &names) {
                Ok(formula) => drop(hessian(&formula)),
                Err(error) => assert!(error.to_string().len() < 1000, "{error}"),
            }
        }
    };
    small.spawn(run).unwrap().join().unwrap();
}
