//! A report on a system of very many components: identities along random directions.

use std::fmt;

use real::{OutOfMemory, Row, Rows, WIDTH};
use schemes::{Nv, SexpLi};
use serde::Serialize;
use systems::run_time::{Description, Lanes, Layout, Op, System, Weights};

use super::{
    finding::Status,
    points::{Purpose, Random},
};

/// What was found of a large system at points around a state, along random directions. An identity
/// that does not hold in general holds along a random direction with probability zero, but a small
/// defect in one of many components may be below the rounding of a sum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LargeInspection {
    /// The name of the system, and its parameters.
    pub system: String,
    /// The number of components.
    pub dimension: usize,
    /// The number of noises.
    pub noises: usize,
    /// The number of points and directions.
    pub directions: usize,
    /// The identities.
    pub identities: Vec<Identity>,
    /// Why `sexp-li` is not for the system, if it is not.
    pub sexp_li_refused: Option<String>,
    /// Why `nv` is not for the system, if it is not.
    pub nv_refused: Option<String>,
    /// Why `split` is not for the system, if it is not.
    pub split_refused: Option<String>,
}

/// An identity along directions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identity {
    /// The identity in words.
    pub what: String,
    /// Whether it held along all directions.
    pub status: Status,
    /// The largest defect, relative to the sum of the sizes of all terms.
    pub defect: f64,
    /// What is allowed: round-off, and for derivatives the error of a difference quotient.
    pub allowed: f64,
}

/// Points and directions.
const DIRECTIONS: usize = 6;
/// Identities without a difference quotient hold to this part of their terms: some hundred ε.
const ROUNDING: f64 = 1e-13;
/// The step of a central difference, relative to the size of the components, and what its error
/// may be: the third derivative times the step squared, and rounding over the step.
const STEP: f64 = 1e-4;
const QUOTIENT: f64 = 1e-6;

impl LargeInspection {
    /// Whether no identity was refuted.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.identities.iter().all(|identity| identity.status.holds())
    }
}

/// Inspects a system of any size around the state `y0`: B is skew, v is the gradient of h, the
/// derivatives are those of B and v, and the claimed Casimirs are Casimirs.
///
/// # Errors
/// [`OutOfMemory`].
///
/// # Panics
/// Unless `y0` has as many components as the system.
pub fn inspect_large(system: &dyn System, y0: &[f64]) -> Result<LargeInspection, OutOfMemory> {
    assert_eq!(y0.len(), system.description().dimension, "components of a state");
    let mut probe = Probe::new(system)?;
    let mut skew = Check::new("vᵀB(y)v = 0", ROUNDING);
    let mut gradient = Check::new("∇h is the derivative of h", QUOTIENT);
    let mut hessian = Check::new("∇²h·u is the derivative of ∇h", QUOTIENT);
    let mut structure = Check::new("(∂B·u)v is the derivative of B(y)v", QUOTIENT);
    let laws = &system.description().invariants;
    let mut casimirs: Vec<Check> = laws
        .iter()
        .enumerate()
        .map(|(n, law)| {
            Check::new(format!("∇CᵀB = 0 for {}, number {}", law.formula, n + 1), QUOTIENT)
        })
        .collect();
    let mut random = Random::new(Purpose::Points);
    for _ in 0..DIRECTIONS {
        let mut vector = |size: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..y0.len()).map(|i| random.uniform() * size(i)).collect()
        };
        let shift = vector(&|i| 0.1 * (0.1 + y0[i].abs()));
        let y: Vec<f64> = y0.iter().zip(shift).map(|(y, shift)| y + shift).collect();
        if system.check_domain(&y).is_err() {
            continue;
        }
        let (u, v) = (vector(&|i| 0.1 + y0[i].abs()), vector(&|_| 1.0));
        let dt = 0.5 + 0.5 * random.uniform();
        let dw: Vec<f64> = (0..system.description().noises).map(|_| random.uniform()).collect();
        let at = probe.at(&y)?;
        let (along, covector, noise) = (probe.at(&u)?, probe.at(&v)?, probe.noise(&dw)?);
        let h = Weights { dt, dw: &noise, areas: &[] };
        // B and its derivative.
        let turned = probe.structure(&at, &covector)?;
        skew.add(0.0, probe.products(&covector, &turned));
        let [up, down] = [STEP, -STEP].map(|step| moved(&y, &u, step));
        let (up, down) = (probe.at(&up)?, probe.at(&down)?);
        let quotient = |up: &Rows, down: &Rows| -> Result<Rows, OutOfMemory> {
            let mut quotient = Rows::zero(up.len())?;
            for ((q, up), down) in quotient.iter_mut().zip(up.iter()).zip(down.iter()) {
                (0..WIDTH).for_each(|p| q[p] = (up[p] - down[p]) / (2.0 * STEP));
            }
            Ok(quotient)
        };
        let bent = probe.structure_along(&at, &along, &covector)?;
        let expected =
            quotient(&probe.structure(&up, &covector)?, &probe.structure(&down, &covector)?)?;
        structure.compare(&probe, &bent, &expected, &turned);
        // v and its derivative.
        let slope = probe.gradient(&at, h)?;
        let curved = probe.hessian(&at, &along, h)?;
        let expected = quotient(&probe.gradient(&up, h)?, &probe.gradient(&down, h)?)?;
        hessian.compare(&probe, &curved, &expected, &slope);
        if !system.description().is_transverse {
            let difference = (probe.energy(&up, h) - probe.energy(&down, h)) / (2.0 * STEP);
            gradient.add(difference, probe.products(&along, &slope));
        }
        // Casimirs along the field.
        for (n, casimir) in casimirs.iter_mut().enumerate() {
            let field = probe.components(&turned);
            let [up, down] = [STEP, -STEP].map(|step| moved(&y, &field, step));
            let (up, down) = (probe.invariant(n, &up)?, probe.invariant(n, &down)?);
            let size = up.abs() + down.abs() + probe.invariant(n, &y)?.abs();
            casimir.record((up - down).abs() / (2.0 * STEP), size);
        }
    }
    let mut identities = vec![skew, structure, hessian];
    if !system.description().is_transverse {
        identities.push(gradient);
    }
    identities.extend(casimirs);
    let Description { name, parameters, dimension, noises, parts, .. } = system.description();
    Ok(LargeInspection {
        system: format!("{name} ({parameters})"),
        dimension: *dimension,
        noises: *noises,
        directions: DIRECTIONS,
        identities: identities.into_iter().map(Check::finding).collect(),
        sexp_li_refused: SexpLi::at_run_time(system).err().map(|refused| refused.to_string()),
        nv_refused: Nv::at_run_time(system).err().map(|refused| refused.to_string()),
        split_refused: parts.clone().err(),
    })
}

