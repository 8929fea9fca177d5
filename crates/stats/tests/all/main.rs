//! Do intervals of means and of orders cover as often as they say?

mod means;
mod orders;
mod tails;
