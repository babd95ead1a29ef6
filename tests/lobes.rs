//! `toolroom lobes`: verdicts against published and reference numbers, charts, refusals.

use crate::command_line::{directory, json, shipped, stderr, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The verdict of a shipped file at a point, with changes.
fn verdict(name: &str, point: [&str; 2], changes: &[&str]) -> Value {
    let path = shipped(name);
    let mut arguments = vec!["lobes", &path, "--json", "--at", point[0], point[1]];
    for change in changes {
        arguments.extend(["--set", change]);
    }
    json(&toolroom(&arguments))
}

fn close(value: &Value, expected: f64, relative: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value / expected - 1.0).abs() < relative, "{value} against {expected}");
}

const SLOT: &str = "chatter/milling-slot";
const BAR: &str = "chatter/turning-bar";
const CHUCK: &str = "chuck-fig3";
const UP: &str = "engagement.direction=up";

#[test]
fn milling_limits_are_those_of_the_standard_case() {
    // Limit [mm] and kind; converged by Chebyshev collocation, the limits over immersion and speed.
    let half = "engagement.immersion=0.5";
    let thin = "engagement.immersion=0.05";
    let cases: [(&str, &[&str], f64, &str); 8] = [
        ("6000 rpm", &[], 0.35322417, "hopf"),
        ("12000 rpm", &[], 2.1493095, "flip"),
        ("24000 rpm", &[], 3.7425451, "hopf"),
        ("16000 rpm", &[half, UP], 0.20827493, "hopf"),
        ("20000 rpm", &[half, UP], 1.1853002, "hopf"),
        ("10000 rpm", &[half], 2.1046897, "flip"),
        ("8000 rpm", &[thin, UP], 3.4955794, "hopf"),
        ("10000 rpm", &[thin], 4.0907110, "flip"),
    ];
    for (speed, changes, limit, kind) in cases {
        let below = verdict(SLOT, [speed, &format!("{} mm", 0.99 * limit)], changes);
        let above = verdict(SLOT, [speed, &format!("{} mm", 1.01 * limit)], changes);
        close(&below["stability_limit [mm]"], limit, 1e-6);
        close(&below["margin"], 0.01, 1e-4);
        assert_eq!((&below["stable"], &below["type"]), (&true.into(), &"stable".into()), "{speed}");
        assert_eq!((&above["stable"], &above["type"]), (&false.into(), &kind.into()), "{speed} {changes:?}");
        assert!(above["residual"].as_f64().expect("a number") < 1e-8);
    }
}

#[test]
fn milling_spectral_radii_are_those_of_the_standard_case() {
    for (depth, radius) in [("0.2 mm", 0.8197427843), ("0.5 mm", 1.073975587), ("1 mm", 1.406473525)] {
        close(&verdict(SLOT, ["5000 rpm", depth], &[])["spectral_radius"], radius, 1e-7);
    }
    // The same in other units.
    close(&verdict(SLOT, ["523.5987755982989 rad/s", "500 um"], &[])["spectral_radius"], 1.073975587, 1e-7);
}

#[test]
fn a_flip_vibrates_at_odd_multiples_of_half_the_tooth_frequency() {
    let flip = verdict(SLOT, ["12000 rpm", "2.3 mm"], &[]);
    assert_eq!(flip["type"], "flip");
    let lines = flip["chatter_frequencies [Hz]"].as_array().expect("a list");
    // 12000 rpm with two teeth are 400 Hz.
    let expected = [200.0, 600.0, 1000.0, 1400.0, 1800.0];
    assert_eq!(lines.len(), expected.len(), "{lines:?}");
    for (line, expected) in lines.iter().zip(expected) {
        close(line, expected, 1e-6);
    }
    close(&flip["chatter_frequency [Hz]"], 1000.0, 1e-6);
}

/// A lathe tool of m = 0.561 kg, c = 145 N s/m and k = 6.48 N/um, without a workpiece that bends.
fn stiff_work(name: &str) -> String {
    let path = directory("lobes", name).join("turning.toml");
    let (mass, damping, stiffness): (f64, f64, f64) = (0.561, 145.0, 6.48e6);
    let frequency = (stiffness / mass).sqrt() / std::f64::consts::TAU;
    let ratio = damping / (2.0 * (stiffness * mass).sqrt());
    let text = format!(
        "schema = 1\nname = \"tool\"\nprocess = \"turning\"\n[[mode]]\ndirection = [1, 0]\n\
         natural_frequency = \"{frequency} Hz\"\ndamping_ratio = {ratio}\nstiffness = \"6.48 N/um\"\n\
         [cut]\ncutting_coefficient = \"1384 MPa\"\ndiameter = \"35 mm\"\n\
         [chart]\nspindle_speed = [\"200 rpm\", \"9000 rpm\"]\ndepth_of_cut = [\"0 mm\", \"2 mm\"]\n\
         boundary_only = true\n[[point]]\nspindle_speed = \"3000 rpm\"\ndepth_of_cut = \"0.4 mm\"\n"
    );
    fs::write(&path, text).expect("writable");
    path.display().to_string()
}

