//! `modelDescription.xml` of FMI 2.0 and 3.0, as far as an importer needs it.

mod read;
mod schema;

use std::collections::BTreeMap;
use std::fmt;

/// What a unit says about itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelDescription {
    /// `fmiVersion` as written.
    pub fmi_version: String,
    /// 2 or 3.
    pub major: u8,
    /// Name of the model.
    pub model_name: String,
    /// `guid` of FMI 2.0, `instantiationToken` of FMI 3.0.
    pub token: String,
    /// Attributes for people, such as `description`, `generationTool`, `generationDateAndTime`.
    pub about: BTreeMap<String, String>,
    /// Interface for Co-Simulation.
    pub co_simulation: Option<Interface>,
    /// Interface for Model Exchange.
    pub model_exchange: Option<Interface>,
    /// Interface for Scheduled Execution.
    pub scheduled_execution: Option<Interface>,
    /// Units by name.
    pub units: BTreeMap<String, Unit>,
    /// Types by name.
    pub types: BTreeMap<String, DeclaredType>,
    /// Categories of log messages.
    pub log_categories: Vec<String>,
    /// The experiment that its author had in mind.
    pub experiment: Experiment,
    /// Variables in the order of the file.
    pub variables: Vec<Variable>,
    /// What depends on what.
    pub structure: Structure,
}

/// One interface and its capability flags.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Interface {
    /// Name of the binary and prefix of static functions.
    pub identifier: String,
    /// Every attribute as written.
    pub attributes: BTreeMap<String, String>,
}

impl Interface {
    /// Whether a capability flag is set.
    pub fn can(&self, flag: &str) -> bool {
        self.attributes.get(flag).is_some_and(|value| read::is_true(value))
    }

    /// Whether the state can be saved and restored; FMI 2.0 and 3.0 spell it differently.
    pub fn saves_state(&self) -> bool {
        self.can("canGetAndSetFMUstate") || self.can("canGetAndSetFMUState")
    }

    /// Whether a saved state can be written to bytes.
    pub fn serializes_state(&self) -> bool {
        self.can("canSerializeFMUstate") || self.can("canSerializeFMUState")
    }
}

/// A unit: `base value = factor · value + offset`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unit {
    /// Factor and offset to SI and the powers of kg, m, s, A, K, mol, cd, rad; `None` where the
    /// file does not say.
    pub base: Option<BaseUnit>,
    /// Names of display units.
    pub display: Vec<String>,
}

/// A unit in terms of SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    /// SI units in one of this unit.
    pub factor: f64,
    /// SI value of zero.
    pub offset: f64,
    /// Powers of kg, m, s, A, K, mol, cd, rad.
    pub powers: [i32; 8],
}

impl BaseUnit {
    /// Factor and offset by which a value in this unit becomes one in `other`: `factor · value + offset`. `None` between
    /// different dimensions.
    ///
    /// ```
    /// use toolroom_fmu_import::description::BaseUnit;
    /// let metre = BaseUnit { factor: 1.0, offset: 0.0, powers: [0, 1, 0, 0, 0, 0, 0, 0] };
    /// let millimetre = BaseUnit { factor: 1e-3, ..metre };
    /// assert_eq!(metre.conversion(millimetre), Some((1000.0, 0.0)));
    /// assert_eq!(metre.conversion(BaseUnit { powers: [1, 0, 0, 0, 0, 0, 0, 0], ..metre }), None);
    /// ```
    pub fn conversion(self, other: Self) -> Option<(f64, f64)> {
        (self.powers == other.powers).then(|| (self.factor / other.factor, (self.offset - other.offset) / other.factor))
    }

    /// A unit by its name; a revolution counts as an angle.
    #[cfg(feature = "fmi")]
    pub(crate) fn from_unit(unit: toolroom_process::unit::Unit) -> Self {
        let [m, kg, s, k, a, mol, rev, _] = unit.dimension.map(i32::from);
        // A revolution is counted as one there, and as 2π rad here.
        let factor = unit.factor * std::f64::consts::TAU.powi(rev);
        Self { factor, offset: unit.offset, powers: [kg, m, s, a, k, mol, 0, rev] }
    }
}

/// `DefaultExperiment`, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Start time, s.
    pub start: Option<f64>,
    /// Stop time, s.
    pub stop: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Step of communication or integration, s.
    pub step: Option<f64>,
}

/// A declared type, as far as variables take something from it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DeclaredType {
    /// Its unit.
    pub unit: Option<String>,
    /// `relativeQuantity`.
    pub relative: bool,
}

