//! Numbers and tables for people.

/// Formats a number with three significant digits where it is of ordinary size, with two otherwise.
///
/// ```
/// let read = [0.0, f64::NAN, 0.25, 3.16, 27.18, 1234.6, 1e-3, 4e7].map(analysis::number);
/// assert_eq!(read, ["0", "NaN", "0.25", "3.16", "27.2", "1235", "1.0e-3", "4.0e7"]);
/// ```
pub fn number(x: f64) -> String {
    match x.abs() {
        0.0 => format!("{x}"),
        99.95..1e5 => format!("{x:.0}"),
        9.995..99.95 => format!("{x:.1}"),
        0.0995..9.995 => format!("{x:.2}"),
        _ => format!("{x:.1e}"),
    }
}

/// Largest width of a column.
const WIDEST: usize = 100;

/// Aligns cells in columns as wide as their widest cell, or a hundred characters.
pub fn aligned(rows: &[Vec<String>]) -> String {
    let cell = |row: &Vec<String>, k: usize| row.get(k).map_or(0, |cell| cell.chars().count());
    let width = |k: usize| rows.iter().map(|row| cell(row, k)).max().unwrap_or(0).min(WIDEST);
    let line = |row: &Vec<String>| {
        let cells = row.iter().enumerate();
        let cells = cells.map(|(k, cell)| format!("{cell:<0$}", width(k)));
        format!("{}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}
