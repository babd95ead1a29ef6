//! Effects of a diagnosis, as entries of a file.

use crate::error::ApplyError;
use crate::scope::{machines, scope_item, scoped_item, scoped_json};
use crate::values::{number, put, tables, unreadable, written};
use serde_json::Value;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, value};
use toolroom_effects::{Definition, Effect, parse_definitions};
use toolroom_gap::EffectId;
use toolroom_scenario::ShopEffect;

/// Total below which an effect is off.
const NOTHING: f64 = 1e-12;

/// The effect that an entry of a file or diagnosis describes, at size zero.
fn effect_of(
    id: &str,
    shape: &serde_json::Map<String, Value>,
    definition: Option<&'static Definition>,
) -> Option<Effect> {
    let known = definition.map(EffectId::from).or_else(|| EffectId::named(id));
    let unit = known.map_or("1", |effect| effect.entry().size.unit);
    let size = if unit == "1" { 0.0.into() } else { Value::from(format!("0 {unit}")) };
    let defined: Vec<&'static Definition> = definition.into_iter().collect();
    let parameters = shape.iter().map(|(name, value)| (name.as_str(), value)).chain([("size", &size)]);
    Effect::of_parameters(id, parameters, &defined).ok().map(|effect| effect.with_size(0.0))
}

/// What a user has written of an effect of a diagnosis.
fn definition_of(effect: &Value) -> Result<Option<&'static Definition>, ApplyError> {
    let Some(text) = effect["definition"].as_str() else { return Ok(None) };
    let read = parse_definitions("diagnosis.json", text).map_err(|_| unreadable("the definition of an effect"))?;
    Ok(read.first().copied())
}

/// Copies the definition of a user's effect into a file that lacks it.
fn define(document: &mut DocumentMut, definition: &Definition) -> Result<(), ApplyError> {
    let id = definition.entry().id;
    let entries = tables(document, "effect")?;
    if entries.iter().any(|entry| entry.get("id").and_then(Item::as_str) == Some(id)) {
        return Ok(());
    }
    let text: DocumentMut = definition.text().parse().map_err(|_| unreadable("the definition of an effect"))?;
    let definition = text.get("effect").and_then(Item::as_array_of_tables).and_then(|all| all.get(0)).cloned();
    entries.push(definition.ok_or_else(|| unreadable("the definition of an effect"))?);
    Ok(())
}

/// Shape of the diagnosis as keys of a file.
fn shape_of(effect: &Value) -> serde_json::Map<String, Value> {
    let one = |(name, own): (&String, &Value)| {
        let unit = own["unit"].as_str().unwrap_or("1");
        let number = &own["value"];
        (name.clone(), if unit == "1" { number.clone() } else { format!("{number} {unit}").into() })
    };
    effect["shape"].as_object().into_iter().flatten().map(one).collect()
}

fn shape_of_entry(entry: &dyn TableLike) -> serde_json::Map<String, Value> {
    let mut map = serde_json::Map::new();
    let mut take = |table: &dyn TableLike| {
        for (key, item) in table.iter().filter(|(key, _)| !KEYS.contains(key)) {
            let text = item.as_str().map(Value::from);
            let number = || item.as_integer().map(Value::from).or_else(|| item.as_float().map(Value::from));
            map.extend(text.or_else(number).map(|read| (key.to_owned(), read)));
        }
    };
    take(entry);
    if let Some(shape) = entry.get("shape").and_then(Item::as_table_like) {
        take(shape);
    }
    map
}

/// Keys of an effect that are no parameters of its shape.
const KEYS: [&str; 5] = ["id", "size", "shape", "scope", "standard_error"];

/// Sets size and standard error of an entry.
fn set_size(entry: &mut dyn TableLike, effect: &Value) -> Result<f64, ApplyError> {
    let size = &effect["size"];
    let unit = size["unit"].as_str().unwrap_or("1");
    let total = number(&size["value"], "a size")?;
    put(entry, "size", written(total, unit));
    if let Some(error) = size["se"].as_f64() {
        put(entry, "standard_error", written(error, unit));
    }
    Ok(total)
}

