//! Systems of matrices: fluids on a sphere, SU(N) spins, quantum systems.

use std::{ops::Range, sync::Arc};

use casimir::{
    formula::Names,
    inspect::facts::Bath,
    mc::{Initial, Observe, Problem, bind_at_run_time},
    real::{PathMask, Row, WIDTH},
    schemes::{BuiltIn, Method, SchemeError},
    systems::run_time::{self, System},
};
use keys::*;
use matrix::{
    Function, Grid, InCoordinates, MatrixSystem, OnMatrices, Quantum, Scheme, Sphere,
    SpinCouplings, Stirring, SuSpins, c64, coordinates, matrices, pure,
};

use super::{
    Built, Known, Model,
    damping::damping,
    lattice, problem,
    project::{numbered, valid},
};

/// The parameters of the systems.
pub const FLUID: &str = "size = 16, rotation = 0, advection = 1, degrees, strengths, spectrum = 8";
pub const SPINS: &str = "levels = 3, sizes = [1], periodic, exchange, quadratic, quartic, field";
pub const QUANTUM: &str = "hamiltonian, noises";

/// Bytes that a coordinate takes where it is simulated.
const COORDINATE: f64 = 5e3;

/// A problem of matrices.
struct OfMatrices {
    problem: run_time::Problem,
    system: Arc<dyn MatrixSystem>,
    initial: Option<Initial<'static>>,
    equation: &'static str,
    fluid: Option<Arc<Sphere>>,
}

impl Model for OfMatrices {
    fn problem(&self) -> Problem<'_> {
        Problem { initial: self.initial.clone(), ..Problem::at_run_time(&self.problem) }
    }

    fn scheme(&self, scheme: BuiltIn) -> Result<Arc<dyn Method + '_>, SchemeError> {
        let (id, of) = (scheme.id(), self.system());
        let refused = |why| Err(SchemeError::not_for(id, self.system.name(), why));
        let scheme = match scheme {
            BuiltIn::SexpLi => Scheme::Explicit,
            BuiltIn::Midpoint => Scheme::Midpoint,
            BuiltIn::EulerMaruyama | BuiltIn::Heun => {
                return bind_at_run_time(of, scheme.at_run_time(of)?);
            }
            BuiltIn::Split | BuiltIn::Nv => return refused("it needs a sum of parts with flows"),
            _ => return refused("take sexp-li or midpoint, which keep spectra, or em or heun"),
        };
        Ok(Arc::new(OnMatrices { system: Arc::clone(&self.system), scheme }))
    }

    fn system(&self) -> &dyn System {
        self.problem.system()
    }

    fn recommended(&self) -> (&'static str, String) {
        ("sexp-li", "it keeps the spectrum of each matrix at any step, and damps exactly".into())
    }

    fn bath(&self) -> Option<Bath> {
        None
    }

    fn known(&self) -> Known {
        let laws = vec!["each tr W^k of a site is a Casimir".into()];
        Known { equations: vec![self.equation.into()], laws, ..Known::default() }
    }

    fn fastest(&self) -> f64 {
        0.0
    }

    fn vorticity(&self, state: &[f64], grid: &Grid) -> Option<Vec<f64>> {
        let fluid = self.fluid.as_ref()?;
        let w = of_state(fluid.size(), state);
        Some(grid.values(fluid.size(), &fluid.relative(&w)))
    }
}

/// Matrices of a state.
fn of_state(n: usize, y: &[f64]) -> Vec<c64> {
    let mut w = vec![c64::default(); y.len()];
    matrices(n, |i| y[i], &mut w);
    w
}

/// Matrices that initial numbers stand for.
type Start = dyn Fn(&[f64]) -> Vec<c64> + Send + Sync;

/// A system, what initial numbers of some count stand for, and how it is described.
struct Parts {
    start: Box<Start>,
    /// Number of rows that random initial numbers have.
    numbers: usize,
    equation: &'static str,
    names: Names,
    functions: Vec<Function>,
    fluid: Option<Arc<Sphere>>,
}

