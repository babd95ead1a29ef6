//! `toolroom shard PLAN K`: one shard of a plan, whatever it plans.

use crate::args::ShardArgs;
use crate::failure::Failure;
use crate::plan::pool;
use crate::speak::Voice;
use std::fs;
use std::path::Path;
use toolroom_output::signals::{Begun, keeps, tidy};
use toolroom_shards::{ShardError, Work, read_plan, write_plan};
use toolroom_study::planned;

pub fn run(args: &ShardArgs, voice: &Voice) -> Result<(), Failure> {
    perform(&args.plan, args.shard, &args.out, args.threads, voice)
}

/// The shard that `--run`, `--shard` and `--out` of a verb name.
pub fn of_plan(
    plan: Option<&Path>,
    number: Option<u64>,
    out: Option<&Path>,
    threads: usize,
    voice: &Voice,
) -> Result<(), Failure> {
    let (Some(plan), Some(number), Some(out)) = (plan, number, out) else {
        let help = "write --run plan.json --shard 0 --out parts";
        return Err(Failure::argument("--run needs --shard and --out", help));
    };
    perform(plan, number, out, threads, voice)
}

/// Runs a shard and leaves the plan beside its part.
fn perform(path: &Path, number: u64, folder: &Path, threads: usize, voice: &Voice) -> Result<(), Failure> {
    let plan = read_plan(path)?;
    plan.check(env!("CARGO_PKG_VERSION"))?;
    fs::create_dir_all(folder).map_err(|source| Failure::Unwritable { path: folder.to_owned(), source })?;
    let there = folder.join("plan.json");
    if there.exists() {
        let other = read_plan(&there)?;
        if other.hash() != plan.hash() {
            let error = ShardError::OtherPlan { path: there, found: other.hash(), expected: plan.hash() };
            return Err(error.into());
        }
    } else {
        write_plan(&there, &plan)?;
    }
    let threads = pool(threads)?;
    // A part is there as a whole or not at all.
    let _tidy = tidy(Begun::Partials(folder.to_owned()));
    let message = format!("interrupted: shard {number} is not in {}; parts that are there stay", folder.display());
    keeps(message, "run the shard again".to_owned());
    threads.install(|| match plan.kind {
        Work::Compare => Ok(planned::shard(&plan, number, folder)?),
        Work::Lobes => crate::lobes::shards::shard(&plan, number, folder),
        Work::Life => crate::life::study::shard(&plan, number, folder),
    })?;
    voice.say(format_args!("shard {number} of {} is in {}", plan.shards, folder.display()));
    Ok(())
}
