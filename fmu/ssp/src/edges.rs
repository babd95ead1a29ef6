//! Connections as a file has them, followed through the connectors of systems to components.

use crate::read::Reader;
use crate::structure::{Boundary, Component, Connection, End, Local, joined};
use roxmltree::Node;

/// A connector of a system or a component, by the path of its element.
type Place = (String, String);

/// A connection as written.
pub(crate) struct Edge {
    pub from: Place,
    pub to: Place,
    factor: f64,
    offset: f64,
    converts: bool,
    pub line: u32,
}

/// Where a signal comes from, and what becomes of it on the way.
struct Origin {
    end: End,
    factor: f64,
    offset: f64,
    converts: bool,
}

/// A connection of the system at `path`.
pub(crate) fn edge(reader: &mut Reader, node: Node<'_, '_>, path: &str) -> Edge {
    let mut place = |element: &str, connector: &str| {
        let element = node.attribute(element).map_or(path.to_owned(), |element| joined(path, element));
        (element, reader.required(node, connector))
    };
    let (from, to) = (place("startElement", "startConnector"), place("endElement", "endConnector"));
    let mut edge = Edge { from, to, factor: 1.0, offset: 0.0, converts: true, line: reader.line(node) };
    edge.converts = !matches!(node.attribute("suppressUnitConversion"), Some("true" | "1"));
    for child in node.children().filter(Node::is_element) {
        match child.tag_name().name() {
            "LinearTransformation" => {
                edge.factor = reader.number(child, "factor").unwrap_or(1.0);
                edge.offset = reader.number(child, "offset").unwrap_or(0.0);
            }
            "ConnectionGeometry" | "Annotations" => {}
            other => {
                reader.fault(child, format!("<{other}> of a connection is not read: only LinearTransformation is"))
            }
        }
    }
    edge
}

fn end(components: &[Component], place: &Place) -> Option<End> {
    let component = components.iter().position(|component| component.name == place.0)?;
    Some(End { component, connector: place.1.clone() })
}

/// The component that the signal of `last` comes from, through the connectors of the systems around it.
fn origin(components: &[Component], edges: &[Edge], last: &Edge) -> Option<Origin> {
    let (mut at, mut factor, mut offset, mut converts) = (last, last.factor, last.offset, last.converts);
    // As many steps as there are connections lead to the start, unless they lead round in a circle.
    for _ in 0..edges.len() {
        let Some(before) = edges.iter().find(|before| before.to == at.from && end(components, &at.from).is_none())
        else {
            break;
        };
        offset += factor * before.offset;
        factor *= before.factor;
        converts &= before.converts;
        at = before;
    }
    Some(Origin { end: end(components, &at.from)?, factor, offset, converts })
}

/// Connections between components.
pub(crate) fn connections(reader: &mut Reader, components: &[Component], edges: &[Edge]) -> Vec<Connection> {
    let mut found: Vec<Connection> = Vec::new();
    for edge in edges {
        let Some(to) = end(components, &edge.to) else { continue };
        let Some(Origin { end: from, factor, offset, converts }) = origin(components, edges, edge) else { continue };
        if found.iter().any(|other| other.to == to) {
            let name = &components[to.component].name;
            reader.fault_at(edge.line, format!("{name}.{} is connected twice", to.connector));
            continue;
        }
        found.push(Connection { from, to, factor, offset, converts, line: edge.line });
    }
    for connection in &found {
        for (end, kinds) in [(&connection.from, ["output", "inout"]), (&connection.to, ["input", "inout"])] {
            let component = &components[end.component];
            let known = component.connectors.iter().find(|connector| connector.name == end.connector);
            if !known.is_some_and(|connector| kinds.contains(&connector.kind.as_str())) {
                let what = format!("{} has no {} \"{}\"", component.name, kinds[0], end.connector);
                reader.fault_at(connection.line, what);
            }
        }
    }
    found
}

/// Connectors of the outermost system with the ends of components that they stand for.
pub(crate) fn boundary(
    reader: &mut Reader,
    system: Node<'_, '_>,
    components: &[Component],
    edges: &[Edge],
) -> Vec<Boundary> {
    let list = system.children().find(|node| node.has_tag_name_local("Connectors"));
    let connectors = list.into_iter().flat_map(|list| list.children());
    let mut found = Vec::new();
    for node in connectors.filter(|node| node.has_tag_name_local("Connector")) {
        let (Some(name), Some(kind)) = (node.attribute("name"), node.attribute("kind")) else { continue };
        let place: Place = (String::new(), name.to_owned());
        let mut connector = Boundary {
            name: name.to_owned(),
            kind: kind.to_owned(),
            unit: node.children().find_map(|kind| kind.attribute("unit")).map(str::to_owned),
            ends: Vec::new(),
            factor: 1.0,
            offset: 0.0,
            converts: true,
        };
        if kind == "output" {
            for (nth, edge) in edges.iter().filter(|edge| edge.to == place).enumerate() {
                if nth > 0 {
                    reader.fault_at(edge.line, format!("{name} of the system is connected twice"));
                    break;
                }
                let Some(Origin { end, factor, offset, converts }) = origin(components, edges, edge) else { continue };
                (connector.factor, connector.offset, connector.converts) = (factor, offset, converts);
                connector.ends.push(end);
            }
        } else {
            connector.ends = fed(components, edges, place);
        }
        found.push(connector);
    }
    found
}

/// The ends of components that an input of the system leads to.
fn fed(components: &[Component], edges: &[Edge], input: Place) -> Vec<End> {
    let (mut ends, mut open) = (Vec::new(), vec![input]);
    // Each connection is followed once.
    let mut left: Vec<&Edge> = edges.iter().collect();
    while let Some(place) = open.pop() {
        left.retain(|edge| {
            if edge.from != place {
                return true;
            }
            match end(components, &edge.to) {
                Some(end) => ends.push(end),
                None => open.push(edge.to.clone()),
            }
            false
        });
    }
    ends
}
