//! Cycle files.

use super::{Cycle, CycleError, CycleLimits, DressingInterval, cycle_time_estimate, dressing_interval, fastest_cycle};
use crate::{Infeed, Input, Parameters, SetError, State};
use std::path::Path;
use std::sync::Arc;
use toolroom_effects::{EFFECT_LIST, read_effects};
use toolroom_form::{
    ContentFault, Fault, Form, FormFile, Key, Kind, ReadError, Section, Walk, fill_record, parse, read, record_keys,
};
use toolroom_process::{AnyRecord, Record, record};

record! {
    /// How the wheel is dressed.
    ///
    /// # Source
    /// Assumption.
    pub struct DressingPlan {
        /// Time that a dressing takes.
        dressing_time: Real["s" => "s"] = 90.0, 0.0..=1e5;
        /// Most parts between dressings that are considered.
        most_parts: Integer = 500.0, 1.0..=1e5;
        /// Greatest finish infeed of the estimate.
        finish_infeed: Real["m" => "um"] = 1e-6, 1e-9..=1e-3;
    }
}

/// A grinding task: machine, conditions, limits.
///
/// ```toml
/// schema = 1
/// title = "Rings, 100 um of stock"
/// parameter_set = "zb153u_40kh"
/// effects = [{ id = "threshold_force", size = "20 N" }]  # what the set leaves out
/// [parameters]                 # deviations from the set
/// dulling_rate = "0.000667 mm/mm3"
/// [conditions]                 # fields of the input
/// work_rotation_speed = "292 rpm"
/// [limits]                     # fields of CycleLimits
/// stock = "100 um"
/// [dressing]                   # fields of DressingPlan; left out: no dressing interval
/// dressing_time = "90 s"
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
    /// Dressing, where it is asked for.
    pub dressing: Option<DressingPlan>,
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

/// Keys of a cycle file.
pub static CYCLE: Form = Form {
    title: "the cycle file",
    doc: "A grinding cycle to be designed; what is left out has its default",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::default("title", Kind::Text, "", "One line for people"),
        Key::optional("parameter_set", Kind::Text, "Shipped set of the process"),
        Key::optional("effects", Kind::Content(&EFFECT_LIST), "Effects that the parameter set leaves out"),
        Key::optional("parameters", Kind::Table(&PARAMETERS), "Deviations from the parameter set"),
        Key::optional("conditions", Kind::Table(&CONDITIONS), "What the machine does and what surrounds the cut"),
        Key::optional("limits", Kind::Table(&LIMITS), "What the cycle has to keep"),
        Key::optional("dressing", Kind::Table(&DRESSING), "How the wheel is dressed"),
    ],
};

impl ContentFault for SetError {
    fn code(&self) -> &'static str {
        match self {
            Self::Unknown { .. } => "unknown-name",
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

    /// The fastest cycle on a dressed wheel.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn fastest_cycle(&self) -> Result<Cycle, CycleError> {
        fastest_cycle(&self.grinding, &State::default(), &self.input, &self.limits)
    }

    /// The dressing interval by estimated cycles, and by the exact cycle of every part; none
    /// where the file does not ask for it.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn dressing_intervals(&self) -> Result<Option<[DressingInterval; 2]>, CycleError> {
        let Some(plan) = &self.dressing else { return Ok(None) };
        let (grinding, input, limits) = (&self.grinding, &self.input, &self.limits);
        let volume = std::f64::consts::PI * grinding.parameters.work_diameter * limits.stock;
        let wheel = |removed_volume| State { removed_volume, ..State::default() };
        let most = plan.most_parts as u32;
        let estimate = |v: f64| cycle_time_estimate(grinding, &wheel(v), input, limits, plan.finish_infeed);
        let exact = |v: f64| Ok(fastest_cycle(grinding, &wheel(v), input, limits)?.time);
        Ok(Some([
            dressing_interval(estimate, volume, plan.dressing_time, most)?,
            dressing_interval(exact, volume, plan.dressing_time, most)?,
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
    let records: [(&str, Option<&mut dyn AnyRecord>); 4] = [
        ("parameters", Some(&mut parameters)),
        ("conditions", Some(&mut input)),
        ("limits", Some(&mut limits)),
        ("dressing", dressing.as_mut().map(|plan| plan as &mut dyn AnyRecord)),
    ];
    for (key, record) in records {
        if let (Some(table), Some(record)) = (walk.table(root, key), record) {
            fill_record(&table, record);
        }
    }
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
    CycleFile { title, grinding, input, limits, dressing }
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
