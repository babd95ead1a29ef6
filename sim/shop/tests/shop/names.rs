//! What is drawn belongs to names: the order of the tables of a scenario decides nothing.

use toolroom_scenario::Scenario;
use toolroom_scenario_file::{parse, read};
use toolroom_shop::run;
use toolroom_shop::runlog::RunLog;

fn shipped(name: &str, changes: &[&str]) -> Scenario {
    let file = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/{}.toml"), name);
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// Jobs by their order and arrival, with what became of them.
fn fates(scenario: &Scenario, log: &RunLog) -> Vec<String> {
    let mut fates: Vec<String> = log
        .jobs
        .iter()
        .map(|job| {
            let order = job.order.map_or("", |order| scenario.orders[order as usize].id.as_str());
            let part = &scenario.parts[job.part as usize].name;
            format!("{order} {part} {} {} {:?}", job.arrival, job.finish, job.outcome)
        })
        .collect();
    fates.sort();
    fates
}

#[test]
fn orders_of_one_instant_go_by_their_names_wherever_they_stand() {
    for name in ["operators", "lots", "orders", "running"] {
        let scenario = shipped(name, &[]);
        let mut turned = scenario.clone();
        turned.orders.reverse();
        // Orders that are made for others say so by their place.
        assert!(scenario.orders.iter().all(|order| order.parent.is_none()));
        let (there, here) = (run(&scenario, 0, 0).unwrap(), run(&turned, 0, 0).unwrap());
        assert_eq!(fates(&scenario, &there), fates(&turned, &here), "{name}");
    }
}

/// Two ways to break down on one machine, and two maintenances.
fn breaking(failures: [&str; 3]) -> RunLog {
    let text = format!(
        "schema = 1\n[shop]\nname = \"breaking\"\nhorizon = \"400 h\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\n{}\
         [[part]]\nname = \"job\"\noperation = [{{ name = \"do\", machines = \"M\", work = \"50 min\" }}]\n\
         [[arrivals]]\npart = \"job\"\npattern = \"constant_work\"\njobs = 2\n",
        failures.concat()
    );
    run(&parse("shop.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario, 0, 0).unwrap()
}

fn failure(name: &str, between: &str) -> String {
    let name = if name.is_empty() { String::new() } else { format!("name = \"{name}\"\n") };
    format!(
        "[[failure]]\n{name}machines = \"M\"\ntime_between = {{ distribution = \"exponential\", mean = \"{between}\" }}\n\
         time_to_repair = {{ distribution = \"exponential\", mean = \"40 min\" }}\n"
    )
}

fn finishes(log: &RunLog) -> Vec<f64> {
    log.jobs.iter().map(|job| job.finish).filter(|finish| finish.is_finite()).collect()
}

#[test]
fn breakdowns_and_maintenance_draw_the_same_wherever_they_stand() {
    for [first, second] in [["", ""], ["jam", "crash"], ["jam", ""]] {
        let (often, seldom) = (failure(first, "5 h"), failure(second, "30 h"));
        let care = "[[maintenance]]\nmachines = \"M\"\nevery = \"40 h\"\nduration = { distribution = \"exponential\", mean = \"1 h\" }\n\
             [[maintenance]]\nmachines = \"M\"\nevery = \"90 h\"\nduration = { distribution = \"exponential\", mean = \"3 h\" }\n";
        let turned: Vec<&str> = care.split_inclusive("1 h\" }\n").collect();
        let turned = format!("{}{}", turned[1], turned[0]);
        let there = finishes(&breaking([&often, &seldom, care]));
        let here = finishes(&breaking([&seldom, &often, &turned]));
        assert!(there.len() > 300, "{}", there.len());
        assert_eq!(there, here, "{first} {second}");
    }
}

#[test]
fn a_named_breakdown_draws_the_same_whatever_others_there_are() {
    let downs = |failures: [&str; 3]| {
        let log = breaking(failures);
        let begins = log.events.iter().filter(|row| row.event == toolroom_shop::runlog::LogEvent::Failure);
        begins.map(|row| row.time).collect::<Vec<f64>>()
    };
    let jam = failure("jam", "5 h").replace("machines", "clock = \"calendar\"\nmachines");
    let alone = downs([&jam, "", ""]);
    // The other one never strikes, but would draw before by its mean time.
    let other = failure("", "1 h").replace("\"1 h\"", "\"80000 h\"");
    assert_eq!(alone, downs([&other, &jam, ""]));
    assert!(alone.len() > 50);
    // Without a name it draws by another owner.
    assert_ne!(alone, downs([&jam.replace("name = \"jam\"\n", ""), "", ""]));
}

/// The text of a scenario with the sections of one table in the opposite order, each with what is below it.
fn turned_over(text: &str, table: &str) -> String {
    let (head, below) = (format!("[[{table}]]"), format!("[[{table}."));
    let mut blocks: Vec<(bool, String)> = Vec::new();
    for line in text.split_inclusive('\n') {
        let begins = line.starts_with('[') && !(line.starts_with(&below) && blocks.last().is_some_and(|last| last.0));
        if begins || blocks.is_empty() {
            blocks.push((line.starts_with(&head), String::new()));
        }
        blocks.last_mut().unwrap().1 += line;
    }
    let mut turned =
        blocks.iter().filter(|block| block.0).map(|block| block.1.clone()).rev().collect::<Vec<_>>().into_iter();
    let order = |(own, block): &(bool, String)| if *own { turned.next().unwrap() } else { block.clone() };
    blocks.iter().map(order).collect()
}

#[test]
fn tools_and_parts_and_machines_draw_the_same_wherever_their_tables_stand() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios");
    for name in ["chatter-policies", "grinding-policies", "housing", "lathe-cell", "shop/mixed", "shop/rework"] {
        let file = format!("{folder}/{name}.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        let short = ["shop.warm_up=\"0 h\"".to_owned(), "shop.horizon=\"4 h\"".to_owned()];
        let short = if name.starts_with("shop") { &[][..] } else { &short[..] };
        let scenario =
            |text: &str| parse(&file, text, short).unwrap_or_else(|error| panic!("{name}: {error}")).scenario;
        let there = scenario(&text);
        let log = run(&there, 0, 0).unwrap();
        let expected = fates(&there, &log);
        assert!(expected.len() > 3, "{name}");
        for table in ["tool", "part", "machine"] {
            let here = scenario(&turned_over(&text, table));
            assert_eq!(fates(&here, &run(&here, 0, 0).unwrap()), expected, "{name}, {table}");
        }
    }
}
