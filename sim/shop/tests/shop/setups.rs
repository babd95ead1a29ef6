//! Setups that depend on the sequence, against a published example.

use toolroom_scenario_file::parse;
use toolroom_shop::run;

/// One machine and four jobs that are there at the start; a setup takes as long as the jobs before and after say.
///
/// # Source
/// M. L. Pinedo, Scheduling: Theory, Algorithms, and Systems, example 14.2.1; the instance `01x04setups` of jasima.
const JOBS: &str = r#"
schema = 1
[shop]
name = "sequence"
horizon = "10 h"
[[setup_matrix]]
name = "changes"
groups = ["1", "2", "3", "4"]
times = [
    ["1 min", "1 min", "3 min", "4 min"],
    ["0 min", "4 min", "1 min", "3 min"],
    ["0 min", "0 min", "1 min", "0 min"],
    ["1 min", "2 min", "0 min", "3 min"],
    ["4 min", "3 min", "1 min", "0 min"],
]
[[machine]]
name = "M"
process = "plain"
setup_matrix = "changes"
setup_at_start = ""
[[part]]
name = "1"
operation = [{ name = "cut", machines = "M", work = "13 min" }]
[[part]]
name = "2"
operation = [{ name = "cut", machines = "M", work = "9 min" }]
[[part]]
name = "3"
operation = [{ name = "cut", machines = "M", work = "13 min" }]
[[part]]
name = "4"
operation = [{ name = "cut", machines = "M", work = "10 min" }]
[[order]]
id = "1"
part = "1"
[[order]]
id = "2"
part = "2"
[[order]]
id = "3"
part = "3"
[[order]]
id = "4"
part = "4"
"#;

#[test]
fn a_sequence_of_setups_ends_when_the_published_one_does() {
    for (rule, makespan, flow) in [("spt", 51.0, 118.0), ("fifo", 54.0, 136.0), ("least_setup", 49.0, 130.0)] {
        let file = parse("jobs.toml", JOBS, &[format!("dispatch.rule={rule}")]);
        let scenario = file.unwrap_or_else(|error| panic!("{error}")).scenario;
        let log = run(&scenario, 0, 0).unwrap();
        let ends: Vec<f64> = log.jobs.iter().map(|job| job.finish / 60.0).collect();
        assert_eq!(ends.iter().copied().fold(0.0, f64::max), makespan, "{rule}: {ends:?}");
        assert_eq!(ends.iter().sum::<f64>(), flow, "{rule}: {ends:?}");
    }
}

#[test]
fn a_machine_may_stand_ready_for_a_group_that_nothing_has() {
    // The row of "4", which only a part without orders would have: 4 min to "1", and not the 1 min of the first row.
    let (jobs, _) = JOBS.split_once("[[part]]\nname = \"2\"").expect("parts");
    let text = format!("{jobs}[[order]]\nid = \"1\"\npart = \"1\"\n");
    for (at_start, end) in [("", 14.0), ("4", 17.0), ("2", 13.0)] {
        let file = parse("jobs.toml", &text, &[format!("machine.M.setup_at_start=\"{at_start}\"")]);
        let scenario = file.unwrap_or_else(|error| panic!("{error}")).scenario;
        assert_eq!(run(&scenario, 0, 0).unwrap().jobs[0].finish / 60.0, end, "ready for \"{at_start}\"");
    }
}
