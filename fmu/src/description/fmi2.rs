//! `modelDescription.xml` of FMI 2.0.

use super::quantity::{quantity, type_name, types, units};
use super::xml::Xml;
use super::{AUTHOR, COPYRIGHT, Description, LICENCE, TOOL, VERSION};
use crate::instance::nominal_of;
use crate::log::Category;
use crate::variable::{Role, Slot, ValueType, Variable};
use std::collections::BTreeMap;

pub(super) fn write(description: &Description) -> String {
    // FMI 2.0 has no arrays, and its independent variable is optional; importers built on
    // FMI Library report it as an error.
    let variables: Vec<&Variable> = description
        .variables
        .iter()
        .filter(|variable| variable.field.len == 1 && variable.role != Role::Independent)
        .collect();
    let index: BTreeMap<u32, usize> =
        variables.iter().enumerate().map(|(i, variable)| (variable.slot.reference(), i + 1)).collect();
    let indicators = variables.iter().filter(|variable| matches!(variable.slot, Slot::Indicator(_))).count();
    let mut xml = Xml::new();
    let mut head = vec![
        ("fmiVersion", "2.0".to_owned()),
        ("modelName", description.identifier.to_owned()),
        ("guid", description.token.clone()),
        ("description", description.title.to_owned()),
        ("author", AUTHOR.to_owned()),
        ("version", VERSION.to_owned()),
        ("copyright", COPYRIGHT.to_owned()),
        ("license", LICENCE.to_owned()),
        ("generationTool", TOOL.to_owned()),
        ("variableNamingConvention", "structured".to_owned()),
        ("numberOfEventIndicators", if description.continuous { indicators } else { 0 }.to_string()),
    ];
    head.extend(description.generated.clone().map(|date| ("generationDateAndTime", date)));
    xml.element("fmiModelDescription", &head, |xml| {
        interfaces(xml, description);
        xml.element("UnitDefinitions", &[], |xml| definitions(xml, description));
        xml.element("TypeDefinitions", &[], |xml| {
            for (unit, display) in types(description) {
                xml.element("SimpleType", &[("name", type_name(unit, display))], |xml| {
                    let mut attributes = vec![("unit", unit.to_owned())];
                    attributes.extend(quantity(unit).map(|quantity| ("quantity", quantity.to_owned())));
                    if display != unit {
                        attributes.push(("displayUnit", display.to_owned()));
                    }
                    xml.leaf("Real", &attributes);
                });
            }
            for variable in enumerations(description) {
                xml.element("SimpleType", &[("name", choice_type(variable))], |xml| {
                    xml.element("Enumeration", &[], |xml| items(xml, variable));
                });
            }
        });
        xml.element("LogCategories", &[], categories);
        experiment(xml, description);
        xml.element("ModelVariables", &[], |xml| {
            variables.iter().for_each(|variable| scalar(xml, variable, description, &index));
        });
        xml.element("ModelStructure", &[], |xml| structure(xml, description, &variables, &index));
    });
    xml.finish()
}

fn interfaces(xml: &mut Xml, description: &Description) {
    let yes = || "true".to_owned();
    let common = |attributes: &mut Vec<(&'static str, String)>| {
        attributes.extend([
            ("canNotUseMemoryManagementFunctions", yes()),
            ("canGetAndSetFMUstate", yes()),
            ("canSerializeFMUstate", yes()),
            ("providesDirectionalDerivative", description.continuous.to_string()),
        ]);
    };
    if description.continuous {
        let mut attributes = vec![("modelIdentifier", description.identifier.to_owned())];
        common(&mut attributes);
        xml.leaf("ModelExchange", &attributes);
    }
    let mut attributes = vec![
        ("modelIdentifier", description.identifier.to_owned()),
        ("canHandleVariableCommunicationStepSize", yes()),
        ("maxOutputDerivativeOrder", if description.continuous { "1" } else { "0" }.to_owned()),
    ];
    common(&mut attributes);
    xml.leaf("CoSimulation", &attributes);
}

/// Units with their display units; the same in both versions.
pub(super) fn definitions(xml: &mut Xml, description: &Description) {
    for unit in units(description) {
        xml.element("Unit", &[("name", unit.name.to_owned())], |xml| {
            xml.leaf("BaseUnit", &unit.base);
            for (name, factor, offset) in unit.display {
                let mut attributes = vec![("name", name.to_owned()), ("factor", number(factor))];
                if offset != 0.0 {
                    attributes.push(("offset", number(offset)));
                }
                xml.leaf("DisplayUnit", &attributes);
            }
        });
    }
}

/// The variables that are enumerations; each is a type of its own.
pub(super) fn enumerations(description: &Description) -> impl Iterator<Item = &Variable> {
    description.variables.iter().filter(|variable| !variable.items.is_empty())
}

/// Name of the type of an enumeration, which no variable may have.
pub(super) fn choice_type(variable: &Variable) -> String {
    format!("Choice of {}", variable.name)
}

/// The values of an enumeration; the same in both versions.
pub(super) fn items(xml: &mut Xml, variable: &Variable) {
    for (value, item) in (variable.field.min as i64..).zip(variable.items) {
        xml.leaf("Item", &[("name", (*item).to_owned()), ("value", value.to_string())]);
    }
}

/// Categories of messages; the same in both versions.
pub(super) fn categories(xml: &mut Xml) {
    for category in Category::ALL {
        let attributes = [("name", category.name().to_owned()), ("description", category.doc().to_owned())];
        xml.leaf("Category", &attributes);
    }
}

