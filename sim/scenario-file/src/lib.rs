//! Scenario files: TOML in, a resolved [`Scenario`] or every fault with its place out.
//!
//! ```text
//!  bytes ─decode─► text ─TOML─► tree ◄─ --set key=value
//!                                │ walk: units, ranges, unknown and missing keys, by the
//!                                │       tables of keys.rs
//!                                ▼
//!                             sections ─resolve: names, parameter sets, contradictions─► Scenario
//! ```
//! The tables in `keys.rs` say everything about every key once: kind, unit, range, default,
//! meaning. The room [`toolroom_form`] makes reader, JSON schema, the echo of `toolroom check` and
//! the error texts from them.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod calendars;
mod choices;
mod codes;
mod control;
mod cribs;
mod failures;
mod fault;
mod fitted;
mod flow;
mod imported;
mod jobs;
mod keys;
mod matrix;
mod measured;
mod names;
mod order_columns;
mod orders;
mod planned;
mod processes;
mod progress;
mod queue_rules;
mod random;
mod required;
mod resolve;
mod resources;
mod routing;
mod rules;
mod schedule;
mod shared;
mod speed;
mod stability;
mod stocks;
mod table;
mod transport;
mod tune;
mod variants;

pub use codes::CODES;
pub use fault::ScenarioFault;
pub use keys::{GAP, SCENARIO, SENSORS};
pub use processes::process_of;
pub use rules::{gap as gap_section, sensors};
pub use variants::{AS_IT_IS, ShopVariant, literal};

use std::path::{Path, PathBuf};
use toolroom_form::{Echo, FormFile, ReadError};
use toolroom_scenario::{GapSection, Scenario, TuneRequest};

/// What a scenario file says.
#[derive(Clone, Debug)]
pub struct ScenarioFile {
    /// What is simulated.
    pub scenario: Scenario,
    /// Every value as it was understood, defaults included, in the order of the sections.
    pub echo: Vec<Echo>,
    /// What is to be written.
    pub output: Output,
    /// Priors and sensors of a gap diagnosis.
    pub gap: Option<GapSection>,
    /// How the policies are tuned, where the file has a section `[tune]`.
    pub tune: Option<TuneRequest>,
    /// Variants of the shop, in the order of the file.
    pub variants: Vec<ShopVariant>,
    /// What is to be known and how well.
    pub statistics: Statistics,
    /// The text, for records of what was run.
    pub text: String,
    /// Other files that it names: cycles, contours, structures, units.
    pub files: Vec<PathBuf>,
}

/// The section `[statistics]`, as it stands in the file: figures are known where they are computed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// The figure that matters most.
    pub primary: Option<String>,
    /// Figures and how well they have to be known, by name.
    pub until: Vec<(String, String)>,
    /// Most replications until they are known so well.
    pub max_replications: Option<u32>,
    /// By what the best shop is selected.
    pub select: Option<SelectSection>,
}

/// The key `select` of `[statistics]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SelectSection {
    /// Figure of the shop.
    pub kpi: String,
    /// Least difference that matters.
    pub indifference: String,
    /// Probability of a right selection, 0.5 to below 1.
    pub confidence: f64,
}

/// The section `[output]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Log tables as CSV instead of Parquet.
    pub csv: bool,
    /// Whether log tables are written at all.
    pub logs: bool,
}

/// Reads a scenario file; `overrides` are `path=value` as after `--set`.
///
/// # Errors
/// [`ReadError`]: the file cannot be opened or decoded, or every fault found in it.
pub fn read(path: &Path, overrides: &[String]) -> Result<ScenarioFile, ReadError> {
    toolroom_form::read(path, overrides, &SCENARIO, resolve::scenario).map(ScenarioFile::new)
}

/// Reads the text of a scenario; `file` is its name in messages.
///
/// # Errors
/// [`ReadError::Faults`] with every fault found.
///
/// # Examples
/// ```
/// use toolroom_form::ReadError;
/// use toolroom_scenario_file::parse;
/// let Err(ReadError::Faults(list)) = parse("shop.toml", "schema = 1\n[shpo]\n", &[]) else { panic!() };
/// assert!(list.to_string().starts_with("shop.toml:1:1: "));
/// assert!(list.problems.iter().any(|problem| problem.fault.code() == "unknown-key"));
/// ```
pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<ScenarioFile, ReadError> {
    toolroom_form::parse(file, text, overrides, &SCENARIO, resolve::scenario).map(ScenarioFile::new)
}

impl ScenarioFile {
    fn new(file: FormFile<resolve::ScenarioContent>) -> Self {
        let FormFile { content, echo, text, files } = file;
        let resolve::ScenarioContent { scenario, output, gap, tune, variants, statistics } = content;
        Self { scenario, echo, output, gap, tune, variants, statistics, text, files }
    }

    /// Most replications of a study that ends when figures are known well enough (`sequential`), or their number.
    pub fn replications(&self, sequential: bool) -> u32 {
        self.statistics.max_replications.filter(|_| sequential).unwrap_or(self.scenario.replications)
    }
}
