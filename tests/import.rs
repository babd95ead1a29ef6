//! `toolroom import` as a user meets it.

use crate::command_line::toolroom;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn put(dir: &Path, name: &str, text: &str) -> String {
    let path = dir.join(name);
    fs::write(&path, text).expect("a writable folder");
    path.display().to_string()
}

const MAP: &str = "schema = 1\nprocess = \"empirical\"\nrows_per_operation = 2\n\
    column = [{ name = \"tool_id\", from = \"tool\" }, { name = \"cutting_force\", from = \"Fc\", unit = \"kN\" }]\n";

#[test]
fn a_series_of_a_foreign_logger_becomes_records_that_read_back() {
    let dir = tempfile::tempdir().expect("a folder");
    let log = put(dir.path(), "log.csv", "\u{FEFF}tool;Fc;note\nA;0,5;x\nA;0,7;\nB;n/a;\nB;err;\n");
    let map = put(dir.path(), "map.toml", MAP);
    let out = dir.path().join("out");
    let run = toolroom(&["import", "csv", &log, "--map", &map, "--out", &out.display().to_string(), "--json"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let report: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((report["rows"].as_u64(), report["unused"][0].as_str()), (Some(2), Some("note")));
    assert_eq!(
        (report["unreadable"][0]["line"].as_u64(), report["unreadable"][0]["read"].as_str()),
        (Some(5), Some("err"))
    );
    let csv = fs::read_to_string(out.join("operations.csv")).expect("records");
    assert_eq!(csv, "operation_id,tool_id,sequence,cutting_force [N]\nA-1,A,1,600\nB-1,B,1,\n");
    assert!(out.join("import.json").is_file() && out.join("run.json").is_file());
}

#[test]
fn an_import_never_replaces_what_it_reads() {
    let dir = tempfile::tempdir().expect("a folder");
    let log = put(dir.path(), "operations.csv", "tool;Fc\nA;0,5\n");
    let map = put(dir.path(), "map.toml", MAP);
    let out = dir.path().display().to_string();
    for force in [&[][..], &["--force"]] {
        let run = toolroom(&[&["import", "csv", &log, "--map", &map, "--out", &out], force].concat());
        assert_eq!(run.status.code(), Some(2), "{run:?}");
        assert!(String::from_utf8_lossy(&run.stderr).contains("is an input of this command"), "{run:?}");
    }
    assert_eq!(fs::read_to_string(&log).expect("there"), "tool;Fc\nA;0,5\n");
}

#[test]
fn the_nasa_table_needs_no_mapping() {
    let dir = tempfile::tempdir().expect("a folder");
    let text = "case,run,VB,time,DOC,feed,material,cut_no\n1,1,0.1,2,1.5,0.5,1,0\n1,2,,4,1.5,0.5,1,1\n2,1,0.3,3,0.75,0.25,2,2\n";
    let table = put(dir.path(), "mill.csv", text);
    let out = dir.path().join("out").display().to_string();
    let run = toolroom(&["import", "nasa-mill", &table, "--out", &out]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let csv = fs::read_to_string(Path::new(&out).join("operations.csv")).expect("records");
    assert!(csv.contains("1-2,1,2,cast iron,0.5,1.5,2,\n") && csv.contains("2-1,2,1,steel,0.25,0.75,3,0.3\n"), "{csv}");
}

#[test]
fn what_a_mapping_gets_wrong_is_told_with_place_and_fix() {
    let dir = tempfile::tempdir().expect("a folder");
    let log = put(dir.path(), "log.csv", "tool,Fc\nA,1\n");
    let faulty =
        put(dir.path(), "map.toml", &MAP.replace("cutting_force", "cuting_force").replace("process", "proces"));
    let run =
        toolroom(&["import", "csv", &log, "--map", &faulty, "--out", &dir.path().join("o").display().to_string()]);
    let said = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(2), "{said}");
    assert!(said.contains("proces") && said.contains("map.toml"), "{said}");
    let map = put(dir.path(), "other.toml", &MAP.replace("\"Fc\"", "\"Fx\""));
    let run = toolroom(&["import", "csv", &log, "--map", &map, "--out", &dir.path().join("o").display().to_string()]);
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.code() == Some(2) && said.contains("no column `Fx`") && said.contains("Fc"), "{said}");
    assert!(!dir.path().join("o").exists(), "nothing half-written is left");
}
