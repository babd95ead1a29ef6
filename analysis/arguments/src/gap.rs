//! Arguments of `toolroom gap`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

#[derive(Subcommand, Debug)]
pub enum GapCommand {
    /// Name the missing effect, or say that it cannot be told
    #[command(before_help = "Examples:
  toolroom gap diagnose --model scenarios/gap/turning.toml --data operations.csv --out out/gap
  toolroom gap diagnose --model scenarios/gap/turning.toml --data operations.csv --holdout 0.25 --json
  toolroom gap diagnose --model turning.toml --model grinding.toml --data records      every table with its model
  toolroom gap diagnose --model turning.toml --data operations.csv --effects my-effects.toml

Exit code 3 and the verdict cannot_tell: fewer than two groups, or no channel with eight values")]
    Diagnose(DiagnoseArgs),
    /// What such runs could show before anything is measured
    #[command(before_help = "Examples:
  toolroom gap identifiability --model scenarios/gap/turning.toml --data planned.csv")]
    Identifiability(IdentifiabilityArgs),
    /// The next experiment: which runs would tell apart what the records cannot
    #[command(before_help = "Examples:
  toolroom gap plan --model scenarios/gap/turning.toml --data operations.csv
  toolroom gap plan --model scenarios/gap/turning.toml --data operations.csv --out out/plan     runs.csv to fill in")]
    Plan(PlanArgs),
    /// Write the nominal model with everything that a diagnosis has found: effects and calibration
    #[command(before_help = "Examples:
  toolroom gap apply --model scenarios/gap/turning.toml --diagnosis out/gap/diagnosis.json --out better.toml
  toolroom gap apply --model turning.toml --diagnosis out/gap/diagnosis.json --out better.toml --diff
  toolroom gap apply --model turning.toml --diagnosis out/gap/diagnosis.json --out better.toml --only wear_force")]
    Apply(ApplyArgs),
    /// What a model predicts of recorded operations, without any fit
    #[command(before_help = "Examples:
  toolroom gap predict --model better.toml --data operations.csv
  toolroom gap predict --model better.toml --data operations.csv --out out/predicted")]
    Predict(PredictArgs),
    /// Diagnose, apply and diagnose again until nothing new is named
    #[command(before_help = "Examples:
  toolroom gap loop --model scenarios/gap/turning.toml --data operations.csv --out out/loop")]
    Loop(LoopArgs),
    /// Whether a shop has changed since its model was fitted, with a promised rate of false alarms
    #[command(before_help = "Examples:
  toolroom gap watch --model better.toml --data records --state watch.json
  toolroom gap watch --model better.toml --data records --false-alarms \"1 1/year\" --since \"12 day\" --json

Exit code 3: an alarm")]
    Watch(WatchArgs),
    /// Simulate shops, diagnose their records, and count what is found again and what is named wrongly
    #[command(before_help = "Examples:
  toolroom gap recovery --model scenarios/gap/turning.toml --logs 50 --seed 301 --out out/null     nothing is hidden
  toolroom gap recovery --model scenarios/gap/milling.toml --set 'shop.horizon=20 h' --logs 20 --out out/long
  toolroom gap recovery --model shop.toml --truth true-shop.toml --logs 12 --figures --fresh --out out/found")]
    Recovery(RecoveryArgs),
    /// Diagnose shops with a hidden effect that no model here knows, and count the errors
    #[command(before_help = "Examples:
  toolroom gap blind --cases smoke
  toolroom gap blind --cases full --seed 1001 --out out/blind
  toolroom gap blind --cases full --seed 1001 --part 1/4 --out out/first      a quarter of them
  toolroom gap blind --cases full --only null --process turning --times 5 --form 0.02    60 edges, equations off
  toolroom gap blind --from out/first --from out/second --out out/both        both together")]
    Blind(BlindArgs),
}

