//! Studies that were stopped, go on, or are drawn again.

use super::*;

/// The folder of what an unfinished study keeps for going on.
const JOURNAL: &str = ".toolroom-journal";

/// Every file of a directory but `run.json`, which tells the time, and the journals of a study that is not complete.
fn bytes(dir: &Path) -> Vec<(String, Vec<u8>)> {
    let kept = names(dir).into_iter().filter(|name| name != "run.json" && name != JOURNAL);
    kept.map(|name| (name.clone(), fs::read(dir.join(name)).expect("a file"))).collect()
}

pub fn assert_same(one: &Path, two: &Path) {
    let (one, two) = (bytes(one), bytes(two));
    assert_eq!(
        one.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        two.iter().map(|(name, _)| name).collect::<Vec<_>>()
    );
    for ((name, one), (_, two)) in one.iter().zip(&two) {
        assert!(one == two, "{name} differs");
    }
}

#[test]
fn a_stopped_study_goes_on_to_the_same_bytes() {
    let dir = directory("cli", "resume");
    for (verb, more) in [
        ("run", &["--replications", "7"][..]),
        ("run", &["--replications", "7", "--format", "csv"]),
        ("compare", &["--replications", "19", "--until", "half-width 0.001%"]),
    ] {
        let (whole, parts) = (dir.join("whole"), dir.join("parts"));
        let _ = fs::remove_dir_all(&parts);
        let ask = |out: &Path, last: &[&str]| quick_of(verb, out, &[more, last].concat());
        assert_eq!(ask(&whole, &[]).status.code(), Some(0));
        for stop in ["2", "5"] {
            let stopped = ask(&parts, &["--stop-after", stop, "--resume"]);
            assert_eq!(stopped.status.code(), Some(1), "{}", stderr(&stopped));
            assert!(stderr(&stopped).contains("--resume"), "{}", stderr(&stopped));
            let run: Value = serde_json::from_slice(&fs::read(parts.join("run.json")).expect("there")).expect("JSON");
            assert_eq!(run["complete"], false);
            assert_eq!(run["replications"].to_string(), stop);
        }
        let rest = ask(&parts, &["--resume", "--threads", "2"]);
        assert_eq!(rest.status.code(), Some(0), "{}", stderr(&rest));
        assert!(stderr(&rest).contains("going on after 5 replications"), "{}", stderr(&rest));
        assert_same(&whole, &parts);
        assert!(!parts.join(JOURNAL).exists(), "the journal goes with the end of the work");
        let again = ask(&parts, &["--resume"]);
        assert_eq!(again.status.code(), Some(0));
        assert!(stderr(&again).contains("complete"), "{}", stderr(&again));
    }
    assert_eq!(names(&dir), ["parts", "whole"], "no draft is left");
}

#[test]
fn another_study_does_not_go_on_and_says_what_differs() {
    let dir = directory("cli", "resume_other");
    let out = dir.join("out");
    assert_eq!(quick("run", &out, &["--stop-after", "1"]).status.code(), Some(1));
    let before = bytes(&out);
    for (verb, more, message) in [
        ("run", &["--seed", "9"][..], "seed was 1 and is 9"),
        ("run", &["--format", "csv"], "format was \"parquet\" and is \"csv\""),
        ("run", &["--logged", "1"], "logged was 3 and is 1"),
        ("run", &["--until", "half-width 2%"], "until was [] and is [\"half-width 2%\"]"),
        ("run", &["--policy", "adaptive"], "policies was"),
        ("run", &["--set", "machine.L.tool_change_time=1 min"], "changes was"),
        ("compare", &["--logged", "3"], "the command was"),
    ] {
        let refused = quick(verb, &out, &[more, &["--resume"]].concat());
        assert_eq!(refused.status.code(), Some(2), "{more:?}: {}", stderr(&refused));
        assert!(stderr(&refused).contains(message), "{more:?}: {}", stderr(&refused));
    }
    // A finished part that the program does not repeat.
    let study = fs::read_to_string(out.join("study.json")).expect("there");
    let number = study.find("[[[").expect("figures") + 3;
    let end = number + study[number..].find([',', ']']).expect("a list");
    fs::write(out.join("study.json"), format!("{}12345.5{}", &study[..number], &study[end..])).expect("writable");
    let refused = quick("run", &out, &["--resume"]);
    assert!(stderr(&refused).contains("study.json was changed since"), "{}", stderr(&refused));
    let refused = quick("run", &out, &["--resume", "--force"]);
    assert!(stderr(&refused).contains("does not repeat"), "{}", stderr(&refused));
    fs::write(out.join("study.json"), study).expect("writable");
    assert!(bytes(&out) == before, "a refusal changes nothing");
    assert_eq!(names(&dir), ["out"], "no draft is left");
}