/// Writes an effect of the process of a tool.
pub fn of_tool(document: &mut DocumentMut, effect: &Value) -> Result<(), ApplyError> {
    let target = effect["target"].as_str().unwrap_or_default().to_owned();
    let name = target.strip_prefix("tool ").unwrap_or(&target).to_owned();
    let id = effect["id"].as_str().unwrap_or_default().to_owned();
    let shape = shape_of(effect);
    let definition = definition_of(effect)?;
    if let Some(definition) = definition {
        define(document, definition)?;
    }
    let wanted = effect_of(&id, &shape, definition).ok_or_else(|| unreadable("the shape of an effect"))?;
    let mut scope = scoped_json(&effect["scope"]);
    scope.retain(|key, names| key != "tool" || !names.contains(&name));
    let machines = machines(document);
    let tools = document.get_mut("tool").and_then(Item::as_array_of_tables_mut);
    let named = |table: &&mut Table| table.get("name").and_then(Item::as_str) == Some(&name);
    let tool = tools.and_then(|tools| tools.iter_mut().find(named)).ok_or(ApplyError::Target { target })?;
    let same = |entry: &dyn TableLike| {
        let same_effect = entry.get("id").and_then(Item::as_str) == Some(&id)
            && effect_of(&id, &shape_of_entry(entry), definition) == Some(wanted);
        let mut entry_scope = scoped_item(entry, &machines);
        entry_scope.retain(|key, names| key != "tool" || !names.contains(&name));
        same_effect && entry_scope == scope
    };
    if let Some(entries) = tool.get_mut("effects").and_then(Item::as_array_of_tables_mut) {
        let found = entries.iter().position(|entry| same(entry));
        let mut table = found.and_then(|index| entries.get(index)).cloned().unwrap_or_default();
        let total = fill(&mut table, effect, &shape, found.is_none())?;
        match found {
            Some(index) if total.abs() <= NOTHING => drop(entries.remove(index)),
            Some(index) => {
                if let Some(entry) = entries.get_mut(index) {
                    *entry = table;
                }
            }
            None => entries.push(table),
        }
        return Ok(());
    }
    if tool.get("effects").is_none() {
        tool.insert("effects", value(Array::new()));
    }
    let entries =
        tool.get_mut("effects").and_then(Item::as_array_mut).ok_or_else(|| unreadable("`effects` of the model"))?;
    let found = entries.iter().position(|entry| entry.as_inline_table().is_some_and(|entry| same(entry)));
    match found {
        Some(index) => {
            let Some(entry) = entries.get_mut(index).and_then(toml_edit::Value::as_inline_table_mut) else {
                return Ok(());
            };
            if set_size(entry, effect)?.abs() <= NOTHING {
                entries.remove(index);
            }
        }
        None => {
            let mut table = InlineTable::new();
            if fill(&mut table, effect, &shape, true)?.abs() > NOTHING {
                entries.push(table);
            }
        }
    }
    Ok(())
}

/// Writes id, size, shape and scope of an entry; the total.
fn fill(
    entry: &mut dyn TableLike,
    effect: &Value,
    shape: &serde_json::Map<String, Value>,
    new: bool,
) -> Result<f64, ApplyError> {
    if new {
        put(entry, "id", value(effect["id"].as_str().unwrap_or_default()));
    }
    let total = set_size(entry, effect)?;
    if new && !shape.is_empty() {
        let mut table = InlineTable::new();
        for (key, value) in shape {
            let number = || value.as_f64().unwrap_or(f64::NAN).into();
            table.insert(key, value.as_str().map_or_else(number, Into::into));
        }
        entry.insert("shape", value(table));
    }
    if let (true, Some(scope)) = (new, scope_item(&effect["scope"])) {
        entry.insert("scope", value(scope));
    }
    Ok(total)
}

/// Writes an effect of the shop.
pub fn of_shop(document: &mut DocumentMut, effect: &Value) -> Result<(), ApplyError> {
    let id = effect["id"].as_str().unwrap_or_default().to_owned();
    let (scope, machines) = (scoped_json(&effect["scope"]), machines(document));
    let recorded = effect["recorded"].as_f64();
    let shop_effect = ShopEffect::from_word(&id);
    let held = shop_effect == Some(ShopEffect::FeedHold);
    let share = held.then_some(recorded).flatten();
    let recorded = recorded.filter(|_| shop_effect == Some(ShopEffect::FeedOverride));
    let entries = tables(document, "deviation")?;
    let same = |entry: &Table| {
        entry.get("id").and_then(Item::as_str) == Some(&id)
            && scoped_item(entry, &machines) == scope
            && entry.get("recorded").is_some() == recorded.is_some()
    };
    let position = entries.iter().position(same);
    let mut table = position.and_then(|index| entries.get(index)).cloned().unwrap_or_default();
    if held && share.is_none() && table.get("share").is_none() {
        let reason = "the diagnosis does not say in which share of the operations".to_owned();
        return Err(ApplyError::Effect { id, reason });
    }
    let total = fill(&mut table, effect, &serde_json::Map::new(), position.is_none())?;
    if let Some(share) = share {
        put(&mut table, "share", value(share.min(1.0)));
    }
    if let Some(recorded) = recorded {
        put(&mut table, "recorded", value(recorded));
    }
    match position {
        Some(index) if total.abs() <= NOTHING => drop(entries.remove(index)),
        Some(index) => {
            if let Some(entry) = entries.get_mut(index) {
                *entry = table;
            }
        }
        None => entries.push(table),
    }
    Ok(())
}
