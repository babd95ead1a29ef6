//! Imported units in the shop as a user meets them: the exported unit gives the native result, a
//! bad unit is refused, one that fails on the way leaves what came before.
#![cfg(feature = "fmu-import")]

#[path = "../fmu/import/tests/run/fixture.rs"]
mod fixture;

use crate::command_line::{shipped, stderr, toolroom};
use serde_json::Value;
use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Runs and expects an exit code.
fn expect(code: i32, arguments: &[&str]) -> Output {
    let output = toolroom(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
    output
}

fn json(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).expect("JSON")
}

fn folder() -> TempDir {
    TempDir::new().expect("a folder")
}

/// The exported turning unit in `folder`.
fn turning(folder: &Path) -> PathBuf {
    expect(0, &["fmu", "export", "turning", "--fmi", "3", "--out", &folder.display().to_string()]);
    folder.join("toolroom_turning_fmi3.fmu")
}

#[test]
fn three_hundred_replications_with_a_unit_run_through_and_are_the_same_on_one_thread_and_two() {
    let folder = folder();
    let unit = format!("tool.insert.fmu={}", turning(folder.path()).display());
    let digest = |threads: &str| {
        let out = folder.path().join(threads);
        let shown = out.display().to_string();
        let file = shipped("fmu-lathe");
        let study = [
            "run",
            &file,
            "--policy",
            "adaptive",
            "--set",
            &unit,
            "--set",
            "shop.horizon=1 h",
            "--set",
            "shop.warm_up=0.25 h",
        ];
        // Units whose states nobody freed were full after 70 to 150 hours of this shop: 300 are twice as long as that.
        expect(0, &[&study[..], &["--replications", "300", "--threads", threads, "--out", &shown]].concat());
        let run = json(&out.join("run.json"));
        assert!(run["complete"] == true && run["replications"] == 300, "{run}");
        run["digest"].clone()
    };
    let alone = digest("1");
    assert!(alone.is_string());
    assert_eq!(alone, digest("2"));
}

/// `kpi.csv` as rows.
fn figures(results: &Path) -> Vec<(String, Option<f64>)> {
    let text = fs::read_to_string(results.join("kpi.csv")).expect("results");
    let row = |line: &str| {
        let (name, value) = line.rsplit_once(',').expect("columns");
        (name.to_owned(), value.parse().ok())
    };
    text.lines().skip(1).map(row).collect()
}

#[test]
fn compare_with_the_exported_unit_gives_the_native_figures() {
    let folder = folder();
    let (imported, native) = (folder.path().join("imported"), folder.path().join("native"));
    let unit = format!("tool.insert.fmu={}", turning(folder.path()).display());
    // Edges that are changed before they collapse: a collapse is found to 30 us only.
    let limits = ["constant", "adaptive"].map(|name| format!("policy.{name}.tool_change.limit=0.2 mm"));
    let changes =
        ["--set", "shop.horizon=4 h", "--set", &limits[0], "--set", &limits[1], "--replications", "2", "--out"];
    let compare = |name: &str, more: &[&str], out: &Path| {
        let (file, out) = (shipped(name), out.display().to_string());
        expect(0, &[&["compare", &file][..], more, &changes, &[&out]].concat());
    };
    compare("fmu-lathe", &["--set", &unit], &imported);
    compare("fmu-lathe-native", &[], &native);
    let (imported, native) = (figures(&imported), figures(&native));
    assert!(native.len() > 100 && native.len() == imported.len(), "{} figures", native.len());
    for ((name, one), (same, other)) in native.iter().zip(&imported) {
        assert_eq!(name, same);
        // An adaptive policy samples within passes, which a unit cannot do without a new step.
        let relative = if name.starts_with("constant") { 1e-9 } else { 1e-4 };
        let near = match (one, other) {
            (Some(one), Some(other)) => (one - other).abs() <= relative * one.abs().max(1e-9),
            (one, other) => one == other,
        };
        assert!(near, "{name}: {one:?} native, {other:?} imported");
    }
}

