//! FMI units and systems of them: written, looked into, run.

use crate::ScenarioArgs;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use std::path::PathBuf;
use toolroom_fmu::{Entry, Platform, units};

#[derive(Subcommand, Debug)]
pub enum FmuCommand {
    /// Package a cutting process as an FMI unit
    #[command(before_help = "Examples:
  toolroom fmu export turning                 out/fmu/toolroom_turning_fmi2.fmu and _fmi3.fmu
  toolroom fmu export milling --fmi 3 --out .
  toolroom fmu export milling --out mill.fmu             this one file, FMI 3.0 unless --fmi 2
  toolroom fmu export turning --platforms x86_64-linux --platforms x86_64-windows
  toolroom fmu export turning --libraries dist/units     every platform whose library is there")]
    Export(FmuExportArgs),
    /// What an FMI unit offers: interfaces, platforms, variables with units
    #[command(before_help = "Examples:
  toolroom fmu info turning.fmu
  toolroom fmu info turning.fmu --json")]
    Info(FmuFileArgs),
    /// Check an FMI unit against what importers trip over; nothing of it is run
    #[command(before_help = "Examples:
  toolroom fmu check turning.fmu
  toolroom fmu check turning.fmu --json      exit code 2 where an error was found")]
    Check(FmuFileArgs),
    /// Run an FMI unit by itself: inputs from a table, outputs to a table
    #[command(before_help = "Examples:
  toolroom fmu sim turning.fmu --stop \"60 s\"
  toolroom fmu sim turning.fmu --input cut.csv --output result.csv --step \"0.1 s\"
  toolroom fmu sim turning.fmu --interface model-exchange --stop \"60 s\"
  toolroom fmu sim trusted.fmu --isolation none
  toolroom fmu sim turning.fmu --start process.feed_per_rev=0.0002 --start tool.set=c45_t15k6")]
    Sim(FmuSimArgs),
    /// Run units for the program that started this one
    #[command(hide = true)]
    Worker,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuIsolation {
    /// In a worker process: what happens to it does not happen to toolroom
    Process,
    /// In toolroom itself, for units that one trusts
    None,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum FmuInterface {
    /// Co-Simulation: the unit steps by itself
    CoSimulation,
    /// Model Exchange: toolroom integrates the unit's equations
    ModelExchange,
}

#[derive(Args, Debug)]
pub struct FmuSimArgs {
    /// Unit of FMI 2.0 or 3.0
    pub file: PathBuf,
    /// Interface to drive it by; Co-Simulation where the unit has it, if left out
    #[arg(long, value_name = "INTERFACE", value_enum)]
    pub interface: Option<FmuInterface>,
    /// CSV of inputs: time [s] first, then one column an input
    #[arg(long, value_name = "CSV")]
    pub input: Option<PathBuf>,
    #[command(flatten)]
    pub run: UnitRunArgs,
}

/// How units are run by themselves.
#[derive(Args, Debug)]
pub struct UnitRunArgs {
    /// CSV of outputs, standard output if left out
    #[arg(long, value_name = "CSV")]
    pub output: Option<PathBuf>,
    /// Stop time; that of the file or the last time of the inputs, if left out
    #[arg(long, value_name = "TIME")]
    pub stop: Option<String>,
    /// Communication step; the units' own, if left out
    #[arg(long, value_name = "TIME")]
    pub step: Option<String>,
    /// Start value of a parameter or input in the unit's own units, name=value, repeatable; component.name=value in a
    /// system
    #[arg(long, value_name = "NAME=VALUE")]
    pub start: Vec<String>,
    /// Where the code of units runs
    #[arg(long, value_name = "WHERE", value_enum, default_value = "process")]
    pub isolation: FmuIsolation,
    /// Longest time of one call of a unit in a worker process
    #[arg(long, value_name = "TIME", default_value = "10 s")]
    pub call_limit: String,
}

#[derive(Args, Debug)]
pub struct FmuExportArgs {
    /// Model
    #[arg(value_parser = entries())]
    pub model: &'static Entry,
    /// Version of the standard; both, if left out, and 3 for a single file
    #[arg(long, value_name = "VERSION", value_parser = clap::value_parser!(u32).range(2..=3))]
    pub fmi: Option<u32>,
    /// Platform to run on, repeatable; `host`, which is this one, if left out. Others, and `all` that can be had, are
    /// taken from a folder `units` beside the program, or compiled, which needs cargo-zigbuild and the sources
    #[arg(long, value_name = "PLATFORM", value_parser = platforms())]
    pub platforms: Vec<String>,
    /// Directory of libraries that are compiled already, PLATFORM/libtoolroom_fmu.so and so on: every platform that it
    /// has, or those of --platforms. packaging/units.sh makes one
    #[arg(long, value_name = "DIR")]
    pub libraries: Option<PathBuf>,
    /// Parameter set file to pack beside the shipped sets, repeatable
    #[arg(long, value_name = "SET")]
    pub parameters: Vec<PathBuf>,
    /// Directory of the packages, or the package itself, FILE.fmu
    #[arg(long, value_name = "PATH", default_value = "out/fmu")]
    pub out: PathBuf,
}

fn entries() -> impl TypedValueParser<Value = &'static Entry> {
    let named = |name: String| units().find(|entry| entry.name == name).ok_or("no such model");
    PossibleValuesParser::new(units().map(|entry| entry.name)).try_map(named)
}

/// This machine, every platform that can be compiled for here, and each by its name.
fn platforms() -> PossibleValuesParser {
    PossibleValuesParser::new(["host", "all"].into_iter().chain(Platform::ALL.iter().map(|platform| platform.name())))
}

#[derive(Subcommand, Debug)]
pub enum SspCommand {
    /// Package a lathe of a scenario and the policy that controls it as two units with the signals between them
    #[command(before_help = "Examples:
  toolroom ssp export scenarios/fmu-lathe-native.toml --machine L1 --policy adaptive --out cell.ssp
  toolroom ssp export shop.toml --machine L1 --operation ring.turn --fmi 3 --stop \"2 h\" --out cell.ssp
  toolroom ssp export shop.toml --machine L1 --flat --out cell.ssp      for Ecos and libcosim")]
    Export(SspExportArgs),
    /// What a system is made of: units, signals, start values
    #[command(before_help = "Examples:
  toolroom ssp info cell.ssp
  toolroom ssp info cell.ssp --json")]
    Info(FmuFileArgs),
    /// Run a system: its units step together, outputs to a table
    #[command(before_help = "Examples:
  toolroom ssp sim cell.ssp
  toolroom ssp sim cell.ssp --stop \"600 s\" --step \"1 s\" --output result.csv
  toolroom ssp sim cell.ssp --order jacobi
  toolroom ssp sim cell.ssp --order controller,lathe --start lathe.tool.set=c45_t15k6")]
    Sim(SspSimArgs),
}

#[derive(Args, Debug)]
pub struct SspExportArgs {
    #[command(flatten)]
    pub scenario: ScenarioArgs,
    /// Machine, by its name in the scenario
    #[arg(long, value_name = "NAME")]
    pub machine: String,
    /// Policy; the first one, if left out
    #[arg(long, value_name = "NAME")]
    pub policy: Option<String>,
    /// Operation, as OPERATION or PART.OPERATION; the first one that the machine cuts, if left out
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// Version of the standard of both units; 2 is read by every tool
    #[arg(long, value_name = "VERSION", default_value_t = 2, value_parser = clap::value_parser!(u32).range(2..=3))]
    pub fmi: u32,
    /// Nothing at the system itself and no enumerations, in FMI 2.0: what Ecos and libcosim read
    #[arg(long)]
    pub flat: bool,
    /// Platform to run on, repeatable, as with `fmu export`
    #[arg(long, value_name = "PLATFORM", value_parser = platforms())]
    pub platforms: Vec<String>,
    /// Directory of libraries that are compiled already, as with `fmu export`
    #[arg(long, value_name = "DIR")]
    pub libraries: Option<PathBuf>,
    /// End of the default experiment
    #[arg(long, value_name = "TIME", default_value = "1 h")]
    pub stop: String,
    /// The package
    #[arg(long, value_name = "FILE.ssp")]
    pub out: PathBuf,
}

#[derive(Args, Debug)]
pub struct SspSimArgs {
    /// Package of SSP 1.0 or 2.0
    pub file: PathBuf,
    /// `gauss-seidel`: one unit after the other as the file has them; `jacobi`: all at once, signals come a step late;
    /// or the units by name, parted by commas
    #[arg(long, value_name = "ORDER", default_value = "gauss-seidel")]
    pub order: String,
    #[command(flatten)]
    pub run: UnitRunArgs,
}

#[derive(Args, Debug)]
pub struct FmuFileArgs {
    /// Unit of FMI 2.0 or 3.0, or package of SSP
    pub file: PathBuf,
}
