//! Texts that are no formulas end with an error that can be shown, and nothing else.

use formula::{Formula, MAX_DEPTH, Names};

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

#[test]
fn random_texts_end_with_a_formula_or_an_error() {
    const COUNT: usize = 20_000;
    let names = Names::with_variables(&VARIABLES).unwrap();
    let (mut random, mut formulas) = (Random::new(3), 0);
    for text in (0..COUNT).map(|_| text(&mut random)).collect::<Vec<_>>() {
        let shown = match Formula::parse(&text, &names) {
            Ok(formula) => {
                formulas += 1;
                let point = [(); 3].map(|()| random.number());
                formula.gradient(&[0, 1, 2]).evaluate_one(&[&point], &mut [0.0; 3]);
                let reason = formula.explain(&point);
                assert_eq!(formula.value(&point).is_finite(), reason.is_none(), "{text}");
                reason
            }
            Err(error) => Some(error),
        };
        if let Some(error) = shown {
            assert!(text.get(error.span.clone()).is_some(), "{text}: {error:?}");
            assert!(error.line >= 1 && error.column >= 1);
            assert_eq!(error.to_string().lines().count(), 3, "{error}");
        }
    }
    assert!(formulas > COUNT / 200, "{formulas}");
}

/// Long and deep texts: within the limits a formula, beyond them an error, and never a stack that
/// is too small, also in a thread with little of it.
#[test]
fn long_and_deep_texts_are_formulas_or_errors() {
    let names = Names::with_variables(&VARIABLES).unwrap();
    let deep =
        |n: usize, open: &str, close: &str| format!("{}x{}", open.repeat(n), close.repeat(n));
    let texts = |n: usize| {
        let open = ["(", "-", "x^", "x+", "x*y_1-", "x/", "1,", "2 "];
        let mut texts: Vec<String> = open.iter().map(|open| deep(n, open, "")).collect();
        texts.extend([deep(n, "(", ")"), deep(n, "sin(", ")"), deep(n, "-(x^", ")")]);
        texts.extend([deep(n, "", ")"), format!("min({}x)", "x,".repeat(n))]);
        texts.extend(["1", "x", "^"].map(|text| text.repeat(n)));
        texts
    };
    let lengths = [MAX_DEPTH - 2, MAX_DEPTH - 1, MAX_DEPTH, MAX_DEPTH + 1, 1000, 16_000];
    let texts: Vec<String> = lengths.into_iter().flat_map(texts).collect();
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
