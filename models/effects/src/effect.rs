//! One effect and how it is read and written.

use crate::{CatalogueEntry, Context, Definition, EffectError, Terms, UserEffect};
use serde::de::Error as _;
use serde::ser::SerializeMap as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::str::FromStr;
use toolroom_process::{AnyRecord, Field, Number, parameters::Value, unit};

/// Declares the effects: one line `Variant in module` each. A module holds the record of its
/// parameters (called as the variant, `size` first), `const ENTRY` and `fn act`.
macro_rules! catalogue {
    ($($(#[doc = $doc:literal])+ $variant:ident in $module:ident;)+) => {
        $(pub use crate::$module::$variant;)+

        /// An effect that a nominal model leaves out, with its strength and shape.
        ///
        /// An effect maps a [`Context`] to changes of [`Terms`]; its `size` is neutral at zero, and
        /// negative only where a change goes either way.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum Effect<N: Copy = f64> {
            $($(#[doc = $doc])+ $variant($variant<N>),)+
            /// An effect that a user has defined.
            User(UserEffect<N>),
        }

        impl Effect {
            /// Every effect that is built in.
            pub const CATALOGUE: &'static [CatalogueEntry] = &[$(crate::$module::ENTRY),+];

            /// Every effect of the catalogue at its default: size zero.
            pub fn all() -> impl Iterator<Item = Self> {
                [$(Self::$variant($variant::default())),+].into_iter()
            }

            /// Size and shape, the size first.
            pub fn parameters(&self) -> &dyn AnyRecord {
                match self {
                    $(Self::$variant(parameters) => parameters,)+
                    Self::User(own) => own,
                }
            }

            /// Size and shape, to be set.
            pub fn parameters_mut(&mut self) -> &mut dyn AnyRecord {
                match self {
                    $(Self::$variant(parameters) => parameters,)+
                    Self::User(own) => own,
                }
            }
        }

        impl<N: Copy> Effect<N> {
            /// The effect's row of the catalogue.
            pub fn entry(&self) -> &'static CatalogueEntry {
                match self {
                    $(Self::$variant(_) => const { &crate::$module::ENTRY },)+
                    Self::User(own) => own.definition().entry(),
                }
            }

            /// Strength, SI.
            pub fn size(&self) -> N {
                match self {
                    $(Self::$variant(parameters) => parameters.size,)+
                    Self::User(own) => own.size,
                }
            }

            /// The same effect with another strength, SI.
            #[must_use]
            pub fn with_size(mut self, size: N) -> Self {
                match &mut self {
                    $(Self::$variant(parameters) => parameters.size = size,)+
                    Self::User(own) => own.size = size,
                }
                self
            }

            /// The same effect over another number type.
            pub fn map<M: Copy>(&self, convert: impl FnMut(N) -> M) -> Effect<M> {
                match self {
                    $(Self::$variant(parameters) => Effect::$variant(parameters.map(convert)),)+
                    Self::User(own) => Effect::User(own.map(convert)),
                }
            }
        }

        impl<N: Number> Effect<N> {
            /// Changes `terms` as the effect does in the cut that `context` describes.
            pub fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
                match self {
                    $(Self::$variant(parameters) => parameters.act(context, terms),)+
                    Self::User(own) => own.act(context, terms),
                }
            }
        }
    };
}

catalogue! {
    /// Forces grow with flank wear.
    WearForce in wear_force;
    /// The contact grows hotter with flank wear.
    WearTemperature in wear_temperature;
    /// Wear feeds itself.
    WearAcceleration in wear_acceleration;
    /// A fresh edge wears faster.
    RunIn in run_in;
    /// Overheating leaves the tool material weaker.
    ThermalHeredity in thermal_heredity;
    /// One lot of material is harder.
    LotHardness in lot_hardness;
    /// Tool or blank runs out of true.
    Runout in runout;
    /// The chuck is stiffer over a jaw than between two.
    ChuckStiffness in chuck_stiffness;
    /// The flank rubs on the waves of the surface.
    ProcessDamping in process_damping;
    /// Natural frequencies are not those that were tapped.
    ModeFrequency in mode_frequency;
    /// Damping ratios are not those that were tapped.
    ModeDamping in mode_damping;
    /// Modes are stiffer or softer than they were tapped.
    ModeStiffness in mode_stiffness;
    /// Old coolant cools less.
    CoolantAgeing in coolant_ageing;
    /// Another coolant lubricates better or worse.
    CoolantChange in coolant_change;
    /// The grinding wheel dulls between dressings.
    WheelDulling in wheel_dulling;
    /// The grinding wheel rubs before it cuts.
    ThresholdForce in threshold_force;
    /// A built-up edge in a window of speeds.
    BuiltUpEdge in built_up_edge;
    /// Hot work material cuts more easily.
    ThermalSoftening in thermal_softening;
    /// The force reading drifts.
    ForceDrift in force_drift;
    /// The force reading has a zero error.
    ForceBias in force_bias;
    /// The temperature reading lags behind in short cuts.
    TemperatureLag in temperature_lag;
    /// The spindle drive loses power.
    SpindleLoss in spindle_loss;
    /// An edge that crawls rubs and wears.
    CrawlWear in crawl_wear;
    /// Edges chip.
    ChippingHazard in chipping;
    /// The helix bends the wall along the axis.
    HelixFormError in helix_form_error;
    /// The drives cut corners.
    ServoLag in servo_lag;
    /// There is more or less stock than planned.
    StockOffset in stock_offset;
    /// The grinding wheel wears.
    WheelWear in wheel_wear;
    /// The part is gauged warm.
    ThermalGrowth in thermal_growth;
    /// Contact begins late.
    StartOffset in start_offset;
    /// The machine grows softer.
    StiffnessDrift in stiffness_drift;
}

impl Effect {
    /// The effect called `id`, at size zero.
    ///
    /// # Errors
    /// [`EffectError::Unknown`] with the most similar id.
    pub fn named(id: &str) -> Result<Self, EffectError> {
        Self::among(id, &[])
    }

    /// The effect called `id`, of the catalogue or of those that a user has defined, at size zero.
    ///
    /// # Errors
    /// [`EffectError::Unknown`] with the most similar id; [`EffectError::Undefined`] where it can only be a user's.
    pub fn among(id: &str, defined: &[&'static Definition]) -> Result<Self, EffectError> {
        if let Some(effect) = Self::all().find(|effect| effect.entry().id == id) {
            return Ok(effect);
        }
        if let Some(definition) = defined.iter().find(|definition| definition.entry().id == id) {
            return Ok(Self::User(UserEffect::new(definition)));
        }
        if id.contains('.') {
            let known = defined.iter().map(|own| own.entry().id).collect::<Vec<_>>().join(", ");
            return Err(EffectError::Undefined { id: id.to_owned(), known });
        }
        let likeness = |entry: &&CatalogueEntry| strsim::jaro_winkler(entry.id, id);
        let nearest = Self::CATALOGUE.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        Err(EffectError::Unknown { id: id.to_owned(), nearest: nearest.map_or("", |entry| entry.id) })
    }

    /// Sets a parameter from text: a number with its unit, or a bare number for a ratio.
    ///
    /// # Errors
    /// An unknown parameter, a unit that does not fit, a value out of range.
    fn set(&mut self, name: &str, text: &str) -> Result<(), EffectError> {
        let id = self.entry().id;
        let fields = self.parameters().fields();
        // As older files have it.
        let name = if (id, name) == ("built_up_edge", "speed") { "centre" } else { name };
        let Some(i) = fields.iter().position(|field| field.name == name) else {
            let known = fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
            return Err(EffectError::UnknownParameter { id, name: name.to_owned(), known });
        };
        let field = &fields[i];
        let value = unit::quantity(text, field.unit);
        let value = value.map_err(|reason| EffectError::Unit { id, name: field.name, reason })?;
        field.check(value).map_err(|reason| EffectError::Range { id, reason })?;
        self.parameters_mut().set_value(i, value);
        Ok(())
    }
}

/// Reads `id=size`, as on the command line.
///
/// ```
/// use toolroom_effects::Effect;
/// let effect: Effect = "threshold_force=20 N".parse().unwrap();
/// assert_eq!(effect.size(), 20.0);
/// assert!("treshold_force=20 N".parse::<Effect>().unwrap_err().to_string().contains("threshold_force"));
/// ```
impl FromStr for Effect {
    type Err = EffectError;

    fn from_str(text: &str) -> Result<Self, EffectError> {
        Self::parse(text, &[])
    }
}

impl Effect {
    /// The same effect at size zero in the shape that it has by default.
    #[must_use]
    pub fn default_shape(&self) -> Self {
        match self.definition() {
            Some(definition) => Self::User(UserEffect::new(definition)),
            None => Self::named(self.entry().id).unwrap_or(*self),
        }
    }

    /// What a user has written, if this is such an effect.
    pub fn definition(&self) -> Option<&'static Definition> {
        if let Self::User(own) = self { Some(own.definition()) } else { None }
    }

    /// The effect called `id` with parameters as a file or a document has them: numbers, or texts with a unit.
    ///
    /// # Errors
    /// An id that nobody knows, an unknown parameter, a unit that does not fit, a value out of range.
    pub fn of_parameters<'a>(
        id: &str,
        parameters: impl IntoIterator<Item = (&'a str, &'a serde_json::Value)>,
        defined: &[&'static Definition],
    ) -> Result<Self, EffectError> {
        let mut effect = Self::among(id, defined)?;
        for (name, value) in parameters {
            let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            effect.set(name, &text)?;
        }
        Ok(effect)
    }

    /// Reads `id=size` of the catalogue or of the effects that a user has defined.
    ///
    /// # Errors
    /// An id that nobody knows, no size, a unit that does not fit, a size out of range.
    pub fn parse(text: &str, defined: &[&'static Definition]) -> Result<Self, EffectError> {
        let (id, size) = text.split_once('=').unwrap_or((text, ""));
        let mut effect = Self::among(id.trim(), defined)?;
        if size.is_empty() {
            return Err(effect.missing_size());
        }
        effect.set("size", size)?;
        Ok(effect)
    }

    fn missing_size(&self) -> EffectError {
        let entry = self.entry();
        let size = match entry.size.display {
            "1" => "0.2".to_owned(),
            unit => format!("\"0.2 {unit}\""),
        };
        EffectError::MissingSize { id: entry.id, example: format!("{{ id = \"{}\", size = {size} }}", entry.id) }
    }
}

/// An effect as files hold it.
#[derive(Deserialize)]
pub(crate) struct Written {
    id: String,
    /// Parameters beside the size; they may also stand beside it.
    #[serde(default)]
    shape: BTreeMap<String, Value>,
    #[serde(flatten)]
    parameters: BTreeMap<String, Value>,
}

impl Written {
    /// The effect, of the catalogue or of those that a user has defined.
    pub(crate) fn effect(self, defined: &[&'static Definition]) -> Result<Effect, EffectError> {
        let mut effect = Effect::among(&self.id, defined)?;
        for (name, value) in self.shape.iter().chain(&self.parameters) {
            if name == "size" && self.shape.contains_key(name) {
                return Err(EffectError::SizeInShape { id: effect.entry().id });
            }
            match value {
                Value::Number(number) => effect.set(name, &number.to_string())?,
                Value::Quantity(quantity) => effect.set(name, quantity)?,
            }
        }
        if self.parameters.contains_key("size") { Ok(effect) } else { Err(effect.missing_size()) }
    }
}

impl<'de> Deserialize<'de> for Effect {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Written::deserialize(deserializer)?.effect(&[]).map_err(D::Error::custom)
    }
}

impl Serialize for Effect {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let fields = self.parameters().fields();
        let mut map = serializer.serialize_map(Some(1 + fields.len()))?;
        map.serialize_entry("id", self.entry().id)?;
        for (i, field) in fields.iter().enumerate() {
            let value = self.parameters().value(i).unwrap_or(f64::NAN);
            match field.unit {
                "1" => map.serialize_entry(field.name, &value)?,
                _ => map.serialize_entry(field.name, &written_quantity(field, value))?,
            }
        }
        map.end()
    }
}

/// The value with its unit, in the display unit where that reads back to the same bits.
fn written_quantity(field: &Field, value: f64) -> String {
    let display = format!("{} {}", field.to_display(value), field.display);
    if unit::quantity(&display, field.unit) == Ok(value) { display } else { format!("{value} {}", field.unit) }
}
