//! Arguments of the verbs that write, check and describe files.

use super::Changes;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;
use toolroom_kinds::{FileKind, KINDS};

#[derive(Args, Debug)]
pub struct NewArgs {
    /// Kind of file; a scenario, if left out
    #[arg(value_parser = described())]
    pub kind: Option<&'static FileKind>,
    /// Directory to create
    #[arg(required = true)]
    pub dir: PathBuf,
}

#[derive(Args, Debug)]
pub struct ReferenceArgs {
    /// Directory of the pages
    #[arg(default_value = "out/reference")]
    pub dir: PathBuf,
    /// Manual pages in place of Markdown
    #[arg(long)]
    pub man: bool,
}

#[derive(Args, Debug)]
pub struct SchemaArgs {
    /// Kind of file
    #[arg(default_value = "scenario", value_parser = described())]
    pub kind: &'static FileKind,
}

#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Files of any kind; several are each told in a line, with every fault
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Kind of the files, where it is not to be told from their content
    #[arg(long, value_parser = readable())]
    pub kind: Option<&'static FileKind>,
    #[command(flatten)]
    pub changes: Changes,
}

/// Words of every kind.
fn described() -> impl TypedValueParser<Value = &'static FileKind> {
    of_kinds(|_| true)
}

/// Words of the kinds that can be read.
fn readable() -> impl TypedValueParser<Value = &'static FileKind> {
    of_kinds(|kind| kind.read.is_some())
}

fn of_kinds(admitted: fn(&FileKind) -> bool) -> impl TypedValueParser<Value = &'static FileKind> {
    let words = KINDS.iter().filter(|kind| admitted(kind)).map(|kind| PossibleValue::new(kind.word).help(kind.doc));
    PossibleValuesParser::new(words).try_map(|word| FileKind::named(&word).ok_or("no such kind"))
}
