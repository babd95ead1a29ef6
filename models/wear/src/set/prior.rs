//! The section `[prior]` of a set or of a file of its own: how well values are known.

use super::fault::SetFault;
use super::{Catalogue, Spread};
use std::collections::BTreeMap;
use std::path::Path;
use toml::de::DeValue;
use toolroom_form::{Fault, Form, Key, Kind, ReadError, Section, Value, Walk, nearest};

/// Name of the scatter of edges, which `[prior]` may state although it is no parameter of a group.
pub const EDGE_SCATTER_NAME: &str = "edge_scatter";
/// Name of the noise of wear readings, which `[prior]` may state although it is no parameter of a group.
pub const READING_NOISE_NAME: &str = "reading_noise";

/// A file that holds nothing but `[prior]`.
static PRIORS: Form = Form {
    title: "the priors",
    doc: "How well parameters are known before a calibration",
    keys: &[
        Key::default("schema", Kind::Count { min: 1, max: u64::MAX }, "1", "Version of the format, 1"),
        Key::required("prior", Kind::Content(&super::form::PRIOR), "How well values are known, by group.name"),
    ],
};

/// Spreads by `group.name` of a file with nothing but `[prior]`.
///
/// # Errors
/// Every fault of the file, with its place.
pub fn read_priors(path: &Path, catalogue: &'static Catalogue) -> Result<BTreeMap<String, Spread>, ReadError> {
    let resolve = |walk: &mut Walk, root: &Section<'_>| Some(priors(walk, root, catalogue));
    toolroom_form::read(path, &[], &PRIORS, resolve).map(|file| file.content)
}

/// The section `[prior]`: spreads by `group.name`.
pub(super) fn priors(walk: &mut Walk, root: &Section<'_>, catalogue: &'static Catalogue) -> BTreeMap<String, Spread> {
    let mut priors = BTreeMap::new();
    let Some(Value::Raw(raw)) = root.got("prior").map(|got| &got.value) else { return priors };
    let example = "[prior]";
    let DeValue::Table(table) = raw else {
        walk.wrong_type("prior", raw, "a table", root.span_of("prior"), example.to_owned());
        return priors;
    };
    for (name, entry) in table {
        let key = name.get_ref().to_string();
        let known = key.split_once('.').and_then(|(group, name)| catalogue.field(group, name));
        if known.is_none() && ![EDGE_SCATTER_NAME, READING_NOISE_NAME].contains(&key.as_str()) {
            let every = catalogue
                .groups
                .iter()
                .flat_map(|group| group.fields.iter().map(|field| format!("{}.{}", group.name, field.name)));
            let every: Vec<String> = every.collect();
            let fault = Fault::UnknownName {
                kind: "parameter",
                nearest: nearest(&key, every.iter().map(String::as_str)).map(str::to_owned),
                name: key,
                known: "group.name of every parameter of the set".to_owned(),
            };
            walk.fault(name.span(), fault);
            continue;
        }
        let mut refuse = |reason| walk.fault(entry.span(), SetFault::Prior { key: key.clone(), reason });
        let number = |value: &DeValue<'_>| match value {
            DeValue::Float(number) => number.as_str().replace('_', "").parse::<f64>().ok(),
            DeValue::Integer(number) => number.as_str().replace('_', "").parse::<f64>().ok(),
            DeValue::String(_) | DeValue::Boolean(_) | DeValue::Datetime(_) | DeValue::Array(_) | DeValue::Table(_) => {
                None
            }
        };
        let one = match entry.get_ref() {
            DeValue::Table(table) if table.len() == 1 => table.iter().next(),
            DeValue::String(_)
            | DeValue::Integer(_)
            | DeValue::Float(_)
            | DeValue::Boolean(_)
            | DeValue::Datetime(_)
            | DeValue::Array(_)
            | DeValue::Table(_) => None,
        };
        let spread = one.map(|(word, value)| (word.get_ref().to_string(), number(value.get_ref())));
        match spread.as_ref().map(|(word, value)| (word.as_str(), *value)) {
            Some(("factor", Some(factor))) if factor > 1.0 && factor.is_finite() => {
                priors.insert(key, Spread::Factor(factor));
            }
            Some(("deviation", Some(deviation))) if deviation > 0.0 && deviation.is_finite() => {
                priors.insert(key, Spread::Deviation(deviation));
            }
            Some(("factor", _)) => refuse("a factor is a number above 1"),
            Some(("deviation", _)) => refuse("a deviation is a number above 0"),
            _ => refuse("a table with `factor` or `deviation` is due"),
        }
    }
    priors
}
