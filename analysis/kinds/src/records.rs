//! Tables of measured records: CSV files, and folders of them.

use crate::places::refused;
use crate::{CheckResult, FileKind, KindError, SchemaSource, checked};
use serde_json::{Map, Value, json};
use std::path::Path;
use toolroom_form::{ReadError, Refusal};
use toolroom_records::{ColumnKind, RecordError, RecordKind, cells, has_table, read, tables};

/// Tables that gap diagnose, calibrate and their like take as `--data`.
pub const KIND: FileKind = FileKind {
    word: "records",
    doc: "Measured records (operations.csv, cuts.csv, trials.csv, events.csv, orders.csv, stretches.csv), or a folder of them",
    signs: &[],
    read: Some(check),
    form: SchemaSource::Rows(schema),
};

/// Kinds by what a table has to have, the most particular first.
const RECORDS: [RecordKind; 6] = [
    RecordKind::Shop,
    RecordKind::Orders,
    RecordKind::Program,
    RecordKind::Grinding,
    RecordKind::Milling,
    RecordKind::Turning,
];

/// Whether a path is that of records whatever it holds: a folder, or a table in Parquet.
pub fn by_place(path: &Path) -> bool {
    (path.is_dir() && !tables(path).is_empty()) || is_parquet(path)
}

fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

/// Whether the first line of a text is the header of a kind of records.
pub fn by_header(text: &str) -> bool {
    kind_of(text).is_some()
}

/// The kind of records of which all required columns stand in the first line.
fn kind_of(text: &str) -> Option<RecordKind> {
    let line = text.lines().next()?;
    let table = cells("", format!("{line}\n").as_bytes()).ok()?;
    // A header is a name, and its unit in brackets.
    let name = |title: &String| {
        title.split(['[', '(']).next().unwrap_or_default().trim().to_ascii_lowercase().replace([' ', '-'], "_")
    };
    let names: Vec<String> = table.header.iter().map(name).collect();
    let complete = |kind: &RecordKind| {
        let mut required = kind.columns().iter().filter(|column| column.required).peekable();
        required.peek().is_some() && required.all(|column| names.iter().any(|name| name == column.name))
    };
    RECORDS.into_iter().find(complete)
}

/// What `check` says of records: rows and columns that are used, and what is left out, as the verbs that take them report it.
fn check(path: &Path, set: &[String]) -> Result<CheckResult, KindError> {
    if !set.is_empty() {
        return Err(KindError::Unchangeable { kind: "table of records" });
    }
    let refuse = |error: &RecordError| {
        let text = if path.is_dir() { String::new() } else { toolroom_form::text(path).unwrap_or_default() };
        let line = if let RecordError::Quote { fault, .. } = error { fault.line() } else { 1 };
        refused(path, &text, (line, 1), Refusal::new("records", error))
    };
    let no_parquet = |path: &Path| -> Result<_, RecordError> {
        let source = "check reads CSV; the verbs that take records read Parquet, too".into();
        Err(RecordError::Table { path: path.to_owned(), source })
    };
    let kinds = if path.is_dir() {
        let orders = Some(RecordKind::Orders).filter(|kind| has_table(path, *kind));
        tables(path).into_iter().chain(orders).collect()
    } else {
        vec![kind(path)?]
    };
    let (mut lines, mut reports) = (Vec::new(), Vec::new());
    for kind in kinds {
        let (_, report) = match read(path, kind, &no_parquet) {
            // A planner's table of orders has the same name.
            Err(error @ RecordError::MissingColumn { .. }) if path.is_dir() && kind == RecordKind::Orders => {
                lines.push(format!("{error}: it is no table of jobs that came, and is passed over"));
                continue;
            }
            read => read.map_err(|error| refuse(&error))?,
        };
        lines.push(report.to_string().trim_end().to_owned());
        reports.push(report.json());
    }
    let mut found = checked("records", None, Vec::new(), &lines.join("\n"));
    found.result.insert("tables".to_owned(), json!(reports));
    Ok(found)
}

/// The kind of a file that is said to be records; turning where it cannot be told, whose reader then names what is missing.
fn kind(path: &Path) -> Result<RecordKind, ReadError> {
    if is_parquet(path) {
        return Ok(RecordKind::Turning);
    }
    Ok(kind_of(&toolroom_form::text(path)?).unwrap_or(RecordKind::Turning))
}

/// The columns of a row, as a schema for each kind.
fn schema() -> Value {
    let of_kind = |kind: RecordKind| {
        let column = |column: &toolroom_records::RecordColumn| {
            let text = column.kind == ColumnKind::Text;
            let mut described = Map::new();
            described.insert("type".to_owned(), json!(if text { "string" } else { "number" }));
            if !text && column.display != "1" {
                described.insert("description".to_owned(), json!(format!("in {}", column.display)));
            }
            (column.header(), Value::Object(described))
        };
        let columns: Map<String, Value> = kind.columns().iter().map(column).collect();
        let required: Vec<String> =
            kind.columns().iter().filter(|column| column.required).map(|column| column.header()).collect();
        json!({ "title": format!("{}.csv", kind.file_stem()), "type": "object", "properties": columns, "required": required })
    };
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "toolroom records",
        "description": "One row of a table of measured records, by its headers; other units of the same quantity are read too",
        "anyOf": RECORDS.map(of_kind),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TURNED: &str = "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],\
        cutting_time [min]\n1,L1,T1,1,180,0.3,1.5,2\n";

    #[test]
    fn records_are_told_by_their_header_and_read_as_their_verbs_read_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("operations.csv");
        std::fs::write(&path, TURNED).expect("written");
        for place in [path.as_path(), folder.path()] {
            let kind = FileKind::from_path(place).expect("a kind");
            assert_eq!(kind.word, "records");
            let found = (kind.read.expect("a reader"))(place, &[]).expect("records");
            assert!(found.summary.contains("1 rows, columns operation_id"), "{}", found.summary);
            assert_eq!(found.result["tables"][0]["rows"], 1);
        }
        std::fs::write(&path, TURNED.replace("[m/min]", "[kg]")).expect("written");
        let refused = check(&path, &[]).expect_err("a unit").to_string();
        assert!(refused.contains("column `cutting_speed` has the unit `kg`"), "{refused}");
    }

    #[test]
    fn the_schema_has_the_columns_of_every_kind() {
        let schema = schema();
        let kinds = schema["anyOf"].as_array().expect("kinds");
        assert_eq!(kinds.len(), RECORDS.len());
        assert!(schema.to_string().contains("cutting_speed [m/min]"));
    }
}
