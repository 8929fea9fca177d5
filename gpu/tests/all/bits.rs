//! States of kernels and of the processor, to the bit, for every scheme on every scene.

use std::sync::{
    Arc, Mutex,
    atomic::{AtomicU64, Ordering::Relaxed},
};

use gpu::Gpu;
use mc::{Initial, Ladder, Problem, Run, Statistic, View};
use noise::{StreamKey, Truncation};
use nonlin::Solver;
use scenes::{Changes, Scene, Source, gallery::GALLERY};
use schemes::{BuiltIn, Device, Method, Sexp, Task, Trajectories, WithSolver};

use crate::interpreter::Interpreter;

/// Paths of a comparison: two groups.
const PATHS: u64 = 256;
const GROUPS: u64 = 2;

/// A block of a run at a time: its first path, which paths had clipped increments, and all bits.
type Block = (u64, u64, usize, u32, Vec<u64>);

/// All that a statistic is shown at times that it reads.
#[derive(Default, PartialEq)]
struct Seen(Vec<Block>);

impl Statistic for Seen {
    fn observe(&mut self, view: &View<'_>) {
        if !self.reads(view.time) {
            return;
        }
        for run in 0..view.runs() {
            let state = view.state(run).iter();
            let paths = view.live.paths();
            let bits = paths.flat_map(|p| state.clone().map(move |row| row[p].to_bits()));
            let clipped = view.clipped[run].and(view.live).0;
            self.0.push((view.time, view.first_path, run, clipped, bits.collect()));
        }
    }

    fn reads(&self, time: u64) -> bool {
        time != 3
    }

    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}

/// Counts the groups of paths that a device computes, and those that it leaves to the processor.
#[derive(Debug)]
struct Counted {
    gpu: Gpu<Interpreter>,
    groups: [AtomicU64; 2],
    /// The kernel of the last task.
    ptx: Mutex<String>,
}

impl Device for Counted {
    fn advance(&self, task: &Task<'_>) -> Option<Trajectories> {
        *self.ptx.lock().unwrap() = Gpu::<Interpreter>::ptx(task).unwrap_or_default();
        let found = self.gpu.advance(task)?;
        for group in found.solved.chunks(128) {
            let solved = group.iter().all(|&solved| solved);
            self.groups[usize::from(!solved)].fetch_add(1, Relaxed);
        }
        Some(found)
    }

    fn fewest(&self) -> u64 {
        self.gpu.fewest()
    }

    fn refuse(&self, why: &str) {
        self.gpu.refuse(why);
    }

    fn refused(&self) -> Vec<String> {
        self.gpu.refused()
    }
}

/// A comparison of a device with the processor.
struct Compared {
    same: bool,
    /// Groups that were computed, and that were left to the processor.
    groups: [u64; 2],
    reasons: Vec<String>,
    failed: u64,
    clipped: Vec<u64>,
    ptx: String,
}

pub fn scene(text: &str) -> Scene {
    let source = Source::new("test", text);
    Scene::new(source, &Changes::default()).unwrap()
}

/// Runs of a scheme of the scene, as [`compare_method`].
fn compare(
    scene: &Scene,
    problem: &Problem<'_>,
    scheme: BuiltIn,
    how: (u64, &[usize], Truncation),
    change: fn(&str) -> String,
) -> Option<Compared> {
    compare_method(&scene.model.scheme(scheme).ok()?, problem, how, change)
}

/// Runs on some levels on a device, whose kernels are changed before, and on the processor.
fn compare_method<'a>(
    method: &Arc<dyn Method + 'a>,
    problem: &Problem<'a>,
    (steps, levels, truncation): (u64, &[usize], Truncation),
    change: fn(&str) -> String,
) -> Option<Compared> {
    let key = StreamKey { seed: 7, experiment: 0 };
    let measured = |device: Option<&dyn Device>| {
        let run = |&level: &usize| Run::new(Arc::clone(method), level);
        let problem = Problem { device, ..problem.clone() };
        let most = levels.iter().max().copied().unwrap_or(0);
        let runs = levels.iter().map(run).collect();
        let ladder = Ladder::new(&problem, steps, most, truncation, key, runs).ok()?;
        let measured = ladder.run(PATHS, Seen::default);
        Some((measured.statistic, measured.failed, measured.clipped))
    };
    let gpu = Gpu::new(Interpreter { change, fewest: 0 });
    let counted = Counted { gpu, groups: Default::default(), ptx: Mutex::default() };
    let (found, wanted) = (measured(Some(&counted))?, measured(None)?);
    Some(Compared {
        same: found == wanted,
        groups: counted.groups.map(AtomicU64::into_inner),
        reasons: counted.gpu.refused(),
        failed: wanted.1,
        clipped: wanted.2,
        ptx: counted.ptx.into_inner().unwrap(),
    })
}

/// Kernels as they are.
fn as_written(ptx: &str) -> String {
    ptx.into()
}

