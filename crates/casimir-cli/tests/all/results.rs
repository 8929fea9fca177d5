//! What the commands print and write.

use std::{collections::BTreeSet, fs};

use serde_json::Value;

use crate::common::{BODY, OSCILLATOR, SPINS, fails, json, npz, read_json, succeeds, with_scene};

#[test]
fn few_paths_are_tables_and_many_are_statistics() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    let text = succeeds(path, &["run", "scene.toml", "--write", "csv,json,npz"]);
    assert!(text.contains("4 paths, 64 steps of sexp-li"), "{text}");
    let out = path.join("scene-run");
    let page = fs::read_to_string(out.join("index.html")).unwrap();
    for words in ["Oscillator", "Phase portraits", "time t", "sexp-li", "scene.toml", "4 paths"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("<script") && !page.contains("src="));
    let csv = fs::read_to_string(out.join("paths.csv")).unwrap();
    assert!(csv.starts_with("scheme,path,t,q,p,energy\n"), "{}", csv.lines().next().unwrap());
    assert_eq!(csv.lines().count(), 1 + 4 * 65);
    for file in ["paths.json", "paths.npz", "figures/time-q.svg", "figures/portrait-q-p.svg"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    assert!(!out.join("study.csv").exists());
    // Replaced results are told.
    fails(path, &["run", "scene.toml"], 0, &["will be replaced"]);

    let many = "run scene.toml --paths 512 --write csv,json,npz --out many";
    let text = succeeds(path, &many.split(' ').collect::<Vec<_>>());
    assert!(text.contains("512 paths") && text.contains("95 % interval"), "{text}");
    for file in ["study.csv", "study.json", "study.npz", "paths.csv", "figures/end-energy.svg"] {
        assert!(path.join("many").join(file).is_file(), "{file}");
    }
    // Nothing of a checkpoint is left.
    let left = fs::read_dir(path.join("many")).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(left.into_iter().all(|name| !name.to_string_lossy().contains("part")));
}

#[test]
fn formulas_and_systems_of_the_project_agree() {
    let formulas = r#"[system]
state = ["y1", "y2", "y3"]
parameters = { a = 0.5, b = 1, c = 1.5 }
B = [["-y3", "y2"], ["-y1"]]
H0 = "(a*y1^2 + b*y2^2 + c*y3^2)/2"
H = ["y1^2/2", "y2^2/4", "y3^2/6"]
"#;
    let rest = &BODY[BODY.find("[damping]").unwrap()..];
    let value = |text: &str| -> Vec<f64> {
        let json = json(with_scene(text).path(), &["run", "scene.toml", "--json"]);
        ["y1", "y2", "y3"].map(|name| json["at_end"][name]["mean"].as_f64().unwrap()).into()
    };
    let (compiled, formulas) = (value(BODY), value(&format!("{formulas}{rest}")));
    for (a, b) in compiled.iter().zip(&formulas) {
        assert!((a - b).abs() < 1e-13, "{compiled:?} {formulas:?}");
    }
}

#[test]
fn casimirs_stay_on_their_law_and_the_report_says_so() {
    let folder = with_scene(BODY);
    let text = succeeds(folder.path(), &["inspect", "scene.toml"]);
    assert!(text.contains("0.5 y1² + 0.5 y2² + 0.5 y3²"), "{text}");
    assert_eq!(json(folder.path(), &["inspect", "scene.toml", "--json"])["dimension"], 3);
    for text in [BODY, SPINS] {
        let folder = with_scene(&text.replace("paths = 256", "paths = 2"));
        succeeds(folder.path(), &["run", "scene.toml", "--write", "json"]);
        let json = read_json(folder.path().join("scene-run/paths.json"));
        let columns = json[0]["columns"].as_array().unwrap().iter();
        let of_laws = columns.filter(|c| c["name"].as_str().unwrap().ends_with("defect"));
        let defects: Vec<_> = of_laws.flat_map(|c| c["values"].as_array().unwrap()).collect();
        let small = |defect: &&Value| defect.as_f64().unwrap().abs() < 1e-13;
        assert!(!defects.is_empty() && defects.iter().all(small));
    }
}

