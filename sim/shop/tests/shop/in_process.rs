//! Work that is in the shop when the run begins, against results worked out by hand.

use toolroom_scenario::Scenario;
use toolroom_scenario_file::{parse, read};
use toolroom_shop::run;
use toolroom_shop::runlog::{LogEvent, MachineState, RunLog};

/// Two stations: setup 20 and 3 min a piece, then setup 15 and 2 min a piece; orders of ten pieces.
const LINE: &str = r#"
schema = 1
[shop]
name = "line"
horizon = "30 h"
[[calendar]]
name = "early"
shift = [{ start = "6 h", end = "14 h" }]
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
    { name = "saw", machines = "A", work = "3 min", setup_time = "20 min", setup_group = "plates" },
    { name = "drill", machines = "B", work = "2 min", setup_time = "15 min", setup_group = "plates" },
]
"#;

fn shop(orders: &[&str], rest: &str, changes: &[&str]) -> Scenario {
    let order = |id: &&str| format!("[[order]]\nid = \"{id}\"\npart = \"plate\"\nquantity = 10\ndue = \"20 h\"\n");
    let text = format!("{LINE}{}{rest}", orders.iter().map(order).collect::<String>());
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    parse("line.toml", &text, &changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// When the last piece of every order left, min.
fn finishes(scenario: &Scenario, log: &RunLog) -> Vec<f64> {
    let mut last = vec![0.0f64; scenario.orders.len()];
    for job in &log.jobs {
        let order = job.order.expect("a job of an order") as usize;
        last[order] = last[order].max(job.finish / 60.0);
    }
    last
}

fn worked(log: &RunLog, machine: u32) -> (f64, f64) {
    let rows = || log.states.iter().filter(|row| row.machine == machine && row.state == MachineState::Working);
    (rows().next().expect("it works").start / 60.0, rows().next_back().expect("it works").end / 60.0)
}

#[test]
fn an_order_in_a_machine_needs_what_is_left_and_those_before_it_go_by_their_waits() {
    let wip = r#"
[[wip]]
order = "1"
operation = "saw"
machine = "A"
done = "40 %"
[[wip]]
order = "2"
operation = "saw"
since = "-1 h"
[[wip]]
order = "3"
operation = "saw"
since = "-2 h"
[[wip]]
order = "4"
operation = "drill"
"#;
    let scenario = shop(&["1", "2", "3", "4", "5"], wip, &[]);
    let log = run(&scenario, 0, 0).unwrap();
    // A is ready for plates: 1 to 18 min, 3 to 48, 2 to 78, 5 to 108. B is set up for 4 until 15 and has it until 35.
    assert_eq!(finishes(&scenario, &log), [55.0, 98.0, 75.0, 35.0, 128.0]);
    let setups = log.events.iter().filter(|event| event.event == LogEvent::Setup).count();
    assert_eq!(setups, 1, "A stands ready for what is in it");
}

#[test]
fn a_setup_that_is_in_progress_is_finished_first() {
    let wip = "[[wip]]\norder = \"1\"\noperation = \"saw\"\nmachine = \"A\"\nsetup_left = \"12 min\"\n";
    let log = run(&shop(&["1"], wip, &[]), 0, 0).unwrap();
    assert_eq!((worked(&log, 0), worked(&log, 1)), ((12.0, 42.0), (57.0, 77.0)));
}

#[test]
fn work_in_a_machine_waits_for_its_shift() {
    let wip = "[[wip]]\norder = \"1\"\noperation = \"saw\"\nmachine = \"A\"\npieces = 4\n";
    let log = run(&shop(&["1"], wip, &["machine.A.calendar=\"early\""]), 0, 0).unwrap();
    assert_eq!(worked(&log, 0), (360.0, 378.0));
}

#[test]
fn pieces_that_move_apart_have_passed_or_wait() {
    // Four of ten pieces are sawn; the saw is kept for the rest, 3 minutes each from 0 on.
    let wip = "[[wip]]\norder = \"1\"\noperation = \"saw\"\nmachine = \"A\"\npieces = 4\n";
    for (transfer, begins, ends) in [(1, 15.0, 35.0), (5, 18.0, 38.0), (10, 33.0, 53.0)] {
        // A transfer of ten moves as one job, of which 40 % are done.
        let log = run(&shop(&["1"], wip, &[&format!("order.1.transfer={transfer}")]), 0, 0).unwrap();
        assert_eq!((worked(&log, 0), worked(&log, 1)), ((0.0, 18.0), (begins, ends)), "transfer {transfer}");
        assert_eq!(log.jobs.iter().map(|job| job.quantity).sum::<u32>(), 10);
    }
    // Seven of ten have left the shop; three are left to drill.
    let wip = "[[wip]]\norder = \"1\"\noperation = \"drill\"\nmachine = \"B\"\ndone = \"70 %\"\n";
    let scenario = shop(&["1"], wip, &["order.1.transfer=1"]);
    let log = run(&scenario, 0, 0).unwrap();
    assert_eq!((worked(&log, 1), log.jobs.len()), ((0.0, 6.0), 3));
    assert_eq!(scenario.orders[0].finished_before(&scenario.parts[0]), 7);
}

#[test]
fn a_furnace_is_loaded_at_the_start() {
    let changes = ["machine.A.batch={ max = 20, min = 20 }", "part.plate.operation.saw.work_per=\"batch\""];
    let wip = "[[wip]]\norder = \"1\"\noperation = \"saw\"\nmachine = \"A\"\ndone = \"50 %\"\n\
               [[wip]]\norder = \"2\"\noperation = \"saw\"\nmachine = \"A\"\ndone = \"50 %\"\n";
    let log = run(&shop(&["1", "2", "3", "4"], wip, &changes), 0, 0).unwrap();
    // Half of 3 minutes for both, then the other two together.
    let ends: Vec<f64> = log.operations.iter().filter(|row| row.operation == 0).map(|row| row.end).collect();
    assert_eq!(ends, [90.0, 90.0, 270.0, 270.0]);
}

#[test]
fn a_part_goes_on_within_its_passes_and_an_edge_is_as_worn_as_it_was() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/cell.toml");
    let mut scenario = read(file.as_ref(), &["machine.L.calendar=\"two shifts\"".to_owned()]).unwrap().scenario;
    scenario.arrivals.clear();
    scenario.failures.clear();
    scenario.orders.push(toolroom_scenario::Order {
        id: "A".to_owned(),
        part: 0,
        quantity: 1,
        release: -3600.0,
        due: 86_400.0,
        priority: 0,
        weight: 1.0,
        customer: String::new(),
        transfer: None,
        split: None,
        setup_ahead: false,
        parent: None,
        overrun: 0,
        in_process: Some(toolroom_scenario::InProcess {
            operation: 0,
            machine: Some(0),
            done: 0.375,
            setup_left: 0.0,
            since: 0.0,
        }),
    });
    for machine in &mut scenario.machines {
        machine.calendar = None;
    }
    scenario.machines[0].edges_at_start = vec![(0, 2e-4)];
    let log = run(&scenario, 0, 0).unwrap();
    // 20 m at 40 m/min: six passes of 30 s each, of which two and a quarter are cut.
    let passes: Vec<u32> = log.passes.iter().map(|row| row.pass).collect();
    assert_eq!(passes, [2, 3, 4, 5]);
    let cutting: f64 = log.passes.iter().map(|row| row.cutting_time).sum();
    assert!((cutting - 112.5).abs() < 1e-9, "{cutting}");
    assert!((log.passes[0].flank_wear_start - 2e-4).abs() < 1e-12);
    assert!((log.operations[0].time_before - 67.5).abs() < 1e-9);
    // The next edge is a new one.
    scenario.machines[0].edges_at_start.clear();
    let fresh = run(&scenario, 0, 0).unwrap();
    assert!(fresh.passes[0].flank_wear_start < 1e-5);
}

#[test]
fn an_order_is_late_by_what_it_waited_before_the_start() {
    let wip = "[[wip]]\norder = \"1\"\noperation = \"drill\"\nmachine = \"B\"\ndone = \"50 %\"\n";
    let scenario = shop(&["1"], wip, &["order.1.release=\"-5 h\"", "order.1.due=\"-1 h\""]);
    let log = run(&scenario, 0, 0).unwrap();
    let job = &log.jobs[0];
    assert_eq!((job.arrival / 60.0, job.finish / 60.0, job.due / 60.0), (-300.0, 10.0, -60.0));
}

#[test]
fn what_travels_with_work_at_the_start_is_held_from_the_start() {
    let text = |count: u32, second: &str| {
        let line = LINE.replace("{ name = \"saw\",", "{ name = \"saw\", fixture = \"pallet\", hold = \"until drill\",");
        let order = |id: u32| format!("[[order]]\nid = \"{id}\"\npart = \"plate\"\nquantity = 10\ndue = \"20 h\"\n");
        format!(
            "{line}{}{}[[fixture]]\nname = \"pallet\"\ncount = {count}\n\
             [[wip]]\norder = \"1\"\noperation = \"drill\"\nmachine = \"B\"\ndone = \"50 %\"\n{second}",
            order(1),
            order(2)
        )
    };
    let read = |text: &str| parse("line.toml", text, &[]);
    let ends = |text: &str| {
        let scenario = read(text).unwrap_or_else(|error| panic!("{error}")).scenario;
        finishes(&scenario, &run(&scenario, 0, 0).unwrap())
    };
    // Ten minutes of drilling are left; then the pallet is free, and the second order takes 20 + 30 and 20 min.
    assert_eq!(ends(&text(1, "")), [10.0, 80.0]);
    assert_eq!(ends(&text(2, "")), [10.0, 70.0]);
    let waits = "[[wip]]\norder = \"2\"\noperation = \"drill\"\nsince = \"0 h\"\n";
    assert_eq!(ends(&text(2, waits)), [10.0, 30.0]);
    let error = read(&text(1, waits)).expect_err("there is one pallet").to_string();
    assert!(error.contains("2 orders hold \"pallet\" at the start"), "{error}");
}
