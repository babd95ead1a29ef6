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

/// Taylor's constants of a handbook, as a tool and as a set hold them.
const CONSTANTS: &str = "taylor = { form = \"v T^n f^a ap^b = C\", C = \"300 m/min\", n = 0.25, a = 0.3, b = 0.1, source = \"our handbook\" }";

/// The same shop with more keys for its tool.
fn shop_with(folder: &Path, name: &str, set: &str, keys: &str) -> String {
    let text = fs::read_to_string(shop(folder, set)).expect("the shop");
    let named = format!("parameter_set = \"{set}\"\n");
    assert!(text.contains(&named));
    let path = folder.join(name);
    fs::write(&path, text.replace(&named, &format!("{named}{keys}\n"))).expect("a scenario");
    path.display().to_string()
}

fn key_figures(folder: &Path, scenario: &str, changes: &[&str]) -> Vec<u8> {
    let out = folder.join("out").display().to_string();
    let run = ["run", scenario, "--policy", "programmed", "--replications", "2", "--out", &out, "--quiet", "--force"];
    let output = toolroom(&[&run[..], changes].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    fs::read(Path::new(&out).join("kpi.csv")).expect("key figures")
}

#[test]
fn a_tool_with_constants_in_place_is_that_of_a_file_with_them() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let head = "schema = 1\nname = \"own\"\ntitle = \"own\"\nbased_on = \"c45_t15k6\"\n";
    fs::write(folder.join("own.toml"), format!("{head}[handbook]\n{CONSTANTS}\n")).expect("a set");
    let by_file = key_figures(folder, &shop(folder, "./own.toml"), &[]);
    let plain = key_figures(folder, &shop(folder, "c45_t15k6"), &[]);
    assert_ne!(by_file, plain, "the constants tell");
    let in_place = shop_with(folder, "inline.toml", "c45_t15k6", &format!("handbook = {{ {CONSTANTS} }}"));
    assert_eq!(key_figures(folder, &in_place, &[]), by_file);
    // A change of one constant on the command line is one of the file.
    let other = CONSTANTS.replace("300 m/min", "280 m/min");
    let other = shop_with(folder, "other.toml", "c45_t15k6", &format!("handbook = {{ {other} }}"));
    assert_eq!(
        key_figures(folder, &in_place, &["--set", "tool.insert.handbook.taylor.C=280 m/min"]),
        key_figures(folder, &other, &[])
    );
    // `check` says what the constants amount to.
    let checked = toolroom(&["check", &in_place, "--json"]);
    let checked: Value = serde_json::from_slice(&checked.stdout).expect("JSON");
    let told = checked.to_string();
    assert!(
        told.contains("extended_taylor.speed_exponent") && told.contains("extended_taylor.reference_life"),
        "{told}"
    );
    // The set of that tool, written down.
    let baked = folder.join("baked.toml").display().to_string();
    let output = toolroom(&["calibrate", "--bake", &in_place, "--tool", "insert", "--out", &baked]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("extended_taylor.speed_exponent: is 4"), "{}", text(&output.stdout));
    assert_eq!(key_figures(folder, &shop(folder, "./baked.toml"), &[]), by_file);
    // How well a life of the tool is known goes with it, as `calibrate` writes it into a first set.
    let life = "handbook = { one_life = { life = \"15 min\", cutting_speed = \"200 m/min\" } }";
    let one_life = shop_with(folder, "life.toml", "c45_t15k6", life);
    let output = toolroom(&["calibrate", "--bake", &one_life, "--tool", "insert", "--force", "--out", &baked]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let set = fs::read_to_string(&baked).expect("a set");
    let factor = |key: &str| -> f64 {
        let line = set.lines().find_map(|line| line.strip_prefix(&format!("\"{key}\" = {{ factor = ")));
        line.and_then(|line| line.trim_end_matches(" }").parse().ok()).unwrap_or_else(|| panic!("{key}: {set}"))
    };
    assert!((factor("extended_taylor.reference_life") - 0.25_f64.exp()).abs() < 1e-6, "{set}");
    assert!((factor("extended_taylor.speed_exponent") - 0.3_f64.exp()).abs() < 1e-6, "{set}");
}

#[test]
fn the_group_of_another_wear_law_makes_that_the_law_of_a_tool() {
    let folder = TempDir::new().expect("a folder");
    let folder = folder.path();
    let values = "reference_life = \"30 min\", speed_exponent = 4.0, feed_exponent = 1.2, depth_exponent = 0.4, \
                  wear_limit = \"0.8 mm\", reference_speed = \"200 m/min\", reference_feed = \"0.3 mm/rev\", \
                  reference_depth = \"1.5 mm\"";
    let keys = format!("parameters = {{ extended_taylor = {{ {values} }} }}");
    let own = shop_with(folder, "own.toml", "c45_t15k6", &keys);
    let figures = key_figures(folder, &own, &[]);
    assert_ne!(figures, key_figures(folder, &shop(folder, "c45_t15k6"), &[]));
    let longer = key_figures(folder, &own, &["--set", "tool.insert.parameters.extended_taylor.reference_life=60 min"]);
    assert_ne!(figures, longer, "the value on the command line tells");
    let refused = |keys: &str, changes: &[&str]| {
        let path = shop_with(folder, "refused.toml", "c45_t15k6", keys);
        let output = toolroom(&[&["check", &path][..], changes].concat());
        assert_eq!(output.status.code(), Some(2), "{keys}: {}", text(&output.stdout));
        text(&output.stderr)
    };
    let without = keys.replace("feed_exponent = 1.2, ", "");
    let message = refused(&without, &[]);
    assert!(message.contains("[parameters.extended_taylor] lacks feed_exponent"), "{message}");
    assert!(message.contains("refused.toml:") && message.contains("parameter_set"), "{message}");
    let message = refused("parameters = { extended_taylor = { C = \"300 m/min\", n = 0.25 } }", &[]);
    assert!(message.contains("`handbook`"), "{message}");
    let two = keys.replace("parameters = { ", "parameters = { usui = { wear_at_reference = \"0.02 um/m\" }, ");
    assert!(refused(&two, &[]).contains("several wear laws"), "{}", refused(&two, &[]));
    let both = format!("{keys}\nhandbook = {{ {} }}", CONSTANTS.replace("300 m/min", "3 m/min"));
    assert!(refused(&both, &[]).contains("no plausible life"), "{}", refused(&both, &[]));
    let message = refused(&keys, &["--set", "tool.insert.parameters.extended_taylor.speed_exponent=40"]);
    assert!(message.contains("speed_exponent"), "{message}");
    let draws = format!("handbook = {{ {CONSTANTS} }}\nparameters_from = \"none.parquet\"");
    assert!(refused(&draws, &[]).contains("`handbook` states constants"), "{}", refused(&draws, &[]));
}

#[test]
fn a_study_of_lives_takes_the_constants_of_a_handbook_in_place() {
    let folder = TempDir::new().expect("a folder");
    let study = |name: &str, keys: &str| {
        let path = folder.path().join(name);
        let text =
            format!("schema = 1\nname = \"own\"\nlives = 200\nseed = 1\nparameter_set = \"c45_t15k6\"\n{keys}\n");
        fs::write(&path, text).expect("a study");
        json(&["life", &path.display().to_string(), "--json", "--out", &format!("{}.out", path.display())])
    };
    let without_name = |result: &Value| result["cells"].clone();
    let (plain, own) = (study("plain.toml", ""), study("own.toml", &format!("handbook = {{ {CONSTANTS} }}")));
    assert_ne!(without_name(&plain), without_name(&own));
    assert!(!own["cells"].is_null(), "{own}");
}