#[test]
fn a_missing_unit_is_told_with_the_command_that_makes_it() {
    let folder = folder();
    let out = folder.path().join("out");
    let unit = folder.path().join("toolroom_turning_fmi3.fmu");
    let change = format!("tool.insert.fmu={}", unit.display());
    let refused = expect(2, &["compare", &shipped("fmu-lathe"), "--set", &change, "--out", &out.display().to_string()]);
    let command = format!("toolroom fmu export turning --out {}", folder.path().display());
    assert!(words(&refused).contains(&words_of(&command)), "{}", stderr(&refused));
    assert!(!out.exists());
}

/// What was said on standard error without line breaks and frames.
fn words(output: &Output) -> String {
    words_of(&stderr(output))
}

fn words_of(text: &str) -> String {
    text.chars().filter(|character| !character.is_whitespace() && !"│·".contains(*character)).collect()
}

/// An archive like `unit`, its entries renamed from → to, with one more entry.
fn repacked(unit: &Path, rename: (&str, &str), more: Option<&str>) -> PathBuf {
    let path = unit.with_file_name("bad.fmu");
    let mut from = zip::ZipArchive::new(fs::File::open(unit).expect("a unit")).expect("a zip file");
    let mut to = zip::ZipWriter::new(fs::File::create(&path).expect("writable"));
    let options = zip::write::SimpleFileOptions::default();
    for i in 0..from.len() {
        let mut entry = from.by_index(i).expect("an entry");
        let name = entry.name().expect("a name").replace(rename.0, rename.1);
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("an entry");
        to.start_file(name, options).expect("an entry");
        to.write_all(&bytes).expect("an entry");
    }
    if let Some(name) = more {
        to.start_file(name, options).expect("an entry");
        to.write_all(b"gotcha").expect("an entry");
    }
    to.finish().expect("a zip file");
    path
}

#[test]
fn bad_units_are_refused_before_anything_runs() {
    let folder = folder();
    let sound = turning(folder.path());
    let out = folder.path().join("out");
    let refused = |unit: &Path, expected: &str| {
        let change = format!("tool.insert.fmu={}", unit.display());
        let output = expect(2, &["run", &shipped("fmu-lathe"), "--set", &change, "--out", &out.display().to_string()]);
        assert!(words(&output).contains(&words_of(expected)), "{expected} in {}", stderr(&output));
        assert!(!out.exists(), "{expected}");
    };
    let bytes = fs::read(&sound).expect("a unit");
    let cut = folder.path().join("cut.fmu");
    fs::write(&cut, &bytes[..bytes.len() / 2]).expect("writable");
    refused(&cut, "is not an FMU");
    // The description is the first entry: a byte of it is another.
    let mut damaged = bytes.clone();
    damaged[2000] ^= 1;
    fs::write(&cut, damaged).expect("writable");
    refused(&cut, "modelDescription.xml is damaged");
    refused(&repacked(&sound, ("", ""), Some("../../escaped.txt")), "leads out of the unit's folder");
    assert!(!std::env::temp_dir().join("escaped.txt").exists());
    refused(&repacked(&sound, ("x86_64-linux", "x86_64-windows"), None), "has no library for this computer");
    refused(&repacked(&sound, ("modelDescription.xml", "description.xml"), None), "has no modelDescription.xml");
    refused(&fixture::unit(folder.path(), &["NO_STEP"], ("", "")), "lacks functions that FMI asks for: fmi2DoStep");
}

/// The shipped scenario with the unit of the tests, which steps fail in by `switch`.
fn failing(folder: &Path, switch: &str) -> String {
    with_unit(folder, &fixture::unit(folder, &[switch], ("", "")))
}

