//! What is measured of a lattice, beside sums over its spins one by one.

use std::{f64::consts::TAU, sync::Arc};

use lattice::{Follow, LargePath, Means, Record, Spectra};
use mc::{
    Checkpoint,
    parts::{Program, Stop},
};
use noise::{StreamKey, Truncation};
use real::{Row, Rows};
use schemes::SexpLi;
use systems::{
    Constant,
    lattice::{Bond, Cell, Crystal, Material, Shape, SpinLattice, noise_at_temperature},
    run_time::{Lanes, Problem, System},
};

use crate::on_threads;

type Spin = [f64; 3];

/// A crystal with J between nearest neighbours, and materials.
fn crystal(name: &str, sizes: &[usize], periodic: bool, of: &[Material]) -> Crystal {
    let cell = Cell::named(name).unwrap();
    let bond = |pair| Bond { pair, exchange: 1.0, antisymmetric: [0.0; 3] };
    let bonds = cell.pairs(sizes.len(), 0).into_iter().map(bond).collect();
    let materials = of.iter().copied().cycle().take(cell.sites.len()).collect();
    Crystal { cell, shape: Shape::new(sizes, periodic).unwrap(), bonds, materials }
}

fn lattice(crystal: Crystal, field: Spin) -> SpinLattice {
    SpinLattice::new(crystal, field, true, Lanes::Components).unwrap()
}

fn state(lattice: &SpinLattice, of: impl Fn(usize) -> Spin) -> Rows {
    let layout = lattice.description().layout;
    let mut rows = Rows::zero(layout.rows);
    for site in 0..lattice.crystal().sites() {
        for (c, s) in of(site).into_iter().enumerate() {
            let (row, lane) = layout.place(3 * site + c);
            rows[row][lane] = s;
        }
    }
    rows
}

fn number(n: usize) -> f64 {
    2.0 * (n as f64 * 0.618_033_988_749_894_9 + 0.1).fract() - 1.0
}

fn dot(a: Spin, b: Spin) -> f64 {
    (0..3).map(|c| a[c] * b[c]).sum()
}

#[test]
fn means_and_spectra_are_sums_over_spins() {
    for (name, sizes, periodic) in [
        ("cubic", &[70][..], true),
        ("cubic", &[33, 40], false),
        ("hcp", &[5, 6, 7], true),
        ("bcc", &[9, 8, 5], false),
    ] {
        let lattice = lattice(crystal(name, sizes, periodic, &[Material::default()]), [0.1; 3]);
        let crystal = lattice.crystal();
        let sites = crystal.sites();
        let of = |site: usize| [0, 1, 2].map(|c| number(3 * site + c) + 0.2);
        let y = state(&lattice, of);
        let [means, spectra] = [1, 2].map(|threads| {
            on_threads(threads, || (Means::of(&lattice, &y, 0.0), Spectra::of(&lattice, &y)))
        });
        assert_eq!(means, spectra);
        let (means, spectra) = means;
        for c in 0..3 {
            let mean = |b: Option<usize>| {
                let mine = |site: &usize| b.is_none_or(|b| crystal.coordinates(*site).0 == b);
                let mine: Vec<f64> = (0..sites).filter(mine).map(|site| of(site)[c]).collect();
                mine.iter().sum::<f64>() / mine.len() as f64
            };
            assert!((means.spin[c] - mean(None)).abs() < 1e-14);
            for (b, found) in means.of_sites.iter().enumerate() {
                assert!((found[c] - mean(Some(b))).abs() < 1e-14, "{name}");
            }
        }
        let along = (0..3).filter(|&axis| lattice.shape().sizes()[axis] > 1);
        for (k, axis) in along.enumerate() {
            let size = lattice.shape().sizes()[axis];
            for (r, found) in spectra.correlations[k].iter().enumerate() {
                let mut all = Vec::new();
                for site in 0..sites {
                    let (b, cell) = crystal.coordinates(site);
                    for other in 0..sites {
                        let (other_b, far) = crystal.coordinates(other);
                        let across = (0..3).all(|a| a == axis || cell[a] == far[a]);
                        let there = cell[axis] + r;
                        let there = if periodic { there % size } else { there };
                        if b == other_b && across && far[axis] == there {
                            all.push(dot(of(site), of(other)));
                        }
                    }
                }
                let mean = all.iter().sum::<f64>() / all.len() as f64;
                assert!((found - mean).abs() < 1e-12, "{name}, {axis}, {r}: {found} {mean}");
            }
            let expected = if periodic { size / 2 + 1 } else { size };
            assert_eq!(spectra.correlations[k].len(), expected);
            for (q, found) in spectra.structures[k].iter().enumerate() {
                let (mut re, mut im) = ([0.0; 3], [0.0; 3]);
                for site in 0..sites {
                    let (b, cell) = crystal.coordinates(site);
                    let at = cell[axis] as f64 + crystal.cell.sites[b][axis];
                    let angle = TAU * q as f64 * at / size as f64;
                    for (c, s) in of(site).into_iter().enumerate() {
                        re[c] += s * angle.cos();
                        im[c] -= s * angle.sin();
                    }
                }
                let sum = (dot(re, re) + dot(im, im)) / sites as f64;
                assert!((found - sum).abs() < 1e-10 * (1.0 + sum), "{name}, {q}: {found} {sum}");
            }
        }
    }
}

