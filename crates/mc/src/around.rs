//! Methods around other methods.

use std::sync::Arc;

use real::Row;
use schemes::{Method, Stepper};

/// What makes steppers around those of another method.
pub trait Wrap: Send + Sync {
    /// A stepper around one of `method`; see [`Method::start`].
    fn start<'s>(&'s self, method: &'s dyn Method, y: &[Row]) -> Box<dyn Stepper + 's>;
}

/// A method and what is around it. It reads the noise of that method.
pub struct Around<'a, T> {
    pub method: Arc<dyn Method + 'a>,
    pub wrap: T,
}

impl<T: Wrap> Method for Around<'_, T> {
    fn id(&self) -> &'static str {
        self.method.id()
    }

    fn reads_areas(&self) -> bool {
        self.method.reads_areas()
    }

    fn clips_increments(&self) -> bool {
        self.method.clips_increments()
    }

    fn stack(&self) -> usize {
        self.method.stack()
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        self.wrap.start(&*self.method, y)
    }
}
