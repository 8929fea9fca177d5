//! Solvers of others: their noise as arrays, and what their states show.

use casimir::analysis::{Claims, LevelNoise, SolverStates, VISITS};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::{prelude::*, types::PyDict};
use scenes::{Changes, Scene};
use verbs::{self, Measure, failure::Failure};

use crate::{
    Given, How,
    calls::{self, Found, watched},
};

/// Steps of the coarsest size, step sizes, and paths.
type Sizes = (Option<u64>, usize, u64);
/// States [path, component].
type States<'py> = PyReadonlyArray2<'py, f64>;
/// Increments, areas and space-time areas of a step size.
type Noise<'py> = Bound<'py, PyDict>;

fn measure((steps, levels, paths): Sizes) -> Measure {
    Measure { steps, levels, paths }
}

/// The arrays of the noise of a step size, on so many paths.
fn arrays<'py>(
    py: Python<'py>,
    noise: LevelNoise,
    paths: usize,
    noises: usize,
) -> PyResult<Noise<'py>> {
    let steps = noise.increments.len() / (paths * noises).max(1);
    let arrays = PyDict::new(py);
    let dims = [steps, paths, noises];
    arrays.set_item("dW", PyArray1::from_vec(py, noise.increments).reshape(dims)?)?;
    arrays.set_item("H", PyArray1::from_vec(py, noise.space_time).reshape(dims)?)?;
    let areas = if noises > 1 { noise.areas } else { vec![0.0; steps * paths * noises] };
    let areas = PyArray1::from_vec(py, areas).reshape([steps, paths, noises, noises])?;
    arrays.set_item("areas", areas)?;
    Ok(arrays)
}

/// The noise of some paths at every step size, and states at time 0, and at the end by the
/// reference with two step sizes.
#[pyfunction]
pub fn solver_noise<'py>(
    py: Python<'py>,
    given: Given<'py>,
    sizes: Sizes,
    range: (u64, usize),
) -> PyResult<(Vec<Noise<'py>>, Vec<Bound<'py, PyArray2<f64>>>)> {
    let source = given.source();
    let found = py.detach(|| {
        let scene = Scene::new(source, &Changes::default())?;
        let (noise, states) = verbs::solver_noise(&scene, measure(sizes), range)?;
        Ok((noise, states, scene.problem().noises, scene.components.len()))
    });
    let paths = range.1;
    let (noise, states, noises, d) =
        found.map_err(|failure: Failure| calls::raised(py, &given.text, failure))?;
    let noise = noise.into_iter().map(|noise| arrays(py, noise, paths, noises));
    let states = states.map(|y| PyArray1::from_vec(py, y).reshape([paths, d]));
    Ok((noise.collect::<PyResult<_>>()?, states.into_iter().collect::<PyResult<_>>()?))
}

/// The sizes of single steps, each with the noise of one and of two half steps, on several times
/// so many states.
#[pyfunction]
pub fn single_steps<'py>(
    py: Python<'py>,
    given: Given<'py>,
    sizes: Sizes,
) -> PyResult<(usize, Vec<(f64, [Noise<'py>; 2])>)> {
    let source = given.source();
    let found = py.detach(|| {
        let scene = Scene::new(source, &Changes::default())?;
        Ok((verbs::single_steps(&scene, measure(sizes))?, scene.problem().noises))
    });
    let (steps, noises) =
        found.map_err(|failure: Failure| calls::raised(py, &given.text, failure))?;
    let of = |(tau, [one, two]): (f64, [LevelNoise; 2])| {
        let paths = one.increments.len() / noises.max(1);
        Ok((tau, [arrays(py, one, paths, noises)?, arrays(py, two, paths, noises)?]))
    };
    Ok((VISITS, steps.into_iter().map(of).collect::<PyResult<_>>()?))
}

/// States at time 0, at each step size, at the coarsest again, by the reference, and after single
/// steps.
type Answers<'py> =
    (States<'py>, Vec<States<'py>>, States<'py>, [States<'py>; 2], Vec<[States<'py>; 2]>);
/// Claims: strong and weak order; whether laws are kept, and whether all steps are the same map.
type Said = (Option<f64>, Option<f64>, bool, bool);

/// Judges the states of a solver that took these seconds at each step size.
#[pyfunction]
pub fn judge<'py>(
    py: Python<'py>,
    given: Given<'py>,
    sizes: Sizes,
    answers: Answers<'py>,
    seconds: Vec<f64>,
    said: Said,
    how: How,
) -> PyResult<Bound<'py, PyDict>> {
    let (start, levels, again, reference, single) = answers;
    let of = |states: States<'py>| states.as_array().iter().copied().collect::<Vec<f64>>();
    let states = SolverStates {
        start: of(start),
        levels: levels.into_iter().map(of).collect(),
        again: of(again),
        reference: reference.map(of),
        single: single.into_iter().map(|pair| pair.map(of)).collect(),
        seconds,
    };
    let (strong, weak, keeps, same_step) = said;
    let claims = Claims { strong, weak, keeps, same_step };
    let source = given.source();
    watched(py, &given.text, how.threads, how.show, false, move |_| {
        let scene = Scene::new(source, &Changes::default())?;
        let common = verbs::judge(&scene, measure(sizes), &states, &claims)?;
        Ok(Found { common, ..Found::default() })
    })
}
