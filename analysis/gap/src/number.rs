//! Numbers in documents.

use serde_json::{Value, json};

/// A number as JSON has it; null where it is none.
pub(super) fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}
