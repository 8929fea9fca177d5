//! Compiled systems through the trait of systems known at run time.

use std::{cmp::Ordering, ops::Range};

use dgrad::Rule;
use real::{Row, Rows, WIDTH};
use systems::{
    LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody, area_gradient,
    ito_correction,
    run_time::{Compiled, Description, Op, System, Weights, derived},
    vector_field_derivative,
};

/// States near y0, one for each path.
fn around(y0: &[f64], spread: f64, shift: usize) -> Rows {
    let mut rows = Rows::splat(y0);
    for (i, row) in rows.iter_mut().enumerate() {
        for p in 0..WIDTH {
            let number = ((i + 7 * p + shift) as f64 * 0.618_033_988_749_894_9).fract();
            row[p] += spread * (2.0 * number - 1.0);
        }
    }
    rows
}

fn path<const N: usize>(rows: &[Row], p: usize) -> [f64; N] {
    std::array::from_fn(|i| rows[i][p])
}

/// Compares with the system itself: equal where the adapter calls it, to `rounding` where methods
/// are derived from B, ∇h and their derivatives.
fn check<S, const D: usize, const M: usize>(system: S, y0: [f64; D], rounding: f64)
where
    S: PoissonSystem<D, M> + Copy,
{
    let adapter = Compiled::new(system, y0);
    let mut scratch = Rows::zero(adapter.description().scratch_rows());
    let (a, b) = (around(&y0, 0.1, 0), around(&y0, 0.1, 1000));
    let (u, dw) = (around(&[0.0; D], 1.0, 77), around(&[0.0; M], 0.1, 5));
    let areas = around(&vec![0.0; M * M], 1.0, 99);
    let h = Weights { dt: 0.03, dw: &dw, areas: &areas, ..Weights::NONE };
    let each = |found: &[Row], expected: &dyn Fn(usize) -> [f64; D], rounding: f64| {
        for p in 0..WIDTH {
            let (found, expected) = (path::<D>(found, p), expected(p));
            for i in 0..D {
                let error = (found[i] - expected[i]).abs();
                assert!(error <= rounding, "{} {i} {p}: {error:e}", system.name());
            }
        }
    };
    let (a, b, u): (&[Row], &[Row], &[Row]) = (&a, &b, &u);
    let mut apply = |op: Op<&[Row]>| {
        let mut out = Rows::zero(D);
        adapter.apply(op, 0..D, h, &mut out, &mut scratch);
        out
    };
    let turned = apply(Op::Structure { y: a, v: u });
    each(&turned, &|p| system.structure(path(a, p), path(u, p)), 0.0);
    let gradient = apply(Op::Gradient { y: a });
    each(&gradient, &|p| system.gradient(path(a, p), h.dt, path(&dw, p)), 0.0);
    let averaged = |p| system.averaged_gradient(path(a, p), path(b, p), h.dt, path(&dw, p));
    each(&apply(Op::AveragedGradient { a, b }), &averaged, 0.0);
    let field = |p| system.averaged_field(path(a, p), path(b, p), h.dt, path(&dw, p));
    each(&apply(Op::AveragedField { a, b }), &field, 0.0);
    let ito = |p| ito_correction(&system, path(a, p));
    each(&apply(Op::ItoCorrection { y: a }), &ito, 0.0);
    let skew = |p: usize| -> [[f64; M]; M] {
        let area = |m: usize, l: usize| areas[m * M + l][p];
        std::array::from_fn(|m| {
            std::array::from_fn(|l| match m.cmp(&l) {
                Ordering::Less => area(m, l),
                Ordering::Equal => 0.0,
                Ordering::Greater => -area(l, m),
            })
        })
    };
    let of_areas = |p| area_gradient(&system, path(a, p), skew(p));
    each(&apply(Op::AreaGradient { y: a }), &of_areas, 0.0);

    // The derivative of B∇h along u is (∂B·u)∇h + B∇²h·u, and that of ∇̄h a difference quotient.
    let bent = apply(Op::StructureAlong { y: a, u, v: &gradient });
    let curved = apply(Op::Hessian { y: a, u });
    let mut slope = apply(Op::Structure { y: a, v: &curved });
    slope.iter_mut().flatten().zip(bent.iter().flatten()).for_each(|(x, bent)| *x += bent);
    let along = |p| vector_field_derivative(&system, path(a, p), h.dt, path(&dw, p), path(u, p));
    each(&slope, &along, rounding);
    let slope = apply(Op::AveragedHessian { a, b, u });

    let mut energy = [0.0; WIDTH];
    adapter.energy(a, h, &mut energy, &mut scratch);
    assert_eq!(energy[9], system.energy(path(a, 9), h.dt, path(&dw, 9)));
    let mut derived = |op| {
        let mut out = Rows::zero(D);
        derived(&adapter as &dyn System, op, h, &mut out, &mut scratch);
        out
    };
    each(&derived(Op::AveragedGradient { a, b }), &averaged, rounding);
    each(&derived(Op::AveragedField { a, b }), &field, rounding);

    let step = 1e-5;
    let quotient = |p| {
        let (a, b, u): ([f64; D], [f64; D], [f64; D]) = (path(a, p), path(b, p), path(u, p));
        let moved = |s: f64| {
            let b = std::array::from_fn(|i| b[i] + s * u[i]);
            system.averaged_gradient(a, b, h.dt, path(&dw, p))
        };
        let (plus, minus): ([f64; D], [f64; D]) = (moved(step), moved(-step));
        std::array::from_fn(|i| (plus[i] - minus[i]) / (2.0 * step))
    };
    // Truncation step², rounding ε/step.
    each(&slope, &quotient, 1e-9);
}

