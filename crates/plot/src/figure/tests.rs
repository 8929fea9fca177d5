use stats::{Point, Rate};

use super::{
    axis::{Axis, Range},
    canvas::{FAINT, GREY, INK, markup},
    chart::{Figure, Line},
    convergence::{order, overall_order, reference_slopes},
    frame::Frame,
    look::{BLUE, VERMILLION, of_schemes},
    ticks::Ticks,
    *,
};
use crate::{Kind, Series, label::Label};

/// Checks that a figure is whole and has these words.
#[track_caller]
pub fn is_whole(svg: &str, words: &[&str]) {
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{svg}");
    assert!(!svg.contains("NaN"), "{svg}");
    words.iter().for_each(|words| assert!(svg.contains(words), "{words}"));
}

#[test]
fn awkward_data_still_make_a_figure() {
    let point = |x, y| Measured { x, y, lo: 0.5 * y, hi: 2.0 * y };
    for points in [
        vec![],
        vec![point(1.0, 0.1)],
        vec![point(0.0, 0.0), point(f64::NAN, 1.0), point(1.0, f64::INFINITY)],
        vec![point(1.0, f64::MAX), point(1e-300, 1e-300), point(1e9, -1.0)],
    ] {
        let plot = |decades| {
            let curves = vec![Curve::new("a stranger", points.clone())];
            Plot { x_title: "time".into(), decades, curves }
        };
        for signed in [true, false] {
            let (title, y_title) = ("A & B".into(), "error".into());
            let lines = vec![Line { name: "n", constant: 1e-300, power: 1.0 }];
            let plots = [true, false].map(plot).into();
            is_whole(&Figure { title, y_title, signed, lines, plots }.svg(), &["A &amp; B"]);
        }
    }
    let trace =
        |name: &str, points: &[(f64, f64)]| Trace { name: name.into(), points: points.into() };
    let gap = [(0.0, 1.0), (1.0, f64::NAN), (2.0, f64::INFINITY), (3.0, 1.0)];
    for traces in [vec![], vec![trace("", &[])], vec![trace("", &gap)]] {
        is_whole(&lines("", "x", "y", &traces), &[]);
    }
    // Names where there are several.
    let mut traces = vec![trace("a<b", &[(0.0, 1.0), (1.0, 2.0)])];
    let svg = lines("A & B", "time t", "y", &traces);
    is_whole(&svg, &["A &amp; B", "time t"]);
    assert!(!svg.contains("a&lt;b"));
    traces.push(trace("c", &[(0.0, 0.0)]));
    is_whole(&lines("", "t", "y", &traces), &["a&lt;b"]);
}

/// The points of each line of a figure that is neither of the axes nor of the grid.
fn curves(svg: &str) -> Vec<Vec<(f64, f64)>> {
    let is_curve = |line: &&str| ![INK, FAINT, GREY].iter().any(|color| line.contains(*color));
    let points = |line: &str| -> Vec<(f64, f64)> {
        let points = line.split("points=\"").nth(1).and_then(|rest| rest.split('"').next());
        let number = |x: &str| x.parse::<f64>().unwrap();
        let point = |xy: &str| xy.split_once(',').map(|(x, y)| (number(x), number(y)));
        points.unwrap().split(' ').filter_map(point).collect()
    };
    svg.lines().filter(|line| line.starts_with("<polyline")).filter(is_curve).map(points).collect()
}

/// Bars reach over the intervals, with 1.96 standard errors to each side or as they are given.
#[test]
fn bars_are_intervals() {
    for (kind, sign) in [(Kind::Strong, 1.0), (Kind::Weak, 1.0), (Kind::Weak, -1.0)] {
        let point = |value: f64| Point::normal(value, sign * value, 0.2 * value);
        let mut points: Vec<Point> = [0.1, 0.03, 0.001].map(point).to_vec();
        let mut ends =
            [1.0 - 1.96 * 0.2, 1.0 + 1.96 * 0.2].map(|end| [0.1, 0.03, 0.001].map(|x| x * end));
        if let (Kind::Strong, Point::Error { lo, hi, .. }) = (kind, &mut points[1]) {
            (*lo, *hi) = (Some(0.02), Some(0.07));
            (ends[0][1], ends[1][1]) = (0.02, 0.07);
        }
        let series = Series {
            scheme: "heun".into(),
            quantity: "y(T)".into(),
            points,
            rate: None,
            max_relative_defect: None,
        };
        let curves = curves(&convergence("", kind, &[series]));
        let curve = curves.iter().find(|curve| curve.len() == 3).unwrap();
        let scale = (curve[2].1 - curve[0].1) / 0.01f64.ln();
        let is_bar = |curve: &&Vec<(f64, f64)>| curve.len() == 2 && curve[0].0 == curve[1].0;
        let bars: Vec<_> = curves.iter().filter(is_bar).collect();
        assert_eq!(bars.len(), 3);
        for (n, bar) in bars.into_iter().enumerate() {
            for (end, (_, y)) in ends.iter().zip(bar) {
                // Places are rounded to integers, two of them here.
                let exact = curve[0].1 + scale * f64::ln(end[n] / 0.1);
                assert!((y - exact).abs() <= 1.5, "{kind:?} {n}: {y} {exact}");
            }
        }
    }
}

