//! The 14 panels of the paper as data (Bréhier, Cohen and Komori 2025, §5).

mod invariant;
pub mod strong;
pub mod weak;

use mc::Observable;
use real::elementary::{cos, sin};
use systems::paper;

use crate::{Compiled, Experiment, Words, in_words};
use invariant::follow;
use strong::compare;
use weak::WeakPanel;

/// Everything that makes a panel, in the order of the paper.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment::new(&["pendulum-strong"], |conditions| {
        let words = Words {
            title: "Damped stochastic pendulum: strong convergence",
            system: in_words::PENDULUM,
            paper: "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
        };
        compare(conditions, words, (12, 500), true, &Compiled::of(&paper::pendulum()))
    }),
    Experiment::new(&["rigid-body-casimir"], |conditions| {
        let words = Words {
            title: "Damped stochastic rigid body: the Casimir ½|y|² along one path",
            system: in_words::BODY_3,
            paper: "sexp follows the conformal law of the Casimir; Euler–Maruyama does not.",
        };
        let problem = paper::rigid_body_three_noises(10.0);
        follow(conditions, words, 100, &[0], &Compiled::of(&problem))
    }),
    Experiment::new(&["rigid-body-strong-3"], |conditions| {
        let words = Words {
            title: "Damped stochastic rigid body, three noises: strong convergence",
            system: in_words::BODY_3,
            paper: "With several noises all three schemes have strong order 1/2.",
        };
        let problem = paper::rigid_body_three_noises(1.0);
        compare(conditions, words, (14, 1000), true, &Compiled::of(&problem))
    }),
    Experiment::new(&["rigid-body-strong-1"], |conditions| {
        let words = Words {
            title: "Damped stochastic rigid body, only W₁: strong convergence",
            system: in_words::BODY_1,
            paper: "With one noise sexp and midpoint have strong order 1, Euler–Maruyama 1/2.",
        };
        compare(conditions, words, (14, 1000), true, &Compiled::of(&paper::rigid_body_one_noise()))
    }),
    Experiment::new(WEAK_IDS, |conditions| weak::measure(WEAK_PANELS, conditions)),
    Experiment::new(&["rigid-body-energy"], |conditions| {
        let words = Words {
            title: "Damped stochastic rigid body, noise H₀: the energy along one path",
            system: in_words::BODY_ENERGY,
            paper: "sexp follows the conformal law of the energy.",
        };
        let problem = paper::rigid_body_energy(10.0);
        follow(conditions, words, 100, &[1, 0], &Compiled::of(&problem))
    }),
    Experiment::new(&["lotka-volterra-energy"], |conditions| {
        let words = Words {
            title: "Damped stochastic Lotka–Volterra system: the energy along one path",
            system: "Lotka–Volterra, a = −1, b = −2, c = 1",
            paper: "sexp follows the conformal law of the energy, a Hamiltonian that is not \
                    quadratic.",
        };
        let problem = paper::lotka_volterra_2_2(10.0);
        follow(conditions, words, 100, &[0, 1], &Compiled::of(&problem))
    }),
    Experiment::new(&["lotka-volterra-strong"], |conditions| {
        let words = Words {
            title: "Damped stochastic Lotka–Volterra system: strong convergence",
            system: in_words::VOLTERRA,
            paper: "sexp has strong order 1; m(H) = 0, so the theorems do not apply. (The paper's \
                    reference has the finest step of the figure, where the error is then zero by \
                    construction; here it is finer.)",
        };
        compare(conditions, words, (12, 500), false, &Compiled::of(&paper::lotka_volterra_1_1()))
    }),
    Experiment::new(&["maxwell-bloch-casimir"], |conditions| {
        let words = Words {
            title: "Damped stochastic Maxwell–Bloch system: the Casimir ½(y₂² + y₃²) along one path",
            system: "Maxwell–Bloch",
            paper: "sexp follows the conformal law of the Casimir.",
        };
        follow(conditions, words, 500, &[0], &Compiled::of(&paper::maxwell_bloch(5.0)))
    }),
    Experiment::new(&["poisson3-casimir"], |conditions| {
        let words = Words {
            title: "Damped three-dimensional Poisson system: the Casimir ½(y₁+y₂+y₃)² along one path",
            system: in_words::POISSON,
            paper: "sexp follows the conformal law of the Casimir; Euler–Maruyama slightly less \
                    well, midpoint well.",
        };
        follow(conditions, words, 100, &[0, 1], &Compiled::of(&paper::poisson3_casimir(2.0)))
    }),
    Experiment::new(&["poisson3-strong"], |conditions| {
        let words = Words {
            title: "Damped three-dimensional Poisson system: strong convergence",
            system: in_words::POISSON,
            paper: "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
        };
        compare(conditions, words, (12, 400), true, &Compiled::of(&paper::poisson3_strong()))
    }),
];

const WEAK_IDS: &[&str] =
    &[WEAK_PANELS[0].id, WEAK_PANELS[1].id, WEAK_PANELS[2].id, WEAK_PANELS[3].id];

/// The weak panels, which one set of runs makes.
const WEAK_PANELS: &[WeakPanel] = &[
    WeakPanel {
        id: "rigid-body-weak-y",
        title: "Rigid body, three noises: weak error of E[y_j]",
        functions: [phi("y1", |y| y[0]), phi("y2", |y| y[1]), phi("y3", |y| y[2])],
    },
    WeakPanel {
        id: "rigid-body-weak-y2",
        title: "Rigid body, three noises: weak error of E[y_j²]",
        functions: [
            phi("y1^2", |y| y[0] * y[0]),
            phi("y2^2", |y| y[1] * y[1]),
            phi("y3^2", |y| y[2] * y[2]),
        ],
    },
    WeakPanel {
        id: "rigid-body-weak-cos",
        title: "Rigid body, three noises: weak error of E[cos y_j]",
        functions: [
            phi("cos y1", |y| cos(y[0])),
            phi("cos y2", |y| cos(y[1])),
            phi("cos y3", |y| cos(y[2])),
        ],
    },
    WeakPanel {
        id: "rigid-body-weak-sin",
        title: "Rigid body, three noises: weak error of E[sin y_j]",
        functions: [
            phi("sin y1", |y| sin(y[0])),
            phi("sin y2", |y| sin(y[1])),
            phi("sin y3", |y| sin(y[2])),
        ],
    },
];

/// A test function with its name.
pub const fn phi<const D: usize>(
    name: &'static str,
    function: fn([f64; D]) -> f64,
) -> Observable<D> {
    Observable { name, function }
}

/// The twelve test functions of the weak panels.
pub fn weak_observables() -> Vec<Observable<3>> {
    WEAK_PANELS.iter().flat_map(|panel| panel.functions).collect()
}
