//! Broken scenes: exit code 2, a place, a way out, and nothing written.

use std::fs;

use crate::common::{BODY, OSCILLATOR, SPINS, fails, run, with_scene};

/// A scene, what is replaced in it by what, the place of the error, and words of the message.
type Broken = (&'static str, &'static str, &'static str, &'static str, &'static str);

#[rustfmt::skip]
const BROKEN: &[Broken] = &[
    // Keys and types.
    (OSCILLATOR, "steps = 64", "stepz = 64", "line 13, column 1", "the nearest is `steps`"),
    (OSCILLATOR, "[damping]", "[dumping]", "line 8, column 2", "the nearest is `damping`"),
    (OSCILLATOR, "[observe]", "[fit]\nof = []\n[observe]", "line 17, column 1", "expected `parameters`"),
    (OSCILLATOR, "accuracy =", "precision =", "line 20, column 1", "expected one of `of`, `accuracy`, `gradient`"),
    (OSCILLATOR, "steps = 64\n", "", "line 10, column 1", "missing key `steps`"),
    (OSCILLATOR, "steps = 64", "steps = 0", "line 13, column 9", "at least 1"),
    (OSCILLATOR, "steps = 64", "steps = 6.5", "line 13, column 9", "a whole number"),
    (OSCILLATOR, "steps = 64", "steps = \"many\"", "line 13, column 9", "a whole number"),
    (OSCILLATOR, "paths = 4", "paths = 1e30", "line 15, column 9", "a whole number"),
    (OSCILLATOR, "title = \"Oscillator\"", "title = 3", "line 1, column 9", "string"),
    (OSCILLATOR, "until = 2.0", "until = true", "line 12, column 9", "a number or a formula"),
    (OSCILLATOR, "until = 2.0", "until = ", "line 12, column 9", ""),
    (OSCILLATOR, "\"q\", \"p\"]", "\"q\", \"p\"", "line 4", ""),
    (OSCILLATOR, "steps = 64", "steps = 64\nsteps = 65", "line 14, column 1", "duplicate"),
    (OSCILLATOR, "H = [", "drift = [\"p\", \"-q\"]\nnoise = [\"0\", \"s\"]\nH = [", "line 8, column 10",
        "for each noise, row or pair: write [[\"0\", \"s\"]]"),
    (OSCILLATOR, "H = [", "drift = \"p\"\nnoise = \"0.3\"\nH = [", "line 8, column 9", "write [[\"0.3\"]]"),
    (OSCILLATOR, "paths = 4", "columns = \"q\"", "line 15, column 11", "where a list is wanted: write [\"q\"]"),
    (OSCILLATOR, "rate = \"0.1\"", "rates = 0.5", "line 9, column 9", "got 0.5, where values have names: write { p = 0.5 }"),
    (OSCILLATOR, "[run]", "[bath]\ntemperature = 1\nfriction = 0.5\n[run]", "line 12, column 12", "write { p = 0.5 }"),
    // Values.
    (OSCILLATOR, "s = 0.3", "s = \"k/2\"", "line 4, column 30", "a parameter cannot use another one: write the value"),
    (OSCILLATOR, "[1.0, 0.5]", "[\"N(0,1)\", 0]", "line 11, column 13", "z1, z2, … are standard normals"),
    (OSCILLATOR, "[\"energy\", \"q\"]", "[\"E[q]\"]", "line 19, column 8", "write what it is of, x for E[x]"),
    (OSCILLATOR, "[\"energy\", \"q\"]", "[\"E(q)\"]", "line 19, column 8", "write what it is of, x for E[x]"),
    (OSCILLATOR, "[\"energy\", \"q\"]", "[\"var[q]\"]", "line 19, column 8", "`var` is no vector"),
    (OSCILLATOR, "[observe]", "[sweep]\nk = \"1..3\"\n[observe]", "line 17, column 5", "a range is 1:3:N"),
    (OSCILLATOR, "until = 2.0", "until = -2.0", "line 12, column 9", "must be positive, got -2"),
    (OSCILLATOR, "until = 2.0", "until = inf", "line 12, column 9", "a number must be finite, got inf"),
    (OSCILLATOR, "until = 2.0", "until = \"ln(0)\"", "line 12, column 10", "not a finite number"),
    (OSCILLATOR, "[1.0, 0.5]", "[nan, 0.5]", "line 11, column 11", "a number must be finite, got NaN"),
    (OSCILLATOR, "[1.0, 0.5]", "[1.0]", "line 11, column 11", "must have 2 components, got 1"),
    (OSCILLATOR, "[1.0, 0.5]", "[1.0, \"x\"]", "line 11, column 18", "unknown name `x`"),
    (OSCILLATOR, "accuracy = 0.05", "accuracy = 0", "line 20, column 12", "must be positive"),
    (OSCILLATOR, "paths = 4", "times = 7", "line 15, column 9", "do not divide 64 steps: take 4"),
    (OSCILLATOR, "\"sexp-li\"", "\"sexp-lo\"", "line 14, column 10", "the nearest is `sexp-li`"),
    // Formulas.
    (OSCILLATOR, "k*q^2/2", "k*q^2/2)", "line 6, column 22", "was not opened"),
    (OSCILLATOR, "p^2/2 +", "(p^2/2 +", "line 6, column 7", "not closed"),
    (OSCILLATOR, "k*q^2/2", "k*q^2/", "line 6, column 21", "is missing at the end"),
    (OSCILLATOR, "k*q^2/2", "2q", "line 6, column 16", "write 2*q"),
    (OSCILLATOR, "k*q^2/2", "sinn(q)", "line 6, column 15", "the nearest is `sin`"),
    (OSCILLATOR, "k*q^2/2", "Sin(q)", "line 6, column 15", "the nearest is `sin`"),
    (OSCILLATOR, "[observe]", "[events]\nc = \"q = 1.5\"\n[observe]", "line 17, column 8", "write `< or >`"),
    (OSCILLATOR, "k*q^2/2", "log(q)", "line 6, column 15", "unknown function `log`"),
    (OSCILLATOR, "k*q^2/2", "ln(q - 2)", "line 6, column 15", "NaN for -1"),
    (OSCILLATOR, "k*q^2/2", "sqrt(q - 1)", "line 6, column 6", "derivative of H0 by q"),
    (OSCILLATOR, "s*q", "s*q**2", "line 7, column 11", "write ^"),
    (OSCILLATOR, "\"0.1\"", "\"0.1*q\"", "line 9, column 13", "depends on t and parameters alone"),
    (OSCILLATOR, "\"0.1\"", "\"1/t\"", "line 9, column 9", "at t = 0"),
    (OSCILLATOR, "energy = \"H0\"", "e = \"H1\"", "line 17, column 6", "unknown name `H1`"),
    (OSCILLATOR, "energy = \"H0\"", "q = \"H0\"", "line 17, column 1", "a column of the tables"),
    (OSCILLATOR, "of = [\"energy\"", "of = [\"enrgy\"", "line 19, column 8", "unknown name"),
    (OSCILLATOR, "[\"energy\", \"q\"]", "[]", "line 19, column 6", "at least one function"),
    (OSCILLATOR, "[\"energy\", \"q\"]", "[\"q\", \"q\"]", "line 19, column 12", "listed twice"),
    (OSCILLATOR, "energy = \"H0\"", "C1 = \"q\"", "line 17, column 1", "choose another name"),
    (OSCILLATOR, "energy = \"H0\"", "path = \"q\"", "line 17, column 1", "`path` is a column"),
    (OSCILLATOR, "energy = \"H0\"", "\"H0 defect\" = \"q\"", "line 17, column 1", "defect` is a column"),
    (OSCILLATOR, "[\"q\", \"p\"]\nparam", "[\"q\", \"path\"]\nparam", "line 3, column 15", "`path` is"),
    (OSCILLATOR, "[\"q\", \"p\"]\nparam", "[\"scheme\", \"p\"]\nparam", "line 3, column 10",
        "`scheme` is a column of the tables already"),
    (OSCILLATOR, "\"-1\"", "\"-t\"", "line 5, column 21", "time is known in H0, H"),
    (OSCILLATOR, "s*q", "if(q > 0, q, 0)", "line 7, column 10", "a condition is not smooth"),
    // The structure matrix and the names.
    (OSCILLATOR, "k = 1.0", "t = 1.0", "line 4, column 16", "`t` is the time"),
    (OSCILLATOR, "\"-1\"", "\"1\"", "line 5, column 12", "B is not skew"),
    (OSCILLATOR, "[\"0\", \"1\"]", "[\"0\"]", "line 5, column 5", "must have 2 rows"),
    (OSCILLATOR, "B = [[\"0\", \"1\"], [\"-1\", \"0\"]]\n", "", "", "[system] needs `B`"),
    (OSCILLATOR, "[\"q\", \"p\"]\nparam", "[\"q\", \"q\"]\nparam", "line 3, column 15", "given twice"),
    (OSCILLATOR, "[\"q\", \"p\"]\nparam", "[\"q\", \"2p\"]\nparam", "line 3, column 15", "is no name"),
    (OSCILLATOR, "k = 1.0", "k = [1, 2]", "line 4, column 20", "is one number"),
    (OSCILLATOR, "k = 1.0", "sin = 1.0", "line 4, column 16", "choose another"),
    // What is observed, drawn and computed of it.
    (OSCILLATOR, "[observe]", "[statistics]\npairs = [[\"q\", \"r\"]]\n[observe]", "line 17, column 16",
        "no column `r`; the nearest is `p`"),
    (OSCILLATOR, "[observe]", "[statistics]\npairs = [[\"q\"]]\n[observe]", "line 17, column 10", "length 1"),
    (OSCILLATOR, "[observe]", "[statistics]\npears = []\n[observe]", "line 17, column 1", "expected one of `pairs`"),
    (OSCILLATOR, "[observe]", "[statistics]\nautocorrelation = [\"enregy\"]\n[observe]",
        "line 17, column 20", "the nearest is `energy`"),
    (OSCILLATOR, "[observe]", "[statistics]\nfrom = 2\n[observe]", "line 17, column 8", "from 0 to 2, got 2"),
    (OSCILLATOR, "[observe]", "[figures]\nportraits = [[\"q\", \"x\"]]\n[observe]", "line 17, column 20",
        "no column `x`"),
    (OSCILLATOR, "[observe]", "[figures]\nshow = [\"Energy\"]\n[observe]", "line 17, column 9",
        "the nearest is `energy`"),
    (OSCILLATOR, "[observe]", "[figures]\nlog = [\"kk\"]\n[observe]", "line 17, column 8", "nearest is `k`"),
    (OSCILLATOR, "[observe]", "[probabilities]\nfar = \"q\"\n[observe]", "line 17, column 7", "a condition, such as"),
    (OSCILLATOR, "[observe]", "[probabilities]\nfar = \"q > \"\n[observe]", "line 17, column 12", "is missing at the end"),
    (OSCILLATOR, "[observe]", "[probabilities]\nfar = \"q = 1\"\n[observe]", "line 17, column 10", "="),
    (OSCILLATOR, "[observe]", "[probabilities]\nenergy = \"q > 1\"\n[observe]", "line 17, column 1", "already"),
    (OSCILLATOR, "[observe]", "[events]\nfar = { when = \"q > 1\", stops = true }\n[observe]",
        "line 17", "unknown key `stops`"),
    (OSCILLATOR, "[observe]", "[events]\nfar = \"q > far\"\n[observe]", "line 17, column 12", "unknown name `far`"),
    (OSCILLATOR, "[observe]", "[observe]\nmean = \"average(q\"", "line 17, column 9", "observable of its own"),
    (OSCILLATOR, "[observe]", "[observe]\nmean = \"2*average(q)\"", "line 17, column 11", "observable of its own"),
    (OSCILLATOR, "paths = 4", "columns = [\"components\", \"H1\", \"r\"]", "line 15, column 32", "no column `r`"),
    (OSCILLATOR, "[observe]", "[sweep]\nkk = [1, 2]\n[observe]", "line 17, column 6", "the nearest is `k`"),
    (OSCILLATOR, "[observe]", "[sweep]\nk = \"1:2\"\n[observe]", "line 17, column 5", "from:to:number"),
    (OSCILLATOR, "[observe]", "[sweep]\nk = [1, \"x\"]\n[observe]", "line 17, column 5", "unknown name `x`"),
    (OSCILLATOR, "[1.0, 0.5]", "[\"z1\", \"w1\"]", "line 11, column 19", "unknown name `w1`"),
    (OSCILLATOR, "[1.0, 0.5]", "\"states.txt\"", "line 11, column 11", "cannot read the states states.txt"),
    (OSCILLATOR, "[1.0, 0.5]", "[\"z1\", \"1/(z2 - z2)\"]", "line 11, column 21", "division by zero"),
    // Systems of the project.
    (BODY, "noise = [1, 2, 3]", "noise = [1, 0, 3]", "line 3, column 49",
        "`noise` must be positive and finite, got 0"),
    (BODY, "rigid-body", "rigid-bodi", "line 2, column 8", "the nearest is `rigid-body`"),
    (BODY, "[2, 1, \"2/3\"]", "[2, 1]", "line 3, column 26", "has three numbers, got 2"),
    (BODY, "noise = [1", "noises = [1", "line 3, column 41", "there are inertia, noise"),
    (BODY, "\nparameters", "\nH0 = \"1\"\nparameters", "line 3, column 6", "is for formulas"),
    (BODY, "noise = [1, 2, 3]", "noise = [1, 2]", "line 3, column 49", "one or three numbers"),
    (BODY, "\"sexp-li\"", "\"split-levy\"", "line 10, column 10", "there are auto, sexp"),
    (BODY, "1.0\nsteps = 64\nscheme = \"sexp-li\"", "64.0\nsteps = 64\ntruncation = 4\nscheme = \"sexp\"",
        "line 9, column 9", "Take at least 65 steps"),
    (SPINS, "[4, 4]", "[4, 0]", "line 3, column 24", "at least 1"),
    (SPINS, "[run]", "[bath]\ntemperature = 1\ntransverse = { s = 1 }\n[run]", "line 3, column 62", "leave this out"),
    (SPINS, "[run]", "[bath]\ntemperature = \"0.5+0.5*t\"\ntransverse = { s = 1 }\n[run]", "line 5, column 24",
        "are constant: write them without t"),
    (SPINS, "periodic = true", "periodic = 1", "line 3, column 43", "true or false"),
    (SPINS, "initial = [0, 0, 1]", "initial = [0, 1]", "line 5, column 11", "48 components, got 2"),
    (SPINS, "[4, 4], periodic = true", "[3, 3], periodic = true", "", "even size"),
];

#[test]
fn broken_scenes_have_a_place_and_a_way_out() {
    assert!(BROKEN.len() >= 50);
    let mut wrong = Vec::new();
    for (number, (base, what, by, place, words)) in BROKEN.iter().enumerate() {
        assert!(base.contains(what), "case {number}: {what}");
        let mut text = base.replacen(what, by, 1);
        if words.contains("even size") {
            text += "scheme = \"split\"\n";
            text = text.replace("transverse = 0.1, ", "");
        }
        let folder = with_scene(&text);
        let output = run(folder.path(), &["run", "scene.toml"]);
        let message = String::from_utf8_lossy(&output.stderr);
        let files = fs::read_dir(folder.path()).unwrap().count();
        if output.status.code() != Some(2)
            || !message.starts_with("error: scene.toml")
            || !message.contains(place)
            || !message.contains(words)
            || files != 1
        {
            let code = output.status.code();
            wrong.push(format!("{what} -> {by}: {place}: {words}\n{code:?}, {files}: {message}"));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), BROKEN.len(), wrong.join("\n"));
}

#[test]
fn what_is_no_scene_or_argument_is_refused() {
    let folder = with_scene("");
    fails(folder.path(), &["run", "scene.toml"], 2, &["missing key `system`"]);
    let folder = with_scene(OSCILLATOR);
    for (arguments, words) in [
        ("run nowhere.toml", "cannot read the scene nowhere.toml"),
        ("run", "<SCENE>"),
        ("rum scene.toml", "'run'"),
        ("new nothing", "there are empty"),
        ("run scene.toml --paths few", "not a whole number"),
        ("run scene.toml --set k=1..3", "1..3 is no number: a range is 1:3:N"),
        ("expect scene.toml --gradient q", "make its initial value one, initial = [\"q0\"]"),
        ("merge .", "does not say what its parts are"),
        ("compare scene.toml --error -1", "must be positive and finite, got -1"),
        ("compare scene.toml --budget nan", "must be positive and finite"),
        ("order scene.toml --path-steps 0", "at least 1"),
    ] {
        fails(folder.path(), &arguments.split(' ').collect::<Vec<_>>(), 2, &[words]);
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn what_cannot_be_written_is_a_failure_and_gigabytes_are_not_by_mistake() {
    let folder = with_scene(OSCILLATOR);
    fs::write(folder.path().join("taken"), "").unwrap();
    for out in ["taken", "taken/inside", "/proc/here"] {
        fails(folder.path(), &["run", "scene.toml", "--out", out], 1, &[out]);
    }
    let folder = with_scene(&OSCILLATOR.replace("paths = 4", "paths = 1e8\ntables = 1e7"));
    fails(folder.path(), &["run", "scene.toml", "--write", "csv"], 2, &["GB", "--large"]);
}
