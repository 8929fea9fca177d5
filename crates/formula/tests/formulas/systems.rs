//! Poisson systems from texts against compiled ones, and what is said about wrong ones.

use formula::{Definition, DefinitionError, FormulaSystem, Structure, Which};
use real::{Row, Rows, WIDTH};
use systems::{
    Linearity, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, RigidBody, SystemError,
    run_time::{Compiled, Op, System, Weights},
};

use crate::{expression::Random, paper};

/// Relative to the largest component: a few roundings of sums of a few terms.
const ROUNDING: f64 = 1e-14;

struct Pair {
    formula: FormulaSystem,
    compiled: Box<dyn System>,
}

fn rows(random: &mut Random, count: usize, scale: f64, shift: f64) -> Rows {
    let mut rows = Rows::zero(count);
    rows.iter_mut().flatten().for_each(|x| *x = shift + scale * random.number());
    rows
}

fn assert_near(ours: &[Row], theirs: &[Row], tolerance: f64, what: &str) {
    let flat = |rows: &[Row]| rows.as_flattened().to_vec();
    let (ours, theirs) = (flat(ours), flat(theirs));
    let scale = theirs.iter().fold(0.0, |scale: f64, x| scale.max(x.abs()));
    for (ours, theirs) in ours.iter().zip(&theirs) {
        assert!((ours - theirs).abs() <= tolerance * scale, "{what}: {ours} {theirs} of {scale}");
    }
}

impl Pair {
    fn new(definition: &Definition, y0: &[f64], compiled: impl System + 'static) -> Self {
        let formula = FormulaSystem::new(definition, y0).unwrap();
        Self { formula, compiled: Box::new(compiled) }
    }

    /// Compares every method near 1.5 in each component.
    fn agree(&self, tolerance: f64) {
        let systems: [&dyn System; 2] = [&self.formula, &*self.compiled];
        let (ours, theirs) = (self.formula.description(), self.compiled.description());
        let (d, name) = (ours.dimension, &ours.name);
        assert_eq!(ours.noises, theirs.noises);
        let mut random = Random::new(5);
        let y = rows(&mut random, d, 0.5, 1.5);
        let (u, v) = (rows(&mut random, d, 1.0, 0.0), rows(&mut random, d, 0.1, 0.0));
        let dw = rows(&mut random, ours.noises, 0.1, 0.0);
        let areas = rows(&mut random, ours.noises * ours.noises, 1.0, 0.0);
        let h = Weights { dt: 0.01, dw: &dw, areas: &areas, ..Weights::NONE };
        let affine = theirs.linearity != Linearity::Other;
        let (y, u, v): (&[Row], &[Row], &[Row]) = (&y, &u, &v);
        let mut ops = vec![
            Op::Structure { y, v },
            Op::StructureAlong { y, u, v },
            Op::Gradient { y },
            Op::Hessian { y, u },
            Op::AveragedField { a: y, b: v },
            Op::AveragedHessian { a: y, b: v, u },
            Op::ItoCorrection { y },
        ];
        if affine {
            ops.push(Op::Cayley { y, v });
        }
        if ours.noises > 1 {
            ops.push(Op::AreaGradient { y });
        }
        // And h.
        for (number, op) in ops.into_iter().map(Some).chain([None]).enumerate() {
            let [found, expected] = systems.map(|system| {
                let mut out = Rows::zero(d);
                let mut scratch = Rows::zero(system.description().scratch_rows());
                scratch.fill([f64::NAN; WIDTH]);
                match op {
                    Some(op) => system.apply(op, 0..d, h, &mut out, &mut scratch),
                    None => system.energy(y, h, &mut out[0], &mut scratch),
                }
                out
            });
            // The averaged gradient of the compiled system may be a closed form.
            assert_near(&found, &expected, tolerance, &format!("{name}: {number}"));
        }
        assert_eq!(ours.linearity, theirs.linearity, "{name}");
        assert_eq!(ours.always_solvable, theirs.always_solvable, "{name}");
    }
}

#[test]
fn the_systems_of_the_paper_are_the_compiled_ones() {
    let y3 = [1.0, 1.2, 0.8];
    let (inertia, noise) = ([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]);
    let body = RigidBody::three_noises(inertia, noise).unwrap();
    let body = Pair::new(&paper::rigid_body(inertia, noise), &y3, Compiled::new(body, y3));
    body.agree(ROUNDING);
    assert!(body.formula.description().is_quadratic());

    let pendulum = Compiled::new(Pendulum::new(0.5).unwrap(), [0.2, 1.0]);
    Pair::new(&paper::pendulum(0.5), &[0.2, 1.0], pendulum).agree(1e-13);

    let populations = LotkaVolterra::<2, 2>::new(0.5).unwrap();
    let populations = Compiled::new(populations, y3);
    let populations = Pair::new(&paper::lotka_volterra(0.5), &y3, populations);
    // ∇H has degree 4.
    assert_eq!(populations.formula.description().rule.nodes().len(), 3);
    populations.agree(1e-13);

    Pair::new(&paper::maxwell_bloch(), &y3, Compiled::new(MaxwellBloch, y3)).agree(ROUNDING);
    let poisson = Compiled::new(Poisson3::new(0.5).unwrap(), y3);
    Pair::new(&paper::poisson3(0.5), &y3, poisson).agree(1e-13);
}