/// The shipped scenario with `unit`.
fn with_unit(folder: &Path, unit: &Path) -> String {
    let text = fs::read_to_string(shipped("fmu-lathe")).expect("shipped");
    let text = text
        .replace("../out/fmu/toolroom_turning_fmi3.fmu", &unit.display().to_string())
        .replace("start = { \"tool.set\" = \"ni_vk6om\" }", "outputs = { flank_wear = \"tool.VB\" }");
    let path = folder.join("failing.toml");
    fs::write(&path, text).expect("writable");
    path.display().to_string()
}

#[test]
fn a_step_that_fails_at_once_leaves_what_came_before() {
    let folder = folder();
    let (scenario, out) = (failing(folder.path(), "FAILS"), folder.path().join("out"));
    let shown = out.display().to_string();
    let output = expect(1, &["run", &scenario, "--format", "csv", "--out", &shown]);
    for expected in ["replication 0", "machine `L", "the solver gave up", "no replication is complete"] {
        assert!(stderr(&output).contains(expected), "{expected} in {}", stderr(&output));
    }
    let run = json(&out.join("run.json"));
    assert_eq!((&run["complete"], &run["replications"]), (&Value::from(false), &Value::from(0)));
    assert!(run["stopped"]["reason"].as_str().is_some_and(|reason| reason.contains("the solver gave up")), "{run}");
    let passes = fs::read_to_string(out.join("stopped/operations.csv")).expect("a table of the run that stopped");
    assert!(passes.lines().count() > 1, "{passes}");
    let report = expect(0, &["report", &shown]);
    assert!(stderr(&report).contains("the solver gave up"), "{}", stderr(&report));
}

#[test]
fn replications_before_a_step_that_fails_stay_readable() {
    let folder = folder();
    let (scenario, out) = (failing(folder.path(), "TIRES=4000"), folder.path().join("out"));
    let shown = out.display().to_string();
    let arguments =
        ["run", &scenario, "--policy", "constant", "--replications", "40", "--threads", "1", "--out", &shown];
    let output = expect(1, &arguments);
    assert!(stderr(&output).contains("no more steps today"), "{}", stderr(&output));
    let run = json(&out.join("run.json"));
    let replications = run["replications"].as_u64().expect("a number");
    assert!(run["complete"] == false && (1..40).contains(&replications), "{replications} replications");
    assert_eq!(run["stopped"]["replication"], replications);
    fs::remove_file(out.join("report.html")).expect("a report");
    expect(0, &["report", &shown]);
    assert!(out.join("report.html").is_file());
}

#[test]
fn a_run_that_stopped_goes_on_to_what_it_would_have_been() {
    let folder = folder();
    let digest = |scenario: &str, name: &str| {
        let out = folder.path().join(name);
        let shown = out.display().to_string();
        let whole =
            ["run", scenario, "--policy", "constant", "--replications", "12", "--threads", "1", "--out", &shown];
        let mut attempts = 0;
        // The unit fails after so many steps of one process.
        while toolroom(&if attempts == 0 { whole.to_vec() } else { [&whole[..], &["--resume"]].concat() }).status.code()
            == Some(1)
        {
            attempts += 1;
            assert!(attempts < 10 && out.join("stopped").is_dir(), "attempt {attempts}");
        }
        let run = json(&out.join("run.json"));
        assert!(run["complete"] == true && run["replications"] == 12 && !out.join("stopped").exists(), "{run}");
        (attempts, run["digest"].clone())
    };
    let (attempts, resumed) = digest(&failing(folder.path(), "TIRES=4000"), "resumed");
    let (at_once, sound) = digest(&failing(folder.path(), "SOUND"), "sound");
    assert!(attempts > 0 && at_once == 0, "{attempts} and {at_once} failures");
    assert_eq!(resumed, sound);
}

/// Folders of unpacked units that are there.
fn unpacked(temporary: &Path) -> Vec<String> {
    let entries = fs::read_dir(temporary).expect("a folder").map(|entry| entry.expect("an entry").file_name());
    entries.map(|name| name.to_string_lossy().into_owned()).filter(|name| name.starts_with("toolroom-fmu-")).collect()
}

