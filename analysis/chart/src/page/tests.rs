use super::*;
use crate::{Axis, Cell, Plot, Style, Table};
use proptest::prelude::*;

fn full(text: &str) -> Report {
    let chart = Plot::new(text, Axis::linear(text, text), Axis::log(text, text))
        .describe(text)
        .line(text, [(0.0, 1.0), (1.0, 10.0)], Style::nth(0))
        .horizontal(3.0, text)
        .vertical(0.5, text);
    let mut report = Report::new(text).lead(text).tile(Tile::new(text, text, text)).provenance(Provenance {
        version: text.to_owned(),
        command: text.to_owned(),
        seed: Some(42),
        inputs: vec![(text.to_owned(), text.to_owned())],
    });
    for _ in 0..5 {
        let section = Section::new(text)
            .paragraph(text)
            .list([text])
            .folded(text, [text])
            .note(text)
            .warning(text)
            .table(text, Table::new([text, text]).row([text.into(), Cell::Number(1.5)]))
            .figure(Figure::new(&chart, text).data_in(text))
            .choice((0..3).map(|_| (text.to_owned(), Figure::new(&chart, text))));
        report = report.section(section);
    }
    report
}

/// Names of all elements and attributes, in document order.
fn skeleton(html: &str) -> Vec<String> {
    let xml = html.strip_prefix("<!DOCTYPE html>\n").expect("starts with the document type");
    let document = roxmltree::Document::parse(xml).unwrap_or_else(|e| panic!("{e}"));
    let elements = document.root().descendants().filter(roxmltree::Node::is_element);
    elements.map(|n| n.attributes().fold(n.tag_name().name().to_owned(), |s, a| s + " " + a.name())).collect()
}

const HOSTILE: [&str; 8] = [
    "<script>alert(1)</script>",
    "\"><img src=x onerror=alert(1)>",
    "' onload='alert(1)",
    "]]><!-- & &amp; &#x3c;script&#x3e;",
    "</title></style></svg><iframe src=//e.example>",
    "\u{0}\u{8}\u{b}\u{1f}\u{fffe}\u{ffff}",
    "\u{202e}txt.exe\u{2066}",
    "{{7*7}} ${x} \\u003cscript\\u003e",
];

#[test]
fn hostile_text_stays_text() {
    let expected = skeleton(&full("plain").html());
    for text in HOSTILE {
        let html = full(text).html();
        assert_eq!(skeleton(&html), expected, "{text:?}");
        assert!(!html.contains("<script") && !html.contains("<img") && !html.contains("<iframe"), "{text:?}");
        assert!(!html.contains(['\u{0}', '\u{202e}', '\u{ffff}']));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_text_changes_the_structure(text in "\\PC{0,40}|[<>&\"'a-z=/ ]{1,40}|(?s:.{0,20})") {
        // Short and long labels place legends alike; only the words differ.
        let expected = skeleton(&full("plain").html());
        if !text.is_empty() {
            prop_assert_eq!(skeleton(&full(&text).html()), expected);
        }
    }
}

#[test]
fn the_page_needs_neither_script_nor_network() {
    let html = full("plain").html();
    for forbidden in ["<script", "<link", "src=", "@import", "url(", "onload"] {
        assert!(!html.contains(forbidden), "{forbidden}");
    }
    let addresses: Vec<&str> = html.match_indices("http").map(|(i, _)| &html[i..(i + 26).min(html.len())]).collect();
    assert!(
        addresses.iter().all(|a| a.starts_with("http://www.w3.org/2000/svg") || a.starts_with("http-equiv")),
        "{addresses:?}"
    );
}

#[test]
fn contents_appear_above_four_sections() {
    let section = || Section::new("s").paragraph("p");
    let with =
        |n: usize| (0..n).fold(Report::new("r"), |r, _| r.section(section()).section(Section::new("empty"))).html();
    assert!(!with(4).contains("<nav"));
    assert!(with(5).contains("<nav") && with(5).contains("href=\"#section-5\""));
    assert!(!with(5).contains("empty"), "a heading without anything below is left out");
}

#[test]
fn long_data_is_shortened_and_names_the_file() {
    let points = (0..100_000).map(|i| (f64::from(i), f64::from(i % 97)));
    let chart = Plot::new("t", Axis::linear("x", ""), Axis::linear("y", "")).line("l", points, Style::nth(0));
    let figure = Figure::new(&chart, "c").data_in("operations.csv");
    let html = Report::new("r").section(Section::new("s").figure(figure)).html();
    assert!(html.contains("The first 200 of 100000 rows; all of them are in operations.csv."));
    assert!(html.len() < 150_000, "{} bytes", html.len());
}

#[test]
fn numbers_in_data_tables_can_be_pasted_into_a_spreadsheet() {
    let values = [-0.5, 1.0 / 3.0, 1e-7, 123_456.7, f64::NAN, 0.0];
    let points = values.iter().map(|&v| (v, 1.0));
    let chart = Plot::new("t", Axis::linear("x", ""), Axis::linear("y", "")).scatter("s", points, Style::nth(0));
    let html = Report::new("r").section(Section::new("s").figure(Figure::new(&chart, "c"))).html();
    for cell in ["-0.5", "0.333333", "1e-7", "123457", "–", "0"] {
        assert!(html.contains(&format!("<td class=\"num\">{cell}</td>")), "{cell}");
    }
}

#[test]
fn writing_replaces_the_old_report_and_leaves_nothing_else() {
    let folder = std::env::temp_dir().join(format!("toolroom-page-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let path = folder.join("report.html");
    std::fs::write(&path, "old").expect("writable");
    Report::new("new").write(&path).expect("writable");
    assert!(std::fs::read_to_string(&path).expect("readable").contains("<h1>new</h1>"));
    assert_eq!(std::fs::read_dir(&folder).expect("readable").count(), 1);
    let missing = folder.join("missing/report.html");
    let error = Report::new("new").write(&missing).expect_err("the folder is missing");
    assert!(error.to_string().contains("report.html"));
    std::fs::remove_dir_all(&folder).expect("removable");
}

#[test]
fn a_choice_shows_one_figure_and_numbers_all() {
    let chart = Plot::new("x", Axis::linear("x", "m"), Axis::linear("y", "m")).line("", [(0.0, 1.0)], Style::nth(0));
    let figures = |count: usize| (0..count).map(|i| (format!("name {i}"), Figure::new(&chart, format!("caption {i}"))));
    let page = |count| Report::new("t").section(Section::new("s").choice(figures(count))).html();
    let two = page(2);
    assert_eq!(two.matches("type=\"radio\"").count(), 2);
    assert_eq!(two.matches("checked=\"checked\"").count(), 1, "the first is shown");
    assert!(two.contains("Figure 1.</b> caption 0") && two.contains("Figure 2.</b> caption 1"));
    // One figure needs no choice; more than the style sheet knows stand one after another.
    for count in [0, 1, 25] {
        let html = page(count);
        assert!(!html.contains("type=\"radio\""), "{count}");
        assert_eq!(html.matches("<figure").count(), count);
    }
}
