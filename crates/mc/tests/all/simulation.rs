//! Paths as tables, and paths driven by recorded increments.

use std::sync::Arc;

use mc::{
    Friction, LadderError, NoiseOrigin, RunError, Setup, Simulation, StateFunction, write_csv,
};
use noise::{StreamKey, Truncation};
use nonlin::{Method, Solver};
use real::Real;
use schemes::{EulerMaruyama, Sexp, WithSolver};
use systems::{
    Constant, Cosine, Damping, MaxwellBloch, Poisson3, PoissonSystem, Problem,
    lattice::{Couplings, Shape, SpinLattice},
    run_time,
};

use crate::ladder::{body, on_threads};

const KEY: StreamKey = StreamKey { seed: 5, experiment: 2 };

fn k4() -> Truncation {
    Truncation::new(4).unwrap()
}

#[test]
fn a_table_holds_the_trajectory_and_the_conformal_defect() {
    let (problem, sexp) = (body(), Sexp);
    let all = Simulation::new(Setup::of(&problem, &sexp), k4()).path(64, KEY, 7).unwrap();
    let table = Simulation::new(Setup::of(&problem, &sexp), k4())
        .every(10)
        .observing(StateFunction::new("y1 y2", |y: [f64; 3]| y[0] * y[1]))
        .path(64, KEY, 7)
        .unwrap();
    let saved = [0, 10, 20, 30, 40, 50, 60, 64];
    assert_eq!(table.times(), saved.map(|n| all.times()[n]));
    for (row, &n) in saved.iter().enumerate() {
        let y: [f64; 3] = std::array::from_fn(|i| all.columns[1 + i].values[n]);
        for i in 0..3 {
            assert_eq!(table.column(&format!("y{}", i + 1)).unwrap()[row], y[i]);
        }
        assert_eq!(table.column("y1 y2").unwrap()[row], y[0] * y[1]);
        assert_eq!(table.column("C").unwrap()[row], problem.system().invariant(0, y));
        let law = (-2.0 * problem.damping().integral(0.0, all.times()[n])).exp()
            * problem.system().invariant(0, problem.y0());
        let defect = problem.system().invariant(0, y) / law - 1.0;
        // A hundred roundings in the state, a few in the law.
        assert!((table.column("C defect").unwrap()[row] - defect).abs() < 128.0 * f64::EPSILON);
    }
    assert_eq!(table.column("energy"), None);
    assert_eq!(table.noise, NoiseOrigin { seed: 5, experiment: 2, path: 7 });
    assert_eq!(
        (table.scheme.as_str(), table.system.as_str(), table.tau),
        ("sexp", "rigid-body", 1.0 / 64.0)
    );

    // The twin: Euler–Maruyama on the same noise leaves the law, and the column shows it.
    let worst = |table: &mc::TimeSeries| {
        table.column("C defect").unwrap().iter().fold(0.0, |m: f64, d| m.max(d.abs()))
    };
    let euler =
        Simulation::new(Setup::of(&problem, &EulerMaruyama), k4()).path(64, KEY, 7).unwrap();
    assert!(worst(&table) < 1e-13 && worst(&euler) > 1e-3, "{} {}", worst(&table), worst(&euler));
    // Its defect is relative to the law.
    let (casimir, defects) = (euler.column("C").unwrap(), euler.column("C defect").unwrap());
    for ((t, value), defect) in euler.times().iter().zip(casimir).zip(defects) {
        let law = (-2.0 * problem.damping().integral(0.0, *t)).exp() * casimir[0];
        assert!((defect - (value / law - 1.0)).abs() < 1e-14, "{t}");
    }
}

