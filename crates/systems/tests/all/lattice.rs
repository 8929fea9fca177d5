//! Spin lattices against formulas written out spin by spin, in both layouts.

use real::{Row, Rows, WIDTH};
use systems::{
    lattice::{Couplings, Shape, SpinLattice, noise_at_temperature},
    run_time::{Op, System, Weights},
};

type Spin = [f64; 3];

/// Numbers in [−1, 1), by multiples of the golden ratio.
pub fn number(n: usize) -> f64 {
    2.0 * (n as f64 * 0.618_033_988_749_894_9 + 0.1).fract() - 1.0
}

fn spins(sites: usize, first: usize) -> Vec<Spin> {
    (0..sites).map(|i| [0, 1, 2].map(|c| number(first + 5 * (3 * i + c)))).collect()
}

/// Vectors in the rows of a system, the same on all paths.
fn rows(system: &dyn System, vectors: &[Spin]) -> Rows {
    let layout = system.description().layout;
    let mut rows = Rows::zero(layout.rows);
    for (component, &x) in vectors.as_flattened().iter().enumerate() {
        let (row, lane) = layout.place(component);
        rows[row][lane] = x;
        if lane == 0 && layout.rows == system.description().dimension {
            rows[row] = [x; WIDTH];
        }
    }
    rows
}

fn vectors(system: &dyn System, rows: &[Row]) -> Vec<Spin> {
    let layout = system.description().layout;
    let at = |component| {
        let (row, lane) = layout.place(component);
        rows[row][lane]
    };
    (0..system.description().dimension / 3).map(|i| [0, 1, 2].map(|c| at(3 * i + c))).collect()
}

fn cross(a: Spin, b: Spin) -> Spin {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Spin, b: Spin) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Every bond of a lattice once, found from coordinates.
fn bonds(sizes: [usize; 3], periodic: bool) -> Vec<(usize, usize)> {
    let site = |at: [usize; 3]| at[0] + sizes[0] * (at[1] + sizes[1] * at[2]);
    let mut bonds = Vec::new();
    for z in 0..sizes[2] {
        for y in 0..sizes[1] {
            for x in 0..sizes[0] {
                for axis in 0..3 {
                    let mut next = [x, y, z];
                    next[axis] += 1;
                    if next[axis] == sizes[axis] {
                        if !periodic || sizes[axis] < 3 {
                            continue;
                        }
                        next[axis] = 0;
                    }
                    bonds.push((site([x, y, z]), site(next)));
                }
            }
        }
    }
    bonds
}

/// The vector v of the lattice, and h.
fn by_hand(
    bonds: &[(usize, usize)],
    k: &Couplings,
    s: &[Spin],
    dt: f64,
    dw: &dyn Fn(usize) -> Spin,
) -> (Vec<Spin>, f64) {
    let mut field = vec![k.field; s.len()];
    let mut energy = 0.0;
    for &(i, j) in bonds {
        energy -= k.exchange * dot(s[i], s[j]) * dt;
        for c in 0..3 {
            field[i][c] += k.exchange * s[j][c];
            field[j][c] += k.exchange * s[i][c];
        }
    }
    let v = (0..s.len()).map(|i| {
        energy -= 0.5 * k.anisotropy * s[i][2] * s[i][2] * dt;
        energy -= dot(k.field, s[i]) * dt + k.noise * dot(dw(i), s[i]);
        field[i][2] += k.anisotropy * s[i][2];
        let turned = cross(s[i], field[i]);
        let length = dot(s[i], s[i]).sqrt();
        [0, 1, 2]
            .map(|c| -field[i][c] * dt - k.noise * dw(i)[c] - k.damping * dt * turned[c] / length)
    });
    let v = v.collect();
    (v, energy)
}

fn near(found: &[Spin], expected: &[Spin], tolerance: f64, what: &str) {
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        for c in 0..3 {
            let error = (found[c] - expected[c]).abs();
            assert!(error <= tolerance, "{what}, spin {i}: {found:?} {expected:?}");
        }
    }
}

/// All rows of a result, tile by tile.
fn tiles(system: &dyn System, op: Op<&Rows>, h: Weights<'_>) -> Rows {
    let layout = system.description().layout;
    let mut out = Rows::zero(layout.rows);
    for first in (0..layout.rows).step_by(layout.tile_rows) {
        let tile = first..(first + layout.tile_rows).min(layout.rows);
        let is_local = op.is_local();
        let op = op.map(|rows| if is_local { &rows[tile.clone()] } else { &rows[..] });
        system.apply(op, tile.clone(), h, &mut out[tile], &mut []);
    }
    out
}

