//! Which dependence of observables is computed, and which figures are drawn.

use casimir::mc::study::Wanted;

use super::{
    Columns, Settings,
    file::{FiguresTable, StatisticsTable},
    read::Constants,
    source::Read,
};

/// Which figures are drawn, and how.
#[derive(Debug, Default)]
pub struct Drawn {
    /// Pairs that are drawn against each other, if they are chosen.
    pub portraits: Option<Vec<[String; 2]>>,
    /// The columns that are drawn, if they are chosen.
    pub show: Option<Vec<String>>,
    /// What has logarithmic axes.
    pub log: Vec<String>,
    /// Whether a dot runs along path 0.
    pub animate: bool,
}

impl Drawn {
    pub(super) fn new(table: &FiguresTable, columns: &Columns<'_>, varied: &[&str]) -> Read<Self> {
        let pair = |[x, y]: &super::file::Pair| Ok([columns.check(x, &[])?, columns.check(y, &[])?]);
        let portraits = table.portraits.as_ref().map(|pairs| pairs.iter().map(pair).collect());
        let show = table.show.as_ref();
        let show = show.map(|names| names.iter().map(|name| columns.check(name, &[])).collect());
        Ok(Self {
            portraits: portraits.transpose()?,
            show: show.transpose()?,
            log: table.log.iter().map(|name| columns.check(name, varied)).collect::<Read<_>>()?,
            animate: table.animate,
        })
    }

    /// Whether a column or parameter has a logarithmic axis.
    pub fn is_logarithmic(&self, name: &str) -> bool {
        self.log.iter().any(|log| log == name)
    }
}

/// The dependence that is wanted.
pub(super) fn wanted(
    table: &StatisticsTable,
    columns: &Columns<'_>,
    (settings, constants): (&Settings, &Constants),
) -> Read<Wanted> {
    let pair = |[a, b]: &super::file::Pair| Ok((columns.observable(a)?, columns.observable(b)?));
    let Some(from) = &table.from else {
        return Ok(Wanted {
            pairs: table.pairs.iter().map(pair).collect::<Read<_>>()?,
            lagged: table.autocorrelation.iter().map(|a| columns.observable(a)).collect::<Read<_>>()?,
            from: 0,
        });
    };
    let time = constants.value(columns.source, from)?;
    let spacing = settings.until / settings.times as f64;
    if !(0.0..settings.until).contains(&time) {
        let message = format!("autocorrelations begin from 0 to {}, got {time}", settings.until);
        return Err(columns.source.error(from.span(), message));
    }
    // Random initial values are a saved time as well.
    let first = (time / spacing - 1e-9).ceil().max(1.0) as usize - 1;
    let from = first + usize::from(settings.random.is_some() && time > 0.0);
    let table = StatisticsTable { from: None, ..table.clone() };
    Ok(Wanted { from, ..wanted(&table, columns, (settings, constants))? })
}