/// Products that a sum reads next, fused with it, as a compiler without `.rn` would do.
fn fused(ptx: &str) -> String {
    let mut lines: Vec<String> = ptx.lines().map(String::from).collect();
    for n in 1..lines.len() {
        let [product, sum] = [n - 1, n].map(|n| lines[n].trim().trim_end_matches(';').to_string());
        let (Some(product), Some(sum)) =
            (product.strip_prefix("mul.rn.f64 "), sum.strip_prefix("add.rn.f64 "))
        else {
            continue;
        };
        let ([product, a, b], [to, x, y]) = (parts(product), parts(sum));
        if x == product || y == product {
            let other = if x == product { y } else { x };
            lines[n] = format!("fma.rn.f64 {to}, {a}, {b}, {other};");
        }
    }
    lines.join("\n")
}

fn parts(operands: &str) -> [&str; 3] {
    let mut parts = operands.split(", ");
    [(); 3].map(|()| parts.next().unwrap_or_default())
}

/// Scenes that have no list of operations: systems of the project, lattices, matrices.
const NOT_LISTED: [&str; 10] = [
    "pendulum",
    "rigid-body",
    "lotka-volterra",
    "maxwell-bloch",
    "poisson3",
    "spin-lattice",
    "quench",
    "stirred-sphere",
    "spin-one",
    "dephasing",
];

/// Numbers of kernels that are compared and of twins that are caught, and what has no kernel, of
/// every second scene.
fn compared_gallery(first: usize) -> (u32, u32, Vec<String>) {
    let (mut listed, mut not, mut caught) = (0, Vec::new(), 0);
    let scenes = GALLERY.iter().filter(|(name, _)| !NOT_LISTED.contains(name));
    for (name, text) in scenes.skip(first).step_by(2) {
        let scene = scene(text);
        let problem = Problem { t_end: scene.settings.until.min(0.5), ..scene.problem() };
        for scheme in BuiltIn::ALL {
            let how = (5, &[0][..], scene.settings.truncation);
            let Some(compared) = compare(&scene, &problem, scheme, how, as_written) else {
                continue;
            };
            assert!(compared.same, "{name} {}", scheme.id());
            // With Lévy areas of several noises, or with parts that have no flow.
            if !compared.reasons.is_empty() {
                not.push(format!("{name} {}", scheme.id()));
                continue;
            }
            assert_eq!(compared.groups, [GROUPS, 0], "{name} {}", scheme.id());
            listed += 1;
            // A long kernel in one launch is long to interpret.
            if compared.ptx.len() < 60_000 {
                let twin = compare(&scene, &problem, scheme, how, fused).unwrap();
                caught += u32::from(!twin.same);
            }
        }
    }
    (listed, caught, not)
}

#[test]
fn every_scheme_on_the_gallery_has_the_bits_of_the_processor() {
    let [(a, b, mut not), (c, d, others)] = std::thread::scope(|scope| {
        let even = scope.spawn(|| compared_gallery(0));
        [compared_gallery(1), even.join().unwrap()]
    });
    let (listed, caught) = (a + c, b + d);
    not.extend(others);
    println!("{listed} listed, {caught} fused twins caught, not listed: {not:?}");
    assert!(listed >= 200 && caught > 180, "{listed} {caught}");
    assert!(not.len() < 50, "{not:?}");
}

#[test]
fn runs_on_levels_share_a_path() {
    let oscillator = |noises: &str| {
        format!(
            "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\n\
             H0 = \"p^2/2 + cos(q) + exp(-q^2)\"\nH = [{noises}]\n[damping]\nrate = \"0.3*t\"\n\
             [run]\ninitial = [1, 0.2]\nuntil = 1\nsteps = 64\n"
        )
    };
    // One noise and three leave normals over; clipping at one deviation counts many increments.
    for noises in ["\"0.3*q\"", "\"0.3*q\", \"0.2*q^2\"", "\"0.3*q\", \"0.1*q^2\", \"0.1*q^3\""] {
        let scene = scene(&oscillator(noises));
        for (scheme, order) in
            [(BuiltIn::Sexp, 1), (BuiltIn::SplitH, 2), (BuiltIn::Nv, 1), (BuiltIn::Heun, 1)]
        {
            let truncation = Truncation::new(order).unwrap();
            let how = (64, &[2, 0, 1][..], truncation);
            let problem = scene.problem();
            let compared = compare(&scene, &problem, scheme, how, as_written).unwrap();
            assert!(compared.same && compared.groups == [GROUPS, 0], "{noises} {}", scheme.id());
            let clips = !matches!(scheme, BuiltIn::SplitH | BuiltIn::Nv);
            assert_eq!(compared.clipped.iter().all(|&count| count > 0), clips, "{noises}");
        }
    }
}

