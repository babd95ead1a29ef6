//! Diagnoses: JSON that `gap diagnose` writes and `gap apply` reads, held against their schema.

use crate::places::{key, refused};
use crate::{CheckResult, FileKind, KindError, SchemaSource, checked};
use serde_json::Value;
use std::path::Path;
use toolroom_form::Refusal;

const SCHEMA: &str = include_str!("../../../scenarios/schema/diagnosis.schema.json");

/// A finished diagnosis.
pub const KIND: FileKind = FileKind {
    word: "diagnosis",
    doc: "diagnosis.json of gap diagnose",
    signs: &["verdict"],
    read: Some(check),
    form: SchemaSource::Text(SCHEMA),
};

/// What `check` says of a diagnosis: whether it is one, and what it found.
fn check(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    if !set.is_empty() {
        return Err(KindError::Unchangeable { kind: "diagnosis" });
    }
    let text = toolroom_form::text(path)?;
    let value: Value = serde_json::from_str(&text).map_err(|error| {
        let place = (error.line().max(1), error.column().max(1));
        refused(path, &text, place, Refusal::new("diagnosis", error))
    })?;
    let schema: Value = serde_json::from_str(SCHEMA).expect("a schema of the repository is JSON");
    if let Some(fault) = fault(&value, &schema, &mut Vec::new()) {
        let last = fault.path.iter().rev().find(|step| !step.starts_with('['));
        let refusal = Refusal::new("diagnosis", format_args!("{}: {}", place(&fault.path), fault.message));
        return Err(refused(path, &text, last.map_or((1, 1), |step| key(&text, step)), refusal).into());
    }
    let effects = value["effects"].as_array().into_iter().flatten();
    let names: Vec<&str> = effects.filter_map(|effect| effect["id"].as_str()).collect();
    let named = if names.is_empty() { "no effect named".to_owned() } else { names.join(", ") };
    let verdict = value["verdict"].as_str().unwrap_or_default();
    Ok(checked("diagnosis", None, Vec::new(), &format!("a diagnosis with the verdict {verdict}, {named}")))
}

/// What is not as the schema says, and where: keys and `[index]`.
struct SchemaFault {
    path: Vec<String>,
    message: String,
}

/// The place of an entry as people write it, such as `effects[0].id`.
fn place(path: &[String]) -> String {
    let text = path.iter().fold(String::new(), |text, step| match step.starts_with('[') || text.is_empty() {
        true => text + step,
        false => text + "." + step,
    });
    if text.is_empty() { "the file".to_owned() } else { text }
}

/// The first entry of `value` that is not as `schema` says. Of JSON schemas it knows what that of a diagnosis uses: types,
/// `const`, `enum`, `required`, properties and items.
fn fault(value: &Value, schema: &Value, path: &mut Vec<String>) -> Option<SchemaFault> {
    let refuse = |path: &[String], message: String| Some(SchemaFault { path: path.to_vec(), message });
    let due = |wanted: &Value| {
        let words: Vec<&str> = match wanted {
            Value::String(word) => vec![word],
            Value::Array(words) => words.iter().filter_map(Value::as_str).collect(),
            Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => Vec::new(),
        };
        (!words.is_empty() && !words.iter().any(|word| is(value, word))).then(|| words.join(" or "))
    };
    if let Some(due) = due(&schema["type"]) {
        return refuse(path, format!("{} stands here; {due} is due", short(value)));
    }
    if let Some(constant) = schema.get("const").filter(|constant| *constant != value) {
        return refuse(path, format!("{} stands here; {constant} is due", short(value)));
    }
    if let Some(words) = schema["enum"].as_array().filter(|words| !words.contains(value)) {
        let words: Vec<&str> = words.iter().filter_map(Value::as_str).collect();
        return refuse(path, format!("{} stands here; one of {} is due", short(value), words.join(", ")));
    }
    let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
    if let Some(missing) =
        value.as_object().and_then(|object| required.into_iter().find(|key| !object.contains_key(*key)))
    {
        return refuse(path, format!("the key `{missing}` is missing"));
    }
    let mut inside = |step: String, value: &Value, schema: &Value| {
        path.push(step);
        let found = fault(value, schema, path);
        path.pop();
        found
    };
    for (key, entry) in value.as_object().into_iter().flatten() {
        let described = schema["properties"].get(key).or_else(|| schema.get("additionalProperties"));
        if let Some(found) = described.and_then(|described| inside(key.clone(), entry, described)) {
            return Some(found);
        }
    }
    let items = schema.get("items");
    let entries = value.as_array().into_iter().flatten().enumerate();
    entries.into_iter().find_map(|(index, entry)| items.and_then(|items| inside(format!("[{index}]"), entry, items)))
}

/// Whether a value is of a type of JSON schemas.
fn is(value: &Value, word: &str) -> bool {
    match word {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        // A word that this does not know would be met by every test of a diagnosis.
        _ => false,
    }
}

/// A value in a message: what it is, and what stands there where that is short.
fn short(value: &Value) -> String {
    match value {
        Value::Object(_) => "an object".to_owned(),
        Value::Array(list) => format!("a list of {}", list.len()),
        Value::String(text) if text.chars().count() > 40 => "a long text".to_owned(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The least value that a schema admits.
    fn least(schema: &Value) -> Value {
        if let Some(constant) = schema.get("const") {
            return constant.clone();
        }
        let word = schema["type"].get(0).unwrap_or(&schema["type"]).as_str();
        let required = || schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        match word {
            Some("object") => required().map(|key| (key.to_owned(), least(&schema["properties"][key]))).collect(),
            Some("array") => (0..schema["minItems"].as_u64().unwrap_or(0)).map(|_| least(&schema["items"])).collect(),
            Some("number" | "integer") => json!(0),
            Some("boolean") => json!(false),
            Some("null") => Value::Null,
            _ => schema["enum"].get(0).cloned().unwrap_or_else(|| json!("")),
        }
    }

    #[test]
    fn a_diagnosis_is_told_by_its_verdict_and_its_faults_have_a_place() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("diagnosis.json");
        let whole = least(&serde_json::from_str(SCHEMA).expect("JSON"));
        std::fs::write(&path, whole.to_string()).expect("written");
        let found = check(&path, &[]).expect("a diagnosis");
        assert_eq!(found.summary, "valid: a diagnosis with the verdict effect, no effect named");
        let said = |change: &dyn Fn(&mut Value)| {
            let mut value = whole.clone();
            change(&mut value);
            std::fs::write(&path, serde_json::to_string_pretty(&value).expect("JSON")).expect("written");
            assert_eq!(FileKind::from_path(&path).expect("a kind").word, "diagnosis");
            check(&path, &[]).expect_err("refused").to_string()
        };
        assert!(said(&|value| value["verdict"] = json!("gone")).contains("one of effect, constant"));
        assert!(said(&|value| value["schema"] = json!(1)).contains("schema: 1 stands here; 2 is due"));
        assert!(said(&|value| value["effects"] = json!([3])).contains("effects[0]: 3 stands here"));
        let gone = |value: &mut Value| drop(value.as_object_mut().expect("an object").remove("notes"));
        assert!(said(&gone).contains("the key `notes` is missing"));
    }
}
