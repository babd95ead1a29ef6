//! The report opens from disk: one file, no request, no console message, every chart drawn.
#![allow(clippy::print_stdout)] // a test that cannot look says so

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn demo(folder: &Path) -> PathBuf {
    demo_of(folder, &["--replications", "2"])
}

fn demo_of(folder: &Path, options: &[&str]) -> PathBuf {
    let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["demo", "--quiet"])
        .args(options)
        .arg("--out")
        .arg(folder)
        .output()
        .expect("toolroom runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("report.html")
}

/// A browser, where the machine has one.
fn browser() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success()))
}

#[test]
fn the_report_is_one_small_file_that_asks_for_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let html = std::fs::read_to_string(demo(&folder.path().join("demo"))).expect("a report");
    assert!(html.len() < 2_000_000, "{} bytes", html.len());
    assert!(html.matches("<svg").count() >= 5, "charts of comparison, VB(t), v(t), Gantt and state times");
    for request in ["<script", "<link", "<img", "<iframe", "src=", "href=\"http", "url(", "@import"] {
        assert!(!html.contains(request), "the report contains {request}");
    }
}

#[test]
fn a_browser_draws_every_chart_without_a_word() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let report = demo(&folder.path().join("demo"));
    let picture = folder.path().join("report.png");
    let run = |action: String| {
        let output = Command::new(browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .args(["--enable-logging=stderr", "--window-size=1200,9000"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .arg(action)
            .arg(format!("file://{}", report.display()))
            .output()
            .expect("the browser runs");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!said.contains(":CONSOLE"), "console message: {said}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let dom = run("--dump-dom".to_owned());
    let html = std::fs::read_to_string(&report).expect("a report");
    assert_eq!(dom.matches("<svg").count(), html.matches("<svg").count(), "charts kept by the browser");
    run(format!("--screenshot={}", picture.display()));
    // A blank page of this size is some 20 kB.
    assert!(std::fs::metadata(&picture).expect("a picture").len() > 100_000, "the page is nearly blank");
}

/// What a browser says of a page that it has laid out.
const MEASURE: &str = concat!("<script>", include_str!("measure.js"), "</script></body>");

/// What it says of a page of this width; the page forbids scripts, the copy that is measured does not.
fn measured(browser: &str, folder: &Path, html: &str, width: u32) -> Value {
    let copy = folder.join("measured.html");
    std::fs::write(&copy, html.replace("default-src 'none';", "").replace("</body>", MEASURE)).expect("a copy");
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--dump-dom"])
        .args(["--virtual-time-budget=2000".to_owned(), format!("--window-size={width},1000")])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", copy.display()))
        .output()
        .expect("the browser runs");
    let dom = String::from_utf8_lossy(&output.stdout).into_owned();
    let start = dom.find("<title>MEASURED ").expect("the page was measured") + "<title>MEASURED ".len();
    serde_json::from_str(dom[start..].split("</title>").next().expect("a title")).expect("JSON")
}

/// What does not fit its place, or lies on something else.
fn misplaced(measured: &Value) -> String {
    format!("{} {} {}", measured["wide"], measured["over"], measured["labels"])
}

#[test]
fn a_report_fits_the_window_and_the_page_and_no_label_lies_on_another() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, shown) in [("cells", &["--replications", "2"][..]), ("shop", &["--shop"])] {
        let html = std::fs::read_to_string(demo_of(&folder.path().join(name), shown)).expect("a report");
        // A4 with its margins of 14 mm is 688 px wide; on paper nothing scrolls, and the height is that of the pages.
        let paper = html.replace("@media print", "@media all");
        for (page, width, most) in [(&html, 1400, 6000), (&html, 700, 11_000), (&paper, 688, 60_000)] {
            let measured = measured(browser, folder.path(), page, width);
            assert_eq!(misplaced(&measured), "0 [] []", "{name} at {width} px");
            let height = measured["height"].as_u64().expect("a height");
            assert!(height <= most, "{name}: {height} px tall at {width} px");
        }
    }
}

#[test]
fn a_diagnosis_has_no_table_that_is_cut_on_paper() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("gap");
    let shipped = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name);
    let run = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["gap", "diagnose", "--quiet", "--model"])
        .arg(shipped("gap/turning.toml"))
        .arg("--data")
        .arg(shipped("new/wear.csv"))
        .arg("--out")
        .arg(&out)
        .output()
        .expect("toolroom runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let html = std::fs::read_to_string(out.join("report.html")).expect("a report");
    let measured = measured(browser, folder.path(), &html.replace("@media print", "@media all"), 688);
    assert_eq!(misplaced(&measured), "0 [] []");
}

#[test]
fn every_text_of_a_report_can_be_read_in_light_and_in_the_dark() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium on this machine");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let html = std::fs::read_to_string(demo(&folder.path().join("demo"))).expect("a report");
    let themed = |theme: &str| html.replacen("<html", &format!("<html data-theme=\"{theme}\""), 1);
    for theme in ["light", "dark"] {
        let answer = measured(browser, folder.path(), &themed(theme), 1400);
        assert!(answer["seen"].as_u64().expect("a count") > 100, "{answer}");
        assert_eq!(answer["poor"], Value::Array(Vec::new()), "{theme}");
    }
}
