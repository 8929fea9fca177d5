//! Whether the steps of a run are said to resolve what changes with time, and how fast it turns.

use serde_json::Value;

use crate::common::{json, run, succeeds, with_scene};

/// A particle that is pushed by f(t): p(T) = ∫f where k = 0.
fn driven(force: &str, k: &str, run: &str) -> String {
    format!(
        "[system]\nstate = ['q', 'p']\nB = 'canonical'\nH0 = 'p^2/2 + {k}*q^2/2 - ({force})*q'\n\
         H = ['0.2*q']\n[run]\ninitial = [0, 0]\n{run}\n[observe]\nmom = 'p'\n\
         [expect]\nof = ['mom']\naccuracy = 0.02\n"
    )
}

/// A pulse of the integral one.
fn pulse(at: f64, width: f64) -> String {
    format!("exp(-((t - {at})/{width})^2/2)/({width}*sqrt(2*pi))")
}

/// What a run says of its steps.
fn check(scene: &str) -> Value {
    let folder = with_scene(scene);
    let found = json(folder.path(), &["run", "scene.toml", "--json", "--threads", "1"]);
    found["step_check"].clone()
}

/// What it prints.
fn says(scene: &str) -> String {
    let folder = with_scene(scene);
    let output = crate::common::run(folder.path(), &["run", "scene.toml", "--threads", "1"]);
    [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap()).concat()
}

#[test]
fn a_run_names_what_its_steps_do_not_resolve_and_a_number_that_does() {
    // A narrow pulse alone and on a slow drive, a double one without integral; drives that steps
    // of T/100 and of T/200 read as constants, as zero and as slow ones.
    let pair = format!("{} - {}", pulse(1.03, 1e-4), pulse(1.033, 1e-4));
    for (force, k) in [
        (pulse(1.03, 1e-4), "0"),
        (pulse(1.7321, 1e-7), "0"),
        (format!("3*cos(2*t) + {}", pulse(0.4567, 1e-5)), "1"),
        (format!("7 + 0.01*{}", pulse(0.123, 1e-6)), "1"),
        (pair, "1"),
        ("cos(2*pi*800*t)".into(), "1"),
        ("0.1*sin(2*pi*800*t) + 5".into(), "1"),
        ("cos(2*pi*401*t)".into(), "1"),
        ("1/(1 + ((t - 1.03)/1e-5)^2)/1e-5".into(), "0"),
        // At the ends, which no step reads.
        ("1000*exp(-t/0.0007)".into(), "0"),
        ("500*(1 + tanh((t - 1.9991)/0.0003))".into(), "0"),
        (pulse(1.9994, 4e-4), "1"),
    ] {
        let unresolved = &check(&driven(&force, k, "until = 2\nsteps = 200"))["unresolved"];
        assert!(unresolved.is_array(), "{force}: {unresolved}");
        if let (Some(steps), true) = (unresolved[1].as_u64(), force.contains("1e-4")) {
            let enough = driven(&force, k, &format!("until = 2\nsteps = {steps}"));
            assert!(steps > 200 && check(&enough)["unresolved"].is_null(), "{force}: {steps}");
        }
    }
    let said = says(&driven(&pulse(1.03, 1e-4), "0", "until = 2\nsteps = 200\npaths = 100"));
    assert!(said.contains("a function of t changes within a step near t = 1.03"), "{said}");
    assert!(said.contains("take 12800 steps") && said.contains("? (?)"), "{said}");
}

#[test]
fn functions_of_time_that_are_integrated_or_followed_are_resolved_too() {
    let still =
        |more: &str| driven("0", "1", "until = 2\nsteps = 200").replace("[0, 0]", "[1, 0]") + more;
    let observed = |of: &str| still("").replace("[observe]\n", &format!("[observe]\n{of}\n"));
    let narrow = pulse(1.2345, 1e-7);
    for (scene, is_seen) in [
        (observed("m = 'integral(q^2*(1 + cos(800*pi*t)))'"), true),
        (observed("m = 'average(cos(800*pi*t))'"), true),
        (observed(&format!("m = 'integral(q*{narrow})'")), true),
        (observed("wave = 'cos(800*pi*t)*q'\nm = 'integral(wave)'"), true),
        (still("[events]\nhit = 'p*sin(800*pi*t + 1) > 0.9'\n"), true),
        (observed("m = 'integral(q^2*(1 + cos(3*t)))'\nend = 'cos(800*pi*t)*q'"), false),
        (still("[events]\nhit = 'p*sin(3*t + 1) > 0.9'\n"), false),
    ] {
        let unresolved = &check(&scene)["unresolved"];
        assert_eq!(unresolved.is_array(), is_seen, "{scene}: {unresolved}");
    }
    // ∫cos²t(1 + cos 1024t) dt over a period, by steps that are halved until they resolve it.
    let scene = observed("m = 'integral(q^2*(1 + cos(1024*t)))'").replace("H = ['0.2*q']\n", "");
    let scene = scene.replace("until = 2\n", "until = '2*pi'\n").replace("['mom']", "['m']");
    let found = json(with_scene(&scene).path(), &["expect", "scene.toml", "--json"]);
    let found = &found["estimates"][0];
    let number = |key: &str| found[key].as_f64().unwrap();
    assert!((number("value") - std::f64::consts::PI).abs() <= number("half_width"), "{found}");
}