#[test]
fn the_adapter_has_the_bits_of_the_system() {
    check(Pendulum::new(1.0).unwrap(), [0.3, 1.0], 1e-15);
    check(
        RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0]).unwrap(),
        [0.6, 0.3, 0.8],
        2e-15,
    );
    check(MaxwellBloch, [1.0, 0.4, 0.7], 2e-15);
    let lotka_volterra = LotkaVolterra::<1, 1>::new(1.0).unwrap();
    check(lotka_volterra, [1.0, 1.9, 0.5], 1e-14);
    check(Poisson3::new(1.0).unwrap(), [1.0, 2.0, 3.0], 1e-13);
}

/// H = ½y₁⁶ + y₁y₂⁵ in the plane, whose gradient three nodes average exactly.
struct Sixth(Description);

impl System for Sixth {
    fn description(&self) -> &Description {
        &self.0
    }
    fn apply(
        &self,
        op: Op<&[Row]>,
        _: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        let Op::Gradient { y } = op else { return derived(self, op, h, out, scratch) };
        for p in 0..WIDTH {
            let [a, b] = [y[0][p], y[1][p]];
            out[0][p] = h.dt * (3.0 * a.powi(5) + b.powi(5));
            out[1][p] = h.dt * 5.0 * a * b.powi(4);
        }
    }
    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, _: &mut [Row]) {
        for p in 0..WIDTH {
            out[p] = h.dt * (0.5 * y[0][p].powi(6) + y[0][p] * y[1][p].powi(5));
        }
    }
}

#[test]
fn an_odd_number_of_nodes_averages_to_the_change_of_energy() {
    let system = Sixth(Description::new("sixth", 2, 0, Rule::new(3).unwrap()));
    let h = Weights { dt: 0.7, ..Weights::NONE };
    let mut scratch = Rows::zero(system.description().scratch_rows());
    let (a, b) = (around(&[0.5, 1.0], 0.4, 0), around(&[0.9, 0.3], 0.4, 50));
    let (mut mean, mut before, mut after) = (Rows::zero(2), [0.0; WIDTH], [0.0; WIDTH]);
    let op = Op::AveragedGradient { a: &a[..], b: &b[..] };
    system.apply(op, 0..2, h, &mut mean, &mut scratch);
    system.energy(&a, h, &mut before, &mut scratch);
    system.energy(&b, h, &mut after, &mut scratch);
    for p in 0..WIDTH {
        let change: f64 = (0..2).map(|i| mean[i][p] * (b[i][p] - a[i][p])).sum();
        // Terms are below 8.
        assert!((change - (after[p] - before[p])).abs() < 64.0 * f64::EPSILON, "{p}: {change}");
    }
}
