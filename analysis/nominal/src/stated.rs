//! What a model file states beside its parameter sets, and how a fit starts from there.

use super::parts::Part;
use super::{Candidate, EffectId, Frame, Movable, Words};
use toolroom_effects::Definition;
use toolroom_records::Records;
use toolroom_scenario::{Calibration, CalibrationShift, Deviation, Occasion, Scenario, Scope, SwitchedEffect};

/// Effects, deviations and calibration of a model file. Fits count from what they say: the nominal model is that
/// which `run` simulates.
#[derive(Clone, Debug, Default)]
pub struct Declarations {
    /// Name of the tool whose process is diagnosed.
    pub tool: Option<String>,
    /// Its effects.
    pub effects: Vec<SwitchedEffect>,
    /// Effects that a user has defined, in the file or beside it.
    pub defined: Vec<&'static Definition>,
    /// Effects of the shop.
    pub deviations: Vec<Deviation>,
    /// Constants that measurements have moved.
    pub calibrations: Vec<Calibration>,
    /// Mean time of loading and unloading by machine, s.
    pub handling: Vec<(String, f64)>,
    /// Names of the parts of the scenario.
    pub parts: Vec<String>,
    /// Hashes of the records that the calibration has seen.
    pub seen: Vec<String>,
    /// Effects by id and shape that are tried on parts of the records, too.
    pub split: Vec<(EffectId, String)>,
    /// Levels of columns on which every effect is tried, too.
    pub places: Vec<(String, String)>,
}

impl Declarations {
    /// What a scenario states about a tool, or about the shop.
    pub fn from_scenario(scenario: &Scenario, tool: Option<usize>) -> Self {
        let tool = tool.map(|index| &scenario.tools[index]);
        let handling = |machine: &toolroom_scenario::MachineType| {
            (machine.name.clone(), machine.load_time.mean() + machine.unload_time.mean())
        };
        Self {
            tool: tool.map(|tool| tool.name.clone()),
            effects: tool.map_or_else(Vec::new, |tool| tool.variants.effects.clone()),
            defined: scenario.defined.clone(),
            deviations: scenario.deviations.clone(),
            calibrations: scenario.calibrations.clone(),
            handling: scenario.machines.iter().map(handling).collect(),
            parts: scenario.parts.iter().map(|part| part.name.clone()).collect(),
            seen: Vec::new(),
            split: Vec::new(),
            places: Vec::new(),
        }
    }

    /// Whether effects are tried on parts of the records.
    pub(crate) fn is_split(&self) -> bool {
        !self.split.is_empty() || !self.places.is_empty()
    }

