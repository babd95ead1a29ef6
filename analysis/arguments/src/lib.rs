//! The command line as clap reads it: verbs, options and their help.

#![deny(clippy::wildcard_enum_match_arm)]
// Doc comments are help texts here: `time [s]` is a column, not a link, and what groups options has no text of its own.
#![allow(rustdoc::broken_intra_doc_links, missing_docs)]

mod calibrate;
mod calibration_data;
mod files;
mod gap;
mod import;
mod lobes;
mod modes;
mod planning;
mod program;

pub use calibrate::CalibrateArgs;
pub use calibration_data::CalibrationData;
pub use files::{CheckArgs, NewArgs, ReferenceArgs, SchemaArgs};
pub use gap::{
    ApplyArgs, BlindArgs, BlindCases, DiagnoseArgs, GapCommand, GapData, IdentifiabilityArgs, LoopArgs, PlanArgs,
    PredictArgs, WatchArgs,
};
pub use import::{ImportCommand, ImportCsvArgs, ImportTableArgs, MtconnectArgs, NistRunsArgs};
pub use lobes::LobesArgs;
pub use modes::{CoefficientsArgs, ListenArgs, ModesArgs, SwapArgs};
pub use planning::{ContourArgs, GrindArgs, IdentifyArgs};
pub use program::ProgramArgs;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use toolroom_fmu::{Entry, Platform, units};

/// Constant against adaptive cutting speed in a simulated machining shop.
#[derive(Parser, Debug)]
#[command(
    name = "toolroom",
    version,
    before_help = "Examples:
  toolroom demo                                   the shipped shop, every policy, in seconds
  toolroom new myshop                             a commented scenario to edit
  toolroom check myshop/scenario.toml             every problem at once, units echoed
  toolroom compare myshop/scenario.toml           policies on common random numbers
  toolroom compare myshop/scenario.toml --set machine.L.tool_change_time=\"1 min\"
  toolroom point turning --tool ni_vk6om --set cutting_speed=\"40 m/min\"",
    after_help = "Exit codes:
  0 done; 1 the work failed or was interrupted; 2 the input is wrong;
  3 done, but the answer must not be overlooked (too little data for one)",
    arg_required_else_help = true,
    disable_help_subcommand = true
)]
pub struct Toolroom {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub common: Common,
}

/// Flags of every verb.
#[derive(Args, Clone, Debug)]
pub struct Common {
    /// Result as JSON on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Say nothing but results and errors
    #[arg(long, short, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more about how the work was done
    #[arg(long, short, global = true)]
    pub verbose: bool,
    /// Tables as wide as they are, whatever the width of the terminal
    #[arg(long, global = true)]
    pub wide: bool,
    /// Memory at which the work is ended and what is finished is kept, such as "4 GB"; half of the machine, if left out
    #[arg(long, global = true, value_name = "SIZE", value_parser = toolroom_output::memory::bound)]
    pub max_memory: Option<u64>,
    /// Replace files that toolroom did not write, or that were changed since; never an input
    #[arg(long, global = true)]
    pub force: bool,
}

#[derive(Subcommand, Debug)]
pub enum Command {
    /// The shipped shop: three lathes, two mills, a grinder, every policy, in seconds
    #[command(before_help = "Examples:
  toolroom demo                  results in out/demo
  toolroom demo --replications 100 --policy \"v0 at 0.2 mm\" --policy productivity")]
    Demo(DemoArgs),
    /// Compare the policies of a scenario, and variants of its shop, on common random numbers
    #[command(before_help = "Examples:
  toolroom compare shop.toml
  toolroom compare shop.toml --axis variant                    [[variant]] against the shop as it is
  toolroom compare shop.toml --select \"late_orders 1\"           the best variant, with a guarantee
  toolroom compare shop.toml --until \"half-width 2%\" --replications 1000
  toolroom compare shop.toml --replications 1000 --resume      goes on after Ctrl-C
  toolroom compare shop.toml --set machine.L.tool_change_time=\"1 min\" --json
  toolroom compare shop.toml -P machine.L.tool_change_time \"1 min\" \"5 min\" \"1 min\"")]
    Compare(CompareArgs),
    /// Run policies with the full logs of every replication
    #[command(before_help = "Examples:
  toolroom run shop.toml --policy adaptive --out out/adaptive
  toolroom run shop.toml --records out/records      as if measured, for `toolroom gap diagnose`
  toolroom run shop.toml --format csv --replications 3")]
    Run(RunArgs),
    /// Find or open the report of a finished run; draw it again where it is missing
    #[command(before_help = "Examples:
  toolroom report out/demo
  toolroom report --open out/demo")]
    Report(ReportArgs),
    /// Compare the key figures of two finished runs, in pairs where they share their random numbers
    #[command(before_help = "Examples:
  toolroom diff out/monday out/tuesday