/// Joins a system with its initial value.
fn built(reading: &Reading, system: Arc<dyn MatrixSystem>, parts: Parts) -> Read<Built> {
    let Parts { start, numbers, equation, names, functions, fluid } = parts;
    let (n, settings) = (system.size(), &reading.settings);
    let dimension = names.variables().len();
    let state = move |given: &[f64]| {
        let mut y = vec![0.0; dimension];
        let w = if given.len() == dimension { of_state(n, given) } else { start(given) };
        coordinates(n, &w, |i, value| y[i] = value);
        y
    };
    let y0 = state(&settings.initial);
    let initial = settings.random.clone().map(|Initial { law, draw }| {
        let given = numbers.max(settings.initial.len());
        let draw = Arc::new(move |key, first, rows: &mut [Row]| {
            let mut drawn = vec![[0.0; WIDTH]; given];
            draw(key, first, &mut drawn);
            for p in 0..WIDTH {
                let of_path: Vec<f64> = drawn.iter().map(|row| row[p]).collect();
                rows.iter_mut().zip(state(&of_path)).for_each(|(row, y)| row[p] = y);
            }
        });
        Initial { law, draw }
    });
    let (damping, friction) = damping(reading, names.variables(), &[])?;
    if !friction.is_empty() {
        let at = reading.file.damping.as_ref().and_then(|table| place(&table.components));
        refuse!(at, "matrices are damped as a whole: give one `rate`");
    }
    let in_coordinates = Arc::new(InCoordinates::new(Arc::clone(&system)));
    let problem = problem(reading, in_coordinates, damping, y0)?;
    let quantity = |of: Function| {
        let name = of.name().to_owned();
        let values = move |y: &[Row], values: &mut Row| of.evaluate(y, PathMask::ALL, values);
        Observable::new(name, Quantity::smooth(values))
    };
    let quantities: Vec<_> = functions.into_iter().map(quantity).collect();
    let energy = quantities.iter().find(|of| of.name == "energy").expect("each system has one");
    let energy = Further::Quantity(energy.quantity.clone());
    let model = OfMatrices { problem, system, initial, equation, fluid };
    Ok(Built { quantities, ..Built::new(model, names, Some(energy)) })
}

/// A whole number of a parameter in a range.
fn whole(reading: &Reading, name: &str, default: usize, range: Range<usize>) -> Read<usize> {
    let number = reading.number(name, default as f64)?;
    if number.fract() != 0.0 || !range.contains(&(number as usize)) {
        let (least, most) = (range.start, range.end - 1);
        refuse!(
            reading.place(name),
            "`{name}` is a whole number from {least} to {most}, got {number}"
        );
    }
    Ok(number as usize)
}

/// Euler's equations on the sphere.
pub fn fluid(reading: &Reading) -> Read<Built> {
    let n = whole(reading, "size", 16, 2..matrix::Harmonics::LARGEST + 1)?;
    let rotation = reading.number("rotation", 0.0)?;
    if let (true, Some(table)) = (rotation != 0.0, &reading.file.damping) {
        let words = "damping would act on the vorticity of the rotation, too: leave one out";
        refuse!(place(&table.rate), "{words}");
    }
    let degrees = reading.list("degrees", &[])?;
    let strengths = reading.list("strengths", &[1.0])?;
    let is_wrong = |l: &&f64| l.fract() != 0.0 || !(1.0..n as f64).contains(*l);
    if let Some(degree) = degrees.iter().find(is_wrong) {
        let most = n - 1;
        refuse!(reading.place("degrees"), "degrees are whole, from 1 to {most}, got {degree}");
    }
    if ![1, degrees.len()].contains(&strengths.len()) {
        let (number, all) = (strengths.len(), degrees.len());
        let message = "give one strength, or one for each degree, got";
        refuse!(reading.place("strengths"), "{message} {number} for {all} degrees");
    }
    let stirring = degrees.iter().enumerate().flat_map(|(k, degree)| {
        Stirring::isotropic(*degree as usize, strengths[k % strengths.len()])
    });
    let advection = reading.number("advection", 1.0)?;
    let fluid = Arc::new(reading.checked("size", Sphere::new(n, rotation, advection, stirring))?);
    let (initial, dimension) = (&reading.settings.initial, n * n);
    if initial.len() > dimension {
        let (most, given) = (dimension - 1, initial.len());
        refuse!(
            initial,
            "the initial value has up to {most} coefficients of harmonics, got {given}"
        );
    }
    let most = whole(reading, "spectrum", 8.min(n - 1), 1..n)?;
    let own = Arc::clone(&fluid);
    let parts = Parts {
        start: Box::new(move |given| own.vorticity(given)),
        numbers: 0,
        equation: "dω = {v, ω} dt + Σσₘ{Yₘ, ω} ∘ dWₘ − γω dt, v = (−Δ)⁻¹(ω − f), as matrices",
        names: numbered(dimension),
        functions: fluid.functions(most),
        fluid: Some(Arc::clone(&fluid)),
    };
    built(reading, fluid, parts)
}