/// Type of a variable's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueType {
    /// `Real` or `Float64`.
    Float64,
    /// `Float32`.
    Float32,
    /// `Integer` or a whole number of this many bits, and whether it is signed.
    Integer(u8, bool),
    /// `Boolean`.
    Boolean,
    /// `String`.
    String,
    /// `Binary`.
    Binary,
    /// `Enumeration`.
    Enumeration,
    /// `Clock`.
    Clock,
}

impl ValueType {
    /// The type of an XML element.
    fn named(element: &str) -> Option<Self> {
        Some(match element {
            "Real" | "Float64" => Self::Float64,
            "Float32" => Self::Float32,
            "Integer" | "Int32" => Self::Integer(32, true),
            "Int8" => Self::Integer(8, true),
            "UInt8" => Self::Integer(8, false),
            "Int16" => Self::Integer(16, true),
            "UInt16" => Self::Integer(16, false),
            "UInt32" => Self::Integer(32, false),
            "Int64" => Self::Integer(64, true),
            "UInt64" => Self::Integer(64, false),
            "Boolean" => Self::Boolean,
            "String" => Self::String,
            "Binary" => Self::Binary,
            "Enumeration" => Self::Enumeration,
            "Clock" => Self::Clock,
            _ => return None,
        })
    }
}

impl ValueType {
    /// Whether a variable of this type can be `value`: whole numbers within their bits, Booleans as 0 and 1; false for
    /// what is no number.
    ///
    /// ```
    /// use toolroom_fmu_import::ValueType;
    /// assert!(ValueType::Integer(8, false).holds(255.0) && !ValueType::Integer(8, false).holds(256.0));
    /// assert!(!ValueType::Integer(32, true).holds(1.5) && !ValueType::Boolean.holds(2.0));
    /// ```
    pub fn holds(self, value: f64) -> bool {
        let whole = |bits: u8, signed: bool| {
            let reach = f64::from(bits - u8::from(signed)).exp2();
            value.fract() == 0.0 && value < reach && value >= if signed { -reach } else { 0.0 }
        };
        match self {
            Self::Float64 | Self::Float32 => value.is_finite(),
            Self::Integer(bits, signed) => whole(bits, signed),
            Self::Enumeration => whole(64, true),
            Self::Boolean => value == 0.0 || value == 1.0,
            Self::String | Self::Binary | Self::Clock => false,
        }
    }
}

impl fmt::Display for ValueType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float64 => f.write_str("real"),
            Self::Float32 => f.write_str("real (32 bit)"),
            Self::Integer(32, true) => f.write_str("integer"),
            Self::Integer(bits, signed) => write!(f, "{}integer ({bits} bit)", if *signed { "" } else { "unsigned " }),
            Self::Boolean => f.write_str("boolean"),
            Self::String => f.write_str("string"),
            Self::Binary => f.write_str("binary"),
            Self::Enumeration => f.write_str("enumeration"),
            Self::Clock => f.write_str("clock"),
        }
    }
}

/// One variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Unique name.
    pub name: String,
    /// Value reference.
    pub reference: u32,
    /// Type.
    pub value_type: ValueType,
    /// `input`, `output`, `parameter`, …
    pub causality: String,
    /// `continuous`, `discrete`, `fixed`, …
    pub variability: String,
    /// `exact`, `approx` or `calculated`, by the standard's default where it is left out.
    pub initial: Option<String>,
    /// Start value as written.
    pub start: Option<String>,
    /// Unit, its own or its type's.
    pub unit: Option<String>,
    /// Whether it is a difference of quantities (`relativeQuantity`, its own or its type's): offsets between units do not
    /// concern it.
    pub relative: bool,
    /// Declared type.
    pub declared_type: Option<String>,
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// Nominal value.
    pub nominal: Option<f64>,
    /// Index of the state whose derivative this is.
    pub derivative_of: Option<usize>,
    /// Whether it belongs to clocks, and has a value only where one of them ticks (FMI 3.0).
    pub clocked: bool,
    /// Of a clock: `triggered`, or who decides when it ticks next (`constant`, `countdown` and so on).
    pub interval_variability: Option<String>,
    /// Dimensions of an array; none for a scalar.
    pub dimensions: Vec<Dimension>,
    /// Meaning.
    pub description: String,
    /// Line of the file.
    pub line: u32,
}