/// The default experiment; the same in both versions.
pub(super) fn experiment(xml: &mut Xml, description: &Description) {
    let (stop, step) = description.experiment;
    let attributes = [
        ("startTime", number(0.0)),
        ("stopTime", number(stop)),
        ("tolerance", number(1e-6)),
        ("stepSize", number(step)),
    ];
    xml.leaf("DefaultExperiment", &attributes);
}

/// A number that reads back to the same bits.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// Causality, variability and initial of a variable; the same words in both versions.
pub(super) fn role(variable: &Variable) -> Vec<(&'static str, String)> {
    let varies = if variable.is_discrete() { "discrete" } else { "continuous" };
    let (causality, variability, initial) = match variable.role {
        Role::Independent => ("independent", "continuous", None),
        Role::Input => ("input", varies, None),
        Role::Tunable => ("parameter", "tunable", Some("exact")),
        Role::Fixed => ("parameter", "fixed", Some("exact")),
        Role::State => ("local", "continuous", Some("exact")),
        Role::Local => ("local", varies, Some("calculated")),
        Role::Output => ("output", varies, Some("calculated")),
    };
    let mut attributes = vec![("causality", causality.to_owned()), ("variability", variability.to_owned())];
    attributes.extend(initial.map(|initial| ("initial", initial.to_owned())));
    attributes
}

/// Type, unit, range and start of a number; the same words in both versions.
pub(super) fn value(variable: &Variable) -> Vec<(&'static str, String)> {
    let field = &variable.field;
    let mut attributes = Vec::new();
    if variable.value_type == ValueType::Real {
        attributes.push(("declaredType", type_name(field.unit, field.display)));
        attributes.push(("unit", field.unit.to_owned()));
        if field.display != field.unit {
            attributes.push(("displayUnit", field.display.to_owned()));
        }
    }
    let text = |value: f64| match variable.value_type {
        ValueType::Real => number(value),
        ValueType::Boolean => (value > 0.5).to_string(),
        ValueType::Integer | ValueType::String => format!("{value:.0}"),
    };
    if variable.value_type != ValueType::Boolean {
        attributes.extend((field.min != f64::MIN).then(|| ("min", text(field.min))));
        attributes.extend((field.max != f64::MAX).then(|| ("max", text(field.max))));
    }
    if variable.value_type == ValueType::Real {
        let nominal = nominal_of(field.display, field.unit);
        attributes.extend((nominal != 1.0).then(|| ("nominal", number(nominal))));
    }
    if variable.has_start() {
        attributes.push(("start", text(field.start)));
    }
    attributes
}

/// How an unknown depends on each of its knowns: in no way of which a solver could make use.
pub(super) fn kinds(count: usize) -> String {
    vec!["dependent"; count].join(" ")
}

fn scalar(xml: &mut Xml, variable: &Variable, description: &Description, index: &BTreeMap<u32, usize>) {
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", variable.slot.reference().to_string()),
        ("description", variable.field.doc.trim().to_owned()),
    ];
    attributes.extend(role(variable));
    xml.element("ScalarVariable", &attributes, |xml| {
        let mut attributes = value(variable);
        match (variable.value_type, variable.slot) {
            (ValueType::String, _) => xml.leaf("String", &[("start", description.sets[0].0.to_owned())]),
            (ValueType::Boolean, _) => xml.leaf("Boolean", &attributes),
            (ValueType::Integer, _) if !variable.items.is_empty() => {
                attributes.insert(0, ("declaredType", choice_type(variable)));
                xml.leaf("Enumeration", &attributes);
            }
            (ValueType::Integer, _) => xml.leaf("Integer", &attributes),
            (ValueType::Real, slot) => {
                if let Slot::Derivative(i) = slot {
                    attributes.push(("derivative", index[&Slot::State(i).reference()].to_string()));
                }
                if variable.role == Role::State {
                    attributes.push(("reinit", "true".to_owned()));
                }
                xml.leaf("Real", &attributes);
            }
        }
    });
}

fn structure(xml: &mut Xml, description: &Description, variables: &[&Variable], index: &BTreeMap<u32, usize>) {
    let list = |xml: &mut Xml, name: &'static str, wanted: &dyn Fn(&Variable) -> bool, dependencies: bool| {
        let unknowns: Vec<&&Variable> = variables.iter().filter(|variable| wanted(variable)).collect();
        if unknowns.is_empty() {
            return;
        }
        xml.element(name, &[], |xml| {
            for variable in unknowns {
                let reference = variable.slot.reference();
                let mut attributes = vec![("index", index[&reference].to_string())];
                let knowns = description.dependencies.of_unknown(reference).filter(|_| dependencies);
                if let Some(knowns) = knowns {
                    let known = knowns.iter().filter_map(|known| index.get(known)).map(ToString::to_string);
                    let known: Vec<String> = known.collect();
                    attributes.push(("dependencies", known.join(" ")));
                    attributes.push(("dependenciesKind", kinds(known.len())));
                }
                xml.leaf("Unknown", &attributes);
            }
        });
    };
    let rate = |variable: &Variable| matches!(variable.slot, Slot::Derivative(_));
    let output = |variable: &Variable| variable.role == Role::Output;
    // Where there is no Model Exchange a state is no known, and dependencies are not declared.
    list(xml, "Outputs", &output, description.continuous);
    list(xml, "Derivatives", &rate, true);
    list(xml, "InitialUnknowns", &|variable| output(variable) || rate(variable), false);
}
