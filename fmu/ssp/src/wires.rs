//! From connections by name to ports with a conversion.

use crate::error::MasterError;
use crate::structure::{Boundary, Connection, SystemStructure};
use crate::values::Parameter;
use toolroom_fmu_import::description::BaseUnit;
use toolroom_fmu_import::{ModelDescription, Port, ValueType, Variable};

/// A signal: the value at `to` is `factor · value + offset` of the one at `from`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wire {
    /// Component and place among its outputs.
    pub from: (usize, usize),
    /// Component of the input.
    pub to: usize,
    /// The input.
    pub port: Port,
    pub factor: f64,
    pub offset: f64,
}

/// A variable that is read at every step.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    pub port: Port,
    /// Name and unit, as the head of a column.
    pub head: String,
    pub name: String,
}

/// An output of the system itself: `factor · value + offset` of one of a component.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    /// Component and place among its outputs.
    from: (usize, usize),
    factor: f64,
    offset: f64,
    /// Name and unit, as the head of a column.
    pub head: String,
}

impl Shown {
    /// Its value where components have these.
    pub fn value(&self, values: &[Vec<f64>]) -> f64 {
        self.factor * values[self.from.0][self.from.1] + self.offset
    }
}

fn is_number(variable: &Variable) -> bool {
    variable.dimensions.is_empty()
        && !matches!(variable.value_type, ValueType::String | ValueType::Binary | ValueType::Clock)
}

/// Outputs of a component that a table holds: its connectors, or all outputs of a unit without connectors.
pub(crate) fn outputs(structure: &SystemStructure, index: usize, description: &ModelDescription) -> Vec<Output> {
    let component = &structure.components[index];
    let named = |variable: &&Variable| {
        let mut connectors = component.connectors.iter();
        if component.connectors.is_empty() {
            variable.causality == "output"
        } else {
            connectors.any(|each| each.name == variable.name && each.kind != "input" && each.kind != "parameter")
        }
    };
    let output = |variable: &Variable| {
        let unit = variable.unit.as_ref().filter(|unit| *unit != "1");
        let unit = unit.map_or(String::new(), |unit| format!(" [{unit}]"));
        let name = format!("{}.{}", component.name, variable.name);
        Output { port: Port::from_variable(variable), head: format!("{name}{unit}"), name: variable.name.clone() }
    };
    description.variables.iter().filter(named).filter(|variable| is_number(variable)).map(output).collect()
}

/// The unit of a connector in terms of SI: its own by the definitions of the structure, or that of its variable.
fn base(
    structure: &SystemStructure,
    component: usize,
    variable: &Variable,
    description: &ModelDescription,
) -> Option<BaseUnit> {
    let connector = structure.components[component].connectors.iter().find(|each| each.name == variable.name);
    let given = connector.and_then(|connector| connector.unit.as_ref());
    given
        .and_then(|unit| structure.units.get(unit))
        .copied()
        .or_else(|| description.units.get(variable.unit.as_ref()?)?.base)
}

/// The unit of a connector as it is written: its own, or that of its variable.
fn written(structure: &SystemStructure, component: usize, variable: &Variable) -> String {
    let connector = structure.components[component].connectors.iter().find(|each| each.name == variable.name);
    let given = connector.and_then(|connector| connector.unit.as_ref());
    given.or(variable.unit.as_ref()).cloned().unwrap_or_default()
}

