//! Processor time of the calling thread.

use std::time::Duration;

/// What [`thread_time`] reads, in words.
pub(crate) const CLOCK: &str = if cfg!(unix) {
    "processor time of the thread"
} else {
    "wall time, for want of a thread's processor time"
};

/// Processor time that this thread has used: what other processes take from it does not count, what
/// they do to caches and to the frequency does.
#[cfg(unix)]
pub(crate) fn thread_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
}

/// Wall time since the first call.
#[cfg(not(unix))]
pub(crate) fn thread_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_runs_with_work() {
        let start = thread_time();
        let mut sum = 0.0;
        for n in 0..2_000_000 {
            sum += std::hint::black_box(f64::from(n)).sqrt();
        }
        assert!(sum > 0.0 && thread_time() > start);
    }
}
