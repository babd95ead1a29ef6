//! A scenario with what a diagnosis has found: its text, of which everything else stays byte for byte.

use crate::constants::calibrate;
use crate::effects::{of_shop, of_tool};
use crate::error::ApplyError;
use crate::hash::{BYTE_ORDER_MARK, model_hash, parsed, unmark};
use crate::program;
use crate::values::unreadable;
use serde_json::Value;
use toml_edit::Item;
use toolroom_effects::Effect;
use toolroom_gap::EffectId;
use toolroom_scenario::ShopEffect;

/// What is to be applied to which text.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The model file.
    pub text: &'a str,
    /// Values of `--set` with which it was diagnosed.
    pub overrides: &'a [String],
    /// The diagnosis.
    pub diagnosis: &'a Value,
    /// Process of the model.
    pub process: &'a str,
    /// Effects to be applied; all, if empty.
    pub only: &'a [String],
    /// Whether calibration is applied.
    pub calibration: bool,
    /// Whether effects that are empirical, and no causes, are applied.
    pub empirical: bool,
}

/// What was changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Changes {
    /// The text of the model.
    pub text: String,
    /// Effects that were written, by id.
    pub effects: Vec<String>,
    /// Constants that were written, as parameter and target.
    pub constants: Vec<String>,
    /// Hashes of the records that its calibration has seen.
    pub data: Vec<String>,
    /// What is worth knowing.
    pub notes: Vec<String>,
}

/// The model with what a diagnosis has found.
///
/// # Errors
/// [`ApplyError`]: a diagnosis of another model or form, an effect that no shop can have, a tool that is not there.
pub fn apply(request: Request<'_>) -> Result<Changes, ApplyError> {
    let Request { diagnosis, process, .. } = request;
    let schema = &diagnosis["schema"];
    if schema.as_u64() != Some(crate::SCHEMA) {
        return Err(ApplyError::Schema { found: schema.to_string() });
    }
    let mine = |own: &&Value| own["process"].as_str().is_none_or(|own| own == process);
    let model = diagnosis["models"].as_array().into_iter().flatten().find(mine);
    let diagnosed = model.and_then(|model| model["hash"].as_str()).unwrap_or_default().to_owned();
    let found = model_hash(request.text, request.overrides)?;
    if diagnosed != found {
        return Err(ApplyError::Model { diagnosed, found });
    }
    let mut document = parsed(request.text)?;
    // With its terms a model has another calibration, too.
    let mut proposals = diagnosis["proposals"].as_array().into_iter().flatten();
    let proposed = proposals.find(|own| request.empirical && mine(own)).map(|own| &own["applied"]);
    let applied = proposed.unwrap_or(&diagnosis["applied"]);
    let list = |key: &str| applied[key].as_array().into_iter().flatten().filter(mine).collect::<Vec<_>>();
    let wanted = |own: &&&Value| {
        let id = own["id"].as_str().unwrap_or_default();
        request.only.is_empty() || request.only.iter().any(|only| only == id)
    };
    if let Some(error) = unknown(diagnosis, request.only) {
        return Err(error);
    }
    let effects = list("effects");
    let mut effects: Vec<&Value> = effects.iter().filter(wanted).copied().collect();
    // What rapid motions have beside the acceleration of the axes is added to it.
    effects.sort_by_key(|own| own["id"] != EffectId::AXIS_ACCELERATION.word());
    let mut constants = if request.calibration { list("calibration") } else { Vec::new() };
    // A constant that was named is chosen by its name, as effects are.
    constants.retain(|own| own["id"].is_null() || wanted(&own));
    if effects.is_empty() && constants.is_empty() {
        return Err(ApplyError::Nothing);
    }
    let by = format!("diagnosis {}", diagnosis["hash"].as_str().unwrap_or_default().get(..8).unwrap_or_default());
    let mut data: Vec<String> = document
        .get("gap")
        .and_then(|gap| gap.get("applied"))
        .and_then(|mark| mark.get("data"))
        .and_then(Item::as_array)
        .map(|all| all.iter().filter_map(|own| own.as_str().map(str::to_owned)).collect())
        .unwrap_or_default();
    unmark(&mut document);
    let data_hash = diagnosis["data"]["hash"].as_str().unwrap_or_default().to_owned();
    if !data_hash.is_empty() && !data.contains(&data_hash) {
        data.push(data_hash);
    }
    let mut changes =
        Changes { text: String::new(), effects: Vec::new(), constants: Vec::new(), data, notes: Vec::new() };
    for effect in effects {
        let id = effect["id"].as_str().ok_or_else(|| unreadable("the id of an effect"))?;
        if effect["kind"] == "empirical" && !request.empirical {
            let reason = "it is empirical, not a cause; --accept-empirical takes it in".to_owned();
            return Err(ApplyError::Effect { id: id.to_owned(), reason });
        }
        if process == "program" {
            program::switch_on(&mut document, effect)?;
        } else if Effect::named(id).is_ok() || effect["definition"].is_string() {
            of_tool(&mut document, effect)?;
        } else if ShopEffect::from_word(id).is_some() {
            of_shop(&mut document, effect)?;
        } else {
            let reason = "it is an effect of part programs or of records alone".to_owned();
            return Err(ApplyError::Effect { id: id.to_owned(), reason });
        }
        changes.effects.push(id.to_owned());
    }
    for constant in constants {
        if process == "program" {
            program::calibrate(&mut document, constant)?;
        } else {
            calibrate(&mut document, constant, &by)?;
        }
        let text = |key: &str| constant[key].as_str().unwrap_or_default();
        changes.constants.push(format!("{} of {}", text("parameter"), text("target")));
    }
    let mark = request.text.chars().next().filter(|first| *first == BYTE_ORDER_MARK);
    changes.text = mark.into_iter().collect::<String>() + &document.to_string();
    Ok(changes)
}

/// The first of the names that were chosen that stands for nothing in a diagnosis, whatever its process.
fn unknown(diagnosis: &Value, only: &[String]) -> Option<ApplyError> {
    let of = |applied: &Value| {
        let lists = ["effects", "calibration"].map(|key| applied[key].as_array().cloned().unwrap_or_default());
        lists.concat().iter().filter_map(|own| own["id"].as_str().map(str::to_owned)).collect::<Vec<String>>()
    };
    let proposals = diagnosis["proposals"].as_array().into_iter().flatten();
    let mut there: Vec<String> = of(&diagnosis["applied"]);
    there.extend(proposals.flat_map(|own| of(&own["applied"])));
    there.sort();
    there.dedup();
    let name = only.iter().find(|name| !there.contains(name))?.clone();
    let found = if there.is_empty() { "no effect".to_owned() } else { there.join(", ") };
    Some(ApplyError::Only { name, found })
}
