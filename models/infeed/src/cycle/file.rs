//! Cycle files.

use super::design::fastest_cycle_of_steady_wheel;
use super::dressing::interval;
use super::{
    Cycle, CycleError, CycleLimits, DressingInterval, DressingPlan, Surface, cycle_time_estimate, dressing_interval,
    fastest_cycle_while_dulling,
};
use crate::{Infeed, Input, Parameters, SetError, State};
use std::path::Path;
use std::sync::Arc;
use toolroom_effects::{EFFECT_LIST, read_effects};
use toolroom_form::{
    ContentFault, Fault, Form, FormFile, Key, Kind, Need, ReadError, Section, Walk, fill_record, parse, read,
    record_keys,
};
use toolroom_process::{AnyRecord, Field, Record};

/// The wheel for which a cycle is designed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WheelState {
    /// As it comes from the dresser.
    Dressed,
    /// As blunt as it is for the last part before the next dressing.
    #[default]
    Worst,
    /// It has removed this volume per width since dressing, m².
    Removed(f64),
}

impl WheelState {
    /// Reads `dressed`, `worst` or a volume per width with its unit.
    fn read(text: &str) -> Result<Self, WheelFault> {
        match text.trim() {
            "dressed" => Ok(Self::Dressed),
            "worst" => Ok(Self::Worst),
            other => match toolroom_process::unit::quantity(other, "m2") {
                Ok(volume) if (0.0..=1e4).contains(&volume) => Ok(Self::Removed(volume)),
                Ok(_) | Err(_) => Err(WheelFault { read: other.to_owned() }),
            },
        }
    }
}

/// A grinding task: machine, conditions, limits.
///
/// ```toml
/// schema = 1
/// title = "Rings, 100 um of stock"
/// parameter_set = "zb153u_40kh"
/// effects = [{ id = "threshold_force", size = "20 N" }]  # what the set leaves out
/// wheel = "worst"              # the wheel that the cycle is for: dressed, worst, or "300 mm3/mm"
/// [parameters]                 # deviations from the set
/// dulling_rate = "0.000667 mm/mm3"
/// [conditions]                 # fields of the input
/// work_rotation_speed = "292 rpm"
/// [limits]                     # fields of CycleLimits
/// stock = "100 um"
/// [dressing]                   # fields of DressingPlan; left out: no dressing interval
/// dressing_time = "90 s"
/// [roughness]                  # fields of Surface; left out: nothing is said about roughness
/// measured = "0.4 um"
/// removal_rate = "3 mm2/s"
/// ```
///
/// ```
/// let file = toolroom_infeed::CycleFile::parse("cycle.toml", "schema = 1", &["limits.stock=50 um".to_owned()]).unwrap();
/// assert_eq!(file.content.fastest_cycle().unwrap().revolutions, 17);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CycleFile {
    /// One line for people.
    pub title: String,
    /// The process.
    pub grinding: Infeed,
    /// Conditions; the infeed per revolution is of no account.
    pub input: Input,
    /// Limits.
    pub limits: CycleLimits,
    /// Dressing, where it is requested.
    pub dressing: Option<DressingPlan>,
    /// The wheel for which the cycle is designed.
    pub wheel: WheelState,
    /// A measured roughness, where there is one.
    pub surface: Option<Surface>,
}

static PARAMETERS: Form = Form {
    title: "[parameters]",
    doc: "Deviations from the parameter set",
    keys: &record_keys::<{ Parameters::<f64>::FIELDS.len() }>(Parameters::FIELDS),
};

static CONDITIONS: Form = Form {
    title: "[conditions]",
    doc: "What the machine does and what surrounds the cut",
    keys: &record_keys::<{ Input::<f64>::FIELDS.len() }>(Input::FIELDS),
};

static LIMITS: Form = Form {
    title: "[limits]",
    doc: "What the cycle has to keep",
    keys: &record_keys::<{ CycleLimits::<f64>::FIELDS.len() }>(CycleLimits::FIELDS),
};

static DRESSING: Form = Form {
    title: "[dressing]",
    doc: "How the wheel is dressed; left out, no dressing interval is worked out",
    keys: &record_keys::<{ DressingPlan::<f64>::FIELDS.len() }>(DressingPlan::FIELDS),
};

const SURFACE: &[Field] = Surface::<f64>::FIELDS;

static ROUGHNESS: Form = Form {
    title: "[roughness]",
    doc: "A measured roughness, from which that of the cycle follows; left out, nothing is said about roughness",
    keys: &[
        Key { need: Need::Required, ..Key::of_named(SURFACE, "measured") },
        Key { need: Need::Required, ..Key::of_named(SURFACE, "removal_rate") },
        Key::of_named(SURFACE, "lead"),
        Key::of_named(SURFACE, "depth"),
        Key::of_named(SURFACE, "exponent"),
        Key::of_named(SURFACE, "sparked_out"),
    ],
};

