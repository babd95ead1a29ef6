//! Parameter sets of one's own: by path wherever a shipped name may stand, every value with its origin,
//! and a first set from one known life.

use crate::command_line::toolroom;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(arguments: &[&str]) -> Value {
    let output = toolroom(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

const OWN: &str = "scenarios/parameters/own/our-42crmo4.toml";

/// A short study of the shipped steel shop with its set replaced.
fn shop(folder: &Path, set: &str) -> String {
    let text = fs::read_to_string("scenarios/steel-shafts.toml").expect("the shipped scenario");
    let path = folder.join("shop.toml");
    fs::write(&path, text.replace("parameter_set = \"c45_t15k6\"", &format!("parameter_set = \"{set}\"")))
        .expect("a scenario");
    path.display().to_string()
}

#[test]
fn every_value_is_listed_with_its_origin() {
    let checked = json(&["check", OWN, "--json"]);
    assert_eq!((checked["kind"].as_str(), checked["law"].as_str()), (Some("parameter-set"), Some("extended_taylor")));
    let origin = |name: &str| {
        let all = checked["parameters"].as_array().expect("a list");
        let one = all.iter().find(|each| each["name"] == name).unwrap_or_else(|| panic!("{name}"));
        one["origin"].as_str().expect("a word").to_owned()
    };
    assert_eq!(origin("chipping.rate"), "given");
    assert_eq!(origin("extended_taylor.speed_exponent"), "handbook");
    assert_eq!(origin("temperature.chip_heating"), "based on c45_t15k6");
    assert_eq!(origin("extended_taylor.stage_contrast"), "assumed");
    for shipped in ["turning/c45_t15k6", "turning/ni_vk6om", "milling/c45_endmill_d12", "milling/mill_t15k6_d32"] {
        json(&["check", &format!("scenarios/parameters/{shipped}.toml"), "--json"]);
    }
}

#[test]
fn a_copy_of_a_shipped_set_gives_the_same_shop_to_the_byte() {
    let folder = TempDir::new().expect("a folder");
    fs::copy("scenarios/parameters/turning/c45_t15k6.toml", folder.path().join("mine.toml")).expect("a copy");
    let kpi = |set: &str, out: &str| {
        let out = folder.path().join(out).display().to_string();
        let run = ["compare", &shop(folder.path(), set), "--replications", "2", "--out", &out, "--quiet"];
        let output = toolroom(&run);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let inputs = fs::read_to_string(Path::new(&out).join("run.json")).expect("provenance");
        (fs::read(Path::new(&out).join("kpi.csv")).expect("key figures"), inputs)
    };
    let (shipped, _) = kpi("c45_t15k6", "a");
    let (by_path, inputs) = kpi("./mine.toml", "b");
    assert_eq!(shipped, by_path);
    // The file's hash stands beside that of the scenario.
    assert!(inputs.contains("mine.toml"), "{inputs}");
}

#[test]
fn a_handbook_law_enters_shops_points_and_studies() {
    let folder = TempDir::new().expect("a folder");
    let set = Path::new(env!("CARGO_MANIFEST_DIR")).join(OWN).display().to_string();
    json(&["check", &shop(folder.path(), &set), "--json"]);
    let point = json(&[
        "point",
        "turning",
        "--tool",
        OWN,
        "--json",
        "--set",
        "cutting_speed=222 m/min",
        "--set",
        "feed_per_rev=0.3 mm/rev",
        "--set",
        "depth_of_cut=1.5 mm",
    ]);
    let life = point["outputs"]["tool_life [min]"].as_f64().expect("a life");
    assert!((life - 59.60626).abs() < 1e-3, "{life}");
    let study = folder.path().join("study.toml");
    let words = format!("schema = 1\nname = \"own\"\nlives = 200\nparameter_set = \"{set}\"\nseed = 1\n");
    fs::write(&study, words).expect("a study");
    json(&["check", &study.display().to_string(), "--kind", "life", "--json"]);
}

#[test]
fn what_is_wrong_in_a_set_is_named_with_its_line_where_the_set_is_named() {
    let folder = TempDir::new().expect("a folder");
    let broken = fs::read_to_string(OWN).expect("the set").replace("mc = 0.24", "mc = \"0.24 mm\"");
    fs::write(folder.path().join("mine.toml"), broken).expect("a set");
    let output = toolroom(&["check", &shop(folder.path(), "mine.toml")]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains("mc") && message.contains("mine.toml"), "{message}");
    let output = toolroom(&["check", &shop(folder.path(), "./yours.toml")]);
    let message = text(&output.stderr);
    assert!(output.status.code() == Some(2) && message.contains("mine.toml"), "{message}");
    let output = toolroom(&["point", "turning", "--tool", "c45_t15k"]);
    assert!(text(&output.stderr).contains("did you mean `c45_t15k6`"), "{}", text(&output.stderr));
}

#[test]
fn one_known_life_makes_a_first_set() {
    let folder = TempDir::new().expect("a folder");
    let first = folder.path().join("first.toml").display().to_string();
    let known =
        ["calibrate", "turning", "--life", "15 min", "--at", "200 m/min", "--feed", "0.25 mm/rev", "--out", &first];
    let answer = json(&[&known[..], &["--json"]].concat());
    let life = &answer["life"];
    let near = |value: &Value, expected: f64| (value.as_f64().expect("a number") / expected - 1.0).abs() < 0.01;
    assert!(near(&life[2]["median [min]"], 6.03) && near(&life[2]["ci90"][1], 10.56), "{life}");
    assert!(near(&life[2]["next_edge90"][0], 2.65) && near(&life[2]["next_edge90"][1], 12.47), "{life}");
    assert!(near(&life[0]["median [min]"], 37.3) && near(&life[0]["ci90"][0], 21.3), "{life}");
    let point = json(&["point", "turning", "--tool", &first, "--json"]);
    assert!(near(&point["outputs"]["tool_life [min]"], 15.0), "{point}");
    json(&["check", &shop(folder.path(), &first), "--json"]);
    let wrong = toolroom(&["calibrate", "turning", "--life", "15 mm", "--at", "200 m/min", "--out", &first]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(text(&wrong.stderr).contains("--life"), "{}", text(&wrong.stderr));
}
