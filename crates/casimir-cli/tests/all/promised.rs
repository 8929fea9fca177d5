//! Heat baths, words about what is kept, and equations: what is said follows from the facts.

use std::path::Path;

use crate::common::{fails, json, succeeds, with_scene};

/// A scene of formulas.
fn scene(state: &str, b: &str, energy: &str, rest: &str, initial: &str) -> String {
    format!(
        "[system]\nstate = {state}\nB = {b}\nH0 = \"{energy}\"\n{rest}\n[run]\n\
         initial = {initial}\nuntil = 3\nsteps = 12\n"
    )
}

#[track_caller]
fn bath(scene: &str) -> Option<f64> {
    let found = json(with_scene(scene).path(), &["inspect", "scene.toml", "--json"]);
    found["bath"]["beta"].as_f64().map(|beta| 1.0 / beta)
}

const PLANE: &str = "[\"q\", \"p\"]";
const FOUR: &str = "[\"q1\", \"q2\", \"p1\", \"p2\"]";
const CANONICAL: &str = "\"canonical\"";

/// The noise for the mass at the initial value, as it was taken, is no bath where this is refused.
#[test]
fn a_bath_that_would_be_wrong_is_refused_with_what_is_right() {
    let half = "rates = { p = 0.5 }";
    let both = "rates = { p1 = 0.5, p2 = 0.5 }";
    let spins = "[\"s[xyz]\"]";
    for (state, b, energy, rates, initial, old, words) in [
        (
            PLANE,
            CANONICAL,
            "q^2/2 + p^2/(2*(1 + q^2))",
            half,
            "[2, 0]",
            "sqrt(5)*q",
            "depends on `q`",
        ),
        (PLANE, CANONICAL, "q^2/2 + p^2/2 + p^4/4", half, "[1, 0]", "q", "no term p^2/(2*m)"),
        (PLANE, CANONICAL, "q^2/2 + sqrt(1 + p^2)", half, "[1, 0]", "q", "no term p^2/(2*m)"),
        (PLANE, CANONICAL, "q^2/2 + (p - 0.3)^2/2", half, "[1, 0]", "q", "no term p^2/(2*m)"),
        (
            FOUR,
            CANONICAL,
            "p1^2/2 + p2^2/(2*q1^2) + q1^2",
            both,
            "[1, 0, 0, 1]",
            "q2",
            "∂H0/∂p2 depends on `q1`",
        ),
        (
            FOUR,
            CANONICAL,
            "p1^2/2 + p2^2/2 + 0.3*p1*p2 + q1^2",
            both,
            "[1, 0, 0, 1]",
            "q2",
            "∂H0/∂p1 depends on `p2`",
        ),
        (PLANE, "[[\"1 + q^2\"]]", "q^2/2 + p^2/2", half, "[0, 0]", "q", "have a divergence"),
        // q moves both momenta.
        (
            "[\"q\", \"p1\", \"p2\"]",
            "[[\"1\", \"1\"], [\"0\"]]",
            "p1^2/2 + p2^2/2 + q^2",
            "rates = { p1 = 0.5 }",
            "[1, 0, 0]",
            "q",
            "`p1` is not the momentum of one",
        ),
        (
            spins,
            "\"spins\"",
            "-0.5*sz",
            "rates = { sx = 0.5 }",
            "[0.6, 0, 0.8]",
            "sy",
            "`sx` is not the momentum of one",
        ),
        (
            spins,
            "\"rigid\"",
            "sx^2/2 + sy^2/4 + sz^2/6",
            "rates = { s = 0.5 }",
            "[0, 0.3, 0.1]",
            "sy",
            "acts on it `through` functions",
        ),
    ] {
        let with = |rest: &str| scene(state, b, energy, rest, initial);
        let place = ["line 7, column 15", words];
        let refused =
            with(&format!("[bath]\n{}\ntemperature = 1", rates.replace("rates", "friction")));
        fails(with_scene(&refused).path(), &["run", "scene.toml"], 2, &place);
        let taken = bath(&with(&format!("H = [\"{old}\"]\n[damping]\n{rates}")));
        assert_eq!(taken, None, "{energy}");
    }
    let time = scene(
        PLANE,
        CANONICAL,
        "(1 + 0.5*sin(t))*p^2/2 + q^2",
        "[bath]\nfriction = { p = 0.5 }\ntemperature = 1",
        "[1, 0]",
    );
    fails(with_scene(&time).path(), &["run", "scene.toml"], 2, &["no term p^2/(2*m)"]);
    let twice = "[system]\nstate = [\"q\", \"q\"]\nB = \"canonical\"\nH0 = \"q\"\n\
                 [run]\ninitial = [1, 0]\nuntil = 1\nsteps = 8\n";
    fails(with_scene(twice).path(), &["run", "scene.toml"], 2, &["`q`"]);
    for (kt, words) in [
        ("\"1 + q^2\"", "depends on t and parameters alone"),
        ("-1", "kT must be positive, got -1 at t = 0"),
    ] {
        let wrong = time.replace("(1 + 0.5*sin(t))*", "").replace("re = 1", &format!("re = {kt}"));
        fails(with_scene(&wrong).path(), &["run", "scene.toml"], 2, &[words]);
    }
    // The noise that the first message names: ∂H/∂q = √(2γ m kT).
    let right =
        "H = [\"(q*sqrt(1 + q^2) + ln(q + sqrt(1 + q^2)))/2\"]\n[damping]\nrates = { p = 0.5 }";
    let right = scene(PLANE, CANONICAL, "q^2/2 + p^2/(2*(1 + q^2))", right, "[2, 0]");
    assert!((bath(&right).unwrap() - 1.0).abs() < 1e-9);
    // A noise √(1 + p²) of p, whose field has a divergence: e^{−βH₀} is stationary for a law of
    // Student, where γp = ½σ²(1 + p²)(βH₀′ − p/(1 + p²)), so that β = 1 + 2γ/σ².
    let student = "H = [\"0.8*q\"]\n[damping]\nrates = { p = 0.5 }";
    let student = scene(PLANE, "[[\"sqrt(1 + p^2)\"]]", "ln(1 + p^2)/2", student, "[1, 1]");
    assert!((bath(&student).unwrap() * (1.0 + 1.0 / 0.64) - 1.0).abs() < 1e-9);
}

