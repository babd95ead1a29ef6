//! Tables whose keys, units and ranges are those of a record.

use crate::fault::{Fault, nearest};
use crate::form::Quantity;
use crate::section::{Section, Value};
use crate::walk::{Echo, Walk};
use crate::words::display;
use toml::de::{DeTable, DeValue};
use toolroom_process::AnyRecord;

/// The key `parameters` of a section, `parameters = { group = { name = "1.5 mm" } }`, into the
/// groups of a process.
pub fn set_parameters(walk: &mut Walk, tool: &Section<'_>, mut groups: Vec<(&'static str, &mut dyn AnyRecord)>) {
    let Some(Value::Raw(raw)) = tool.got("parameters").map(|got| &got.value) else { return };
    let span = tool.span_of("parameters");
    let example = "{ limits = { wear_limit = \"0.5 mm\" } }";
    let DeValue::Table(table) = raw else {
        walk.wrong_type("parameters", raw, "a table of groups", span, example.to_owned());
        return;
    };
    for (group, values) in table {
        let Some((_, record)) = groups.iter_mut().find(|(name, _)| *name == &**group.get_ref()) else {
            let fault = Fault::UnknownKey {
                section: format!("parameter set of {}", tool.path),
                key: group.get_ref().to_string(),
                nearest: nearest(group.get_ref(), groups.iter().map(|(name, _)| *name)),
                known: groups.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
            };
            walk.fault(group.span(), fault);
            continue;
        };
        let DeValue::Table(table) = values.get_ref() else {
            let expected = "a table of parameters";
            walk.wrong_type(group.get_ref(), values.get_ref(), expected, values.span(), example.to_owned());
            continue;
        };
        set_record(walk, &format!("{}, {}", tool.path, group.get_ref()), table, *record);
    }
}

/// Sets the fields of `record` that a section of [`record_keys`](crate::record_keys) gives.
pub fn fill_record(section: &Section<'_>, record: &mut dyn AnyRecord) {
    for (i, field) in record.fields().iter().enumerate() {
        if let Some(value) = section.si(field.name) {
            record.set_value(i, value);
        }
    }
}

/// Sets the values that `table` holds, each read in the unit of its field.
pub fn set_record(walk: &mut Walk, title: &str, table: &DeTable<'_>, record: &mut dyn AnyRecord) {
    let fields = record.fields();
    for (key, raw) in table {
        let Some(i) = fields.iter().position(|field| field.name == key.get_ref()) else {
            let fault = Fault::UnknownKey {
                section: title.to_owned(),
                key: key.get_ref().to_string(),
                nearest: nearest(key.get_ref(), fields.iter().map(|field| field.name)),
                known: fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", "),
            };
            walk.fault(key.span(), fault);
            continue;
        };
        let field = &fields[i];
        let quantity = Quantity::of(field);
        if let Value::Si(value) = walk.quantity(field.name, &quantity, raw) {
            record.set_value(i, value);
            let (section, value) = (title.to_owned(), display(&quantity, value));
            walk.echo.push(Echo { section, key: field.name.to_owned(), value, span: raw.span(), default: false });
        }
    }
}
