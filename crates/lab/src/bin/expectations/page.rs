//! `docs/expectations.md`, made from the measurements.

use report::{
    Page,
    figure::{Curve, Figure, Measured, Plot, Spacing, Style},
    number,
    provenance::generated_by,
};

use crate::{
    bias::STEPS,
    results::{
        BiasPoint, Cost, FunctionBias, FunctionOrder, Measurements, Method, Orders, ProblemOrders,
        SchemeBias, SchemeOrders, Slope,
    },
};

/// The whole page with its figures.
pub fn page(measured: &Measurements) -> Page {
    let mut page = Page::new("Expectations");
    page.paragraph(format!(
        "What does an expectation cost, and how large is the bias of a scheme? {} The load average \
         of the minute before was {}: {}. Times hold for that machine.",
        generated_by(&measured.provenance),
        measured.load.map_or("not known".into(), |load| format!("{load:.2}")),
        match measured.load {
            Some(load) if load < 0.5 => "little else ran at the start",
            Some(_) => "other work ran beside, or had just ended",
            None => "other work may have run beside",
        },
    ));
    page.paragraph(PROBLEM);
    page.heading(2, "Cost of E[cos y₃]");
    page.paragraph(format!("{METHOD} Processor time is: {}.", measured.clock));
    page.list(measured.methods.iter().map(exponents));
    let steps = |row: &Cost| row.path_steps as f64;
    let drawing = figure(&measured.methods, "path-steps", steps, |method| method.beyond_pilot);
    page.figure("expectations-path-steps.svg", "Path-steps against accuracy", drawing);
    let seconds = |row: &Cost| row.processor_s;
    let drawing = figure(&measured.methods, "processor seconds", seconds, |m| m.beyond_pilot_s);
    page.figure("expectations-seconds.svg", "Processor seconds against accuracy", drawing);
    page.paragraph(PATHS_COMPARED);
    let head = ["ε", "against", "path-steps", "processor seconds"];
    page.table(head, compared(&measured.methods));
    for method in &measured.methods {
        section(&mut page, method);
    }
    twelve(&mut page, measured);
    bias(&mut page, measured);
    orders(&mut page, &measured.orders);
    page.paragraph("The fields of `expectations.json` are in [results.md](results.md).");
    page
}

/// A slope with its interval.
fn interval(slope: Slope) -> String {
    format!("{:.2} ± {:.2}", slope.value, slope.half_width().max(0.01)).replace('-', "−")
}

fn exponents(method: &Method) -> String {
    let of = |slope: Option<Slope>| slope.map_or("not known".into(), interval);
    let (steps, seconds) = (of(method.path_steps), of(method.processor_s));
    let (later, later_s) = (of(method.beyond_pilot), of(method.beyond_pilot_s));
    format!(
        "**{}**: ε to the power {later} in path-steps and {later_s} in seconds beyond the pilot; \
         {steps} and {seconds} over all rows.",
        method.name
    )
}

/// The cost of the other methods over that of the last at the accuracies of both.
fn compared(methods: &[Method]) -> Vec<[String; 4]> {
    let Some((last, others)) = methods.split_last() else { return Vec::new() };
    let mut rows = Vec::new();
    for row in &last.rows {
        for other in others {
            let same = other.rows.iter().find(|candidate| candidate.accuracy == row.accuracy);
            rows.extend(same.map(|same| {
                [
                    format!("{:.0e}", row.accuracy),
                    other.name.into(),
                    format!("{} ×", number(same.path_steps as f64 / row.path_steps as f64)),
                    format!("{} ×", number(same.processor_s / row.processor_s)),
                ]
            }));
        }
    }
    rows
}