fn moved(y: &[f64], u: &[f64], step: f64) -> Vec<f64> {
    y.iter().zip(u).map(|(y, u)| y + step * u).collect()
}

/// An identity while it is checked.
struct Check {
    what: String,
    allowed: f64,
    worst: f64,
    count: usize,
}

impl Check {
    fn new(what: impl Into<String>, allowed: f64) -> Self {
        Self { what: what.into(), allowed, worst: 0.0, count: 0 }
    }

    /// A defect of an identity whose terms have sizes that sum to `size`.
    fn record(&mut self, defect: f64, size: f64) {
        let relative = if defect == 0.0 { 0.0 } else { defect / size };
        // A NaN is the worst.
        if relative > self.worst || relative.is_nan() {
            self.worst = relative;
        }
        self.count += 1;
    }

    /// The defect of Σ terms = expected.
    fn add(&mut self, expected: f64, (sum, size): (f64, f64)) {
        self.record((sum - expected).abs(), size + expected.abs());
    }

    /// The largest difference of two vectors, one of which follows from values like `origin`.
    fn compare(&mut self, probe: &Probe<'_>, found: &Rows, expected: &Rows, origin: &Rows) {
        let largest = |rows: &Rows| {
            probe.components(rows).into_iter().fold(0.0f64, |largest, x| largest.max(x.abs()))
        };
        let [found_at, expected_at] = [found, expected].map(|rows| probe.components(rows));
        let size = largest(found) + largest(expected) + largest(origin);
        for (found, expected) in found_at.iter().zip(&expected_at) {
            self.record((found - expected).abs(), size);
        }
    }

    fn finding(self) -> Identity {
        let Self { what, allowed, worst, count } = self;
        let status = if count == 0 || worst.is_nan() {
            Status::Unknown
        } else if worst <= allowed {
            Status::Found
        } else {
            Status::Refuted
        };
        Identity { what, status, defect: worst, allowed }
    }
}

/// The operations of a system, tile by tile, on states of one path.
struct Probe<'a> {
    system: &'a dyn System,
    layout: Layout,
    scratch: Rows,
}

