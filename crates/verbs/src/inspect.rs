//! Inspection of a system.

use casimir::{
    inspect::{
        InspectSettings,
        facts::{Bath, Growth, Span, growth, span},
    },
    stats::Warning,
};

use crate::{lines_of, prelude::*};
use scenes::{Set, digits, model::with_names};

/// Inspects the system of a scene, whose scheme is not asked for.
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[derive(Clone, Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Inspect {
    /// A parameter of the scene: NAME=VALUE
    #[cfg_attr(feature = "clap", arg(long = "set", value_name = "NAME=VALUE"))]
    #[serde(skip)]
    pub sets: Vec<Set>,
}

impl Verb for Inspect {
    const NAME: &'static str = "inspect";
    const STORES: Stores = Stores::Nothing;
    const WRITES: bool = false;

    fn changes(&self) -> Changes {
        Changes {
            scheme: SchemeAndSeed { sets: self.sets.clone(), ..SchemeAndSeed::default() },
            ..Changes::default()
        }
    }

    fn compute(&self, scene: &Scene, _: &Store<'_>, watch: &Watch) -> Done<Found> {
        let model = &scene.model;
        let (problem, system) = (model.problem(), model.system());
        let (known, bath, findings) = watch.under("looking at points", 0, |_| {
            (
                model.known(),
                model.bath(),
                casimir::inspect::inspect(
                    system,
                    &InspectSettings {
                        run: Some(model.recommended()),
                        y0: Some(problem.y0.clone()),
                        damping: Some((problem.damping, problem.t_end)),
                        friction: model.friction(),
                        areas: system.description().jacobi_holds,
                    },
                ),
            )
        });
        let mut findings = findings.map_err(|error| refused(scene, error))?;
        if scene.problem().initial.is_some() {
            // The bound is for paths from one initial value.
            findings.problem.iter_mut().for_each(|problem| problem.radius = None);
        }
        // Those of schemes that run on the system.
        let runs = |id| BuiltIn::named(id).is_some_and(|scheme| model.scheme(scheme).is_ok());
        findings.orders.retain(|order| runs(order.scheme));
        let mut text = format!("{findings}\n");
        if let Some(bath) = &bath {
            text += &words(bath);
            if let Some(beta) = bath.beta {
                text += &further(scene, beta, findings.bound.is_some());
            }
        }
        let text = with_names(&text, &scene.components);
        let (parts, plain) = (system.description().parts.as_ref(), system.description().plain);
        let flows = parts.map_or(&[][..], |parts| &parts.words);
        let of_flows = match (parts, flows) {
            // Schemes of compiled systems have flows of their own.
            (Err(_), _) if known.equations.is_empty() || plain => String::new(),
            (Err(reason), _) => format!("\nNo flows, for split and nv: {reason}"),
            (Ok(parts), []) => format!("\nFlows, for split and nv: of {} parts", parts.number),
            (_, flows) => format!("\nFlows, for split and nv\n  - {}", flows.join("\n  - ")),
        };
        let (equation, remark) = (known.equation(), known.remark);
        let text = format!("{equation}{}{}{of_flows}\n", lines_of(&remark), text.trim_end());
        let mistakes = findings.mistakes.clone();
        let mut json = json!(findings);
        json["bath"] = json!(bath);
        json["flows"] = json!(flows);
        if let (true, Some(of_plain)) = (plain, json.as_object_mut()) {
            of_plain.retain(|key, _| {
                !["structure", "hamiltonians", "bath", "flows", "theorems", "has_flows"]
                    .contains(&&**key)
            });
        }
        let warnings = mistakes.into_iter().map(Warning::new).chain(remark);
        Ok(Found::new(warnings, text, json, Vec::new()))
    }
}

/// Describes the stationary law in words.
fn words(Bath { beta, any, mismatch }: &Bath) -> String {
    match beta {
        _ if *any => "Without damping and heat: every function of H0 is stationary".into(),
        Some(beta) => {
            let kt = digits(1.0 / beta);
            format!("Heat bath: exp(-H0/kT) is stationary with kT = {kt}")
        }
        None => format!("No heat bath:\n  - {}", mismatch.join("\n  - ")),
    }
}

/// Says of a bath whether exp(-H0/kT) has an integral, and whether its noises reach a whole leaf.
fn further(scene: &Scene, beta: f64, compact: bool) -> String {
    let (system, y0) = (scene.model.system(), scene.problem().y0);
    let name = |i: usize| &*scene.components[i];
    let integral = match growth(system, &y0, beta) {
        _ if compact => "it has an integral: leaves are compact".into(),
        Growth::Everywhere => "it has an integral, as far as H0 was looked at: H0 grows".into(),
        Growth::Falls(_) => "it has no integral: H0 falls without bound".into(),
        Growth::NotAlong(Some(i)) => {
            format!("it has no integral, unless {} is an angle: H0 does not grow with it", name(i))
        }
        Growth::NotAlong(None) => "it has no integral: H0 does not grow everywhere".into(),
        Growth::Unknown => "whether it has an integral is not known".into(),
    };
    let reach = span(system, &y0).map(|Span { reached, leaf, never }| {
        let never: Vec<&str> = never.into_iter().map(name).collect();
        let which =
            if never.is_empty() { String::new() } else { format!(", not {}", never.join(", ")) };
        if reached == leaf {
            format!("\n  - its noises reach all {leaf} directions of a leaf")
        } else {
            format!(
                "\n  - its noises reach {reached} of {leaf} directions of a leaf{which}: averages \
                 depend on where chains begin"
            )
        }
    });
    format!("\n  - {integral}{}", reach.unwrap_or_default())
}
