//! A lattice of very many spins, whose paths are computed one after the other on all threads.

use std::sync::Arc;

use casimir::{
    lattice::{Means, Record},
    mc::{Coefficients, Column, NoiseOrigin, Observe, Problem, Role, TimeSeries},
    real::{PathMask, Rows},
    schemes::{BuiltIn, Method, SchemeError},
    systems::{
        Damping, SystemError,
        lattice::SpinLattice,
        run_time::{self, System},
    },
};
use keys::*;

use super::{Built, Model, damping::damping, lattice::Start, project::valid};
use crate::Scene;

/// A large lattice. Its components are means: the mean spin, the energy per spin, and the mean spin
/// of each site of a cell with several.
pub struct Large {
    /// The lattice, in rows of one path.
    pub lattice: Arc<SpinLattice>,
    damping: Arc<dyn Damping>,
    start: Start,
    /// Means at the start of path 0.
    means: Vec<f64>,
}

impl Large {
    pub(super) fn built(reading: &Reading, lattice: SpinLattice, start: Start) -> Read<Built> {
        let vector = |name: &str| ["x", "y", "z"].map(|axis| format!("{name}{axis}"));
        let sites = start.moments.len();
        let of_sites = (1..=sites).filter(|_| sites > 1).flat_map(|b| vector(&format!("m{b}")));
        let names = valid(vector("m").into_iter().chain(["energy".into()]).chain(of_sites));
        let components = names.variables();
        let (damping, friction) = damping(reading, components, &[])?;
        if let (false, Some(table)) = (friction.is_empty(), &reading.file.damping) {
            let words = "a lattice of so many spins has no friction: give a `rate` of all";
            refuse!(place(&table.components), "{words}");
        }
        let y0 = start.of_path(0);
        let layout = lattice.description().layout;
        let mut rows = Rows::zero(layout.rows);
        for (component, y) in y0.into_iter().enumerate() {
            let (row, place) = layout.place(component);
            rows[row][place] = y;
        }
        let means = Self::values(&Means::of(&lattice, &rows, 0.0));
        // A few components are observables by themselves.
        let many = components.len() > crate::MAX_COMPONENTS;
        let quantity = |(k, name): (usize, &String)| Observable::new(name, Quantity::Component(k));
        let quantities = components.iter().enumerate().map(quantity).filter(|_| many).collect();
        let model = Self { lattice: Arc::new(lattice), damping, start, means };
        let energy = Further::Quantity(Quantity::Component(3));
        Ok(Built { quantities, ..Built::new(model, names, Some(energy)) })
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
        let Self { lattice, damping, start, .. } = self;
        let (y0, t_end) = (start.of_path(path), start.settings.until);
        run_time::Problem::new(lattice.clone(), damping.clone(), y0, t_end)
    }

    /// The table of a path: means of the lattice, and observables of them.
    #[must_use]
    pub fn table(&self, scene: &Scene, (scheme, path): (&str, u64), record: &Record) -> TimeSeries {
        let values: Vec<Vec<f64>> = record.means.iter().map(Self::values).collect();
        let column = |name: &str, role, of: &dyn Fn(&Vec<f64>) -> f64| {
            let values = values.iter().map(of).collect();
            Column { name: name.into(), role, values }
        };
        let time = Column { name: "t".into(), role: Role::Time, values: record.times.clone() };
        let components = scene.components.iter().enumerate();
        let components = components.map(|(k, name)| column(name, Role::Component, &|of| of[k]));
        let others = scene.observables.iter();
        let others = others.filter(|phi| !matches!(phi.quantity, Quantity::Component(_)));
        let others = others.map(|phi| {
            let value = |of: &Vec<f64>| phi.values(&Rows::splat(of), PathMask::first(1))[0];
            column(&phi.name, Role::Observable, &value)
        });
        let columns = [time].into_iter().chain(components).chain(others).collect();
        let (problem, settings) = (self.problem(), &self.start.settings);
        let key = settings.key;
        TimeSeries {
            system: self.lattice.crystal().cell.name.clone(),
            damping: problem.describe_damping(),
            scheme: scheme.into(),
            tau: problem.t_end / settings.steps as f64,
            noise: NoiseOrigin { seed: key.seed, experiment: key.experiment, path },
            halted: record.halted.clone(),
            columns,
        }
    }
}

impl Model for Large {
    /// Means in place of spins: no scheme takes it.
    fn problem(&self) -> Problem<'_> {
        let description = self.lattice.description();
        Problem {
            name: description.name.clone(),
            parameters: description.parameters.clone(),
            noises: description.noises,
            silent: false,
            y0: self.means.clone(),
            initial: None,
            t_end: self.start.settings.until,
            damping: &*self.damping,
            friction: &[],
            laws: Vec::new(),
            coefficients: Arc::new(|_, _| Coefficients {
                drift: vec![],
                noises: vec![],
                correction: vec![],
            }),
            in_time: Vec::new(),
            device: None,
        }
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        Err(SchemeError::not_for(scheme.id(), "spin-lattice", "one path is on all threads"))
    }

    fn system(&self) -> &dyn System {
        &*self.lattice
    }

    fn recommended(&self) -> (&'static str, String) {
        ("sexp-li", "it keeps the lengths of spins, and is explicit".into())
    }

    fn fastest(&self) -> f64 {
        0.0
    }

    fn large(&self) -> Option<&Large> {
        Some(self)
    }
}
