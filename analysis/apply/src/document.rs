//! `diagnosis.json`, schema 2: everything that an application needs, as numbers with units.

use crate::applied::{Applied, AppliedEffect, Constant};
use crate::grew::grew;
use serde_json::{Map, Value, json};
use std::path::Path;
use toolroom_gap::{NINETY, WEAR_RATE, WrittenEffect};
use toolroom_process::table::{Cell, csv_text};
use toolroom_process::unit;
use toolroom_records::Records;
use toolroom_scenario::{Calibration, Scope};
use toolroom_shards::fingerprint;

/// Version of the document.
pub const SCHEMA: u64 = 2;

/// A number with its unit, in the unit for people where that reads back to the same bits, else in SI.
pub(crate) fn exact(value: f64, si: &'static str, display: &'static str) -> (f64, &'static str) {
    let shown = unit::convert(value, si, display);
    let same = unit::quantity(&format!("{shown} {display}"), si) == Ok(value);
    if display == "1" || same { (shown, display) } else { (value, si) }
}

fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

/// A scope as files have it.
pub fn scope_json(scope: &Scope) -> Value {
    let mut map: Map<String, Value> =
        scope.names.iter().map(|(key, names)| ((*key).to_owned(), json!(names))).collect();
    let mut time = |key: &str, time: Option<f64>| {
        if let Some(time) = time {
            map.insert(key.to_owned(), json!(format!("{time} s")));
        }
    };
    time("from", scope.from);
    time("until", scope.until);
    Value::Object(map)
}

fn shape_json(written_effect: &WrittenEffect) -> Value {
    let one = |(name, value, si, display): &(&'static str, f64, &'static str, &'static str)| {
        let (value, unit) = exact(*value, si, display);
        ((*name).to_owned(), json!({ "value": number(value), "unit": unit, "se": null }))
    };
    Value::Object(written_effect.shape.iter().map(one).collect())
}

/// Whether an effect is a cause, a constant that is another one on a part of the records, or describes and is none.
fn kind(found: &AppliedEffect) -> &'static str {
    match found.written_effect.definition {
        Some(own) if own.is_empirical() => "empirical",
        Some(_) if found.id.is_wear_rate() => "constant",
        Some(_) | None => "cause",
    }
}

fn found_json(found: &AppliedEffect, target: &str, process: &str) -> Value {
    let (si, display) = (found.id.entry().size.unit, found.id.entry().size.display);
    let (size, unit) = exact(found.size, si, display);
    let ratio = if unit == si { 1.0 } else { unit::convert(1.0, si, display) };
    let mut value = json!({
        "kind": kind(found), "id": found.id.word(), "process": process, "target": target,
        "shape": shape_json(&found.written_effect), "scope": scope_json(&found.written_effect.scope),
        "size": { "value": number(size), "unit": unit, "se": number(found.standard_error * ratio) },
    });
    if let Some(recorded) = found.written_effect.recorded {
        value["recorded"] = number(recorded);
    }
    if let Some(definition) = found.written_effect.definition {
        value["definition"] = json!(definition.text());
    }
    value
}