/// A nominal model and records.
#[derive(Args, Debug)]
pub struct GapData {
    /// Nominal model: a scenario with a section [gap]
    #[arg(long, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// Records: a CSV or Parquet file, or a directory that holds it
    #[arg(long, alias = "design", value_name = "DATA")]
    pub data: PathBuf,
    /// Column whose levels are left out together; edges or dressing cycles, if left out
    #[arg(long, value_name = "COLUMN")]
    pub group: Option<String>,
    /// Replace a value of the model: path=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// File of effects of your own, beside those of the catalogue, repeatable
    #[arg(long, value_name = "EFFECTS.toml")]
    pub effects: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub struct DiagnoseArgs {
    /// Nominal model: a scenario with a section [gap]; repeatable, one for each table of the data
    #[arg(long = "model", value_name = "MODEL.toml", required = true)]
    pub models: Vec<PathBuf>,
    /// Records: a CSV or Parquet file, or a directory that holds it
    #[arg(long, value_name = "DATA")]
    pub data: PathBuf,
    /// Column whose levels are left out together, where a table has it; edges or dressing cycles, if left out
    #[arg(long, value_name = "COLUMN")]
    pub group: Option<String>,
    /// Replace a value of every model: path=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// File of effects of your own, beside those of the catalogue, repeatable
    #[arg(long, value_name = "EFFECTS.toml")]
    pub effects: Vec<PathBuf>,
    /// Where no cause is known, write terms that describe the gap (empirical, not a cause) into this file
    #[arg(long, value_name = "PROPOSED.toml")]
    pub propose: Option<PathBuf>,
    /// Share of the groups that is kept out of the fit and only predicted, at most a half
    #[arg(long, value_name = "FRACTION", conflicts_with = "holdout_data", value_parser = held_out)]
    pub holdout: Option<f64>,
    /// Records of other groups on which the closure is scored
    #[arg(long, value_name = "DATA2")]
    pub holdout_data: Option<PathBuf>,
    /// Seed of the null distribution and of the intervals
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Directory of diagnosis.json and report.html
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct WatchArgs {
    #[command(flatten)]
    pub data: GapData,
    /// Only rows from this time since the start of the records on, with its unit
    #[arg(long, value_name = "TIME")]
    pub since: Option<String>,
    /// False alarms that are promised for all streams together, per year
    #[arg(long, value_name = "RATE", default_value = "0.2 1/year")]
    pub false_alarms: String,
    /// What is kept between two looks; a look goes on where the last one stopped
    #[arg(long, value_name = "watch.json")]
    pub state: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct PlanArgs {
    #[command(flatten)]
    pub data: GapData,
    /// Seed of the null distribution
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Directory of plan.json and of the planned runs as records to fill in
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct IdentifiabilityArgs {
    #[command(flatten)]
    pub data: GapData,
}

#[derive(Args, Debug)]
pub struct ApplyArgs {
    /// Nominal model; repeatable, as in the diagnosis
    #[arg(long = "model", value_name = "MODEL.toml", required = true)]
    pub models: Vec<PathBuf>,
    /// A finished diagnosis
    #[arg(long, value_name = "diagnosis.json")]
    pub diagnosis: PathBuf,
    /// Recorded events: run the shop with and without the effects and hold both against them
    #[arg(long, value_name = "DATA")]
    pub data: Option<PathBuf>,
    /// Only these effects, by id; repeatable
    #[arg(long, value_name = "ID")]
    pub only: Vec<String>,
    /// Effects alone: constants stay as they are
    #[arg(long)]
    pub no_calibration: bool,
    /// Take in effects that are empirical, and no causes
    #[arg(long)]
    pub accept_empirical: bool,
    /// Print what would change, and write nothing
    #[arg(long)]
    pub diff: bool,
    /// Values of `--set` with which the model was diagnosed
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// File to write; of several models a directory, in which each keeps its name
    #[arg(long, value_name = "MODEL2.toml")]
    pub out: PathBuf,
}

#[derive(Args, Debug)]
pub struct PredictArgs {
    #[command(flatten)]
    pub data: GapData,
    /// Directory of predictions.csv; to the terminal, if left out
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct LoopArgs {
    /// Nominal model
    #[arg(long, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// Records: a CSV or Parquet file, or a directory that holds it
    #[arg(long, value_name = "DATA")]
    pub data: PathBuf,
    /// File of effects of your own, beside those of the catalogue, repeatable
    #[arg(long, value_name = "EFFECTS.toml")]
    pub effects: Vec<PathBuf>,
    /// Greatest number of rounds
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=20))]
    pub rounds: u32,
    /// Seed of null distributions and intervals
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Directory of the rounds: round-1, round-2 …
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

#[derive(Args, Debug)]
pub struct RecoveryArgs {
    /// Nominal model
    #[arg(long, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// Scenario whose runs are recorded: the model with what is hidden; the model itself, if left out
    #[arg(long, value_name = "TRUTH.toml")]
    pub truth: Option<PathBuf>,
    /// Replace a value of both: path=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Simulated logs
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub logs: u32,
    /// Seed of the first log; the others follow it
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Apply what was found, and diagnose fresh records of the truth by that
    #[arg(long)]
    pub fresh: bool,
    /// Apply what was found, and compare how far the key figures of the shop close with what the truth closes
    #[arg(long)]
    pub figures: bool,
    /// Directory of recovery.json and of the records, log by log
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

#[derive(Args, Debug)]
pub struct BlindArgs {
    /// Seed of all cases; those of different seeds have nothing in common
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How many cases
    #[arg(long, value_enum, default_value = "smoke")]
    pub cases: BlindCases,
    /// Only this process
    #[arg(long, value_name = "PROCESS")]
    pub process: Option<String>,
    /// Only the k-th of n equal parts of the cases; every set is spread over all parts
    #[arg(long, value_name = "K/N", value_parser = part)]
    pub part: Option<(usize, usize)>,
    /// Only the cases of this set: null, effect, pair, "outside the catalogue", …
    #[arg(long, value_name = "SET")]
    pub only: Option<String>,
    /// So many times as many groups (edges, dressings, days) as usual
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = times)]
    pub times: usize,
    /// How far the equations of the shops are off: share of forces and temperatures, from 0 to 0.2
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = form)]
    pub form: f64,
    /// Only the whole method, not what is left of it without its parts
    #[arg(long)]
    pub no_ablations: bool,
    /// Diagnose nothing: count the cases of finished runs together; repeatable
    #[arg(long, value_name = "DIR", conflicts_with_all = ["seed", "cases", "process", "part", "only", "times", "form", "no_ablations"])]
    pub from: Vec<PathBuf>,
    /// Directory of cases.csv, rates.md and blind.json
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `2/5`: the second of five parts.
fn part(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
    numbers.filter(|(k, n)| (1..=*n).contains(k)).ok_or_else(|| "give K/N with K from 1 to N, as in 2/5".to_owned())
}

fn times(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|times| (1..=100).contains(times))
        .ok_or_else(|| "give a whole number from 1 to 100".to_owned())
}

