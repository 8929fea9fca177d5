//! Are increments, Lévy areas and scrambled Sobol points what they are said to be, as far as
//! samples can tell?

mod areas;
mod battery;
mod check;
mod law;
mod quasi;
mod rebuilt;
mod statistics;
mod truncation;
mod written_out;
