//! A scenario with what a diagnosis has found: its text, of which everything else stays byte for byte.

use crate::document::size_unit;
use crate::error::ApplyError;
use crate::hash::model_hash;
use crate::program;
use serde_json::Value;
use std::collections::BTreeMap;
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike, value};
use toolroom_effects::Effect;
use toolroom_process::unit;
use toolroom_scenario::{Calibration, Deviation};

/// Total below which an effect is off.
const NOTHING: f64 = 1e-12;

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
    let bare = request.text.strip_prefix('\u{feff}');
    let text = bare.unwrap_or(request.text);
    let mut document: DocumentMut =
        text.parse().map_err(|error: toml_edit::TomlError| ApplyError::Text { message: error.to_string() })?;
    let list = |key: &str| diagnosis["applied"][key].as_array().into_iter().flatten().filter(mine).collect::<Vec<_>>();
    let wanted = |own: &&&Value| {
        let id = own["id"].as_str().unwrap_or_default();
        request.only.is_empty() || request.only.iter().any(|only| only == id)
    };
    let effects = list("effects");
    let effects: Vec<&Value> = effects.iter().filter(wanted).copied().collect();
    let constants = if request.calibration { list("calibration") } else { Vec::new() };
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
    if let Some(gap) = document.get_mut("gap").and_then(Item::as_table_like_mut) {
        gap.remove("applied");
    }
    let own = diagnosis["data"]["hash"].as_str().unwrap_or_default().to_owned();
    if !own.is_empty() && !data.contains(&own) {
        data.push(own);
    }
    let mut changes =
        Changes { text: String::new(), effects: Vec::new(), constants: Vec::new(), data, notes: Vec::new() };
    for effect in effects {
        let id = effect["id"].as_str().ok_or_else(|| unreadable("the id of an effect"))?;
        if process == "program" {
            program::switch_on(&mut document, effect)?;
        } else if Effect::named(id).is_ok() {
            of_tool(&mut document, effect)?;
        } else if Deviation::IDS.contains(&id) {
            of_shop(&mut document, effect)?;
        } else {
            let reason = "it is an effect of part programs or of records alone".to_owned();
            return Err(ApplyError::Effect { id: id.to_owned(), reason });
        }
        changes.effects.push(id.to_owned());
    }
    for own in constants {
        if process == "program" {
            program::calibrate(&mut document, own)?;
        } else {
            calibrate(&mut document, own, &by)?;
        }
        let text = |key: &str| own[key].as_str().unwrap_or_default();
        changes.constants.push(format!("{} of {}", text("parameter"), text("target")));
    }
    changes.text = format!("{}{document}", if bare.is_some() { "\u{feff}" } else { "" });
    Ok(changes)
}

pub(crate) fn unreadable(what: &str) -> ApplyError {
    ApplyError::Value { what: what.to_owned() }
}

/// A number of the diagnosis.
pub(crate) fn number(of: &Value, what: &str) -> Result<f64, ApplyError> {
    of.as_f64().ok_or_else(|| unreadable(what))
}

/// A number of a file: bare where it is a ratio, else text with its unit. Rust prints as many digits as bring back
/// the same bits.
pub(crate) fn written(number: f64, unit: &str) -> Item {
    if unit == "1" { value(number) } else { value(format!("{number} {unit}")) }
}

/// Scope of an entry as names and times, machines with a count taken apart.
type Scoped = BTreeMap<String, Vec<String>>;

fn scoped_json(scope: &Value) -> Scoped {
    let names = |own: &Value| match own {
        Value::String(text) => vec![time(text)],
        Value::Array(all) => all.iter().filter_map(|own| own.as_str().map(str::to_owned)).collect(),
        _ => Vec::new(),
    };
    scope.as_object().into_iter().flatten().map(|(key, own)| (key.clone(), names(own))).collect()
}

/// A time in seconds; another text as it is.
fn time(text: &str) -> String {
    unit::quantity(text, "s").map_or_else(|_| text.to_owned(), |seconds| format!("{seconds} s"))
}

fn scoped_item(entry: &dyn TableLike, machines: &[(String, Vec<String>)]) -> Scoped {
    let texts = |item: &Item| match item {
        Item::Value(toml_edit::Value::String(text)) => vec![text.value().clone()],
        Item::Value(toml_edit::Value::Array(all)) => {
            all.iter().filter_map(|own| own.as_str().map(str::to_owned)).collect()
        }
        _ => Vec::new(),
    };
    let mut scope = Scoped::new();
    for (key, item) in entry.get("scope").and_then(Item::as_table_like).into_iter().flat_map(TableLike::iter) {
        let mut names = texts(item);
        if key == "machine" {
            let each = |name: &String| {
                let known = machines.iter().find(|(own, _)| own == name).map(|(_, all)| all.clone());
                known.unwrap_or_else(|| vec![name.clone()])
            };
            names = names.iter().flat_map(each).collect();
        }
        if matches!(key, "from" | "until") {
            names = names.iter().map(|text| time(text)).collect();
        }
        scope.insert(key.to_owned(), names);
    }
    if let Some(shift) = entry.get("shift") {
        scope.insert("shift".to_owned(), texts(shift));
    }
    scope
}