#[test]
fn both_layouts_are_the_lattice_spin_by_spin() {
    let sizes: [&[usize]; 13] = [
        &[1],
        &[2],
        &[3],
        &[31],
        &[32],
        &[33],
        &[100],
        &[2500],
        &[7, 5],
        &[40, 33],
        &[3, 4, 5],
        &[12, 11, 10],
        &[33, 2, 40],
    ];
    let tolerance = 64.0 * f64::EPSILON;
    for (n, sizes) in sizes.iter().enumerate() {
        for periodic in [false, true] {
            for (local, damping) in [(false, 0.0), (true, 0.3)] {
                let shape = if periodic { Shape::periodic(sizes) } else { Shape::open(sizes) };
                let shape = shape.unwrap();
                let k = Couplings {
                    exchange: 1.3,
                    anisotropy: 0.7,
                    field: [0.1, -0.2, 0.4],
                    noise: 0.8,
                    local,
                    damping,
                };
                let bonds = bonds(shape.sizes(), periodic);
                let sites = shape.sites();
                let (s, u, w) = (spins(sites, n), spins(sites, 1000), spins(sites, 2000));
                let dt = 0.2;
                let dw = |i: usize| if local { w[i] } else { w[0] };
                let (v, energy) = by_hand(&bonds, &k, &s, dt, &dw);
                let systems = [
                    SpinLattice::on_paths(shape.clone(), k).unwrap(),
                    SpinLattice::one_path(shape, k).unwrap(),
                ];
                let mut first = None;
                for system in &systems {
                    let layout = system.description().layout;
                    let what = format!("{} of {}", system.description().parameters, layout.rows);
                    let y = rows(system, &s);
                    let dw = if local { rows(system, &w) } else { Rows::splat(&w[0]) };
                    let h = Weights { dt, dw: &dw, ..Weights::NONE };
                    let gradient = tiles(system, Op::Gradient { y: &y }, h);
                    near(&vectors(system, &gradient), &v, tolerance, &what);
                    let turned = tiles(system, Op::Structure { y: &y, v: &gradient }, h);
                    let expected: Vec<Spin> =
                        s.iter().zip(&v).map(|(&s, &v)| cross(s, v)).collect();
                    near(&vectors(system, &turned), &expected, tolerance, &what);
                    let mut sum = [0.0; WIDTH];
                    system.energy(&y, h, &mut sum, &mut []);
                    assert!((sum[0] - energy).abs() < tolerance * (1.0 + sites as f64), "{what}");
                    // The derivative along u, by a central difference.
                    let moved = |step: f64| {
                        let moved = |(s, u): (&Spin, &Spin)| [0, 1, 2].map(|c| s[c] + step * u[c]);
                        let moved: Vec<Spin> = s.iter().zip(&u).map(moved).collect();
                        by_hand(&bonds, &k, &moved, dt, &|_| [0.0; 3]).0
                    };
                    let step = 1e-5;
                    let (up, down) = (moved(step), moved(-step));
                    let quotient =
                        |(a, b): (&Spin, &Spin)| [0, 1, 2].map(|c| (a[c] - b[c]) / (2.0 * step));
                    let expected: Vec<Spin> = up.iter().zip(&down).map(quotient).collect();
                    let along = rows(system, &u);
                    let hessian = tiles(system, Op::Hessian { y: &y, u: &along }, h);
                    // Third derivatives of 1/|s| at |s| ≥ 0.1, times step².
                    near(&vectors(system, &hessian), &expected, 1e-6, &what);
                    // Both layouts compute in the same order.
                    let bits = (vectors(system, &gradient), vectors(system, &hessian));
                    assert_eq!(*first.get_or_insert(bits.clone()), bits, "{what}");
                    // Nothing is where no spin is.
                    let count = |rows: &[Row]| rows.iter().flatten().filter(|x| **x != 0.0).count();
                    assert!(
                        count(&turned)
                            <= 3 * sites * if layout.rows == 3 * sites { WIDTH } else { 1 }
                    );
                }
            }
        }
    }
}

/// ∇Σ A_ml {Hₘ, H_l} over m < l, where Hₘ = −σ Σ sᵢₘ and {sₘ, s_l} = s·(e_l × eₘ).
#[test]
fn areas_of_common_noise_turn_all_spins() {
    let k = Couplings { exchange: 1.3, noise: 0.8, ..Couplings::default() };
    let area = [[0.0, 0.3, 0.5], [0.0, 0.0, 0.7], [0.0; 3]];
    let axis = |m: usize| std::array::from_fn(|c| f64::from(u8::from(c == m)));
    let shape = Shape::open(&[5]).unwrap();
    let systems = [SpinLattice::on_paths(shape.clone(), k), SpinLattice::one_path(shape, k)]
        .map(Result::unwrap);
    for system in &systems {
        let y = rows(system, &spins(5, 3));
        // As both layouts have them, by rows.
        let areas = Rows::splat(area.as_flattened());
        let h = Weights { areas: &areas, ..Weights::NONE };
        let found = vectors(system, &tiles(system, Op::AreaGradient { y: &y }, h));
        let mut expected = [0.0; 3];
        for (m, l) in [(0, 1), (0, 2), (1, 2)] {
            let turned = cross(axis(l), axis(m));
            (0..3).for_each(|c| expected[c] += 0.64 * area[m][l] * turned[c]);
        }
        near(&found, &[expected; 5], 4.0 * f64::EPSILON, "areas");
    }
}

