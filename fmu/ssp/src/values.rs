//! Start values: `.ssv` files and the bindings that name them.

use crate::read::Reader;
use crate::structure::{Local, units};
use roxmltree::Node;
use std::collections::BTreeMap;
use toolroom_fmu_import::description::BaseUnit;

/// A start value.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name of the variable; in a binding of a system with the name of the component before it.
    pub name: String,
    /// Value as written; elements of an array parted by spaces.
    pub value: String,
    /// Its unit in terms of SI, where the file gives one.
    pub unit: Option<BaseUnit>,
    /// Entry of the package that holds it.
    pub entry: String,
    /// Line of that entry.
    pub line: u32,
}

/// Gives the text of an entry of the package.
pub(crate) type Source<'s> = dyn FnMut(&str) -> Result<String, String> + 's;

/// The start values that an element binds: those of files and those written beside it, later ones last.
pub(crate) fn bound(reader: &mut Reader, element: Node<'_, '_>, source: &mut Source<'_>) -> Vec<Parameter> {
    let lists = element.children().filter(|node| node.has_tag_name_local("ParameterBindings"));
    let bindings: Vec<Node<'_, '_>> = lists.flat_map(|list| list.children()).collect();
    let mut all = Vec::new();
    for binding in bindings.into_iter().filter(|node| node.has_tag_name_local("ParameterBinding")) {
        let prefix = binding.attribute("prefix").unwrap_or_default();
        if let Some(mapping) = binding.children().find(|node| node.has_tag_name_local("ParameterMapping")) {
            reader.fault(mapping, "a mapping of parameters is not read: name the variables themselves".to_owned());
        }
        let mut values = Vec::new();
        match binding.attribute("source") {
            Some(entry) if binding.attribute("sourceBase").unwrap_or("SSD") == "SSD" => {
                let entry = entry.trim_start_matches("./");
                match source(entry) {
                    Ok(text) => values = file(reader, entry, &text),
                    Err(reason) => reader.fault(binding, format!("source = \"{entry}\": {reason}")),
                }
            }
            Some(_) => reader.fault(binding, "values inside a unit are not read: sourceBase has to be SSD".to_owned()),
            None => {
                let inside = binding.descendants().find(|node| node.has_tag_name_local("ParameterSet"));
                match inside {
                    Some(set) => values = parameters(reader, set),
                    None => reader.fault(binding, "it has neither source nor <ParameterSet>".to_owned()),
                }
            }
        }
        all.extend(values.into_iter().map(|value| Parameter { name: format!("{prefix}{}", value.name), ..value }));
    }
    all
}

/// The values of a `.ssv` file.
fn file(reader: &mut Reader, entry: &str, text: &str) -> Vec<Parameter> {
    let mut inner = Reader::new(entry);
    let values = inner.parse(text).map(|document| parameters(&mut inner, document.root_element())).unwrap_or_default();
    reader.faults.append(&mut inner.faults);
    values
}

fn parameters(reader: &mut Reader, set: Node<'_, '_>) -> Vec<Parameter> {
    if set.tag_name().name() != "ParameterSet" {
        reader.fault(set, format!("<{}> instead of <ParameterSet>", set.tag_name().name()));
        return Vec::new();
    }
    let list = set.children().find(|node| node.has_tag_name_local("Units"));
    let units: BTreeMap<String, BaseUnit> = list.map(|list| units(reader, list)).unwrap_or_default();
    let lists = set.children().filter(|node| node.has_tag_name_local("Parameters"));
    let mut values = Vec::new();
    for parameter in lists.flat_map(|list| list.children()).filter(|node| node.has_tag_name_local("Parameter")) {
        let name = reader.required(parameter, "name");
        let Some(typed) = parameter.children().find(|node| node.is_element() && node.attribute("value").is_some())
        else {
            reader.fault(parameter, format!("the parameter \"{name}\" has no value"));
            continue;
        };
        let unit = typed.attribute("unit").and_then(|unit| units.get(unit)).copied();
        let value = typed.attribute("value").unwrap_or_default().to_owned();
        values.push(Parameter { name, value, unit, entry: reader.entry.clone(), line: reader.line(parameter) });
    }
    values
}
