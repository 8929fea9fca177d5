//! What follows from findings, and its words: every case on findings that are made up.

use super::{
    super::{
        finding::Status::{self, Found, Refuted, Shown, Unknown},
        problem::Bound,
        theory::{orders, theorems},
        *,
    },
    *,
};
use Applies::{Conditionally, No, Yes};
use systems::Linearity;

/// A finding of this status, with a defect and a bound to print.
fn finding(status: Status) -> Finding {
    let mut finding = Finding::default();
    (finding.status, finding.points, finding.at) = (status, 3, vec![1.0]);
    (finding.defect, finding.round_off) = (0.5, 1e-15);
    finding
}

/// Canonical variables, H₁ = H₀/2 of degree two: everything is shown.
fn sound() -> Inspection {
    let mut report = inspect(&valid(Pendulum::new(0.7))).unwrap();
    let shape = Shape {
        kind: Kind::Quadratic,
        degree: Some(2.0),
        degree_error: 0.0,
        homogeneous: finding(Shown),
        constant_hessian: finding(Shown),
        minimum: Some(minimum(0.5, Shown)),
    };
    report.hamiltonians.shapes = vec![shape.clone(), shape];
    report.hamiltonians.noise_size = Some(0.5);
    report.hamiltonians.proportional = Some(finding(Shown));
    report.hamiltonians.discrete_gradient = finding(Shown);
    report.structure.linear = finding(Shown);
    report.structure.skew = finding(Shown);
    report.structure.constant = finding(Shown);
    report
}

fn minimum(value: f64, positive: Status) -> Minimum {
    Minimum { value, error: 1e-3, positive, in_domain_only: false }
}

fn bound(report: &Inspection) -> Option<Bound> {
    Bound::of(&report.structure, &report.hamiltonians, &report.casimirs)
}

/// (applies, because) of the statements, in the order of the report.
fn statements(report: &Inspection) -> Vec<(Applies, String)> {
    let Inspection { structure, hamiltonians, casimirs, noise, invariants, .. } = report;
    let bound = bound(report);
    let all = theorems(structure, hamiltonians, casimirs, noise, invariants, bound.as_ref());
    all.into_iter().map(|theorem| (theorem.applies, theorem.because)).collect()
}

const EXACT: usize = 0;
const CASIMIR: usize = 1;
const ENERGY: usize = 2;
const BOUND: usize = 3;
const SOLVABLE: usize = 4;
const STRONG: usize = 5;

/// What one statement says of the sound system with one change.
fn says(statement: usize, change: impl Fn(&mut Inspection)) -> (Applies, String) {
    let mut report = sound();
    change(&mut report);
    statements(&report)[statement].clone()
}

fn words(applies: Applies, because: &str) -> (Applies, String) {
    (applies, because.to_owned())
}