#[test]
fn a_bath_of_constant_masses_has_its_temperature() {
    let field = "[[\"0\", \"1\", \"0\"], [\"0\", \"1\"], [\"1 + x1^2\"]]";
    for (state, b, energy, rates, initial) in [
        (PLANE, "[[\"2\"]]", "q^4 + p^2/5", "p = 0.5", "[1, 0]"),
        ("[\"p\", \"q\"]", "[[\"2\"]]", "q^4 + p^2/5", "p = 0.5", "[1, 0]"),
        // A charge in a magnetic field, in velocities.
        (
            "[\"x1\", \"x2\", \"v1\", \"v2\"]",
            field,
            "v1^2/2 + v2^2/2 + x1^2 + x2^4",
            "v1 = 0.2, v2 = 0.7",
            "[1, 0, 0, 1]",
        ),
        (PLANE, CANONICAL, "p^2/2 + q^2/2", "q = 0.3, p = \"2*0.25\"", "[1, 0]"),
    ] {
        let rest = format!("[bath]\nfriction = {{ {rates} }}\ntemperature = 1.7");
        let found = bath(&scene(state, b, energy, &rest, initial));
        assert!(found.is_some_and(|kt| (kt - 1.7).abs() < 1e-8), "{state} {energy}: {found:?}");
    }
    // A drive, and a temperature that changes, are no reason to refuse.
    let driven = scene(
        PLANE,
        CANONICAL,
        "p^2/2 + q^2 - cos(t)*q",
        "[bath]\nfriction = { p = \"1 + t\" }\ntemperature = \"1 + t\"",
        "[1, 0]",
    );
    succeeds(with_scene(&driven).path(), &["inspect", "scene.toml"]);
}