Runs of one seed in which the same machines, tools, operations, sources and failures draw are paired by replication;
others are compared as independent samples, and the output says why.")]
    Diff(DiffArgs),
    /// Write a commented file of any kind to edit, with sample data
    #[command(
        allow_missing_positional = true,
        before_help = "Examples:
  toolroom new myshop            writes myshop/scenario.toml and its schema for editors
  toolroom compare myshop/scenario.toml
  toolroom new gap mygap         a nominal model, a mapping and 168 records of a lathe
  toolroom new lobes mychart     a stability chart; other kinds: toolroom new --help"
    )]
    New(NewArgs),
    /// Validate a file of any kind: every problem at once, quantities echoed with units
    #[command(before_help = "Examples:
  toolroom check myshop/scenario.toml
  toolroom check myshop/scenario.toml --set machine.L.rate=\"70 EUR/h\" --json
  toolroom check scenarios/grinding/cycle.toml      cycle, contour, lobes, life, mapping and gap model files too
  toolroom check shop.toml --kind gap               a scenario as a nominal model

The kind of a file is told by the keys and tables at its top; --kind overrides it.")]
    Check(CheckArgs),
    /// Calculate every output of a process at one operating point
    #[command(before_help = "Examples:
  toolroom point turning --tool ni_vk6om --set cutting_speed=\"40 m/min\" --set flank_wear=\"0.2 mm\"
  toolroom point turning --tool c45_t15k6 --effect wear_force=0.2 --json
  toolroom point turning --effects my-effects.toml --effect my.crater=0.1
  toolroom point infeed --set infeed_per_rev=\"4.43 um/rev\" --advance \"3 s\"")]
    Point(PointArgs),
    /// Stability chart of milling, turning or a chuck, or the verdict at one point of it
    #[command(before_help = "Examples:
  toolroom lobes scenarios/chatter/milling-slot.toml
  toolroom lobes scenarios/chatter/milling-slot.toml --at \"5000 rpm\" \"0.5 mm\" --json
  toolroom lobes chart.toml --best --show power --show sle    within [limits] of the file; greatest removal rate
  toolroom lobes chart.toml --robust \"2 mm\"                  speeds by the probability of stability
  toolroom lobes scenarios/chatter/turning-bar.toml --set bar.position=\"100 mm\"
  toolroom lobes scenarios/chuck-fig3.toml --at 1 0.3        speed ratio (or rpm) and modulation
  toolroom lobes chart.toml --plan plan.json --shards 64     for a cluster
  toolroom lobes --run plan.json --shard 17 --out parts      one shard of it; then: toolroom merge parts")]
    Lobes(LobesArgs),
    /// Vibration modes with their uncertainty from a tap test: frequency responses in CSV or universal files
    #[command(before_help = "Examples:
  toolroom modes tap.csv --averages 5 --out spindle3-d12.toml
  toolroom modes tap.uff --averages 4 --report out/modes       pictures and the stabilisation diagram
  toolroom modes tap.csv --pick \"612 Hz\" --pick \"1185 Hz\" --direction \"30 deg\"
  toolroom modes tap.csv --read                                what the file holds, without a fit
  toolroom modes spindle3-d12.toml --cuts cuts.csv --lobes chart.toml --out new.toml    brought up to date by the shop

