//! Wires between quantities of a process in SI and variables of a unit in its own units.

use crate::description::{BaseUnit, ModelDescription, Unit, ValueType, Variable};
use crate::instance::{CallError, Port, StartValue};
use std::ffi::CString;
use toolroom_process::{Field, Kind, ProcessEvent, Wiring, unit};

/// Why a unit does not fit in the place of a process.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WiringError {
    /// A variable that the unit does not have.
    #[error("the unit has no {causality} \"{variable}\" for {quantity}; it has: {known}")]
    UnknownVariable {
        /// What the variable is for.
        quantity: String,
        /// What was looked for.
        variable: String,
        /// `input`, `output` or `parameter`.
        causality: &'static str,
        /// What there is.
        known: String,
    },
    /// A quantity or event that the process does not have.
    #[error("the process has no {kind} \"{name}\"; it has: {known}")]
    UnknownQuantity {
        /// `input`, `output` or `event`.
        kind: &'static str,
        /// What was read.
        name: String,
        /// What there is.
        known: String,
    },
    /// A variable without unit for a quantity with one.
    #[error("\"{variable}\" has no unit, {quantity} is in {due}: write \"{variable} [{due}]\"")]
    NoUnit {
        /// The quantity.
        quantity: String,
        /// The variable.
        variable: String,
        /// A unit that would do.
        due: String,
    },
    /// A unit beside another one of the description.
    #[error("\"{variable}\" is in {own} by its description: leave out [{given}]")]
    OtherUnit {
        /// The variable.
        variable: String,
        /// Its unit by the description.
        own: String,
        /// The unit of the wiring.
        given: String,
    },
    /// An event by something else than a Boolean.
    #[error("\"{variable}\" is of type {value_type}: the event {event} is told by a Boolean output")]
    Event {
        /// The event.
        event: &'static str,
        /// The variable.
        variable: String,
        /// Its type.
        value_type: ValueType,
    },
    /// A unit of another dimension.
    #[error("\"{variable}\" is in {read}, which is no unit of {quantity} ({due})")]
    WrongUnit {
        /// The quantity.
        quantity: String,
        /// The variable.
        variable: String,
        /// Its unit.
        read: String,
        /// The unit that is due.
        due: String,
    },
    /// Another number of start values than elements.
    #[error("start value {value:?} of \"{variable}\": it takes {due} numbers, with blanks between them")]
    StartCount {
        /// The parameter.
        variable: String,
        /// What was read.
        value: String,
        /// How many values are due.
        due: usize,
    },
    /// A start value beyond the bounds of the description.
    #[error("start value {value} of \"{variable}\" is outside {min} to {max} of its description")]
    StartRange {
        /// The parameter.
        variable: String,
        /// What was read.
        value: f64,
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// A start value that its parameter cannot take.
    #[error("start value {value:?} of \"{variable}\" is no {value_type}")]
    StartValue {
        /// The parameter.
        variable: String,
        /// What was read.
        value: String,
        /// Its type.
        value_type: ValueType,
    },
    /// Nothing by which the shop could command the unit.
    #[error("the unit has no input for cutting_speed: wire one with inputs = {{ cutting_speed = \"…\" }}")]
    NoSpeed,
    /// A unit of fixed steps that does not say how long they are.
    #[error(
        "the unit cannot vary its communication step (canHandleVariableCommunicationStepSize) and does not say how long \
         it is: give it as step = \"…\""
    )]
    FixedStep,
    /// A call that failed while the unit was tried out.
    #[error(transparent)]
    Call(#[from] CallError),
}

/// A wire: `SI value = factor · value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wire {
    /// End at the unit.
    pub port: Port,
    factor: f64,
    offset: f64,
    /// Least and greatest value of the variable, in its unit.
    bounds: [f64; 2],
}

impl Wire {
    /// Whether it converts as another one does, to rounding.
    fn is_like(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
        near(self.factor, other.factor) && near(self.offset, other.offset)
    }

