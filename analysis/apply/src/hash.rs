//! The hash of a model: of what it says, not of how it is written.

use crate::ApplyError;
use std::collections::BTreeMap;
use std::fmt::Write;
use toml_edit::{DocumentMut, Item, TableLike, Value};
use toolroom_shards::fingerprint;

/// What some editors begin a file with.
pub(crate) const BYTE_ORDER_MARK: char = '\u{feff}';

/// Hash of a model file with the values of `--set`: whitespace, comments, the order of keys and the mark of an
/// earlier `gap apply` do not count.
///
/// # Errors
/// [`ApplyError::Text`]: the file is no TOML.
///
/// ```
/// use toolroom_apply::model_hash;
/// let [a, b] = ["schema = 1\n[gap]\nforce = 0.1 # prior\n", "gap = { force = 0.1 }\nschema=1\n"];
/// assert_eq!(model_hash(a, &[]), model_hash(b, &[]));
/// assert_ne!(model_hash(a, &[]), model_hash(a, &["gap.force=0.2".to_owned()]));
/// ```
pub fn model_hash(text: &str, overrides: &[String]) -> Result<String, ApplyError> {
    let mut document = parsed(text)?;
    unmark(&mut document);
    let mut canonical = String::new();
    table(document.as_table(), &mut canonical);
    for own in overrides {
        let _ = write!(canonical, "\n{own}");
    }
    Ok(fingerprint(canonical.as_bytes()))
}

/// A model, whether or not it begins with a byte order mark.
pub(crate) fn parsed(text: &str) -> Result<DocumentMut, ApplyError> {
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    text.parse().map_err(|error: toml_edit::TomlError| ApplyError::Text { message: error.to_string() })
}

/// Takes the mark of an earlier `gap apply` away.
pub(crate) fn unmark(document: &mut DocumentMut) {
    if let Some(gap) = document.get_mut("gap").and_then(Item::as_table_like_mut) {
        gap.remove("applied");
    }
}

fn table(of: &dyn TableLike, text: &mut String) {
    let sorted: BTreeMap<&str, &Item> = of.iter().collect();
    text.push('{');
    for (key, own) in sorted {
        let _ = write!(text, "{key:?}=");
        item(own, text);
        text.push(',');
    }
    text.push('}');
}

fn item(of: &Item, text: &mut String) {
    match of {
        Item::None => {}
        Item::Value(own) => value(own, text),
        Item::Table(own) => table(own, text),
        Item::ArrayOfTables(all) => {
            text.push('[');
            for own in all {
                table(own, text);
                text.push(',');
            }
            text.push(']');
        }
    }
}

fn value(of: &Value, out: &mut String) {
    match of {
        Value::String(text) => {
            let _ = write!(out, "{:?}", text.value());
        }
        Value::Integer(number) => {
            let _ = write!(out, "{}", number.value());
        }
        Value::Float(number) => {
            let _ = write!(out, "{}", number.value());
        }
        Value::Boolean(flag) => {
            let _ = write!(out, "{}", flag.value());
        }
        Value::Datetime(time) => {
            let _ = write!(out, "{}", time.value());
        }
        Value::Array(all) => {
            out.push('[');
            for own in all {
                value(own, out);
                out.push(',');
            }
            out.push(']');
        }
        Value::InlineTable(own) => table(own, out),
    }
}
