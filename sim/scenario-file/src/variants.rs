//! Variants of a shop: named changes of its file.

use super::calendars::moment;
use super::fault::ScenarioFault;
use super::names::named;
use toml::de::DeValue;
use toolroom_form::{Section, Value, Walk};

/// A shop with some values changed.
#[derive(Clone, Debug, PartialEq)]
pub struct ShopVariant {
    /// Name, unique.
    pub name: String,
    /// Changes of the file, `path=value` as after `--set`.
    pub set: Vec<String>,
    /// From when on it is changed, s; `None`: from the start.
    pub from: Option<f64>,
}

/// Name of the shop as it is, among its variants.
pub const AS_IT_IS: &str = "as it is";

/// Values by which runs are paired: no variant has its own.
const NUMBERS: [&str; 2] = ["shop.seed", "shop.replications"];

/// The sections `[[variant]]`.
pub(super) fn variants(walk: &mut Walk, root: &Section<'_>, (start, horizon): (Option<f64>, f64)) -> Vec<ShopVariant> {
    let mut variants = Vec::new();
    for (name, section) in named(walk, root, "variant", None) {
        if name == AS_IT_IS {
            let reason = format!("\"{AS_IT_IS}\" is the name of the shop without changes");
            let fix = "call the variant by what it changes".to_owned();
            walk.fault(section.span_of("name"), ScenarioFault::Arrangement { reason, fix });
        }
        let mut set = Vec::new();
        if let Some(Value::Raw(value)) = section.got("set").map(|got| &got.value) {
            if let DeValue::Table(table) = value {
                let change = |(path, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'_>>)| {
                    let path: &std::borrow::Cow<'_, str> = path.get_ref();
                    format!("{path}={}", literal(value.get_ref()))
                };
                set.extend(table.iter().map(change));
                let numbers = |path: &str| NUMBERS.contains(&path.trim());
                if let Some((path, _)) = table.iter().find(|(path, _)| numbers(path.get_ref())) {
                    let reason = format!("variant \"{name}\" changes `{}`, which all variants share", path.get_ref());
                    let fix = "variants run as often on the same random numbers: change it in [shop]".to_owned();
                    walk.fault(path.span(), ScenarioFault::Arrangement { reason, fix });
                }
            } else {
                let example = "{ \"machine.CMM.count\" = 3 }".to_owned();
                walk.wrong_type("set", value, "a table of paths and values", section.span_of("set"), example);
            }
        }
        let from = moment(walk, &section, "from", start);
        if from.is_some_and(|from| !(0.0..horizon).contains(&from)) {
            let reason = format!("variant \"{name}\" is changed before the start or after the horizon");
            let fix = "give a time in the run; left out, it is changed from the start".to_owned();
            walk.fault(section.span_of("from"), ScenarioFault::Arrangement { reason, fix });
        }
        variants.push(ShopVariant { name, set, from });
    }
    variants
}

/// A value as it is written in a file.
pub fn literal(value: &DeValue<'_>) -> String {
    let joined = |parts: Vec<String>| parts.join(", ");
    match value {
        DeValue::String(text) => toml::Value::String(text.to_string()).to_string(),
        DeValue::Integer(number) => number.as_str().to_owned(),
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(time) => format!("\"{time}\""),
        DeValue::Array(list) => {
            format!("[{}]", joined(list.iter().map(|entry| literal(entry.get_ref())).collect()))
        }
        DeValue::Table(table) => {
            let entry = |(key, value): (&toml::Spanned<_>, &toml::Spanned<DeValue<'_>>)| {
                let key: &std::borrow::Cow<'_, str> = key.get_ref();
                format!("{} = {}", toml::Value::String(key.to_string()), literal(value.get_ref()))
            };
            format!("{{ {} }}", joined(table.iter().map(entry).collect()))
        }
    }
}