#[test]
fn expectations_have_intervals() {
    let folder = with_scene(OSCILLATOR);
    let text = succeeds(folder.path(), &["expect", "scene.toml"]);
    assert!(text.contains("E[energy]") && text.contains("E[q]") && !text.contains("NOT"), "{text}");
    let json = json(folder.path(), &["expect", "scene.toml", "--json", "--out", "kept"]);
    assert_eq!(json["reached"], true);
    for estimate in json["estimates"].as_array().unwrap() {
        assert!(estimate["half_width"].as_f64().unwrap() <= 0.05);
    }
    assert!(folder.path().join("kept/expect.json").is_file());
    let none = OSCILLATOR.split("[expect]").next().unwrap();
    fails(with_scene(none).path(), &["expect", "scene.toml"], 2, &["[expect]"]);
}

#[test]
fn helpers_for_people_and_editors_are_printed() {
    let folder = with_scene(OSCILLATOR);
    assert!(json(folder.path(), &["schema"])["properties"]["system"].is_object());
    for command in ["new", "inspect", "run", "expect", "order", "compare", "plan", "part"] {
        let help = succeeds(folder.path(), &["help", command]);
        assert!(help.contains("Example"), "{command}: {help}");
    }
}

#[test]
fn orders_and_comparisons_are_measured() {
    let folder = with_scene(&OSCILLATOR.replace("sexp-li", "auto"));
    let path = folder.path();
    let text = succeeds(path, &["order", "scene.toml", "--scheme", "heun", "--path-steps", "1e7"]);
    assert!(text.contains("strong, y(T): order 1;") && text.contains("weak, E[energy]"), "{text}");
    assert_eq!(read_json(path.join("scene-order/order.json"))["strong"]["order"], 1.0);
    let text = succeeds(path, &["compare", "scene.toml", "--error", "0.05", "--budget", "20"]);
    assert!(text.contains("Take ") && text.contains("sexp-li"), "{text}");
    for file in ["scene-order/strong.svg", "scene-order/weak.svg", "scene-compare/compare.svg"] {
        assert!(fs::read_to_string(path.join(file)).unwrap().starts_with("<svg"), "{file}");
    }
}

#[test]
fn nv_is_a_scheme_like_the_others() {
    let expect = "[expect]\nof = [\"y3\"]\naccuracy = 0.01\n";
    let folder = with_scene(&format!("{}{expect}", BODY.replace("sexp-li", "nv")));
    let path = folder.path();
    for (arguments, words) in [
        ("run scene.toml --paths 128", "steps of nv"),
        ("expect scene.toml", "nv with steps"),
        ("order scene.toml --path-steps 1e7", "strong, y(T)"),
        ("compare scene.toml --error 0.05 --budget 20", "Take "),
    ] {
        let printed = succeeds(path, &arguments.split(' ').collect::<Vec<_>>());
        assert!(printed.contains(words) && !printed.contains("NOT"), "{printed}");
    }
    let json = read_json(path.join("scene-compare/compare.json"));
    let candidates = json["candidates"].as_array().unwrap();
    let nv = candidates.iter().find(|one| one["scheme"] == "nv").expect("a candidate");
    assert!(nv["outcome"]["reached"].is_object(), "{nv}");
    // Flows of the Hamiltonians are not known.
    let unknown = OSCILLATOR.replace("p^2/2 + k*q^2/2", "k*p^2*q^2").replace("s*q", "s*p^2*q");
    let unknown = unknown.replace("sexp-li", "split");
    let words = "line 14, column 10: split needs a sum of parts with flows";
    fails(with_scene(&unknown).path(), &["run", "scene.toml"], 2, &[words, "no flow of p^2 q^2"]);
    for text in [&unknown, SPINS] {
        let words = "nv needs a sum of parts with flows";
        fails(with_scene(text).path(), &["run", "scene.toml", "--scheme", "nv"], 2, &[words]);
    }
}

