//! Spins on a lattice.

use std::sync::{Arc, OnceLock};

use casimir::{
    formula::{Names, Tape},
    mc::{Initial, demand},
    noise::StreamKey,
    real::{Row, Rows, WIDTH},
    systems::{
        lattice::{
            Bond, Cell, Couplings, Crystal, Field, LATTICES, Material, Pair, Shape, SpinLattice,
            noise_at_temperature,
        },
        run_time::{Lanes, Problem, System, Weights},
    },
};

use super::{AtRunTime, Built, damping::damping, large::Large, project::numbered};
use crate::{
    At, BathTable, Further, Observable, Parameter, Quantity, Read, Reading, Wrong, among, refuse,
};

/// The parameters of a lattice.
pub const PARAMETERS: &str = "sizes, periodic, lattice, exchange, next, dmi, interfacial, moment, \
                              anisotropy, field, noise, local, transverse";

/// Bytes that a site takes where it is simulated or inspected, and on one large path.
const SITE: [f64; 2] = [1.5e4, 400.0];
/// Sites from which a few paths are computed one after the other, each on all threads.
pub const MANY_SITES: usize = 1 << 15;
/// Relative tolerance for the lengths of spins.
const ROUNDING: f64 = 1e-9;

/// Sizes and shape of a lattice, `default` if none are given.
pub fn shape(reading: &Reading<'_>, default: f64) -> Read<(Vec<usize>, Shape)> {
    let sizes = reading.list("sizes", &[default])?;
    if let Some(size) = sizes.iter().find(|n| n.fract() != 0.0 || !(1.0..=1e6).contains(*n)) {
        refuse!(reading.place("sizes"), "a size is a whole number of at least 1, got {size}");
    }
    let sizes: Vec<usize> = sizes.iter().map(|size| *size as usize).collect();
    let shape = Shape::new(&sizes, reading.switch("periodic", false)?)
        .map_err(|error| reading.error("sizes", error))?;
    Ok((sizes, shape))
}

/// Refuses more sites than there is memory for, where each takes `bytes`.
pub fn fits(reading: &Reading<'_>, sites: usize, bytes: f64) -> Read<()> {
    demand(format!("a lattice of {sites} sites"), bytes * sites as f64)
        .map_err(|error| reading.error("sizes", error))
}

/// Damping α of each of `each` sites of a cell, and the temperature kT, of the one bath of all
/// spins of a lattice.
pub fn bath(reading: &Reading<'_>, each: usize) -> Read<Option<(Vec<f64>, f64)>> {
    let [BathTable { temperature, through, friction, transverse }, more @ ..] = &*reading.file.bath
    else {
        return Ok(None);
    };
    let alone = through.len() + friction.len() + more.len() == 0;
    let of = |name: &str| transverse.iter().find(|(known, _)| known.as_str() == name);
    let alphas: Option<Vec<_>> = match of("s") {
        Some((_, alpha)) if transverse.len() == 1 => Some(vec![alpha; each]),
        _ if transverse.len() == each => {
            (1..=each).map(|b| of(&format!("s{b}")).map(|(_, alpha)| alpha)).collect()
        }
        _ => None,
    };
    let Some(alphas) = alphas.filter(|_| alone) else {
        let several = match each {
            1 => String::new(),
            _ => format!(", or s1 to s{each} for the sites of a cell"),
        };
        refuse!(
            temperature,
            "a lattice has one bath, by transverse damping of all its spins: \
             `transverse = {{ s = 0.1 }}`{several}"
        );
    };
    // The same at all times: t is no name here.
    let alphas: Vec<f64> =
        alphas.into_iter().map(|alpha| reading.constants.value(alpha)).collect::<Read<_>>()?;
    let kt = reading.constants.value(temperature)?;
    if let Some(alpha) = alphas.iter().find(|alpha| kt < 0.0 || **alpha <= 0.0) {
        refuse!(
            temperature,
            "a temperature of at least 0 needs `transverse` damping above 0, got {kt} and {alpha}"
        );
    }
    Ok(Some((alphas, kt)))
}

/// One number for all of `count`, or a number for each.
fn each(reading: &Reading<'_>, name: &str, default: f64, count: usize) -> Read<Vec<f64>> {
    match &reading.list(name, &[default])?[..] {
        [one] => Ok(vec![*one; count]),
        all if all.len() == count => Ok(all.to_vec()),
        all => {
            let (given, each) =
                (all.len(), if count > 1 { format!(" or {count}") } else { String::new() });
            refuse!(reading.place(name), "`{name}` takes 1{each} numbers here, got {given}")
        }
    }
}

