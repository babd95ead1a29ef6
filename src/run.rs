//! `toolroom run FILE`: policies with full logs.

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::{Request, default_out, perform};
use crate::warm_up::settle;
use toolroom_scenario_file::read;
use toolroom_study::request::policies_named;

pub fn run(args: &RunArgs, voice: &Voice) -> Result<(), Failure> {
    let mut file = read(&args.scenario.file, &args.scenario.changes.overrides())?;
    let policies = policies_named(&file.scenario, &args.study.policy)?;
    let out = default_out(&file.scenario.name);
    let target = args.study.out.as_deref().unwrap_or(&out);
    let warm_up = settle(&mut file, &mut [], &policies, &args.study, target, voice)?;
    let input = args.scenario.file.display().to_string();
    let request = Request {
        command: format!("run {input}"),
        input,
        changes: &args.scenario.changes,
        args: &args.study,
        policies,
        logged: file.scenario.replications,
        out,
        file,
        known: std::sync::Arc::default(),
        tuning: None,
        variants: Vec::new(),
        select: None,
        warm_up,
    };
    perform(&request, None, voice)
}