#[test]
fn laws_decay_with_all_friction_and_defects_have_their_sign() {
    // The damping of all components and friction on two of them, on one of these twice.
    let damping = Constant::new(0.4).unwrap();
    let problem = Problem::new(MaxwellBloch, damping, [1.0, 0.6, 0.8], 1.0).unwrap();
    let on = |rate: f64, components: &[usize]| Friction {
        damping: Arc::new(Constant::new(rate).unwrap()),
        components: components.to_vec(),
    };
    let friction = [on(0.5, &[1, 2]), on(-0.1, &[2]), on(0.1, &[0]), on(-0.1, &[1])];
    let setup = Setup::of(&problem, &Sexp).with_friction(&friction);
    let table = Simulation::new(setup, k4()).path(64, KEY, 7).unwrap();
    let columns = [table.times(), table.column("C").unwrap(), table.column("C defect").unwrap()];
    for row in 0..=64 {
        let [t, value, defect] = columns.map(|column| column[row]);
        // A hundred roundings in the state, a few in the law.
        let left = value / (0.5 * (-2.0 * 0.8 * t).exp()) - 1.0;
        assert!(left.abs() < 128.0 * f64::EPSILON && defect.abs() < 128.0 * f64::EPSILON, "{t}");
    }
    // Euler's method multiplies a linear Casimir by 1 − γτ: one that is negative is above its law.
    let (system, damping) = (Poisson3::new(0.1).unwrap(), Constant::new(0.5).unwrap());
    let problem = Problem::new(system, damping, [0.25, -1.0, 0.25], 1.0).unwrap();
    let simulation = Simulation::new(Setup::of(&problem, &EulerMaruyama), k4());
    let table = simulation.path(64, KEY, 7).unwrap();
    assert!(table.column("S").unwrap()[0] == -0.5 && table.halted.is_none());
    for (n, defect) in (0..=64).zip(table.column("S defect").unwrap()) {
        let exact = 1.0 - (1.0 - 0.5 / 64.0f64).powi(n) * (0.5 / 64.0 * f64::from(n)).exp();
        assert!((defect - exact).abs() < 1e-12, "{n}: {defect} {exact}");
    }
    // A table that is cut short says where.
    simulation.stop.now();
    let table = simulation.path(64, KEY, 7).unwrap();
    let end = table.times().last().copied().unwrap_or(0.0);
    assert!(end < 1.0 && table.halted == Some(format!("stopped after t = {end}")), "{table:?}");
}

#[test]
fn many_paths_come_in_order_and_do_not_depend_on_threads() {
    let (problem, sexp) = (body(), Sexp);
    let simulation = Simulation::new(Setup::of(&problem, &sexp), k4()).every(8);
    let paths = simulation.paths(16, KEY, 3..9).unwrap();
    for (path, table) in (3..9).zip(&paths) {
        assert_eq!(*table, simulation.path(16, KEY, path).unwrap());
    }
    assert_eq!(on_threads(1, || simulation.paths(16, KEY, 3..9)).unwrap(), paths);
}

#[test]
fn tables_read_back_to_the_same_bits() {
    let (problem, sexp) = (body(), Sexp);
    let paths = Simulation::new(Setup::of(&problem, &sexp), k4())
        .observing(StateFunction::new("a \"b\", c", |y: [f64; 3]| y[0]))
        .paths(8, KEY, 0..3)
        .unwrap();
    let mut csv = Vec::new();
    write_csv(&paths, &mut csv).unwrap();
    let csv = String::from_utf8(csv).unwrap();
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("scheme,path,t,y1,y2,y3,\"a \"\"b\"\", c\",C,C defect"));
    for table in &paths {
        for row in 0..9 {
            let entries: Vec<&str> = lines.next().unwrap().split(',').collect();
            for (column, text) in table.columns.iter().zip(&entries[2..]) {
                assert_eq!(text.parse(), Ok(column.values[row]));
            }
        }
    }
    assert_eq!(lines.next(), None);

    let json = serde_json::to_value(&paths).unwrap();
    assert_eq!(json[2]["noise"]["path"], 2);
    assert_eq!(json[2]["columns"][1]["name"], "y1");
    let read: Vec<f64> = serde_json::from_value(json[2]["columns"][1]["values"].clone()).unwrap();
    assert_eq!(read, paths[2].columns[1].values);

    // Tables with other columns do not fit below.
    let other = Simulation::new(Setup::of(&problem, &sexp), k4()).path(8, KEY, 0).unwrap();
    let error = write_csv(&[paths[0].clone(), other], &mut Vec::new()).unwrap_err();
    assert!(error.to_string().contains("a \"\"b\"\", c"), "{error}");
    write_csv(&[], &mut Vec::new()).unwrap();
}

