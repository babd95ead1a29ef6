//! The structure of a cell: its units, the signals between them, what it shows.
//!
//! # Source
//! System Structure and Parameterization 1.0.1, Modelica Association. Version 2.0 has the same elements in the same
//! namespaces; readers of 1.0 refuse a file that calls itself 2.0.

use crate::{Cell, Form};
use std::collections::BTreeSet;
use toolroom_fmu::{Attributes, ValueType, Variable, Xml, unit_powers, units};

/// Attributes of the root of both files.
pub(crate) const HEAD: &[(&str, &str)] = &[
    ("version", "1.0"),
    ("generationTool", concat!("toolroom ", env!("CARGO_PKG_VERSION"))),
    ("xmlns:ssc", "http://ssp-standard.org/SSP1/SystemStructureCommon"),
    ("xmlns:ssd", "http://ssp-standard.org/SSP1/SystemStructureDescription"),
    ("xmlns:ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"),
];

/// Entry of the parameter values.
pub(crate) const VALUES: &str = "resources/parameters.ssv";

/// Components and their models, in the order in which they step: a controller acts before the machine.
pub(crate) const COMPONENTS: [(&str, &str); 2] = [("controller", "controller"), ("lathe", "turning")];

/// Signals: component and variable at both ends.
const SIGNALS: &[[&str; 4]] = &[
    ["controller", "process.cutting_speed", "lathe", "process.cutting_speed"],
    ["controller", "process.tool_change", "lathe", "tool.change"],
    ["lathe", "process.spindle_power", "controller", "process.spindle_power"],
    ["lathe", "process.feed_force", "controller", "process.feed_force"],
    ["lathe", "process.thermo_emf", "controller", "process.thermo_emf"],
    ["lathe", "process.flank_wear", "controller", "process.flank_wear"],
    ["lathe", "tool.lost", "controller", "process.tool_lost"],
    ["lathe", "event.wear_limit", "controller", "process.tool_worn"],
];

/// Outputs of the system: component and variable, and the name of the connector.
const SHOWN: &[[&str; 3]] = &[
    ["lathe", "process.flank_wear", "flank_wear"],
    ["controller", "process.cutting_speed", "cutting_speed"],
    ["controller", "process.estimated_flank_wear", "estimated_flank_wear"],
    ["lathe", "tool.count", "edges"],
];

/// Entry of a component's unit.
pub(crate) fn source(component: &str) -> String {
    format!("resources/{component}.fmu")
}

fn connector(xml: &mut Xml, name: &str, kind: &str, variable: &Variable) {
    xml.element("ssd:Connector", &[("name", name.to_owned()), ("kind", kind.to_owned())], |xml| {
        let unit = [("unit", variable.field.unit.to_owned())];
        let unit: Attributes<'_> = if variable.field.unit == "1" { &[] } else { &unit };
        match variable.value_type {
            ValueType::Real => xml.leaf("ssc:Real", unit),
            ValueType::Integer => xml.leaf("ssc:Integer", &[]),
            ValueType::Boolean => xml.leaf("ssc:Boolean", &[]),
            ValueType::String => xml.leaf("ssc:String", &[]),
        }
    });
}

/// Definitions of units, each once; nothing where there are none.
pub(crate) fn unit_definitions(xml: &mut Xml, element: &'static str, names: impl Iterator<Item = &'static str>) {
    let names: BTreeSet<&str> = names.filter(|name| *name != "1").collect();
    if names.is_empty() {
        return;
    }
    xml.element(element, &[], |xml| {
        for name in names {
            xml.element("ssc:Unit", &[("name", name.to_owned())], |xml| {
                xml.leaf("ssc:BaseUnit", &unit_powers(name));
            });
        }
    });
}

/// Entry of the parameter values of a component, in a flat system.
pub(crate) fn values_of(component: &str) -> String {
    format!("resources/{component}.ssv")
}

