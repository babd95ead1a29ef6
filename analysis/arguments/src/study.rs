//! Studies of a scenario and their results.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::path::{Path, PathBuf};
use toolroom_study::planned::Axis;

/// A scenario and changes to it.
#[derive(Args, Clone, Debug)]
pub struct ScenarioArgs {
    /// Scenario file
    pub file: PathBuf,
    #[command(flatten)]
    pub changes: Changes,
}

/// A scenario, or a snapshot of one that was run to some instant, and changes to it.
#[derive(Args, Clone, Debug)]
pub struct StartArgs {
    /// Scenario file; left out with --from
    #[arg(required_unless_present = "from", conflicts_with = "from")]
    pub file: Option<PathBuf>,
    /// Go on from this snapshot: changes act from its instant on
    #[arg(long, value_name = "SNAPSHOT", conflicts_with = "schedule")]
    pub from: Option<PathBuf>,
    /// Another end of the run that goes on: a date, or a time since the start
    #[arg(long, value_name = "TIME", requires = "from", conflicts_with = "file")]
    pub horizon: Option<String>,
    #[command(flatten)]
    pub changes: Changes,
}

impl StartArgs {
    /// The scenario file; empty where a snapshot stands in its place.
    pub fn path(&self) -> &Path {
        self.file.as_deref().unwrap_or(Path::new(""))
    }
}

/// Changes to the values of a scenario.
#[derive(Args, Clone, Debug, Default)]
pub struct Changes {
    /// Replace a value of the scenario: path=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Seed of every random stream
    #[arg(long)]
    pub seed: Option<u64>,
    /// Independent repetitions
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub replications: Option<u32>,
    /// A table of sequences that the machines follow: order, operation, machine, position, not_before, start
    #[arg(long, value_name = "FILE")]
    pub schedule: Option<PathBuf>,
}

impl Changes {
    /// All changes as `path=value`, the flags last so that they win.
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.set.clone();
        overrides.extend(self.seed.map(|seed| format!("shop.seed={seed}")));
        overrides.extend(self.replications.map(|count| format!("shop.replications={count}")));
        // A path counts from here, in the scenario from its folder.
        let path = |file: &PathBuf| std::path::absolute(file).unwrap_or_else(|_| file.clone());
        let schedule =
            self.schedule.as_ref().map(|file| format!("tables.schedule={:?}", path(file).display().to_string()));
        overrides.extend(schedule);
        overrides
    }
}

/// How a study is run and where it goes.
#[derive(Args, Clone, Debug, Default)]
pub struct StudyArgs {
    /// Only this policy, repeatable; the first is the baseline
    #[arg(long, value_name = "NAME")]
    pub policy: Vec<String>,
    /// Directory of the results, out/NAME if left out
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads, 0 for one per processor; the results do not depend on it
    #[arg(long, default_value_t = 0, value_parser = crate::threads())]
    pub threads: usize,
    /// Stop when figures are known this well, repeatable: "half-width 2%" (parts per shift and cost per part), "lead_time
    /// half-width 5 min"
    #[arg(long, value_name = "PRECISION")]
    pub until: Vec<toolroom_study::study::Precision>,
    /// Format of the log tables, instead of the scenario's
    #[arg(long, value_enum)]
    pub format: Option<LogFormat>,
    /// Replications whose full logs are written
    #[arg(long, value_name = "COUNT")]
    pub logged: Option<u32>,
    /// Part of the first run that trace.json shows, two dates or times since the start [default: the first week]
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"])]
    pub trace: Vec<String>,
    /// Also write what sensors and controls would have recorded of the first run: operations, cuts, trials, events
    #[arg(long, value_name = "DIR", conflicts_with = "resume")]
    pub records: Option<PathBuf>,
    /// Go on with the same study where it was interrupted; refused where anything but threads differs
    #[arg(long)]
    pub resume: bool,
    /// Stop after so many replications as Ctrl-C does, with exit code 1
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    pub stop_after: Option<u32>,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogFormat {
    Parquet,
    Csv,
}

#[derive(Args, Debug)]
pub struct DemoArgs {
    /// A job shop of 40 machines with 300 orders in place of one shift of six machines that cut
    #[arg(long)]
    pub shop: bool,
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub study: StudyArgs,
}

#[derive(Args, Debug)]
pub struct RunArgs {
    #[command(flatten)]
    pub scenario: StartArgs,
    #[command(flatten)]
    pub study: StudyArgs,
    /// Run to this date or time since the start only, and write --snapshot
    #[arg(long, value_name = "TIME", requires = "snapshot", conflicts_with = "from")]
    pub snapshot_at: Option<String>,
    /// Where the snapshot is written
    #[arg(long, value_name = "FILE", requires = "snapshot_at")]
    pub snapshot: Option<PathBuf>,
    /// From the instant of the snapshot on, this [[variant]] of the scenario
    #[arg(long, value_name = "NAME", requires = "from")]
    pub variant: Option<String>,
}

#[derive(Args, Clone, Debug)]
pub struct CompareArgs {
    #[command(flatten)]
    pub scenario: StartArgs,
    #[command(flatten)]
    pub study: StudyArgs,
    /// Repeat the comparison at several values of a key; files are written only with --out
    #[arg(
        short = 'P',
        num_args = 4,
        value_names = ["KEY", "LO", "HI", "STEP"],
        allow_negative_numbers = true,
        conflicts_with_all = ["resume", "stop_after"]
    )]
    pub sweep: Vec<String>,
    /// Write a plan of the replications instead of running them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["sweep", "resume", "stop_after"])]
    pub plan: Option<PathBuf>,
    /// Number of shards, one a replication if left out
    #[arg(long, requires = "plan", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub shards: Option<u64>,
    /// Tune the policies on a seed of their own before they are compared, as [tune] of the scenario says
    #[arg(long, conflicts_with = "plan")]
    pub tune: bool,
    /// Compare the settings of the file even where it has a section [tune]
    #[arg(long, conflicts_with = "tune")]
    pub no_tune: bool,
    /// What is compared: policies of the shop as it is, variants of the shop under its first policy, or variants under
    /// every policy; left out: all that the scenario has
    #[arg(long, value_parser = axis(), conflicts_with = "sweep")]
    pub axis: Option<Axis>,
    /// Select the best of the shop and its variants under the first policy, by a figure and the least difference that
    /// matters, such as "lead_time 5 min" or "late_orders 1"; runs as often as that needs
    #[arg(long, value_name = "FIGURE DIFFERENCE", conflicts_with_all = ["sweep", "plan"])]
    pub select: Option<String>,
}

/// Reads what `compare` compares.
fn axis() -> impl TypedValueParser<Value = Axis> {
    let words = Axis::ALL.map(|axis| PossibleValue::new(axis.word()).help(axis.meaning()));
    let of_word = |word: String| Axis::ALL.into_iter().find(|axis| axis.word() == word).ok_or("no such axis");
    PossibleValuesParser::new(words).try_map(of_word)
}

#[derive(Args, Debug)]
pub struct ReportArgs {
    /// Directory of a finished run
    pub dir: PathBuf,
    /// Open it in a browser
    #[arg(long)]
    pub open: bool,
}

#[derive(Args, Debug)]
pub struct DiffArgs {
    /// Directory of a finished run
    pub one: PathBuf,
    /// Directory of another
    pub two: PathBuf,
}