#[test]
fn numbers_are_cells() {
    let values = [1.0, 0.0, -1.0, 0.25, f64::NAN, 1.0];
    let svg = picture("A & B", ((0.0, 1.0), "x"), ((0.0, 2.0), "y"), 2, &values);
    is_whole(&svg, &["A &amp; B"]);
    // Zero and what is no number are the paper.
    let cells =
        |svg: &str| svg.split("<path").skip(1).map(|path| path.matches('M').count()).sum::<usize>();
    assert_eq!(cells(&svg), 4);
    // From below, and from the left.
    let svg = picture("", ((0.0, 1.0), "x"), ((0.0, 2.0), "y"), 2, &[1.0, 0.0, 0.0, -1.0]);
    let [below, above] = [BLUE, VERMILLION].map(|color| {
        let path = svg.lines().find(|line| line.contains("<path") && line.contains(color));
        let place = path.unwrap().split("d=\"M").nth(1).and_then(|rest| rest.split('h').next());
        place.unwrap().split(' ').map(|x| x.parse::<f64>().unwrap()).collect::<Vec<_>>()
    });
    assert!(below[0] < above[0] && below[1] > above[1], "{below:?} {above:?}");
    let pictures = [("t = 0".to_owned(), values.to_vec()), ("t = 1".to_owned(), vec![1.0; 6])];
    let svg = strip("spins", 3, &pictures);
    is_whole(&svg, &["t = 0", "t = 1"]);
    assert_eq!(cells(&svg), 10);
    for empty in [picture("", ((0.0, 1.0), "x"), ((0.0, 1.0), "y"), 1, &[]), strip("", 1, &[])] {
        is_whole(&empty, &[]);
    }
}

#[test]
fn orders_are_short_and_never_certain() {
    let rate = |estimate, lo, hi| Rate { estimate, lo, hi, confidence: 0.95, ..Rate::default() };
    assert_eq!(order(&rate(1.0015, 0.954, 1.049)), "1.00 ± 0.05");
    assert_eq!(order(&rate(0.5, 0.499, 0.501)), "0.50 ± 0.01");
    assert_eq!(order(&rate(-0.1, f64::NAN, 0.3)), "−0.10");
}

#[test]
fn each_order_is_drawn_once_and_clear_of_the_data() {
    let trend = |order: f64, constant: f64| {
        let point = |k: i32| (2f64.powi(-k), constant * 2f64.powi(-k).powf(order));
        let points: Vec<_> = (5..13).map(point).collect();
        assert!((overall_order(&points) - order).abs() < 1e-12);
        (order, points)
    };
    let trends = [trend(1.0, 0.1), trend(0.5, 1.0), trend(1.0, 0.3)];
    let slopes = reference_slopes(&trends);
    for (tau, error) in trends.iter().flat_map(|(_, points)| points) {
        assert!(slopes[0].at(*tau) < *error && *error < slopes[1].at(*tau));
    }
    let powers = |trends: &[(f64, Vec<(f64, f64)>)]| {
        reference_slopes(trends).iter().map(|line| line.power).collect::<Vec<_>>()
    };
    assert_eq!(powers(&trends), [1.0, 0.5]);
    assert_eq!(powers(&[trend(0.5, 1.0), trend(0.5, 2.0)]), [0.5]);
    assert_eq!(powers(&[trend(2.0, 1.0)]), [2.0]);
    assert!(reference_slopes(&[]).is_empty());
}

fn axis(logarithmic: bool, (lo, hi): (f64, f64), start: f64, end: f64) -> Axis {
    Axis { logarithmic, range: Range { lo, hi }, start, end }
}

#[test]
fn positions_and_ranges() {
    let linear = |start, end| axis(false, (0.0, 1.0), start, end);
    let frame = Frame { x: linear(0.0, 10.0), y: linear(10.0, 0.0) };
    // The border belongs to the box.
    assert!(frame.holds((0.0, 10.0)) && frame.holds((10.0, 0.0)) && !frame.holds((10.1, 5.0)));

    let log = axis(true, (1.0, 100.0), 200.0, 0.0);
    // What is not positive sits at the floor.
    for (value, at) in [(1.0, 200.0), (10.0, 100.0), (100.0, 0.0), (0.0, 200.0), (-3.0, 200.0)] {
        assert!((log.position(value) - at).abs() < 1e-12, "{value}");
    }
    assert!(log.position(f64::NAN).is_nan());
    assert_eq!(axis(false, (1.0, 100.0), 200.0, 0.0).position(50.5), 100.0);

    let unit = Range { lo: 1.0, hi: 100.0 };
    let values = [f64::NAN, 3.0, -1.0, 0.0, f64::INFINITY, 7.0];
    assert_eq!(Range::of_positive(values, unit), Range { lo: 3.0, hi: 7.0 });
    assert_eq!(Range::of_positive([0.0, -1.0], unit), unit);
    assert_eq!(Range::of([], unit), unit);
    let narrow = Range { lo: 2.0, hi: 3.0 }.with_two_decades();
    assert!((narrow.lo - 1.0).abs() < 1e-12 && (narrow.hi - 10.0).abs() < 1e-12);
    let wide = Range { lo: 0.5, hi: 20.0 };
    assert_eq!(wide.with_two_decades(), wide);
    for value in [0.0, 3.0, -1e9] {
        let range = Range { lo: value, hi: value }.padded(0.05);
        assert!(range.lo < value && value < range.hi);
    }
}

