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

#[test]
fn an_effect_of_ones_own_makes_no_cell_and_one_with_a_scope_is_left_out_by_name() {
    let folder = directory("ssp_cell", "effects");
    let text = std::fs::read_to_string(shipped("lathe-cell")).expect("a shipped scenario");
    let switched = |name: &str, effect: &str, more: &str| {
        let place = text.find("parameter_set").expect("a tool with a parameter set");
        let (tool, rest) = text.split_at(place);
        let file = folder.join(format!("{name}.toml"));
        std::fs::write(&file, format!("{tool}effects = [{effect}]\n{rest}{more}")).expect("a file");
        let package = folder.join(format!("{name}.ssp")).display().to_string();
        toolroom(&["ssp", "export", &file.display().to_string(), "--machine", "L", "--out", &package])
    };
    let crater = r#"
[[effect]]
id = "my.crater"
title = "crater weakens the edge"
process = ["turning"]
size = { unit = "1", ordinary = 0.1, range = [0.0, 2.0] }
changes = [{ term = "cutting_force", factor = "1 + size * (flank_wear / 0.3 mm)" }]
confounder = "wear_force"
separating_test = "two speeds on one edge"
source = "assumption"
"#;
    let own = switched("own", r#"{ id = "my.crater", size = 0.05 }"#, crater);
    assert_eq!(own.status.code(), Some(2), "{}", stderr(&own));
    assert!(stderr(&own).contains("effect `my.crater` of tool"), "{}", stderr(&own));
    let scoped = r#"{ id = "wear_force", size = 0.2, scope = { from = "1 h" } }"#;
    let scoped = switched("scoped", scoped, "");
    assert_eq!(scoped.status.code(), Some(0), "{}", stderr(&scoped));
    assert!(stderr(&scoped).contains("effect `wear_force` has a scope and is left out"), "{}", stderr(&scoped));
    let everywhere = switched("everywhere", r#"{ id = "wear_force", size = 0.2 }"#, "");
    assert_eq!(everywhere.status.code(), Some(0), "{}", stderr(&everywhere));
    assert!(!stderr(&everywhere).contains("left out"), "{}", stderr(&everywhere));
}

#[test]
#[cfg(feature = "fmu-import")]
fn a_bad_start_value_of_a_package_is_an_argument() {
    use std::io::{Read, Write};

    let folder = directory("ssp_cell", "start");
    let (sound, bad) = (folder.join("cell.ssp"), folder.join("bad.ssp"));
    let (file, shown) = (shipped("lathe-cell"), sound.display().to_string());
    let made = toolroom(&["ssp", "export", &file, "--machine", "L", "--policy", "constant", "--out", &shown]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let mut from = zip::ZipArchive::new(std::fs::File::open(&sound).expect("a package")).expect("a zip file");
    let mut to = zip::ZipWriter::new(std::fs::File::create(&bad).expect("writable"));
    for i in 0..from.len() {
        let mut entry = from.by_index(i).expect("an entry");
        let (name, mut bytes) = (entry.name().expect("a name").to_string(), Vec::new());
        entry.read_to_end(&mut bytes).expect("an entry");
        if name.ends_with("parameters.ssv") {
            let text = String::from_utf8(bytes).expect("text");
            assert!(text.contains("<ssv:Real value=\"0.25\""), "{text}");
            bytes = text.replace("<ssv:Real value=\"0.25\"", "<ssv:Real value=\"slow\"").into_bytes();
        }
        to.start_file(name, zip::write::SimpleFileOptions::default()).expect("an entry");
        to.write_all(&bytes).expect("an entry");
    }
    to.finish().expect("a zip file");
    let run = toolroom(&["ssp", "sim", &bad.display().to_string(), "--stop", "2 s", "--step", "1 s"]);
    assert_eq!((run.status.code(), stdout(&run).as_str()), (Some(2), ""), "{}", stderr(&run));
    let said = stderr(&run).split_whitespace().collect::<Vec<_>>().join(" ");
    for expected in
        ["bad.ssp: resources/parameters.ssv:", "lathe-cell-L: controller.rule.lowest_speed: start value \"slow\""]
    {
        assert!(said.contains(expected), "{expected} in {said}");
    }
    let run = toolroom(&["ssp", "sim", &shown, "--stop", "2 s", "--step", "1 s"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let heads = stdout(&run).lines().next().map(str::to_owned).expect("a table");
    assert!(heads.ends_with(",flank_wear [m],cutting_speed [m/s],estimated_flank_wear [m],edges"), "{heads}");
    assert!(stderr(&run).contains("an algebraic loop, settled before the first step"), "{}", stderr(&run));
}
