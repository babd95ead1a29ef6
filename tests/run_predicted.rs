//! A run without scatter, read by sensors without errors, is what the nominal model predicts of its records.

use crate::command_line::toolroom;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Channels that a sensor sheet makes exact, by process.
const EXACT: [(&str, &str); 6] = [
    ("flank_wear", "absolute = \"0 mm\""),
    ("cutting_force", "relative = 0.0"),
    ("feed_force", "relative = 0.0"),
    ("spindle_power", "relative = 0.0"),
    ("temperature", "relative = 0.0"),
    ("thermo_emf", "relative = 0.0"),
];

fn done(arguments: &[&str]) {
    let output = toolroom(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Greatest relative difference of readings from predictions by channel, over a run of the shipped nominal model of
/// turning, changed by `change`.
fn off(change: impl Fn(&str) -> String) -> BTreeMap<String, f64> {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| Path::join(dir.path(), name).display().to_string();
    let shipped = format!("{}/scenarios/gap/turning.toml", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(shipped).expect("a shipped model");
    let mut text = change(&text.replace("scatter = \"lab\"", "scatter = \"none\""));
    for (channel, sensor) in EXACT {
        text += &format!("\n[[gap.sensor]]\nchannel = \"{channel}\"\n{sensor}\n");
    }
    fs::write(at("shop.toml"), text).expect("a writable folder");
    done(&["run", &at("shop.toml"), "--seed", "1", "--records", &at("r"), "--out", &at("o")]);
    let data = at("r/operations.csv");
    done(&["gap", "predict", "--model", &at("shop.toml"), "--data", &data, "--out", &at("p")]);
    let table = fs::read_to_string(at("p/predictions.csv")).expect("predictions");
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let place = |name: &str| header.iter().position(|own| *own == name).expect("a column");
    let [channel, measured, predicted] = ["channel", "measured", "predicted"].map(place);
    let mut worst: BTreeMap<String, f64> = BTreeMap::new();
    for row in lines {
        let number = |at: usize| row[at].parse::<f64>().expect("a number");
        let (measured, predicted) = (number(measured), number(predicted));
        // A land below a tenth of a millimetre is judged as one of that.
        let unit = if row[channel] == "flank_wear" { predicted.max(0.1e-3) } else { predicted.abs() };
        let own = worst.entry(row[channel].to_owned()).or_default();
        *own = own.max((measured - predicted).abs() / unit);
    }
    worst
}

/// The body of the tool warms within an operation and cools between two: a temperature that is two per cent off is a
/// fifth of the life of an edge that wears by its heat.
#[test]
fn what_a_nominal_model_predicts_of_its_own_run_is_what_was_simulated() {
    let handling = |text: &str, times: [&str; 2]| {
        let text = text.replace("load_time = \"30 s\"", &format!("load_time = \"{}\"", times[0]));
        text.replace("load_time = \"15 s\"", &format!("load_time = \"{}\"", times[1]))
    };
    for times in [["30 s", "15 s"], ["3 s", "2 s"]] {
        let worst = off(|text| handling(text, times));
        let within = |channel: &str, least: f64| {
            let own = worst[channel];
            assert!(own < least, "{channel} is off by {own} where a part is handled for {times:?}: {worst:?}");
        };
        within("temperature", 0.004);
        within("thermo_emf", 0.002);
        within("cutting_force", 0.008);
        within("spindle_power", 0.008);
        within("feed_force", 0.02);
        within("flank_wear", 0.05);
    }
}