#[test]
fn bad_simulations_are_refused() {
    let (problem, sexp) = (body(), Sexp);
    let simulation = || Simulation::new(Setup::of(&problem, &sexp), k4());
    let refused = simulation().every(0).path(8, KEY, 0).unwrap_err().to_string();
    assert!(refused.ends_with("must be at least 1, got 0"), "{refused}");
    let twice = simulation().observing(StateFunction::new("y2", |y: [f64; 3]| y[1]));
    let refused = twice.path(8, KEY, 0).unwrap_err().to_string();
    assert_eq!(refused, "two columns have the name \"y2\"; rename one");
    let steps = |steps| simulation().path(steps, KEY, 0).unwrap_err();
    assert!(matches!(steps(0), RunError::Ladder(LadderError::Steps { .. })));
    assert!(matches!(steps(1), RunError::Ladder(LadderError::Noise(_))));
}

#[test]
fn invariants_that_share_a_name_are_numbered() {
    let couplings = Couplings { exchange: 0.9, noise: 0.7, ..Couplings::default() };
    let lattice = SpinLattice::on_paths(Shape::open(&[2]).unwrap(), couplings).unwrap();
    let (damping, y0) = (Cosine::new(0.5, 2.0).unwrap(), vec![0.0, 0.6, 0.8, 0.0, 0.0, 0.0]);
    let problem = run_time::Problem::new(Arc::new(lattice), Arc::new(damping), y0, 1.0).unwrap();
    let simulation = Simulation::new(Setup::at_run_time(&problem, &Sexp).unwrap(), k4());
    let table = &simulation.paths(16, KEY, 0..1).unwrap()[0];
    let names: Vec<&str> = table.columns[7..].iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["C1", "C1 defect", "C2", "C2 defect"]);
    // The second spin is zero and stays so: there is no relative defect, and none is needed.
    assert_eq!(table.column("C2 defect").unwrap(), [0.0; 17]);
}

/// 150 oscillators in a ring, each coupled to the next, one of them with noise.
struct Oscillators;

impl PoissonSystem<300, 1> for Oscillators {
    fn name(&self) -> &'static str {
        "oscillators"
    }
    fn structure<R: Real>(&self, _: [R; 300], v: [R; 300]) -> [R; 300] {
        std::array::from_fn(|i| if i % 2 == 0 { -v[i + 1] } else { v[i - 1] })
    }
    fn energy<R: Real>(&self, y: [R; 300], dt: f64, dw: [f64; 1]) -> R {
        let mut energy = y[0] * dw[0];
        for i in 0..300 {
            energy = energy + (y[i] + y[(i + 2) % 300]) * y[i] * (0.5 * dt);
        }
        energy
    }
    fn gradient<R: Real>(&self, y: [R; 300], dt: f64, dw: [f64; 1]) -> [R; 300] {
        let neighbours = |i: usize| y[(i + 2) % 300] + y[(i + 298) % 300];
        let mut gradient = std::array::from_fn(|i| (y[i] + neighbours(i) * 0.5) * dt);
        gradient[0] = gradient[0] + dw[0];
        gradient
    }
    // Other means of the gradient would take seconds to compile.
    fn averaged_gradient<R: Real>(
        &self,
        a: [R; 300],
        b: [R; 300],
        dt: f64,
        dw: [f64; 1],
    ) -> [R; 300] {
        self.gradient(std::array::from_fn(|i| (a[i] + b[i]) * 0.5), dt, dw)
    }
}

/// Matrices in 300 dimensions do not fit the stacks of rayon's threads.
#[test]
fn large_compiled_systems_run_on_the_usual_threads() {
    let y0 = std::array::from_fn(|i| [0.6, 0.0, 0.8][i % 3]);
    let problem = Problem::new(Oscillators, Cosine::new(0.5, 2.0).unwrap(), y0, 0.125).unwrap();
    for (solver, steps) in [(Solver::default(), 8), (Solver::new(Method::Newton), 1)] {
        let scheme = &WithSolver { formula: Sexp, solver };
        let paths =
            Simulation::new(Setup::of(&problem, scheme), k4()).paths(steps, KEY, 0..2).unwrap();
        assert!(paths.iter().all(|path| path.times().len() as u64 == steps + 1));
    }
}
