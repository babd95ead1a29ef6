//! The first hour: examples of every kind, shipped files anywhere, the reference, refusals for programs.

use super::*;

/// Kinds of which there is an example.
const KINDS: [&str; 16] = [
    "scenario",
    "effects",
    "structure",
    "coefficients",
    "tool",
    "lobes",
    "life",
    "cycle",
    "contour",
    "setup",
    "program-setup",
    "mapping",
    "shop-mapping",
    "gap",
    "machine",
    "parameter-set",
];

#[test]
fn new_writes_an_example_of_every_kind_that_check_takes() {
    let all = directory("cli", "new_kinds");
    for kind in KINDS {
        let folder = all.join(kind);
        let answer = json(&toolroom(&["new", kind, &folder.display().to_string(), "--json"]));
        assert_eq!(answer["kind"], kind);
        let file = answer[kind].as_str().expect("the file");
        let text = fs::read_to_string(file).expect("written");
        assert!(text.starts_with(&format!("#:schema ./{kind}.schema.json\n")), "{kind}");
        assert!(folder.join(format!("{kind}.schema.json")).is_file(), "{kind}");
        // The schema that the first line of a file names lies beside it, whatever kind of file it is.
        for written in answer["files"].as_array().expect("files") {
            let text = fs::read_to_string(written.as_str().expect("a path")).expect("written");
            if let Some(schema) = text.strip_prefix("#:schema ").and_then(|rest| rest.lines().next()) {
                assert!(folder.join(schema).is_file(), "{kind}: {written} names {schema}");
            }
        }
        let checked = toolroom(&["check", file, "--kind", kind]);
        assert_eq!(checked.status.code(), Some(0), "{kind}: {}", stderr(&checked));
        assert!(!stderr(&checked).contains("warning["), "{kind}: {}", stderr(&checked));
        // As a shell hands on all files of the folder.
        let files: Vec<String> = fs::read_dir(&folder)
            .expect("a folder")
            .map(|entry| entry.expect("an entry").path().display().to_string())
            .collect();
        let files: Vec<&str> = files
            .iter()
            .map(String::as_str)
            .filter(|file| file.ends_with(".toml") || file.ends_with(".json"))
            .collect();
        let all_files = toolroom(&[&["check"], &files[..]].concat());
        assert!(files.len() < 2 || all_files.status.success(), "{kind}: {}", stderr(&all_files));
        // A second time nothing is replaced.
        assert_eq!(toolroom(&["new", kind, &folder.display().to_string()]).status.code(), Some(2), "{kind}");
    }
    let unknown = toolroom(&["new", "sccenario", &all.join("x").display().to_string()]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(stderr(&unknown).contains("scenario"), "{}", stderr(&unknown));
}

#[test]
fn the_example_of_a_plan_is_of_this_version_and_its_shards_run() {
    let folder = directory("cli", "new_plan");
    let answer = json(&toolroom(&["new", "plan", &folder.display().to_string(), "--json"]));
    let plan = answer["plan"].as_str().expect("the plan");
    assert_eq!(json(&toolroom(&["check", plan, "--json"]))["kind"], "plan");
    let (parts, out) = (folder.join("parts").display().to_string(), folder.join("lives").display().to_string());
    for shard in ["0", "1"] {
        let ran = toolroom(&["shard", plan, shard, "--out", &parts]);
        assert_eq!(ran.status.code(), Some(0), "{}", stderr(&ran));
    }
    let merged = toolroom(&["merge", &parts, "--out", &out]);
    assert_eq!(merged.status.code(), Some(0), "{}", stderr(&merged));
}

#[test]
fn the_records_of_the_example_of_a_gap_name_what_they_hide() {
    let folder = directory("cli", "new_gap").join("gap");
    let here = |name: &str| folder.join(name).display().to_string();
    assert_eq!(toolroom(&["new", "gap", &here("")]).status.code(), Some(0));
    let (log, map, records) = (here("log.csv"), here("map.toml"), here("records"));
    let read = json(&toolroom(&["import", "csv", &log, "--map", &map, "--out", &records, "--json"]));
    assert_eq!(read["rows"], 168);
    let diagnosis =
        json(&toolroom(&["gap", "diagnose", "--model", &here("turning.toml"), "--data", &records, "--json"]));
    assert_eq!(
        (diagnosis["verdict"].as_str(), diagnosis["effects"][0]["id"].as_str()),
        (Some("effect"), Some("wear_force"))
    );
}

#[test]
fn a_shipped_file_is_taken_by_its_name() {
    for name in
        ["builtin:template", "builtin:policies", "builtin:life/policies.toml", "builtin:orders", "builtin:cycle"]
    {
        let checked = toolroom(&["check", name]);
        assert_eq!(checked.status.code(), Some(0), "{name}: {}", stderr(&checked));
    }
    let verdict = json(&toolroom(&["lobes", "builtin:milling-slot", "--at", "5000 rpm", "0.5 mm", "--json"]));
    assert!(verdict.is_object());
    let out = directory("cli", "builtin").join("out").display().to_string();
    let life =
        toolroom(&["life", "builtin:constant", "--lives", "50", "--set", "sensitivity.samples=64", "--out", &out]);
    assert_eq!(life.status.code(), Some(0), "{}", stderr(&life));
    let unknown = toolroom(&["check", "builtin:polices"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(stderr(&unknown).contains("did you mean builtin:policies?"), "{}", stderr(&unknown));
}

#[test]
fn the_reference_has_every_verb_option_and_code() {
    let folder = directory("cli", "reference");
    let dir = folder.join("pages").display().to_string();
    assert_eq!(toolroom(&["reference", &dir]).status.code(), Some(0));
    let page = |name: &str| fs::read_to_string(folder.join("pages").join(name)).expect(name);
    let commands = page("commands.md");
    for expected in
        ["## toolroom compare\n", "## toolroom gap diagnose\n", "`--set <KEY=VALUE>`", "`--wide`", "## Exit codes"]
    {
        assert!(commands.contains(expected), "{expected}");
    }
    assert!(!commands.contains("## toolroom fmu worker"), "for programs only");
    let codes = json(&toolroom(&["explain", "--json"]));
    let errors = page("errors.md");
    for code in codes["codes"].as_array().expect("codes") {
        assert!(errors.contains(&format!("| `{}` |", code["code"].as_str().expect("a word"))), "{code}");
    }
    assert!(page("key-figures.md").contains("| `cost_per_part` |") && page("effects.md").contains("| `wear_force` |"));
    assert!(page("file-scenario.md").contains("| `tool_change_time` | "), "keys");
    // A second run replaces its own pages, not one that somebody has edited.
    assert_eq!(toolroom(&["reference", &dir]).status.code(), Some(0));
    fs::write(folder.join("pages/errors.md"), "mine").expect("writable");
    assert_eq!(toolroom(&["reference", &dir]).status.code(), Some(2));
    let man = folder.join("man").display().to_string();
    assert_eq!(toolroom(&["reference", "--man", &man]).status.code(), Some(0));
    assert!(names(&folder.join("man")).contains(&"toolroom-gap-diagnose.1".to_owned()));
    let compare = fs::read_to_string(folder.join("man/toolroom-compare.1")).expect("a page");
    assert!(compare.starts_with(".TH TOOLROOM-COMPARE 1") && compare.contains(".SH EXAMPLES"), "{compare}");
}

#[test]
fn programs_are_told_why_there_is_no_result() {
    for (arguments, code) in [
        (&["check", "gone.toml", "--json"][..], "unreadable"),
        (&["point", "turning", "--tool", "gone", "--json"], "argument"),
        (&["compare", "--json"], "usage"),
    ] {
        let output = toolroom(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(answer["error"]["code"], code, "{arguments:?}: {answer}");
        assert!(answer["error"]["message"].as_str().is_some_and(|text| !text.is_empty()), "{answer}");
    }
    let broken = file("first_problem", "[shop]\nnamee = 1\n");
    let output = toolroom(&["check", &broken, "--json"]);
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(answer["error"], answer["problems"][0]);
}

#[test]
fn of_thousands_of_faults_the_first_are_shown_and_programs_are_told_all() {
    let orders: String = (0..1000).map(|i| format!("[[order]]\nid = \"{i}\"\nquantity = \"x\"\nwrong = 1\n")).collect();
    let text = fs::read_to_string(shipped("template")).expect("shipped");
    let before = text.lines().count();
    let many = file("many_faults", format!("{}\n{orders}", text.trim_end()));
    let output = toolroom(&["check", &many, "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let problems = answer["problems"].as_array().expect("a list");
    assert!(problems.len() >= 3000, "{}", problems.len());
    let last = problems.iter().rev().find(|problem| problem["code"] == "unknown-key").expect("the last `wrong`");
    assert_eq!((last["line"].as_u64(), last["column"].as_u64()), (Some(before as u64 + 4_000), Some(1)));
    let said = stderr(&output);
    assert!(said.len() < 50_000, "{}", said.len());
    assert!(
        said.contains(", of which the first 50 are shown (`--verbose` shows all)"),
        "{}",
        &said[said.len() - 300..]
    );
}

#[test]
fn several_files_are_checked_at_once() {
    let (good, bad) = (shipped("template"), file("one_of_several", "[shop]\nnamee = 1\n"));
    let both = toolroom(&["check", &good, "builtin:policies"]);
    assert_eq!(both.status.code(), Some(0), "{}", stderr(&both));
    let output = toolroom(&["check", &bad, &good, "--json"]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    let answer: Value = serde_json::from_slice(&output.stdout).expect("one JSON text");
    assert_eq!(
        (&answer["valid"], &answer["files"][0]["valid"], &answer["files"][1]["valid"]),
        (&false.into(), &false.into(), &true.into())
    );
    assert!(stderr(&output).contains("namee") && stderr(&output).contains("1 of 2 files"), "{}", stderr(&output));
    let changed = toolroom(&["check", &good, &good, "--seed", "2"]);
    assert_eq!(changed.status.code(), Some(2), "{}", stderr(&changed));
}

#[test]
fn a_text_without_keys_is_told_by_the_verb_that_reads_it() {
    let folder = directory("cli", "without_keys");
    for (name, text, verb) in [
        ("part.nc", "%\nO1\nG21 G90\nM30\n%\n", "toolroom program"),
        ("log.csv", "Lathe;Insert;vc\nL1;E0;220\n", "toolroom import csv"),
    ] {
        let path = folder.join(name);
        fs::write(&path, text).expect("writable");
        let output = toolroom(&["check", &path.display().to_string()]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(stderr(&output).contains(verb) && !stderr(&output).contains("unquoted"), "{name}: {}", stderr(&output));
    }
}

#[test]
fn a_line_without_end_is_told_without_its_text() {
    let broken = file("endless", format!("{}\n", "9".repeat(100_000)));
    let output = toolroom(&["check", &broken]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output).len());
    assert!(stderr(&output).contains("line 1, column") && stderr(&output).len() < 2000);
}

#[test]
fn a_slip_of_the_unit_is_a_warning() {
    let text = fs::read_to_string(shipped("template")).expect("shipped");
    let odd = file("unusual", text.replace("diameter = \"120 mm\"", "diameter = \"0.12 mm\""));
    let output = toolroom(&["check", &odd]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("warning[unusual]: diameter"), "{}", stderr(&output));
    assert_eq!(json(&toolroom(&["check", &odd, "--json"]))["warning_codes"][0], "unusual");
    assert_eq!(toolroom(&["explain", "unusual"]).status.code(), Some(0));
}

#[cfg(target_os = "linux")]
#[test]
fn a_command_ends_at_its_bound_of_memory_and_says_so() {
    let out = directory("cli", "memory").join("out");
    let ended = quick_of("compare", &out, &["--replications", "2000", "--max-memory", "1 MB"]);
    assert_eq!(ended.status.code(), Some(1), "{}", stderr(&ended));
    assert!(stderr(&ended).contains("needs more than 0.001 GB of memory"), "{}", stderr(&ended));
    assert!(stderr(&ended).contains("--max-memory"), "{}", stderr(&ended));
    let refused = quick("compare", &out, &["--max-memory", "1"]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
}

#[test]
fn what_is_overloaded_is_said_before_a_run_with_its_growth() {
    let out = directory("cli", "overload").join("out").display().to_string();
    let change = "part.shaft.operation.measure.work=\"2 h\"";
    let run = toolroom(&["run", "builtin:orders", "--replications", "1", "--set", change, "--out", &out]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    // 157.0 h of work and setups and 128 h of working time in two weeks: 29.0 h more, 2.1 h a day.
    let said = stderr(&run);
    assert!(said.contains("warning[overload]: C is overloaded") && said.contains("grows by 2.1 h a day"), "{said}");
    let fits = toolroom(&[
        "run",
        "builtin:queue",
        "--replications",
        "1",
        "--set",
        "shop.horizon=\"8 h\"",
        "--set",
        "shop.warm_up=\"0 h\"",
        "--out",
        &out,
    ]);
    assert_eq!(fits.status.code(), Some(0), "{}", stderr(&fits));
    assert!(!stderr(&fits).contains("warning"), "{}", stderr(&fits));
    // 1.4e9 jobs before a server of 60 an hour.
    let text = fs::read_to_string(shipped("shop/queue")).expect("shipped").replace("48 1/h", "360000 1/h");
    let flood = file("flood", text);
    let ended = toolroom(&["run", &flood, "--replications", "1", "--max-memory", "200 MB", "--out", &out]);
    assert_eq!(ended.status.code(), Some(1), "{}", stderr(&ended));
    assert!(stderr(&ended).contains("warning[memory]: some 1.4e9 jobs"), "{}", stderr(&ended));
    assert!(stderr(&ended).contains("needs more than 0.200 GB"), "{}", stderr(&ended));
}

#[test]
fn check_reads_records_and_diagnoses() {
    let folder = directory("cli", "check_found").join("gap");
    let here = |name: &str| folder.join(name).display().to_string();
    assert_eq!(toolroom(&["new", "gap", &here("")]).status.code(), Some(0));
    let (log, map, records) = (here("log.csv"), here("map.toml"), here("records"));
    assert_eq!(toolroom(&["import", "csv", &log, "--map", &map, "--out", &records]).status.code(), Some(0));
    for place in [here("records"), here("records/operations.csv")] {
        let checked = json(&toolroom(&["check", &place, "--json"]));
        assert_eq!((&checked["kind"], &checked["tables"][0]["rows"]), (&"records".into(), &168.into()), "{checked}");
    }
    let found = here("found");
    let diagnosed =
        toolroom(&["gap", "diagnose", "--model", &here("turning.toml"), "--data", &records, "--out", &found]);
    assert_eq!(diagnosed.status.code(), Some(0), "{}", stderr(&diagnosed));
    let diagnosis = here("found/diagnosis.json");
    assert_eq!(json(&toolroom(&["check", &diagnosis, "--json"]))["kind"], "diagnosis");
    let text =
        fs::read_to_string(&diagnosis).expect("a diagnosis").replace("\"verdict\": \"effect\"", "\"verdict\": 7");
    let refused = toolroom(&["check", &file("found.json", text)]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("verdict: 7 stands here"), "{}", stderr(&refused));
    assert_eq!(toolroom(&["schema", "records"]).status.code(), Some(0));
}

#[test]
fn no_advance_is_computed_for_hours() {
    let long = toolroom(&["point", "infeed", "--set", "infeed_per_rev=1 um/rev", "--advance", "1e12 s"]);
    assert_eq!(long.status.code(), Some(2), "{}", stderr(&long));
    assert!(stderr(&long).contains("is more than 1000000 s"), "{}", stderr(&long));
}

#[test]
fn a_file_of_nothing_but_slips_is_refused_with_its_place() {
    // Each sign was looked for from the start of the file: minutes for a list of 300 000 commas.
    for (name, flood) in [("commas", ",".repeat(300_000)), ("slips", "= 1\n".repeat(75_000))] {
        let flooded = file(name, format!("schema = 1\ncolumn = [{flood}"));
        let refused = toolroom(&["check", &flooded]);
        assert_eq!(refused.status.code(), Some(2), "{name}: {}", stderr(&refused));
        let value: Value = serde_json::from_slice(&toolroom(&["check", &flooded, "--json"]).stdout).expect("JSON");
        let first = &value["problems"][0];
        assert_eq!((&first["code"], &first["line"]), (&"syntax".into(), &2.into()), "{first}");
    }
}

#[test]
fn files_without_keys_are_sent_to_the_verb_that_reads_them() {
    let hits = directory("cli", "hits").join("hits.uff");
    fs::write(&hits, "    -1\n    58\nhits\n    -1\n").expect("writable");
    let refused = toolroom(&["check", &hits.display().to_string()]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("toolroom modes FILE --read"), "{}", stderr(&refused));
    let shard = toolroom(&["shard", "no-plan.json", "0", "--out", "parts"]);
    assert_eq!(shard.status.code(), Some(2));
    assert!(stderr(&shard).contains("no-plan.json cannot be read"), "{}", stderr(&shard));
}