#[test]
fn the_energy_law_needs_one_noise_a_degree_and_an_exact_average() {
    let of = |change: &dyn Fn(&mut Hamiltonians)| says(ENERGY, |r| change(&mut r.hamiltonians));
    let law = "H₁ = 0.5 H₀, H₀ is homogeneous of degree 2, and ∇̄h is exact";
    assert_eq!(of(&|_| ()), words(Yes, &format!("{law} (shown)")));
    let found = words(Conditionally, &format!("{law} (found by search)"));
    assert_eq!(of(&|h| h.discrete_gradient = finding(Found)), found);
    assert_eq!(of(&|h| h.shapes[0].homogeneous = finding(Found)), found);
    assert_eq!(of(&|h| h.proportional = Some(finding(Found))), found);
    let inexact = words(Conditionally, "up to the error of ∇̄h; take more nodes or a closed form");
    assert_eq!(of(&|h| h.discrete_gradient = finding(Refuted)), inexact);
    assert_eq!(of(&|h| h.discrete_gradient = finding(Unknown)), inexact);
    let none = |h: &mut Hamiltonians, status| {
        (h.shapes[0].degree, h.shapes[0].homogeneous) = (None, finding(status));
    };
    assert_eq!(of(&|h| none(h, Refuted)), words(No, "H₀ is not homogeneous"));
    let unknown = words(Conditionally, "cannot tell whether H₁ = c H₀ with a homogeneous H₀");
    assert_eq!(of(&|h| none(h, Unknown)), unknown);
    let other = |h: &mut Hamiltonians, status| {
        (h.noise_size, h.proportional) = (None, Some(finding(status)));
    };
    let many = words(No, "there is not one noise with H₁ = c H₀");
    assert_eq!(of(&|h| other(h, Refuted)), many);
    assert_eq!(of(&|h| other(h, Unknown)), unknown);
    // Two noises that are one, or are not, and none.
    let two = |h: &mut Hamiltonians, status| {
        other(h, status);
        h.shapes.push(h.shapes[1].clone());
    };
    let both = law.replace("H₁ = 0.5 H₀", "Hₘ = cₘ H₀ for every m");
    assert_eq!(of(&|h| two(h, Shown)), words(Yes, &format!("{both} (shown)")));
    assert_eq!(of(&|h| two(h, Refuted)), many);
    let silent = law.replace("H₁ = 0.5 H₀", "no noise");
    assert_eq!(of(&|h| h.shapes.truncate(1)), words(Yes, &format!("{silent} (shown)")));
    // B must be skew-symmetric, and must be known to be.
    let skew = |status| says(ENERGY, |r| r.structure.skew = finding(status));
    assert_eq!(skew(Refuted), words(No, "B is not skew-symmetric"));
    let doubt = |name| format!("{law} (shown); B is skew-symmetric ({name})");
    assert_eq!(skew(Found), words(Conditionally, &doubt("found by search")));
    assert_eq!(skew(Unknown), words(Conditionally, &doubt("cannot tell")));
}

#[test]
fn laws_of_casimirs_are_as_sure_as_the_least_sure_one() {
    let body = inspect(&valid(RigidBody::one_noise([1.0, 2.0, 4.0], 5.0))).unwrap();
    let sphere = "0.5 y1² + 0.5 y2² + 0.5 y3²";
    let casimir = |status| {
        let mut casimir = body.casimirs.found[0].clone();
        casimir.casimir = finding(status);
        casimir
    };
    let of = |statement, found: &[Status], complete| {
        says(statement, |r| {
            r.casimirs.found = found.iter().map(|&status| casimir(status)).collect();
            r.casimirs.complete = complete;
        })
    };
    let one = words(Yes, &format!("{sphere} (shown)"));
    assert_eq!(of(CASIMIR, &[Shown], Unknown), one);
    let two = format!("{sphere} (shown); {sphere} (found by search)");
    assert_eq!(of(CASIMIR, &[Shown, Found], Shown), words(Conditionally, &two));
    assert_eq!(of(EXACT, &[Shown], Shown), words(Yes, &format!("{sphere} (shown); H₀ (shown)")));
    let none = "linear or quadratic Casimir of B";
    assert_eq!(of(CASIMIR, &[], Shown), words(No, &format!("no {none}")));
    let unknown = words(Conditionally, &format!("cannot tell whether there is a {none}"));
    assert_eq!(of(CASIMIR, &[], Unknown), unknown);
    let doubt = says(EXACT, |r| r.hamiltonians.proportional = Some(finding(Unknown)));
    assert!(doubt.0 == No && doubt.1.starts_with("no linear or quadratic Casimir"), "{doubt:?}");
    // True claims have laws, too; those on the energy are that of the energy.
    let claim = |claimed_casimir, status| {
        says(EXACT, |r| {
            let claim = ClaimedInvariant { claimed_casimir, ..body.invariants[0].clone() };
            r.invariants = vec![ClaimedInvariant { casimir: finding(status), ..claim }];
            r.casimirs.found.clear();
        })
    };
    assert_eq!(claim(true, Shown), words(Yes, "C (shown); H₀ (shown)"));
    assert_eq!(claim(true, Refuted), words(Yes, "H₀ (shown)"));
    assert_eq!(claim(false, Shown), words(Yes, "H₀ (shown)"));
}