/// A spiral with wave vector 2π·5/60 along an axis: S = N/2 at that q and at its mirror, no other,
/// and C(r) = cos qr.
#[test]
fn a_spiral_has_its_wave_vector() {
    for axis in 0..2 {
        let mut sizes = [7, 7];
        sizes[axis] = 60;
        let lattice = lattice(crystal("cubic", &sizes, true, &[Material::default()]), [0.0; 3]);
        let y = state(&lattice, |site| {
            let angle = TAU * 5.0 * lattice.crystal().coordinates(site).1[axis] as f64 / 60.0;
            [angle.cos(), 0.0, angle.sin()]
        });
        // Each spin has a bond along either axis: −cos φ of the turn between neighbours, and −1.
        let energy = Means::of(&lattice, &y, 0.0).energy;
        assert!((energy + 1.0 + (TAU * 5.0 / 60.0).cos()).abs() < 1e-13, "{energy}");
        let Spectra { correlations, structures } = Spectra::of(&lattice, &y);
        for (k, s) in structures[axis].iter().enumerate() {
            let expected = if k == 5 || k == 55 { 210.0 } else { 0.0 };
            assert!((s - expected).abs() < 1e-11, "{k}: {s}");
        }
        for (r, c) in correlations[axis].iter().enumerate() {
            assert!((c - (TAU * 5.0 * r as f64 / 60.0).cos()).abs() < 1e-13, "{r}: {c}");
        }
        assert!(structures[1 - axis].iter().all(|s| *s < 1e-11));
        assert!(correlations[1 - axis].iter().all(|c| (c - 1.0).abs() < 1e-13));
    }
}

const KEY: StreamKey = StreamKey { seed: 20_261_129, experiment: 0 };

/// A bcc lattice of two materials at a temperature, all spins up, and its problem.
fn hot(sizes: &[usize]) -> (SpinLattice, Problem) {
    let of =
        |damping| Material { anisotropy: 0.5, noise: noise_at_temperature(damping, 0.3), damping };
    let lattice = lattice(crystal("bcc", sizes, true, &[of(0.5), of(0.1)]), [0.0, 0.0, 0.4]);
    let y0 = [0.0, 0.0, 1.0].repeat(lattice.crystal().sites());
    let damping = Arc::new(Constant::new(0.0).unwrap());
    let problem = Problem::new(Arc::new(lattice.clone()), damping, y0, 1.0).unwrap();
    (lattice, problem)
}

/// A run that is stopped after each look at the clock and goes on from its checkpoint, on another
/// number of threads each time, has the bits of an undisturbed one, and the states that it kept.
#[test]
fn a_path_goes_on_with_the_same_bits() {
    let (lattice, problem) = hot(&[12, 9, 11]);
    let scheme = SexpLi::at_run_time(problem.system()).unwrap();
    let follow = Follow { lattice: &lattice, steps: 90, every: 15, spectra_every: 45 };
    let new = || LargePath::new(&problem, &scheme, 90, Truncation::none(), KEY, 0).unwrap();
    let run =
        |checkpoint: Option<&Checkpoint>, stop_after: u64| -> (Record, Vec<(u64, Vec<Row>)>) {
            let (stop, steps, mut kept) = (Stop::default(), std::cell::Cell::new(0), Vec::new());
            let told = |more| {
                steps.set(steps.get() + more);
                if steps.get() >= stop_after {
                    stop.now();
                }
            };
            let mut keep = |step: u64, y: &[Row]| {
                kept.push((step, y.to_vec()));
                Ok(())
            };
            (follow.path(new(), checkpoint, &stop, &told, &mut keep).unwrap(), kept)
        };
    let (expected, states) = on_threads(1, || run(None, u64::MAX));
    assert_eq!((expected.times.len(), expected.at.len(), states.len()), (7, 3, 3));
    assert!(expected.halted.is_none());
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = Checkpoint::new(folder.path().join("path.bin"), Program::default());
    let (mut found, mut kept) = (Record::default(), Vec::new());
    for limit in (1..=12).map(|k| 8 * k).chain([u64::MAX]) {
        let more;
        (found, more) = on_threads(1 + limit as usize % 3, || run(Some(&checkpoint), limit));
        kept.extend(more);
    }
    assert_eq!(found, expected);
    assert_eq!(kept, states);
    // A path of another lattice refuses it.
    let (other, problem) = hot(&[12, 9, 12]);
    let scheme = SexpLi::at_run_time(problem.system()).unwrap();
    let path = LargePath::new(&problem, &scheme, 90, Truncation::none(), KEY, 0).unwrap();
    let follow = Follow { lattice: &other, ..follow };
    let refused =
        follow.path(path, Some(&checkpoint), &Stop::default(), &|_| (), &mut |_, _| Ok(()));
    assert!(refused.unwrap_err().to_string().contains("the work is a state of"));
}