fn constant_json(constant: &Constant, process: &str) -> Value {
    let mut value = json!({
        "parameter": constant.movable.parameter, "target": constant.movable.target.words(), "process": process,
        "scope": scope_json(&constant.movable.scope),
        "se": number(constant.standard_error), "prior": number(constant.prior), "moved_sd": number(constant.moved),
    });
    if constant.movable.summand {
        let word = |(word, _): &&(&str, &'static str)| *word == constant.movable.parameter;
        value["summand"] = number(constant.value);
        value["unit"] = json!(Calibration::WORDS.iter().find(word).map_or("1", |(_, unit)| *unit));
    } else {
        value["factor"] = number(constant.value);
    }
    if constant.movable.parameter == "wear_rate" && !constant.movable.scope.is_everywhere() {
        // What it was named as, so that it can be chosen.
        value["id"] = json!(WEAR_RATE);
    }
    value
}

/// Calibration and effects of a point of one process that an application may write: [`document`] has those of what was
/// named, an entry of `proposals` those with its terms.
pub fn point_json(part: &Applied, process: &Process<'_>) -> Value {
    let mut value = applied_json(std::slice::from_ref(part), &process.target, process.name);
    if let Some(map) = value.as_object_mut() {
        map.retain(|key, _| key == "calibration" || key == "effects");
    }
    value
}

/// Calibration, effects and covariance of one process; `target` is its tool, as a file names it.
pub fn applied_json(parts: &[Applied], target: &str, process: &str) -> Value {
    let matrix = |own: &Applied| -> Vec<Vec<Value>> {
        own.covariance.row_iter().map(|row| row.iter().map(|value| number(*value)).collect()).collect()
    };
    let all = |list: &dyn Fn(&Applied) -> Vec<Value>| parts.iter().flat_map(list).collect::<Vec<Value>>();
    let covariance: Vec<Value> = parts.iter().map(|own| json!({ "names": own.names, "matrix": matrix(own) })).collect();
    json!({
        "calibration": all(&|own| own.calibration.iter().map(|each| constant_json(each, process)).collect()),
        "effects": all(&|own| {
            let effects = own.effects.iter().filter(|each| !each.is_constant);
            effects.map(|each| found_json(each, target, process)).collect()
        }),
        "covariance": covariance.first().cloned().unwrap_or(Value::Null),
        "left": all(&|own| own.left.iter().map(|name| json!(name)).collect()),
        "grew": grew(parts).iter().map(|own| own.json(process)).collect::<Vec<Value>>(),
    })
}

/// What one process of a diagnosis adds to its document.
pub struct Process<'a> {
    /// `turning`, `shop` …
    pub name: &'a str,
    /// Its model file.
    pub path: &'a Path,
    /// [`model_hash`](crate::model_hash) of that.
    pub hash: String,
    /// The tool or shop to which constants and effects belong, as a file names it.
    pub target: String,
    /// The applied point of each part.
    pub parts: &'a [Applied],
}

/// Standard error of the size of an effect that is applied, as its interval says it: that of the applied point alone knows of
/// no other form of the effect.
fn printed_error(applied: &Value, printed: &[Value]) -> Option<f64> {
    let alike = |own: &&Value| ["id", "process", "shape", "scope"].iter().all(|key| own[key] == applied[key]);
    let size = &printed.iter().find(alike)?["size"];
    let factor = |size: &Value| Some(unit::parse(size["unit"].as_str()?).ok()?.factor);
    Some(size["se"].as_f64()? * factor(size)? / factor(&applied["size"])?)
}

/// The document of a diagnosis with everything that an application needs. `document` is what was found; `data` are
/// hash, rows and the first and last start of the records, s.
pub fn document(mut document: Value, processes: &[Process<'_>], data: (String, usize, Option<(f64, f64)>)) -> Value {
    document["schema"] = json!(SCHEMA);
    let applied: Vec<Value> = processes.iter().map(|own| applied_json(own.parts, &own.target, own.name)).collect();
    let records = |own: &Process<'_>, list: &mut Value| {
        // One effect may act twice, on two parts of the records: both lists have their effects in the same order.
        let mut left: Vec<&AppliedEffect> = own.parts.iter().flat_map(|part| &part.effects).collect();
        for effect in list.as_array_mut().into_iter().flatten() {
            let mine = effect["process"].as_str().is_none_or(|process| process == own.name);
            let named = |found: &&AppliedEffect| Some(found.id.word()) == effect["id"].as_str();
            let place = left.iter().position(named).filter(|_| mine);
            let found = place.map(|place| left.remove(place));
            if let (Some(found), true, true) = (found, mine, effect["size"].is_number()) {
                effect["kind"] = json!(kind(found));
                effect["words"] = effect["shape"].take();
                effect["shape"] = shape_json(&found.written_effect);
                effect["scope"] = scope_json(&found.written_effect.scope);
                effect["target"] = json!(own.target);
                let half = effect["ci90"][1].as_f64().unwrap_or(f64::NAN) - effect["size"].as_f64().unwrap_or(f64::NAN);
                effect["size"] = json!({
                    "value": effect["size"], "unit": effect["unit"], "se": number(half / NINETY), "ci90": effect["ci90"],
                });
            }
        }
    };
    for each_process in processes {
        records(each_process, &mut document["effects"]);
        if document["processes"][each_process.name].is_object() {
            let list = &mut document["processes"][each_process.name]["effects"];
            let mut taken = list.take();
            records(each_process, &mut taken);
            document["processes"][each_process.name]["effects"] = taken;
            document["processes"][each_process.name]["schema"] = json!(SCHEMA);
        }
    }
    if document["processes"].is_null()
        && let Some(map) = document.as_object_mut()
    {
        map.remove("processes");
    }
    let join = |key: &str| -> Vec<Value> {
        applied.iter().flat_map(|own| own[key].as_array().cloned().unwrap_or_default()).collect()
    };
    document["applied"] = json!({
        "calibration": join("calibration"), "effects": join("effects"), "left": join("left"),
        "grew": join("grew"),
        "covariance": applied.first().map_or(Value::Null, |own| own["covariance"].clone()),
    });
    let printed = document["effects"].as_array().cloned().unwrap_or_default();
    for effect in document["applied"]["effects"].as_array_mut().into_iter().flatten() {
        if let Some(error) = printed_error(effect, &printed) {
            effect["size"]["se"] = number(error);
        }
    }
    let models: Vec<Value> = processes
        .iter()
        .map(|own| json!({ "process": own.name, "path": own.path.display().to_string(), "hash": own.hash }))
        .collect();
    document["model"] = models.first().cloned().unwrap_or(Value::Null);
    document["models"] = json!(models);
    let (hash, rows, times) = data;
    let time = |time: Option<f64>| time.map_or(Value::Null, |time| json!(format!("{time} s")));
    document["data"] = json!({
        "hash": hash, "rows": rows, "from": time(times.map(|times| times.0)), "until": time(times.map(|times| times.1)),
    });
    document["hash"] = json!(fingerprint(document.to_string().as_bytes()));
    document
}

