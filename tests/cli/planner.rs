//! A planner's whole path: the table of an order system, a look before the run, late orders with their probability,
//! and what a second setter would change.

use super::*;

/// Two lathes and one setter, who comes only in the morning.
const SHOP: &str = r#"
schema = 1
[shop]
name = "gear cell"
title = "Gears"
start = "2026-03-30 00:00"
horizon = "2 week"
replications = 20
[tables]
orders = "erp.csv"
column = [
    { name = "id", from = "Auftrag" }, { name = "part", from = "Teil" }, { name = "quantity", from = "Menge" },
    { name = "customer", from = "Kunde" }, { name = "release", from = "Start", format = "%d.%m.%Y", at = "06:00" },
    { name = "due", from = "Liefertermin", format = "%d.%m.%Y", at = "14:00" },
]
[[calendar]]
name = "early"
week = { mon-fri = ["06:00-14:00"] }
[[operator]]
name = "setter"
count = 1
skills = ["setup"]
calendar = "early"
[[machine]]
name = "T"
count = 2
process = "plain"
calendar = "early"
setup_at_start = ""
[[part]]
name = "gear"
[[part.operation]]
name = "turn"
machines = ["T"]
work = { distribution = "lognormal", mean = "6 min", cv = 0.05 }
setup_time = "120 min"
setup_group = "gears"
operator = { setup = "setup" }
[[part]]
name = "ring"
[[part.operation]]
name = "turn"
machines = ["T"]
work = { distribution = "lognormal", mean = "4 min", cv = 0.3 }
setup_time = "120 min"
setup_group = "rings"
operator = { setup = "setup" }
[dispatch]
rule = "edd"
"#;

/// Six lots that change over every time; the last one cannot be done by its date.
const ERP: &str = "Auftrag;Status;Teil;Menge;Kunde;Start;Liefertermin\n\
    4711;offen;gear;40;Nord;30.03.2026;31.03.2026\n\
    4712;offen;ring;60;Nord;30.03.2026;31.03.2026\n\
    4713;offen;gear;40;West;31.03.2026;02.04.2026\n\
    4714;offen;ring;60;West;31.03.2026;02.04.2026\n\
    4715;offen;gear;40;Nord;01.04.2026;07.04.2026\n\
    4716;offen;gear;300;Nord;06.04.2026;08.04.2026\n";

fn order<'a>(answers: &'a Value, id: &str) -> &'a Value {
    let orders = answers["orders"].as_array().expect("orders");
    orders.iter().find(|order| order["id"] == id).expect("the order")
}

fn on_time(answers: &Value, id: &str) -> f64 {
    order(answers, id)["on_time"]["share"].as_f64().expect("a share")
}

/// Median date of the end, which sorts as a text does.
fn finish<'a>(answers: &'a Value, id: &str) -> &'a str {
    order(answers, id)["finish"]["p50"].as_str().expect("a date")
}

#[test]
fn a_planner_goes_from_the_order_system_to_a_paired_answer() {
    let folder = directory("cli", "planner");
    let scenario = folder.join("shop.toml");
    fs::write(&scenario, SHOP).expect("written");
    fs::write(folder.join("erp.csv"), ERP).expect("written");
    let scenario = scenario.display().to_string();

    let checked = json(&toolroom(&["check", &scenario, "--json"]));
    let warnings = checked["warnings"].as_array().expect("warnings");
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    // 300 pieces of 6 min are 30 h; from Monday to Wednesday the lathe works 24. The times of a lot are one draw, and one
    // four deviations below the mean will not come.
    let message = warnings[0].as_str().expect("a text");
    assert!(message.starts_with("order 4716 cannot be finished before 2026-04-09 12:00"), "{message}");
    let overloaded =
        json(&toolroom(&["check", &scenario, "--json", "--set", "part.ring.operation.turn.work=\"80 min\""]));
    let warnings = overloaded["warnings"].to_string();
    assert!(warnings.contains("T1 + T2 is overloaded"), "120 rings of 80 min are 160 h: {warnings}");

    let run = |name: &str, more: &[&str]| {
        let out = folder.join(name).display().to_string();
        let answers = json(&toolroom(&[&["run", &scenario, "--out", &out, "--json"], more].concat()));
        (out, answers)
    };
    let (one, base) = run("one", &[]);
    let (two, second) = run("two", &["--set", "operator.setter.count=2"]);
    assert_eq!(on_time(&base, "4716"), 0.0, "check said so");
    assert_eq!(on_time(&second, "4716"), 0.0, "and no setter changes it");
    assert!(finish(&second, "4712") < finish(&base, "4712"), "who waited for the setter is earlier: {base}");

    // Stations without cutting data have neither edges nor costs here: the report says nothing of them.
    let report = fs::read_to_string(Path::new(&one).join("report.html")).expect("a report");
    assert!(report.contains("lead time") && !report.contains("edges / 100 parts"));
    assert!(!report.contains("Speed and wear of the edges"));

    let difference = json(&toolroom(&["diff", &one, &two, "--json"]));
    assert_eq!(difference["paired"], true, "{difference}");
    let rows = difference["differences"].as_array().expect("differences");
    let lead = rows.iter().find(|row| row["kpi"] == "lead_time [min]").expect("the lead time");
    let ends = &lead["difference"]["ci95"];
    assert_eq!(lead["difference"]["n"], 20);
    assert!(ends[1].as_f64().expect("an end") < 0.0, "lots leave earlier, beyond chance: {lead}");

    // The same question as a variant of the file.
    let varied = folder.join("varied.toml");
    let variant = "[[variant]]\nname = \"second setter\"\nset = { \"operator.setter.count\" = 2 }\n";
    fs::write(&varied, format!("{SHOP}\n{variant}")).expect("written");
    let varied = varied.display().to_string();
    let out = folder.join("varied").display().to_string();
    let answers = json(&toolroom(&["compare", &varied, "--out", &out, "--json", "--select", "lead_time 10 min"]));
    let found = &answers["variants"][0];
    assert_eq!(found["name"], "second setter");
    let paired = &found["policies"][0]["differences"]["lead_time [min]"];
    let close = |a: &Value, b: &Value| (a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-9;
    assert!(close(&paired["mean"], &lead["difference"]["mean"]), "{paired} and {lead}");
    assert!(close(&paired["ci95"][1], &ends[1]));
    assert_eq!(paired["resolved_together"], true);
    assert_eq!(answers["selection"]["best"], "second setter", "{}", answers["selection"]);
    let rows = fs::read_to_string(folder.join("varied/variants.csv")).expect("a table");
    let late = |shop: &str| rows.lines().filter(|row| row.starts_with(shop) && row.contains(",late_orders,")).count();
    assert_eq!((late("as it is,"), late("second setter,")), (20, 20));
    let report = fs::read_to_string(folder.join("varied/report.html")).expect("a report");
    assert!(report.contains("Variants of the shop") && report.contains("second setter"));

    // What a variant cannot change is reported at its place.
    fs::write(folder.join("wrong.toml"), format!("{SHOP}\n{}", variant.replace("setter.count", "seter.count")))
        .expect("written");
    let wrong = folder.join("wrong.toml").display().to_string();
    for verb in ["check", "compare"] {
        let output = toolroom(&[verb, &wrong]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("second setter") && message.contains("seter"), "{message}");
    }
}
