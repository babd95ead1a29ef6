//! Records as rows of a table of inputs; cells of a table of results.

use toolroom_chart::Table;
use toolroom_process::AnyRecord;
use toolroom_scenario::file::significant;

/// A table of inputs without rows yet.
pub fn input_table() -> Table {
    Table::new(["group", "key", "value"])
}

/// Adds every field of a record in the units that people read.
pub fn push_record(table: &mut Table, group: &str, record: &dyn AnyRecord) {
    for (i, field) in record.fields().iter().enumerate() {
        let value = significant(field.to_display(record.value(i).unwrap_or(f64::NAN)));
        let text = if field.display == "1" { value } else { format!("{value} {}", field.display) };
        table.push([group.into(), field.name.into(), text.into()]);
    }
}

/// A text as a cell of a CSV file.
pub fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
