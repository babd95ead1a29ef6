//! Units and types of the model description, from the units of the fields.

use super::Description;
use crate::variable::ValueType;
use toolroom_process::unit;

/// A unit with the display units that fields ask for.
pub(super) struct UnitDefinition {
    /// SI name.
    pub name: &'static str,
    /// Powers of the base units of FMI.
    pub base: Vec<(&'static str, String)>,
    /// Name, factor and offset of each display unit.
    pub display: Vec<(&'static str, f64, f64)>,
}

/// Name of the physical quantity of an SI unit, in the words of ISO 80000.
pub(super) fn quantity(unit: &str) -> Option<&'static str> {
    Some(match unit {
        "m" => "Length",
        "m2" => "Area",
        "m/s" => "Velocity",
        "m/s2" => "Acceleration",
        "m3/s" => "VolumeFlowRate",
        "s" => "Time",
        "K" => "ThermodynamicTemperature",
        "N" => "Force",
        "N/m" => "Stiffness",
        "Pa" => "Pressure",
        "J" => "Energy",
        "W" => "Power",
        "V" => "ElectricPotential",
        "rad" => "Angle",
        "rad/s" => "AngularVelocity",
        "J/mol" => "MolarEnergy",
        "kg/m3" => "Density",
        _ => return None,
    })
}

/// Every unit that a variable uses, in the order of first use.
pub(super) fn units(description: &Description) -> Vec<UnitDefinition> {
    let mut units: Vec<UnitDefinition> = Vec::new();
    for variable in description.variables.iter().filter(|variable| variable.value_type == ValueType::Real) {
        let field = &variable.field;
        let index = units.iter().position(|unit| unit.name == field.unit).unwrap_or_else(|| {
            units.push(UnitDefinition { name: field.unit, base: unit_powers(field.unit), display: Vec::new() });
            units.len() - 1
        });
        let display = &mut units[index].display;
        if field.display != field.unit && display.iter().all(|(name, ..)| *name != field.display) {
            let offset = field.to_display(0.0);
            display.push((field.display, field.to_display(1.0) - offset, offset));
        }
    }
    units
}

/// Powers of the base units of FMI and SSP in an SI unit, name and power. A revolution of the unit system is a radian there.
///
/// ```
/// assert_eq!(toolroom_fmu::unit_powers("m/s"), [("m", "1".to_owned()), ("s", "-1".to_owned())]);
/// ```
pub fn unit_powers(si: &str) -> Vec<(&'static str, String)> {
    const NAMES: [&str; 7] = ["m", "kg", "s", "K", "A", "mol", "rad"];
    let dimension = unit::parse(si).map_or([0; 8], |unit| unit.dimension);
    NAMES
        .into_iter()
        .zip(dimension)
        .filter(|(_, power)| *power != 0)
        .map(|(name, power)| (name, power.to_string()))
        .collect()
}

/// Name of the type of variables with this unit and display unit.
pub(super) fn type_name(unit: &str, display: &str) -> String {
    format!("{} in {display}", quantity(unit).unwrap_or("Quantity"))
}

/// Unit and display unit of every type, in the order of first use.
pub(super) fn types(description: &Description) -> Vec<(&'static str, &'static str)> {
    let mut types = Vec::new();
    for variable in description.variables.iter().filter(|variable| variable.value_type == ValueType::Real) {
        let quantity = (variable.field.unit, variable.field.display);
        if !types.contains(&quantity) {
            types.push(quantity);
        }
    }
    types
}