#[test]
fn steps_are_solvable_where_derivatives_are_bounded() {
    let of = |constant, hessian, positive| {
        says(SOLVABLE, |r| {
            r.structure.constant = finding(constant);
            r.hamiltonians.shapes[1].constant_hessian = finding(hessian);
            r.hamiltonians.shapes[0].minimum = Some(minimum(0.5, positive));
        })
    };
    let both = "B and the Hessians are constant";
    assert_eq!(of(Shown, Shown, Shown), words(Yes, &format!("{both} (shown)")));
    let found = words(Conditionally, &format!("{both} (found by search)"));
    assert_eq!((of(Shown, Found, Shown), of(Found, Shown, Shown)), (found.clone(), found));
    let second = "if the second derivatives of all Hamiltonians are bounded";
    assert_eq!(of(Shown, Refuted, Shown), words(Conditionally, second));
    let ball = words(Conditionally, "in the ball of the moment bound");
    assert_eq!(of(Refuted, Shown, Shown), ball);
    let region = words(Conditionally, "if paths stay in the region of the points");
    assert_eq!(of(Refuted, Shown, Refuted), region);
}

#[test]
fn orders_hold_while_paths_are_bounded_and_formulas_smooth() {
    let of = |statement, pieces, positive, in_domain_only| {
        says(statement, |r| {
            r.noise.pieces = pieces;
            let least = Minimum { in_domain_only, ..minimum(0.5, positive) };
            r.hamiltonians.shapes[0].minimum = Some(least);
        })
    };
    let least = "m(H₀) = 5.0000e-1 > 0 (shown)";
    assert_eq!(of(BOUND, false, Shown, false), words(Yes, least));
    assert_eq!(of(STRONG, false, Shown, false), words(Yes, least));
    let smooth = format!("{least}; if B and the energy are smooth");
    assert_eq!(of(STRONG, true, Shown, false), words(Conditionally, &smooth));
    let found = "m(H₀) = 5.0000e-1 > 0 (found by search)";
    assert_eq!(of(BOUND, false, Found, false), words(Conditionally, found));
    let domain = format!(
        "{found} on the domain while paths stay in the domain, on which it is positive \
         (found by search)"
    );
    assert_eq!(of(BOUND, false, Found, true), words(Conditionally, &domain));
    let none = "found no linear or quadratic Casimir or energy with m(F) > 0";
    assert_eq!(of(BOUND, false, Unknown, false), words(No, none));
    let unbounded = "if all paths stay bounded, which was not proved here";
    assert_eq!(of(STRONG, false, Refuted, false), words(Conditionally, unbounded));
}

#[test]
fn the_surest_bound_is_taken_and_that_of_a_casimir_first() {
    let body = inspect(&valid(RigidBody::one_noise([1.0, 2.0, 4.0], 5.0))).unwrap();
    let of = |casimir: Minimum, energy: Minimum| {
        let mut report = sound();
        report.casimirs = body.casimirs.clone();
        report.casimirs.definite = None;
        report.casimirs.found[0].minimum = casimir;
        report.hamiltonians.shapes[0].minimum = Some(energy);
        bound(&report).map(|bound| (bound.function == "H₀", bound.status))
    };
    let (shown, found, unknown) = (minimum(0.5, Shown), minimum(0.5, Found), minimum(0.5, Unknown));
    let domain = Minimum { in_domain_only: true, ..shown };
    assert_eq!(of(shown, shown), Some((false, Shown)));
    assert_eq!(of(found, shown), Some((true, Shown)));
    assert_eq!(of(domain, found), Some((true, Found)));
    assert_eq!(of(unknown, found), Some((true, Found)));
    assert_eq!(of(unknown, unknown), None);
    // (F(y)/(m − error))^{1/p}: (8/(0.5 − 0.001))^{1/4} for a quartic F = 8.
    let plane = valid(Problem::new(EVERYWHERE, valid(Constant::new(-0.5)), [4.0, 0.0], 2.0));
    let mut report = sound();
    (report.hamiltonians.shapes[0].degree, report.casimirs.found) = (Some(4.0), Vec::new());
    let system = Erased::<_, 2, 1>(&EVERYWHERE);
    let findings = ProblemFindings::of(
        plane.damping(),
        &plane.y0(),
        plane.t_end(),
        &system,
        bound(&report).as_ref(),
    );
    let radius = (8.0f64 / 0.499).powf(0.25) * 1f64.exp();
    assert!((findings.radius.unwrap() / radius - 1.0).abs() < 1e-12, "{findings:?}");
    // A constant bounds nothing.
    report.hamiltonians.shapes[0].degree = Some(0.0);
    assert_eq!(bound(&report), None);
}

