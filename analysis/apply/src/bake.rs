//! A parameter set from the set of a scenario's tool and what the scenario moves in it.

use std::path::Path;
use std::sync::Arc;
use toolroom_cutting::MILLING_CATALOGUE;
use toolroom_process::{AnyRecord, Process as _};
use toolroom_scenario::{
    Calibration, CalibrationShift, Occasion, ProcessModel, Scenario, ShopConstant, Target, ToolType, calibrated,
};
use toolroom_wear::{Origin, ParameterSet, SetError, Spread, TURNING_SETS};

/// Relative deviations that differ by less are the same number, read and written (rounding of decimals is far below).
const SAME: f64 = 1e-9;

/// A baked set.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The set.
    pub set: ParameterSet,
    /// What moved in it, in words.
    pub moved: Vec<String>,
    /// Entries that no set can hold, in words.
    pub left_out: Vec<String>,
}

/// Why no set was made.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// No tool has this name.
    #[error("no tool `{tool}`")]
    Tool {
        /// As given.
        tool: String,
        /// Tools that there are.
        known: String,
    },
    /// The tool has no set of turning or milling.
    #[error("the tool `{0}` neither turns nor mills")]
    Process(String),
    /// Its set cannot be read.
    #[error(transparent)]
    Set(#[from] SetError),
    /// The set would be the old one.
    #[error("nothing of the tool `{0}` is stated or calibrated everywhere")]
    Nothing(String),
}

impl BakeError {
    /// The way out.
    pub fn fix(&self) -> String {
        match self {
            Self::Tool { known, .. } => format!("there are {known}"),
            Self::Process(_) => "sets of turning and milling can be baked".to_owned(),
            Self::Set(_) => "mend the set of the tool".to_owned(),
            Self::Nothing(_) => "`gap apply` writes [[calibration]] into a scenario".to_owned(),
        }
    }
}

/// The set of `tool` with the values that the scenario states or calibrates everywhere. `place` is the scenario's file for
/// sources, `folder` that from which paths of sets count. A rate of wear that is another one (`wear_rate`) moves the levels of
/// the wear law.
///
/// # Errors
/// See [`BakeError`].
pub fn bake(scenario: &Scenario, tool: &str, place: &str, folder: &Path) -> Result<Baked, BakeError> {
    let named = scenario.tools.iter().find(|tool_type| tool_type.name == tool).ok_or_else(|| {
        let known: Vec<&str> = scenario.tools.iter().map(|tool_type| tool_type.name.as_str()).collect();
        BakeError::Tool { tool: tool.to_owned(), known: known.join(", ") }
    })?;
    let catalogue = match named.process {
        ProcessModel::Turning(_) => &TURNING_SETS,
        ProcessModel::Milling(_) => &MILLING_CATALOGUE,
        ProcessModel::Infeed(_) | ProcessModel::Other(_) => return Err(BakeError::Process(tool.to_owned())),
    };
    let mut set = ParameterSet::load(&named.parameter_set, folder, catalogue)?;
    if let ProcessModel::Turning(turning) = named.bare() {
        set = set.under_law(turning.pair.law.group(), catalogue);
    }
    let mut moved = stated(&mut set, named, place);
    known(&mut set, named);
    let mut left_out = Vec::new();
    let mut rates: Vec<Calibration> = Vec::new();
    for calibration in &scenario.calibrations {
        let of_tool = matches!(&calibration.target, Target::Tool(name) if name == tool);
        let own = of_tool && calibration.scope.is_everywhere();
        if own && calibration.parameter == ShopConstant::WearRate.word() {
            rates.push(calibration.clone());
            continue;
        }
        let value = set.values.iter_mut().find(|value| value.key() == calibration.parameter);
        let (true, Some(value)) = (own, value) else {
            left_out.push(format!("{} of {}", calibration.parameter, calibration.target.words()));
            continue;
        };
        let before = value.shown();
        let (by, spread) = match calibration.moved {
            CalibrationShift::Factor(factor) => {
                value.value *= factor;
                (format!("times {factor:.5}"), calibration.standard_error.map(|error| Spread::Factor(error.exp())))
            }
            CalibrationShift::Summand(summand) => {
                value.value += summand;
                let shown = |error: f64| Spread::Deviation(value.field.to_display(error));
                (
                    format!("moved by {:.5} {}", value.field.to_display(summand), value.field.display),
                    calibration.standard_error.map(shown),
                )
            }
        };
        value.origin = Origin::Given;
        value.source = format!("{}; {by} by {} in {place}", value.source, calibration.by);
        if let Some(spread) = spread {
            set.prior.insert(calibration.parameter.clone(), spread);
        }
        moved.push(format!("{}: {before} {by}", calibration.parameter));
    }
    moved.extend(rate(&mut set, rates, place, &mut left_out));
    if moved.is_empty() {
        return Err(BakeError::Nothing(tool.to_owned()));
    }
    Ok(Baked { set, moved, left_out })
}

