//! Cards, release, assignment and the options of rules: against exact answers of queueing networks, against published tables
//! and against cases that were worked out independently.

use crate::scenarios::run;
use std::collections::BTreeMap;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::runlog::LogEvent;
use toolroom_shop::{RunLog, ShopError};

fn parsed(text: &str) -> Scenario {
    with(text, &[])
}

fn with(text: &str, set: &[&str]) -> Scenario {
    let set: Vec<String> = set.iter().map(|&change| change.to_owned()).collect();
    parse("scenario.toml", text, &set).unwrap_or_else(|error| panic!("{error}")).scenario
}

fn refused(text: &str) -> String {
    match parse("scenario.toml", text, &[]) {
        Ok(_) => panic!("is read"),
        Err(error) => format!("{error}: {error:?}"),
    }
}

/// A shop of plain machines with some parts: name, and station and work of each operation.
fn shop(machines: &[&str], parts: &[(&str, &[(&str, &str)])], rest: &str) -> String {
    let mut text = "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"1000 h\"\n".to_owned();
    for machine in machines {
        text += &format!("[[machine]]\nprocess = \"plain\"\nname = {machine}\n");
    }
    for (name, operations) in parts {
        text += &format!("[[part]]\nname = \"{name}\"\n");
        for (index, (station, work)) in operations.iter().enumerate() {
            text += &format!("[[part.operation]]\nname = \"{index}\"\nmachines = \"{station}\"\nwork = {work}\n");
        }
    }
    text + rest
}

fn exponential(minutes: f64) -> String {
    format!("{{ distribution = \"exponential\", mean = \"{minutes} min\" }}")
}

/// A source that never runs out, and one that has so many jobs at the start.
fn constant_work(part: &str, jobs: u32) -> String {
    format!("[[arrivals]]\npart = \"{part}\"\npattern = \"constant_work\"\njobs = {jobs}\n")
}

fn at_start(part: &str, jobs: u32) -> String {
    format!("[[arrivals]]\npart = \"{part}\"\npattern = \"schedule\"\nlot = [{{ time = \"0 h\", size = {jobs} }}]\n")
}

fn finishes(log: &RunLog) -> Vec<f64> {
    log.jobs.iter().map(|job| job.finish / 60.0).collect()
}

/// The order in which jobs were begun, of those that were.
fn order(log: &RunLog) -> Vec<usize> {
    let mut order: Vec<usize> = (0..log.jobs.len()).filter(|job| !log.jobs[*job].start.is_nan()).collect();
    order.sort_by(|a, b| log.jobs[*a].start.total_cmp(&log.jobs[*b].start));
    order
}

/// Four stations, so many jobs kept before them.
fn conwip(jobs: u32, rest: &str) -> String {
    let works = [10.0, 12.0, 8.0, 6.0].map(exponential);
    let stations = ["A", "B", "C", "D"];
    let route: Vec<(&str, &str)> = stations.into_iter().zip(works.iter().map(String::as_str)).collect();
    let machines = ["\"A\"", "\"B\"", "\"C\"", "\"D\""];
    shop(&machines, &[("job", &route)], &(constant_work("job", jobs) + rest)).replace("1000 h", "20000 h")
}

#[test]
fn a_loop_over_a_line_has_the_rate_and_the_lead_time_of_the_closed_network() {
    let log = run(&parsed(&conwip(9, "[[loop]]\nname = \"line\"\nfrom = \"A\"\nto = \"D\"\ncards = 6\n")));
    let mut taken = BTreeMap::new();
    for row in log.events.iter().filter(|row| row.event == LogEvent::Card) {
        taken.insert(row.job.expect("a job takes a card"), row.time);
    }
    let (mut count, mut total) = (0.0_f64, 0.0_f64);
    for (number, job) in (0..).zip(&log.jobs).filter(|(_, job)| job.finish > 60_000.0) {
        count += 1.0;
        total += (job.finish - taken[&number]) / 60.0;
    }
    // Closed exponential network of four stations and six jobs, by mean value analysis.
    let rate = count / (20_000.0 * 60.0 - 1000.0);
    assert!((rate / 0.069_987_8 - 1.0).abs() < 0.01, "{rate}");
    assert!((total / count / 85.729_247 - 1.0).abs() < 0.01, "{}", total / count);
}

