//! From XML to [`ModelDescription`], fault by fault.

use super::{
    BaseUnit, DeclaredType, Dimension, Experiment, Fault, Interface, ModelDescription, Reading, Unit, Unknown,
    ValueType, Variable,
};
use crate::xml;
use roxmltree::Node;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::str::FromStr;

pub(super) fn description(text: &str) -> Reading {
    let mut reader = Reader { faults: Vec::new(), lines: Lines::of(text) };
    let description = match xml::document(text) {
        Ok(document) => {
            let description = reader.root(document.root_element());
            if let Some(description) = &description {
                reader.schema(document.root_element(), description.major);
            }
            description
        }
        Err((line, message)) => {
            reader.faults.push(Fault { line, message });
            None
        }
    };
    reader.faults.sort_by_key(|fault| fault.line);
    Reading { description, faults: reader.faults }
}

/// Starts of lines: finding a line by counting from the start each time is quadratic.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        let mark = text.len() - text.strip_prefix('\u{FEFF}').unwrap_or(text).len();
        Self(text[mark..].bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect())
    }

    fn line(&self, offset: usize) -> u32 {
        self.0.partition_point(|end| *end < offset) as u32 + 1
    }
}

struct Reader {
    faults: Vec<Fault>,
    lines: Lines,
}

impl Reader {
    fn line(&self, node: Node<'_, '_>) -> u32 {
        self.lines.line(node.range().start)
    }

    fn fault(&mut self, node: Node<'_, '_>, message: impl Into<String>) {
        let line = self.line(node);
        self.faults.push(Fault { line, message: message.into() });
    }

    /// What the schema of the standard says against lines on which nothing else is wrong.
    fn schema(&mut self, root: Node<'_, '_>, major: u8) {
        let faulty_lines: BTreeSet<u32> = self.faults.iter().map(|fault| fault.line).collect();
        for (node, message) in super::schema::faults(root, major) {
            if !faulty_lines.contains(&self.line(node)) {
                self.fault(node, message);
            }
        }
    }

    /// An attribute that has to be there.
    fn required<'a>(&mut self, node: Node<'a, '_>, name: &str) -> Option<&'a str> {
        let value = node.attribute(name);
        if value.is_none() {
            self.fault(node, format!("<{}> lacks the attribute {name}", node.tag_name().name()));
        }
        value
    }

    /// An attribute that is a number, if it is there.
    fn number<T: FromStr>(&mut self, node: Node<'_, '_>, name: &str) -> Option<T> {
        let text = node.attribute(name)?;
        let value = text.trim().parse().ok();
        if value.is_none() {
            self.fault(node, format!("{name} = \"{text}\" is no number"));
        }
        value
    }

