//! Effects that users write, effects on a part of the records, and terms that are proposed, from the command line.

use crate::command_line::toolroom;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const CRATER: &str = r#"schema = 1
[[effect]]
id = "my.crater"
title = "crater weakens the edge in fast cuts"
process = ["turning"]
size = { unit = "1", ordinary = 0.1, range = [0.0, 2.0] }
shape = { reference_speed = { value = "200 m/min", range = ["60 m/min", "400 m/min"], fit = true } }
changes = [{ term = "cutting_force", factor = "1 + size * (flank_wear / 0.3 mm) * (cutting_speed / reference_speed)^1.5" }]

[[effect]]
id = "my.wear"
process = ["turning"]
size = { ordinary = 0.2, range = [0, 20] }
changes = [{ term = "cutting_force", factor = "1 + size * (flank_wear / 0.3 mm)" }]
"#;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn at(&self, name: &str) -> String {
        Path::join(self.0.path(), name).display().to_string()
    }

    fn put(&self, name: &str, text: &str) -> String {
        fs::write(self.at(name), text).expect("a writable folder");
        self.at(name)
    }
}

fn done(arguments: &[&str]) -> String {
    let output = toolroom(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

fn refused(arguments: &[&str]) -> String {
    let output = toolroom(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

#[test]
fn a_point_with_an_effect_of_ones_own_has_its_published_force() {
    let folder = Folder::new();
    let file = folder.put("mine.toml", CRATER);
    let cut = ["cutting_speed=220 m/min", "feed_per_rev=0.3 mm", "depth_of_cut=1.5 mm", "flank_wear=0.2 mm"];
    let force = |more: &[&str]| {
        let mut arguments = vec!["point", "turning", "--tool", "c45_t15k6", "--json"];
        cut.iter().for_each(|change| arguments.extend(["--set", *change]));
        arguments.extend(more);
        json(&done(&arguments))["outputs"]["cutting_force [N]"].as_f64().expect("a force")
    };
    // An independent calculation.
    let plain = force(&[]);
    assert!((plain / 918.316_639_371_382_4 - 1.0).abs() < 1e-12, "{plain}");
    let by_file = force(&["--effects", &file, "--effect", "my.wear=0.2"]);
    assert!((by_file / 1_040.758_857_954_233_5 - 1.0).abs() < 1e-12, "{by_file}");
    assert_eq!(by_file.to_bits(), force(&["--effect", "wear_force=0.2"]).to_bits());
    let crater = force(&["--effects", &file, "--effect", "my.crater=0.1"]);
    assert!((crater / 988.946_804_602_985_3 - 1.0).abs() < 1e-12, "{crater}");
}

#[test]
fn a_file_of_effects_is_checked_and_its_faults_have_their_place() {
    let folder = Folder::new();
    assert!(done(&["check", &folder.put("mine.toml", CRATER)]).contains("my.crater"));
    for (from, to, code) in [
        ("(flank_wear / 0.3 mm)\"", "exp(cutting_time)\"", "effect-unit"),
        ("size * (flank_wear / 0.3 mm)\"", "size * flank_were\"", "effect-parse"),
        ("1 + size * (flank_wear / 0.3 mm)\"", "if(flank_wear > 0.2 mm, size, 0)\"", "effect-neutral"),
        ("1 + size * (flank_wear / 0.3 mm)\"", "1 - size * (flank_wear / 0.3 mm)\"", "effect-range"),
    ] {
        let text = CRATER.replace(from, to);
        assert_ne!(text, CRATER, "{from}");
        let said = refused(&["check", &folder.put("other.toml", &text)]);
        assert!(said.contains(code) && said.contains("other.toml:14"), "{to}: {said}");
    }
    let said = refused(&["point", "turning", "--effect", "my.crater=0.1"]);
    assert!(said.contains("no [[effect]] defines `my.crater`"), "{said}");
    assert!(done(&["effects", "--context"]).contains("depth_of_cut"));
}

/// An effect without a value from 20 to 80 s in cut: the check asks at 0 and from 100 s on, by the decades of the range.
const EARLY: &str = r#"
[[effect]]
id = "my.early"
process = ["turning"]
size = { ordinary = 0.1, range = [0, 2] }
changes = [{ term = "cutting_force", factor = "1 + size * sqrt(abs(cutting_time / 1 s - 50) - 30)" }]
"#;

/// What a command says whose work fails, on either stream.
fn failed(arguments: &[&str]) -> String {
    let output = toolroom(arguments);
    let said = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
    said
}

#[test]
fn an_effect_without_a_value_ends_the_work_with_its_code_and_the_operation() {
    let folder = Folder::new();
    let file = folder.put("early.toml", &format!("schema = 1\n{EARLY}"));
    assert!(done(&["check", &file]).contains("my.early"));
    let says = |said: &str, words: &[&str]| {
        let all = ["effect-value", "`my.early`", "cutting_force no number", "size 1.0000e-1", "cutting_time "];
        all.iter().chain(words).for_each(|word| assert!(said.contains(word), "{word}: {said}"));
    };
    let point = ["point", "turning", "--effects", &file, "--effect", "my.early=0.1"];
    says(&failed(&[&point[..], &["--set", "cutting_time=50 s"]].concat()), &[]);
    // Within the window from the first instant on, a step of the integrator once never ended.
    says(&failed(&[&point[..], &["--set", "cutting_time=50 s", "--advance", "30 s"]].concat()), &[]);
    let said = json(&toolroom_output(&[&point[..], &["--set", "cutting_time=50 s", "--json"]].concat()));
    assert_eq!(said["error"]["code"], "effect-value", "{said}");
    let plain = shop(8);
    let data = records(&folder, &plain, 3);
    let truth = with(&plain, "id = \"my.early\", size = 0.1") + EARLY;
    let truth = folder.put("early-shop.toml", &truth);
    let out = folder.at("o2");
    let said = failed(&["run", &truth, "--out", &out, "--force"]);
    says(&said, &["machine `L1`", "part `part`", "operation `turn`", "pass 0", "stopped"]);
    let model = folder.put("plain.toml", &plain);
    for verb in ["diagnose", "identifiability", "plan", "predict"] {
        // As the file states it, and as it is tried: every edge begins with such an operation.
        says(&failed(&["gap", verb, "--model", &truth, "--data", &data]), &["operation J"]);
        says(&failed(&["gap", verb, "--model", &model, "--data", &data, "--effects", &file]), &["operation J"]);
    }
    assert!(done(&["explain", "effect-value"]).contains("min and max"));
}

fn toolroom_output(arguments: &[&str]) -> String {
    String::from_utf8(toolroom(arguments).stdout).expect("text")
}

/// The shipped turning shop with three machines over this time.
fn shop(hours: u32) -> String {
    let path = format!("{}/scenarios/gap/turning.toml", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(path).expect("a shipped model");
    text.replace("horizon = \"8 h\"", &format!("horizon = \"{hours} h\"")).replace("count = 2", "count = 3")
}

/// The shop with an entry in the effects of its tool.
fn with(shop: &str, entry: &str) -> String {
    let text = shop.replacen("scatter = \"lab\"", &format!("scatter = \"lab\"\neffects = [{{ {entry} }}]"), 1);
    assert_ne!(text, shop);
    text
}

/// Records of a run.
fn records(folder: &Folder, shop: &str, seed: u32) -> String {
    let truth = folder.put("truth.toml", shop);
    done(&[
        "run",
        &truth,
        "--seed",
        &seed.to_string(),
        "--records",
        &folder.at("r"),
        "--out",
        &folder.at("o"),
        "--force",
    ]);
    folder.at("r/operations.csv")
}

#[test]
fn an_effect_of_one_machine_is_named_there_and_applied_there() {
    let folder = Folder::new();
    let plain = shop(16);
    let model = folder.put("model.toml", &plain);
    let truth = with(&plain, "id = \"wear_force\", size = 0.4, scope = { machine = \"L1\" }");
    // With two edges on L1 the draw decides: of the seeds 5 and 7 to 11 three name it alone, on two
    // calibration takes it up, and on one heat is named on the other lathes beside it.
    let data = records(&folder, &truth, 8);
    let out = folder.at("d");
    done(&["gap", "diagnose", "--model", &model, "--data", &data, "--out", &out]);
    let diagnosis = json(&fs::read_to_string(folder.at("d/diagnosis.json")).expect("a diagnosis"));
    let named = &diagnosis["effects"][0];
    assert_eq!(named["id"], "wear_force", "{}", diagnosis["notes"]);
    assert_eq!(diagnosis["effects"].as_array().map(Vec::len), Some(1));
    assert_eq!(named["scope"], serde_json::json!({ "machine": ["L1"] }), "{named}");
    let applied = &diagnosis["applied"]["effects"][0];
    assert_eq!(applied["scope"], serde_json::json!({ "machine": ["L1"] }), "{applied}");
    let size = applied["size"]["value"].as_f64().expect("a size");
    assert!((0.3..0.5).contains(&size), "{size}");
    let better = folder.at("better.toml");
    let document = folder.at("d/diagnosis.json");
    done(&["gap", "apply", "--model", &model, "--diagnosis", &document, "--out", &better]);
    let text = fs::read_to_string(&better).expect("a model");
    assert!(text.contains("scope = { machine = \"L1\" }"), "{text}");
}

#[test]
fn an_effect_of_ones_own_is_found_in_records_of_a_shop_that_has_it() {
    let folder = Folder::new();
    let plain = shop(16);
    let model = folder.put("model.toml", &plain);
    let square = r#"
[[effect]]
id = "my.deep"
process = ["turning"]
size = { ordinary = 0.2, range = [0, 5] }
changes = [{ term = "temperature_offset", summand = "size * 100 K * step(flank_wear / 0.1 mm - 1)" }]
"#;
    let file = folder.put("mine.toml", &format!("schema = 1{square}"));
    let truth = format!("{}{square}", with(&plain, "id = \"my.deep\", size = 0.5"));
    let data = records(&folder, &truth, 6);
    let document = folder.at("d/diagnosis.json");
    done(&["gap", "diagnose", "--model", &model, "--data", &data, "--effects", &file, "--out", &folder.at("d")]);
    let diagnosis = json(&fs::read_to_string(&document).expect("a diagnosis"));
    assert_eq!(diagnosis["effects"][0]["id"], "my.deep", "{}", diagnosis["notes"]);
    let better = folder.at("better.toml");
    done(&["gap", "apply", "--model", &model, "--diagnosis", &document, "--out", &better]);
    let text = fs::read_to_string(&better).expect("a model");
    assert_eq!(text.matches("[[effect]]").count(), 1, "{text}");
    done(&["check", &better]);
}

/// A shop of two lathes and three parts, each with conditions of its own.
fn varied(hours: u32) -> String {
    let text = shop(hours).replace("count = 3", "count = 2");
    let (before, rest) = text.split_once("[[part]]").expect("a part");
    let (_, after) = rest.split_once("[dispatch]").expect("rules");
    let part = |name: &str, speed: u32, feed: f64, depth: f64, diameter: u32, length: u32| {
        format!(
            "[[part]]\nname = \"{name}\"\n\n[[part.operation]]\nname = \"turn\"\nmachines = \"L\"\ntool = \"insert\"\n\
             cutting_speed = \"{speed} m/min\"\nfeed_per_rev = \"{feed} mm/rev\"\ndepth_of_cut = \"{depth} mm\"\n\
             diameter = \"{diameter} mm\"\nlength = \"{length} mm\"\nsize_tolerance = \"100 um\"\n\n\
             [[arrivals]]\npart = \"{name}\"\npattern = \"batch\"\ninterval = \"8 h\"\nsize = 60\n\n"
        )
    };
    let parts = [
        part("slow", 150, 0.3, 1.5, 55, 120),
        part("mid", 220, 0.2, 2.5, 70, 180),
        part("fast", 250, 0.3, 1.0, 55, 220),
    ];
    format!("{before}{}[dispatch]{after}", parts.concat())
}

/// The diagnosis of a model over records.
fn diagnosed(folder: &Folder, model: &str, data: &str, out: &str) -> Value {
    done(&["gap", "diagnose", "--model", model, "--data", data, "--out", &folder.at(out)]);
    json(&fs::read_to_string(folder.at(&format!("{out}/diagnosis.json"))).expect("a diagnosis"))
}

#[test]
fn an_effect_everywhere_is_not_named_on_the_part_where_it_is_largest() {
    let folder = Folder::new();
    let plain = varied(16);
    let model = folder.put("model.toml", &plain);
    let data = records(&folder, &with(&plain, "id = \"spindle_loss\", size = \"0.3 kW\""), 11);
    let found = diagnosed(&folder, &model, &data, "d");
    let named = &found["effects"][0];
    assert_eq!((&named["id"], &named["scope"]), (&"spindle_loss".into(), &serde_json::json!({})), "{}", found["notes"]);
    let size = named["size"]["value"].as_f64().expect("a size");
    assert!((0.27..0.33).contains(&size), "{size} kW");
}

/// Hotter worn edges wear faster and are hotter still: from the nominal point no step leads to the fit.
#[test]
fn what_is_applied_of_an_effect_under_which_wear_runs_away_was_fitted() {
    let folder = Folder::new();
    let plain = varied(16);
    let model = folder.put("model.toml", &plain);
    let data = records(&folder, &with(&plain, "id = \"wear_temperature\", size = 0.15"), 11);
    let found = diagnosed(&folder, &model, &data, "d");
    assert_eq!(found["effects"][0]["id"], "wear_temperature", "{}", found["notes"]);
    let size = found["applied"]["effects"][0]["size"]["value"].as_f64().expect("a size");
    assert!((0.12..0.18).contains(&size), "{size}");
    assert!(found["applied"]["calibration"].as_array().is_some_and(|list| list.len() > 5), "{}", found["applied"]);
}

/// A gap that no effect of the catalogue has: heat grows in the course of a day. What is proposed describes it, is called no
/// cause, and can be taken into the model.
#[test]
fn a_gap_without_a_cause_is_described_by_terms_that_can_be_applied_and_predict() {
    let folder = Folder::new();
    // Small batches of long cuts: every edge cuts every part, and many edges are used up in few operations.
    let plain = varied(12)
        .replace("interval = \"8 h\"\nsize = 60", "interval = \"1 h\"\nsize = 7")
        .replace("length = \"120 mm\"", "length = \"500 mm\"")
        .replace("length = \"180 mm\"", "length = \"500 mm\"")
        .replace("length = \"220 mm\"", "length = \"700 mm\"")
        .replace("limit = \"0.4 mm\"", "limit = \"0.25 mm\"")
        .replace("\"220 m/min\"", "\"260 m/min\"")
        .replace("\"250 m/min\"", "\"290 m/min\"")
        .replace("\"150 m/min\"", "\"200 m/min\"");
    let model = folder.put("model.toml", &plain);
    let hidden = "\n[[effect]]\nid = \"hidden.heat\"\nprocess = [\"turning\"]\nsize = { ordinary = 0.1, range = [0, 2] }\n\
                  changes = [{ term = \"temperature_rise\", factor = \"1 + size * min(sensor_time, 12 h) / 12 h\" }]\n";
    let truth = with(&plain, "id = \"hidden.heat\", size = 0.08") + hidden;
    let data = records(&folder, &truth, 3);
    let (file, document) = (folder.at("proposed.toml"), folder.at("d/diagnosis.json"));
    let said =
        done(&["gap", "diagnose", "--model", &model, "--data", &data, "--propose", &file, "--out", &folder.at("d")]);
    assert!(said.contains("empirical, not a cause"), "{said}");
    let diagnosis = json(&fs::read_to_string(&document).expect("a diagnosis"));
    let term = &diagnosis["proposals"][0]["terms"][0];
    assert!(term["id"].as_str().is_some_and(|id| id.starts_with("proposed.temperature")), "{term}");
    let text = fs::read_to_string(&file).expect("a file of terms");
    assert!(text.contains("kind = \"empirical\"") && text.contains("empirical, not a cause"), "{text}");
    done(&["check", &file]);
    done(&["check", &document]);
    let better = folder.at("better.toml");
    done(&["gap", "apply", "--model", &model, "--diagnosis", &document, "--out", &better, "--accept-empirical"]);
    assert!(fs::read_to_string(&better).expect("a model").contains("proposed.temperature"));
    let off = |model: &str| {
        let predicted = json(&done(&["gap", "predict", "--model", model, "--data", &data, "--json"]));
        let rows = predicted["predictions"].as_array().expect("predictions");
        let heat = rows.iter().filter(|row| row["channel"] == "temperature");
        heat.map(|row| (row["measured"].as_f64().unwrap() - row["predicted"].as_f64().unwrap()).powi(2)).sum::<f64>()
    };
    // What the truth itself leaves is noise and scatter: of the rest the terms close more than half.
    let truth = folder.put("hidden.toml", &truth);
    let [before, after, least] = [&model, &better, &truth].map(|model| off(model));
    assert!(before - after > 0.5 * (before - least), "{before} {after} {least}");
}

#[test]
fn what_a_cutting_process_lacks_closes_the_key_figures_of_its_shop() {
    let folder = Folder::new();
    let plain = shop(24);
    let model = folder.put("model.toml", &plain);
    let delay = "\n[[deviation]]\nid = \"operator_delay\"\nsize = \"25 s\"\nscope = { machine = \"L2\" }\n";
    let operations = records(&folder, &format!("{plain}{delay}"), 5);
    let data = folder.at("r");
    done(&["gap", "diagnose", "--model", &model, "--data", &data, "--out", &folder.at("d")]);
    let document = folder.at("d/diagnosis.json");
    let diagnosis = json(&fs::read_to_string(&document).expect("a diagnosis"));
    let named = &diagnosis["effects"][0];
    assert_eq!(named["id"], "operator_delay", "{}", diagnosis["notes"]);
    assert_eq!(named["scope"], serde_json::json!({ "machine": ["L2"] }), "{named}");
    let size = named["size"]["value"].as_f64().expect("a size");
    assert!((24.0..26.0).contains(&size), "{size}");
    let better = folder.at("better.toml");
    let applying = ["gap", "apply", "--model", &model, "--diagnosis", &document, "--out", &better];
    let applied = json(&done(&[&applying[..], &["--data", &data, "--json"]].concat()));
    let closed = |name: &str| {
        let figures = applied["kpi"].as_array().expect("key figures");
        figures.iter().find(|own| own["kpi"] == name).expect(name)["closed"].as_f64()
    };
    for name in ["cycle_time", "throughput", "effectiveness"] {
        assert!(closed(name).is_some_and(|closed| closed > 0.9), "{name}: {}", applied["kpi"]);
    }
    // A table of operations alone tells no lead times.
    let said = refused(&[&applying[..], &["--data", &operations, "--force"]].concat());
    assert!(said.contains("events of the machines") && said.contains("events.csv"), "{said}");
}
