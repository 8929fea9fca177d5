//! How fast the errors of a scheme fall.

use std::time::Instant;

use casimir::{
    analysis::{Order, StepSizes, strong_order, weak_order},
    mc::Setup,
    plot::{Kind, Series, figure::convergence},
};
use serde_json::{Value, json};

use super::{Found, Watch, coarsest_steps, scheme, warnings};
use crate::{
    failure::Done,
    output::Drawn,
    scene::{Observable, Scene},
};

/// A quantity with the order of its errors.
type Measured = (String, Order);

/// Measures the orders of the scheme of a scene. Each measurement may take so many path-steps.
pub fn order(scene: &Scene, path_steps: u64, watch: &Watch) -> Done<Found> {
    let start = Instant::now();
    let ((scheme, because), mistake) = (scheme(scene), scene.model.known().mistake);
    let settings = &scene.settings;
    let measured = scene.setup(&scheme)?;
    let sizes = StepSizes::new(coarsest_steps(settings.until), settings.truncation, settings.key)
        .within(path_steps);
    let sizes = StepSizes { stop: watch.stop.clone(), ..sizes };
    // The strong order, or a weak one.
    let order = |setup: &Setup<'_>, phi: Option<&Observable>| -> Done<Measured> {
        let (kind, quantity) = match phi {
            Some(phi) => ("weak", format!("E[{}]", phi.name)),
            None => ("strong", "y(T)".into()),
        };
        let what = format!("{kind} order of {scheme} for {quantity}");
        let order = watch.under(what, 0, || match phi {
            Some(phi) => weak_order(setup, phi, &sizes, None),
            None => strong_order(setup, &sizes),
        });
        watch.check()?;
        Ok((quantity, order.map_err(|error| scene.steps_error(error))?))
    };
    let strong = order(&measured, None)?;
    let measured = scene.collecting(measured);
    let first = usize::from(scene.expected.is_empty());
    let weak = scene.observables.iter().take(first).chain(&scene.expected);
    let weak = weak.map(|phi| order(&measured, Some(phi)));
    let weak = weak.collect::<Done<Vec<Measured>>>()?;
    let seconds = start.elapsed().as_secs_f64();
    let reason = because.as_ref().map_or(String::new(), |because| format!(" ({because})"));
    let mut text = warnings(&mistake) + &format!("{scheme}{reason}, {seconds:.1} s\n");
    for (kind, (quantity, order)) in
        [("strong", &strong)].into_iter().chain(weak.iter().map(|weak| ("weak", weak)))
    {
        text += &format!("{kind}, {quantity}: {order}\n");
    }
    let weak_series = weak.iter().map(|(quantity, order)| series(&scheme, quantity, order));
    let figures = figures(series(&scheme, "y(T)", &strong.1), &weak_series.collect::<Vec<_>>());
    let described = |(quantity, order): &Measured| described(quantity, order);
    let json = json!({
        "title": scene.title, "scheme": scheme, "because": because,
        "strong": described(&strong), "weak": weak.iter().map(described).collect::<Vec<_>>(), "seconds": seconds,
    });
    Ok(Found::new(text, json, figures))
}

/// An order as a curve.
pub fn series(scheme: &str, quantity: &str, order: &Order) -> Series {
    Series {
        scheme: scheme.into(),
        quantity: quantity.into(),
        points: order.points.clone(),
        rate: order.rate.clone(),
        ..Series::default()
    }
}

/// The figures of a strong order and of weak ones.
pub fn figures(strong: Series, weak: &[Series]) -> Vec<Drawn> {
    let drawn = |file: &str, title, kind, series: &[Series]| Drawn {
        file: file.into(),
        svg: convergence(title, kind, series),
        caption: format!("{title} against the step, 95 % intervals."),
    };
    vec![
        drawn("strong", "Strong errors", Kind::Strong, &[strong]),
        drawn("weak", "Weak errors", Kind::Weak, weak),
    ]
}

/// An order for programs.
pub fn described(quantity: &str, order: &Order) -> Value {
    json!({
        "quantity": quantity, "order": order.order(), "words": order.to_string(),
        "rate": order.rate, "points": order.points, "failed_paths": order.failed,
    })
}
