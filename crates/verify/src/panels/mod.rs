//! The 14 panels of the paper as data (Bréhier, Cohen and Komori 2025, §5).

pub mod curves;
mod invariant;
pub mod strong;
pub mod weak;

use mc::Observable;
use real::elementary::{cos, sin};
use systems::paper;

use crate::{Experiment, Words, in_words};
use invariant::InvariantPanel;
use strong::StrongPanel;
use weak::WeakPanel;

/// Everything that makes a panel, in the order of the paper.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment::new(&["pendulum-strong"], |conditions| {
        StrongPanel {
            words: Words {
                title: "Damped stochastic pendulum: strong convergence",
                system: in_words::PENDULUM,
                paper: "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
            },
            last: 12,
            samples: 500,
            proven: true,
        }
        .compare(conditions, &paper::pendulum())
    }),
    Experiment::new(&["rigid-body-casimir"], |conditions| {
        InvariantPanel {
            words: Words {
                title: "Damped stochastic rigid body: the Casimir ½|y|² along one path",
                system: in_words::BODY_3,
                paper: "sexp follows the conformal law of the Casimir; Euler–Maruyama does not.",
            },
            steps: 100,
            invariants: &[0],
        }
        .follow(conditions, &paper::rigid_body_three_noises(10.0))
    }),
    Experiment::new(&["rigid-body-strong-3"], |conditions| {
        StrongPanel {
            words: Words {
                title: "Damped stochastic rigid body, three noises: strong convergence",
                system: in_words::BODY_3,
                paper: "With several noises all three schemes have strong order 1/2.",
            },
            last: 14,
            samples: 1000,
            proven: true,
        }
        .compare_with_areas(conditions, &paper::rigid_body_three_noises(1.0))
    }),
    Experiment::new(&["rigid-body-strong-1"], |conditions| {
        StrongPanel {
            words: Words {
                title: "Damped stochastic rigid body, only W₁: strong convergence",
                system: in_words::BODY_1,
                paper: "With one noise sexp and midpoint have strong order 1, Euler–Maruyama 1/2.",
            },
            last: 14,
            samples: 1000,
            proven: true,
        }
        .compare(conditions, &paper::rigid_body_one_noise())
    }),
    Experiment::new(WEAK_IDS, |conditions| weak::measure(WEAK_PANELS, conditions)),
    Experiment::new(&["rigid-body-energy"], |conditions| {
        InvariantPanel {
            words: Words {
                title: "Damped stochastic rigid body, noise H₀: the energy along one path",
                system: in_words::BODY_ENERGY,
                paper: "sexp follows the conformal law of the energy.",
            },
            steps: 100,
            invariants: &[1, 0],
        }
        .follow(conditions, &paper::rigid_body_energy(10.0))
    }),
    Experiment::new(&["lotka-volterra-energy"], |conditions| {
        InvariantPanel {
            words: Words {
                title: "Damped stochastic Lotka–Volterra system: the energy along one path",
                system: "Lotka–Volterra, a = −1, b = −2, c = 1",
                paper: "sexp follows the conformal law of the energy, a Hamiltonian that is not \
                    quadratic.",
            },
            steps: 100,
            invariants: &[0, 1],
        }
        .follow(conditions, &paper::lotka_volterra_2_2(10.0))
    }),
    Experiment::new(&["lotka-volterra-strong"], |conditions| {
        StrongPanel {
        words: Words {
            title: "Damped stochastic Lotka–Volterra system: strong convergence",
            system: in_words::VOLTERRA,
            paper: "sexp has strong order 1; m(H) = 0, so the theorems do not apply. (The paper's \
                    reference has the finest step of the figure, where the error is then zero by \
                    construction; here it is finer.)",
        },
        last: 12,
        samples: 500,
        proven: false,
        }
        .compare(conditions, &paper::lotka_volterra_1_1())
    }),
    Experiment::new(&["maxwell-bloch-casimir"], |conditions| {
        InvariantPanel {
            words: Words {
                title: "Damped stochastic Maxwell–Bloch system: the Casimir ½(y₂² + y₃²) along one \
                    path",
                system: "Maxwell–Bloch",
                paper: "sexp follows the conformal law of the Casimir.",
            },
            steps: 500,
            invariants: &[0],
        }
        .follow(conditions, &paper::maxwell_bloch(5.0))
    }),
    Experiment::new(&["poisson3-casimir"], |conditions| {
        InvariantPanel {
        words: Words {
            title: "Damped three-dimensional Poisson system: the Casimir ½(y₁+y₂+y₃)² along one \
                    path",
            system: in_words::POISSON,
            paper: "sexp follows the conformal law of the Casimir; Euler–Maruyama slightly less \
                    well, midpoint well.",
        },
        steps: 100,
        invariants: &[0, 1],
        }
        .follow(conditions, &paper::poisson3_casimir(2.0))
    }),
    Experiment::new(&["poisson3-strong"], |conditions| {
        StrongPanel {
            words: Words {
                title: "Damped three-dimensional Poisson system: strong convergence",
                system: in_words::POISSON,
                paper: "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
            },
            last: 12,
            samples: 400,
            proven: true,
        }
        .compare(conditions, &paper::poisson3_strong())
    }),
];

const WEAK_IDS: &[&str] =
    &[WEAK_PANELS[0].id, WEAK_PANELS[1].id, WEAK_PANELS[2].id, WEAK_PANELS[3].id];

/// The weak panels, which one set of runs makes.
const WEAK_PANELS: &[WeakPanel] = &[
    WeakPanel {
        id: "rigid-body-weak-y",
        title: "Rigid body, three noises: weak error of E[y_j]",
        functions: [("y1", |y| y[0]), ("y2", |y| y[1]), ("y3", |y| y[2])],
    },
    WeakPanel {
        id: "rigid-body-weak-y2",
        title: "Rigid body, three noises: weak error of E[y_j²]",
        functions: [
            ("y1^2", |y| y[0] * y[0]),
            ("y2^2", |y| y[1] * y[1]),
            ("y3^2", |y| y[2] * y[2]),
        ],
    },
    WeakPanel {
        id: "rigid-body-weak-cos",
        title: "Rigid body, three noises: weak error of E[cos y_j]",
        functions: [
            ("cos y1", |y| cos(y[0])),
            ("cos y2", |y| cos(y[1])),
            ("cos y3", |y| cos(y[2])),
        ],
    },
    WeakPanel {
        id: "rigid-body-weak-sin",
        title: "Rigid body, three noises: weak error of E[sin y_j]",
        functions: [
            ("sin y1", |y| sin(y[0])),
            ("sin y2", |y| sin(y[1])),
            ("sin y3", |y| sin(y[2])),
        ],
    },
];

/// The twelve test functions of the weak panels.
pub fn weak_observables() -> Vec<Observable<3>> {
    weak::observables(&WEAK_PANELS.iter().collect::<Vec<_>>())
}
