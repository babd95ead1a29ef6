//! Arguments of `program`.

use clap::Args;
use std::path::PathBuf;
use toolroom_contour::Units;

#[derive(Args, Debug)]
pub struct ProgramArgs {
    /// Part program (G-code) of a milling machine
    pub file: PathBuf,
    /// Replace a value of drives and changer, repeatable: rapid_speed, tool_change_time,
    /// inverse_acceleration, corner_deviation, jerk_time, hole_dwell
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Unit of lengths and feeds of a program without G20 or G21
    #[arg(long, value_name = "UNIT", value_parser = Units::NAMES)]
    pub units: Option<String>,
    /// Table of every block (CSV)
    #[arg(long, value_name = "CSV")]
    pub blocks: Option<PathBuf>,
}
