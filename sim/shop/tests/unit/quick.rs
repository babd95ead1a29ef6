//! Machines with nothing but plain work against the engine for all machines, whose layout only the crate itself can change.

use super::super::{RunLog, run};
use super::*;
use std::sync::Arc;
use toolroom_scenario::Scenario;
use toolroom_scenario::policies::ResolvedPolicy;

/// A shop of four machines, some of them with setups, under a rule; the part is drawn by its number.
fn shop(rule: &str, setups: bool) -> Scenario {
    let mut text = format!(
        "schema = 1\n[shop]\nname = \"quick\"\nhorizon = \"40 h\"\nwarm_up = \"3 h\"\n[dispatch]\nrule = \"{rule}\"\n"
    );
    for machine in 0..4 {
        text += &format!("[[machine]]\nname = \"M{machine}\"\nprocess = \"plain\"\n");
        if setups && machine % 2 == 1 {
            text += "setup_time = \"2 min\"\n";
        }
    }
    for part in 0..5 {
        text += &format!("[[part]]\nname = \"P{part}\"\noperation = [\n");
        for step in 0..4 {
            let (machine, mean) = ((part * 3 + step * (part % 2 + 1)) % 4, 2 + (part + step) % 3);
            let work = match step {
                2 => "\"3 min\"".to_owned(),
                3 if part == 4 => "\"0 min\"".to_owned(),
                _ => format!("{{ distribution = \"exponential\", mean = \"{mean} min\" }}"),
            };
            text += &format!(
                "{{ name = \"{step}\", machines = \"M{machine}\", work = {work}, setup_group = \"{part}\" }},\n"
            );
        }
        text +=
            &format!("]\n[[arrivals]]\npart = \"P{part}\"\npattern = \"poisson\"\nrate = \"{} 1/h\"\n", 2 + part % 2);
    }
    let file = toolroom_scenario_file::parse("quick.toml", &text, &[]);
    file.unwrap_or_else(|error| panic!("{error:?}")).scenario
}

#[test]
fn quick_machines_leave_the_log_of_all_steps_one_by_one() {
    for (rule, setups) in [("fifo", false), ("fifo", true), ("spt", false), ("cr", true), ("least_setup", true)] {
        let scenario = shop(rule, setups);
        let policy = Arc::new(ResolvedPolicy::from_scenario(&scenario, 0).unwrap());
        let mut slow = Shop::with_recorder(&scenario, policy, 0, RunLog::default()).unwrap();
        let layout = Arc::make_mut(&mut slow.layout);
        assert!(layout.machine_plans.iter().all(|plan| plan.is_quick));
        layout.machine_plans.iter_mut().for_each(|plan| (plan.is_quick, plan.one_step) = (false, false));
        let log = run(&scenario, 0, 0).unwrap();
        assert!(log.operations.len() > 1000, "{}", log.operations.len());
        // NaN in rows: compared as they are written.
        assert_eq!(format!("{log:?}"), format!("{:?}", slow.run().unwrap()), "{rule}");
    }
}
