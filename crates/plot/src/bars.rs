//! Progress on the terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Does work of about so many path-steps, zero if that is not known, under a bar; without one where
/// the output is no terminal. The work says how many are done, from any thread.
pub fn under_bar<R>(
    what: &str,
    path_steps: u64,
    work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> R,
) -> R {
    let bar = bar(what, path_steps);
    let result = work(&|done| bar.inc(done));
    bar.finish_and_clear();
    result
}

/// Does work that says now and then how far it is, in the place of `what`.
pub fn under_words<R>(what: &str, work: impl FnOnce(&dyn Fn(String)) -> R) -> R {
    let bar = bar(what, 0);
    let result = work(&|words| bar.set_message(words));
    bar.finish_and_clear();
    result
}

fn bar(what: &str, path_steps: u64) -> ProgressBar {
    let template = match path_steps {
        0 => "{elapsed:>4} {spinner} {msg}",
        _ => "{elapsed:>4} [{bar:28}] {percent:>3}% {msg}, {eta} left",
    };
    let style = ProgressStyle::with_template(template).expect("the template is valid");
    let bar = ProgressBar::new(path_steps).with_style(style.progress_chars("=> "));
    let bar = bar.with_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
