//! Orders that are split, transferred in batches and set up for ahead: nothing is lost, and everything ends, whatever else
//! happens in the shop.

use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_kernel::SimTime;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::Shop;
use toolroom_shop::runlog::{JobOutcome, MachineState, OperationRow, RunLog};

/// A random shop of plain machines whose orders have every lot rule.
fn random_shop(seed: u64) -> String {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut pick = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    // An inspection that sends pieces back excludes setting up ahead.
    let sends_back = pick(3) == 0;
    let people = pick(3) == 0;
    let fixtures = pick(3) == 0;
    let (mut vices, mut pallets) = (false, false);
    let cribs = pick(3) == 0;
    let mut worn = false;
    let rule = ["fifo", "spt", "atc", "least_setup", "edd"][pick(5) as usize];
    let mut text = format!(
        "schema = 1\n[shop]\nname = \"random\"\nseed = {}\nhorizon = \"2000 h\"\n[dispatch]\nrule = \"{rule}\"\n\
         machine_choice = \"{}\"\n",
        seed + 1,
        ["least_setup", "first", "longest_idle"][pick(3) as usize],
    );
    // What is begun anew at the end of a shift and needs longer than one never ends.
    let at_end = ["resume", "finish", "scrap"][pick(3) as usize];
    write!(
        text,
        "[[calendar]]\nname = \"day\"\nperiod = \"10 h\"\nat_end = \"{at_end}\"\nshift = [{{ start = \"1 h\", end = \"9 h\" }}]\n"
    )
    .unwrap();
    if people {
        writeln!(text, "[[operator]]\nname = \"setter\"\nskills = [\"setup\"]\ncalendar = \"day\"").unwrap();
        if pick(2) == 0 {
            writeln!(
                text,
                "walk = {{ locations = [\"M0\", \"M1\", \"M2\"], times = [[\"0 min\", \"2 min\", \"5 min\"], \
                 [\"2 min\", \"0 min\", \"3 min\"], [\"5 min\", \"3 min\", \"0 min\"]] }}"
            )
            .unwrap();
        }
    }
    for _ in 0..pick(3) {
        let clock = ["busy", "calendar"][pick(2) as usize];
        let window = if pick(2) == 0 { "window = \"day\"" } else { "" };
        writeln!(
            text,
            "[[maintenance]]\nmachines = \"M{}\"\nevery = \"{} h\"\nclock = \"{clock}\"\nduration = \"{} min\"\n{window}",
            pick(3),
            5 + pick(40),
            5 + 10 * pick(9)
        )
        .unwrap();
    }
    let mut counts = [0; 3];
    for (group, count) in counts.iter_mut().enumerate() {
        *count = 1 + pick(4);
        writeln!(
            text,
            "[[machine]]\nname = \"M{group}\"\ncount = {}\nprocess = \"plain\"\nsetup_at_start = \"\"\nsetup_time = \"{} min\"",
            *count,
            10 * pick(4)
        )
        .unwrap();
        if pick(2) == 0 {
            writeln!(text, "calendar = \"day\"").unwrap();
        }
    }
    for part in 0..3 {
        writeln!(text, "[[part]]\nname = \"P{part}\"").unwrap();
        // What travels with a pallet is one job.
        let travels = fixtures && pick(3) == 0;
        for operation in 0..1 + pick(4) {
            let machines = ["\"M0\"", "\"M1\"", "\"M2\"", "[\"M0\", \"M2\"]"][pick(4) as usize];
            writeln!(
                text,
                "[[part.operation]]\nname = \"o{operation}\"\nmachines = {machines}\n\
                 work = {{ distribution = \"exponential\", mean = \"{} min\" }}",
                3 + pick(20)
            )
            .unwrap();
            if people && pick(2) == 0 {
                let step = match pick(6) {
                    0 => "run = \"setup\"",
                    1 => "run = { skill = \"setup\", share = 0.4 }",
                    2 => "run = { skill = \"setup\", first = \"2 min\" }",
                    _ => "setup = \"setup\"",
                };
                writeln!(text, "operator = {{ {step} }}").unwrap();
            }
            if cribs && machines == "\"M1\"" {
                writeln!(text, "tool = \"drill\"").unwrap();
                worn = true;
            }
            if travels && operation == 0 {
                writeln!(text, "fixture = \"pallet\"\nhold = \"until LAST{part}\"").unwrap();
                pallets = true;
            } else if fixtures && pick(3) == 0 {
                writeln!(text, "fixture = \"vice\"").unwrap();
                vices = true;
            }
            match pick(5) {
                0 if sends_back => {
                    let go = pick(operation + 1);
                    writeln!(text, "outcomes = [{{ share = 0.2, go = \"o{go}\" }}]\nrework_max = 2").unwrap();
                }
                1 => writeln!(text, "outcomes = [{{ share = 0.1, scrap = true }}]").unwrap(),
                _ => {}
            }
        }
        let last = text.rfind("name = \"o").map_or(String::new(), |at| text[at + 8..at + 10].to_owned());
        text = text.replace(&format!("LAST{part}"), &last);
        for order in 0..1 + pick(4) {
            writeln!(
                text,
                "[[order]]\nid = \"O{part}{order}\"\npart = \"P{part}\"\nquantity = {}\nrelease = \"{} h\"\nsetup_ahead = {}",
                if travels { 1 } else { 1 + pick(12) },
                pick(20),
                !travels && !sends_back && pick(2) == 0
            )
            .unwrap();
            if travels {
                continue;
            }
            match pick(4) {
                0 => writeln!(text, "split = \"all\"").unwrap(),
                1 => writeln!(text, "split = {}", 1 + pick(4)).unwrap(),
                _ => {}
            }
            if pick(2) == 0 {
                writeln!(text, "transfer = {}", 1 + pick(5)).unwrap();
            }
        }
    }
    if worn {
        let life = 10 + pick(60);
        writeln!(
            text,
            "[[tool]]\nname = \"drill\"\nprocess = \"life_only\"\nedge_cost = \"9 EUR\"\n\
             life = {{ distribution = \"exponential\", mean = \"{life} min\" }}"
        )
        .unwrap();
        let batch = 1 + pick(2);
        // One stays in every machine, and worn ones wait for a whole batch.
        let edges = counts[1] + batch - 1 + pick(2);
        // Where work is scrapped at the end of a shift, edges that are ground then are lost.
        let station = if pick(2) == 0 && at_end != "scrap" { "station = \"M2\", " } else { "" };
        let back = match pick(3) {
            0 => "buy = { below = 2, lot = 3, lead = \"4 h\" }".to_owned(),
            1 => format!(
                "regrind = {{ {station}time = \"25 min\", times = 3, life_factor = 0.9 }}\n\
                 buy = {{ below = 2, lot = 3, lead = \"4 h\" }}"
            ),
            _ => format!("regrind = {{ {station}time = \"15 min\", batch = {} }}", batch),
        };
        writeln!(text, "[[crib]]\ntool = \"drill\"\nedges = {edges}\nfetch = \"2 min\"\n{back}").unwrap();
    }
    for (name, used) in [("vice", vices), ("pallet", pallets)] {
        if used {
            writeln!(text, "[[fixture]]\nname = \"{name}\"\ncount = {}", 1 + pick(2)).unwrap();
        }
    }
    if pick(2) == 0 {
        let part = ["resume", "scrap"][pick(2) as usize];
        writeln!(
            text,
            "[[failure]]\nmachines = \"M1\"\ntime_between = {{ distribution = \"exponential\", mean = \"3 h\" }}\n\
             time_to_repair = \"20 min\"\nclock = \"busy\"\npart = \"{part}\""
        )
        .unwrap();
    }
    text
}