#[test]
fn a_lattice_has_a_temperature_where_its_noise_gives_one() {
    let lattice = |parameters: &str, initial: &str, end: &str| {
        format!(
            "[system]\nname = \"spin-lattice\"\nparameters = {{ sizes = [2]{parameters} }}\n[bath]\n\
             temperature = 0.5\ntransverse = {{ s = 0.1 }}\n[run]\ninitial = {initial}\nuntil = 1\nsteps = 8\n{end}"
        )
    };
    let unit = "[0, 0.6, 0.8]";
    for (scene, words) in [
        (lattice(", local = false", unit, ""), "a noise for each spin, `local`"),
        (lattice("", unit, "[damping]\nrate = 0.1\n"), "and no [damping]"),
        (lattice("", "[\"z1\", 0, 1]", ""), "spins have lengths from"),
    ] {
        fails(with_scene(&scene).path(), &["run", "scene.toml"], 2, &["line 5", words]);
    }
    assert!((bath(&lattice("", unit, "")).unwrap() - 0.5).abs() < 1e-9);
}

/// What `inspect` says of paths, and what `run` says; `compare` names the same scheme.
fn said(folder: &Path, file: &str) -> [String; 2] {
    let found = json(folder, &["inspect", file, "--json"]);
    let [scheme, because] =
        ["scheme", "because"].map(|key| found["recommended"][0][key].as_str().unwrap().to_owned());
    let run = succeeds(folder, &["run", file, "--scheme", "auto", "--paths", "1", "--out", "run"]);
    let line = run.lines().find(|line| line.starts_with(&*scheme) && line.contains(": it "));
    let compared =
        succeeds(folder, &["compare", file, "--budget", "0.1", "--error", "0.1", "--out", "all"]);
    let auto = compared.split("`auto` takes ").nth(1).unwrap_or_else(|| panic!("{compared}"));
    assert_eq!(auto.split([',', ' ']).next(), Some(&*scheme), "{compared}");
    [format!("{scheme}: {because}"), line.unwrap_or_else(|| panic!("{run}")).to_owned()]
}

/// The words about these scenes, of `run`: those of `inspect` may go on.
#[track_caller]
fn words(text: &str) -> String {
    let folder = with_scene(text);
    let [inspect, run] = said(folder.path(), "scene.toml");
    assert!(inspect.starts_with(&run), "{inspect}\n{run}");
    run
}

#[test]
fn what_is_kept_follows_from_all_damping() {
    let spin =
        |rest: &str| scene("[\"s[1..3]\"]", "\"spins\"", "-0.5*s3 + s1^2", rest, "[1, 0, 0]");
    let kubo = |rest: &str| {
        scene(
            PLANE,
            CANONICAL,
            "(p^2 + q^2)/2",
            &format!("H = [\"0.3*(p^2 + q^2)\"]\n{rest}"),
            "[1, 0]",
        )
    };
    let lattice = |parameters: &str, end: &str| {
        format!(
            "[system]\nname = \"spin-lattice\"\nparameters = {{ sizes = [3], noise = 0.1{parameters} }}\n\
             [run]\ninitial = [0, 0, 1]\nuntil = 1\nsteps = 8\n{end}"
        )
    };
    let body =
        "[system]\nname = \"rigid-body\"\n[run]\ninitial = [0, 0.6, 0.8]\nuntil = 1\nsteps = 8\n";
    let pendulum =
        "[system]\nname = \"pendulum\"\n[run]\ninitial = [0.3, 1]\nuntil = 1\nsteps = 8\n";
    let uniform = "[damping]\nrate = \"cos(2*pi*t)\"\n";
    for (scene, expected) in [
        (spin(""), "sexp: it keeps the Casimirs, and the energy"),
        (
            spin("[damping]\nrates = { s1 = 0.1 }"),
            "sexp: it damps exactly, and keeps the energy but for the damping",
        ),
        (
            spin("[damping]\nrate = 0.1"),
            "sexp: it keeps the laws of Casimirs, and the energy but for the damping",
        ),
        (kubo(""), "sexp-h: it keeps the energy; space-time areas give strong order 1.5"),
        (
            kubo("[damping]\nrate = 0.3"),
            "sexp-h: it damps exactly, and keeps the law of the energy; space-time areas give strong order 1.5",
        ),
        (
            kubo("[damping]\nrates = { p = 0.3 }"),
            "sexp-h: it damps exactly, and keeps the energy but for the noise and the damping; space-time areas give strong order 1.5",
        ),
        (lattice("", ""), "split: it keeps the Casimirs, and nearly the energy but for the noise"),
        (
            lattice(", transverse = 0.1", ""),
            "sexp-li: it keeps the Casimirs, and nearly the energy but for the noise and the bath",
        ),
        (
            lattice("", "[damping]\nrate = 1\ncomponents = [\"s1x\"]\n"),
            "split: it keeps the laws of Casimirs, and nearly the energy but for the noise and the damping",
        ),
        (
            lattice(", periodic = true", ""),
            "sexp: it keeps the Casimirs, and the energy but for the noise; split would not do: axis 1",
        ),
        (
            lattice(", field = [0, 0, \"1+cos(t)\"]", ""),
            "sexp: it keeps the Casimirs, and the energy but for the noise and what depends on time; split would not do: a field by formulas has no flow",
        ),
        (
            body.to_owned(),
            "sexp-levy: it keeps the Casimirs, and the energy but for the noise; Lévy areas give strong order 1",
        ),
        (
            format!("{body}{uniform}"),
            "sexp-levy: it keeps the laws of Casimirs, and the energy but for the noise and the damping; Lévy",
        ),
        (pendulum.to_owned(), "sexp: it keeps the energy"),
    ] {
        let found = words(&scene);
        let whole = expected.contains("axis 1") || expected.ends_with("Lévy");
        assert!(found == expected || whole && found.starts_with(expected), "{expected}\n{found}");
    }
    // Without iteration a constant B makes an explicit step.
    let oscillator = kubo("").replace("until", "scheme = \"sexp-li\"\nuntil");
    let text = succeeds(with_scene(&oscillator).path(), &["run", "scene.toml"]);
    assert!(text.contains("the energy drifts; auto takes sexp-h"), "{text}");
    let text = succeeds(
        with_scene(&spin("[damping]\nrates = { s1 = 0.1 }")).path(),
        &["inspect", "scene.toml"],
    );
    assert!(text.contains("damping  γ = 0.1 on s1; ") && !text.contains("γ = 0;"), "{text}");
}

