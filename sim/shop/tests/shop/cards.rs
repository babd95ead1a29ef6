//! Random shops with cards and limited buffers, and tables in another order.

use proptest::prelude::*;
use toolroom_scenario_file::parse;
use toolroom_shop::runlog::LogEvent;
use toolroom_shop::{RunLog, ShopError};

const STATIONS: [&str; 4] = ["A", "B", "C", "D"];

/// A shop of four stations: routings, jobs of each part there from the start, cards of loops from a station to another.
#[derive(Clone, Debug)]
struct Draw {
    routes: Vec<Vec<usize>>,
    jobs: u32,
    loops: Vec<(usize, usize, u32)>,
    buffers: [Option<u32>; 4],
    rework: bool,
    rule: &'static str,
}

fn draws() -> impl Strategy<Value = Draw> {
    let routes = prop::collection::vec(prop::collection::vec(0usize..4, 1..5), 1..4);
    let loops = prop::collection::vec((0usize..4, 0usize..4, 1u32..4), 1..4);
    let buffer = || prop_oneof![3 => Just(None), 1 => (0u32..3).prop_map(Some)];
    let rule = prop::sample::select(vec!["fifo", "spt", "edd", "atc", "pt_winq", "cr"]);
    let buffers = [buffer(), buffer(), buffer(), buffer()];
    (routes, 1u32..9, loops, buffers, any::<bool>(), rule)
        .prop_map(|(routes, jobs, loops, buffers, rework, rule)| Draw { routes, jobs, loops, buffers, rework, rule })
}

impl Draw {
    fn text(&self) -> String {
        let mut text = "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"2000 h\"\n".to_owned();
        for (station, buffer) in STATIONS.iter().zip(self.buffers) {
            text += &format!("[[machine]]\nname = \"{station}\"\nprocess = \"plain\"\n");
            text += &buffer.map_or_else(String::new, |places| format!("input_buffer = {places}\n"));
        }
        for (index, route) in self.routes.iter().enumerate() {
            text += &format!("[[part]]\nname = \"P{index}\"\n");
            for (place, station) in route.iter().enumerate() {
                text += &format!(
                    "[[part.operation]]\nname = \"{place}\"\nmachines = \"{}\"\nwork = {{ distribution = \"exponential\", mean = \"5 min\" }}\n",
                    STATIONS[*station]
                );
                if self.rework && place == 1 {
                    text += "outcomes = [{ share = 0.2, go = \"0\" }]\n";
                }
            }
            text += &format!(
                "[[arrivals]]\npart = \"P{index}\"\npattern = \"schedule\"\nlot = [{{ time = \"0 h\", size = {} }}]\n",
                self.jobs
            );
        }
        for (index, (from, to, cards)) in self.loops.iter().enumerate() {
            text += &format!(
                "[[loop]]\nname = \"L{index}\"\nfrom = \"{}\"\nto = \"{}\"\ncards = {cards}\n",
                STATIONS[*from], STATIONS[*to]
            );
        }
        text + &format!("[dispatch]\nrule = \"{}\"\n", self.rule)
    }
}