#[test]
fn orders_and_costs_on_an_alias_are_undecided() {
    let run = "until = 2\nsteps = 256";
    for (hertz, is_seen) in [(1, true), (200_001, false)] {
        let folder = with_scene(&driven(&format!("cos(2*pi*{hertz}*t)"), "1", run));
        let command = ["order", "scene.toml", "--json", "--path-steps", "3e6"];
        let strong = json(folder.path(), &command)["strong"]["words"].as_str().unwrap().to_owned();
        let compared =
            crate::common::run(folder.path(), &["compare", "scene.toml", "--budget", "0.3"]);
        let compared = String::from_utf8(compared.stdout).unwrap();
        let undecided = "undecided: the steps do not resolve a function of t near t = ";
        assert_eq!(strong.contains(undecided), !is_seen, "{strong}");
        let none =
            "No scheme is recommended: the finest steps do not resolve a function of t near t = ";
        assert_eq!(compared.contains(none), !is_seen, "{compared}");
    }
}

#[test]
fn what_steps_resolve_raises_no_alarm() {
    for force in [
        // Eight steps in a period and four; a switch; noise of another time; what only looks wild.
        "cos(2*pi*12.5*t)",
        "2*cos(2*pi*25*t) + 100",
        "tanh((t - 1.00001)/1e-7)",
        "exp(-((t - 1)/0.03)^2/2)",
        "t^2*sin(t)^2 + t^2*cos(t)^2",
        "1 + sin(20*t)*exp(-t)/(2 + cos(3*t))",
    ] {
        let check = check(&driven(force, "1", "until = 2\nsteps = 200"));
        assert!(check["unresolved"].is_null(), "{force}: {check}");
    }
}

#[test]
fn an_expectation_takes_steps_that_see_a_pulse() {
    let folder = with_scene(&driven(&pulse(1.0, 5e-3), "0", "until = 2\nsteps = 8"));
    let found = json(folder.path(), &["expect", "scene.toml", "--json", "--threads", "1"]);
    let p = &found["estimates"][0];
    let [lo, hi] = ["lo", "hi"].map(|end| p[end].as_f64().unwrap());
    assert!(found["reached"] == true && lo < 1.0 && 1.0 < hi && hi - lo <= 0.04, "{found}");
}

#[test]
fn a_path_has_digits_where_it_passes_zero() {
    let scene = "[system]\nstate = ['q', 'p']\nB = 'canonical'\nH0 = '(p^2 + q^2)/2'\n[run]\n\
                 initial = [1, 0]\nuntil = '20*pi'\nsteps = 10000\n";
    // p(T) = 0, and by steps ω³τ²T/12 = 2.1e-4.
    let said = says(scene);
    assert!(!said.contains("digit"), "{said}");
    let few = scene.replace("10000", "20").replace("20*pi", "19*pi");
    let said = says(&few);
    assert!(said.contains("no digit along a path of q is right"), "{said}");
}

/// A step turns by a quarter of a radian. Its phase error is in the correlation with the past, and
/// no value at the end shows it.
#[test]
fn step_errors_of_correlations_are_named() {
    let scene = "[system]\nstate = ['q', 'p']\nB = 'canonical'\nH0 = '(p^2 + q^2)/2'\n[bath]\n\
                 temperature = 1\nfriction = { p = 0.5 }\n[run]\ninitial = ['z1', 'z2']\nuntil = 32\n\
                 steps = 128\ntimes = 128\npaths = 2000\n[statistics]\nautocorrelation = ['q']\n";
    let words =
        "the step errors of autocorrelation and spectrum may exceed the sampling errors: of q";
    let said = says(scene);
    assert!(said.contains(words), "{said}");
    let said = says(&scene.replace("steps = 128", "steps = 4096"));
    assert!(!said.contains("step errors of autocorrelation"), "{said}");
}