impl<'a> Probe<'a> {
    fn new(system: &'a dyn System) -> Result<Self, OutOfMemory> {
        let description = system.description();
        let scratch = Rows::zero(description.scratch_rows())?;
        Ok(Self { system, layout: description.layout, scratch })
    }

    /// A state in rows, on path 0.
    fn at(&self, y: &[f64]) -> Result<Rows, OutOfMemory> {
        if self.layout.lanes == Lanes::Paths {
            return Rows::splat(y);
        }
        let mut rows = Rows::zero(self.layout.rows)?;
        for (component, &y) in y.iter().enumerate() {
            let (row, place) = self.layout.place(component);
            rows[row][place] = y;
        }
        Ok(rows)
    }

    fn noise(&self, dw: &[f64]) -> Result<Rows, OutOfMemory> {
        if self.layout.local_noise { self.at(dw) } else { Rows::splat(dw) }
    }

    fn components(&self, rows: &[Row]) -> Vec<f64> {
        let at = |component| {
            let (row, place) = self.layout.place(component);
            rows[row][place]
        };
        (0..self.system.description().dimension).map(at).collect()
    }

    /// Σ aᵢbᵢ and Σ |aᵢbᵢ|.
    fn products(&self, a: &[Row], b: &[Row]) -> (f64, f64) {
        let terms = self.components(a).into_iter().zip(self.components(b)).map(|(a, b)| a * b);
        terms.fold((0.0, 0.0), |(sum, size), term| (sum + term, size + term.abs()))
    }

    /// The result of an operation on whole states.
    fn apply(&mut self, op: Op<&Rows>, h: Weights<'_>) -> Result<Rows, OutOfMemory> {
        let Layout { rows, tile_rows, .. } = self.layout;
        let (mut out, is_local) = (Rows::zero(rows)?, op.is_local());
        for first in (0..rows).step_by(tile_rows) {
            let tile = first..(first + tile_rows).min(rows);
            let op = op.map(|state| if is_local { &state[tile.clone()] } else { &state[..] });
            self.system.apply(op, tile.clone(), h, &mut out[tile], &mut self.scratch);
        }
        Ok(out)
    }

    fn structure(&mut self, y: &Rows, v: &Rows) -> Result<Rows, OutOfMemory> {
        self.apply(Op::Structure { y, v }, Weights::NONE)
    }

    fn structure_along(&mut self, y: &Rows, u: &Rows, v: &Rows) -> Result<Rows, OutOfMemory> {
        self.apply(Op::StructureAlong { y, u, v }, Weights::NONE)
    }

    fn gradient(&mut self, y: &Rows, h: Weights<'_>) -> Result<Rows, OutOfMemory> {
        self.apply(Op::Gradient { y }, h)
    }

    fn hessian(&mut self, y: &Rows, u: &Rows, h: Weights<'_>) -> Result<Rows, OutOfMemory> {
        self.apply(Op::Hessian { y, u }, h)
    }

    fn energy(&mut self, y: &Rows, h: Weights<'_>) -> f64 {
        let mut out = [0.0; WIDTH];
        self.system.energy(y, h, &mut out, &mut self.scratch);
        self.of_row(&out)
    }

    fn invariant(&mut self, index: usize, y: &[f64]) -> Result<f64, OutOfMemory> {
        let (y, mut out) = (self.at(y)?, [0.0; WIDTH]);
        self.system.invariant(index, &y, &mut out, &mut self.scratch);
        Ok(self.of_row(&out))
    }

    /// The number of path 0, or the sum over the row of one path.
    fn of_row(&self, row: &Row) -> f64 {
        match self.layout.lanes {
            Lanes::Paths => row[0],
            Lanes::Components => row.iter().sum(),
        }
    }
}

impl fmt::Display for LargeInspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.system)?;
        writeln!(
            f,
            "{} components, {} noises; {} points and directions",
            self.dimension, self.noises, self.directions
        )?;
        for Identity { what, status, defect, allowed } in &self.identities {
            let word = status.name();
            writeln!(f, "{what}: {word}, to {defect:.1e} of its terms (allowed {allowed:.0e})")?;
        }
        for (scheme, refused) in [
            ("sexp-li", &self.sexp_li_refused),
            ("nv", &self.nv_refused),
            ("split", &self.split_refused),
        ] {
            match refused {
                None => writeln!(f, "{scheme} is for it")?,
                Some(reason) => writeln!(f, "{scheme} is not for it: {reason}")?,
            }
        }
        Ok(())
    }
}
