//! `toolroom merge DIR`: the parts of a plan become one result.

use crate::args::MergeArgs;
use crate::failure::Failure;
use crate::shard::checked;
use crate::speak::Voice;
use crate::{compare, life, lobes};
use toolroom_shards::read_plan;

pub fn run(args: &MergeArgs, voice: &Voice) -> Result<(), Failure> {
    let plan = read_plan(&args.dir.join("plan.json"))
        .map_err(|error| Failure::argument(error, "give the directory into which shards were run with --out"))?;
    checked(&plan)?;
    match plan.kind.as_str() {
        "lobes" => lobes::merge(&plan, &args.dir, args.out.as_deref(), voice),
        "compare" => compare::merge(&plan, &args.dir, args.out.as_deref(), voice),
        _ => life::merge(&plan, &args.dir, args.out.as_deref(), &args.statistics, voice),
    }
}
