//! Scenes in parts, and what a signal leaves.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
    thread::sleep,
    time::Duration,
};

use crate::common::{BODY, casimir, fails, read_json, succeeds, with_scene};

/// Runs parts of the folder `big`.
fn parts(path: &Path, numbers: &[&str]) {
    for number in numbers {
        succeeds(path, &["part", "big", "--part", number, "--threads", "1"]);
    }
}

/// Every file that `--write` makes of a run.
const WRITTEN: [&str; 6] =
    ["study.csv", "study.json", "study.npz", "paths.csv", "paths.json", "paths.npz"];

#[cfg(unix)]
#[test]
#[ignore = "long: run by the gate"]
fn any_number_of_paths_extends_to_the_bits_of_one_run() {
    for (count, numbers) in [("3", &["127", "128", "3000"][..]), ("7", &["3001"])] {
        let folder = with_scene(BODY);
        let path = folder.path();
        let plan =
            |paths| ["plan", "scene.toml", "--paths", paths, "--parts", count, "--out", "big"];
        // A few paths are no study, and leave nothing behind.
        fails(path, &plan("1"), 2, &["at least 100"]);
        assert!(!path.join("big").exists());
        for (n, &paths) in numbers.iter().enumerate() {
            let told = match n {
                0 => succeeds(path, &plan(paths)),
                _ => succeeds(path, &["extend", "big", "--paths", paths]),
            };
            assert!(n > 0 || told.contains(" paths of 64 steps"), "{told}");
            // Not before it is merged, and not to fewer.
            fails(path, &["extend", "big", "--paths", "1e6"], 2, &["not merged yet"]);
            for number in 2..=count.parse::<u32>().unwrap() {
                // Killed twice before.
                let number = number.to_string();
                let arguments = ["part", "big", "--part", &number, "--threads", "1"];
                signalled(path, &arguments, "-KILL", 9);
                signalled(path, &arguments, "-TERM", 31);
                succeeds(path, &arguments);
            }
            if count == "7" {
                fails(path, &["merge", "big"], 1, &["--array=1"]);
            }
            // The last one by the script, as a scheduler calls it.
            let script = Command::new("bash").arg(path.join("big/job.sh")).arg("1").status();
            assert!(script.unwrap().success());
            succeeds(path, &["merge", "big", "--write", "csv,json,npz"]);
            fails(path, &["extend", "big", "--paths", "101"], 2, &["more than"]);
            let whole = ["run", "scene.toml", "--paths", paths, "--write", "csv,json,npz"];
            succeeds(path, &whole);
            for name in WRITTEN {
                let read = |folder: &str| fs::read(path.join(folder).join(name)).unwrap();
                assert!(read("big") == read("scene-run"), "{name}, {paths} in {count} parts");
            }
        }
    }
}

#[test]
fn a_folder_of_parts_may_have_any_results() {
    let folder = with_scene(BODY);
    let path = folder.path();
    let plan = ["plan", "scene.toml", "--parts", "2", "--out", "big"];
    succeeds(path, &plan);
    parts(path, &["1", "2"]);
    let merge = ["merge", "big", "--write", "csv,json,npz"];
    for arguments in [&merge[..2], &merge, &merge, &["merge", "big", "--write", "json"]] {
        succeeds(path, arguments);
    }
    assert!(fs::read_to_string(path.join("big/study.json")).unwrap().contains("series"));
    fails(path, &plan, 2, &["has parts"]);
    succeeds(path, &["extend", "big", "--paths", "300"]);
    fails(path, &["extend", "big", "--paths", "400"], 2, &["not merged yet"]);
    parts(path, &["1", "2"]);
    succeeds(path, &merge);
}

/// Sends a signal to the program after some milliseconds, as Ctrl-C does.
#[cfg(unix)]
pub fn signalled(
    path: &Path,
    arguments: &[&str],
    signal: &str,
    after: u64,
) -> (Option<i32>, String) {
    let child = casimir(path)
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    sleep(Duration::from_millis(after));
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.is_ok());
    let output = child.wait_with_output().expect("it ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into())
}

#[cfg(unix)]
#[test]
#[ignore = "long: run by the gate"]
fn what_is_complete_is_written_when_it_is_interrupted() {
    let folder = with_scene(&BODY.replace("paths = 256", "paths = 3e6"));
    let path = folder.path();
    let arguments = ["run", "scene.toml", "--write", "csv,json,npz"];
    let out = path.join("scene-run");
    let mut before = 0.0;
    for moment in 0..10u64 {
        // Moments from 50 to 600 ms, in no order.
        let (code, _) = signalled(path, &arguments, "-INT", 50 + 61 * (moment * 7 % 10));
        match code {
            // Interrupted before signals were waited for: nothing is written, or all of the last.
            None => continue,
            Some(0) => break,
            code => assert_eq!(code, Some(130)),
        }
        // Before the first path.
        if before == 0.0 && !out.join("study.json").exists() {
            continue;
        }
        let json = read_json(out.join("study.json"));
        let paths = json["record"]["paths"].as_f64().unwrap();
        let last = json["series"][0]["points"].as_array().unwrap().last().unwrap();
        assert_eq!(last["count"].as_f64(), Some(paths));
        assert!(paths >= before && paths <= 3e6, "{before} {paths}");
        let warnings = json["warnings"].to_string();
        assert!(warnings.contains("of 3000000 paths"), "{warnings}");
        let page = fs::read_to_string(out.join("index.html")).unwrap();
        assert!(page.trim_end().ends_with("</html>"));
        before = paths;
    }
    assert!(before > 0.0);
}

#[cfg(unix)]
#[test]
#[ignore = "long: run by the gate"]
fn what_has_no_whole_path_is_named() {
    // The bins of a study are still being chosen: nothing is said.
    let text = BODY.replace("= 256", "= 3e5").replace("= 64", "= 200000");
    let folder = with_scene(&text);
    let arguments = ["run", "scene.toml", "--threads", "1", "--write", "json"];
    assert_eq!(signalled(folder.path(), &arguments, "-INT", 500).0, Some(130));
    assert!(!folder.path().join("scene-run/index.html").exists());
    // Long paths end where they are interrupted, if that is after the check of the steps.
    let text = BODY.replace("paths = 256", "paths = 99").replace("= 64", "= 250000");
    let folder = with_scene(&text);
    let file = folder.path().join("scene-run/paths.json");
    // The check takes most of the time: the next moment may not leave out what follows.
    let mut moment = 300.0;
    while !file.exists() {
        let (code, _) = signalled(folder.path(), &arguments, "-INT", moment as u64);
        moment *= 1.1;
        if code == Some(0) {
            fs::remove_file(&file).unwrap();
            moment = 300.0;
        } else {
            assert_eq!(code, Some(130));
        }
    }
    assert!(read_json(file)[0]["halted"].as_str().unwrap().starts_with("stopped after t = 0."));
    // A lattice, of whose spins there is no picture yet.
    let lattice = succeeds(folder.path(), &["new", "spin-lattice"]);
    let lattice =
        lattice.replace("paths = 500", "paths = 20").replace("steps = 500", "steps = 5e5");
    fs::write(folder.path().join("lattice.toml"), lattice).unwrap();
    let (code, _) = signalled(folder.path(), &["run", "lattice.toml"], "-INT", 700);
    assert_eq!(code, Some(130));
}
