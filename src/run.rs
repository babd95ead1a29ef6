//! `toolroom run FILE`: policies with full logs.

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::{Request, default_out, perform};
use toolroom_scenario::file::read;
use toolroom_study::request::policies_named;

pub fn run(args: &RunArgs, voice: &Voice) -> Result<(), Failure> {
    let file = read(&args.scenario.file, &args.scenario.changes.overrides())?;
    let policies = policies_named(&file.scenario, &args.study.policy)?;
    let input = args.scenario.file.display().to_string();
    let request = Request {
        command: format!("run {input}"),
        input,
        changes: &args.scenario.changes,
        args: &args.study,
        policies,
        logged: file.scenario.replications,
        out: default_out(&file.scenario.name),
        file,
        known: std::sync::Arc::default(),
        tuning: None,
        variants: Vec::new(),
        select: None,
    };
    perform(&request, None, voice)
}
