//! `toolroom import`: measured data of others as records, tables of an order system as a scenario.

mod csv;
mod mtconnect;
mod nist_runs;
mod shop;

use crate::args::ImportCommand;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use std::time::Instant;
use toolroom_output::OutputDir;
use toolroom_records::{ReadReport, RecordKind, Records, write_csv};

pub fn run(command: &ImportCommand, voice: &Voice) -> Result<(), Failure> {
    match command {
        ImportCommand::Csv(args) => csv::run(args, voice),
        ImportCommand::NasaMill(args) => csv::nasa_mill(args, voice),
        ImportCommand::Mtconnect(args) => mtconnect::run(args, voice),
        ImportCommand::NistRuns(args) => nist_runs::run(args, voice),
        ImportCommand::Shop(args) => shop::run(args, voice),
        ImportCommand::Frf(args) => crate::modes::import(args, voice),
    }
}

/// Name of the table of a kind of records.
fn table(kind: RecordKind) -> String {
    format!("{}.csv", kind.file_stem())
}

/// Takes the folder of an import.
fn create(folder: &Path, kind: RecordKind, inputs: &[&Path], voice: &Voice) -> Result<OutputDir, Failure> {
    Ok(OutputDir::create(folder, &[&table(kind), "import.json"], inputs.iter().copied(), voice.force)?)
}

/// Writes records with the report of their reading, and says what became of the file.
fn write(
    records: &Records,
    report: &ReadReport,
    dir: OutputDir,
    provenance: &toolroom_chart::page::Provenance,
    began: Instant,
    voice: &Voice,
) -> Result<(), Failure> {
    let name = table(records.kind);
    let path = dir.draft().join(&name);
    let unwritable = |source| Failure::Unwritable { path: path.clone(), source };
    let file = std::fs::File::create(&path).map_err(unwritable)?;
    write_csv(records, std::io::BufWriter::new(file)).map_err(|error| unwritable(std::io::Error::other(error)))?;
    dir.put_json("import.json", &report.json())?;
    dir.record(provenance, began.elapsed())?;
    let written = dir.publish()?.join(&name);
    if voice.json {
        let mut value = report.json();
        value["written"] = json!(written);
        return voice.json(&value);
    }
    voice.data(report.to_string().trim_end())?;
    voice.data(format_args!("wrote {}", written.display()))
}
