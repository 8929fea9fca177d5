//! What is written, what is said where that fails, and what signals leave.

use std::{
    fs::{self, File},
    path::Path,
    thread,
    time::{Duration, SystemTime},
};

use crate::common::{BODY, OSCILLATOR, fails, run, succeeds, with_scene};
#[cfg(unix)]
use crate::parts::signalled;

/// After `extend` parts have new paths only.
#[test]
fn nothing_is_merged_without_what_was_merged_before() {
    let folder = with_scene(BODY);
    let path = folder.path();
    let parts = || {
        for part in ["1", "2"] {
            succeeds(path, &["part", "big", "--part", part]);
        }
    };
    succeeds(path, &["plan", "scene.toml", "--parts", "2", "--out", "big"]);
    parts();
    succeeds(path, &["merge", "big"]);
    let merged = path.join("big/merged.bin");
    fs::copy(&merged, path.join("before")).unwrap();
    succeeds(path, &["extend", "big", "--paths", "600"]);
    let way_out = ["merged.bin lacks paths of study", "put it back, or delete part-*.bin"];
    // Before the parts are computed again, and after.
    fs::remove_file(&merged).unwrap();
    fails(path, &["merge", "big"], 1, &way_out);
    fs::copy(path.join("before"), &merged).unwrap();
    parts();
    fs::remove_file(&merged).unwrap();
    fails(path, &["merge", "big"], 1, &way_out);
    assert!(!merged.exists());
    // Both ways on give all paths.
    fs::copy(path.join("before"), &merged).unwrap();
    let whole = succeeds(path, &["merge", "big"]);
    assert!(whole.contains("600 paths"), "{whole}");
    for file in ["merged.bin", "part-1-of-2.bin", "part-2-of-2.bin"] {
        fs::remove_file(path.join("big").join(file)).unwrap();
    }
    parts();
    let again = succeeds(path, &["merge", "big"]);
    assert_eq!(again.lines().nth(2), whole.lines().nth(2));
}

/// Commands with arguments that are refused later, with another exit code.
const REFUSED: [(&str, &str); 5] = [
    ("order", "--scheme split"),
    ("compare", "--error -1"),
    ("expect", ""),
    ("equilibrium", ""),
    ("lyapunov", ""),
];

#[test]
fn a_folder_is_tried_before_the_work_and_nothing_is_left_of_that() {
    // No flow is known, and no stationary law.
    let scene = OSCILLATOR.replace("\"0.1\"", "\"0.1 + t\"");
    let scene = scene.replace("p^2/2 + k*q^2/2", "k*p^2*q^2").replace("s*q", "s*p^2*q");
    let folder = with_scene(&scene[..scene.find("[expect]").unwrap()]);
    let path = folder.path();
    fs::write(path.join("taken"), "").unwrap();
    let long = "o".repeat(300);
    for (command, more) in REFUSED {
        let default = format!("scene-{command}");
        for out in ["", "taken", "taken/inside", &long, "some/where"] {
            let mut arguments = vec![command, "scene.toml"];
            arguments.extend(more.split_whitespace());
            arguments.extend(["--out", out].iter().filter(|_| !out.is_empty()));
            let (file, code) = match out {
                "" => (&*default, 1),
                "some/where" => ("scene", 2),
                out => (out, 1),
            };
            if out.is_empty() {
                fs::write(path.join(file), "").unwrap();
            }
            fails(path, &arguments, code, &[file]);
        }
        fs::remove_file(path.join(default)).unwrap();
    }
    assert_eq!(fs::read_dir(path).unwrap().count(), 2);
}

/// Numbers that are printed, and the file that a folder stands in the place of.
#[test]
fn numbers_are_printed_also_where_a_file_cannot_be_written() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    for (arguments, file, number) in [
        ("run scene.toml", "index.html", "at the end"),
        ("run scene.toml --paths 200", "index.html", "95 % interval"),
        ("run scene.toml --json --write npz", "paths.npz", "\"seed\""),
        ("order scene.toml --path-steps 1e5", "order.json", "strong, y(T)"),
        ("compare scene.toml --budget 0.3", "compare.json", "an error of"),
        ("inspect scene.toml", "inspect.json", "D = 2"),
        ("expect scene.toml", "expect.json", "E[energy]"),
        ("expect scene.toml --json", "expect.json", "\"half_width\""),
        ("equilibrium scene.toml --path-steps 1e6", "equilibrium.json", "energy"),
        ("lyapunov scene.toml --path-steps 1e6", "lyapunov.json", "λ1"),
    ] {
        fs::create_dir_all(path.join("out").join(file)).unwrap();
        let mut arguments: Vec<&str> = arguments.split(' ').collect();
        arguments.extend(["--out", "out"]);
        let output = run(path, &arguments);
        let [text, error] =
            [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
        assert!(text.contains(number), "{arguments:?}: {text}");
        let named = format!("error: cannot write out/{file}: ");
        assert!(error.contains(&named), "{arguments:?}: {error}");
        fs::remove_dir_all(path.join("out")).unwrap();
    }
}

