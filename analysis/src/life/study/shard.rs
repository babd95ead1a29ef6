//! The shards of a study: lives to Parquet, statistics to the sidecar, all of them merged.

use super::edge::Outcome;
use super::run::{Tally, lives};
use super::{Cell, End, Study};
use crate::life::sample::{Observation, Sample, SampleError};
use crate::shards::{Computed, Plan, ShardError, at, parts};
use polars::prelude::{
    Column, DataFrame, DataType, Field, IntoColumn, NamedFrom, ParquetWriter, PolarsError, Schema, Series,
};
use std::fs::File;
use std::io;
use std::path::Path;

/// Lives of a cell that are held in memory at once.
const CHUNK: u64 = 65_536;

/// Runs a shard into a directory; nothing happens where its part is there already. `rows` says
/// whether lives are written or only their statistics.
///
/// # Errors
/// [`ShardError`]; what was complete stays.
pub fn run(study: &Study, plan: &Plan, shard: u64, directory: &Path, rows: bool) -> Result<(), ShardError> {
    crate::shards::run(plan, shard, directory, |range, draft| {
        let content = write_lives(study, range, rows.then_some(draft))?;
        let digest = digest(&content);
        Ok(Computed { content, digest, rows })
    })
}

fn digest(cells: &[Tally]) -> u64 {
    cells.iter().fold(0, |digest: u64, cell| digest.wrapping_add(cell.digest.0))
}

fn write_lives(study: &Study, (from, to): (u64, u64), path: Option<&Path>) -> Result<Vec<Tally>, ShardError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| ShardError::Parquet { path, source }
    };
    let fields = [
        ("condition", DataType::String),
        ("policy", DataType::String),
        ("edge", DataType::Float64),
        ("life [min]", DataType::Float64),
        ("path [m]", DataType::Float64),
        ("flank_wear [mm]", DataType::Float64),
        ("end", DataType::String),
        ("weight", DataType::Float64),
    ];
    let schema: Schema = fields.iter().map(|(name, kind)| Field::new((*name).into(), kind.clone())).collect();
    let mut writer = match path {
        Some(path) => {
            let file = File::create(path).map_err(at(path))?;
            Some(
                ParquetWriter::new(io::BufWriter::new(file))
                    .set_parallel(false)
                    .batched(&schema)
                    .map_err(failed(path))?,
            )
        }
        None => None,
    };
    let mut write = |rows: Rows| match (&mut writer, path) {
        (Some(writer), Some(path)) => {
            let frame = frame(&study.cells[rows.cell], rows.start, &rows.outcomes).map_err(failed(path))?;
            writer.write_batch(&frame).map_err(failed(path))
        }
        _ => Ok(()),
    };
    let mut cells = vec![Tally::default(); study.cells.len()];
    let mut ready = Rows::default();
    let starts = || (from..to).step_by(CHUNK as usize);
    for (cell, start) in (0..cells.len()).flat_map(|cell| starts().map(move |start| (cell, start))) {
        let live = || lives(study, &study.cells[cell], start, to.min(start + CHUNK), path.is_some());
        // The last chunk is written while this one lives.
        let (written, (part, outcomes)) = rayon::join(|| write(std::mem::take(&mut ready)), live);
        written?;
        cells[cell].merge(&part);
        ready = Rows { cell, start, outcomes };
    }
    write(ready)?;
    if let (Some(writer), Some(path)) = (writer, path) {
        writer.finish().map_err(failed(path))?;
        File::open(path).and_then(|file| file.sync_all()).map_err(at(path))?;
    }
    Ok(cells)
}

/// Lives of a cell, from a number on, that wait to be written.
#[derive(Default)]
struct Rows {
    cell: usize,
    start: u64,
    outcomes: Vec<Outcome>,
}

fn frame(cell: &Cell, start: u64, outcomes: &[Outcome]) -> Result<DataFrame, PolarsError> {
    let n = outcomes.len();
    let real = |name: &str, of: &dyn Fn(usize, &Outcome) -> f64| -> Column {
        let values: Vec<f64> = outcomes.iter().enumerate().map(|(i, outcome)| of(i, outcome)).collect();
        Series::new(name.into(), values).into_column()
    };
    let text = |name: &str, values: Vec<&str>| Series::new(name.into(), values).into_column();
    let columns = vec![
        text("condition", vec![cell.condition.as_str(); n]),
        text("policy", vec![cell.policy.as_str(); n]),
        real("edge", &|i, _| (start + i as u64) as f64),
        real("life [min]", &|_, outcome| outcome.life / 60.0),
        real("path [m]", &|_, outcome| outcome.path),
        real("flank_wear [mm]", &|_, outcome| outcome.flank_wear * 1e3),
        text("end", outcomes.iter().map(|outcome| outcome.end.name()).collect()),
        real("weight", &|_, outcome| outcome.weight),
    ];
    DataFrame::new(n, columns)
}

/// All parts of a plan as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// One a cell.
    pub cells: Vec<Tally>,
    /// Hash of all lives, the same for every number of shards.
    pub digest: u64,
}

/// Merges the parts in a directory; the study has so many `cells`.
///
/// # Errors
/// [`ShardError`] for missing, doubled, foreign, changed and malformed parts.
pub fn merge(plan: &Plan, cells: usize, directory: &Path) -> Result<Merged, ShardError> {
    let checked = |part: &Vec<Tally>, (from, to): (u64, u64)| {
        if part.len() != cells {
            return Err(format!("it holds {} conditions and policies, not {cells}", part.len()));
        }
        match part.iter().find(|cell| cell.life.count() != to - from) {
            Some(cell) => Err(format!("it holds {} lives, not {}", cell.life.count(), to - from)),
            None => Ok(digest(part)),
        }
    };
    let mut merged = vec![Tally::default(); cells];
    for part in parts(plan, directory, checked)? {
        merged.iter_mut().zip(&part).for_each(|(own, other)| own.merge(other));
    }
    let digest = digest(&merged);
    Ok(Merged { cells: merged, digest })
}

/// Lives of a merged cell as a sample for fits, in minutes: classes of the sketch, edges that
/// were still good as censored.
pub fn sample(tally: &Tally) -> Result<Sample, SampleError> {
    let minutes = |observation| match observation {
        Observation::Between(low, high) => Observation::Between(low / 60.0, high / 60.0),
        other => other,
    };
    let lives = End::ALL.iter().zip(&tally.ends).flat_map(|(end, sketch)| {
        sketch.observations().map(move |(observation, weight)| {
            let observation = minutes(observation);
            (if end.censored() { Observation::Censored(observation.age()) } else { observation }, weight)
        })
    });
    Sample::weighted(lives)
}