/// ψψ* at each site, or at all if there is one ψ, which must not be zero; of length one.
fn coherent(reading: &Reading, n: usize, sites: usize) -> Read<Box<Start>> {
    let given = &reading.settings.initial;
    let (all, count) = (sites * n * n, given.len());
    if ![all, n, sites * n].contains(&count) {
        let of_all = if sites > 1 { ", those of all sites" } else { "" };
        refuse!(
            given,
            "the initial value has {n} amplitudes{of_all} or all {all} components, got {count}"
        );
    }
    if count != all && given.chunks(n).any(|psi| psi.iter().all(|x| *x == 0.0)) {
        refuse!(given, "amplitudes must not all be zero");
    }
    Ok(Box::new(move |given| {
        let mut w = Vec::with_capacity(all);
        given.chunks(n).cycle().take(sites).for_each(|psi| pure(psi, &mut w));
        w
    }))
}

/// SU(N) spins on a lattice.
pub fn spins(reading: &Reading) -> Read<Built> {
    let n = whole(reading, "levels", 3, 2..17)?;
    let (_, shape) = lattice::shape(reading, 1.0)?;
    let (sites, size) = (shape.sites(), n * n);
    lattice::fits(reading, sites, COORDINATE * size as f64)?;
    let couplings = SpinCouplings {
        exchange: reading.number("exchange", 0.0)?,
        quadratic: reading.number("quadratic", 0.0)?,
        quartic: reading.number("quartic", 0.0)?,
        field: reading.three("field", [0.0; 3])?,
        bath: lattice::bath(reading, 1)?.map(|(alphas, kt)| [alphas[0], kt]),
    };
    let spins = Arc::new(reading.checked("levels", SuSpins::new(n, shape, couplings))?);
    let components = (1..=sites).flat_map(|site| (1..=size).map(move |k| format!("s{site}_{k}")));
    let parts = Parts {
        start: coherent(reading, n, sites)?,
        numbers: sites * n,
        equation: "dρᵢ = −i[∂H/∂ρᵢ, ρᵢ] dt + bath, H = Σ(D(Sz)² + K(Sz)⁴ − h·S) − JΣ Sᵢ·Sⱼ",
        names: valid(components),
        functions: spins.functions(),
        fluid: None,
    };
    built(reading, spins, parts)
}

/// A quantum system with classical noise.
pub fn quantum(reading: &Reading) -> Read<Built> {
    let hamiltonian = operators(reading, "hamiltonian")?;
    let n = (1..=hamiltonian.len()).find(|n| n * n >= hamiltonian.len()).unwrap_or(0);
    if n * n != hamiltonian.len() || n == 0 {
        refuse!(
            reading.place("hamiltonian"),
            "`hamiltonian` has the entries of a square matrix, row by row, got {}",
            hamiltonian.len()
        );
    }
    let noises = operators(reading, "noises")?;
    if !noises.len().is_multiple_of(n * n) {
        let count = noises.len();
        refuse!(
            reading.place("noises"),
            "`noises` has the {} entries of each operator, one after the other, got {count}",
            n * n
        );
    }
    let columns = |rows: &[c64]| (0..n * n).map(|at| rows[at % n * n + at / n]).collect();
    let (hamiltonian, noises): (Vec<c64>, _) =
        (columns(&hamiltonian), noises.chunks(n * n).map(columns).collect());
    reading.checked("hamiltonian", Quantum::new(n, hamiltonian.clone(), Vec::new()))?;
    let quantum = Arc::new(reading.checked("noises", Quantum::new(n, hamiltonian, noises))?);
    let parts = Parts {
        start: coherent(reading, n, 1)?,
        numbers: n,
        equation: "dρ = −i[H, ρ] dt − iΣ[Lₘ, ρ] ∘ dWₘ",
        names: numbered(n * n),
        functions: quantum.functions(),
        fluid: None,
    };
    built(reading, quantum, parts)
}

/// Entries of operators row by row, formulas of the parameters that are affine in `i`.
fn operators(reading: &Reading, name: &str) -> Read<Vec<c64>> {
    let Some(at) = reading.get(name) else { return Ok(Vec::new()) };
    if !matches!(**at, Parameter::Many(_)) {
        refuse!(at, "`{name}` is a list of entries, row by row, such as [0, \"-i\", \"i\", 0]");
    }
    let mut names = reading.constants.names.clone();
    let units = usize::from(names.variable("i").is_ok());
    let entry = |text: &At<Text>| {
        let formula = text.formula(&names)?;
        let [re, one, two] = [0.0, 1.0, 2.0].map(|i| formula.value(&[i][..units]));
        let im = one - re;
        if !(re + im).is_finite() || (two - re - 2.0 * im).abs() > 1e-12 * (re.abs() + im.abs()) {
            refuse!(text, "`{}` is no number a + b*i", text.0);
        }
        Ok(c64::new(re, im))
    };
    at.texts().iter().map(entry).collect()
}