    /// The SI `value` in the variable's unit.
    pub fn outward(&self, value: f64) -> f64 {
        if self.factor == 1.0 && self.offset == 0.0 { value } else { (value - self.offset) / self.factor }
    }

    /// Least and greatest value of the variable, in its unit.
    pub fn bounds(&self) -> [f64; 2] {
        self.bounds
    }

    /// The SI `value` in the variable's unit, where its description does not admit it.
    pub fn beyond(&self, value: f64) -> Option<(f64, [f64; 2])> {
        let outward = self.outward(value);
        let [min, max] = self.bounds;
        // A bound that is converted to and fro is met to rounding.
        let slack = 1e-12 * outward.abs();
        (outward < min - slack || outward > max + slack).then_some((outward, self.bounds))
    }

    /// The variable's `value` in SI.
    pub fn inward(&self, value: f64) -> f64 {
        if self.factor == 1.0 && self.offset == 0.0 { value } else { self.factor * value + self.offset }
    }
}

/// Fields of the process that the unit has, with their wires.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wires {
    /// Scalar fields, as the shop sees them.
    pub fields: Vec<Field>,
    /// One wire a field; `None` for a field that the driver takes care of itself.
    pub wires: Vec<Option<Wire>>,
}

impl Wires {
    /// Wires `fields` to variables of `causality`, those of `given` by name and the others where
    /// a variable of the same name is found.
    pub(crate) fn from_model_description(
        description: &ModelDescription,
        fields: &[Field],
        causality: &'static str,
        given: &std::collections::BTreeMap<String, String>,
    ) -> Result<Self, WiringError> {
        let scalars = || fields.iter().filter(|field| field.len == 1);
        for name in given.keys() {
            if scalars().all(|field| field.name != name) {
                let known = scalars().map(|field| field.name).collect::<Vec<_>>().join(", ");
                return Err(WiringError::UnknownQuantity { kind: causality, name: name.clone(), known });
            }
        }
        let mut wires = Self::default();
        for field in scalars() {
            let (variable, unit) = match given.get(field.name) {
                Some(text) => {
                    let (name, unit) = split_unit(text);
                    (named(description, field.name, name, causality)?, unit)
                }
                None => match found(description, field.name, causality) {
                    Some(variable) => (variable, None),
                    None => continue,
                },
            };
            wires.fields.push(*field);
            wires.wires.push(Some(wire(description, field, variable, unit)?));
        }
        Ok(wires)
    }

    /// Takes the field called `name` out and gives its wire.
    pub(crate) fn take(&mut self, name: &str) -> Option<Wire> {
        let index = self.index(name)?;
        self.fields.remove(index);
        self.wires.remove(index)
    }

    /// Index of the field called `name`.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.fields.iter().position(|field| field.name == name)
    }
}

/// The wire of a quantity that the unit has inside, under the name of `field`.
pub(crate) fn inner(description: &ModelDescription, field: &Field) -> Option<Wire> {
    wire(description, field, found(description, field.name, "local")?, None).ok()
}

/// `"vc [m/min]"` to its variable and unit.
fn split_unit(text: &str) -> (&str, Option<&str>) {
    match text.strip_suffix(']').and_then(|text| text.rsplit_once('[')) {
        // A name may end with an index: wear[1].
        Some((name, unit)) if name.ends_with(' ') => (name.trim(), Some(unit.trim())),
        _ => (text.trim(), None),
    }
}

fn named<'d>(
    description: &'d ModelDescription,
    quantity: &str,
    name: &str,
    causality: &'static str,
) -> Result<&'d Variable, WiringError> {
    let fits = |variable: &&Variable| {
        let same = variable.causality == causality || (causality == "output" && variable.causality == "local");
        same && variable.dimensions.is_empty() && !variable.clocked
    };
    description.variables.iter().filter(fits).find(|variable| variable.name == name).ok_or_else(|| {
        let known = description.variables.iter().filter(fits).map(|variable| variable.name.as_str()).take(40);
        WiringError::UnknownVariable {
            quantity: quantity.to_owned(),
            variable: name.to_owned(),
            causality,
            known: known.collect::<Vec<_>>().join(", "),
        }
    })
}