/// The rate of wear as all its entries together make it, in the levels of the law.
fn rate(set: &mut ParameterSet, rates: Vec<Calibration>, place: &str, left_out: &mut Vec<String>) -> Option<String> {
    let by = rates.first()?.by.clone();
    let target = rates[0].target.clone();
    let errors: Vec<f64> = rates.iter().filter_map(|rate| rate.standard_error).collect();
    let word = ShopConstant::WearRate;
    let Target::Tool(tool) = &target else { return None };
    let mut here = Occasion::default();
    here.set("tool", tool.as_str());
    let factor = calibrated(&rates, word, &here, 1.0);
    let keys = if factor > 0.0 && factor.is_finite() {
        set.scale_wear_rate(factor, &format!("wear rate times {factor:.5} by {by} in {place}"))
    } else {
        Vec::new()
    };
    if keys.is_empty() {
        left_out.push(format!("{} of {}", word.word(), target.words()));
        return None;
    }
    // Errors of entries are independent; that of a summand counts against the rate that it moves.
    let error = errors.iter().map(|error| error * error).sum::<f64>().sqrt();
    if error > 0.0 {
        set.prior.extend(keys.iter().map(|key| (key.clone(), Spread::Factor(error.exp()))));
    }
    Some(format!("{}: times {factor:.5}, in {}", word.word(), keys.join(" and ")))
}

/// How well the tool's values are known by what it states beside the set: lives and constants of a handbook come with spreads of
/// their own.
fn known(set: &mut ParameterSet, tool: &ToolType) {
    // Draws say more than a set can hold; its own section stands.
    if tool.posterior.is_some() {
        return;
    }
    for (key, deviation) in &tool.spreads.parameters {
        let Some(value) = set.values.iter().find(|value| value.key() == *key) else { continue };
        let same = match set.prior.get(key) {
            Some(Spread::Factor(factor)) => (factor.ln() - deviation).abs() <= SAME,
            Some(Spread::Deviation(own)) => (own / value.field.to_display(value.value) - deviation).abs() <= SAME,
            None => false,
        };
        if !same {
            set.prior.insert(key.clone(), Spread::Factor(deviation.exp()));
        }
    }
}

/// Values of the tool that the scenario states beside the set (`parameters`, `handbook`).
fn stated(set: &mut ParameterSet, tool: &ToolType, place: &str) -> Vec<String> {
    let mut bare = tool.bare().clone();
    let groups: Vec<(&str, &mut dyn AnyRecord)> = match &mut bare {
        ProcessModel::Turning(process) => Arc::make_mut(process).parameters_mut(),
        ProcessModel::Milling(process) => Arc::make_mut(process).parameters_mut(),
        ProcessModel::Infeed(_) | ProcessModel::Other(_) => Vec::new(),
    };
    let mut statements = Vec::new();
    for (group, record) in groups {
        for (index, field) in record.fields().iter().enumerate() {
            let Some(now) = record.value(index) else { continue };
            let matching = set.values.iter_mut().find(|value| value.group == group && value.field.name == field.name);
            let Some(value) = matching.filter(|value| value.value != now) else { continue };
            let before = if value.value.is_nan() { String::new() } else { format!("{} ", value.shown()) };
            (value.value, value.origin) = (now, Origin::Given);
            value.source = format!("stated in {place}");
            statements.push(format!("{}: {before}is {}", value.key(), value.shown()));
        }
    }
    statements
}
