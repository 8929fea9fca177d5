//! Derivatives of expectations with respect to parameters.

use serde_json::Value;

use crate::common::{fails, json, run, with_scene};

/// The estimate of a derivative with its half-width, of function number `k`.
fn derivative(found: &Value, parameter: &str, k: usize) -> [f64; 2] {
    let estimate = &found["gradient"][parameter][k];
    ["value", "half_width"].map(|key| estimate[key].as_f64().unwrap())
}

/// Asserts derivatives, each within 1.6 half-widths: three standard errors and more.
#[track_caller]
fn are(scene: &str, exact: &[(&str, usize, f64)]) {
    let folder = with_scene(scene);
    let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
    for &(parameter, k, exact) in exact {
        let [value, half] = derivative(&found, parameter, k);
        assert!((value - exact).abs() < 1.6 * half, "∂/∂{parameter}: {value} ± {half}, {exact}");
        assert!(half <= found["accuracy"].as_f64().unwrap(), "{found}");
    }
}

/// E[q] = e^{−s²T/2} cos wT. At w = 1 the formulas have a simpler form than nearby.
const KUBO: &str = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "w*(q^2 + p^2)/2"
H = ["s*(q^2 + p^2)/2"]
parameters = { w = 1, s = 0.5 }
[run]
initial = [1, 0]
until = 2
steps = 64
[expect]
of = ["q"]
accuracy = 5e-4
gradient = ["s", "w"]
"#;

#[test]
fn derivatives_of_an_oscillator_are_exact() {
    let exact = [("s", 0, 0.324_095_5), ("w", 0, -1.416_323)];
    are(KUBO, &exact);
    are(&KUBO.replace("steps = 64", "steps = 64\nscheme = \"sexp\""), &exact);
}

/// On new noise the quotient is off by the sampling errors of both means over 2h.
#[test]
fn difference_quotients_agree_on_common_noise_alone() {
    let loose = KUBO.replace("accuracy = 5e-4", "accuracy = 0.05").replace(", \"w\"]", "]");
    let found = |scene: &str, seed: &str| {
        json(with_scene(scene).path(), &["expect", "scene.toml", "--json", "--seed", seed])
    };
    let [value, half] = derivative(&found(&loose, "1"), "s", 0);
    let without = loose.replace("gradient = [\"s\"]", "");
    let mean = |s: &str, seed: &str| -> f64 {
        let scene = without.replace("s = 0.5", &format!("s = {s}"));
        found(&scene, seed)["estimates"][0]["value"].as_f64().unwrap()
    };
    let quotient = |seed: &str| (mean("0.501", seed) - mean("0.499", "1")) / 0.002;
    assert!((quotient("1") - value).abs() < half, "{} {value} ± {half}", quotient("1"));
    for seed in ["2", "3", "4"] {
        assert!((quotient(seed) - value).abs() > 2.0 * half, "{} {value} ± {half}", quotient(seed));
    }
}

/// q(T) is normal with mean cos T and variance s²(T/2 − sin 2T/4). The logarithm does not exist at
/// changes of a hundred, and tanh is constant there.
#[test]
fn a_parameter_may_be_in_functions_alone() {
    let scene = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + q^2/2"
H = ["0.3*q"]
parameters = { c = 2 }
[run]
initial = [1, 0]
until = 1.5
steps = 64
[expect]
of = ["exp(c*q)", "ln(q + c)", "tanh(c*q)"]
accuracy = 1e-3
gradient = ["c"]
"#;
    let (mean, variance) = (1.5f64.cos(), 0.09 * (0.75 - 3f64.sin() / 4.0));
    let of = |function: fn(f64) -> f64| -> f64 {
        let step = 0.01;
        let points = (-800..=800).map(|k| step * f64::from(k));
        let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        points.map(|x| step * density(x) * function(mean + variance.sqrt() * x)).sum()
    };
    let exact = [
        ("c", 0, of(|q| q * (2.0 * q).exp())),
        ("c", 1, of(|q| if q > -1.9 { 1.0 / (q + 2.0) } else { 0.0 })),
        ("c", 2, of(|q| q / (2.0 * q).cosh().powi(2))),
    ];
    are(scene, &exact);
}