#[test]
fn random_initial_values_have_a_spread_of_step_errors() {
    // q turns by w·T with w up to 40: means are wrong by what one path does not tell.
    let scene = "[system]\nstate = ['q', 'w', 'p', 'd']\nB = 'canonical'\nH0 = 'w*(p^2 + q^2)/2'\n\
                 [run]\ninitial = ['1', '40*u1^4', '0', '0']\nuntil = 10\nsteps = 200\npaths = 300\n";
    for seed in ["1", "2", "3"] {
        let scene = scene.replace("paths", &format!("seed = {seed}\npaths"));
        let said = says(&scene);
        assert!(said.contains("the step error of q, p may exceed"), "{said}");
    }
}

#[test]
fn a_stiff_bond_in_a_bath_is_said_to_lack_energy() {
    // x = ωτ/2 = 0.35 gives ⟨kq²/2⟩ = ½kT/(1 + x²): 11 % too little.
    let scene = "[system]\nstate = ['q', 'p']\nB = 'canonical'\nH0 = 'p^2/2 + 4900*q^2/2'\n\
                 [bath]\nfriction = { p = 1 }\ntemperature = 1\n[run]\ninitial = [0, 0]\nuntil = 5\n\
                 steps = 500\npaths = 200\n[observe]\npot = '4900*q^2/2'\n";
    let said = says(scene);
    let words = "turns by 0.7 radians in a step: where noise drives it, schemes like the midpoint \
                 rule give it about 11 % too little energy; take 1742 steps for 1 %";
    assert!(said.contains(words), "{said}");
    let said = says(&scene.replace("steps = 500", "steps = 2000"));
    assert!(!said.contains("turns"), "{said}");
}

#[test]
fn fast_and_rough_rates_are_integrated_at_once_and_exactly() {
    // ∫(1 + 20 sin²(400πt)) = 22 on [0, 2], and ∫ of a box one: q(2) = e^{−∫γ}.
    for (rate, exact) in
        [("1 + 20*sin(400*pi*t)^2", 22.0), ("if(t > 1.003 and t < 1.004, 1000, 0)", 1.0)]
    {
        let scene = format!(
            "[system]\nstate = ['q', 'p']\nB = 'canonical'\nH0 = '0*p^2/2'\n[damping]\n\
             rate = '{rate}'\n[run]\ninitial = [1, 0]\nuntil = 2\nsteps = 200\n\
             [expect]\nof = ['q']\naccuracy = 1e-6\n"
        );
        let folder = with_scene(&scene);
        let start = std::time::Instant::now();
        let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
        let q = found["estimates"][0]["value"].as_f64().unwrap();
        assert!((q / f64::exp(-exact) - 1.0).abs() < 2e-12, "{rate}: {found}");
        assert!(start.elapsed().as_secs() < 20, "{rate}: {:?}", start.elapsed());
        succeeds(folder.path(), &["inspect", "scene.toml"]);
    }
}

/// Sums that are zero by symmetry have the rounding errors of their terms, and no digit is wrong.
#[test]
fn zeros_by_symmetry_have_rounding_errors() {
    let text = "[system]\nstate = [\"q[1..3]\", \"p[1..3]\"]\nB = \"canonical\"\n\
                H0 = \"dot(p, p)/2 + (q1 - q2)^2/2 + (q2 - q3)^4/4\"\n\
                [run]\ninitial = [0.7, 0.2, -0.9, 0.3, -0.1, -0.2]\nuntil = 5\nsteps = 500\n\
                [observe]\nP = \"p1 + p2 + p3\"\nQ = \"(q1 + q2 + q3)/3\"\n";
    let lattice = "[system]\nname = \"spin-lattice\"\nparameters = { sizes = [16], periodic = true, \
                   field = [0, 0, 0.5] }\n[run]\ninitial = [\"0.001*cos(2*pi*3*x/16)\", \
                   \"0.001*sin(2*pi*3*x/16)\", \"sqrt(1-1e-6)\"]\nuntil = 2\nsteps = 400\n";
    for (text, paths) in [(text, "1"), (lattice, "1"), (lattice, "100")] {
        let words = ["run", "scene.toml", "--json", "--paths", paths];
        let found = json(with_scene(text).path(), &words);
        assert_eq!(found["warnings"], serde_json::json!([]), "{paths}: {found:#}");
    }
    // The twin: too few steps, and P is still zero.
    let said = run(with_scene(text).path(), &["run", "scene.toml", "--steps", "5"]);
    let said =
        String::from_utf8_lossy(&said.stderr).into_owned() + &String::from_utf8_lossy(&said.stdout);
    let warning = said.lines().find(|line| line.contains("no digit")).expect("a warning");
    assert!(warning.contains("q1") && !warning.contains('P'), "{said}");
}
