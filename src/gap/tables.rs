//! Which model reads which table of a data set.

use super::{nominal_of, said};
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::{Path, PathBuf};
use toolroom_gap::NominalModel;
use toolroom_records::{RecordError, RecordKind, Records};

/// A nominal model with the records of its table, or why the table, in which nothing is wrong, has none.
pub struct Table {
    pub model: NominalModel,
    pub records: Result<Records, String>,
}

/// Every model with its table. Of several models each needs one of its own and every table one of
/// them; a single model may leave tables alone.
pub fn tables(paths: &[PathBuf], set: &[String], data: &Path, voice: &Voice) -> Result<Vec<Table>, Failure> {
    let mut models: Vec<(&PathBuf, NominalModel)> = Vec::new();
    for path in paths {
        models.push((path, nominal_of(path, set)?));
    }
    let stem = |model: &NominalModel| model.kind().file_stem();
    if models.len() > 1 && data.is_file() {
        let message = format!("{} is one table, but {} models are given", data.display(), models.len());
        return Err(Failure::argument(message, "give the directory that holds a table for each, or one model"));
    }
    for (index, (path, model)) in models.iter().enumerate() {
        if let Some((other, _)) = models[..index].iter().find(|(_, other)| stem(other) == stem(model)) {
            let message = format!("{} and {} both read the table `{}`", other.display(), path.display(), stem(model));
            return Err(Failure::argument(message, "leave one of them out: a table has one model"));
        }
    }
    if data.is_dir() {
        let found = toolroom_records::tables(data);
        let words = |kinds: &[RecordKind]| {
            let word = |kind: &RecordKind| format!("{} ({})", kind.file_stem(), kind.name());
            kinds.iter().map(word).collect::<Vec<_>>().join(", ")
        };
        for (path, model) in &models {
            if found.iter().all(|kind| kind.file_stem() != stem(model)) {
                let what = if found.is_empty() { "no records".to_owned() } else { words(&found) };
                let (file, kind, data) = (path.display(), model.kind().name(), data.display());
                let table = stem(model);
                let message = format!(
                    "{file} is a model of {kind}, but {data} holds no {table}.csv or {table}.parquet; it holds {what}"
                );
                let fix = format!("leave {} out, or add the table; `toolroom import csv` maps others", path.display());
                return Err(Failure::argument(message, fix));
            }
        }
        let mut left = found;
        left.retain(|kind| models.iter().all(|(_, model)| stem(model) != kind.file_stem()));
        if !left.is_empty() && models.len() > 1 {
            let message = format!("{} holds {}, which no model reads", data.display(), words(&left));
            let model = format!("--model scenarios/gap/{}.toml", left[0].name());
            return Err(Failure::argument(message, format_args!("add a model ({model}), or take the table away")));
        }
        if !left.is_empty() {
            voice.say(format_args!("not diagnosed, since no model reads it: {}", words(&left)));
        }
    }
    let read = |(_, model): (&PathBuf, NominalModel)| Ok(Table { records: usable(data, &model, voice)?, model });
    models.into_iter().map(read).collect()
}

/// The records of a table, or why none of its rows is of use.
fn usable(data: &Path, model: &NominalModel, voice: &Voice) -> Result<Result<Records, String>, Failure> {
    match toolroom_records::read(data, model.kind(), &toolroom_parquet::read_cells) {
        Err(error @ RecordError::NoRows { wrong: false, .. }) => Ok(Err(error.to_string())),
        read => said(read, voice).map(Ok),
    }
}