/// The same with another one in this place.
fn but<T, const N: usize>(place: usize, other: T, mut all: [T; N]) -> [T; N] {
    all[place] = other;
    all
}

#[test]
fn orders_follow_from_what_commutes_and_from_where_paths_are() {
    let noises = |commute, no_correction, pieces| Noises {
        commute: finding(commute),
        no_correction: finding(no_correction),
        silent: finding(Refuted),
        pieces,
        ..Noises::default()
    };
    let of = |noises: &Noises| -> Vec<(f64, f64, Status)> {
        orders(noises, true).iter().map(|order| (order.strong, order.weak, order.known)).collect()
    };
    let (one, half) = ((1.0, 1.0, Shown), (0.5, 1.0, Shown));
    let weak_two = |(strong, _, known)| (strong, 2.0, known);
    // sexp, sexp-levy, sexp-li, sexp-li-levy, split, nv, midpoint, heun and em.
    assert_eq!(of(&noises(Shown, Shown, false)), but(5, weak_two(one), [one; 9]));
    let with_areas = [half, one, half, one, half, weak_two(half), half, half, half];
    assert_eq!(of(&noises(Refuted, Refuted, false)), with_areas);
    let (found, doubt) = ((1.0, 1.0, Found), (0.5, 1.0, Unknown));
    let nv_found = but(5, weak_two(found), [found; 9]);
    assert_eq!(of(&noises(Found, Unknown, true)), but(8, doubt, nv_found));
    // A counterexample off the paths does not tell on which order there is.
    let calm = [finding(Found), finding(Refuted)];
    let special = Noises { on_paths: calm, ..noises(Refuted, Refuted, false) };
    let nv = weak_two(doubt);
    assert_eq!(of(&special), [doubt, one, doubt, one, doubt, nv, doubt, doubt, half]);
    let silent = Noises { silent: finding(Found), ..noises(Shown, Shown, false) };
    assert_eq!(of(&silent), but(8, (1.0, 1.0, Found), [(2.0, 2.0, Found); 9]));
}