/// The unit cell.
fn cell(reading: &Reading<'_>) -> Read<Cell> {
    let name = match reading.get("lattice").map(|at| &**at) {
        None => "cubic",
        Some(Parameter::One(name)) => &name.0,
        Some(_) => "",
    };
    let unknown =
        || reading.error("lattice", format!("no lattice `{name}`{}", among(name, &LATTICES)));
    Cell::named(name).ok_or_else(unknown)
}

/// The bonds of a cell: exchange and antisymmetric exchange of nearest neighbours, exchange of next
/// ones. Numbers are for all pairs of sites of the cell, or for 11, 12, …, 1n, 22, …
fn bonds(reading: &Reading<'_>, cell: &Cell, axes: usize) -> Read<Vec<Bond>> {
    let sites = cell.sites.len();
    let of = |name, default| each(reading, name, default, sites * (sites + 1) / 2);
    let number = |pair: &Pair| {
        let (a, b) = (pair.from.min(pair.to), pair.from.max(pair.to));
        a * (2 * sites - a - 1) / 2 + b
    };
    let (exchange, next) = (of("exchange", 1.0)?, of("next", 0.0)?);
    let (along, across) = (of("dmi", 0.0)?, of("interfacial", 0.0)?);
    let nearest = cell.pairs(axes, 0).into_iter().map(|pair| {
        let (k, [x, y, z]) = (number(&pair), pair.way);
        let length = (x * x + y * y + z * z).sqrt();
        let (d, e) = (along[k] / length, across[k] / length);
        Bond { pair, exchange: exchange[k], antisymmetric: [d * x - e * y, d * y + e * x, d * z] }
    });
    let far = cell.pairs(axes, 1).into_iter().filter(|pair| next[number(pair)] != 0.0);
    let far = far.map(|pair| Bond { pair, exchange: next[number(&pair)], antisymmetric: [0.0; 3] });
    Ok(nearest.chain(far).collect())
}

/// The field: three numbers, or formulas of t and the place x, y, z.
fn field(reading: &Reading<'_>) -> Read<Field> {
    let given = reading.get("field");
    let texts = match given.map(|at| (at, &**at)) {
        Some((at, Parameter::Many(texts))) if texts.len() == 3 => {
            texts.iter().map(|text| At::new(at.span(), text.clone())).collect::<Vec<_>>()
        }
        _ => return Ok(reading.three("field", [0.0; 3])?.into()),
    };
    let mut names = Names::new();
    for name in ["t", "x", "y", "z"] {
        names.variable(name).map_err(|error| reading.error("field", error))?;
    }
    let formulas = texts.iter().map(|text| text.formula(&names)).collect::<Read<Vec<_>>>()?;
    let reads: Vec<usize> = formulas.iter().flat_map(|formula| formula.reads()).collect();
    if reads.is_empty() {
        return Ok(reading.three("field", [0.0; 3])?.into());
    }
    for (text, formula) in texts.iter().zip(&formulas) {
        if let Some(error) = formula.explain(&[0.0; 4]) {
            let message = format!("{} at t = 0 and the origin", error.message);
            return Err(Wrong::in_formula(text, &error, message));
        }
    }
    let tape = |formula: &casimir::formula::Formula| {
        Tape::new(&formula.graph, &[formula.root], &[0..1, 1..4])
    };
    let tapes: Vec<Tape> = formulas.iter().map(tape).collect();
    let scratch_rows = 1 + tapes.iter().map(Tape::scratch_rows).max().unwrap_or(0);
    let of = move |t: f64, places: &[Row; 3], out: &mut [Row], scratch: &mut [Row]| {
        for (tape, out) in tapes.iter().zip(out.chunks_mut(1)) {
            tape.evaluate(&[&[[t; WIDTH]], places], out, scratch);
        }
    };
    Ok(Field::Of { of: Arc::new(of), depends_on_time: reads.contains(&0), scratch_rows })
}

/// Initial values of the spins: those of the scene times the moments of the sites of the cell.
#[derive(Clone)]
pub struct Start {
    pub crystal: Arc<Crystal>,
    pub moments: Vec<f64>,
    initial: Vec<f64>,
    random: Option<Initial<'static>>,
    /// Whether states of all spins come from a file.
    whole: bool,
}

impl Start {
    fn of_site(&self, site: usize) -> ([f64; 3], f64) {
        (self.crystal.place(site), self.moments[self.crystal.coordinates(site).0])
    }

    /// The spins, one possible value where they are random.
    fn possible(&self) -> Vec<f64> {
        let all = match self.initial[..] {
            [x, y, z] => [x, y, z].repeat(self.crystal.sites()),
            ref all => all.to_vec(),
        };
        all.iter().enumerate().map(|(k, s)| s * self.of_site(k / 3).1).collect()
    }

