//! Arguments of `import`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

#[derive(Subcommand, Debug)]
pub enum ImportCommand {
    /// Logs of MTConnect adapters (SHDR: time|key|value|…) as events
    #[command(before_help = "Examples:
  toolroom import mtconnect mill.shdr --out out/mill
  toolroom import mtconnect monday.shdr tuesday.shdr --machine M1 --key tool=T_Number --out out/week")]
    Mtconnect(MtconnectArgs),
}

#[derive(Args, Debug)]
pub struct MtconnectArgs {
    /// Logs of one machine
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Name of the machine
    #[arg(long, default_value = "machine")]
    pub machine: String,
    /// Key that tells the execution, program, tool, block, feed_override, rapid_override,
    /// spindle_override, part_count or availability, where the usual names do not; repeatable
    #[arg(long, value_name = "ROLE=KEY")]
    pub key: Vec<String>,
    /// Directory of events.csv
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}
