//! `toolroom life`: tool lives, measured or simulated.

mod fit;
pub mod study;

use crate::args::{LifeArgs, Statistics};
use crate::failure::Failure;
use crate::shard;
use crate::speak::Voice;
use toolroom_life::analysis::Request;
use toolroom_life::replacement::Costs;

pub use study::merge;

pub fn run(args: &LifeArgs, voice: &Voice) -> Result<(), Failure> {
    match (&args.fit, &args.file) {
        (Some(csv), _) => fit::run(args, csv, voice),
        (None, Some(file)) => study::run(args, file, voice),
        (None, None) => {
            let shards = &args.shards;
            shard::of_plan(shards.run.as_deref(), shards.shard, args.out.as_deref(), shards.threads, voice)
        }
    }
}

/// What the arguments ask for; `costs` are those of a study file.
fn request(statistics: &Statistics, costs: Option<Costs>) -> Result<Request, Failure> {
    let costs = match statistics.costs[..] {
        [planned, failure] => Costs { planned, failure },
        _ => costs.unwrap_or(Request::default().costs),
    };
    let Costs { planned, failure } = costs;
    if !(planned > 0.0 && failure.is_finite() && failure >= planned) {
        let message = format!("--costs {planned} {failure}: a failure costs at least as much as a planned replacement");
        return Err(Failure::argument(message, "write both in one money, for example --costs 1 5"));
    }
    Ok(Request {
        confidence: statistics.confidence,
        bootstrap: statistics.bootstrap,
        goodness: statistics.goodness,
        costs,
        seed: statistics.seed.unwrap_or(1),
        ..Request::default()
    })
}
