//! `toolroom life` and `toolroom merge`: fits of measured lives, studies, shards, refusals.

use crate::command_line::{directory, stderr, toolroom};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn json(arguments: &[&str]) -> Value {
    let output = toolroom(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// The words of a refusal with exit code 2, wherever its lines break.
fn refused(arguments: &[&str]) -> String {
    let output = toolroom(arguments);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    stderr(&output).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

/// Changes and cuts a part at some places, and asks that it is refused by its name each time; it is then as
/// it was.
fn damaged_parts_are_refused(part: &Path, merge: &[&str]) {
    let whole = fs::read(part).expect("a part");
    let name = part.file_name().and_then(|name| name.to_str()).expect("a name");
    for k in 0..6 {
        // Spread over the file by the golden ratio, the same on every run.
        let offset = (whole.len() as f64 * (0.618 * f64::from(k + 1)).fract()) as usize;
        let mut changed = whole.clone();
        changed[offset] ^= 1 << k;
        for bytes in [&whole[..offset], &changed] {
            fs::write(part, bytes).expect("writable");
            let said = refused(merge);
            assert!(said.contains(name) && said.contains("run its shard again"), "{offset}: {said}");
        }
    }
    fs::write(part, whole).expect("writable");
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

fn close(value: &Value, expected: f64, relative: f64) {
    let value = value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    assert!((value / expected - 1.0).abs() < relative, "{value} against {expected}");
}

fn fit_of<'a>(summary: &'a Value, distribution: &str) -> &'a Value {
    let fits = summary["fits"].as_array().expect("fits");
    fits.iter().find(|fit| fit["distribution"] == distribution).expect("the law is fitted")
}

const STUDY: &str = "schema = 1\nname = \"small\"\nlives = 600\nparameter_set = \"ni_vk6om\"\n\
    scatter = { allowance = \"0 mm\", piece_hardness = \"0\" }\n\
    [[condition]]\ncutting_speed = [\"30 m/min\", \"40 m/min\"]\n";
/// What keeps the statistics of a test short.
const QUICK: [&str; 2] = ["--bootstrap", "20"];

/// The study of these tests with some more lines, in a directory.
fn study(folder: &Path, more: &str) -> PathBuf {
    let path = folder.join("study.toml");
    fs::write(&path, format!("{STUDY}{more}")).expect("written");
    path
}

#[test]
fn measured_lives_give_the_published_law() {
    let folder = directory("life", "fit");
    let lives = folder.join("bearings.csv");
    // J. Lieblein, M. Zelen, J. Research NBS 57 (1956) 273.
    let ages = "17.88 28.92 33.00 41.52 42.12 45.60 48.40 51.84 51.96 54.12 55.56 67.80 68.64 68.64 68.88 84.12 \
        93.12 98.64 105.12 105.84 127.92 128.04 173.40";
    fs::write(&lives, format!("life [min]\n{}\n", ages.split_whitespace().collect::<Vec<_>>().join("\n"))).unwrap();
    let out = folder.join("out");
    let arguments = ["life", "--fit", text(&lives), "--out", text(&out), "--goodness", "19", "--json"];
    let summary = json(&[&arguments[..], &QUICK].concat());
    close(&summary["n"], 23.0, 1e-12);
    close(&summary["mean [min]"], 72.224, 1e-4);
    let weibull = fit_of(&summary, "weibull");
    close(&weibull["parameters"]["shape"], 2.101_85, 1e-4);
    close(&weibull["parameters"]["scale [min]"], 81.874_56, 1e-4);
    close(&weibull["log_likelihood"], -113.692, 1e-5);
    assert!(weibull["p"].as_f64().is_some_and(|p| p > 0.0 && p <= 1.0), "{weibull}");
    assert!(summary["replacement"]["saving"].as_f64().is_some() && summary["digest"].is_string());
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Probability paper") && page.contains("Cost against the age of replacement"));
    assert_eq!(summary, serde_json::from_str::<Value>(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap());
}

#[test]
#[allow(clippy::print_stderr)] // a test that is left out says so
fn public_wear_data_give_their_known_numbers() {
    let data = std::env::var_os("TOOLROOM_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let (nasa, phm, turning) = (
        data.join("nasa-mill-wear.csv"),
        data.join("phm2010-milling-wear.csv"),
        data.join("turning-wear-18-tools.csv"),
    );
    if !nasa.is_file() || !phm.is_file() || !turning.is_file() {
        eprintln!("skipped: no wear data in {}", data.display());
        return;
    }
    let folder = directory("life", "public");
    let fit = |arguments: &[&str]| {
        let out = folder.join("out");
        json(&[&["life", "--json", "--goodness", "0", "--out", text(&out), "--fit"], arguments, &QUICK].concat())
    };
    // NASA milling: ln T = 3.22 - 0.98 ln a_p - 0.36 ln f - 1.47 [steel], deviation 0.24.
    let columns = ["--edge", "case", "--age", "time", "--wear", "VB", "--limit", "0.3", "--regress", "ln(DOC)"];
    let more = ["--regress", "ln(feed)", "--regress", "material=2"];
    let milled = fit(&[&[text(&nasa)], &columns[..], &more].concat());
    let coefficient = |name: &str| &milled["regression"]["coefficients"][name]["coefficient"];
    close(coefficient("intercept"), 3.22, 2e-3);
    close(coefficient("ln(DOC)"), -0.98, 1e-2);
    close(coefficient("ln(feed)"), -0.36, 1e-2);
    close(coefficient("material=2"), -1.47, 5e-3);
    close(&milled["regression"]["sigma"], 0.24, 2e-2);
    // PHM 2010: 298, 277.5 and 234 cuts to 165 um, CV 0.12.
    let cutters = fit(&[text(&phm), "--edge", "cutter", "--age", "cut", "--wear", "max_wear", "--limit", "165"]);
    close(&cutters["mean"], (298.0 + 277.5 + 234.0) / 3.0, 2e-3);
    close(&cutters["cv"], 0.12, 0.03);
    // 18 tools to chipping: the last wear is 184.7 um on average, Weibull 4.08 and 203 um.
    let mut last: Vec<(String, String)> = Vec::new();
    for line in fs::read_to_string(&turning).unwrap().lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        last.retain(|(tool, _)| tool != cells[0]);
        last.push((cells[0].to_owned(), cells[3].to_owned()));
    }
    let ends = folder.join("ends.csv");
    let rows: Vec<&str> = last.iter().map(|(_, wear)| wear.as_str()).collect();
    fs::write(&ends, format!("life [um]\n{}\n", rows.join("\n"))).unwrap();
    let worn = fit(&[text(&ends)]);
    close(&worn["mean [um]"], 184.7, 1e-3);
    close(&fit_of(&worn, "weibull")["parameters"]["shape"], 4.08, 3e-3);
    close(&fit_of(&worn, "weibull")["parameters"]["scale [um]"], 203.0, 2e-3);
}

#[test]
fn lives_that_no_edge_has_are_refused_and_others_of_any_size_are_fitted() {
    let folder = directory("life", "extremes");
    let file = folder.join("lives.csv");
    let out = folder.join("out");
    let fit = ["life", "--fit", text(&file), "--out", text(&out), "--bootstrap", "20", "--goodness", "19", "--json"];
    // Each among lives that are fine: line, value and fix are reported.
    for wrong in ["0", "-3", "1e200", "1e300", "1e-300", "1e13", "inf", "-inf", "NaN", "1e400", "", "x"] {
        fs::write(&file, format!("life [min],group\n12,a\n{wrong},a\n17,a\n21,a\n")).unwrap();
        let said = refused(&fit);
        assert!(said.contains("lives.csv:3: `life` is") && said.contains(wrong) && said.contains("is due"), "{said}");
    }
    for (wrong, column) in [("14,20", "inspected"), ("14,-1", "inspected"), ("14,1e300", "inspected")] {
        fs::write(&file, format!("life [min],inspected\n12,\n{wrong}\n17,\n")).unwrap();
        let said = refused(&fit);
        assert!(said.contains("lives.csv:3:") && said.contains(column), "{said}");
    }
    fs::write(&file, "tool,t,VB\n1,0,0\n1,1e300,1\n").unwrap();
    let readings = ["--edge", "tool", "--age", "t", "--wear", "VB", "--limit", "0.3"];
    assert!(refused(&[&fit[..], &readings].concat()).contains("lives.csv:3: `t` is `1e300`"));
    fs::write(&file, "tool,t,VB\n1,0,0\n1,1,1e12\n").unwrap();
    assert!(refused(&[&fit[..], &readings].concat()).contains("edge `1` is"));
    fs::write(&file, "life,f\n1,1\n2,1e300\n3,3\n").unwrap();
    assert!(refused(&[&fit[..], &["--regress", "f"]].concat()).contains("lives.csv:3: `f` is `1e300`"));
    // Too little for any law, each in its own words.
    for (lives, words) in [
        ("5\n", "1 different lives"),
        ("5\n5\n5\n5\n", "1 different lives"),
        ("5,1\n7,1\n", "all 2 lives are censored"),
        ("5,1\n", "all 1 lives are censored"),
    ] {
        let header = if lives.contains(',') { "life,censored" } else { "life" };
        fs::write(&file, format!("{header}\n{lives}")).unwrap();
        let said = refused(&fit);
        assert!(said.contains(words), "{said}");
    }
    // As small, large and far apart, or as near to each other, as a file may have them.
    for lives in [
        ["1e-9", "2e-9", "3e-9", "5e-9", "8e-9"],
        ["1e11", "2e11", "3e11", "5e11", "1e12"],
        ["1e-9", "1", "10", "1e6", "1e12"],
        ["1e-9", "1e-9", "1e-9", "1e-9", "1e12"],
        ["5", "5", "5", "5", "5.0000000001"],
        ["5", "5", "5", "5", "1e12"],
    ] {
        fs::write(&file, format!("life\n{}\n", lives.join("\n"))).unwrap();
        let found = json(&fit);
        let (least, most) = (lives[0].parse::<f64>().unwrap(), lives[4].parse::<f64>().unwrap());
        let mean = found["mean"].as_f64().expect("a number");
        assert!(least <= mean && mean <= most, "{lives:?}: {mean}");
        assert!(found["fits"].as_array().is_some_and(|fits| !fits.is_empty()), "{lives:?}");
        assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("Probability paper"), "{lives:?}");
    }
    // The search for a gamma law went beyond the range of numbers here, and the program panicked.
    for lives in [
        "3.3471834061730865e-08,1,\n0.16872578601802418,0,\n5.004999999999999,1,\n3.347183406176434e-08,0,\n1.3e-09,0,\n\
         1000000000000.0,0,\n1e-09,0,5e-10\n",
        "1.7465057488474325e-05,1,\n0.01967495001034625,1,\n0.019655294715630624,1,\n1000000000000.0,0,\n1e-09,0,\n\
         1.001e-09,0,\n0.019655294715630624,0,0.0\n",
    ] {
        fs::write(&file, format!("life,censored,inspected\n{lives}")).unwrap();
        let output = toolroom(&fit);
        assert!(matches!(output.status.code(), Some(0 | 2)), "{lives}: {}", stderr(&output));
    }
}

#[test]
fn a_broken_quote_is_refused_with_its_line() {
    let folder = directory("life", "quotes");
    let file = folder.join("lives.csv");
    fs::write(&file, "life,group\n12,a\n17,\"a\n21,b\n").unwrap();
    let said = refused(&["life", "--fit", text(&file), "--out", text(&folder.join("out"))]);
    assert!(said.contains("lives.csv:3:") && said.contains("never closed"), "{said}");
}

#[test]
fn shards_threads_and_interruptions_change_nothing() {
    let folder = directory("life", "shards");
    let file = study(&folder, "");
    let run = |out: &str, more: &[&str]| {
        let out = folder.join(out);
        json(&[&["life", text(&file), "--json", "--out", text(&out)], more, &QUICK].concat())
    };
    let whole = run("whole", &["--threads", "1"]);
    assert_eq!(whole["cells"].as_array().map(Vec::len), Some(2));
    assert_eq!(run("threads", &["--threads", "2"]), whole);
    // A name of a column has a comma in it.
    let mut cells = csv::Reader::from_path(folder.join("whole/cells.csv")).expect("a table");
    let names = cells.headers().expect("a header").clone();
    let b10 = names.iter().position(|name| name == "B10 [min]").expect("the column");
    let rows: Vec<csv::StringRecord> = cells.records().map(|row| row.expect("as long as the header")).collect();
    assert_eq!((names.len(), rows.len()), (12, 2));
    for (row, cell) in rows.iter().zip(whole["cells"].as_array().expect("cells")) {
        close(&cell["b10 [min]"]["value"], row[b10].parse().expect("a number"), 1e-12);
    }
    assert_eq!(run("seven", &["--shards", "7"]), whole);

    let plan = folder.join("plan.json");
    let said = toolroom(&["life", text(&file), "--plan", text(&plan), "--shards", "5"]);
    assert_eq!(said.status.code(), Some(0), "{}", stderr(&said));
    let parts = folder.join("parts");
    let shard = |k: &str| toolroom(&["life", "--run", text(&plan), "--shard", k, "--out", text(&parts)]);
    let merge = ["merge", text(&parts), "--json", "--out"];
    for k in ["4", "0", "2", "1"] {
        assert_eq!(shard(k).status.code(), Some(0));
    }
    let merged = folder.join("merged");
    let arguments = [&merge[..], &[text(&merged)], &QUICK].concat();
    assert!(refused(&arguments).contains("1 of 5 shards are missing: 3"));
    assert_eq!(shard("3").status.code(), Some(0));
    // A shard that is there is not run again: its file keeps its time.
    let modified = |name: &str| fs::metadata(parts.join(name)).and_then(|data| data.modified()).unwrap();
    let before = modified("part-000003.parquet");
    assert_eq!(shard("3").status.code(), Some(0));
    assert_eq!(modified("part-000003.parquet"), before);
    assert_eq!(json(&arguments), whole);

    // A study that was killed between shards goes on to the same result.
    let seven = folder.join("seven");
    fs::remove_file(seven.join("parts/part-000002.json")).unwrap();
    fs::remove_file(seven.join("parts/part-000005.parquet")).unwrap();
    assert_eq!(run("seven", &["--shards", "7", "--resume"]), whole);

    // Refusals: a doubled, a foreign and a changed part.
    let (one, copy) = (parts.join("part-000001.json"), parts.join("part-000001-copy.json"));
    fs::copy(&one, &copy).unwrap();
    assert!(refused(&arguments).contains("shard 1 is there twice"));
    fs::remove_file(&copy).unwrap();
    fs::copy(folder.join("whole/parts/part-000000.json"), &one).unwrap();
    assert!(refused(&arguments).contains("belongs to another plan"));
    fs::remove_file(&one).unwrap();
    assert_eq!(shard("1").status.code(), Some(0));
    fs::write(parts.join("part-000001.parquet"), b"cut short").unwrap();
    assert!(refused(&arguments).contains("run shard 1 again"));
    assert_eq!(shard("1").status.code(), Some(0));
    damaged_parts_are_refused(&parts.join("part-000002.json"), &arguments);
    assert_eq!(json(&arguments), whole);
    let error = shard("5");
    assert_eq!(error.status.code(), Some(2));
    assert!(stderr(&error).contains("numbered from 0"));
}

#[test]
fn a_study_says_what_was_asked_of_it() {
    let folder = directory("life", "study");
    let more = "[[policy]]\nname = \"constant\"\nspeed = \"programmed\"\n[[policy]]\nname = \"adaptive\"\n\
        speed = \"minimum_wear\"\nreading = \"pass\"\n[early]\nage = \"8 min\"\nwear_shift = 1.5\n\
        [replacement]\nplanned = \"10 EUR\"\nfailure = \"50 EUR\"\n[sensitivity]\nsamples = 64\ntrajectories = 4\n";
    let file = study(&folder, more);
    let out = folder.join("out");
    let summary = json(&[&["life", text(&file), "--json", "--lives", "200", "--out", text(&out)], &QUICK[..]].concat());
    let cells = summary["cells"].as_array().expect("cells");
    assert_eq!(cells.len(), 4);
    assert_eq!((&cells[1]["policy"], &cells[1]["condition"]), (&"adaptive".into(), &"v 30".into()));
    for key in ["n", "mean [min]", "cv", "quantiles", "fits", "replacement", "digest", "regression", "sensitivity"] {
        assert!(!summary[key].is_null(), "{key}");
    }
    close(&cells[0]["mean [min]"], 22.9, 0.1);
    assert!(cells[0]["early"]["standard_error"].as_f64().is_some_and(|error| error > 0.0));
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    for title in
        ["Flank wear over time", "Tool life over speed", "Life with one input at its ends", "Probability paper"]
    {
        assert!(page.contains(title), "{title}");
    }
    assert!(out.join("parts/part-000000.parquet").is_file() && out.join("cells.csv").is_file());
}

#[test]
fn a_precision_sets_the_number_of_lives() {
    let folder = directory("life", "precision");
    let file = study(&folder, "").with_file_name("study.toml");
    let text_of = fs::read_to_string(&file).unwrap().replace("lives = 600", "lives = 50000\nuntil = \"2 %\"");
    fs::write(&file, text_of).unwrap();
    let out = folder.join("out");
    let summary = json(&[&["life", text(&file), "--json", "--out", text(&out)], &QUICK[..]].concat());
    let lives = summary["n"].as_f64().expect("a number");
    assert!((500.0..5000.0).contains(&lives), "{lives}");
    let (mean, error) = (summary["mean [min]"].as_f64().unwrap(), summary["standard_error [min]"].as_f64().unwrap());
    assert!(1.96 * error / mean < 0.022, "{error} of {mean}");
}

#[test]
fn input_that_makes_no_sense_is_refused() {
    let folder = directory("life", "refused");
    let with = |more: &str| {
        let file = study(&folder, more);
        refused(&["life", text(&file), "--out", text(&folder.join("out"))])
    };
    let field = "[[field]]\nname = \"cut.hardness\"\ndistribution = ";
    assert!(with(&format!("{field}\"gamma\"\nscale = \"-1\"\nshape = 2\n")).contains("positive"));
    assert!(with(&format!("{field}\"uniform\"\nlow = \"1 mm\"\nhigh = \"2\"\n")).contains("`low`"));
    assert!(
        with("[[field]]\nname = \"cut.hardnes\"\ndistribution = \"normal\"\nmean = \"1\"\ndeviation = \"0.1\"\n")
            .contains("cut.hardness")
    );
    let pair = |first: &str, second: &str, value: f64| {
        format!("[[correlation]]\nfirst = \"{first}\"\nsecond = \"{second}\"\nvalue = {value}\n")
    };
    let empirical = format!("{field}\"empirical\"\ncolumn = \"h\"\nfile = ");
    assert!(with(&format!("{empirical}\"nowhere.csv\"\n")).contains("nowhere.csv cannot be read"));
    fs::write(folder.join("g.csv"), "g\n1\n").unwrap();
    assert!(with(&format!("{empirical}\"g.csv\"\n")).contains("g.csv:1: there is no column `h`"));
    let (a, b, c) = ("common wear", "batch hardness", "initial wear");
    let impossible = [pair(a, b, 0.9), pair(b, c, 0.9), pair(a, c, -0.9)].concat();
    assert!(with(&impossible).contains("positive definite"));
    let faulty = format!("{field}\"normal\"\nmean = \"1\"\ndeviation = \"-1\"\n");
    let said = with(&[faulty, pair("cut.hardness", a, 0.5)].concat());
    assert!(said.contains("positive") && !said.contains("did you mean"), "{said}");
    assert!(with(&[pair(a, b, 0.5), pair(b, a, 0.4)].concat()).contains("given once"));
    assert!(with("lifes = 3\n").contains("lifes"));
    assert!(!folder.join("out").exists(), "nothing is written");

    let csv = |name: &str, content: &str| {
        let path = folder.join(name);
        fs::write(&path, content).unwrap();
        refused(&["life", "--fit", text(&path), "--out", text(&folder.join("out"))])
    };
    assert!(csv("censored.csv", "life,censored\n5,1\n7,1\n").contains("all 2 lives are censored"));
    assert!(csv("one.csv", "life\n5\n").contains("1 different lives that ended do not determine 2 parameters"));
    assert!(csv("negative.csv", "life\n5\n-3\n").contains("negative.csv:3: `life` is -3"));
    assert!(csv("words.csv", "life\n5\nlong\n").contains("words.csv:3: `life` is `long`"));
    assert!(refused(&["merge", text(&folder)]).contains("plan.json"));
    assert!(refused(&["life"]).contains("FILE") || refused(&["life"]).contains("required"));
}

#[test]
fn a_file_that_changes_between_shards_is_refused() {
    let folder = directory("life", "changed");
    let field = "[[field]]\nname = \"cut.hardness\"\ndistribution = \"empirical\"\nfile = \"h.csv\"\ncolumn = \"h\"\n";
    let file = study(&folder, field);
    let (csv, plan, parts) = (folder.join("h.csv"), folder.join("plan.json"), folder.join("parts"));
    fs::write(&csv, "h\n0.9\n1.1\n").unwrap();
    let run = |arguments: &[&str]| toolroom(arguments).status.code();
    assert_eq!(run(&["life", text(&file), "--plan", text(&plan), "--shards", "2"]), Some(0));
    let shard = |k: &'static str| ["life", "--run", text(&plan), "--shard", k, "--out", text(&parts)];
    assert_eq!(run(&shard("0")), Some(0));
    fs::write(&csv, "h\n0.8\n1.2\n").unwrap();
    assert!(refused(&shard("1")).contains("h.csv has changed"));
    assert!(refused(&["merge", text(&parts)]).contains("h.csv has changed"));
}

#[cfg(unix)]
#[test]
fn a_signal_keeps_the_shards_that_are_complete_and_leaves_no_lock() {
    let folder = directory("life", "signal");
    let file = study(&folder, "");
    let arguments = |out: &'static str, more: &[&'static str]| -> Vec<String> {
        let all = ["life", text(&file), "--json", "--lives", "40000", "--shards", "40", "--out"];
        let out = folder.join(out);
        [&all[..], &[text(&out)], more, &QUICK].concat().into_iter().map(str::to_owned).collect()
    };
    let run = |list: &[String]| json(&list.iter().map(String::as_str).collect::<Vec<_>>());
    let whole = run(&arguments("whole", &[]));
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let out = folder.join("out");
        let _ = fs::remove_dir_all(&out);
        let child = Command::new(env!("CARGO_BIN_EXE_toolroom"))
            .args(arguments("out", &[]))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary runs");
        while !out.join("parts/part-000000.json").is_file() {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill runs").success());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        assert!(stderr(&output).contains("of 40 shards are complete"), "{}", stderr(&output));
        assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
        let list =
            |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect::<Vec<_>>();
        assert_eq!(list(&out), ["parts"], "no draft and no lock is left");
        assert!(list(&out.join("parts")).iter().all(|name| !name.to_string_lossy().contains("partial")));
        assert_eq!(run(&arguments("out", &["--resume"])), whole);
    }
    // Started anew, the earlier parts go and what the user put beside them stays.
    fs::write(folder.join("out/parts/notes.txt"), "mine").unwrap();
    fs::write(folder.join("out/notes.txt"), "mine").unwrap();
    run(&arguments("out", &["--seed", "3"]));
    assert_eq!(fs::read_to_string(folder.join("out/parts/notes.txt")).unwrap(), "mine");
    assert_eq!(fs::read_to_string(folder.join("out/notes.txt")).unwrap(), "mine");
    fs::write(folder.join("out/parts/part-000001.parquet"), "mine").unwrap();
    let again = arguments("out", &[]);
    let again: Vec<&str> = again.iter().map(String::as_str).collect();
    assert!(refused(&again).contains("part-000001.parquet was changed since"));
    assert_eq!(fs::read(folder.join("out/parts/part-000001.parquet")).unwrap(), b"mine");
}

