//! `toolroom import csv` and the tables with a mapping of their own.

use super::{create, write};
use crate::args::{ImportCsvArgs, ImportTableArgs};
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::Path;
use std::time::Instant;
use toolroom_output::provenance;
use toolroom_records::import::{ImportError, Mapping, import};

/// The mapping of the NASA milling table, shipped as an example too.
const NASA_MILL: &str = include_str!("../../scenarios/gap/map-nasa-mill.toml");

pub fn run(args: &ImportCsvArgs, voice: &Voice) -> Result<(), Failure> {
    let mapping = Mapping::read(&args.map, &args.set)?;
    let map = ["--map".to_owned(), args.map.display().to_string()];
    let set = args.set.iter().flat_map(|set| ["--set".to_owned(), set.clone()]);
    perform("import csv", &mapping, &args.table, Some(&args.map), map.into_iter().chain(set), voice)
}

pub fn nasa_mill(args: &ImportTableArgs, voice: &Voice) -> Result<(), Failure> {
    let mapping = Mapping::parse("map-nasa-mill.toml", NASA_MILL, &[])?;
    perform("import nasa-mill", &mapping, args, None, [], voice)
}

fn perform(
    verb: &str,
    mapping: &Mapping,
    args: &ImportTableArgs,
    map: Option<&Path>,
    arguments: impl IntoIterator<Item = String>,
    voice: &Voice,
) -> Result<(), Failure> {
    let began = Instant::now();
    let inputs: Vec<&Path> = map.into_iter().chain([args.file.as_path()]).collect();
    let dir = create(&args.out, mapping.kind, &inputs, voice)?;
    let (records, report) = import(&args.file, mapping, &toolroom_parquet::read_cells).map_err(refused)?;
    let bytes = std::fs::read(&args.file).map_err(Failure::unread(&args.file))?;
    let provenance = provenance(verb, &[(args.file.display().to_string(), &bytes)], arguments, None);
    write(&records, &report, dir, &provenance, began, voice)
}

fn refused(error: ImportError) -> Failure {
    let fix = error.fix();
    Failure::located(error, fix)
}
