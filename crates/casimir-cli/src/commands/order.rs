//! `casimir order`: how fast the errors of a scheme fall.

use std::time::Instant;

use casimir::{
    analysis::{self, ReferenceSolution, StepSizes, strong_order, weak_order},
    plot::{Kind, Series, figure::convergence, files},
};
use serde_json::{Value, json};

use super::{coarsest_steps, folder, open, print, print_json, scheme, threads, under_bar, warn};
use crate::{
    arguments::Order,
    failure::Done,
    scene::{Changes, Scene},
};

/// The order of one quantity.
struct Found {
    quantity: String,
    order: analysis::Order,
}

/// What was found of a scheme.
struct Results {
    scheme: String,
    because: Option<String>,
    strong: Found,
    weak: Vec<Found>,
    seconds: f64,
}

/// Measures the orders of a scheme on a scene.
pub fn order(arguments: &Order) -> Done {
    let scene = open(&arguments.scene, &Changes::from(&arguments.scheme))?;
    threads(arguments.output.threads)?;
    let results = measure(&scene, arguments.path_steps)?;
    let folder = folder::of(arguments.output.out.as_ref(), &arguments.scene, "order");
    folder::prepare(&folder)?;
    let Results { scheme, because, strong, weak, seconds } = &results;
    let series = |found: &Found| Series {
        scheme: scheme.clone(),
        quantity: found.quantity.clone(),
        points: found.order.points.clone(),
        rate: found.order.rate.clone(),
        max_relative_defect: None,
    };
    let weak_series = weak.iter().map(series).collect::<Vec<_>>();
    let figures = [
        ("strong.svg", convergence("Strong errors", Kind::Strong, &[series(strong)])),
        ("weak.svg", convergence("Weak errors", Kind::Weak, &weak_series)),
    ];
    for (file, figure) in figures {
        files::write(&folder.join(file), figure.svg())?;
    }
    let json = json!({
        "title": scene.title, "scheme": scheme, "because": because,
        "strong": described(strong), "weak": weak.iter().map(described).collect::<Vec<_>>(),
        "seconds": seconds,
    });
    files::write_json(&folder.join("order.json"), &json)?;
    if arguments.output.json {
        return print_json(&json);
    }
    let reason = because.as_ref().map_or(String::new(), |because| format!(" ({because})"));
    let mut text = format!("{scheme}{reason}, {seconds:.1} s\n");
    text += &format!("strong, {}: {}\n", strong.quantity, strong.order);
    for Found { quantity, order } in weak {
        text += &format!("weak, {quantity}: {order}\n");
    }
    let folder = folder.display();
    print(&format!("{text}figures: {folder}/strong.svg, {folder}/weak.svg\n"))
}

fn described(found: &Found) -> Value {
    let Found { quantity, order } = found;
    json!({
        "quantity": quantity, "order": order.order(), "words": order.to_string(),
        "rate": order.rate, "points": order.points, "failed_paths": order.failed,
    })
}

fn measure(scene: &Scene, path_steps: u64) -> Done<Results> {
    let start = Instant::now();
    warn(scene);
    let (scheme, because) = scheme(scene);
    let settings = &scene.settings;
    let measured = scene.setup(&scheme)?;
    let (heun, midpoint) = (scene.setup("heun")?.scheme, scene.setup("midpoint")?.scheme);
    let reference = ReferenceSolution::Independent(vec![heun, midpoint]);
    let sizes = StepSizes::new(coarsest_steps(settings.until), settings.truncation, settings.key)
        .within(path_steps);
    let found = |quantity: String, order: Result<_, _>| {
        let order = order.map_err(|error| scene.steps_error(error));
        Ok(Found { quantity, order: order? })
    };
    let strong = under_bar(&format!("strong order of {scheme}"), 0, |_| {
        found("y(T)".into(), strong_order(&measured, &sizes, &reference))
    })?;
    let first = usize::from(scene.expected.is_empty());
    let weak = scene.observables.iter().take(first).chain(&scene.expected).map(|phi| {
        let quantity = format!("E[{}]", phi.name);
        under_bar(&format!("weak order of {scheme} for {quantity}"), 0, |_| {
            found(quantity, weak_order(&measured, phi, &sizes, &reference))
        })
    });
    let weak = weak.collect::<Done<_>>()?;
    Ok(Results { scheme, because, strong, weak, seconds: start.elapsed().as_secs_f64() })
}
