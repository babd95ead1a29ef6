//! Orders, lots and dates against results worked out by hand.

use toolroom_scenario::{Scenario, date};
use toolroom_scenario_file::{parse, read};
use toolroom_shop::run;
use toolroom_shop::runlog::{LogEvent, MachineState, OperationRow, RunLog};

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
    log.events.iter().filter(|event| event.event == LogEvent::Setup).count()
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
fn line_text() -> String {
    r#"
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
"#
    .to_owned()
}

/// That shop with some values changed.
fn line(changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    parse("line.toml", &line_text(), &changes).unwrap_or_else(|error| panic!("{error}")).scenario
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
        split: None,
        setup_ahead: false,
        parent: None,
        overrun: 0,
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

#[test]
fn a_machine_that_is_set_up_ahead_begins_as_soon_as_the_first_pieces_are_there() {
    // When the second station begins with its first piece and ends with its last, and how long it starves between, min.
    for (transfer, begins, ends, starves) in [(10, 50.0, 70.0, 35.0), (5, 35.0, 60.0, 25.0), (1, 23.0, 52.0, 17.0)] {
        let log = run(&line(&[&format!("order.1.transfer={transfer}"), "order.1.setup_ahead=true"]), 0, 0).unwrap();
        let worked = minutes(&log, 1, MachineState::Working);
        assert_eq!((worked[0].0, worked[worked.len() - 1].1), (begins, ends), "transfer {transfer}");
        assert_eq!(minutes(&log, 1, MachineState::Setup), [(0.0, 15.0)], "transfer {transfer}");
        let starved = minutes(&log, 1, MachineState::Starved);
        // From the end of the setup to the first piece, then between pieces: 8 min and 9 times 1 min for single ones.
        assert_eq!(starved.iter().map(|(from, to)| to - from).sum::<f64>(), starves, "transfer {transfer}");
        assert_eq!((setups(&log), log.jobs.len()), (2, 10 / transfer), "nobody sees the stand-in");
        assert_eq!(log.operations.len(), 2 * 10 / transfer);
        let elsewhere = minutes(&log, 0, MachineState::Working);
        assert_eq!((elsewhere[0].0, elsewhere[elsewhere.len() - 1].1), (20.0, 50.0), "the first station is as it was");
    }
}

#[test]
fn a_setup_ahead_of_the_second_machine_lets_the_third_be_set_up_too() {
    // A third station: setup 40 and 1 min a piece. All are set up from 0 on.
    let more = "    { name = \"wash\", machines = \"C\", work = \"1 min\", setup_time = \"40 min\" },\n]\n[[order]]";
    let station = "[[machine]]\nname = \"C\"\nprocess = \"plain\"\nsetup_at_start = \"\"\n[[part]]";
    let text = line_text().replace("]\n[[order]]", more).replace("[[part]]", station);
    for (transfer, begins, ends) in [(10, 70.0, 80.0), (1, 40.0, 53.0)] {
        let changes = [format!("order.1.transfer={transfer}"), "order.1.setup_ahead=true".to_owned()];
        let scenario = parse("line.toml", &text, &changes).unwrap_or_else(|error| panic!("{error}")).scenario;
        let log = run(&scenario, 0, 0).unwrap();
        for (machine, setup) in [(0, 20.0), (1, 15.0), (2, 40.0)] {
            assert_eq!(minutes(&log, machine, MachineState::Setup), [(0.0, setup)], "transfer {transfer}");
        }
        let worked = minutes(&log, 2, MachineState::Working);
        assert_eq!((worked[0].0, worked[worked.len() - 1].1), (begins, ends), "transfer {transfer}");
        assert_eq!((setups(&log), log.jobs.len()), (3, 10 / transfer), "nobody sees the stand-ins");
    }
}

#[test]
fn a_machine_is_set_up_ahead_although_the_one_before_needs_no_setup() {
    let text = line_text().replacen("setup_at_start = \"\"\n", "setup_at_start = \"plate\"\n", 1);
    let log = |ahead: bool| {
        let change = format!("order.1.setup_ahead={ahead}");
        run(&parse("line.toml", &text, &[change]).unwrap_or_else(|error| panic!("{error}")).scenario, 0, 0).unwrap()
    };
    assert_eq!(minutes(&log(true), 0, MachineState::Setup), []);
    assert_eq!(minutes(&log(true), 1, MachineState::Setup), [(0.0, 15.0)]);
    assert_eq!(minutes(&log(false), 1, MachineState::Setup), [(30.0, 45.0)]);
}

/// The same with three saws and two drills.
fn wide(changes: &[&str]) -> Scenario {
    let mut all = vec!["machine.A.count=3", "machine.B.count=2"];
    all.extend(changes);
    line(&all)
}

#[test]
fn a_split_order_is_divided_equally_over_the_machines_that_are_free() {
    let pieces = |log: &RunLog, machine: u32| {
        log.operations.iter().filter(|row| row.machine == machine).map(|row| row.quantity).sum::<u32>()
    };
    let ends = |log: &RunLog| {
        let last = |machine| minutes(log, machine, MachineState::Working).last().map(|(_, to)| *to);
        [0, 1, 2, 3, 4].map(last)
    };
    // Over two: 20 + 5 · 3 min, then 15 + 5 · 2 min.
    let two = run(&wide(&["order.1.split=2"]), 0, 0).unwrap();
    assert_eq!(ends(&two), [Some(35.0), Some(35.0), None, Some(60.0), Some(60.0)]);
    assert_eq!([0, 1, 2, 3, 4].map(|machine| pieces(&two, machine)), [5, 5, 0, 5, 5]);
    assert_eq!(setups(&two), 4);
    // Over all: 4, 3 and 3 pieces, then 5 and 5.
    let all = run(&wide(&["order.1.split=\"all\""]), 0, 0).unwrap();
    assert_eq!(ends(&all), [Some(32.0), Some(29.0), Some(29.0), Some(57.0), Some(57.0)]);
    assert_eq!([0, 1, 2, 3, 4].map(|machine| pieces(&all, machine)), [4, 3, 3, 5, 5]);
    // A machine that has done its share is free while the others still work.
    let idle = minutes(&all, 1, MachineState::Idle);
    assert_eq!(idle[0].0, 29.0);
    // Single pieces move on: two come every three minutes from 23 on, one to each drill, where 15 min of setup are first.
    let single = run(&wide(&["order.1.split=2", "order.1.transfer=1"]), 0, 0).unwrap();
    assert_eq!(ends(&single), [Some(35.0), Some(35.0), None, Some(48.0), Some(48.0)]);
    // With both: the drills are set up from 0 on, and get two pieces every three minutes.
    let ahead = run(&wide(&["order.1.split=2", "order.1.transfer=1", "order.1.setup_ahead=true"]), 0, 0).unwrap();
    assert_eq!(ends(&ahead), [Some(35.0), Some(35.0), None, Some(37.0), Some(37.0)]);
    assert_eq!(minutes(&ahead, 4, MachineState::Setup), [(0.0, 15.0)]);
    // One machine is not split.
    let one = run(&wide(&["order.1.split=1"]), 0, 0).unwrap();
    assert_eq!(ends(&one), [Some(50.0), None, None, Some(85.0), None]);
}

#[test]
fn a_split_order_takes_only_machines_that_no_better_job_wants() {
    // The second order is more urgent: by its rule the second saw takes that, and the first order stays on one.
    let text = "[[order]]\nid = \"2\"\npart = \"plate\"\nquantity = 2\npriority = 0\n";
    let scenario = |rule: &str| {
        let first = "priority = 1\nsplit = 2\nquantity = 10\n";
        let all = format!("{}\n{text}", line_text().replace("quantity = 10\n", first));
        let changes = ["machine.A.count=2".to_owned(), format!("dispatch.rule={rule}")];
        parse("line.toml", &all, &changes).unwrap_or_else(|error| panic!("{error}")).scenario
    };
    let saws = |log: &RunLog, order: u32| {
        let rows = log.operations.iter().filter(|row| row.operation == 0);
        let own = rows.filter(|row| log.jobs[row.job as usize].order == Some(order));
        own.map(|row| row.machine).collect::<std::collections::BTreeSet<u32>>().len()
    };
    let log = run(&scenario("priority"), 0, 0).unwrap();
    assert_eq!((saws(&log, 0), saws(&log, 1)), (1, 1));
    let log = run(&scenario("fifo"), 0, 0).unwrap();
    assert_eq!((saws(&log, 0), saws(&log, 1)), (2, 1));
}

#[test]
fn a_machine_is_set_up_once_for_all_pieces_even_where_the_same_group_needs_a_setup() {
    let matrix = "\n[[setup_matrix]]\nname = \"jaws\"\ngroups = [\"plate\"]\ntimes = [[\"4 min\"], [\"4 min\"]]\n";
    let text = format!("{}{matrix}", line_text());
    let changes = ["machine.A.setup_matrix=jaws".to_owned(), "order.1.transfer=1".to_owned()];
    let scenario = parse("line.toml", &text, &changes).unwrap_or_else(|error| panic!("{error}")).scenario;
    assert_eq!(minutes(&run(&scenario, 0, 0).unwrap(), 0, MachineState::Setup), [(0.0, 4.0)]);
}

#[test]
fn a_breakdown_during_a_setup_ahead_only_makes_it_longer() {
    let text = format!(
        "{}\n[[failure]]\nmachines = \"B\"\nclock = \"calendar\"\ntime_between = \"10 min\"\ntime_to_repair = \"100 min\"\npart = \"scrap\"\n",
        line_text()
    );
    let scenario = parse("line.toml", &text, &["order.1.setup_ahead=true".to_owned()]);
    let log = run(&scenario.unwrap_or_else(|error| panic!("{error}")).scenario, 0, 0).unwrap();
    assert_eq!(minutes(&log, 1, MachineState::Setup)[..2], [(0.0, 10.0), (110.0, 115.0)]);
    assert_eq!(log.jobs[0].quantity, 10);
}

#[test]
fn what_lot_rules_cannot_do_is_refused_with_the_way_out() {
    let refused = |changes: &[&str]| {
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        parse("line.toml", &line_text(), &changes).expect_err("refused").to_string()
    };
    let lot = "part.plate.operation.drill.work_per=lot";
    assert!(refused(&["order.1.split=2", lot]).contains("takes one time for all of it"));
    let back = "part.plate.operation.drill.outcomes=[{ share = 0.1, go = \"saw\" }]";
    assert!(refused(&["order.1.setup_ahead=true", back]).contains("sends parts back"));
    assert!(refused(&["order.1.setup_ahead=true", "machine.B.input_buffer=2"]).contains("buffer"));
    assert!(refused(&["order.1.split=some"]).contains("all, or a whole number"));
    assert!(refused(&["order.1.split=0"]).contains("1 to 1000"));
}

#[test]
fn the_shipped_lots_stay_as_long_as_their_file_says() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/lots.toml");
    let file = read(path.as_ref(), &[]).unwrap_or_else(|error| panic!("{error}"));
    let said = |name: &str| {
        let line = file.text.lines().find(|line| line.starts_with(&format!("#   {name}  "))).expect("a line for it");
        line.trim_end_matches(" min").rsplit(' ').next().and_then(|minutes| minutes.parse::<f64>().ok())
    };
    let stays = |changes: &[String]| {
        let scenario = read(path.as_ref(), changes).unwrap_or_else(|error| panic!("{error}")).scenario;
        run(&scenario, 0, 0).unwrap().jobs.iter().map(|job| job.finish / 60.0).fold(0.0, f64::max)
    };
    assert_eq!(said("as it is"), Some(stays(&[])));
    for variant in &file.variants {
        assert_eq!(said(&variant.name), Some(stays(&variant.set)), "{}", variant.name);
    }
    assert_eq!(file.variants.len(), 6);
}
