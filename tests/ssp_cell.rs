//! `toolroom ssp export` from the command line. That the cell wears as the shop does is a test of fmu/ssp.

use crate::command_line::{directory, json, shipped, stderr, stdout, toolroom};

#[test]
fn a_lathe_and_its_policy_become_a_package_that_ssp_info_reads() {
    let package = directory("ssp_cell", "export").join("cell.ssp").display().to_string();
    let file = shipped("lathe-cell");
    let made = toolroom(&["ssp", "export", &file, "--machine", "L", "--out", &package]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    assert!(stdout(&made).contains("lathe-cell on L: ring.turn, policy adaptive, FMI 2.0"), "{}", stdout(&made));
    assert!(stderr(&made).contains("edges are nominal and sensors exact"), "{}", stderr(&made));
    let info = json(&toolroom(&["ssp", "info", &package, "--json"]));
    assert_eq!((&info["ssp_version"], &info["stop [s]"]), (&"1.0".into(), &3600.0.into()), "{info}");
    let names: Vec<_> = info["components"].as_array().expect("units").iter().map(|each| each["name"].clone()).collect();
    assert_eq!(names, ["controller", "lathe"]);
    assert_eq!(info["connections"].as_array().map(Vec::len), Some(8), "{info}");
    assert_eq!(info["boundary"].as_array().map(Vec::len), Some(4), "{info}");

    let unknown = toolroom(&["ssp", "export", &file, "--machine", "L9", "--out", &format!("{package}.other")]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(stderr(&unknown).contains("there is no machine `L9`; there are L"), "{}", stderr(&unknown));
}
