//! Scenes whose means and deviations are known without this project (`tests/truths`), by default
//! settings: is what `run` states true?
//!
//! An answer is a mean or a deviation at T. It is *wrong* if the truth lies outside its 95 %
//! interval, widened by a step error that was seen. Deviations have no interval of their own:
//! theirs is 1.96·½s√((κ − 1)/paths) with the known deviation s and kurtosis κ. It is *grossly
//! wrong* if the truth is six standard errors outside, and outside of the bound that is stated
//! where no step error was seen, too. "Cannot tell" and "too few values for an interval" are no
//! answers, and few of them are allowed.

use serde::Deserialize;
use serde_json::Value;

use crate::common::{run, with_scene};

#[derive(Deserialize)]
struct File {
    problem: Vec<Problem>,
}

#[derive(Deserialize)]
struct Problem {
    name: String,
    scene: String,
    /// Its number among them.
    #[serde(skip)]
    number: usize,
    /// Mean, deviation, standard errors of both, kurtosis.
    truth: toml::Table,
}

fn problems() -> Vec<Problem> {
    let mut file: File = toml::from_str(include_str!("../../truths/truths.toml")).expect("truths");
    file.problem.iter_mut().enumerate().for_each(|(n, problem)| problem.number = n);
    assert!(file.problem.len() >= 20);
    file.problem
}

/// One answer, in the units of the observable.
#[derive(Debug)]
struct Answer {
    what: String,
    stated: f64,
    truth: f64,
    /// By how much the truth lies outside the 95 % interval of sampling.
    outside: f64,
    half_width: f64,
    /// Error of the truth and of round-off.
    tolerance: f64,
    /// About this; zero if none was seen.
    step_error: f64,
    /// Below this, if none was seen; else zero.
    step_bound: f64,
}

impl Answer {
    fn wrong(&self) -> bool {
        self.is_beyond(0.0)
    }

    /// Six standard errors beyond all that is stated: no accident of sampling.
    fn grossly_wrong(&self) -> bool {
        self.is_beyond(self.step_bound + 2.0 * self.half_width)
    }

    fn is_beyond(&self, more: f64) -> bool {
        self.stated.is_nan() || self.outside > self.tolerance + self.step_error + more
    }
}

/// What the scenes stated.
#[derive(Default)]
struct Judged {
    answers: Vec<Answer>,
    /// Means and deviations that are no answer.
    refused: Vec<String>,
}

impl Judged {
    fn ask(&mut self, problem: &Problem, seed: usize, arguments: &[&str]) {
        let folder = with_scene(&problem.scene);
        // Scenes with the same seed would share their increments, and with them their misses.
        let seed = (1000 * seed + problem.number).to_string();
        let all = [&["run", "scene.toml", "--json", "--seed", &seed], arguments].concat();
        let output = run(folder.path(), &all);
        if !output.status.success() {
            // Honest, but no answer.
            let message = String::from_utf8_lossy(&output.stderr);
            println!("{}: {message}", problem.name);
            let two = problem.truth.keys().flat_map(|name| [name, name]);
            self.refused.extend(two.map(|name| format!("{}, {name}: {message}", problem.name)));
            return;
        }
        let json: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        for (name, truth) in &problem.truth {
            let numbers: Vec<f64> = truth.clone().try_into().expect("five numbers");
            let [mean, deviation, mean_error, deviation_error, kurtosis] = numbers[..] else {
                panic!("{name}: five numbers")
            };
            let point = &json["at_end"][name];
            let count = point["count"].as_f64().expect("a count");
            let width = 1.96 * 0.5 * deviation * ((kurtosis - 1.0) / count).max(0.0).sqrt();
            let stated = |key: &str| point[key].as_f64().unwrap_or(f64::NAN);
            let interval = point["mean_interval"]
                .as_array()
                .map(|interval| [0, 1].map(|k: usize| interval[k].as_f64().unwrap_or(f64::NAN)));
            // Of a constant, such as a Casimir, the mean itself is the answer.
            let constant = deviation <= 1e-9 * mean.abs();
            let interval = interval.or(constant.then_some([stated("mean"); 2]));
            let of_deviation = Some([stated("deviation") - width, stated("deviation") + width]);
            for (key, truth, error, interval) in [
                ("mean", mean, mean_error, interval),
                ("deviation", deviation, deviation_error, of_deviation),
            ] {
                let what = format!("{}, {key} of {name}", problem.name);
                let step = &point["step_error"][key];
                let size_if = |decided: &str| match step["decided"] == decided {
                    true => step["size"].as_f64().unwrap_or(0.0),
                    false => 0.0,
                };
                let (Some([lo, hi]), false) = (interval, step["decided"] == "cannot-tell") else {
                    self.refused.push(what);
                    continue;
                };
                self.answers.push(Answer {
                    what,
                    stated: stated(key),
                    truth,
                    outside: f64::max(lo - truth, truth - hi),
                    half_width: (hi - lo) / 2.0,
                    tolerance: 1.96 * error + 1e-9 * f64::max(mean.abs(), deviation),
                    step_error: size_if("about"),
                    step_bound: f64::max(size_if("below"), size_if("fine")),
                });
            }
        }
    }