#[test]
fn a_loop_over_the_whole_shop_is_constant_work() {
    let of = |text: &str| run(&with(text, &["shop.horizon=\"500 h\""]));
    let cards = of(&conwip(40, "[[loop]]\nname = \"all\"\nfrom = \"A\"\nto = \"D\"\ncards = 6\n"));
    let finished = |log: &RunLog| finishes(log).into_iter().filter(|time| time.is_finite()).collect::<Vec<f64>>();
    assert!(finished(&cards).len() > 1500);
    assert_eq!(finished(&cards), finished(&of(&conwip(6, ""))));
}

#[test]
fn two_loops_share_a_station() {
    let (ten, six, fifteen) = (exponential(10.0), exponential(6.0), exponential(15.0));
    let parts: [(&str, &[(&str, &str)]); 2] =
        [("X", &[("A", &ten), ("S", &six)]), ("Y", &[("S", &six), ("B", &fifteen)])];
    let loops = "[[loop]]\nname = \"x\"\nfrom = \"A\"\nto = \"S\"\nparts = \"X\"\ncards = 3\n\
                 [[loop]]\nname = \"y\"\nfrom = \"S\"\nto = \"B\"\nparts = \"Y\"\ncards = 4\n";
    let text = shop(&["\"A\"", "\"S\"", "\"B\""], &parts, &(constant_work("X", 5) + &constant_work("Y", 7) + loops));
    let log = run(&with(&text, &["shop.horizon=\"20000 h\""]));
    for (part, known) in [(0, 0.077_538_5), (1, 0.061_945_9)] {
        let finished = log.jobs.iter().filter(|job| job.part == part && job.finish.is_finite()).count();
        let rate = finished as f64 / (20_000.0 * 60.0);
        assert!((rate / known - 1.0).abs() < 0.01, "{part}: {rate}");
    }
}

#[test]
fn one_card_a_station_blocks_as_stations_without_buffers_do() {
    let one = exponential(1.0);
    let route: Vec<(&str, &str)> = ["A", "B", "C"].into_iter().map(|station| (station, one.as_str())).collect();
    let limited = ["\"A\"", "\"B\"\ninput_buffer = 0", "\"C\"\ninput_buffer = 0"];
    let line = shop(&limited, &[("job", &route)], &constant_work("job", 20));
    let kanban: String = ["A", "B", "C"]
        .iter()
        .map(|station| format!("[[loop]]\nname = \"{station}\"\nfrom = \"{station}\"\ncards = 1\n"))
        .collect();
    let cards = shop(&["\"A\"", "\"B\"", "\"C\""], &[("job", &route)], &(constant_work("job", 20) + &kanban));
    let (line, cards) = (run(&parsed(&line)), run(&parsed(&cards)));
    assert!(line.jobs.len() > 30_000);
    assert_eq!(finishes(&line).len(), finishes(&cards).len());
    // Hillier and Boling: the rate is 0.564103 a minute.
    let same =
        finishes(&line).iter().zip(finishes(&cards)).all(|(a, b)| (a - b).abs() < 1e-6 || a.is_nan() && b.is_nan());
    assert!(same);
}

#[test]
fn jobs_that_wait_for_each_others_cards_are_named() {
    let parts: [(&str, &[(&str, &str)]); 2] =
        [("X", &[("A", "\"5 min\""), ("B", "\"5 min\"")]), ("Y", &[("B", "\"5 min\""), ("A", "\"5 min\"")])];
    let loops = |cards: u32| {
        format!(
            "[[loop]]\nname = \"first\"\nfrom = \"A\"\ncards = {cards}\n[[loop]]\nname = \"second\"\nfrom = \"B\"\ncards = 1\n"
        )
    };
    let text = |cards: u32, before: &str| {
        let jobs = at_start("X", 1) + &at_start("Y", 1);
        shop(&["\"A\"", &format!("\"B\"{before}")], &parts, &(jobs + &loops(cards)))
    };
    for before in ["", "\ninput_buffer = 3"] {
        match toolroom_shop::run(&parsed(&text(1, before)), 0, 0) {
            Err(ShopError::CardDeadlock { time, circle }) => {
                assert_eq!(time, 300.0);
                let (x, y) = (
                    "X 0 has a card of \"first\" and wants a card of \"second\"",
                    "Y 1 has a card of \"second\" and wants a card of \"first\"",
                );
                assert!(circle == format!("{x}; {y}") || circle == format!("{y}; {x}"), "{circle}");
            }
            other => panic!("no deadlock: {:?}", other.map(|log| finishes(&log))),
        }
        assert_eq!(finishes(&run(&parsed(&text(2, before)))), [10.0, 10.0]);
    }
}

