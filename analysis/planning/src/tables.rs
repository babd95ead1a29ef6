//! Tables of results as CSV, and records as rows of a table of inputs.

use toolroom_chart::Table;
use toolroom_form::significant;
use toolroom_process::AnyRecord;
use toolroom_process::table::{Cell, csv_text};

/// A table as CSV; every row is as long as the header.
pub(crate) fn table<'a, R: IntoIterator<Item = Cell<'a>>>(
    header: impl IntoIterator<Item = impl AsRef<str>>,
    rows: impl IntoIterator<Item = R>,
) -> String {
    csv_text(header, rows).expect("every row is as long as the header")
}

/// A table of inputs without rows yet.
pub(crate) fn input_table() -> Table {
    Table::new(["group", "key", "value"])
}

/// Adds every field of a record in the units that people read.
pub(crate) fn push_record(table: &mut Table, group: &str, record: &dyn AnyRecord) {
    for (i, field) in record.fields().iter().enumerate() {
        let value = significant(field.to_display(record.value(i).unwrap_or(f64::NAN)));
        let text = if field.display == "1" { value } else { format!("{value} {}", field.display) };
        table.push([group.into(), field.name.into(), text.into()]);
    }
}