fn parsed(text: &str) -> Scenario {
    parse("random.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
}

/// Work of a machine that is not undone, by order and operation.
fn pieces(log: &RunLog) -> BTreeMap<(u32, u32), BTreeMap<u32, u32>> {
    let mut done: BTreeMap<(u32, u32), BTreeMap<u32, u32>> = BTreeMap::new();
    for row in &log.operations {
        let Some(order) = log.jobs[row.job as usize].order else { continue }; // edges that are ground
        *done.entry((order, row.operation)).or_default().entry(row.machine).or_default() += row.quantity;
    }
    done
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn lots_lose_no_piece_and_come_to_an_end(seed in 0u64..1_000_000) {
        let text = random_shop(seed);
        let scenario = parsed(&text);
        let mut shop = Shop::new(&scenario, 0, 0).unwrap();
        shop.run_until(SimTime::from_seconds(8.0 * 3600.0).unwrap()).unwrap();
        let branch = shop.clone().run().unwrap();
        let log = shop.run().unwrap();
        prop_assert!(format!("{branch:?}") == format!("{log:?}"), "a branch goes on as the run did\n{text}");
        // Every piece of every order leaves the shop, good or scrapped.
        let mut left = vec![0; scenario.orders.len()];
        for job in &log.jobs {
            let last: Vec<_> =
                (0..scenario.machines.len() as u32).map(|own| log.states.iter().rfind(|row| row.machine == own)).collect();
            prop_assert!(
                job.outcome != JobOutcome::InProcess,
                "a job that never ends: {:?}\n{:?}\n{}",
                job,
                last,
                text
            );
            if let Some(order) = job.order {
                left[order as usize] += job.quantity;
            }
        }
        prop_assert_eq!(left, scenario.orders.iter().map(|order| order.quantity).collect::<Vec<_>>(), "{}", text);
        for machine in 0..scenario.machines.len() as u32 {
            let mut end = 0.0;
            for row in log.states.iter().filter(|row| row.machine == machine) {
                prop_assert_eq!(row.start, end);
                end = row.end;
            }
            prop_assert_eq!(end, scenario.horizon);
            let last = log.states.iter().rfind(|row| row.machine == machine).unwrap();
            prop_assert!(
                matches!(
                    last.state,
                    MachineState::Idle | MachineState::OffShift | MachineState::Down | MachineState::Maintenance
                ),
                "machine {} is kept for nobody in the end: {:?}\n{}", machine, last, text
            );
            // Operations follow one another; what an inspection has divided was one.
            let mut last = (0.0, 0.0);
            for row in log.operations.iter().filter(|row| row.machine == machine) {
                let own = (row.start, row.end);
                prop_assert!(own == last || row.start >= last.1, "two at once in machine {}\n{}", machine, text);
                last = own;
            }
        }
        // Never more of a fixture in use than there are.
        for fixture in &scenario.shared.fixtures {
            let needs = |row: &&OperationRow| {
                fixture.holds.iter().any(|hold| hold.contains(row.part as usize, row.operation as usize))
            };
            let mut used: Vec<(u32, f64, f64)> =
                log.operations.iter().filter(needs).map(|row| (row.machine, row.start, row.end)).collect();
            used.dedup();
            for (_, start, _) in &used {
                let now = used.iter().filter(|(_, from, to)| from <= start && start < to).count();
                prop_assert!(now <= fixture.count as usize, "{now} of {} at {start}\n{text}", fixture.name);
            }
        }
        // No more machines than an order is split over, and shares that differ by one piece at most, where neither
        // rework nor scrap adds or takes pieces.
        let disturbed = text.contains("outcomes") || text.contains("scrap");
        for ((order, operation), done) in pieces(&log).into_iter().filter(|_| !disturbed) {
            let ordered = &scenario.orders[order as usize];
            prop_assert!(done.len() as u32 <= ordered.split.unwrap_or(1), "order {}: {:?}\n{}", order, done, text);
            let (least, most) = (done.values().min().unwrap(), done.values().max().unwrap());
            prop_assert!(most - least <= 1, "order {}, operation {}: {:?}\n{}", order, operation, done, text);
        }
    }
}
