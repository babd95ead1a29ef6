//! `SystemStructure.ssd`: what a system is made of.

use crate::edges::{Edge, boundary, connections, edge};
use crate::read::Reader;
use crate::values::{self, Parameter};
use roxmltree::Node;
use std::collections::BTreeMap;
use toolroom_fmu_import::description::BaseUnit;

/// A system of units, its nested systems resolved.
///
/// # Source
/// System Structure and Parameterization 1.0.1 and 2.0, Modelica Association; both versions have the same namespaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SystemStructure {
    /// Name of the structure.
    pub name: String,
    /// `version` as written.
    pub version: String,
    /// Start of the default experiment, s.
    pub start: Option<f64>,
    /// Its end, s.
    pub stop: Option<f64>,
    /// Units by name.
    pub units: BTreeMap<String, BaseUnit>,
    /// Units of FMI in the order of the file, those of nested systems among them.
    pub components: Vec<Component>,
    /// Signals between components.
    pub connections: Vec<Connection>,
    /// Inputs and outputs of the system itself, with the component ends that they stand for.
    pub boundary: Vec<Boundary>,
}

/// A unit of FMI in a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Name with the names of the systems around it, such as `cell.lathe`.
    pub name: String,
    /// Entry of the package that holds the unit.
    pub source: String,
    /// `implementation`: `any`, `CoSimulation` or `ModelExchange`.
    pub implementation: String,
    /// Connectors.
    pub connectors: Vec<Connector>,
    /// Start values; the last one of a name holds.
    pub parameters: Vec<Parameter>,
    /// Line of the file.
    pub line: u32,
}

/// A connector of a component. It has the name of a variable of the unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Connector {
    /// Name.
    pub name: String,
    /// `input`, `output`, `inout`, `parameter` or `calculatedParameter`.
    pub kind: String,
    /// Unit, where the file gives one.
    pub unit: Option<String>,
}

/// One end of a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct End {
    /// Index into [`SystemStructure::components`].
    pub component: usize,
    /// Name of the connector.
    pub connector: String,
}

/// A signal from an output to an input: `factor · value + offset`, after units were converted.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// Where the signal comes from.
    pub from: End,
    /// Where it goes.
    pub to: End,
    /// Factor of the linear transformations on the way.
    pub factor: f64,
    /// Their offset.
    pub offset: f64,
    /// Whether units are converted.
    pub converts: bool,
    /// Line of the file.
    pub line: u32,
}

/// An input or output of the system itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Name.
    pub name: String,
    /// `input` or `output`.
    pub kind: String,
    /// Unit, where the file gives one.
    pub unit: Option<String>,
    /// Ends of components that it is connected to.
    pub ends: Vec<End>,
    /// Of an output: factor of the linear transformations on the way; its value is `factor · value + offset` of that of its
    /// end, after units were converted.
    pub factor: f64,
    /// Their offset.
    pub offset: f64,
    /// Whether units are converted.
    pub converts: bool,
}

/// What was collected from the file so far.
#[derive(Default)]
struct Collected {
    components: Vec<Component>,
    edges: Vec<Edge>,
    /// Paths of systems.
    systems: Vec<String>,
}

/// Reads the text of a structure; `values` gives the text of another entry of the package.
pub(crate) fn read(reader: &mut Reader, root: Node<'_, '_>, values: &mut values::Source<'_>) -> SystemStructure {
    let mut structure = SystemStructure {
        name: root.attribute("name").unwrap_or_default().to_owned(),
        version: reader.required(root, "version"),
        ..SystemStructure::default()
    };
    let mut collected = Collected::default();
    let mut system = None;
    for child in root.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "System" => system = Some(child),
            "Units" => structure.units = units(reader, child),
            "DefaultExperiment" => {
                structure.start = reader.number(child, "startTime");
                structure.stop = reader.number(child, "stopTime");
            }
            // Enumerations name numbers; annotations are other tools' own.
            "Enumerations" | "Annotations" => {}
            other => reader.fault(child, format!("<{other}> is no element of <SystemStructureDescription>")),
        }
    }
    let Some(system) = system else {
        reader.fault(root, "there is no <System>".to_owned());
        return structure;
    };
    walk(reader, system, "", &mut collected, values);
    structure.components = collected.components;
    let name = structure.components.iter().enumerate().find_map(|(i, component)| {
        structure.components[..i].iter().any(|other| other.name == component.name).then_some(component)
    });
    if let Some(twice) = name {
        reader.fault_at(twice.line, format!("there are two elements of the name \"{}\"", twice.name));
    }
    structure.boundary = boundary(reader, system, &structure.components, &collected.edges);
    expect_defined(reader, (root, system), &structure);
    for edge in &collected.edges {
        for (element, _) in [&edge.from, &edge.to] {
            let known =
                collected.systems.contains(element) || structure.components.iter().any(|each| each.name == *element);
            if !known {
                reader
                    .fault_at(edge.line, format!("the connection names an element \"{element}\", which is not there"));
            }
        }
    }
    structure.connections = connections(reader, &structure.components, &collected.edges);
    structure
}

