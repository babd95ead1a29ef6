//! toolroom as a library: shops, policies, tool lives and gap diagnosis from one dependency.
//!
//! The rooms of the project are modules here under their short names, so that a program names
//! nothing but `toolroom`; the functions below do in one call what a verb of the command line does.
//!
//! | want | call | verb |
//! |---|---|---|
//! | a scenario from its file | [`read_scenario`] | `toolroom check` |
//! | one replication with its log | [`run`] | `toolroom run` |
//! | effects that a user defines | [`gap_study::user_effects`] | `--effects` |
//! | policies on common random numbers | [`compare`] | `toolroom compare` |
//! | laws of tool lives | [`life::measured_study::MeasuredStudy`] | `toolroom life --fit` |
//! | results of a simulated study of lives | [`life::study::report::results`] | `toolroom life` |
//! | plans along a contour | [`planning::contour::studies`] | `toolroom contour` |
//! | the fastest grinding cycle | [`planning::cycle::CycleDesign`] | `toolroom grind` |
//! | lag and stiffnesses from trials | [`planning::identification::IdentificationStudy`] | `toolroom identify` |
//! | a stability chart | [`planning::lobes::ChartStudy`] | `toolroom lobes` |
//! | vibration modes from a tap test | [`modes::ModesStudy`] | `toolroom modes` |
//! | the blind benchmark | [`blind::diagnose`] | `toolroom gap blind` |
//! | parameters from measured edges | [`calibrate::Calibration`] | `toolroom calibrate --data` |
//! | why model and records differ | [`diagnose`] | `toolroom gap diagnose` |
//! | a diagnosis with its documents | [`gap_study::GapStudy`] | `toolroom gap diagnose` |
//! | a process at one point, at many | [`planning::point::Point`], [`planning::point::PointGrid`] | `toolroom point` |
//! | a part program on a machine | [`planning::program::ProgramStudy`] | `toolroom program` |
//! | what differs between two runs | [`study::difference::RunDifference`] | `toolroom diff` |
//! | what is wrong in a file of any kind | [`kinds::FileKind`] | `toolroom check` |
//! | a process as an FMI unit | [`fmu::package`] | `toolroom fmu export` |
//!
//! Quantities are SI numbers (rad, K) unless a name says otherwise. Programs over it are in `examples`.
//!
//! # What is not modelled
//! The functions write no files. A study hands out its tables, pictures and report as [`chart::ResultFiles`], which
//! the caller writes where they belong.

#![deny(clippy::wildcard_enum_match_arm)]

pub use toolroom_apply as apply;
pub use toolroom_blind as blind;
pub use toolroom_calibrate as calibrate;
pub use toolroom_cell as cell;
pub use toolroom_chart as chart;
pub use toolroom_chatter as chatter;
pub use toolroom_contour as contour;
pub use toolroom_cutting as cutting;
pub use toolroom_drives as drives;
pub use toolroom_effects as effects;
pub use toolroom_fmu as fmu;
pub use toolroom_form as form;
pub use toolroom_gap as gap;
pub use toolroom_gap_study as gap_study;
pub use toolroom_infeed as infeed;
pub use toolroom_kernel as kernel;
pub use toolroom_kinds as kinds;
pub use toolroom_life as life;
pub use toolroom_lobes as lobes;
pub use toolroom_modes as modes;
pub use toolroom_parquet as parquet;
pub use toolroom_planning as planning;
pub use toolroom_post as post;
pub use toolroom_process as process;
pub use toolroom_program as program;
pub use toolroom_recording as recording;
pub use toolroom_records as records;
pub use toolroom_scenario as scenario;
pub use toolroom_scenario_file as scenario_file;
pub use toolroom_shards as shards;
pub use toolroom_shop as shop;
pub use toolroom_ssp as ssp;
pub use toolroom_statistics as statistics;
pub use toolroom_steady as steady;
pub use toolroom_stock as stock;
pub use toolroom_study as study;
pub use toolroom_wear as wear;

use form::ReadError;
use gap::{Answers, ModelFileError, NominalModel};
use records::{ReadReport, RecordError, RecordKind, Records};
use scenario::Scenario;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use study::compare::Comparison;
use study::study::{Study, StudyError, StudyOptions, run_study};

pub use shop::run;

/// Reads a scenario file.
///
/// # Errors
/// [`ReadError`]: the file cannot be opened or decoded, or every fault found in it, with its place.
pub fn read_scenario(path: impl AsRef<Path>) -> Result<Scenario, ReadError> {
    study::draws::register();
    scenario_file::read(path.as_ref(), &[]).map(|file| file.scenario)
}

/// Compares every policy of a scenario on common random numbers, over so many replications; the
/// result depends on the seed of the scenario alone, whatever the number of threads.
///
/// # Errors
/// [`StudyError`] where a policy cannot be worked out or a run stops.
pub fn compare(scenario: &Scenario, replications: u32) -> Result<(Study, Comparison), StudyError> {
    let options = StudyOptions { replications, ..StudyOptions::of(scenario) };
    let study = run_study(scenario, &options, None, &|_| {}, &AtomicBool::new(false))?;
    let comparison = Comparison::new(scenario, &study);
    Ok((study, comparison))
}

/// Reads measured records from a CSV or Parquet file, or from the file of `kind` in a folder.
///
/// # Errors
/// [`RecordError`]: a file that cannot be read, a missing column, a unit that does not fit.
pub fn read_records(path: impl AsRef<Path>, kind: RecordKind) -> Result<(Records, ReadReport), RecordError> {
    records::read(path.as_ref(), kind, &toolroom_parquet::read_cells)
}

/// Why records were not diagnosed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DiagnoseError {
    /// The nominal model.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// The records.
    #[error(transparent)]
    Records(#[from] RecordError),
}

/// Diagnoses records against a nominal model: which effect is missing, how far the gap shrinks on
/// groups left out, or that it cannot be told. `seed` draws the null distributions.
///
/// # Errors
/// [`DiagnoseError`]: a model or records that cannot be read.
pub fn diagnose(model: impl AsRef<Path>, data: impl AsRef<Path>, seed: u64) -> Result<Answers, DiagnoseError> {
    let model = NominalModel::read(model.as_ref(), &[])?;
    let (records, _) = read_records(data, model.kind())?;
    Ok(gap::diagnose_processes(&[model.asked(&records, None, |_, _| false)], seed))
}

/// The library of exported FMI units for this machine, which is inside the program.
///
/// # Errors
/// A library that cannot be unpacked.
#[cfg(feature = "embedded-units")]
pub fn unit_library() -> std::io::Result<Vec<u8>> {
    let packed = include_bytes!(concat!(env!("OUT_DIR"), "/units.zlib")).as_slice();
    let mut library = Vec::new();
    std::io::copy(&mut flate2::read::ZlibDecoder::new(packed), &mut library).map(|_| library)
}