/// `count` words.
fn words(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|&text| text.to_owned()).collect()
}

/// The definition of a chain of rigid bodies, with B block diagonal and given in full.
fn bodies(count: usize) -> Definition {
    let y = |body: usize, i: usize| format!("y{body}_{i}");
    let mut structure = vec![vec!["0".to_owned(); 3 * count]; 3 * count];
    for body in 0..count {
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            structure[3 * body + i][3 * body + j] = format!("-{}", y(body, k));
            structure[3 * body + j][3 * body + i] = y(body, k);
        }
    }
    let squares = (0..count).flat_map(|body| (0..3).map(move |i| (body, i)));
    let energy: Vec<String> =
        squares.map(|(body, i)| format!("{}*{}^2", i + 1, y(body, i))).collect();
    Definition {
        name: "bodies".into(),
        state: (0..count).flat_map(|body| (0..3).map(move |i| y(body, i))).collect(),
        structure: structure.into(),
        energy: energy.join(" + "),
        noises: vec![format!("{}^2/2", y(0, 0)), format!("{}*{}", y(0, 1), y(count - 1, 2))],
        ..Definition::default()
    }
}

/// so(4), in an order in which elimination makes entries where there were none.
fn rotations() -> Definition {
    let planes = [(1, 3), (1, 2), (1, 4), (2, 3), (2, 4), (3, 4)];
    // {L_ij, L_kl} is the L of the two other axes if the planes share one, with a sign.
    let bracket = |(i, j): (usize, usize), (k, l): (usize, usize)| -> Option<String> {
        let (first, last, sign) = match () {
            () if j == k => (i, l, 1),
            () if i == l => (j, k, 1),
            () if i == k => (j, l, -1),
            () if j == l => (i, k, -1),
            () => return None,
        };
        let (sign, first, last) =
            if first < last { (sign, first, last) } else { (-sign, last, first) };
        Some(format!("{sign}*L{first}{last}"))
    };
    let pairs = (0..6).flat_map(|m| (m + 1..6).map(move |n| (m, n)));
    let entries = pairs.filter_map(|(m, n)| Some(((m, n), bracket(planes[m], planes[n])?)));
    Definition {
        name: "so(4)".into(),
        state: planes.map(|(i, j)| format!("L{i}{j}")).to_vec(),
        structure: Structure::Entries(entries.collect()),
        energy: "L12^2 + 2*L34^2".into(),
        ..Definition::default()
    }
}

/// Eliminations of all sizes solve z = y + B((y+z)/2)v.
#[test]
fn the_linearly_implicit_step_is_solved_in_every_dimension() {
    for (definition, d) in [1, 2, 3, 9, 12]
        .map(|count| (bodies(count), 3 * count))
        .into_iter()
        .chain([(rotations(), 6)])
    {
        let y0: Vec<f64> = (0..d).map(|i| 0.3 + 0.1 * i as f64).collect();
        let system = FormulaSystem::new(&definition, &y0).unwrap();
        assert!(
            system.description().linearity == Linearity::Affine
                && system.description().always_solvable
        );
        let mut random = Random::new(9);
        let (y, v) = (rows(&mut random, d, 1.0, 0.0), rows(&mut random, d, 0.5, 0.0));
        let mut scratch = Rows::zero(system.description().scratch_rows());
        let (mut z, mut field) = (Rows::zero(d), Rows::zero(d));
        system.apply(Op::Cayley { y: &y, v: &v }, 0..d, Weights::NONE, &mut z, &mut scratch);
        let mut middle = Rows::zero(d);
        for i in 0..d {
            middle[i] = std::array::from_fn(|p| 0.5 * (y[i][p] + z[i][p]));
        }
        let op = Op::Structure { y: &middle[..], v: &v };
        system.apply(op, 0..d, Weights::NONE, &mut field, &mut scratch);
        for i in 0..d {
            for p in 0..WIDTH {
                let defect = z[i][p] - y[i][p] - field[i][p];
                assert!(defect.abs() < 1e-13, "dimension {d}: {defect:e}");
            }
        }
    }
}