#[test]
fn the_backlog_goes_by_the_rule_of_the_loop() {
    let parts: [(&str, &[(&str, &str)]); 3] =
        [("a", &[("A", "\"6 min\"")]), ("b", &[("A", "\"4 min\"")]), ("c", &[("A", "\"2 min\"")])];
    let jobs = at_start("a", 1) + &at_start("b", 1) + &at_start("c", 1);
    let text = shop(&["\"A\""], &parts, &jobs);
    let card = "[[loop]]\nname = \"A\"\nfrom = \"A\"\ncards = 1\n";
    assert_eq!(order(&run(&parsed(&format!("{text}{card}")))), [0, 1, 2]);
    assert_eq!(order(&run(&parsed(&format!("{text}{card}rule = \"spt\"\n")))), [2, 1, 0]);
}

#[test]
fn all_of_an_order_has_one_card_and_rework_comes_back_for_it() {
    // Pieces move on one by one; the second order waits until the last piece of the first is through both stations.
    let parts: [(&str, &[(&str, &str)]); 1] = [("p", &[("A", "\"3 min\""), ("B", "\"2 min\"")])];
    let orders = "[[order]]\nid = \"one\"\npart = \"p\"\nquantity = 4\ntransfer = 1\n\
                  [[order]]\nid = \"two\"\npart = \"p\"\nquantity = 2\n";
    let card = "[[loop]]\nname = \"all\"\nfrom = \"A\"\nto = \"B\"\ncards = 1\n";
    let log = run(&parsed(&shop(&["\"A\"", "\"B\""], &parts, &format!("{orders}{card}"))));
    let of = |order: u32| log.jobs.iter().filter(move |job| job.order == Some(order));
    assert_eq!(of(0).map(|job| job.finish / 60.0).collect::<Vec<f64>>(), [5.0, 8.0, 11.0, 14.0]);
    assert_eq!(of(1).map(|job| (job.start / 60.0, job.finish / 60.0)).collect::<Vec<_>>(), [(14.0, 24.0)]);
    // Work that comes back behind a loop takes a card again: nobody is lost, and no card.
    let rework: [(&str, &[(&str, &str)]); 1] =
        [("p", &[("A", "\"3 min\""), ("B", "\"2 min\"\noutcomes = [{ share = 0.3, go = \"0\" }]")])];
    let card = "[[loop]]\nname = \"A\"\nfrom = \"A\"\ncards = 2\n";
    let orders =
        "[[order]]\nid = \"one\"\npart = \"p\"\nquantity = 9\n[[order]]\nid = \"two\"\npart = \"p\"\nquantity = 30\n";
    let log = run(&parsed(&shop(&["\"A\"", "\"B\""], &rework, &format!("{orders}{card}{}", at_start("p", 50)))));
    let pieces: u32 = log.jobs.iter().filter(|job| job.finish.is_finite()).map(|job| job.quantity).sum();
    assert_eq!(pieces, 9 + 30 + 50);
    let returns = log.events.iter().filter(|row| row.event == LogEvent::CardReturn).count();
    assert!(returns > 52, "{returns}");
}