/// Of friction on one component, of an initial value, of the noise, and of φ itself.
#[test]
fn rates_initial_values_and_functions_are_differentiated() {
    let scene = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + k*q^2/2"
H = ["s*q"]
parameters = { k = 2, s = 0.7, f = 0.8, q0 = 1 }
[damping]
rates = { p = "f" }
[run]
initial = ["q0", 0]
until = 1.5
steps = 64
[expect]
of = ["q", "s*q^2"]
accuracy = 5e-4
gradient = ["k", "s", "f", "q0"]
"#;
    // By the matrix exponential and the covariance of the solution.
    let (square, by_s) = (0.121_640_38, 0.318_496_6);
    are(
        scene,
        &[
            ("k", 0, -0.350_738_59),
            ("k", 1, 0.7 * 0.028_088_05),
            ("s", 0, 0.0),
            ("s", 1, square + 0.7 * by_s),
            ("f", 0, 0.396_832_25),
            ("f", 1, 0.7 * -0.164_560_79),
            ("q0", 0, -0.100_829_41),
            ("q0", 1, 0.7 * 0.020_333_14),
        ],
    );
}

/// The rigid body whose means are known by spherical harmonics to degree 27, with damping
/// g cos 2t.
#[test]
fn derivatives_of_a_rigid_body_are_those_on_the_sphere() {
    let scene = r#"
[system]
state = ["x", "y", "z"]
B = "rigid"
H0 = "x^2/(2*I1) + y^2/(2*I2) + z^2/(2*I3)"
H = ["x^2/(2*J1)", "y^2/(2*J2)", "z^2/(2*J3)"]
parameters = { I1 = 2, I2 = 1, I3 = "2/3", J1 = 1, J2 = 2, J3 = 3, g = 0.5 }
[damping]
rate = "g*cos(2*t)"
[run]
initial = ["cos(1.1)", 0, "sin(1.1)"]
until = 1
steps = 64
[expect]
of = ["cos(z)"]
accuracy = 2e-4
gradient = ["I1", "I2", "I3", "J1", "J2", "J3", "g"]
"#;
    are(
        scene,
        &[
            ("I1", 0, 7.476_86e-3),
            ("I2", 0, -2.578_22e-2),
            ("I3", 0, -9.281_7e-3),
            ("J1", 0, -4.320_75e-2),
            ("J2", 0, -1.275_45e-3),
            ("J3", 0, 6.808_5e-4),
            ("g", 0, 0.156_913),
        ],
    );
}

/// The change of a parameter follows its effect, whatever its size, without noise as with it; what
/// paths collect for others is left out. The intervals are whole: bounds, without sampling errors.
#[test]
fn parameters_of_all_sizes_have_derivatives() {
    let phase = |t0: f64| {
        // q″ + q = cos(t − t0), differentiated: q = ½t sin(t − t0) + ½ sin t0 sin t.
        let t = 2.0f64;
        -0.5 * t * (t - t0).cos() + 0.5 * t0.cos() * t.sin()
    };
    let pushed = "H0 = \"(q^2 + p^2)/2 + w*q\"\nH = []";
    for (w, h, exact) in [
        ("1e-12", pushed, 2f64.cos() - 1.0),
        ("0", pushed, 2f64.cos() - 1.0),
        ("0.1", pushed, 2f64.cos() - 1.0),
        ("1000", "H0 = \"w*(q^2 + p^2)/2\"\nH = []", -2.0 * 2000f64.sin()),
    ] {
        let scene = KUBO.replace("H0 = \"w*(q^2 + p^2)/2\"\nH = [\"s*(q^2 + p^2)/2\"]", h);
        let scene = scene.replace("w = 1, s = 0.5", &format!("w = {w}"));
        let events = "[events]\nlate = \"q < -9\"\n[observe]\nmean = \"average(q)\"\n[expect]";
        let scene = scene.replace("[\"s\", \"w\"]", "[\"w\"]").replace("[expect]", events);
        are(&scene, &[("w", 0, exact)]);
    }
    let drive = "H0 = \"(q^2 + p^2)/2 - cos(t - w)*q\"\nH = []";
    let scene = KUBO.replace("H0 = \"w*(q^2 + p^2)/2\"\nH = [\"s*(q^2 + p^2)/2\"]", drive);
    let scene = scene.replace("w = 1, s = 0.5", "w = 1e6").replace("[\"s\", \"w\"]", "[\"w\"]");
    are(&scene.replace("initial = [1, 0]", "initial = [0, 0]"), &[("w", 0, phase(1e6))]);
}

