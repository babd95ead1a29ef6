//! `toolroom merge DIR`: the parts of a plan become one result.

use crate::args::MergeArgs;
use crate::failure::Failure;
use crate::life;
use crate::speak::Voice;

pub fn run(args: &MergeArgs, voice: &Voice) -> Result<(), Failure> {
    life::merge(&args.dir, args.out.as_deref(), &args.statistics, voice)
}
