//! `toolroom fmu info` and `fmu check` as a user meets them.

use crate::command_line::toolroom;
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};

const GAIN: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Gain" guid="{g}" description="Doubles">
  <CoSimulation modelIdentifier="Gain" canHandleVariableCommunicationStepSize="true"/>
  <UnitDefinitions><Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit></UnitDefinitions>
  <ModelVariables>
    <ScalarVariable name="force" valueReference="1" causality="input"><Real unit="N" start="2"/></ScalarVariable>
    <ScalarVariable name="double" valueReference="2" causality="output" initial="calculated"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2"/></Outputs><InitialUnknowns><Unknown index="2"/></InitialUnknowns></ModelStructure>
</fmiModelDescription>"#;

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// A unit with sources only, which is sound but for what `from` → `to` changes.
fn unit(name: &str, from: &str, to: &str) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmu_files");
    std::fs::create_dir_all(&folder).expect("the target directory is writable");
    let path: PathBuf = folder.join(name);
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).expect("writable"));
    for (name, content) in [("modelDescription.xml", GAIN.replace(from, to)), ("sources/gain.c", "int x;".to_owned())] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).expect("an entry");
        zip.write_all(content.as_bytes()).expect("an entry");
    }
    zip.finish().expect("a zip file");
    path.display().to_string()
}

#[test]
fn info_shows_variables_with_units() {
    let path = unit("info.fmu", "", "");
    let output = toolroom(&["fmu", "info", &path]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let shown = text(&output.stdout);
    for expected in ["Gain, FMI 2.0", "Doubles", "Co-Simulation", "force [N]", "platforms              none"] {
        assert!(shown.contains(expected), "{expected} in\n{shown}");
    }
    let output = toolroom(&["fmu", "info", &path, "--json"]);
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(result["variables"][0]["unit"], "N");
    assert_eq!(result["interfaces"]["co_simulation"]["modelIdentifier"], "Gain");
}

#[test]
fn check_says_which_rule_is_broken_where() {
    let sound = toolroom(&["fmu", "check", &unit("sound.fmu", "", "")]);
    assert_eq!(sound.status.code(), Some(0), "{}", text(&sound.stdout));
    let path = unit("faulty.fmu", "<Outputs><Unknown index=\"2\"/></Outputs>", "");
    let faulty = toolroom(&["fmu", "check", &path]);
    assert_eq!(faulty.status.code(), Some(2));
    assert!(text(&faulty.stdout).contains("missing in <ModelStructure> as output: double"), "{}", text(&faulty.stdout));
    let output = toolroom(&["fmu", "check", &path, "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&result["valid"], &result["errors"]), (&Value::from(false), &Value::from(1)));
    assert_eq!(result["findings"][0]["rule"], "structure");
}

#[test]
fn what_is_no_unit_is_refused_with_its_path() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no.fmu");
    std::fs::write(&path, "no zip").expect("writable");
    let path = path.display().to_string();
    for verb in ["info", "check"] {
        for file in [path.as_str(), "not/there.fmu", "."] {
            let output = toolroom(&["fmu", verb, file]);
            assert_eq!(output.status.code(), Some(2), "{verb} {file}");
            assert!(text(&output.stderr).contains(&format!("error: {file}")), "{}", text(&output.stderr));
        }
    }
}

#[test]
fn a_package_goes_into_the_file_that_is_named_and_takes_the_place_of_no_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let mine = folder.path().join("t.fmu");
    let export = |more: &[&str]| {
        let out = mine.display().to_string();
        let output = toolroom(&[&["fmu", "export", "turning", "--out", &out], more].concat());
        (output.status.code(), text(&output.stderr))
    };
    for (more, version) in [(&[][..], "3.0"), (&["--fmi", "2"], "2.0")] {
        let (code, message) = export(more);
        assert_eq!(code, Some(0), "{message}");
        let info = toolroom(&["fmu", "info", &mine.display().to_string(), "--json"]);
        let info: Value = serde_json::from_slice(&info.stdout).expect("JSON");
        assert_eq!(info["fmi_version"], version);
        std::fs::remove_file(&mine).expect("a file");
    }
    std::fs::write(&mine, "mine").expect("writable");
    let (code, message) = export(&["--fmi", "3"]);
    assert!(code == Some(2) && message.contains("was changed since toolroom wrote it"), "{message}");
    assert_eq!(std::fs::read_to_string(&mine).expect("there"), "mine");
}
