//! Progress on the terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use verify::Progress;

/// A bar for the panel that is running; nothing where the output is no terminal.
pub struct Bars {
    bar: ProgressBar,
}

impl Default for Bars {
    /// No bar yet.
    fn default() -> Self {
        let style = "{elapsed:>4} [{bar:28}] {percent:>3}% {msg}, {eta} left";
        let style = ProgressStyle::with_template(style).expect("the template is valid");
        let bar = ProgressBar::new(0).with_style(style.progress_chars("=> "));
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }
}

impl Bars {
    /// Prints a line above the bar, also where there is no bar.
    pub fn println(&self, line: &str) {
        self.bar.suspend(|| println!("{line}"));
    }

    /// Takes the bar off the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bars {
    fn begin(&self, id: &str, work: u64) {
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