fn figure(
    methods: &[Method],
    y_title: &str,
    cost: fn(&Cost) -> f64,
    exponent: fn(&Method) -> Option<Slope>,
) -> String {
    let curve = |method: &Method| {
        let points = method.rows.iter().map(|row| Measured::new(row.accuracy, cost(row)));
        let note = exponent(method).map_or(String::new(), interval);
        Curve { note, ..Curve::new(method.name, points) }
    };
    let plot = Plot {
        x_title: "requested half-width ε of the 95 % interval".into(),
        spacing: Spacing::Decades,
        lines: Vec::new(),
        curves: methods.iter().map(curve).collect(),
    };
    Figure {
        title: format!("E[cos y_3] of the rigid body with three noises: {y_title}"),
        y_title: y_title.into(),
        size: (340.0, 230.0),
        style: Style::Schemes,
        plots: vec![plot],
    }
    .svg()
}

fn section(page: &mut Page, method: &Method) {
    page.heading(3, &format!("By {}", method.name));
    let head = [
        "ε",
        "estimate",
        "half-width",
        "error",
        "finest steps",
        "path-steps",
        "wall s",
        "processor s",
    ];
    let row = |row: &Cost| {
        let mut width = format!("{:.1e}", row.half_width);
        if !row.reached {
            width += ", not reached";
        }
        let mut error = format!("{:+.1e}", row.error);
        if row.error.abs() > row.half_width {
            error += ", outside";
        }
        [
            format!("{:.0e}", row.accuracy),
            format!("{:.8}", row.estimate),
            width,
            error,
            row.finest_steps.to_string(),
            format!("{:.2e}", row.path_steps as f64),
            number(row.wall_s),
            number(row.processor_s),
        ]
    };
    page.table(head, method.rows.iter().map(row));
    page.paragraph(method.stopped.clone().unwrap_or_default());
    if !method.decisions.is_empty() {
        page.paragraph("What was decided in the last row:");
        page.list(method.decisions.iter().cloned());
    }
}

fn twelve(page: &mut Page, measured: &Measurements) {
    let twelve = &measured.twelve;
    page.heading(2, "Twelve test functions");
    page.paragraph(format!(
        "All of them by one run of `Expect` to ± {:.0e}: {:.2e} path-steps, {} s of wall time and \
         {} s of processor time. {} of {} intervals contain the exact value. They share their \
         paths.",
        twelve.accuracy,
        twelve.path_steps as f64,
        number(twelve.wall_s),
        number(twelve.processor_s),
        twelve.estimates.iter().filter(|e| (e.estimate - e.exact).abs() <= e.half_width).count(),
        twelve.estimates.len(),
    ));
    let rows = twelve.estimates.iter().map(|known| {
        [
            format!("`{}`", known.name),
            format!("{:.9}", known.estimate),
            format!("{:.1e}", known.half_width),
            format!("{:.9}", known.exact),
            format!("{:+.1e}", known.estimate - known.exact),
        ]
    });
    page.table(["φ", "estimate", "half-width", "exact", "error"], rows);
}

fn bias(page: &mut Page, measured: &Measurements) {
    let bias = &measured.bias;
    page.heading(2, "Bias of schemes");
    let all = bias.schemes.iter().flat_map(|s| &s.functions).flat_map(|f| &f.points);
    let points = all.map(|point| point.points).min().unwrap_or(0);
    page.paragraph(format!(
        "E[φ(y_N)] − E[φ(y(T))] at N steps, with the half-width of its 95 % interval, from {} \
         independent scrambles of {} Sobol points. {BIAS}",
        bias.scrambles, points
    ));
    let head = ["scheme", "φ"].map(str::to_owned).into_iter();
    let head =
        head.chain(STEPS.iter().map(|n| format!("{n} step{}", if *n == 1 { "" } else { "s" })));
    let row = |scheme: &SchemeBias, function: &FunctionBias| {
        let cell = |steps: &u64| {
            let at = function.points.iter().find(|point| point.steps == *steps);
            at.map_or("–".into(), in_words)
        };
        let first = [format!("`{}`", scheme.scheme), function.name.clone()];
        first.into_iter().chain(STEPS.iter().map(cell)).collect::<Vec<_>>()
    };
    let rows = bias.schemes.iter().flat_map(|s| s.functions.iter().map(move |f| row(s, f)));
    page.table(head, rows);
}

