//! `toolroom gap`: where model and shop differ, and why.

mod apply;
mod blind;
mod diagnose;
mod identifiability;
mod plan;
mod tables;
mod watch;

use crate::args::{GapCommand, GapData};
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::Path;
use toolroom_gap::{ModelFileError, NominalModel};
use toolroom_records::{ReadReport, RecordError, Records};

pub fn run(command: &GapCommand, voice: &Voice) -> Result<(), Failure> {
    match command {
        GapCommand::Diagnose(args) => diagnose::run(args, voice),
        GapCommand::Identifiability(args) => identifiability::run(args, voice),
        GapCommand::Apply(args) => apply::run(args, voice),
        GapCommand::Blind(args) => blind::run(args, voice),
        GapCommand::Plan(args) => plan::run(args, voice),
        GapCommand::Watch(args) => watch::run(args, voice),
    }
}

/// The nominal model of a file.
fn nominal(data: &GapData) -> Result<NominalModel, Failure> {
    nominal_of(&data.model, &data.set)
}

/// The nominal model of a file with the values of `--set`.
pub fn nominal_of(path: &Path, set: &[String]) -> Result<NominalModel, Failure> {
    NominalModel::read(path, set).map_err(|error| match error {
        ModelFileError::Read(error) => Failure::from(error),
        other => Failure::argument(other, "see scenarios/gap for nominal models that work"),
    })
}

/// Records of the model's kind; what was read is said.
fn recorded(path: &Path, model: &NominalModel, voice: &Voice) -> Result<Records, Failure> {
    said(toolroom_records::read(path, model.kind(), &toolroom_parquet::read_cells), voice)
}

/// Records that were read, and a line about it.
fn said(read: Result<(Records, ReadReport), RecordError>, voice: &Voice) -> Result<Records, Failure> {
    let (records, report) = read.map_err(|error| match error {
        RecordError::Unreadable { .. } => Failure::argument(error, "check the path"),
        RecordError::Quote { .. } => Failure::argument(error, "mend that line; nothing was diagnosed"),
        other => Failure::argument(other, "`toolroom import csv` maps other tables to records"),
    })?;
    voice.say(report.to_string().trim_end());
    Ok(records)
}

/// Nothing of what the model predicts was measured.
fn nothing_measured(notes: &[String]) -> Failure {
    let found = notes.iter().fold(String::new(), |all, note| format!("{all}; {note}"));
    let message = format!("no channel that the model predicts is recorded{found}");
    Failure::argument(message, "`toolroom gap` compares forces, wear, power, temperature, stock, …")
}
