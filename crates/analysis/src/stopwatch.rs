//! Times of repeated work.

use std::time::Instant;

use serde::{Deserialize, Serialize};

/// Wall time, and the processor time of the thread that started it.
///
/// Other processes take no processor time from a thread; they disturb its caches and the frequency
/// of its core.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    start: Instant,
    /// Processor time of the thread at the start, in seconds.
    used: f64,
}

impl Stopwatch {
    /// Starts a stopwatch on the thread that works.
    pub fn start() -> Self {
        let start = Instant::now();
        Self { start, used: processor_seconds(start) }
    }

    /// Seconds of wall time since the start.
    pub fn wall_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Seconds of processor time of this thread since the start, without work on other threads; of
    /// wall time where the system does not measure that of a thread.
    pub fn thread_s(&self) -> f64 {
        processor_seconds(self.start) - self.used
    }
}

#[cfg(unix)]
fn processor_seconds(_start: Instant) -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

#[cfg(not(unix))]
fn processor_seconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}

/// Several measurements of the same quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Smallest measurement: the cost of the work when nothing disturbs it.
    pub best: f64,
    /// Median of the measurements.
    pub median: f64,
    /// Largest measurement.
    pub worst: f64,
}

impl Spread {
    /// Computes the spread of at least one number.
    ///
    /// # Panics
    /// If there is none.
    pub fn of(mut numbers: Vec<f64>) -> Self {
        numbers.sort_by(f64::total_cmp);
        let last = numbers.len() - 1;
        let median = 0.5 * (numbers[last / 2] + numbers[last.div_ceil(2)]);
        Self { best: numbers[0], median, worst: numbers[last] }
    }

    /// Scales every number by `factor` > 0.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { best: self.best * factor, median: self.median * factor, worst: self.worst * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_ordered_whatever_came_first() {
        let spread = Spread::of(vec![3.0, 1.0, 2.0, 5.0]);
        assert_eq!(spread, Spread { best: 1.0, median: 2.5, worst: 5.0 });
        assert_eq!(spread.scaled(2.0), Spread { best: 2.0, median: 5.0, worst: 10.0 });
        assert_eq!(Spread::of(vec![7.0]), Spread { best: 7.0, median: 7.0, worst: 7.0 });
    }

    #[test]
    fn processor_time_of_a_thread_is_no_more_than_wall_time() {
        // Some processor time before the start does not count.
        let before = Stopwatch::start();
        let work = |seconds: f64| {
            let watch = Stopwatch::start();
            while watch.wall_s() < seconds {
                std::hint::black_box(seconds.sqrt());
            }
            watch
        };
        work(0.02);
        let watch = work(0.05);
        let (used, passed) = (watch.thread_s(), watch.wall_s());
        assert!(0.0 < used && used <= passed && passed >= 0.05, "{used} {passed}");
        assert!(before.wall_s() >= 0.07 && before.thread_s() > watch.thread_s() - 1e-3);
        // A thread that sleeps uses next to none.
        let asleep = Stopwatch::start();
        std::thread::sleep(std::time::Duration::from_millis(50));
        assert!(asleep.wall_s() >= 0.05);
        assert!(!cfg!(unix) || asleep.thread_s() < 0.02);
    }
}