#[test]
fn work_is_released_by_date_and_by_load() {
    let parts: [(&str, &[(&str, &str)]); 1] = [("p", &[("A", "\"10 min\""), ("B", "\"10 min\"")])];
    let starts = |rest: &str| {
        let log = run(&parsed(&shop(&["\"A\"", "\"B\""], &parts, rest)));
        log.jobs.iter().map(|job| job.start / 60.0).collect::<Vec<f64>>()
    };
    let order = |id: &str, due: &str| format!("[[order]]\nid = \"{id}\"\npart = \"p\"\ndue = \"{due}\"\n");
    let orders = order("1", "5 h") + &order("2", "2 h") + &order("3", "30 min");
    assert_eq!(starts(&format!("{orders}[release]\nrule = \"at_date\"\nlead = \"1 h\"\n")), [240.0, 60.0, 0.0]);
    // A job adds 10 to A and 10/2 to B. With a norm of 15 min the next one fits when A is done with the one before.
    let load = |norm: u32| {
        format!("{}[release]\nrule = \"workload\"\nevery = \"5 min\"\nnorm = \"{norm} min\"\n", at_start("p", 3))
    };
    assert_eq!(starts(&load(15)), [0.0, 10.0, 20.0]);
    // No job is within a norm of 9 min: each waits until its stations have no load, the work before it at B included.
    assert_eq!(starts(&load(9)), [0.0, 20.0, 40.0]);
    // Orders are looked at in the order of their due dates.
    assert_eq!(
        starts(&format!("{orders}[release]\nrule = \"workload\"\nevery = \"5 min\"\nnorm = \"15 min\"\n")),
        [20.0, 10.0, 0.0]
    );
}

/// Jobs of one machine: time, due date, weight, setup group, time of a second operation elsewhere; min.
const JOBS: [(u32, u32, u32, &str, u32); 5] =
    [(4, 20, 1, "a", 6), (6, 10, 2, "b", 0), (3, 15, 1, "a", 2), (5, 9, 1, "b", 0), (2, 30, 3, "c", 4)];

#[test]
fn options_of_rules_follow_their_formulas() {
    let mut text = "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"10 h\"\n\
                    [[machine]]\nname = \"M\"\nprocess = \"plain\"\nsetup_time = \"3 min\"\nsetup_at_start = \"a\"\n"
        .to_owned();
    for index in 0..5 {
        text += &format!("[[machine]]\nname = \"N{index}\"\nprocess = \"plain\"\n");
    }
    for (index, (time, _, _, group, next)) in JOBS.iter().enumerate() {
        text += &format!(
            "[[part]]\nname = \"{index}\"\n[[part.operation]]\nname = \"one\"\nmachines = \"M\"\nwork = \"{time} min\"\nsetup_group = \"{group}\"\n"
        );
        if *next > 0 {
            text += &format!("[[part.operation]]\nname = \"two\"\nmachines = \"N{index}\"\nwork = \"{next} min\"\n");
        }
    }
    for (index, (_, due, weight, ..)) in JOBS.iter().enumerate() {
        text += &format!("[[order]]\nid = \"{index}\"\npart = \"{index}\"\ndue = \"{due} min\"\nweight = {weight}\n");
    }
    // Worked out independently, decision by decision, from the formulas of the guide.
    let cases: [(&[&str], [usize; 5]); 14] = [
        (&["rule=\"atcs\""], [2, 0, 4, 1, 3]),
        (&["rule=\"atcs\"", "atcs_k1=1", "atcs_k2=0.2"], [2, 0, 1, 3, 4]),
        (&["rule=\"atcs\"", "atcs_k1=1", "atcs_k2=5"], [1, 3, 2, 4, 0]),
        (&["rule=\"atcs\"", "atcs_k1=0.5", "atcs_k2=5", "slack_by=\"operation\""], [0, 1, 4, 2, 3]),
        (&["rule=\"atc\""], [1, 4, 2, 0, 3]),
        (&["rule=\"atc\"", "atc_k=0.5"], [1, 3, 2, 0, 4]),
        (&["rule=\"atc\"", "slack_by=\"operation\""], [4, 1, 2, 0, 3]),
        (&["rule=\"atc\"", "slack_by=\"operation\"", "atc_k=0.5"], [1, 4, 2, 0, 3]),
        (&["rule=\"covert\""], [1, 4, 2, 0, 3]),
        (&["rule=\"covert\"", "covert_k=0.3", "covert_b=1"], [0, 1, 2, 3, 4]),
        (&["rule=\"spt\"", "setup_in_key=true"], [2, 0, 4, 3, 1]),
        (&["rule=\"sst\""], [0, 2, 1, 3, 4]),
        (&["rule=\"atc\"", "setup_in_key=true", "atc_k=0.7"], [1, 3, 2, 4, 0]),
        (&["rule=\"atcs\"", "setup_in_key=true", "atcs_k1=1", "atcs_k2=1"], [2, 0, 1, 3, 4]),
    ];
    for (options, expected) in cases {
        let set: Vec<String> = options.iter().map(|option| format!("dispatch.{option}")).collect();
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        assert_eq!(order(&run(&with(&text, &set))), expected, "{options:?}");
    }
}

