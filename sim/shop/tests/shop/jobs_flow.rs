//! Batches, rework, preemption and assembly: exact values, results by hand, and what holds in any shop.

use proptest::prelude::*;
use std::fmt::Write;
use toolroom_kernel::SimTime;
use toolroom_scenario::{InspectedTo, Scenario};
use toolroom_scenario_file::{parse, read};
use toolroom_shop::runlog::{JobOutcome, MachineState, OperationResult, RunLog};
use toolroom_shop::{Shop, run};

fn parsed(text: &str) -> Scenario {
    parse("flow.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
}

fn shipped(name: &str, changes: &[&str]) -> Scenario {
    let file = format!("{}/../../scenarios/shop/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{name}: {error}")).scenario
}

/// A shop with one part `job` that is worked on by one machine `M`, and what comes to it.
fn station(machine: &str, work: &str, arrivals: &str, horizon: &str) -> Scenario {
    parsed(&format!(
        "schema = 1\n[shop]\nname = \"one\"\nhorizon = \"{horizon}\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\n{machine}\n\
         [[part]]\nname = \"job\"\n[[part.operation]]\nname = \"do\"\nmachines = \"M\"\n{work}\n{arrivals}"
    ))
}

/// Mean time from coming to the shop to the first start, min, and mean number that started together.
fn waits(log: &RunLog) -> (f64, f64) {
    let started: Vec<&_> = log.jobs.iter().filter(|job| job.start.is_finite()).collect();
    let mut starts: Vec<u64> = started.iter().map(|job| job.start.to_bits()).collect();
    starts.sort_unstable();
    starts.dedup();
    let wait: f64 = started.iter().map(|job| job.start - job.arrival).sum();
    (wait / 60.0 / started.len() as f64, started.len() as f64 / starts.len() as f64)
}

fn near(computed: f64, exact: f64, relative: f64) {
    assert!((computed / exact - 1.0).abs() < relative, "{computed} instead of {exact}");
}

const RATE: &str = "[[arrivals]]\npart = \"job\"\npattern = \"poisson\"\nrate = \"18 1/h\"\n";

#[test]
fn batches_wait_as_their_markov_chains_say() {
    // Bulk service queues (Bailey 1954; Neuts 1967): stationary distributions of their chains. The tolerances are some
    // four standard errors of runs of this length.
    let random = "work = { distribution = \"exponential\", mean = \"10 min\" }\nwork_per = \"batch\"";
    let run_of = |batch: &str, work: &str| waits(&run(&station(batch, work, RATE, "6000 h"), 0, 0).unwrap());
    near(run_of("batch = { max = 4, min = 1 }", random).0, 25.524_987, 0.06);
    near(run_of("batch = { max = 4, min = 4 }", random).0, 21.476_391, 0.06);
    let constant = "work = \"10 min\"\nwork_per = \"batch\"";
    near(run_of("batch = { max = 4, min = 4, by = \"lots\" }", constant).0, 7.669_612, 0.03);
    // Six, or 40 minutes after the first: 1 + the jobs of a Poisson process in that time, at most 6.
    let rate = RATE.replace("18 1/h", "6 1/h");
    let text = "batch = { max = 6, min = 6, time_out = \"40 min\" }";
    let (wait, size) = waits(&run(&station(text, "work = \"0 min\"", &rate, "6000 h"), 0, 0).unwrap());
    near(size, 4.589_696, 0.01);
    near(wait, 20.058_307, 0.02);
}

