//! A system from texts behind the functions that the checks need.

use formula::FormulaSystem;
use real::{Bounded, Dual, Real};
use schemes::{Nv, SexpLi, run_time::Scheme};
use systems::{Invariant, run_time};

use super::{
    advice::{Override, WithoutIteration},
    algebra::{Matrix, axis, transposed},
    erased::{Function, System, values},
};

/// A [`System`] from a [`FormulaSystem`].
pub struct OfFormulas<'a>(pub(super) &'a FormulaSystem);

fn variables(y: &[f64]) -> Vec<Bounded> {
    y.iter().copied().map(Bounded::variable).collect()
}

/// Numbers with a derivative along a direction.
fn along<R: Real>(y: &[R], direction: &[R]) -> Vec<Dual<R>> {
    y.iter().zip(direction).map(|(&y, &u)| Dual::new(y, u)).collect()
}

/// Numbers with derivative 1 in component l.
fn seeded<R: Real>(y: &[R], l: usize) -> Vec<Dual<R>> {
    let one = |(i, &y)| if i == l { Dual::variable(y) } else { Dual::fixed(y) };
    y.iter().enumerate().map(one).collect()
}

fn derivatives<R: Real>(y: &[Dual<R>]) -> Vec<R> {
    y.iter().map(|component| component.derivative()).collect()
}

/// ∇h.
fn gradient<R: Real>(system: &FormulaSystem, y: &[R], weights: &[f64]) -> Vec<R> {
    let slope = |l| system.energy_of(&seeded(y, l), weights).derivative();
    (0..y.len()).map(slope).collect()
}

/// B∇h.
fn field<R: Real>(system: &FormulaSystem, y: &[R], weights: &[f64]) -> Vec<R> {
    system.structure_of(y, &gradient(system, y, weights))
}

/// h for some weights.
struct Energy<'a> {
    system: &'a FormulaSystem,
    weights: Vec<f64>,
}

impl Function for Energy<'_> {
    fn value(&self, y: &[f64]) -> Bounded {
        values(|| vec![self.system.energy_of(&variables(y), &self.weights)])[0]
    }
    fn gradient(&self, y: &[f64]) -> Vec<Bounded> {
        values(|| gradient(self.system, &variables(y), &self.weights))
    }
    fn hessian(&self, y: &[f64]) -> Matrix<Bounded> {
        let row = |l| {
            values(|| derivatives(&gradient(self.system, &seeded(&variables(y), l), &self.weights)))
        };
        (0..y.len()).map(row).collect()
    }
}

impl OfFormulas<'_> {
    fn description(&self) -> &run_time::Description {
        run_time::System::description(self.0)
    }
}

impl System for OfFormulas<'_> {
    fn name(&self) -> &str {
        &self.description().name
    }
    fn dimension(&self) -> usize {
        self.description().dimension
    }
    fn noises(&self) -> usize {
        self.description().noises
    }
    fn in_domain(&self, y: &[f64]) -> bool {
        run_time::System::check_domain(self.0, y).is_ok()
    }
    fn piecewise(&self, y: &[f64]) -> bool {
        let weights = vec![1.0; 1 + self.noises()];
        Bounded::piecewise(|| field(self.0, &variables(y), &weights)).1
    }
    fn structure(&self, y: &[f64], v: &[Bounded]) -> Vec<Bounded> {
        values(|| self.0.structure_of(&variables(y), v))
    }
    fn matrix_derivatives(&self, y: &[f64]) -> Vec<Matrix<Bounded>> {
        let d = self.dimension();
        let unit = |j| -> Vec<Dual<Bounded>> {
            axis(d, j).into_iter().map(|x| Dual::fixed(Bounded::exact(x))).collect()
        };
        let column = |l, j| {
            values(|| derivatives(&self.0.structure_of(&seeded(&variables(y), l), &unit(j))))
        };
        (0..d).map(|l| transposed(&(0..d).map(|j| column(l, j)).collect())).collect()
    }
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_> {
        Box::new(Energy { system: self.0, weights: weights.into() })
    }
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<Bounded> {
        values(|| gradient(self.0, &variables(y), weights))
    }
    fn averages(&self, a: &[f64], b: &[f64], weights: &[f64]) -> [Vec<Bounded>; 2] {
        let rule = &self.description().rule;
        let (a, b) = (variables(a), variables(b));
        let averaged = || {
            let mut sum = vec![Bounded::exact(0.0); a.len()];
            for (&node, &weight) in rule.nodes().iter().zip(rule.weights()) {
                let at: Vec<Bounded> =
                    a.iter().zip(&b).map(|(&a, &b)| a * (1.0 - node) + b * node).collect();
                let gradient = gradient(self.0, &at, weights);
                sum.iter_mut().zip(gradient).for_each(|(sum, x)| *sum = *sum + x * weight);
            }
            sum
        };
        let middle = || a.iter().zip(&b).map(|(&a, &b)| (a + b) * 0.5).collect::<Vec<_>>();
        [values(averaged), values(|| self.0.structure_of(&middle(), &averaged()))]
    }
    fn predict(&self, a: &[f64], _: &[f64]) -> (Vec<f64>, f64) {
        (a.into(), f64::INFINITY)
    }
    fn field(&self, y: &[f64], weights: &[f64]) -> (Vec<Bounded>, Matrix<Bounded>) {
        let column = |l| values(|| derivatives(&field(self.0, &seeded(&variables(y), l), weights)));
        let columns: Matrix<Bounded> = (0..self.dimension()).map(column).collect();
        (values(|| field(self.0, &variables(y), weights)), transposed(&columns))
    }
    fn commutators(&self, y: &[f64], areas: &Matrix) -> Vec<Bounded> {
        values(|| {
            let y = variables(y);
            let mut sum = vec![Bounded::exact(0.0); y.len()];
            for l in 0..self.noises() {
                let others: Vec<f64> =
                    std::iter::once(0.0).chain(areas.iter().map(|row| row[l])).collect();
                let direction = field(self.0, &y, &others);
                let unit = axis(1 + self.noises(), 1 + l);
                let moved = derivatives(&field(self.0, &along(&y, &direction), &unit));
                sum.iter_mut().zip(moved).for_each(|(sum, x)| *sum = *sum + x);
            }
            sum
        })
    }
    fn without_iteration(&self, _: &[f64]) -> WithoutIteration {
        let scheme = SexpLi::at_run_time(self.0);
        WithoutIteration {
            structure: self.description().linearity,
            truncates: scheme.as_ref().is_ok_and(Scheme::clips_increments),
            refused: scheme.err().map(|refused| refused.to_string()),
            areas_refused: Some("Lévy areas are not drawn for systems known at run time".into()),
            nv_refused: Nv::at_run_time(self.0).err().map(|refused| refused.to_string()),
            draws_areas: false,
        }
    }
    fn overrides(&self, _: &[Vec<f64>]) -> Vec<Override> {
        Vec::new()
    }
    fn invariants(&self) -> Vec<(Invariant, Box<dyn Function + '_>)> {
        Vec::new()
    }
}
