//! stub
pub mod results;
