//! Arguments of `identify`, `grind` and `contour`.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;
use toolroom_infeed::Basis;

#[derive(Args, Debug)]
pub struct IdentifyArgs {
    /// Table of trials (CSV): trial_id, infeed_per_rev [um], revolutions, stock_removed [um], …
    pub data: PathBuf,
    /// Table of recorded forces (CSV): trial_id, revolution or time [s], normal_force [N]
    #[arg(long, value_name = "CSV")]
    pub forces: Option<PathBuf>,
    /// What the lag is taken from: stock and force weighted by their errors, stock alone, or rise and decay of the force
    #[arg(long, value_parser = basis(), default_value = "both")]
    pub basis: Basis,
    /// Standard deviation of a measurement (stock, infeed_per_rev, revolutions, force), repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub error: Vec<String>,
    /// Refuse the table where one trial cannot be, instead of leaving it out
    #[arg(long)]
    pub strict: bool,
    /// Bootstrap resamples of more than six trials; fewer trials are enumerated
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(..=10_000_000))]
    pub resamples: u32,
    /// Seed of the resampling
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Directory of the results, out/NAME if left out
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

fn basis() -> impl TypedValueParser<Value = Basis> {
    PossibleValuesParser::new(Basis::WORDS).try_map(|word| Basis::from_word(&word).ok_or("no such basis"))
}

#[derive(Args, Debug)]
pub struct GrindArgs {
    /// Cycle file: machine, limits of heat, finish, size, power, force, removal rate, burn and roughness, the wheel, its dressing
    pub file: PathBuf,
    /// Replace a value of the file: table.key=value with unit, as in limits.power="2 kW", wheel=worst, or effects.ID=SIZE, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Directory of the results, out/NAME if left out
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct ContourArgs {
    /// Contour file
    pub file: PathBuf,
    /// Part program that draws the contour, instead of the sections of the file
    #[arg(long, value_name = "PROGRAM", group = "drawn")]
    pub gcode: Option<PathBuf>,
    /// Language of the part program; found from its words where not given
    #[arg(long, value_name = "DIALECT", value_parser = crate::program::READ, requires = "gcode")]
    pub dialect: Option<String>,
    /// DXF file that draws the contour, instead of the sections of the file
    #[arg(long, value_name = "DRAWING", group = "drawn")]
    pub dxf: Option<PathBuf>,
    /// Layer of the drawing; left out where it is one contour
    #[arg(long, value_name = "LAYER", requires = "dxf")]
    pub layer: Option<String>,
    /// Ends of the drawing that lie no farther apart are one point, such as "10 um"; 1 um, if left out
    #[arg(long, value_name = "LENGTH", requires = "dxf")]
    pub join: Option<String>,
    /// Unit of lengths of a part program or drawing that names none
    #[arg(long, value_name = "UNIT", value_parser = toolroom_program::Units::NAMES, requires = "drawn")]
    pub units: Option<String>,
    /// Language of the part programs that are written; fanuc where not given
    #[arg(long, value_name = "DIALECT", value_parser = toolroom_program::Dialect::NAMES)]
    pub post: Option<String>,
    /// Only this pass, repeatable
    #[arg(long, value_name = "NAME")]
    pub pass: Vec<String>,
    /// Replace a value of the file: group.key=value or pass.NAME.key=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Feeds change in ramps within the acceleration of the machine
    #[arg(long)]
    pub ramps: bool,
    /// Share of the edge's life that is left at the start, for plans that change it on the way
    #[arg(long, value_name = "SHARE")]
    pub edge: Option<String>,
    /// Random draws of the conditions in the sensitivity study, 0 for none
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(..=100_000))]
    pub draws: u32,
    /// Seed of the draws
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Go on with a plan that was interrupted, to the same results
    #[arg(long)]
    pub resume: bool,
    /// Directory of the results, out/NAME if left out
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