    /// Which effects are tried on which parts of the records, those first that come first of all: where the strongest structure
    /// follows a level, every effect is tried there and then everywhere but there, since what lengthens the one and what
    /// shortens the other leave the same structure.
    pub(crate) fn tried<'a>(&self, effects: &[Candidate], parts: &'a [Part]) -> Vec<(usize, &'a Part)> {
        let at_level = |part: &Part| self.places.iter().any(|(column, name)| part.is_level(column, name));
        let beside = |part: &Part| self.places.iter().any(|(column, name)| part.leaves_out(column, name));
        let split =
            |effect: &Candidate| self.split.iter().any(|(id, shape)| effect.id == *id && effect.shape == *shape);
        let with = |part: &'a Part| effects.iter().enumerate().map(move |(index, effect)| (index, effect, part));
        let all = || parts.iter().flat_map(with);
        let first = all().filter(|(_, effect, part)| at_level(part) || split(effect));
        let second = all().filter(|(_, effect, part)| beside(part) && !at_level(part) && !split(effect));
        first.chain(second).map(|(index, _, part)| (index, part)).collect()
    }

    /// Rows of `records` on which something with this scope acts, 1 or 0 each.
    pub fn rows(&self, records: &Records, scope: &Scope) -> Vec<f64> {
        let tool = self.tool.as_deref();
        let on = |row: usize| f64::from(u8::from(scope.holds(&occasion(records, row, tool))));
        (0..records.len()).map(on).collect()
    }

    /// A scope without the name of the tool that all rows have.
    pub fn normal(&self, scope: &Scope) -> Scope {
        let mut scope = scope.clone();
        let own = |names: &Vec<String>| self.tool.as_ref().is_some_and(|tool| names.contains(tool));
        scope.names.retain(|(key, names)| *key != "tool" || !own(names));
        scope
    }

    /// Nominal handling time of each row, s: that of its machine, of all in the mean where it is not known.
    pub fn handling_of(&self, records: &Records) -> Vec<f64> {
        let mean = self.handling.iter().map(|(_, time)| time).sum::<f64>() / self.handling.len().max(1) as f64;
        let machines = records.texts("machine");
        let time = |row: usize| {
            let handling = machines.and_then(|names| self.handling.iter().find(|(name, _)| *name == names[row]));
            handling.map_or(mean, |(_, time)| *time)
        };
        (0..records.len()).map(time).collect()
    }

    /// Spread of a calibration before these records: as its file says, or as it was left by other records.
    pub fn spread(calibration: &Calibration, default: f64) -> f64 {
        let prior = calibration.prior.filter(|prior| *prior > 0.0).unwrap_or(default);
        match calibration.standard_error {
            Some(error) => error.hypot(STAYS * prior),
            None => prior,
        }
    }

    /// Takes the calibration that matches `movable` out, with the value that it gives: the logarithm of a factor, or
    /// a summand.
    pub fn take(&mut self, movable: &Movable) -> Option<(Calibration, f64)> {
        let same = |own: &Calibration| {
            own.parameter == movable.parameter
                && own.target == movable.target
                && self.normal(&own.scope) == movable.scope
        };
        let place = self.calibrations.iter().position(same)?;
        let value = match self.calibrations[place].moved {
            CalibrationShift::Factor(factor) if !movable.summand => factor.ln(),
            CalibrationShift::Summand(summand) if movable.summand => summand,
            CalibrationShift::Factor(_) | CalibrationShift::Summand(_) => return None,
        };
        let value = if movable.inverse { -value } else { value };
        Some((self.calibrations.remove(place), value))
    }
}

/// Share of a prior that stays after measurements: what one set of records shows another may not (assumption).
pub(crate) const STAYS: f64 = 0.25;

/// A row of records as scopes see it.
pub(crate) fn occasion<'a>(records: &'a Records, row: usize, tool: Option<&str>) -> Occasion<'a> {
    let text = |column: &str| records.texts(column).map(|values| values[row].as_str());
    Occasion::recorded(&text, records.numbers("start_time").map(|times| times[row]), tool)
}

impl Words {
    /// Finds what the file states of the parameters and surfaces of a frame; their spread becomes the file's.
    pub(super) fn settle(frame: &mut Frame, stated: &mut Declarations) {
        let words = std::mem::take(&mut frame.words);
        let mut found = Self { effects: words.effects.clone(), ..Self::default() };
        for (name, movable) in &words.movable {
            for (i, parameter) in frame.parameters.iter_mut().enumerate().filter(|(_, own)| own.name == *name) {
                if let Some((calibration, value)) = stated.take(movable) {
                    parameter.deviation = Declarations::spread(&calibration, parameter.deviation);
                    found.parameters.push((i, value / parameter.deviation));
                }
            }
            for (i, surface) in frame.surfaces.iter_mut().enumerate().filter(|(_, own)| own.name == *name) {
                if let Some((calibration, value)) = stated.take(movable) {
                    surface.deviation = Declarations::spread(&calibration, surface.deviation);
                    found.surfaces.push((i, value / surface.deviation));
                }
            }
        }
        for calibration in stated.calibrations.drain(..) {
            let (parameter, target) = (&calibration.parameter, calibration.target.words());
            frame.notes.push(format!("[[calibration]] {parameter} of {target} says nothing about these records"));
        }
        frame.words = Self { movable: words.movable, ..found };
    }
}