#[test]
fn a_scheme_is_recommended_for_what_it_keeps() {
    let body = inspect(&valid(RigidBody::one_noise([1.0, 2.0, 4.0], 5.0))).unwrap();
    let of = |change: &dyn Fn(&mut Inspection), damped| {
        let mut report = sound();
        report.noise.commute = finding(Shown);
        report.noise.silent = finding(Refuted);
        report.without_iteration.structure = Linearity::Affine;
        change(&mut report);
        report = report.with_recommendations(damped);
        let said = report.recommended.iter();
        said.map(|taken| format!("{} {}: {}", taken.scheme, taken.purpose.name(), taken.because))
            .collect::<Vec<_>>()
    };
    let usual = |change: &dyn Fn(&mut Inspection)| of(change, true);
    let large = "sexp-li for large noise: every step has a solution, so no increment is truncated";
    let energy = "sexp for paths: it keeps the energy".to_owned();
    let weak = "sexp-li for expectations: mc::expect extrapolates weak order 1; with flows of parts take nv";
    assert_eq!(usual(&|_| ()), [&energy, weak, large]);
    let constant = usual(&|r| r.without_iteration.structure = Linearity::Constant);
    assert_eq!(constant, [&*energy, &weak.replacen("sexp-li", "sexp", 1)]);
    // Without areas any scheme for paths is one for expectations.
    let refused = usual(&|r| r.without_iteration.refused = Some("no".into()));
    assert_eq!(refused, [energy.as_str()]);
    let inexact = usual(&|r| r.hamiltonians.discrete_gradient = finding(Refuted));
    assert_eq!(inexact[0], format!("{energy}; the energy up to the error of ∇̄h"));
    // Nothing found to keep: never an explicit scheme.
    let no_energy = |r: &mut Inspection| r.hamiltonians.shapes[0].degree = None;
    let exact = "sexp for paths: it damps exactly, and keeps the energy but for the noise";
    assert_eq!(usual(&no_energy)[0], exact);
    assert_eq!(usual(&|r| r.hamiltonians.proportional = Some(finding(Refuted)))[0], exact);
    assert_eq!(usual(&|r| r.structure.skew = finding(Refuted)), [exact, weak]);
    assert_eq!(of(&no_energy, false)[0], energy);
    // Casimirs, with and without an energy, and where sexp-li refuses the system or truncates.
    let price = "it keeps the Casimirs at about the price of heun, and the energy drifts";
    let casimir = |r: &mut Inspection| r.casimirs = body.casimirs.clone();
    let both = usual(&casimir);
    assert_eq!(both[0], "sexp for paths: it keeps the energy and the Casimirs");
    let short = format!("sexp-li for short paths: {price}");
    assert_eq!(both[1], short);
    let only = |r: &mut Inspection| (casimir(r), no_energy(r)).1;
    let kept = "sexp for paths: it keeps the Casimirs, and the energy but for the noise";
    assert_eq!(usual(&only), [kept, &short, weak, large]);
    let refused = usual(&|r| {
        only(r);
        r.without_iteration.refused = Some("no".into());
        r.without_iteration.nv_refused = Some("no".into());
    });
    assert_eq!(refused, [kept]);
    let truncates = usual(&|r| (only(r), r.without_iteration.truncates = true).1);
    assert_eq!(truncates, [kept, &short, weak]);
    let areas = usual(&|r| {
        only(r);
        r.noise.commute = finding(Refuted);
        r.without_iteration.draws_areas = true;
    });
    assert_eq!(
        areas[0],
        format!("{}; Lévy areas give strong order 1", kept.replacen("sexp", "sexp-levy", 1))
    );
}

#[test]
fn a_claim_is_as_sure_as_its_law_and_its_degree() {
    let body = inspect(&valid(RigidBody::one_noise([1.0, 2.0, 4.0], 5.0))).unwrap();
    let status = |claimed_casimir, casimir, conserved, homogeneous| {
        let mut claim = ClaimedInvariant { claimed_casimir, ..body.invariants[0].clone() };
        (claim.casimir, claim.conserved) = (finding(casimir), finding(conserved));
        claim.shape.homogeneous = finding(homogeneous);
        claim.status()
    };
    assert_eq!(status(true, Shown, Refuted, Shown), Shown);
    assert_eq!(status(true, Found, Shown, Shown), Found);
    assert_eq!(status(false, Refuted, Unknown, Shown), Unknown);
    assert_eq!(status(true, Shown, Shown, Found), Found);
    let mistaken = ClaimedInvariant { mistakes: vec!["one".into()], ..body.invariants[0].clone() };
    assert_eq!(mistaken.status(), Refuted);
}

