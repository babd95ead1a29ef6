//! Machines with a time of their own for plain work: the rank of a job is turned into a time by the machine.

use crate::scenarios::run;
use toolroom_scenario::Scenario;
use toolroom_scenario_file::parse;
use toolroom_shop::runlog::OperationRow;

/// Jobs or orders of two pieces that are worked on by `machines`; B has a time of its own.
fn shop(machines: &str, own: &str, operation: &str, jobs: &str) -> Result<Scenario, String> {
    let text = format!(
        "schema = 1\n[shop]\nname = \"t\"\nhorizon = \"1000 h\"\n\
         [[machine]]\nname = \"A\"\nprocess = \"plain\"\n[[machine]]\nname = \"B\"\nprocess = \"plain\"\n\
         [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"o\"\nmachines = {machines}\n\
         work = {{ distribution = \"exponential\", mean = \"10 min\" }}\n{operation}time_on = {{ B = {own} }}\n{jobs}"
    );
    parse("scenario.toml", &text, &[]).map(|file| file.scenario).map_err(|error| format!("{error}: {error:?}"))
}

const SOURCE: &str = "[[arrivals]]\npart = \"p\"\nquantity = 2\npattern = \"renewal\"\ntime_between = \"5 h\"\n";

/// Two orders, one of which moves on piece by piece.
const ORDERS: &str = "[[order]]\npart = \"p\"\ndue = \"9 h\"\nid = \"a\"\nquantity = 2\n\
                      [[order]]\npart = \"p\"\ndue = \"9 h\"\nid = \"b\"\nquantity = 3\ntransfer = 1\n";

/// Times of all operations in the order of jobs, min.
fn times(scenario: &Scenario) -> Vec<(u32, f64)> {
    let log = run(scenario);
    let done = log.operations.iter().filter(|row| row.end.is_finite());
    let time = |row: &OperationRow| (row.job, (row.end - row.start) / 60.0 / f64::from(row.quantity));
    let mut rows: Vec<(u32, f64)> = done.map(time).collect();
    assert!(rows.len() > 1);
    rows.sort_by_key(|(job, _)| *job);
    rows
}

#[test]
fn a_machine_turns_the_rank_of_a_job_into_a_time_by_its_own_distribution() {
    let uniform = "{ distribution = \"uniform\", low = \"2 min\", high = \"4 min\" }";
    for jobs in [SOURCE, ORDERS] {
        let times_on = |machine: &str, own: &str| times(&shop(machine, own, "", jobs).unwrap());
        // B is named by `time_on` and has to be one of the machines: it is down to its choice by `first`.
        let on_a = times_on("[\"A\", \"B\"]\nmachine_choice = \"first\"", "1");
        let on_b = times_on("[\"B\"]", uniform);
        assert_eq!(on_a.len(), on_b.len());
        for ((_, a), (_, b)) in on_a.iter().zip(&on_b) {
            let rank = 1.0 - (-a / 10.0).exp();
            assert!((b - (2.0 + 2.0 * rank)).abs() < 1e-9, "{a} {b}");
        }
        // A factor, and a duration for all.
        let twice = times_on("[\"B\"]", "2");
        assert!(on_a.iter().zip(&twice).all(|((_, a), (_, b))| (2.0 * a - b).abs() < 1e-9));
        assert!(times_on("[\"B\"]", "\"7 min\"").iter().all(|(_, time)| (time - 7.0).abs() < 1e-9));
    }
}

#[test]
fn choices_of_machines_know_the_mean_and_batches_the_rank() {
    // The mean on B is 3 min, on A 10: the fastest machine is B, and a factor that makes it slow is not asked.
    let uniform = "{ distribution = \"uniform\", low = \"2 min\", high = \"4 min\" }";
    let fastest = shop("[\"A\", \"B\"]\nmachine_choice = \"fastest\"", uniform, "", SOURCE).unwrap();
    assert!(run(&fastest).operations.iter().all(|row| row.machine == 1));
    let lot = shop("[\"B\"]", uniform, "work_per = \"lot\"\n", SOURCE).unwrap();
    assert!(times(&lot).iter().all(|(_, time)| (1.0..2.0).contains(time))); // of a lot of two pieces, by piece
}

#[test]
fn times_of_machines_that_make_no_sense_are_refused() {
    let refused = |own: &str, operation: &str| shop("[\"B\"]", own, operation, SOURCE).unwrap_err();
    assert!(refused("-1", "").contains("number above 0"));
    assert!(refused("\"5 m\"", "").contains("5 m"));
    assert!(refused("{ distribution = \"uniform\", low = \"4 min\", high = \"2 min\" }", "").contains("ascending"));
    assert!(refused("true", "").contains("a factor, a duration or a table"));
    assert!(refused("\"5 min\"", "draw = \"part\"\n").contains("draw"));
    assert!(shop("[\"A\"]", "2", "", SOURCE).unwrap_err().contains("does not do the operation"));
}
