//! The form of a contour file as serde sees it.

use crate::{ContourError, CutterSide, FileError, FormError, Milling};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;
use toolroom_process::{AnyRecord, unit};

/// A quantity with its place.
pub(crate) type Text = Spanned<String>;

/// Values of a record by field name.
pub(crate) type Table = BTreeMap<String, Spanned<Value>>;

/// A number, with or without unit.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum Value {
    Number(f64),
    Quantity(String),
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawFile {
    pub schema: Spanned<u32>,
    pub name: String,
    pub title: String,
    pub parameter_set: Option<Text>,
    #[serde(default = "yes")]
    pub closed: bool,
    pub cutter_side: Option<CutterSide>,
    pub milling: Option<Milling>,
    pub path_error: Option<RawPathError>,
    pub form_error: Option<FormError>,
    pub corners: Option<Corners>,
    pub start: Option<[Text; 2]>,
    pub heading: Option<Text>,
    #[serde(default)]
    pub machine: Table,
    #[serde(default)]
    pub cutter: Table,
    #[serde(default)]
    pub force: Table,
    #[serde(default)]
    pub life: Table,
    #[serde(default)]
    pub economics: Table,
    #[serde(default)]
    pub scatter: Table,
    #[serde(default)]
    pub pass: Vec<Spanned<Table>>,
    #[serde(default)]
    pub section: Vec<Spanned<RawSection>>,
}

fn yes() -> bool {
    true
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawSection {
    pub turn: Option<Text>,
    pub line: Option<Text>,
    pub line_to: Option<[Text; 2]>,
    pub arc: Option<Text>,
    pub radius: Option<Text>,
    pub arc_to: Option<[Text; 2]>,
    pub center: Option<[Text; 2]>,
    pub direction: Option<Direction>,
    pub spline_to: Option<Vec<[Text; 2]>>,
    pub lobed: Option<Lobed>,
}

impl RawSection {
    /// Names of the keys given, for messages.
    pub fn keys(&self) -> String {
        let given = [
            ("line", self.line.is_some()),
            ("line_to", self.line_to.is_some()),
            ("arc", self.arc.is_some()),
            ("radius", self.radius.is_some()),
            ("arc_to", self.arc_to.is_some()),
            ("center", self.center.is_some()),
            ("direction", self.direction.is_some()),
            ("spline_to", self.spline_to.is_some()),
            ("lobed", self.lobed.is_some()),
        ];
        let names: Vec<&str> = given.iter().filter(|(_, given)| *given).map(|(name, _)| *name).collect();
        if names.is_empty() { "none of their keys".to_owned() } else { names.join(", ") }
    }
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Direction {
    Left,
    Right,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lobed {
    pub diameter: Text,
    pub eccentricity: Text,
    pub lobes: u32,
    pub sections: u32,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PathErrorModel {
    Servo,
    Empirical,
    ExplicitEuler,
    Off,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawPathError {
    pub model: Spanned<PathErrorModel>,
    /// Of explicit Euler.
    pub step: Option<Text>,
    /// Of the servo's velocity loop, ideal without.
    pub velocity_loop_frequency: Option<Text>,
    pub velocity_loop_damping: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Policy {
    Loop,
    ExactStop,
    SlowDown,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Corners {
    pub policy: Spanned<Policy>,
    pub radius: Option<Text>,
    pub tolerance: Option<Text>,
}

/// Key by which a pass is called.
pub(crate) const NAME: &str = "name";

/// The field called `key`, and its index.
fn field_of<'a>(
    group: &'static str,
    key: &str,
    fields: &'a [toolroom_process::Field],
) -> Result<(usize, &'a toolroom_process::Field), ContourError> {
    fields.iter().enumerate().find(|(_, field)| field.name == key).ok_or_else(|| {
        let known = fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
        ContourError::UnknownKey { group, key: key.to_owned(), known }
    })
}

/// Sets one field of `record` from text.
pub(crate) fn assign(
    group: &'static str,
    key: &str,
    text: &str,
    record: &mut dyn AnyRecord,
) -> Result<(), ContourError> {
    let fields = record.fields();
    let (i, field) = field_of(group, key, fields)?;
    let si = unit::quantity(text, field.unit).map_err(|reason| ContourError::Quantity { key: field.name, reason })?;
    field.check(si)?;
    record.set_value(i, si);
    Ok(())
}

/// Sets the fields of `record` that `table` gives, its name aside.
pub(crate) fn fill(
    text: &str,
    group: &'static str,
    table: &Table,
    record: &mut dyn AnyRecord,
) -> Result<(), FileError> {
    let fields = record.fields();
    for (key, value) in table.iter().filter(|(key, _)| *key != NAME) {
        let at = value.span().start;
        let (i, field) = field_of(group, key, fields).map_err(|fault| FileError::at(text, at, fault))?;
        let read = match value.get_ref() {
            Value::Number(number) => unit::quantity(&number.to_string(), field.unit),
            Value::Quantity(quantity) => unit::quantity(quantity, field.unit),
        };
        let si = read.map_err(|reason| {
            let inside = if matches!(value.get_ref(), Value::Quantity(_)) { 1 + reason.at() } else { 0 };
            FileError::at(text, at + inside, ContourError::Quantity { key: field.name, reason })
        })?;
        field.check(si).map_err(|reason| FileError::at(text, at, reason.into()))?;
        record.set_value(i, si);
    }
    Ok(())
}
