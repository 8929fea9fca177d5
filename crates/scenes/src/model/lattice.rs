//! Spins on a lattice.

use std::sync::Arc;

use casimir::{
    formula::{Formula, Tape},
    mc::{Initial, demand},
    noise::StreamKey,
    real::{Row, Rows, WIDTH},
    systems::{
        lattice::{
            Bond, Cell, Couplings, Crystal, Field, LATTICES, Material, Pair, Shape, SpinLattice,
            noise_at_temperature,
        },
        run_time::{Lanes, System, Weights},
    },
};
use keys::*;

use super::{AtRunTime, Built, damping::damping, large::Large, problem, project::valid};

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
pub fn shape(reading: &Reading, default: f64) -> Read<(Vec<usize>, Shape)> {
    let sizes = reading.list("sizes", &[default])?;
    if let Some(size) = sizes.iter().find(|n| n.fract() != 0.0 || !(1.0..=1e6).contains(*n)) {
        refuse!(reading.place("sizes"), "a size is a whole number of at least 1, got {size}");
    }
    let sizes: Vec<usize> = sizes.iter().map(|size| *size as usize).collect();
    let shape = Shape::new(&sizes, reading.switch("periodic", false)?);
    Ok((sizes, reading.checked("sizes", shape)?))
}

/// Refuses more sites than there is memory for, where each takes `bytes`.
pub fn fits(reading: &Reading, sites: usize, bytes: f64) -> Read<()> {
    let enough = demand(format!("a lattice of {sites} sites"), bytes * sites as f64);
    reading.checked("sizes", enough)
}