impl Variable {
    /// Least and greatest value, in its own unit; infinite where the description has none.
    pub fn bounds(&self) -> [f64; 2] {
        [self.min.unwrap_or(f64::NEG_INFINITY), self.max.unwrap_or(f64::INFINITY)]
    }
}

/// Size of an array in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// So many elements.
    Fixed(u64),
    /// As many as the structural parameter or constant with this value reference says.
    Of(u32),
}

/// Most elements of an array that are read (assumption: no table has more columns).
const MOST_ELEMENTS: u64 = 1 << 20;

/// `ModelStructure`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Structure {
    /// Outputs.
    pub outputs: Vec<Unknown>,
    /// Derivatives of continuous states.
    pub derivatives: Vec<Unknown>,
    /// What can be requested in Initialization Mode.
    pub initial: Vec<Unknown>,
    /// Event indicators.
    pub event_indicators: usize,
}

/// One unknown with what it depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Index into [`ModelDescription::variables`].
    pub variable: usize,
    /// Indices into [`ModelDescription::variables`]; `None`: it may depend on everything.
    pub dependencies: Option<Vec<usize>>,
    /// Line of the file.
    pub line: u32,
}

/// One thing that is wrong in a description.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Line, from 1.
    pub line: u32,
    /// What is wrong.
    pub message: String,
}

/// What became of reading a description.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The description, as far as it could be understood.
    pub description: Option<ModelDescription>,
    /// What is wrong with it.
    pub faults: Vec<Fault>,
}

impl ModelDescription {
    /// The clocks of FMI 3.0.
    pub fn clocks(&self) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(|variable| variable.value_type == ValueType::Clock)
    }

    /// A clock that the importer of Model Exchange has to tick: one of time, which the unit is told of.
    pub fn clock_to_tick(&self) -> Option<&Variable> {
        let of_time = |clock: &&Variable| clock.interval_variability.as_deref() != Some("triggered");
        self.clocks().filter(|clock| clock.causality == "input").find(of_time)
    }

    /// Reads the text of a `modelDescription.xml`. What can be understood is; every fault is
    /// listed.
    ///
    /// ```
    /// use toolroom_fmu_import::ModelDescription;
    /// let text = r#"<fmiModelDescription fmiVersion="3.0" modelName="Gain" instantiationToken="g1">
    ///   <CoSimulation modelIdentifier="Gain"/>
    ///   <ModelVariables>
    ///     <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    ///   </ModelVariables><ModelStructure/></fmiModelDescription>"#;
    /// let reading = ModelDescription::read(text);
    /// assert!(reading.faults.is_empty());
    /// assert_eq!(reading.description.unwrap().variables[0].name, "time");
    /// ```
    pub fn read(text: &str) -> Reading {
        read::description(text)
    }

    /// The variable called `name`.
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name)
    }

    /// The length of step, s, that a unit of Co-Simulation takes which cannot vary it: `fixedInternalStepSize` of
    /// FMI 3.0, or else the step of the default experiment.
    pub fn fixed_step(&self, interface: &Interface) -> Option<f64> {
        let fixed_step = interface.attributes.get("fixedInternalStepSize").and_then(|step| step.trim().parse().ok());
        fixed_step.or(self.experiment.step).filter(|step: &f64| step.is_finite() && *step > 0.0)
    }

    /// Sizes of `variable` in each direction, with `start` values by name in place of those of the description;
    /// `None` where they cannot be known or the array has no element or too many.
    pub fn extents(&self, variable: &Variable, start: &BTreeMap<String, String>) -> Option<Vec<u64>> {
        let size = |dimension: &Dimension| match *dimension {
            Dimension::Fixed(size) => Some(size),
            Dimension::Of(reference) => {
                let variable = self.variables.iter().find(|each| each.reference == reference)?;
                start.get(&variable.name).or(variable.start.as_ref())?.trim().parse().ok()
            }
        };
        let extents: Vec<u64> = variable.dimensions.iter().map(size).collect::<Option<_>>()?;
        let elements = extents.iter().try_fold(1u64, |product, extent| product.checked_mul(*extent))?;
        (1..=MOST_ELEMENTS).contains(&elements).then_some(extents)
    }

    /// Interfaces with their names.
    pub fn interfaces(&self) -> impl Iterator<Item = (&'static str, &Interface)> {
        [
            ("Co-Simulation", &self.co_simulation),
            ("Model Exchange", &self.model_exchange),
            ("Scheduled Execution", &self.scheduled_execution),
        ]
        .into_iter()
        .filter_map(|(name, interface)| interface.as_ref().map(|interface| (name, interface)))
    }
}