#[test]
fn one_more_sweep_settles_a_solution() {
    let scene = scene(scenes::gallery::scene("double-well").unwrap());
    let settled = WithSolver { formula: Sexp, solver: Solver::default().settled() };
    let method = mc::bind_at_run_time(scene.model.system(), Box::new(settled)).unwrap();
    let how = (8, &[0][..], scene.settings.truncation);
    let problem = Problem { t_end: 0.5, ..scene.problem() };
    let compared = compare_method(&method, &problem, how, as_written).unwrap();
    assert!(compared.same && compared.groups == [GROUPS, 0]);
}

/// A step alone takes one of the two programs of `nv`.
#[test]
fn a_single_step_has_the_bits_of_the_processor() {
    let scene = scene(scenes::gallery::scene("kubo").unwrap());
    let how = (1, &[0][..], scene.settings.truncation);
    let compared = compare(&scene, &scene.problem(), BuiltIn::Nv, how, as_written).unwrap();
    assert!(compared.same && compared.groups == [GROUPS, 0]);
}

#[test]
fn what_is_not_solved_is_left_to_the_processor() {
    // Steps of 2 on a stiff well: plain iteration finds nothing, Euler's method overflows.
    let well = "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"p^2/2 + q^4\"\n\
                H = [\"0.5*q\"]\n[run]\ninitial = [2, 1]\nuntil = 40\nsteps = 20\n";
    let scene = scene(well);
    let problem = scene.problem();
    let how = (20, &[0][..], Truncation::new(4).unwrap().wide());
    for (scheme, fails) in [(BuiltIn::Sexp, false), (BuiltIn::EulerMaruyama, true)] {
        let compared = compare(&scene, &problem, scheme, how, as_written).unwrap();
        assert!(compared.same && compared.groups == [0, GROUPS], "{}", scheme.id());
        assert_eq!(compared.failed > 0, fails);
    }
    // A square root that paths leave the domain of.
    let root = "[system]\nstate = [\"x\"]\ndrift = [\"-sqrt(x)\"]\nnoise = [[\"0.7*sqrt(x)\"]]\n\
                [run]\ninitial = [1]\nuntil = 1\nsteps = 20\n";
    let scene = self::scene(root);
    let compared = compare(&scene, &scene.problem(), BuiltIn::Heun, how, as_written).unwrap();
    assert!(compared.same && compared.failed > 0 && compared.groups[1] > 0);
    // A finite state that is outside of it at the end.
    let scene = self::scene(&root.replace("-sqrt(x)", "-2 - 0*sqrt(x)").replace("= 20", "= 1"));
    let how = (1, &[0][..], Truncation::none());
    let compared =
        compare(&scene, &scene.problem(), BuiltIn::EulerMaruyama, how, as_written).unwrap();
    assert!(compared.same && compared.failed > 0 && compared.groups[1] > 0);
}

#[test]
fn functions_of_extreme_numbers_have_the_same_bits() {
    let functions = [
        "sin(x)",
        "cos(x)",
        "tan(x)",
        "exp(-abs(x))",
        "ln(abs(x) + 1e-320)",
        "exp(ln(abs(x)) - 700)",
        "sqrt(abs(x))",
        "tanh(x)",
        "sinh(min(abs(x), 700))",
        "cosh(max(min(x, 700), -700))",
        "abs(x)",
        "min(x, 0.3)",
        "max(x, -0.3)",
        "1/(1 + abs(x))",
        "x/(3 + x/(1 + abs(x)))",
    ];
    let names: Vec<String> = (1..=functions.len()).map(|k| format!("\"f{k}\"")).collect();
    let texts: Vec<String> = functions.iter().map(|text| format!("\"{text}\"")).collect();
    let zeros = vec!["0"; functions.len()].join(", ");
    let scene = scene(&format!(
        "[system]\nstate = [\"x\", {}]\ndrift = [\"0\", {}]\nnoise = [[\"0\", {}]]\n[run]\n\
         initial = [1, {zeros}]\nuntil = 1\nsteps = 1\n[observe]\nhalf = \"x/2\"\n",
        names.join(", "),
        texts.join(", "),
        vec!["\"0\""; functions.len()].join(", "),
    ));
    // Finite numbers of every exponent, subnormal ones and both zeros.
    let draw = |_: StreamKey, first: u64, rows: &mut [[f64; 32]]| {
        for (p, x) in rows[0].iter_mut().enumerate() {
            let word = noise::mix(first + p as u64 + 1);
            let bits = match p {
                0 => 1 << 63,
                1..8 => word & !(0x7ff << 52),
                _ => word,
            };
            *x = Some(f64::from_bits(bits)).filter(|x| x.abs() < 1e300).unwrap_or(-0.7);
        }
        rows[1..].iter_mut().for_each(|row| row.fill(0.0));
    };
    let initial = Some(Initial { law: "all numbers".into(), draw: Arc::new(draw) });
    let problem = Problem { initial, ..scene.problem() };
    let how = (1, &[0][..], Truncation::none());
    let compared = compare(&scene, &problem, BuiltIn::EulerMaruyama, how, as_written).unwrap();
    assert!(compared.same, "bits");
    assert_eq!(compared.groups, [GROUPS, 0]);
}
