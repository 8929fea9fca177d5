//! Progress on the terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use verify::Progress;

/// A bar for the panel that is running; nothing where the output is no terminal.
pub struct Bars {
    bar: ProgressBar,
}

impl Bars {
    /// No bar yet.
    #[must_use]
    pub fn new() -> Self {
        let bar = ProgressBar::new(0);
        bar.set_style(
            ProgressStyle::with_template("{elapsed:>4} [{bar:28}] {percent:>3}% {msg}, {eta} left")
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("=> "),
        );
        bar.enable_steady_tick(Duration::from_millis(200));
        Self { bar }
    }

    /// Prints a line above the bar, also where there is no bar.
    pub fn println(&self, line: &str) {
        self.bar.suspend(|| println!("{line}"));
    }

    /// Takes the bar off the terminal.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Default for Bars {
    fn default() -> Self {
        Self::new()
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
