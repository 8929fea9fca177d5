//! Which statements of the paper apply, the orders that theory predicts, and the schemes to take.

use schemes::{BuiltIn, Properties, SexpLi, StrongOrder};
use systems::{Linearity, run_time::System};

use super::{
    Applies, ExpectedOrder, FoundCasimir, InspectSettings, Inspection, Recommendation, Status,
    Theorem,
};
use crate::facts::Conserved;

/// Orders of the [built-in schemes](BuiltIn) for smooth B and H. Schemes with Lévy areas are listed
/// if `areas` are drawn, schemes that read rates of the damping if these are finite. Strong order
/// one takes Lévy areas where noises do not commute. The strong order of `em` is at least ½.
pub fn orders(report: &Inspection, areas: bool, finite_rates: bool) -> Vec<ExpectedOrder> {
    let noise = &report.noise;
    // A counterexample shows that the order is ½, unless paths stay where there is none.
    let elsewhere = noise.at_start.points > 0 && !noise.at_start.fails();
    let commuting = match noise.commute.status {
        Status::Holds => (1.0, Status::Holds),
        Status::Fails if !elsewhere => (0.5, Status::Holds),
        _ => (0.5, Status::Unknown),
    };
    let expected = |scheme: BuiltIn| {
        let Properties { id, strong, weak, without_noise, .. } = scheme.properties();
        let silent = report.hamiltonians.silent;
        let (strong, known) = match strong {
            _ if silent => (without_noise, Status::Holds),
            StrongOrder::Areas => (1.0, Status::Holds),
            StrongOrder::Commuting => commuting,
            StrongOrder::SpaceTime => (if report.is_langevin { 2.0 } else { 1.5 }, Status::Holds),
            StrongOrder::Additive => (0.5, Status::Unknown),
        };
        let weak = if silent { without_noise } else { weak };
        ExpectedOrder { scheme: id, strong, weak, known }
    };
    let (commute, constant) = (noise.commute.holds(), !report.depends_on_time);
    let is_sound = |scheme: &BuiltIn| match scheme {
        _ if !areas && scheme.is_for_areas() => false,
        _ if !finite_rates && !scheme.properties().exact_damping => false,
        _ if report.fields.is_some() => scheme.is_for_plain(),
        BuiltIn::Baoab => report.has_flows && commute,
        BuiltIn::SplitH => report.has_flows && commute && constant,
        BuiltIn::SexpH => commute && constant,
        // With B and H sexp-levy keeps more.
        BuiltIn::HeunLevy => false,
        _ => true,
    };
    BuiltIn::ALL.into_iter().filter(is_sound).map(expected).collect()
}

/// Statements of the paper for a system with these properties, with damping or without. Where the
/// equation is not `theirs`, with friction on single components or a bath, those on paths do not
/// apply.
pub fn theorems(report: &Inspection, damped: bool, theirs: bool) -> Vec<Theorem> {
    use Applies::{Conditionally, No, Yes};
    let Inspection { structure, hamiltonians, casimirs, bound, .. } = report;
    let (shape, proportional) = (&hamiltonians.shapes[0], hamiltonians.proportional.status);
    let casimirs = casimirs.as_ref();
    let found = casimirs.is_some_and(|casimirs| !casimirs.found.is_empty());
    let complete = casimirs.is_some_and(|casimirs| casimirs.complete);
    let each = |any: bool| match any {
        true => Yes,
        false if complete => No,
        false => Conditionally,
    };
    let law = proportional.holds() && shape.degree.is_some();
    let energy = match proportional {
        Status::Fails => No,
        Status::Holds if law && hamiltonians.discrete_gradient.holds() => Yes,
        // Without damping the energy is constant, homogeneous or not.
        Status::Holds if damped && shape.homogeneous.fails() => No,
        _ => Conditionally,
    };
    let bounded = match bound {
        Some(bound) if bound.minimum.in_domain_only => Conditionally,
        Some(_) => Yes,
        None => No,
    };
    let quadratic = hamiltonians.shapes.iter().all(|h| h.minimum.is_some() || h.is_zero());
    let solvable = structure.constant.holds() && quadratic;
    // The paper assumes that exact and numerical paths are bounded.
    let orders = if bounded == No { Conditionally } else { bounded };
    let strong = if report.noises > 1 { "strong-half" } else { "strong-one" };
    let theorem = |(statement, applies)| {
        let applies = match structure.sound() {
            _ if !theirs && statement != "solvability" => No,
            Status::Fails => No,
            Status::Unknown if applies == Yes => Conditionally,
            _ => applies,
        };
        Theorem { statement, applies }
    };
    [
        ("exact-conformal", each(report.has_claimed_casimir() || found || law)),
        ("conformal-casimir", each(found)),
        ("energy-balance", energy),
        ("moment-bound", bounded),
        ("solvability", if solvable { Yes } else { Conditionally }),
        (strong, orders),
        ("weak-one", orders),
    ]
    .map(theorem)
    .into()
}

/// Recommended schemes for a system with damping or without, the scheme for paths first.
pub fn recommendations(
    report: &Inspection,
    system: &dyn System,
    settings: &InspectSettings<'_>,
    damped: bool,
) -> Vec<Recommendation> {
    let Inspection { structure, hamiltonians, casimirs, noise, .. } = report;
    // Which laws friction leaves is not looked at here.
    let sound = structure.sound() != Status::Fails && settings.friction.is_empty();
    let plain = report.fields.is_some();
    let counts = |found: &FoundCasimir| !plain || found.form.degree == 2;
    let found = match casimirs {
        Some(casimirs) => casimirs.found.iter().any(counts),
        None => report.has_claimed_casimir(),
    };
    let lawful = hamiltonians.shapes.first().is_some_and(|h0| h0.degree.is_some()) || !damped;
    let kept = Conserved {
        casimirs: sound && found,
        energy: sound && !plain && hamiltonians.proportional.holds() && lawful,
        areas: settings.areas && !noise.commute.holds(),
        noise: !hamiltonians.silent && report.noises > 0,
        damped: damped || !settings.friction.is_empty(),
    };
    let (scheme, mut because) = settings.run.clone().unwrap_or_else(|| kept.scheme(system));
    if !hamiltonians.discrete_gradient.holds() && ["sexp", "sexp-levy"].contains(&scheme) {
        because += "; the energy up to the error of ∇̄h";
    }
    if !plain && casimirs.as_ref().is_some_and(|casimirs| !casimirs.logarithmic.is_empty()) {
        because += "; split alone keeps the Casimir with logarithms";
    }
    let mut found = vec![Recommendation { purpose: "paths", scheme, because }];
    let linear = SexpLi::at_run_time(system).is_ok();
    if !plain && !hamiltonians.silent && (linear || kept.areas) {
        // Without iteration a step is explicit where B is constant.
        let implicit = linear && system.description().linearity == Linearity::Affine;
        let scheme = if implicit { "sexp-li" } else { "sexp" };
        let because = "weak order 1 is extrapolated; with flows of parts take nv".into();
        found.push(Recommendation { purpose: "expectations", scheme, because });
    }
    found
}