    /// The spins of 32 paths.
    fn draw(&self, key: StreamKey, first: u64, rows: &mut [Row]) {
        let Some(law) = &self.random else { return };
        let of_spins = |rows: &mut [Row], with: &dyn Fn(&mut Row, f64, f64)| {
            for (site, spin) in rows.chunks_exact_mut(3).enumerate() {
                let (place, moment) = self.of_site(site);
                spin.iter_mut().zip(place).for_each(|(row, r)| with(row, r, moment));
            }
        };
        of_spins(rows, &|row, r, _| *row = [r; WIDTH]);
        (law.draw)(key, first, rows);
        of_spins(rows, &|row, _, moment| row.iter_mut().for_each(|s| *s *= moment));
    }

    /// The law on 32 paths, if initial values are random.
    fn law(&self) -> Option<Initial<'static>> {
        let (start, law) = (self.clone(), self.random.as_ref()?.law.clone());
        let draw = move |key: StreamKey, first: u64, rows: &mut [Row]| start.draw(key, first, rows);
        Some(Initial { law, draw: Arc::new(draw) })
    }

    /// The spins of one large path: each is that of a path of its own of the law.
    pub fn of_path(&self, key: StreamKey, path: u64) -> Vec<f64> {
        let mut y = self.possible();
        let Some(law) = self.random.as_ref().filter(|_| !self.whole) else { return y };
        let groups = self.crystal.sites().div_ceil(WIDTH) as u64;
        for (group, spins) in y.chunks_mut(3 * WIDTH).enumerate() {
            let mut rows = [[0.0; WIDTH]; 3];
            for p in 0..spins.len() / 3 {
                let (place, _) = self.of_site(group * WIDTH + p);
                rows.iter_mut().zip(place).for_each(|(row, r)| row[p] = r);
            }
            (law.draw)(key, (path * groups + group as u64) * WIDTH as u64, &mut rows);
            for (p, spin) in spins.chunks_exact_mut(3).enumerate() {
                let (_, moment) = self.of_site(group * WIDTH + p);
                spin.iter_mut().zip(&rows).for_each(|(s, row)| *s = row[p] * moment);
            }
        }
        y
    }

    /// The length of the spins at each site of the cell, which all of `rows` have.
    fn lengths(&self, rows: &[Row]) -> Result<Vec<f64>, [f64; 2]> {
        let norm = |s: [f64; 3]| s.iter().map(|s| s * s).sum::<f64>().sqrt();
        let mut ends = vec![[f64::INFINITY, 0.0f64]; self.moments.len()];
        for (site, spin) in rows.chunks_exact(3).enumerate() {
            let [least, most] = &mut ends[self.crystal.coordinates(site).0];
            for p in 0..WIDTH {
                let length = norm([spin[0][p], spin[1][p], spin[2][p]]);
                (*least, *most) = (least.min(length), most.max(length));
            }
        }
        match ends.iter().find(|[least, most]| most - least > ROUNDING * most) {
            Some(ends) => Err(*ends),
            None => Ok(ends.into_iter().map(|[_, most]| most).collect()),
        }
    }
}

