//! The shards of a study: lives to Parquet, statistics to the sidecar, all of them merged.

use super::edge::Outcome;
use super::run::{Tally, lives};
use super::{End, FailureKind, Study};
use crate::file::{StudyFile, StudyText, parse};
use crate::sample::{Observation, Sample, SampleError};
use std::fs::File;
use std::path::Path;
use toolroom_form::{FormFile, ReadError};
use toolroom_records::table::{Kind, NewTable, TableError, TableWriter, Value};
use toolroom_shards::{Computed, PLAN, Plan, ShardError, Work, at, parts};

/// Lives of a cell that are held in memory at once.
const CHUNK: u64 = 65_536;

/// Columns of the lives that a shard writes.
const COLUMNS: [(&str, Kind); 8] = [
    ("condition", Kind::Text),
    ("policy", Kind::Text),
    ("edge", Kind::Real),
    ("life [min]", Kind::Real),
    ("path [m]", Kind::Real),
    ("flank_wear [mm]", Kind::Real),
    ("end", Kind::Text),
    ("weight", Kind::Real),
];

/// Lives of a shard when nobody says how many shards there are.
const SHARD: u64 = 500_000;

/// The plan of a study that was read from `text` with `overrides`, in at most `shards` parts; of half a million lives
/// each where that is `None`.
///
/// # Errors
/// A file that the study names cannot be read.
pub fn plan(
    version: &str,
    text: StudyText,
    file: &FormFile<StudyFile>,
    overrides: Vec<String>,
    shards: Option<u64>,
) -> Result<Plan, ShardError> {
    let study = &file.content.study;
    let lives = study.lives.saturating_mul(study.cells.len() as u64);
    Ok(Plan {
        schema: PLAN,
        kind: Work::Life,
        version: version.to_owned(),
        name: study.name.clone(),
        file: text.file,
        directory: text.directory.display().to_string(),
        text: text.text,
        files: Plan::fingerprints(&file.files)?,
        overrides,
        policies: Vec::new(),
        axis: None,
        seed: study.seed,
        pieces: study.lives,
        shards: shards.unwrap_or(lives.div_ceil(SHARD)).min(study.lives),
    })
}

/// The study of a plan.
///
/// # Errors
/// [`ReadError::Faults`] with every fault found.
pub fn study(plan: &Plan) -> Result<FormFile<StudyFile>, ReadError> {
    parse(&plan.file, &plan.text, Path::new(&plan.directory), &plan.overrides)
}

/// Runs a shard into a directory; nothing happens where its part is there already. `rows` starts the
/// table of its lives; without it their statistics alone are kept.
///
/// # Errors
/// [`ShardError`]; what was complete stays.
pub fn run(
    study: &Study,
    plan: &Plan,
    shard: u64,
    directory: &Path,
    rows: Option<NewTable<'_>>,
) -> Result<(), ShardError> {
    toolroom_shards::run(plan, shard, directory, |range, draft| {
        let content = write_lives(study, range, draft, rows)?;
        let digest = digest(&content);
        Ok(Computed { content, digest, rows: rows.is_some() })
    })
}

fn digest(cells: &[Tally]) -> u64 {
    cells.iter().fold(0, |digest: u64, cell| digest.wrapping_add(cell.digest.0))
}

fn write_lives(
    study: &Study,
    (from, to): (u64, u64),
    path: &Path,
    rows: Option<NewTable<'_>>,
) -> Result<Vec<Tally>, ShardError> {
    let failed = |source| ShardError::Rows { path: path.to_owned(), source };
    let mut writer = match rows {
        Some(new) => Some(new(File::create(path).map_err(at(path))?, &COLUMNS).map_err(failed)?),
        None => None,
    };
    let mut write = |ready: Rows| match &mut writer {
        Some(writer) => ready.write(study, writer.as_mut()).map_err(failed),
        None => Ok(()),
    };
    let mut cells = vec![Tally::default(); study.cells.len()];
    let mut ready = Rows::default();
    let starts = || (from..to).step_by(CHUNK as usize);
    for (cell, start) in (0..cells.len()).flat_map(|cell| starts().map(move |start| (cell, start))) {
        let live = || lives(study, &study.cells[cell], start, to.min(start + CHUNK), rows.is_some());
        // The last chunk is written while this one lives.
        let (written, (part, outcomes)) = rayon::join(|| write(std::mem::take(&mut ready)), live);
        written?;
        cells[cell].merge(&part);
        ready = Rows { cell, start, outcomes };
    }
    write(ready)?;
    if let Some(writer) = writer {
        writer.finish().map_err(failed)?;
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

impl Rows {
    fn write(&self, study: &Study, writer: &mut dyn TableWriter) -> Result<(), TableError> {
        for (i, outcome) in self.outcomes.iter().enumerate() {
            let cell = &study.cells[self.cell];
            writer.row(&[
                Value::Text(&cell.condition),
                Value::Text(&cell.policy),
                Value::Real(Some((self.start + i as u64) as f64)),
                Value::Real(Some(outcome.life / 60.0)),
                Value::Real(Some(outcome.path)),
                Value::Real(Some(outcome.flank_wear * 1e3)),
                Value::Text(outcome.end.name()),
                Value::Real(Some(outcome.weight)),
            ])?;
        }
        writer.end_group()
    }
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

/// Classes over the range of the lives that are fitted: an interval a hundredth of the range wide tells a law
/// hardly less than the lives themselves (for a normal law of the logarithm, 0.04 % of the information).
const CLASSES: i32 = 100;

/// Lives of a merged cell as a sample for fits, in minutes: classes of the sketch, edges that
/// were still good as censored.
pub fn sample(tally: &Tally) -> Result<Sample, SampleError> {
    sample_of(tally, |end| !end.censored())
}

/// The same lives in which only failures have ended.
pub fn failures(tally: &Tally, kind: FailureKind) -> Result<Sample, SampleError> {
    sample_of(tally, |end| kind.is_failure(end))
}

fn sample_of(tally: &Tally, ended: impl Fn(End) -> bool + Copy) -> Result<Sample, SampleError> {
    let minutes = |observation| match observation {
        Observation::Between(low, high) => Observation::Between(low / 60.0, high / 60.0),
        Observation::Failed(_) | Observation::Censored(_) => observation,
    };
    let classes = || tally.ends.iter().flat_map(|sketch| sketch.classes().map(|(class, _)| class));
    let span = classes().max().unwrap_or(0) - classes().min().unwrap_or(0);
    let joined = (span / CLASSES).max(1);
    let lives = End::ALL.iter().zip(&tally.ends).flat_map(|(end, sketch)| {
        sketch.observations(joined).into_iter().map(move |(observation, weight)| {
            let observation = minutes(observation);
            (if ended(*end) { observation } else { Observation::Censored(observation.age()) }, weight)
        })
    });
    Sample::weighted(lives)
}
