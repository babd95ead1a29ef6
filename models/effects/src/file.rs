//! Effects as files list them: `effects = [{ id = "wear_force", size = 0.2 }]`.

use crate::{Effect, Effects};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::sync::Arc;
use toml::de::{DeValue, ValueDeserializer};
use toolroom_form::{Content, ContentFault, Fault, Section, Span, Walk, field};

/// A list of effects under a key of a file; `--set effects.ID=SIZE` sets one.
pub static EFFECT_LIST: Content = Content {
    expected: "a list of effects",
    example: EXAMPLE,
    schema: || json!({ "type": "array", "items": { "oneOf": Effect::all().map(effect).collect::<Vec<_>>() } }),
    entry: Some(["id", "size"]),
};

const EXAMPLE: &str = "[{ id = \"wear_force\", size = 0.2 }]";

/// The JSON schema of an effect with its size and shape.
fn effect(of: Effect) -> Value {
    let mut properties = Map::new();
    properties.insert("id".to_owned(), json!({ "const": of.entry().id, "description": of.entry().title }));
    properties.extend(of.parameters().fields().iter().map(|each| (each.name.to_owned(), field(each))));
    json!({ "type": "object", "additionalProperties": false, "properties": properties, "required": ["id", "size"] })
}

/// An effect that cannot act where the file lists it.
#[derive(Debug, thiserror::Error)]
#[error("{subject}{message}")]
struct EffectFault {
    /// The section that lists it, with a colon; empty at the top of a file.
    subject: String,
    /// What the catalogue says.
    message: String,
}

impl ContentFault for EffectFault {
    fn code(&self) -> &'static str {
        "effect"
    }
}

/// The effects that a section lists under `effects`; every one has to act on `process`, where it is known.
/// Without the key, and where a problem was noted, there are none.
pub fn read_effects(walk: &mut Walk, section: &Section<'_>, process: Option<&'static str>) -> Effects {
    let Some(got) = section.got("effects") else { return Effects::default() };
    let toolroom_form::Value::Raw(DeValue::Array(entries)) = &got.value else {
        if let toolroom_form::Value::Raw(other) = &got.value {
            walk.wrong_type("effects", other, EFFECT_LIST.expected, got.span.clone(), EXAMPLE.to_owned());
        }
        return Effects::default();
    };
    let subject = if section.path.is_empty() { String::new() } else { format!("{}: ", section.path) };
    let refuse = |walk: &mut Walk, span: Span, message: String| {
        walk.fault(span, Fault::Content(Arc::new(EffectFault { subject: subject.clone(), message })));
    };
    let mut effects = Vec::new();
    for entry in entries {
        match Effect::deserialize(ValueDeserializer::from(entry.clone())) {
            Ok(effect) => effects.push(effect),
            Err(error) => refuse(walk, entry.span(), error.message().to_owned()),
        }
    }
    let checked = Effects::new(effects).and_then(|effects| {
        process.map_or(Ok(()), |process| effects.check(process))?;
        Ok(effects)
    });
    checked.unwrap_or_else(|reason| {
        refuse(walk, got.span.clone(), reason.to_string());
        Effects::default()
    })
}
