//! A tool's process under the effects and constants that act only on some operations.

use crate::{Calibration, CalibrationShift, Occasion, ProcessModel, Scope};
use std::sync::Arc;
use toolroom_effects::{Effect, Effects};
use toolroom_process::Process as _;

/// An effect of a tool as its file gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct SwitchedEffect {
    /// The effect with size and shape.
    pub effect: Effect,
    /// Operations on which it acts.
    pub scope: Scope,
    /// Standard error of the size, SI.
    pub standard_error: Option<f64>,
}

/// Entries with a scope that one tool may have: each doubles the number of its processes.
pub const MOST_SCOPED: usize = 8;

/// What a file makes of the parameter set of a tool.
#[derive(Clone, Debug, Default)]
pub struct Variants {
    /// The process of parameter set and `parameters` alone; that of the tool, if none.
    pub bare: Option<ProcessModel>,
    /// Effects as the file gives them.
    pub effects: Vec<SwitchedEffect>,
    /// Scopes of the entries that act on some operations only.
    pub(crate) scopes: Vec<Scope>,
    /// The process by the set of acting entries, bit i being `scopes[i]`; empty where there is no scope.
    pub(crate) processes: Vec<ProcessModel>,
}

/// One entry: an effect, or a constant that is moved.
enum Entry<'a> {
    Effect(Effect),
    Constant(&'a str, &'a str, CalibrationShift),
}

impl Variants {
    /// Effects as a file gives them, which are not worked out yet.
    pub fn written(effects: Vec<SwitchedEffect>) -> Self {
        Self { effects, ..Self::default() }
    }

    /// The process of a tool that acts where no scope holds, and what else there is of it. `constants` are the
    /// calibrations of its process; effects of `process` itself do not count.
    ///
    /// # Errors
    /// Parameter that the process does not have, or a word about entries that cannot stand together.
    pub fn from_process_model(
        process: &ProcessModel,
        effects: Vec<SwitchedEffect>,
        constants: &[&Calibration],
    ) -> Result<(ProcessModel, Self), String> {
        let mut always: Vec<Entry<'_>> = Vec::new();
        let mut sometimes: Vec<(&Scope, Entry<'_>)> = Vec::new();
        let scoped = effects.iter().map(|own| (&own.scope, Entry::Effect(own.effect)));
        let moved = constants.iter().filter_map(|own| {
            own.constant().map(|(group, field)| (&own.scope, Entry::Constant(group, field, own.moved)))
        });
        for (scope, entry) in scoped.chain(moved) {
            if scope.is_everywhere() { always.push(entry) } else { sometimes.push((scope, entry)) }
        }
        if sometimes.len() > MOST_SCOPED {
            return Err(format!("{} entries with a scope; at most {MOST_SCOPED} are possible", sometimes.len()));
        }
        let bare = with(process, &[])?;
        let process = with(&bare, &always.iter().collect::<Vec<_>>())?;
        let mut variants = Self { bare: Some(bare.clone()), ..Self::default() };
        if !sometimes.is_empty() {
            for mask in 0..1usize << sometimes.len() {
                let acting = sometimes.iter().enumerate().filter(|(i, _)| mask >> i & 1 == 1).map(|(_, own)| &own.1);
                variants.processes.push(with(&bare, &always.iter().chain(acting).collect::<Vec<_>>())?);
            }
        }
        variants.scopes = sometimes.into_iter().map(|(scope, _)| scope.clone()).collect();
        variants.effects = effects;
        Ok((process, variants))
    }

    /// The set of entries that act on an operation, for [`crate::ToolType::process_of`].
    pub fn acting(&self, occasion: &Occasion<'_>) -> u32 {
        self.scopes.iter().enumerate().map(|(i, scope)| u32::from(scope.holds(occasion)) << i).sum()
    }

    /// The process where the set `acting` acts; `None` where no entry has a scope.
    pub(crate) fn process(&self, acting: u32) -> Option<&ProcessModel> {
        self.processes.get(acting as usize)
    }

    /// Whether the lots of workpieces deviate because of an effect with a scope among those of the set `acting`.
    pub fn hardens_lots(&self, acting: u32) -> bool {
        self.switches(acting, |effect| matches!(effect, Effect::LotHardness(_)))
    }

    /// Whether the coolant is another one because of an effect with a scope among those of the set `acting`.
    pub fn changes_coolant(&self, acting: u32) -> bool {
        self.switches(acting, |effect| matches!(effect, Effect::CoolantChange(_)))
    }

    fn switches(&self, acting: u32, is: fn(&Effect) -> bool) -> bool {
        let scoped = self.effects.iter().filter(|switched| !switched.scope.is_everywhere());
        scoped.enumerate().any(|(i, switched)| acting >> i & 1 == 1 && is(&switched.effect))
    }

    /// Whether some entry acts on some operations only.
    pub fn has_scopes(&self) -> bool {
        !self.scopes.is_empty()
    }
}

/// A process with other effects and with constants moved.
fn with(bare: &ProcessModel, entries: &[&Entry<'_>]) -> Result<ProcessModel, String> {
    let list = entries.iter().filter_map(|entry| if let Entry::Effect(effect) = entry { Some(*effect) } else { None });
    let effects = Effects::overlaid(list.collect());
    macro_rules! changed {
        ($process:expr, $wrap:path) => {{
            let mut process = (**$process).clone();
            process.effects = effects;
            for entry in entries {
                if let Entry::Constant(group, field, moved) = entry {
                    move_constant(process.parameters_mut(), group, field, *moved)?;
                }
            }
            $wrap(Arc::new(process))
        }};
    }
    Ok(match bare {
        ProcessModel::Turning(process) => changed!(process, ProcessModel::Turning),
        ProcessModel::Milling(process) => changed!(process, ProcessModel::Milling),
        ProcessModel::Infeed(process) => changed!(process, ProcessModel::Infeed),
        ProcessModel::Other(_) if entries.is_empty() => bare.clone(),
        ProcessModel::Other(_) => return Err("an imported unit takes neither effects nor calibration".to_owned()),
    })
}

/// Moves one constant among the parameter groups of a process.
///
/// # Errors
/// Parameter that is not there, or a value outside its range.
pub fn move_constant(
    mut groups: Vec<(&'static str, &mut dyn toolroom_process::AnyRecord)>,
    group: &str,
    field: &str,
    moved: CalibrationShift,
) -> Result<(), String> {
    for (name, record) in &mut groups {
        let fields = record.fields();
        if let Some(i) = fields.iter().position(|own| own.name == field).filter(|_| *name == group) {
            let value = record.value(i).unwrap_or(f64::NAN);
            let value = match moved {
                CalibrationShift::Factor(factor) => value * factor,
                CalibrationShift::Summand(summand) => value + summand,
            };
            fields[i].check(value).map_err(|error| format!("{group}.{field}: {error}"))?;
            record.set_value(i, value);
            return Ok(());
        }
    }
    let known = groups.iter().flat_map(|(name, record)| {
        record.fields().iter().map(move |field| format!("{name}.{}", field.name)).collect::<Vec<_>>()
    });
    let known: Vec<String> = known.collect();
    let wanted = format!("{group}.{field}");
    let near = toolroom_form::nearest(&wanted, known.iter().map(String::as_str));
    let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    Err(format!("the process has no constant `{wanted}`{near}"))
}