/// Behind its pole a logarithm has slopes and no value.
#[test]
fn paths_that_leave_the_domain_fail() {
    let text = r#"[system]
state = ["q", "p"]
B = [["1"]]
H0 = "p^2/2 + q - ln(q)"
[run]
initial = [1, 1.5]
until = 50
steps = 100
scheme = "heun"
"#;
    let words = "all paths failed: take more steps";
    fails(with_scene(text).path(), &["run", "scene.toml"], 1, &[words]);
    // With short steps nothing is left.
    succeeds(with_scene(&text.replace("100", "10000")).path(), &["run", "scene.toml"]);
    // At the end q = 1 − t is on the pole of H₀, where all numbers of the state are finite.
    let pole = text.replace("p^2/2 + q - ln(q)", "1e-3/q - p").replace("heun", "em");
    let pole = pole.replace("until = 50", "until = 1").replace("100", "64");
    fails(with_scene(&pole).path(), &["run", "scene.toml"], 1, &[words]);
    succeeds(with_scene(&pole.replace("l = 1", "l = 0.75")).path(), &["run", "scene.toml"]);
}

/// Of three paths the first leaves the domain: nothing is made up for it, and readers are told.
#[test]
fn what_is_left_of_paths_that_fail_is_right_and_said() {
    let text = r#"[system]
state = ["q", "p"]
parameters = { c = 1 }
B = "canonical"
H0 = "p^2/2 + c*(q - ln(q))"
[run]
initial = "states.csv"
until = 50
steps = 100
scheme = "heun"
paths = 3
"#;
    let folder = with_scene(text);
    let path = folder.path();
    fs::write(path.join("states.csv"), "1, 1.5\n1.1, 0\n1, 0.01\n").unwrap();
    succeeds(path, &["run", "scene.toml", "--write", "json,npz"]);
    let tables = read_json(path.join("scene-run/paths.json"));
    let values = |n: usize| -> Vec<f64> {
        let columns = tables[n]["columns"].as_array().unwrap();
        let q = columns.iter().find(|column| column["name"] == "q").unwrap();
        serde_json::from_value(q["values"].clone()).unwrap()
    };
    let [first, second, third] = [0, 1, 2].map(values);
    let q = npz(path.join("scene-run/paths.npz"), "q");
    let (all, n) = (second.len(), first.len());
    assert!(all == 101 && n < all && q.len() == 3 * all);
    assert!(q[..n] == first && q[n..all].iter().all(|q| q.is_nan()), "{q:?}");
    assert!(q[all..2 * all] == second && q[2 * all..] == third);
    // A mean is that of the paths that are left.
    let sweep = ["run", "scene.toml", "--set", "c=1,0.9", "--write", "csv"];
    succeeds(path, &sweep);
    let csv = fs::read_to_string(path.join("scene-run/sweep.csv")).unwrap();
    let mut means = csv.lines().filter_map(|line| line.strip_prefix("1,50.0,q,mean,"));
    let mean: f64 = means.next().expect(&csv).split(',').next().unwrap().parse().unwrap();
    assert!((mean - (second[100] + third[100]) / 2.0).abs() < 1e-14, "{mean}");
    // States come in turn: the first of three 67 times.
    let found = json(path, &["run", "scene.toml", "--paths", "200", "--json"]);
    let page = fs::read_to_string(path.join("scene-run/index.html")).unwrap();
    let lost = "67 of 200 paths failed";
    assert!(found["warnings"].to_string().contains(lost) && page.contains(lost), "{found}");
}

/// A figure says how far a law is missed, to both sides. Heun's rule gains |1 + iτ − τ²/2|² in each
/// step.
#[test]
fn the_largest_defect_is_in_the_caption() {
    for sign in ["", "-"] {
        let folder = with_scene(&format!(
            "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"{sign}(q^2 + p^2)/2\"\n\
             [run]\ninitial = [1, 0]\nuntil = 10\nsteps = 64\nscheme = \"heun\"\n"
        ));
        succeeds(folder.path(), &["run", "scene.toml"]);
        let page = fs::read_to_string(folder.path().join("scene-run/index.html")).unwrap();
        let defect = (1.0 + (10.0f64 / 64.0).powi(4) / 4.0).powi(64) - 1.0;
        assert!(page.contains(&format!("the largest is {defect:.1e}.")), "{defect}");
    }
}