A lobes file takes the result by structure = \"spindle3-d12.toml\" in place of its [[mode]].")]
    Modes(ModesArgs),
    /// Modes at the tip of a tool on a spindle that was measured, by receptance coupling
    #[command(before_help = "Examples:
  toolroom swap spindle.toml --tool endmill12.toml --out spindle-d12.toml
  toolroom swap spindle.toml --tool endmill12.toml --range \"50 Hz\" \"8000 Hz\" --report out/swap")]
    Swap(SwapArgs),
    /// Whether the sound of a milling cut is that of chatter, and at which speeds it would be quiet
    #[command(before_help = "Examples:
  toolroom listen cut.wav --teeth 4 --speed \"7500 rpm\"
  toolroom listen cut.wav --teeth 4 --speed \"7500 rpm\" --air air.wav --lobes chart.toml")]
    Listen(ListenArgs),
    /// Cutting-force coefficients with their uncertainty from mean forces, or of a group of work materials
    #[command(before_help = "Examples:
  toolroom coefficients slot.csv --teeth 2 --depth \"2 mm\" --out al7075.toml
  toolroom coefficients side.csv --teeth 4 --depth \"3 mm\" --immersion 0.25 --axes=-x,-y,z
  toolroom coefficients --list                              groups of work materials and their source
  toolroom coefficients --group 6 --chip-thickness \"0.08 mm\" --out steel.toml

A lobes file takes the result by coefficients = \"al7075.toml\" in [force] or [cut].")]
    Coefficients(CoefficientsArgs),
    /// Tool lives: a Monte Carlo study, or laws fitted to measured lives
    #[command(before_help = "Examples:
  toolroom life scenarios/life/policies.toml          study of policies, report in out/policies
  toolroom life study.toml --lives 1000000 --set scatter=\"lab\"
  toolroom life study.toml --plan plan.json --shards 256      for a cluster
  toolroom life --run plan.json --shard 17 --out parts        one shard of it; then: toolroom merge parts
  toolroom life --fit lives.csv                       columns life [min], censored, inspected, group
  toolroom life --fit nasa.csv --edge case --age time --wear VB --limit 0.3 \\
      --regress \"ln(DOC)\" --regress \"ln(feed)\" --regress material=2")]
    Life(LifeArgs),
    /// A parameter set from what a shop knows of its own tools
    #[command(before_help = "Examples:
  toolroom calibrate turning --life \"15 min\" --at \"200 m/min\" --feed \"0.25 mm/rev\" --out first.toml
  toolroom calibrate turning --model c45_t15k6 --data wear.csv --limit \"0.3 mm\" --out my.toml
  toolroom check first.toml                 every value with where it comes from
  toolroom point turning --tool first.toml --set cutting_speed=\"250 m/min\"")]
    Calibrate(CalibrateArgs),
    /// Lag and stiffnesses of machine and grinding process from plunge trials
    #[command(before_help = "Examples:
  toolroom identify scenarios/data/zb153u_trials.csv
  toolroom identify trials.csv --forces forces.csv --basis force
  toolroom identify trials.csv --error stock=\"1 um\" --json")]
    Identify(IdentifyArgs),
    /// The fastest rough, finish and spark-out cycle within limits, and when to dress
    #[command(before_help = "Examples:
  toolroom grind scenarios/grinding/cycle.toml
  toolroom grind scenarios/grinding/cycle.toml --set conditions.coolant_factor=0.75
  toolroom grind scenarios/grinding/cycle.toml --set limits.power=\"2 kW\" --set wheel=worst
  toolroom grind scenarios/grinding/cycle.toml --set effects.threshold_force=\"5 N\" --json")]
    Grind(GrindArgs),
    /// Spindle speeds and feeds along a milled contour: least time, least cost, against handbook regimes
    #[command(before_help = "Examples:
  toolroom contour scenarios/contour/rk3.toml
  toolroom contour scenarios/contour/rk3.toml --pass finish --set economics.edge_cost=\"20 EUR\"
  toolroom contour setup.toml --gcode part.nc            contour from a part program
  toolroom contour scenarios/contour/cam.toml --ramps --json")]
    Contour(ContourArgs),
    /// Nominal cycle time of a part program, block by block: feeds, rapids, dwells, tool changes, holes
    #[command(before_help = "Examples:
  toolroom program part.nc
  toolroom program part.nc --set tool_change_time=\"6 s\" --set inverse_acceleration=\"0.5 s2/m\" --json
  toolroom program part.nc --blocks blocks.csv")]
    Program(ProgramArgs),
    /// Run one shard of a plan made by life, compare or lobes with --plan
    #[command(before_help = "Examples:
  toolroom compare shop.toml --replications 1000 --plan plan.json --shards 50
  toolroom shard plan.json 17 --out parts            anywhere, in any order, as often as you like
  seq 0 49 | xargs -P 8 -I{} toolroom shard plan.json {} --out parts --threads 1
  toolroom merge parts")]
    Shard(ShardArgs),
    /// Merge the parts of a study, comparison or chart that was run in shards
    #[command(before_help = "Examples:
  toolroom merge parts
  toolroom merge parts --out out/study --json")]
    Merge(MergeArgs),
    /// Published numbers beside computed ones, for every model
    #[command(before_help = "Examples:
  toolroom validate
  toolroom validate --json")]
    Validate,
    /// List the effects that a nominal model leaves out
    #[command(before_help = "Examples:
  toolroom effects
  toolroom effects --json
  toolroom effects --context                       what formulas of effects of your own may name")]
    Effects(EffectsArgs),
    /// FMI units: package a model, look into any, check it, run one
    #[command(subcommand)]
    Fmu(FmuCommand),
    /// Systems of FMI units as SSP packages: look into one, run one
    #[command(subcommand)]
    Ssp(SspCommand),
    /// Write the reference: every command, key, key figure, effect and error code
    #[command(before_help = "Examples:
  toolroom reference out/reference        pages in Markdown
  toolroom reference --man ~/.local/share/man/man1")]
    Reference(ReferenceArgs),
    /// Print the JSON schema of a kind of file, for editors
    #[command(before_help = "Examples:
  toolroom schema > scenario.schema.json
  toolroom schema lobes > lobes.schema.json")]
    Schema(SchemaArgs),
    /// Where a nominal model and measured records differ, which effect is missing, how far the gap shrinks
    #[command(subcommand)]
    Gap(GapCommand),
    /// Measured data of others as records
    #[command(subcommand)]
    Import(ImportCommand),
    /// Explain the code of an error
    #[command(before_help = "Examples:
  toolroom explain quantity
  toolroom explain               every code")]
    Explain(ExplainArgs),
    /// Completions for a shell
    #[command(before_help = "Examples:
  toolroom completions bash > /etc/bash_completion.d/toolroom
  toolroom completions zsh  > ~/.zfunc/_toolroom")]
    Completions(CompletionsArgs),
}

