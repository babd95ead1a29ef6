//! Where an entry acts: machines, tools, parts, operations and times, in a diagnosis and in a file.

use serde_json::Value;
use std::collections::BTreeMap;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike};
use toolroom_process::unit;

/// Scope of an entry as names and times, machines with a count taken apart.
pub type EntryScope = BTreeMap<String, Vec<String>>;

/// The scope of an entry of a diagnosis.
pub fn scoped_json(scope: &Value) -> EntryScope {
    let names = |own: &Value| match own {
        Value::String(text) => vec![time(text)],
        Value::Array(all) => all.iter().filter_map(|own| own.as_str().map(str::to_owned)).collect(),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Object(_) => Vec::new(),
    };
    scope.as_object().into_iter().flatten().map(|(key, own)| (key.clone(), names(own))).collect()
}

/// A time in seconds; another text as it is.
fn time(text: &str) -> String {
    unit::quantity(text, "s").map_or_else(|_| text.to_owned(), |seconds| format!("{seconds} s"))
}

/// The scope of an entry of a file.
pub fn scoped_item(entry: &dyn TableLike, machines: &[(String, Vec<String>)]) -> EntryScope {
    let texts = |item: &Item| match (item.as_str(), item.as_array()) {
        (Some(text), _) => vec![text.to_owned()],
        (None, Some(all)) => all.iter().filter_map(|own| own.as_str().map(str::to_owned)).collect(),
        (None, None) => Vec::new(),
    };
    let mut scope = EntryScope::new();
    for (key, item) in entry.get("scope").and_then(Item::as_table_like).into_iter().flat_map(TableLike::iter) {
        let mut names = texts(item);
        if key == "machine" {
            let known_machine = |name: &String| {
                let known = machines.iter().find(|(own, _)| own == name).map(|(_, all)| all.clone());
                known.unwrap_or_else(|| vec![name.clone()])
            };
            names = names.iter().flat_map(known_machine).collect();
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
pub fn machines(document: &DocumentMut) -> Vec<(String, Vec<String>)> {
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

/// A scope of a diagnosis as a file has it; none where it is everywhere.
pub fn scope_item(scope: &Value) -> Option<InlineTable> {
    let map = scope.as_object().filter(|map| !map.is_empty())?;
    let mut table = InlineTable::new();
    for (key, names) in map {
        let item = match names.as_array().map(Vec::as_slice) {
            Some([only]) => only.as_str().unwrap_or_default().into(),
            Some(all) => all.iter().filter_map(Value::as_str).collect::<Array>().into(),
            None => names.as_str().unwrap_or_default().into(),
        };
        table.insert(key, item);
    }
    Some(table)
}