/// Keys of a cycle file.
pub static CYCLE: Form = Form {
    title: "the cycle file",
    doc: "A grinding cycle to be designed; what is left out has its default",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::default("title", Kind::Text, "", "One line for people"),
        Key::optional("parameter_set", Kind::Text, "Shipped set of the process"),
        Key::optional("effects", Kind::Content(&EFFECT_LIST), "Effects that the parameter set leaves out"),
        Key::default(
            "wheel",
            Kind::Text,
            "worst",
            "Wheel for which the cycle is designed: dressed, worst (as blunt as for the last part before the next dressing), or the volume removed per width since dressing, as in 300 mm3/mm",
        ),
        Key::optional("parameters", Kind::Table(&PARAMETERS), "Deviations from the parameter set"),
        Key::optional("conditions", Kind::Table(&CONDITIONS), "What the machine does and what surrounds the cut"),
        Key::optional("limits", Kind::Table(&LIMITS), "What the cycle has to keep"),
        Key::optional("dressing", Kind::Table(&DRESSING), "How the wheel is dressed"),
        Key::optional(
            "roughness",
            Kind::Table(&ROUGHNESS),
            "A measured roughness, from which that of the cycle follows",
        ),
    ],
};

impl ContentFault for SetError {
    fn code(&self) -> &'static str {
        match self {
            Self::Unknown(_) => "unknown-name",
            Self::UnknownGroup { .. } | Self::Parameter(_) => "parameter-set",
        }
    }
}

impl CycleFile {
    /// [`CycleFile::parse`] of the file at `path`.
    ///
    /// # Errors
    /// [`ReadError`]: the file cannot be opened or decoded, or every fault found in it.
    pub fn read(path: &Path, overrides: &[String]) -> Result<FormFile<Self>, ReadError> {
        read(path, overrides, &CYCLE, |walk, root| Some(resolve(walk, root)))
    }

    /// Reads the text of a cycle file, with values replaced as after `--set`: `limits.stock=50 um`, or of
    /// an effect `effects.threshold_force=20 N`. `file` is its name for messages. What is not given has its default.
    ///
    /// # Errors
    /// [`ReadError::Faults`] with every fault and its place.
    pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<FormFile<Self>, ReadError> {
        parse(file, text, overrides, &CYCLE, |walk, root| Some(resolve(walk, root)))
    }

    /// Volume of a part per width, m².
    fn part_volume(&self) -> f64 {
        std::f64::consts::PI * self.grinding.parameters.work_diameter * self.limits.stock
    }

    /// The wheel for which the cycle is designed. The last part before the next dressing comes behind the parts of
    /// `interval`, or else of the dressing limit of the parameters.
    pub fn wheel_before(&self, interval: Option<&DressingInterval>) -> State {
        let removed_volume = match self.wheel {
            WheelState::Dressed => 0.0,
            WheelState::Removed(volume) => volume,
            WheelState::Worst => {
                let volume = self.part_volume();
                let by_limit = || (self.grinding.parameters.dressing_limit / volume * (1.0 - 1e-9)).ceil();
                let parts = interval.map_or_else(by_limit, |interval| f64::from(interval.parts));
                volume * (parts - 1.0).max(0.0)
            }
        };
        State { removed_volume, ..State::default() }
    }

    /// The fastest cycle on a wheel in this state.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn cycle_on(&self, wheel: &State) -> Result<Cycle, CycleError> {
        self.cycle_with(&self.grinding, wheel)
    }

    /// [`CycleFile::cycle_on`] of another machine than that of the file, as one with a smaller wheel. A roughness was
    /// measured at the wheel speed of the file.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn cycle_with(&self, grinding: &Infeed, wheel: &State) -> Result<Cycle, CycleError> {
        let plan = self.plan();
        fastest_cycle_while_dulling(grinding, wheel, &self.input, &self.limits, self.known(&plan))
    }

    fn plan(&self) -> DressingPlan {
        self.dressing.unwrap_or_default()
    }

    /// The measured roughness, the dressing of this file and the wheel speed.
    fn known<'a>(&'a self, plan: &'a DressingPlan) -> Option<(&'a Surface, &'a DressingPlan, f64)> {
        self.surface.as_ref().map(|surface| (surface, plan, self.grinding.parameters.wheel_speed))
    }

    /// The fastest cycle on the wheel for which it is designed.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn fastest_cycle(&self) -> Result<Cycle, CycleError> {
        let intervals = if self.wheel == WheelState::Worst { self.dressing_intervals()? } else { None };
        self.cycle_on(&self.wheel_before(intervals.as_ref().map(|[_, exact]| exact)))
    }

    /// The dressing interval by estimated cycles, and by the exact cycle of every part; none
    /// where the file does not ask for it.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn dressing_intervals(&self) -> Result<Option<[DressingInterval; 2]>, CycleError> {
        let Some(plan) = &self.dressing else { return Ok(None) };
        let (grinding, input, limits) = (&self.grinding, &self.input, &self.limits);
        let volume = self.part_volume();
        let wheel = |removed_volume| State { removed_volume, ..State::default() };
        let most = plan.most_parts as u32;
        let estimate = |v: f64| cycle_time_estimate(grinding, &wheel(v), input, limits, plan.finish_infeed);
        let exact =
            |v: f64| Ok(fastest_cycle_of_steady_wheel(grinding, &wheel(v), input, limits, self.known(plan))?.time);
        // With a bent force every cycle is found by many runs: they are not sought far beyond the best interval.
        let whole = grinding.parameters.force_exponent == 1.0;
        Ok(Some([
            dressing_interval(estimate, volume, plan.dressing_time, most)?,
            interval(exact, volume, plan.dressing_time, most, whole)?,
        ]))
    }
}

