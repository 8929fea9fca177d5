//! Systems of matrices: fluids on a sphere, SU(N) spins, quantum systems.

use std::{ops::Range, sync::Arc};

use casimir::{
    expectation::Expect,
    inspect::facts::Bath,
    mc::{Friction, Initial, Problem, Setup},
    noise::StreamKey,
    real::{Row, WIDTH},
    schemes::{BuiltIn, Method, SchemeError},
    systems::{
        lattice::Shape,
        run_time::{self, System},
    },
};
use matrix::{
    Grid, InCoordinates, MatrixSystem, OnMatrices, Quantum, Scheme, Sphere, SpinCouplings,
    Stirring, SuSpins, c64, coordinates, inner, matrices,
};

use super::{Built, Known, Model, damping::damping, project::numbered};
use crate::{At, BathTable, Further, Observable, Parameter, Quantity, Read, Reading, refuse};

/// The parameters of the systems.
pub const FLUID: &str = "size = 16, rotation = 0, advection = 1, degrees, strengths, spectrum = 8";
pub const SPINS: &str = "levels = 3, sizes = [1], periodic, exchange, quadratic, quartic, field";
pub const QUANTUM: &str = "hamiltonian, noises";

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
        let scheme = match scheme {
            BuiltIn::SexpLi => Scheme::Explicit,
            BuiltIn::Midpoint => Scheme::Midpoint,
            BuiltIn::EulerMaruyama | BuiltIn::Heun => {
                let scheme = scheme.at_run_time(self.problem.system())?;
                return Ok(Setup::at_run_time(&self.problem, scheme)?.scheme);
            }
            other => {
                let why = match other {
                    BuiltIn::Split | BuiltIn::Nv => "it needs a sum of parts with flows",
                    _ => "take sexp-li or midpoint, which keep spectra, or em or heun",
                };
                return Err(SchemeError::not_for(other.id(), self.system.name(), why));
            }
        };
        Ok(Arc::new(OnMatrices { system: Arc::clone(&self.system), scheme }))
    }

    /// None: what is chosen is for systems of texts.
    fn expect(&self) -> Option<Expect<'_>> {
        None
    }

    fn system(&self) -> &dyn System {
        self.problem.system()
    }

    fn recommended(&self) -> (&'static str, String) {
        ("sexp-li", "it keeps the spectrum of each matrix at any step, and damps exactly".into())
    }

    fn friction(&self) -> &[Friction] {
        &[]
    }

    fn bath(&self) -> Option<Bath> {
        None
    }

    fn known(&self) -> Known {
        let laws = vec!["each tr W^k of a site is a Casimir".into()];
        Known { equations: vec![self.equation.into()], laws, mistake: None }
    }

    fn fastest(&self) -> f64 {
        0.0
    }

    fn vorticity(&self, state: &[f64], grid: &Grid) -> Option<Vec<f64>> {
        let fluid = self.fluid.as_ref()?;
        let w = of_state(fluid.size(), |i| state[i], state.len());
        Some(grid.values(fluid.size(), &fluid.relative(&w)))
    }
}

/// Matrices of a state.
fn of_state(n: usize, y: impl Fn(usize) -> f64, dimension: usize) -> Vec<c64> {
    let mut w = vec![c64::default(); dimension];
    matrices(n, y, &mut w);
    w
}

/// A function of matrices as a quantity.
fn function(
    n: usize,
    dimension: usize,
    of: impl Fn(&[c64]) -> f64 + Send + Sync + 'static,
) -> Quantity {
    Quantity::Function(Arc::new(move |y: &[Row], values: &mut Row| {
        for p in 0..WIDTH {
            // Paths that are equal to the first one are not computed again.
            let like = p > 0 && y[..dimension].iter().all(|y| y[p].to_bits() == y[0].to_bits());
            values[p] = if like { values[0] } else { of(&of_state(n, |i| y[i][p], dimension)) };
        }
    }))
}

/// Matrices that initial numbers stand for.
type Start = dyn Fn(&[f64]) -> Vec<c64> + Send + Sync;

/// A system, what initial numbers of some count stand for, and how it is described.
struct Parts {
    start: Box<Start>,
    /// Number of rows that random initial numbers have.
    numbers: usize,
    equation: &'static str,
    components: Vec<String>,
    energy: Quantity,
    quantities: Vec<Observable>,
    fluid: Option<Arc<Sphere>>,
}

