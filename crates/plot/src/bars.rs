//! Progress on the terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar for what is running; nothing where the output is no terminal. Work is counted in
/// path-steps.
pub struct Bars {
    bar: ProgressBar,
}

impl Default for Bars {
    /// No bar yet.
    fn default() -> Self {
        let bar = ProgressBar::new(0);
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }
}

impl Bars {
    /// A piece of work begins; it will do about `work` path-steps, if that is known and not zero.
    pub fn begin(&self, id: &str, work: u64) {
        let template = match work {
            0 => "{elapsed:>4} {spinner} {msg}",
            _ => "{elapsed:>4} [{bar:28}] {percent:>3}% {msg}, {eta} left",
        };
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        self.bar.set_style(style.progress_chars("=> "));
        self.bar.reset();
        self.bar.set_length(work);
        self.bar.set_message(id.to_owned());
    }

    /// Some of it is done; called from any thread.
    pub fn advance(&self, work: u64) {
        self.bar.inc(work);
    }

    /// Takes the bar off the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
