//! `toolroom gap`: where model and shop differ, and why.

mod apply;
mod blind;
mod diagnose;
mod identifiability;
mod plan;
mod predict;
mod recovery;
mod rounds;
mod watch;

use crate::args::{GapCommand, GapData};
use crate::effects::defined;
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::{Path, PathBuf};
use toolroom_gap::NominalModel;
use toolroom_gap_study::{GapStudyError, Reading};
use toolroom_records::Records;

pub fn run(command: &GapCommand, voice: &Voice) -> Result<(), Failure> {
    match command {
        GapCommand::Diagnose(args) => diagnose::run(args, voice),
        GapCommand::Identifiability(args) => identifiability::run(args, voice),
        GapCommand::Apply(args) => apply::run(args, voice),
        GapCommand::Blind(args) => blind::run(args, voice),
        GapCommand::Plan(args) => plan::run(args, voice),
        GapCommand::Predict(args) => predict::run(args, voice),
        GapCommand::Recovery(args) => recovery::run(args, voice),
        GapCommand::Loop(args) => rounds::run(args, voice),
        GapCommand::Watch(args) => watch::run(args, voice),
    }
}

/// The nominal model of a file.
fn nominal(data: &GapData) -> Result<NominalModel, Failure> {
    let model = nominal_of(&data.model, &data.set)?;
    let defined = defined(&data.effects)?;
    model.with_effects(&data.model, &defined).map_err(|error| GapStudyError::from(error).into())
}

/// The nominal model of a file with the values of `--set`.
fn nominal_of(path: &Path, set: &[String]) -> Result<NominalModel, Failure> {
    NominalModel::read(path, set).map_err(|error| GapStudyError::from(error).into())
}

/// How records are read: what was read of a table is said.
fn reading<T>(voice: &Voice, work: impl FnOnce(&Reading<'_>) -> Result<T, GapStudyError>) -> Result<T, Failure> {
    let reading = Reading { parquet: &toolroom_parquet::read_cells, say: &|line| voice.say(line) };
    work(&reading).map_err(Failure::from)
}

/// Records of the model's kind.
fn recorded(path: &Path, model: &NominalModel, voice: &Voice) -> Result<Records, Failure> {
    reading(voice, |reading| reading.records(path, model))
}

/// Nothing of what the model predicts was measured.
/// The files behind `--data`: the path itself, and of a folder every table in it. None of them is ever replaced.
fn files_of(data: &Path) -> Vec<PathBuf> {
    std::iter::once(data.to_owned()).chain(toolroom_records::table_files(data)).collect()
}

fn nothing_measured(notes: &[String]) -> Failure {
    GapStudyError::NothingMeasured { notes: notes.to_vec() }.into()
}
