//! Orders, lots and dates against results worked out by hand.

use toolroom_scenario::file::{parse, read};
use toolroom_scenario::{Scenario, date};
use toolroom_shop::run;
use toolroom_shop::runlog::{MachineState, OperationRow, RunLog};

fn shipped(changes: &[&str]) -> Scenario {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/orders.toml");
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// When every order is finished, in the order of the table.
fn finishes(scenario: &Scenario, log: &RunLog) -> Vec<String> {
    let mut last = vec![0.0f64; scenario.orders.len()];
    for job in &log.jobs {
        let order = job.order.expect("a job of an order") as usize;
        last[order] = last[order].max(job.finish);
    }
    last.iter().map(|finish| date::show(scenario.start.unwrap() + finish)).collect()
}

fn setups(log: &RunLog) -> usize {
    log.events.iter().filter(|event| event.event == "setup").count()
}

#[test]
fn the_order_table_by_hand_comes_out_to_the_second() {
    let cases = [
        (
            "fifo",
            ["03-30 22:55", "03-31 02:05", "03-31 12:00", "03-31 22:15", "04-01 13:15", "04-07 12:40"],
            (2, 535.0, 8),
        ),
        (
            "edd",
            ["03-30 23:25", "03-31 02:35", "03-31 22:15", "03-31 12:00", "04-01 14:00", "04-07 12:40"],
            (1, 40.0, 9),
        ),
    ];
    for (rule, expected, (late, tardiness, changes)) in cases {
        let scenario = shipped(&[&format!("dispatch.rule={rule}")]);
        let log = run(&scenario, 0, 0).unwrap();
        let dated: Vec<String> = expected.iter().map(|time| format!("2026-{time}")).collect();
        assert_eq!(finishes(&scenario, &log), dated, "{rule}");
        let behind = |job: &toolroom_shop::runlog::JobRow| (job.finish - job.due).max(0.0) / 60.0;
        assert_eq!(log.jobs.iter().filter(|job| job.finish > job.due).count(), late, "{rule}");
        assert_eq!(log.jobs.iter().map(behind).sum::<f64>(), tardiness, "{rule}");
        assert_eq!(setups(&log), changes, "{rule}");
    }
}

#[test]
fn a_shop_that_runs_goes_on_to_the_same_second() {
    // The state of the shop above on Tuesday at 12:47, written as work in process.
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/running.toml");
    let scenario = read(file.as_ref(), &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let log = run(&scenario, 0, 0).unwrap();
    assert_eq!(finishes(&scenario, &log), ["2026-03-31 22:15", "2026-04-01 13:15", "2026-04-07 12:40"]);
    assert_eq!(setups(&log), 2, "for O5 at C and for O6 at T2: what is in the machines is set up");
}

#[test]
fn a_permuted_table_gives_the_same_finishes() {
    let scenario = shipped(&["dispatch.rule=edd"]);
    let mut turned = scenario.clone();
    turned.orders.reverse();
    let (there, here) = (run(&scenario, 0, 0).unwrap(), run(&turned, 0, 0).unwrap());
    let mut back = finishes(&turned, &here);
    back.reverse();
    assert_eq!(finishes(&scenario, &there), back);
}

/// Two stations: setup 20 and 3 min a piece, then setup 15 and 2 min a piece; ten pieces.
fn line(changes: &[&str]) -> Scenario {
    let text = r#"
schema = 1
[shop]
name = "line"
horizon = "10 h"
[[machine]]
name = "A"
process = "plain"
setup_at_start = ""
[[machine]]
name = "B"
process = "plain"
setup_at_start = ""
[[part]]
name = "plate"
operation = [
    { name = "saw", machines = "A", work = "3 min", setup_time = "20 min" },
    { name = "drill", machines = "B", work = "2 min", setup_time = "15 min" },
]
[[order]]
id = "1"
part = "plate"
quantity = 10
transfer = 10
"#;
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    parse("line.toml", text, &changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// Stays of a machine in a state, min.
fn minutes(log: &RunLog, machine: u32, state: MachineState) -> Vec<(f64, f64)> {
    let rows = log.states.iter().filter(|row| row.machine == machine && row.state == state);
    rows.map(|row| (row.start / 60.0, row.end / 60.0)).collect()
}

#[test]
fn pieces_that_are_transferred_earlier_are_finished_earlier() {
    // When the second station begins with its first piece and ends with its last, min.
    for (transfer, begins, ends) in [(10, 65.0, 85.0), (5, 50.0, 70.0), (1, 38.0, 58.0)] {
        let log = run(&line(&[&format!("order.1.transfer={transfer}")]), 0, 0).unwrap();
        let worked = minutes(&log, 1, MachineState::Working);
        assert_eq!((worked[0].0, worked[worked.len() - 1].1), (begins, ends), "transfer {transfer}");
        assert_eq!(setups(&log), 2, "one setup a station");
        assert_eq!(log.jobs.iter().map(|job| job.quantity).sum::<u32>(), 10);
    }
}

#[test]
fn a_machine_that_is_kept_for_an_order_starves_between_its_pieces() {
    // Pieces come every 3 minutes to a station that needs 2 and no setup.
    let log = run(&line(&["order.1.transfer=1", "part.plate.operation.drill.setup_time=\"0 min\""]), 0, 0).unwrap();
    let starved = minutes(&log, 1, MachineState::Starved);
    assert_eq!((starved.len(), starved[0], starved[8]), (9, (25.0, 26.0), (49.0, 50.0)));
    assert_eq!(minutes(&log, 1, MachineState::Working)[9], (50.0, 52.0));
}

#[test]
fn pieces_of_an_order_are_cut_one_by_one_and_move_on_together() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/cell.toml");
    let changes = ["shop.replications=1".to_owned()];
    let mut scenario = read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{error}")).scenario;
    scenario.arrivals.clear();
    scenario.failures.clear();
    let order = |id: &str, release: f64| toolroom_scenario::Order {
        id: id.to_owned(),
        part: 0,
        quantity: 6,
        release,
        due: 1e6,
        priority: 0,
        weight: 1.0,
        customer: String::new(),
        transfer: None,
        in_process: None,
    };
    scenario.orders = vec![order("first", 6.0 * 3600.0), order("second", 6.0 * 3600.0)];
    let log = run(&scenario, 0, 0).unwrap();
    assert_eq!(log.jobs.len(), 12);
    assert!(log.jobs.iter().all(|job| job.finish.is_finite() && job.quantity == 1));
    let rows_of = |order: u32, operation: u32| {
        let belongs =
            |row: &&OperationRow| log.jobs[row.job as usize].order == Some(order) && row.operation == operation;
        log.operations.iter().filter(belongs).collect::<Vec<_>>()
    };
    for order in 0..2 {
        let lathes: std::collections::BTreeSet<u32> = rows_of(order, 0).iter().map(|row| row.machine).collect();
        assert_eq!(lathes.len(), 1, "one lathe is kept for the order");
        let turned = rows_of(order, 0).iter().map(|row| row.end).fold(0.0, f64::max);
        assert!(rows_of(order, 1).iter().all(|row| row.start >= turned), "washed when all are turned");
        // Washed one after the other, without another order in between.
        let washed: Vec<f64> = rows_of(order, 1).iter().map(|row| row.start).collect();
        assert!((washed[5] - washed[0] - 5.0 * 90.0).abs() < 1e-6, "{washed:?}");
    }
}

#[test]
fn a_step_that_needs_little_more_is_finished_after_the_shift() {
    let ended = |within: &str| {
        let mut scenario = shipped(&[&format!("calendar.early.finish_within=\"{within}\"")]);
        scenario.orders.truncate(1);
        scenario.orders[0].quantity = 62;
        let log = run(&scenario, 0, 0).unwrap();
        let first = log.operations.iter().find(|row| row.machine == 0).unwrap().end;
        date::show(scenario.start.unwrap() + first)
    };
    // 62 pieces take 8 h 16 min: the last 16 minutes are overtime, or wait for the next day.
    assert_eq!(ended("15 min"), "2026-03-31 06:16");
    assert_eq!(ended("16 min"), "2026-03-30 14:16");
}