#[test]
fn turning_limits_are_those_of_the_reference_with_and_without_process_damping() {
    let path = stiff_work("limits");
    for (speed, free, damped) in [("1500 rpm", 0.38491350, 0.97558778), ("8000 rpm", 0.72273448, 0.77227103)] {
        let arguments = ["lobes", &path, "--json", "--at", speed, "0.3 mm"];
        close(&json(&toolroom(&arguments))["stability_limit [mm]"], free, 1e-7);
        let with = [&arguments[..], &["--set", "cut.process_damping=6.11e5 N/m"]].concat();
        close(&json(&toolroom(&with))["stability_limit [mm]"], damped, 1e-7);
    }
    // Slow enough, process damping keeps every depth stable: there is no limit and no margin.
    let slow = ["lobes", &path, "--json", "--at", "500 rpm", "1 mm", "--set", "cut.process_damping=6.11e5 N/m"];
    let slow = json(&toolroom(&slow));
    assert_eq!(slow["stable"], true);
    assert!(slow["stability_limit [mm]"].is_null() && slow["margin"].is_null());
}

#[test]
fn a_bar_is_softer_the_farther_the_tool_is_from_its_supports() {
    let limit = |position: &str| {
        let change = format!("bar.position={position}");
        let verdict = verdict(BAR, ["3000 rpm", "0.2 mm"], &[&change, "mode.tool.stiffness=1000 N/um"]);
        verdict["stability_limit [mm]"].as_f64().expect("a limit")
    };
    let (near, middle) = (limit("100 mm"), limit("200 mm"));
    assert!(near > 2.0 * middle, "{near} mm against {middle} mm");
}

#[test]
fn chuck_thresholds_are_those_of_the_paper_s_reduced_system() {
    // Speed ratio 1 and 2, lags 0, 40 and 80 us.
    for (lag, one, two) in
        [("0 s", 0.541592, 0.0723846), ("40 us", 0.417262, 0.0422591), ("80 us", 0.257592, 0.0128043)]
    {
        let lag = format!("chuck.lag={lag}");
        for (ratio, threshold) in [("1", one), ("2", two)] {
            let found = verdict(CHUCK, [ratio, "0.7"], &[&lag]);
            close(&found["critical_modulation"], threshold, 1e-5);
            assert_eq!(found["type"], "parametric");
        }
    }
    let found = verdict(CHUCK, ["1", "0.3"], &[]);
    close(&found["spectral_radius"], 1.00647429, 1e-7);
    // 240.93141 kgf/mm over 300 kgf/mm², against 200.
    close(&found["stability_limit [mm]"], 240.93141 / 300.0, 1e-6);
    close(&found["margin"], 1.0 - 200.0 / 240.93141, 1e-6);
    close(&found["chatter_frequency [Hz]"], 120.0, 1e-9);
    // 2400 rpm in a chuck of three jaws are 120 Hz.
    close(&verdict(CHUCK, ["2400 rpm", "0.3"], &[])["spectral_radius"], 1.00647429, 1e-7);
    let other = verdict(CHUCK, ["1.9", "0.3"], &["chuck.preset=table2_milli", "chuck.lag=40 us"]);
    close(&other["spectral_radius"], 0.923837325, 1e-7);
}