#[test]
fn families_go_by_their_best_job_and_others_wait() {
    // Two families of two places; jobs of both come one by one. The first family that is full goes first; a lone
    // job goes 30 minutes after it has come.
    let text = "schema = 1\n[shop]\nname = \"oven\"\nhorizon = \"10 h\"\n\
        [[machine]]\nname = \"oven\"\nprocess = \"plain\"\nbatch = { max = 2, min = 2, time_out = \"30 min\" }\n\
        [[part]]\nname = \"a\"\noperation = [{ name = \"bake\", machines = \"oven\", work = \"10 min\", work_per = \"batch\" }]\n\
        [[part]]\nname = \"b\"\noperation = [{ name = \"bake\", machines = \"oven\", work = \"20 min\", work_per = \"batch\" }]\n\
        [[arrivals]]\npart = \"a\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\" }, { time = \"12 min\" }, { time = \"13 min\" }]\n\
        [[arrivals]]\npart = \"b\"\npattern = \"schedule\"\nlot = [{ time = \"5 min\" }, { time = \"6 min\" }]\n";
    let log = run(&parsed(text), 0, 0).unwrap();
    let times: Vec<(f64, f64)> = log.jobs.iter().map(|job| (job.start / 60.0, job.finish / 60.0)).collect();
    // In the order of their arrival: a at 0, b at 5 and 6, a at 12 and 13.
    assert_eq!(times, [(26.0, 36.0), (6.0, 26.0), (6.0, 26.0), (26.0, 36.0), (43.0, 53.0)]);
    // All together in one family.
    let any = text.replace("max = 2, min = 2", "max = 5, min = 5, same = \"any\"");
    let log = run(&parsed(&any), 0, 0).unwrap();
    assert!(log.jobs.iter().all(|job| (job.start, job.finish) == (13.0 * 60.0, 33.0 * 60.0)), "the longest counts");
    // A machine that breaks down with a batch loses all of it.
    let broken = any
        + "[[failure]]\nmachines = \"oven\"\ntime_between = \"15 min\"\ntime_to_repair = \"5 h\"\npart = \"scrap\"\n";
    let log = run(&parsed(&broken), 0, 0).unwrap();
    assert!(log.jobs.iter().all(|job| job.outcome == JobOutcome::Breakdown && job.finish == 28.0 * 60.0));
}

#[test]
fn an_order_meets_others_in_a_furnace_and_goes_on_by_itself() {
    // Transfer of two: the pieces of an order reach the furnace in three parts and need no machine kept for them.
    let text = "schema = 1\n[shop]\nname = \"heat\"\nhorizon = \"10 h\"\n\
        [[machine]]\nname = \"saw\"\nprocess = \"plain\"\n\
        [[machine]]\nname = \"furnace\"\nprocess = \"plain\"\nbatch = { max = 4, min = 4, time_out = \"1 h\" }\n\
        [[part]]\nname = \"bar\"\noperation = [\n{ name = \"cut\", machines = \"saw\", work = \"5 min\" },\n\
        { name = \"heat\", machines = \"furnace\", work = \"1 h\", work_per = \"batch\" }]\n\
        [[order]]\nid = \"O1\"\npart = \"bar\"\nquantity = 6\ntransfer = 2\n";
    let log = run(&parsed(text), 0, 0).unwrap();
    let finishes: Vec<f64> = log.jobs.iter().map(|job| job.finish / 60.0).collect();
    // Four are there at 20 min; the last two, at 30, wait for an hour and begin at 90.
    assert_eq!(finishes, [80.0, 80.0, 150.0]);
}

#[test]
fn urgent_jobs_interrupt_others_as_a_hand_says() {
    // Low: 10 min from 0; high: 3 min at 4.
    let text = |how: &str| {
        format!(
            "schema = 1\n[shop]\nname = \"urgent\"\nhorizon = \"1 h\"\n[dispatch]\nrule = [\"priority\", \"fifo\"]\npreempt = \"{how}\"\n\
             [[machine]]\nname = \"M\"\nprocess = \"plain\"\n\
             [[part]]\nname = \"low\"\noperation = [{{ name = \"do\", machines = \"M\", work = \"10 min\" }}]\n\
             [[part]]\nname = \"high\"\noperation = [{{ name = \"do\", machines = \"M\", work = \"3 min\" }}]\n\
             [[arrivals]]\npart = \"low\"\npattern = \"schedule\"\npriority = 2\nlot = [{{ time = \"0 min\" }}]\n\
             [[arrivals]]\npart = \"high\"\npattern = \"schedule\"\npriority = 1\nlot = [{{ time = \"4 min\" }}]\n"
        )
    };
    let ends = |how: &str| -> Vec<(JobOutcome, f64)> {
        let log = run(&parsed(&text(how)), 0, 0).unwrap();
        log.jobs.iter().map(|job| (job.outcome, job.finish / 60.0)).collect()
    };
    let good = |low, high| vec![(JobOutcome::Good, low), (JobOutcome::Good, high)];
    assert_eq!(ends("none"), good(10.0, 13.0));
    assert_eq!(ends("resume"), good(13.0, 7.0));
    assert_eq!(ends("repeat"), good(17.0, 7.0));
    assert_eq!(ends("scrap"), [(JobOutcome::Preempted, 4.0), (JobOutcome::Good, 7.0)]);
    let held = text("resume").replacen("work = \"10 min\"", "work = \"10 min\", preemptible = false", 1);
    let log = run(&parsed(&held), 0, 0).unwrap();
    assert_eq!(log.jobs[1].finish, 13.0 * 60.0);
}