#[test]
#[ignore = "long: run by the gate"]
fn inspect_run_and_compare_agree_on_every_scene() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for file in std::fs::read_dir(project.join("scenes")).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        let times = text.lines().any(|line| line.starts_with("times = "));
        let steps = |line: &str| {
            if line.starts_with("steps = ") && !times { "steps = 200" } else { line }.to_owned()
        };
        words(&text.lines().map(steps).collect::<Vec<_>>().join("\n"));
    }
}

#[test]
fn equations_are_compared_where_auxiliary_momenta_are_zero() {
    let given = |drift: &str, noise: &str| {
        let rest =
            format!("H = [\"px*x*0.4\"]\ncalculus = \"ito\"\ndrift = {drift}\nnoise = {noise}");
        scene("[\"x\", \"px\"]", CANONICAL, "px*x*(0.5 - x)", &rest, "[1, 0]")
    };
    let right = "x*(0.5 - x) + 0.08*x";
    for (drift, noise) in [
        (format!("[\"{right}\"]"), "[[\"0.4*x\"]]"),
        (format!("[\"{right}\", \"0\"]"), "[[\"0.4*x\", \"0\"]]"),
        (format!("[\"{right}\", \"px*x\"]"), "[[\"0.4*x\", \"-0.4*px\"]]"),
    ] {
        succeeds(with_scene(&given(&drift, noise)).path(), &["inspect", "scene.toml"]);
    }
    for (drift, noise, words) in [
        ("[\"x*(0.5 - x)\"]", "[[\"0.4*x\"]]", "Itô's ½Σ b′b is the difference"),
        ("[\"x*(0.5 - x) + 0.08*x\"]", "[[\"0.4*x^2\"]]", "this noise 1 is"),
        ("[\"x*(0.5 - x) + 0.08*x\", \"1\"]", "[[\"0.4*x\", \"0\"]]", "this drift is 1.0"),
        ("[\"1\", \"1\", \"1\"]", "[[\"0.4*x\"]]", "one formula for each of 2 components, got 3"),
    ] {
        fails(with_scene(&given(drift, noise)).path(), &["run", "scene.toml"], 2, &[words]);
    }
    // Motion in a plane has no auxiliary components.
    let plane = "drift = [\"p1\", \"p2\", \"-q1\", \"q2\"]";
    let plane = scene(FOUR, CANONICAL, "(p1^2 + p2^2 + q1^2 + q2^2)/2", plane, "[1, 0, 0, 0]");
    fails(with_scene(&plane).path(), &["run", "scene.toml"], 2, &["this drift is"]);
}

