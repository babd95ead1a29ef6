//! A planner's path: an order table is checked, run, and answered.

use super::*;

#[test]
fn an_order_table_is_checked_and_answered() {
    let scenario = shipped("shop/orders");
    let checked = toolroom(&["check", &scenario]);
    assert_eq!(checked.status.code(), Some(0), "{}", stderr(&checked));
    let message = stderr(&checked) + &stdout(&checked);
    assert!(message.contains("warning[late]: order O6 cannot be finished before 2026-04-07 12:40"), "{message}");
    let out = directory("cli", "orders");
    let ran = |more: &[&str]| {
        let out = out.display().to_string();
        json(&toolroom(&[&["run", &scenario, "--out", &out, "--force", "--json"], more].concat()))
    };
    let fifo = ran(&[]);
    let order = |answers: &Value, id: &str| {
        let orders = answers["orders"].as_array().expect("orders");
        orders.iter().find(|order| order["id"] == id).expect("the order").clone()
    };
    assert_eq!(order(&fifo, "O1")["finish"]["mean"], "2026-03-30 22:55");
    assert_eq!(order(&fifo, "O6")["finish"]["p95"], "2026-04-07 12:40");
    let late = |answers: &Value| {
        let orders = answers["orders"].as_array().expect("orders").clone();
        orders
            .iter()
            .filter(|order| order["on_time"]["share"] == 0.0)
            .map(|order| order["id"].clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(late(&fifo), ["O4", "O6"]);
    assert_eq!(late(&ran(&["--set", "dispatch.rule=edd"])), ["O6"]);
    let table = fs::read_to_string(out.join("orders.csv")).expect("the orders");
    assert!(
        table.lines().nth(1).expect("a row").contains("O6,hub,west,80,2026-04-01 06:00:00,2026-04-07 12:00:00"),
        "{table}"
    );
    let loads = fs::read_to_string(out.join("load.csv")).expect("the loads");
    assert_eq!(loads.lines().count(), 1 + 4 * 2, "four machines in two weeks: {loads}");
    let message = stdout(&toolroom(&["run", &scenario, "--out", &out.display().to_string(), "--force"]));
    assert!(message.contains("2 of 6 orders are late") && message.contains("2026-03-31 22:15"), "{message}");
}

#[test]
fn a_bad_row_is_told_with_its_line() {
    let folder = directory("cli", "orders-bad");
    let text = fs::read_to_string(shipped("shop/orders")).expect("the scenario");
    let table = fs::read_to_string(shipped("shop/orders").replace(".toml", ".csv")).expect("the table");
    let scenario = folder.join("orders.toml");
    fs::write(&scenario, text).expect("written");
    fs::write(folder.join("orders.csv"), table.replace("O3,hub", "O3,hubb")).expect("written");
    let checked = toolroom(&["check", &scenario.display().to_string()]);
    assert_eq!(checked.status.code(), Some(2), "{}", stdout(&checked));
    let message = stderr(&checked);
    assert!(
        message.contains("orders.csv, line 4") && message.contains("hubb") && message.contains("did you mean `hub`"),
        "{message}"
    );
}

#[test]
fn a_scenario_says_what_is_to_be_known() {
    let folder = directory("cli", "statistics");
    let scenario = folder.join("queue.toml");
    let text = fs::read_to_string(shipped("shop/queue")).expect("the scenario");
    let section = "[statistics]\nprimary = \"lead_time\"\nuntil = { lead_time = \"half-width 40 %\" }\n";
    let write = |section: &str| fs::write(&scenario, format!("{text}\n{section}")).expect("written");
    write(section);
    let out = folder.join("out").display().to_string();
    let name = scenario.display().to_string();
    let small = [
        "--set",
        "shop.horizon=\"200 h\"",
        "--set",
        "shop.warm_up=\"20 h\"",
        "--set",
        "shop.replications=60",
        "--force",
        "--out",
        &out,
        "--json",
    ];
    let run = |more: &[&str]| {
        let ran = toolroom(&[&["run", &name][..], &small, more].concat());
        assert!(ran.status.success(), "{}", stderr(&ran));
        let summary = json(&ran);
        summary["replications"].as_u64().expect("a number")
    };
    let stopped = run(&[]);
    assert!((8..60).contains(&stopped), "{stopped}");
    let page = fs::read_to_string(folder.join("out/schedule.html")).expect("a page");
    assert!(page.contains(&format!("of {stopped}, the median by lead_time under programmed")), "which run it is");
    // The command line goes before the file.
    assert_eq!(run(&["--until", "lead_time half-width 0.001 %"]), 60);
    // Another number of them counts where they end by a figure, unless one is typed.
    write(&section.replace("until", "max_replications = 12\nuntil"));
    assert_eq!(run(&["--until", "lead_time half-width 0.001 %"]), 12);
    assert_eq!(run(&["--until", "lead_time half-width 0.001 %", "--replications", "15"]), 15);
    write(&section.replace("lead_time\"\nuntil", "lead_tine\"\nuntil"));
    let checked = toolroom(&["check", &name]);
    assert_eq!(checked.status.code(), Some(2), "{}", stdout(&checked));
    let message = stderr(&checked);
    assert!(
        message.contains("line ")
            && message.contains("[statistics] primary")
            && message.contains("did you mean `lead_time`"),
        "{message}"
    );
}

#[test]
fn figures_stand_by_part_and_station_where_nothing_is_logged() {
    let folder = directory("cli", "groups");
    let out = folder.join("out").display().to_string();
    let cell = shipped("shop/job-shop");
    let ran = toolroom(&["run", &cell, "--replications", "3", "--logged", "0", "--out", &out, "--json"]);
    assert!(ran.status.success(), "{}", stderr(&ran));
    let summary = json(&ran);
    let groups = |kind: &str| summary[format!("by_{kind}")][0]["groups"].as_array().expect("groups").clone();
    let sum = |kind: &str, figure: &str| -> f64 {
        groups(kind).iter().map(|group| group["kpi"][figure]["mean"].as_f64().expect("a number")).sum()
    };
    assert!(groups("part").len() > 1 && groups("station").len() > 1 && summary["by_customer"].is_null());
    let wip = summary["policies"][0]["kpi"]["wip"]["mean"].as_f64().expect("a number");
    assert!((sum("part", "wip") / wip - 1.0).abs() < 1e-9, "the jobs in the shop are those of its parts");
    assert!(groups("station").iter().all(|group| group["kpi"]["queue_wait [min]"]["mean"].as_f64() > Some(0.0)));
    let table = fs::read_to_string(folder.join("out/stations.csv")).expect("a table");
    assert!(table.starts_with("policy,station,kpi,unit,mean,half_width\n"), "{table}");
    assert_eq!(table.lines().count(), 1 + 6 * groups("station").len());
    assert!(folder.join("out/parts.csv").is_file() && !folder.join("out/customers.csv").exists());
}

/// Components that are scrapped are a share of all components, though good ones do not leave the shop.
#[test]
fn scrap_of_components_is_a_share_of_components() {
    let folder = directory("cli", "components");
    let text = "schema = 1\n[shop]\nname = \"box\"\nhorizon = \"200 h\"\nreplications = 1\n\
        [[machine]]\nname = \"gears\"\nprocess = \"plain\"\n[[machine]]\nname = \"bench\"\nprocess = \"plain\"\n\
        [[part]]\nname = \"gear\"\noperation = [{ name = \"make\", machines = \"gears\", work = \"5 min\", \
        outcomes = [{ share = 0.2, scrap = true }] }]\n\
        [[part]]\nname = \"box\"\ncomponents = [{ part = \"gear\", quantity = 2 }]\n\
        operation = [{ name = \"join\", machines = \"bench\", work = \"8 min\", assemble = true }]\n\
        [[arrivals]]\npart = \"gear\"\npattern = \"poisson\"\nrate = \"10 1/h\"\n\
        [[arrivals]]\npart = \"box\"\npattern = \"poisson\"\nrate = \"4 1/h\"\n";
    let scenario = folder.join("box.toml");
    fs::write(&scenario, text).expect("a scenario");
    let out = folder.join("out");
    let (file, to) = (scenario.display().to_string(), out.display().to_string());
    let ran = toolroom(&["run", &file, "--logged", "1", "--format", "csv", "--out", &to, "--json"]);
    let summary = json(&ran);
    let jobs = fs::read_to_string(out.join("jobs.csv")).expect("jobs");
    let count = |part: &str, outcome: &str| {
        let of = |line: &&str| line.split(',').nth(3) == Some(part) && line.ends_with(outcome);
        jobs.lines().filter(of).count() as f64
    };
    let (good, scrapped, boxes) = (count("gear", "good"), count("gear", "rejected"), count("box", "good"));
    assert!(good > 1000.0 && scrapped > 200.0 && boxes > 500.0);
    let rate = |figures: &Value| figures["scrap_rate"]["mean"].as_f64().expect("a share");
    let groups = summary["by_part"][0]["groups"].as_array().expect("parts");
    let gear = groups.iter().find(|group| group["name"] == "gear").expect("the gear");
    assert!((rate(&gear["kpi"]) - scrapped / (good + scrapped)).abs() < 1e-12, "{gear}");
    let shop = rate(&summary["policies"][0]["kpi"]);
    assert!((shop - scrapped / (good + scrapped + boxes)).abs() < 1e-12, "{shop}");
}
