//! Arguments of `toolroom calibrate --data`.

use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct CalibrationData {
    /// Measured edges: records of operations, or a table of lives
    #[arg(long, value_name = "RECORDS", requires = "model", conflicts_with = "life")]
    pub data: Option<PathBuf>,
    /// Parameter set from which everything comes that the data do not say: a shipped name or a file
    #[arg(long, value_name = "SET", requires = "data", conflicts_with = "life")]
    pub model: Option<String>,
    /// Mapping file for a table of any layout
    #[arg(long, value_name = "MAP.toml", requires = "data", conflicts_with = "life")]
    pub map: Option<PathBuf>,
    /// Wear law of turning: all, or extended_taylor, takeyama_murata, usui, energy_balance; may be repeated. Milling has `life`
    #[arg(long, value_name = "NAME", requires = "data", conflicts_with = "life", value_delimiter = ',')]
    pub law: Vec<String>,
    /// Shape of the wear curve of laws that state lives: straight, curved, tilted, or all of them; may be repeated
    #[arg(long, value_name = "WORD", requires = "data", conflicts_with = "life", value_delimiter = ',')]
    pub shape: Vec<String>,
    /// Column of words whose edges may wear at different rates, such as material; material=steel has the set carry steel
    #[arg(long, value_name = "COLUMN", requires = "data", conflicts_with = "life")]
    pub by: Option<String>,
    /// A parameter that is not fitted, such as stage_tilt=0; may be repeated
    #[arg(long, value_name = "KEY=VALUE", requires = "data", conflicts_with = "life")]
    pub fix: Vec<String>,
    /// File whose [prior] goes before that of the set: a parameter set, or nothing but [prior]
    #[arg(long, value_name = "FILE", requires = "data", conflicts_with = "life")]
    pub prior: Option<PathBuf>,
    /// Edges that take no part and are predicted: a share such as 0.2, or names such as E03,E07
    #[arg(long, value_name = "SHARE|EDGES", requires = "data", conflicts_with = "life")]
    pub holdout: Option<String>,
    /// How edges begin
    #[arg(long, value_name = "WORD", requires = "data", conflicts_with = "life", default_value = "auto", value_enum)]
    pub start: CalibrationStart,
    /// Let the wear rate wander within lives, and find by how much
    #[arg(long, requires = "data", conflicts_with = "life")]
    pub life_noise: bool,
    /// Work out profile intervals too
    #[arg(long, requires = "data", conflicts_with = "life")]
    pub profile: bool,
    /// Scenario whose choice between two speeds says what to measure next, by cost
    #[arg(long, value_name = "SCENARIO", requires = "data", conflicts_with = "life")]
    pub decision: Option<PathBuf>,
    /// Draws of the posterior
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = draws)]
    pub draws: usize,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Fail where the law or a parameter is not determined; the files are written
    #[arg(long, requires = "data", conflicts_with = "life")]
    pub strict: bool,
}

/// How edges were when their records began.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationStart {
    /// New, but for those whose first reading is far above zero
    Auto,
    /// New
    New,
    /// Nothing is supposed of the wear and the time before their first readings
    Unknown,
}

/// Most draws of a posterior: the ends of 90 % intervals are then known to 0.7 % of a posterior standard deviation
/// (√(0.05·0.95/N) over the normal density there), far below what the data leave open, and each draw costs two evaluations of the
/// density and a third of a kilobyte.
const MOST_DRAWS: usize = 100_000;

fn draws(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|draws| (100..=MOST_DRAWS).contains(draws)).ok_or_else(|| {
        format!(
            "from 100 to {MOST_DRAWS}: with so many the ends of intervals are known to 0.7 % of a standard deviation, and more would \
             only take longer"
        )
    })
}
