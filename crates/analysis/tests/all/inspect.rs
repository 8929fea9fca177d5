//! `inspect` says what the paper's systems are, and finds what is wrong with spoiled ones.

use inspect::{Applies, InspectError, InspectSettings, Inspection};
use real::{Real, elementary};
use systems::{
    Constant, Form, HamiltonianIncrement, Invariant, InvariantKind, LotkaVolterra, MaxwellBloch,
    Pendulum, Poisson3, PoissonSystem, Problem, RigidBody, RigidBodyEnergy, Sine, SystemError,
};

use super::{
    applies, casimirs, inspect_alone as inspect, inspect_around, inspect_problem,
    system as formulas, texts,
};

const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];

type PaperLotkaVolterra = LotkaVolterra<2, 2>;

/// One row of the table of systems: dimensions, noises, Casimirs of B, degree of the energy where
/// it has a law.
fn row(
    report: &Inspection,
    dimension: usize,
    noises: usize,
    expected: &[&str],
    energy: Option<f64>,
) {
    assert!(report.mistakes.is_empty(), "{report}");
    assert!(report.structure.skew.holds() && report.structure.jacobi.holds(), "{report}");
    assert_eq!((report.dimension, report.noises), (dimension, noises), "{report}");
    assert_eq!(casimirs(report), expected, "{report}");
    let hamiltonians = &report.hamiltonians;
    let degree = hamiltonians.shapes[0].degree.filter(|_| hamiltonians.proportional.holds());
    assert_eq!(degree, energy, "{report}");
    assert!(hamiltonians.discrete_gradient.holds(), "{report}");
}

/// (degree, m(F) > 0) of a claimed invariant.
fn claimed(report: &Inspection, name: &str) -> (Option<f64>, bool) {
    let invariant = report
        .invariants
        .iter()
        .find(|invariant| invariant.name == name)
        .expect("a claimed invariant");
    let shape = &invariant.shape;
    (shape.degree, shape.minimum.is_some_and(|minimum| minimum.positive.holds()))
}

#[test]
fn the_table_of_systems_is_reproduced() {
    let sphere = "0.5 y1² + 0.5 y2² + 0.5 y3²";

    let pendulum = inspect(&Pendulum::new(0.7).unwrap()).unwrap();
    row(&pendulum, 2, 1, &[], None);
    assert!(pendulum.hamiltonians.proportional.holds());
    assert!(pendulum.structure.constant.holds() && pendulum.invariants.is_empty());
    assert_eq!(applies(&pendulum, "exact-conformal"), Some(Applies::No));

    let three = inspect(&RigidBody::three_noises(INERTIA, [1.0, 2.0, 3.0]).unwrap()).unwrap();
    row(&three, 3, 3, &[sphere], None);
    assert_eq!(claimed(&three, "C"), (Some(2.0), true));
    assert!(!three.noise.commute.holds() && !three.structure.constant.holds());
    assert_eq!(
        (three.order("sexp"), three.order("sexp-levy")),
        (Some((0.5, 1.0)), Some((1.0, 1.0)))
    );
    assert_eq!(applies(&three, "strong-half"), Some(Applies::Yes));
    assert_eq!(applies(&three, "strong-one"), None);
    // m(H₀) > 0 and m(Hₘ) = 0, as the paper's remark says.
    let positive: Vec<bool> =
        three.hamiltonians.shapes.iter().map(|h| h.minimum.unwrap().positive.holds()).collect();
    assert_eq!(positive, [true, false, false, false]);

    let one = inspect(&RigidBody::one_noise(INERTIA, 1.5).unwrap()).unwrap();
    row(&one, 3, 1, &[sphere], None);
    assert_eq!(
        (applies(&one, "strong-one"), applies(&one, "energy-balance")),
        (Some(Applies::Yes), Some(Applies::No))
    );
    assert_eq!((one.order("sexp"), one.order("em")), (Some((1.0, 1.0)), Some((0.5, 1.0))));

    let energy = inspect(&RigidBodyEnergy::new(INERTIA, 0.7).unwrap()).unwrap();
    row(&energy, 3, 1, &[sphere], Some(2.0));
    assert_eq!(claimed(&energy, "H"), (Some(2.0), true));
    assert_eq!(applies(&energy, "energy-balance"), Some(Applies::Yes));

    let lotka = inspect(&PaperLotkaVolterra::new(1.0).unwrap()).unwrap();
    row(&lotka, 3, 1, &["2 y1 + y2 + y3"], Some(5.0));
    assert_eq!(claimed(&lotka, "H"), (Some(5.0), false));
    assert_eq!(claimed(&lotka, "C"), (Some(1.0), false));
    // The positive cone is seen at points, and not as a formula.
    assert_eq!(applies(&lotka, "moment-bound"), Some(Applies::Conditionally));

    let maxwell = inspect(&MaxwellBloch).unwrap();
    row(&maxwell, 3, 1, &["0.5 y2² + 0.5 y3²"], None);
    assert_eq!(claimed(&maxwell, "C"), (Some(2.0), false));
    assert_eq!(applies(&maxwell, "moment-bound"), Some(Applies::No));

    let poisson = inspect(&Poisson3::new(1.0).unwrap()).unwrap();
    row(&poisson, 3, 1, &["y1 + y2 + y3"], None);
    assert_eq!(claimed(&poisson, "C"), (Some(2.0), false));
    assert_eq!(claimed(&poisson, "S"), (Some(1.0), false));
    // A sum of components of any sign bounds nothing.
    assert_eq!(applies(&poisson, "moment-bound"), Some(Applies::No));
    // Where B is constant, sexp-li is explicit.
    assert_eq!(pendulum.recommended[1].scheme, "sexp");
}