/// Most cards that jobs had at a time.
fn most_cards(log: &RunLog) -> i64 {
    let change = |event: LogEvent| match event {
        LogEvent::Card => 1,
        LogEvent::CardReturn => -1,
        _ => 0,
    };
    let counts = log.events.iter().scan(0, |count, row| {
        *count += change(row.event);
        Some(*count)
    });
    counts.max().unwrap_or(0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn shops_with_cards_finish_all_work_or_name_a_deadlock(draw in draws()) {
        let Ok(file) = parse("scenario.toml", &draw.text(), &[]) else { return Ok(()) }; // a loop that nobody passes
        match toolroom_shop::run(&file.scenario, 0, 0) {
            Ok(log) => {
                let all = draw.jobs as usize * draw.routes.len();
                prop_assert_eq!(log.jobs.len(), all);
                prop_assert_eq!(log.jobs.iter().filter(|job| job.finish.is_finite()).count(), all, "{}", draw.text());
                if let [(_, _, cards)] = draw.loops[..] {
                    prop_assert!(most_cards(&log) <= i64::from(cards));
                }
                let count = |event: LogEvent| log.events.iter().filter(|row| row.event == event).count();
                prop_assert!(count(LogEvent::CardReturn) >= count(LogEvent::Card), "every card comes back");
            }
            Err(ShopError::Deadlock { .. }) => prop_assert!(draw.buffers.iter().any(Option::is_some)),
            // Cards of one loop alone lock only with places.
            Err(ShopError::CardDeadlock { .. }) => {
                prop_assert!(draw.loops.len() > 1 || draw.buffers.iter().any(Option::is_some), "{}", draw.text());
            }
            Err(other) => prop_assert!(false, "{other}: {}", draw.text()),
        }
    }
}

#[test]
fn tables_in_another_order_give_the_same_results() {
    let work = |mean: u32| format!("work = {{ distribution = \"gamma\", mean = \"{mean} min\", cv = 0.7 }}");
    let machine = |name: &str| format!("[[machine]]\nname = \"{name}\"\nprocess = \"plain\"\nsetup_time = \"2 min\"\n");
    let operation = |station: &str, mean: u32| {
        format!("[[part.operation]]\nname = \"{station}\"\nmachines = \"{station}\"\n{}\n", work(mean))
    };
    let part = |name: &str, route: &[(&str, u32)]| {
        let operations: String = route.iter().map(|(station, mean)| operation(station, *mean)).collect();
        format!("[[part]]\nname = \"{name}\"\nflow_allowance = \"2 h\"\n{operations}")
    };
    let card =
        |station: &str| format!("[[loop]]\nname = \"{station}\"\nfrom = \"{station}\"\ncards = 3\nrule = \"spt\"\n");
    let machines = ["A", "B", "C"].map(machine);
    let parts = [
        part("p", &[("A", 4), ("B", 5), ("C", 3)]),
        part("q", &[("C", 5), ("A", 4)]),
        part("r", &[("B", 3), ("C", 4), ("A", 2)]),
    ];
    let cards = [card("A"), card("C")];
    let arrivals: String = ["p", "q", "r"]
        .iter()
        .map(|name| format!("[[arrivals]]\npart = \"{name}\"\npattern = \"poisson\"\nrate = \"3 1/h\"\nweight = 2\n"))
        .collect();
    let rest = "[release]\nrule = \"workload\"\nnorm = \"1 h\"\nevery = \"20 min\"\n[dispatch]\n\
                rule = \"atcs\"\nslack_by = \"operation\"\n";
    let results = |back: bool, rule: &str| {
        let joined = |tables: &[String]| -> String {
            if back { tables.iter().rev().cloned().collect() } else { tables.concat() }
        };
        let head = "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"300 h\"\n";
        let text = format!("{head}{}{}{arrivals}{}{rest}", joined(&machines), joined(&parts), joined(&cards));
        let file = parse("scenario.toml", &text, &[format!("dispatch.rule=\"{rule}\"")])
            .unwrap_or_else(|error| panic!("{error}"));
        let log = toolroom_shop::run(&file.scenario, 0, 0).unwrap();
        let name = |part: u32| file.scenario.parts[part as usize].name.clone();
        let mut jobs: Vec<(u64, String, u64)> =
            log.jobs.iter().map(|job| (job.arrival.to_bits(), name(job.part), job.finish.to_bits())).collect();
        jobs.sort();
        assert!(jobs.len() > 2500);
        jobs
    };
    // Rules that look at the next queue are left out: what they see within an instant hangs on who chooses first, and machines
    // choose in the order of the file.
    for rule in ["atcs", "atc", "covert", "sst", "mod"] {
        assert!(results(false, rule) == results(true, rule), "{rule}");
    }
}

#[test]
fn a_part_that_waits_for_a_card_on_a_machine_locks_those_who_want_that_machine() {
    // One is done at B and wants C, one waits at B; both have cards of B. A third is done at C, stays there and wants one.
    let draw = Draw {
        routes: vec![vec![2, 1, 2]],
        jobs: 5,
        loops: vec![(1, 1, 2)],
        buffers: [None, None, Some(0), None],
        rework: false,
        rule: "fifo",
    };
    let file = parse("scenario.toml", &draw.text(), &[]).unwrap_or_else(|error| panic!("{error}"));
    match toolroom_shop::run(&file.scenario, 0, 0) {
        Err(ShopError::CardDeadlock { circle, .. }) => assert!(circle.contains("wants a card of \"L0\""), "{circle}"),
        other => panic!("no deadlock: {:?}", other.map(|log| log.jobs.len())),
    }
    // With a place before C the one at B moves on.
    let file = parse("scenario.toml", &draw.text(), &["machine.C.input_buffer=5".to_owned()]).unwrap();
    let log = toolroom_shop::run(&file.scenario, 0, 0).unwrap();
    assert!(log.jobs.iter().all(|job| job.finish.is_finite()));
}

/// Nobody chooses a machine for a card: with `setup_in_key` the work alone orders a backlog, whatever any machine stands ready for.
#[test]
fn a_backlog_does_not_look_at_setups() {
    let part = |name: &str, minutes: u32, group: &str| {
        format!(
            "[[part]]\nname = \"{name}\"\n[[part.operation]]\nname = \"o\"\nmachines = \"B\"\nwork = \"{minutes} min\"\n\
             setup_group = \"{group}\"\nsetup_time = \"20 min\"\n[[arrivals]]\npart = \"{name}\"\npattern = \"schedule\"\n\
             lot = [{{ time = \"{} min\", size = 1 }}]\n",
            u32::from(name != "first"),
        )
    };
    let text = format!(
        "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"10 h\"\n[dispatch]\nrule = \"spt\"\nsetup_in_key = true\n\
         [[machine]]\nname = \"A\"\nprocess = \"plain\"\nsetup_at_start = \"long\"\n\
         [[machine]]\nname = \"B\"\nprocess = \"plain\"\nsetup_at_start = \"first\"\n{}{}{}\
         [[loop]]\nname = \"one\"\nfrom = \"B\"\ncards = 1\n",
        part("first", 30, "first"),
        part("long", 6, "long"),
        part("short", 5, "short"),
    );
    let scenario = parse("t.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario;
    let log = toolroom_shop::run(&scenario, 0, 0).unwrap();
    let finish = |part: u32| log.jobs.iter().find(|job| job.part == part).map(|job| job.finish);
    assert!(finish(2) < finish(1), "the short job has the card first: {:?} {:?}", finish(2), finish(1));
}