#[test]
fn a_missing_report_is_drawn_again() {
    let dir = directory("cli", "redraw");
    for (name, more, code) in [("whole", &[][..], 0), ("part", &["--stop-after", "2"], 1)] {
        let out = dir.join(name);
        assert_eq!(quick("compare", &out, more).status.code(), Some(code));
        let before = bytes(&out);
        fs::remove_file(out.join("report.html")).expect("there");
        let output = toolroom(&["report", &out.display().to_string()]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stdout(&output).trim().ends_with("report.html"));
        assert!(bytes(&out) == before, "{name}: the report is the one that was there");
    }
}

/// A signal `seconds` after the start of an endless study, which ends with `code`.
#[cfg(unix)]
fn interrupted_after(seconds: u64, folder: &Path, signal: &str, code: i32) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_toolroom"))
        .args(["compare", &shipped("template"), "--replications", "100000", "--logged", "0", "--out"])
        .arg(folder)
        .args(["--policy", "constant", "--policy", "best constant", "--set", "shop.horizon=6 h"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary runs");
    std::thread::sleep(std::time::Duration::from_secs(seconds));
    let interrupt = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill runs");
    assert!(interrupt.success());
    assert_eq!(child.wait().expect("it ends").code(), Some(code));
}

#[cfg(unix)]
#[test]
fn an_interrupted_study_keeps_what_is_complete() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let dir = directory("cli", "interrupt");
        let out = dir.join("out");
        // A busy machine may need longer for its first replications; until then nothing is written.
        for seconds in [1, 4, 16, 64] {
            interrupted_after(seconds, &out, signal, code);
            if out.join("run.json").exists() {
                break;
            }
            let left = if out.exists() { names(&out) } else { Vec::new() };
            assert!(left.iter().all(|name| name == JOURNAL), "no draft is left: {left:?}");
        }
        is_readable_as_far_as_it_came(&out);
    }
}

#[cfg(unix)]
fn is_readable_as_far_as_it_came(folder: &Path) {
    assert!(names(folder).iter().all(|name| name == JOURNAL || !name.starts_with('.')), "no draft and no lock is left");
    let run: Value = serde_json::from_slice(&fs::read(folder.join("run.json")).expect("run.json")).expect("JSON");
    assert_eq!(run["complete"], false);
    let done = run["replications"].as_u64().expect("a count");
    assert!((1..100_000).contains(&done), "{done}");
    let report = toolroom(&["report", &folder.display().to_string()]);
    assert!(stderr(&report).contains("interrupted"), "{}", stderr(&report));
}

#[test]
fn a_recorded_shop_is_diagnosed_and_its_key_figures_come_nearer() {
    let dir = directory("cli", "recorded-shop");
    let path = |name: &str| dir.join(name).display().to_string();
    let nominal = shipped("gap/shop");
    let late = "\n[[deviation]]\nid = \"operator_delay\"\nsize = \"15 s\"\nshift = \"S2\"\n";
    let text = fs::read_to_string(&nominal).expect("a shipped scenario");
    fs::write(path("true.toml"), text + late).expect("writable");
    let (records, out, better) = (path("records"), path("gap"), path("better.toml"));
    let run = ["run", &path("true.toml"), "--replications", "2", "--out", &path("run"), "--records", &records];
    assert_eq!(toolroom(&run).status.code(), Some(0), "{}", stderr(&toolroom(&run)));
    assert_eq!(
        names(Path::new(&records)),
        [".toolroom.json", "cuts.csv", "events.csv", "operations.csv", "orders.csv"]
    );
    let found = json(&toolroom(&["gap", "diagnose", "--model", &nominal, "--data", &records, "--out", &out, "--json"]));
    assert_eq!(
        (&found["verdict"], &found["effects"][0]["id"]),
        (&"effect".into(), &"operator_delay".into()),
        "{found}"
    );
    assert_eq!(found["effects"][0]["scope"]["shift"][0], "S2");
    let diagnosis = format!("{out}/diagnosis.json");
    let apply = ["gap", "apply", "--model", &nominal, "--diagnosis", &diagnosis, "--out", &better];
    let applied = json(&toolroom(&[&apply[..], &["--data", &records, "--json"]].concat()));
    let cycle = &applied["kpi"][0];
    assert_eq!(cycle["kpi"], "cycle_time");
    assert!(cycle["closed"].as_f64().is_some_and(|closed| closed > 0.7), "{applied}");
    assert_eq!(toolroom(&["check", &better]).status.code(), Some(0));
}
