//! Checked choices of statistics of dependence and of figures.

use casimir::{plot::figure::Title, study::Wanted};

use super::{Constants, FiguresTable, Pair, Read, Scene, Settings, StatisticsTable, refuse};

/// Checked choice of figures and of their axes.
#[derive(Default)]
pub struct FigureSettings {
    /// Pairs of columns that are drawn against each other, if chosen.
    pub portraits: Option<Vec<[String; 2]>>,
    /// Columns that are drawn, if chosen.
    pub show: Option<Vec<String>>,
    /// Columns, parameters and spectra with logarithmic axes.
    pub log: Vec<String>,
}

impl FigureSettings {
    pub(super) fn new(table: &FiguresTable, scene: &Scene, others: &[&str]) -> Read<Self> {
        let check = |name: &_| scene.column(name, &[]);
        let pair = |[x, y]: &Pair| Ok([check(x)?, check(y)?]);
        Ok(Self {
            portraits: chosen(&table.portraits, pair)?,
            show: chosen(&table.show, check)?,
            log: table.log.iter().map(|name| scene.column(name, others)).collect::<Read<_>>()?,
        })
    }

    /// The title of the axis of a column, a parameter or a spectrum.
    pub fn title<'a>(&self, words: &'a str) -> Title<'a> {
        Title { words, logarithmic: self.log.iter().any(|log| log == words) }
    }
}

/// Checks all of what is chosen, if something is.
pub fn chosen<T, U>(
    all: &Option<Vec<T>>,
    check: impl FnMut(&T) -> Read<U>,
) -> Read<Option<Vec<U>>> {
    all.as_ref().map(|all| all.iter().map(check).collect()).transpose()
}

/// Reads and checks the wanted statistics of dependence.
pub fn wanted(table: &StatisticsTable, scene: &Scene, constants: &Constants) -> Read<Wanted> {
    let number = |name: &_| scene.observable(name);
    let pair = |[a, b]: &Pair| Ok((number(a)?, number(b)?));
    let mut wanted = Wanted {
        pairs: table.pairs.iter().map(pair).collect::<Read<_>>()?,
        lagged: table.autocorrelation.iter().map(number).collect::<Read<_>>()?,
        ..Wanted::default()
    };
    if let Some(from) = &table.from {
        let Settings { until, times, random, .. } = &scene.settings;
        let time = constants.value(from)?;
        if !(0.0..*until).contains(&time) {
            refuse!(from, "autocorrelations begin from 0 to {until}, got {time}");
        }
        // Random initial values are a saved time as well.
        let place = (time / until * *times as f64 - 1e-9).ceil() as usize;
        wanted.from = place.saturating_sub(usize::from(random.is_none()));
    }
    Ok(wanted)
}
