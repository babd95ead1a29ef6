//! What is said of input that is wrong: the file and the line for programs, a code that `explain` knows; and samples without
//! a fault.

use crate::command_line::{directory, json, stderr, stdout, toolroom};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The error that a refused command tells programs.
fn error(arguments: &[&str]) -> Value {
    let output = toolroom(&[arguments, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
    let answer: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{arguments:?}: {error}: {}", stdout(&output)));
    answer["error"].clone()
}

/// Every verb that reads a file: the words before and behind the file.
const READERS: &[(&[&str], &[&str])] = &[
    (&["check"], &[]),
    (&["run"], &[]),
    (&["compare"], &[]),
    (&["life"], &[]),
    (&["lobes"], &[]),
    (&["modes"], &[]),
    (&["modes"], &["--read"]),
    (&["swap"], &["--tool", "scenarios/chatter/endmill12.toml"]),
    (&["swap", "scenarios/chatter/spindle.toml", "--tool"], &[]),
    (&["listen"], &["--teeth", "4", "--speed", "3000 rpm"]),
    (&["coefficients"], &["--teeth", "2", "--depth", "2 mm"]),
    (&["grind"], &[]),
    (&["contour"], &[]),
    (&["identify"], &[]),
    (&["program"], &[]),
    (&["program", "scenarios/programs/plate.nc", "--drives"], &[]),
    (&["program", "scenarios/programs/plate.nc", "--setup"], &[]),
    (&["calibrate", "turning", "--model", "ni_vk6om", "--limit", "0.3 mm", "--out", "{out}", "--data"], &[]),
    (&["gap", "diagnose", "--model", "scenarios/gap/turning.toml", "--out", "{out}", "--data"], &[]),
    (&["gap", "diagnose", "--data", "scenarios/new/log.csv", "--out", "{out}", "--model"], &[]),
    (&["import", "csv", "scenarios/new/log.csv", "--out", "{out}", "--map"], &[]),
    (&["import", "csv"], &["--map", "scenarios/new/map.toml", "--out", "{out}"]),
    (&["import", "shop", "--out", "{out}", "--map"], &[]),
    (&["import", "mtconnect", "--out", "{out}"], &[]),
    (&["import", "nist-runs", "--out", "{out}"], &[]),
    (&["effects", "--effects"], &[]),
    (&["fmu", "info"], &[]),
    (&["fmu", "check"], &[]),
    (&["ssp", "info"], &[]),
];

#[test]
fn every_verb_tells_programs_which_file_is_missing_or_binary() {
    let folder = directory("faults", "files");
    let (gone, out) = (folder.join("gone.toml").display().to_string(), folder.join("out").display().to_string());
    let binary = folder.join("binary.toml");
    // Neither text of any encoding nor a number of bytes that one would have.
    fs::write(&binary, [0x7f, b'E', b'L', b'F', 0xff, 0xfe, 0x00, 0x01, 0x80, 0x9d, 0x81]).expect("writable");
    let binary = binary.display().to_string();
    let mut silent = Vec::new();
    for (before, behind) in READERS {
        for file in [&gone, &binary] {
            let words = before.iter().copied().chain([file.as_str()]).chain(behind.iter().copied());
            let words: Vec<&str> = words.map(|word| if word == "{out}" { out.as_str() } else { word }).collect();
            let error = error(&words);
            // A program that makes the file and tries again has one code to look for.
            let code = if file == &gone { Some("unreadable") } else { error["code"].as_str() };
            if (error["file"].as_str(), error["code"].as_str()) != (Some(file), code) {
                silent.push(format!("{words:?}: {error}"));
            }
        }
    }
    assert!(silent.is_empty(), "{}", silent.join("\n"));
}

#[test]
fn a_line_that_is_known_is_told_to_programs() {
    let folder = directory("faults", "lines");
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).expect("writable");
        path.display().to_string()
    };
    let table = write("taps.csv", "frequency [Hz],real [um/N],imag [um/N]\n100,0.1,0\n101,nan,0\n");
    let found = error(&["modes", &table]);
    assert_eq!((found["file"].as_str(), found["line"].as_u64()), (Some(table.as_str()), Some(3)), "{found}");
    let program = write("part.nc", "G21 G90\nG0 X0 Y0\nG411\n");
    let found = error(&["program", &program]);
    assert_eq!((found["file"].as_str(), found["line"].as_u64()), (Some(program.as_str()), Some(3)), "{found}");
    assert!(found["column"].as_u64().is_some(), "{found}");
    let forces = write("forces.csv", "feed_per_tooth [mm],mean_force_q [N]\n0.1,1\n");
    let found = error(&["coefficients", &forces, "--teeth", "2", "--depth", "2 mm"]);
    assert_eq!((found["file"].as_str(), found["line"].as_u64()), (Some(forces.as_str()), Some(1)), "{found}");
    let shop = write("shop.toml", "[shop]\nnamee = 1\n");
    let found = error(&["run", &shop]);
    assert_eq!((found["file"].as_str(), found["line"].is_u64()), (Some(shop.as_str()), true), "{found}");
    // An error of the command line is one of no file.
    assert_eq!(error(&["point", "turning", "--tool", "gone"])["file"], Value::Null);
}

