//! Do intervals of means and of orders cover as often as they say?

mod statistical;