/// The other way round: files are written where numbers cannot be printed.
#[cfg(target_os = "linux")]
#[test]
fn files_are_written_where_numbers_cannot_be_printed() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    for (arguments, file) in [
        (["run", "scene.toml", "--out", "a"], "a/index.html"),
        (["inspect", "scene.toml", "--out", "b"], "b/inspect.json"),
    ] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = crate::common::casimir(path).args(arguments).stdout(full).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && error.contains("cannot print: "), "{error}");
        assert!(path.join(file).is_file(), "{file}");
    }
}

/// An observable whose name is a letter many times.
fn named(c: &str, formula: &str) -> String {
    format!("\"{}\" = \"{formula}\"\n", c.repeat(300))
}

#[test]
fn figures_of_different_observables_are_different_files() {
    let names =
        "\"q+p\" = \"q+p\"\n\"q-p\" = \"q-p\"\nQ = \"2*q\"\n\"a/b\" = \"q*p\"\n\"a-b\" = \"q\"\n";
    let names =
        [names, &named("x", "q + 1"), &named("x", "q + 2").replacen("xx", "xy", 1)].concat();
    let scene = OSCILLATOR.replace("[observe]\n", &format!("[observe]\n{names}"));
    let scene = scene
        .replace("[run]", "[figures]\nportraits = [[\"q\", \"q-p\"], [\"q-q\", \"p\"]]\n[run]");
    let scene = scene.replace("Q =", "\"q-q\" = \"q\"\nQ =");
    let files = |scene: &str| {
        let folder = with_scene(scene);
        succeeds(folder.path(), &["run", "scene.toml"]);
        let files = fs::read_dir(folder.path().join("scene-run/figures")).unwrap();
        let name = |file: fs::DirEntry| file.file_name().into_string().unwrap();
        let mut names: Vec<String> = files.map(|file| name(file.unwrap())).collect();
        names.sort();
        names
    };
    let found = files(&scene);
    let of = |what: &str| found.iter().filter(|name| name.starts_with(what)).count();
    // Eight and energy, q, p; H0 has a law.
    assert_eq!((of("time-"), of("portrait-")), (11, 2), "{found:?}");
    let small: std::collections::BTreeSet<String> =
        found.iter().map(|name| name.to_lowercase()).collect();
    assert_eq!(small.len(), found.len(), "{found:?}");
    assert!(found.iter().all(|name| name.len() < 100 && name.is_ascii()), "{found:?}");
    // Others keep their names, and no order matters.
    assert!(found.contains(&"time-energy.svg".into()) && found.contains(&"time-p.svg".into()));
    let swapped = scene
        .replace("\"q+p\" =", "\"one\" =")
        .replace("\"q-p\" = \"q-p\"", "\"q+p\" = \"q+p\"\n\"q-p\" = \"q-p\"");
    let swapped = files(&swapped.replace("\"one\" = \"q+p\"\n", ""));
    assert_eq!(swapped, found);
}

#[test]
fn what_a_killed_process_left_is_removed_and_nothing_else() {
    let folder = with_scene(OSCILLATOR);
    let path = folder.path();
    succeeds(path, &["run", "scene.toml"]);
    let out = path.join("scene-run");
    let old = SystemTime::now() - Duration::from_secs(3600);
    let left = |folder: &Path, name: &str, time: SystemTime| {
        let file = folder.join(name);
        File::create(&file).unwrap().set_modified(time).unwrap();
        file
    };
    let gone = [
        (&out, ".index.html.x1"),
        (&out, "..casimir.y2"),
        (&out.join("figures"), ".time-q.svg.z3"),
    ];
    let gone = gone.map(|(folder, name)| left(folder, &format!("{name}.casimir"), old));
    // Another process may write the one; the others are somebody's.
    let kept = [
        left(&out, ".index.html.x2.casimir", SystemTime::now()),
        left(&out, ".index.html.swp", old),
        left(&out, "notes.casimir", old),
    ];
    succeeds(path, &["run", "scene.toml"]);
    assert!(gone.iter().all(|file| !file.exists()) && kept.iter().all(|file| file.exists()));
}

#[test]
fn a_scheme_that_is_none_is_refused_by_every_command() {
    let folder = with_scene(&OSCILLATOR.replace("\"sexp-li\"", "\"sexpp\""));
    for command in ["inspect", "compare", "expect", "equilibrium", "order", "run"] {
        let words = ["line 14, column 10: no scheme `sexpp`", "the nearest is `sexp`"];
        fails(folder.path(), &[command, "scene.toml"], 2, &words);
    }
    // One that is not for the system is none of inspect's business.
    let folder = with_scene(&OSCILLATOR.replace("\"sexp-li\"", "\"split\""));
    succeeds(folder.path(), &["inspect", "scene.toml"]);
}