#[test]
fn a_chart_leaves_picture_table_numbers_and_report() {
    let out = directory("lobes", "chart").join("out");
    let (path, place) = (shipped(SLOT), out.display().to_string());
    let small = ["--set", "chart.columns=24", "--set", "chart.rows=10"];
    let arguments = [&["lobes", path.as_str(), "--json", "--out", place.as_str()][..], &small].concat();
    let summary = json(&toolroom(&arguments));
    let entries = fs::read_dir(&out).expect("results").map(|entry| entry.expect("an entry").file_name());
    let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    assert_eq!(names, ["lobes.csv", "lobes.json", "lobes.png", "lobes.svg", "report.html", "run.json"]);
    let pixels = fs::read(out.join("lobes.png")).expect("a picture");
    assert_eq!((&pixels[..8], &pixels[16..20]), (&b"\x89PNG\r\n\x1a\n"[..], &1600_u32.to_be_bytes()[..]));
    let value: Value = serde_json::from_slice(&fs::read(out.join("lobes.json")).expect("numbers")).expect("JSON");
    assert_eq!(value, summary);
    let table = fs::read_to_string(out.join("lobes.csv")).expect("a table");
    assert!(table.starts_with("spindle_speed [rpm],depth_of_cut [mm],spectral_radius,stable,type,"), "{table}");
    assert_eq!(table.lines().count(), 1 + 24 * 10);
    // The grid, the boundary and the verdicts of the points tell one story.
    let stable = table.lines().skip(1).filter(|line| line.contains(",true,")).count();
    close(&summary["stable_share"], stable as f64 / 240.0, 1e-12);
    assert_eq!(summary["points"][0]["name"], "cautious");
    assert_eq!(summary["points"][3]["type"], "hopf");
    let picture = fs::read_to_string(out.join("lobes.svg")).expect("a picture");
    for expected in ["Spindle speed [rpm]", "Depth of cut [mm]", "stability limit", "margin below 10 %", "unstable"] {
        assert!(picture.contains(expected), "{expected}");
    }
    let report = fs::read_to_string(out.join("report.html")).expect("a report");
    assert!(report.contains("1 of 4 operating points are unstable") && report.contains("chart.columns=24"));
    assert!(report.len() < 2_000_000);
    // A second run takes the place of the first and gives the same bytes.
    assert_eq!(json(&toolroom(&arguments)), summary);
    assert_eq!(fs::read_to_string(out.join("lobes.csv")).expect("a table"), table);
}