#[derive(Subcommand, Debug)]
pub enum FmuCommand {
    /// Package a cutting process as an FMI unit
    #[command(before_help = "Examples:
  toolroom fmu export turning                 out/fmu/toolroom_turning_fmi2.fmu and _fmi3.fmu
  toolroom fmu export milling --fmi 3 --out .
  toolroom fmu export milling --out mill.fmu             this one file, FMI 3.0 unless --fmi 2
  toolroom fmu export turning --platforms x86_64-linux --platforms x86_64-windows")]
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
    /// compiled, which needs cargo-zigbuild and the sources
    #[arg(long, value_name = "PLATFORM", value_parser = platforms())]
    pub platforms: Vec<String>,
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
  toolroom ssp export shop.toml --machine L1 --operation ring.turn --fmi 3 --stop \"2 h\" --out cell.ssp")]
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
    /// Platform to run on, repeatable, as with `fmu export`
    #[arg(long, value_name = "PLATFORM", value_parser = platforms())]
    pub platforms: Vec<String>,
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

/// A scenario and changes to it.
#[derive(Args, Clone, Debug)]
pub struct ScenarioArgs {
    /// Scenario file
    pub file: PathBuf,
    #[command(flatten)]
    pub changes: Changes,
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
}

impl Changes {
    /// All changes as `path=value`, the flags last so that they win.
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.set.clone();
        overrides.extend(self.seed.map(|seed| format!("shop.seed={seed}")));
        overrides.extend(self.replications.map(|count| format!("shop.replications={count}")));
        overrides
    }
}

#[derive(Args, Debug)]
pub struct ExplainArgs {
    /// Code in the message, such as `quantity`; every code, if left out
    pub code: Option<String>,
}

#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// Shell
    pub shell: clap_complete::Shell,
}