/// Large numbers make a root that is not finite.
#[test]
fn what_is_wrong_with_the_noise_of_a_bath_is_at_its_temperature() {
    let scene = OSCILLATOR.replace("H = [\"s*q\"]\n", "");
    let bath = "[bath]\nfriction = { p = 1e200 }\ntemperature = 1e200";
    let scene = scene.replace("[damping]\nrate = \"0.1\"", bath);
    let folder = with_scene(&scene);
    fails(folder.path(), &["run", "scene.toml"], 2, &["line 9, column 15", "temperature = 1e200"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_is_no_text_has_a_script() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt, process::Command};

    let folder = with_scene(BODY);
    for name in [&b"big\xff it's"[..], b"big\nger"] {
        let name = OsStr::from_bytes(name);
        let arguments = ["plan", "scene.toml", "--parts", "2", "--out"];
        let mut plan = crate::common::casimir(folder.path());
        assert!(plan.args(arguments).arg(name).output().unwrap().status.success());
        let out = folder.path().join(name);
        for part in ["1", "2"] {
            let script = Command::new("bash").arg(out.join("job.sh")).arg(part).output().unwrap();
            assert!(script.status.success(), "{script:?}");
        }
        let mut merge = crate::common::casimir(folder.path());
        assert!(merge.arg("merge").arg(name).output().unwrap().status.success());
    }
}

#[cfg(unix)]
#[test]
fn a_signal_ends_with_a_line_and_exit_code_130() {
    let folder = with_scene(&BODY.replace("steps = 64", "steps = 50000000"));
    let kept = "has what was measured; the same command goes on";
    let lost = "stopped: what is not printed or written yet is lost";
    for (arguments, said) in [
        (&["order", "scene.toml", "--path-steps", "1e13", "--threads", "1"][..], kept),
        (&["compare", "scene.toml", "--budget", "100", "--threads", "1"], kept),
        (&["plan", "scene.toml", "--parts", "2", "--out", "big"], lost),
    ] {
        for signal in ["-INT", "-TERM"] {
            let (code, words) = signalled(folder.path(), arguments, signal, 400);
            assert_eq!(code, Some(130), "{arguments:?}: {words}");
            assert!(words.contains(said), "{words}");
        }
    }
}

/// Work that is started by `nohup` goes on when the terminal hangs up.
#[cfg(unix)]
#[test]
fn nohup_works() {
    let folder = with_scene(&OSCILLATOR.replace("paths = 4", "paths = 4e5"));
    let program = "nohup \"$0\" run scene.toml --json --threads 1 > told & sleep 0.2; \
                   kill -HUP $!; wait $!";
    let mut shell = std::process::Command::new("bash");
    shell.args(["-c", program, env!("CARGO_BIN_EXE_casimir")]).current_dir(folder.path());
    assert!(shell.output().unwrap().status.success());
    assert!(fs::read_to_string(folder.path().join("told")).unwrap().contains("\"seconds\""));
}

#[cfg(unix)]
#[test]
fn what_is_said_of_stopped_work_is_true() {
    // All paths are at t = 0.
    let folder = with_scene(&OSCILLATOR.replace("steps = 64", "steps = 1e9\ntimes = 1"));
    let (code, words) =
        signalled(folder.path(), &["run", "scene.toml", "--threads", "1"], "-INT", 300);
    assert_eq!(code, Some(130), "{words}");
    assert!(words.contains("nothing is written") && !words.contains("complete"), "{words}");
    assert!(!folder.path().join("scene-run/index.html").exists());
    // A folder is in the place of the samples, or they cannot be written any more.
    let folder = with_scene(OSCILLATOR);
    for (command, file) in [("expect", "samples.bin"), ("equilibrium", "chains.bin")] {
        let kept = folder.path().join(format!("scene-{command}"));
        fs::create_dir_all(kept.join(file)).unwrap();
        let arguments = [command, "scene.toml", "--accuracy", "1e-7", "--threads", "1"];
        fails(folder.path(), &arguments, 1, &["cannot read", file]);
        fs::remove_dir_all(&kept).unwrap();
        // Whose figures have no folder then.
        if command == "equilibrium" {
            continue;
        }
        let (code, words) = thread::scope(|scope| {
            scope.spawn(|| {
                thread::sleep(Duration::from_millis(350));
                _ = fs::remove_dir_all(&kept);
                fs::write(&kept, "").unwrap();
            });
            signalled(folder.path(), &arguments, "-INT", 700)
        });
        assert_eq!(code, Some(130), "{words}");
        assert!(words.contains("no samples are kept: the same command begins anew"), "{words}");
        assert!(!words.contains("samples are in"), "{words}");
    }
    let folder = with_scene(OSCILLATOR);
    let arguments = ["expect", "scene.toml", "--accuracy", "1e-7", "--threads", "1"];
    let (_, words) = signalled(folder.path(), &arguments, "-INT", 700);
    let kept = folder.path().join("scene-expect/samples.bin").exists();
    assert!(kept && words.contains("the same command goes on from them"), "{words}");
}
