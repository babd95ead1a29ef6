//! The variables of a unit, made from the fields of its records.

use crate::configured::Configured;
use crate::unit::Unit;
use toolroom_process::{Field, Kind, Record};

/// What a variable stands for; also its value reference.
///
/// Every kind has a block of its own, so that references of one block do not move when another
/// grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The independent variable.
    Time,
    /// Input field.
    Input(usize),
    /// State field.
    State(usize),
    /// Derivative of a state field.
    Derivative(usize),
    /// Output field.
    Output(usize),
    /// Parameter.
    Parameter(usize),
    /// Event indicator.
    Indicator(usize),
    /// Whether an event has happened since the last renewal.
    Event(usize),
    /// Input that renews a part of the state.
    Renewal(usize),
    /// How often.
    Count(usize),
    /// Whether the edge is lost.
    Lost,
    /// Speed that the built-in policy commands.
    CommandedSpeed,
    /// Name of the parameter set.
    Set,
}

/// What a master may set by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Settable {
    /// Input field.
    Input(usize),
    /// Input that renews a part of the state.
    Renewal(usize),
    /// State field.
    State(usize),
    /// Parameter.
    Parameter(usize),
}

/// Length of a block of value references.
const BLOCK: u32 = 1000;

impl Slot {
    /// The value reference.
    pub const fn reference(self) -> u32 {
        let (block, index) = match self {
            Self::Time => (0, 0),
            Self::Input(i) => (1, i),
            Self::State(i) => (2, i),
            Self::Derivative(i) => (3, i),
            Self::Output(i) => (4, i),
            Self::Parameter(i) => (5, i),
            Self::Indicator(i) => (6, i),
            Self::Event(i) => (7, i),
            Self::Renewal(i) => (8, i),
            Self::Count(i) => (9, i),
            Self::Lost => (10, 0),
            Self::CommandedSpeed => (10, 1),
            Self::Set => (10, 2),
        };
        block * BLOCK + index as u32
    }

    /// The slot of a value reference, whether or not a unit has it.
    #[inline]
    pub fn of(reference: u32) -> Option<Self> {
        let index = (reference % BLOCK) as usize;
        Some(match (reference / BLOCK, index) {
            (0, 0) => Self::Time,
            (1, i) => Self::Input(i),
            (2, i) => Self::State(i),
            (3, i) => Self::Derivative(i),
            (4, i) => Self::Output(i),
            (5, i) => Self::Parameter(i),
            (6, i) => Self::Indicator(i),
            (7, i) => Self::Event(i),
            (8, i) => Self::Renewal(i),
            (9, i) => Self::Count(i),
            (10, 0) => Self::Lost,
            (10, 1) => Self::CommandedSpeed,
            (10, 2) => Self::Set,
            _ => return None,
        })
    }

    /// What setting the slot by number changes; `None` for what a unit computes and for the name of the parameter set,
    /// which is text.
    pub(crate) fn settable(self) -> Option<Settable> {
        match self {
            Self::Input(i) => Some(Settable::Input(i)),
            Self::Renewal(i) => Some(Settable::Renewal(i)),
            Self::State(i) => Some(Settable::State(i)),
            Self::Parameter(i) => Some(Settable::Parameter(i)),
            Self::Time
            | Self::Derivative(_)
            | Self::Output(_)
            | Self::Indicator(_)
            | Self::Event(_)
            | Self::Count(_)
            | Self::Lost
            | Self::CommandedSpeed
            | Self::Set => None,
        }
    }
}

/// Type of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueType {
    /// `fmi2Real`, `fmi3Float64`.
    Real,
    /// `fmi2Integer`, `fmi3Int32`.
    Integer,
    /// `fmi2Boolean`, `fmi3Boolean`.
    Boolean,
    /// `fmi2String`, `fmi3String`.
    String,
}

impl From<Kind> for ValueType {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Real => Self::Real,
            Kind::Boolean => Self::Boolean,
            Kind::Integer => Self::Integer,
        }
    }
}

/// Causality, variability and initialisation of a variable, as FMI words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// `independent`.
    Independent,
    /// Continuous or discrete input.
    Input,
    /// Parameter that may change between steps.
    Tunable,
    /// Parameter that is fixed after initialisation.
    Fixed,
    /// Continuous state: settable before initialisation.
    State,
    /// Computed, inside.
    Local,
    /// Computed, outside.
    Output,
}

/// One variable of a unit.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Structured name, `process.cutting_speed`.
    pub name: String,
    /// What it stands for.
    pub slot: Slot,
    /// Type of the value.
    pub value_type: ValueType,
    /// What it is to the importer.
    pub role: Role,
    /// Unit, range, start, meaning, number of elements.
    pub field: Field,
    /// Of an enumeration, which is an integer of a few values: their names from the least one on.
    pub items: &'static [&'static str],
}

impl Variable {
    fn new(name: String, slot: Slot, role: Role, field: Field) -> Self {
        Self { name, slot, value_type: field.kind.into(), role, field, items: &[] }
    }

    /// Whether the value changes at events only.
    pub fn is_discrete(&self) -> bool {
        self.value_type != ValueType::Real || self.slot == Slot::CommandedSpeed
    }

    /// Whether the importer gives the start value.
    pub fn has_start(&self) -> bool {
        matches!(self.role, Role::Input | Role::Tunable | Role::Fixed | Role::State)
    }
}

