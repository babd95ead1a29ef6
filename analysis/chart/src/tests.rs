use super::*;
use proptest::prelude::*;

fn axis(label: &str) -> Axis {
    Axis::linear(label, "mm")
}

/// One chart of each kind over the same numbers.
fn every_kind(text: &str, v: &[f64], log: bool) -> Vec<Box<dyn Chart>> {
    let ax = || if log { Axis::log(text, text) } else { axis(text) };
    let pairs = || v.iter().copied().zip(v.iter().rev().copied());
    let first = v.first().copied().unwrap_or(f64::NAN);
    let labels = || v.iter().map(|_| text);
    let s = Style::nth;
    let plot = Plot::new(text, ax(), ax())
        .describe(text)
        .line(text, pairs(), s(0))
        .marked_line(text, pairs(), s(1))
        .step(text, pairs(), s(2))
        .scatter(text, pairs(), s(3))
        .band(text, pairs().map(|(a, b)| (a, a.min(b), a.max(b))), s(4))
        .columns(text, Histogram::new(v.iter().copied()).density(), s(5))
        .horizontal(first, text)
        .vertical(first, text);
    let estimates = || v.iter().map(|&x| Estimate::new(x, x - 1.0, x + first));
    let bars = Bars::new(text, ax(), labels())
        .describe(text)
        .series(text, estimates(), s(0))
        .series(text, estimates(), s(1))
        .reference(first, text);
    let mut stacked = StackedBars::new(text, ax()).describe(text).kind(text, s(0)).kind(text, s(1));
    let mut gantt = Gantt::new(text, ax(), labels()).describe(text).kind(text, s(1)).mark_kind(text, s(2));
    let mut waterfall = Waterfall::new(text, ax()).describe(text).total(text, first).reference(first, text);
    let mut intervals = Intervals::new(text, ax()).describe(text).reference(first, text);
    for (i, (a, b)) in pairs().enumerate() {
        stacked = stacked.row(text, [a, b]);
        gantt = gantt.interval(i, 0, a.min(b), a.max(b), text).mark(i, 0, a);
        waterfall = waterfall.change(text, Estimate::new(a, a, b));
        intervals = intervals.row(text, Estimate::new(a, a.min(b), a.max(b)));
    }
    let grid = v.iter().flat_map(|a| v.iter().map(move |b| a - b));
    let heat = HeatMap::new(text, [ax(), ax(), ax()], v.to_vec(), v.to_vec(), grid)
        .describe(text)
        .line(text, pairs(), s(0))
        .scatter(text, pairs(), s(1));
    let tornado = intervals.clone().tornado(text, text);
    let diverging = heat.clone().colours(ColourMap::Diverging);
    vec![
        Box::new(plot),
        Box::new(bars),
        Box::new(stacked),
        Box::new(gantt),
        Box::new(waterfall),
        Box::new(intervals),
        Box::new(tornado),
        Box::new(heat),
        Box::new(diverging),
    ]
}

/// Panics unless the picture is well-formed, titled, described and free of bad coordinates.
fn check(chart: &dyn Chart) -> String {
    let svg = chart.svg();
    let document = roxmltree::Document::parse(&svg).unwrap_or_else(|e| panic!("{e}\n{svg}"));
    let root = document.root_element();
    let names: Vec<&str> = root.children().take(2).map(|n| n.tag_name().name()).collect();
    assert_eq!(names, ["title", "desc"]);
    for node in root.descendants().filter(roxmltree::Node::is_element) {
        assert!(!matches!(node.tag_name().name(), "script" | "image" | "use" | "a" | "style"));
        assert!(!node.has_attribute("id"), "identifiers clash when charts share a page");
        for attribute in node.attributes().filter(|a| a.name() != "aria-label") {
            let value = attribute.value();
            assert!(!value.contains("NaN") && !value.contains("inf"), "{} = {value}", attribute.name());
        }
    }
    svg
}

const KINDS: usize = 9;

#[test]
fn every_kind_is_well_formed_and_shows_its_words() {
    for chart in every_kind("wear & <tear>", &[1.0, 2.5, 3.0, 7.0], false) {
        let svg = check(chart.as_ref());
        assert!(svg.contains("wear &amp; &lt;tear&gt;"));
        assert!(!svg.contains("no data"));
        assert!(!chart.data().rows().is_empty());
    }
}