/// Builds the model of a lattice.
pub fn build(reading: &Reading<'_>) -> Read<Built> {
    if let Some(place) = reading.place("dipolar") {
        refuse!(
            place,
            "dipolar fields are not computed: each spin acts on all others, which takes a Fourier \
             transform for each evaluation and leaves no flow of a bond"
        );
    }
    reading.know(&PARAMETERS.split(", ").collect::<Vec<_>>())?;
    let (mut sizes, shape) = shape(reading, 8.0)?;
    let cell = cell(reading)?;
    let (each_cell, simple) = (cell.sites.len(), cell.name == "cubic");
    let bonds = bonds(reading, &cell, sizes.len())?;
    let none = vec![Material::default(); each_cell];
    let crystal = Arc::new(Crystal { cell, shape, bonds, materials: none });
    let (sites, settings) = (crystal.sites(), reading.settings);
    let is_large = settings.one_by_one && sites >= MANY_SITES && !settings.is_study();
    fits(reading, sites, SITE[usize::from(is_large)])?;
    let start = Start {
        moments: each(reading, "moment", 1.0, each_cell)?,
        crystal: Arc::clone(&crystal),
        initial: settings.initial.clone(),
        random: settings.random.clone(),
        whole: settings.states.is_some(),
    };
    let per_spin = settings.initial.len() == 3 && !(is_large && start.whole);
    if !per_spin && settings.initial.len() != 3 * sites {
        let given = settings.initial.len();
        let words = format!("the initial value must have {} components, got {given}", 3 * sites);
        return Err(reading.initial_error(words));
    }
    let local = reading.switch("local", true)?;
    let (alphas, noises) = match (bath(reading, each_cell)?, reading.file.bath.first()) {
        (Some((alphas, kt)), Some(BathTable { temperature, .. })) => {
            if let Some(place) = reading.place("transverse").or(reading.place("noise")) {
                refuse!(place, "damping and noise follow from the bath: leave this out");
            }
            if sites > 1 && !local || reading.file.damping.is_some() {
                refuse!(
                    temperature,
                    "a bath takes a noise for each spin, `local`, and no [damping]: give `noise`"
                );
            }
            // Of random initial values those of the first 32 paths are looked at.
            let splat = |y: Vec<f64>| y.iter().map(|y| [*y; WIDTH]).collect::<Vec<Row>>();
            let lengths = if is_large {
                let mut y = start.of_path(settings.key, 0);
                y.truncate(3 * MANY_SITES);
                start.lengths(&splat(y))
            } else {
                let mut rows = splat(start.possible());
                start.draw(settings.key, 0, &mut rows);
                start.lengths(&rows)
            };
            let lengths = match lengths {
                Ok(lengths) => lengths,
                Err([least, most]) => {
                    refuse!(temperature, "spins have lengths from {least} to {most}: give `noise`")
                }
            };
            // σ² = 2α kT/|s|. A length of one is not exactly one.
            let is_one = |length: f64| length == 0.0 || (length - 1.0).abs() < ROUNDING;
            let lengths = lengths.into_iter().map(|of| if is_one(of) { 1.0 } else { of });
            let noise = |(alpha, length): (&f64, f64)| noise_at_temperature(*alpha, kt / length);
            let noises = alphas.iter().zip(lengths).map(noise).collect();
            (alphas, noises)
        }
        _ => {
            let of = |name| each(reading, name, 0.0, each_cell);
            (of("transverse")?, of("noise")?)
        }
    };
    let anisotropies = each(reading, "anisotropy", 0.0, each_cell)?;
    let material =
        |b: usize| Material { anisotropy: anisotropies[b], noise: noises[b], damping: alphas[b] };
    let materials = (0..each_cell).map(material).collect();
    let crystal = Crystal { materials, ..Arc::unwrap_or_clone(crystal) };
    let (field, lanes) = (field(reading)?, if is_large { Lanes::Components } else { Lanes::Paths });
    let is_simple = simple && crystal.bonds.iter().all(|bond| bond.antisymmetric == [0.0; 3]);
    let lattice = match field {
        Field::Constant(field) if is_simple && !is_large && reading.place("next").is_none() => {
            let Material { anisotropy, noise, damping } = crystal.materials[0];
            let exchange = reading.number("exchange", 1.0)?;
            let couplings = Couplings { exchange, anisotropy, field, noise, local, damping };
            SpinLattice::on_paths(crystal.shape, couplings)
        }
        field => SpinLattice::new(crystal, field, local, lanes),
    };
    let lattice = lattice.map_err(|error| reading.error("sizes", error))?;
    if is_large {
        return Large::built(reading, lattice, start);
    }
    if let Some(across) = sizes.get_mut(1) {
        *across *= each_cell;
    } else {
        sizes[0] *= each_cell;
    }
    let components: Vec<String> =
        (1..=sites).flat_map(|site| ["x", "y", "z"].map(|axis| format!("s{site}{axis}"))).collect();
    let system = lattice.clone();
    let per_spin = move |y: &[Row], values: &mut Row| {
        let description = system.description();
        let [dw, mut scratch] = [description.noises, description.scratch_rows()].map(Rows::zero);
        system.energy(
            &y[..3 * sites],
            Weights { dt: 1.0, dw: &dw, ..Weights::NONE },
            values,
            &mut scratch,
        );
        values.iter_mut().for_each(|value| *value /= sites as f64);
    };
    let energy = Quantity::Function(Arc::new(per_spin));
    let names = numbered(&components);
    let (damping, friction) = damping(reading, &components, &[])?;
    let problem = Problem::new(Arc::new(lattice), damping, start.possible(), settings.until)
        .map_err(|error| reading.initial_error(error))?;
    let mean = |axis: usize| {
        let mean = move |y: &[Row], values: &mut Row| {
            *values = [0.0; WIDTH];
            for spin in y[..3 * sites].chunks(3) {
                values.iter_mut().zip(&spin[axis]).for_each(|(sum, s)| *sum += s / sites as f64);
            }
        };
        Observable::new(["mx", "my", "mz"][axis], Quantity::Function(Arc::new(mean)))
    };
    let mut quantities: Vec<Observable> = (0..3).map(mean).collect();
    quantities.push(Observable::new("energy", energy.clone()));
    Ok(Built {
        sizes,
        model: Box::new(AtRunTime {
            problem,
            friction,
            initial: start.law(),
            formulas: None,
            facts: OnceLock::new(),
            flows: OnceLock::new(),
        }),
        names,
        components,
        energy: Some(Further::Quantity(energy)),
        quantities,
    })
}
