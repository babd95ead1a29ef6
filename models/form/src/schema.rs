//! The JSON schema (draft 2020-12) of files, made from the same tables as the reader.

use crate::form::{Form, Key, Kind, Need};
use serde_json::{Map, Value, json};
use toolroom_process::{Field, unit};

/// JSON schema of a kind of file, called `title` in editors.
///
/// ```
/// use toolroom_form::{Form, Key, Kind, schema};
/// static MODE: Form = Form { title: "[[mode]]", doc: "A mode", keys: &[Key::required("name", Kind::Name, "Name")] };
/// static FILE: Form = Form { title: "the file", doc: "Modes", keys: &[Key::optional("mode", Kind::Tables(&MODE), "Modes")] };
/// let schema = schema(&FILE, "toolroom modes");
/// assert_eq!(schema["properties"]["mode"]["items"]["additionalProperties"], false);
/// ```
pub fn schema(described: &'static Form, title: &str) -> Value {
    let Value::Object(body) = form(described) else { return Value::Null };
    let mut root = Map::new();
    root.insert("$schema".to_owned(), json!("https://json-schema.org/draft/2020-12/schema"));
    root.insert("title".to_owned(), json!(title));
    root.extend(body);
    if let Some(version) = root.get_mut("properties").and_then(|properties| properties.get_mut("schema")) {
        *version = json!({ "const": 1, "description": "Version of the format" });
    }
    Value::Object(root)
}

fn form(form: &'static Form) -> Value {
    let mut properties: Map<String, Value> = Map::new();
    for key in form.keys {
        let body = property(key);
        match properties.get_mut(key.name) {
            // The same key in another case.
            Some(first) => {
                let docs = [&*first, &body].map(|body| body["description"].as_str().unwrap_or_default().to_owned());
                first["description"] = json!(docs.join(". "));
            }
            None => drop(properties.insert(key.name.to_owned(), body)),
        }
    }
    let always = |key: &&Key| matches!(key.need, Need::Required) && key.when.is_none();
    let required: Vec<&str> = form.keys.iter().filter(always).map(|key| key.name).collect();
    let mut body = json!({
        "type": "object",
        "description": form.doc,
        "additionalProperties": false,
        "properties": properties,
    });
    if !required.is_empty() {
        body["required"] = json!(required);
    }
    let cases: Vec<Value> = form
        .keys
        .iter()
        .filter(|key| matches!(key.need, Need::Required))
        // A condition on something outside the section is the reader's to check.
        .filter_map(|key| Some((key, key.when.filter(|when| form.key(when.key).is_some())?)))
        .map(|(key, when)| {
            json!({
                "if": { "properties": { when.key: { "enum": when.values } }, "required": [when.key] },
                "then": { "required": [key.name] },
            })
        })
        .collect();
    if !cases.is_empty() {
        body["allOf"] = json!(cases);
    }
    body
}

fn property(key: &'static Key) -> Value {
    let mut body = kind(&key.kind);
    let mut doc = match body["description"].as_str() {
        Some(detail) => format!("{}. {detail}", key.doc.trim().trim_end_matches('.')),
        None => key.doc.trim().to_owned(),
    };
    if let Some(when) = key.when {
        doc.push_str(&format!(". Where {} is {}", when.key, when.values.join(" or ")));
    }
    body["description"] = json!(doc);
    if let Need::Default(text) = key.need {
        body["default"] = match key.kind {
            Kind::Count { .. } | Kind::Flag => serde_json::from_str(text).unwrap_or(json!(text)),
            Kind::Name
            | Kind::Text
            | Kind::Quantity(_)
            | Kind::Or { .. }
            | Kind::Dated(_)
            | Kind::Choice(_)
            | Kind::Reference(_)
            | Kind::List(_)
            | Kind::Table(_)
            | Kind::Tables(_)
            | Kind::Shorthand { .. }
            | Kind::Fields { .. }
            | Kind::Parameters
            | Kind::Texts
            | Kind::Content(_)
            | Kind::Amount => json!(text),
        };
    }
    body
}

/// The beginning of a date.
const DATE: &str = "^[0-9]{4}-[0-9]{2}-[0-9]{2}";

fn kind(value: &'static Kind) -> Value {
    match value {
        Kind::Name => json!({ "type": "string", "minLength": 1, "maxLength": 100 }),
        Kind::Text | Kind::Reference(_) => json!({ "type": "string" }),
        Kind::Quantity(quantity) => {
            let mut body = number(quantity.unit, quantity.min, quantity.max);
            if !quantity.example.is_empty() {
                body["examples"] = json!([quantity.example]);
            }
            body
        }
        Kind::Count { min, max } => {
            let mut body = json!({ "type": "integer", "minimum": min });
            if *max != u64::MAX {
                body["maximum"] = json!(max);
            }
            body
        }
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Choice(choices) => json!({ "enum": choices }),
        Kind::Or { words, other } => json!({ "anyOf": [{ "enum": words }, kind(other)] }),
        Kind::Dated(other) => json!({ "anyOf": [kind(other), { "type": "string", "pattern": DATE }] }),
        Kind::List(item) => {
            let item = kind(item);
            json!({ "anyOf": [{ "type": "array", "items": item.clone() }, item] })
        }
        Kind::Table(table) => form(table),
        Kind::Tables(table) => json!({ "type": "array", "items": form(table) }),
        Kind::Shorthand { word, form: table } => json!({ "anyOf": [kind(word), form(table)] }),
        Kind::Fields { word, fields } => {
            let properties: Map<String, Value> =
                fields.iter().map(|each| (each.name.to_owned(), field(each))).collect();
            let table = json!({ "type": "object", "additionalProperties": false, "properties": properties });
            json!({ "anyOf": [kind(word), table] })
        }
        Kind::Parameters => json!({
            "type": "object",
            "additionalProperties": { "type": "object", "additionalProperties": { "type": ["number", "string"] } },
        }),
        Kind::Texts => json!({
            "type": "object",
            "additionalProperties": { "type": ["boolean", "number", "string"] },
        }),
        Kind::Content(content) => (content.schema)(),
        Kind::Amount => json!({ "type": ["number", "string"] }),
    }
}

/// JSON schema of a field of a record.
pub fn field(quantity: &Field) -> Value {
    let mut body = number(quantity.unit, quantity.min, quantity.max);
    let detail = body["description"].as_str().map_or(String::new(), |detail| format!(" {detail}"));
    body["description"] = json!(format!("{}{detail}", quantity.doc.trim()));
    body
}

/// A ratio between bounds, or text that begins with a number.
fn number(si: &str, min: f64, max: f64) -> Value {
    let text = json!({ "type": "string", "pattern": r"^\s*[+-]?[0-9.]" });
    if si == "1" {
        return json!({ "anyOf": [{ "type": "number", "minimum": min, "maximum": max }, text] });
    }
    let mut text = text;
    text["description"] = json!(format!("A number with its unit ({})", unit::accepted(si)));
    text
}