/// The variable called `name`, or the only one of this causality whose last part it is.
fn found<'d>(description: &'d ModelDescription, name: &str, causality: &str) -> Option<&'d Variable> {
    let fits =
        |variable: &&Variable| variable.causality == causality && variable.dimensions.is_empty() && !variable.clocked;
    let exact = description.variables.iter().filter(fits).find(|variable| variable.name == name);
    exact.or_else(|| {
        let last = |variable: &&Variable| variable.name.rsplit_once('.').is_some_and(|(_, last)| last == name);
        let mut candidates = description.variables.iter().filter(fits).filter(last);
        candidates.next().filter(|_| candidates.next().is_none())
    })
}

fn wire(
    description: &ModelDescription,
    field: &Field,
    variable: &Variable,
    given: Option<&str>,
) -> Result<Wire, WiringError> {
    let port = Port::from_variable(variable);
    let bounds = variable.bounds();
    if field.kind != Kind::Real || field.unit == "1" && given.is_none() && variable.unit.is_none() {
        return Ok(Wire { port, factor: 1.0, offset: 0.0, bounds });
    }
    let (quantity, name) = (field.name.to_owned(), variable.name.clone());
    let wrong = |read: &str| WiringError::WrongUnit {
        quantity: quantity.clone(),
        variable: name.clone(),
        read: read.to_owned(),
        due: field.display.to_owned(),
    };
    if let Some(text) = given {
        let (zero, one) = (unit::convert(0.0, text, field.unit), unit::convert(1.0, text, field.unit));
        if !one.is_finite() {
            return Err(wrong(text));
        }
        let offset = if variable.relative { 0.0 } else { zero };
        let given = Wire { port, factor: one - zero, offset, bounds };
        return match &variable.unit {
            // The same unit by another name is no contradiction.
            Some(own) if wire(description, field, variable, None).is_ok_and(|by_own| !by_own.is_like(&given)) => {
                Err(WiringError::OtherUnit { variable: name, own: own.clone(), given: text.to_owned() })
            }
            _ => Ok(given),
        };
    }
    let Some(unit) = &variable.unit else {
        return Err(WiringError::NoUnit { quantity, variable: name, due: field.display.to_owned() });
    };
    let base = description.units.get(unit).and_then(|unit: &Unit| unit.base);
    // A unit without base units is known by its name alone.
    let (factor, offset) = match base {
        Some(base) if base.powers == powers(field.unit) => (base.factor, base.offset),
        Some(_) => return Err(wrong(unit)),
        None => {
            let zero = unit::convert(0.0, unit, field.unit);
            (unit::convert(1.0, unit, field.unit) - zero, zero)
        }
    };
    let offset = if variable.relative { 0.0 } else { offset };
    if factor.is_finite() && factor != 0.0 { Ok(Wire { port, factor, offset, bounds }) } else { Err(wrong(unit)) }
}

/// Powers of kg, m, s, A, K, mol, cd, rad of an SI unit.
fn powers(si: &str) -> [i32; 8] {
    unit::parse(si).map_or([0; 8], |unit| BaseUnit::from_unit(unit).powers)
}

/// Boolean outputs that tell of events, by name or from `given`.
pub(crate) fn events(
    description: &ModelDescription,
    wiring: &Wiring,
) -> Result<Vec<(ProcessEvent, Port)>, WiringError> {
    // What ends an edge comes first: it is what counts where two happen in one step.
    const EVENTS: [ProcessEvent; 3] = [ProcessEvent::Chipping, ProcessEvent::ThermalCollapse, ProcessEvent::WearLimit];
    for name in wiring.events.keys() {
        if EVENTS.iter().all(|event| event.name() != name) {
            let known = EVENTS.map(ProcessEvent::name).join(", ");
            return Err(WiringError::UnknownQuantity { kind: "event", name: name.clone(), known });
        }
    }
    let mut events = Vec::new();
    for event in EVENTS {
        let variable = match wiring.events.get(event.name()) {
            Some(name) => Some(named(description, event.name(), name, "output")?),
            None => found(description, event.name(), "output"),
        };
        let boolean = variable.filter(|variable| variable.value_type == ValueType::Boolean);
        if let (Some(named), None) = (variable.filter(|_| wiring.events.contains_key(event.name())), boolean) {
            let (variable, value_type) = (named.name.clone(), named.value_type);
            return Err(WiringError::Event { event: event.name(), variable, value_type });
        }
        events.extend(boolean.map(|variable| (event, Port::from_variable(variable))));
    }
    Ok(events)
}