    fn root(&mut self, root: Node<'_, '_>) -> Option<ModelDescription> {
        if root.tag_name().name() != "fmiModelDescription" {
            self.fault(root, format!("<{}> instead of <fmiModelDescription>", root.tag_name().name()));
            return None;
        }
        let fmi_version = self.required(root, "fmiVersion")?.to_owned();
        // Releases of FMI 3 differ in what an importer may pass over; there is no other FMI 2 than 2.0.
        let major = match fmi_version.split_once('.') {
            Some(("2", "0")) => 2,
            Some(("3", _)) => 3,
            _ => {
                self.fault(root, format!("fmiVersion = \"{fmi_version}\" is not read; 2.0 and 3.0 are, and later 3.x"));
                return None;
            }
        };
        let token = self.required(root, if major == 2 { "guid" } else { "instantiationToken" }).unwrap_or_default();
        let mut description = ModelDescription {
            fmi_version,
            major,
            model_name: self.required(root, "modelName").unwrap_or_default().to_owned(),
            token: token.to_owned(),
            about: attributes(root),
            ..ModelDescription::default()
        };
        let mut structure = None;
        let mut variables = None;
        for child in root.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "CoSimulation" => description.co_simulation = Some(self.interface(child)),
                "ModelExchange" => description.model_exchange = Some(self.interface(child)),
                "ScheduledExecution" => description.scheduled_execution = Some(self.interface(child)),
                "UnitDefinitions" => description.units = self.units(child),
                "TypeDefinitions" => description.types = self.types(child),
                "LogCategories" => {
                    let named = elements(child).filter_map(|category| self.required(category, "name"));
                    description.log_categories = named.map(str::to_owned).collect();
                }
                "DefaultExperiment" => {
                    description.experiment = Experiment {
                        start: self.number(child, "startTime"),
                        stop: self.number(child, "stopTime"),
                        tolerance: self.number(child, "tolerance"),
                        step: self.number(child, "stepSize"),
                    }
                }
                "ModelVariables" => variables = Some(child),
                "ModelStructure" => structure = Some(child),
                "VendorAnnotations" | "Annotations" => {}
                other => self.fault(child, format!("<{other}> is no element of <fmiModelDescription>")),
            }
        }
        match variables {
            Some(node) => self.variables(node, &mut description),
            None => self.fault(root, "there are no <ModelVariables>"),
        }
        match structure {
            Some(node) => self.structure(node, &mut description),
            None => self.fault(root, "there is no <ModelStructure>"),
        }
        if major == 2 {
            description.structure.event_indicators = self.number(root, "numberOfEventIndicators").unwrap_or(0);
        }
        Some(description)
    }

    fn interface(&mut self, node: Node<'_, '_>) -> Interface {
        let identifier = self.required(node, "modelIdentifier").unwrap_or_default().to_owned();
        Interface { identifier, attributes: attributes(node) }
    }

    fn units(&mut self, node: Node<'_, '_>) -> BTreeMap<String, Unit> {
        let mut units = BTreeMap::new();
        for unit in elements(node) {
            let Some(name) = self.required(unit, "name") else { continue };
            let mut read = Unit::default();
            for child in elements(unit) {
                match child.tag_name().name() {
                    "BaseUnit" => {
                        const SYMBOLS: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
                        for attribute in child.attributes() {
                            if !SYMBOLS.contains(&attribute.name()) && !matches!(attribute.name(), "factor" | "offset")
                            {
                                self.fault(child, format!("<BaseUnit> has no attribute {}", attribute.name()));
                            }
                        }
                        read.base = Some(BaseUnit {
                            factor: self.number(child, "factor").unwrap_or(1.0),
                            offset: self.number(child, "offset").unwrap_or(0.0),
                            powers: SYMBOLS.map(|symbol| self.number(child, symbol).unwrap_or(0)),
                        });
                    }
                    "DisplayUnit" => read.display.extend(self.required(child, "name").map(str::to_owned)),
                    _ => {}
                }
            }
            if units.insert(name.to_owned(), read).is_some() {
                self.fault(unit, format!("two units are called {name}"));
            }
        }
        units
    }

    /// Types with what variables take from them; FMI 2.0 has it on a child element.
    fn types(&mut self, node: Node<'_, '_>) -> BTreeMap<String, DeclaredType> {
        let mut types = BTreeMap::new();
        for type_node in elements(node) {
            let Some(name) = self.required(type_node, "name") else { continue };
            let said = |attribute| {
                let own = type_node.attribute(attribute);
                own.or_else(|| elements(type_node).find_map(|child| child.attribute(attribute)))
            };
            let declared = DeclaredType {
                unit: said("unit").map(str::to_owned),
                relative: said("relativeQuantity").is_some_and(is_true),
            };
            if types.insert(name.to_owned(), declared).is_some() {
                self.fault(type_node, format!("two types are called {name}"));
            }
        }
        types
    }

    fn variables(&mut self, node: Node<'_, '_>, description: &mut ModelDescription) {
        let mut names: HashMap<String, u32> = HashMap::new();
        // Derivatives name their state by index (FMI 2.0) or value reference (FMI 3.0), which may
        // come later.
        let mut derivatives = Vec::new();
        let mut clocked: Vec<(u32, u32)> = Vec::new();
        for element in elements(node) {
            let (typed, value_type) = if description.major == 2 {
                let typed =
                    elements(element).find_map(|child| ValueType::named(child.tag_name().name()).map(|t| (child, t)));
                let Some(found) = typed.filter(|_| element.tag_name().name() == "ScalarVariable") else {
                    self.fault(element, format!("<{}> is no variable with a type", element.tag_name().name()));
                    continue;
                };
                found
            } else {
                let Some(value_type) = ValueType::named(element.tag_name().name()) else {
                    self.fault(element, format!("<{}> is no type of variable", element.tag_name().name()));
                    continue;
                };
                (element, value_type)
            };
            let Some(name) = self.required(element, "name") else { continue };
            let _ = self.required(element, "valueReference");
            let Some(reference) = self.number(element, "valueReference") else { continue };
            let line = self.line(element);
            for (each, of) in std::iter::once((name, element)).chain(
                elements(element)
                    .filter(|child| child.tag_name().name() == "Alias")
                    .filter_map(|child| Some((child.attribute("name")?, child))),
            ) {
                if let Some(before) = names.insert(each.to_owned(), line) {
                    self.fault(of, format!("the name {each} is taken by the variable of line {before}"));
                }
            }
            let causality = element.attribute("causality").unwrap_or("local").to_owned();
            let float = matches!(value_type, ValueType::Float64 | ValueType::Float32);
            let variability = element.attribute("variability").map(str::to_owned).unwrap_or_else(|| {
                let fixed = matches!(causality.as_str(), "parameter" | "structuralParameter" | "calculatedParameter");
                // FMI 2.0 makes everything continuous by default, FMI 3.0 only reals.
                let standard = if fixed && description.major == 3 {
                    "fixed"
                } else if float || description.major == 2 {
                    "continuous"
                } else {
                    "discrete"
                };
                standard.to_owned()
            });
            let declared_type = typed.attribute("declaredType").map(str::to_owned);
            let from_type = declared_type.as_ref().and_then(|name| description.types.get(name));
            let type_unit = || from_type.and_then(|declared| declared.unit.clone());
            let type_relative = from_type.is_some_and(|declared| declared.relative);
            let relative = typed.attribute("relativeQuantity").map_or(type_relative, is_true);
            let start = typed.attribute("start").map(str::to_owned).or_else(|| {
                let starts: Vec<&str> = elements(element)
                    .filter(|c| c.tag_name().name() == "Start")
                    .filter_map(|c| c.attribute("value"))
                    .collect();
                (!starts.is_empty()).then(|| starts.join(" "))
            });
            let initial =
                element.attribute("initial").map(str::to_owned).or_else(|| default_initial(&causality, &variability));
            if let Some(state) = typed.attribute("derivative") {
                derivatives.push((description.variables.len(), state.to_owned(), line));
            }
            // What is no number is told by the schema.
            let ticked = element.attribute("clocks").filter(|_| description.major == 3).unwrap_or_default();
            clocked.extend(ticked.split_whitespace().filter_map(|clock| Some((line, clock.parse().ok()?))));
            let unit = typed.attribute("unit").map(str::to_owned).or_else(type_unit);
            let shown = std::iter::once(typed)
                .chain(elements(element))
                .filter_map(|each| Some((each, each.attribute("displayUnit")?)));
            for (type_node, display) in
                shown.filter(|(type_node, _)| *type_node == typed || type_node.tag_name().name() == "Alias")
            {
                let known = unit.as_ref().and_then(|unit| description.units.get(unit));
                if !known.is_some_and(|unit| unit.display.iter().any(|known| known == display)) {
                    let with_unit = unit.as_deref().map_or_else(String::new, |unit| format!(" of unit \"{unit}\""));
                    self.fault(type_node, format!("displayUnit \"{display}\" is not among those{with_unit}"));
                }
            }
            description.variables.push(Variable {
                name: name.to_owned(),
                reference,
                value_type,
                causality,
                variability,
                initial,
                start,
                unit,
                relative,
                declared_type,
                min: self.number(typed, "min"),
                max: self.number(typed, "max"),
                nominal: self.number(typed, "nominal"),
                derivative_of: None,
                clocked: description.major == 3 && element.has_attribute("clocks"),
                interval_variability: element.attribute("intervalVariability").map(str::to_owned),
                dimensions: self.dimensions(element),
                description: element.attribute("description").unwrap_or_default().to_owned(),
                line,
            });
        }
        for (line, clock) in clocked {
            if description.clocks().all(|variable| variable.reference != clock) {
                self.faults
                    .push(Fault { line, message: format!("clocks: {clock} is the value reference of no clock") });
            }
        }
        let by_reference = references(description);
        for (index, of, line) in derivatives {
            match self.variable(&of, description, &by_reference) {
                Some(state) => description.variables[index].derivative_of = Some(state),
                None => self.faults.push(Fault { line, message: format!("derivative = \"{of}\" names no variable") }),
            }
        }
    }

    fn dimensions(&mut self, element: Node<'_, '_>) -> Vec<Dimension> {
        let mut dimensions = Vec::new();
        for child in elements(element).filter(|child| child.tag_name().name() == "Dimension") {
            let size = match (self.number(child, "start"), self.number(child, "valueReference")) {
                (Some(size), None) => Dimension::Fixed(size),
                (None, Some(reference)) => Dimension::Of(reference),
                (None, None) | (Some(_), Some(_)) => {
                    self.fault(child, "<Dimension> has either start or valueReference");
                    Dimension::Fixed(0)
                }
            };
            dimensions.push(size);
        }
        dimensions
    }

    /// The variable that `text` names: an index from 1 in FMI 2.0, a value reference in FMI 3.0.
    fn variable(
        &self,
        text: &str,
        description: &ModelDescription,
        by_reference: &HashMap<u32, usize>,
    ) -> Option<usize> {
        let number: u32 = text.trim().parse().ok()?;
        if description.major == 2 {
            let index = (number as usize).checked_sub(1)?;
            (index < description.variables.len()).then_some(index)
        } else {
            by_reference.get(&number).copied()
        }
    }

    fn structure(&mut self, node: Node<'_, '_>, description: &mut ModelDescription) {
        let by_reference = references(description);
        // FMI 2.0 has lists of <Unknown>, FMI 3.0 the unknowns themselves.
        for element in elements(node) {
            let kind = element.tag_name().name();
            let unknowns: Vec<Node<'_, '_>> = match kind {
                "Outputs" | "Derivatives" | "InitialUnknowns" => elements(element).collect(),
                "Output" | "ContinuousStateDerivative" | "InitialUnknown" | "ClockedState" | "EventIndicator" => {
                    vec![element]
                }
                other => {
                    self.fault(element, format!("<{other}> is no element of <ModelStructure>"));
                    continue;
                }
            };
            for unknown in unknowns {
                let named = if description.major == 2 { "index" } else { "valueReference" };
                let Some(text) = self.required(unknown, named) else { continue };
                let Some(variable) = self.variable(text, description, &by_reference) else {
                    self.fault(unknown, format!("{named} = \"{text}\" names no variable"));
                    continue;
                };
                let dependencies = unknown.attribute("dependencies").map(|list| {
                    let mut known = Vec::new();
                    for reference in list.split_whitespace() {
                        match self.variable(reference, description, &by_reference) {
                            Some(index) => known.push(index),
                            None => self.fault(unknown, format!("dependency \"{reference}\" names no variable")),
                        }
                    }
                    known
                });
                if let Some(kinds) = unknown.attribute("dependenciesKind") {
                    let (kinds, due) = (
                        kinds.split_whitespace().count(),
                        unknown.attribute("dependencies").map_or(0, |list| list.split_whitespace().count()),
                    );
                    if kinds != due {
                        self.fault(unknown, format!("{kinds} dependenciesKind for {due} dependencies"));
                    }
                }
                let unknown = Unknown { variable, dependencies, line: self.line(unknown) };
                let structure = &mut description.structure;
                match kind {
                    "Outputs" | "Output" => structure.outputs.push(unknown),
                    "Derivatives" | "ContinuousStateDerivative" => structure.derivatives.push(unknown),
                    "InitialUnknowns" | "InitialUnknown" => structure.initial.push(unknown),
                    "EventIndicator" => structure.event_indicators += 1,
                    _ => {}
                }
            }
        }
    }
}

fn elements<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

fn attributes(node: Node<'_, '_>) -> BTreeMap<String, String> {
    node.attributes().map(|attribute| (attribute.name().to_owned(), attribute.value().to_owned())).collect()
}

fn references(description: &ModelDescription) -> HashMap<u32, usize> {
    description.variables.iter().enumerate().map(|(index, variable)| (variable.reference, index)).collect()
}

/// The default of `initial` (FMI 2.0.4 table in 2.2.7, FMI 3.0.2 in 2.4.7.5).
fn default_initial(causality: &str, variability: &str) -> Option<String> {
    let initial = match (causality, variability) {
        ("input" | "independent", _) => return None,
        ("parameter" | "structuralParameter", _) | (_, "constant") => "exact",
        _ => "calculated",
    };
    Some(initial.to_owned())
}

/// An `xs:boolean` that is true.
pub(super) fn is_true(value: &str) -> bool {
    matches!(value, "true" | "1")
}
