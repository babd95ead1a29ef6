//! `toolroom coefficients`, the workbench of `toolroom lobes` (loads, limits, the best point, maps, vibration over time, pitch),
//! and modes that cuts of the shop bring up to date.

use crate::command_line::{directory, json, shipped, stderr, stdout, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;

const FILE: &str = "chatter/side-milling";

fn close(value: &Value, expected: f64, relative: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value / expected - 1.0).abs() < relative, "{value} against {expected}");
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The verdict of a shipped file at a point, with changes.
fn verdict(point: [&str; 2], changes: &[&str]) -> Value {
    let path = shipped(FILE);
    let mut arguments = vec!["lobes", &path, "--json", "--at", point[0], point[1]];
    for change in changes {
        arguments.extend(["--set", change]);
    }
    json(&toolroom(&arguments))
}

#[test]
fn slot_tests_give_coefficients_that_a_lobes_file_takes() {
    let data = format!("{}/scenarios/data/slot-al7075.csv", env!("CARGO_MANIFEST_DIR"));
    let folder = directory("workbench", "coefficients");
    let out = folder.join("al7075.toml").display().to_string();
    let arguments = ["coefficients", &data, "--teeth", "2", "--depth", "2 mm", "--json", "--out", &out];
    let found = json(&toolroom(&arguments));
    // Independent least squares.
    for (name, value, sd) in [
        ("tangential [MPa]", 791.341, 14.879),
        ("radial [MPa]", 188.342, 14.042),
        ("axial [MPa]", 222.101, 8.894),
        ("edge_tangential [N/mm]", 27.9944, 1.3778),
        ("edge_radial [N/mm]", 30.0511, 1.3002),
        ("edge_axial [N/mm]", 0.95154, 0.6675),
    ] {
        close(&found["coefficients"][name]["value"], value, 1e-5);
        close(&found["coefficients"][name]["sd"], sd, 1e-4);
    }
    assert_eq!(toolroom(&["check", &out]).status.code(), Some(0));
    // The shipped file is what the command writes, and stands in place of its numbers.
    let point = ["9000 rpm", "1.2 mm"];
    let named = verdict(point, &[]);
    let text = fs::read_to_string(shipped(FILE)).expect("shipped");
    let numbers = "tangential = \"791.34111 MPa\"\nradial = \"188.34222 MPa\"\n\
                   edge_tangential = \"27.99437 N/mm\"\nedge_radial = \"30.05113 N/mm\"\n";
    let written: String = text
        .lines()
        .map(|line| if line.starts_with("coefficients = \"") { numbers.to_owned() } else { format!("{line}\n") })
        .collect();
    let path = folder.join("numbers.toml");
    fs::write(&path, written).expect("writable");
    let place = path.display().to_string();
    let by_numbers = json(&toolroom(&["lobes", &place, "--json", "--at", point[0], point[1]]));
    close(&by_numbers["stability_limit [mm]"], number(&named["stability_limit [mm]"]), 1e-6);
    close(&by_numbers["power [kW]"], number(&named["power [kW]"]), 1e-6);
    // Forces on the work, and too few feeds, are refused with the fix.
    let opposite = toolroom(&["coefficients", &data, "--teeth", "2", "--depth", "2 mm", "--axes=-x,-y,-z"]);
    assert!(opposite.status.code() == Some(2) && stderr(&opposite).contains("opposite sign"), "{}", stderr(&opposite));
    let few = folder.join("few.csv");
    fs::write(&few, "feed_per_tooth [mm],mean_force_x [N],mean_force_y [N]\n0.1,-50,70\n0.1,-51,72\n")
        .expect("writable");
    let few = toolroom(&["coefficients", &few.display().to_string(), "--teeth", "2", "--depth", "2 mm"]);
    assert!(few.status.code() == Some(2) && stderr(&few).contains("three feeds"), "{}", stderr(&few));
    // A group of work materials where nothing was measured: 1775 MPa (0.1 mm)^-0.24, its tangent holds 76 %.
    let group = json(&toolroom(&["coefficients", "--group", "6", "--chip-thickness", "0.1 mm", "--json"]));
    close(&group["coefficients"]["tangential [MPa]"]["value"], 0.76 * 1775.0 * 0.1f64.powf(-0.24), 1e-9);
    assert!(stdout(&toolroom(&["coefficients", "--list"])).contains("titanium"));
    let list: Value = serde_json::from_str(&stdout(&toolroom(&["coefficients", "--list", "--json"]))).expect("JSON");
    assert!(list["groups"].as_array().is_some_and(|groups| groups.len() > 20 && groups[0]["k_c1.1 [MPa]"].is_number()));
}

