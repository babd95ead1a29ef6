//! Effects and drives of a model of part programs.

use crate::error::ApplyError;
use crate::values::{amount, number, put, unreadable, written};
use serde_json::Value;
use toml_edit::{DocumentMut, Item, Table, TableLike};
use toolroom_drives::Drives;
use toolroom_gap::EffectId;
use toolroom_process::{Field, Record};

/// The table under `key`, which is made where there is none.
fn table<'a>(document: &'a mut DocumentMut, key: &str) -> Result<&'a mut dyn TableLike, ApplyError> {
    if document.get(key).is_none() {
        document.insert(key, Item::Table(Table::new()));
    }
    document.get_mut(key).and_then(Item::as_table_like_mut).ok_or_else(|| unreadable(&format!("[{key}] of the model")))
}

/// The table under a key of the drives, which is made where there is none.
fn inner<'a>(document: &'a mut DocumentMut, key: &str) -> Result<&'a mut dyn TableLike, ApplyError> {
    let drives = table(document, "drives")?;
    if drives.get(key).is_none() {
        drives.insert(key, Item::Table(Table::new()));
    }
    let found = drives.get_mut(key).and_then(Item::as_table_like_mut);
    found.ok_or_else(|| unreadable(&format!("[drives.{key}] of the model")))
}

fn field(name: &str) -> Result<Field, ApplyError> {
    Drives::<f64>::FIELDS.iter().find(|field| field.name == name).copied().ok_or_else(|| unreadable("a drive"))
}

/// A number of the diagnosis with its unit, in `si`.
fn quantity(value: &Value, si: &'static str) -> Result<f64, ApplyError> {
    let amount = number(&value["value"], "a shape")?;
    let unit = value["unit"].as_str().unwrap_or("1");
    if unit == "1" {
        return Ok(amount);
    }
    toolroom_process::unit::quantity(&format!("{amount} {unit}"), si).map_err(|_| unreadable("a shape"))
}

/// Adds to a value of the drives.
fn add(entry: &mut dyn TableLike, key: &str, more: f64, field: Field) {
    let before = entry.get(key).and_then(Item::as_value).map(amount(field.unit)).unwrap_or(field.start);
    put(entry, key, written(before + more, field.unit));
}

/// Adds the size of an effect to that which the model has, and takes over the drives that belong to it.
pub fn switch_on(document: &mut DocumentMut, effect: &Value) -> Result<(), ApplyError> {
    let id = effect["id"].as_str().unwrap_or_default();
    let alike = effect["shape"]["each_alike"].is_object();
    let key = if alike { "feed_hold_each" } else { id };
    let effect_id = EffectId::named(id).ok_or_else(|| unreadable("the id of an effect"))?;
    let si = effect_id.entry().size.unit;
    let size = &effect["size"];
    let text = format!("{} {}", number(&size["value"], "a size")?, size["unit"].as_str().unwrap_or("1"));
    let added = if si == "1" {
        number(&size["value"], "a size")?
    } else {
        toolroom_process::unit::quantity(&text, si).map_err(|_| unreadable("a size"))?
    };
    // What acts on the drives goes there, where the next diagnosis finds it.
    if effect_id == EffectId::SPINDLE_RAMP {
        let [base, reference] = ["base_speed", "reference_speed"].map(|key| quantity(&effect["shape"][key], "rad/s"));
        let (base, reference) = (base?, reference?);
        let constant = added / (reference * reference + base * base);
        let spindle = inner(document, "spindle")?;
        add(spindle, "constant", constant, field("spindle_constant")?);
        put(spindle, "base_speed", written(base, "rad/s"));
        return Ok(());
    }
    if effect_id == EffectId::STOP_SETTLING {
        let rapid = added * quantity(&effect["shape"]["rapid"], "1")?;
        let own = document.get("drives").and_then(|drives| drives.get("settling")).is_some();
        let keys = if own { ["feed", "rapid"] } else { ["feed_settling", "rapid_settling"] };
        let settling = if own { inner(document, "settling")? } else { table(document, "drives")? };
        add(settling, keys[0], added, field("feed_settling")?);
        add(settling, keys[1], rapid, field("rapid_settling")?);
        return Ok(());
    }
    let effects = table(document, "effects")?;
    let before = effects.get(key).and_then(Item::as_value).map(amount(si)).unwrap_or(0.0);
    put(effects, key, written(before + added, si));
    for drive in ["corner_deviation", "jerk_time"] {
        let drive_value = &effect["shape"][drive];
        if let Some(value) = drive_value["value"].as_f64() {
            let unit = drive_value["unit"].as_str().unwrap_or("1").to_owned();
            put(table(document, "drives")?, drive, written(value, &unit));
        }
    }
    Ok(())
}

/// Multiplies a constant of the drives.
pub fn calibrate(document: &mut DocumentMut, constant: &Value) -> Result<(), ApplyError> {
    let parameter = constant["parameter"].as_str().unwrap_or_default();
    let key = parameter.strip_prefix("drives.").ok_or_else(|| unreadable("a calibration"))?;
    let factor = number(&constant["factor"], "a factor")?;
    // A tool changer is not calibrated but has an effect of its own, tool_change_delay.
    let drive = Drives::<f64>::FIELDS.iter().find(|drive| drive.name == key && key != "tool_change_time");
    let Field { unit, start, .. } = *drive.ok_or_else(|| unreadable("a calibration"))?;
    let drives = table(document, "drives")?;
    let before = drives.get(key).and_then(Item::as_value).map(amount(unit)).unwrap_or(start);
    put(drives, key, written(before * factor, unit));
    Ok(())
}