/// Damping α of each of `each` sites of a cell, and the temperature kT, of the one bath of all
/// spins of a lattice.
pub fn bath(reading: &Reading, each: usize) -> Read<Option<(Vec<f64>, f64)>> {
    let [BathTable { temperature, through, friction, transverse }, more @ ..] = &*reading.file.bath
    else {
        return Ok(None);
    };
    let alone = through.len() + friction.len() + more.len() == 0;
    let of = |name: &str| Some(transverse.iter().find(|(known, _)| known.as_str() == name)?.1);
    let alphas: Option<Vec<_>> = match (of("s"), transverse.len()) {
        (Some(alpha), 1) => Some(vec![alpha; each]),
        (_, given) if given == each => (1..=each).map(|b| of(&format!("s{b}"))).collect(),
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
    const CONSTANT: &str =
        "the temperature and damping of a lattice are constant: write them without t";
    let value = |text: &At<Text>| {
        let value = reading.constants.value(text);
        value.map_err(|wrong| wrong.instead(&["t"], CONSTANT))
    };
    let kt = value(temperature)?;
    if kt < 0.0 {
        refuse!(temperature, "kT must be at least 0, got {kt}");
    }
    let damping = |text: &At<Text>| match value(text)? {
        alpha if alpha > 0.0 => Ok(alpha),
        alpha => refuse!(text, "`transverse` damping must be above 0, got {alpha}"),
    };
    Ok(Some((alphas.into_iter().map(damping).collect::<Read<_>>()?, kt)))
}

/// One number for all of `count`, or a number for each.
fn each(reading: &Reading, name: &str, default: f64, count: usize) -> Read<Vec<f64>> {
    let all = reading.list(name, &[default])?;
    if ![1, count].contains(&all.len()) {
        let each = if count > 1 { format!(" or {count}") } else { String::new() };
        refuse!(reading.place(name), "`{name}` takes 1{each} numbers here, got {}", all.len());
    }
    Ok((0..count).map(|k| all[k % all.len()]).collect())
}

/// The unit cell.
fn cell(reading: &Reading) -> Read<Cell> {
    let name = match reading.get("lattice").map(|at| &**at) {
        None => "cubic",
        Some(Parameter::One(name)) => &name.0,
        Some(_) => "",
    };
    let unknown = || format!("no lattice `{name}`{}", among(name, &LATTICES));
    reading.checked("lattice", Cell::named(name).ok_or_else(unknown))
}

/// The bonds of a cell: exchange and antisymmetric exchange of nearest neighbours, exchange of next
/// ones. Numbers are for all pairs of sites of the cell, or for 11, 12, …, 1n, 22, …
fn bonds(reading: &Reading, cell: &Cell, axes: usize) -> Read<Vec<Bond>> {
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
fn field(reading: &Reading) -> Read<Field> {
    let texts = reading.get("field").map(At::texts).filter(|texts| texts.len() == 3);
    let (texts, names) = (texts.unwrap_or_default(), valid(["t", "x", "y", "z"]));
    let formulas = texts.iter().map(|text| text.formula(&names)).collect::<Read<Vec<_>>>()?;
    let reads: Vec<usize> = formulas.iter().flat_map(Formula::reads).collect();
    if reads.is_empty() {
        return Ok(reading.three("field", [0.0; 3])?.into());
    }
    for (text, formula) in texts.iter().zip(&formulas) {
        text.demand_value(formula, &[0.0; 4], "t = 0 and the origin")?;
    }
    let tape = |of: &Formula| Tape::new(&of.graph, &[of.root], &[0..1, 1..4]);
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
    crystal: Crystal,
    pub moments: Vec<f64>,
    pub settings: Settings,
}

impl Start {
    fn moment(&self, site: usize) -> f64 {
        self.moments[self.crystal.coordinates(site).0]
    }

    /// The spins without what differs from site to site.
    fn given(&self) -> Vec<f64> {
        let given = &self.settings.initial;
        let spins = 0..3 * self.crystal.sites();
        spins.map(|k| given[k % given.len()] * self.moment(k / 3)).collect()
    }

    /// The spins of the first 32 paths.
    fn first(&self) -> Rows {
        let mut rows = Rows::splat(&self.given());
        self.draw(self.settings.key, 0, &mut rows);
        rows
    }

    /// The spins of 32 paths.
    fn draw(&self, key: StreamKey, first: u64, rows: &mut [Row]) {
        let Some(law) = &self.settings.random else { return };
        for (site, spin) in rows.chunks_exact_mut(3).enumerate() {
            spin.copy_from_slice(&self.crystal.place(site).map(|r| [r; WIDTH]));
        }
        (law.draw)(key, first, rows);
        for (site, spin) in rows.chunks_exact_mut(3).enumerate() {
            let moment = self.moment(site);
            spin.as_flattened_mut().iter_mut().for_each(|s| *s *= moment);
        }
    }

    /// The law on 32 paths, if initial values are random.
    fn law(&self) -> Option<Initial<'static>> {
        let (start, law) = (self.clone(), self.settings.random.as_ref()?.law.clone());
        let draw = Arc::new(move |key, first, rows: &mut [Row]| start.draw(key, first, rows));
        Some(Initial { law, draw })
    }

    /// The spins of one large path: each is that of a path of its own of the law, unless states of
    /// all spins come from a file.
    pub fn of_path(&self, path: u64) -> Vec<f64> {
        let Settings { random, states, key, .. } = &self.settings;
        let mut y = self.given();
        let Some(law) = random.as_ref().filter(|_| states.is_none()) else { return y };
        let groups = self.crystal.sites().div_ceil(WIDTH) as u64;
        for (group, spins) in y.chunks_mut(3 * WIDTH).enumerate() {
            let mut rows = [[0.0; WIDTH]; 3];
            for p in 0..spins.len() / 3 {
                let place = self.crystal.place(group * WIDTH + p);
                rows.iter_mut().zip(place).for_each(|(row, r)| row[p] = r);
            }
            (law.draw)(*key, (path * groups + group as u64) * WIDTH as u64, &mut rows);
            for (p, spin) in spins.chunks_exact_mut(3).enumerate() {
                let moment = self.moment(group * WIDTH + p);
                spin.iter_mut().zip(&rows).for_each(|(s, row)| *s = row[p] * moment);
            }
        }
        y
    }

    /// The length of the spins at each site of the cell, which all of `rows` have.
    fn lengths(&self, rows: &[Row]) -> Result<Vec<f64>, [f64; 2]> {
        let mut ends = vec![[f64::INFINITY, 0.0f64]; self.moments.len()];
        for (site, spin) in rows.chunks_exact(3).enumerate() {
            let [least, most] = &mut ends[self.crystal.coordinates(site).0];
            for p in 0..WIDTH {
                let length = spin.iter().map(|s| s[p] * s[p]).sum::<f64>().sqrt();
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
pub fn build(reading: &Reading) -> Read<Built> {
    let (mut sizes, shape) = shape(reading, 8.0)?;
    let cell = cell(reading)?;
    let (each_cell, bonds) = (cell.sites.len(), bonds(reading, &cell, sizes.len())?);
    let materials = vec![Material::default(); each_cell];
    let crystal = Crystal { cell, shape, bonds, materials };
    let (sites, settings) = (crystal.sites(), &reading.settings);
    let is_large = settings.one_by_one && sites >= MANY_SITES && !settings.is_study();
    fits(reading, sites, SITE[usize::from(is_large)])?;
    let start = Start {
        moments: each(reading, "moment", 1.0, each_cell)?,
        crystal: crystal.clone(),
        settings: settings.clone(),
    };
    let (given, dimension) = (settings.initial.len(), 3 * sites);
    let per_spin = given == 3 && !(is_large && settings.states.is_some());
    if !per_spin && given != dimension {
        let words = "the initial value must have";
        refuse!(&settings.initial, "{words} {dimension} components, got {given}");
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
            let rows = if is_large {
                Rows::splat(&start.of_path(0)[..3 * MANY_SITES])
            } else {
                start.first()
            };
            let lengths = start.lengths(&rows).map_err(|[least, most]| {
                let words = format!("spins have lengths from {least} to {most}: give `noise`");
                Wrong::new(temperature, words)
            })?;
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
    let crystal = Crystal { materials: (0..each_cell).map(material).collect(), ..crystal };
    let (field, lanes) = (field(reading)?, if is_large { Lanes::Components } else { Lanes::Paths });
    let is_simple = crystal.cell.name == "cubic"
        && crystal.bonds.iter().all(|bond| bond.antisymmetric == [0.0; 3]);
    let lattice = match field {
        Field::Constant(field) if is_simple && !is_large && reading.place("next").is_none() => {
            let Material { anisotropy, noise, damping } = crystal.materials[0];
            let exchange = reading.number("exchange", 1.0)?;
            let couplings = Couplings { exchange, anisotropy, field, noise, local, damping };
            SpinLattice::on_paths(crystal.shape, couplings)
        }
        field => SpinLattice::new(crystal, field, local, lanes),
    };
    let lattice = reading.checked("sizes", lattice)?;
    if is_large {
        return Large::built(reading, lattice, start);
    }
    let across = 1.min(sizes.len() - 1);
    sizes[across] *= each_cell;
    let spin = |site: usize| ["x", "y", "z"].map(|axis| format!("s{site}{axis}"));
    let names = valid((1..=sites).flat_map(spin));
    let system = lattice.clone();
    let energy = Quantity::smooth(move |y, values| {
        let description = system.description();
        let [dw, mut scratch] = [description.noises, description.scratch_rows()].map(Rows::zero);
        let weights = Weights { dt: 1.0, dw: &dw, ..Weights::NONE };
        system.energy(&y[..dimension], weights, values, &mut scratch);
        values.iter_mut().for_each(|value| *value /= sites as f64);
    });
    let (damping, friction) = damping(reading, names.variables(), &[])?;
    let first = start.first();
    let y0 = first.iter().map(|row| row[0]).collect();
    let problem = problem(reading, Arc::new(lattice), damping, y0)?;
    // Formulas of places give all paths the same.
    let is_random = first.iter().any(|row| row.iter().any(|s| *s != row[0]));
    let mean = |axis: usize| {
        let mean = move |y: &[Row], values: &mut Row| {
            *values = [0.0; WIDTH];
            for spin in y[..dimension].chunks(3) {
                values.iter_mut().zip(&spin[axis]).for_each(|(sum, s)| *sum += s / sites as f64);
            }
        };
        Observable::new(["mx", "my", "mz"][axis], Quantity::smooth(mean))
    };
    let means = (0..3).map(mean);
    let quantities = means.chain([Observable::new("energy", energy.clone())]).collect();
    let initial = start.law().filter(|_| is_random);
    let model = AtRunTime { initial, ..AtRunTime::new(problem, friction, None) };
    let built = Built::new(model, names, Some(Further::Quantity(energy)));
    Ok(Built { sizes, quantities, ..built })
}