#[test]
fn two_priorities_wait_as_cobham_says() {
    let text = |how: &str, low: &str| {
        format!(
            "schema = 1\n[shop]\nname = \"two\"\nhorizon = \"12000 h\"\n[dispatch]\nrule = [\"priority\", \"fifo\"]\npreempt = \"{how}\"\n\
             [[machine]]\nname = \"M\"\nprocess = \"plain\"\n\
             [[part]]\nname = \"high\"\noperation = [{{ name = \"do\", machines = \"M\", work = {{ distribution = \"exponential\", mean = \"6 min\" }} }}]\n\
             [[part]]\nname = \"low\"\noperation = [{{ name = \"do\", machines = \"M\", work = {low} }}]\n\
             [[arrivals]]\npart = \"high\"\npattern = \"poisson\"\npriority = 1\nrate = \"2.4 1/h\"\n\
             [[arrivals]]\npart = \"low\"\npattern = \"poisson\"\npriority = 2\nrate = \"3 1/h\"\n"
        )
    };
    let exponential = "{ distribution = \"exponential\", mean = \"10 min\" }";
    let mean = |log: &RunLog, part: u32, since: fn(&toolroom_shop::runlog::JobRow) -> f64| {
        let done: Vec<f64> =
            log.jobs.iter().filter(|job| job.part == part && job.finish.is_finite()).map(since).collect();
        done.iter().sum::<f64>() / done.len() as f64 / 60.0
    };
    // Cobham (1954), and the preemptive resume queue (Jaiswal 1968).
    let log = run(&parsed(&text("none", exponential)), 0, 0).unwrap();
    near(mean(&log, 0, |job| job.start - job.arrival), 8.473_684, 0.05);
    near(mean(&log, 1, |job| job.start - job.arrival), 32.591_093, 0.08);
    let log = run(&parsed(&text("resume", exponential)), 0, 0).unwrap();
    near(mean(&log, 0, |job| job.finish - job.arrival), 7.894_737, 0.04);
    near(mean(&log, 1, |job| job.finish - job.arrival), 45.748_988, 0.08);
    // The same 20 minutes begun again after every interruption: time from the first start to the end.
    let repeated = text("repeat", "\"20 min\"").replace("6 min", "5 min").replace("2.4 1/h", "1.8 1/h");
    let log = run(&parsed(&repeated.replace("3 1/h", "0.6 1/h")), 0, 0).unwrap();
    near(mean(&log, 1, |job| job.finish - job.start), 32.239_953, 0.02);
}

#[test]
fn rework_loads_stations_as_a_jackson_network() {
    let mut scenario = shipped("rework", &["shop.horizon=\"20000 h\""]);
    let outcomes = &scenario.parts[0].operations[2].inspection.outcomes;
    assert_eq!(outcomes.iter().map(|own| own.to).collect::<Vec<_>>(), [0, 1].map(InspectedTo::Operation));
    let log = run(&scenario, 0, 0).unwrap();
    let share = |machine: u32| {
        let rows = log.states.iter().filter(|row| row.machine == machine && row.state == MachineState::Working);
        rows.map(|row| row.end - row.start).sum::<f64>() / log.horizon
    };
    for (machine, load) in [(0, 0.7125), (1, 0.625), (2, 0.25)] {
        near(share(machine), load, 0.02);
    }
    let done: Vec<f64> =
        log.jobs.iter().filter(|job| job.finish.is_finite()).map(|job| job.finish - job.arrival).collect();
    near(done.iter().sum::<f64>() / done.len() as f64 / 60.0, 89.565_217, 0.05);
    // Nobody is sent back more often than allowed.
    scenario.horizon = 3.6e6;
    scenario.parts[0].operations[2].inspection.rework_max = Some(1);
    let log = run(&scenario, 0, 0).unwrap();
    let sent = |job: usize| {
        let rows = log.operations.iter().filter(|row| row.job as usize == job);
        rows.filter(|row| row.result == OperationResult::Rework).count()
    };
    assert!((0..log.jobs.len().min(1000)).all(|job| sent(job) <= 1));
    let rejected = log.jobs.iter().filter(|job| job.outcome == JobOutcome::Rejected).count() as f64;
    near(rejected / log.jobs.len() as f64, 0.04, 0.25);
}

