//! Quantiles from all values where these are few, in the place of those from histograms.

use casimir::{
    mc::{
        TimeSeries,
        study::{Place, Quantile, StudyResult},
    },
    stats::quantile_ranks,
};

use crate::scene::Scene;

/// Numbers that are kept for exact quantiles: 32 megabytes.
const MOST_NUMBERS: u64 = 4_000_000;

/// Whether all tables of a scene are few enough.
pub fn are_affordable(scene: &Scene) -> bool {
    let settings = &scene.settings;
    let of_path = (settings.times + 1).saturating_mul(scene.columns() as u64);
    settings.paths.saturating_mul(of_path) <= MOST_NUMBERS
}

/// Replaces the quantiles of a study by order statistics of the tables of all its paths.
pub fn replace(study: &mut StudyResult, tables: &[TimeSeries]) {
    for series in &mut study.series {
        for (row, point) in series.points.iter_mut().enumerate() {
            let value = |table: &TimeSeries| {
                let column = table.column(&series.observable)?;
                column.get(row).copied().filter(|value| value.is_finite())
            };
            let mut values: Vec<f64> = tables.iter().filter_map(value).collect();
            if values.is_empty() {
                continue;
            }
            values.sort_by(f64::total_cmp);
            let count = values.len() as u64;
            for quantile in &mut point.quantiles {
                let level = quantile.level;
                // The rank k from 1 to n.
                let at = |k: u64| values.get(usize::try_from(k).ok()?.checked_sub(1)?).copied();
                let rank = ((level * count as f64).ceil() as u64).clamp(1, count);
                let (lo, hi) = quantile_ranks(count, level);
                *quantile = Quantile {
                    level,
                    value: at(rank),
                    lo: at(lo),
                    hi: at(hi),
                    place: Place::Inside,
                };
            }
        }
    }
    study.warnings.retain(|warning| !warning.contains(": a quantile lies "));
}
