//! Running the program in a folder of its own.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::Value;

/// The program in this folder.
pub fn casimir(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_casimir"));
    command.current_dir(folder);
    command
}

/// Runs the program with these arguments.
pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    casimir(folder).args(arguments).output().expect("the program starts")
}

/// Runs it, and gives what it printed; it must succeed.
#[track_caller]
pub fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Runs it, and reads the JSON that it prints.
#[track_caller]
pub fn json(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(&succeeds(folder, arguments)).expect("JSON")
}

/// The JSON in a file.
#[track_caller]
pub fn read_json(file: impl AsRef<Path>) -> Value {
    serde_json::from_slice(&fs::read(file).expect("a file")).expect("JSON")
}

/// The numbers of an array in a file of NumPy, which is not compressed.
#[track_caller]
pub fn npz(file: impl AsRef<Path>, name: &str) -> Vec<f64> {
    let bytes = fs::read(file).expect("a file");
    let find = |words: &[u8], from: usize| {
        let place = bytes[from..].windows(words.len()).position(|window| window == words);
        from + place.unwrap_or_else(|| panic!("no array {name}")) + words.len()
    };
    let header = find(format!("{name}.npy").as_bytes(), 0);
    let data = find(b"\n", find(b"'shape': ", header));
    let header = String::from_utf8_lossy(&bytes[header..data]);
    let (_, shape) = header.split_once("'shape': (").expect("a shape");
    let sizes = shape.split(')').next().unwrap_or_default().split(", ");
    let count: usize = sizes.map(|n| n.trim_end_matches(',').parse::<usize>().unwrap()).product();
    let number = |chunk: &[u8]| f64::from_le_bytes(chunk.try_into().unwrap());
    bytes[data..data + 8 * count].chunks_exact(8).map(number).collect()
}

/// Runs it; it must end with this exit code and say these words.
#[track_caller]
pub fn fails(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    let output = run(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
    for words in words {
        assert!(message.contains(words), "{arguments:?}, {words}: {message}");
    }
}

/// A folder with a scene.
pub fn with_scene(text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("scene.toml"), text).expect("a scene");
    folder
}

/// A scene of formulas.
pub const OSCILLATOR: &str = r#"title = "Oscillator"
[system]
state = ["q", "p"]
parameters = { k = 1.0, s = 0.3 }
B = [["0", "1"], ["-1", "0"]]
H0 = "p^2/2 + k*q^2/2"
H = ["s*q"]
[damping]
rate = "0.1"
[run]
initial = [1.0, 0.5]
until = 2.0
steps = 64
scheme = "sexp-li"
paths = 4
[observe]
energy = "H0"
[expect]
of = ["energy", "q"]
accuracy = 0.05
"#;

/// A scene of a system of the project.
pub const BODY: &str = r#"[system]
name = "rigid-body"
parameters = { inertia = [2, 1, "2/3"], noise = [1, 2, 3] }
[damping]
rate = "0.5*cos(2*t)"
[run]
initial = ["cos(1.1)", 0, "sin(1.1)"]
until = 1.0
steps = 64
scheme = "sexp-li"
paths = 256
"#;

/// Spins.
pub const SPINS: &str = r#"[system]
name = "spin-lattice"
parameters = { sizes = [4, 4], periodic = true, transverse = 0.1, noise = 0.3 }
[run]
initial = [0, 0, 1]
until = 1.0
steps = 64
"#;

/// A scene with friction in the place of a bath that has nothing else.
pub fn without_bath(scene: &str) -> String {
    let lines = scene.lines().filter(|line| !line.starts_with("temperature = "));
    let scene = lines.collect::<Vec<_>>().join("\n") + "\n";
    scene.replace("[bath]\nfriction = ", "[damping]\nrates = ")
}