#[test]
fn the_best_point_keeps_every_limit_and_more_power_is_not_less_removal() {
    let out = directory("workbench", "best").join("out").display().to_string();
    let path = shipped(FILE);
    let best = |power: &str| {
        let power = format!("limits.power={power}");
        let small = ["--set", "chart.columns=21", "--set", "chart.rows=8", "--set", &power];
        let arguments = [&["lobes", &path, "--best", "--json", "--out", &out][..], &small].concat();
        json(&toolroom(&arguments))["best"].clone()
    };
    let (tight, wide) = (best("1.5 kW"), best("8 kW"));
    for best in [&tight, &wide] {
        assert!(number(&best["p_stable"]) >= 0.95, "{best}");
        let point = [("spindle_speed [rpm]", "rpm"), ("depth_of_cut [mm]", "mm")]
            .map(|(key, unit)| format!("{} {unit}", number(&best[key])));
        let there = verdict([&point[0], &point[1]], &["limits.power=8 kW"]);
        assert_eq!((&there["stable"], &there["limits_broken"]), (&true.into(), &Value::Array(Vec::new())), "{there}");
        for (one, other) in [
            ("removal_rate [cm3/min]", "removal_rate [cm3/min]"),
            ("power [kW]", "power [kW]"),
            ("max_static_force [N]", "max_static_force [N]"),
        ] {
            close(&best[one], number(&there[other]), 1e-9);
        }
        close(&best["sle [um]"], number(&there["vibration"]["sle [um]"]), 1e-6);
    }
    assert!(number(&tight["power [kW]"]) <= 1.5 && number(&wide["power [kW]"]) > 1.5, "{tight} {wide}");
    assert!(number(&wide["removal_rate [cm3/min]"]) > number(&tight["removal_rate [cm3/min]"]));
    assert_eq!(tight["bound"], "power");
    // Without a feed there is nothing to remove.
    let none =
        toolroom(&["lobes", &shipped("chatter/milling-slot"), "--best", "--out", &out, "--set", "chart.columns=2"]);
    assert!(none.status.code() == Some(2) && stderr(&none).contains("feed_per_tooth"), "{}", stderr(&none));
}

#[test]
fn maps_show_what_a_point_tells() {
    let out = directory("workbench", "maps").join("out");
    let (path, place) = (shipped(FILE), out.display().to_string());
    let mut arguments =
        vec!["lobes", &path, "--json", "--out", &place, "--set", "chart.columns=6", "--set", "chart.rows=5"];
    for map in ["margin", "p_stable", "sle", "force", "torque", "power", "mrr"] {
        arguments.extend(["--show", map]);
    }
    json(&toolroom(&arguments));
    let rows = |name: &str| -> Vec<[String; 3]> {
        let text = fs::read_to_string(out.join(format!("{name}.csv"))).expect("a table");
        assert!(Path::new(&out).join(format!("{name}.png")).is_file());
        let row = |line: &str| {
            let cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            <[String; 3]>::try_from(cells).expect("three cells")
        };
        text.lines().skip(1).map(row).collect()
    };
    let at = |name: &str, speed: &str, depth: &str| -> Option<f64> {
        let rows = rows(name);
        let is = |cell: &str, value: &str| {
            let [cell, value] = [cell, value].map(|text| text.parse::<f64>().expect("a number"));
            (cell - value).abs() < 1e-9 * value
        };
        let row = rows.iter().find(|row| is(&row[0], speed) && is(&row[1], depth)).expect("the point is on the grid");
        row[2].parse().ok()
    };
    // A stable point of the grid, and an unstable one.
    for (speed, depth) in [("8000", "2.5"), ("4000", "10")] {
        let there = verdict([&format!("{speed} rpm"), &format!("{depth} mm")], &[]);
        let stable = there["stable"] == true;
        for (map, key) in [("torque", "torque [N m]"), ("power", "power [kW]"), ("mrr", "removal_rate [cm3/min]")] {
            close(&there[key], at(map, speed, depth).expect("a value"), 1e-9);
        }
        let (error, force) = (at("sle", speed, depth), at("force", speed, depth));
        assert_eq!((error.is_some(), force.is_some()), (stable, stable), "{speed} {depth}");
        if let (Some(error), Some(force)) = (error, force) {
            close(&there["vibration"]["sle [um]"], error, 1e-6);
            close(&there["max_static_force [N]"], force, 1e-9);
        }
        let probable = at("p_stable", speed, depth).expect("a share");
        assert!(if stable { probable > 0.5 } else { probable < 0.5 }, "{probable}");
    }
    let report = fs::read_to_string(out.join("report.html")).expect("a report");
    assert!(report.contains("power 4 kW") && report.contains("Removal rate"));
    let refused = toolroom(&["lobes", &shipped("chuck-fig3"), "--show", "power", "--out", &place]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("milling and turning"));
}

