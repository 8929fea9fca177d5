//! Orders, `inspect`, and what both once said falsely; `compare`. One program: its tests run side
//! by side, and what they share is compiled once.

mod compare;
mod facts;
mod false_answers;
mod generated;
mod inspect;
mod orders;
mod run_time;
mod run_time_compare;