#[test]
fn rules_may_know_the_means_of_times_only() {
    let (five, six) = (exponential(5.0), exponential(6.0));
    let parts: [(&str, &[(&str, &str)]); 2] = [("long", &[("A", &six)]), ("short", &[("A", &five)])];
    let text =
        shop(&["\"A\""], &parts, &(at_start("long", 6) + &at_start("short", 6) + "[dispatch]\nrule = \"spt\"\n"));
    let by_mean = [6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5];
    assert_eq!(order(&run(&with(&text, &["dispatch.time_in_key=\"expected\""]))), by_mean);
    assert_ne!(order(&run(&parsed(&text))), by_mean);
}

#[test]
fn a_job_may_be_assigned_to_a_queue_when_it_comes() {
    let works = ["\"10 min\"", "\"1 min\"", "\"1 min\"", "\"5 min\""];
    let names = ["a", "b", "c", "d"];
    let routes: Vec<[(&str, &str); 1]> = works.iter().map(|work| [("M", *work)]).collect();
    let parts: Vec<(&str, &[(&str, &str)])> =
        names.iter().zip(&routes).map(|(name, route)| (*name, &route[..])).collect();
    let jobs: String = names.iter().map(|name| at_start(name, 1)).collect();
    let text = shop(&["\"M\"\ncount = 2"], &parts, &(jobs + "[dispatch]\n"));
    let finished = |set: &[&str]| finishes(&run(&with(&text, set)));
    let (assigned, least) = ("dispatch.assign=\"at_arrival\"", "dispatch.queue_choice=\"least_work\"");
    assert_eq!(finished(&[]), [10.0, 1.0, 2.0, 7.0]);
    // One job each, then the first of equally long queues, then the shorter one.
    assert_eq!(finished(&[assigned]), [10.0, 1.0, 11.0, 6.0]);
    assert_eq!(finished(&[assigned, least]), [10.0, 1.0, 2.0, 7.0]);
    assert!(
        refused(&text.replace("[dispatch]\n", "[dispatch]\nqueue_choice = \"least_work\"\n")).contains("at_arrival")
    );
}

#[test]
fn least_work_and_first_come_first_served_is_one_queue_for_all() {
    let one = exponential(1.0);
    let poisson = "[[arrivals]]\npart = \"job\"\npattern = \"poisson\"\nrate = \"96 1/h\"\n[dispatch]\n";
    let text = shop(&["\"M\"\ncount = 2"], &[("job", &[("M", &one)])], poisson);
    let mean = |set: &[&str]| {
        let log = run(&with(&text, set));
        let stays: Vec<f64> =
            log.jobs.iter().filter(|job| job.finish.is_finite()).map(|job| job.finish - job.arrival).collect();
        assert!(stays.len() > 90_000);
        stays.iter().sum::<f64>() / stays.len() as f64 / 60.0
    };
    let (assigned, least) = ("dispatch.assign=\"at_arrival\"", "dispatch.queue_choice=\"least_work\"");
    let together = mean(&[]);
    assert!((mean(&[assigned, least]) - together).abs() < 1e-6 * together);
    // Mean stays by the Markov chains, min: the shortest of two queues (numerically, up to 90 jobs each), one queue (Erlang C).
    let known = 2.955_737 / 2.777_778;
    let ratio = mean(&[assigned]) / together;
    assert!((ratio / known - 1.0).abs() < 0.01, "{ratio}, not {known}");
}

