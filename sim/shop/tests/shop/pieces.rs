//! Pieces that are not all alike, sources of several parts, samples, and lost pieces that begin anew.

use crate::scenarios;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::run;
use toolroom_shop::runlog::{JobOutcome, MachineState, OperationResult, RunLog};

const HEAD: &str = "schema = 1\n[shop]\nname = \"pieces\"\nhorizon = \"1000 h\"\n\
    [[machine]]\nname = \"M\"\nprocess = \"plain\"\n[[machine]]\nname = \"N\"\nprocess = \"plain\"\n";

fn parsed(text: &str) -> Scenario {
    parse("pieces.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).scenario
}

/// One operation of a part `p` on `M`, and what comes to it.
fn station(part: &str, operation: &str, comes: &str) -> Scenario {
    parsed(&format!(
        "{HEAD}[[part]]\nname = \"p\"\n{part}\n[[part.operation]]\nname = \"do\"\nmachines = \"M\"\n{operation}\n{comes}"
    ))
}

/// Minutes from the start to the end of the last job.
fn end(log: &RunLog) -> f64 {
    log.jobs.iter().map(|job| job.finish).fold(0.0, f64::max) / 60.0
}

/// Minutes that machine number `machine` works.
fn worked(log: &RunLog, machine: u32) -> f64 {
    scenarios::time_in(log, machine, MachineState::Working) / 60.0
}

#[test]
fn pieces_drawn_one_by_one_spread_less_than_a_lot() {
    let order = |draw: &str, quantity: u32, more: &str| {
        let work = format!("work = {{ distribution = \"exponential\", mean = \"1 min\" }}\n{draw}");
        station("", &work, &format!("[[order]]\nid = \"O\"\npart = \"p\"\nquantity = {quantity}\n{more}"))
    };
    let spread = |shop: &Scenario| {
        let ends: Vec<f64> = (0..600).map(|replication| end(&run(shop, 0, replication).unwrap())).collect();
        let mean = ends.iter().sum::<f64>() / 600.0;
        (mean, (ends.iter().map(|end| (end - mean).powi(2)).sum::<f64>() / 599.0).sqrt())
    };
    // Of 50 pieces of 1 ± 1 min: 50 times the same draw, or the sum of 50; limits of four standard errors.
    let (mean, deviation) = spread(&order("", 50, ""));
    assert!((mean - 50.0).abs() < 8.2 && (deviation - 50.0).abs() < 12.0, "{mean} {deviation}");
    let apart = order("draw = \"part\"", 50, "");
    let (mean, deviation) = spread(&apart);
    let root = 50.0f64.sqrt();
    assert!((mean - 50.0).abs() < 1.2 && (deviation - root).abs() < 0.9, "{mean} {deviation}");
    // A piece has its time whatever moves together, and the first one that of the lot.
    let batches = order("draw = \"part\"", 50, "transfer = 7");
    let ends = [&apart, &batches].map(|shop| end(&run(shop, 0, 3).unwrap()));
    assert!((ends[0] - ends[1]).abs() < 1e-9, "{ends:?}");
    let one = [order("", 1, ""), order("draw = \"part\"", 1, "")].map(|shop| end(&run(&shop, 0, 3).unwrap()));
    assert_eq!(one[0], one[1]);
}

#[test]
fn a_source_brings_its_parts_by_their_shares_and_pieces_by_their_numbers() {
    let text = |rule: &str| {
        format!(
            "{HEAD}[dispatch]\nrule = \"{rule}\"\n[[part]]\nname = \"a\"\noperation = [{{ name = \"do\", machines = \"M\", work = \"1 min\" }}]\n\
             [[part]]\nname = \"b\"\noperation = [{{ name = \"do\", machines = \"M\", work = \"2 min\" }}]\n\
             [[arrivals]]\npart_mix = {{ b = 0.3, a = 0.7 }}\npattern = \"poisson\"\nrate = \"10 1/h\"\nquantity = {{ low = 1, high = 3 }}\n"
        )
    };
    let log = run(&parsed(&text("fifo")), 0, 0).unwrap();
    let (count, of_b) = (log.jobs.len() as f64, log.jobs.iter().filter(|job| job.part == 1).count() as f64);
    // Some 10 000 jobs: four standard errors of the share are 0.018, of the mean number of pieces 0.033.
    assert!((count - 10_000.0).abs() < 400.0 && (of_b / count - 0.3).abs() < 0.018, "{of_b} of {count}");
    let pieces: u32 = log.jobs.iter().map(|job| job.quantity).sum();
    assert!((f64::from(pieces) / count - 2.0).abs() < 0.033, "{pieces} pieces");
    for row in log.operations.iter().filter(|row| row.end.is_finite()) {
        let unit = if row.part == 0 { 60.0 } else { 120.0 };
        assert!((row.end - row.start - unit * f64::from(row.quantity)).abs() < 1e-6, "{row:?}");
    }
    // The same jobs come whatever the rule.
    let jobs = |log: &RunLog| log.jobs.iter().map(|job| (job.part, job.quantity)).collect::<Vec<_>>();
    assert_eq!(jobs(&log), jobs(&run(&parsed(&text("lpt")), 0, 0).unwrap()));
}

#[test]
fn due_dates_may_be_drawn() {
    let comes = "[[arrivals]]\npart = \"p\"\npattern = \"schedule\"\nlot = [{ time = \"1 h\", size = 400 }]\n\
        due = { rule = \"random\", allowance = { distribution = \"uniform\", low = \"2 h\", high = \"4 h\" } }\n";
    let log = run(&station("", "work = \"1 min\"", comes), 0, 0).unwrap();
    let hours: Vec<f64> = log.jobs.iter().map(|job| (job.due - job.arrival) / 3600.0).collect();
    assert!(hours.iter().all(|time| (2.0..4.0).contains(time)));
    let mean = hours.iter().sum::<f64>() / 400.0;
    assert!((mean - 3.0).abs() < 4.0 * (4.0f64 / 12.0 / 400.0).sqrt(), "{mean}");
}

#[test]
fn only_the_sample_is_measured() {
    let part = |transfer: &str, quantity: u32| {
        parsed(&format!(
            "{HEAD}[[part]]\nname = \"p\"\noperation = [{{ name = \"turn\", machines = \"M\", work = \"1 min\" }}, \
             {{ name = \"measure\", machines = \"N\", work = \"4 min\", sample = {{ every = 5, others = \"pass\" }} }}]\n\
             [[order]]\nid = \"O\"\npart = \"p\"\nquantity = {quantity}\n{transfer}"
        ))
    };
    // Of eleven pieces the first, the sixth and the eleventh.
    let together = run(&part("", 11), 0, 0).unwrap();
    assert_eq!((worked(&together, 1), end(&together)), (12.0, 23.0));
    // One by one: measured at 1 to 5, 6 to 10, 11 to 15 min; the others are done when they are turned.
    let apart = run(&part("transfer = 1", 11), 0, 0).unwrap();
    let ends: Vec<f64> = apart.jobs.iter().map(|job| job.finish / 60.0).collect();
    assert_eq!(ends, [5.0, 2.0, 3.0, 4.0, 5.0, 10.0, 7.0, 8.0, 9.0, 10.0, 15.0]);
    assert_eq!(worked(&apart, 1), 12.0);
}

#[test]
fn only_the_sample_is_judged() {
    let work = "work = \"1 min\"\noutcomes = [{ share = 1.0, scrap = true }]\nsample = { every = 4 }";
    let shop = station("", work, "[[order]]\nid = \"O\"\npart = \"p\"\nquantity = 10\n");
    let log = run(&shop, 0, 0).unwrap();
    let pieces = |outcome: JobOutcome| -> u32 {
        log.jobs.iter().filter(|job| job.outcome == outcome).map(|job| job.quantity).sum()
    };
    // The first, the fifth and the ninth.
    assert_eq!((pieces(JobOutcome::Rejected), pieces(JobOutcome::Good), worked(&log, 0)), (3, 7, 10.0));
}

#[test]
fn pieces_keep_their_times_when_an_inspection_divides_them() {
    // Half of twenty pieces are lost after the first operation; the others take the times that were drawn for them.
    let text = format!(
        "{HEAD}[[part]]\nname = \"p\"\noperation = [{{ name = \"turn\", machines = \"M\", work = \"1 min\", outcomes = [{{ share = 0.5, go = \"turn\" }}] }}, \
         {{ name = \"grind\", machines = \"N\", draw = \"part\", work = {{ distribution = \"exponential\", mean = \"4 min\" }} }}]\n\
         [[order]]\nid = \"O\"\npart = \"p\"\nquantity = 20\n"
    );
    let whole = parsed(&text.replace("share = 0.5", "share = 0.0"));
    for replication in 0..20 {
        let (divided, whole) = (run(&parsed(&text), 0, replication).unwrap(), run(&whole, 0, replication).unwrap());
        assert!(divided.jobs.len() > 1);
        // What is worked on in all is the same sum of twenty times.
        assert!((worked(&divided, 1) - worked(&whole, 1)).abs() < 1e-6);
    }
}

#[test]
fn rejected_parts_that_are_cut_go_back_until_that_is_enough() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/cell.toml");
    // No part is within a tolerance of ten nanometres.
    let tight =
        ["part.ring.operation.turn.size_tolerance=\"0.01 um\"", "shop.horizon=\"16 h\"", "shop.warm_up=\"0 h\""];
    let log_with = |more: &[&str]| {
        let changes: Vec<String> = tight.iter().chain(more).map(|&change| change.to_owned()).collect();
        let scenario = toolroom_scenario_file::read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{error}"));
        run(&scenario.scenario, 0, 0).unwrap()
    };
    /// Jobs that were scrapped for their size, each with how often it had been sent back.
    fn scrapped(log: &RunLog) -> Vec<usize> {
        let out =
            (0..log.jobs.len() as u32).filter(|job| log.jobs[*job as usize].outcome == JobOutcome::OutOfTolerance);
        let sent_back = |job: u32| {
            log.operations.iter().filter(|row| row.job == job && row.result == OperationResult::Rework).count()
        };
        out.map(sent_back).collect()
    }
    let at_once = scrapped(&log_with(&[]));
    assert!(at_once.len() > 20 && at_once.iter().all(|back| *back == 0), "{at_once:?}");
    let back = ["part.ring.operation.turn.on_reject={ go = \"turn\" }", "part.ring.operation.turn.rework_max=2"];
    let later = scrapped(&log_with(&back));
    assert!(later.len() > 5 && later.iter().all(|back| *back == 2), "{later:?}");
}