/// The Lotka–Volterra system with the Casimir that the paper names, ab ln y₁ − b ln y₂ + ln y₃.
#[derive(Clone)]
struct AsPrinted;
const A: f64 = -0.7;
const B: f64 = -1.9;

impl PoissonSystem<3, 1> for AsPrinted {
    fn name(&self) -> &'static str {
        "lotka-volterra as printed"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let p = A * B;
        let prefactor = (y[0].ln() * (1.0 - p) + y[1].ln() * (1.0 + B)).exp();
        [v[1] * A + v[2], -(v[0] * A + v[2] * p), v[1] * p - v[0]].map(|v| prefactor * v)
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        self.invariant(0, y).exp() * (dt + dw[0])
    }
    fn check_domain(&self, y: [f64; 3]) -> Result<(), SystemError> {
        LotkaVolterra::<1, 1>::new(1.0)?.check_domain(y)
    }
    fn invariants(&self) -> Vec<Invariant> {
        let formula = "ab ln y₁ − b ln y₂ + ln y₃";
        vec![Invariant {
            name: "C",
            formula,
            kind: InvariantKind::Casimir,
            form: Form::Homogeneous,
            degree: 1.0,
        }]
    }
    fn invariant<R: Real>(&self, _index: usize, y: [R; 3]) -> R {
        y[0].ln() * (A * B) - y[1].ln() * B + y[2].ln()
    }
}

