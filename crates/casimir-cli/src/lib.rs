//! **Scenes: damped stochastic Poisson systems from a text file, for programs.**
//!
//! [`Scene::new`](scene::Scene::new) reads a scene and checks it; its [`Model`](model::Model) is
//! the problem with every scheme for it. The program `casimir` is made of these.
//!
//! The way through: text → `scene/file` (keys) → `scene/run`, `scene/observe` (checked) → `model` →
//! `verbs/run` (`Results`) → `output` (`figures`, `page`, `npz`). The program adds a command line
//! and folders.
//!
//! ```
//! use casimir::mc::Simulation;
//! use casimir_cli::scene::{Changes, Scene, Source};
//!
//! let text = r#"
//! [system]
//! state = ["q", "p"]
//! B = [["1"]]
//! H0 = "(q^2 + p^2)/2"
//! H = ["0.1*q"]
//! [run]
//! initial = [1, 0]
//! until = 1
//! steps = 64
//! "#;
//! let source = Source { name: "oscillator.toml".into(), text: text.into(), states: None };
//! let scene = Scene::new(source, &Changes::default())?;
//! let setup = scene.setup("sexp")?;
//! let simulation = Simulation::new(setup, scene.settings.truncation);
//! let paths = simulation.paths(scene.settings.steps, scene.settings.key, 0..2)?;
//! assert_eq!(paths.len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod citation;
pub mod doctor;
pub mod failure;
pub mod gallery;
pub mod model;
pub mod output;
pub mod scene;
pub mod verbs;