#[test]
fn derivatives_that_paths_do_not_show_are_refused() {
    for (from, to, words) in [
        ("of = [\"q\"]", "of = [\"q > 1\"]", "derivative by s: it changes a noise"),
        ("of = [\"q\"]", "of = [\"if(q > w, q, 0)\"]", "`w`, which is in what is observed"),
        ("of = [\"q\"]", "of = [\"H0 > 1\"]", "`s`, which is in what is observed"),
        (
            "[expect]\nof = [\"q\"]",
            "[events.far]\nwhen = \"q > w\"\n[expect]\nof = [\"far\"]",
            "`w`, which is in what is observed",
        ),
        ("gradient = [\"s\", \"w\"]", "gradient = [\"x\"]", "no parameter `x`"),
        ("until = 2", "until = \"2*w\"", "no derivative by `w`: it changes the time of the end"),
        (
            "initial = [1, 0]",
            "initial = [\"w*max(u1-0.99,0)\", 0]",
            "the law of random initial values",
        ),
        ("w*(q^2 + p^2)/2", "p^2/2 + w*abs(q)", "abs, min or max, whose field jumps"),
        ("[\"s\", \"w\"]", "[\"s\", \"s\"]", "by `s` is asked for twice"),
        ("[run]", "[damping]\nrate = \"if(t > w, 1, 0)\"\n[run]", "the rate has conditions"),
    ] {
        let folder = with_scene(&KUBO.replace(from, to));
        fails(folder.path(), &["expect", "scene.toml"], 2, &[words]);
    }
    let outside = KUBO.replace("w*(q^2 + p^2)/2", "w*q^2/2").replace("[\"s\", ", "[");
    let folder = with_scene(&outside.replace("of = [\"q\"]", "of = [\"q > 0\"]"));
    let words = ["by w: it changes the drift in directions in which no noise acts"];
    fails(folder.path(), &["expect", "scene.toml"], 2, &words);
}

/// Hénon and Heiles' stars of energy 1/6 over 200 units of time, with an exponent of a tenth.
#[test]
fn derivatives_of_chaos_are_not_believed() {
    let scene = r#"
[system]
state = ["q1", "q2", "p1", "p2"]
B = "canonical"
H0 = "(p1^2 + p2^2)/2 + (q1^2 + q2^2)/2 + l*(q1^2*q2 - q2^3/3)"
H = ["s*q1"]
parameters = { l = 1, s = 1e-3 }
[run]
initial = [0, -0.25, 0.42, 0]
until = 200
steps = 4000
[expect]
of = ["q1"]
accuracy = 1e-2
gradient = ["l"]
"#;
    let words = ["nearby ones separate as exp(0."];
    fails(with_scene(scene).path(), &["expect", "scene.toml"], 2, &words);
}

