//! `toolroom modes` and `toolroom swap`: from a tap test to a verdict, and what is refused.

use crate::command_line::{directory, json, shipped, stderr, toolroom};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;

fn close(value: &Value, expected: f64, relative: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value / expected - 1.0).abs() < relative, "{value} against {expected}");
}

/// The mode of the standard slot and one above: frequency (Hz), damping ratio, stiffness (N/um).
const MODES: [[f64; 3]; 2] = [[922.0, 0.011, 1.34005], [2300.0, 0.02, 8.0]];

/// A tap test of the modes in um/N with one percent of noise and its coherence, 5 averages.
fn tap(last: f64, sign: f64) -> String {
    let mut text = "frequency [Hz],real [um/N],imag [um/N],coherence\n".to_owned();
    let mut state = 1u64;
    // Sum of twelve uniform numbers: nearly normal.
    let mut normal = || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    for line in 0.. {
        let frequency = 200.0 + 2.0 * f64::from(line);
        if frequency > last {
            break;
        }
        let (mut re, mut im) = (0.0, 0.0);
        for [f, zeta, k] in MODES {
            let r = frequency / f;
            let (a, b) = (1.0 - r * r, 2.0 * zeta * r);
            re += a / (a * a + b * b) / k;
            im -= b / (a * a + b * b) / k;
        }
        let (ratio, size) = (0.01f64, re.hypot(im));
        let sd = size * ratio / 10f64.sqrt();
        let (re, im) = (sign * (re + sd * normal()), sign * (im + sd * normal()));
        let coherence = 1.0 / (1.0 + ratio * ratio);
        let _ = writeln!(text, "{frequency},{re:e},{im:e},{coherence:.9}");
    }
    text
}

#[test]
fn a_tap_test_becomes_a_verdict() {
    let folder = directory("dynamics", "verdict");
    let place = |name: &str| folder.join(name).display().to_string();
    fs::write(place("tap.csv"), tap(3200.0, 1.0)).expect("writable");
    let (tap, structure, report) = (place("tap.csv"), place("tool.toml"), place("report"));
    let arguments = ["modes", &tap, "--averages", "5", "--out", &structure, "--report", &report, "--json"];
    let found = json(&toolroom(&arguments));
    assert_eq!(found["modes"].as_array().map(Vec::len), Some(2), "{found}");
    assert_eq!(found["refused"], Value::Null);
    for (mode, [f, zeta, k]) in found["modes"].as_array().expect("modes").iter().zip(MODES) {
        close(&mode["natural_frequency [Hz]"], f, 1e-3);
        close(&mode["damping_ratio"], zeta, 1e-2);
        close(&mode["stiffness [N/um]"], k, 1e-2);
    }
    assert!(Path::new(&report).join("report.html").exists());
    assert_eq!(toolroom(&["check", &structure]).status.code(), Some(0));
    // The slot of the literature with the modes of the tap test instead of its own.
    let lobes = fs::read_to_string(shipped("chatter/milling-slot")).expect("shipped");
    let (before, rest) = lobes.split_once("[[mode]]").expect("a mode");
    let after = rest.split_once("[cutter]").expect("a cutter").1;
    let with =
        |modes: &str| format!("{}{modes}\n[cutter]{after}", before.replace("#:schema ../schema/lobes.schema.json", ""));
    fs::write(place("fitted.toml"), with("structure = \"tool.toml\"")).expect("writable");
    let modes = MODES.map(|[f, zeta, k]| {
        format!(
            "[[mode]]\ndirection = [1, 0]\nnatural_frequency = \"{f} Hz\"\ndamping_ratio = {zeta}\nstiffness = \"{k} N/um\"\n"
        )
    });
    fs::write(place("true.toml"), with(&modes.concat())).expect("writable");
    let limit = |file: &str| {
        let at = json(&toolroom(&["lobes", &place(file), "--json", "--at", "8000 rpm", "0.3 mm"]));
        at["stability_limit [mm]"].as_f64().expect("a limit")
    };
    let (fitted, truth) = (limit("fitted.toml"), limit("true.toml"));
    assert!((fitted / truth - 1.0).abs() < 0.02, "{fitted} {truth}");
    // Deep under the limit it is stable nearly for sure, above it is not: half a percent of frequency moves the lobe far.
    let probable = |file: &str, depth: &str| {
        json(&toolroom(&["lobes", &place(file), "--json", "--at", "8000 rpm", depth]))["p_stable"].as_f64()
    };
    assert!(probable("fitted.toml", "0.1 mm").is_some_and(|share| share > 0.95));
    assert!(probable("fitted.toml", "2 mm").is_some_and(|share| share < 0.5));
    assert_eq!(probable("true.toml", "0.1 mm"), None);
    // Modes in both places contradict each other.
    fs::write(place("both.toml"), with(&format!("structure = \"tool.toml\"\n{}", modes[0]))).expect("writable");
    let both = toolroom(&["lobes", &place("both.toml"), "--at", "8000 rpm", "0.3 mm"]);
    assert!(both.status.code() == Some(2) && stderr(&both).contains("structure"), "{}", stderr(&both));
}

