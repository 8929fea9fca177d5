//! What the stack promises for every system, checked on systems that nobody wrote by hand.
//!
//! Random skew structures (constant, linear, scaled; most violate Jacobi's identity, which no proof
//! here uses), random linear and quadratic Casimirs built to be Casimirs, random homogeneous and
//! non-polynomial Hamiltonians, random damping, steps and truncated increments, in 2 to 5
//! dimensions with 1 to 3 noises.
//!
//! | module | idea |
//! |---|---|
//! | `rounding` | numbers that bound their own rounding error: where tolerances come from |
//! | `structure`, `hamiltonian`, `damping`, `random` | the random systems and what happens to them |
//! | `law` | the defect of a conformal law and what round-off and the solver may make of it |
//! | `conformal` | `sexp` keeps Casimirs and energies over several steps; `sexp-li` keeps Casimirs for increments of all sizes |
//! | `twins` | the same checks reject what is wrong on purpose |
//!
//! All draws come from proptest with a fixed seed, so a run is reproducible. `--nocapture` prints
//! how much of each tolerance was used.

mod conformal;
mod damping;
mod hamiltonian;
mod law;
mod random;
mod rounding;
mod structure;
mod twins;
