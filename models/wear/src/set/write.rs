//! A parameter set as a file that needs no other one.

use super::{ParameterSet, Spread};
use std::fmt::Write;
use toolroom_process::Record;

impl ParameterSet {
    /// The set as a file: every value with its unit and source, whatever it was based on. Reading it
    /// gives the same set, but that every value is stated.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let _ = writeln!(text, "schema = 1\nname = {}\ntitle = {}", quoted(&self.name), quoted(&self.title));
        let _ = writeln!(text, "process = \"{}\"", self.process);
        if let Some(law) = self.law {
            let _ = writeln!(text, "law = \"{law}\"");
        }
        let mut group = "";
        for value in &self.values {
            if value.group != group {
                group = value.group;
                let _ = writeln!(text, "\n[parameters.{group}]");
            }
            // The shortest decimal that gives the same number back.
            let number = value.field.to_display(value.value);
            let number = if value.field.from_display(number) == value.value { number } else { nudged(value, number) };
            let written = match value.field.display {
                "1" => format!("{number:?}"),
                unit => format!("\"{number:?} {unit}\""),
            };
            let source = match &value.origin {
                super::Origin::Given => value.source.clone(),
                super::Origin::Handbook | super::Origin::Based(_) | super::Origin::Assumed => {
                    format!("{} ({})", value.source, value.origin)
                }
            };
            let _ = writeln!(text, "{} = {{ value = {written}, source = {} }}", value.field.name, quoted(&source));
        }
        if !self.prior.is_empty() {
            let _ = writeln!(text, "\n[prior]");
            for (key, spread) in &self.prior {
                let spread = match spread {
                    Spread::Factor(factor) => format!("factor = {factor:?}"),
                    Spread::Deviation(deviation) => format!("deviation = {deviation:?}"),
                };
                let _ = writeln!(text, "{} = {{ {spread} }}", quoted(key));
            }
        }
        if let Some(scatter) = &self.scatter {
            let _ = writeln!(text, "\n[scatter]");
            for (i, field) in crate::Scatter::<f64>::FIELDS.iter().enumerate() {
                let number = field.to_display(scatter.get(i).unwrap_or(field.start));
                let _ = match field.display {
                    "1" => writeln!(text, "{} = {number:?}", field.name),
                    unit => writeln!(text, "{} = \"{number:?} {unit}\"", field.name),
                };
            }
        }
        text
    }
}

/// The neighbour of `number` that reads back as the value, where there is one.
fn nudged(value: &super::ParameterValue, number: f64) -> f64 {
    let near = [number.next_up(), number.next_down()];
    near.into_iter().find(|near| value.field.from_display(*near) == value.value).unwrap_or(number)
}
