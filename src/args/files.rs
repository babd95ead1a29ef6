//! Arguments of the verbs that write, check and describe files.

use super::ScenarioArgs;
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct NewArgs {
    /// Directory to create
    pub dir: PathBuf,
}

#[derive(Args, Debug)]
pub struct SchemaArgs {
    /// Kind of file
    #[arg(default_value = "scenario")]
    pub kind: FileKind,
}

#[derive(clap::ValueEnum, Clone, Copy, Debug)]
pub enum FileKind {
    Scenario,
    Lobes,
    Life,
    /// diagnosis.json of `gap diagnose`
    Diagnosis,
}

#[derive(Args, Debug)]
pub struct CheckArgs {
    #[command(flatten)]
    pub scenario: ScenarioArgs,
}
