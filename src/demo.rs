//! `toolroom demo`: the shipped shop, no file needed.

use crate::args::DemoArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::{Request, default_out, perform};
use toolroom_scenario_file::parse;
use toolroom_study::request::policies_named;

/// Three lathes, two mills, a grinder, one shift.
const SCENARIO: &str = include_str!("../scenarios/demo.toml");

pub fn run(args: &DemoArgs, voice: &Voice) -> Result<(), Failure> {
    let file = parse("demo.toml", SCENARIO, &args.changes.overrides())?;
    let policies = policies_named(&file.scenario, &args.study.policy)?;
    let request = Request {
        command: "demo".to_owned(),
        input: "demo.toml".to_owned(),
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
