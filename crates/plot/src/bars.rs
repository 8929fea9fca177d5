//! Progress on the terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Is told how far a run is. Work is counted in path-steps.
pub trait Progress: Sync {
    /// A piece of work begins; it will do about `work` path-steps.
    fn begin(&self, id: &str, work: u64);
    /// Some of it is done; called from any thread.
    fn advance(&self, work: u64);
    /// It has ended.
    fn end(&self);
}

/// Tells nobody.
impl Progress for () {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn end(&self) {}
}

/// A bar for what is running; nothing where the output is no terminal.
pub struct Bars {
    bar: ProgressBar,
}

/// Of work whose amount is known, and of other work.
const KNOWN: &str = "{elapsed:>4} [{bar:28}] {percent:>3}% {msg}, {eta} left";
const UNKNOWN: &str = "{elapsed:>4} {spinner} {msg}";

fn style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template).expect("the template is valid");
    style.progress_chars("=> ")
}

impl Default for Bars {
    /// No bar yet.
    fn default() -> Self {
        let bar = ProgressBar::new(0).with_style(style(KNOWN));
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }
}

impl Bars {
    /// Prints a line above the bar, also where there is no bar.
    pub fn println(&self, line: &str) {
        self.bar.suspend(|| println!("{line}"));
    }

    /// Prints a line on the standard error, also where there is no bar.
    pub fn note(&self, line: &str) {
        self.bar.suspend(|| eprintln!("{line}"));
    }

    /// Takes the bar off the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bars {
    /// Without work its amount is not known.
    fn begin(&self, id: &str, work: u64) {
        self.bar.set_style(style(if work > 0 { KNOWN } else { UNKNOWN }));
        self.bar.reset();
        self.bar.set_length(work);
        self.bar.set_message(id.to_owned());
    }

    fn advance(&self, work: u64) {
        self.bar.inc(work);
    }

    fn end(&self) {
        self.bar.set_position(self.bar.length().unwrap_or(0));
    }
}