/// A push at the end, of area w: its growth is that of a parameter, not of paths.
#[test]
fn late_effects_are_no_chaos() {
    let push = "H0 = \"(q^2 + p^2)/2 - w*q*exp(-((t - 1.9)/0.1)^2/2)/(0.1*sqrt(2*pi))\"\nH = []";
    let scene = KUBO.replace("H0 = \"w*(q^2 + p^2)/2\"\nH = [\"s*(q^2 + p^2)/2\"]", push);
    let scene = scene.replace("until = 2\n", "until = 2.5\n").replace("[\"s\", \"w\"]", "[\"w\"]");
    // ∫ sin(2.5 − t) times the push.
    let exact = (-0.5 * 0.1 * 0.1f64).exp() * 0.6f64.sin();
    are(&scene, &[("w", 0, exact)]);
}

/// p is an Ornstein–Uhlenbeck process with the mean m = c(1 − e^{−gT})/g and the variance
/// v = s²(1 − e^{−2gT})/2g; P(p > a) is that of a normal law. The second noise acts on p as well:
/// with both, the span has directions to spare.
#[test]
fn probabilities_and_passages_have_derivatives_by_likelihood_ratios() {
    let scene = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 - c*q"
H = ["0.48*q", "0.64*q"]
parameters = { c = 0.5, g = 0.7 }
[damping]
rates = { p = "g" }
[run]
initial = [0, 0]
until = 2
steps = 64
[probabilities]
above = "p > 0.4"
[expect]
of = ["above", "p"]
accuracy = 3e-2
gradient = ["c", "g"]
"#;
    let exact = [
        ("c", 0, 0.640_891_72),
        ("c", 1, 1.076_290_05),
        ("g", 0, -0.199_903_89),
        ("g", 1, -0.416_497_23),
    ];
    are(scene, &exact);
    // A friction gt: m and v by quadrature.
    let growing = scene.replace("p = \"g\"", "p = \"g*t\"").replace("[\"c\", \"g\"]", "[\"g\"]");
    are(&growing, &[("g", 0, -0.319_759_68), ("g", 1, -0.457_604_37)]);
    // P(max p > a) of a Brownian motion with drift, by reflection.
    let passage = scene
        .replace("p^2/2 - c*q", "-c*q")
        .replace("until = 2", "until = 1")
        .replace("[probabilities]\nabove = \"p > 0.4\"", "[events]\nhit = \"p > 0.7\"")
        .replace("[damping]\nrates = { p = \"g\" }\n", "")
        .replace("[\"above\", \"p\"]", "[\"hit\"]")
        .replace("[\"c\", \"g\"]", "[\"c\"]");
    are(&passage, &[("c", 0, 0.436_295_7)]);
}

/// ∂⟨φ⟩/∂θ = ⟨∂φ⟩ − Cov(φ, ∂(βH₀)): by quadrature for a particle in a double well, exact and by
/// steps with a bias; and the energy of a rigid body, −Var(H)β² by kT at β = 2.
#[test]
fn stationary_averages_have_derivatives() {
    let well = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + (q^2 - 1)^2 + c*q"
parameters = { c = 0.1, kT = 0.7, q0 = 0, b = 1 }
[bath]
temperature = "kT"
friction = { p = 1 }
[run]
initial = ["q0", 0]
until = 20
steps = 400
"#;
    let body = r#"
[system]
state = ["x", "y", "z"]
B = "rigid"
H0 = "x^2/4 + y^2/2 + z^2*3/4"
parameters = { kT = 0.5, b = 1 }
[bath]
temperature = "kT"
through = ["x", "y", "z"]
[run]
initial = ["cos(1.1)", 0, "sin(1.1)"]
until = 10
steps = 400
"#;
    let run = |scene: &str, accuracy: &str, more: &[&str]| {
        let folder = with_scene(scene);
        let of = ["equilibrium", "scene.toml", "--json", "--accuracy", accuracy];
        json(folder.path(), &[&of, more].concat())
    };
    let is = |found: &Value, parameter: &str, k: usize, exact: f64| {
        let [value, half] = derivative(found, parameter, k);
        assert!((value - exact).abs() < 1.6 * half, "∂/∂{parameter}: {value} ± {half}, {exact}");
        assert!(half <= found["accuracy"].as_f64().unwrap(), "{found}");
    };
    let of = ["--of", "q", "--of", "c*q^2", "--gradient", "c", "--gradient", "kT"];
    let schemes: [&[&str]; 2] = [&[], &["--scheme", "baoab"]];
    for scheme in schemes {
        let found = run(well, "0.03", &[&of[..], scheme].concat());
        for (parameter, k, exact) in WELL {
            is(&found, parameter, k, exact);
        }
    }
    // The average itself has a tenth of this error.
    is(&run(well, "3e-3", &["--of", "c*q^2", "--gradient", "c"]), "c", 0, WELL[1].2);
    let found = run(body, "0.02", &["--of", "H0", "--gradient", "kT"]);
    is(&found, "kT", 0, 4.0 * 0.016_200_991_8);
    for (scene, parameter, words) in [
        (well, "q0", "it changes the initial value"),
        (&well.replace("\"canonical\"", "[[\"b\"]]"), "b", "it changes B"),
        (&well.replace("[bath]\ntemperature = \"kT\"\nfriction = { p = 1 }\n", ""), "c", "no"),
    ] {
        let folder = with_scene(scene);
        let arguments = ["equilibrium", "scene.toml", "--gradient", parameter];
        fails(folder.path(), &arguments, 2, &[words]);
    }
}

