//! `toolroom gap predict`: what a model predicts of recorded operations.

use super::{files_of, reading};
use crate::args::{GapData, PredictArgs};
use crate::effects::defined;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::collections::BTreeMap;
use toolroom_apply::{Prediction, predictions};
use toolroom_gap::ChannelId;
use toolroom_gap_study::{GapStudyError, tables, usable};
use toolroom_location::Located;
use toolroom_output::Files;
use toolroom_process::table::{Cell, csv_text};
use toolroom_process::unit;
use toolroom_records::RecordError;

pub fn run(args: &PredictArgs, voice: &Voice) -> Result<(), Failure> {
    let mut rows: Vec<(String, Prediction)> = Vec::new();
    let GapData { model, data, group, set, effects } = &args.data;
    let defined = defined(effects)?;
    let models = std::slice::from_ref(model);
    let read = reading(voice, |reading| Ok(tables(models, set, &defined, data, reading)))?;
    for table in read.map_err(lacking)? {
        let records = table.records.map_err(|why| Failure::argument(why, "add rows"))?;
        let asked = table.model.asked(&records, group.as_deref(), |_, _| false);
        if asked.parts.iter().all(|part| part.frame().measured.observations.is_empty()) {
            return Err(lacking(GapStudyError::NothingMeasured { notes: asked.notes }));
        }
        usable(&asked, &records)?;
        for note in &asked.notes {
            voice.say(note);
        }
        let ids = ["operation_id", "trial_id"].iter().find_map(|name| records.texts(name));
        let id = |row: usize| ids.and_then(|ids| ids.get(row)).cloned().unwrap_or_else(|| (row + 1).to_string());
        rows.extend(asked.parts.iter().flat_map(|part| predictions(part.as_ref())).map(|own| (id(own.row), own)));
    }
    for line in summary(&rows) {
        voice.say(line);
    }
    let header = ["operation_id", "channel", "unit", "measured", "predicted", "standard_deviation"];
    let text = csv_text(header, rows.iter().map(cells)).expect("every row is as long as the header");
    if let Some(out) = &args.out {
        let path = out.join("predictions.csv");
        std::fs::create_dir_all(out).map_err(|source| Failure::Unwritable { path: out.clone(), source })?;
        let data = files_of(data);
        Files::new(data.iter().chain([model]).chain(effects).map(AsRef::as_ref), voice.force)
            .put(&path, text.as_bytes())?;
        if voice.json {
            return voice.json(&json!({ "schema": 1, "rows": rows.len(), "path": path.display().to_string() }));
        }
        return voice.data(format_args!("wrote {} with {} values", path.display(), rows.len()));
    }
    if voice.json {
        let list: Vec<_> = rows
            .iter()
            .map(|(id, own)| {
                json!({
                    "operation_id": id, "channel": own.channel.word(), "unit": own.unit, "measured": own.measured,
                    "predicted": own.value, "standard_deviation": own.standard_deviation,
                })
            })
            .collect();
        return voice.json(&json!({ "schema": 1, "predictions": list }));
    }
    voice.raw(text.trim_end())
}

/// Records that lack what a prediction needs have a code of their own.
fn lacking(error: GapStudyError) -> Failure {
    let lacks = matches!(
        error,
        GapStudyError::Records(RecordError::MissingColumn { .. }) | GapStudyError::NothingMeasured { .. }
    );
    match error.fix().filter(|_| lacks) {
        Some(fix) => Failure::argument(format_args!("predict-column: {error}"), fix).at(error.location()),
        None => error.into(),
    }
}

/// How far the model is from each channel, in the unit for people.
fn summary(rows: &[(String, Prediction)]) -> Vec<String> {
    let mut channels: BTreeMap<ChannelId, (&str, f64, f64, f64)> = BTreeMap::new();
    for (_, own) in rows {
        let shown = |value: f64| unit::convert(value, own.unit, own.display);
        let off = shown(own.measured) - shown(own.value);
        if off.is_finite() {
            let sums = channels.entry(own.channel).or_insert((own.display, 0.0, 0.0, 0.0));
            *sums = (sums.0, sums.1 + off, sums.2 + off * off, sums.3 + 1.0);
        }
    }
    let digits = |value: f64| format!("{value:.2e}").parse().unwrap_or(value).to_string();
    let line = |(channel, (unit, sum, squares, count)): (ChannelId, (&str, f64, f64, f64))| {
        let unit = if unit == "1" { String::new() } else { format!(" {unit}") };
        let [mean, rms] = [sum / count, (squares / count).sqrt()].map(digits);
        format!(
            "{channel}: measured less predicted {mean}{unit} in the mean, {rms}{unit} root mean square, of {count} values"
        )
    };
    channels.into_iter().map(line).collect()
}

fn cells((id, own): &(String, Prediction)) -> [Cell<'_>; 6] {
    [
        id.into(),
        own.channel.word().into(),
        own.unit.into(),
        own.measured.into(),
        own.value.into(),
        own.standard_deviation.into(),
    ]
}