/// Every Rust file of the program that is no test.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() && !["tests", "target", "benches"].contains(&name.as_str()) {
            sources(&path, found);
        } else if name.ends_with(".rs") && name != "tests.rs" {
            found.push(path);
        }
    }
}

/// The words between quotes in a text that are codes: small letters and hyphens.
fn words(text: &str) -> impl Iterator<Item = String> {
    let is_code = |word: &&str| !word.is_empty() && word.chars().all(|sign| sign.is_ascii_lowercase() || sign == '-');
    text.split('"').skip(1).step_by(2).filter(is_code).map(str::to_owned)
}

#[test]
fn every_code_of_an_error_is_explained() {
    let listed = json(&toolroom(&["explain", "--json"]));
    let known: Vec<&str> =
        listed["codes"].as_array().expect("a list").iter().filter_map(|code| code["code"].as_str()).collect();
    let twice: Vec<&&str> =
        known.iter().filter(|code| known.iter().filter(|other| other == code).count() > 1).collect();
    assert!(twice.is_empty(), "explained twice: {twice:?}");
    // The codes are the words of functions `code` and the literals of fields `code`; what takes its code from the list of its
    // explanations has no such word and needs none.
    let mut files = Vec::new();
    for folder in ["src", "analysis", "models", "sim"] {
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut files);
    }
    let mut used: BTreeSet<String> = BTreeSet::new();
    for file in files {
        let text = fs::read_to_string(&file).expect("a text");
        let text = text.split("#[cfg(test)]").next().unwrap_or_default();
        for body in text.split("fn code(&self) -> ").skip(1).filter(|body| body.contains("&'static str")) {
            used.extend(words(body.split("\n    }\n").next().unwrap_or_default()));
        }
        for literal in text.split("code: \"").skip(1).chain(text.split("Refusal::new(\"").skip(1)) {
            used.extend(words(&format!("\"{}\"", literal.split('"').next().unwrap_or_default())));
        }
    }
    assert!(used.len() > 40 && used.contains("quantity"), "{used:?}");
    let unknown: Vec<&String> = used.iter().filter(|code| !known.contains(&code.as_str())).collect();
    assert!(unknown.is_empty(), "not explained: {unknown:?}");
    let of_fits = ["low-coherence", "edge-of-range", "sensor-sign", "coarse-frequency", "window-damping", "poor-fit"];
    for code in of_fits.into_iter().chain(["argument", "unreadable", "usage", "interrupted"]) {
        assert!(stdout(&toolroom(&["explain", code])).starts_with(code), "{code}");
    }
}

#[test]
fn what_new_writes_has_no_fault() {
    let folder = directory("faults", "new");
    for kind in ["scenario", "effects", "structure", "coefficients", "tool", "lobes", "life", "program-setup", "cycle"]
        .into_iter()
        .chain([
            "contour",
            "setup",
            "mapping",
            "shop-mapping",
            "gap",
            "machine",
            "parameter-set",
            "diagnosis",
            "records",
        ])
    {
        let place = folder.join(kind).display().to_string();
        let written = json(&toolroom(&["new", kind, &place, "--json"]));
        let files: Vec<&str> = written["files"].as_array().expect("a list").iter().filter_map(Value::as_str).collect();
        // Measured tables and part programs behind the first are input of its verb, and no files of keys.
        let checked = |file: &&str| *file == files[0] || file.ends_with(".toml");
        for file in files.iter().copied().filter(checked) {
            let output = toolroom(&["check", file]);
            assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        }
    }
    // The base of the tables of a shop has no machine, and is a scenario without one where no mapping takes it.
    let shop = folder.join("shop-mapping");
    let base = shop.join("base.toml").display().to_string();
    assert!(stderr(&toolroom(&["check", &base])).contains("map.toml"));
    fs::remove_file(shop.join("map.toml")).expect("it was written");
    assert_eq!(error(&["check", &base])["code"], "nothing-there");
}

#[test]
fn feeds_and_forces_of_another_unit_are_told() {
    let slot = fs::read_to_string("scenarios/data/slot-al7075.csv").expect("shipped");
    let table = directory("faults", "feeds").join("slot.csv");
    fs::write(&table, slot.replace("feed_per_tooth [mm]", "feed_per_tooth [m]")).expect("writable");
    let cut = ["--teeth", "2", "--depth", "2 mm", "--json"];
    let warnings = |file: &str| {
        let found = json(&toolroom(&[&["coefficients", file][..], &cut].concat()));
        found["warnings"].as_array().expect("a list").iter().filter(|text| text.to_string().contains("unusual")).count()
    };
    assert_eq!(warnings("scenarios/data/slot-al7075.csv"), 0);
    assert_eq!(warnings(&table.display().to_string()), 2);
}