#[test]
fn the_misprinted_casimir_is_found_and_the_true_one_named() {
    let report = inspect(&AsPrinted).unwrap();
    let printed = &report.invariants[0];
    // B∇ ln H = B∇H/H is the vector field itself; ln H is constant along it, and not homogeneous.
    assert!(!printed.casimir.holds() && printed.casimir.defect > 1e-3, "{report}");
    assert!(printed.conserved.holds() && printed.shape.degree.is_none());
    assert_eq!(report.mistakes.len(), 2, "{report}");
    assert!(report.mistakes[0].contains("is claimed as a Casimir and is none"), "{report}");
    assert!(report.mistakes[0].contains("a function of the Hamiltonian"), "{report}");
    let text = report.to_string();
    for words in [
        "D = 3, M = 1; 24 points with |yᵢ| ≤ 2 in its domain\n",
        "C        ab ln y₁ − b ln y₂ + ln y₃: Casimir (WRONG, see below); not homogeneous (",
        "y3; m = 1.0000e0 > 0 on the domain; B∇C = 0 to ",
        "  1 / 1: sexp, sexp-levy, sexp-li,",
        "Take sexp for paths: it keeps the laws of Casimirs, and the law of the energy; the energy \
         up to the error of ∇̄h\n",
        "\nMistakes\n  - C = ab ln y₁ − b ln y₂ + ln y₃ is claimed as a Casimir and is none",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }

    // ab y₁ + y₂ − a y₃, up to a factor.
    let casimir = &report.casimirs.as_ref().unwrap().found[0];
    assert_eq!(casimir.form.degree, 1);
    let factor = casimir.form.coefficients[1];
    for (found, exact) in casimir.form.coefficients.iter().zip([A * B, 1.0, -A]) {
        assert!((found / factor - exact).abs() < 1e-9, "{}", casimir.formula);
    }
    assert!(casimir.minimum.positive.holds() && casimir.minimum.in_domain_only);
}

/// One thing wrong with a rigid body.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// A sign in B.
    Sign,
    /// B(y) = y₁J with J that couples y₂ and y₁ only, plus a constant part: skew, but not Jacobi's.
    NotJacobi,
    /// |v| in B(y)v.
    NotLinear,
    /// dt² in the energy.
    EnergyNotLinear,
    Gradient,
    AveragedGradient,
    /// ∇̄ at an end point: right at a = b and nowhere else.
    OneSided,
    AveragedField,
    Degree,
    /// H₀ as an energy beside noises that change it.
    Energy,
    /// Two invariants are listed, and one is implemented.
    MissingInvariant,
    /// A skew defect of 1e-9 beside an entry of 1e4.
    NotSkew,
    /// H + 1e6 with a quartic H and the midpoint as ∇̄h.
    Offset,
    /// NaN in the energy.
    NaN,
    /// Nowhere defined.
    Nowhere,
}

#[derive(Clone)]
struct Spoiled(Fault);

fn body() -> RigidBody<3> {
    RigidBody::three_noises(INERTIA, [1.0, 2.0, 3.0]).unwrap()
}

impl PoissonSystem<3, 3> for Spoiled {
    fn name(&self) -> &'static str {
        "spoiled"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let mut result = body().structure(y, v);
        match self.0 {
            Fault::Sign => result[2] = y[0] * v[1] + y[1] * v[0],
            Fault::NotJacobi => {
                result = [v[1] * y[0] + v[2], -(v[0] * y[0]) + v[2] * y[1], -v[0] - v[1] * y[1]]
            }
            Fault::NotLinear => result[0] = result[0] + v[0] * v[0],
            Fault::NotSkew => {
                result[0] = result[0] + v[1] * 1e4;
                result[1] = result[1] - v[0] * 1e4;
                result[2] = result[2] + v[2] * 1e-9;
            }
            _ => {}
        }
        result
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 3]) -> R {
        match self.0 {
            Fault::EnergyNotLinear => body().energy(y, dt * dt, dw),
            Fault::NaN => (y[0] - 1.0).ln() * dt,
            Fault::Offset => body().energy(y, dt, dw) + (y[0].powi(4) * 0.25 + 1e6) * dt,
            _ => body().energy(y, dt, dw),
        }
    }
    fn gradient<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 3]) -> [R; 3] {
        let mut gradient = real::gradient(&HamiltonianIncrement { system: self, dt, dw }, y);
        if self.0 == Fault::Gradient {
            gradient[1] = gradient[1] * 1.000_001;
        }
        gradient
    }
    fn averaged_gradient<R: Real>(&self, a: [R; 3], b: [R; 3], dt: f64, dw: [f64; 3]) -> [R; 3] {
        let at = if self.0 == Fault::OneSided { b } else { dgrad::midpoint(a, b) };
        let dt = if self.0 == Fault::AveragedGradient { 1.01 * dt } else { dt };
        real::gradient(&HamiltonianIncrement { system: self, dt, dw }, at)
    }
    fn averaged_field<R: Real>(&self, a: [R; 3], b: [R; 3], dt: f64, dw: [f64; 3]) -> [R; 3] {
        let at = if self.0 == Fault::AveragedField { a } else { dgrad::midpoint(a, b) };
        self.structure(at, self.averaged_gradient(a, b, dt, dw))
    }
    fn invariants(&self) -> Vec<Invariant> {
        let mut casimir = body().invariants()[0];
        match self.0 {
            Fault::NotJacobi | Fault::Sign | Fault::NotSkew => return Vec::new(),
            Fault::Degree => casimir.degree = 3.0,
            Fault::Energy => casimir.kind = InvariantKind::Energy,
            Fault::MissingInvariant => return vec![casimir; 2],
            _ => {}
        }
        vec![casimir]
    }
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        match self.0 {
            Fault::Energy => body().energy(y, 1.0, [0.0; 3]),
            _ if index > 0 => y[0] * f64::NAN,
            _ => body().invariant(index, y),
        }
    }
    fn check_domain(&self, y: [f64; 3]) -> Result<(), SystemError> {
        let refused = SystemError::outside_domain(1, y[0], "nothing");
        if self.0 == Fault::Nowhere { Err(refused) } else { Ok(()) }
    }
}

