//! `casimir order`: how fast the errors of a scheme fall.

use std::time::Instant;

use casimir::{
    analysis::{Order, StepSizes, strong_order, weak_order},
    plot::{Kind, Series, figure::convergence, files},
};
use serde_json::json;

use super::{coarsest_steps, folder, open, print, print_json, scheme, threads, under_bar, warn};
use crate::{
    arguments,
    failure::Done,
    scene::{Changes, Scene},
};

/// A quantity with the order of its errors.
type Found = (String, Order);

/// Measures the orders of a scheme on a scene.
pub fn order(arguments: &arguments::Order) -> Done {
    let scene = open(&arguments.scene, &Changes::from(&arguments.scheme))?;
    threads(arguments.output.threads)?;
    let start = Instant::now();
    warn(&scene);
    let (scheme, because) = scheme(&scene);
    let (strong, weak) = measure(&scene, &scheme, arguments.path_steps)?;
    let seconds = start.elapsed().as_secs_f64();
    let folder = folder::of(arguments.output.out.clone(), &arguments.scene, "order")?;
    let series = |(quantity, order): &Found| Series {
        scheme: scheme.clone(),
        quantity: quantity.clone(),
        points: order.points.clone(),
        rate: order.rate.clone(),
        ..Series::default()
    };
    let weak_series = weak.iter().map(series).collect::<Vec<_>>();
    let figures = [
        ("strong.svg", convergence("Strong errors", Kind::Strong, &[series(&strong)])),
        ("weak.svg", convergence("Weak errors", Kind::Weak, &weak_series)),
    ];
    for (file, figure) in figures {
        files::write(&folder.join(file), figure)?;
    }
    let described = |(quantity, order): &Found| {
        json!({
            "quantity": quantity, "order": order.order(), "words": order.to_string(),
            "rate": order.rate, "points": order.points, "failed_paths": order.failed,
        })
    };
    let json = json!({
        "title": scene.title, "scheme": scheme, "because": because,
        "strong": described(&strong), "weak": weak.iter().map(described).collect::<Vec<_>>(),
        "seconds": seconds,
    });
    files::write_json(&folder.join("order.json"), &json)?;
    if arguments.output.json {
        return print_json(&json);
    }
    let reason = because.map_or(String::new(), |because| format!(" ({because})"));
    let lines = [("strong", &strong)].into_iter().chain(weak.iter().map(|found| ("weak", found)));
    let lines = lines.map(|(kind, (quantity, order))| format!("{kind}, {quantity}: {order}\n"));
    let (lines, folder) = (lines.collect::<String>(), folder.display());
    print(&format!(
        "{scheme}{reason}, {seconds:.1} s\n{lines}figures: {folder}/strong.svg, {folder}/weak.svg\n"
    ))
}

/// The strong order, and the weak orders of what is expected or of the first observable.
fn measure(scene: &Scene, scheme: &str, path_steps: u64) -> Done<(Found, Vec<Found>)> {
    let settings = &scene.settings;
    let measured = scene.setup(scheme)?;
    let sizes = StepSizes::new(coarsest_steps(settings.until), settings.truncation, settings.key)
        .within(path_steps);
    let found = |quantity: String, order: Result<_, _>| -> Done<Found> {
        Ok((quantity, order.map_err(|error| scene.steps_error(error))?))
    };
    let strong = under_bar(&format!("strong order of {scheme}"), 0, |_| {
        found("y(T)".into(), strong_order(&measured, &sizes))
    })?;
    let measured = scene.collecting(measured);
    let first = usize::from(scene.expected.is_empty());
    let weak = scene.observables.iter().take(first).chain(&scene.expected).map(|phi| {
        let quantity = format!("E[{}]", phi.name);
        under_bar(&format!("weak order of {scheme} for {quantity}"), 0, |_| {
            found(quantity, weak_order(&measured, phi, &sizes, None))
        })
    });
    Ok((strong, weak.collect::<Done<_>>()?))
}