fn range(lo: f64, hi: f64) -> Range {
    Range { lo, hi }
}

#[test]
fn powers_are_labelled_with_marks_between_and_thinned_to_a_common_stride() {
    let values = |ticks: &Ticks| ticks.major.iter().map(|tick| tick.0).collect::<Vec<_>>();
    let ticks = Ticks::decades(range(0.05, 20.0), 6);
    assert_eq!(values(&ticks), [0.1, 1.0, 10.0]);
    assert_eq!(ticks.major[0].1, Label::new("10^-1"));
    assert_eq!(ticks.minor.len(), 5 + 8 + 8 + 1);
    // Decades at the ends are kept.
    assert_eq!(values(&Ticks::decades(range(1e-17, 1e-3), 20)).len(), 15);
    assert!((3..=6).contains(&Ticks::decades(range(1e-300, 1e300), 6).major.len()));
    let few = Ticks::decades(range(1e-17, 1.0), 6);
    let exponents: Vec<&str> = few.major.iter().map(|(_, label)| &*label.exponent).collect();
    assert_eq!(exponents, ["−15", "−12", "−9", "−6", "−3", "0"]);
    let steps = range(2f64.powi(-14), 2f64.powi(-5));
    assert_eq!(Ticks::powers(2, steps, 12).major.len(), 10);
    let thinned = Ticks::powers(2, steps, 8);
    assert_eq!(values(&thinned), [-14, -12, -10, -8, -6].map(|k| 2f64.powi(k)));
    assert_eq!(thinned.minor.len(), 5);
}

#[test]
fn decimal_steps_are_one_two_or_five_and_large_numbers_share_a_factor() {
    for (from, most, words, factor) in [
        (range(0.0, 10.0), 6, &["0", "2", "4", "6", "8", "10"][..], None),
        (range(-0.03, 0.09), 4, &["0", "0.05"], None),
        (range(0.0, 3e7), 4, &["0", "1", "2", "3"], Some("×10^7")),
        (range(-1.2e-5, 0.0), 4, &["−1.0", "−0.5", "0"], Some("×10^-5")),
        // Hopeless ranges have no ticks.
        (range(1.0, 1.0), 5, &[], None),
        (range(-f64::MAX, f64::MAX), 5, &[], None),
        (range(1e17, 1e17 + 16.0), 5, &[], None),
    ] {
        let ticks = Ticks::decimal(from, most);
        let bases: Vec<&str> = ticks.major.iter().map(|(_, label)| &*label.base).collect();
        assert_eq!((bases, ticks.factor), (words.to_vec(), factor.map(Label::new)));
    }
    assert!(Ticks::decades(range(2.0, 3.0), 5).major.is_empty());
}

#[test]
fn an_unknown_scheme_gets_a_look_of_its_own() {
    let looks = of_schemes(&["sexp", "other", "em", "sexp-levy"]);
    for (i, a) in looks.iter().enumerate() {
        assert!(looks[..i].iter().all(|b| a.color != b.color && a.marker != b.marker));
    }
    // Methods that may coincide show through each other.
    for pair in [of_schemes(&["sexp", "midpoint"]), of_schemes(&["a", "b", "c", "d"]).split_off(2)]
    {
        let (below, above) = (pair[0], pair[1]);
        assert!(below.layer < above.layer && below.hollow() && !above.hollow());
        assert!(below.radius(1.0) > above.radius(1.0));
        assert!(below.line(1.0).width > above.line(1.0).width && above.line(1.0).dashed);
    }
}

#[test]
fn scripts_become_elements_and_what_follows_is_back_on_the_line() {
    assert_eq!(
        markup(&Label::new("y2^2")),
        "y<tspan dy=\"0.28em\" font-size=\"74%\">2</tspan>\
         <tspan dy=\"-0.78em\" font-size=\"74%\">2</tspan>"
    );
    assert_eq!(markup(&Label::words("a<b")), "a&lt;b");
    for (notation, shift) in [("y", "0.00"), ("y2", "-0.21"), ("y2^2", "0.37")] {
        let text = markup(&Label { tail: ": 1".into(), ..Label::new(notation) });
        let end = format!("<tspan dy=\"{shift}em\" font-size=\"100%\">: 1</tspan>");
        assert!(text.ends_with(&end), "{text}");
    }
}