#[test]
fn every_mistake_is_named() {
    assert!(inspect(&Spoiled(Fault::None)).unwrap().mistakes.is_empty());
    for (fault, words) in [
        (Fault::Sign, "B(y) is not skew-symmetric"),
        (Fault::NotLinear, "structure(y, v) is not linear in v"),
        (Fault::EnergyNotLinear, "energy(y, dt, dw) is not linear"),
        (Fault::Gradient, "gradient is not the gradient of energy"),
        (Fault::AveragedGradient, "averaged_gradient(y, y) is not the gradient"),
        (Fault::OneSided, "is not the change of energy"),
        (Fault::Offset, "is not the change of energy"),
        (Fault::AveragedField, "averaged_field(a, b) is not structure"),
        (Fault::Degree, "is claimed to have degree 3 and has degree 2"),
        (Fault::Energy, "is claimed as an energy, and the flow changes it"),
        (Fault::MissingInvariant, "is listed, but invariant(1, y) returns NaN in the domain"),
    ] {
        let report = inspect(&Spoiled(fault)).unwrap();
        assert!(report.mistakes.iter().any(|mistake| mistake.contains(words)), "{words}: {report}");
        assert!(report.to_string().contains(words));
        // One mistake is one line, but for those that spoil what is derived from them.
        if !matches!(
            fault,
            Fault::Sign | Fault::NotLinear | Fault::EnergyNotLinear | Fault::AveragedGradient
        ) {
            assert_eq!(report.mistakes.len(), 1, "{report}");
        }
    }
}

#[test]
fn a_wrong_structure_is_reported() {
    let report = inspect(&Spoiled(Fault::Sign)).unwrap();
    for statement in
        ["exact-conformal", "conformal-casimir", "moment-bound", "strong-half", "weak-one"]
    {
        assert_eq!(applies(&report, statement), Some(Applies::No), "{report}");
    }
    assert!(report.to_string().contains("NOT skew-symmetric"));
    // A small defect beside a large entry, relative to its own terms.
    let skew = inspect(&Spoiled(Fault::NotSkew)).unwrap().structure.skew;
    assert!(skew.fails() && skew.defect == 1.0, "{skew}");
    // Without Jacobi's identity there is no mistake.
    let report = inspect(&Spoiled(Fault::NotJacobi)).unwrap();
    let b = &report.structure;
    assert!(!b.jacobi.holds() && b.skew.holds() && report.mistakes.is_empty(), "{report}");
    assert!(report.to_string().contains("no Jacobi identity"), "{report}");
}

#[test]
fn what_cannot_be_looked_at_is_refused() {
    assert_eq!(
        inspect(&Spoiled(Fault::Nowhere)),
        Err(InspectError::NoPoints { found: 0, wanted: 24 })
    );
    let error = inspect(&Spoiled(Fault::NaN)).unwrap_err();
    assert!(
        matches!(&error, InspectError::NotFinite { .. })
            && error.to_string().contains("NaN at y = ["),
        "{error}"
    );
}

