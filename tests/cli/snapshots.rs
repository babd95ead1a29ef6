//! A shop that goes on from a snapshot: the uninterrupted run bit for bit, and branches of it.

use super::*;

/// Tables of a folder of results, by name.
fn tables(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found: Vec<_> = names(folder)
        .into_iter()
        .filter(|name| name.ends_with(".csv"))
        .map(|name| (name.clone(), fs::read(folder.join(name)).expect("a table")))
        .collect();
    found.sort();
    found
}

#[test]
fn what_goes_on_from_a_snapshot_is_the_uninterrupted_run_bit_for_bit() {
    let folder = directory("cli", "snapshots");
    let here = |name: &str| folder.join(name).display().to_string();
    for (shop, at) in [("shop/orders", "2026-04-01 06:00"), ("shop/rework", "37 h"), ("demo", "3 h")] {
        let (file, short) = (shipped(shop), shop.replace('/', "_"));
        let (whole, snapshot, again) =
            (here(&format!("{short}_whole")), here(&format!("{short}.trs")), here(&format!("{short}_again")));
        let common = ["--format", "csv", "--json", "--out"];
        let run = toolroom(&[&["run", &file, "--replications", "3"], &common[..], &[&whole]].concat());
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        let kept = toolroom(&["run", &file, "--replications", "3", "--snapshot-at", at, "--snapshot", &snapshot]);
        assert_eq!(kept.status.code(), Some(0), "{}", stderr(&kept));
        let from = toolroom(&[&["run", "--from", &snapshot], &common[..], &[&again]].concat());
        assert_eq!(from.status.code(), Some(0), "{}", stderr(&from));
        let (whole, again) = (tables(Path::new(&whole)), tables(Path::new(&again)));
        assert!(whole.len() > 5, "{shop}: {} tables", whole.len());
        for (one, other) in whole.iter().zip(&again) {
            assert!(one == other, "{shop}: {} differs", one.0);
        }
        assert_eq!(whole.len(), again.len());
    }
}

#[test]
fn a_branch_changes_what_comes_and_not_what_was() {
    let folder = directory("cli", "snapshot_branches");
    let here = |name: &str| folder.join(name).display().to_string();
    let (scenario, snapshot) = (here("shop.toml"), here("s.trs"));
    let text = fs::read_to_string(shipped("shop/orders")).expect("shipped");
    let orders = fs::read_to_string(Path::new(&shipped("shop/orders")).with_file_name("orders.csv")).expect("shipped");
    let variant = "\n[[variant]]\nname = \"no night\"\nset = { \"machine.C.calendar\" = \"early\" }\n";
    fs::write(&scenario, format!("{text}{variant}")).expect("written");
    fs::write(here("orders.csv"), &orders).expect("written");
    let at = "2026-03-31 12:00";
    let kept = toolroom(&["run", &scenario, "--snapshot-at", at, "--snapshot", &snapshot, "--json"]);
    assert_eq!(json(&kept)["at [h]"], 36.0);
    let run = |name: &str, more: &[&str]| {
        let out = here(name);
        json(&toolroom(&[&["run", "--from", &snapshot, "--out", &out, "--json"], more].concat()))
    };
    let finishes = |answers: &Value| {
        let orders = answers["orders"].as_array().expect("orders").iter();
        let mut finishes: Vec<(String, String)> = orders
            .map(|order| (order["id"].to_string(), order["finish"]["p50"].as_str().expect("a date").to_owned()))
            .collect();
        finishes.sort();
        finishes
    };
    let (as_it_is, set) = (finishes(&run("one", &[])), finishes(&run("two", &["--set", "machine.C.calendar=early"])));
    let named = finishes(&run("three", &["--variant", "no night"]));
    assert_eq!(set, named, "a variant is its values");
    assert_ne!(as_it_is, set, "no night shift from Tuesday noon on");
    for (before, after) in as_it_is.iter().zip(&set).filter(|(before, _)| before.1.as_str() < at) {
        assert_eq!(before, after, "what was done by then");
    }
    assert!(as_it_is.iter().any(|(_, finish)| finish.as_str() < at));
    // A comparison lets the variants of the file begin there, in pairs.
    let compared = json(&toolroom(&["compare", "--from", &snapshot, "--out", &here("compared"), "--json"]));
    assert_eq!(compared["variants"][0]["name"], "no night");

    // People who come in the instant of the branch are no part of the shop as it was.
    let people = here("people.trs");
    let kept = toolroom(&["run", &shipped("shop/operators"), "--snapshot-at", "2 h", "--snapshot", &people]);
    assert_eq!(kept.status.code(), Some(0), "{}", stderr(&kept));
    let compared = json(&toolroom(&["compare", "--from", &people, "--out", &here("people"), "--json"]));
    assert!(!compared["variants"].as_array().expect("variants").is_empty());
    let one = toolroom(&["run", "--from", &people, "--set", "operator.setter.count=2", "--out", &here("one_more")]);
    assert_eq!(one.status.code(), Some(0), "{}", stderr(&one));

    let refused = |arguments: &[&str]| {
        let output = toolroom(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        stderr(&output)
    };
    let told = refused(&[
        "run",
        "--from",
        &snapshot,
        "--set",
        "shop.shift_length=6 h",
        "--set",
        "part.shaft.flow_allowance=9 h",
    ]);
    assert!(
        told.contains("`shop.shift_length=6 h`, `part.shaft.flow_allowance=9 h` cannot change while the shop runs"),
        "{told}"
    );
    assert!(told.contains("other rules"), "{told}");
    let told = refused(&["run", "--from", &snapshot, "--seed", "3"]);
    assert!(told.contains("those of the snapshot"), "{told}");
    let told = refused(&["run", "--from", &snapshot, "--variant", "no nigt"]);
    assert!(told.contains("did you mean \"no night\"?"), "{told}");
    let demo = here("demo.trs");
    assert_eq!(
        toolroom(&["run", &shipped("demo"), "--snapshot-at", "3 h", "--snapshot", &demo]).status.code(),
        Some(0)
    );
    let told = refused(&["run", "--from", &demo, "--horizon", "2 h"]);
    assert!(told.contains("ends before the snapshot"), "{told}");
    let told = refused(&["run", &scenario, "--snapshot-at", "2026-03-29 12:00", "--snapshot", &here("x.trs")]);
    assert!(told.contains("no instant of the run"), "{told}");
    // The order table is a part of the run.
    fs::write(here("orders.csv"), orders.replace("O3", "O33")).expect("written");
    let told = refused(&["run", "--from", &snapshot]);
    assert!(told.contains("orders.csv has changed since the snapshot was taken"), "{told}");
    let other = fs::read_to_string(&snapshot).expect("read").replace("\"format\": 1", "\"format\": 7");
    fs::write(&snapshot, other).expect("written");
    assert!(refused(&["run", "--from", &snapshot]).contains("in format 7"));
}