#[test]
fn a_unit_that_hangs_crashes_or_ends_its_process_is_a_replication_that_failed() {
    for (fault, expected) in [
        ("for (;;)", "fmi2DoStep answered nothing within 0.5 s (call_limit); its process was ended"),
        ("*(volatile int *)0 = 1", "fmi2DoStep answered nothing: its process ended by signal 11"),
        ("abort()", "fmi2DoStep answered nothing: its process ended by signal 6 (abort)"),
        ("_exit(0)", "fmi2DoStep answered nothing: its process ended with exit code 0"),
        ("exit(0)", "fmi2DoStep answered nothing: its process ended with exit code 0"),
    ] {
        let folder = folder();
        let switch = format!("BEFORE=static int steps; if (++steps > 3000) {fault}");
        let (scenario, out) = (failing(folder.path(), &switch), folder.path().join("out"));
        let temporary = folder.path().join("temporary");
        fs::create_dir(&temporary).expect("writable");
        let limit = "tool.insert.wiring.call_limit=0.5 s";
        let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
            .args(["run", &scenario, "--policy", "constant", "--replications", "400", "--threads", "1", "--set", limit])
            .args(["--out", &out.display().to_string()])
            .env("TMPDIR", &temporary)
            .env("NO_COLOR", "1")
            .output()
            .expect("the binary runs");
        assert_eq!(output.status.code(), Some(1), "{fault}: {}", stderr(&output));
        for expected in [expected, "machine `L", "part `ring`", "wear.fmu", "replication"] {
            assert!(words(&output).contains(&words_of(expected)), "{fault}: {expected} in {}", stderr(&output));
        }
        let run = json(&out.join("run.json"));
        let kept = run["replications"].as_u64().expect("a number");
        assert!(run["complete"] == false && kept > 0, "{fault}: {kept} replications");
        assert!(out.join("kpi.csv").is_file() && out.join("report.html").is_file(), "{fault}");
        assert_eq!(unpacked(&temporary), [""; 0], "{fault}");
    }
}

#[test]
fn a_call_that_hangs_is_told_after_its_limit_and_is_not_waited_for_twice() {
    // States as numbers, in memory, and none at all, in a shop that needs none.
    let without_breakdowns = |text: String| {
        let (before, rest) = text.split_once("[[failure]]").expect("breakdowns");
        format!("{before}[[policy]]{}", rest.split_once("[[policy]]").expect("policies").1)
    };
    for (states, keeps) in [
        ("", true),
        ("canSerializeFMUstate=\"true\"", true),
        ("canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"", false),
    ] {
        let folder = folder();
        let (begun, out) = (folder.path().join("begun"), folder.path().join("out"));
        let hang = format!("BEFORE=FILE *f=fopen(\"{}\",\"a\");fputc(1,f);fclose(f);for(;;)", begun.display());
        let scenario = with_unit(folder.path(), &fixture::unit(folder.path(), &[&hang], (states, "")));
        if !keeps {
            let text = fs::read_to_string(&scenario).expect("a scenario");
            fs::write(&scenario, without_breakdowns(text)).expect("writable");
        }
        let study = ["run", &scenario, "--policy", "constant", "--threads", "1"];
        let limit = ["--set", "tool.insert.wiring.call_limit=1 s", "--out", &out.display().to_string()];
        let output = expect(1, &[&study[..], &limit].concat());
        let expected = words_of("fmi2DoStep answered nothing within 1 s (call_limit)");
        assert!(words(&output).contains(&expected), "{states}: {}", stderr(&output));
        // The run that stopped is made again for its logs, without the call.
        assert!(out.join("stopped").is_dir(), "{states}");
        assert_eq!(fs::metadata(&begun).expect("a call that hangs").len(), 1, "{states}");
    }
}

#[test]
fn a_crash_in_the_37th_replication_keeps_36() {
    let folder = folder();
    let steps = folder.path().join("steps");
    // How many late steps so many replications take: a byte each, by one thread.
    let late_steps = |replications: &str| {
        let count = format!("BEFORE=FILE *f=fopen(\"{}\",\"a\");fputc(1,f);fclose(f)", steps.display());
        let scenario = with_unit(folder.path(), &fixture::unit(folder.path(), &[&count], ("", "")));
        let out = folder.path().join(format!("of-{replications}")).display().to_string();
        let study = ["run", &scenario, "--policy", "constant", "--replications", replications, "--threads", "1"];
        expect(0, &[&study[..], &["--out", &out]].concat());
        let length = fs::metadata(&steps).expect("late steps").len();
        fs::remove_file(&steps).expect("a file");
        length
    };
    let (before, after) = (late_steps("36"), late_steps("37"));
    assert!(after > before + 1, "{before} and {after} late steps");
    let fault = format!("BEFORE=static int steps; if (++steps > {}) abort()", (before + after) / 2);
    let (scenario, out) = (failing(folder.path(), &fault), folder.path().join("out"));
    let temporary = folder.path().join("temporary");
    fs::create_dir(&temporary).expect("writable");
    let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["run", &scenario, "--policy", "constant", "--replications", "100", "--threads", "1"])
        .args(["--out", &out.display().to_string()])
        .env("TMPDIR", &temporary)
        .env("NO_COLOR", "1")
        .output()
        .expect("the binary runs");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    for expected in ["replication 36", "signal 6 (abort)", "36 replications are complete"] {
        assert!(words(&output).contains(&words_of(expected)), "{expected} in {}", stderr(&output));
    }
    let run = json(&out.join("run.json"));
    assert_eq!((&run["replications"], &run["stopped"]["replication"]), (&Value::from(36), &Value::from(36)), "{run}");
    assert_eq!(unpacked(&temporary), [""; 0]);
}

