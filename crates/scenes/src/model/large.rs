//! A lattice of very many spins, whose paths are computed one after the other on all threads.

use std::sync::Arc;

use casimir::{
    expectation::Expect,
    lattice::{Means, Record},
    mc::{Coefficients, Column, Friction, NoiseOrigin, Observe, Problem, Role, TimeSeries},
    real::{PathMask, Row, Rows, WIDTH},
    schemes::{BuiltIn, Method, SchemeError},
    systems::{
        Damping, SystemError,
        lattice::SpinLattice,
        run_time::{self, System},
    },
};

use super::{Built, Model, damping::damping, lattice::Start, project::numbered};
use crate::{Further, Observable, Quantity, Read, Reading, Scene, Settings, refuse};

/// A large lattice. Its components are means: the mean spin, the energy per spin, and the mean spin
/// of each site of a cell with several.
pub struct Large {
    /// The lattice, in rows of one path.
    pub lattice: Arc<SpinLattice>,
    damping: Arc<dyn Damping>,
    start: Start,
    settings: Settings,
    /// Means at the start of path 0.
    means: Vec<f64>,
}

impl Large {
    pub(super) fn built(reading: &Reading<'_>, lattice: SpinLattice, start: Start) -> Read<Built> {
        let names = |name: &str| ["x", "y", "z"].map(|axis| format!("{name}{axis}"));
        let mut components = Vec::from(names("m"));
        components.push("energy".into());
        let several = if start.moments.len() > 1 { start.moments.len() } else { 0 };
        components.extend((1..=several).flat_map(|b| names(&format!("m{b}"))));
        let (damping, friction) = damping(reading, &components, &[])?;
        if let (false, Some(table)) = (friction.is_empty(), &reading.file.damping) {
            let place = table.components.as_ref().map(|of| of.span());
            refuse!(place, "a lattice of so many spins has no friction: give a `rate` of all");
        }
        let y0 = start.of_path(reading.settings.key, 0);
        let layout = lattice.description().layout;
        let mut rows = Rows::zero(layout.rows);
        for (component, y) in y0.into_iter().enumerate() {
            let (row, place) = layout.place(component);
            rows[row][place] = y;
        }
        let means = Self::values(&Means::of(&lattice, &rows, 0.0));
        let settings = reading.settings.clone();
        let quantity = |(k, name): (usize, &String)| Observable::new(name, Quantity::Component(k));
        // A few components are observables by themselves.
        let many = components.len() > crate::MAX_COMPONENTS;
        let quantities = components.iter().enumerate().map(quantity).filter(|_| many).collect();
        Ok(Built {
            names: numbered(&components),
            components,
            sizes: Vec::new(),
            energy: Some(Further::Quantity(Quantity::Component(3))),
            quantities,
            model: Box::new(Self { lattice: Arc::new(lattice), damping, start, settings, means }),
        })
    }

    /// The components, from means.
    #[must_use]
    pub fn values(Means { spin, energy, of_sites }: &Means) -> Vec<f64> {
        let of_sites = if of_sites.len() > 1 { &of_sites[..] } else { &[] };
        spin.iter().chain([energy]).chain(of_sites.as_flattened()).copied().collect()
    }

    /// The problem of a path.
    ///
    /// # Errors
    /// [`SystemError`] if an initial value is not finite.
    pub fn path(&self, path: u64) -> Result<run_time::Problem, SystemError> {
        let (settings, lattice) = (&self.settings, Arc::clone(&self.lattice));
        let y0 = self.start.of_path(settings.key, path);
        run_time::Problem::new(lattice, Arc::clone(&self.damping), y0, settings.until)
    }

    /// The table of a path: means of the lattice, and observables of them.
    #[must_use]
    pub fn table(&self, scene: &Scene, (scheme, path): (&str, u64), record: &Record) -> TimeSeries {
        let values: Vec<Vec<f64>> = record.means.iter().map(Self::values).collect();
        let column =
            |name: &str, role, values: Vec<f64>| Column { name: name.into(), role, values };
        let mut columns = vec![column("t", Role::Time, record.times.clone())];
        for (k, name) in scene.components.iter().enumerate() {
            let of = values.iter().map(|values| values[k]).collect();
            columns.push(column(name, Role::Component, of));
        }
        let others = scene.observables.iter();
        for phi in others.filter(|phi| !matches!(phi.quantity, Quantity::Component(_))) {
            let value = |values: &Vec<f64>| {
                let rows: Vec<Row> = values.iter().map(|value| [*value; WIDTH]).collect();
                phi.values(&rows, PathMask::first(1))[0]
            };
            columns.push(column(&phi.name, Role::Observable, values.iter().map(value).collect()));
        }
        let problem = self.problem();
        let key = self.settings.key;
        TimeSeries {
            system: self.lattice.crystal().cell.name.clone(),
            damping: problem.describe_damping(),
            scheme: scheme.into(),
            tau: problem.t_end / self.settings.steps as f64,
            noise: NoiseOrigin { seed: key.seed, experiment: key.experiment, path },
            halted: record.halted.clone(),
            columns,
        }
    }
}

impl Model for Large {
    /// Means in place of spins: no scheme takes it.
    fn problem(&self) -> Problem<'_> {
        let none = || Coefficients { drift: vec![], noises: vec![], correction: vec![] };
        let description = self.lattice.description();
        Problem {
            name: description.name.clone(),
            parameters: description.parameters.clone(),
            noises: description.noises,
            silent: false,
            y0: self.means.clone(),
            initial: None,
            t_end: self.settings.until,
            damping: &*self.damping,
            friction: &[],
            laws: Vec::new(),
            coefficients: Arc::new(move |_, _| none()),
            in_time: None,
            device: None,
        }
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        Err(SchemeError::not_for(scheme.id(), "spin-lattice", "one path is on all threads"))
    }

    fn expect(&self) -> Option<Expect<'_>> {
        None
    }

    fn system(&self) -> &dyn System {
        &*self.lattice
    }

    fn recommended(&self) -> (&'static str, String) {
        ("sexp-li", "it keeps the lengths of spins, and is explicit".into())
    }

    fn friction(&self) -> &[Friction] {
        &[]
    }

    fn fastest(&self) -> f64 {
        0.0
    }

    fn large(&self) -> Option<&Large> {
        Some(self)
    }
}
