//! Numbers and tables of a file that is edited.

use crate::error::ApplyError;
use serde_json::Value;
use toml_edit::{ArrayOfTables, DocumentMut, Item, TableLike, value};
use toolroom_process::unit;

/// A value of the diagnosis that cannot be read.
pub fn unreadable(what: &str) -> ApplyError {
    ApplyError::Value { what: what.to_owned() }
}

/// A number of the diagnosis.
pub fn number(value: &Value, what: &str) -> Result<f64, ApplyError> {
    value.as_f64().ok_or_else(|| unreadable(what))
}

/// A number of a file: bare where it is a ratio, else text with its unit. Rust prints as many digits as bring back
/// the same bits.
pub fn written(number: f64, unit: &str) -> Item {
    if unit == "1" { value(number) } else { value(format!("{number} {unit}")) }
}

/// A number of a file, in `unit`.
pub fn amount(unit: &'static str) -> impl Fn(&toml_edit::Value) -> f64 {
    move |own| match own {
        toml_edit::Value::Float(number) => *number.value(),
        toml_edit::Value::Integer(number) => *number.value() as f64,
        toml_edit::Value::String(text) => unit::quantity(text.value(), unit).unwrap_or(f64::NAN),
        toml_edit::Value::Boolean(_)
        | toml_edit::Value::Datetime(_)
        | toml_edit::Value::Array(_)
        | toml_edit::Value::InlineTable(_) => f64::NAN,
    }
}

/// Sets a value; what stands around it stays.
pub fn put(entry: &mut dyn TableLike, key: &str, item: Item) {
    let decor = entry.get(key).and_then(Item::as_value).map(|value| value.decor().clone());
    let mut item = item;
    if let (Some(decor), Some(value)) = (decor, item.as_value_mut()) {
        *value.decor_mut() = decor;
    }
    entry.insert(key, item);
}

/// The tables of a list, which is made where there is none.
pub fn tables<'a>(document: &'a mut DocumentMut, key: &str) -> Result<&'a mut ArrayOfTables, ApplyError> {
    if document.get(key).is_none() {
        document.insert(key, Item::ArrayOfTables(ArrayOfTables::new()));
    }
    document
        .get_mut(key)
        .and_then(Item::as_array_of_tables_mut)
        .ok_or_else(|| unreadable(&format!("`{key}` of the model, which is no [[{key}]],")))
}
