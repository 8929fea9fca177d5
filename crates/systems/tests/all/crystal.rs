//! Lattices of any unit cell: neighbours, energies of ground states, gradients and flows.

use std::{f64::consts::TAU, sync::Arc};

use real::{Row, Rows, WIDTH};
use systems::{
    lattice::{Bond, Cell, Crystal, Field, LATTICES, Material, Shape, SpinLattice},
    run_time::{Lanes, Op, System, Weights},
};

use crate::lattice::number;

type Spin = [f64; 3];

const BOTH: [Lanes; 2] = [Lanes::Paths, Lanes::Components];

/// A crystal with exchange J, and J′ to next neighbours, of one material.
fn crystal(name: &str, sizes: &[usize], periodic: bool, exchanges: [f64; 2]) -> Crystal {
    let cell = Cell::named(name).unwrap();
    let bonds = exchanges.iter().enumerate().filter(|(_, j)| **j != 0.0);
    let bonds = bonds.flat_map(|(shell, &exchange)| {
        let bond = move |pair| Bond { pair, exchange, antisymmetric: [0.0; 3] };
        cell.pairs(sizes.len(), shell).into_iter().map(bond)
    });
    let (bonds, materials) = (bonds.collect(), vec![Material::default(); cell.sites.len()]);
    Crystal { cell, shape: Shape::new(sizes, periodic).unwrap(), bonds, materials }
}

fn rows(system: &dyn System, spins: &[Spin]) -> Rows {
    let layout = system.description().layout;
    let mut rows = Rows::zero(layout.rows);
    for (component, &x) in spins.as_flattened().iter().enumerate() {
        let (row, lane) = layout.place(component);
        match layout.lanes {
            Lanes::Paths => rows[row] = [x; WIDTH],
            Lanes::Components => rows[row][lane] = x,
        }
    }
    rows
}

fn energy(system: &SpinLattice, spins: &[Spin], t: f64) -> f64 {
    let zero = Rows::zero(system.description().layout.noise_rows);
    let mut scratch = Rows::zero(system.description().scratch_rows());
    let h = Weights { t, dt: 1.0, dw: &zero, areas: &[] };
    let mut out = [0.0; WIDTH];
    system.energy(&rows(system, spins), h, &mut out, &mut scratch);
    out[0]
}

/// Energies over the number of spins, of both layouts and of tiles.
fn energies(crystal: &Crystal, spins: &[Spin]) -> [f64; 3] {
    let [a, b] =
        BOTH.map(|lanes| SpinLattice::new(crystal.clone(), [0.0; 3], true, lanes).unwrap());
    let (y, layout) = (rows(&b, spins), b.description().layout);
    let of_tile = |first: usize| {
        let tile = first..(first + layout.tile_rows).min(layout.rows);
        b.energy_of_tile(&y, 0.0, tile, &mut [])
    };
    let tiles: f64 = (0..layout.rows).step_by(layout.tile_rows).map(of_tile).sum();
    [energy(&a, spins, 0.0), energy(&b, spins, 0.0), tiles].map(|e| e / spins.len() as f64)
}

/// Neighbours of the first two shells: Ashcroft and Mermin, *Solid State Physics*, chapter 4, and
/// for the plane lattices by counting on paper.
#[test]
fn ferromagnets_have_the_energy_of_their_neighbours() {
    let rows: [(&str, &[usize], [f64; 2]); 11] = [
        ("cubic", &[9], [2.0, 2.0]),
        ("cubic", &[6, 5], [4.0, 4.0]),
        ("cubic", &[4, 5, 3], [6.0, 12.0]),
        ("bcc", &[4, 3, 5], [8.0, 6.0]),
        ("fcc", &[3, 4, 3], [12.0, 6.0]),
        ("diamond", &[3, 3, 3], [4.0, 12.0]),
        ("triangular", &[6, 5], [6.0, 6.0]),
        ("hexagonal", &[5, 5, 3], [8.0, 12.0]),
        ("honeycomb", &[5, 7], [3.0, 6.0]),
        ("kagome", &[5, 5], [4.0, 4.0]),
        ("hcp", &[5, 5, 5], [12.0, 6.0]),
    ];
    assert!(LATTICES.iter().all(|name| rows.iter().any(|(known, ..)| known == name)));
    for (name, sizes, [first, next]) in rows {
        for exchanges in [[1.3, 0.0], [1.3, -0.4]] {
            let crystal = crystal(name, sizes, true, exchanges);
            let up = vec![[0.6, 0.0, 0.8]; crystal.sites()];
            let expected = -0.5 * (exchanges[0] * first + exchanges[1] * next);
            for found in energies(&crystal, &up) {
                assert!((found - expected).abs() < 1e-12, "{name}: {found} {expected}");
            }
        }
    }
}