fn orders(page: &mut Page, orders: &Orders) {
    page.heading(2, "The weak order of nv");
    page.paragraph(ORDER.replace("SCRAMBLES", &orders.scrambles.to_string()));
    let head = ["problem", "scheme", "within 2 ± 0.1", "wider, with 2", "without 2", "defect"];
    let row = |problem: &ProblemOrders, scheme: &SchemeOrders| {
        let count = |wanted| scheme.functions.iter().filter(|f| verdict(f) == wanted).count();
        [
            problem.problem.into(),
            format!("`{}`", scheme.scheme),
            count(Verdict::Two).to_string(),
            count(Verdict::Wide).to_string(),
            count(Verdict::Other).to_string(),
            format!("{:.1e}", scheme.defect),
        ]
    };
    let problems = &orders.problems;
    page.table(head, problems.iter().flat_map(|p| p.schemes.iter().map(move |s| row(p, s))));
    let open = problems.iter().flat_map(|p| p.schemes.iter().filter_map(move |s| not_two(p, s)));
    page.list(open);
    for problem in problems {
        let title = format!("The order on {}, T = {}", problem.problem, problem.t_end);
        page.heading(3, &title);
        let all = || problem.schemes.iter().flat_map(|s| s.functions.iter().map(move |f| (s, f)));
        let Some((_, first)) = all().next() else { continue };
        let steps: Vec<u64> = first.points.iter().map(|point| point.steps).collect();
        page.paragraph(format!(
            "{} Points of a scramble at {} steps: {}.",
            if problem.exact { AGAINST_EXACT } else { AGAINST_TWICE },
            listed(steps.iter()),
            points_in_words(&problem.schemes),
        ));
        let head = ["scheme", "φ"].map(str::to_owned).into_iter();
        let head = head.chain(steps.iter().map(|n| format!("n = {n}")));
        let pairs = steps.windows(2).map(|pair| format!("{} to {}", pair[0], pair[1]));
        let head: Vec<String> = head.chain(pairs).chain(["order".into()]).collect();
        page.table(head, all().map(|(scheme, function)| cells(scheme, function)));
    }
}

fn listed<T: ToString>(items: impl Iterator<Item = T>) -> String {
    items.map(|item| item.to_string()).collect::<Vec<_>>().join(", ")
}

/// The points of a scramble, of `nv` and of twins.
fn points_in_words(schemes: &[SchemeOrders]) -> String {
    let of = |twin| {
        let scheme = schemes.iter().find(|scheme| scheme.twin == twin);
        let points = scheme.and_then(|scheme| scheme.functions.first()).map(|f| &f.points[..]);
        listed(points.unwrap_or_default().iter().map(|point| point.points))
    };
    format!("{}; of twins {}", of(false), of(true))
}

/// What an order with its interval shows.
#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    /// The interval is within 2 ± 0.1.
    Two,
    /// It is not, but contains 2; or there is none.
    Wide,
    /// It does not contain 2, and is not within 2 ± 0.1.
    Other,
}

fn verdict(function: &FunctionOrder) -> Verdict {
    match function.order {
        Some(order) if order.lo >= 1.9 && order.hi <= 2.1 => Verdict::Two,
        Some(order) if order.lo > 2.0 || order.hi < 2.0 => Verdict::Other,
        _ => Verdict::Wide,
    }
}

/// The orders of a scheme that is no twin which are not shown to be within 2 ± 0.1.
fn not_two(problem: &ProblemOrders, scheme: &SchemeOrders) -> Option<String> {
    let open = scheme.functions.iter().filter(|f| verdict(f) != Verdict::Two);
    let open = listed(open.map(|f| format!("{} {}", f.name, order_in_words(f.order))));
    let some = !scheme.twin && !open.is_empty();
    let (problem, scheme) = (problem.problem, scheme.scheme);
    some.then(|| format!("Not shown to be within 2 ± 0.1 on {problem}, `{scheme}`: {open}."))
}

fn order_in_words(order: Option<Slope>) -> String {
    order.map_or("not resolved".into(), interval)
}

fn cells(scheme: &SchemeOrders, function: &FunctionOrder) -> Vec<String> {
    let mut cells = vec![format!("`{}`", scheme.scheme), function.name.clone()];
    cells.extend(function.points.iter().map(in_words));
    cells.extend([function.coarse, function.fine, function.order].map(order_in_words));
    cells
}

