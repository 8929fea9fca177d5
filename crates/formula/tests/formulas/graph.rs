//! Identities, degrees and instructions.

use formula::{Binary, Formula, Graph, Names, Tape, Unary};
use real::elementary;

use crate::expression::hessian;

fn formula(text: &str) -> Formula {
    Formula::parse(text, &Names::with_variables(&["x", "y"]).unwrap()).unwrap()
}

/// Whether two texts are the same expression.
fn same(a: &str, b: &str) -> bool {
    let mut graph = Graph::new();
    let inputs = [graph.input(0), graph.input(1)];
    let mut import = |text: &str| {
        let formula = formula(text);
        graph.copy(Some(&formula.graph), &[formula.root], |k| inputs.get(k).copied())[0]
    };
    import(a) == import(b)
}

#[test]
fn identities_are_applied_and_no_others() {
    let equal = [
        ("x + 0", "x"),
        ("1*x", "x"),
        ("x/1", "x"),
        ("-1*x", "-x"),
        ("0*x + y", "y"),
        ("x - x", "0"),
        ("x + x", "2*x"),
        ("x*x", "x^2"),
        ("x*y", "y*x"),
        ("x + y", "y + x"),
        ("-(x - y)", "y - x"),
        ("-x - y", "-(y + x)"),
        ("-x*y", "x*-y"),
        ("-x/y", "x/-y"),
        ("x/-3", "-(x/3)"),
        ("x/2", "0.5*x"),
        ("3*(2*x)", "6*x"),
        ("2*(3*x)", "6*x"),
        ("-(3*x)", "-3*x"),
        ("(-x)^2", "x^2"),
        ("(-x)^3", "-x^3"),
        ("x - 3", "x + -3"),
        ("-(x + 3)", "-3 - x"),
        ("abs(-x)", "abs(x)"),
        ("min(x, x)", "x"),
        ("2*pi/2", "pi"),
    ];
    for (a, b) in equal {
        assert!(same(a, b), "{a} and {b}");
    }
    let different =
        [("(x + y) + 1", "x + (y + 1)"), ("3*(5*x)", "15*x"), ("x/3", "x*(1/3)"), ("x/x", "1")];
    for (a, b) in different {
        assert!(!same(a, b), "{a} and {b}");
    }
}

#[test]
fn constants_have_the_bits_of_rows() {
    let functions = ["sin", "cos", "tan", "exp", "ln", "sqrt", "abs", "sinh", "cosh", "tanh"];
    for function in functions {
        let folded = formula(&format!("{function}(0.7321)")).value(&[0.0, 0.0]);
        let value = formula(&format!("{function}(x)")).value(&[0.7321, 0.0]);
        assert_eq!(folded.to_bits(), value.to_bits(), "{function}");
    }
    for n in [-7_i32, -2, -1, 0, 1, 2, 3, 4, 5, 7, 10, 15, 31, 100] {
        let value = formula(&format!("x^{n}")).value(&[1.0123, 0.0]);
        assert_eq!(value.to_bits(), elementary::powi(1.0123, n).to_bits(), "{n}");
        assert_eq!(formula(&format!("1.0123^{n}")).value(&[0.0; 2]).to_bits(), value.to_bits());
    }
    assert_eq!(formula("x^0.37").value(&[2.0, 0.0]), elementary::exp(0.37 * elementary::ln(2.0)));
}

#[test]
fn functions_are_accurate() {
    for n in -4000..4000 {
        let x = f64::from(n) * 0.003 + 1e-5;
        for (text, host) in [("sinh(x)", x.sinh()), ("cosh(x)", x.cosh()), ("tanh(x)", x.tanh())] {
            let value = formula(text).value(&[x, 0.0]);
            assert!((value - host).abs() <= 4.0 * f64::EPSILON * host.abs(), "{text} at {x}");
        }
    }
    let at = |text: &str, x: f64| formula(text).value(&[x, 0.0]);
    assert_eq!((at("tanh(x)", 1e300), at("tanh(x)", f64::NEG_INFINITY)), (1.0, -1.0));
    assert_eq!((at("sinh(x)", -800.0), at("cosh(x)", -800.0)), (f64::NEG_INFINITY, f64::INFINITY));
    for text in ["sinh(x)", "cosh(x)", "tanh(x)", "tan(x)", "abs(x)", "min(x, y)", "max(y, x)"] {
        assert!(at(text, f64::NAN).is_nan(), "{text}");
    }
}

#[test]
fn derivatives_of_sinc_have_no_cancellation() {
    let formula = formula("sinc(x)");
    for x in [0.0, 1e-9, 1e-3, 0.3, 0.999, 1.001] {
        let (mut slope, mut curvature) = ([0.0], [0.0; 2]);
        formula.gradient(&[0]).evaluate_one(&[&[x, 0.0]], &mut slope);
        hessian(&formula).evaluate_one(&[&[x, 0.0], &[1.0, 0.0]], &mut curvature);
        // Taylor series: sinc = Σ (−1)ⁿ x²ⁿ/(2n+1)!.
        let (mut first, mut second, mut factorial) = (0.0, 0.0, 1.0);
        for n in 1..15 {
            factorial *= -f64::from(2 * n * (2 * n + 1));
            first += f64::from(2 * n) * x.powi(2 * n - 1) / factorial;
            second += f64::from(2 * n * (2 * n - 1)) * x.powi(2 * n - 2) / factorial;
        }
        assert!((slope[0] - first).abs() <= 1e-15, "{x}: {} {first}", slope[0]);
        assert!((curvature[0] - second).abs() <= 4e-15, "{x}: {} {second}", curvature[0]);
    }
}