#[derive(Args, Debug)]
pub struct EffectsArgs {
    /// List quantities and terms that formulas of effects of your own may name, instead of the effects
    #[arg(long)]
    pub context: bool,
    /// File of effects of your own, listed behind those of the catalogue, repeatable
    #[arg(long, value_name = "EFFECTS.toml")]
    pub effects: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub struct PointArgs {
    /// Process
    pub process: PointProcess,
    /// Parameter set of tool and work material, by name or path; the process's default, if left out
    #[arg(long, value_name = "SET")]
    pub tool: Option<String>,
    /// Input, state or group.parameter with its unit, repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Effect switched on, id=size, repeatable
    #[arg(long, value_name = "ID=SIZE")]
    pub effect: Vec<String>,
    /// File of effects of your own, beside those of the catalogue, repeatable
    #[arg(long, value_name = "EFFECTS.toml")]
    pub effects: Vec<PathBuf>,
    /// Hold the input for this time first
    #[arg(long, value_name = "TIME")]
    pub advance: Option<String>,
    /// Tool body in the life of turning: warm at once, or warming up
    #[arg(long, value_enum, default_value_t = PointLife::QuasiSteady)]
    pub life_model: PointLife,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub enum PointProcess {
    Turning,
    Milling,
    Infeed,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
#[value(rename_all = "snake_case")]
pub enum PointLife {
    QuasiSteady,
    Ode,
}

impl From<PointProcess> for toolroom_planning::point::PointProcess {
    fn from(process: PointProcess) -> Self {
        match process {
            PointProcess::Turning => Self::Turning,
            PointProcess::Milling => Self::Milling,
            PointProcess::Infeed => Self::Infeed,
        }
    }
}

impl From<PointLife> for toolroom_cutting::LifeModel {
    fn from(life: PointLife) -> Self {
        match life {
            PointLife::QuasiSteady => Self::QuasiSteady,
            PointLife::Ode => Self::Ode,
        }
    }
}

#[derive(Args, Debug)]
pub struct LifeArgs {
    /// Study file
    #[arg(required_unless_present_any = ["fit", "run"], conflicts_with_all = ["fit", "run"])]
    pub file: Option<PathBuf>,
    #[command(flatten)]
    pub shards: Shards,
    /// Fit laws to measured lives, or to wear readings with --wear
    #[arg(long, value_name = "CSV", conflicts_with = "run")]
    pub fit: Option<PathBuf>,
    #[command(flatten)]
    pub readings: Readings,
    /// Regress ln(life) on a column, on ln(COLUMN), or on COLUMN=VALUE, repeatable
    #[arg(long, value_name = "COLUMN", requires = "fit")]
    pub regress: Vec<String>,
    #[command(flatten)]
    pub statistics: Statistics,
    /// Directory of the results, out/NAME if left out; of the parts with --run
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// How a study is run.
#[derive(Args, Clone, Debug)]
pub struct Shards {
    /// Replace a value of the study: path=value with unit, repeatable
    #[arg(long, value_name = "KEY=VALUE", conflicts_with_all = ["fit", "run"])]
    pub set: Vec<String>,
    /// Lives of every condition under every policy, instead of the study's
    #[arg(long, conflicts_with_all = ["fit", "run"])]
    pub lives: Option<u64>,
    /// Write a plan instead of running
    #[arg(long, value_name = "FILE", conflicts_with_all = ["fit", "run"])]
    pub plan: Option<PathBuf>,
    /// Number of shards
    #[arg(long, conflicts_with_all = ["fit", "run"], value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub shards: Option<u64>,
    /// Run one shard of a plan
    #[arg(long, value_name = "PLAN", requires_all = ["shard", "out"])]
    pub run: Option<PathBuf>,
    /// Its number, from 0
    #[arg(long, requires = "run")]
    pub shard: Option<u64>,
    /// Go on with a study that was stopped
    #[arg(long, conflicts_with_all = ["fit", "run", "plan"])]
    pub resume: bool,
    /// Threads, 0 for one per processor; the results do not depend on it
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
}

#[derive(Args, Debug)]
pub struct ShardArgs {
    /// Plan
    pub plan: PathBuf,
    /// Number of the shard, from 0
    pub shard: u64,
    /// Directory of the parts
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Threads, 0 for one per processor; the results do not depend on it
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
}

#[derive(Args, Debug)]
pub struct MergeArgs {
    /// Directory of the parts
    pub dir: PathBuf,
    #[command(flatten)]
    pub statistics: Statistics,
    /// Directory of the results, out/NAME if left out
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Wear readings that become lives.
#[derive(Args, Clone, Debug)]
pub struct Readings {
    /// Column of wear readings: the life is the age at which they reach --limit
    #[arg(long, value_name = "COLUMN", requires_all = ["limit", "edge", "age"])]
    pub wear: Option<String>,
    /// Wear at which an edge is spent, in the unit of the column
    #[arg(long, value_name = "WEAR", requires = "wear")]
    pub limit: Option<f64>,
    /// Column that names the edge, repeatable
    #[arg(long, value_name = "COLUMN", requires = "wear")]
    pub edge: Vec<String>,
    /// Column of the age
    #[arg(long, value_name = "COLUMN", requires = "wear")]
    pub age: Option<String>,
    /// Column of the group
    #[arg(long, value_name = "COLUMN", requires = "wear")]
    pub group: Option<String>,
    /// Take the life as lying between two readings instead of interpolating
    #[arg(long, requires = "wear")]
    pub between: bool,
}

/// What is worked out of lives.
#[derive(Args, Clone, Debug)]
pub struct Statistics {
    /// Cost of a planned replacement and of a failure, in any money; 1 and 5 if left out
    #[arg(long, num_args = 2, value_names = ["PLANNED", "FAILURE"])]
    pub costs: Vec<f64>,
    /// Confidence of intervals and bands
    #[arg(long, default_value_t = 0.9, value_parser = confidence)]
    pub confidence: f64,
    /// Resampled refits behind the bands
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u32).range(20..=100_000))]
    pub bootstrap: u32,
    /// Samples behind the p of each fit, 0 for none
    #[arg(long, default_value_t = 199, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    pub goodness: u32,
    /// Seed of every random stream
    #[arg(long)]
    pub seed: Option<u64>,
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
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// Stop when parts per shift and cost per part are known this well: "half-width 2%"
    #[arg(long, value_name = "PRECISION")]
    pub until: Option<toolroom_study::study::Precision>,
    /// Format of the log tables, instead of the scenario's
    #[arg(long, value_enum)]
    pub format: Option<LogFormat>,
    /// Replications whose full logs are written
    #[arg(long, value_name = "COUNT")]
    pub logged: Option<u32>,
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
    #[command(flatten)]
    pub changes: Changes,
    #[command(flatten)]
    pub study: StudyArgs,
}

#[derive(Args, Debug)]
pub struct RunArgs {
    #[command(flatten)]
    pub scenario: ScenarioArgs,
    #[command(flatten)]
    pub study: StudyArgs,
}

#[derive(Args, Debug)]
pub struct CompareArgs {
    #[command(flatten)]
    pub scenario: ScenarioArgs,
    #[command(flatten)]
    pub study: StudyArgs,
    /// Repeat the comparison at several values of a key; nothing is written
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
    #[arg(long, value_enum, conflicts_with = "sweep")]
    pub axis: Option<Axis>,
    /// Select the best of the shop and its variants under the first policy, by a figure and the least difference that
    /// matters, such as "lead_time 5 min" or "late_orders 1"; runs as often as that needs
    #[arg(long, value_name = "FIGURE DIFFERENCE", conflicts_with_all = ["sweep", "plan"])]
    pub select: Option<String>,
}

/// What `compare` compares.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Policies of the shop as it is
    Policy,
    /// Variants of the shop under the first policy
    Variant,
    /// Variants under every policy
    Both,
}

impl Axis {
    /// As it was typed, with a space before it.
    pub fn typed(self) -> &'static str {
        match self {
            Self::Policy => " --axis policy",
            Self::Variant => " --axis variant",
            Self::Both => " --axis both",
        }
    }
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

/// A confidence between 50 and 99.9 %: `0.9`, `90 %`.
pub fn confidence(text: &str) -> Result<f64, String> {
    let share = match text.trim().strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().map(|percent| percent / 100.0),
        None => text.trim().parse(),
    };
    match share {
        Ok(share) if (0.5..=0.999).contains(&share) => Ok(share),
        _ => Err("a confidence from 0.5 to 0.999 is due, such as 0.9 or 90%".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_confidence_is_read_as_people_write_it() {
        assert_eq!([confidence("0.9"), confidence("90%"), confidence("90 %")], [Ok(0.9), Ok(0.9), Ok(0.9)]);
        assert!(["0", "1", "9", "x"].iter().all(|text| confidence(text).is_err()));
    }
}