/// −3J/2 on the triangular lattice at 120°, −4J on bcc and −3J/2 on honeycombs up and down, and
/// −√(J² + D²) of a spiral that turns by atan(D/J) in each step.
#[test]
fn ground_states_have_their_energies() {
    let angle = |turns: f64| [(TAU * turns).cos(), (TAU * turns).sin(), 0.0];
    let afm = crystal("triangular", &[6, 9], true, [-1.0, 0.0]);
    let spins: Vec<Spin> = (0..afm.sites())
        .map(|site| {
            let (_, [x, y, _]) = afm.coordinates(site);
            angle((x + 2 * y) as f64 / 3.0 * 1.0 + y as f64)
        })
        .collect();
    let mut cases = vec![(afm, spins, -1.5)];
    for (name, sizes, expected) in
        [("bcc", &[3, 3, 3][..], -4.0), ("honeycomb", &[4, 4], -1.5), ("diamond", &[3; 3], -2.0)]
    {
        let afm = crystal(name, sizes, true, [-1.0, 0.0]);
        let up = |site| {
            let (b, _) = afm.coordinates(site);
            [0.0, 0.0, if b < afm.materials.len() / 2 { 1.0 } else { -1.0 }]
        };
        let spins = (0..afm.sites()).map(up).collect();
        cases.push((afm, spins, expected));
    }
    for axis in 0..3 {
        let mut sizes = [3; 3];
        sizes[axis] = 40;
        let mut helix = crystal("cubic", &sizes, true, [1.0, 0.0]);
        let d = (TAU / 40.0).tan();
        for bond in &mut helix.bonds {
            // D along the bond: the spins of its plane turn about it.
            bond.antisymmetric = bond.pair.way.map(|r| -d * r);
        }
        let turned = |site| {
            let (_, cell) = helix.coordinates(site);
            let [cos, sin, _] = angle(cell[axis] as f64 / 40.0);
            let mut s = [0.0; 3];
            (s[(axis + 1) % 3], s[(axis + 2) % 3]) = (cos, sin);
            s
        };
        let spins: Vec<Spin> = (0..helix.sites()).map(turned).collect();
        // Bonds across are parallel.
        cases.push((helix.clone(), spins, -2.0 - (1.0 + d * d).sqrt()));
    }
    for (crystal, spins, expected) in cases {
        for found in energies(&crystal, &spins) {
            assert!((found - expected).abs() < 1e-12, "{}: {found} {expected}", crystal.cell.name);
        }
    }
}

/// Two materials, both shells and D, in a field of time and place.
fn rich(name: &str, sizes: &[usize], periodic: bool) -> Crystal {
    let mut crystal = crystal(name, sizes, periodic, [0.7, -0.3]);
    for (k, bond) in crystal.bonds.iter_mut().enumerate() {
        bond.exchange += 0.01 * (k % 3) as f64;
        bond.antisymmetric = [0, 1, 2].map(|c| 0.3 * number(3 * k + c));
    }
    for (b, material) in crystal.materials.iter_mut().enumerate() {
        let b = b as f64;
        *material = Material { anisotropy: 0.4 - 0.2 * b, noise: 0.3 + 0.1 * b, damping: 0.1 * b };
    }
    crystal
}

fn waves(t: f64, r: &[f64; 3]) -> Spin {
    [(r[0] + 2.0 * t).sin(), 0.3 * r[1], (r[2] - t).cos()]
}

fn field() -> Field {
    let of = |t: f64, r: &[Row; 3], out: &mut [Row], scratch: &mut [Row]| {
        assert!(!scratch.is_empty());
        for p in 0..WIDTH {
            let h = waves(t, &[r[0][p], r[1][p], r[2][p]]);
            (0..3).for_each(|c| out[c][p] = h[c]);
        }
    };
    Field::Of { of: Arc::new(of), depends_on_time: true, scratch_rows: 1 }
}

/// −s × ∇ and the damping, by differences of the energy, which is computed from the bonds.
#[test]
fn gradients_are_those_of_the_energy() {
    for (name, sizes, periodic) in [
        ("hcp", &[5, 6, 5][..], true),
        ("honeycomb", &[9, 5], false),
        ("bcc", &[5, 11, 9], true),
        ("kagome", &[5, 5], true),
        ("cubic", &[5, 6, 7], true),
    ] {
        let crystal = rich(name, sizes, periodic);
        let sites = crystal.sites();
        let spins: Vec<Spin> = (0..sites).map(|i| [0, 1, 2].map(|c| number(3 * i + c))).collect();
        let dw: Vec<Spin> =
            (0..sites).map(|i| [0, 1, 2].map(|c| number(7 * i + 2 * c + 1))).collect();
        let (t, dt) = (0.37, 0.2);
        let systems =
            BOTH.map(|lanes| SpinLattice::new(crystal.clone(), field(), true, lanes).unwrap());
        assert!(systems[0].description().depends_on_time);
        let bits = systems.map(|system| {
            let layout = system.description().layout;
            let (y, dw_rows) = (rows(&system, &spins), rows(&system, &dw));
            let h = Weights { t, dt, dw: &dw_rows, areas: &[] };
            let mut scratch = Rows::zero(system.description().scratch_rows());
            let mut out = Rows::zero(layout.rows);
            for first in (0..layout.rows).step_by(layout.tile_rows) {
                let tile = first..(first + layout.tile_rows).min(layout.rows);
                let out = &mut out[tile.clone()];
                system.apply(Op::Gradient { y: &y }, tile, h, out, &mut scratch);
            }
            (0..sites).map(|site| system.spin(&out, site, 0)).collect::<Vec<_>>()
        });
        assert_eq!(bits[0], bits[1], "{name}");
        let system = SpinLattice::new(crystal.clone(), field(), true, Lanes::Components).unwrap();
        for site in (0..sites).step_by(sites / 8 + 1) {
            let step = 1e-4;
            let at = |c: usize, step: f64| {
                let mut moved = spins.clone();
                moved[site][c] += step;
                energy(&system, &moved, t)
            };
            let s = spins[site];
            let gradient = [0, 1, 2].map(|c| (at(c, step) - at(c, -step)) / (2.0 * step));
            let Material { noise, damping, .. } = crystal.materials[crystal.coordinates(site).0];
            let length = s.iter().map(|s| s * s).sum::<f64>().sqrt();
            for c in 0..3 {
                let [a, b] = [(c + 1) % 3, (c + 2) % 3];
                // ∇H₀ = −F.
                let turned = -(s[a] * gradient[b] - s[b] * gradient[a]);
                let v = gradient[c] * dt - noise * dw[site][c] - damping * dt * turned / length;
                // A quadratic energy of order one for each spin: rounding over the step.
                let error = (v - bits[0][site][c]).abs();
                assert!(error < 1e-10 * sites as f64, "{name}, {site}, {c}: {error:e}");
            }
        }
    }
}

