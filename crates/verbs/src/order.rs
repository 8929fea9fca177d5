//! How fast the errors of a scheme fall.

use casimir::{
    analysis::{self, StepSizes, strong_order, weak_order},
    mc::Setup,
    plot::{Kind, Series, figure::convergence},
};

use crate::prelude::*;

/// The strong and the weak order of the scheme of a scene.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Order {
    /// Path-steps that each measurement may take
    #[cfg_attr(feature = "clap", arg(long, default_value_t = Order::default().path_steps))]
    pub path_steps: Count,
    /// Scheme and seed.
    #[cfg_attr(feature = "clap", command(flatten))]
    #[serde(skip)]
    pub scheme: SchemeAndSeed,
}

impl Default for Order {
    fn default() -> Self {
        Self { path_steps: Count(300_000_000), scheme: SchemeAndSeed::default() }
    }
}

impl Verb for Order {
    const NAME: &'static str = "order";
    const STORES: Stores = Stores::Measurements;

    fn changes(&self) -> Changes {
        Changes { scheme: self.scheme.clone(), ..Changes::default() }
    }

    fn meaning(&self) -> String {
        format!("path steps = {}\n", self.path_steps.0)
    }

    fn compute(&self, scene: &Scene, store: &Store<'_>, watch: &Watch) -> Done<Found> {
        let (start, job) = (Instant::now(), store.job());
        let (scheme, because) = scheme(scene);
        let settings = &scene.settings;
        let measured = scene.setup(&scheme)?;
        let coarsest = coarsest_steps(settings.until);
        let sizes = StepSizes {
            stop: watch.stop.clone(),
            job: job.cloned(),
            ..StepSizes::new(coarsest, settings.truncation, settings.key).within(self.path_steps.0)
        };
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
        let weak = scene.tested().map(|phi| order(&measured, Some(phi)));
        let weak = weak.collect::<Done<Vec<Measured>>>()?;
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
}

/// A quantity with the order of its errors.
pub type Measured = (String, analysis::Order);

/// The figures of a strong order and of weak ones.
pub fn figures(scheme: &str, strong: &analysis::Order, weak: &[Measured]) -> Vec<Figure> {
    let series = |quantity: &str, order: &analysis::Order| Series {
        scheme: scheme.into(),
        quantity: quantity.into(),
        points: order.points.clone(),
        rate: order.rate.clone(),
        ..Series::default()
    };
    let drawn = |file: &str, title, kind, series: &[Series]| {
        Figure::new(
            file,
            convergence(title, kind, series),
            format!("{title} against the step, 95 % intervals."),
        )
    };
    let weak: Vec<Series> = weak.iter().map(|(quantity, order)| series(quantity, order)).collect();
    vec![
        drawn("strong", "Strong errors", Kind::Strong, &[series("y(T)", strong)]),
        drawn("weak", "Weak errors", Kind::Weak, &weak),
    ]
}

/// A strong order and weak ones for programs.
pub fn described(strong: &analysis::Order, weak: &[Measured]) -> [Value; 2] {
    let one = |quantity: &str, order: &analysis::Order| {
        json!({
            "quantity": quantity, "order": order.order(), "words": order.to_string(),
            "rate": order.rate, "points": order.points, "failed_paths": order.failed,
        })
    };
    [one("y(T)", strong), weak.iter().map(|(quantity, order)| one(quantity, order)).collect()]
}