#[test]
fn machines_are_chosen_by_setup_time_speed_and_use() {
    let text = |time: u32, choice: &str| {
        format!(
            "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"10 h\"\n\
             [[machine]]\nname = \"slow\"\nprocess = \"plain\"\nsetup_at_start = \"a\"\n\
             [[machine]]\nname = \"fast\"\nprocess = \"plain\"\nsetup_at_start = \"b\"\n\
             [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"o\"\nmachines = [\"slow\", \"fast\"]\nwork = \"{time} min\"\n\
             setup_time = \"5 min\"\nsetup_group = \"a\"\ntime_on = {{ slow = 2 }}\nmachine_choice = \"{choice}\"\n{}",
            at_start("p", 1)
        )
    };
    let finish = |time: u32, choice: &str| finishes(&run(&parsed(&text(time, choice))))[0];
    // On the slow one 2 t, on the fast one 5 + t.
    assert_eq!([finish(4, "least_setup"), finish(4, "fastest"), finish(4, "earliest_finish")], [8.0, 9.0, 8.0]);
    assert_eq!([finish(6, "least_setup"), finish(6, "fastest"), finish(6, "earliest_finish")], [12.0, 11.0, 11.0]);
    assert!(refused(&text(4, "fastest").replace("slow = 2", "slwo = 2")).contains("slwo"));
    // One job an hour: the machine that has worked less takes it; by chance each takes about half.
    let hourly = "[[arrivals]]\npart = \"p\"\npattern = \"renewal\"\ntime_between = \"1 h\"\n[dispatch]\n";
    let route: [(&str, &str); 1] = [("M", "\"7 min\"")];
    let text = shop(&["\"M\"\ncount = 2"], &[("p", &route)], hourly);
    let machines = |choice: &str| {
        let log = run(&with(&text, &[&format!("dispatch.machine_choice=\"{choice}\"")]));
        log.operations.iter().map(|row| row.machine).collect::<Vec<u32>>()
    };
    let used = machines("least_used");
    assert!(used.len() > 900 && (0..).zip(&used).all(|(index, machine)| *machine == index % 2));
    let random = machines("random");
    let first = random.iter().filter(|machine| **machine == 0).count() as f64 / random.len() as f64;
    assert!((first - 0.5).abs() < 0.06, "{first}");
    assert_eq!(random, machines("random"));
}

#[test]
fn every_order_of_a_random_routing_is_as_likely() {
    let works: [(&str, &str); 3] = [("A", "\"1 min\""), ("B", "\"1 min\""), ("C", "\"1 min\"")];
    let source = "[[arrivals]]\npart = \"p\"\npattern = \"renewal\"\ntime_between = \"10 min\"\ndue = { rule = \"TWK\", k = 4 }\n";
    let text = shop(&["\"A\"", "\"B\"", "\"C\""], &[("p", &works)], source);
    let log = run(&parsed(&text.replace("name = \"p\"\n", "name = \"p\"\nrouting = \"random\"\n")));
    let mut routes: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    log.operations.iter().for_each(|row| routes.entry(row.job).or_default().push(row.operation));
    let mut counts: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    routes.into_values().filter(|route| route.len() == 3).for_each(|route| *counts.entry(route).or_default() += 1);
    assert_eq!(counts.len(), 6);
    let total: u32 = counts.values().sum();
    let chi: f64 =
        counts.values().map(|own| (f64::from(*own) - f64::from(total) / 6.0).powi(2) / (f64::from(total) / 6.0)).sum();
    assert!(total > 5990 && chi < 20.5, "{chi}"); // 0.1 % of a chi squared of five degrees of freedom
    assert!(log.jobs.iter().all(|job| (job.due - job.arrival - 720.0).abs() < 1e-6));
    assert!(
        refused(&text.replace("name = \"p\"\n", "name = \"p\"\nrouting = \"random\"\n").replace(
            "work = \"1 min\"\n[[part.operation]]\nname = \"2\"",
            "work = \"1 min\"\noutcomes = [{ share = 0.1, go = \"0\" }]\n[[part.operation]]\nname = \"2\""
        ))
        .contains("no fixed routing")
    );
}