/// One of a pair has two values, which stand one beside the other in a figure with it to the right;
/// autocorrelations have lags up to half of the times from 1.125 to 8, in steps of an eighth.
#[test]
fn dependence_is_drawn_the_right_way_and_from_the_right_time() {
    let folder = with_scene(
        r#"[system]
state = ["q", "p"]
B = "canonical"
H0 = "(p^2 + q^2)/2"
H = ["sqrt(2)*q"]
[damping]
rates = { p = 1 }
[run]
initial = [0, 0]
until = 8
steps = 64
paths = 200
[observe]
two = "if(q > 0, 1, 0)"
[statistics]
pairs = [["two", "p"]]
autocorrelation = ["q"]
from = 1.125
"#,
    );
    let path = folder.path();
    succeeds(path, &["run", "scene.toml", "--write", "json"]);
    let svg = fs::read_to_string(path.join("scene-run/figures/joint-two-p.svg")).unwrap();
    let cells = svg.split(" d=\"").skip(1).filter_map(|path| path.split('"').next());
    let cells = cells.flat_map(|path| path.split('M')).filter_map(|cell| cell.split_once('h'));
    let cells = cells.filter_map(|(from, _)| from.split_once(' '));
    let (x, y): (BTreeSet<&str>, BTreeSet<&str>) = cells.unzip();
    assert!(x.len() == 2 && y.len() > 2, "{x:?} {y:?}");
    let study = read_json(path.join("scene-run/study.json"));
    let lags = study["lagged"][0]["points"].as_array().unwrap();
    // 56 times, and the lag zero.
    assert_eq!((lags.len(), &lags[28]["time"]), (29, &serde_json::json!(3.5)));
}

/// Formulas of observables use H₀, observables above them, and what a lattice has by itself.
#[test]
fn observables_use_observables() {
    let more = "paths = 2\n[observe]\nenergy = \"H0\"\ntwice = \"energy + H0 + 0*q\"\nright = \"if(twice > 0 and q > -9, twice/2, 7)\"";
    let text = OSCILLATOR.replace("paths = 4\n[observe]\nenergy = \"H0\"", more);
    assert_ne!(text, OSCILLATOR);
    let folder = with_scene(&text);
    let path = folder.path();
    let said = succeeds(path, &["run", "scene.toml", "--write", "json"]);
    assert!(said.contains("at the end  path 0") && said.contains("\ntwice"), "{said}");
    let tables = read_json(path.join("scene-run/paths.json"));
    let column = |name: &str| {
        let columns = tables[1]["columns"].as_array().unwrap().iter();
        let values =
            columns.clone().find(|column| column["name"] == name).unwrap()["values"].clone();
        serde_json::from_value::<Vec<f64>>(values).unwrap()
    };
    let (energy, twice, right) = (column("energy"), column("twice"), column("right"));
    assert!(energy.iter().zip(&twice).all(|(energy, twice)| 2.0 * energy == *twice));
    assert_eq!(energy, right);
    let later = text.replace("energy = \"H0\"", "early = \"twice\"");
    let folder = with_scene(&later);
    fails(folder.path(), &["run", "scene.toml"], 2, &["unknown name `twice`"]);
    let lattice = with_scene(LATTICE);
    let said = succeeds(lattice.path(), &["run", "scene.toml"]);
    assert!(said.contains("\nsquare"), "{said}");
}

const LATTICE: &str = r#"[system]
name = "spin-lattice"
parameters = { sizes = [3, 3], noise = 0.1 }
[run]
initial = [0, 0, 1]
until = 1
steps = 16
[observe]
square = "mx^2 + my^2 + mz^2 + 0*(energy - H0)"
"#;