#[test]
fn a_unit_by_itself_may_crash_too_and_the_rows_before_stand() {
    let folder = folder();
    let unit = fixture::unit(folder.path(), &["BEFORE=exit(0)"], ("", "")).display().to_string();
    let table = folder.path().join("rows.csv");
    let arguments =
        ["fmu", "sim", &unit, "--stop", "200 s", "--step", "10 s", "--output", &table.display().to_string()];
    let output = expect(1, &arguments);
    assert!(words(&output).contains(&words_of("its process ended with exit code 0")), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&table).expect("rows").lines().count(), 12);
}

/// `fmu sim` of the unit of the tests over 200 s in steps of 10 s, its own temporary files in `folder`.
fn simulated(folder: &Path, switch: &str, limit: &str) -> Output {
    let unit = fixture::unit(folder, &[switch], ("", "")).display().to_string();
    let temporary = folder.join("temporary");
    fs::create_dir_all(&temporary).expect("writable");
    let output = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["fmu", "sim", &unit, "--stop", "200 s", "--step", "10 s", "--start", "rate=1e-6", "--call-limit", limit])
        .env("TMPDIR", &temporary)
        .env("NO_COLOR", "1")
        .output()
        .expect("the binary runs");
    assert_eq!(unpacked(&temporary), [""; 0], "{switch}");
    output
}

#[test]
fn the_call_in_which_a_unit_hangs_or_dies_is_named_wherever_it_is() {
    for (switch, expected) in [
        ("MAKES=for (;;)", "fmi2Instantiate answered nothing within 0.5 s (call_limit)"),
        ("SETS=exit(0)", "setting a start value answered nothing: its process ended with exit code 0"),
        ("ENTERS=for (;;)", "fmi2EnterInitializationMode answered nothing within 0.5 s (call_limit)"),
        ("EXITS=abort()", "fmi2ExitInitializationMode answered nothing: its process ended by signal 6 (abort)"),
        ("ENDS=for (;;)", "at 200 s: fmi2Terminate answered nothing within 0.5 s (call_limit)"),
        ("BEFORE=overflow(0)", "fmi2DoStep answered nothing: its process ended by signal 11 (segmentation fault)"),
        ("BEFORE=raise(SIGSTOP)", "fmi2DoStep answered nothing within 0.5 s (call_limit)"),
        (
            "BEFORE=for (int i = 3; i < 64; i++) write(i, \"\\377\\377\\377\\377\", 4)",
            // In which call that is noticed hangs on when the stream is read.
            "answered what cannot be read: the unit wrote to its worker's stream",
        ),
    ] {
        let folder = folder();
        let output = simulated(folder.path(), switch, "0.5 s");
        assert_eq!(output.status.code(), Some(1), "{switch}: {}", stderr(&output));
        assert!(words(&output).contains(&words_of(expected)), "{switch}: {}", stderr(&output));
        assert!(!stderr(&output).contains("thread"), "{switch}: {}", stderr(&output));
    }
    // What fails once everything is done does no harm.
    let folder = folder();
    let output = simulated(folder.path(), "FREES=for (;;)", "0.5 s");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(String::from_utf8_lossy(&output.stdout).lines().count(), 22);
}