#[test]
fn casimirs_of_parts_are_summed_to_a_bound() {
    // Two bodies, turned by the same noises.
    let rows = ["-c b 0 0 0", "-a 0 0 0", "0 0 0", "-f e", "-d"];
    let energy = "c*f + (a^2 + d^2)/4 + (b^2 + e^2)/2 + 0.75*(c^2 + f^2)";
    let bodies =
        texts("a b c d e f", &rows, energy, &["0.7*a+0.7*d", "0.7*b+0.7*e", "0.7*c+0.7*f"]);
    let report =
        inspect::inspect(&formulas(&bodies, &[1.0; 6]), &InspectSettings::default()).unwrap();
    assert!(report.mistakes.is_empty() && !report.noise.commute.holds(), "{report}");
    let all = report.casimirs.as_ref().unwrap();
    let definite = all.found.iter().filter(|casimir| casimir.minimum.positive.holds());
    assert_eq!((all.found.len(), definite.count()), (2, 0));
    let sum = all.definite.as_ref().unwrap();
    assert!((sum.minimum.value - 0.5).abs() < 1e-12, "{report}");
    assert_eq!(applies(&report, "strong-half"), Some(Applies::Yes), "{report}");
    let words = format!("    a positive definite sum: {}, m = 5.0000e-1 > 0", sum.formula);
    assert!(report.to_string().contains(&words), "{report}");
}

/// B joins 25 components; quadratic Casimirs are sought among 24 at most.
#[test]
fn a_search_that_was_left_out_is_not_complete() {
    let complete = |d: usize| {
        let entry = |i: usize, j: usize| if j == i + 1 { format!("y{i}") } else { "0".into() };
        let row = |i: usize| (i + 1..d).map(|j| entry(i, j)).collect::<Vec<_>>().join(" ");
        let rows: Vec<String> = (0..d - 1).map(row).collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let state = (0..d).map(|i| format!("y{i} ")).collect::<String>();
        let y0 = vec![1.0; d];
        let report = inspect_around(&formulas(&texts(&state, &rows, "y0^2", &[]), &y0), &y0);
        report.unwrap().casimirs.unwrap().complete
    };
    assert_eq!([4, 25].map(complete), [true, false]);
}

#[test]
fn a_problem_knows_its_radius_and_its_largest_step() {
    // γ < 0 pumps: the radius is reached at the time of the least ∫γ, here T.
    let y0 = [0.6, 0.0, 0.8];
    let problem = Problem::new(body(), Constant::new(-0.5).unwrap(), y0, 2.0).unwrap();
    let report = inspect_problem(&problem).unwrap();
    let radius = report.problem.as_ref().unwrap().radius.unwrap();
    assert!((radius - elementary::exp(1.0)).abs() < 1e-12, "{radius}");

    // Lotka–Volterra, where the paper has no bound: 2·0.2 + 0.4 + 0.6 = 1.4, and γ = sin t never
    // pumps.
    let problem = Problem::new(
        PaperLotkaVolterra::new(1.0).unwrap(),
        Sine::new(1.0, 1.0).unwrap(),
        [0.2, 0.4, 0.6],
        10.0,
    );
    let report = inspect_problem(&problem.unwrap()).unwrap();
    let radius = report.problem.as_ref().unwrap().radius.unwrap();
    assert!((radius - 1.4).abs() < 1e-12, "{report}");
    let words = "stay within ‖y‖ ≤ 1.4000 while they are in the domain\n";
    assert!(report.to_string().contains(words), "{report}");

    // Nothing bounds the pendulum.
    let pendulum = Pendulum::new(1.0).unwrap();
    let problem = Problem::new(pendulum, Constant::new(2.0).unwrap(), [0.2, 1.0], 1.0).unwrap();
    let report = inspect_problem(&problem).unwrap();
    assert_eq!(report.problem.as_ref().unwrap().radius, None);
}

