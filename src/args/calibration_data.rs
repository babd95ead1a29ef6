//! Arguments of `toolroom calibrate --data`.

use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct CalibrationData {
    /// Measured edges: records of turning operations, or a table of lives
    #[arg(long, value_name = "RECORDS", requires = "model", conflicts_with = "life")]
    pub data: Option<PathBuf>,
    /// Parameter set from which everything comes that the data do not say: a shipped name or a file
    #[arg(long, value_name = "SET", requires = "data")]
    pub model: Option<String>,
    /// Mapping file for a table of any layout
    #[arg(long, value_name = "MAP.toml", requires = "data")]
    pub map: Option<PathBuf>,
    /// Wear law: all, or extended_taylor, takeyama_murata, usui, energy_balance; may be repeated
    #[arg(long, value_name = "NAME", requires = "data", value_delimiter = ',')]
    pub law: Vec<String>,
    /// A parameter that is not fitted, such as stage_tilt=0; may be repeated
    #[arg(long, value_name = "KEY=VALUE", requires = "data")]
    pub fix: Vec<String>,
    /// Draws of the posterior
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = draws)]
    pub draws: usize,
    /// Seed of the draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Fail where the law or a parameter is not determined; the files are written
    #[arg(long, requires = "data")]
    pub strict: bool,
}

fn draws(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|draws| (100..=1_000_000).contains(draws)).ok_or_else(|| "from 100 to 1000000".to_owned())
}
