//! `toolroom compare FILE`: every policy on common random numbers.

use crate::args::{Changes, CompareArgs, StudyArgs};
use crate::failure::Failure;
use crate::output::Files;
use crate::shard::{leave, refused};
use crate::speak::Voice;
use crate::study::{Request, chosen, default_out, perform};
use crate::sweep;
use std::path::Path;
use std::sync::Arc;
use toolroom_scenario::file::{ScenarioFile, parse, read};
use toolroom_shards::{self, Computed, Plan, ShardError};
use toolroom_study::study::{KnownRuns, StoredRun, stored_digest, stored_runs};

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
    if let Some(target) = &args.plan {
        return plan(args, &file, &policies, target, voice);
    }
    let request = Request {
        command: format!("compare {input}"),
        input,
        changes: &args.scenario.changes,
        args: &args.study,
        policies,
        logged: 1,
        out: default_out(&file.scenario.name),
        file,
        known: Arc::default(),
    };
    perform(&request, voice)
}

/// `--plan FILE`: the replications cut into shards.
fn plan(
    args: &CompareArgs,
    file: &ScenarioFile,
    policies: &[usize],
    target: &Path,
    voice: &Voice,
) -> Result<(), Failure> {
    if args.study.until.is_some() {
        let help = "give the number with --replications; a precision needs all replications at hand";
        return Err(Failure::argument("--until cannot be planned in shards", help));
    }
    let scenario = &file.scenario;
    let replications = u64::from(scenario.replications);
    let plan = Plan {
        schema: 1,
        kind: "compare".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        name: scenario.name.clone(),
        file: args.scenario.file.display().to_string(),
        directory: String::new(),
        text: file.text.clone(),
        files: Plan::fingerprints(&file.files).map_err(refused)?,
        overrides: args.scenario.changes.overrides(),
        policies: policies.iter().map(|policy| scenario.policies[*policy].name.clone()).collect(),
        seed: scenario.seed,
        pieces: replications,
        shards: args.shards.unwrap_or(replications).min(replications),
    };
    let inputs = file.files.iter().map(AsRef::as_ref).chain([args.scenario.file.as_path()]);
    leave(&plan, target, &Files::new(inputs, voice.force))?;
    let shown = target.display();
    voice.say(format_args!("wrote {shown}: {} shards   next: toolroom shard {shown} 0 --out parts", plan.shards));
    Ok(())
}

/// The scenario of a plan, its policies by index.
fn planned(plan: &Plan) -> Result<(ScenarioFile, Vec<usize>), Failure> {
    let file = parse(&plan.file, &plan.text, &plan.overrides)?;
    let policies = chosen(&file.scenario, &plan.policies)?;
    Ok((file, policies))
}

/// One shard of a planned comparison.
pub fn shard(plan: &Plan, number: u64, out: &Path) -> Result<(), Failure> {
    let (file, policies) = planned(plan)?;
    let mut failed = None;
    let ran = toolroom_shards::run(plan, number, out, |(from, to), _| {
        // Replications are 32-bit numbers by the form of the file.
        let runs = stored_runs(&file.scenario, &policies, from as u32, to as u32).unwrap_or_else(|error| {
            failed = Some(Failure::Work { message: error.to_string() });
            Vec::new()
        });
        if failed.is_some() {
            let source = std::io::Error::other("the shop stopped");
            return Err(ShardError::File { path: out.to_owned(), source });
        }
        let digest = stored_digest(&file.scenario, &policies, (from, to), &runs)
            .map_err(|why| ShardError::Malformed { path: out.to_owned(), why })?;
        Ok(Computed { content: runs, digest, rows: false })
    });
    match failed {
        Some(failure) => Err(failure),
        None => ran.map_err(refused),
    }
}

/// Merges the parts of a planned comparison: the same files and digest as without a plan.
pub fn merge(plan: &Plan, parts: &Path, out: Option<&Path>, voice: &Voice) -> Result<(), Failure> {
    let (file, policies) = planned(plan)?;
    let digest = |runs: &Vec<StoredRun>, range| stored_digest(&file.scenario, &policies, range, runs);
    let runs = toolroom_shards::parts(plan, parts, digest).map_err(refused)?.into_iter().flatten();
    let known: KnownRuns = runs.map(|run| ((run.replication, run.policy), run)).collect();
    let changes = Changes { set: plan.overrides.clone(), ..Changes::default() };
    let args = StudyArgs {
        policy: plan.policies.clone(),
        out: out.map(Path::to_owned),
        threads: 0,
        until: None,
        format: None,
        logged: None,
        records: None,
        resume: false,
        stop_after: None,
    };
    let request = Request {
        command: format!("compare {}", plan.file),
        input: plan.file.clone(),
        changes: &changes,
        args: &args,
        policies,
        logged: 1,
        out: default_out(&file.scenario.name),
        file,
        known: Arc::new(known),
    };
    perform(&request, voice)
}
