//! A planner's whole path from the tables of an order system: a mapping, a look before the run, late orders with their
//! probability, and what a second setter would change.

use super::*;

/// Orders of the table.
const ORDERS: usize = 300;

const BASE: &str = r#"schema = 1
[shop]
name = "works"
start = "2026-03-30 00:00"
horizon = "6 week"
replications = 10
[[calendar]]
name = "early"
week = { mon-fri = ["06:00-14:00"] }
[[calendar]]
name = "two"
week = { mon-fri = ["06:00-14:00", "14:00-22:00"] }
[dispatch]
rule = "edd"
[[variant]]
name = "second setter"
set = { "operator.Anna.count" = 2 }
"#;

const MAP: &str = r#"schema = 1
base = "base.toml"
[[table]]
kind = "machines"
file = "machines.csv"
default = { process = "plain" }
column = [{ name = "name", from = "Platz" }, { name = "calendar", from = "Schicht" }]
[[table]]
kind = "operators"
file = "people.csv"
column = [{ name = "name", from = "Name" }, { name = "skills", from = "Kann" }, { name = "calendar", from = "Schicht" }]
[[table]]
kind = "routings"
file = "routings.csv"
default = { operator.setup = "setup" }
column = [{ name = "part", from = "Teil" }, { name = "sequence", from = "AVO" }, { name = "machines", from = "Platz" },
          { name = "setup_time", from = "tr", unit = "min" }, { name = "work", from = "te", unit = "min", cv = 0.1 }]
[[table]]
kind = "orders"
file = "orders.csv"
where = "Status != 'fertig'"
column = [{ name = "id", from = "Auftrag" }, { name = "part", from = "Teil" }, { name = "quantity", from = "Menge" },
          { name = "release", from = "Start", format = "%d.%m.%Y", at = "06:00" },
          { name = "due", from = "Termin", format = "%d.%m.%Y", at = "14:00" }]
"#;

/// Writes the tables of a shop of six stations and a setter; `part_of_fifth` is the part of the fifth order.
fn tables(folder: &Path, part_of_fifth: &str) {
    let put = |name: &str, text: &str| fs::write(folder.join(name), text).expect("written");
    put("base.toml", BASE);
    put("map.toml", MAP);
    put("machines.csv", "Platz;Schicht\nT1;two\nT2;two\nF1;two\nF2;two\nS1;early\nM1;early\n");
    put("people.csv", "Name;Kann;Schicht\nAnna;setup;two\n");
    let mut routings = "Teil;AVO;Platz;tr;te\n".to_owned();
    for part in 0..20 {
        let (unit, setup) = (2 + part % 4, 20 + 5 * (part % 3));
        routings += &format!("P{part};20;F1, F2;{setup};{unit},5\nP{part};10;T1, T2;{setup};{unit},0\n");
        if part % 2 == 0 {
            routings += &format!("P{part};30;S1;0;4,5\n");
        }
        routings += &format!("P{part};40;M1;10;0,5\n");
    }
    put("routings.csv", &routings);
    let mut orders = "Auftrag;Status;Teil;Menge;Start;Termin\n".to_owned();
    for order in 0..ORDERS {
        // Five weeks of orders, each due nine days after its start; the tenth is 4 h of sawing due at once.
        let day = order * 33 / ORDERS;
        let date = |day: usize| match day {
            0..=1 => format!("{}.03.2026", 30 + day),
            2..=31 => format!("{:02}.04.2026", day - 1),
            _ => format!("{:02}.05.2026", day - 31),
        };
        let part = if order == 4 { part_of_fifth.to_owned() } else { format!("P{}", order % 20) };
        let (quantity, due) = if order == 10 { (300, day) } else { (10 + order % 7, day + 9) };
        orders += &format!("A{order:03};offen;{part};{quantity};{};{}\n", date(day), date(due));
    }
    put("orders.csv", &orders);
}

#[test]
fn a_planner_goes_from_the_tables_of_an_order_system_to_a_paired_answer() {
    let folder = directory("cli", "order_system");
    let here = |name: &str| folder.join(name).display().to_string();
    let (map, shop) = (here("map.toml"), here("shop.toml"));
    tables(&folder, "P44");
    let kind = json(&toolroom(&["check", &map, "--json"]));
    assert_eq!(kind["kind"], "shop-mapping");
    // A slip is told at its cell, and nothing is written.
    let refused = toolroom(&["import", "shop", "--map", &map, "--out", &shop]);
    assert_eq!(refused.status.code(), Some(2));
    let told = stderr(&refused);
    assert!(told.contains("orders.csv, row 6, cell C6 (Teil): there is no part \"P44\""), "{told}");
    assert!(told.contains("did you mean `P4`?") && !Path::new(&shop).exists(), "{told}");
    let refused = toolroom(&["import", "shop", "--map", &map, "--out", &shop, "--json"]);
    let told: Value = serde_json::from_slice(&refused.stdout).expect("JSON");
    assert_eq!((told["problems"][0]["code"].as_str(), told["valid"].as_bool()), (Some("unknown-name"), Some(false)));

    tables(&folder, "P4");
    let imported = json(&toolroom(&["import", "shop", "--map", &map, "--out", &shop, "--check", "--json"]));
    assert_eq!((imported["orders"].as_u64(), imported["parts"].as_u64()), (Some(ORDERS as u64), Some(20)));
    // S1 saws 150 orders of 13 pieces of 4.5 min, and A010 of 300, in the 240 h of its shifts until the horizon.
    let loads = imported["load"].as_array().expect("loads");
    let saw = loads.iter().find(|load| load["station"] == "S1").expect("the saw");
    let pieces: usize = (0..ORDERS).step_by(2).map(|order| if order == 10 { 300 } else { 10 + order % 7 }).sum();
    let hours = pieces as f64 * 4.5 / 60.0;
    assert!((saw["work [h]"].as_f64().expect("hours") - hours).abs() < 1e-6, "{saw}");
    let warnings = imported["warnings"].to_string();
    assert!(warnings.contains("order A010 cannot be finished before"), "{warnings}");
    assert!(warnings.contains("S1 cannot do in time what is due until"), "{warnings}");
    // The same shop with a slower saw has more work than time.
    let slow = fs::read_to_string(here("routings.csv")).expect("read").replace(";0;4,5", ";0;9,5");
    fs::write(here("routings.csv"), slow).expect("written");
    let slow = json(&toolroom(&["import", "shop", "--map", &map, "--out", &here("slow.toml"), "--check", "--json"]));
    assert!(slow["warnings"].to_string().contains("S1 is overloaded"), "{}", slow["warnings"]);

    let out = here("out");
    let answers = json(&toolroom(&["run", &shop, "--out", &out, "--json"]));
    let orders = answers["orders"].as_array().expect("orders");
    assert_eq!(orders.len(), ORDERS);
    let late = orders.iter().find(|order| order["id"] == "A010").expect("the order");
    assert_eq!(late["on_time"]["share"], 0.0, "check said so: {late}");
    assert!(orders[0]["on_time"]["share"].as_f64() <= orders[ORDERS - 1]["on_time"]["share"].as_f64());

    let compared = json(&toolroom(&["compare", &shop, "--out", &here("compared"), "--json"]));
    let found = &compared["variants"][0];
    assert_eq!(found["name"], "second setter");
    let lead = &found["policies"][0]["differences"]["lead_time [min]"];
    assert_eq!(lead["n"], 10);
    assert!(lead["ci95"][1].as_f64().expect("an end") < 0.0, "orders leave earlier, beyond chance: {lead}");
}