#[test]
fn a_report_is_data() {
    let report = inspect(&MaxwellBloch).unwrap();
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["system"], "maxwell-bloch");
    assert_eq!(json["structure"]["skew"]["status"], "holds");
    assert_eq!(json["casimirs"]["found"][0]["degree"], 2);
    assert_eq!(json["theorems"][3]["applies"], "no");
    assert_eq!(report, inspect(&MaxwellBloch).unwrap());
}

#[test]
fn a_report_reads_like_this() {
    let problem = Problem::new(body(), Constant::new(-0.5).unwrap(), [0.6, 0.0, 0.8], 2.0).unwrap();
    let text = inspect_problem(&problem).unwrap().to_string();
    let expected = [
        "rigid-body: D = 3, M = 3; 29 points with ‖y‖ ≤ 2.0000",
        concat!(
            "  B(y)     skew-symmetric (exactly); depends on y; Jacobi identity (to 2e-16 of ",
            "its terms)"
        ),
        "  H0       homogeneous of degree 2 (exactly), m = 2.5000e-1 > 0",
        "  H1       homogeneous of degree 2 (exactly), m = about 0",
        "  H2       homogeneous of degree 2 (exactly), m = about 0",
        "  H3       homogeneous of degree 2 (exactly), m = about 0",
        "  ∇̄h       exact (to 3e-16 of its terms)",
        "  noises   no multiples of H0 (off by 1.0e0 of its terms at [-0.117, -0.689, -1.167])",
        concat!(
            "           do not commute: strong order 1 needs Lévy areas (off by 1.0e0 of its ",
            "terms at [0.600, 0.000, 0.800])"
        ),
        concat!(
            "  C        ½(y₁² + y₂² + y₃²): Casimir (holds); homogeneous of degree 2 ",
            "(exactly), m = 5.0000e-1 > 0"
        ),
        "  Casimirs of B, linear or quadratic",
        "    0.5 y1² + 0.5 y2² + 0.5 y3²; m = 5.0000e-1 > 0; B∇C = 0 exactly",
        "  damping  γ = -0.5; rate and integral agree to 0e0",
        "  paths    stay within ‖y‖ ≤ 2.7183",
        "Statements of the paper",
        "  they apply: exact-conformal, conformal-casimir, moment-bound, strong-half, weak-one",
        "  they do not apply: energy-balance",
        "  under a condition: solvability",
        "Expected orders, strong / weak",
        "  0.5 / 1: sexp, sexp-li, split, midpoint, heun",
        "  1 / 1: sexp-levy, sexp-li-levy",
        "  0.5 / 2: nv",
        "  0.5 at least / 1: em",
        concat!(
            "Take sexp-levy for paths: it keeps the laws of Casimirs, and the energy but for ",
            "the noise and the damping; Lévy areas give strong order 1"
        ),
        "Take sexp-li for expectations: weak order 1 is extrapolated; with flows of parts take nv",
        "No mistakes found.",
    ];
    for (line, words) in text.lines().zip(expected) {
        assert_eq!(line, words, "{text}");
    }
    assert_eq!(text.lines().count(), expected.len());
}