fn form(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=0.2).contains(share));
    share.ok_or_else(|| "give a share from 0 to 0.2, as in 0.02".to_owned())
}

#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlindCases {
    /// A few of each set
    Smoke,
    /// As many as bounds on error rates need
    Full,
}

impl BlindCases {
    /// Word on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Smoke => "smoke",
            Self::Full => "full",
        }
    }
}

impl BlindArgs {
    /// The arguments as they have to be typed.
    pub fn typed(&self) -> Vec<String> {
        if !self.from.is_empty() {
            return self.from.iter().flat_map(|from| ["--from".to_owned(), from.display().to_string()]).collect();
        }
        let mut list =
            vec!["--seed".to_owned(), self.seed.to_string(), "--cases".to_owned(), self.cases.name().to_owned()];
        self.process.iter().for_each(|process| list.extend(["--process".to_owned(), process.clone()]));
        self.part.iter().for_each(|(k, n)| list.extend(["--part".to_owned(), format!("{k}/{n}")]));
        self.only.iter().for_each(|only| list.extend(["--only".to_owned(), only.clone()]));
        if self.times > 1 {
            list.extend(["--times".to_owned(), self.times.to_string()]);
        }
        if self.form > 0.0 {
            list.extend(["--form".to_owned(), self.form.to_string()]);
        }
        if self.no_ablations {
            list.push("--no-ablations".to_owned());
        }
        list
    }
}

/// A share of groups that leaves at least as many to be fitted.
fn held_out(text: &str) -> Result<f64, String> {
    let share = text.parse::<f64>().ok().filter(|share| *share > 0.0 && *share <= 0.5);
    share.ok_or_else(|| "a share above 0 and at most 0.5 is needed, such as 0.25".to_owned())
}
