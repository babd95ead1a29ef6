//! Nothing of the user's is lost: what a command may replace, and what it leaves alone.

use super::{directory, json, names, quick, quick_of, shipped, stderr, toolroom};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;

/// What is said about a command that must change nothing.
fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", stderr(output));
    stderr(output)
}

fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
}

fn read(path: impl AsRef<Path>) -> String {
    fs::read_to_string(path).expect("a text file")
}

fn write(path: impl AsRef<Path>, text: &str) {
    fs::write(path, text).expect("writable");
}

#[test]
fn a_second_run_keeps_what_it_did_not_write_and_removes_what_it_no_longer_writes() {
    let out = directory("cli", "owned_second").join("out");
    done(&quick("run", &out, &["--format", "csv"]));
    let run: Value = serde_json::from_str(&read(out.join("run.json"))).expect("JSON");
    let listed: Vec<&str> =
        run["files"].as_array().expect("a list").iter().filter_map(|f| f["name"].as_str()).collect();
    let there = names(&out);
    assert_eq!(listed, there.iter().filter(|name| *name != "run.json").map(String::as_str).collect::<Vec<_>>());
    assert!(there.iter().any(|name| name == "operations.csv"), "{there:?}");

    write(out.join("notes.txt"), "mine");
    fs::create_dir(out.join("pictures")).expect("writable");
    write(out.join("pictures/one.txt"), "mine");
    done(&quick("run", &out, &["--logged", "0"]));
    assert_eq!((read(out.join("notes.txt")), read(out.join("pictures/one.txt"))), ("mine".into(), "mine".into()));
    let expected = [
        "kpi.csv",
        "notes.txt",
        "pictures",
        "report.html",
        "run.json",
        "stations.csv",
        "study.json",
        "summary.json",
        "trace.json",
    ];
    assert_eq!(names(&out), expected, "tables that are no longer written are gone, and no lock is left");
}

#[test]
fn a_result_that_somebody_changed_is_replaced_by_force_only() {
    let out = directory("cli", "owned_changed").join("out");
    done(&quick("compare", &out, &[]));
    let before = read(out.join("summary.json"));
    write(out.join("summary.json"), "annotated");
    let message = refused(&quick("compare", &out, &["--seed", "2"]));
    assert!(message.contains("summary.json was changed since") && message.contains("--force"), "{message}");
    assert_eq!(read(out.join("summary.json")), "annotated");
    done(&quick("compare", &out, &["--force"]));
    assert_eq!(read(out.join("summary.json")), before);
    // What was removed by hand is no change of anything.
    fs::remove_file(out.join("kpi.csv")).expect("there");
    done(&quick("compare", &out, &[]));
}

#[test]
fn a_folder_of_others_is_used_where_nothing_stands_in_the_way() {
    let out = directory("cli", "owned_foreign").join("out");
    fs::create_dir(&out).expect("writable");
    write(out.join("thesis.txt"), "mine");
    write(out.join("report.html"), "mine");
    let message = refused(&quick("compare", &out, &[]));
    assert!(message.contains("report.html was not written by toolroom"), "{message}");
    assert_eq!(names(&out), ["report.html", "thesis.txt"]);
    fs::rename(out.join("report.html"), out.join("old.html")).expect("writable");
    // Somebody else's run.json proves nothing.
    write(out.join("run.json"), "{\"schema\": 1}");
    assert!(refused(&quick("compare", &out, &[])).contains("run.json was not written by toolroom"));
    fs::remove_file(out.join("run.json")).expect("there");
    done(&quick("compare", &out, &[]));
    assert_eq!((read(out.join("thesis.txt")), read(out.join("old.html"))), ("mine".into(), "mine".into()));
    // A new name of the second run that is the user's.
    write(out.join("tools.csv"), "mine");
    assert!(refused(&quick("compare", &out, &["--format", "csv"])).contains("tools.csv"));
    assert_eq!(read(out.join("tools.csv")), "mine");
}

