//! Fixtures and pallets: as servers, as cards of a closed line, by hand, and where jobs wait for each other.

use proptest::prelude::*;
use std::fmt::Write;
use toolroom_kernel::SimTime;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::runlog::{JobOutcome, MachineState, RunLog};
use toolroom_shop::{Shop, ShopError, World, run};

fn parsed(text: &str) -> Scenario {
    parse("fixtures.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
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

/// Identical machines to which jobs come at random; `fixture` goes into their operation.
fn station(machines: u32, fixture: &str) -> String {
    format!(
        "schema = 1\n[shop]\nname = \"vices\"\nhorizon = \"20000 h\"\n[[fixture]]\nname = \"vice\"\ncount = 2\n\
         [[machine]]\nname = \"M\"\ncount = {machines}\nprocess = \"plain\"\n\
         [[part]]\nname = \"job\"\n[[part.operation]]\nname = \"do\"\nmachines = \"M\"\n{fixture}\n\
         work = {{ distribution = \"exponential\", mean = \"10 min\" }}\n\
         [[arrivals]]\npart = \"job\"\npattern = \"poisson\"\nrate = \"9.6 1/h\"\n"
    )
}

#[test]
fn machines_with_fewer_fixtures_serve_as_many_jobs_as_there_are_fixtures() {
    let with = run(&parsed(&station(5, "fixture = \"vice\"")), 0, 0).unwrap();
    let plain = station(2, "").replace("[[fixture]]\nname = \"vice\"\ncount = 2\n", "");
    let servers = run(&parsed(&plain), 0, 0).unwrap();
    assert!(finishes(&with).len() > 100_000);
    for (own, other) in with.jobs.iter().zip(&servers.jobs) {
        assert!(own.finish == other.finish || own.finish.is_nan() && other.finish.is_nan());
    }
    // Erlang: two servers at a load of 0.8 let a job wait (2·0.8²/1.8)·10/(2·0.2) min on average.
    let waits: Vec<f64> =
        with.jobs.iter().filter(|job| job.start.is_finite()).map(|job| job.start - job.arrival).collect();
    let mean = waits.iter().sum::<f64>() / waits.len() as f64 / 60.0;
    let exact = 2.0 * 0.64 / 1.8 * 10.0 / 0.4;
    assert!((mean / exact - 1.0).abs() < 0.03, "{mean} instead of {exact}");
    // What is idle with work for which no vice is free says so.
    // The first two machines of the file take them first.
    assert!((2..5).all(|machine| !minutes(&with, machine, MachineState::WaitingFixture).is_empty()));
}

/// A line of four stations; `pallets` in front, `first` into its first operation, and how jobs come.
fn line(pallets: &str, first: &str, arrivals: &str) -> String {
    let mut text =
        format!("schema = 1\n[shop]\nname = \"line\"\nhorizon = \"5000 h\"\n{pallets}\n[[part]]\nname = \"job\"\n");
    for (name, mean, keys) in [("a", 10, first), ("b", 12, ""), ("c", 8, ""), ("d", 6, "")] {
        writeln!(text, "[[part.operation]]\nname = \"{name}\"\nmachines = \"{name}\"\n{keys}").unwrap();
        writeln!(text, "work = {{ distribution = \"exponential\", mean = \"{mean} min\" }}").unwrap();
    }
    for name in ["a", "b", "c", "d"] {
        writeln!(text, "[[machine]]\nname = \"{name}\"\nprocess = \"plain\"").unwrap();
    }
    text + "[[arrivals]]\npart = \"job\"\n" + arrivals
}

#[test]
fn pallets_that_travel_hold_the_work_in_a_line_as_cards_do() {
    let cards = run(&parsed(&line("", "", "pattern = \"constant_work\"\njobs = 6\n")), 0, 0).unwrap();
    let text = line(
        "[[fixture]]\nname = \"pallet\"\ncount = 6",
        "fixture = \"pallet\"\nhold = \"until d\"",
        "pattern = \"schedule\"\nlot = [{ time = \"0 h\", size = 400 }]\n",
    );
    let pallets = run(&parsed(&text), 0, 0).unwrap();
    for (own, card) in pallets.jobs.iter().zip(&cards.jobs) {
        assert!(own.finish.is_finite() && own.finish == card.finish, "{} {}", own.finish, card.finish);
    }
    // Four exponential stations in a circle with six cards (Gordon and Newell 1967): .0699878 a minute.
    let done = cards.jobs.iter().filter(|job| job.finish.is_finite()).count() as f64;
    let rate = done / (cards.horizon / 60.0);
    assert!((rate / 0.069_987_8 - 1.0).abs() < 0.02, "{rate}");
}

/// Plain machines of 5 min for each operation; an operation is machine, keys. One part each at time 0.
fn shop(before: &str, machines: &[(&str, &str)], routings: &[&[(&str, &str)]]) -> String {
    let mut text = format!("schema = 1\n[shop]\nname = \"fixtures\"\nhorizon = \"3 h\"\n{before}\n");
    for (name, keys) in machines {
        writeln!(text, "[[machine]]\nname = \"{name}\"\nprocess = \"plain\"\n{keys}").unwrap();
    }
    for (number, routing) in routings.iter().enumerate() {
        writeln!(text, "[[part]]\nname = \"P{number}\"").unwrap();
        for (place, (machine, keys)) in routing.iter().enumerate() {
            writeln!(text, "[[part.operation]]\nname = \"o{place}\"\nmachines = \"{machine}\"").unwrap();
            writeln!(text, "work = \"5 min\"\n{keys}").unwrap();
        }
        writeln!(text, "[[arrivals]]\npart = \"P{number}\"\npattern = \"schedule\"").unwrap();
        writeln!(text, "lot = [{{ time = \"0 h\" }}]").unwrap();
    }
    text
}

const VICE: &str = "[[fixture]]\nname = \"vice\"";
const TWO: &str = "[[fixture]]\nname = \"vice\"\n[[fixture]]\nname = \"pallet\"";

#[test]
fn a_machine_takes_other_work_while_a_fixture_is_elsewhere() {
    // P0 has the vice on A; P1 waits for it before B, and B does P2 meanwhile, then waits from 5 min on for nothing.
    let routings: [&[(&str, &str)]; 3] =
        [&[("A", "fixture = \"vice\"\nsetup_time = \"4 min\"")], &[("B", "fixture = \"vice\"")], &[("B", "")]];
    let text = shop(VICE, &[("A", "setup_at_start = \"\""), ("B", "")], &routings);
    let log = run(&parsed(&text), 0, 0).unwrap();
    assert_eq!(finishes(&log), [9.0, 14.0, 5.0]);
    assert_eq!(minutes(&log, 1, MachineState::WaitingFixture), [(5.0, 9.0)]);
    assert_eq!(minutes(&log, 0, MachineState::WaitingFixture), []);
}

#[test]
fn nobody_holds_a_fixture_while_waiting_for_a_person() {
    // The setter is at C until 20 min. P1 needs him and the vice: it leaves the vice to P2, which needs nobody.
    let people = "[[operator]]\nname = \"setter\"\nskills = [\"setup\"]\n[dispatch]\nrule = \"fifo\"\n";
    let needs = "fixture = \"vice\"\noperator = { run = \"setup\" }";
    let routings: [&[(&str, &str)]; 3] =
        [&[("C", "operator = { run = \"setup\" }")], &[("A", needs)], &[("B", "fixture = \"vice\"")]];
    let text = shop(&format!("{people}{VICE}"), &[("C", ""), ("A", ""), ("B", "")], &routings).replacen(
        "work = \"5 min\"",
        "work = \"20 min\"",
        1,
    );
    let log = run(&parsed(&text), 0, 0).unwrap();
    assert_eq!(finishes(&log), [20.0, 25.0, 5.0]);
    assert_eq!(minutes(&log, 1, MachineState::WaitingOperator), [(0.0, 20.0)]);
}

#[test]
fn a_fixture_that_travels_is_free_when_its_last_operation_is_over() {
    let keys = "fixture = \"vice\"\nhold = \"until o1\"";
    let routing: &[(&str, &str)] = &[("A", keys), ("B", ""), ("C", "")];
    let log = run(&parsed(&shop(VICE, &[("A", ""), ("B", ""), ("C", "")], &[routing, routing])), 0, 0).unwrap();
    // The second begins when the first has left B, at 10 min, and not when it has left A.
    assert_eq!(finishes(&log), [15.0, 25.0]);
    assert_eq!(minutes(&log, 0, MachineState::WaitingFixture), [(5.0, 10.0)]);
}

fn deadlock(text: &str) -> (f64, String) {
    match run(&parsed(text), 0, 0) {
        Err(ShopError::FixtureDeadlock { time, circle }) => (time, circle),
        other => panic!("no deadlock: {:?}", other.map(|log| finishes(&log))),
    }
}

#[test]
fn jobs_that_hold_what_the_other_needs_are_named() {
    let holds = |name: &str| format!("fixture = \"{name}\"\nhold = \"until o1\"");
    let needs = |name: &str| format!("fixture = \"{name}\"");
    let [vice, pallet] = ["vice", "pallet"].map(holds);
    let [then_vice, then_pallet] = ["vice", "pallet"].map(needs);
    let routings: [&[(&str, &str)]; 2] = [&[("A", &vice), ("C", &then_pallet)], &[("B", &pallet), ("C", &then_vice)]];
    let text = shop(TWO, &[("A", ""), ("B", ""), ("C", "")], &routings);
    let circle = "P0 0 holds \"vice\" and wants \"pallet\"; P1 1 holds \"pallet\" and wants \"vice\"";
    assert_eq!(deadlock(&text), (300.0, circle.to_owned()));
    // One more of either is enough.
    let more = text.replacen("name = \"vice\"", "name = \"vice\"\ncount = 2", 1);
    assert_eq!(finishes(&run(&parsed(&more), 0, 0).unwrap()), [15.0, 10.0]);
}

#[test]
fn places_and_fixtures_may_close_one_circle() {
    // P0 has the pallet and keeps A, because B has no place; P1 keeps B, and needs the pallet before it goes to A.
    let holds = "fixture = \"pallet\"\nhold = \"until o1\"";
    let routings: [&[(&str, &str)]; 2] = [&[("A", holds), ("B", "")], &[("B", ""), ("C", "fixture = \"pallet\"")]];
    let none = "input_buffer = 0";
    let text =
        shop(TWO, &[("A", none), ("B", none), ("C", none)], &routings).replace("[[fixture]]\nname = \"vice\"\n", "");
    let circle = "B holds P1 1 that wants \"pallet\"; P0 0 holds \"pallet\" and wants B";
    assert_eq!(deadlock(&text), (300.0, circle.to_owned()));
    // A place before C lets P1 leave B.
    let placed = text.replace(
        "name = \"C\"\nprocess = \"plain\"\ninput_buffer = 0",
        "name = \"C\"\nprocess = \"plain\"\ninput_buffer = 1",
    );
    assert_eq!(finishes(&run(&parsed(&placed), 0, 0).unwrap()), [10.0, 15.0]);
}

#[test]
fn an_urgent_job_takes_over_the_fixture_with_the_machine() {
    let before = format!("[dispatch]\nrule = [\"priority\", \"fifo\"]\npreempt = \"resume\"\n{VICE}");
    let keys: &[(&str, &str)] = &[("A", "fixture = \"vice\"")];
    let text = shop(&before, &[("A", "")], &[keys, keys]).replace(
        "part = \"P1\"\npattern = \"schedule\"\nlot = [{ time = \"0 h\" }]",
        "part = \"P1\"\npriority = 0\npattern = \"schedule\"\nlot = [{ time = \"2 min\" }]",
    );
    let text = text.replace("part = \"P0\"\n", "part = \"P0\"\npriority = 1\n");
    assert_eq!(finishes(&run(&parsed(&text), 0, 0).unwrap()), [10.0, 7.0]);
}

#[test]
fn what_fixtures_cannot_do_is_refused() {
    let keys = "fixture = \"vice\"\nhold = \"until o1\"";
    let routing: &[(&str, &str)] = &[("A", keys), ("B", "")];
    let text = shop(VICE, &[("A", ""), ("B", "")], &[routing]);
    assert!(parse("fixtures.toml", &text, &[]).is_ok());
    let order = "[[order]]\nid = \"O1\"\npart = \"P0\"\nquantity = 4\ntransfer = 2\ndue = \"1 h\"\n";
    let cases = [
        (text.replace("fixture = \"vice\"", "fixture = \"vise\""), "vice"),
        (text.replace("until o1", "until o7"), "o7"),
        (text.replace("until o1", "for ever"), "until wash"),
        (text.replace("fixture = \"vice\"\n", ""), "names none"),
        (text.replace("machines = \"B\"", "machines = \"B\"\nfixture = \"vice\""), "still holds"),
        (text.replace("machines = \"B\"", "machines = \"B\"\nfixture = \"vice\"\nhold = \"until o0\""), "before it"),
        (text.replace(keys, ""), "needed by no operation"),
        (
            text.replace("name = \"B\"\nprocess = \"plain\"", "name = \"B\"\nprocess = \"plain\"\nbatch = { max = 2 }"),
            "batch",
        ),
        (text.clone() + order, "several jobs"),
    ];
    for (text, word) in cases {
        let error = parse("fixtures.toml", &text, &[]).expect_err(word).to_string();
        assert!(error.contains(word), "{word}: {error}");
    }
}

/// Jobs in queues that could never be begun even if everything at work were over at once, and all that can move after it.
fn waiting_for_ever(scenario: &Scenario, world: &World) -> Vec<u32> {
    let mut left: Vec<(u32, usize, usize)> = world
        .jobs
        .iter()
        .filter(|job| job.waiting)
        .map(|job| (job.number, job.row.part as usize, job.operation as usize))
        .collect();
    loop {
        let free = |fixture: usize, but: u32| {
            let fixture = &scenario.shared.fixtures[fixture];
            let holds = |(number, part, operation): &(u32, usize, usize)| {
                *number != but
                    && fixture.holds.iter().any(|hold| hold.contains(*part, *operation) && *operation > hold.from)
            };
            left.iter().filter(|job| holds(job)).count() < fixture.count as usize
        };
        let begins = |(number, part, operation): &(u32, usize, usize)| {
            (0..scenario.shared.fixtures.len()).all(|index| {
                let needs = |hold: &toolroom_scenario::Hold| hold.part == *part && hold.from == *operation;
                !scenario.shared.fixtures[index].holds.iter().any(needs) || free(index, *number)
            })
        };
        let Some(next) = left.iter().position(begins) else { return left.iter().map(|job| job.0).collect() };
        left.remove(next);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Jobs that travel with fixtures all end, or a circle is named whose jobs can indeed never move.
    #[test]
    fn random_pallets_end_or_name_a_deadlock(
        counts in prop::collection::vec(1u32..3, 3),
        routes in prop::collection::vec(prop::collection::vec((0usize..3, 0usize..6, 0usize..3), 2..5), 2..8),
    ) {
        const NAMES: [&str; 3] = ["A", "B", "C"];
        let before: String = counts.iter().enumerate().map(|(index, count)| {
            format!("[[fixture]]\nname = \"F{index}\"\ncount = {count}\n")
        }).collect();
        let mut needed = [false; 3];
        let routings: Vec<Vec<(&str, String)>> = routes.iter().map(|route| {
            let mut until = [None; 3];
            route.iter().enumerate().map(|(place, &(machine, fixture, length))| {
                let free = fixture < 3 && until[fixture].is_none_or(|until| until < place);
                let keys = if free {
                    let last = (place + length).min(route.len() - 1);
                    until[fixture] = Some(last);
                    needed[fixture] = true;
                    format!("fixture = \"F{fixture}\"\nhold = \"until o{last}\"")
                } else {
                    String::new()
                };
                (NAMES[machine], keys)
            }).collect()
        }).collect();
        if needed.contains(&false) {
            return Ok(());
        }
        let routings: Vec<Vec<(&str, &str)>> =
            routings.iter().map(|route| route.iter().map(|(machine, keys)| (*machine, keys.as_str())).collect()).collect();
        let routings: Vec<&[(&str, &str)]> = routings.iter().map(Vec::as_slice).collect();
        let text = shop(&before, &[("A", ""), ("B", ""), ("C", "")], &routings);
        let scenario = parsed(&text);
        match run(&scenario, 0, 0) {
            // Seven parts of four operations need at most 140 min one after the other.
            Ok(log) => prop_assert!(log.jobs.iter().all(|job| job.outcome == JobOutcome::Good), "stands still\n{text}"),
            Err(ShopError::FixtureDeadlock { circle, .. }) => {
                let mut shop = Shop::new(&scenario, 0, 0).unwrap();
                shop.run_until(SimTime::from_seconds(scenario.horizon).unwrap()).unwrap_err();
                let never = waiting_for_ever(&scenario, shop.world());
                for words in circle.split("; ") {
                    let number: u32 = words.split(' ').nth(1).unwrap().parse().unwrap();
                    prop_assert!(never.contains(&number), "{circle}\n{text}");
                }
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }
}