/// Connections as wires.
pub(crate) fn wires(
    structure: &SystemStructure,
    units: &[&ModelDescription],
    outputs: &[Vec<Output>],
) -> Result<Vec<Wire>, MasterError> {
    let wire = |connection: &Connection| {
        let (from, to) = (&connection.from, &connection.to);
        let refused = |reason: String| {
            let connection = format!("{} -> {}", structure.named(from), structure.named(to));
            MasterError::Connection { connection, reason }
        };
        let variable = |end: &crate::End, unit: &ModelDescription| {
            let variable = unit.variable(&end.connector).cloned();
            variable.ok_or_else(|| refused(format!("the unit has no variable \"{}\"", end.connector)))
        };
        let (source, target) = (variable(from, units[from.component])?, variable(to, units[to.component])?);
        let place = outputs[from.component].iter().position(|output| output.name == from.connector);
        let (Some(place), true) = (place, is_number(&target)) else {
            return Err(refused("only scalar numbers and Booleans are signals".to_owned()));
        };
        let (mut factor, mut offset) = (connection.factor, connection.offset);
        let bases = (
            base(structure, from.component, &source, units[from.component]),
            base(structure, to.component, &target, units[to.component]),
        );
        if let (true, (Some(one), Some(other))) = (connection.converts, bases) {
            let (unit, shift) = one.conversion(other).ok_or_else(|| {
                let units = [written(structure, from.component, &source), written(structure, to.component, &target)];
                refused(format!("[{}] is no unit of what is in [{}]", units[0], units[1]))
            })?;
            // 10 °C of a difference are 10 K.
            let shift = if source.relative || target.relative { 0.0 } else { shift };
            // The transformation comes after the units were converted.
            (factor, offset) = (factor * unit, factor * shift + offset);
        }
        Ok(Wire { from: (from.component, place), to: to.component, port: Port::from_variable(&target), factor, offset })
    };
    for (component, unit) in structure.components.iter().zip(units) {
        for connector in &component.connectors {
            let Some(variable) = unit.variable(&connector.name) else { continue };
            let contrary = match connector.kind.as_str() {
                "input" => {
                    matches!(variable.causality.as_str(), "output" | "local" | "independent" | "calculatedParameter")
                }
                "output" => matches!(variable.causality.as_str(), "input" | "parameter" | "structuralParameter"),
                _ => false, // of parameters the kinds of both standards differ
            };
            if contrary {
                let connection = format!("{}.{}", component.name, connector.name);
                let reason = format!("{} of the system, but {} of the unit", connector.kind, variable.causality);
                return Err(MasterError::Connection { connection, reason });
            }
        }
    }
    structure.connections.iter().map(wire).collect()
}

/// Outputs of the system that a table holds, in their own units where the file gives them.
pub(crate) fn shown(
    structure: &SystemStructure,
    units: &[&ModelDescription],
    outputs: &[Vec<Output>],
) -> Result<Vec<Shown>, MasterError> {
    let connectors = structure.boundary.iter().filter(|connector| connector.kind == "output");
    let mut found = Vec::new();
    for connector in connectors {
        let Boundary { name, unit, ends, .. } = connector;
        // Without a connection it has no value, and one of a text or an array has no column.
        let Some(end) = ends.first() else { continue };
        let Some(place) = outputs[end.component].iter().position(|output| output.name == end.connector) else {
            continue;
        };
        let Some(variable) = units[end.component].variable(&end.connector) else { continue };
        let (mut factor, mut offset) = (connector.factor, connector.offset);
        let own = unit.as_ref().and_then(|unit| structure.units.get(unit)).copied();
        let bases = (base(structure, end.component, variable, units[end.component]), own);
        if let (true, (Some(one), Some(other))) = (connector.converts, bases) {
            let (scale, shift) = one.conversion(other).ok_or_else(|| MasterError::Connection {
                connection: format!("{} -> {name} of the system", structure.named(end)),
                reason: "their units are of other dimensions".to_owned(),
            })?;
            let shift = if variable.relative { 0.0 } else { shift };
            (factor, offset) = (factor * scale, factor * shift + offset);
        }
        let shown = unit.as_ref().or(variable.unit.as_ref()).filter(|unit| *unit != "1");
        let head = format!("{name}{}", shown.map_or(String::new(), |unit| format!(" [{unit}]")));
        found.push(Shown { from: (end.component, place), factor, offset, head });
    }
    Ok(found)
}

/// A start value as the unit takes it: in the unit of its variable.
pub(crate) fn start_value(parameter: &Parameter, unit: &ModelDescription) -> Result<String, String> {
    let Some(given) = parameter.unit else { return Ok(parameter.value.clone()) };
    let variable = unit.variable(&parameter.name).ok_or("the unit has no such variable")?;
    let Some(base_unit) = variable.unit.as_ref().and_then(|name| unit.units.get(name)?.base) else {
        return Ok(parameter.value.clone());
    };
    let (factor, shift) = given.conversion(base_unit).ok_or("its unit is not one of the variable")?;
    let offset = if variable.relative { 0.0 } else { shift };
    if (factor, offset) == (1.0, 0.0) {
        return Ok(parameter.value.clone());
    }
    let value: f64 = parameter.value.trim().parse().map_err(|_| "it is no number, and has a unit")?;
    Ok((factor * value + offset).to_string())
}
