//! Buffers, blocking and deadlock, through scenario files.

use proptest::prelude::*;
use toolroom_kernel::SimTime;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::{parse, read};
use toolroom_shop::runlog::{JobOutcome, LogEvent, MachineState, RunLog};
use toolroom_shop::{Shop, ShopError, World, run};

/// The shipped line with changes.
fn line(changes: &[&str]) -> Scenario {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/line.toml");
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

/// Parts a minute after an hour.
fn rate(scenario: &Scenario) -> f64 {
    let log = run(scenario, 0, 0).unwrap();
    let counted = log.jobs.iter().filter(|job| job.finish > 3600.0).count();
    counted as f64 / ((log.horizon - 3600.0) / 60.0)
}

/// A shop of plain machines of 5 min each: buffers by machine, routings by part, one part each at time 0.
fn shop(machines: &[(&str, &str)], routings: &[&[&str]], dispatch: &str) -> String {
    use std::fmt::Write;
    let mut text = format!("schema = 1\n[shop]\nname = \"places\"\nhorizon = \"2 h\"\n[dispatch]\n{dispatch}\n");
    for (name, keys) in machines {
        writeln!(text, "[[machine]]\nname = \"{name}\"\nprocess = \"plain\"\n{keys}").unwrap();
    }
    for (number, routing) in routings.iter().enumerate() {
        writeln!(text, "[[part]]\nname = \"P{number}\"").unwrap();
        for (place, machine) in routing.iter().enumerate() {
            let work = "work = \"5 min\"";
            writeln!(text, "[[part.operation]]\nname = \"{place}\"\nmachines = {machine}\n{work}").unwrap();
        }
        writeln!(text, "[[arrivals]]\npart = \"P{number}\"\npattern = \"schedule\"").unwrap();
        writeln!(text, "lot = [{{ time = \"0 h\", size = 1 }}]").unwrap();
    }
    text
}

fn parsed(text: &str) -> Scenario {
    parse("places.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
}

const NONE: &str = "input_buffer = 0";

/// Finishes of the jobs in the order of their release, min.
fn finishes(log: &RunLog) -> Vec<f64> {
    log.jobs.iter().map(|job| job.finish / 60.0).collect()
}

#[test]
fn lines_make_what_their_markov_chains_say() {
    // Hillier and Boling (1967), and the stationary distribution of the chain of each line. Half a percent are
    // some four standard errors of the number of parts of 20 000 hours.
    let mean = |machine: usize, rate: f64| {
        let part = ["first", "second", "third"][machine];
        format!("part.part.operation.{part}.work.mean=\"{} min\"", 1.0 / rate)
    };
    let rates = [mean(0, 1.0), mean(1, 0.8), mean(2, 1.1)];
    let unequal: Vec<&str> = rates.iter().map(String::as_str).collect();
    let buffers = ["machine.B.input_buffer=1", "machine.C.input_buffer=2"];
    let before = "dispatch.blocking=\"before_service\"";
    let ones = ["machine.B.input_buffer=1", "machine.C.input_buffer=1"];
    let twos = ["machine.B.input_buffer=2", "machine.C.input_buffer=2", "arrivals.1.jobs=12"];
    let cases: [(Vec<&str>, f64); 7] = [
        (vec![], 0.564_103),
        (vec![before], 0.4),
        (ones.to_vec(), 0.670_466),
        (twos.to_vec(), 0.734_017),
        ([&unequal[..], &buffers].concat(), 0.640_381),
        ([&unequal[..], &buffers, &[before]].concat(), 0.567_612),
        // A place behind a machine is a place before the next one.
        (vec!["machine.A.output_buffer=1", "machine.B.output_buffer=1"], 0.670_466),
    ];
    for (mut changes, published) in cases {
        changes.push("shop.horizon=\"20000 h\"");
        let rate = rate(&line(&changes));
        assert!((rate / published - 1.0).abs() < 0.005, "{changes:?}: {rate} instead of {published}");
    }
}

#[test]
fn a_part_that_is_done_keeps_its_machine_until_there_is_a_place() {
    // Two parts through A (5 min) and B (5 min, 10 for what comes first): the second waits on A from 10 to 15.
    let text = shop(&[("A", ""), ("B", NONE)], &[&["\"A\"", "\"B\""], &["\"A\"", "\"B\""]], "").replacen(
        "machines = \"B\"\nwork = \"5 min\"",
        "machines = \"B\"\nwork = \"10 min\"",
        1,
    );
    let log = run(&parsed(&text), 0, 0).unwrap();
    assert_eq!(finishes(&log), [15.0, 20.0]);
    let blocked: Vec<_> = log.states.iter().filter(|row| row.state == MachineState::Blocked).collect();
    assert_eq!(blocked.len(), 1);
    assert_eq!((blocked[0].machine, blocked[0].job), (0, Some(1)));
    assert_eq!((blocked[0].start, blocked[0].end), (600.0, 900.0));
    // With a place before B nobody is blocked.
    let log = run(&parsed(&text.replace(NONE, "input_buffer = 1")), 0, 0).unwrap();
    assert!(log.states.iter().all(|row| row.state != MachineState::Blocked));
    assert_eq!(finishes(&log), [15.0, 20.0]);
    // With blocking before service the second part is begun when the first has left B.
    let text = text.replace("[dispatch]", "[dispatch]\nblocking = \"before_service\"");
    let log = run(&parsed(&text), 0, 0).unwrap();
    assert_eq!(finishes(&log), [15.0, 25.0]);
}

fn deadlock(text: &str) -> (f64, String) {
    match run(&parsed(text), 0, 0) {
        Err(ShopError::Deadlock { time, circle }) => (time, circle),
        other => panic!("no deadlock: {:?}", other.map(|log| finishes(&log))),
    }
}

#[test]
fn parts_that_want_each_others_machines_are_named() {
    let machines = [("A", NONE), ("B", NONE), ("C", NONE)];
    let two = shop(&machines, &[&["\"A\"", "\"B\""], &["\"B\"", "\"A\""]], "");
    assert_eq!(deadlock(&two), (300.0, "A holds P0 0 that wants B; B holds P1 1 that wants A".to_owned()));
    let routings: [&[&str]; 3] = [&["\"A\"", "\"B\""], &["\"B\"", "\"C\""], &["\"C\"", "\"A\""]];
    let three = shop(&machines, &routings, "");
    let circle = "A holds P0 0 that wants B; B holds P1 1 that wants C; C holds P2 2 that wants A";
    assert_eq!(deadlock(&three), (300.0, circle.to_owned()));
    // Before service the parts stand before their machines and none can begin.
    let before = three.replace("[dispatch]", "[dispatch]\nblocking = \"before_service\"");
    assert_eq!(deadlock(&before), (0.0, circle.to_owned()));
    // A place in the circle is enough for these three parts; so is to let them change places.
    let placed = three.replacen(NONE, "input_buffer = 1", 1);
    assert_eq!(finishes(&run(&parsed(&placed), 0, 0).unwrap()), [10.0, 10.0, 10.0]);
    let swapped = three.replace("[dispatch]", "[dispatch]\ndeadlock = \"swap\"");
    let scenario = parsed(&swapped);
    let mut shop = Shop::new(&scenario, 0, 0).unwrap();
    shop.run_until(SimTime::from_seconds(3600.0).unwrap()).unwrap();
    assert_eq!(shop.world().flow.swaps, 1);
    let log = shop.run().unwrap();
    assert_eq!(finishes(&log), [10.0, 10.0, 10.0]);
    assert_eq!(log.events.iter().filter(|event| event.event == LogEvent::Swap).count(), 3);
}

#[test]
fn a_circle_with_a_way_out_is_no_deadlock() {
    // P0 on A may go to B or to C, which works on: it waits for C.
    let machines = [("A", NONE), ("B", NONE), ("C", NONE)];
    let routings: [&[&str]; 3] = [&["\"A\"", "[\"B\", \"C\"]"], &["\"B\"", "\"A\""], &["\"C\""]];
    let text = shop(&machines, &routings, "")
        .replace("machines = \"C\"\nwork = \"5 min\"", "machines = \"C\"\nwork = \"30 min\"");
    assert_eq!(finishes(&run(&parsed(&text), 0, 0).unwrap()), [35.0, 35.0, 30.0]);
    // A part that wants its own machine again does not wait for itself.
    let text = shop(&machines, &[&["\"A\"", "\"A\""]], "");
    assert_eq!(finishes(&run(&parsed(&text), 0, 0).unwrap()), [10.0]);
}

#[test]
fn what_can_never_move_is_refused() {
    let machines = [("A", NONE), ("B", NONE)];
    let twice = shop(&machines, &[&["\"A\"", "\"A\""]], "blocking = \"before_service\"");
    let cases = [
        (twice.clone(), "never begin"),
        (twice.replace("[dispatch]", "[dispatch]\ndeadlock = \"swap\""), "deadlock"),
        (twice.replacen(NONE, "output_buffer = 1", 1), "output_buffer"),
        (shop(&machines, &[&["\"A\""]], "") + "[[buffer]]\nname = \"hall\"\nplaces = 2\nbefore = [\"A\"]\n", "hall"),
        (
            shop(&machines, &[&["\"A\""]], "")
                + "[[order]]\nid = \"O1\"\npart = \"P0\"\nquantity = 4\ntransfer = 2\ndue = \"1 h\"\n",
            "several jobs",
        ),
    ];
    for (text, word) in cases {
        let error = parse("places.toml", &text, &[]).expect_err(word).to_string();
        assert!(error.contains(word), "{error}");
    }
}

#[test]
fn machines_share_a_buffer() {
    // One place before B and C together: the second part of A waits in it, the third keeps A.
    let text = shop(
        &[("A", ""), ("B", ""), ("C", "")],
        &[&["\"A\"", "\"B\""], &["\"A\"", "\"B\""], &["\"A\"", "\"C\""], &["\"A\"", "\"C\""]],
        "",
    ) + "[[buffer]]\nname = \"rack\"\nplaces = 1\nbefore = [\"B\", \"C\"]\n";
    let text = text.replacen("machines = \"B\"\nwork = \"5 min\"", "machines = \"B\"\nwork = \"22 min\"", 1);
    // P0 is on B from 5 to 27; P1 takes the place at 10; P2 goes past it to C at 15; P3 is done at 20, when C is free.
    assert_eq!(finishes(&run(&parsed(&text), 0, 0).unwrap()), [27.0, 32.0, 20.0, 25.0]);
}

/// Machines whose parts could never go on even if all that is at work left the shop at once, and whatever can
/// move after it: by trying one move after the other.
fn standing_for_ever(scenario: &Scenario, world: &World) -> Vec<usize> {
    let machines = &scenario.machines;
    let mut blocked: Vec<Option<u32>> = world.machines.iter().map(|machine| machine.blocked).collect();
    let mut buffers = world.flow.buffers.clone();
    let wants = |slot: u32| {
        let job = world.jobs.get(slot).unwrap();
        scenario.parts[job.row.part as usize].operations[job.operation as usize].machines[0]
    };
    let room = |buffers: &[Vec<u32>], buffer: usize| buffers[buffer].len() < scenario.buffers[buffer].places as usize;
    loop {
        let free = |machine: usize| blocked[machine].is_none();
        let enters = |slot: u32| {
            free(wants(slot)) || machines[wants(slot)].input_buffer.is_none_or(|input| room(&buffers, input))
        };
        let on_machine = |machine: &usize| {
            blocked[*machine].is_some_and(|slot| {
                wants(slot) == *machine
                    || enters(slot)
                    || machines[*machine].output_buffer.is_some_and(|output| room(&buffers, output))
            })
        };
        if let Some(machine) = (0..machines.len()).find(on_machine) {
            blocked[machine] = None;
            continue;
        }
        let moves =
            |slot: &u32| if world.jobs.get(*slot).unwrap().waiting { free(wants(*slot)) } else { enters(*slot) };
        let Some((buffer, slot)) = buffers
            .iter()
            .enumerate()
            .find_map(|(buffer, standing)| standing.iter().copied().find(moves).map(|slot| (buffer, slot)))
        else {
            return (0..machines.len()).filter(|machine| blocked[*machine].is_some()).collect();
        };
        buffers[buffer].retain(|other| *other != slot);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// A random shop with small buffers ends, or names a deadlock; no part is lost.
    #[test]
    fn random_shops_end_or_name_a_deadlock(
        places in prop::collection::vec(0u32..3, 4),
        behind in prop::collection::vec(prop::option::of(0u32..2), 4),
        routes in prop::collection::vec(prop::collection::vec(0usize..4, 1..5), 1..9),
        swap: bool,
        before: bool,
    ) {
        const NAMES: [&str; 4] = ["A", "B", "C", "D"];
        let quoted: Vec<String> = NAMES.iter().map(|name| format!("\"{name}\"")).collect();
        let keys: Vec<String> = places.iter().zip(&behind).map(|(places, behind)| {
            let buffer = format!("input_buffer = {places}");
            behind.filter(|_| !before).map_or(buffer.clone(), |behind| format!("{buffer}\noutput_buffer = {behind}"))
        }).collect();
        let machines: Vec<(&str, &str)> = NAMES.iter().copied().zip(keys.iter().map(String::as_str)).collect();
        let routings: Vec<Vec<&str>> =
            routes.iter().map(|route| route.iter().map(|&machine| quoted[machine].as_str()).collect()).collect();
        let routings: Vec<&[&str]> = routings.iter().map(Vec::as_slice).collect();
        let dispatch = match (before, swap) {
            (true, _) => "blocking = \"before_service\"",
            (false, true) => "deadlock = \"swap\"",
            (false, false) => "",
        };
        let text = shop(&machines, &routings, dispatch);
        let Ok(file) = parse("places.toml", &text, &[]) else { return Ok(()) }; // a part in its own way
        let scenario = file.scenario;
        match run(&scenario, 0, 0) {
            Ok(log) => {
                // Eight parts of four operations need at most 160 min one after the other.
                prop_assert!(log.jobs.iter().all(|job| job.outcome == JobOutcome::Good || job.finish.is_nan()));
                let open = log.jobs.iter().filter(|job| job.finish.is_nan()).count();
                let working = log.states.iter().filter(|row| row.state == MachineState::Working && row.end == log.horizon);
                prop_assert!(open == 0 || working.count() > 0, "stands still without a word\n{text}");
                for machine in 0..4 {
                    let total: f64 =
                        log.states.iter().filter(|row| row.machine == machine).map(|row| row.end - row.start).sum();
                    prop_assert!((total - log.horizon).abs() < 1e-9);
                }
            }
            Err(ShopError::Deadlock { circle, .. }) => {
                prop_assert!(!swap || before);
                if !before {
                    let mut shop = Shop::new(&scenario, 0, 0).unwrap();
                    shop.run_until(SimTime::from_seconds(scenario.horizon).unwrap()).unwrap_err();
                    let never = standing_for_ever(&scenario, shop.world());
                    for words in circle.split("; ") {
                        let machine = NAMES.iter().position(|name| words.starts_with(name)).unwrap();
                        prop_assert!(never.contains(&machine), "{circle}\n{text}");
                    }
                }
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }
}