#[test]
fn a_boundary_alone_is_the_exact_limit() {
    let path = stiff_work("boundary");
    let out = directory("lobes", "boundary-out").join("out").display().to_string();
    let change = ["--set", "chart.spindle_speed=[\"3000 rpm\", \"5000 rpm\"]", "--set", "chart.columns=3"];
    let summary = json(&toolroom(&[&["lobes", &path, "--json", "--out", &out][..], &change].concat()));
    let limit = &summary["boundaries"][0]["limit"];
    close(&limit[0][0], 3000.0, 1e-12);
    close(&limit[0][1], 0.47242024, 1e-7);
    close(&limit[8][1], 0.37018611, 1e-7);
    assert!(summary["stable_share"].is_null());
    let table = fs::read_to_string(Path::new(&out).join("lobes.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + 9, "{table}");
}

#[test]
fn the_shipped_bar_and_chuck_are_charts() {
    for (name, message) in [(BAR, "roughing"), (CHUCK, "limit at lag 40 us: least 0.0423 at speed ratio 2")] {
        let out = directory("lobes", &name.replace('/', "-")).join("out").display().to_string();
        let output = toolroom(&["lobes", &shipped(name), "--out", &out, "--set", "chart.boundary_only=true"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        assert!(text.contains(message), "{text}");
    }
}

const STARS: &str = "chatter/chuck-fig2";
const LATHE: &str = "chatter/chuck-fig4";
const VARYING: &str = "chatter/speed-variation";

#[test]
fn the_stars_of_figure_2_stand_to_the_exact_routh_limit() {
    // Limits [kgf/mm] at 40 and 80 us; 200 is just outside by the literal table.
    for (preset, limits, third) in [
        ("f0_120hz", [480.64035, 240.93141], true),
        ("table2_milli", [583.62805, 311.15854], true),
        ("table2_literal", [397.51237, 198.76858], false),
    ] {
        let preset = format!("chuck.preset={preset}");
        for (lag, limit) in [("40 us", limits[0]), ("80 us", limits[1])] {
            let star = verdict(STARS, [lag, "1.96133 N/um"], &[&preset]);
            close(&star["critical_cutting_stiffness [N/um]"], limit * 9806.65e-6, 1e-6);
            assert_eq!(star["stable"], lag == "40 us" || third, "{preset} {lag}");
        }
        let first = verdict(STARS, ["0 s", "1.96133 N/um"], &[&preset]);
        assert_eq!((&first["stable"], &first["margin"]), (&true.into(), &Value::Null));
    }
}

#[test]
fn the_tool_widens_the_region_of_figure_4_and_the_allowance_does_not() {
    let radius = |at, changes: &[&str]| verdict(LATHE, at, changes)["spectral_radius"].clone();
    close(&radius(["0.55", "0.3"], &[]), 1.196003135, 1e-7);
    close(&radius(["0.55", "0.2"], &[]), 0.947564657, 1e-7);
    close(&radius(["0.274", "0.5"], &[]), 0.569386055, 1e-7);
    close(&radius(["0.5", "0.5"], &["lathe.allowance=[0.3]"]), 1.502025864, 1e-7);
    let tip = |allowance: &str| {
        let change = format!("lathe.allowance=[{allowance}]");
        verdict(LATHE, ["0.547", "0.3"], &[&change])["critical_modulation"].as_f64().expect("a threshold")
    };
    let (even, uneven) = (tip("0"), tip("0.6"));
    assert!((even - 0.2217).abs() < 5e-4 && (uneven / even - 1.0).abs() < 1e-3, "{even} {uneven}");
}

#[test]
fn a_varying_speed_calms_what_chatters_at_constant_speed() {
    // One and a half times the limit of constant speed: RVA, 1/RVF, spectral radius a revolution.
    for (speed, limit, cases) in [
        ("1500 rpm", 0.38491350, [(0.1, 5, 0.84211), (0.2, 5, 0.57866), (0.1, 10, 0.84023)]),
        ("6000 rpm", 0.39462604, [(0.0, 5, 1.3002), (0.1, 5, 0.97724), (0.2, 5, 0.60473)]),
    ] {
        let depth = format!("{} mm", 1.5 * limit);
        for (amplitude, revolutions, radius) in cases {
            let mass = "mode.tool.natural_frequency=540.9 Hz";
            let amplitude = format!("speed_variation.amplitude={amplitude}");
            let revolutions = format!("speed_variation.revolutions={revolutions}");
            let found = verdict(VARYING, [speed, &depth], &[mass, &amplitude, &revolutions]);
            close(&found["spectral_radius"], radius, 2e-3);
        }
    }
    // A mill as well: the flip of the standard slot at 12 000 rpm goes deeper.
    let text = fs::read_to_string(shipped(SLOT)).expect("shipped");
    let path = directory("lobes", "varying-mill").join("mill.toml");
    let section = "[speed_variation]\namplitude = 0.2\nrevolutions = 5\n[chart]";
    fs::write(&path, text.replacen("[chart]", section, 1)).expect("writable");
    let path = path.display().to_string();
    let found = json(&toolroom(&["lobes", &path, "--json", "--at", "6000 rpm", "0.45 mm"]));
    assert_eq!((&found["stable"], &found["speed_variation"]["revolutions"]), (&true.into(), &5.into()));
    assert_eq!(verdict(SLOT, ["6000 rpm", "0.45 mm"], &[])["stable"], false);
}

#[test]
fn a_chart_is_the_same_from_any_number_of_shards() {
    let folder = directory("lobes", "shards");
    let path = shipped(SLOT);
    let small = ["--set", "chart.columns=11", "--set", "chart.rows=7"];
    let place = |name: &str| folder.join(name).display().to_string();
    let whole = json(&toolroom(&[&["lobes", &path, "--json", "--out", &place("whole")][..], &small].concat()));
    let table = fs::read(folder.join("whole/lobes.csv")).expect("a table");
    for shards in ["1", "4", "11"] {
        let (plan, parts, out) = (place("plan.json"), place(&format!("parts{shards}")), place("merged"));
        let planned = [&["lobes", &path, "--plan", &plan, "--shards", shards][..], &small].concat();
        assert_eq!(toolroom(&planned).status.code(), Some(0));
        // In any order, by either verb.
        for shard in (0..shards.parse::<u32>().expect("a number")).rev().map(|shard| shard.to_string()) {
            let output = if shard == "0" {
                toolroom(&["shard", &plan, &shard, "--out", &parts])
            } else {
                toolroom(&["lobes", "--run", &plan, "--shard", &shard, "--out", &parts, "--threads", "1"])
            };
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        }
        let merged = json(&toolroom(&["merge", &parts, "--json", "--out", &out]));
        assert_eq!(merged, whole, "{shards} shards");
        assert_eq!(merged["digest"].as_str().map(str::len), Some(16));
        assert_eq!(fs::read(folder.join("merged/lobes.csv")).expect("a table"), table);
    }
    let part = folder.join("parts4/part-000001.json");
    let whole = fs::read(&part).expect("a part");
    for offset in (0..whole.len()).step_by(whole.len() / 5) {
        let mut changed = whole.clone();
        changed[offset] ^= 4;
        for bytes in [&whole[..offset], &changed] {
            fs::write(&part, bytes).expect("writable");
            let output = toolroom(&["merge", &place("parts4"), "--out", &place("merged")]);
            let said = stderr(&output);
            assert!(output.status.code() == Some(2) && said.contains("part-000001.json"), "{offset}: {said}");
        }
    }
    fs::write(&part, whole).expect("writable");
    fs::remove_file(folder.join("parts4/part-000002.json")).expect("a part");
    let output = toolroom(&["merge", &place("parts4"), "--out", &place("merged")]);
    assert!(output.status.code() == Some(2) && stderr(&output).contains("1 of 4 shards are missing: 2"));
    let plan = ["lobes", &path, "--plan", &place("other.json"), "--set", "chart.boundary_only=true"];
    assert!(stderr(&toolroom(&plan)).contains("a boundary alone cannot be cut into shards"));
    let other = ["lobes", "--run", &place("plan.json"), "--shard", "0", "--out", &place("parts4")];
    assert!(stderr(&toolroom(&other)).contains("belongs to another plan"));
}

/// Both had lost their grid to the row of depth zero.
#[test]
fn the_shipped_turning_charts_have_a_verdict_at_every_point() {
    for name in [BAR, "chatter/shaft"] {
        let out = directory("lobes", &format!("whole-{}", name.replace('/', "-"))).join("out");
        let small = ["--set", "chart.columns=12", "--set", "chart.rows=9"];
        let output =
            toolroom(&[&["lobes", &shipped(name), "--json", "--out", &out.display().to_string()][..], &small].concat());
        let summary = json(&output);
        assert!(!stderr(&output).contains("warning"), "{}", stderr(&output));
        assert_eq!((&summary["holes"], summary["without_verdict"].as_array().map(Vec::len)), (&0.into(), Some(0)));
        let table = fs::read_to_string(out.join("lobes.csv")).expect("a table");
        let uncut: Vec<&str> = table.lines().filter(|line| line.split(',').nth(1) == Some("0")).collect();
        assert_eq!((table.lines().count(), uncut.len()), (1 + 12 * 9, 12));
        assert!(uncut.iter().all(|line| line.contains(",true,stable,")), "{uncut:?}");
        assert!(!fs::read_to_string(out.join("lobes.svg")).expect("a picture").contains("no verdict"));
    }
}

/// At 40 rpm a slot that is hardly damped is too slow for the period map and too fast for the envelope of the lobes.
#[test]
fn a_point_without_verdict_is_a_hole_that_is_told_in_one_piece_and_in_shards() {
    let folder = directory("lobes", "holes");
    let place = |name: &str| folder.join(name).display().to_string();
    let path = shipped(SLOT);
    let small = [
        "--set",
        "chart.columns=6",
        "--set",
        "chart.rows=5",
        "--set",
        "mode.tool.damping_ratio=0.0005",
        "--set",
        "chart.spindle_speed=[\"40 rpm\", \"8040 rpm\"]",
        "--set",
        "chart.depth_of_cut=[\"0.1 mm\", \"2 mm\"]",
    ];
    let output = toolroom(&[&["lobes", &path, "--json", "--out", &place("whole")][..], &small].concat());
    let whole = json(&output);
    let message = stderr(&output);
    assert!(message.contains("5 of 30 points have no verdict") && message.contains("first 40 rpm"), "{message}");
    assert_eq!(whole["holes"], 5);
    let first = &whole["without_verdict"][0];
    assert_eq!(first["spindle_speed [rpm]"], 40.0);
    assert!(first["reason"].as_str().is_some_and(|reason| reason.contains("too slow for the period map")), "{first}");
    let share = whole["stable_share"].as_f64().expect("a share");
    let table = fs::read_to_string(folder.join("whole/lobes.csv")).expect("a table");
    assert!(table.starts_with(
        "spindle_speed [rpm],depth_of_cut [mm],spectral_radius,stable,type,chatter_frequency [Hz],hole\n"
    ));
    let holes =
        table.lines().filter(|line| line.contains(",,,,") && line.contains("too slow for the period map")).count();
    let stable = table.lines().filter(|line| line.contains(",true,stable,")).count();
    assert_eq!((table.lines().count(), holes), (31, 5));
    assert!((share - stable as f64 / 25.0).abs() < 1e-12);
    for name in ["lobes.svg", "report.html"] {
        assert!(fs::read_to_string(folder.join("whole").join(name)).expect(name).contains("no verdict"), "{name}");
    }
    assert_eq!(
        toolroom(&[&["lobes", &path, "--plan", &place("plan.json"), "--shards", "3"][..], &small].concat())
            .status
            .code(),
        Some(0)
    );
    for shard in ["2", "0", "1"] {
        let output = toolroom(&["shard", &place("plan.json"), shard, "--out", &place("parts")]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let output = toolroom(&["merge", &place("parts"), "--json", "--out", &place("merged")]);
    assert_eq!(json(&output), whole);
    assert!(stderr(&output).contains("5 of 30 points have no verdict"), "{}", stderr(&output));
    for name in ["lobes.csv", "lobes.svg", "lobes.png"] {
        let [one, other] = ["whole", "merged"].map(|out| fs::read(folder.join(out).join(name)).expect(name));
        assert_eq!(one, other, "{name}");
    }
    // A chart of nothing but holes is still a chart.
    let none = [
        "--set",
        "chart.columns=3",
        "--set",
        "chart.rows=2",
        "--set",
        "mode.tool.damping_ratio=0.0005",
        "--set",
        "chart.spindle_speed=[\"30 rpm\", \"60 rpm\"]",
        "--set",
        "chart.depth_of_cut=[\"0.1 mm\", \"2 mm\"]",
    ];
    let output = toolroom(&[&["lobes", &path, "--out", &place("none")][..], &none].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("no point of the chart has a verdict"));
    assert!(fs::read_to_string(folder.join("none/lobes.svg")).expect("a picture").contains("Slot with two teeth"));
}

/// A faulty structure is reported through the scenario whose tool names it, with place, value and fix in
/// either file.
#[test]
fn faults_of_a_structure_are_told_through_the_scenario() {
    let scenario = fs::read_to_string(shipped("chatter-policies")).expect("shipped");
    let structures =
        ["shaft", "endmill"].map(|name| fs::read_to_string(shipped(&format!("chatter/{name}"))).expect("shipped"));
    let folder = directory("lobes", "scenario-faults");
    fs::create_dir_all(folder.join("chatter")).expect("writable");
    let path = folder.join("shop.toml");
    let check = |changed: [(&str, &str); 3]| {
        let texts = [&scenario, &structures[0], &structures[1]];
        let names = ["shop.toml", "chatter/shaft.toml", "chatter/endmill.toml"];
        for ((text, name), (from, to)) in texts.into_iter().zip(names).zip(changed) {
            assert!(text.contains(from), "{from}");
            fs::write(folder.join(name), text.replacen(from, to, 1)).expect("writable");
        }
        let output = toolroom(&["check", &path.display().to_string()]);
        let answer = stderr(&output);
        let words: Vec<&str> = answer.split_whitespace().filter(|word| *word != "│").collect();
        (output.status.code(), words.join(" "))
    };
    let none = ("", "");
    assert_eq!(check([none, none, none]).0, Some(0));
    for (shaft, mill, messages) in [
        (
            ("stiffness = \"60 N/um\"", "stiffness = \"0 N/um\""),
            none,
            ["shaft.toml:16:", "`stiffness` = 0 N/um", "above 0"],
        ),
        (("stiffness = \"60 N/um\"", "stiffness = \"-60 N/um\""), none, ["shaft.toml:16:", "-60 N/um", "above 0"]),
        (("damping_ratio = 0.04", "damping_ratio = -0.04"), none, ["shaft.toml:15:", "-0.04", "above 0"]),
        (("damping_ratio = 0.04", "damping_ratio = nan"), none, ["shaft.toml:15:", "nan", "above 0"]),
        (("\"800 rpm\", \"2800 rpm\"", "\"800 rpm\", \"800 rpm\""), none, ["shaft.toml:", "800 rpm", "ascends"]),
        (("columns = 200", "columns = 1"), none, ["shaft.toml:", "`columns` = 1", "2 to 4000"]),
        (none, ("immersion = 0.25", "immersion = 1.25"), ["endmill.toml:", "`immersion` = 1.25", "up to 1"]),
        (none, ("teeth = 4", "teeth = 0"), ["endmill.toml:", "`teeth` = 0", "1 to 200"]),
        (none, ("teeth = 4", "teeth = 3"), ["shop.toml:", "3 teeth", "that of the tool 4"]),
        (none, ("stiffness = \"11 N/um\"", "stiffness = \"inf N/um\""), ["endmill.toml:", "inf", "number"]),
    ] {
        let (code, answer) = check([none, shaft, mill]);
        assert_eq!(code, Some(2), "{messages:?}: {answer}");
        assert!(answer.contains("structure ="), "{answer}");
        for message in messages {
            assert!(answer.contains(message), "{message} in\n{answer}");
        }
    }
    // What the scenario says about the cut itself.
    for (from, to, message) in [
        ("width_of_cut = \"3 mm\"", "width_of_cut = \"13 mm\"", "13 mm"),
        ("width_of_cut = \"3 mm\"", "width_of_cut = \"0 mm\"", "above 0"),
        ("depth_of_cut = \"2 mm\"", "depth_of_cut = \"nan mm\"", "number"),
        ("position = \"620 mm\"", "position = \"720 mm\"", "720 mm"),
        ("natural_frequency = \"2 %\"", "natural_frequency = \"-2 %\"", "-2 %"),
        ("amplitude = 0.2", "amplitude = 1.2", "1.2"),
        ("= \"chatter/shaft.toml", "= \"chatter/endmill.toml", "describes no turning"),
        ("= \"chatter/shaft.toml", "= \"chatter/nowhere.toml", "nowhere.toml"),
    ] {
        let (code, answer) = check([(from, to), none, none]);
        assert_eq!(code, Some(2), "{to}: {answer}");
        assert!(answer.contains(message) && answer.contains("shop.toml:"), "{message} in\n{answer}");
    }
}

#[test]
fn faults_of_a_file_are_told_with_their_place_and_fix() {
    let text = fs::read_to_string(shipped(SLOT)).expect("shipped");
    let cases = [
        ("teeth = 2", "teeth = 0", "1 to 200"),
        ("teeth = 2", "theeth = 2", "did you mean `teeth`?"),
        ("immersion = 1 ", "immersion = 1.2 ", "above 0 up to 1"),
        ("immersion = 1 ", "immersion = 0 ", "above 0 up to 1"),
        ("immersion = 1 ", "immersion = nan ", "`immersion` = nan is outside"),
        ("mass = \"0.03993 kg\"", "stiffness = \"-1 N/um\"", "`stiffness` = -1 N/um is outside"),
        ("[force]", "[speed_variation]\namplitude = 1\nrevolutions = 5\n[force]", "`amplitude` = 1 is outside"),
        ("[force]", "[speed_variation]\namplitude = 0.1\nrevolutions = 1\n[force]", "2 to 200"),
        ("[force]", "[speed_variation]\namplitude = 0.1\n[force]", "lacks `revolutions`"),
        ("damping_ratio = 0.011", "damping_ratio = -0.011", "`damping_ratio` = -0.011 is outside"),
        ("mass = \"0.03993 kg\"", "stiffness = \"0 N/um\"", "`stiffness` = 0 N/um is outside"),
        ("mass = \"0.03993 kg\"", "", "lacks `stiffness`"),
        ("mass = \"0.03993 kg\"", "mass = \"0.04 kg\"\nstiffness = \"1 N/um\"", "contradict each other"),
        ("direction = [1, 0] ", "direction = [0, 0] ", "which have a length"),
        ("direction = [1, 0] ", "direction = [1, 0, 0] ", "two components"),
        ("[\"5000 rpm\", \"25000 rpm\"]", "[\"5000 rpm\", \"5000 rpm\"]", "the range of a chart ascends"),
        ("[\"5000 rpm\", \"25000 rpm\"]", "[\"5000 rpm\"]", "least and greatest"),
        ("columns = 400", "columns = 1", "2 to 4000"),
        ("tangential = \"600 MPa\"", "tangential = \"600 mm\"", "`mm` is not a unit of"),
        ("process = \"milling\"", "process = \"turning\"", "does not apply to process = \"turning\""),
        ("process = \"milling\"", "process = \"millling\"", "did you mean `milling`?"),
        ("teeth = 2", "teeth = 2\npitch = [\"180 deg\"]", "every tooth has one pitch angle"),
        ("teeth = 2", "teeth = 2\npitch = [\"180 deg\", \"170 deg\"]", "360 deg"),
        ("teeth = 2", "teeth = 2\nrunout = \"10 um\"", "lacks `feed_per_tooth`"),
        ("schema = 1", "schema = 2", "write schema = 1"),
    ];
    for (from, to, message) in cases {
        assert!(text.contains(from), "{from}");
        let path = directory("lobes", "faults").join("faulty.toml");
        fs::write(&path, text.replacen(from, to, 1)).expect("writable");
        let output = toolroom(&["lobes", &path.display().to_string(), "--at", "5000 rpm", "0.5 mm"]);
        let answer = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{to}: {answer}");
        assert!(output.stdout.is_empty() && answer.contains("faulty.toml:"), "{to}: {answer}");
        // The message may be broken over lines that start with a bar.
        let words: Vec<&str> = answer.split_whitespace().filter(|word| *word != "│").collect();
        assert!(words.join(" ").contains(message), "{message} in\n{answer}");
    }
}

#[test]
fn a_file_without_modes_is_refused() {
    let text = fs::read_to_string(shipped(SLOT)).expect("shipped");
    let start = text.find("[[mode]]").expect("a mode");
    let end = text.find("[cutter]").expect("a cutter");
    let path = directory("lobes", "no-modes").join("faulty.toml");
    fs::write(&path, format!("{}{}", &text[..start], &text[end..])).expect("writable");
    let output = toolroom(&["lobes", &path.display().to_string(), "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let problems: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(problems["problems"][0]["message"], "there is no vibration mode");
}

#[test]
fn points_that_are_none_are_input_errors() {
    let path = shipped(SLOT);
    for (point, message) in [
        (["5000", "0.5 mm"], "has no unit"),
        (["5000 rpm", "0.5 kg"], "is not a unit of"),
        (["0 rpm", "0.5 mm"], "must be positive"),
        (["5000 rpm", "-0.5 mm"], "must not be negative"),
        (["nan rpm", "0.5 mm"], "does not start with a number"),
    ] {
        let output = toolroom(&["lobes", &path, "--at", point[0], point[1]]);
        assert_eq!(output.status.code(), Some(2), "{point:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(message), "{point:?}: {}", stderr(&output));
    }
    let output = toolroom(&["lobes", "/nowhere.toml"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
}

#[test]
fn a_cut_that_is_stable_again_above_its_limit_is_told_in_every_answer() {
    let path = directory("lobes", "again").join("again.toml");
    let text = "schema = 1\nname = \"again\"\nprocess = \"turning\"\n[[mode]]\nname = \"tool\"\ndirection = [0.81398, 0.5809]\n\
                natural_frequency = \"968.5 Hz\"\ndamping_ratio = 0.0347\nstiffness = \"4.917 N/um\"\n[cut]\n\
                cutting_coefficient = \"756.2 MPa\"\nforce_angle = \"34.2 deg\"\nprocess_damping = \"7.69e5 N/m\"\n\
                diameter = \"40 mm\"\n[chart]\nspindle_speed = [\"4200 rpm\", \"4450 rpm\"]\ndepth_of_cut = [\"0 mm\", \"8 mm\"]\n\
                columns = 11\nrows = 41\n";
    fs::write(&path, text).expect("writable");
    let path = path.display().to_string();
    let at = |depth: &str| json(&toolroom(&["lobes", &path, "--json", "--at", "4320.58 rpm", depth]));
    let verdict = at("4.5 mm");
    assert_eq!((&verdict["stable"], &verdict["certificate"]), (&true.into(), &"proved".into()));
    close(&verdict["stability_limit [mm]"], 3.40790862, 1e-7);
    let intervals = verdict["stable_intervals [mm]"].as_array().expect("a list");
    for (interval, [from, to]) in intervals.iter().skip(1).zip([[4.36082071, 4.76004717], [5.79565668, 9.0]]) {
        close(&interval[0], from, 1e-7);
        assert!(interval[1].as_f64().expect("a number") < 1.0 + to);
    }
    assert_eq!(intervals.len(), 3);
    assert_eq!(at("5 mm")["stable"], false);
    // Grid, curve and verdict are one answer: every point of the grid lies on the side that the ends say.
    let out = directory("lobes", "again-chart");
    let chart = json(&toolroom(&["lobes", &path, "--json", "--out", &out.display().to_string()]));
    let table = fs::read_to_string(out.join("lobes.csv")).expect("the table");
    let boundary = &chart["boundaries"][0];
    let ends = |speed: f64| -> Vec<f64> {
        let points = ["limit", "further"].into_iter().flat_map(|key| boundary[key].as_array().expect("points"));
        let here = points.filter(|point| (point[0].as_f64().expect("a speed") - speed).abs() < 1e-6);
        here.filter_map(|point| point[1].as_f64()).collect()
    };
    let mut compared = 0;
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let (speed, depth): (f64, f64) = (cells[0].parse().expect("speed"), cells[1].parse().expect("depth"));
        let below = ends(speed).into_iter().filter(|end| *end < depth).count();
        assert_eq!(cells[3] == "true", below % 2 == 0, "{row}");
        compared += 1;
    }
    assert_eq!(compared, 11 * 41);
    assert!(!boundary["curves"].as_array().expect("curves").is_empty());
}