#[cfg(unix)]
#[test]
fn a_plan_takes_the_place_of_nothing_but_a_plan() {
    let folder = directory("life", "life-plan-place");
    let file = study(&folder, "");
    let plan_to =
        |place: &Path, shards: &str| toolroom(&["life", text(&file), "--plan", text(place), "--shards", shards]);
    let before = fs::read(&file).unwrap();
    let said = plan_to(&file, "2");
    assert_eq!(said.status.code(), Some(2));
    assert!(stderr(&said).contains("is an input of this command"), "{}", stderr(&said));
    assert_eq!(fs::read(&file).unwrap(), before);
    let plan = folder.join("plan.json");
    for shards in ["2", "3"] {
        assert_eq!(plan_to(&plan, shards).status.code(), Some(0));
        assert!(fs::read_to_string(&plan).unwrap().contains(&format!("\"shards\": {shards}")));
    }
    // Whatever is no file stays what it is.
    let link = folder.join("link");
    std::os::unix::fs::symlink("/dev/stdout", &link).unwrap();
    let said = plan_to(&link, "2");
    assert_eq!(said.status.code(), Some(0), "{}", stderr(&said));
    assert!(String::from_utf8_lossy(&said.stdout).contains("\"shards\": 2"));
    assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
}

#[cfg(unix)]
#[test]
fn a_full_disk_loses_nothing_that_was_complete() {
    let folder = directory("life", "full");
    let file = study(&folder, "");
    let out = folder.join("out");
    // Files above 64 KiB cannot be written: the plan fits, a part of 4000 lives does not.
    let arguments = format!("life {} --out {} --shards 2 --lives 4000 --bootstrap 20", text(&file), text(&out));
    let limited = format!("trap '' XFSZ; ulimit -f 64; exec {} {arguments}", env!("CARGO_BIN_EXE_toolroom"));
    let output = Command::new("bash").args(["-c", &limited]).env("NO_COLOR", "1").output().expect("a shell");
    assert_ne!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("part-000000"), "{}", stderr(&output));
    assert!(!out.join("summary.json").exists());
    let drafts = fs::read_dir(out.join("parts")).unwrap().filter_map(Result::ok);
    let left: Vec<String> = drafts.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(left, ["plan.json"], "no half-written part is left");
    let again = toolroom(&arguments.split(' ').chain(["--resume"]).collect::<Vec<_>>());
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
}