#[test]
fn pieces_of_an_order_are_judged_one_by_one() {
    let text = "schema = 1\n[shop]\nname = \"pieces\"\nhorizon = \"100 h\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\n\
        [[part]]\nname = \"pin\"\noperation = [{ name = \"turn\", machines = \"M\", work = \"1 min\",\n\
        outcomes = [{ share = 0.2, go = \"turn\" }, { share = 0.1, scrap = true }] }]\n\
        [[order]]\nid = \"O1\"\npart = \"pin\"\nquantity = 1000\n";
    let log = run(&parsed(text), 0, 0).unwrap();
    let pieces = |outcome| log.jobs.iter().filter(|job| job.outcome == outcome).map(|job| job.quantity).sum::<u32>();
    assert_eq!(pieces(JobOutcome::Good) + pieces(JobOutcome::Rejected), 1000);
    // 0.1/(1 − 0.2) of them are scrapped in the end.
    near(f64::from(pieces(JobOutcome::Rejected)), 125.0, 0.3);
    // Every visit takes its time: 1000/(1 − 0.2) minutes.
    near(log.jobs.iter().map(|job| job.finish).fold(0.0, f64::max) / 60.0, 1250.0, 0.1);
    let lot = text.replace("scrap = true }]", "scrap = true }], outcomes_per = \"lot\"");
    let log = run(&parsed(&lot), 0, 0).unwrap();
    assert_eq!(log.jobs.len(), 1);
}

#[test]
fn assembly_takes_all_components_at_once() {
    // Stationary distribution of its chain: two feeders of rate 1 with room for two finished parts each, assembly of rate 2.
    let log = run(&shipped("assembly", &["shop.horizon=\"4000 h\""]), 0, 0).unwrap();
    let made = log.jobs.iter().filter(|job| job.part == 2 && job.finish.is_finite()).count() as f64;
    near(made / (log.horizon / 60.0), 0.771_654, 0.01);
    // By hand: a needs two of b. They come at 10 and 20 min, so that a begins at 20; the second a waits for ever.
    let text = "schema = 1\n[shop]\nname = \"pair\"\nhorizon = \"2 h\"\n\
        [[machine]]\nname = \"M\"\nprocess = \"plain\"\n[[machine]]\nname = \"A\"\nprocess = \"plain\"\n\
        [[part]]\nname = \"b\"\noperation = [{ name = \"make\", machines = \"M\", work = \"10 min\" }]\n\
        [[part]]\nname = \"a\"\ncomponents = [{ part = \"b\", quantity = 2 }]\n\
        operation = [{ name = \"join\", machines = \"A\", work = \"5 min\", assemble = true }]\n\
        [[arrivals]]\npart = \"b\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\", size = 3 }]\n\
        [[arrivals]]\npart = \"a\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\", size = 2 }]\n";
    let log = run(&parsed(text), 0, 0).unwrap();
    let of_a: Vec<(f64, f64)> =
        log.jobs.iter().filter(|job| job.part == 1).map(|job| (job.start / 60.0, job.finish / 60.0)).collect();
    assert_eq!(of_a[0], (20.0, 25.0));
    assert!(of_a[1].0.is_nan());
}

