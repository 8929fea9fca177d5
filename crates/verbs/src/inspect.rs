//! Inspection of a system.

use casimir::{
    inspect::{
        InspectSettings,
        facts::{Bath, Growth, Span, growth, span},
    },
    schemes::BuiltIn,
    stats::Warning,
};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::{Found, Store, Stores, Verb, Watch};
use crate::failure::Done;
use scenes::{Changes, Scene, SchemeAndSeed, Set, digits, model::with_names};

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
        let scheme = SchemeAndSeed { sets: self.sets.clone(), ..SchemeAndSeed::default() };
        Changes { scheme, ..Changes::default() }
    }

    fn compute(&self, scene: &Scene, _: &Store, watch: &Watch) -> Done<Found> {
        let model = &scene.model;
        let (problem, system) = (model.problem(), model.system());
        let (known, bath, findings) = watch.under("looking at points", 0, |_| {
            let settings = InspectSettings {
                run: Some(model.recommended()),
                y0: Some(problem.y0.clone()),
                damping: Some((problem.damping, problem.t_end)),
                friction: model.friction(),
                areas: system.description().jacobi_holds,
            };
            (model.known(), model.bath(), casimir::inspect::inspect(system, &settings))
        });
        let mut findings = findings.map_err(|error| scene.source.error(None, error))?;
        // Those of schemes that run on the system.
        let runs = |id| BuiltIn::ALL.into_iter().any(|s| s.id() == id && model.scheme(s).is_ok());
        findings.orders.retain(|order| runs(order.scheme));
        let law = bath.as_ref().map_or(String::new(), words);
        let beta = bath.as_ref().and_then(|bath| bath.beta);
        let further = beta.map(|beta| further(scene, beta, findings.bound.is_some()));
        let text = format!("{findings}\n{law}{}", further.unwrap_or_default());
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
        let text = format!("{}{}{of_flows}\n", known.equation(), text.trim_end());
        let mistakes = findings.mistakes.clone();
        let mut json = json!(findings);
        json["bath"] = json!(bath);
        json["flows"] = json!(flows);
        if let (true, Some(of_plain)) = (plain, json.as_object_mut()) {
            let of_others = ["structure", "hamiltonians", "bath", "flows", "theorems", "has_flows"];
            of_plain.retain(|key, _| !of_others.contains(&&**key));
        }
        Ok(Found::new(mistakes.into_iter().map(Warning::new), text, json, Vec::new()))
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
        match reached == leaf {
            true => format!("\n  - its noises reach all {leaf} directions of a leaf"),
            false => format!(
                "\n  - its noises reach {reached} of {leaf} directions of a leaf{which}: averages \
                 depend on where chains begin"
            ),
        }
    });
    format!("\n  - {integral}{}", reach.unwrap_or_default())
}