fn harmonic() -> Definition {
    Definition {
        name: "harmonic".into(),
        state: words(&["p", "q"]),
        parameters: vec![("c".into(), 2.0)],
        structure: vec![words(&["0", "-c*q"]), words(&["c*q", "0"])].into(),
        energy: "(p^2 + q^2)/2".into(),
        noises: words(&["q"]),
        ..Definition::default()
    }
}

fn error(change: impl FnOnce(&mut Definition)) -> DefinitionError {
    let mut definition = harmonic();
    change(&mut definition);
    FormulaSystem::new(&definition, &[3.0, 4.0]).err().expect("an error")
}

/// The rows of B.
fn texts(definition: &mut Definition) -> &mut Vec<Vec<String>> {
    match &mut definition.structure {
        Structure::Rows(rows) => rows,
        Structure::Entries(_) => unreachable!("it has rows"),
    }
}

#[test]
fn wrong_definitions_are_named() {
    type Change = fn(&mut Definition);
    let table: [(Change, &str); 14] = [
        (
            |d| d.structure = Structure::Entries([((0, 2), "c*q".into())].into()),
            "an entry of B has row < column < 2, counted from 0, got row 0, column 2",
        ),
        (
            |d| d.structure = Structure::Entries([((1, 0), "c*q".into())].into()),
            "an entry of B has row < column < 2, counted from 0, got row 1, column 0",
        ),
        (|d| d.state[1] = "p".into(), "`p` is given twice, or a constant"),
        (|d| d.parameters[0].1 = f64::INFINITY, "the parameter `c` must be finite, got inf"),
        (|d| d.state.truncate(1), "the initial value must have 1 components, got 2"),
        (
            |d| texts(d)[1].truncate(1),
            "B must have 2 rows of 2 entries, or its entries above \
             the diagonal in rows of 1 to 1; its rows have [2, 1]",
        ),
        (
            |d| texts(d)[0][1] = "-c*q + 2r".into(),
            "B, row 1, column 2: line 1, column 9: an operator is missing: write 2*r\n  \
             -c*q + 2r\n          ^",
        ),
        (
            |d| texts(d)[1][0] = "c*p".into(),
            "B is not skew: row 1, column 2 is -8, and row 2, column 1 is 6, at y = [3.0, 4.0]",
        ),
        (
            |d| texts(d)[0][0] = "p".into(),
            "B is not skew: row 1, column 1 is 3, and row 1, column 1 is 3, at y = [3.0, 4.0]",
        ),
        (
            |d| d.energy = "ln(p - q)".into(),
            "H0: line 1, column 1: this is NaN for -1 at the initial value\n  \
             ln(p - q)\n  ^^^^^^^^^",
        ),
        (
            |d| d.energy = "sqrt(p - 3)".into(),
            "the derivative of H0 by p is inf at the initial value",
        ),
        (
            |d| d.noises[0] = "sqrt(q - 4)".into(),
            "the derivative of H, noise 1 by q is inf at the initial value",
        ),
        (
            |d| d.noises[0] = "qq".into(),
            "H, noise 1: line 1, column 1: unknown name `qq`; the nearest is `q`\n  qq\n  ^^",
        ),
        (
            |d| texts(d)[0][1] = "1/(p - 3)".into(),
            "B, row 1, column 2: line 1, column 1: this is inf for 1 and 0 at the initial \
             value\n  1/(p - 3)\n  ^^^^^^^^^",
        ),
    ];
    for (change, message) in table {
        assert_eq!(error(change).to_string(), message);
    }
    let none = FormulaSystem::new(&Definition::default(), &[]).err().unwrap();
    assert_eq!((none.which, &*none.message), (Which::State, "the state has no component"));
    let nan = FormulaSystem::new(&harmonic(), &[3.0, f64::NAN]).err().unwrap();
    assert_eq!(nan.to_string(), "the initial value must be finite, got q = NaN");
    let wrong = error(|d| d.noises[0] = "2q".into());
    assert_eq!((wrong.which, wrong.formula.unwrap().column), (Which::Noise(1), 2));
}

#[test]
fn skewness_is_found_where_only_numbers_show_it() {
    let system = |entry: &str| {
        let structure = vec![words(&["0", "(p + q)^2"]), words(&[entry, "0"])];
        FormulaSystem::new(&Definition { structure: structure.into(), ..harmonic() }, &[3.0, 4.0])
    };
    assert!(system("-p^2 - q*(2*p + q)").is_ok());
    let error = system("-p^2 - q*(2*p + q*1.0000001)").err().unwrap();
    assert_eq!(error.which, Which::Structure(1, 2), "{error}");
}