/// The start values of `wiring` as the unit takes them, in the order in which they are set: structural parameters, texts,
/// numbers.
///
/// # Errors
/// [`WiringError`]: a variable that has no start value, or a value that is none of its type.
pub fn start_values(description: &ModelDescription, wiring: &Wiring) -> Result<Vec<(Port, StartValue)>, WiringError> {
    let settable = |variable: &&Variable| {
        matches!(variable.causality.as_str(), "parameter" | "structuralParameter" | "input")
            || matches!(variable.initial.as_deref(), Some("exact" | "approx"))
    };
    let mut values: Vec<(Port, StartValue)> = Vec::new();
    for (name, text) in &wiring.start {
        let variable = description.variables.iter().filter(settable).find(|variable| variable.name == *name);
        let unknown = || WiringError::UnknownVariable {
            quantity: "a start value".to_owned(),
            variable: name.clone(),
            causality: "parameter",
            known: description
                .variables
                .iter()
                .filter(settable)
                .map(|v| v.name.as_str())
                .take(40)
                .collect::<Vec<_>>()
                .join(", "),
        };
        let variable = variable.ok_or_else(unknown)?;
        let refused =
            || WiringError::StartValue { variable: name.clone(), value: text.clone(), value_type: variable.value_type };
        let extents = description.extents(variable, &wiring.start).ok_or_else(refused)?;
        let count = extents.iter().product::<u64>() as u32;
        let port = Port { count, ..Port::from_variable(variable) };
        let number = |text: &str| match text {
            "true" => Some(1.0),
            "false" => Some(0.0),
            text => text.parse::<f64>().ok().filter(|value| value.is_finite()),
        };
        let number = |text: &str| number(text).filter(|value| variable.value_type.holds(*value));
        let numbers = || text.split_whitespace().map(number).collect::<Option<Vec<f64>>>();
        let value = match variable.value_type {
            ValueType::String if count == 1 => CString::new(text.as_str()).ok().map(StartValue::Text),
            ValueType::String | ValueType::Binary | ValueType::Clock => None,
            ValueType::Float64
            | ValueType::Float32
            | ValueType::Integer(..)
            | ValueType::Boolean
            | ValueType::Enumeration => {
                let numbers = numbers().ok_or_else(refused)?;
                if numbers.len() != count as usize {
                    let (variable, value, due) = (name.clone(), text.clone(), count as usize);
                    return Err(WiringError::StartCount { variable, value, due });
                }
                let [min, max] = variable.bounds();
                if let Some(value) = numbers.iter().copied().find(|value| *value < min || *value > max) {
                    return Err(WiringError::StartRange { variable: name.clone(), value, min, max });
                }
                match numbers[..] {
                    [number] if variable.causality == "structuralParameter" => Some(StartValue::Structure(number)),
                    // A size is one number.
                    _ if variable.causality == "structuralParameter" => None,
                    _ => Some(StartValue::Numbers(numbers)),
                }
            }
        };
        values.push((port, value.ok_or_else(refused)?));
    }
    // Structural parameters have a mode of their own, before all others. A string such as the name of a parameter set
    // may set other parameters: it goes before them.
    values.sort_by_key(|(_, value)| match value {
        StartValue::Structure(_) => 0,
        StartValue::Text(_) => 1,
        StartValue::Numbers(_) => 2,
    });
    Ok(values)
}