/// That the version is one that is read, and that every unit of a connector has a definition, which tells what it means.
fn expect_defined(reader: &mut Reader, (root, system): (Node<'_, '_>, Node<'_, '_>), structure: &SystemStructure) {
    let version = structure.version.as_str();
    if !(version.is_empty() || version == "1.0" || version == "2.0" || version.starts_with("2.0-")) {
        reader.fault(root, format!("version = \"{version}\" of the standard is not read: 1.0 and 2.0 are"));
    }
    let defined: Vec<&str> = root
        .children()
        .filter(|node| node.has_tag_name_local("Units"))
        .flat_map(|list| list.children())
        .filter_map(|unit| unit.attribute("name"))
        .collect();
    for component in &structure.components {
        for connector in &component.connectors {
            if let Some(unit) = connector.unit.as_deref().filter(|unit| !defined.contains(unit)) {
                let what =
                    format!("{}.{} is in \"{unit}\", which <Units> does not define", component.name, connector.name);
                reader.fault_at(component.line, what);
            }
        }
    }
    for connector in &structure.boundary {
        if let Some(unit) = connector.unit.as_deref().filter(|unit| !defined.contains(unit)) {
            let what = format!("{} of the system is in \"{unit}\", which <Units> does not define", connector.name);
            reader.fault(system, what);
        }
    }
}

/// Units by name: those that the file gives in terms of SI.
pub(crate) fn units(reader: &mut Reader, list: Node<'_, '_>) -> BTreeMap<String, BaseUnit> {
    let mut units = BTreeMap::new();
    for unit in list.children().filter(|node| node.has_tag_name_local("Unit")) {
        let name = reader.required(unit, "name");
        let Some(base) = unit.children().find(|node| node.has_tag_name_local("BaseUnit")) else { continue };
        let mut powers = [0; 8];
        for (power, symbol) in powers.iter_mut().zip(["kg", "m", "s", "A", "K", "mol", "cd", "rad"]) {
            *power = reader.number(base, symbol).unwrap_or(0);
        }
        let factor = reader.number(base, "factor").unwrap_or(1.0);
        let offset = reader.number(base, "offset").unwrap_or(0.0);
        units.insert(name, BaseUnit { factor, offset, powers });
    }
    units
}

/// Elements are told by their local name: 1.0 and 2.0 have one namespace for each schema.
pub(crate) trait Local {
    fn has_tag_name_local(&self, name: &str) -> bool;
}

impl Local for Node<'_, '_> {
    fn has_tag_name_local(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

pub(crate) fn joined(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// Reads a system at `path` with everything below it, and gives the start values that it binds, by names below it.
fn walk(
    reader: &mut Reader,
    system: Node<'_, '_>,
    path: &str,
    collected: &mut Collected,
    values: &mut values::Source<'_>,
) {
    let first = collected.components.len();
    collected.systems.push(path.to_owned());
    for child in system.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "Elements" => {
                for element in child.children().filter(Node::is_element) {
                    let name = joined(path, &reader.required(element, "name"));
                    match element.tag_name().name() {
                        "Component" => component(reader, element, name, collected, values),
                        "System" => walk(reader, element, &name, collected, values),
                        other => {
                            reader.fault(element, format!("<{other}> is not read: only components and systems are"))
                        }
                    }
                }
            }
            "Connections" => {
                let edges = child.children().filter(|node| node.has_tag_name_local("Connection"));
                for connection in edges {
                    let edge = edge(reader, connection, path);
                    collected.edges.push(edge);
                }
            }
            // Bindings of a system come after those of its elements: outer values take precedence.
            "Connectors" | "ParameterBindings" | "ElementGeometry" | "SystemGeometry" | "GraphicalElements"
            | "Annotations" => {}
            other => reader.fault(child, format!("<{other}> is not read in a system")),
        }
    }
    for parameter in values::bound(reader, system, values) {
        let inside = collected.components[first..].iter_mut().find_map(|component| {
            let local = component.name.strip_prefix(path).map(|name| name.trim_start_matches('.'))?;
            let variable = parameter.name.strip_prefix(local)?.strip_prefix('.')?.to_owned();
            Some((component, variable))
        });
        match inside {
            Some((component, variable)) => component.parameters.push(Parameter { name: variable, ..parameter }),
            None => reader.fault_of(
                &parameter.entry,
                parameter.line,
                format!("the parameter \"{}\" begins with the name of no component of the system", parameter.name),
            ),
        }
    }
}

fn component(
    reader: &mut Reader,
    element: Node<'_, '_>,
    name: String,
    collected: &mut Collected,
    values: &mut values::Source<'_>,
) {
    let kind = element.attribute("type").unwrap_or("application/x-fmu-sharedlibrary");
    if kind != "application/x-fmu-sharedlibrary" {
        reader.fault(element, format!("a component of type {kind} is not read: only FMI units are"));
        return;
    }
    let source = reader.required(element, "source");
    let list = element.children().find(|node| node.has_tag_name_local("Connectors"));
    let connectors = list.into_iter().flat_map(|list| list.children());
    let connectors: Vec<Connector> = connectors
        .filter(|node| node.has_tag_name_local("Connector"))
        .map(|node| Connector {
            name: reader.required(node, "name"),
            kind: reader.required(node, "kind"),
            unit: node.children().find_map(|kind| kind.attribute("unit")).map(str::to_owned),
        })
        .collect();
    collected.components.push(Component {
        name,
        source: source.trim_start_matches("./").to_owned(),
        implementation: element.attribute("implementation").unwrap_or("any").to_owned(),
        connectors,
        parameters: values::bound(reader, element, values),
        line: reader.line(element),
    });
}
