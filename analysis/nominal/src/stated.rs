//! What a model file states beside its parameter sets, and how a fit starts from there.

use super::parts::Part;
use super::{Candidate, Direction, EffectRefusal, Forward, Frame, Point, Transform, WrittenEffect};
use toolroom_effects::Definition;
use toolroom_innovations::Chain;
use toolroom_records::Records;
use toolroom_scenario::{Calibration, Deviation, Moved, Occasion, Scenario, Scope, SwitchedEffect, Target};

/// Effects, deviations and calibration of a model file. Fits count from what they say: the nominal model is that
/// which `run` simulates.
#[derive(Clone, Debug, Default)]
pub struct Stated {
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
    pub split: Vec<(String, String)>,
    /// Levels of columns on which every effect is tried, too.
    pub places: Vec<(String, String)>,
}

impl Stated {
    /// What a scenario states about a tool, or about the shop.
    pub fn of(scenario: &Scenario, tool: Option<usize>) -> Self {
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

    /// Whether an effect is tried on this part of the records.
    pub(crate) fn tries(&self, effect: &Candidate, part: &Part) -> bool {
        part.is_asked_for(self) || self.split.iter().any(|(id, shape)| effect.id == id && effect.shape == *shape)
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

    /// Takes the calibration that matches `what` out, with the value that it gives: the logarithm of a factor, or
    /// a summand.
    pub fn take(&mut self, what: &Movable) -> Option<(Calibration, f64)> {
        let same = |own: &Calibration| {
            own.parameter == what.parameter && own.target == what.target && self.normal(&own.scope) == what.scope
        };
        let place = self.calibrations.iter().position(same)?;
        let value = match self.calibrations[place].moved {
            Moved::Factor(factor) if !what.summand => factor.ln(),
            Moved::Summand(summand) if what.summand => summand,
            Moved::Factor(_) | Moved::Summand(_) => return None,
        };
        let value = if what.inverse { -value } else { value };
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

/// How a scenario says that a parameter or a surface of a frame has moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Movable {
    /// `parameter` of its `[[calibration]]`.
    pub parameter: String,
    /// Its target.
    pub target: Target,
    /// Its scope.
    pub scope: Scope,
    /// Whether it is a summand, SI, instead of a factor.
    pub summand: bool,
    /// Whether the factor of the file is the inverse of that of the frame: a life against a rate.
    pub inverse: bool,
    /// Least and greatest factor of the file on the value of the parameter set, by the range of the constant (1).
    pub range: [f64; 2],
}

/// Relative distance to the end of a range at which a constant stays, so that rounding does not take it beyond (1).
const WITHIN: f64 = 1e-12;

impl Movable {
    /// A factor everywhere.
    pub fn factor(parameter: impl Into<String>, target: Target) -> Self {
        let (scope, range) = (Scope::default(), [0.0, f64::INFINITY]);
        Self { parameter: parameter.into(), target, scope, summand: false, inverse: false, range }
    }

    /// The same for a constant whose value in the parameter set is `value` and whose range is `least` to `greatest`.
    #[must_use]
    pub fn between(self, value: f64, least: f64, greatest: f64) -> Self {
        if !(value > 0.0 && least <= value && value <= greatest) {
            return self;
        }
        Self { range: [least / value * (1.0 + WITHIN), greatest / value * (1.0 - WITHIN)], ..self }
    }
}

/// Where fits start, and the words of a scenario for what they may move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Words {
    /// Parameters and surfaces by name.
    pub movable: Vec<(String, Movable)>,
    /// Values of parameters that the file states, in prior standard deviations.
    pub parameters: Vec<(usize, f64)>,
    /// Of surfaces.
    pub surfaces: Vec<(usize, f64)>,
    /// Sizes of candidates, SI.
    pub effects: Vec<(usize, f64)>,
}

impl Words {
    /// How a scenario says the parameter or surface called `name`.
    pub fn of(&self, name: &str) -> Option<&Movable> {
        self.movable.iter().find(|(own, _)| own == name).map(|(_, movable)| movable)
    }

    /// Finds what the file states of the parameters and surfaces of a frame; their spread becomes the file's.
    pub(super) fn settle(frame: &mut Frame, stated: &mut Stated) {
        let words = std::mem::take(&mut frame.words);
        let mut found = Self { effects: words.effects.clone(), ..Self::default() };
        for (name, movable) in &words.movable {
            for (i, parameter) in frame.parameters.iter_mut().enumerate().filter(|(_, own)| own.name == *name) {
                if let Some((calibration, value)) = stated.take(movable) {
                    parameter.deviation = Stated::spread(&calibration, parameter.deviation);
                    found.parameters.push((i, value / parameter.deviation));
                }
            }
            for (i, surface) in frame.surfaces.iter_mut().enumerate().filter(|(_, own)| own.name == *name) {
                if let Some((calibration, value)) = stated.take(movable) {
                    surface.deviation = Stated::spread(&calibration, surface.deviation);
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

/// A model whose nominal point is what its file states.
pub(super) struct Given {
    model: Box<dyn Forward>,
    frame: Frame,
    base: Point,
}

impl Given {
    /// The model counted from what its file states; the model itself where that is nothing.
    pub fn around(model: Box<dyn Forward>) -> Box<dyn Forward> {
        let words = &model.frame().words;
        if words.parameters.is_empty() && words.surfaces.is_empty() && words.effects.is_empty() {
            return model;
        }
        let mut base = Point::nominal(model.as_ref());
        words.parameters.iter().for_each(|(i, x)| base.parameters[*i] = *x);
        words.surfaces.iter().for_each(|(i, x)| base.surfaces[*i] = *x);
        words.effects.iter().for_each(|(i, size)| base.effects[*i] = *size);
        let mut frame = model.frame().clone();
        words.effects.iter().for_each(|(i, size)| frame.candidates[*i].greatest -= size);
        Box::new(Self { model, frame, base })
    }

    fn from(&self, at: &Point) -> Point {
        let mut point = at.clone();
        point.parameters.iter_mut().zip(&self.base.parameters).for_each(|(x, base)| *x += base);
        point.effects.iter_mut().zip(&self.base.effects).for_each(|(size, base)| *size += base);
        point
    }

    /// Factor and summand that the stated surfaces give each observation.
    fn surfaces(&self) -> Vec<(f64, f64)> {
        let measured = &self.frame.measured;
        let mut both = vec![(0.0_f64, 0.0); measured.len()];
        for (surface, x) in self.frame.surfaces.iter().zip(&self.base.surfaces).filter(|(_, x)| **x != 0.0) {
            for (observation, (relative, absolute)) in measured.observations.iter().zip(&mut both) {
                if surface.channels.contains(&observation.channel) {
                    let value = surface.deviation * x * surface.feature[observation.row];
                    *(if surface.absolute { absolute } else { relative }) += value;
                }
            }
        }
        both.iter_mut().for_each(|(relative, _)| *relative = relative.exp());
        both
    }
}

impl Forward for Given {
    fn frame(&self) -> &Frame {
        &self.frame
    }

    fn simulate(&self, at: &Point) -> Vec<f64> {
        let mut raw = self.model.simulate(&self.from(at));
        raw.iter_mut().zip(self.surfaces()).for_each(|(raw, (factor, summand))| *raw = *raw * factor + summand);
        raw
    }

    fn slopes(&self, at: &Point, raw: &[f64], along: &[Direction]) -> Vec<Vec<f64>> {
        let surfaces = self.surfaces();
        let inner: Vec<f64> = raw.iter().zip(&surfaces).map(|(raw, (factor, add))| (raw - add) / factor).collect();
        let mut slopes = self.model.slopes(&self.from(at), &inner, along);
        for slope in &mut slopes {
            slope.iter_mut().zip(&surfaces).for_each(|(slope, (factor, _))| *slope *= factor);
        }
        slopes
    }

    fn refusal(&self, at: &Point) -> Option<EffectRefusal> {
        self.model.refusal(&self.from(at))
    }

    fn scatter_is_known(&self, channel: usize) -> bool {
        self.model.scatter_is_known(channel)
    }

    fn chains(&self, at: &Point) -> Vec<Chain> {
        let from = self.from(at);
        let mut chains = self.model.chains(&from);
        if chains.is_empty() || self.base.surfaces.iter().all(|x| *x == 0.0) {
            return chains;
        }
        // What a stated surface does to a value it does to its scatter.
        let (raw, surfaces) = (self.model.simulate(&from), self.surfaces());
        let measured = &self.frame.measured;
        let readings = chains.iter_mut().flat_map(|chain| &mut chain.rows).flat_map(|row| &mut row.readings);
        for reading in readings {
            let (factor, summand) = surfaces[reading.place];
            let value = raw[reading.place] * factor;
            let scale = match measured.channels[measured.observations[reading.place].channel].transform {
                Transform::Linear => factor,
                Transform::Log if value + summand > 0.0 => value / (value + summand),
                Transform::Log => 0.0,
            };
            reading.by = reading.by.map(|slope| slope * scale);
        }
        chains
    }

    fn written(&self, candidate: usize) -> WrittenEffect {
        self.model.written(candidate)
    }
}
