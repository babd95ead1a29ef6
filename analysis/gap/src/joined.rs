//! Records of two sets of one shop, of which the second is only predicted.

use crate::shop::{after, groups_of};
use crate::{NominalModel, NominalProcess};
use toolroom_records::{RecordKind, Records};

/// The records followed by `more`, and the groups (by the column `group`, if given) that only these have.
///
/// # Errors
/// Column and name of a group that both have.
pub fn joined(
    model: &NominalModel,
    records: &Records,
    mut more: Records,
    group: Option<&str>,
) -> Result<(Records, Vec<String>), (String, String)> {
    if let NominalProcess::Shop(shop) = &model.process {
        // The days of another log come after those of the first.
        more = after(shop, records, more);
        // Every log numbers its jobs and edges from the first: those of another one are others.
        for column in ["operation_id", "tool_id"] {
            let names = more.texts(column).map(|names| names.iter().map(|name| held_out(name)).collect());
            names.into_iter().for_each(|names| more.set_texts(column, names));
        }
        let [inside, outside] = [records, &more].map(|own| groups_of(shop, own, group));
        if let Some(name) = outside.iter().find(|name| inside.contains(*name)) {
            return Err((group.unwrap_or("day").to_owned(), name.clone()));
        }
        return Ok((records.followed_by(&more), outside.into_iter().collect()));
    }
    let program = model.kind() == RecordKind::Program;
    let column = group.unwrap_or(if program { "section" } else { "tool_id" });
    if program {
        // The same sections of the same programs ran on other pieces.
        let names = more.texts(column).map(|names| names.iter().map(|name| format!("{name}, held out")).collect());
        names.into_iter().for_each(|names| more.set_texts(column, names));
    }
    let outside = more.levels(column).map(|(names, _)| names).unwrap_or_default();
    let inside = records.levels(column).map(|(names, _)| names).unwrap_or_default();
    match outside.iter().find(|name| inside.contains(name)) {
        Some(name) => Err((column.to_owned(), name.clone())),
        None => Ok((records.followed_by(&more), outside)),
    }
}

/// The name of what another log calls `name`; nothing stays nothing.
fn held_out(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!("held out {name}") }
}
