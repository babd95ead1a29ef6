//! Part programs as controls and editors write them: line ends, encodings, diameters; the table of motions.

use crate::command_line::{directory, json, stderr, stdout, toolroom};
use std::fs;
use std::path::Path;

/// A part program of a test.
fn program(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, text).expect("writable");
    path.display().to_string()
}

const PLATE: &str = "G21 G90 G94 G17\nT1 M6\nS1000 M3\nG0 X30 Y0 Z5\nG1 Z-1 F100\nX60 F200\nG0 Z50\nM30\n";

#[test]
fn a_program_with_carriage_returns_alone_is_the_same_program() {
    let folder = directory("program_files", "ends");
    let usual = program(&folder, "lf.nc", PLATE);
    let old = program(&folder, "cr.nc", PLATE.replace('\n', "\r"));
    let told = |file: &str| stdout(&toolroom(&["program", file, "--start", "0,0,100 mm"])).replace(file, "");
    assert!(told(&usual).contains("cycle time") || !told(&usual).is_empty());
    assert_eq!(told(&usual), told(&old));
    // A fault is at its line.
    let wrong = program(&folder, "wrong.nc", "G21 G90\rG0 X1\rG411\r");
    assert!(stderr(&toolroom(&["program", &wrong])).contains("wrong.nc:3:1:"));
}

#[test]
fn a_program_that_only_dwells_takes_its_time_and_one_that_does_nothing_is_refused() {
    let folder = directory("program_files", "dwells");
    let waits = program(&folder, "waits.nc", "%\nO1\nG21\nG4 P2000\nM30\n%\n");
    let told = json(&toolroom(&["program", &waits, "--dialect", "fanuc", "--json"]));
    assert_eq!((&told["dwell [s]"], &told["cycle_time [s]"]), (&2.0.into(), &2.0.into()), "{told}");
    let idle = toolroom(&["program", &program(&folder, "idle.nc", "%\nO1\nG21\nM30\n%\n"), "--dialect", "fanuc"]);
    assert_eq!(idle.status.code(), Some(2));
    assert!(stderr(&idle).contains("dwells nowhere"), "{}", stderr(&idle));
}

#[test]
fn a_program_in_utf_16_is_refused_by_that_name() {
    let folder = directory("program_files", "utf-16");
    let wide: Vec<u8> = [0xff, 0xfe].into_iter().chain(PLATE.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let output = toolroom(&["program", &program(&folder, "wide.nc", wide)]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("wide.nc: the text is UTF-16"), "{}", stderr(&output));
}

#[test]
fn motions_have_times_at_feed_and_in_rapid_with_and_without_a_setup() {
    let folder = directory("program_files", "motions");
    let (nc, csv) = (program(&folder, "plate.nc", PLATE), folder.join("motions.csv").display().to_string());
    let told = json(&toolroom(&["program", &nc, "--start", "0,0,100 mm", "--motions", &csv, "--json"]));
    let table = fs::read_to_string(&csv).expect("written");
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some("line,tool,purpose,rapid,time [s],length [mm],x [mm],z [mm]"),
        "axes that never move are left out: {table}"
    );
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let sum = |rapid: &str| -> f64 {
        rows.iter().filter(|row| row[3] == rapid).map(|row| row[4].parse::<f64>().expect("a time")).sum()
    };
    // Without drives: the longest axis at 30 m/min, 95 mm and 51 mm; at feed 6 mm at 100 and 30 mm at 200 mm/min.
    assert!((sum("1") - 146.0 / 500.0).abs() < 2e-6, "{table}");
    assert!((sum("0") - (3.6 + 9.0)).abs() < 2e-6, "{table}");
    let total = told["rapid_time [s]"].as_f64().expect("a time") + told["feed_time [s]"].as_f64().expect("a time");
    assert!((sum("0") + sum("1") - total).abs() < 1e-5, "{total}");

    let (nc, setup) = ("scenarios/programs/plate.nc", "scenarios/programs/plate-setup.toml");
    json(&toolroom(&[
        "program",
        nc,
        "--setup",
        setup,
        "--start",
        "0,0,100 mm",
        "--motions",
        &csv,
        "--force",
        "--json",
    ]));
    let table = fs::read_to_string(&csv).expect("written");
    let still = |line: &&str| line.split(',').nth(2) == Some("1") && line.split(',').nth(3) == Some("0.000000");
    let rapids = table.lines().filter(|line| line.split(',').nth(2) == Some("1")).count();
    assert!(rapids > 2 && table.lines().filter(still).count() < rapids / 2, "{table}");
}

#[test]
fn a_line_of_a_lathe_is_explained_in_diameters() {
    let folder = directory("program_files", "lathe");
    let text = "G21 G18 G99 G97 S800 M3\nG0 X100. Z5.\nG1 X40. F0.2\nM30\n";
    let nc = program(&folder, "shaft.nc", text);
    let arguments = ["program", &nc, "--dialect", "fanuc-lathe", "--start", "200,0,50 mm", "--explain", "3"];
    let told = stdout(&toolroom(&arguments));
    assert!(told.contains("from X100 to X40") && told.contains("behind it: X40"), "{told}");
    let told = json(&toolroom(&[&arguments[..], &["--json"]].concat()));
    let motion = &told["explained"]["first_runs"][0]["motions"][0];
    assert_eq!((motion["start"][0].as_f64(), motion["end"][0].as_f64()), (Some(100.0), Some(40.0)), "{motion}");
    assert_eq!(motion["length [mm]"].as_f64(), Some(30.0), "the way of the tool is that of a radius");
}

#[test]
fn a_shifted_tool_leaves_the_bore_with_the_spindle_at_its_angle() {
    let folder = directory("program_files", "oriented");
    let text = "G21 G90 G94 G17\nT1 M6\nS2000 M3\nG0 X0 Y0 Z20.\nG76 X10. Z-5. R2. Q0.5 F100\nG80\nG0 Z50.\nM30\n";
    let nc = program(&folder, "bore.nc", text);
    for dialect in ["fanuc", "haas", "siemens", "heidenhain", "linuxcnc"] {
        let out = folder.join(format!("{dialect}.out")).display().to_string();
        let output = toolroom(&["program", &nc, "--start", "0,0,100 mm", "--post", dialect, "--out", &out]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let posted = fs::read_to_string(&out).expect("written");
        // M5 would leave the tip against the wall wherever the spindle happens to stand.
        let oriented = posted.lines().position(|line| line.contains("M19")).unwrap_or_else(|| panic!("{posted}"));
        let shifted = posted.lines().skip(oriented).find(|line| line.contains('X')).expect("the shift");
        assert!(shifted.contains("10.5"), "{posted}");
        assert_eq!(toolroom(&["program", &out, "--dialect", dialect]).status.code(), Some(0), "{posted}");
    }
}
