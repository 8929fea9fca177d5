//! Schemes on systems whose dimension is known at run time only.

use nonlin::BlockStatus;
use real::Row;

use crate::Step;

/// A scheme on a system, both fixed: what a driver sees of them. N is the noise of a step on 32
/// paths, see [`noise::StepNoise`].
///
/// A [`Scheme`](crate::Scheme) on a [`PoissonSystem`](systems::PoissonSystem) becomes one in `mc`.
/// Like a scheme it draws no random numbers and truncates nothing.
pub trait DynScheme<N>: Send + Sync {
    /// Identifier in results, for example `sexp`.
    fn id(&self) -> &'static str;

    /// Whether the scheme reads the Lévy areas of a step.
    fn reads_areas(&self) -> bool;

    /// Whether the driver truncates increments and areas for this scheme.
    fn clips_increments(&self) -> bool;

    /// Bytes of stack that a step needs; few unless overridden.
    fn stack(&self) -> usize {
        0
    }

    /// 32 paths in the states `y`; row i is component i. A block of paths has one for each run,
    /// made once.
    fn start(&self, y: &[Row]) -> Box<dyn RunState<N> + '_>;
}

/// The states of 32 paths that a scheme advances.
pub trait RunState<N>: Send {
    /// Advances every path by one step and overwrites `status`. A path that `status` marks as
    /// failed may hold anything.
    fn step(&mut self, step: &Step, noise: &N, status: &mut BlockStatus);

    /// The states; row i is component i.
    fn rows(&self) -> &[Row];

    /// The states, to be set.
    fn rows_mut(&mut self) -> &mut [Row];
}
