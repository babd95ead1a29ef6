//! `toolroom demo`: a shipped shop, no file needed.

use crate::args::DemoArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::{Request, default_out, perform};
use std::path::Path;
use toolroom_scenario_file::read;
use toolroom_study::request::policies_named;

pub fn run(args: &DemoArgs, voice: &Voice) -> Result<(), Failure> {
    let input = if args.shop { "builtin:shop/mixed" } else { "builtin:demo" };
    let file = read(Path::new(input), &args.changes.overrides())?;
    let policies = policies_named(&file.scenario, &args.study.policy)?;
    let request = Request {
        command: "demo".to_owned(),
        input: input.to_owned(),
        changes: &args.changes,
        typed: args.changes.overrides(),
        args: &args.study,
        policies,
        logged: 1,
        out: default_out("demo"),
        file,
        known: std::sync::Arc::default(),
        tuning: None,
        variants: Vec::new(),
        select: None,
        until: args.study.until.clone(),
        primary: None,
        warm_up: None,
    };
    perform(&request, None, voice)?;
    voice.say("your own shop: toolroom new myshop");
    Ok(())
}