/// A field of no record.
const fn field(name: &'static str, kind: Kind, start: f64, doc: &'static str) -> Field {
    Field { name, unit: "1", display: "1", kind, len: 1, start, min: f64::MIN, max: f64::MAX, doc }
}

/// Whether a unit has events after which its edge cannot cut.
pub(crate) fn can_be_lost<U: Unit>() -> bool {
    U::EVENTS.iter().any(|event| event.ends_cut())
}

/// Speed field of an adaptive unit's input.
fn speed_field<U: Unit>() -> Option<Field> {
    U::Input::FIELDS.iter().find(|field| field.name == "cutting_speed").copied()
}

/// Every variable of a unit, in the order of the model description.
pub fn variables<U: Unit>() -> Vec<Variable> {
    let mut all = vec![Variable::new(
        "time".to_owned(),
        Slot::Time,
        Role::Independent,
        Field { unit: "s", display: "s", ..field("time", Kind::Real, 0.0, "Simulation time.") },
    )];
    let numbered = |fields: &'static [Field]| fields.iter().copied().enumerate();
    all.extend(
        numbered(U::Input::FIELDS)
            .map(|(i, field)| Variable::new(format!("process.{}", field.name), Slot::Input(i), Role::Input, field)),
    );
    all.extend(U::RENEWALS.iter().enumerate().map(|(i, renewal)| {
        let field = Field { min: 0.0, max: 1.0, ..field(renewal.name, Kind::Boolean, 0.0, renewal.doc) };
        Variable::new(renewal.name.to_owned(), Slot::Renewal(i), Role::Input, field)
    }));
    let state = |field: &Field| format!("{}.{}", U::STATE_GROUP, field.name);
    let state_role = if U::CONTINUOUS { Role::State } else { Role::Local };
    all.extend(
        numbered(U::State::FIELDS).map(|(i, field)| Variable::new(state(&field), Slot::State(i), state_role, field)),
    );
    if U::CONTINUOUS {
        all.extend(numbered(U::State::FIELDS).map(|(i, field)| {
            let rate = Field {
                unit: rate_unit(field.unit),
                display: rate_unit(field.unit),
                min: f64::MIN,
                max: f64::MAX,
                ..field
            };
            Variable::new(format!("der({})", state(&field)), Slot::Derivative(i), Role::Local, rate)
        }));
    }
    all.extend(
        numbered(U::Output::FIELDS)
            .map(|(i, field)| Variable::new(format!("process.{}", field.name), Slot::Output(i), Role::Output, field)),
    );
    all.extend(U::EVENTS.iter().enumerate().map(|(i, event)| {
        let doc = "Whether the event has happened since the last renewal.";
        Variable::new(
            format!("event.{}", event.name()),
            Slot::Event(i),
            Role::Output,
            field(event.name(), Kind::Boolean, 0.0, doc),
        )
    }));
    if can_be_lost::<U>() {
        let doc = "Whether the edge collapsed or chipped; it does not cut any more until it is changed.";
        let name = format!("{}.lost", U::STATE_GROUP);
        all.push(Variable::new(name, Slot::Lost, Role::Output, field("lost", Kind::Boolean, 0.0, doc)));
    }
    all.extend(U::RENEWALS.iter().enumerate().map(|(i, renewal)| {
        let field = field(renewal.count, Kind::Integer, 1.0, renewal.count_doc);
        Variable::new(renewal.count.to_owned(), Slot::Count(i), Role::Output, field)
    }));
    if U::ADAPTIVE
        && let Some(speed) = speed_field::<U>()
    {
        let doc = "Cutting speed that the built-in policy commands; the input where it is off.";
        let field = Field { doc, ..speed };
        all.push(Variable::new("adaptive.cutting_speed".to_owned(), Slot::CommandedSpeed, Role::Output, field));
    }
    all.extend(U::EVENTS.iter().enumerate().map(|(i, event)| {
        let doc = "Event indicator: negative before the event.";
        Variable::new(
            format!("indicator.{}", event.name()),
            Slot::Indicator(i),
            Role::Local,
            field(event.name(), Kind::Real, 0.0, doc),
        )
    }));
    let doc = "Parameter set of tool and work material, from the resources. Choosing one sets every parameter that \
               was not set by itself.";
    all.push(Variable {
        value_type: ValueType::String,
        ..Variable::new("tool.set".to_owned(), Slot::Set, Role::Fixed, field("set", Kind::Real, 0.0, doc))
    });
    let parameters = Configured::<U>::shipped().fields.to_vec();
    all.extend(parameters.into_iter().enumerate().map(|(i, (name, field))| Variable {
        items: items::<U>(&name),
        ..Variable::new(name, Slot::Parameter(i), Role::Tunable, field)
    }));
    all
}

/// Names of the values of a parameter that is an enumeration; none of any other.
pub(crate) fn items<U: Unit>(parameter: &str) -> &'static [&'static str] {
    U::ENUMERATIONS.iter().find(|(name, _)| *name == parameter).map_or(&[], |(_, items)| items)
}

/// SI unit of a rate; state fields use these units only, which a test holds.
pub(crate) fn rate_unit(unit: &str) -> &'static str {
    match unit {
        "1" => "1/s",
        "m" => "m/s",
        "K" => "K/s",
        "s" => "s/s",
        "J" => "W",
        "m2" => "m2/s",
        _ => "1",
    }
}
