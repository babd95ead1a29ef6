//! What a tap test comes as: responses with their coherence in another file, tables in place of modes, other tables than the usual;
//! and what follows from it at a point: roughness, unstable multipliers, the helix for a window of speeds.

use crate::command_line::{directory, json, shipped, stderr, stdout, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn tap() -> String {
    format!("{}/scenarios/data/tap-tool.csv", env!("CARGO_MANIFEST_DIR"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("writable");
    path.display().to_string()
}

/// The shipped tap as two files, as analysers export it.
#[test]
fn coherence_comes_from_a_file_of_its_own_and_import_puts_both_together() {
    let folder = directory("tap-tests", "coherence");
    let text = fs::read_to_string(tap()).expect("shipped");
    let rows: Vec<Vec<&str>> =
        text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect()).collect();
    let place = rows[0].iter().position(|title| title.contains("coherence")).expect("a coherence");
    let frequency = rows[0].iter().position(|title| title.contains("frequency")).expect("frequencies");
    let columns = |keep: &dyn Fn(usize) -> bool| {
        let line = |row: &Vec<&str>| {
            let cells = row.iter().enumerate().filter(|(i, _)| keep(*i)).map(|(_, cell)| *cell);
            cells.collect::<Vec<_>>().join(",") + "\n"
        };
        rows.iter().map(line).collect::<String>()
    };
    let responses = write(&folder, "frf.csv", &columns(&|i| i != place));
    let coherence = write(&folder, "coherence.csv", &columns(&|i| i == place || i == frequency));
    let both = folder.join("both.csv").display().to_string();
    let told = json(&toolroom(&["import", "frf", &responses, "--coherence", &coherence, "--out", &both, "--json"]));
    assert_eq!(told["functions"][0]["coherence"], true, "{told}");
    let fitted = |arguments: &[&str]| {
        let found = json(&toolroom(&[&["modes"], arguments, &["--averages", "5", "--json"]].concat()));
        let modes = found["modes"].as_array().expect("modes").clone();
        modes.iter().map(|mode| number(&mode["natural_frequency [Hz]"])).collect::<Vec<f64>>()
    };
    let whole = fitted(&[&tap()]);
    assert_eq!(fitted(&[&responses, "--coherence", &coherence]), whole);
    for (one, other) in fitted(&[&both]).iter().zip(&whole) {
        assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
    }
    let short = write(&folder, "short.csv", "frequency [Hz],coherence\n100,0.9\n102,0.9\n");
    let refused = toolroom(&["modes", &responses, "--coherence", &short]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("other frequencies"), "{}", stderr(&refused));
}

/// A structure file that names the measured responses has the modes that `modes` fits to them, and their own limit beside.
#[test]
fn a_structure_file_takes_measured_responses_in_place_of_modes() {
    let folder = directory("tap-tests", "table");
    fs::copy(tap(), folder.join("tap.csv")).expect("copied");
    let structure = folder.join("fitted.toml").display().to_string();
    let tap = folder.join("tap.csv").display().to_string();
    assert!(toolroom(&["modes", &tap, "--out", &structure]).status.success());
    write(&folder, "table.toml", "schema = 1\nname = \"tapped\"\ntable = \"tap.csv\"\n");
    let chart = write(
        &folder,
        "chart.toml",
        "schema = 1\nname = \"cut\"\nprocess = \"turning\"\nstructure = \"table.toml\"\n[cut]\ncutting_coefficient = \"1200 MPa\"\n\
         diameter = \"40 mm\"\n[chart]\nspindle_speed = [\"3000 rpm\", \"9000 rpm\"]\ndepth_of_cut = [\"0 mm\", \"1.5 mm\"]\n\
         columns = 12\nrows = 8\n",
    );
    let at = |arguments: &[&str]| {
        json(&toolroom(&[&["lobes", &chart, "--at", "4200 rpm", "0.4 mm", "--json"], arguments].concat()))
    };
    let (named, fitted) = (at(&[]), at(&["--set", "structure=fitted.toml"]));
    let limit = |told: &Value| number(&told["stability_limit [mm]"]);
    assert!((limit(&named) / limit(&fitted) - 1.0).abs() < 1e-6, "{named} {fitted}");
    // From the truth 0.429366 mm, straight from the noisy table 0.4281 mm.
    assert!((number(&named["measured_limit [mm]"]) / 0.4281 - 1.0).abs() < 0.015, "{named}");
    assert_eq!((&fitted["measured_limit [mm]"], &named["unstable_multipliers"]), (&Value::Null, &0.into()));
    let out = folder.join("out").display().to_string();
    let drawn = toolroom(&["lobes", &chart, "--out", &out]);
    assert!(drawn.status.success() && stdout(&drawn).contains("measured"), "{}", stdout(&drawn));
    // What must not be used is refused with its reason.
    write(&folder, "tap.csv", "frequency [Hz],real [um/N],imag [um/N]\n100,1,0\n102,1,-1\n");
    let refused = toolroom(&["lobes", &chart, "--at", "4200 rpm", "0.4 mm"]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("too few"), "{}", stderr(&refused));
}

/// `modes update` is `modes --cuts`.
#[test]
fn the_verb_that_updates_modes_says_what_the_option_says() {
    let folder = directory("tap-tests", "update");
    let structure = write(
        &folder,
        "lathe.toml",
        "schema = 1\nname = \"lathe\"\n[[mode]]\ndirection = [1, 0]\nnatural_frequency = { value = \"600 Hz\", sd = \"18 Hz\" }\n\
         damping_ratio = { value = 0.03, sd = 0.0075 }\nstiffness = { value = \"10 N/um\", sd = \"1 N/um\" }\n",
    );
    let chart = write(
        &folder,
        "chart.toml",
        "schema = 1\nname = \"lathe\"\nprocess = \"turning\"\nstructure = \"lathe.toml\"\n[cut]\ncutting_coefficient = \"1500 MPa\"\n\
         diameter = \"50 mm\"\n[chart]\nspindle_speed = [\"3000 rpm\", \"9000 rpm\"]\ndepth_of_cut = [\"0 mm\", \"1.5 mm\"]\n",
    );
    let cuts = write(&folder, "cuts.csv", "spindle_speed [rpm],depth_of_cut [mm],chatter\n3400,0.3,0\n6300,0.5,1\n");
    let rest = [structure.as_str(), "--cuts", &cuts, "--lobes", &chart, "--particles", "64"];
    let (verb, option) =
        (toolroom(&[&["modes", "update"], &rest[..]].concat()), toolroom(&[&["modes"], &rest[..]].concat()));
    assert!(verb.status.success(), "{}", stderr(&verb));
    assert_eq!(stdout(&verb), stdout(&option));
    assert_eq!(toolroom(&["modes", "update", &structure]).status.code(), Some(2));
}

/// Two teeth at low immersion: a helix takes the island of period doubling away.
#[test]
fn a_helix_goes_deeper_over_its_window() {
    let slot = shipped("chatter/milling-slot");
    let changes = ["--set", "engagement.immersion=0.05", "--set", "chart.depth_of_cut=[\"0 mm\", \"12 mm\"]"];
    let helix = |window: [&str; 2]| {
        toolroom(&[&["lobes", &slot, "--json", "--helix", window[0], window[1]], &changes[..]].concat())
    };
    let found = json(&helix(["16800 rpm", "17000 rpm"]));
    assert!(number(&found["gain"]) > 0.05, "{found}");
    let change = format!("cutter.helix_angle=\"{} deg\"", number(&found["helix_angle [deg]"]));
    let depth = format!("{} mm", 0.98 * number(&found["least_limit [mm]"]));
    let at = |extra: &[&str]| {
        json(&toolroom(&[&["lobes", &slot, "--at", "16900 rpm", &depth, "--json"], &changes[..], extra].concat()))
    };
    assert_eq!((&at(&["--set", &change])["stable"], &at(&[])["stable"]), (&true.into(), &false.into()));
    let refused = helix(["9000 rpm", "8000 rpm"]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("ascend"), "{}", stderr(&refused));
}

#[test]
fn a_point_has_its_roughness_and_its_number_of_unstable_multipliers() {
    let file = shipped("chatter/side-milling");
    let at = |speed: &str, depth: &str| json(&toolroom(&["lobes", &file, "--at", speed, depth, "--json"]));
    let (quiet, loud) = (at("8000 rpm", "1.5 mm"), at("8000 rpm", "7 mm"));
    assert_eq!((&quiet["stable"], &quiet["unstable_multipliers"]), (&true.into(), &0.into()));
    assert!(loud["unstable_multipliers"].as_u64().is_some_and(|count| count > 0), "{loud}");
    let ra = |told: &Value| number(&told["vibration"]["ra [um]"]);
    // Cusps alone would leave 0.1²/(18 sqrt(3) 8) mm, 0.04 um.
    assert!(ra(&quiet) > 0.02 && ra(&quiet) < 1.0, "{quiet}");
    assert!(ra(&loud) > 3.0 * ra(&quiet), "{loud}");
}