#[test]
fn flows_turn_spins_and_lengths_stay() {
    let k = Couplings {
        exchange: -0.6,
        anisotropy: 0.9,
        field: [0.3, 0.0, 0.1],
        noise: 0.4,
        local: true,
        damping: 0.0,
    };
    for (shape, periodic) in [
        (Shape::periodic(&[6, 4]), true),
        (Shape::open(&[5, 4]), false),
        (Shape::open(&[3, 4]), false),
    ] {
        let shape = shape.unwrap();
        let (s, w) = (spins(shape.sites(), 3), spins(shape.sites(), 17));
        let (v, _) = by_hand(&bonds(shape.sizes(), periodic), &k, &s, 1.0, &|i| w[i]);
        let systems = [
            SpinLattice::on_paths(shape.clone(), k).unwrap(),
            SpinLattice::one_path(shape, k).unwrap(),
        ];
        let ends = systems.map(|system| {
            let mut y = rows(&system, &s);
            let dw = rows(&system, &w);
            // Field and noise, anisotropy, and two parts for each axis.
            assert_eq!(system.description().parts.as_ref().map(|parts| parts.number), Ok(6));
            // To first order the flows add up to B∇h.
            let step = 1e-7;
            let small: Vec<Spin> = w.iter().map(|w| w.map(|w| w * step)).collect();
            let small = rows(&system, &small);
            let mut moved = rows(&system, &s);
            for part in 0..6 {
                system.flow(part, &mut y, Weights { dt: 0.3, dw: &dw, ..Weights::NONE }, &mut []);
                let h = Weights { dt: step, dw: &small, ..Weights::NONE };
                system.flow(part, &mut moved, h, &mut []);
            }
            for (i, moved) in vectors(&system, &moved).into_iter().enumerate() {
                let field = cross(s[i], v[i]);
                for c in 0..3 {
                    // The second order is step·|f|² ≈ 1e-6.
                    assert!(((moved[c] - s[i][c]) / step - field[c]).abs() < 1e-5, "spin {i}");
                }
            }
            for (s, y) in s.iter().zip(vectors(&system, &y)) {
                assert!((dot(y, y) / dot(*s, *s) - 1.0).abs() < 64.0 * f64::EPSILON);
            }
            vectors(&system, &y)
        });
        assert_eq!(ends[0], ends[1]);
    }
}

#[test]
fn sixteen_spins_have_an_invariant_each_and_more_have_their_sum() {
    for (sites, index) in [(16, 5), (17, 0)] {
        let k = Couplings { exchange: 1.0, ..Couplings::default() };
        let system = SpinLattice::on_paths(Shape::open(&[sites]).unwrap(), k).unwrap();
        let s = spins(sites, 3);
        let mut found = [0.0; WIDTH];
        system.invariant(index, &rows(&system, &s), &mut found, &mut []);
        let all = if sites > 16 { &s[..] } else { &s[index..=index] };
        let exact: f64 = all.iter().map(|&s| 0.5 * dot(s, s)).sum();
        assert!((found[0] / exact - 1.0).abs() < 64.0 * f64::EPSILON, "{sites}");
    }
}

#[test]
fn wrong_lattices_are_refused() {
    let k = Couplings { exchange: 1.0, noise: 0.1, ..Couplings::default() };
    for sizes in [&[][..], &[0], &[3, 0], &[1, 2, 3, 4], &[usize::MAX, 2], &[1 << 49]] {
        let error = Shape::open(sizes).unwrap_err();
        assert!(error.0.ends_with(&format!("got {sizes:?}")), "{error}");
    }
    let shape = Shape::periodic(&[4, 5]).unwrap();
    let nan = Couplings { anisotropy: f64::NAN, ..k };
    let error = SpinLattice::on_paths(shape.clone(), nan).unwrap_err().to_string();
    assert_eq!(error, "the anisotropy K must be finite, got NaN");
    let odd = SpinLattice::one_path(shape, k).unwrap().description().parts.clone().unwrap_err();
    assert!(odd.contains("axis 2 is periodic with 5 sites"), "{odd}");
    let damped = Couplings { damping: 0.1, ..k };
    let lattice = SpinLattice::one_path(Shape::open(&[4]).unwrap(), damped).unwrap();
    assert!(lattice.description().parts.is_err());
}

#[test]
fn the_noise_at_a_temperature() {
    assert_eq!(noise_at_temperature(0.5, 4.0), 2.0);
}
