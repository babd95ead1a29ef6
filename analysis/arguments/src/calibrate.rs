//! Arguments of `toolroom calibrate`.

use super::calibration_data::CalibrationData;
use clap::Args;
use clap::builder::PossibleValuesParser as Words;
use std::path::PathBuf;
use toolroom_wear::{ISO_513, ToolMaterial};

#[derive(Args, Debug)]
pub struct CalibrateArgs {
    /// Process
    #[arg(value_parser = Words::new(["turning", "milling"]), required_unless_present = "bake")]
    pub process: Option<String>,
    /// About how long an edge lasts, such as "15 min"
    #[arg(long, value_name = "TIME", requires = "at", required_unless_present_any = ["data", "bake"])]
    pub life: Option<String>,
    /// Cutting speed at which it lasts that long
    #[arg(long, value_name = "SPEED", requires = "life")]
    pub at: Option<String>,
    /// Feed per revolution there
    #[arg(long, value_name = "LENGTH", default_value = "0.25 mm/rev")]
    pub feed: String,
    /// Depth of cut there
    #[arg(long, value_name = "LENGTH", default_value = "1.5 mm")]
    pub depth: String,
    /// Tool material, which decides how steeply life falls with speed
    #[arg(long, value_name = "WORD", default_value = "carbide", value_parser = Words::new(ToolMaterial::WORDS))]
    pub tool_material: String,
    /// ISO 513 letter of the work material
    #[arg(long, value_name = "LETTER", default_value = "P", value_parser = Words::new(ISO_513))]
    pub material: String,
    /// Flank wear at which an edge is spent; 0.3 mm, or with --data that of the set
    #[arg(long, value_name = "LENGTH")]
    pub limit: Option<String>,
    /// Scenario whose tool has values that it states or calibrates: they become a set
    #[arg(long, value_name = "SCENARIO", requires = "tool", conflicts_with_all = ["data", "life", "process"])]
    pub bake: Option<PathBuf>,
    /// The tool of --bake
    #[arg(long, value_name = "NAME", requires = "bake")]
    pub tool: Option<String>,
    /// Parameter set to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    #[command(flatten)]
    pub measured: CalibrationData,
}