fn binding(xml: &mut Xml, source: String) {
    xml.element("ssd:ParameterBindings", &[], |xml| {
        xml.leaf("ssd:ParameterBinding", &[("source", source)]);
    });
}

/// `SystemStructure.ssd` of a cell.
pub(crate) fn description(cell: &Cell, form: Form, stop: f64) -> String {
    let models: Vec<(&str, Vec<Variable>)> = COMPONENTS
        .iter()
        .filter_map(|(component, model)| Some((*component, units().find(|unit| unit.name == *model)?.variables())))
        .collect();
    let variable = |component: &str, name: &str, output: bool| {
        let (_, variables) = models.iter().find(|(own, _)| *own == component)?;
        // A unit may show under one name what it is told under the same.
        variables.iter().find(|each| each.name == name && matches!(each.role, toolroom_fmu::Role::Output) == output)
    };
    let mut used = BTreeSet::new();
    let mut xml = Xml::new();
    let mut head = vec![("name", cell.name.clone()), ("description", cell.title.clone())];
    head.extend(HEAD.iter().map(|(key, value)| (*key, (*value).to_owned())));
    xml.element("ssd:SystemStructureDescription", &head, |xml| {
        let system = [("name", "cell".to_owned()), ("description", cell.title.clone())];
        xml.element("ssd:System", &system, |xml| {
            if form == Form::Whole {
                xml.element("ssd:Connectors", &[], |xml| {
                    for [component, name, shown] in SHOWN {
                        if let Some(variable) = variable(component, name, true) {
                            used.insert(variable.field.unit);
                            connector(xml, shown, "output", variable);
                        }
                    }
                });
                binding(xml, VALUES.to_owned());
            }
            xml.element("ssd:Elements", &[], |xml| {
                for (component, _) in COMPONENTS {
                    let attributes = [
                        ("name", component.to_owned()),
                        ("type", "application/x-fmu-sharedlibrary".to_owned()),
                        ("source", source(component)),
                        ("implementation", "CoSimulation".to_owned()),
                    ];
                    xml.element("ssd:Component", &attributes, |xml| {
                        xml.element("ssd:Connectors", &[], |xml| {
                            let outputs = SIGNALS.iter().map(|[from, name, ..]| (from, name, "output"));
                            let inputs = SIGNALS.iter().map(|[.., to, name]| (to, name, "input"));
                            let shown = SHOWN.iter().map(|[from, name, _]| (from, name, "output"));
                            let mut known = BTreeSet::new();
                            for (_, name, kind) in outputs.chain(inputs).chain(shown).filter(|end| *end.0 == component)
                            {
                                let variable = variable(component, name, kind == "output");
                                if let Some(variable) = variable.filter(|_| known.insert((*name, kind))) {
                                    used.insert(variable.field.unit);
                                    connector(xml, name, kind, variable);
                                }
                            }
                        });
                        if form == Form::Flat {
                            binding(xml, values_of(component));
                        }
                    });
                }
            });
            xml.element("ssd:Connections", &[], |xml| {
                for [from, start, to, end] in SIGNALS {
                    let ends = [
                        ("startElement", (*from).to_owned()),
                        ("startConnector", (*start).to_owned()),
                        ("endElement", (*to).to_owned()),
                        ("endConnector", (*end).to_owned()),
                    ];
                    xml.leaf("ssd:Connection", &ends);
                }
                for [from, start, shown] in SHOWN.iter().filter(|_| form == Form::Whole) {
                    let ends = [
                        ("startElement", (*from).to_owned()),
                        ("startConnector", (*start).to_owned()),
                        ("endConnector", (*shown).to_owned()),
                    ];
                    xml.leaf("ssd:Connection", &ends);
                }
            });
        });
        unit_definitions(xml, "ssd:Units", used.iter().copied());
        let experiment = [("startTime", "0.0".to_owned()), ("stopTime", format!("{stop:?}"))];
        xml.leaf("ssd:DefaultExperiment", &experiment);
    });
    xml.finish()
}
