//! Progress of work, and requests to end it early.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread,
    time::{Duration, Instant},
};

use casimir::mc::parts::Stop;

use crate::failure::{Done, Failure};

/// Shows the progress of work; by default nothing is shown.
pub trait Progress: Send + Sync {
    /// Begins work of so long, in path-steps; zero if their number is not known.
    fn begin(&self, _what: &str, _path_steps: u64) {}

    /// Adds path-steps that are done.
    fn advance(&self, _path_steps: u64) {}

    /// Shows the state of the work in words.
    fn message(&self, _words: &str) {}

    /// Ends the work.
    fn end(&self) {}

    /// Whether somebody sees the progress. If not, long work is reported in words.
    fn is_seen(&self) -> bool {
        false
    }

    /// Says a line.
    fn say(&self, _words: &str) {}
}

/// Shows nothing.
impl Progress for () {}

/// Progress of a verb, and the request that ends it early.
#[derive(Clone)]
pub struct Watch {
    /// Shows the work that is under way.
    pub progress: Arc<dyn Progress>,
    /// Request to end early.
    pub stop: Stop,
}

impl Watch {
    /// Watch that shows `progress`; nothing has asked for the end.
    pub fn new(progress: impl Progress + 'static) -> Self {
        Self { progress: Arc::new(progress), stop: Stop::default() }
    }

    /// Does work to an accuracy. `work` reports its half-width so far and the part of its
    /// path-steps that is done. After a minute, and at the end, an accuracy that is not reached is
    /// reported, with the time that it takes.
    pub fn until<R>(
        &self,
        what: &str,
        accuracy: f64,
        work: impl FnOnce(&dyn Fn(f64, f64)) -> R,
    ) -> R {
        let (start, last) = (Instant::now(), Mutex::new((f64::INFINITY, 0.0)));
        let now = || start.elapsed().as_secs_f64();
        let last = || last.lock().unwrap_or_else(PoisonError::into_inner);
        let told = |half_width: f64, done: f64| {
            *last() = (half_width, now() / done);
            let left = now() * (1.0 / done - 1.0);
            self.progress.message(&format!(
                "±{half_width:.1e} so far, ±{accuracy:.1e} wanted, about {left:.0} s left"
            ));
        };
        let say = || {
            let ((half_width, whole), since) = (*last(), now());
            let so_far = match half_width.is_finite() {
                _ if half_width <= accuracy => return,
                false if since < PATIENCE.as_secs_f64() => return,
                false => "no estimate yet".into(),
                true => match (whole - since) / 60.0 {
                    // What is left is the step error, and not sampling.
                    more if more < 0.05 => format!("±{half_width:.1e} so far"),
                    more if more < MANY_MINUTES => {
                        format!("±{half_width:.1e} so far, about {more:.1} more")
                    }
                    _ => format!("±{half_width:.1e} so far, far from it"),
                },
            };
            let since = since / 60.0;
            self.progress
                .say(&format!("±{accuracy:e} is not reached in {since:.1} minutes: {so_far}"));
        };
        let result = watched(PATIENCE, say, || self.under(what, 0, |_| work(&told)));
        say();
        result
    }

    /// Does work of about `path_steps` path-steps, zero if that is not known; `work` tells how many
    /// more are done. Where nobody sees the progress of long work, it is reported once.
    pub fn under<R>(
        &self,
        what: &str,
        path_steps: u64,
        work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> R,
    ) -> R {
        let (start, done, progress) = (Instant::now(), AtomicU64::new(0), &*self.progress);
        progress.begin(what, path_steps);
        let say = || {
            let since = start.elapsed().as_secs_f64();
            let left = since * (path_steps as f64 / done.load(Ordering::Relaxed) as f64 - 1.0);
            let known = left.is_finite().then(|| format!(", about {left:.0} s left"));
            if !progress.is_seen() {
                progress.say(&format!("{what}: {since:.0} s so far{}", known.unwrap_or_default()));
            }
        };
        let advance = |more| {
            done.fetch_add(more, Ordering::Relaxed);
            progress.advance(more);
        };
        let result = watched(SOON, say, || work(&advance));
        progress.end();
        result
    }

    /// Refuses to go on if the end was asked for.
    pub fn check(&self) -> Done {
        if self.stop.is_asked() {
            Err(Failure::Stopped("nothing is complete".into()))
        } else {
            Ok(())
        }
    }
}

/// Time after which the progress is reported, where no bar shows it.
const SOON: Duration = Duration::from_secs(8);
/// Minutes that nobody waits.
const MANY_MINUTES: f64 = 1e5;
/// Time after which the half-width reached so far is reported.
const PATIENCE: Duration = Duration::from_secs(60);

/// Does work, and calls `say` if that takes longer than `patience`.
fn watched<R>(patience: Duration, say: impl Fn() + Sync, work: impl FnOnce() -> R) -> R {
    thread::scope(|scope| {
        let ((working, ended), say) = (channel::<()>(), &say);
        scope.spawn(move || {
            if ended.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
                say();
            }
        });
        let result = work();
        drop(working);
        result
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU32;

    use super::*;

    #[test]
    fn long_work_is_spoken_of_once() {
        for (patience, expected) in [(Duration::from_millis(1), 1), (PATIENCE, 0)] {
            let said = AtomicU32::new(0);
            let say = || _ = said.fetch_add(1, Ordering::Relaxed);
            watched(patience, say, || thread::sleep(Duration::from_millis(200)));
            assert_eq!(said.into_inner(), expected);
        }
    }
}