/// 1/N Σ over modes of 1/ε: the trace of the inverse of A with Aᵢⱼ = (Σⱼ Jᵢⱼ + K + h)δᵢⱼ − Jᵢⱼ, by
/// conjugate gradients at one site of each kind.
fn spin_waves(crystal: &Crystal, gap: f64) -> f64 {
    let (sites, each) = (crystal.sites(), crystal.materials.len());
    let mut next = vec![Vec::new(); sites];
    for site in 0..sites {
        let (b, cell) = crystal.coordinates(site);
        for Bond { pair, .. } in crystal.bonds.iter().filter(|bond| bond.pair.from == b) {
            let sizes = crystal.shape.sizes();
            let at = |a: usize| {
                (cell[a] as isize + pair.cells[a]).rem_euclid(sizes[a] as isize) as usize
            };
            let other = at(0) + sizes[0] * (pair.to + each * (at(1) + sizes[1] * at(2)));
            next[site].push(other);
            next[other].push(site);
        }
    }
    let apply = |x: &[f64]| -> Vec<f64> {
        let at = |i: usize| {
            (next[i].len() as f64 + gap) * x[i] - next[i].iter().map(|&j| x[j]).sum::<f64>()
        };
        (0..sites).map(at).collect()
    };
    let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let of = |b: usize| {
        let site = b * crystal.shape.sizes()[0];
        let (mut x, mut r) = (vec![0.0; sites], vec![0.0; sites]);
        r[site] = 1.0;
        let mut p = r.clone();
        for _ in 0..300 {
            let (before, ap) = (inner(&r, &r), apply(&p));
            if before < 1e-24 {
                break;
            }
            let step = before / inner(&p, &ap);
            (0..sites).for_each(|i| {
                x[i] += step * p[i];
                r[i] -= step * ap[i];
            });
            let grow = inner(&r, &r) / before;
            (0..sites).for_each(|i| p[i] = r[i] + grow * p[i]);
        }
        x[site]
    };
    (0..each).map(of).sum::<f64>() / each as f64
}

/// ⟨1 − m⟩ = kT/N Σ 1/ε of classical spin waves, up to (1 − m)² and the step. Batches are of ten
/// times of decorrelation 1/(α·gap); an interval of 4.5 standard errors misses by chance with
/// 4e-4 (Student's t, 15 degrees of freedom) for each of 9. Twice the temperature
/// is rejected, on three of them.
#[test]
fn statistical_magnetisation_is_that_of_spin_waves() {
    const KT: f64 = 0.03;
    let sizes: [(&str, &[usize]); 9] = [
        ("cubic", &[8, 8, 8]),
        ("bcc", &[6, 6, 6]),
        ("fcc", &[5, 5, 5]),
        ("diamond", &[4, 4, 4]),
        ("triangular", &[20, 20]),
        ("hexagonal", &[8, 8, 6]),
        ("honeycomb", &[16, 16]),
        ("kagome", &[14, 14]),
        ("hcp", &[7, 7, 6]),
    ];
    for (k, (name, sizes)) in sizes.into_iter().enumerate() {
        let theory = |kt: f64, seed: u64| {
            let (damping, gap) = (1.0, 1.0 + 0.5);
            let material =
                Material { anisotropy: 0.5, noise: noise_at_temperature(damping, kt), damping };
            let lattice = lattice(crystal(name, sizes, true, &[material]), [0.0, 0.0, 1.0]);
            let y0 = [0.0, 0.0, 1.0].repeat(lattice.crystal().sites());
            let zero = Arc::new(Constant::new(0.0).unwrap());
            let problem = Problem::new(Arc::new(lattice.clone()), zero, y0, 1.0).unwrap();
            let scheme = SexpLi::at_run_time(problem.system()).unwrap();
            // Steps of 0.01.
            let key = StreamKey { experiment: seed, ..KEY };
            let path = LargePath::new(&problem, &scheme, 100, Truncation::none(), key, 0);
            let mut path = path.unwrap();
            path.advance(400).unwrap();
            let batch = |_| {
                let mut sum = 0.0;
                for _ in 0..8 {
                    path.advance(40).unwrap();
                    sum += 1.0 - Means::of(&lattice, path.state(), 0.0).spin[2];
                }
                sum / 8.0
            };
            let batches: Vec<f64> = (0..16).map(batch).collect();
            let mean = batches.iter().sum::<f64>() / 16.0;
            let variance = batches.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 15.0;
            let exact = KT * spin_waves(lattice.crystal(), gap);
            ((mean - exact).abs(), 4.5 * (variance / 16.0).sqrt() + 2.0 * exact * exact, exact)
        };
        let (error, bound, exact) = theory(KT, k as u64);
        println!("{name}: {error:e} of {exact:e}, {bound:e}");
        assert!(error < bound && bound < 0.2 * exact, "{name}: {error:e} of {exact:e}, {bound:e}");
        if k % 4 > 0 {
            continue;
        }
        let (error, bound, _) = theory(2.0 * KT, 100 + k as u64);
        assert!(error > 2.0 * bound, "{name}: {error:e} {bound:e}");
    }
}