/// A system from texts is found to be what the compiled one is.
#[test]
fn formulas_are_inspected_like_compiled_systems() {
    let noises = ["y1^2/2", "y2^2/4", "y3^2/6"];
    let energy = "(y1^2/2 + y2^2 + 1.5*y3^2)/2";
    let (y0, damping) = ([0.45, 0.0, 0.89], systems::Cosine::new(0.5, 2.0).unwrap());
    let body = formulas(&texts("y1 y2 y3", &["-y3 y2", "-y1"], energy, &noises), &y0);
    let settings = InspectSettings {
        y0: Some(y0.to_vec()),
        damping: Some((&damping, 1.0)),
        areas: false,
        ..InspectSettings::default()
    };
    let ours = inspect::inspect(&body, &settings).unwrap();
    let body = RigidBody::three_noises(INERTIA, [1.0, 2.0, 3.0]).unwrap();
    let theirs = inspect_problem(&Problem::new(body, damping, y0, 1.0).unwrap()).unwrap();
    assert!(ours.mistakes.is_empty(), "{ours}");
    let same = |report: &Inspection| {
        let (b, noise) = (&report.structure, &report.noise);
        (b.skew.status, b.jacobi.status, noise.commute.status, report.points)
    };
    assert_eq!((same(&ours), casimirs(&ours)), (same(&theirs), casimirs(&theirs)));
    // No Lévy areas are drawn here for the formulas.
    let areas = |order: &&inspect::ExpectedOrder| order.scheme.ends_with("-levy");
    assert_eq!(theirs.orders.iter().filter(areas).count(), 2);
    assert!(ours.orders.iter().eq(theirs.orders.iter().filter(|order| !areas(order))));
    let recommended = ours.recommended.iter().map(|recommended| recommended.scheme);
    assert_eq!(recommended.collect::<Vec<_>>(), ["sexp", "sexp-li"]);
    let radius = |report: &Inspection| report.problem.as_ref().and_then(|p| p.radius).unwrap();
    assert!((radius(&ours) / radius(&theirs) - 1.0).abs() < 1e-12);

    // Two populations: Σ cᵢ ln yᵢ, and a domain that has to be found.
    let y0 = [1.0, 0.5, 0.7];
    let energy = "x + y + z - ln(x) - ln(y)";
    let populations = formulas(&texts("x y z", &["x*y -x*z", "y*z"], energy, &["0.1*x"]), &y0);
    let report = inspect_around(&populations, &y0).unwrap();
    assert!(report.mistakes.is_empty() && !report.defined_everywhere, "{report}");
    assert_eq!(report.casimirs.as_ref().unwrap().logarithmic.len(), 1, "{report}");
    // A quadrature that is not exact is no mistake of formulas.
    let steep = formulas(&texts("x y", &["1"], "exp(6*x^2) + y^2", &[]), &[1.0, 0.5]);
    let report = inspect_around(&steep, &[1.0, 0.5]).unwrap();
    assert!(report.mistakes.is_empty() && report.hamiltonians.quadrature_error > 0.0, "{report}");
}

/// Large systems are inspected along directions.
#[test]
#[ignore = "long: run by the gate"]
fn lattices_are_inspected_along_directions() {
    use systems::lattice::{Couplings, Shape, SpinLattice};
    let sound = |report: &Inspection| report.mistakes.is_empty() && report.undecided.is_empty();
    let couplings = Couplings {
        exchange: 1.0,
        anisotropy: 0.4,
        field: [0.1, 0.2, 0.3],
        noise: 0.5,
        local: true,
        damping: 0.0,
    };
    let shape = Shape::periodic(&[20, 15, 10]).unwrap();
    let y0 = [0.6, 0.0, 0.8].repeat(3000);
    for damping in [0.0, 0.2] {
        let couplings = Couplings { damping, ..couplings };
        let lattice = SpinLattice::one_path(shape.clone(), couplings).unwrap();
        let report = inspect_around(&lattice, &y0).unwrap();
        assert!(sound(&report), "{report}");
        let mut methods = report.hamiltonians.methods.iter();
        let gradient = methods.any(|(what, _)| what.starts_with("gradient is"));
        assert_eq!(gradient, damping == 0.0);
        assert!(report.to_string().contains("D = 9000, M = 9000"), "{report}");
    }
    // On 32 paths; of 24 spins, with too many components for matrices, each with its length.
    let one_field = Couplings { local: false, ..couplings };
    for (spins, couplings) in [(4, couplings), (4, one_field), (24, one_field)] {
        let ring = SpinLattice::on_paths(Shape::periodic(&[spins]).unwrap(), couplings).unwrap();
        let report = inspect_around(&ring, &y0[..3 * spins]).unwrap();
        assert!(sound(&report) && casimirs(&report).len() == spins, "{report}");
        let (text, large) = (report.to_string(), spins == 24);
        assert!(!large || report.noise.commute.fails() && text.contains("and 12 more"), "{text}");
    }
}
