//! Tool lives: studies, fits, their shards.

use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct LifeArgs {
    /// Study file
    #[arg(required_unless_present_any = ["fit", "run"], conflicts_with_all = ["fit", "run"])]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub shards: Shards,
    /// Fit laws to measured lives, or to wear readings with --wear
    #[arg(long, value_name = "CSV", conflicts_with = "run")]
    pub fit: Option<PathBuf>,
    #[command(flatten)]
    pub readings: Readings,
    /// Regress ln(life) on a column, on ln(COLUMN), or on COLUMN=VALUE, repeatable
    #[arg(long, value_name = "COLUMN", requires = "fit")]
    pub regress: Vec<String>,
    #[command(flatten)]
    pub statistics: Statistics,
    /// Directory of the results, out/NAME if left out; of the parts with --run
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// How a study is run.
#[derive(Args, Clone, Debug)]
pub struct Shards {
    /// Replace a value of the study: path=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE", conflicts_with_all = ["fit", "run"])]
    pub set: Vec<String>,
    /// Lives of every condition under every policy, instead of the study's
    #[arg(long, conflicts_with_all = ["fit", "run"])]
    pub lives: Option<u64>,
    /// Write a plan instead of running
    #[arg(long, value_name = "FILE", conflicts_with_all = ["fit", "run"])]
    pub plan: Option<PathBuf>,
    /// Number of shards
    #[arg(long, conflicts_with_all = ["fit", "run"], value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub shards: Option<u64>,
    /// Run one shard of a plan
    #[arg(long, value_name = "PLAN", requires_all = ["shard", "out"])]
    pub run: Option<PathBuf>,
    /// Its number, from 0
    #[arg(long, requires = "run")]
    pub shard: Option<u64>,
    /// Go on with a study that was stopped
    #[arg(long, conflicts_with_all = ["fit", "run", "plan"])]
    pub resume: bool,
    /// Threads, 0 for one per processor; the results do not depend on it
    #[arg(long, default_value_t = 0, value_parser = crate::threads())]
    pub threads: usize,
}

#[derive(Args, Debug)]
pub struct ShardArgs {
    /// Plan
    pub plan: PathBuf,
    /// Number of the shard, from 0
    pub shard: u64,
    /// Directory of the parts
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Threads, 0 for one per processor; the results do not depend on it
    #[arg(long, default_value_t = 0, value_parser = crate::threads())]
    pub threads: usize,
}

#[derive(Args, Debug)]
pub struct MergeArgs {
    /// Directory of the parts
    pub dir: PathBuf,
    #[command(flatten)]
    pub statistics: Statistics,
    /// Directory of the results, out/NAME if left out
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Wear readings that become lives.
#[derive(Args, Clone, Debug)]
pub struct Readings {
    /// Column of wear readings: the life is the age at which they reach --limit
    #[arg(long, value_name = "COLUMN", requires_all = ["limit", "edge", "age"])]
    pub wear: Option<String>,
    /// Wear at which an edge is spent, in the unit of the column
    #[arg(long, value_name = "WEAR", requires = "wear")]
    pub limit: Option<f64>,
    /// Column that names the edge, repeatable
    #[arg(long, value_name = "COLUMN", requires = "wear")]
    pub edge: Vec<String>,
    /// Column of the age
    #[arg(long, value_name = "COLUMN", requires = "wear")]
    pub age: Option<String>,
    /// Column of the group
    #[arg(long, value_name = "COLUMN", requires = "wear")]
    pub group: Option<String>,
    /// Take the life as lying between two readings instead of interpolating
    #[arg(long, requires = "wear")]
    pub between: bool,
}

/// What is worked out of lives.
#[derive(Args, Clone, Debug)]
pub struct Statistics {
    /// Cost of a planned replacement and of a failure, in any money; 1 and 5 if left out
    #[arg(long, num_args = 2, value_names = ["PLANNED", "FAILURE"])]
    pub costs: Vec<f64>,
    /// Confidence of intervals and bands
    #[arg(long, default_value_t = 0.9, value_parser = confidence)]
    pub confidence: f64,
    /// Resampled refits behind the bands
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    pub bootstrap: u32,
    /// Samples behind the p of each fit, 0 for none
    #[arg(long, default_value_t = 199, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    pub goodness: u32,
    /// Seed of every random stream
    #[arg(long)]
    pub seed: Option<u64>,
}

/// A confidence between 50 and 99.9 %: `0.9`, `90 %`.
pub fn confidence(text: &str) -> Result<f64, String> {
    let share = match text.trim().strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().map(|percent| percent / 100.0),
        None => text.trim().parse(),
    };
    match share {
        Ok(share) if (0.5..=0.999).contains(&share) => Ok(share),
        _ => Err("a confidence from 0.5 to 0.999 is due, such as 0.9 or 90%".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_confidence_is_read_as_people_write_it() {
        assert_eq!([confidence("0.9"), confidence("90%"), confidence("90 %")], [Ok(0.9), Ok(0.9), Ok(0.9)]);
        assert!(["0", "1", "9", "x"].iter().all(|text| confidence(text).is_err()));
    }
}
