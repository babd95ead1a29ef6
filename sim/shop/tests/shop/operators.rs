//! People and setup matrices against results worked out by hand.

use toolroom_scenario::Scenario;
use toolroom_scenario_file::{parse, read};
use toolroom_shop::run;
use toolroom_shop::runlog::{MachineState, RunLog};

fn shipped(changes: &[&str]) -> Scenario {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/operators.toml");
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// When the jobs are finished, min.
fn finishes(log: &RunLog) -> Vec<f64> {
    log.jobs.iter().map(|job| job.finish / 60.0).collect()
}

/// Stays of a machine in a state, min.
fn minutes(log: &RunLog, machine: u32, state: MachineState) -> Vec<(f64, f64)> {
    let rows = log.states.iter().filter(|row| row.machine == machine && row.state == state);
    rows.map(|row| (row.start / 60.0, row.end / 60.0)).collect()
}

#[test]
fn a_setter_sets_one_machine_after_the_other() {
    let log = run(&shipped(&[]), 0, 0).unwrap();
    assert_eq!(finishes(&log), [50.0, 80.0]);
    assert_eq!(minutes(&log, 1, MachineState::WaitingOperator), [(0.0, 30.0)]);
    assert_eq!(minutes(&log, 1, MachineState::Setup), [(30.0, 60.0)]);
    let two = run(&shipped(&["operator.setter.count=2"]), 0, 0).unwrap();
    assert_eq!(finishes(&two), [50.0, 50.0]);
}

#[test]
fn a_setter_who_leaves_goes_on_in_the_next_shift() {
    // Ten minutes of the second setup are left at the end of the shift; the lathes themselves go on.
    let log = run(&shipped(&["calendar.early.week={ mon-fri = [\"06:00-06:50\"] }", "shop.horizon=\"2 day\""]), 0, 0);
    let log = log.unwrap();
    assert_eq!(finishes(&log), [50.0, 24.0 * 60.0 + 30.0]);
    assert_eq!(minutes(&log, 1, MachineState::WaitingOperator), [(0.0, 30.0), (50.0, 24.0 * 60.0)]);
}

/// A setup that is under way at the end of a shift passes to who comes, though a job with an earlier date waits elsewhere.
#[test]
fn a_setup_under_way_passes_to_the_next_shift_before_what_waits() {
    let text = "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"8 h\"\n[dispatch]\nrule = \"edd\"\n\
        [[calendar]]\nname = \"early\"\nshift = [{ start = \"0 min\", end = \"60 min\" }]\n\
        [[calendar]]\nname = \"late\"\nshift = [{ start = \"60 min\", end = \"480 min\" }]\n\
        [[operator]]\nname = \"e\"\nskills = [\"set\"]\ncalendar = \"early\"\n\
        [[operator]]\nname = \"l\"\nskills = [\"set\"]\ncalendar = \"late\"\n\
        [[machine]]\nname = \"M\"\ncount = 2\nprocess = \"plain\"\nsetup_at_start = \"\"\n\
        [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"o\"\nmachines = \"M\"\nwork = \"5 min\"\n\
        setup_time = \"90 min\"\noperator = { setup = \"set\" }\n\
        [[order]]\nid = \"later\"\npart = \"p\"\ndue = \"8 h\"\n\
        [[order]]\nid = \"sooner\"\npart = \"p\"\nrelease = \"10 min\"\ndue = \"4 h\"\n";
    let scenario = parse("t.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let log = run(&scenario, 0, 0).unwrap();
    assert_eq!(finishes(&log), [95.0, 185.0]);
    assert_eq!(minutes(&log, 1, MachineState::WaitingOperator), [(10.0, 90.0)]);
}

#[test]
fn a_change_takes_what_its_place_in_the_matrix_says() {
    // One lathe, first set up, then changed from small to large, and back.
    let mut scenario = shipped(&["machine.L.count=1"]);
    let third = toolroom_scenario::Order { id: "third".to_owned(), ..scenario.orders[0].clone() };
    scenario.orders.push(third);
    let log = run(&scenario, 0, 0).unwrap();
    let setups: Vec<f64> = minutes(&log, 0, MachineState::Setup).iter().map(|(from, to)| to - from).collect();
    assert_eq!(setups, [30.0, 20.0, 45.0]);
    // By the least setup the two small ones follow each other.
    scenario.dispatch = vec![toolroom_scenario::DispatchRule::LeastSetup];
    let log = run(&scenario, 0, 0).unwrap();
    let setups: Vec<f64> = minutes(&log, 0, MachineState::Setup).iter().map(|(from, to)| to - from).collect();
    assert_eq!(setups, [30.0, 20.0]);
}

/// Identical machines that are loaded by one operator for a minute and work alone for three.
fn loaded(machines: u32) -> Scenario {
    let text = format!(
        r#"
schema = 1
[shop]
name = "loaded"
horizon = "100 h"
[[operator]]
name = "loader"
skills = "load"
[[machine]]
name = "M"
count = {machines}
process = "plain"
load_time = "1 min"
[[part]]
name = "part"
operation = [{{ name = "work", machines = "M", work = "3 min", operator = {{ load = "load" }} }}]
[[arrivals]]
part = "part"
pattern = "constant_work"
jobs = 20
"#
    );
    parse("loaded.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario
}

#[test]
fn one_operator_loads_as_many_machines_as_there_is_time_for() {
    for (machines, rate) in [(1, 0.25), (2, 0.5), (3, 0.75), (4, 1.0), (5, 1.0)] {
        let log = run(&loaded(machines), 0, 0).unwrap();
        let done = log.jobs.iter().filter(|job| job.finish.is_finite()).count() as f64;
        assert!((done / 6000.0 - rate).abs() < 2e-3, "{machines}: {}", done / 6000.0);
    }
}

#[test]
fn the_person_with_the_fewest_skills_goes() {
    let mut scenario = shipped(&["operator.setter.count=2"]);
    scenario.operators[0].skills = vec![0, 1];
    scenario.operators[1].skills = vec![0];
    let mut shop = toolroom_shop::Shop::new(&scenario, 0, 0).unwrap();
    shop.run_until(toolroom_kernel::SimTime::from_seconds(60.0).unwrap()).unwrap();
    let attended: Vec<_> = shop.world().operators.iter().map(|person| person.machine).collect();
    assert_eq!(attended, [Some(1), Some(0)], "the first lathe is served first, by the specialist");
}

#[test]
fn edges_wear_as_much_while_somebody_stands_beside_them() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/cell.toml");
    let mut scenario = read(file.as_ref(), &["shop.horizon=\"40 h\"".to_owned()]).unwrap().scenario;
    scenario.failures.clear();
    let alone = run(&scenario, 0, 0).unwrap();
    scenario.skills = vec!["run".to_owned()];
    scenario.operators = (0..2)
        .map(|i| toolroom_scenario::Operator {
            name: format!("O{i}"),
            skills: vec![0],
            calendar: None,
            rate: 0.0,
            walk: None,
        })
        .collect();
    scenario.parts[0].operations[0].attendance.run = Some(0);
    let attended = run(&scenario, 0, 0).unwrap();
    // A person for each lathe is no limit. Steps then wait within the instant only: the same cuts on the same edges.
    assert_eq!(attended.passes.len(), alone.passes.len());
    assert!(attended.edges == alone.edges);
    // With one person for two lathes only one of them is in cut at a time.
    scenario.operators.truncate(1);
    let shared = run(&scenario, 0, 0).unwrap();
    let mut cuts: Vec<(f64, f64)> = shared.passes.iter().map(|row| (row.start, row.end)).collect();
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let waiting = |log: &RunLog| log.states.iter().any(|row| row.state == MachineState::WaitingOperator);
    assert!(waiting(&shared) && !waiting(&attended));
    assert!(shared.passes.len() < alone.passes.len());
}

/// A shift that comes back finds an operation that may be finished after it, waiting for a person: it goes on waiting, once.
#[test]
fn who_waits_over_the_end_of_a_shift_is_served_once() {
    let text = r#"
schema = 1
[shop]
name = "absent"
horizon = "10 h"
[[calendar]]
name = "machines"
period = "10 h"
at_end = "finish"
shift = [{ start = "0 h", end = "2 h" }, { start = "3 h", end = "10 h" }]
[[calendar]]
name = "people"
period = "10 h"
shift = [{ start = "0 h", end = "1 h" }, { start = "4 h", end = "10 h" }]
[[operator]]
name = "tender"
count = 2
skills = "run"
calendar = "people"
[[machine]]
name = "M"
process = "plain"
calendar = "machines"
[[part]]
name = "part"
operation = [{ name = "work", machines = "M", work = "2 h", operator = { run = "run" } }]
[[order]]
id = "O"
part = "part"
quantity = 1
"#;
    let scenario = parse("absent.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let mut shop = toolroom_shop::Shop::new(&scenario, 0, 0).unwrap();
    shop.run_until(toolroom_kernel::SimTime::from_seconds(4.5 * 3600.0).unwrap()).unwrap();
    let attending = shop.world().operators.iter().filter(|person| person.machine.is_some()).count();
    assert_eq!(attending, 1, "one person is enough for one machine");
    assert_eq!(finishes(&shop.run().unwrap()), [300.0]);
}