#[test]
fn lost_pieces_begin_anew_at_once() {
    // A shift of 40 minutes at whose end what is in work is lost. Thirty minutes of work that come at 20 are lost at 40;
    // their successor comes in that instant, begins with the next shift at 100 and is done at 130.
    let text = |replenish: &str| {
        format!(
            "schema = 1\n[shop]\nname = \"anew\"\nhorizon = \"20 h\"\n[[calendar]]\nname = \"short\"\nperiod = \"100 min\"\n\
             shift = [{{ start = \"0 min\", end = \"40 min\" }}]\nat_end = \"scrap\"\n\
             [[machine]]\nname = \"M\"\nprocess = \"plain\"\ncalendar = \"short\"\n[[part]]\nname = \"p\"\n{replenish}\n\
             operation = [{{ name = \"do\", machines = \"M\", work = \"30 min\", work_per = \"lot\" }}]\n\
             [[order]]\nid = \"O\"\npart = \"p\"\nquantity = 5\nrelease = \"20 min\"\npriority = 3\n"
        )
    };
    let jobs = |replenish: &str| {
        let log = run(&parsed(&text(replenish)), 0, 0).unwrap();
        log.jobs
            .iter()
            .map(|job| (job.arrival / 60.0, job.finish / 60.0, job.quantity, job.outcome))
            .collect::<Vec<_>>()
    };
    let lost = (20.0, 40.0, 5, JobOutcome::ShiftEnd);
    assert_eq!(jobs(""), [lost]);
    assert_eq!(jobs("replenish = \"new_order\""), [lost, (40.0, 130.0, 5, JobOutcome::Good)]);
    // An order that moves in batches: the last one is lost at 40 and made again.
    let apart = text("replenish = \"new_order\"\nreplenish_priority = -1")
        .replace("work = \"30 min\", work_per = \"lot\"", "work = \"3 min\"")
        .replace("quantity = 5", "quantity = 9\ntransfer = 1");
    let log = run(&parsed(&apart), 0, 0).unwrap();
    let good: u32 = log.jobs.iter().filter(|job| job.outcome == JobOutcome::Good).map(|job| job.quantity).sum();
    assert_eq!((good, log.jobs.len()), (9, 10));
    // Six pieces from 20 to 38, the seventh is lost; three from 100 to 109.
    assert_eq!(end(&log), 109.0);
}

#[test]
fn an_order_begins_with_its_overrun() {
    let order = "[[order]]\nid = \"O\"\npart = \"p\"\nquantity = 10\n";
    let log = run(&station("replenish = { overrun = 0.15 }", "work = \"1 min\"", order), 0, 0).unwrap();
    assert_eq!((log.jobs[0].quantity, end(&log)), (12, 12.0));
}
