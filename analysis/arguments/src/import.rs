//! Arguments of `import`.

use crate::modes::ImportFrfArgs;
use clap::{Args, Subcommand};
use std::path::PathBuf;

#[derive(Subcommand, Debug)]
pub enum ImportCommand {
    /// A measured table of any layout, by a mapping file
    #[command(before_help = "Examples:
  toolroom import csv log.csv --map map.toml --out out/log
  toolroom import csv vicomtech.csv --map scenarios/gap/map-vicomtech.toml --out out/vicomtech
  toolroom import csv log.csv --map map.toml --set rows_per_operation=30 --out out/log")]
    Csv(ImportCsvArgs),
    /// The table of milling cuts of NASA Ames and UC Berkeley
    #[command(before_help = "Examples:
  toolroom import nasa-mill mill.csv --out out/nasa")]
    NasaMill(ImportTableArgs),
    /// Logs of MTConnect adapters (SHDR: time|key|value|…) as events
    #[command(before_help = "Examples:
  toolroom import mtconnect mill.shdr --out out/mill
  toolroom import mtconnect op2-*.shdr --program OP2 --nc op2.nc --out out/op2
  toolroom import mtconnect monday.shdr tuesday.shdr --machine M1 --key tool=T_Number --out out/week")]
    Mtconnect(MtconnectArgs),
    /// The table of program runs derived from the logs of the NIST test bed
    #[command(before_help = "Examples:
  toolroom import nist-runs nist-mazak-runs-2017.csv --machine Mazak03 --program 103 --out out/mazak03-103")]
    NistRuns(NistRunsArgs),
    /// Tables of an order system (CSV, XLSX, ODS) as a scenario of a shop, by a mapping file
    #[command(before_help = "Examples:
  toolroom new shop-mapping erp
  toolroom import shop --map map.toml --out shop.toml
  toolroom import shop --map map.toml --out shop.toml --check")]
    Shop(ImportShopArgs),
    /// Frequency responses or hits of a tap test: what the file holds, and all of it as one table
    #[command(before_help = "Examples:
  toolroom import frf tap.uff
  toolroom import frf hits.csv --highest \"2000 Hz\" --out tap.csv
  toolroom import frf tap.csv --coherence coherence.csv --out both.csv")]
    Frf(ImportFrfArgs),
}

#[derive(Args, Debug)]
pub struct ImportShopArgs {
    /// Which tables there are and what their columns are
    #[arg(long, value_name = "MAP.toml")]
    pub map: PathBuf,
    /// The scenario that is made
    #[arg(long, value_name = "SHOP.toml")]
    pub out: PathBuf,
    /// Also say what `toolroom check` says of it: load against capacity, due dates that cannot be met
    #[arg(long)]
    pub check: bool,
}

#[derive(Args, Debug)]
pub struct NistRunsArgs {
    /// Table of runs: machine, day, hour, prog, mode, act, nom, hold, tc, nhold
    pub file: PathBuf,
    /// Only this machine
    #[arg(long, value_name = "NAME")]
    pub machine: Option<String>,
    /// Only this program
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
    /// Directory of stretches.csv
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
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
    /// Name of the program, where the log does not tell it or not well
    #[arg(long, value_name = "NAME")]
    pub program: Option<String>,
    /// Part program of the runs: they are timed stretch by stretch (stretches.csv)
    #[arg(long, value_name = "FILE")]
    pub nc: Option<PathBuf>,
    /// Unit of lengths and feeds of a part program without G20 or G21
    #[arg(long, value_name = "UNIT", value_parser = toolroom_program::Units::NAMES)]
    pub units: Option<String>,
    /// Least nominal time of a stretch of motions
    #[arg(long, value_name = "TIME", default_value = "10 s")]
    pub stretch: String,
    /// Directory of events.csv, runs.csv and stretches.csv
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

#[derive(Args, Debug)]
pub struct ImportCsvArgs {
    /// What the columns are
    #[arg(long, value_name = "MAP.toml")]
    pub map: PathBuf,
    /// Replace a value of the mapping, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub table: ImportTableArgs,
}

#[derive(Args, Debug)]
pub struct ImportTableArgs {
    /// CSV in any delimiter, encoding and decimal sign, or Parquet
    pub file: PathBuf,
    /// Directory of the records and of import.json
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}