/// Thousands of components are in no table unless they are asked for, and then the spins of a
/// lattice are one array.
#[test]
fn tables_have_the_columns_that_are_chosen() {
    let header = |text: &str| {
        let folder = with_scene(text);
        succeeds(folder.path(), &["run", "scene.toml", "--write", "csv,npz"]);
        let csv = fs::read_to_string(folder.path().join("scene-run/paths.csv")).unwrap();
        let npz = fs::read(folder.path().join("scene-run/paths.npz")).unwrap();
        (csv.lines().next().unwrap().to_owned(), String::from_utf8_lossy(&npz).into_owned())
    };
    let (csv, npz) = header(LATTICE);
    assert!(csv.starts_with("scheme,path,t,square,mx,my,mz,energy,C1,"), "{csv}");
    assert!(!npz.contains("spins"));
    let with =
        |columns: &str| LATTICE.replace("steps = 16", &format!("steps = 16\ncolumns = {columns}"));
    let (csv, npz) = header(&with("[\"components\", \"mz\"]"));
    assert!(csv.starts_with("scheme,path,t,s1x,s1y") && csv.ends_with("s9z,mz"), "{csv}");
    assert!(npz.contains("spins.npy") && npz.contains("'shape': (1, 17, 9, 3)"));
    assert!(!npz.contains("s1x.npy"));
    let (csv, npz) = header(&with("[\"s2y\", \"energy\"]"));
    assert_eq!(csv, "scheme,path,t,s2y,energy");
    assert!(npz.contains("s2y.npy"));
    let (csv, _) = header(&with("[\"laws\"]"));
    assert!(
        csv.starts_with("scheme,path,t,C1,C1 defect,C2") && csv.ends_with("C9 defect"),
        "{csv}"
    );
    let folder = with_scene(&with("[\"mq\"]"));
    fails(folder.path(), &["run", "scene.toml"], 2, &["line", "no column `mq`; the nearest is"]);
}

/// P(q(t) < −½) of the Kubo oscillator without damping: q = cos(t + W(t)/2).
#[test]
fn probabilities_have_intervals_that_cover() {
    let scene = r#"[system]
state = ["q", "p"]
B = [["1"]]
H0 = "(q^2 + p^2)/2"
H = ["0.5*(q^2 + p^2)/2"]
[run]
initial = [1, 0]
until = 2
steps = 64
paths = 2000
[probabilities]
left = "q < -0.5"
never = "q > 2"
"#;
    let folder = with_scene(scene);
    let path = folder.path();
    // The angle is normal with mean 2 and variance ½; in (2π/3, 4π/3) the cosine is below −½.
    let below = |x: f64| 0.5 * erfc(-(x - 2.0));
    let third = std::f64::consts::TAU / 3.0;
    let truth = below(2.0 * third) - below(third);
    let mut missed = 0;
    for seed in 1..=20 {
        let run = json(path, &["run", "scene.toml", "--seed", &seed.to_string(), "--json"]);
        let interval = |name: &str| {
            let interval = run["at_end"][name]["mean_interval"].clone();
            serde_json::from_value::<[f64; 2]>(interval).unwrap()
        };
        let ([lo, hi], [none, few]) = (interval("left"), interval("never"));
        missed += usize::from(!(lo..=hi).contains(&truth));
        assert!(none == 0.0 && few > 1.5e-3 && few < 3e-3);
    }
    // More than five of twenty have a probability of 3·10⁻⁴ (binomial, 5 %).
    assert!(missed <= 5, "{missed}");
    for (wrong, words) in [("q", "a condition"), ("q <", "missing"), ("zz > 1", "unknown name")] {
        let folder = with_scene(&scene.replace("q < -0.5", wrong));
        fails(folder.path(), &["run", "scene.toml"], 2, &["line", words]);
    }
}

/// By the series of erf.
fn erfc(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for n in 1..200 {
        term *= -x * x / f64::from(n);
        sum += term / f64::from(2 * n + 1);
    }
    1.0 - sum * 2.0 / std::f64::consts::PI.sqrt()
}