/// The lines of a report that have this label.
fn line(report: &Inspection, label: &str) -> String {
    let text = report.to_string();
    let mut lines = text.lines().skip_while(|line| !line.trim_start().starts_with(label));
    let first = lines.next().unwrap_or_else(|| panic!("{label}: {text}")).to_owned();
    let next = lines.take_while(|line| line.starts_with("           "));
    next.fold(first, |all, line| format!("{all}\n{}", line.trim_start()))
}

#[test]
fn every_status_has_its_words() {
    let of = |label: &str, change: &dyn Fn(&mut Inspection)| {
        let mut report = sound();
        report.noises = 2;
        change(&mut report);
        line(&report, label)
    };
    let (defect, rough) =
        ("defect 5.0e-1 at [1.000], round-off 1e-15", "too much round-off, 1e-15, at [1.000]");
    let skew = |status| of("B(y)", &|r| r.structure.skew = finding(status));
    let jacobi = "constant (shown, to 1e-15); Jacobi identity (shown)";
    let b = |skew: String| format!("  B(y)     {skew}\n{jacobi}");
    assert_eq!(skew(Shown), b("skew-symmetric (shown, to 1e-15)".into()));
    assert_eq!(skew(Unknown), b(format!("skew-symmetric? ({rough})")));
    assert_eq!(skew(Refuted), b(format!("NOT skew-symmetric, see below ({defect})")));
    let found = of("B(y)", &|r| r.structure.constant = finding(Found));
    assert!(found.ends_with("\nconstant (found at 3 points, to 1e-15); Jacobi identity (shown)"));
    let bent = of("B(y)", &|r| {
        (r.structure.constant, r.structure.jacobi) = (finding(Refuted), finding(Refuted));
    });
    let none = format!("\ndepends on y; no Jacobi identity, not needed ({defect})");
    assert!(bent.ends_with(&none), "{bent}");
    let crooked = of("B(y)", &|r| r.structure.linear = finding(Refuted));
    assert_eq!(crooked, "  B(y)     structure(y, v) is NOT linear in v, see below");

    let least = "5.0000e-1 > 0 (shown)";
    let quadratic = format!("quadratic, degree 2 (shown, to 1e-15), m = {least}");
    assert_eq!(of("H0", &|_| ()), format!("  H0       {quadratic}"));
    let c = "  H1       c H0 up to a constant, c = 0.5 (shown, to 1e-15)";
    assert_eq!(of("H1", &|_| ()), c);
    let own = of("H1", &|r| r.hamiltonians.noise_size = None);
    assert_eq!(own, format!("  H1       {quadratic}"));
    let quartic = of("H0", &|r| {
        (r.hamiltonians.shapes[0].kind, r.hamiltonians.shapes[0].minimum) =
            (Kind::Homogeneous, None);
    });
    assert_eq!(quartic, "  H0       homogeneous of degree 2 (shown, to 1e-15)");
    let average = |status| of("∇̄h", &|r| r.hamiltonians.discrete_gradient = finding(status));
    assert_eq!(average(Found), "  ∇̄h       exact (found at 3 points, to 1e-15)");
    assert_eq!(average(Unknown), format!("  ∇̄h       exact? {rough}"));
    assert!(average(Refuted).starts_with("  ∇̄h       NOT exact: relative error "));
    let commute = |status| of("noises", &|r| r.noise.commute = finding(status));
    let areas = "  noises   commute: strong order 1 needs no Lévy areas\n(shown, to 1e-15)";
    assert_eq!(commute(Shown), areas);
    assert_eq!(commute(Unknown), format!("  noises   commute?\n({rough})"));
    let none = format!("  noises   do not commute: strong order 1 needs Lévy areas\n({defect})");
    assert_eq!(commute(Refuted), none);
    let one = Inspection { noises: 1, ..sound() };
    assert!(!one.to_string().contains("  noises"), "{one}");

    let casimirs = |change: &dyn Fn(&mut Casimirs)| of("Casimirs", &|r| change(&mut r.casimirs));
    let head =
        |sought, none| format!("  Casimirs of B, {sought}, coefficients to six digits:{none}");
    assert_eq!(casimirs(&|_| ()), head("linear or quadratic", " none (shown)"));
    let unknown = casimirs(&|c| (c.complete, c.quadratic_sought) = (Unknown, false));
    assert_eq!(unknown, head("linear", " none found"));
    let body = inspect(&valid(RigidBody::one_noise([1.0, 2.0, 4.0], 5.0))).unwrap();
    for (status, is, has) in [(Refuted, "not", defect), (Unknown, "perhaps", rough)] {
        let nearly = FoundCasimir { casimir: finding(status), ..body.casimirs.found[0].clone() };
        let mut report = sound();
        report.casimirs.nearly.push(nearly);
        let words = format!("    {is} 0.5 y1² + 0.5 y2² + 0.5 y3²: B∇C has {has}\n");
        assert!(report.to_string().contains(&words), "{report}");
    }
}