#[test]
fn degrees_are_read_off() {
    let degrees = [
        ("3", Some(0), Some(0)),
        ("x^2*y + 1", Some(2), Some(1)),
        ("(x + y)^3/7 - x*y^4", Some(3), Some(4)),
        ("x/y", Some(1), None),
        ("sin(y)*x", Some(1), None),
        ("abs(y)", Some(0), None),
        ("min(x, 1)*y", None, Some(1)),
        ("exp(ln(2))*x", Some(1), Some(0)),
        ("x^-1", None, Some(0)),
        ("0*sin(x) + y", Some(0), Some(1)),
        ("x^1.5", None, Some(0)),
    ];
    for (text, x, y) in degrees {
        let formula = formula(text);
        assert_eq!((formula.degree(&[0]), formula.degree(&[1])), (x, y), "{text}");
    }
    let pieces = formula("abs(x) + 1");
    assert!(pieces.reads() == [0].into());
}

/// The number of instructions of a tape for a text.
fn instructions(text: &str) -> usize {
    formula(text).tape.instructions().len()
}

#[test]
fn products_are_joined_with_sums() {
    let table = [
        ("x*y + x^2", 1),
        ("x*y - 3", 1),
        ("3 - x*y", 1),
        ("2*x + 3*y", 1),
        ("x - 2*y", 1),
        ("(x + y)*x", 2),
        ("(x + y)/2", 1),
        ("3*(x*y - x)", 1),
        ("x*y + x^2 + y^2", 2),
        ("sin(x) + (x*y - y^2)", 3),
        ("x*y/3", 2),
        ("x^8", 3),
        ("sin(x)*sin(x) + sin(x)", 2),
    ];
    for (text, count) in table {
        assert_eq!(instructions(text), count, "{text}");
    }
}

#[test]
fn no_product_and_sum_is_fused() {
    // x·y rounds to 1, so that a fused operation would give −2^-106.
    let (x, y) = (1.0 + f64::EPSILON * 0.5 * 2.0, 1.0 - f64::EPSILON);
    assert_eq!(formula("x*y - 1").value(&[x, y]), x * y - 1.0);
    assert_eq!(formula("x*y - x*y + 0*x").value(&[x, y]), 0.0);
}

#[test]
fn results_may_be_inputs_constants_and_each_other() {
    let mut graph = Graph::new();
    let (x, y, three) = (graph.input(0), graph.input(1), graph.constant(3.0));
    let sum = graph.add(x, y);
    let root = graph.unary(Unary::Sqrt, sum);
    let product = graph.binary(Binary::Mul, sum, root);
    let outputs = [y, three, root, product, root, sum, y, three];
    let tape = Tape::new(&graph, &outputs, &[0..1, 1..2]);
    let mut out = [0.0; 8];
    tape.evaluate_one(&[&[1.0], &[3.0]], &mut out);
    assert_eq!(out, [3.0, 3.0, 2.0, 8.0, 2.0, 4.0, 3.0, 3.0]);
    assert_eq!(tape.scratch_rows(), 0);
}

/// The two are one computation, wherever their results go; a sine alone stays so.
#[test]
fn a_sine_stands_beside_its_cosine() {
    let mut graph = Graph::new();
    let (x, y) = (graph.input(0), graph.input(1));
    let sum = graph.add(x, y);
    let [cosine, inner] = [sum, x].map(|of| graph.unary(Unary::Cos, of));
    let product = graph.mul(cosine, inner);
    let [sine, outer, alone] = [sum, x, y].map(|of| graph.unary(Unary::Sin, of));
    let both = graph.mul(outer, product);
    let tape = Tape::new(&graph, &[both, sine, alone, cosine], &[0..1, 1..2]);
    let names: Vec<String> = tape.instructions().iter().map(|one| format!("{one:?}")).collect();
    let is = |n: usize, operation: &str| names[n].contains(&format!("operation: {operation},"));
    let sines: Vec<usize> = (0..names.len()).filter(|&n| is(n, "SinBesideCos")).collect();
    assert_eq!((sines.len(), names.len()), (2, 8), "{names:?}");
    assert!(sines.iter().all(|&n| is(n + 1, "Of(Cos)")), "{names:?}");

    let point = |p: usize| [0.37 * p as f64 - 5.0, (p * p) as f64];
    let rows: [[f64; 32]; 2] = [0, 1].map(|k| std::array::from_fn(|p| point(p)[k]));
    let out = tape.rows(&[&rows[..1], &rows[1..]]);
    for p in 0..32 {
        let [x, y] = point(p);
        let ((sine, cosine), (outer, inner)) = (elementary::sin_cos(x + y), elementary::sin_cos(x));
        let exact = [outer * (cosine * inner), sine, elementary::sin(y), cosine];
        let mut one = [0.0; 4];
        tape.evaluate_one(&[&[x], &[y]], &mut one);
        assert_eq!(one.map(f64::to_bits), exact.map(f64::to_bits), "{p}");
        assert_eq!([0, 1, 2, 3].map(|k| out[k][p].to_bits()), exact.map(f64::to_bits), "{p}");
    }
}

#[test]
fn scratch_is_used_again() {
    // A long tape has an order of its own.
    for (number, factor) in [(50, "*y"), (3000, "*y"), (3000, "")] {
        let terms: Vec<String> = (0..number).map(|n| format!("sin(x + {n}){factor}")).collect();
        let rows = formula(&terms.join(" + ")).tape.scratch_rows();
        assert!(rows <= 3, "{rows}");
    }
}
