//! Vectors, sums and blocks of B.

use std::fs;

use crate::common::{fails, succeeds, with_scene};

const SHORT: &str = r#"[system]
state = ["s[1..3][xyz]"]
parameters = { J = 0.7 }
B = "spins"
H0 = "-J*sum(i in 1..2, dot(s[i], s[i+1])) - norm(cross(s1, s2 + 2*s3))/3"
H = ["0.2*s1z", "0.1*(s1x + s2x + s3x)"]
[run]
initial = [0, 0, 1, 1, 0, 0, 0, "3/5", "4/5"]
until = 1
steps = 32
scheme = "sexp-li"
[observe]
m2 = "dot(s1 + s2 + s3, s1 + s2 + s3)"
"#;

/// The same, written out.
fn long() -> String {
    let names: Vec<String> =
        (1..=3).flat_map(|k| ["x", "y", "z"].map(|c| format!("s{k}{c}"))).collect();
    let mut rows = Vec::new();
    for i in 0..9 {
        let entry = |j: usize| {
            let (a, b) = (i % 3, j % 3);
            let third = &names[3 * (i / 3) + (6 - a - b) % 3];
            match (i / 3 == j / 3 && a != b, (3 + b - a) % 3 == 1) {
                (false, _) => "\"0\"".to_owned(),
                (true, true) => format!("\"-{third}\""),
                (true, false) => format!("\"{third}\""),
            }
        };
        rows.push(format!("[{}]", (0..9).map(entry).collect::<Vec<_>>().join(", ")));
    }
    let dot = |a: &str, b: &str| format!("({a}x*{b}x + {a}y*{b}y + {a}z*{b}z)");
    let b = |c: &str| format!("(s2{c} + 2*s3{c})");
    let cross = |i: &str, j: &str| format!("(s1{i}*{} - s1{j}*{})^2", b(j), b(i));
    let energy = format!(
        "-J*({} + {}) - sqrt({} + {} + {})/3",
        dot("s1", "s2"),
        dot("s2", "s3"),
        cross("y", "z"),
        cross("z", "x"),
        cross("x", "y")
    );
    let sum = |c: &str| format!("(s1{c} + s2{c} + s3{c})");
    let start = SHORT.find("[run]").unwrap();
    let rest = SHORT[start..].split("m2").next().unwrap();
    format!(
        "[system]\nstate = {names:?}\nparameters = {{ J = 0.7 }}\nB = [{}]\nH0 = \"{energy}\"\n\
         H = [\"0.2*s1z\", \"0.1*{}\"]\n{rest}m2 = \"{}^2 + {}^2 + {}^2\"\n",
        rows.join(", "),
        sum("x"),
        sum("x"),
        sum("y"),
        sum("z")
    )
}

#[test]
fn short_forms_are_what_they_stand_for() {
    let tables: Vec<String> = [SHORT.to_owned(), long()]
        .iter()
        .map(|scene| {
            let folder = with_scene(scene);
            succeeds(folder.path(), &["run", "scene.toml", "--write", "csv"]);
            fs::read_to_string(folder.path().join("scene-run/paths.csv")).unwrap()
        })
        .collect();
    let rows = |table: &str| -> Vec<Vec<f64>> {
        let row = |line: &str| line.split(',').skip(2).map(|x| x.parse().unwrap_or(0.0)).collect();
        table.lines().skip(1).map(row).collect()
    };
    let (short, long) = (rows(&tables[0]), rows(&tables[1]));
    assert!(short.len() > 30 && short.len() == long.len());
    for (a, b) in short.iter().flatten().zip(long.iter().flatten()) {
        assert!((a - b).abs() < 1e-12 * (1.0 + a.abs()), "{a} {b}");
    }
}

#[test]
fn blocks_are_written_out() {
    let scene = r#"[system]
state = ["q[1..2]", "p[1..2]", "M[xyz]", "x", "y"]
B = "canonical(q, p) + rigid(M) + 1/4*canonical(x, y)"
H0 = "dot(p, p)/2 + dot(q, q)/2 + dot(M, M)/2 + Mz + x^2 + y^2"
[run]
initial = [1, 0, 0, 1, 0, 1, 0, 1, 1]
until = 1
steps = 10
"#;
    // Blocks are of these components, whichever stands first among all.
    let other = scene.replace(r#""q[1..2]", "p[1..2]""#, r#""p[1..2]", "q[1..2]""#);
    for scene in [scene, &other] {
        let folder = with_scene(scene);
        let text = succeeds(folder.path(), &["inspect", "scene.toml"]);
        for line in ["q1 = p1", "p2 = -q2", "x = "] {
            assert!(text.contains(line), "{line}: {text}");
        }
    }
}

#[test]
fn wrong_short_forms_are_named() {
    let with = |from: &str, to: &str| {
        assert!(SHORT.contains(from), "{from}");
        SHORT.replace(from, to)
    };
    for (scene, words) in [
        (with("s[1..3][xyz]", "s[1..3"), "is neither a name, or vectors"),
        (with("s[1..3][xyz]", "s[3..1][xyz]"), "is neither a name"),
        (with("\"spins\"", "\"spin(s1)\""), "the nearest is `spins`"),
        (with("\"spins\"", "\"spins(s4)\""), "`s4` is no part of the state"),
        (with("\"spins\"", "\"canonical(s1, s2x)\""), "as many momenta as positions"),
        (with("\"spins\"", "\"spins(s1x)\""), "vectors of three components"),
        (with("dot(s[i], s[i+1])", "dot(s[i], s[i+2])"), "unknown name `s4`"),
        (with("dot(s[i], s[i+1])", "s[i]*s[i+1]"), "a product of vectors is dot"),
        (with("dot(s[i], s[i+1])", "s[i]"), "a vector of 3 - a number has no meaning"),
        (with("i in 1..2", "i in 2..1"), "has no term"),
        (with("i in 1..2", "J in 1..2"), "`J` has a meaning already"),
        (with("i in 1..2,", "i = 1..2,"), "a sum is written"),
        (with("s2 + 2*s3", "s2 + 2"), "a vector of 3 + a number has no meaning"),
        (with("0.2*s1z", "0.2*s1[4]"), "`s1` has components 1 to 3, got 4"),
    ] {
        let folder = with_scene(&scene);
        fails(folder.path(), &["run", "scene.toml"], 2, &[words]);
        assert!(!folder.path().join("scene-run").exists());
    }
}