#[test]
fn what_helps_no_one_is_not_printed() {
    let of = |norm: f64, change: &dyn Fn(&mut Inspection)| {
        let mut report = sound();
        (report.solvability.structure, report.solvability.hessians) = (1.0, vec![norm; 2]);
        change(&mut report);
        report.to_string()
    };
    let (bound, none) = ("are contractions, C(k, τ) < 1", "no useful bound of τ");
    let text = of(1.0, &|_| ());
    assert!(text.contains(bound) && !text.contains(none), "{text}");
    let text = of(1e8, &|_| ());
    assert!(text.contains(none) && !text.contains(bound), "{text}");
    // Canonical variables have no Casimir.
    let split = "split keeps every Casimir";
    assert!(!text.contains(split), "{text}");
    let body = inspect(&valid(RigidBody::one_noise([1.0, 2.0, 4.0], 5.0))).unwrap();
    assert!(of(1.0, &|r| r.casimirs = body.casimirs.clone()).contains(split));
    // One that is claimed and may be one.
    let claim = |status, linear| {
        of(1.0, &|r| {
            r.invariants = vec![body.invariants[0].clone()];
            r.invariants[0].casimir = finding(status);
            r.structure.linear = finding(linear);
        })
    };
    assert!(claim(Found, Shown).contains(split));
    assert!(!claim(Refuted, Shown).contains(split) && !claim(Found, Refuted).contains(split));
}

#[test]
fn advice_names_the_schemes_and_how_many_nodes_are_exact() {
    let gains = |report: Inspection| {
        let all = report.overrides.iter();
        let mut average = all.filter(|one| one.method == "averaged_gradient");
        average.next().map(|one| one.gains.clone())
    };
    let polynomial = |degree| gains(inspect(&Power { degree, cosine: false }).unwrap());
    assert_eq!(polynomial(2), None);
    let four = "∇̄h takes 8 evaluations of ∇h; dgrad::averaged::<2, _, _, 2> is exact with 2";
    assert_eq!(polynomial(4).as_deref(), Some(four));
    assert_eq!(polynomial(16), None);
    let many = "8 nodes are not exact; dgrad::averaged::<9, _, _, 2> is";
    assert_eq!(polynomial(18).as_deref(), Some(many));
    let report = inspect(&Power { degree: 2, cosine: true }).unwrap();
    let words = "  averaged_gradient, for sexp, sexp-levy and sexp-li: ∇̄h takes 8 evaluations of ∇h \
                 and is as exact as the line ∇̄h says; sines and cosines of one coordinate";
    assert!(report.to_string().contains(words), "{report}");
}

/// H₀ = y₁ⁿ + y₂², and a cosine.
struct Power {
    degree: i32,
    cosine: bool,
}

impl PoissonSystem<2, 1> for Power {
    fn name(&self) -> &'static str {
        "power"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [-v[1], v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        let h = y[0].powi(self.degree) + y[1] * y[1];
        let h = if self.cosine { h + y[0].cos() } else { h };
        h * (dt + dw[0])
    }
}