    /// The most wrong answers that right intervals have but once in a thousand times: binomial
    /// with 5 %, with twice the variance, since answers of one scene depend on each other.
    fn budget(&self) -> f64 {
        let expected = 0.05 * self.answers.len() as f64;
        expected + 3.1 * (2.0 * 0.95 * expected).sqrt()
    }

    fn wrong(&self) -> usize {
        self.answers.iter().filter(|answer| answer.wrong()).count()
    }

    #[track_caller]
    fn hold(&self) {
        let Judged { answers, refused } = self;
        let (wrong, budget) = (self.wrong(), self.budget());
        println!("{wrong} of {} wrong, budget {budget:.0}: {refused:#?}", answers.len());
        let which = |judge: fn(&Answer) -> bool| -> Vec<&Answer> {
            answers.iter().filter(|answer| judge(answer)).collect()
        };
        assert!(wrong as f64 <= budget, "{wrong}: {:#?}", which(Answer::wrong));
        assert!(!answers.iter().any(Answer::grossly_wrong), "{:#?}", which(Answer::grossly_wrong));
        assert!(10 * refused.len() <= answers.len() + refused.len(), "{refused:#?}");
    }

    /// Without step errors far too many answers are wrong, and some are grossly wrong.
    #[track_caller]
    fn are_refuted(mut self) {
        self.answers.iter_mut().for_each(|answer| answer.step_error = 0.0);
        assert!(self.wrong() as f64 > 2.0 * self.budget(), "{} wrong", self.wrong());
        self.answers.iter_mut().for_each(|answer| answer.step_bound = 0.0);
        assert!(self.answers.iter().any(Answer::grossly_wrong));
    }
}

/// Three scenes, with the wrong method: seconds.
#[test]
fn default_answers_are_true_on_three_scenes() {
    let names = [
        "Kubo oscillator",
        "spin, noise in three directions",
        "oscillator with a fluctuating spring",
    ];
    let [mut right, mut wrong] = [(); 2].map(|()| Judged::default());
    for problem in problems().iter().filter(|problem| names.contains(&&*problem.name)) {
        right.ask(problem, 1, &[]);
        wrong.ask(problem, 1, &["--scheme", "em"]);
    }
    assert_eq!(right.answers.len() + right.refused.len(), 32);
    right.hold();
    wrong.are_refuted();
}

#[test]
#[ignore = "statistical: run by the gate"]
fn default_answers_are_true_with_five_seeds() {
    let mut judged = Judged::default();
    for problem in problems() {
        (1..=5).for_each(|seed| judged.ask(&problem, seed, &[]));
    }
    judged.hold();
}

/// The wrong method: an explicit scheme without its step errors.
#[test]
#[ignore = "statistical: run by the gate"]
fn answers_of_euler_and_maruyama_are_refuted() {
    let mut judged = Judged::default();
    for problem in problems().iter().filter(|problem| !problem.scene.contains("spin-lattice")) {
        judged.ask(problem, 1, &["--scheme", "em"]);
    }
    judged.are_refuted();
}

/// Nine of ten stated step errors are at most three times the true one, which 32 times as many
/// paths show.
#[test]
#[ignore = "statistical: run by the gate"]
fn stated_step_errors_are_not_too_large() {
    let (mut stated, mut large) = (0, Vec::new());
    for problem in problems() {
        let mut judged = Judged::default();
        judged.ask(&problem, 1, &[]);
        judged.answers.retain(|answer| answer.step_error > 0.0);
        if judged.answers.is_empty() {
            continue;
        }
        let mut many = Judged::default();
        let paths = toml::from_str::<toml::Table>(&problem.scene).expect("a scene");
        let paths = paths["run"]["paths"].as_integer().expect("paths");
        many.ask(&problem, 1, &["--paths", &(32 * paths).to_string()]);
        for answer in judged.answers {
            let Some(true_one) = many.answers.iter().find(|one| one.what == answer.what) else {
                continue;
            };
            let most = (true_one.stated - true_one.truth).abs() + true_one.half_width;
            stated += 1;
            if answer.step_error > 3.0 * most {
                large.push((answer, most));
            }
        }
    }
    println!("{stated} step errors, {} too large: {large:#?}", large.len());
    assert!(10 * large.len() <= stated, "{large:#?}");
}
