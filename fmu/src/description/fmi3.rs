//! `modelDescription.xml` of FMI 3.0.

use super::fmi2::{categories, choice_type, definitions, enumerations, experiment, items, kinds, role, value};
use super::quantity::{quantity, type_name, types};
use super::xml::Xml;
use super::{AUTHOR, COPYRIGHT, Description, LICENCE, TOOL, VERSION};
use crate::variable::{Role, Slot, ValueType, Variable};

pub(super) fn write(description: &Description) -> String {
    let mut xml = Xml::new();
    let mut head = vec![
        ("fmiVersion", "3.0".to_owned()),
        ("modelName", description.identifier.to_owned()),
        ("instantiationToken", description.token.clone()),
        ("description", description.title.to_owned()),
        ("author", AUTHOR.to_owned()),
        ("version", VERSION.to_owned()),
        ("copyright", COPYRIGHT.to_owned()),
        ("license", LICENCE.to_owned()),
        ("generationTool", TOOL.to_owned()),
        ("variableNamingConvention", "structured".to_owned()),
    ];
    head.extend(description.generated.clone().map(|date| ("generationDateAndTime", date)));
    xml.element("fmiModelDescription", &head, |xml| {
        interfaces(xml, description);
        xml.element("UnitDefinitions", &[], |xml| definitions(xml, description));
        xml.element("TypeDefinitions", &[], |xml| {
            for (unit, display) in types(description) {
                let mut attributes = vec![("name", type_name(unit, display)), ("unit", unit.to_owned())];
                attributes.extend(quantity(unit).map(|quantity| ("quantity", quantity.to_owned())));
                if display != unit {
                    attributes.push(("displayUnit", display.to_owned()));
                }
                xml.leaf("Float64Type", &attributes);
            }
            for variable in enumerations(description) {
                xml.element("EnumerationType", &[("name", choice_type(variable))], |xml| items(xml, variable));
            }
        });
        xml.element("LogCategories", &[], categories);
        experiment(xml, description);
        xml.element("ModelVariables", &[], |xml| {
            description.variables.iter().for_each(|variable| element(xml, variable, description));
        });
        xml.element("ModelStructure", &[], |xml| structure(xml, description));
    });
    xml.finish()
}

fn interfaces(xml: &mut Xml, description: &Description) {
    let yes = || "true".to_owned();
    let common = |attributes: &mut Vec<(&'static str, String)>| {
        attributes.extend([
            ("canGetAndSetFMUState", yes()),
            ("canSerializeFMUState", yes()),
            ("providesDirectionalDerivatives", description.continuous.to_string()),
            ("providesAdjointDerivatives", description.continuous.to_string()),
        ]);
    };
    if description.continuous {
        let mut attributes = vec![("modelIdentifier", description.identifier.to_owned())];
        common(&mut attributes);
        attributes.push(("needsCompletedIntegratorStep", yes()));
        xml.leaf("ModelExchange", &attributes);
    }
    let mut attributes = vec![("modelIdentifier", description.identifier.to_owned())];
    common(&mut attributes);
    attributes.extend([
        ("canHandleVariableCommunicationStepSize", yes()),
        ("maxOutputDerivativeOrder", if description.continuous { "1" } else { "0" }.to_owned()),
        ("mightReturnEarlyFromDoStep", yes()),
        ("hasEventMode", yes()),
    ]);
    xml.leaf("CoSimulation", &attributes);
}

fn element(xml: &mut Xml, variable: &Variable, description: &Description) {
    let mut attributes = vec![
        ("name", variable.name.clone()),
        ("valueReference", variable.slot.reference().to_string()),
        ("description", variable.field.doc.trim().to_owned()),
    ];
    attributes.extend(role(variable));
    match variable.value_type {
        ValueType::String => {
            xml.element("String", &attributes, |xml| {
                xml.leaf("Start", &[("value", description.sets[0].0.to_owned())]);
            });
        }
        ValueType::Boolean => {
            attributes.extend(value(variable));
            xml.leaf("Boolean", &attributes);
        }
        ValueType::Integer => {
            attributes.extend((!variable.items.is_empty()).then(|| ("declaredType", choice_type(variable))));
            attributes.extend(value(variable));
            xml.leaf(if variable.items.is_empty() { "Int32" } else { "Enumeration" }, &attributes);
        }
        ValueType::Real => {
            if variable.role != Role::Independent {
                attributes.extend(value(variable));
            } else {
                attributes.push(("unit", variable.field.unit.to_owned()));
            }
            if let Slot::Derivative(i) = variable.slot {
                attributes.push(("derivative", Slot::State(i).reference().to_string()));
            }
            if variable.role == Role::State {
                attributes.push(("reinit", "true".to_owned()));
            }
            if variable.field.len == 1 {
                xml.leaf("Float64", &attributes);
            } else {
                let dimension = [("start", variable.field.len.to_string())];
                xml.element("Float64", &attributes, |xml| xml.leaf("Dimension", &dimension));
            }
        }
    }
}

fn structure(xml: &mut Xml, description: &Description) {
    let mut list = |name: &'static str, wanted: &dyn Fn(&Variable) -> bool, dependencies: bool| {
        for variable in description.variables.iter().filter(|variable| wanted(variable)) {
            let reference = variable.slot.reference();
            let mut attributes = vec![("valueReference", reference.to_string())];
            let knowns = description.dependencies.of_unknown(reference).filter(|_| dependencies);
            if let Some(knowns) = knowns {
                let known: Vec<String> = knowns.iter().map(ToString::to_string).collect();
                attributes.push(("dependencies", known.join(" ")));
                attributes.push(("dependenciesKind", kinds(known.len())));
            }
            xml.leaf(name, &attributes);
        }
    };
    let rate = |variable: &Variable| matches!(variable.slot, Slot::Derivative(_));
    let output = |variable: &Variable| variable.role == Role::Output;
    let indicator = |variable: &Variable| description.continuous && matches!(variable.slot, Slot::Indicator(_));
    // Where there is no Model Exchange a state is no known, and dependencies are not declared.
    list("Output", &output, description.continuous);
    list("ContinuousStateDerivative", &rate, true);
    list("InitialUnknown", &|variable| output(variable) || rate(variable), false);
    list("EventIndicator", &indicator, true);
}
