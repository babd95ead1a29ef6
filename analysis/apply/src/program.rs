//! Effects and drives of a model of part programs.

use crate::error::ApplyError;
use crate::values::{amount, number, put, unreadable, written};
use serde_json::Value;
use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, value};
use toolroom_drives::{Deviation, Drives, Machine};
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

/// The drives that a model has: those of its preset where it gives no others.
fn drives_of(document: &DocumentMut) -> Result<Drives, ApplyError> {
    let mut own = DocumentMut::new();
    if let Some(drives) = document.get("drives") {
        own.insert("drives", drives.clone());
    }
    let file = Machine::of("the model", &own.to_string(), &[]).map_err(|_| unreadable("[drives] of the model"))?;
    Ok(file.content.drives)
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

/// How an effect changes the drives; `None` where it stands among the effects of the model.
fn deviation(id: EffectId, shape: &Value) -> Result<Option<Deviation>, ApplyError> {
    if id == EffectId::SPINDLE_RAMP {
        let [base_speed, reference_speed] = ["base_speed", "reference_speed"].map(|key| quantity(&shape[key], "rad/s"));
        return Ok(Some(Deviation::SpindleRamp { base_speed: base_speed?, reference_speed: reference_speed? }));
    }
    if id == EffectId::STOP_SETTLING {
        return Ok(Some(Deviation::StopSettling { rapid: quantity(&shape["rapid"], "1")? }));
    }
    let shapeless = [
        (EffectId::RAPID_ACCELERATION, Deviation::RapidAcceleration),
        (EffectId::JERK, Deviation::Jerk),
        (EffectId::CORNER_SLOWING, Deviation::CornerSlowing),
        (EffectId::BLOCK_TIME, Deviation::BlockTime),
        (EffectId::PROGRAM_END, Deviation::ProgramEnd),
        (EffectId::MAGAZINE_DISTANCE, Deviation::MagazineDistance),
    ];
    Ok(shapeless.into_iter().find(|(known, _)| *known == id).map(|(_, deviation)| deviation))
}

/// Writes a field of the drives to where the model gives it, by whichever of its names. A jerk belongs to the acceleration that
/// the model states (`stated`), whatever its effects add to that.
fn write(
    document: &mut DocumentMut,
    field: &Field,
    stated: &Drives,
    before: &Drives,
    after: f64,
) -> Result<(), ApplyError> {
    let given = |key: &str| document.get("drives").is_some_and(|drives| drives.get(key).is_some());
    let item = written(after, field.unit);
    match field.name {
        "jerk_time" if given("jerk") => {
            let jerk = 1.0 / (stated.inverse_acceleration * after);
            put(table(document, "drives")?, "jerk", written(jerk, "m/s3"));
        }
        "corner_deviation" if given("corner") => put(inner(document, "corner")?, "value", item),
        "feed_settling" if given("settling") => put(inner(document, "settling")?, "feed", item),
        "rapid_settling" if given("settling") => put(inner(document, "settling")?, "rapid", item),
        "index_time" => {
            let changer = inner(document, "changer")?;
            put(changer, "index_time", item);
            if changer.get("kind").is_some() {
                put(changer, "kind", value("carousel"));
            }
        }
        "spindle_constant" => put(inner(document, "spindle")?, "constant", item),
        "spindle_base_speed" => put(inner(document, "spindle")?, "base_speed", item),
        "braking_constant" => {
            let spindle = inner(document, "spindle")?;
            if spindle.get("braking").is_none() {
                spindle.insert("braking", value(InlineTable::new()));
            }
            let braking = spindle.get_mut("braking").and_then(Item::as_table_like_mut);
            let braking = braking.ok_or_else(|| unreadable("[drives.spindle] braking of the model"))?;
            put(braking, "constant", item);
            if braking.get("base_speed").is_none() {
                put(braking, "base_speed", written(before.braking_base_speed, "rad/s"));
            }
        }
        flat => put(table(document, "drives")?, flat, item),
    }
    Ok(())
}

/// Writes what differs between two sets of drives.
fn write_all(document: &mut DocumentMut, stated: &Drives, before: &Drives, after: &Drives) -> Result<(), ApplyError> {
    for (index, field) in Drives::<f64>::FIELDS.iter().enumerate() {
        if let Some(value) = after.get(index).filter(|value| before.get(index) != Some(*value)) {
            write(document, field, stated, before, value)?;
        }
    }
    Ok(())
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
    let drives = drives_of(document)?;
    let acceleration = document.get("effects").and_then(|effects| effects.get(EffectId::AXIS_ACCELERATION.word()));
    let acceleration = acceleration.and_then(Item::as_value).map_or(0.0, amount("s2/m"));
    let before = Drives { inverse_acceleration: drives.inverse_acceleration + acceleration, ..drives };
    // What acts on the drives goes there, where the next diagnosis finds it.
    if let Some(deviation) = deviation(effect_id, &effect["shape"])? {
        return write_all(document, &drives, &before, &deviation.added(added, &before));
    }
    let effects = table(document, "effects")?;
    let standing = effects.get(key).and_then(Item::as_value).map(amount(si)).unwrap_or(0.0);
    put(effects, key, written(standing + added, si));
    if effect_id == EffectId::AXIS_ACCELERATION {
        let shape = &effect["shape"];
        let deviation = Deviation::Acceleration {
            corner_deviation: quantity(&shape["corner_deviation"], "m")?,
            jerk_time: quantity(&shape["jerk_time"], "s")?,
        };
        // The acceleration itself stands among the effects.
        let after = Drives { inverse_acceleration: before.inverse_acceleration, ..deviation.added(added, &before) };
        write_all(document, &drives, &before, &after)?;
    }
    Ok(())
}

/// Multiplies a constant of the drives.
pub fn calibrate(document: &mut DocumentMut, constant: &Value) -> Result<(), ApplyError> {
    let parameter = constant["parameter"].as_str().unwrap_or_default();
    let key = parameter.strip_prefix("drives.").ok_or_else(|| unreadable("a calibration"))?;
    let factor = number(&constant["factor"], "a factor")?;
    // A tool changer is not calibrated but has an effect of its own, tool_change_delay.
    let index = Drives::<f64>::index_of(key).filter(|_| key != "tool_change_time");
    let index = index.ok_or_else(|| unreadable("a calibration"))?;
    let before = drives_of(document)?;
    let Field { unit, .. } = Drives::<f64>::FIELDS[index];
    let after = before.get(index).ok_or_else(|| unreadable("a calibration"))? * factor;
    let ratios = [before.rapid_ratio_x, before.rapid_ratio_y, before.rapid_ratio_z];
    let drives = table(document, "drives")?;
    if key == "rapid_speed" && ratios.iter().any(|ratio| *ratio != 1.0) {
        // One speed would be that of every axis.
        if drives.get(key).and_then(Item::as_table_like).is_none() {
            drives.insert(key, value(InlineTable::new()));
        }
        let axes = drives.get_mut(key).and_then(Item::as_table_like_mut).ok_or_else(|| unreadable("rapid_speed"))?;
        for (axis, ratio) in ["X", "Y", "Z"].into_iter().zip(ratios) {
            put(axes, axis, written(after * ratio, unit));
        }
        return Ok(());
    }
    if let Some(axes) = drives.get_mut(key).and_then(Item::as_table_like_mut) {
        ["X", "Y", "Z"].into_iter().for_each(|axis| put(axes, axis, written(after, unit)));
        return Ok(());
    }
    put(drives, key, written(after, unit));
    Ok(())
}