#[test]
fn a_point_outside_of_the_domain_is_named() {
    let definition = Definition { energy: "p^2/2 + ln(q)".into(), ..harmonic() };
    let system = FormulaSystem::new(&definition, &[3.0, 4.0]).unwrap();
    let description = system.description();
    assert_eq!((&*description.name, &*description.parameters), ("harmonic", "c = 2"));
    assert_eq!(system.check_domain(&[1.0, 1.0]), Ok(()));
    let error = system.check_domain(&[1.0, -1.0]).unwrap_err();
    assert_eq!(error, SystemError::outside_domain(1, 1.0, "that all formulas are finite"));
}

/// ∇̄h(a, b)·(b − a) = h(b) − h(a) for polynomials, sines and cosines, however far b is from a.
#[test]
fn averaged_gradients_keep_the_energy() {
    let mut definition = harmonic();
    definition.energy = "p^6*q/7 - 3*cos(2*p - q/3 + 1) + (p + q)^2 - (2 - sin(q))".into();
    definition.noises = vec!["p*q^3 + sin(p + c*q)".into(), "2*sin(p + c*q) - p".into()];
    let system = FormulaSystem::new(&definition, &[0.3, 0.4]).unwrap();
    let mut random = Random::new(23);
    let (a, b) = (rows(&mut random, 2, 0.7, 0.0), rows(&mut random, 2, 0.7, 0.5));
    let dw = rows(&mut random, 2, 1.0, 0.0);
    let h = Weights { dt: 0.3, dw: &dw, ..Weights::NONE };
    let mut scratch = Rows::zero(system.description().scratch_rows());
    let (mut mean, mut start, mut end) = (Rows::zero(2), [0.0; WIDTH], [0.0; WIDTH]);
    system.apply(Op::AveragedGradient { a: &a, b: &b }, 0..2, h, &mut mean, &mut scratch);
    system.energy(&a, h, &mut start, &mut scratch);
    system.energy(&b, h, &mut end, &mut scratch);
    for p in 0..WIDTH {
        let work: f64 = (0..2).map(|i| mean[i][p] * (b[i][p] - a[i][p])).sum();
        let change = end[p] - start[p];
        let scale = 1.0 + start[p].abs() + end[p].abs() + work.abs();
        assert!((work - change).abs() < 2e-14 * scale, "{work} {change}");
    }
}

/// The commutators of noises are −B times the gradient of their brackets where B is a Poisson
/// structure, and need not be where it is skew only.
#[test]
fn jacobi_is_shown_or_not() {
    let definition = |structure: [&[&str]; 2], noises: &[&str]| Definition {
        name: "three".into(),
        state: words(&["x", "y", "z"]),
        structure: structure.map(words).to_vec().into(),
        energy: "x^2/2 + y^2 + z".into(),
        noises: words(noises),
        ..Definition::default()
    };
    let holds = |structure, noises| {
        let system = FormulaSystem::new(&definition(structure, noises), &[0.6, 0.7, 0.8]).unwrap();
        system.description().jacobi_holds
    };
    let quadratic: &[&str] = &["x^2/2 + y*z", "sin(y) + exp(z)", "x"];
    let body: [&[&str]; 2] = [&["-z", "y"], &["-x"]];
    assert!(holds(body, quadratic) && holds(body, &["x"]));
    // Bv = b × v with b = (−y, x, 1), and b·curl b = 2.
    let skew: [&[&str]; 2] = [&["-1", "x"], &["y"]];
    assert!(!holds(skew, &["x", "y", "z"]));
    // Pieces may act where no point is.
    assert!(!holds(body, &["x*abs(y*z - x)", "y*z + x^2"]));
}

#[test]
fn conditions_are_refused_where_derivatives_are_needed() {
    let definition = |entry: &str, energy: &str| Definition {
        state: vec!["q".into(), "p".into()],
        structure: vec![vec![entry.into()]].into(),
        energy: energy.into(),
        ..Definition::default()
    };
    assert!(FormulaSystem::new(&definition("1", "p^2/2 + abs(q)"), &[1.0, 0.0]).is_ok());
    for (entry, energy, which, place) in [
        ("1", "p^2/2 + if(q > 0, q, -q)", Which::Energy, 11..16),
        ("if(q < 2, 1, 2)", "p^2/2", Which::Structure(1, 2), 3..8),
    ] {
        let error = FormulaSystem::new(&definition(entry, energy), &[1.0, 0.0]).err().unwrap();
        let formula = error.formula.unwrap();
        assert_eq!(error.which, which);
        assert!(formula.message.contains("not smooth"), "{formula}");
        assert_eq!(formula.span, place);
    }
}
