//! `toolroom merge DIR`: the parts of a plan become one result.

use crate::args::MergeArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::{compare, life, lobes};
use toolroom_shards::{Work, read_plan};

pub fn run(args: &MergeArgs, voice: &Voice) -> Result<(), Failure> {
    let plan = read_plan(&args.dir.join("plan.json"))
        .map_err(|error| Failure::located(error, "give the directory into which shards were run with --out"))?;
    plan.check(env!("CARGO_PKG_VERSION"))?;
    match plan.kind {
        Work::Lobes => lobes::merge(&plan, &args.dir, args.out.as_deref(), voice),
        Work::Compare => compare::merge(&plan, &args.dir, args.out.as_deref(), voice),
        Work::Life => life::merge(&plan, &args.dir, args.out.as_deref(), &args.statistics, voice),
    }
}