/// The rows of the table `predictions`, part by part.
pub fn predictions_of(records: &Records, parts: &[Applied]) -> Vec<PredictionRow> {
    let id = |row: usize| {
        let texts = ["operation_id", "trial_id"].iter().find_map(|name| records.texts(name));
        match texts.map(|texts| texts[row].as_str()) {
            Some("") => format!("row {}", row + 1),
            Some(id) => id.to_owned(),
            None => (row + 1).to_string(),
        }
    };
    let row = |part: &Applied, i: usize| {
        let [nominal, calibrated, applied] = &part.predictions;
        let applied_row = &applied[i];
        PredictionRow {
            operation_id: id(applied_row.row.min(records.len().saturating_sub(1))),
            channel: applied_row.channel.to_string(),
            unit: applied_row.unit.to_owned(),
            measured: applied_row.measured,
            nominal: nominal[i].value,
            calibrated: calibrated[i].value,
            applied: applied_row.value,
            standard_deviation: applied_row.standard_deviation,
            used: applied_row.used,
        }
    };
    parts.iter().flat_map(|part| (0..part.predictions[2].len()).map(move |i| row(part, i))).collect()
}

/// A row of the table `predictions`, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct PredictionRow {
    /// Operation or trial; the number of the block in a shop's log.
    pub operation_id: String,
    /// Channel.
    pub channel: String,
    /// SI unit of the values.
    pub unit: String,
    /// What was measured.
    pub measured: f64,
    /// What the model that was read predicts.
    pub nominal: f64,
    /// The same with calibration alone.
    pub calibrated: f64,
    /// The same with calibration and effects.
    pub applied: f64,
    /// Standard deviation of the reading.
    pub standard_deviation: f64,
    /// Whether it was fitted.
    pub used: bool,
}

impl PredictionRow {
    /// The table as text.
    pub fn csv(rows: &[Self]) -> String {
        let header = [
            "operation_id",
            "channel",
            "unit",
            "measured",
            "nominal",
            "calibrated",
            "applied",
            "standard_deviation",
            "used",
        ];
        csv_text(header, rows.iter().map(Self::cells)).expect("every row is as long as the header")
    }

    fn cells(&self) -> [Cell<'_>; 9] {
        [
            (&self.operation_id).into(),
            (&self.channel).into(),
            (&self.unit).into(),
            self.measured.into(),
            self.nominal.into(),
            self.calibrated.into(),
            self.applied.into(),
            self.standard_deviation.into(),
            self.used.into(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_applied_effect_has_the_error_of_its_printed_interval_in_its_own_unit() {
        let effect = |shape: &str, value: f64, unit: &str, se: f64| {
            json!({ "id": "heat", "process": "turning", "shape": { "width": shape }, "scope": {},
                "size": { "value": value, "unit": unit, "se": se } })
        };
        let printed = [effect("wide", 3.0, "mm", 9.0), effect("narrow", 120.0, "um", 15.0)];
        let error = |applied: &Value| printed_error(applied, &printed);
        let own = error(&effect("narrow", 1.2e-4, "m", 1e-9)).expect("the same effect");
        assert!((own / 15e-6 - 1.0).abs() < 1e-12, "{own}");
        assert_eq!(error(&effect("other", 1.0, "um", 1.0)), None);
    }
}