/// Machines by the names under which a file knows them.
fn machines(document: &DocumentMut) -> Vec<(String, Vec<String>)> {
    let tables = document.get("machine").and_then(Item::as_array_of_tables);
    let one = |table: &Table| {
        let name = table.get("name")?.as_str()?.to_owned();
        let count = table.get("count").and_then(Item::as_integer);
        let all = match count {
            Some(count) => (1..=count).map(|i| format!("{name}{i}")).collect(),
            None => vec![name.clone()],
        };
        Some((name, all))
    };
    tables.into_iter().flatten().filter_map(one).collect()
}

fn scope_item(scope: &Value) -> Option<InlineTable> {
    let map = scope.as_object().filter(|map| !map.is_empty())?;
    let mut table = InlineTable::new();
    for (key, own) in map {
        match own {
            Value::Array(all) if all.len() != 1 => {
                let list: Array = all.iter().filter_map(Value::as_str).collect();
                table.insert(key, list.into());
            }
            Value::Array(all) => {
                table.insert(key, all[0].as_str().unwrap_or_default().into());
            }
            other => {
                table.insert(key, other.as_str().unwrap_or_default().into());
            }
        }
    }
    Some(table)
}

/// The effect that an entry of a file or diagnosis describes, at size zero.
fn effect_of(id: &str, shape: &serde_json::Map<String, Value>) -> Option<Effect> {
    let mut map = shape.clone();
    map.insert("id".to_owned(), id.into());
    let (unit, _) = size_unit(id);
    map.insert("size".to_owned(), if unit == "1" { 0.0.into() } else { format!("0 {unit}").into() });
    serde_json::from_value::<Effect>(Value::Object(map)).ok().map(|effect| effect.with_size(0.0))
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
            let read = match item {
                Item::Value(toml_edit::Value::String(text)) => Value::from(text.value().clone()),
                Item::Value(toml_edit::Value::Integer(number)) => Value::from(*number.value()),
                Item::Value(toml_edit::Value::Float(number)) => Value::from(*number.value()),
                _ => continue,
            };
            map.insert(key.to_owned(), read);
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

/// Sets a value; what stands around it stays.
pub(crate) fn put(entry: &mut dyn TableLike, key: &str, item: Item) {
    let decor = entry.get(key).and_then(Item::as_value).map(|value| value.decor().clone());
    let mut item = item;
    if let (Some(decor), Some(value)) = (decor, item.as_value_mut()) {
        *value.decor_mut() = decor;
    }
    entry.insert(key, item);
}

/// Writes an effect of the process of a tool.
fn of_tool(document: &mut DocumentMut, effect: &Value) -> Result<(), ApplyError> {
    let target = effect["target"].as_str().unwrap_or_default().to_owned();
    let name = target.strip_prefix("tool ").unwrap_or(&target).to_owned();
    let id = effect["id"].as_str().unwrap_or_default().to_owned();
    let shape = shape_of(effect);
    let wanted = effect_of(&id, &shape).ok_or_else(|| unreadable("the shape of an effect"))?;
    let mut scope = scoped_json(&effect["scope"]);
    scope.retain(|key, names| key != "tool" || !names.contains(&name));
    let machines = machines(document);
    let tools = document.get_mut("tool").and_then(Item::as_array_of_tables_mut);
    let named = |table: &&mut Table| table.get("name").and_then(Item::as_str) == Some(&name);
    let tool = tools.and_then(|tools| tools.iter_mut().find(named)).ok_or(ApplyError::Target { target })?;
    let same = |entry: &dyn TableLike| {
        let own = entry.get("id").and_then(Item::as_str) == Some(&id)
            && effect_of(&id, &shape_of_entry(entry)) == Some(wanted);
        let mut at = scoped_item(entry, &machines);
        at.retain(|key, names| key != "tool" || !names.contains(&name));
        own && at == scope
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
        for (key, own) in shape {
            match own {
                Value::String(text) => table.insert(key, text.as_str().into()),
                other => table.insert(key, other.as_f64().unwrap_or(f64::NAN).into()),
            };
        }
        entry.insert("shape", value(table));
    }
    if let (true, Some(scope)) = (new, scope_item(&effect["scope"])) {
        entry.insert("scope", value(scope));
    }
    Ok(total)
}

/// The tables of a list, which is made where there is none.
fn tables<'a>(document: &'a mut DocumentMut, key: &str) -> Result<&'a mut ArrayOfTables, ApplyError> {
    if document.get(key).is_none() {
        document.insert(key, Item::ArrayOfTables(ArrayOfTables::new()));
    }
    document
        .get_mut(key)
        .and_then(Item::as_array_of_tables_mut)
        .ok_or_else(|| unreadable(&format!("`{key}` of the model, which is no [[{key}]],")))
}

