//! `toolroom swap`: a tool on a spindle of which taps on a blank are known, prediction beside measurement, the joint of a holder.

use crate::command_line::{directory, json, shipped, stderr, toolroom};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::fs;
use toolroom_dynamics::{BaseMode, Joint, Material, Receptance, Segment, base, chain};

/// The spindle of `scenarios/chatter/spindle.toml`.
fn spindle(w: f64) -> Receptance {
    let mode = |[natural_frequency, damping_ratio, stiffness, rotation]: [f64; 4]| BaseMode {
        natural_frequency,
        damping_ratio,
        stiffness,
        rotation,
    };
    base(&[[680.0, 0.045, 42e6, -9.0], [1420.0, 0.03, 65e6, -14.0], [2950.0, 0.025, 90e6, -22.0]].map(mode), w)
}

/// Materials of tool files.
const STEEL: Material = Material { youngs_modulus: 205e9, density: 7_850.0, poisson_ratio: 0.29, loss_factor: 0.004 };
const CARBIDE: Material =
    Material { youngs_modulus: 580e9, density: 14_500.0, poisson_ratio: 0.24, loss_factor: 0.004 };

/// A table of responses (m/N) in um/N with noise of a share of their greatest modulus, coherence and 5 averages.
fn table(names: &[&str], noise: f64, at: impl Fn(f64) -> Vec<[f64; 2]>) -> String {
    let frequencies: Vec<f64> = (0..1600).map(|line| 150.0 + 3.0 * f64::from(line)).collect();
    let values: Vec<Vec<[f64; 2]>> = frequencies.iter().map(|frequency| at(TAU * frequency)).collect();
    let mut text = "frequency [Hz]".to_owned();
    for name in names {
        let _ = write!(text, ",{name}real [um/N],{name}imag [um/N],{name}coherence");
    }
    let mut state = 7u64;
    let mut normal = || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    for (frequency, row) in frequencies.iter().zip(&values) {
        let _ = write!(text, "\n{frequency}");
        for (i, [re, im]) in row.iter().enumerate().take(names.len()) {
            let greatest = values.iter().map(|row| row[i][0].hypot(row[i][1])).fold(0.0, f64::max);
            let share = noise * greatest / re.hypot(*im);
            let (coherence, sd) = (1.0 / (1.0 + share * share), 1e6 * noise * greatest / 10f64.sqrt());
            let (re, im) = (1e6 * re + sd * normal(), 1e6 * im + sd * normal());
            let _ = write!(text, ",{re:e},{im:e},{coherence:.9}");
        }
    }
    text + "\n"
}

/// Real and imaginary part of the displacement over the force.
fn part(receptance: Receptance) -> [f64; 2] {
    [receptance[(0, 0)].re, receptance[(0, 0)].im]
}

/// Taps on a steel blank of 16 by 40 mm at its tip and 25 mm behind it.
fn blank(names: &[&str], noise: f64) -> String {
    table(names, noise, |w| {
        let front = Segment::rod(0.025, 0.016, 1.0, STEEL).body(w).expect("finite");
        let behind =
            Segment::rod(0.015, 0.016, 1.0, STEEL).body(w).expect("finite").on(&spindle(w), None).expect("finite");
        let coupling = (front.r22 + behind).try_inverse().expect("finite");
        let tip = front.r11 - front.r12 * coupling * front.r21;
        [tip, behind * coupling * front.r21, behind * coupling * front.r22].map(part).to_vec()
    })
}