/// Mean and standard error over replications.
fn over(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

#[test]
fn rules_of_the_random_job_shop_have_the_published_figures() {
    // Flow time, its standard deviation, tardiness and share tardy, each with half its 95 % interval of 16 replications,
    // of a model of its own after Holthaus and Rajendran; min.
    let known = [
        ("fifo", [(820.6, 13.0), (269.7, 13.0), (56.9, 7.2), (0.254, 0.014)]),
        ("spt", [(619.1, 6.2), (333.1, 12.1), (30.5, 2.8), (0.0787, 0.0040)]),
        ("edd", [(766.7, 9.4), (265.4, 8.0), (17.8, 4.1), (0.134, 0.015)]),
        ("pt_winq", [(617.1, 6.0), (266.7, 10.2), (21.2, 2.5), (0.0790, 0.0046)]),
        ("atc", [(702.7, 7.8), (246.2, 7.5), (6.0, 2.1), (0.0575, 0.0103)]),
    ];
    let text = include_str!("../../../../scenarios/shop/holthaus.toml");
    let replications = 6;
    for (rule, figures) in known {
        let scenario = with(text, &[&format!("dispatch.rule=\"{rule}\"")]);
        let mut found = vec![Vec::new(); 4];
        for replication in 0..replications {
            let log = toolroom_shop::run(&scenario, 0, replication).unwrap();
            let jobs: Vec<_> = log.jobs.iter().skip(2000).filter(|job| job.finish.is_finite()).collect();
            let count = jobs.len() as f64;
            let flows: Vec<f64> = jobs.iter().map(|job| (job.finish - job.arrival) / 60.0).collect();
            let (mean, error) = over(&flows);
            let late: Vec<f64> = jobs.iter().map(|job| ((job.finish - job.due) / 60.0).max(0.0)).collect();
            let tardy = late.iter().filter(|time| **time > 0.0).count() as f64;
            let values = [mean, error * count.sqrt(), late.iter().sum::<f64>() / count, tardy / count];
            found.iter_mut().zip(values).for_each(|(all, value)| all.push(value));
        }
        for (place, ((published, half), values)) in figures.into_iter().zip(&found).enumerate() {
            let (mean, error) = over(values);
            // Student's factor of 15 degrees of freedom makes a half-width of a standard error.
            let both = (error * error + (half / 2.131_f64).powi(2)).sqrt();
            let allowed = if place == 2 { (3.0 * both).max(0.25 * published) } else { 3.0 * both };
            assert!((mean - published).abs() < allowed, "{rule}, figure {place}: {mean}, not {published}");
        }
    }
}

#[test]
fn the_job_shop_of_law_and_kelton_has_its_figures() {
    let scenario = parsed(include_str!("../../../../scenarios/shop/job-shop.toml"));
    let replications = 80;
    let mut flows = vec![Vec::new(); 3];
    let mut finished = Vec::new();
    for replication in 0..replications {
        let log = toolroom_shop::run(&scenario, 0, replication).unwrap();
        let done = || log.jobs.iter().filter(|job| job.finish.is_finite());
        finished.push(done().count() as f64);
        for (part, flows) in (0..).zip(&mut flows) {
            let stays: Vec<f64> =
                done().filter(|job| job.part == part).map(|job| (job.finish - job.arrival) / 3600.0).collect();
            flows.push(stays.iter().sum::<f64>() / stays.len() as f64);
        }
    }
    // Two other models agree on this: means with half their 95 % intervals of 1500 replications; h and jobs.
    for (values, (known, half)) in
        flows.iter().chain([&finished]).zip([(24.11, 0.53), (13.36, 0.21), (32.91, 0.57), (11_578.2, 4.6)])
    {
        let (mean, error) = over(values);
        assert!((mean - known).abs() < 3.0 * (error * error + (half / 1.96_f64).powi(2)).sqrt(), "{mean}, not {known}");
    }
}
