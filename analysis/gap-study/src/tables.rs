//! Which model reads which table of a data set.

use crate::{GapStudyError, Reading};
use std::path::{Path, PathBuf};
use toolroom_effects::Definition;
use toolroom_gap::{NominalModel, NominalProcess};
use toolroom_records::{RecordError, RecordKind, Records};

/// A nominal model with the records of its table, or why the table, in which nothing is wrong, has none.
#[derive(Debug)]
pub struct Table {
    /// The model.
    pub model: NominalModel,
    /// Its records.
    pub records: Result<Records, String>,
}

/// Every model with its table; `set` are values that replace those of the models, `defined` effects beside theirs. Of several models each needs a table
/// of its own and every table one of them; a single model may leave tables alone.
///
/// # Errors
/// [`GapStudyError`]: a file that cannot be read, models and tables that do not fit each other.
pub fn tables(
    paths: &[PathBuf],
    set: &[String],
    defined: &[&'static Definition],
    data: &Path,
    reading: &Reading<'_>,
) -> Result<Vec<Table>, GapStudyError> {
    let mut models: Vec<(&PathBuf, NominalModel)> = Vec::new();
    for path in paths {
        models.push((path, NominalModel::read(path, set)?.with_effects(path, defined)?));
    }
    let stem = |model: &NominalModel| model.kind().file_stem();
    if models.len() > 1 && data.is_file() {
        return Err(GapStudyError::OneTable { data: data.to_owned(), models: models.len() });
    }
    for (index, (path, model)) in models.iter().enumerate() {
        if let Some((other, _)) = models[..index].iter().find(|(_, other)| stem(other) == stem(model)) {
            let (one, other) = ((*other).clone(), (*path).clone());
            return Err(GapStudyError::TwoModels { one, other, table: stem(model) });
        }
    }
    if data.is_dir() {
        let mut left = toolroom_records::tables(data);
        let words = |kinds: &[RecordKind]| {
            let word = |kind: &RecordKind| format!("{} ({})", kind.file_stem(), kind.name());
            kinds.iter().map(word).collect::<Vec<_>>().join(", ")
        };
        for (path, model) in &models {
            if left.iter().all(|kind| kind.file_stem() != stem(model)) {
                let found = if left.is_empty() { "no records".to_owned() } else { words(&left) };
                return Err(GapStudyError::NoTable {
                    model: (*path).clone(),
                    kind: model.kind().name(),
                    data: data.to_owned(),
                    table: stem(model),
                    found,
                });
            }
        }
        left.retain(|kind| models.iter().all(|(_, model)| stem(model) != kind.file_stem()));
        if let [(_, only)] = &models[..]
            && reads_events(only)
        {
            left.retain(|kind| *kind != RecordKind::Shop);
        }
        match &left[..] {
            [] => {}
            [first, ..] if models.len() > 1 => {
                let (left, shipped) = (words(&left), first.name());
                return Err(GapStudyError::NoModel { data: data.to_owned(), left, shipped });
            }
            left => (reading.say)(&format!("not diagnosed, since no model reads it: {}", words(left))),
        }
    }
    let read = |(_, model): (&PathBuf, NominalModel)| Ok(Table { records: usable(data, &model, reading)?, model });
    models.into_iter().map(read).collect()
}

/// Whether the events of machines are read beside the records of the process that runs on them.
pub fn reads_events(model: &NominalModel) -> bool {
    match model.process {
        NominalProcess::Turning(_) | NominalProcess::Milling(_) | NominalProcess::Grinding(_) => true,
        NominalProcess::Empirical | NominalProcess::Program(_) | NominalProcess::Shop(_) => false,
    }
}

/// The records of a table, or why none of its rows is of use.
fn usable(data: &Path, model: &NominalModel, reading: &Reading<'_>) -> Result<Result<Records, String>, GapStudyError> {
    match toolroom_records::read(data, model.kind(), reading.parquet) {
        Err(error @ RecordError::NoRows { wrong: false, .. }) => Ok(Err(error.to_string())),
        read => reading.said(read).map(Ok),
    }
}