/// What the sections mean; of account only where no problem was noted.
fn resolve(walk: &mut Walk, root: &Section<'_>) -> CycleFile {
    let mut parameters = Parameters::default();
    if let Some(set) = root.text("parameter_set") {
        match Parameters::named(set) {
            Ok(named) => parameters = named,
            Err(reason) => walk.fault(root.span_of("parameter_set"), Fault::Content(Arc::new(reason))),
        }
    }
    let (mut input, mut limits) = (Input::default(), CycleLimits::default());
    let mut dressing = root.given("dressing").then(DressingPlan::default);
    let mut surface = root.given("roughness").then(Surface::default);
    let records: [(&str, Option<&mut dyn AnyRecord>); 5] = [
        ("parameters", Some(&mut parameters)),
        ("conditions", Some(&mut input)),
        ("limits", Some(&mut limits)),
        ("dressing", dressing.as_mut().map(|plan| plan as &mut dyn AnyRecord)),
        ("roughness", surface.as_mut().map(|surface| surface as &mut dyn AnyRecord)),
    ];
    let mut measured_after = [false; 2];
    for (key, record) in records {
        if let (Some(table), Some(record)) = (walk.table(root, key), record) {
            fill_record(&table, record);
            if key == "roughness" {
                measured_after = ["lead", "depth"].map(|key| table.given(key));
            }
        }
    }
    // The wheel was dressed for the measurement as it is for the cycle, unless something else is said.
    if let Some(surface) = &mut surface {
        let plan = dressing.unwrap_or_default();
        let [lead, depth] = measured_after;
        surface.lead = if lead { surface.lead } else { plan.lead };
        surface.depth = if depth { surface.depth } else { plan.depth };
    }
    let wheel = root.text("wheel").map_or(Ok(WheelState::default()), WheelState::read).unwrap_or_else(|fault| {
        walk.fault(root.span_of("wheel"), Fault::Content(Arc::new(fault)));
        WheelState::default()
    });
    let noted = walk.problems.len();
    let effects = read_effects(walk, root, Some("infeed"));
    let grinding = Infeed::new(parameters, effects).unwrap_or_else(|reason| {
        if walk.problems.len() == noted {
            let fault = Fault::Content(Arc::new(RefusedEffect(reason)));
            walk.fault(root.span_of("effects"), fault);
        }
        Infeed::default()
    });
    let p = &grinding.parameters;
    if p.internal >= 0.5 && p.wheel_diameter >= p.work_diameter {
        let (wheel, bore) = (1e3 * p.wheel_diameter, 1e3 * p.work_diameter);
        walk.fault(root.span_of("parameters"), Fault::Content(Arc::new(WheelInBore { wheel, bore })));
    }
    let title = root.text("title").unwrap_or_default().to_owned();
    CycleFile { title, grinding, input, limits, dressing, wheel, surface }
}

/// A wheel that is none of those for which a cycle can be designed.
#[derive(Debug, thiserror::Error)]
#[error(
    "wheel = {read:?} is not known; write dressed, worst, or the volume removed per width since dressing, as in 300 mm3/mm"
)]
struct WheelFault {
    read: String,
}

impl ContentFault for WheelFault {
    fn code(&self) -> &'static str {
        "out-of-range"
    }
}

/// A wheel that does not fit into the bore.
#[derive(Debug, thiserror::Error)]
#[error("a wheel of {wheel} mm does not fit into a bore of {bore} mm; give a smaller wheel_diameter, or internal = 0")]
struct WheelInBore {
    wheel: f64,
    bore: f64,
}

impl ContentFault for WheelInBore {
    fn code(&self) -> &'static str {
        "out-of-range"
    }
}

/// An effect that these parameters do not admit.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
struct RefusedEffect(toolroom_effects::EffectError);

impl ContentFault for RefusedEffect {
    fn code(&self) -> &'static str {
        "effect"
    }
}
