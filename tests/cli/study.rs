//! Studies of a shop: tables, folders of results, comparisons, precision.

use super::*;

#[test]
fn compare_prints_the_table_and_leaves_a_complete_directory() {
    let dir = directory("cli", "compare");
    let out = dir.join("result");
    let output = quick("compare", &out, &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = stdout(&output);
    for expected in ["parts / shift", "cost / part", "cell gain", "shop gain", "bottleneck"] {
        assert!(table.contains(expected), "{expected} in\n{table}");
    }
    assert!(stderr(&output).contains("toolroom report --open"));
    assert_eq!(names(&dir), ["result"], "no draft is left");
    let files = [
        "events.parquet",
        "jobs.parquet",
        "kpi.csv",
        "operations.parquet",
        "report.html",
        "run.json",
        "schedule.html",
        "states.parquet",
        "stations.csv",
        "study.json",
        "summary.json",
        "tools.parquet",
        "trace.json",
    ];
    assert_eq!(names(&out), files);
    let run: Value = serde_json::from_slice(&fs::read(out.join("run.json")).expect("run.json")).expect("JSON");
    assert_eq!((&run["complete"], &run["replications"], &run["schema"]), (&true.into(), &3.into(), &1.into()));
    let again = quick("compare", &out, &["--json", "--quiet"]);
    let summary = json(&again);
    assert!(stderr(&again).is_empty(), "{}", stderr(&again));
    for key in [
        "seed",
        "replications",
        "policies",
        "differences",
        "cell_gain",
        "shop_gain",
        "cutting_share",
        "bottleneck",
        "digest",
    ] {
        assert!(!summary[key].is_null(), "{key}");
    }
    for key in ["parts_per_shift", "cost_per_part", "edges_per_100_parts", "oee"] {
        let value = &summary["policies"][0]["kpi"][key];
        assert!(value["mean"].is_f64() && value["ci95"][1].is_f64(), "{key}: {value}");
    }
    assert_eq!(summary["policies"][1]["name"], "best constant");
    assert_eq!(names(&dir), ["result"], "the second run took the place of the first");
}

#[test]
fn run_writes_csv_and_report_and_diff_read_it_again() {
    let dir = directory("cli", "run");
    let (one, two) = (dir.join("one"), dir.join("two"));
    assert_eq!(quick("run", &one, &["--format", "csv"]).status.code(), Some(0));
    let jobs = fs::read_to_string(one.join("jobs.csv")).expect("a log table");
    assert!(jobs.lines().next().is_some_and(|header| header.contains("arrival [min]")), "{jobs}");
    assert!(jobs.lines().any(|line| line.starts_with("best constant,2,")), "all replications are logged");
    assert_eq!(quick("run", &two, &["--seed", "9", "--logged", "0"]).status.code(), Some(0));
    assert!(!two.join("jobs.parquet").exists());
    let (one, two) = (one.display().to_string(), two.display().to_string());
    let report = toolroom(&["report", &one]);
    assert!(stdout(&report).trim().ends_with("report.html"), "{}", stderr(&report));
    assert_eq!(json(&toolroom(&["diff", &one, &one, "--json"]))["identical"], true);
    let difference = json(&toolroom(&["diff", &one, &two, "--json"]));
    assert_eq!(difference["identical"], false);
    assert!(difference["differences"].as_array().is_some_and(|list| !list.is_empty()));
    assert!(stdout(&toolroom(&["diff", &one, &two])).contains("parts_per_shift"));
    let missing = toolroom(&["diff", &one, "/nowhere"]);
    assert_eq!(missing.status.code(), Some(2), "{}", stderr(&missing));
}

/// A grinder that is busy most of the time with short and long parts.
const BUSY: &str = r#"schema = 1
[shop]
name = "busy"
title = "Short and long parts"
seed = 5
replications = 12
horizon = "24 h"
[[machine]]
name = "G"
process = "infeed"
rate = "60 EUR/h"
load_time = "0 s"
unload_time = "0 s"
[[tool]]
name = "wheel"
process = "infeed"
parameter_set = "zb153u_40kh"
edge_cost = "1 EUR"
[[part]]
name = "short"
[[part.operation]]
name = "grind"
machines = "G"
tool = "wheel"
work_rotation_speed = "120 rpm"
phase = [{ infeed_per_rev = "1 um/rev", revolutions = 60 }]
size_tolerance = "1 mm"
[[part]]
name = "long"
[[part.operation]]
name = "grind"
machines = "G"
tool = "wheel"
work_rotation_speed = "120 rpm"
phase = [{ infeed_per_rev = "1 um/rev", revolutions = 480 }]
size_tolerance = "1 mm"
[[arrivals]]
part = "short"
pattern = "poisson"
rate = "40 1/h"
[[arrivals]]
part = "long"
pattern = "poisson"
rate = "6 1/h"
[[policy]]
name = "programmed"
speed = "programmed"
"#;

/// Values of a figure of the shop in the replications of a run, from its `kpi.csv`.
fn figure(dir: &Path, id: &str) -> Vec<f64> {
    let text = fs::read_to_string(dir.join("kpi.csv")).expect("a table");
    let rows = text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    rows.filter(|row| row[2].is_empty() && row[3] == id).map(|row| row[5].parse().expect("a number")).collect()
}

#[test]
fn runs_that_differ_in_the_dispatch_rule_are_compared_in_pairs() {
    let dir = directory("cli", "diff");
    let file = dir.join("busy.toml");
    fs::write(&file, BUSY).expect("writable");
    let run = |name: &str, more: &[&str]| {
        let out = dir.join(name).display().to_string();
        let file = file.display().to_string();
        let output = toolroom(&[&["run", &file, "--logged", "0", "--out", &out], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        out
    };
    let fifo = run("fifo", &[]);
    let rule = "dispatch.rule=shortest_processing_time";
    let shortest = run("shortest", &["--set", rule]);
    let seed = run("seed", &["--set", rule, "--seed", "6"]);
    fs::write(&file, BUSY.replace("\"G\"", "\"H\"")).expect("writable");
    let renamed = run("renamed", &["--set", rule]);

    let lead = |other: &str| {
        let all = json(&toolroom(&["diff", &fifo, other, "--json"]));
        let found =
            all["differences"].as_array().and_then(|list| list.iter().find(|row| row["kpi"] == "lead_time [min]"));
        let row = found.expect("a difference").clone();
        let ends = [0, 1].map(|end| row["difference"]["ci95"][end].as_f64().expect("a number"));
        (all, row, 0.5 * (ends[1] - ends[0]))
    };
    let (all, row, half_width) = lead(&shortest);
    assert_eq!((&all["paired"], &all["unpaired_because"]), (&true.into(), &Value::Null));
    // The t interval of twelve differences: 2.200985 is the 97.5 % point of eleven degrees of freedom.
    let [one, two] = [&fifo, &shortest].map(|run| figure(Path::new(run), "lead_time"));
    let pairs: Vec<f64> = one.iter().zip(&two).map(|(one, two)| two - one).collect();
    assert_eq!(pairs.len(), 12);
    let mean = pairs.iter().sum::<f64>() / 12.0;
    let variance = pairs.iter().map(|pair| (pair - mean).powi(2)).sum::<f64>() / 11.0;
    assert!((row["difference"]["mean"].as_f64().expect("a number") - mean).abs() < 1e-9 * mean.abs());
    assert!((half_width - 2.200_985 * (variance / 12.0).sqrt()).abs() < 1e-5 * half_width, "{row}");
    assert!(mean + half_width < 0.0, "the shorter part first shortens the mean lead time: {row}");
    let text = stdout(&toolroom(&["diff", &fifo, &shortest]));
    assert!(text.starts_with("paired by replication on common random numbers"), "{text}");
    let line = text.lines().find(|line| line.contains("lead_time [min]")).expect("a row");
    assert!(line.contains(" ± ") && !line.contains("within the interval"), "{line}");

    // Other random numbers: two samples that have nothing to do with one another.
    for (other, message) in
        [(&seed, "their seeds are 5 and 6"), (&renamed, "machine `G` of the first is not in the second")]
    {
        let (all, row, unpaired) = lead(other);
        assert_eq!((&all["paired"], &all["unpaired_because"]), (&false.into(), &message.into()), "{row}");
        assert!(unpaired > 1.5 * half_width, "{unpaired} against {half_width}");
        let text = stdout(&toolroom(&["diff", &fifo, other]));
        assert!(text.starts_with(&format!("not paired, as {message}; 95 % Welch intervals")), "{text}");
    }

    // A table that was touched is refused with its line.
    let table = Path::new(&seed).join("kpi.csv");
    let broken = fs::read_to_string(&table).expect("a table").replacen("programmed,0,", "programmed,x,", 1);
    fs::write(&table, broken).expect("writable");
    let refused = toolroom(&["diff", &fifo, &seed]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("kpi.csv:2: `x` is no replication"), "{}", stderr(&refused));
}

#[test]
fn what_cannot_be_written_is_told_before_any_work() {
    let dir = directory("cli", "unwritable");
    fs::write(dir.join("file"), "x").expect("writable");
    fs::create_dir(dir.join("mine")).expect("writable");
    fs::write(dir.join("mine/report.html"), "x").expect("writable");
    for place in ["file", "file/below", "mine"] {
        let output = quick("compare", &dir.join(place), &[]);
        assert_eq!(output.status.code(), Some(2), "{place}: {}", stderr(&output));
        assert!(stdout(&output).is_empty(), "{place}");
    }
    assert_eq!(names(&dir), ["file", "mine"]);
    assert_eq!(names(&dir.join("mine")), ["report.html"]);
}

#[test]
fn a_study_of_nothing_is_an_input_error() {
    let out = directory("cli", "nothing").join("out");
    let path = shipped("template");
    let out_name = out.display().to_string();
    let with = |more: &[&str]| toolroom(&[&["compare", &path, "--out", &out_name], more].concat());
    for (more, message) in [
        (&["--replications", "0"][..], "--replications"),
        (&["--set", "shop.replications=0"], "1 to 1000000"),
        (&["--policy", "adaptvie"], "did you mean \"adaptive\"?"),
        (&["--policy", "constant"], "only one policy"),
        (&["--set", "machine.L.tool_change_time=2"], "has no unit"),
        (&["--set", "machine.M.rate=2 EUR/h"], "is not in the file"),
        (&["--until", "often"], "half-width 2%"),
        (&["-P", "shop.seed", "1", "3", "0"], "STEP is positive"),
    ] {
        let output = with(more);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(message), "{more:?}: {}", stderr(&output));
    }
    assert!(!out.exists());
}

#[test]
fn a_sweep_gives_a_comparison_at_every_value() {
    let out = directory("cli", "sweep").join("out");
    let sweep = ["-P", "machine.L.tool_change_time", "1 min", "2 min", "1 min"];
    let result = json(&quick("compare", &out, &[&sweep[..], &["--json"]].concat()));
    let points = result["points"].as_array().expect("points");
    assert_eq!(points.iter().map(|point| point["value"].as_str()).collect::<Vec<_>>(), [Some("1 min"), Some("2 min")]);
    assert!(points[0]["summary"]["digest"] != points[1]["summary"]["digest"]);
}

#[test]
fn precision_stops_a_study_early() {
    let out = directory("cli", "until").join("out");
    let (path, out) = (shipped("template"), out.display().to_string());
    let until = ["--until", "half-width 90%", "--replications", "400", "--json"];
    let policies = ["--policy", "constant", "--policy", "best constant", "--set", "shop.horizon=6 h"];
    let result = json(&toolroom(&[&["compare", &path, "--out", &out][..], &until, &policies].concat()));
    assert_eq!(result["complete"], true);
    let replications = result["replications"].as_u64().expect("a count");
    assert!((8..400).contains(&replications), "{replications}");
}

/// What a wheel has not is empty, and its force has a name of its own.
#[test]
fn passes_of_wheels_have_no_figures_of_edges() {
    let dir = directory("cli", "wheels");
    let out = dir.join("out").display().to_string();
    let file = shipped("grinder-bottleneck");
    let output = toolroom(&["run", &file, "--replications", "1", "--format", "csv", "--quiet", "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let table = fs::read_to_string(dir.join("out/operations.csv")).expect("passes");
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let column =
        |name: &str| header.iter().position(|own| *own == name).unwrap_or_else(|| panic!("{name}: {header:?}"));
    let operation = column("operation");
    let edges =
        ["cutting_speed_start [m/min]", "depth_of_cut [mm]", "path [m]", "cutting_force [N]", "roughness_ra [um]"];
    let force = column("normal_force [N]");
    let (mut ground, mut cut) = (0, 0);
    for row in lines {
        if row[operation].starts_with("grind") {
            ground += 1;
            assert!(edges.iter().all(|name| row[column(name)].is_empty()) && !row[force].is_empty(), "{row:?}");
        } else {
            cut += 1;
            assert!(edges.iter().all(|name| !row[column(name)].is_empty()) && row[force].is_empty(), "{row:?}");
        }
    }
    assert!(ground > 10 && cut > 10, "{ground} {cut}");
}