#[test]
fn what_could_never_work_is_refused() {
    let base = "schema = 1\n[shop]\nname = \"x\"\nhorizon = \"2 h\"\n[[machine]]\nname = \"M\"\nprocess = \"plain\"\nMACHINE\n\
        [[machine]]\nname = \"N\"\nprocess = \"plain\"\n\
        [[part]]\nname = \"b\"\nPART\noperation = [{ name = \"first\", machines = \"M\", work = \"1 min\" }, \
        { name = \"second\", machines = [\"M\"], work = \"1 min\"SECOND }]\n\
        [[arrivals]]\npart = \"b\"\npattern = \"schedule\"\nlot = [{ time = \"0 min\" }]\n[dispatch]\nDISPATCH\n";
    let cases = [
        ("MACHINE", "batch = { max = 2, min = 3 }", "no more than fit in"),
        ("SECOND", ", work_per = \"batch\"", "no machine that makes batches"),
        ("SECOND", ", outcomes = [{ share = 0.7, go = \"first\" }, { share = 0.7, scrap = true }]", "add up to 1.4"),
        ("SECOND", ", outcomes = [{ share = 0.7, go = \"frist\" }]", "first"),
        ("SECOND", ", outcomes = [{ share = 0.7 }]", "either goes back"),
        ("PART", "components = [{ part = \"b\" }]", "goes into itself"),
        ("SECOND", ", assemble = true", "no components"),
        ("DISPATCH", "preempt = \"resume\"", "priority first"),
    ];
    for (place, text, word) in cases {
        let text = base.replace(place, text);
        let text = ["MACHINE", "PART", "SECOND", "DISPATCH"].iter().fold(text, |text, place| text.replace(place, ""));
        let error = parse("flow.toml", &text, &[]).expect_err(word).to_string();
        assert!(error.contains(word), "{word}: {error}");
    }
    let mixed = base.replace("MACHINE", "batch = { max = 2 }").replace("[\"M\"]", "[\"M\", \"N\"]");
    let mixed = ["PART", "SECOND", "DISPATCH"].iter().fold(mixed, |text, place| text.replace(place, ""));
    assert!(parse("flow.toml", &mixed, &[]).unwrap_err().to_string().contains("alone and in batches"));
}