#[test]
fn a_shop_in_shards_is_the_shop_in_one_piece() {
    let folder = directory("life", "shop");
    let scenario = format!("{}/scenarios/demo.toml", env!("CARGO_MANIFEST_DIR"));
    let policies = ["--policy", "v0 at 0.2 mm", "--policy", "productivity"];
    let common = ["compare", &scenario, "--replications", "5"];
    let whole = folder.join("whole");
    let whole = json(&[&common[..], &policies, &["--json", "--out", text(&whole)]].concat());
    let plan = folder.join("plan.json");
    let planned = toolroom(&[&common[..], &policies, &["--plan", text(&plan), "--shards", "3"]].concat());
    assert_eq!(planned.status.code(), Some(0), "{}", stderr(&planned));
    let parts = folder.join("parts");
    for k in ["2", "0", "1"] {
        let shard = toolroom(&["shard", text(&plan), k, "--out", text(&parts), "--threads", "1"]);
        assert_eq!(shard.status.code(), Some(0), "{}", stderr(&shard));
    }
    let merged = json(&["merge", text(&parts), "--json", "--out", text(&folder.join("merged"))]);
    assert_eq!(merged, whole);
    let out = folder.join("merged");
    let merge = ["merge", text(&parts), "--out", text(&out)];
    damaged_parts_are_refused(&parts.join("part-000001.json"), &merge);
    fs::remove_file(parts.join("part-000001.json")).unwrap();
    assert!(refused(&merge).contains("missing: 1"));
}
