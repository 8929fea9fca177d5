//! `casimir order`: how fast the errors of a scheme fall.

use std::time::Instant;

use casimir::{
    analysis::{self, ReferenceSolution, StepSizes, strong_order, weak_order},
    plot::{Bars, Kind, Progress, Series, figure::convergence, files},
};
use serde_json::{Value, json};

use super::{coarsest_steps, folder, open, print, print_json, scheme, threads, warn};
use crate::{
    arguments::Order,
    failure::Done,
    model::Model,
    scene::{Changes, Observable, Scene},
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
    let results = measure(&scene, &*scene.model, arguments.path_steps)?;
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
    let figure = convergence("Strong errors", Kind::Strong, &[series(strong)]);
    files::write(&folder.join("strong.svg"), figure.svg())?;
    let figure =
        convergence("Weak errors", Kind::Weak, &weak.iter().map(series).collect::<Vec<_>>());
    files::write(&folder.join("weak.svg"), figure.svg())?;
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

fn measure(scene: &Scene, model: &dyn Model, path_steps: u64) -> Done<Results> {
    let start = Instant::now();
    warn(model);
    let (scheme, because) = scheme(scene, model);
    let (source, settings) = (&scene.source, &scene.settings);
    let setup = |scheme: &str| {
        let setup = model.setup(scheme);
        setup.map_err(|error| settings.scheme_error(source, error))
    };
    let measured = setup(&scheme)?;
    let (heun, midpoint) = (setup("heun")?.scheme, setup("midpoint")?.scheme);
    let reference = ReferenceSolution::Independent(vec![heun, midpoint]);
    let sizes = StepSizes::new(coarsest_steps(settings.until), settings.truncation, settings.key);
    let wrong = |error| settings.steps_error(source, error);
    let bars = Bars::default();
    bars.begin(&format!("strong order of {scheme}"), 0);
    let order = strong_order(&measured, &sizes.within(path_steps), &reference).map_err(wrong)?;
    let strong = Found { quantity: "y(T)".into(), order };
    let mut weak = Vec::new();
    let first = scene.observables.first().into_iter();
    let expected: Vec<&Observable> = match scene.expected.is_empty() {
        true => first.collect(),
        false => scene.expected.iter().collect(),
    };
    for phi in expected {
        bars.begin(&format!("weak order of {scheme} for E[{}]", phi.name), 0);
        let order = weak_order(&measured, phi, &sizes.within(path_steps), &reference);
        let quantity = format!("E[{}]", phi.name);
        weak.push(Found { quantity, order: order.map_err(wrong)? });
    }
    bars.finish();
    let seconds = start.elapsed().as_secs_f64();
    Ok(Results { scheme, because, strong, weak, seconds })
}