#[test]
fn limits_and_scatter_are_read_with_their_faults() {
    let broken = verdict(["8000 rpm", "9 mm"], &["limits.torque=0.5 N m"]);
    let limits: Vec<&str> =
        broken["limits_broken"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
    assert!(limits.contains(&"torque"), "{limits:?}");
    for (change, word) in [
        ("limits.power=-1 kW", "power"),
        ("limits.power=4 mm", "power"),
        ("scatter.coefficients=2", "coefficients"),
        ("force.feed_per_tooth=0 mm", "feed_per_tooth"),
        ("force.tangential=600 MPa", "one of the two places"),
        ("force.coefficients=none.toml", "none.toml"),
    ] {
        let output = toolroom(&["check", &shipped(FILE), "--set", change]);
        assert!(output.status.code() == Some(2) && stderr(&output).contains(word), "{change}: {}", stderr(&output));
    }
}

#[test]
fn a_vibration_over_time_has_the_lines_of_its_kind() {
    let folder = directory("workbench", "history");
    let slot = shipped("chatter/milling-slot");
    let history = |name: &str, at: [&str; 2]| -> Value {
        let out = folder.join(name).display().to_string();
        let feed = "force.feed_per_tooth=0.1 mm";
        let mut args = vec!["lobes", &slot, "--at", at[0], at[1], "--history", &out, "--json"];
        for known in [feed, "scatter.natural_frequency=0.01", "scatter.damping_ratio=0.1", "scatter.coefficients=0.1"] {
            args.extend(["--set", known]);
        }
        let output = toolroom(&args);
        let told = json(&output);
        let text = fs::read_to_string(folder.join(name).join("history.json")).expect("lines");
        let mut history: Value = serde_json::from_str(&text).expect("JSON");
        let [low, high] = [0, 1].map(|end| number(&history["p_stable_band"][end]));
        let probable = number(&history["p_stable"]);
        assert!(
            probable == number(&told["p_stable"]) && low <= probable && probable <= high && low < high,
            "{history}"
        );
        history["at"] = told;
        for file in ["history.csv", "spectrum.csv", "history.png", "spectrum.png", "section.png", "report.html"] {
            assert!(folder.join(name).join(file).is_file(), "{file}");
        }
        history
    };
    let origins = |history: &Value| -> Vec<String> {
        let lines = history["lines"].as_array().expect("lines");
        lines.iter().filter_map(|line| line["origin"].as_str().map(str::to_owned)).collect()
    };
    let stable = history("stable", ["12000 rpm", "1 mm"]);
    assert!(origins(&stable).iter().all(|origin| origin.starts_with("tooth")), "{stable}");
    assert_eq!(stable["at"]["vibration"]["method"], "forced");
    close(&stable["pp_x [um]"], number(&stable["at"]["vibration"]["pp_x [um]"]), 0.05);
    // Period doubling at 1.1 times the limit of 2.1493 mm: an independent simulation has 345.32 um and 222.6 N.
    let flip = history("flip", ["12000 rpm", "2.36424 mm"]);
    let vibration = &flip["at"]["vibration"];
    assert_eq!((&vibration["method"], &vibration["settled"]), (&"simulated".into(), &true.into()), "{vibration}");
    close(&vibration["pp_x [um]"], 345.32, 0.04);
    close(&vibration["max_force_x [N]"], 222.6, 0.04);
    close(&vibration["max_force_y [N]"], 342.0, 0.04);
    let lines = flip["lines"].as_array().expect("lines");
    let strongest = lines.iter().max_by(|a, b| number(&a["x [um]"]).total_cmp(&number(&b["x [um]"]))).expect("a line");
    assert!(strongest["origin"].as_str().is_some_and(|origin| origin.starts_with("chatter")), "{strongest}");
    // The great vibration that it settles to is not the one that sets in at 1000 Hz: it moves to 1015 Hz.
    close(&strongest["frequency [Hz]"], 1000.0, 0.02);
}

#[test]
fn an_unequal_pitch_goes_deeper_over_its_window() {
    let slot = shipped("chatter/milling-slot");
    // The worst lobe of equal pitch.
    let found = json(&toolroom(&[
        "lobes",
        &slot,
        "--pitch",
        "9000 rpm",
        "11000 rpm",
        "--json",
        "--set",
        "chart.depth_of_cut=[\"0 mm\", \"4 mm\"]",
    ]));
    assert!(number(&found["gain"]) > 0.3, "{found}");
    let pitch: Vec<f64> = found["pitch [deg]"].as_array().expect("angles").iter().map(number).collect();
    assert!((pitch.iter().sum::<f64>() - 360.0).abs() < 1e-9 && pitch.len() == 2, "{pitch:?}");
    // A verdict just below the limit that is told, at a speed of the window.
    let change = format!("cutter.pitch=[\"{:.6} deg\", \"{:.6} deg\"]", pitch[0], pitch[1]);
    let depth = format!("{} mm", 0.98 * number(&found["least_limit [mm]"]));
    let unequal = json(&toolroom(&["lobes", &slot, "--at", "10000 rpm", &depth, "--json", "--set", &change]));
    let equal = json(&toolroom(&["lobes", &slot, "--at", "10000 rpm", &depth, "--json"]));
    assert_eq!((&unequal["stable"], &equal["stable"]), (&true.into(), &false.into()), "{unequal}");
    let refused = toolroom(&["lobes", &slot, "--pitch", "9000 rpm", "8000 rpm"]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("ascend"), "{}", stderr(&refused));
}

/// Cuts of a shop whose mode lies 3.8 % below what the structure file says, at its limits.
#[test]
fn cuts_of_the_shop_bring_a_structure_file_up_to_date() {
    let folder = directory("workbench", "update");
    let place = |name: &str| folder.join(name).display().to_string();
    let structure = "schema = 1\nname = \"lathe\"\n[measurement]\nsource = \"tap\"\n[[mode]]\ndirection = [1, 0]\n\
                     natural_frequency = { value = \"600 Hz\", sd = \"18 Hz\" }\n\
                     damping_ratio = { value = 0.03, sd = 0.0075 }\nstiffness = { value = \"10 N/um\", sd = \"1 N/um\" }\n";
    let lobes = "schema = 1\nname = \"lathe\"\nprocess = \"turning\"\nstructure = \"lathe.toml\"\n\
                 [cut]\ncutting_coefficient = \"1500 MPa\"\ndiameter = \"50 mm\"\n\
                 [chart]\nspindle_speed = [\"3000 rpm\", \"9000 rpm\"]\ndepth_of_cut = [\"0 mm\", \"1.5 mm\"]\n";
    let cuts = "spindle_speed [rpm],depth_of_cut [mm],chatter\n3400,0.30,0\n3900,0.45,0\n4400,0.35,0\n5000,0.55,0\n\
                5600,0.75,1\n6300,0.50,1\n7000,0.45,0\n8000,0.70,1\n5800,0.80,0\n5400,0.70,1\n";
    for (name, text) in [("lathe.toml", structure), ("chart.toml", lobes), ("cuts.csv", cuts)] {
        fs::write(folder.join(name), text).expect("writable");
    }
    let (old, new, chart, records) = (place("lathe.toml"), place("new.toml"), place("chart.toml"), place("cuts.csv"));
    let base = ["modes", &old, "--cuts", &records, "--lobes", &chart, "--coefficients", "0", "--particles", "600"];
    let told = json(&toolroom(&[&base[..], &["--json", "--out", &new]].concat()));
    // An independent grid has 578.79 ± 7.19 Hz.
    let frequency = &told["modes"][0]["natural_frequency [Hz]"];
    assert!((number(&frequency["value"]) - 578.79).abs() < 2.5, "{told}");
    assert!((number(&frequency["sd"]) / 7.19 - 1.0).abs() < 0.3, "{told}");
    assert_eq!(told["drift"], false);
    assert!(number(&told["next_cut"]["p_chatter"]) > 0.2);
    // The new file is one, and the lobes have moved with it.
    assert_eq!(toolroom(&["check", &new]).status.code(), Some(0));
    let speed = |name: &str| {
        let change = format!("structure={name}");
        let found = json(&toolroom(&["lobes", &chart, "--json", "--at", "5600 rpm", "0.4 mm", "--set", &change]));
        number(&found["chatter_frequency [Hz]"])
    };
    assert!(speed("new.toml") < speed("lathe.toml"));
    // The same draws, the same text.
    assert_eq!(stdout(&toolroom(&base)), stdout(&toolroom(&base)));
    fs::write(folder.join("bad.csv"), "spindle_speed [rpm],depth_of_cut [mm],chatter\n3400,0.30,yes\n")
        .expect("writable");
    let bad = toolroom(&["modes", &old, "--cuts", &place("bad.csv"), "--lobes", &chart]);
    assert!(bad.status.code() == Some(2) && stderr(&bad).contains("bad.csv:2"), "{}", stderr(&bad));
}