#[test]
fn what_a_unit_starts_hides_no_death_of_its_worker_and_ends_with_it() {
    for (then, code, expected) in [("_exit(3)", 1, "its process ended with exit code 3"), ("", 0, "20 steps of 10 s")] {
        let folder = folder();
        let started = folder.path().join("started");
        let child =
            format!("FILE *f = fopen(\"{}\", \"w\"); fprintf(f, \"%d\", getpid()); fclose(f)", started.display());
        // The child is told apart by its file; it keeps every stream of the worker open.
        let fork = format!(
            "BEFORE=static int once; if (!once++) {{ if (!fork()) {{ {child}; pause(); }} usleep(200000); {then}; }}"
        );
        let output = simulated(folder.path(), &fork, "20 s");
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        assert!(words(&output).contains(&words_of(expected)), "{}", stderr(&output));
        let process = fs::read_to_string(&started).expect("a process was started");
        let alive = || Command::new("kill").args(["-0", &process]).output().is_ok_and(|asked| asked.status.success());
        // A process that was killed stays in the table until somebody has asked for it.
        for _ in 0..100 {
            if !alive() {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        assert!(!alive() || zombie(&process), "process {process} is left");
    }
}

/// Whether a process has ended and nobody has asked for it yet.
fn zombie(process: &str) -> bool {
    let state = Command::new("ps").args(["-o", "stat=", "-p", process]).output().expect("ps");
    String::from_utf8_lossy(&state.stdout).trim_start().starts_with('Z')
}

#[test]
fn a_program_that_is_killed_leaves_no_worker_and_no_folder() {
    let folder = folder();
    let unit = fixture::unit(folder.path(), &["BEFORE=for (;;)"], ("", "")).display().to_string();
    let temporary = folder.path().join("temporary");
    fs::create_dir(&temporary).expect("writable");
    let mut program = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["fmu", "sim", &unit, "--stop", "200 s", "--step", "10 s"])
        .env("TMPDIR", &temporary)
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("the binary runs");
    let wait = |done: &dyn Fn() -> bool| {
        for _ in 0..600 {
            if done() {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(50));
        }
        panic!("nothing happened within half a minute");
    };
    wait(&|| !unpacked(&temporary).is_empty());
    std::thread::sleep(std::time::Duration::from_millis(500));
    program.kill().expect("it runs");
    program.wait().expect("it ends");
    wait(&|| unpacked(&temporary).is_empty());
}

#[test]
fn impossible_values_reach_no_table() {
    for value in ["NAN", "-5.0", "1e300"] {
        let folder = folder();
        let (scenario, out) = (failing(folder.path(), &format!("VALUE={value}")), folder.path().join("out"));
        let output = expect(1, &["run", &scenario, "--replications", "2", "--out", &out.display().to_string()]);
        for expected in ["tool.VB", "wear.fmu", "machine `L"] {
            assert!(words(&output).contains(&words_of(expected)), "{value}: {expected} in {}", stderr(&output));
        }
        assert_eq!(json(&out.join("run.json"))["replications"], 0);
    }
}

#[test]
fn check_refuses_what_run_would_refuse() {
    let folder = folder();
    let change = ("canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"", "");
    let unit = fixture::unit(folder.path(), &[], change);
    let scenario = with_unit(folder.path(), &unit);
    let out = folder.path().join("out").display().to_string();
    for arguments in [&["check", &scenario][..], &["run", &scenario, "--out", &out]] {
        let output = expect(2, arguments);
        assert!(words(&output).contains(&words_of("cannot go back to an earlier state")), "{}", stderr(&output));
    }
    assert!(!Path::new(&out).exists());
    // A break interrupts a pass whatever becomes of the part when the shift is over, and so does a wait for a person.
    let text = fs::read_to_string(&scenario).expect("a scenario");
    let (before, rest) = text.split_once("[[failure]]").expect("breakdowns");
    let steady = format!("{before}[[policy]]{}", rest.split_once("[[policy]]").expect("policies").1);
    let dated = steady.replace("[shop]", "[shop]\nstart = \"2026-03-30 06:00\"");
    let week = "week = { mon-fri = [\"06:00-14:00\"] }\nat_end = \"finish\"\n";
    let of_machine = |calendar: &str| {
        let machine = format!("[[calendar]]\nname = \"early\"\n{week}{calendar}\n[[machine]]\ncalendar = \"early\"");
        dated.replacen("[[machine]]", &machine, 1)
    };
    let person = "[[operator]]\nname = \"Ann\"\nskills = [\"cut\"]\n\n[[machine]]";
    let attended = dated
        .replacen("[[machine]]", person, 1)
        .replace("name = \"turn\"", "name = \"turn\"\noperator = { run = \"cut\" }");
    for (text, by) in [
        (of_machine("breaks = [\"10:00-10:15\"]"), Some("a break of calendar `early`")),
        (attended, Some("waits for the person who attends operation `turn`")),
        (of_machine(""), None),
        (steady, None),
    ] {
        fs::write(&scenario, text).expect("writable");
        let output = expect(if by.is_some() { 2 } else { 0 }, &["check", &scenario]);
        let refused = by.map(|by| format!("passes on machine `L1` are interrupted by {by}"));
        assert!(refused.is_none_or(|told| words(&output).contains(&words_of(&told))), "{}", stderr(&output));
        if by.is_none() {
            expect(0, &["run", &scenario, "--policy", "constant", "--replications", "1", "--out", &out, "--force"]);
        }
    }
    // States in memory are enough for breakdowns.
    let unit = fixture::unit(folder.path(), &[], ("canSerializeFMUstate=\"true\"", ""));
    let scenario = with_unit(folder.path(), &unit);
    expect(0, &["check", &scenario]);
    expect(0, &["run", &scenario, "--replications", "3", "--out", &out, "--force"]);
    // A unit of fixed steps of which none is taken in a pass.
    let fixed = ("canHandleVariableCommunicationStepSize=\"true\"", "fixedInternalStepSize=\"1000\"");
    let scenario = with_unit(folder.path(), &fixture::unit(folder.path(), &[], fixed));
    for verb in [&["check", &scenario][..], &["run", &scenario, "--out", &out, "--force"]] {
        let output = expect(2, verb);
        assert!(words(&output).contains(&words_of("cannot be met within half a step")), "{}", stderr(&output));
    }
}

#[test]
fn a_unit_of_fixed_steps_says_how_far_it_was_from_the_clock() {
    let folder = folder();
    let fixed = ("canHandleVariableCommunicationStepSize=\"true\" ", "");
    let scenario = with_unit(folder.path(), &fixture::unit(folder.path(), &[], fixed));
    let out = folder.path().join("out").display().to_string();
    let output = expect(0, &["run", &scenario, "--policy", "constant", "--replications", "1", "--out", &out]);
    for expected in ["it takes steps of 1 s only", "away from the clock of the shop"] {
        assert!(words(&output).contains(&words_of(expected)), "{expected} in {}", stderr(&output));
    }
}
