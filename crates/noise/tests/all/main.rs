//! Are increments, Lévy areas and scrambled Sobol points what they are said to be, as far as
//! samples can tell?

mod rebuilt;
mod statistical;
mod written_out;
