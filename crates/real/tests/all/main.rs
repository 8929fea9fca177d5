//! Blocks, derivatives and elementary functions against what is known of them.

mod block;
mod derivative;
mod elementary;
