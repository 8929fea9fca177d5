//! How fast the errors of a scheme fall.

use std::{sync::Arc, time::Instant};

use casimir::{
    analysis::{Order, StepSizes, strong_order, weak_order},
    mc::{Setup, parts::Job},
    plot::{Kind, Series, figure::convergence},
};
use serde_json::{Value, json};

use super::{Found, Watch, coarsest_steps, scheme};
use crate::{failure::Done, output::Figure};
use scenes::{Observable, Scene};

/// A quantity with the order of its errors.
pub type Measured = (String, Order);

/// Measures the orders of the scheme of a scene, kept by a job if there is one. Each measurement
/// may take `path_steps` path-steps.
pub fn order(scene: &Scene, path_steps: u64, job: Option<&Arc<Job>>, watch: &Watch) -> Done<Found> {
    let start = Instant::now();
    let (scheme, because) = scheme(scene);
    let settings = &scene.settings;
    let measured = scene.setup(&scheme)?;
    let sizes = StepSizes::new(coarsest_steps(settings.until), settings.truncation, settings.key)
        .within(path_steps);
    let sizes = StepSizes { stop: watch.stop.clone(), job: job.cloned(), ..sizes };
    // The strong order, or a weak one.
    let order = |setup: &Setup<'_>, phi: Option<&Observable>| -> Done<Measured> {
        let (kind, quantity) = match phi {
            Some(phi) => ("weak", format!("E[{}]", phi.name)),
            None => ("strong", "y(T)".into()),
        };
        if let Some(job) = job {
            job.section(&format!("{kind} order, {quantity}: "));
        }
        let what = format!("{kind} order of {scheme} for {quantity}");
        let order = watch.under(&what, 0, |_| match phi {
            Some(phi) => weak_order(setup, phi, &sizes, None),
            None => strong_order(setup, &sizes),
        });
        watch.check()?;
        Ok((quantity, order.map_err(|error| scene.steps_error(error))?))
    };
    let (_, strong) = order(&measured, None)?;
    let measured = scene.collecting(measured);
    let weak =
        scene.tested().map(|phi| order(&measured, Some(phi))).collect::<Done<Vec<Measured>>>()?;
    let seconds = start.elapsed().as_secs_f64();
    let reason = because.as_ref().map_or(String::new(), |because| format!(" ({because})"));
    let mut text = format!("{scheme}{reason}, {seconds:.1} s\nstrong, y(T): {strong}\n");
    for (quantity, order) in &weak {
        text += &format!("weak, {quantity}: {order}\n");
    }
    let figures = figures(&scheme, &strong, &weak);
    let [strong, weak] = described(&strong, &weak);
    let json = json!({
        "scheme": scheme, "because": because, "strong": strong, "weak": weak, "seconds": seconds,
    });
    Ok(Found::of(scene, [], &text, json, figures))
}

/// The figures of a strong order and of weak ones.
pub fn figures(scheme: &str, strong: &Order, weak: &[Measured]) -> Vec<Figure> {
    let series = |quantity: &str, order: &Order| Series {
        scheme: scheme.into(),
        quantity: quantity.into(),
        points: order.points.clone(),
        rate: order.rate.clone(),
        ..Series::default()
    };
    let drawn = |file: &str, title, kind, series: &[Series]| {
        let caption = format!("{title} against the step, 95 % intervals.");
        Figure::new(file, convergence(title, kind, series), caption)
    };
    let weak: Vec<Series> = weak.iter().map(|(quantity, order)| series(quantity, order)).collect();
    vec![
        drawn("strong", "Strong errors", Kind::Strong, &[series("y(T)", strong)]),
        drawn("weak", "Weak errors", Kind::Weak, &weak),
    ]
}

/// A strong order and weak ones for programs.
pub fn described(strong: &Order, weak: &[Measured]) -> [Value; 2] {
    let one = |quantity: &str, order: &Order| {
        json!({
            "quantity": quantity, "order": order.order(), "words": order.to_string(),
            "rate": order.rate, "points": order.points, "failed_paths": order.failed,
        })
    };
    [one("y(T)", strong), weak.iter().map(|(quantity, order)| one(quantity, order)).collect()]
}