/// A tap on the end mill of `scenarios/chatter/endmill12.toml` on the spindle.
fn assembly(joint: &Joint) -> String {
    let tool = [Segment::rod(0.026, 0.012, 0.8, CARBIDE), Segment::rod(0.014, 0.012, 1.0, CARBIDE)];
    table(&[""], 0.003, |w| {
        let tip = chain(&tool, w).and_then(|body| body.on(&spindle(w), Some(joint))).expect("finite");
        vec![part(tip)]
    })
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The mode that limits a cut: frequency (Hz), damping ratio times stiffness (N/um).
fn limiting(value: &Value) -> (f64, f64) {
    let modes = value["modes"].as_array().expect("modes").iter();
    let modes = modes.map(|mode| {
        let damped = number(&mode["damping_ratio"]) * number(&mode["stiffness [N/um]"]);
        (number(&mode["natural_frequency [Hz]"]), damped)
    });
    modes.min_by(|a, b| a.1.total_cmp(&b.1)).expect("a mode")
}

const BLANK: [&str; 6] = ["--blank", "steel d=16 mm L=40 mm", "--second", "25 mm", "--averages", "5"];
/// Up to the highest mode of the spindle; that of the tool beyond it would be called one at the edge of the range.
const RANGE: [&str; 4] = ["--range", "150 Hz", "2900 Hz", "--accept-refused"];

#[test]
fn taps_on_a_blank_stand_in_for_modes_with_rotations() {
    let folder = directory("coupling", "blank");
    let place = |name: &str| folder.join(name).display().to_string();
    let tool = shipped("chatter/endmill12");
    let from_modes =
        json(&toolroom(&[&["swap", &shipped("chatter/spindle"), "--tool", &tool, "--json"][..], &RANGE].concat()));
    let (frequency, damped) = limiting(&from_modes);
    for (name, functions) in [("three", &["11.", "21.", "22."][..]), ("two", &["11.", "21."])] {
        let (taps, out) = (place(&format!("{name}.csv")), place(&format!("{name}.toml")));
        fs::write(&taps, blank(functions, 0.001)).expect("writable");
        let arguments = [&["swap", &taps, "--tool", &tool, "--out", &out, "--json"][..], &BLANK, &RANGE].concat();
        let found = json(&toolroom(&arguments));
        // Damping of the materials is hysteretic: with and without weights by noise a viscous mode differs by some percent.
        let (f, d) = limiting(&found);
        assert!(
            (f / frequency - 1.0).abs() < 2e-3 && (d / damped - 1.0).abs() < 0.05,
            "{name}: {f} {d} {frequency} {damped}"
        );
        let notes = found["notes"].to_string();
        assert_eq!(notes.contains("synthesised"), name == "two", "{notes}");
        assert!(notes.contains('±'), "{notes}");
        assert_eq!(toolroom(&["check", &out]).status.code(), Some(0));
    }
    fs::write(place("one.csv"), blank(&["11."], 0.001)).expect("writable");
    let refused = |file: &str, blank: &[&str]| {
        let output = toolroom(&[&["swap", &place(file), "--tool", &tool][..], blank].concat());
        assert_eq!(output.status.code(), Some(2));
        stderr(&output)
    };
    assert!(refused("one.csv", &BLANK).contains("second point"));
    for (blank, second, word) in [
        ("brass d=16 mm L=40 mm", "25 mm", "brass"),
        ("steel L=40 mm", "25 mm", "lacks d="),
        ("steel d=16 mm L=-4 mm", "25 mm", "no length"),
        ("steel d=16 kg L=40 mm", "25 mm", "--blank d"),
        ("steel d=16 mm L=40 mm", "41 mm", "beyond the blank"),
    ] {
        let message = refused("two.csv", &["--blank", blank, "--second", second]);
        assert!(message.contains(word), "{message}");
    }
}

#[test]
fn a_joint_is_found_from_one_measured_tool() {
    let folder = directory("coupling", "joint");
    let place = |name: &str| folder.join(name).display().to_string();
    let (base, tool, tap) = (shipped("chatter/spindle"), shipped("chatter/endmill12"), place("tap.csv"));
    // Another joint than that of the tool file, 200 N/um and 25 000 N m/rad.
    let joint = Joint { radial: 9e7, angular: 1.2e4, loss_factor: 0.04 };
    fs::write(&tap, assembly(&joint)).expect("writable");
    let compared = |more: &[&str]| {
        let arguments = ["swap", &base, "--tool", &tool, "--measured", &tap, "--json"];
        json(&toolroom(&[&arguments[..], &RANGE, more].concat()))["comparison"].clone()
    };
    let before = compared(&[]);
    assert!(number(&before["difference"]) > 0.3 && before["joint"].is_null(), "{before}");
    let report = place("report");
    let after = compared(&["--fit-joint", "--report", &report]);
    assert!(number(&after["difference"]) < 0.02, "{after}");
    let found = &after["joint"];
    for (key, expected) in [("radial [N/um]", 90.0), ("angular [N m/rad]", 12_000.0), ("loss_factor", 0.04)] {
        assert!((number(&found[key]) / expected - 1.0).abs() < 0.05, "{key}: {found}");
    }
    for pair in after["peaks"].as_array().expect("peaks") {
        let of = |part: &str| number(&pair[part]["frequency [Hz]"]);
        assert!((of("measured") / of("predicted") - 1.0).abs() < 0.005, "{pair}");
    }
    let page = fs::read_to_string(folder.join("report/report.html")).expect("written");
    assert!(page.contains("predicted and measured"));
    let refused = toolroom(&["swap", &base, "--tool", &tool, "--fit-joint"]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("--measured"), "{}", stderr(&refused));
}

#[test]
fn a_damper_in_a_boring_bar_makes_it_stiffer_where_it_swings() {
    let folder = directory("coupling", "damper");
    let place = |name: &str| folder.join(name).display().to_string();
    // A turret that hardly moves, and a steel bar of 32 mm, 200 mm out of it: 0.72 kg/m of modal mass, about 600 Hz.
    let turret = "schema = 1\nname = \"turret\"\n[measurement]\n[[mode]]\ndirection = [1, 0]\n\
                  natural_frequency = { value = \"1500 Hz\" }\ndamping_ratio = { value = 0.03 }\n\
                  stiffness = { value = \"500 N/um\" }\nrotation = \"-3 1/m\"\n";
    let bar = "schema = 1\nname = \"bar\"\n[[segment]]\nlength = \"40 mm\"\ndiameter = \"32 mm\"\nmaterial = \"steel\"\n\
               [[segment]]\nlength = \"160 mm\"\ndiameter = \"32 mm\"\nmaterial = \"steel\"\n";
    let damper = |segments: u32| {
        format!(
            "{bar}[damper]\nmass = \"0.05 kg\"\nnatural_frequency = \"480 Hz\"\ndamping_ratio = 0.2\nsegments = {segments}\n"
        )
    };
    fs::write(place("turret.toml"), turret).expect("writable");
    fs::write(place("bar.toml"), bar).expect("writable");
    fs::write(place("damped.toml"), damper(1)).expect("writable");
    fs::write(place("beyond.toml"), damper(2)).expect("writable");
    let (turret, range) = (place("turret.toml"), ["--range", "50 Hz", "2500 Hz"]);
    let least_real = |tool: &str| {
        let report = place(&format!("report-{tool}"));
        let tool = place(&format!("{tool}.toml"));
        let arguments = ["swap", &turret, "--tool", &tool, "--report", &report, "--accept-refused", "--quiet"];
        assert_eq!(toolroom(&[&arguments[..], &range].concat()).status.code(), Some(0));
        let table = fs::read_to_string(format!("{report}/frf.csv")).expect("written");
        let real =
            table.lines().skip(1).map(|row| row.split(',').nth(1).expect("a cell").parse::<f64>().expect("a number"));
        real.fold(0.0, f64::min)
    };
    // The least real part, which sets the limit of the cut.
    let (plain, damped) = (least_real("bar"), least_real("damped"));
    assert!(plain < 3.0 * damped && damped < 0.0, "{plain} {damped}");
    let refused = toolroom(&["swap", &turret, "--tool", &place("beyond.toml")]);
    assert!(refused.status.code() == Some(2) && stderr(&refused).contains("a damper lies in"), "{}", stderr(&refused));
}
