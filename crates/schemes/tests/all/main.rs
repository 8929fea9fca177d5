//! The tests of the schemes in one binary, so that the kernels of each system are compiled once for
//! all of them; those that disassemble themselves are binaries of their own.

mod bits;
mod by_hand;
mod common;
mod conformal;
mod levy;
mod long_time;
mod nv;
mod order;
mod overflow;
mod own_schemes;
mod run_time;
mod stiff_damping;
mod sweeps;
mod tiles;
mod without_iteration;