#[test]
fn results_of_a_version_without_a_list_are_replaced_and_nothing_else() {
    let out = directory("cli", "owned_earlier").join("out");
    done(&quick("compare", &out, &["--format", "csv"]));
    let mut run: Value = serde_json::from_str(&read(out.join("run.json"))).expect("JSON");
    run.as_object_mut().expect("an object").remove("files");
    write(out.join("run.json"), &run.to_string());
    write(out.join("notes.txt"), "mine");
    done(&quick("compare", &out, &[]));
    let there = names(&out);
    for name in ["notes.txt", "operations.csv", "operations.parquet"] {
        assert!(there.iter().any(|other| other == name), "{name} in {there:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_link_is_followed_and_stays_one() {
    let dir = directory("cli", "owned_link");
    fs::create_dir(dir.join("real")).expect("writable");
    for (link, to) in [("link", "real"), ("dangling", "later")] {
        std::os::unix::fs::symlink(to, dir.join(link)).expect("writable");
        for _ in 0..2 {
            done(&quick("compare", &dir.join(link), &[]));
        }
        assert!(dir.join(link).is_symlink() && dir.join(to).join("run.json").is_file());
    }
}

#[cfg(unix)]
#[test]
fn a_folder_has_one_writer_and_a_dead_one_keeps_nobody_out() {
    use std::process::{Command, Stdio};
    let out = directory("cli", "owned_lock").join("out");
    let mut first = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["compare", &shipped("template"), "--replications", "100000", "--logged", "0", "--out"])
        .arg(&out)
        .args(["--policy", "constant", "--policy", "best constant", "--set", "shop.horizon=6 h"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary runs");
    while !out.join(".toolroom-draft").is_dir() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let message = refused(&quick("compare", &out, &[]));
    assert!(message.contains(&format!("(process {})", first.id())), "{message}");
    assert!(out.join(".toolroom-draft").is_dir(), "the draft of the first stays");
    first.kill().expect("it runs");
    first.wait().expect("it ends");
    assert!(out.join(".toolroom.lock").is_file(), "a killed process leaves its lock");
    done(&quick("compare", &out, &[]));
    assert!(names(&out).iter().all(|name| !name.starts_with('.')), "{:?}", names(&out));
}

#[test]
fn records_replace_nothing_of_others() {
    let dir = directory("cli", "owned_records");
    let (out, records) = (dir.join("out"), dir.join("records"));
    fs::create_dir(&records).expect("writable");
    write(records.join("events.csv"), "measured");
    let to = records.display().to_string();
    let run = |more: &[&str]| quick_of("run", &out, &[&["--replications", "1", "--records", &to], more].concat());
    assert!(refused(&run(&[])).contains("events.csv was not written by toolroom"));
    assert_eq!(read(records.join("events.csv")), "measured");
    assert!(!out.exists(), "refused before any work");
    fs::rename(records.join("events.csv"), records.join("measured.csv")).expect("writable");
    done(&run(&[]));
    let events = read(records.join("events.csv"));
    done(&run(&["--seed", "5"]));
    assert!(read(records.join("events.csv")) != events, "the own table is replaced");
    write(records.join("events.csv"), "edited");
    assert!(refused(&run(&[])).contains("events.csv was changed since"));
    done(&run(&["--force"]));
    assert_eq!((read(records.join("events.csv")), read(records.join("measured.csv"))), (events, "measured".into()));
    assert!(refused(&quick("run", &records, &["--records", &to])).contains("a folder of its own"));
}

#[test]
fn a_model_with_effects_takes_the_place_of_no_model_of_the_user() {
    let dir = directory("cli", "owned_apply");
    let [model, diagnosis, better] =
        ["model.toml", "diagnosis.json", "better.toml"].map(|name| dir.join(name).display().to_string());
    let nominal = read(shipped("gap/turning"));
    write(&model, &nominal);
    let hash = toolroom_apply::model_hash(&nominal, &[]).expect("TOML");
    let effect = |size: f64| {
        format!(
            "{{\"schema\": 2, \"hash\": \"0123456789\", \"models\": [{{\"hash\": \"{hash}\"}}], \"applied\": {{\"effects\": \
             [{{\"id\": \"wear_force\", \"target\": \"tool insert\", \"size\": {{\"value\": {size}, \"unit\": \"1\"}}}}]}}}}"
        )
    };
    write(&diagnosis, &effect(0.2));
    let apply = |to: &str, more: &[&str]| {
        let arguments = ["gap", "apply", "--model", &model, "--diagnosis", &diagnosis, "--out", to];
        toolroom(&[&arguments[..], more].concat())
    };
    for force in [&[][..], &["--force"]] {
        assert!(refused(&apply(&model, force)).contains("is an input of this command"));
    }
    assert_eq!(read(&model), nominal);
    write(&better, "mine");
    assert!(refused(&apply(&better, &[])).contains("was not written by toolroom"));
    done(&apply(&better, &["--force"]));
    write(&diagnosis, &effect(0.3));
    done(&apply(&better, &[]));
    let text = read(&better);
    assert!(text.contains("size = 0.3") && text.contains("[gap.applied]"), "{text}");
    done(&toolroom(&["check", &better]));
    write(&better, &text.replace("size = 0.3", "size = 0.25"));
    refused(&apply(&better, &[]));
    assert!(read(&better).contains("size = 0.25"));
    done(&apply(&better, &["--force"]));
}

#[test]
fn a_plan_takes_no_file_of_the_user_and_never_the_scenario() {
    let dir = directory("cli", "owned_plan");
    let [scenario, plan] = ["shop.toml", "plan.json"].map(|name| dir.join(name).display().to_string());
    write(&scenario, &read(shipped("template")));
    let to = |place: &str, more: &[&str]| toolroom(&[&["compare", &scenario, "--plan", place], more].concat());
    for force in [&[][..], &["--force"]] {
        assert!(refused(&to(&scenario, force)).contains("is an input of this command"));
    }
    done(&to(&plan, &[]));
    done(&to(&plan, &["--shards", "2"]));
    assert_eq!(json(&toolroom(&["check", &scenario, "--json"]))["valid"], true);
    write(&plan, &read(&plan).replace("\"shards\": 2", "\"shards\": 3"));
    assert!(refused(&to(&plan, &[])).contains("was changed since"));
    done(&to(&plan, &["--force"]));
}

#[test]
fn a_part_program_replaces_neither_its_setup_nor_its_machine() {
    let dir = directory("cli", "owned_program");
    let [program, setup, machine] =
        ["part.nc", "setup.toml", "machine.toml"].map(|name| dir.join(name).display().to_string());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    write(&program, &read(root.join("programs/plate.nc")));
    write(&setup, &read(root.join("programs/plate-setup.toml")));
    write(&machine, &read(root.join("machines/vmc.toml")));
    for (option, target) in
        [("--report", &setup), ("--blocks", &setup), ("--blocks", &machine), ("--motions", &machine)]
    {
        let before = read(target);
        let arguments = ["program", &program, "--setup", &setup, "--drives", &machine, option, target, "--force"];
        assert!(refused(&toolroom(&arguments)).contains("is an input of this command"), "{option} {target}");
        assert_eq!(read(target), before);
    }
}

#[test]
fn no_diagnosis_takes_the_place_of_the_records_that_it_reads() {
    let dir = directory("cli", "owned_records");
    let records = dir.join("records");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let [log, map] = ["new/log.csv", "new/map.toml"].map(|name| root.join(name).display().to_string());
    let to = records.display().to_string();
    done(&toolroom(&["import", "csv", &log, "--map", &map, "--out", &to]));
    let imported = read(records.join("operations.csv"));
    let model = shipped("gap/turning");
    for verb in ["diagnose", "plan"] {
        for force in [&[][..], &["--force"]] {
            let arguments = ["gap", verb, "--model", &model, "--data", &to, "--out", &to];
            let said = refused(&toolroom(&[&arguments[..], force].concat()));
            assert!(said.contains("operations.csv"), "{verb}: {said}");
            assert_eq!(read(records.join("operations.csv")), imported, "{verb}");
        }
    }
    // What is imported is no result of an earlier run.
    let template = shipped("template");
    assert!(refused(&toolroom(&["run", &template, "--out", &to])).contains("that `toolroom import` wrote"));
    assert_eq!(read(records.join("operations.csv")), imported);
    let said =
        toolroom(&["calibrate", "turning", "--life", "15 min", "--at", "200 m/min", "--model", &model, "--out", &to]);
    assert!(refused(&said).contains("--life"), "{}", stderr(&said));
}
