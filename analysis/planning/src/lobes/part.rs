//! Columns of a chart, worked out apart from the others.

use super::{Chart, LobesFile, parse};
use serde_json::json;
use toolroom_chatter::{ChatterError, Hole, Lobes, StabilityVerdict};
use toolroom_form::{FormFile, ReadError};
use toolroom_shards::{PLAN, Plan, ShardError, Work, fingerprint};

/// The plan of a chart that was read as `name` with `overrides`: its columns in at most `shards` parts, 16 where that is
/// `None`.
///
/// # Errors
/// A file that the chart names cannot be read.
pub fn plan(
    version: &str,
    name: &str,
    file: &FormFile<LobesFile>,
    overrides: Vec<String>,
    shards: Option<u64>,
) -> Result<Plan, ShardError> {
    let columns = file.content.chart.speed.points as u64;
    Ok(Plan {
        schema: PLAN,
        kind: Work::Lobes,
        version: version.to_owned(),
        name: file.content.name.clone(),
        file: name.to_owned(),
        directory: String::new(),
        text: file.text.clone(),
        files: Plan::fingerprints(&file.files)?,
        overrides,
        seed: 0,
        policies: Vec::new(),
        axis: None,
        pieces: columns,
        shards: shards.unwrap_or(16).min(columns),
    })
}

/// The chart of a plan.
///
/// # Errors
/// [`ReadError::Faults`] with every fault found.
pub fn chart(plan: &Plan) -> Result<FormFile<LobesFile>, ReadError> {
    parse(&plan.file, &plan.text, &plan.overrides)
}

/// What a shard leaves: verdicts column by column, and where there is none.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
pub struct Columns {
    verdicts: Vec<Option<StabilityVerdict>>,
    holes: Vec<Hole>,
}

impl Columns {
    /// The columns `from..to` of the grid.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value.
    pub fn new(file: &LobesFile, start: u64, end: u64) -> Result<Self, ChatterError> {
        let Lobes { verdicts, holes, .. } = file.cut.lobes(&file.chart, start as usize..end as usize)?;
        Ok(Self { verdicts, holes })
    }

    /// A digest of every verdict.
    pub fn digest(&self) -> u64 {
        u64::from_str_radix(&fingerprint(json!(self).to_string().as_bytes()), 16).unwrap_or(0)
    }

    /// The digest of columns that were read back; an error in words where they are not as many verdicts as `columns`
    /// of `chart` have.
    ///
    /// # Errors
    /// How many verdicts were found, and how many are due.
    pub fn checked(&self, chart: &Chart, columns: u64) -> Result<u64, String> {
        let (found, due) = (self.verdicts.len(), columns as usize * chart.depth.points);
        if found == due { Ok(self.digest()) } else { Err(format!("it holds {found} verdicts, not {due}")) }
    }

    /// The whole grid from its columns in their order.
    ///
    /// # Errors
    /// [`ChatterError`]: axes that are none.
    pub fn merged(chart: &Chart, parts: impl IntoIterator<Item = Self>) -> Result<Lobes, ChatterError> {
        let (speed, depth) = (chart.speed.values("speed")?, chart.depth.values("depth")?);
        let (mut verdicts, mut holes) = (Vec::new(), Vec::new());
        for part in parts {
            verdicts.extend(part.verdicts);
            holes.extend(part.holes);
        }
        Ok(Lobes { speed, depth, verdicts, holes })
    }
}
