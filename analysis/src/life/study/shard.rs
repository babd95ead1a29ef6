//! The shards of a study: lives to Parquet, statistics to the sidecar, all of them merged.

use super::edge::Outcome;
use super::run::{Tally, lives};
use super::{End, Study};
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
    let mut cells = Vec::with_capacity(study.cells.len());
    for cell in &study.cells {
        let mut tally = Tally::default();
        let mut start = from;
        while start < to {
            let end = to.min(start + CHUNK);
            let (part, outcomes) = lives(study, cell, start, end, writer.is_some());
            tally.merge(&part);
            if let (Some(writer), Some(path)) = (&mut writer, path) {
                let names = (cell.condition.as_str(), cell.policy.as_str());
                let frame = frame(names, start, &outcomes).map_err(failed(path))?;
                writer.write_batch(&frame).map_err(failed(path))?;
            }
            start = end;
        }
        cells.push(tally);
    }
    if let (Some(writer), Some(path)) = (writer, path) {
        writer.finish().map_err(failed(path))?;
        File::open(path).and_then(|file| file.sync_all()).map_err(at(path))?;
    }
    Ok(cells)
}

fn frame((condition, policy): (&str, &str), start: u64, outcomes: &[Outcome]) -> Result<DataFrame, PolarsError> {
    let n = outcomes.len();
    let real = |name: &str, of: &dyn Fn(usize, &Outcome) -> f64| -> Column {
        let values: Vec<f64> = outcomes.iter().enumerate().map(|(i, outcome)| of(i, outcome)).collect();
        Series::new(name.into(), values).into_column()
    };
    let text = |name: &str, values: Vec<&str>| Series::new(name.into(), values).into_column();
    let columns = vec![
        text("condition", vec![condition; n]),
        text("policy", vec![policy; n]),
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

/// Merges the parts in a directory.
///
/// # Errors
/// [`ShardError`] for missing, doubled, foreign and changed parts.
pub fn merge(plan: &Plan, directory: &Path) -> Result<Merged, ShardError> {
    let mut cells: Vec<Tally> = Vec::new();
    for part in parts::<Vec<Tally>>(plan, directory)? {
        cells.resize(part.len().max(cells.len()), Tally::default());
        cells.iter_mut().zip(&part).for_each(|(own, other)| own.merge(other));
    }
    let digest = digest(&cells);
    Ok(Merged { cells, digest })
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
