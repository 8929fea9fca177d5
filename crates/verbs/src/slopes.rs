//! Parameters of a stationary law e^{−βH₀}.

use casimir::{
    mc::Observe,
    real::{PathMask, Row, Rows, WIDTH, elementary::sin},
    stationary::Slope,
    systems::run_time::{Op, Weights},
};

use crate::prelude::*;
use scenes::{Changed, Nearby};

/// Change of a parameter over its size.
const CHANGE: f64 = 1e-6;

/// Changes of the parameters of derivatives by this part of their sizes.
pub fn changes(scene: &Scene, part: f64) -> Done<Vec<f64>> {
    Ok(scene
        .nearby(&vec![part; scene.gradient.len()])?
        .changed
        .iter()
        .map(|one| match (one.value - one.offset).abs() {
            0.0 => part,
            size => part * size,
        })
        .collect())
}

/// Scenes near one, with parameters changed by 10⁻⁶ of them.
pub fn nearby(scene: &Scene) -> Done<Nearby> {
    Ok(scene.nearby(&changes(scene, CHANGE)?)?)
}

/// The parameters by which averages are differentiated; `averaged` gives the test functions of a
/// scene.
///
/// # Errors
/// The reason why an average has no derivative: no e^{−βH₀} is known to be stationary, or θ changes
/// B or the initial value.
pub fn slopes<'a>(
    Nearby { scene, changed }: &'a Nearby,
    averaged: fn(&Scene) -> Vec<&Observable>,
) -> Done<Vec<Slope<'a>>> {
    changed
        .iter()
        .map(|changed| {
            let Changed { parameter, change, is_observed, scene: near, .. } = changed;
            let refused = |why: &str| {
                refused(scene, format!("no derivative of averages by `{parameter}`: {why}"))
            };
            if let Some(phi) = averaged(scene)
                .into_iter()
                .find(|phi| !phi.quantity.is_continuous())
                .filter(|_| *is_observed)
            {
                return Err(refused(&format!("it is in what is observed, and {} jumps", phi.name)));
            }
            if scene.problem().y0 != near.problem().y0 {
                return Err(refused("it changes the initial value, and with it the leaf"));
            }
            if structure(scene) != structure(near) {
                return Err(refused("it changes B, and with it the leaves"));
            }
            let beta = |scene: &Scene| scene.model.gibbs().map_err(|why| refused(&why));
            let [own, other] = [beta(scene)? / change, beta(near)? / change];
            let (energy, nearby) = scene
                .energy
                .as_ref()
                .zip(near.energy.as_ref())
                .ok_or_else(|| refused("H0 depends on time"))?;
            let of = averaged(scene).into_iter().zip(averaged(near)).map(|(own, near)| {
                Box::new(Change { near: (near, 1.0 / change), own: (own, 1.0 / change) }) as _
            });
            Ok(Slope {
                parameter: parameter.clone(),
                weight: Box::new(Change { near: (nearby, other), own: (energy, own) }),
                of: of.collect(),
            })
        })
        .collect()
}

/// B(y)v for general v at general y.
fn structure(scene: &Scene) -> Vec<Row> {
    let system = scene.model.system();
    let (d, description) = (scene.components.len(), system.description());
    let row = |i: usize, p: usize| 1.0 + 0.3 * sin((i * WIDTH + p) as f64);
    let mut y = Rows::splat(&scene.problem().y0);
    let (mut v, mut out) = (Rows::zero(d), Rows::zero(d));
    for (i, p) in (0..d).flat_map(|i| (0..WIDTH).map(move |p| (i, p))) {
        y[i][p] *= row(i, p);
        v[i][p] = row(p, i);
    }
    let mut scratch = Rows::zero(description.scratch_rows());
    system.apply(Op::Structure { y: &y, v: &v }, 0..d, Weights::NONE, &mut out, &mut scratch);
    out.to_vec()
}

/// A difference of multiples of a function nearby and of one at the parameters.
struct Change<'a> {
    near: (&'a Observable, f64),
    own: (&'a Observable, f64),
}

impl Observe for Change<'_> {
    fn name(&self) -> &str {
        &self.own.0.name
    }

    fn evaluate(&self, y: &[Row], live: PathMask, values: &mut Row) {
        let ((near, a), (own, b)) = (self.near, self.own);
        let before = own.values(y, live);
        near.evaluate(y, live, values);
        live.paths().for_each(|p| values[p] = a * values[p] - b * before[p]);
    }
}
