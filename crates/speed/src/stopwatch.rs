//! Two clocks: the one on the wall, and the time that this thread has spent on a core.

use std::time::Instant;

use crate::{Clock, Spread};

/// Both clocks of repeated work, in seconds.
pub(crate) struct Times {
    pub(crate) wall: Spread,
    /// By [`CLOCK`].
    pub(crate) thread: Spread,
}

/// Does the work once to warm up and then `repetitions` times, on this thread. The time of the
/// thread is that of this one alone and says nothing about work that goes to others.
pub(crate) fn repeat(repetitions: u32, mut work: impl FnMut()) -> Times {
    work();
    let (mut wall, mut thread) = (Vec::new(), Vec::new());
    for _ in 0..repetitions {
        let (start, start_of_thread) = (Instant::now(), thread_seconds(&Instant::now()));
        work();
        thread.push(thread_seconds(&start) - start_of_thread);
        wall.push(start.elapsed().as_secs_f64());
    }
    Times { wall: Spread::of(wall), thread: Spread::of(thread) }
}

/// What the time of a thread is on this system.
#[cfg(unix)]
pub(crate) const CLOCK: Clock = Clock::OnCore;
/// What the time of a thread is on this system.
#[cfg(not(unix))]
pub(crate) const CLOCK: Clock = Clock::Wall;

/// Seconds that this thread has spent on a core.
#[cfg(unix)]
fn thread_seconds(_start: &Instant) -> f64 {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

/// Seconds since the start.
#[cfg(not(unix))]
fn thread_seconds(start: &Instant) -> f64 {
    start.elapsed().as_secs_f64()
}
