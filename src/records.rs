//! Records as rows of a table of inputs.

use toolroom_chart::Table;
use toolroom_form::significant;
use toolroom_process::AnyRecord;

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
