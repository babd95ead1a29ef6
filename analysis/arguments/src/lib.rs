//! The command line as clap reads it: verbs, options and their help.

#![deny(clippy::wildcard_enum_match_arm)]
// Doc comments are help texts here: `time [s]` is a column, not a link, and what groups options has no text of its own.
#![allow(rustdoc::broken_intra_doc_links, missing_docs)]

mod calibrate;
mod calibration_data;
mod files;
mod gap;
mod import;
mod life;
mod lobes;
mod modes;
mod planning;
mod point;
mod program;
pub mod reference;
mod study;
mod unit;

pub use calibrate::CalibrateArgs;
pub use calibration_data::{CalibrationData, CalibrationStart};
pub use files::{CheckArgs, NewArgs, ReferenceArgs, SchemaArgs};
pub use gap::{
    ApplyArgs, BlindArgs, BlindCases, DiagnoseArgs, GapCommand, GapData, IdentifiabilityArgs, LoopArgs, PlanArgs,
    PredictArgs, RecoveryArgs, WatchArgs,
};
pub use import::{ImportCommand, ImportCsvArgs, ImportShopArgs, ImportTableArgs, MtconnectArgs, NistRunsArgs};
pub use life::{LifeArgs, MergeArgs, Readings, ShardArgs, Shards, Statistics, confidence};
pub use lobes::LobesArgs;
pub use modes::{CoefficientsArgs, ImportFrfArgs, ListenArgs, ModesArgs, ModesUpdateArgs, ModesVerb, SwapArgs};
pub use planning::{ContourArgs, GrindArgs, IdentifyArgs};
pub use point::{PointArgs, PointLife, PointProcess};
pub use program::ProgramArgs;
pub use study::{
    Changes, CompareArgs, DemoArgs, DiffArgs, LogFormat, ReportArgs, RunArgs, ScenarioArgs, StartArgs, StudyArgs,
};
pub use unit::{
    FmuCommand, FmuExportArgs, FmuFileArgs, FmuInterface, FmuIsolation, FmuSimArgs, SspCommand, SspExportArgs,
    SspSimArgs, UnitRunArgs,
};

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

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
  0 done; 1 the work failed, or --strict refuses its result; 2 the input is wrong;
  3 done, but the answer must not be overlooked (too little data for one, an alarm);
  130 interrupted by Ctrl-C (SIGINT); 143 ended by SIGTERM",
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

/// Threads that a computer may be asked for: more only take turns (assumption).
const MOST_THREADS: u64 = 256;

/// A number of threads from 0 to [`MOST_THREADS`].
fn threads() -> clap::builder::RangedU64ValueParser<usize> {
    clap::builder::RangedU64ValueParser::new().range(0..=MOST_THREADS)
}

#[derive(Subcommand, Debug)]
pub enum Command {
    /// The shipped shop: three lathes, two mills, a grinder, every policy, in seconds
    #[command(before_help = "Examples:
  toolroom demo                  results in out/demo
  toolroom demo --shop           a job shop with an order table
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
  toolroom run shop.toml --format csv --replications 3
  toolroom run shop.toml --snapshot-at \"2026-04-01 06:00\" --snapshot wednesday.trs
  toolroom run --from wednesday.trs --set dispatch.rule=edd --out out/edd")]
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
  toolroom check *.toml                             every file, a line for each

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
  toolroom modes tap.csv --coherence coherence.csv             responses and coherence in two files
  toolroom modes update spindle3-d12.toml --cuts cuts.csv --lobes chart.toml --out new.toml    by cuts of the shop

A lobes file takes the result by structure = \"spindle3-d12.toml\" in place of its [[mode]].")]
    Modes(ModesArgs),
    /// Modes at the tip of a tool on a spindle that was measured, by receptance coupling
    #[command(before_help = "Examples:
  toolroom swap spindle.toml --tool endmill12.toml --out spindle-d12.toml
  toolroom swap spindle.toml --tool endmill12.toml --range \"50 Hz\" \"8000 Hz\" --report out/swap
  toolroom swap taps.csv --blank \"steel d=16 mm L=40 mm\" --second \"25 mm\" --averages 5 --tool endmill12.toml --out d12.toml
  toolroom swap spindle.toml --tool endmill12.toml --measured tap.csv --fit-joint")]
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
  toolroom contour setup.toml --dxf part.dxf --layer OUTER    contour from a drawing
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
