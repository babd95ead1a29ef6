//! What is diagnosed, and how records are read.

use crate::GapStudyError;
use std::fmt;
use std::path::{Path, PathBuf};
use toolroom_effects::Definition;
use toolroom_gap::NominalModel;
use toolroom_records::{OtherTable, ReadReport, RecordError, Records};

/// How records are read, and who hears what was read of them.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// The reader of Parquet files.
    pub parquet: OtherTable<'a>,
    /// Hears a line about each table that was read, and about tables that no model reads.
    pub say: &'a dyn Fn(&str),
}

impl fmt::Debug for Reading<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reading").finish_non_exhaustive()
    }
}

impl Reading<'_> {
    /// Records of the kind of a model, from a file or the folder that holds it.
    ///
    /// # Errors
    /// [`GapStudyError::Records`]: a file that cannot be read, a missing column, a unit that does not fit.
    pub fn records(&self, data: &Path, model: &NominalModel) -> Result<Records, GapStudyError> {
        self.said(toolroom_records::read(data, model.kind(), self.parquet))
    }

    pub(crate) fn said(&self, read: Result<(Records, ReadReport), RecordError>) -> Result<Records, GapStudyError> {
        let (records, report) = read?;
        (self.say)(report.to_string().trim_end());
        Ok(records)
    }
}

/// A diagnosis that is wanted.
#[derive(Clone, Copy, Debug)]
pub struct GapRequest<'a> {
    /// Files of the nominal models, one a table.
    pub models: &'a [PathBuf],
    /// Values that replace those of the models, `path=value`.
    pub set: &'a [String],
    /// Effects that a user has defined in files of their own.
    pub defined: &'a [&'static Definition],
    /// A table, or the folder of the tables.
    pub data: &'a Path,
    /// Column whose levels are groups; edges, dressing cycles or days where there is none.
    pub group: Option<&'a str>,
    /// Share of the groups that is left out of the fit and only predicted, from 0 to 1.
    pub holdout: f64,
    /// Records of other groups, on which the closure is scored.
    pub holdout_data: Option<&'a Path>,
    /// Seed of the null distributions and of the intervals.
    pub seed: u64,
    /// Name of the file of terms that are proposed where no cause is known; none are sought without it.
    pub propose: Option<&'a str>,
    /// Whether pages with pictures are wanted, which cost a moment.
    pub pages: bool,
}
