//! Start values of the units of a cell, and the file that holds them.

use crate::structure::{HEAD, unit_definitions};
use toolroom_fmu::{Unit, ValueType, Variable, Xml, parameter_values, units};

/// A start value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Start {
    /// Component and variable.
    pub name: String,
    pub value: f64,
    pub value_type: ValueType,
    /// Unit, in which the value is.
    pub unit: &'static str,
}

fn variables(model: &str) -> Vec<Variable> {
    units().find(|unit| unit.name == model).map_or_else(Vec::new, |unit| unit.variables())
}

impl Start {
    fn new(component: &str, variable: &Variable, value: f64) -> Self {
        let name = format!("{component}.{}", variable.name);
        Self { name, value, value_type: variable.value_type, unit: variable.field.unit }
    }

    /// A start value of a unit; nothing where it has that value by itself.
    pub fn of(component: &str, model: &str, name: &str, value: f64) -> Option<Self> {
        let variables = variables(model);
        let variable = variables.iter().find(|variable| variable.name == name && variable.has_start())?;
        (variable.field.start != value).then(|| Self::new(component, variable, value))
    }
}

/// The parameters in which a process differs from the start values of its unit.
pub(crate) fn differing<U: Unit>(component: &str, model: &str, process: &U) -> Vec<Start> {
    let variables = variables(model);
    let start = |(name, value): (String, f64)| {
        let variable = variables.iter().find(|variable| variable.name == name)?;
        (variable.field.start != value).then(|| Start::new(component, variable, value))
    };
    parameter_values(process).into_iter().filter_map(start).collect()
}

/// The start values of one component, by their names in its unit.
pub(crate) fn within(component: &str, start: &[Start]) -> Vec<Start> {
    let own = |each: &Start| {
        let name = each.name.strip_prefix(component)?.strip_prefix('.')?.to_owned();
        Some(Start { name, ..each.clone() })
    };
    start.iter().filter_map(own).collect()
}

/// The file of parameter values.
pub(crate) fn file(name: &str, start: &[Start]) -> String {
    let mut xml = Xml::new();
    let mut head = vec![("name", name.to_owned())];
    head.extend(HEAD.iter().map(|(key, value)| (*key, (*value).to_owned())));
    xml.element("ssv:ParameterSet", &head, |xml| {
        xml.element("ssv:Parameters", &[], |xml| {
            for parameter in start {
                xml.element("ssv:Parameter", &[("name", parameter.name.clone())], |xml| match parameter.value_type {
                    ValueType::Real => {
                        let mut attributes = vec![("value", format!("{:?}", parameter.value))];
                        attributes.extend((parameter.unit != "1").then(|| ("unit", parameter.unit.to_owned())));
                        xml.leaf("ssv:Real", &attributes);
                    }
                    ValueType::Boolean => xml.leaf("ssv:Boolean", &[("value", (parameter.value > 0.5).to_string())]),
                    ValueType::Integer => xml.leaf("ssv:Integer", &[("value", format!("{:.0}", parameter.value))]),
                    ValueType::String => {}
                });
            }
        });
        unit_definitions(xml, "ssv:Units", start.iter().map(|each| each.unit));
    });
    xml.finish()
}
