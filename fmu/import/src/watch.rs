//! What a unit says, compared with what can be.

use crate::description::ModelDescription;
use crate::instance::Port;
use crate::keeping::KeepingError;
use crate::wire::{Wire, Wires};
use toolroom_process::Field;

/// How far wear may fall by rounding, as a share of itself (assumption: a unit that keeps its wear in 32 bits).
const ROUNDING: f64 = 1e-6;

/// Greatest land that a unit may tell of, m. Assumption: ten times what ISO 3685 has for the end of an edge and more; beyond it
/// the unit means another unit.
const GREATEST_LAND: f64 = 10e-3;

/// The outputs of a unit that feed quantities of the process, with the bounds that they are held to.
#[derive(Debug)]
pub(crate) struct Watch {
    outputs: Vec<Watched>,
    /// Which of them is the flank wear.
    wear: Option<usize>,
}

#[derive(Debug)]
struct Watched {
    variable: String,
    unit: String,
    wire: Wire,
    field: Field,
}

impl Watch {
    pub fn of(description: &ModelDescription, outputs: &Wires) -> Self {
        let wired = outputs.fields.iter().zip(&outputs.wires).filter_map(|(field, wire)| Some((field, (*wire)?)));
        let outputs: Vec<Watched> = wired
            .map(|(field, wire)| {
                let variable = description.variables.iter().find(|variable| Port::from_variable(variable) == wire.port);
                Watched {
                    variable: variable.map_or_else(String::new, |variable| variable.name.clone()),
                    unit: variable
                        .and_then(|variable| variable.unit.clone())
                        .map_or(String::new(), |unit| format!(" {unit}")),
                    wire,
                    field: *field,
                }
            })
            .collect();
        let wear = outputs.iter().position(|output| output.field.name == "flank_wear");
        Self { outputs, wear }
    }

    /// Number of outputs.
    pub fn len(&self) -> usize {
        self.outputs.len()
    }

    /// The port of the flank wear.
    pub fn wear(&self) -> Option<Port> {
        self.wear.map(|i| self.outputs[i].wire.port)
    }

    /// Flank wear in SI.
    pub fn inward(&self, wear: f64) -> f64 {
        self.wear.map_or(0.0, |i| self.outputs[i].wire.inward(wear))
    }

    /// Checks `values`, one for each output as the unit gave it at `time` (s); gives the flank wear, which may not
    /// be less than `worn`.
    pub fn check(&self, values: &[f64], time: f64, worn: f64) -> Result<f64, KeepingError> {
        for (output, value) in self.outputs.iter().zip(values) {
            let Watched { variable, unit, field, wire } = output;
            let [min, max] = wire.bounds();
            let refused = |rule: String| {
                let value = told(*value);
                Err(KeepingError::Impossible(format!("at {time} s of its time {variable} = {value}{unit}, {rule}")))
            };
            if !value.is_finite() {
                return refused("which is no finite number".to_owned());
            }
            if *value < min || *value > max {
                return refused(format!("outside {} to {}{unit} of its description", told(min), told(max)));
            }
            if let Err(outside) = field.check(wire.inward(*value)) {
                return refused(format!("which cannot be: {outside}"));
            }
        }
        let Some(i) = self.wear else { return Ok(0.0) };
        let (output, wear) = (&self.outputs[i], self.outputs[i].wire.inward(values[i]));
        if wear > GREATEST_LAND {
            return Err(KeepingError::Impossible(format!(
                "at {time} s of its time {} = {}{}: no land of a cutting edge is wider than {} mm; is the unit right?",
                output.variable,
                told(values[i]),
                output.unit,
                1e3 * GREATEST_LAND
            )));
        }
        if wear < worn * (1.0 - ROUNDING) {
            return Err(KeepingError::Impossible(format!(
                "at {time} s of its time {} = {}{unit} is less than before ({}{unit}): an edge does not grow back",
                output.variable,
                told(values[i]),
                told(output.wire.outward(worn)),
                unit = output.unit,
            )));
        }
        Ok(wear)
    }
}

/// A number in a message: one of many digits by its power of ten.
fn told(value: f64) -> String {
    let many = value.is_finite() && value != 0.0 && !(1e-9..1e12).contains(&value.abs());
    if many { format!("{value:e}") } else { value.to_string() }
}
