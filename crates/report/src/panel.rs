//! What figures, tables and files agree on about a panel.

use analysis::results::Series;

/// Two-sided 95 % quantile of the normal distribution.
pub const QUANTILE: f64 = 1.96;

/// The name of a panel's files: its id, without what could leave the folder.
pub fn file_stem(id: &str) -> String {
    id.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// The quantity that a strong or invariant figure shows: the error at the final time, or else the
/// first quantity.
pub fn main_quantity(series: &[Series]) -> &str {
    const FINAL_TIME: &str = "y(T)";
    let mut quantities = series.iter().map(|s| s.quantity.as_str());
    let first = quantities.clone().next().unwrap_or("");
    quantities.find(|q| *q == FINAL_TIME).unwrap_or(first)
}

/// |value − exact| / |exact|, and zero where the two agree.
pub fn relative_defect(value: f64, exact: f64) -> f64 {
    if value == exact { 0.0 } else { ((value - exact) / exact).abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_stay_in_their_folder() {
        assert_eq!(file_stem("rigid-body-weak-y2"), "rigid-body-weak-y2");
        assert_eq!(file_stem("../x/y"), "___x_y");
    }

    #[test]
    fn agreement_has_no_defect_even_at_zero() {
        assert_eq!(relative_defect(0.0, 0.0), 0.0);
        assert_eq!(relative_defect(1.5, -1.0), 2.5);
        assert_eq!(relative_defect(1.0, 0.0), f64::INFINITY);
    }
}