#[test]
fn without_a_value_every_kind_says_no_data() {
    for values in [&[][..], &[f64::NAN], &[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]] {
        for (i, chart) in every_kind("t", values, false).iter().enumerate() {
            assert!(check(chart.as_ref()).contains("no data"), "kind {i} of {values:?}");
        }
    }
}

#[test]
fn degenerate_values_are_drawn_without_panic() {
    let lists: [&[f64]; 9] = [
        &[0.0],
        &[5.0],
        &[3.0, 3.0, 3.0],
        &[0.0, 0.0],
        &[-1.0, f64::NAN, 2.0],
        &[1e-300, 1e300],
        &[-f64::MAX, f64::MAX],
        &[1e16, 1e16 + 2.0],
        &[f64::MIN_POSITIVE, 5e-324],
    ];
    for values in lists {
        for log in [false, true] {
            let charts = every_kind("t", values, log);
            assert_eq!(charts.len(), KINDS);
            charts.iter().for_each(|c| drop(check(c.as_ref())));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn any_numbers_and_any_words_make_a_well_formed_picture(
        values in prop::collection::vec(prop::num::f64::ANY, 0..6),
        text in "(?s:.{0,30})",
        log: bool,
    ) {
        every_kind(&text, &values, log).iter().for_each(|c| drop(check(c.as_ref())));
    }
}

#[test]
fn a_value_left_out_is_counted_in_words() {
    let plot =
        Plot::new("t", axis("x"), Axis::log("y", "")).line("l", [(1.0, 1.0), (2.0, 0.0), (3.0, 10.0)], Style::nth(0));
    assert!(check(&plot).contains("1 value without a place on the axes is not drawn."));
}

#[test]
fn many_values_make_a_small_picture() {
    let n = 200_000;
    let wave = || (0..n).map(|i| (f64::from(i), (f64::from(i) * 0.01).sin()));
    let plot = Plot::new("t", axis("x"), axis("y")).line("l", wave(), Style::nth(0));
    let cloud =
        Plot::new("t", axis("x"), axis("y")).scatter("l", wave().map(|(i, y)| ((i * 0.7).sin(), y)), Style::nth(0));
    let mut gantt = Gantt::new("t", axis("x"), ["a"]).kind("k", Style::nth(1)).kind("m", Style::nth(2));
    for i in 0..n {
        gantt = gantt.interval(0, i as usize % 2, f64::from(i), f64::from(i) + if i % 2 == 0 { 0.9 } else { 0.2 }, "");
    }
    let grid = (0..600 * 500).map(|i| f64::from(i % 600) * f64::from(i / 600));
    let heat =
        HeatMap::new("t", [axis("x"), axis("y"), axis("v")], (0..600).map(f64::from), (0..500).map(f64::from), grid);
    let charts: [(&dyn Chart, usize); 4] = [(&plot, 60_000), (&cloud, 250_000), (&gantt, 300_000), (&heat, 300_000)];
    for (chart, most) in charts {
        let size = check(chart).len();
        assert!(size < most, "{size} bytes");
    }
}

#[test]
fn a_line_through_two_corners_ends_in_them() {
    let ax = || Axis::linear("", "").range(0.0, 1.0);
    let svg = Plot::new("t", ax(), ax()).line("", [(0.0, 0.0), (1.0, 1.0)], Style::nth(0)).svg();
    let document = roxmltree::Document::parse(&svg).expect("well-formed");
    let window = document
        .descendants()
        .find(|n| n.tag_name().name() == "svg" && n.has_attribute("overflow"))
        .expect("a plot area");
    let side = |name: &str| window.attribute(name).and_then(|v| v.parse::<f64>().ok()).expect("a number");
    let (x, y, w, h) = (side("x"), side("y"), side("width"), side("height"));
    let path = window.descendants().find_map(|n| n.attribute("d")).expect("a path");
    assert_eq!(path, format!("M{x} {}L{} {y}", y + h, x + w));
}