/// Joins a system with its initial value.
fn built(reading: &Reading<'_>, system: Arc<dyn MatrixSystem>, parts: Parts) -> Read<Built> {
    let Parts { start, numbers, equation, components, energy, quantities, fluid } = parts;
    let (n, settings) = (system.size(), reading.settings);
    let dimension = components.len();
    let state = move |given: &[f64]| {
        let mut y = vec![0.0; dimension];
        let w = if given.len() == dimension {
            of_state(n, |i| given[i], dimension)
        } else {
            start(given)
        };
        coordinates(n, &w, |i, value| y[i] = value);
        y
    };
    let y0 = state(&settings.initial);
    let initial = settings.random.clone().map(|Initial { law, draw }| {
        let given = settings.initial.len();
        let given = if given == dimension { dimension } else { numbers.max(given) };
        let draw = move |key: StreamKey, first: u64, rows: &mut [Row]| {
            let mut drawn = vec![[0.0; WIDTH]; given];
            draw(key, first, &mut drawn);
            for p in 0..WIDTH {
                let of_path: Vec<f64> = drawn.iter().map(|row| row[p]).collect();
                rows.iter_mut().zip(state(&of_path)).for_each(|(row, y)| row[p] = y);
            }
        };
        Initial { law, draw: Arc::new(draw) }
    });
    let (damping, friction) = damping(reading, &components, &[])?;
    if !friction.is_empty() {
        let place = reading.file.damping.as_ref().and_then(|table| crate::place(&table.components));
        refuse!(place, "matrices are damped as a whole: give one `rate`");
    }
    let in_coordinates = Arc::new(InCoordinates::new(Arc::clone(&system)));
    let problem = run_time::Problem::new(in_coordinates, damping, y0, settings.until)
        .map_err(|error| reading.initial_error(error))?;
    Ok(Built {
        sizes: Vec::new(),
        names: numbered(&components),
        components,
        energy: Further::Quantity(energy),
        quantities,
        model: Box::new(OfMatrices { problem, system, initial, equation, fluid }),
    })
}

