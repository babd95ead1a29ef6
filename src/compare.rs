//! `toolroom compare FILE`: every policy on common random numbers.

use crate::args::CompareArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::{Request, chosen, default_out, perform};
use crate::sweep;
use toolroom_sim::scenario::file::read;

pub fn run(args: &CompareArgs, voice: &Voice) -> Result<(), Failure> {
    if !args.sweep.is_empty() {
        return sweep::run(args, voice);
    }
    let file = read(&args.scenario.file, &args.scenario.changes.overrides())?;
    let mut policies = chosen(&file.scenario, &args.study.policy)?;
    if policies.len() == 1 && policies[0] != 0 {
        policies.insert(0, 0); // one policy by name is compared with the scenario's baseline
    }
    if policies.len() < 2 {
        let help = "add a [[policy]] to the scenario, or use toolroom run";
        return Err(Failure::argument("there is only one policy, nothing to compare", help));
    }
    let input = args.scenario.file.display().to_string();
    let request = Request {
        command: format!("compare {input}"),
        input,
        changes: &args.scenario.changes,
        args: &args.study,
        policies,
        logged: 1,
        out: default_out(&file.scenario.name),
        file,
    };
    perform(&request, voice)
}
