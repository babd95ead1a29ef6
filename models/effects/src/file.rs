//! Effects as files list them: `effects = [{ id = "wear_force", size = 0.2 }]`.

use crate::effect::Written;
use crate::{Definition, Effect, Effects};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeValue, ValueDeserializer};
use toolroom_form::{Content, ContentFault, Fault, Section, Span, Value as FormValue, Walk, field};

/// A list of effects under a key of a file; `--set effects.ID=SIZE` sets one.
pub static EFFECT_LIST: Content = Content {
    expected: "a list of effects",
    example: EXAMPLE,
    schema: || json!({ "type": "array", "items": { "oneOf": Effect::all().map(effect).collect::<Vec<_>>() } }),
    entry: Some(["id", "size"]),
};

const EXAMPLE: &str = "[{ id = \"wear_force\", size = 0.2 }]";

/// The JSON schema of an effect with its size and shape.
fn effect(kind: Effect) -> Value {
    let mut properties = Map::new();
    properties.insert("id".to_owned(), json!({ "const": kind.entry().id, "description": kind.entry().title }));
    properties.extend(kind.parameters().fields().iter().map(|each| (each.name.to_owned(), field(each))));
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

/// A list of effects in a file, while it is read.
#[derive(Debug)]
pub struct EffectList<'a> {
    /// The entries as the file has them.
    pub entries: Vec<Spanned<DeValue<'a>>>,
    /// Place of the list.
    pub span: Span,
    /// The section that holds it, with a colon; empty at the top of a file.
    subject: String,
}

impl<'a> EffectList<'a> {
    /// The list under `effects` of a section; `None` without the key, and where a value of another type was refused.
    pub fn from_walk(walk: &mut Walk, section: &Section<'a>) -> Option<Self> {
        let got = section.got("effects")?;
        let subject = if section.path.is_empty() { String::new() } else { format!("{}: ", section.path) };
        match &got.value {
            FormValue::Raw(DeValue::Array(entries)) => {
                Some(Self { entries: entries.iter().cloned().collect(), span: got.span.clone(), subject })
            }
            FormValue::Raw(other) => {
                walk.wrong_type("effects", other, EFFECT_LIST.expected, got.span.clone(), EXAMPLE.to_owned());
                None
            }
            FormValue::Si(_)
            | FormValue::Count(_)
            | FormValue::Text(_)
            | FormValue::Flag(_)
            | FormValue::List(_)
            | FormValue::Faulty => None,
        }
    }

    /// The effect of an entry, without keys of the caller's own, out of the catalogue or of those that a user has
    /// defined; a fault where there is none or it does not take the values.
    pub fn read(
        &self,
        walk: &mut Walk,
        entry: Spanned<DeValue<'_>>,
        defined: &[&'static Definition],
    ) -> Option<Effect> {
        let span = entry.span();
        let read = Written::deserialize(ValueDeserializer::from(entry)).map_err(|error| error.message().to_owned());
        let effect = read.and_then(|written| written.effect(defined).map_err(|error| error.to_string()));
        effect.map_err(|message| self.refuse(walk, span, message)).ok()
    }

    /// Notes what is wrong at a place of the list.
    pub fn refuse(&self, walk: &mut Walk, span: Span, message: String) {
        walk.fault(span, Fault::Content(Arc::new(EffectFault { subject: self.subject.clone(), message })));
    }
}

/// The effects that a section lists under `effects`; every one has to act on `process`, where it is known.
/// Without the key, and where a problem was noted, there are none.
pub fn read_effects(walk: &mut Walk, section: &Section<'_>, process: Option<&'static str>) -> Effects {
    let Some(list) = EffectList::from_walk(walk, section) else { return Effects::default() };
    let effects = list.entries.iter().filter_map(|entry| list.read(walk, entry.clone(), &[])).collect();
    let checked = Effects::new(effects).and_then(|effects| {
        process.map_or(Ok(()), |process| effects.check(process))?;
        Ok(effects)
    });
    checked.unwrap_or_else(|reason| {
        list.refuse(walk, list.span.clone(), reason.to_string());
        Effects::default()
    })
}
