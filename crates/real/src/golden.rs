//! Points that are spread evenly, without chance.

/// The multiple of the golden ratio with this number, modulo one: successive numbers give points of
/// [0, 1) with large gaps between them, for any count of points.
#[must_use]
pub fn golden(number: f64) -> f64 {
    (number * 0.618_033_988_749_894_8).fract()
}
