//! Constants that moved, as entries of a file.

use crate::error::ApplyError;
use crate::scope::{machines, scope_item, scoped_item, scoped_json};
use crate::values::{amount, number, put, tables, unreadable, written};
use serde_json::Value;
use toml_edit::{DocumentMut, Item, Table, value};
use toolroom_scenario::Calibration;

/// Writes a constant that moved.
pub fn calibrate(document: &mut DocumentMut, constant: &Value, by: &str) -> Result<(), ApplyError> {
    let text = |key: &str| constant[key].as_str().map(str::to_owned).ok_or_else(|| unreadable("a calibration"));
    let (parameter, target) = (text("parameter")?, text("target")?);
    let (scope, machines) = (scoped_json(&constant["scope"]), machines(document));
    let unit = Calibration::WORDS.iter().find(|(word, _)| *word == parameter).map_or("1", |(_, unit)| *unit);
    let summand = constant["summand"].as_f64();
    let entries = tables(document, "calibration")?;
    let same = |entry: &Table| {
        let is = |key: &str, wanted: &str| entry.get(key).and_then(Item::as_str) == Some(wanted);
        is("parameter", &parameter)
            && is("target", &target)
            && entry.get("summand").is_some() == summand.is_some()
            && scoped_item(entry, &machines) == scope
    };
    let position = entries.iter().position(same);
    let mut table = position.and_then(|index| entries.get(index)).cloned().unwrap_or_default();
    if position.is_none() {
        table.insert("parameter", value(&parameter));
        table.insert("target", value(&target));
    }
    match summand {
        Some(added) => {
            let before = table.get("summand").and_then(Item::as_value).map(amount(unit)).unwrap_or(0.0);
            put(&mut table, "summand", written(before + added, unit));
        }
        None => {
            let factor = number(&constant["factor"], "a factor")?;
            let before = table.get("factor").and_then(Item::as_value).map(amount("1")).unwrap_or(1.0);
            put(&mut table, "factor", value(before * factor));
        }
    }
    let unit = if summand.is_some() { unit } else { "1" };
    if let Some(error) = constant["se"].as_f64() {
        put(&mut table, "standard_error", written(error, unit));
    }
    if table.get("prior").is_none()
        && let Some(prior) = constant["prior"].as_f64()
    {
        table.insert("prior", written(prior, unit));
    }
    if let (None, Some(scope)) = (position, scope_item(&constant["scope"])) {
        table.insert("scope", value(scope));
    }
    put(&mut table, "by", value(by));
    match position.and_then(|index| entries.get_mut(index)) {
        Some(entry) => *entry = table,
        None => entries.push(table),
    }
    Ok(())
}
