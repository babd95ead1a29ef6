//! Schedules that machines follow.

use proptest::prelude::*;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::{parse, read};
use toolroom_shop::run;
use toolroom_shop::runlog::RunLog;

fn shipped(name: &str, changes: &[String]) -> Scenario {
    let file = format!("{}/../../scenarios/shop/{name}", env!("CARGO_MANIFEST_DIR"));
    read(file.as_ref(), changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// Orders of the first job shop of Fisher and Thompson (1963), with sequences of the machines.
fn ft06(sequences: &[[usize; 6]; 6]) -> String {
    let scenario = shipped("ft06.toml", &[]);
    let mut text = "schema = 1\n[shop]\nname = \"ft06\"\nhorizon = \"8 h\"\n".to_owned();
    for machine in &scenario.machines {
        text += &format!("[[machine]]\nname = \"{}\"\nprocess = \"plain\"\n", machine.name);
    }
    for (index, part) in scenario.parts.iter().enumerate() {
        text += &format!("[[part]]\nname = \"J{}\"\n", index + 1);
        for operation in &part.operations {
            let (machine, time) = (&scenario.machines[operation.machines[0]].name, operation.work.plain_time() / 60.0);
            text += &format!(
                "[[part.operation]]\nname = \"on {machine}\"\nmachines = \"{machine}\"\nwork = \"{time} min\"\nsetup_group = \"x\"\n"
            );
        }
        text += &format!("[[order]]\nid = \"J{}\"\npart = \"J{}\"\nquantity = 1\n", index + 1, index + 1);
    }
    for (machine, jobs) in scenario.machines.iter().zip(sequences) {
        for job in jobs {
            let name = &machine.name;
            text += &format!("[[schedule]]\norder = \"J{job}\"\noperation = \"on {name}\"\nmachine = \"{name}\"\n");
        }
    }
    text
}

/// A schedule whose last job is finished at the least possible time.
const BEST: [[usize; 6]; 6] = [
    [1, 4, 3, 6, 2, 5],
    [2, 4, 6, 1, 5, 3],
    [3, 1, 2, 5, 4, 6],
    [3, 6, 4, 1, 2, 5],
    [2, 5, 4, 6, 3, 1],
    [3, 6, 2, 5, 1, 4],
];

fn minutes(log: &RunLog) -> Vec<f64> {
    log.jobs.iter().map(|job| job.finish / 60.0).collect()
}

#[test]
fn the_best_schedule_of_a_known_job_shop_is_replayed() {
    let scenario = parse("ft06.toml", &ft06(&BEST), &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let log = run(&scenario, 0, 0).unwrap();
    assert_eq!(minutes(&log), [55.0, 52.0, 49.0, 54.0, 53.0, 43.0]);
}

#[test]
fn sequences_that_can_never_begin_are_refused_with_their_circle() {
    let mut crossed = BEST;
    crossed[0] = [5, 2, 6, 3, 4, 1];
    crossed[2] = [6, 4, 5, 2, 1, 3];
    let error = parse("ft06.toml", &ft06(&crossed), &[]).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("in a circle") && error.contains(", then "), "{error}");
}

const TWO: &str = r#"
schema = 1
[shop]
name = "two"
horizon = "10 h"
[[machine]]
name = "M"
count = 2
process = "plain"
[[part]]
name = "part"
operation = [{ name = "work", machines = "M", work = "10 min" }]
[[order]]
id = "a"
part = "part"
quantity = 2
transfer = 1
[[order]]
id = "b"
part = "part"
[[order]]
id = "c"
part = "part"
release = "5 min"
"#;

fn two(rows: &[(&str, &str, &str)]) -> String {
    let row = |(order, machine, more): &(&str, &str, &str)| {
        format!("[[schedule]]\norder = \"{order}\"\noperation = \"work\"\nmachine = \"{machine}\"\n{more}\n")
    };
    TWO.to_owned() + &rows.iter().map(row).collect::<String>()
}

#[test]
fn a_machine_waits_for_its_next_operation_and_not_before_its_time() {
    let parsed = |text: &str| parse("two.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    // Two pieces of a lot on the machine that is kept for it, then b; the other machine waits for c.
    let log = run(&parsed(&two(&[("a", "M1", ""), ("b", "M1", ""), ("c", "M2", "")])), 0, 0).unwrap();
    assert_eq!(minutes(&log), [10.0, 20.0, 30.0, 15.0]);
    // Before b the machine waits for c, which is not there yet; a has a time before which it is not begun.
    let rows = [("a", "M1", "not_before = \"7 min\""), ("c", "M2", ""), ("b", "M2", "")];
    let log = run(&parsed(&two(&rows)), 0, 0).unwrap();
    assert_eq!(minutes(&log), [17.0, 27.0, 25.0, 15.0]);
    // Positions go before the order of the rows.
    let rows = [("a", "M1", ""), ("b", "M2", "position = 2"), ("c", "M2", "position = 1")];
    let log = run(&parsed(&two(&rows)), 0, 0).unwrap();
    assert_eq!(minutes(&log), [10.0, 20.0, 25.0, 15.0]);
}

#[test]
fn what_a_schedule_misses_is_told() {
    let told = |text: &str| parse("two.toml", text, &[]).map(|_| ()).unwrap_err().to_string();
    let error = told(&two(&[("a", "M1", "")]));
    assert!(error.contains("the schedule misses work of b, work of c"), "{error}");
    let error = told(&two(&[("a", "M1", ""), ("b", "M1", ""), ("c", "M1", ""), ("a", "M2", "")]));
    assert!(error.contains("is planned twice"), "{error}");
    let error = told(&two(&[("a", "M1", ""), ("b", "M1", ""), ("d", "M1", "")]));
    assert!(error.contains("\"d\""), "{error}");
}

/// A random shop of lots with alternatives, transfer and shifts, without people and chance about what becomes of parts.
fn random_shop(seed: u64) -> String {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut pick = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let rule = ["fifo", "spt", "edd", "least_setup"][pick(4) as usize];
    let mut text = format!(
        "schema = 1\n[shop]\nname = \"random\"\nseed = {}\nhorizon = \"2000 h\"\n[dispatch]\nrule = \"{rule}\"\n\
         [[calendar]]\nname = \"day\"\nperiod = \"10 h\"\nat_end = \"{}\"\nshift = [{{ start = \"1 h\", end = \"9 h\" }}]\n",
        seed + 1,
        ["resume", "finish"][pick(2) as usize]
    );
    for group in 0..3 {
        let (count, setup) = (1 + pick(3), 10 * pick(4));
        text += &format!(
            "[[machine]]\nname = \"M{group}\"\ncount = {count}\nprocess = \"plain\"\nsetup_at_start = \"\"\nsetup_time = \"{setup} min\"\n"
        );
        if pick(2) == 0 {
            text += "calendar = \"day\"\n";
        }
    }
    for part in 0..3 {
        text += &format!("[[part]]\nname = \"P{part}\"\n");
        for operation in 0..1 + pick(4) {
            let machines = ["\"M0\"", "\"M1\"", "\"M2\"", "[\"M0\", \"M2\"]"][pick(4) as usize];
            text += &format!(
                "[[part.operation]]\nname = \"o{operation}\"\nmachines = {machines}\n\
                 work = {{ distribution = \"exponential\", mean = \"{} min\" }}\n",
                3 + pick(20)
            );
        }
        for order in 0..1 + pick(4) {
            let (quantity, release) = (1 + pick(12), pick(20));
            text += &format!(
                "[[order]]\nid = \"O{part}{order}\"\npart = \"P{part}\"\nquantity = {quantity}\nrelease = \"{release} h\"\n"
            );
            if pick(2) == 0 {
                text += &format!("transfer = {}\n", 1 + pick(5));
            }
        }
    }
    text
}

/// The sequences of a run as sections of a file.
fn sequences(scenario: &Scenario, log: &RunLog) -> String {
    let mut rows: Vec<_> = log.operations.iter().collect();
    rows.sort_by(|a, b| a.start.total_cmp(&b.start));
    let mut seen = std::collections::BTreeSet::new();
    let mut text = String::new();
    for row in rows {
        let order = log.jobs[row.job as usize].order.unwrap();
        if seen.insert((order, row.operation)) {
            let operation = &scenario.parts[row.part as usize].operations[row.operation as usize].name;
            let (id, machine) = (&scenario.orders[order as usize].id, &scenario.machines[row.machine as usize].name);
            text += &format!("[[schedule]]\norder = \"{id}\"\noperation = \"{operation}\"\nmachine = \"{machine}\"\n");
        }
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn the_own_schedule_of_a_run_gives_the_same_run(seed in 0u64..1_000_000) {
        let text = random_shop(seed);
        let scenario = parse("random.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario;
        let log = run(&scenario, 0, 0).unwrap();
        let planned = text.clone() + &sequences(&scenario, &log);
        let planned = parse("random.toml", &planned, &[]).unwrap_or_else(|error| panic!("{error}\n{planned}")).scenario;
        let again = run(&planned, 0, 0).unwrap();
        let key = |log: &RunLog| {
            let mut rows: Vec<_> = log.operations.iter().map(|row| {
                let order = log.jobs[row.job as usize].order;
                (order, row.operation, row.machine, row.start.to_bits(), row.end.to_bits())
            }).collect();
            rows.sort_unstable();
            rows
        };
        prop_assert!(key(&log) == key(&again), "{}", text);
    }
}