fn in_words(point: &BiasPoint) -> String {
    let failed = match point.failed {
        0 => String::new(),
        failed => format!(", {failed} paths failed"),
    };
    format!("{:+.2e} ± {:.0e}{failed}", point.bias, point.half_width)
}

const PROBLEM: &str = "\
The problem is the rigid body with three noises of the weak panels: I = (2, 1, 2/3), Î = (1, 2, \
3), γ(t) = ½cos 2t, y(0) = (cos 1.1, 0, sin 1.1), T = 1. Its expectations are known to round-off \
from the Kolmogorov equation on the sphere, so every error here is an actual one.";

const METHOD: &str = "\
ε is the requested half-width of the 95 % interval, bias included. All runs are on one thread, and \
pilots are part of the cost.

**Single paths**: random points, `sexp` on one level, the first one whose bias is at most ε/4; the \
coupled paths that show the bias count. **Multilevel**: random points, `sexp`, antithetic \
differences from τ = 1/2 on. **Quasi-Monte Carlo**: scrambled Sobol points, `nv` with the flows of \
the parts and both orders of the noises, on one level of n steps, extrapolated from n and n/2 steps \
on the same points, and n/4 steps for the bias; steps are doubled until its bound is ε/4, then \
points. Each round computes all its points anew, which is up to half of the cost. **Expect**: \
`mc::Expect`, which takes the same scheme and points on levels, multilevel quasi-Monte Carlo.

**Exponents** are slopes of the logarithm of the cost over the logarithm of ε by least squares, all \
rows alike, with 95 % intervals from the scatter about the line. *Beyond the pilot*, as in the \
legends, are the rows that cost over a fifth more than the first one. Rows are few and levels come \
one at a time, so the intervals are wide.";

const PATHS_COMPARED: &str = "\
How many times the cost of `Expect` another method takes for the same ε:";

const BIAS: &str = "\
`em`, `heun`, `midpoint` and `sexp` clip increments, as the paper does, which takes steps below \
one: they begin with two steps, and the clipping is part of their bias. `nv` changes the order of \
the noises from step to step; *nv, both orders* is the mean of φ over first to last and last to \
first in every step, on the same increments, which is what `Expect` takes.";

const ORDER: &str = "\
Errors are the bias where the exact value is known, otherwise E[φ(y_n)] − E[φ(y_{2n})] on the \
same increments, which has the same order and needs no exact value. The order p₁ between n and 2n \
steps is the binary logarithm of the ratio of the errors, p₂ that between 2n and 4n. The *order* \
in the last column is without the next term of the expansion of the error: (4p₂ − p₁)/3 where \
that is two powers of τ above the first, 2p₂ − p₁ where it is one. For `nv` with an even number \
of steps powers are even, if the flows of the noises are exact ([theory](theory.md)); those of \
`poisson3` are triple jumps, which leave odd powers, and twins have all powers. Intervals of 95 % \
are from the standard errors of SCRAMBLES independent scrambles at each n, by Student's law. They \
have no part for later terms. *Not resolved*: an error is smaller than its half-width, or errors \
differ in sign.

The functions are each component and its square on every problem. Casimirs tie some of them: the \
three squares of the body, two squares of Maxwell–Bloch, the three components of `poisson3`. \
Numbers of steps, points and these formulas were fixed after runs with other seeds, of which \
seed 1 is one.

`nv` has the flows of the parts. *nv, one order*, first to last in every step, and `sexp` are \
twins of weak order one. One noise has no order, so the last two problems have `nv` once. The \
first table counts intervals: within 2 ± 0.1; not within it, but with 2 in them, or not resolved; \
others. Its last column is the largest relative defect of a Casimir from its conformal law, on \
any of these paths at any multiple of T/n.";

const AGAINST_EXACT: &str = "The problem above. Errors are biases against exact values.";

const AGAINST_TWICE: &str = "\
One noise, γ(t) = ½cos 2t, y(0) = (1, 2, 3). Errors are differences between n and 2n steps.";