/// Equipartition: ⟨q²⟩ = kT/k, in units in which kT is small.
#[test]
fn parameters_of_averages_have_any_unit() {
    let scene = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + k*q^2/2"
parameters = { k = 1, kT = 1e-9 }
[bath]
temperature = "kT"
friction = { p = 1 }
[run]
initial = [0, 0]
until = 20
steps = 400
"#;
    let folder = with_scene(scene);
    let of = ["equilibrium", "scene.toml", "--json", "--accuracy", "0.02", "--of", "q^2"];
    let found = json(folder.path(), &[&of[..], &["--gradient", "kT"]].concat());
    let [value, half] = derivative(&found, "kT", 0);
    assert!((value - 1.0).abs() < 1.6 * half && half < 0.1, "{value} ± {half}");
    // Where a function jumps at the parameter, its law is needed and not its values.
    let step = scene.replace("kT = 1e-9", "kT = 1");
    let arguments =
        ["equilibrium", "scene.toml", "--accuracy", "0.02", "--of", "q>k", "--gradient", "k"];
    fails(with_scene(&step).path(), &arguments, 2, &["it is in what is observed"]);
}

/// Large components that θ does not move, and functions in which it is even, at zero.
#[test]
fn changes_are_measured_by_what_depends_on_them() {
    let spectator = r#"
[system]
state = ["q", "p", "Q", "P"]
B = "canonical(q,p)+canonical(Q,P)"
H0 = "p^2/2 + w*q^2/2 + P^2/2"
H = ["0.3*q"]
parameters = { w = 1 }
[run]
initial = [1, 0, 1e8, 0]
until = 2
steps = 64
[expect]
of = ["q"]
accuracy = 3e-3
gradient = ["w"]
"#;
    // E q = cos √w t, the derivative at 1 is −½t sin t.
    are(spectator, &[("w", 0, -2f64.sin())]);
    for (energy, of) in [("k^2*q^2/2", "q"), ("0*q", "q + cos(k*p)")] {
        let even = spectator
            .replace("w*q^2/2", energy)
            .replace("w = 1", "k = 0")
            .replace("[1, 0, 1e8, 0]", "[100, 0, 0, 0]")
            .replace("of = [\"q\"]", &format!("of = [\"{of}\"]"))
            .replace("\"w\"]", "\"k\"]");
        are(&even, &[("k", 0, 0.0)]);
    }
    // A strike that few paths reach: E max(p − a, 0) with p normal, the derivative is −P(p > a).
    let strike = spectator
        .replace("w*q^2/2 + P^2/2", "P^2/2")
        .replace("0.3*q", "0.8*q")
        .replace("w = 1", "a = 1.8")
        .replace("[1, 0, 1e8, 0]", "[0, 0, 0, 0]")
        .replace("until = 2", "until = 1")
        .replace("of = [\"q\"]", "of = [\"max(p - a, 0)\"]")
        .replace("\"w\"]", "\"a\"]");
    are(&strike, &[("a", 0, -0.012_224)]);
    // A stable oscillator in units of its own does not separate.
    let si = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/(2*m) + k*q^2/2"
H = ["1e-13*q"]
parameters = { m = 1e-15, k = 1e-6 }
[damping]
rates = { p = 3e4 }
[run]
initial = [1e-7, 0]
until = 1e-5
steps = 100
[expect]
of = ["q*1e7"]
accuracy = 1e-2
"#;
    let of = ["expect", "scene.toml", "--gradient", "m"];
    // In seconds, some 10¹³, which is not known to 10⁻² but known.
    let output = run(with_scene(si).path(), &of);
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.code() == Some(1) && said.contains("E[∂q*1e7/∂m]"), "{output:?}");
}