/// A whole number of a parameter in a range.
fn whole(reading: &Reading<'_>, name: &str, default: usize, range: Range<usize>) -> Read<usize> {
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

/// Names of the parameters in a list of them with defaults.
fn names(list: &str) -> Vec<&str> {
    list.split(", ").map(|one| one.split(" = ").next().unwrap_or(one)).collect()
}

/// Euler's equations on the sphere.
pub fn fluid(reading: &Reading<'_>) -> Read<Built> {
    reading.know(&names(FLUID))?;
    let n = whole(reading, "size", 16, 2..matrix::Harmonics::LARGEST + 1)?;
    let rotation = reading.number("rotation", 0.0)?;
    if let (true, Some(table)) = (rotation != 0.0, &reading.file.damping) {
        let place = crate::place(&table.rate);
        refuse!(place, "damping would act on the vorticity of the rotation, too: leave one out");
    }
    let degrees = reading.list("degrees", &[])?;
    let strengths = reading.list("strengths", &[1.0])?;
    if let Some(degree) = degrees.iter().find(|l| l.fract() != 0.0 || !(1.0..n as f64).contains(l))
    {
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
    let fluid = Sphere::new(n, rotation, advection, stirring)
        .map_err(|error| reading.error("size", error))?;
    let (fluid, given) = (Arc::new(fluid), reading.settings.initial.len());
    if given > n * n {
        let most = n * n - 1;
        return Err(reading.initial_error(format!(
            "the initial value has up to {most} coefficients of harmonics, got {given}"
        )));
    }
    let dimension = n * n;
    let quantity = |of: fn(&Sphere, &[c64]) -> f64| {
        let fluid = Arc::clone(&fluid);
        function(n, dimension, move |w| of(&fluid, w))
    };
    let energy = quantity(|fluid, w| fluid.energy(w));
    let mut quantities = vec![
        Observable::new("energy", energy.clone()),
        Observable::new("enstrophy", quantity(|_, w| inner(w, w))),
    ];
    for l in 1..=whole(reading, "spectrum", 8.min(n - 1), 1..n)? {
        let own = Arc::clone(&fluid);
        let of = function(n, dimension, move |w| {
            own.harmonics().power(&own.relative(w), l) / (2 * l * (l + 1)) as f64
        });
        quantities.push(Observable::new(format!("energy{l}"), of));
    }
    let own = Arc::clone(&fluid);
    let parts = Parts {
        start: Box::new(move |given| {
            let mut w = own.relative(&vec![c64::default(); n * n]);
            w.iter_mut().for_each(|w| *w = -*w);
            let orders = (1..n).flat_map(|l| (-(l as isize)..=l as isize).map(move |m| (l, m)));
            for ((l, m), value) in orders.zip(given).filter(|(_, value)| **value != 0.0) {
                own.harmonics().add(&mut w, l, m, *value);
            }
            w
        }),
        numbers: 0,
        equation: "dω = {v, ω} dt + Σσₘ{Yₘ, ω} ∘ dWₘ − γω dt, v = (−Δ)⁻¹(ω − f), as matrices",
        components: (1..=dimension).map(|i| format!("y{i}")).collect(),
        energy,
        quantities,
        fluid: Some(Arc::clone(&fluid)),
    };
    built(reading, fluid, parts)
}

/// ψψ* at each site, or at all if there is one ψ; of length one.
fn pure(n: usize, sites: usize) -> Box<Start> {
    Box::new(move |given| {
        let mut w = Vec::with_capacity(sites * n * n);
        for site in 0..sites {
            let first = if given.len() == n { 0 } else { site * n };
            let psi = &given[first..first + n];
            let norm = psi.iter().map(|x| x * x).sum::<f64>();
            w.extend((0..n * n).map(|at| c64::new(psi[at % n] * psi[at / n] / norm, 0.0)));
        }
        w
    })
}

/// Checks the number of initial numbers, and that ψ is not zero.
fn demand(reading: &Reading<'_>, n: usize, sites: usize) -> Read<()> {
    let given = &reading.settings.initial;
    let is_state = given.len() == sites * n * n;
    let counts = [n, sites * n];
    if !is_state && !counts.contains(&given.len()) {
        let (all, count) = (sites * n * n, given.len());
        return Err(reading.initial_error(format!(
            "the initial value has {n} amplitudes, those of all sites or all {all} components, got \
             {count}"
        )));
    }
    if !is_state && given.chunks(n).any(|psi| psi.iter().all(|x| *x == 0.0)) {
        return Err(reading.initial_error("amplitudes must not all be zero"));
    }
    Ok(())
}

/// The mean population of each level over the sites.
fn populations(n: usize, sites: usize) -> impl Iterator<Item = Observable> {
    (0..n).map(move |j| {
        let of =
            move |w: &[c64]| w.chunks(n * n).map(|w| w[j * n + j].re).sum::<f64>() / sites as f64;
        Observable::new(format!("p{}", j + 1), function(n, sites * n * n, of))
    })
}

/// SU(N) spins on a lattice.
pub fn spins(reading: &Reading<'_>) -> Read<Built> {
    reading.know(&names(SPINS))?;
    let n = whole(reading, "levels", 3, 2..17)?;
    let sizes = reading.list("sizes", &[1.0])?;
    if let Some(size) =
        sizes.iter().find(|size| size.fract() != 0.0 || !(1.0..=1e4).contains(*size))
    {
        refuse!(reading.place("sizes"), "a size is a whole number of at least 1, got {size}");
    }
    let sizes: Vec<usize> = sizes.iter().map(|size| *size as usize).collect();
    let shape = Shape::new(&sizes, reading.switch("periodic", false)?)
        .map_err(|error| reading.error("sizes", error))?;
    let bath = match &*reading.file.bath {
        [] => None,
        [BathTable { temperature, through, friction, transverse }, more @ ..] => {
            let others = through.len() + friction.len() + more.len() == 0;
            let alpha = transverse.first().filter(|(s, _)| others && s.as_str() == "s");
            let Some((_, alpha)) = alpha.filter(|_| transverse.len() == 1) else {
                let words = "these spins have one bath of all sites: `transverse = { s = 0.1 }`";
                refuse!(temperature, "{words}");
            };
            Some([reading.constants.value(alpha)?, reading.constants.value(temperature)?])
        }
    };
    let couplings = SpinCouplings {
        exchange: reading.number("exchange", 0.0)?,
        quadratic: reading.number("quadratic", 0.0)?,
        quartic: reading.number("quartic", 0.0)?,
        field: reading.three("field", [0.0; 3])?,
        bath,
    };
    let sites = shape.sites();
    let wrong = |error| match reading.file.bath.first() {
        Some(bath) => crate::Wrong::new(&bath.temperature, error),
        None => reading.error("levels", error),
    };
    let spins = Arc::new(SuSpins::new(n, shape, couplings).map_err(wrong)?);
    demand(reading, n, sites)?;
    let dimension = sites * n * n;
    let own = Arc::clone(&spins);
    let energy = function(n, dimension, move |w| own.energy(w) / sites as f64);
    let mean = |axis: usize| {
        let own = Arc::clone(&spins);
        let of = move |w: &[c64]| {
            (0..sites).map(|site| own.dipole(w, site)[axis]).sum::<f64>() / sites as f64
        };
        Observable::new(["mx", "my", "mz"][axis], function(n, dimension, of))
    };
    let mut quantities: Vec<Observable> = (0..3).map(mean).collect();
    quantities.extend(populations(n, sites));
    quantities.push(Observable::new("energy", energy.clone()));
    let component = |k: usize| format!("s{}_{}", k / (n * n) + 1, k % (n * n) + 1);
    let parts = Parts {
        start: pure(n, sites),
        numbers: sites * n,
        equation: "dρᵢ = −i[∂H/∂ρᵢ, ρᵢ] dt + bath, H = Σ(D(Sz)² + K(Sz)⁴ − h·S) − JΣ Sᵢ·Sⱼ",
        components: (0..dimension).map(component).collect(),
        energy,
        quantities,
        fluid: None,
    };
    built(reading, spins, parts)
}

/// A quantum system with classical noise.
pub fn quantum(reading: &Reading<'_>) -> Read<Built> {
    let hamiltonian = operators(reading, "hamiltonian")?;
    let n = (1..=hamiltonian.len()).find(|n| n * n >= hamiltonian.len()).unwrap_or(0);
    let noises = operators(reading, "noises")?;
    if n == 0 || !noises.len().is_multiple_of(n * n) {
        let count = noises.len();
        refuse!(
            reading.place("noises"),
            "`noises` has the {} entries of each operator, one after the other, got {count}",
            n * n
        );
    }
    let noises = noises.chunks(n * n).map(<[c64]>::to_vec).collect();
    let quantum = Quantum::new(n, hamiltonian, noises)
        .map_err(|error| reading.error("hamiltonian", error))?;
    demand(reading, n, 1)?;
    let quantum = Arc::new(quantum);
    let own = Arc::clone(&quantum);
    let energy = function(n, n * n, move |w| own.energy(w));
    let mut quantities: Vec<Observable> = populations(n, 1).collect();
    quantities.push(Observable::new("energy", energy.clone()));
    quantities.push(Observable::new("purity", function(n, n * n, |w| inner(w, w))));
    for (k, j) in (0..n).flat_map(|k| (0..k).map(move |j| (k, j))) {
        let entry = |part: fn(c64) -> f64| function(n, n * n, move |w| part(w[k * n + j]));
        let (row, column) = (j + 1, k + 1);
        quantities.push(Observable::new(format!("re{row}_{column}"), entry(|x| x.re)));
        quantities.push(Observable::new(format!("im{row}_{column}"), entry(|x| x.im)));
    }
    let parts = Parts {
        start: pure(n, 1),
        numbers: n,
        equation: "dρ = −i[H, ρ] dt − iΣ[Lₘ, ρ] ∘ dWₘ",
        components: (1..=n * n).map(|i| format!("y{i}")).collect(),
        energy,
        quantities,
        fluid: None,
    };
    built(reading, quantum, parts)
}

/// Entries of operators row by row, formulas of the parameters that are affine in `i`; column by
/// column for Hermitian ones, whose transposes these are conjugates of.
fn operators(reading: &Reading<'_>, name: &str) -> Read<Vec<c64>> {
    let Some(at) = reading.get(name) else { return Ok(Vec::new()) };
    let Parameter::Many(texts) = &**at else {
        refuse!(at, "`{name}` is a list of entries, row by row, such as [0, \"-i\", \"i\", 0]");
    };
    let mut names = reading.constants.names.clone();
    let unit = names.variable("i").is_ok();
    let entry = |text: &crate::Text| {
        let text = At::new(at.span(), text.clone());
        let formula = text.formula(&names)?;
        let of = |i: f64| if unit { formula.value(&[i]) } else { formula.value(&[]) };
        let (re, im) = (of(0.0), of(1.0) - of(0.0));
        if !(re + im).is_finite() || (of(2.0) - re - 2.0 * im).abs() > 1e-12 * (re.abs() + im.abs())
        {
            refuse!(at, "`{}` is no number a + b*i", text.0);
        }
        // Rows of a Hermitian matrix are columns of its conjugate.
        Ok(c64::new(re, -im))
    };
    texts.iter().map(entry).collect()
}