#[test]
fn a_bad_tap_test_leaves_no_structure_behind() {
    let folder = directory("dynamics", "refused");
    let place = |name: &str| folder.join(name).display().to_string();
    for (name, text, code) in [("turned", tap(3200.0, -1.0), "sensor-sign"), ("cut", tap(930.0, 1.0), "edge-of-range")]
    {
        let (tap, out) = (place(&format!("{name}.csv")), place(&format!("{name}.toml")));
        fs::write(&tap, text).expect("writable");
        let refused = toolroom(&["modes", &tap, "--averages", "5", "--out", &out]);
        assert_eq!(refused.status.code(), Some(1), "{}", stderr(&refused));
        assert!(stderr(&refused).contains(code), "{}", stderr(&refused));
        assert!(!Path::new(&out).exists());
        assert_eq!(toolroom(&["modes", &tap, "--out", &out, "--accept-refused"]).status.code(), Some(0));
        assert!(Path::new(&out).exists());
    }
    fs::write(place("units.csv"), "frequency,real,imag\n1,2,3\n").expect("writable");
    let refused = toolroom(&["modes", &place("units.csv")]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("has no unit"), "{}", stderr(&refused));
}

#[test]
fn a_shorter_tool_on_the_same_spindle_is_stiffer() {
    let folder = directory("dynamics", "swap");
    let out = folder.join("d12.toml").display().to_string();
    let (spindle, tool) = (shipped("chatter/spindle"), shipped("chatter/endmill12"));
    let swap = |change: &[&str]| {
        let arguments = ["swap", &spindle, "--tool", &tool, "--json", "--out", &out, "--force"];
        let arguments = [&arguments[..], &["--range", "50 Hz", "9000 Hz"], change].concat();
        json(&toolroom(&arguments))
    };
    // Static compliance (um/N) at the tip: that of all modes and of the residual.
    let compliance = |found: &Value| {
        let modes = found["modes"].as_array().expect("modes");
        let stiffness = modes.iter().map(|mode| mode["stiffness [N/um]"].as_f64().expect("a stiffness"));
        let residual = found["upper_residual [um/N]"]["xx"].as_f64().expect("a residual");
        stiffness.map(|stiffness| 1.0 / stiffness).sum::<f64>() + residual
    };
    let long = swap(&[]);
    assert!(long["modes"].as_array().is_some_and(|modes| modes.len() >= 3), "{long}");
    let shorter = swap(&["--set", "segment.2.length=\"6 mm\""]);
    assert!(compliance(&shorter) < 0.9 * compliance(&long), "{shorter} {long}");
    assert_eq!(toolroom(&["check", &out]).status.code(), Some(0));
    assert_eq!(toolroom(&["check", &tool]).status.code(), Some(0));
    let refused = toolroom(&["swap", &tool, "--tool", &tool]);
    assert_eq!(refused.status.code(), Some(2));
}