/// Noises and components of unlike sizes: each is looked at by itself.
#[test]
fn likelihood_ratios_see_small_components() {
    let scene = |energy: &str, noises: &str, of: &str| {
        format!(
            r#"
[system]
state = ["q1", "p1", "q2", "p2"]
B = "canonical(q1,p1)+canonical(q2,p2)"
H0 = "p1^2/2 + {energy}"
H = [{noises}]
parameters = {{ s = 0.8, c = 0.5 }}
[run]
initial = [0, 0, 0, 0]
until = 1
steps = 64
[expect]
of = ["{of}"]
accuracy = 2e-2
"#
        )
    };
    let fails = |scene: String, parameter: &str, words: &str| {
        let arguments = ["expect", "scene.toml", "--gradient", parameter];
        fails(with_scene(&scene).path(), &arguments, 2, &[words]);
    };
    let pair = "\"1e5*q1\", \"s*q2\"";
    fails(scene("p2^2/2 - s*q2", pair, "p2>0.4"), "s", "it changes a noise");
    let outside = scene("c*p2 - c*1e6*q1", "\"1e6*q1\"", "q2*(p1>0)");
    fails(outside, "c", "in directions in which no noise acts");
    // p2 is normal with mean c and deviation s: ∂P(p2 > 0.4)/∂c.
    let large = "\"1e7*q1\", \"0.8*q2\"";
    let found =
        scene("p2^2/2 - c*q2", large, "p2>0.4").replace("2e-2\n", "2e-2\ngradient = [\"c\"]\n");
    let x: f64 = 0.1 / 0.8;
    are(&found, &[("c", 0, (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt() / 0.8)]);
    let heats = r#"
[system]
state = ["q", "p"]
B = "canonical"
H0 = "p^2/2 + k*q^2/2"
parameters = { k = 1 }
[[bath]]
temperature = 1
through = ["q"]
[[bath]]
temperature = 2
through = ["p"]
[run]
initial = [0.5, 0]
until = 1
steps = 64
[observe]
h2 = "integral(heat2)"
[expect]
of = ["h2"]
accuracy = 1e-2
"#;
    fails(heats.into(), "k", "which is in what is observed");
}

/// By quadrature: of ⟨q⟩ and ⟨cq²⟩.
const WELL: [(&str, usize, f64); 4] = [
    ("c", 0, -1.175_427_78),
    ("c", 1, 0.843_194_80),
    ("kT", 0, 0.174_089_10),
    ("kT", 1, -0.005_084_64),
];

/// Parameters are moved off values at which formulas are simpler; values are those at the
/// parameters.
#[test]
fn values_beside_derivatives_are_those_at_the_parameters() {
    let scene = KUBO.replace("of = [\"q\"]", "of = [\"w\", \"q + s\", \"w*s\"]");
    let folder = with_scene(&scene);
    let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
    let value = |k: usize| found["estimates"][k]["value"].as_f64().unwrap();
    assert!((value(0) - 1.0).abs() < 1e-15 && (value(2) - 0.5).abs() < 1e-15, "{found}");
    for (parameter, k, exact) in [("w", 0, 1.0), ("s", 0, 0.0), ("w", 2, 0.5), ("s", 2, 1.0)] {
        let [value, half] = derivative(&found, parameter, k);
        assert!((value - exact).abs() < 1e-8 + half && half < 5e-4, "{parameter} {found}");
    }
}

/// ∂E max(q − a, 0)/∂a = −P(q > a), with a kink; and none where no path comes near a.
#[test]
fn payoffs_with_a_kink_have_derivatives_where_paths_reach_them() {
    let payoff = |a: f64| {
        KUBO.replace("H = [\"s*(q^2 + p^2)/2\"]", "H = [\"s*q\"]")
            .replace("w = 1, s = 0.5", &format!("w = 1, s = 0.5, a = {a}"))
            .replace("of = [\"q\"]", "of = [\"max(q - a, 0)\"]")
            .replace("accuracy = 5e-4", "accuracy = 0.01")
            .replace("[\"s\", \"w\"]", "[\"a\"]")
    };
    // q(2) is normal with mean cos 2 and variance ¼(1 − sin 4/4).
    let deviation = 0.5 * (1.0 - 4f64.sin() / 4.0).sqrt();
    let above = (0.2 - 2f64.cos()) / deviation;
    assert!((above - 1.130_021_4).abs() < 1e-6, "{above}");
    are(&payoff(0.2), &[("a", 0, -0.129_233_6)]);
    fails(with_scene(&payoff(9.0)).path(), &["expect", "scene.toml"], 1, &["not to be believed"]);
}

/// Rounding errors of many steps over the change of a parameter are in the interval, and what no
/// step can reach is said.
#[test]
fn derivatives_without_noise_know_their_rounding() {
    let scene = "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\n\
                 H0 = \"p^2/2 + w^2*q^2/2\"\nparameters = { w = 1.5 }\n\
                 [run]\ninitial = [1, 0]\nuntil = 1\nsteps = 64\n\
                 [expect]\nof = [\"q\"]\naccuracy = 1\ngradient = [\"w\"]\n";
    let many = &["--coarsest-steps", "32768"][..];
    for (accuracy, more, code) in [("1e-5", &[][..], 0), ("3e-7", &[], 1), ("1e-5", many, 1)] {
        let folder = with_scene(scene);
        let arguments = ["expect", "scene.toml", "--json", "--accuracy", accuracy];
        let output = run(folder.path(), &[&arguments, more].concat());
        let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(output.status.code(), Some(code), "{found:#}");
        let [value, half] = derivative(&found, "w", 0);
        assert!((value + 1.5f64.sin()).abs() < half, "{accuracy}: {value} ± {half}");
        let warnings = found["warnings"].to_string();
        let said = warnings.contains("the change of the parameter alone");
        assert_eq!(said, code == 1, "{found:#}");
    }
}

/// What the change of θ leaves of a derivative, here by the rounding errors of 30 000, counts before
/// samples stop. Black and Scholes: ∂/∂r of the price of a call is KTe^{−rT}N(d₂) = 31.505.
#[test]
fn samples_make_room_for_what_the_change_leaves() {
    let text = r#"
[system]
state = ["S"]
parameters = { S0 = 100, K = 105, r = 0.03, v = 0.25 }
calculus = "ito"
drift = ["r*S"]
noise = [["v*S"]]
[run]
initial = ["S0"]
until = 0.75
steps = 100
[expect]
of = ["exp(-r*0.75)*max(S - K, 0) + 30000"]
accuracy = 0.05
gradient = ["r"]
"#;
    let found = json(with_scene(text).path(), &["expect", "scene.toml", "--json"]);
    let slope = &found["gradient"]["r"][0];
    let [value, half] = ["value", "half_width"].map(|key| slope[key].as_f64().unwrap());
    assert!(found["reached"] == true && half <= 0.05, "{found:#}");
    assert!((value - 31.505).abs() < 1.5 * half, "{found:#}");
}
