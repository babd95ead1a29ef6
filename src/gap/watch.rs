//! `toolroom gap watch`: whether a shop that was diagnosed has changed since.

use super::{files_of, nominal, recorded};
use crate::args::WatchArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::path::Path;
use toolroom_gap_study::usable;
use toolroom_output::Files;
use toolroom_process::unit::quantity;
use toolroom_records::Records;
use toolroom_shards::fingerprint;
use toolroom_watch::{Watch, time_column};

pub fn run(args: &WatchArgs, voice: &Voice) -> Result<(), Failure> {
    let model = nominal(&args.data)?;
    let per_year = promised(&args.false_alarms)?;
    let mut records = recorded(&args.data.data, &model, voice)?;
    if let Some(since) = &args.since {
        records = since_rows(&records, since)?;
    }
    usable(&model.asked(&records, args.data.group.as_deref(), |_, _| false), &records)?;
    let key = key(&args.data.model, &args.data.set)?;
    let kept = args.state.as_deref().filter(|path| path.exists()).map(|path| resumed(path, &key)).transpose()?;
    let mut watch = kept.unwrap_or_else(|| Watch::new(key.clone()));
    let look = watch.look_at(&model, &records, args.data.group.as_deref(), per_year).ok_or_else(|| {
        super::nothing_measured(&["the newest block of each machine may still grow and is not used".to_owned()])
    })?;
    if let Some(path) = &args.state {
        let data = files_of(&args.data.data);
        let files = Files::new(data.iter().chain([&args.data.model]).map(AsRef::as_ref), voice.force);
        files.put_marked(path, &watch.state(), |old| Watch::resume(old, &key).is_ok())?;
    }
    if voice.json {
        voice.json(&look.json())?
    } else {
        voice.data(look.text())?
    }
    let streams: Vec<&str> = look.alarms.iter().map(|(alarm, _)| alarm.stream.as_str()).collect();
    if streams.is_empty() { Ok(()) } else { Err(Failure::Alarm { message: streams.join(", ") }) }
}

/// False alarms per year of `0.2 1/year`; a bare number counts per year.
fn promised(text: &str) -> Result<f64, Failure> {
    let number = text.trim().strip_suffix("1/year").unwrap_or(text).trim().parse::<f64>().ok();
    number.filter(|number| *number > 0.0 && number.is_finite()).ok_or_else(|| {
        let message = format!("--false-alarms {text}: a number of false alarms per year above zero is due");
        Failure::argument(message, "write it as in --false-alarms \"0.2 1/year\"")
    })
}

/// The rows from a time on.
fn since_rows(records: &Records, since: &str) -> Result<Records, Failure> {
    let from = quantity(since, "s").map_err(|reason| {
        let message = format!("--since {since}: {reason}");
        Failure::argument(message, "give the time since the start of the records, as in --since \"12 day\"")
    })?;
    let Some(times) = records.numbers(time_column(records)) else {
        let message = format!("--since needs the column `{}`, which the records lack", time_column(records));
        return Err(Failure::argument(message, "leave --since out"));
    };
    let rows: Vec<usize> = (0..records.len()).filter(|row| times[*row] >= from).collect();
    if rows.is_empty() {
        return Err(Failure::argument(format!("--since {since}: no row is as late"), "give an earlier time"));
    }
    Ok(records.select(&rows))
}

/// Fingerprint of a model file and the values that replace its own.
fn key(path: &Path, set: &[String]) -> Result<String, Failure> {
    let mut bytes = std::fs::read(path).map_err(Failure::unread(path))?;
    set.iter().for_each(|value| bytes.extend(value.bytes().chain([b'\n'])));
    Ok(fingerprint(&bytes))
}

fn resumed(path: &Path, key: &str) -> Result<Watch, Failure> {
    let text = std::fs::read_to_string(path).map_err(Failure::unread(path))?;
    Watch::resume(&text, key).map_err(|error| {
        let help = "[watch-state] a state goes on with the model it was begun with; give another --state to begin anew";
        Failure::of_file(path, error, help)
    })
}