#[test]
fn multiples_of_blocks_are_added_and_subtracted() {
    let equations = |b: &str| {
        let scene = scene(
            FOUR,
            &format!("\"{b}\""),
            "p1^2/2 + p2^2/2 + q1^2/2 + q2^2/2",
            "",
            "[1, 0, 0, 1]",
        );
        let text = succeeds(with_scene(&scene).path(), &["inspect", "scene.toml"]);
        [1, 2].map(|line| text.lines().nth(line).unwrap().trim().to_owned())
    };
    for (b, first, second) in [
        ("canonical(q1,p1)-1*canonical(q2,p2)", "p1", "-p2"),
        ("-canonical(q1, p1) + canonical(q2, p2)/4", "-p1", "0.25 p2"),
        ("2*(canonical(q1, p1) - 1e-2*canonical(q2, p2))", "2 p1", "-0.02 p2"),
        ("canonical(q1, p1)*2 - -3*canonical(q2, p2)", "2 p1", "3 p2"),
        ("-(canonical)", "-p1", "-p2"),
    ] {
        assert_eq!(
            equations(b),
            [format!("dq1 = {first} dt"), format!("dq2 = {second} dt")],
            "{b}"
        );
    }
    for (b, words) in
        [("1/canonical", "a multiple of a block"), ("canonical - 2", "a multiple of a block")]
    {
        let wrong = scene(FOUR, &format!("\"{b}\""), "p1^2", "", "[1, 0, 0, 1]");
        fails(with_scene(&wrong).path(), &["run", "scene.toml"], 2, &[words]);
    }
}

#[test]
fn findings_do_not_mislead() {
    let text = |energy: &str, rest: &str| {
        let scene = scene(PLANE, CANONICAL, energy, rest, "[1, 0]");
        succeeds(with_scene(&scene).path(), &["inspect", "scene.toml"])
    };
    let zero = text("0", "H = [\"0.3*q\"]");
    assert!(zero.contains("no multiples of H0 (off") && !zero.contains("NaN"), "{zero}");
    assert!(!zero.contains("commute") && !zero.contains("damps exactly"), "{zero}");
    let pole = text("p^2/(2*q^2) + q^2/2", "");
    assert!(pole.contains("by quadrature: relative error") && !pole.contains("NOT"), "{pole}");
    let bath = text("p^2/2 - q^2/2", "[bath]\nfriction = { p = 0.5 }\ntemperature = 1");
    assert!(bath.contains("it has no integral"), "{bath}");
    let inside =
        scene(PLANE, CANONICAL, "p^2/2", "", "[1, 0]") + "[observe]\na = \"1 + integral(q)\"\n";
    fails(with_scene(&inside).path(), &["run", "scene.toml"], 2, &["and use that"]);
}

/// `inspect` lists flows in words and in JSON, or says why there are none.
#[test]
fn inspect_lists_flows() {
    let found = |energy: &str| {
        let text = scene("[\"q\", \"p\"]", "\"canonical\"", energy, "", "[1, 0]");
        let folder = with_scene(&text);
        let told = succeeds(folder.path(), &["inspect", "scene.toml"]);
        (told, json(folder.path(), &["inspect", "scene.toml", "--json"])["flows"].clone())
    };
    let (told, flows) = found("p^2/2 - cos(q)");
    assert_eq!(flows, serde_json::json!(["kick by 0.5 p^2 of H0", "kick by -cos(q) of H0"]));
    assert!(told.contains("Flows, for split and nv\n  - kick by 0.5 p^2 of H0"), "{told}");
    let (told, flows) = found("p^2*q^2");
    assert_eq!(flows, serde_json::json!([]));
    assert!(told.contains("No flows, for split and nv: no flow of p^2 q^2 is known"), "{told}");
}