/// A random shop of plain machines with batches, rework, scrap, preemption, assembly, shifts, breakdowns and orders.
fn random_shop(seed: u64) -> String {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut pick = move |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let how = ["none", "resume", "repeat", "scrap"][pick(4) as usize];
    let mut text = format!(
        "schema = 1\n[shop]\nname = \"random\"\nseed = {}\nhorizon = \"30 h\"\n\
         [dispatch]\nrule = [\"priority\", \"{}\"]\npreempt = \"{how}\"\n",
        seed + 1,
        ["fifo", "spt", "atc", "least_setup"][pick(4) as usize],
    );
    let at_end = ["resume", "finish", "repeat", "scrap"][pick(4) as usize];
    write!(
        text,
        "[[calendar]]\nname = \"day\"\nperiod = \"10 h\"\nat_end = \"{at_end}\"\nshift = [{{ start = \"1 h\", end = \"9 h\" }}]\n"
    )
    .unwrap();
    let machines = 3 + pick(3);
    let batch: Vec<bool> = (0..machines).map(|machine| machine > 0 && pick(3) == 0).collect();
    for machine in 0..machines {
        writeln!(text, "[[machine]]\nname = \"M{machine}\"\nprocess = \"plain\"\nsetup_time = \"{} min\"", pick(4))
            .unwrap();
        if batch[machine as usize] {
            let same = ["setup_group", "part", "any"][pick(3) as usize];
            let min = 1 + pick(3);
            writeln!(text, "batch = {{ max = 4, min = {min}, time_out = \"45 min\", same = \"{same}\" }}").unwrap();
        }
        if pick(2) == 0 {
            writeln!(text, "calendar = \"day\"").unwrap();
        }
    }
    for part in 0..3 {
        writeln!(text, "[[part]]\nname = \"P{part}\"\nflow_allowance = \"6 h\"").unwrap();
        if part == 2 {
            writeln!(text, "components = [{{ part = \"P0\" }}, {{ part = \"P1\", quantity = 2 }}]").unwrap();
        }
        let operations = 1 + pick(3);
        for operation in 0..operations {
            let assembles = part == 2 && operation == 0;
            let machine = if assembles { 0 } else { pick(machines) };
            let per = if batch[machine as usize] { "batch" } else { ["part", "lot"][pick(2) as usize] };
            writeln!(
                text,
                "[[part.operation]]\nname = \"o{operation}\"\nmachines = \"M{machine}\"\nwork_per = \"{per}\"\nassemble = {assembles}\n\
                 work = {{ distribution = \"exponential\", mean = \"{} min\" }}",
                3 + pick(20)
            )
            .unwrap();
            if pick(2) == 0 {
                let back = pick(operation + 1);
                writeln!(
                    text,
                    "outcomes = [{{ share = 0.2, go = \"o{back}\" }}, {{ share = 0.1, scrap = true }}]\nrework_max = 3\noutcomes_per = \"{}\"",
                    ["part", "lot"][pick(2) as usize]
                )
                .unwrap();
            }
        }
        writeln!(
            text,
            "[[arrivals]]\npart = \"P{part}\"\npattern = \"poisson\"\nrate = \"1 1/h\"\npriority = {}",
            pick(3)
        )
        .unwrap();
        for order in 0..2 {
            writeln!(
                text,
                "[[order]]\nid = \"O{part}{order}\"\npart = \"P{part}\"\nquantity = {}\ntransfer = {}\nrelease = \"{} h\"\npriority = {}",
                1 + pick(4),
                1 + pick(4),
                pick(20),
                pick(3)
            )
            .unwrap();
        }
    }
    if pick(2) == 0 {
        let part = ["resume", "repeat", "scrap"][pick(3) as usize];
        writeln!(
            text,
            "[[failure]]\nmachines = [\"M0\", \"M1\"]\ntime_between = {{ distribution = \"exponential\", mean = \"3 h\" }}\n\
             time_to_repair = \"20 min\"\nclock = \"busy\"\npart = \"{part}\""
        )
        .unwrap();
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]
    #[test]
    fn nothing_is_lost_in_a_shop_with_everything(seed in 0u64..100_000) {
        let text = random_shop(seed);
        let scenario = parsed(&text);
        let mut shop = Shop::new(&scenario, 0, 0).unwrap();
        let half = SimTime::from_seconds(0.5 * scenario.horizon).unwrap();
        shop.run_until(half).unwrap();
        let branch = shop.clone();
        shop.run_until(SimTime::from_seconds(scenario.horizon).unwrap()).unwrap();
        let released: u64 = shop.world().sources.iter().map(|source| source.released).sum();
        let ordered: u64 = scenario.orders.iter().filter(|order| order.release <= scenario.horizon).map(|order| u64::from(order.quantity)).sum();
        let stock: Vec<u64> = shop.world().stock.iter().map(|own| own.iter().map(|own| u64::from(own.pieces)).sum()).collect();
        let inside: u64 = shop.world().jobs.iter().map(|job| u64::from(job.row.quantity)).sum();
        let taken: u64 = shop.world().jobs.iter().filter(|job| job.supplied).map(|job| u64::from(job.row.quantity)).sum();
        let log = shop.run().unwrap();
        let branch = branch.run().unwrap();
        prop_assert_eq!(branch.digest, log.digest);
        // What is not defined is equal to itself in print only.
        prop_assert!(format!("{branch:?}") == format!("{log:?}"), "a branch goes on as the run did\n{text}");
        // Pieces: what came is in the jobs of the log, and what is not finished is in the shop.
        let pieces = |of: &dyn Fn(&toolroom_shop::runlog::JobRow) -> bool| -> u64 {
            log.jobs.iter().filter(|job| of(job)).map(|job| u64::from(job.quantity)).sum()
        };
        prop_assert_eq!(pieces(&|_| true), released + ordered);
        prop_assert_eq!(pieces(&|job| job.outcome == JobOutcome::InProcess), inside);
        // Components: what is finished is in stock or in what was put together.
        let begun = pieces(&|job| job.part == 2 && job.outcome != JobOutcome::InProcess) + taken;
        for (part, needed) in [(0u32, 1), (1, 2)] {
            let good = pieces(&|job| job.part == part && job.outcome == JobOutcome::Good);
            // A part that was scrapped before it was put together took nothing.
            prop_assert!(good >= stock[part as usize] && good <= stock[part as usize] + needed * begun, "{}", text);
        }
        for machine in 0..scenario.machines.len() as u32 {
            let mut end = 0.0;
            for row in log.states.iter().filter(|row| row.machine == machine) {
                prop_assert_eq!(row.start, end);
                end = row.end;
            }
            prop_assert_eq!(end, scenario.horizon);
            // Operations of a machine follow one another; those of one batch are one.
            let mut ends = (0.0, 0.0);
            for row in log.operations.iter().filter(|row| row.machine == machine && row.end.is_finite()) {
                prop_assert!((row.start, row.end) == ends || row.start >= ends.1, "machine {}\n{}", machine, text);
                ends = (row.start, row.end);
            }
        }
        // A job is at one place at a time.
        for job in 0..log.jobs.len() as u32 {
            let mut end = 0.0;
            for row in log.operations.iter().filter(|row| row.job == job) {
                prop_assert!(row.start >= end);
                end = row.end;
            }
        }
    }
}