#[test]
fn flows_of_all_bonds_add_up_to_the_field() {
    for (name, sizes, periodic) in [
        ("honeycomb", &[4, 6][..], true),
        ("bcc", &[4, 4, 4], true),
        ("hcp", &[3, 4, 3], false),
        ("kagome", &[4, 4], true),
        ("cubic", &[8], true),
    ] {
        let mut crystal = rich(name, sizes, periodic);
        crystal.bonds.iter_mut().for_each(|bond| bond.antisymmetric = [0.0; 3]);
        crystal.materials.iter_mut().for_each(|of| of.damping = 0.0);
        let h = [0.2, -0.1, 0.3];
        let systems = BOTH.map(|lanes| SpinLattice::new(crystal.clone(), h, false, lanes).unwrap());
        let sites = crystal.sites();
        let spins: Vec<Spin> = (0..sites).map(|i| [0, 1, 2].map(|c| number(3 * i + c))).collect();
        let zero = Rows::zero(3);
        let [first, second] = systems.map(|system| {
            let parts = system.description().parts.as_ref().unwrap().number;
            let start = rows(&system, &spins);
            let (mut y, step) = (start.clone(), 1e-7);
            let weights = Weights { dt: step, dw: &zero, ..Weights::NONE };
            for part in 0..parts {
                system.flow(part, &mut y, weights, &mut []);
            }
            let mut gradient = Rows::zero(start.len());
            let whole = Weights { dt: 1.0, ..weights };
            let tile = 0..system.description().layout.tile_rows.min(start.len());
            system.apply(Op::Gradient { y: &start }, tile, whole, &mut gradient, &mut []);
            for (site, &s) in spins.iter().enumerate() {
                let (v, moved) = (system.spin(&gradient, site, 0), system.spin(&y, site, 0));
                for c in 0..3 {
                    let [a, b] = [(c + 1) % 3, (c + 2) % 3];
                    let field = s[a] * v[b] - s[b] * v[a];
                    // The second order is step·|f|² of at most 12 bonds.
                    assert!(((moved[c] - s[c]) / step - field).abs() < 1e-4, "{name}, {site}");
                }
            }
            (0..sites).map(|site| system.spin(&y, site, 0)).collect::<Vec<_>>()
        });
        assert_eq!(first, second, "{name}");
    }
}

#[test]
fn wrong_crystals_are_refused() {
    let refused = |crystal: Crystal| {
        SpinLattice::new(crystal, [0.0; 3], true, Lanes::Components).unwrap_err().to_string()
    };
    let words = refused(crystal("cubic", &[4], true, [1.0, 0.5]));
    assert!(words.contains("axis 1 is periodic with 4 cells, and bonds reach 2"), "{words}");
    let mut few = crystal("bcc", &[3, 3, 3], true, [1.0, 0.0]);
    few.materials.pop();
    assert!(refused(few).contains("a cell of 2 sites needs 2 materials"));
    let wrong = crystal("bcc", &[3, 3, 3], true, [f64::NAN, 0.0]);
    assert_eq!(refused(wrong), "the exchange J must be finite, got NaN");
    assert!(Cell::named("cube").is_none());
    let parts = |crystal: &Crystal| {
        let system = SpinLattice::new(crystal.clone(), [0.0; 3], true, Lanes::Paths).unwrap();
        system.description().parts.clone().unwrap_err()
    };
    let mut odd = crystal("triangular", &[5, 4], true, [1.0, 0.0]);
    assert!(parts(&odd).contains("axis 1 is periodic with 5 sites"));
    odd.bonds[0].antisymmetric = [0.0, 0.0, 0.1];
    assert!(parts(&odd).contains("antisymmetric exchange"));
}