/// Writes an effect of the shop.
fn of_shop(document: &mut DocumentMut, effect: &Value) -> Result<(), ApplyError> {
    let id = effect["id"].as_str().unwrap_or_default().to_owned();
    let (scope, machines) = (scoped_json(&effect["scope"]), machines(document));
    let recorded = effect["recorded"].as_f64();
    let share = (id == "feed_hold").then_some(recorded).flatten();
    let recorded = recorded.filter(|_| id == "feed_override");
    if id == "feed_hold" && share.is_none() {
        let reason = "the diagnosis does not say in which share of the operations".to_owned();
        return Err(ApplyError::Effect { id, reason });
    }
    let entries = tables(document, "deviation")?;
    let same = |entry: &Table| {
        entry.get("id").and_then(Item::as_str) == Some(&id)
            && scoped_item(entry, &machines) == scope
            && entry.get("recorded").is_some() == recorded.is_some()
    };
    let found = entries.iter().position(same);
    let mut table = found.and_then(|index| entries.get(index)).cloned().unwrap_or_default();
    let total = fill(&mut table, effect, &serde_json::Map::new(), found.is_none())?;
    if let Some(share) = share {
        put(&mut table, "share", value(share.min(1.0)));
    }
    if let Some(recorded) = recorded {
        put(&mut table, "recorded", value(recorded));
    }
    match found {
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

/// Writes a constant that moved.
fn calibrate(document: &mut DocumentMut, own: &Value, by: &str) -> Result<(), ApplyError> {
    let text = |key: &str| own[key].as_str().map(str::to_owned).ok_or_else(|| unreadable("a calibration"));
    let (parameter, target) = (text("parameter")?, text("target")?);
    let (scope, machines) = (scoped_json(&own["scope"]), machines(document));
    let unit = Calibration::WORDS.iter().find(|(word, _)| *word == parameter).map_or("1", |(_, unit)| *unit);
    let summand = own["summand"].as_f64();
    let entries = tables(document, "calibration")?;
    let same = |entry: &Table| {
        let is = |key: &str, wanted: &str| entry.get(key).and_then(Item::as_str) == Some(wanted);
        is("parameter", &parameter)
            && is("target", &target)
            && entry.get("summand").is_some() == summand.is_some()
            && scoped_item(entry, &machines) == scope
    };
    let found = entries.iter().position(same);
    let mut table = found.and_then(|index| entries.get(index)).cloned().unwrap_or_default();
    if found.is_none() {
        table.insert("parameter", value(&parameter));
        table.insert("target", value(&target));
    }
    match summand {
        Some(added) => {
            let before = table.get("summand").and_then(Item::as_value).map(amount(unit)).unwrap_or(0.0);
            put(&mut table, "summand", written(before + added, unit));
        }
        None => {
            let factor = number(&own["factor"], "a factor")?;
            let before = table.get("factor").and_then(Item::as_value).map(amount("1")).unwrap_or(1.0);
            put(&mut table, "factor", value(before * factor));
        }
    }
    let unit = if summand.is_some() { unit } else { "1" };
    if let Some(error) = own["se"].as_f64() {
        put(&mut table, "standard_error", written(error, unit));
    }
    if table.get("prior").is_none()
        && let Some(prior) = own["prior"].as_f64()
    {
        table.insert("prior", written(prior, unit));
    }
    if let (None, Some(scope)) = (found, scope_item(&own["scope"])) {
        table.insert("scope", value(scope));
    }
    put(&mut table, "by", value(by));
    match found.and_then(|index| entries.get_mut(index)) {
        Some(entry) => *entry = table,
        None => entries.push(table),
    }
    Ok(())
}

/// A number of a file, in `unit`.
pub(crate) fn amount(unit: &'static str) -> impl Fn(&toml_edit::Value) -> f64 {
    move |own| match own {
        toml_edit::Value::Float(number) => *number.value(),
        toml_edit::Value::Integer(number) => *number.value() as f64,
        toml_edit::Value::String(text) => unit::quantity(text.value(), unit).unwrap_or(f64::NAN),
        _ => f64::NAN,
    }
}
