//! Arguments of `toolroom lobes`.

use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;
use toolroom_planning::lobes::MapKind;

#[derive(Args, Debug)]
pub struct LobesArgs {
    /// Lobes file
    #[arg(required_unless_present = "run", conflicts_with = "run")]
    pub file: Option<PathBuf>,
    /// Verdict at this point alone: the values of the two axes, such as spindle speed and depth of cut
    #[arg(long, num_args = 2, value_names = ["SPEED", "DEPTH"], allow_hyphen_values = true)]
    pub at: Vec<String>,
    /// Frequency responses (CSV or universal file, at several spindle speeds too) whose own limit stands beside that of the
    /// modes, at a point or over the chart
    #[arg(long, value_name = "FRF", conflicts_with_all = ["plan", "run", "pitch"])]
    pub measured: Option<PathBuf>,
    /// Write the vibration at that point to this directory: over time, its spectrum, one sample a tooth
    #[arg(long, value_name = "DIR", requires = "at")]
    pub history: Option<PathBuf>,
    /// Show this quantity over the chart, with the limits of the file; repeatable
    #[arg(long, value_name = "MAP", value_parser = PossibleValuesParser::new(MapKind::WORDS), conflicts_with_all = ["at", "plan", "run"])]
    pub show: Vec<String>,
    /// Find the point of greatest removal rate that keeps the limits of the file and is probably stable
    #[arg(long, conflicts_with_all = ["at", "plan", "run"])]
    pub best: bool,
    /// Probability of stability that --best asks for
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, requires = "best")]
    pub probability: f64,
    /// Rank the speeds of the chart by the probability that this depth is stable
    #[arg(long, value_name = "DEPTH", conflicts_with_all = ["at", "plan", "run"])]
    pub robust: Option<String>,
    /// Draws of a calibration with cutting forces, which say how well the force is known, for probabilities
    #[arg(long, value_name = "FILE", requires = "parameter_set", conflicts_with_all = ["plan", "run"])]
    pub parameters_from: Option<PathBuf>,
    /// The parameter set of these draws
    #[arg(long, value_name = "SET", requires = "parameters_from")]
    pub parameter_set: Option<String>,
    /// Search the unequal pitch of the teeth that goes deepest over a window of speeds
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], conflicts_with_all = ["at", "plan", "run", "best", "show", "robust"])]
    pub pitch: Vec<String>,
    /// Search the helix angle that goes deepest over a window of speeds
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"], conflicts_with_all = ["at", "plan", "run", "best", "show", "robust", "pitch"])]
    pub helix: Vec<String>,
    /// Replace a value of the file: path=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE", conflicts_with = "run")]
    pub set: Vec<String>,
    /// Directory of the results, out/NAME if left out; of the parts with --run
    #[arg(long, value_name = "DIR", conflicts_with_all = ["at", "plan"])]
    pub out: Option<PathBuf>,
    /// Go on with a chart that was interrupted, to the same results
    #[arg(long, conflicts_with_all = ["at", "plan", "run"])]
    pub resume: bool,
    /// Write a plan of the chart's columns instead of computing them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["at", "run"])]
    pub plan: Option<PathBuf>,
    /// Number of shards, 16 if left out
    #[arg(long, requires = "plan", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub shards: Option<u64>,
    /// Run one shard of a plan
    #[arg(long, value_name = "PLAN", requires_all = ["shard", "out"], conflicts_with = "at")]
    pub run: Option<PathBuf>,
    /// Its number, from 0
    #[arg(long, requires = "run")]
    pub shard: Option<u64>,
    /// Threads, 0 for one per processor; the results do not depend on it
    #[arg(long, default_value_t = 0, value_parser = crate::threads())]
    pub threads: usize,
}

impl LobesArgs {
    /// What is requested beside the chart, as it has to be typed.
    pub fn typed(&self) -> Vec<String> {
        let mut typed: Vec<String> = self.show.iter().flat_map(|map| ["--show".to_owned(), map.clone()]).collect();
        typed.extend(self.measured.iter().flat_map(|path| ["--measured".to_owned(), path.display().to_string()]));
        if self.best {
            typed.extend(["--best".to_owned(), "--probability".to_owned(), self.probability.to_string()]);
        }
        let draws =
            self.parameters_from.iter().map(|file| ["--parameters-from".to_owned(), file.display().to_string()]);
        typed.extend(draws.flatten());
        typed.extend(self.parameter_set.iter().flat_map(|set| ["--parameter-set".to_owned(), set.clone()]));
        typed.extend(self.robust.iter().flat_map(|depth| ["--robust".to_owned(), depth.clone()]));
        typed
    }
}
