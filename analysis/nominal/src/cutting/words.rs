//! What a scenario calls the numbers of this model, and what it states of them.

use super::{Action, Change, Cutting, Fixed, Nominal};
use crate::cutting_effects::timed;
use crate::features::first_of_group;
use crate::stated::{Declarations, occasion};
use crate::{Candidate, ChannelId, EffectId, Movable, Parameter, Role, Surface, Words, WrittenEffect};
use toolroom_effects::Effect;
use toolroom_records::Records;
use toolroom_scenario::{CalibrationShift, MICRO_STOP, Scope, ShopEffect, Target};

/// Spread of a calibration that no parameter of the model has, where the file gives none (assumption).
const UNKNOWN: f64 = 0.05;

impl<P: Nominal> Cutting<P> {
    /// Takes over what the file states about these rows.
    pub(super) fn state(&mut self, records: &Records, stated: &mut Declarations) {
        self.name(stated);
        self.switch_on(records, stated);
        self.deviate(records, stated);
        self.move_others(records, stated);
        Words::settle(&mut self.frame, stated);
        self.vary();
    }

    /// The words of a scenario for parameters and surfaces.
    fn name(&mut self, stated: &Declarations) {
        let Some(tool) = stated.tool.clone() else { return };
        let tool = || Target::Tool(tool.clone());
        let mut list: Vec<(String, Movable)> = Vec::new();
        for (parameter, change) in self.frame.parameters.iter().zip(&self.changes) {
            match change {
                Change::Constant { group, name } => {
                    let movable = Movable::factor(format!("{group}.{name}"), tool());
                    let movable = match self.constant(group, name) {
                        Some((value, least, greatest)) => movable.between(value, least, greatest),
                        None => movable,
                    };
                    list.push((parameter.name.clone(), movable));
                }
                Change::Wear => list.push((parameter.name.clone(), Movable::factor("wear_rate", tool()))),
                // No scenario has a word for these.
                Change::WearFeature(_) | Change::WearOfLand(..) | Change::Start => {}
            }
        }
        for surface in self.frame.surfaces.iter().filter(|surface| !surface.role.is_allowance()) {
            let name = &surface.name;
            let channel = surface.channels.first().map_or("", |index| self.frame.measured.channels[*index].id.word());
            let gain = |target: Target| Movable::factor(format!("gain.{channel}"), target);
            // Machines and parts that the scenario does not know have no words in it.
            let movable = match &surface.role {
                Role::MachineGain(machine) if stated.handling.iter().all(|(known, _)| known != machine) => continue,
                Role::Fixture(part) if !stated.parts.contains(part) => continue,
                Role::HandlingTime => Movable { summand: true, ..Movable::factor("handling_time", tool()) },
                Role::MachineGain(machine) => gain(Target::Machine(machine.clone())),
                Role::Fixture(part) => {
                    let scope = Scope { names: vec![("part", vec![part.clone()])], ..Scope::default() };
                    Movable { scope, ..gain(tool()) }
                }
                Role::Constant | Role::Allowance => gain(tool()),
            };
            list.push((name.clone(), movable));
        }
        self.frame.words.movable = list;
    }

    /// Value of a constant in the parameter set, and its range.
    fn constant(&self, group: &str, name: &str) -> Option<(f64, f64, f64)> {
        let mut process = self.process.clone();
        let groups = process.parameters_mut();
        let (_, record) = groups.into_iter().find(|(own, _)| *own == group)?;
        let i = record.fields().iter().position(|field| field.name == name)?;
        let field = &record.fields()[i];
        Some((record.value(i)?, field.min, field.max))
    }

    /// Effects of the tool: sizes of their candidates, which are added where the records requested none.
    fn switch_on(&mut self, records: &Records, stated: &Declarations) {
        for entry in &stated.effects {
            let (effect, scope) = (entry.effect, stated.normal(&entry.scope));
            let same = |action: &Action| match action {
                Action::Effect(other) => scope.is_everywhere() && other.with_size(0.0) == effect.with_size(0.0),
                Action::Scoped(other, at, _) => *at == scope && other.with_size(0.0) == effect.with_size(0.0),
                Action::Lot(other, name, _) => {
                    of_lot(name) == scope && EffectId::from(other) == EffectId::from(&effect)
                }
                Action::Reading { .. } => false,
            };
            let found = self.actions.iter().position(same);
            let index = found.unwrap_or_else(|| {
                let action = if scope.is_everywhere() {
                    Action::Effect(effect.with_size(0.0))
                } else {
                    Action::Scoped(effect.with_size(0.0), scope.clone(), stated.rows(records, &scope))
                };
                let entry = effect.entry();
                let typical = if effect.size() > 0.0 { effect.size() } else { 1e-3 * entry.size.max };
                self.append(
                    Candidate {
                        id: EffectId::from(&effect),
                        shape: words(effect, &scope),
                        typical,
                        greatest: entry.size.max,
                        least: entry.size.min.min(0.0),
                        onset: 0.0,
                    },
                    action,
                )
            });
            self.frame.words.effects.push((index, effect.size()));
        }
    }

    fn append(&mut self, candidate: Candidate, action: Action) -> usize {
        self.frame.candidates.push(candidate);
        self.actions.push(action);
        self.actions.len() - 1
    }

    /// Effects of the shop that show in the time of an operation.
    fn deviate(&mut self, records: &Records, stated: &Declarations) {
        let firsts = first_of_group(&self.frame.measured.group_of_row);
        for deviation in &stated.deviations {
            let scope = stated.normal(&deviation.scope);
            let same = |(i, candidate): (usize, &Candidate)| {
                matches!(self.actions[i], Action::Reading { .. })
                    && candidate.id == deviation.effect.into()
                    && self.written_effect(i).scope == scope
                    && (deviation.effect == ShopEffect::FeedHold
                        || self.written_effect(i).recorded.is_some() == deviation.recorded.is_some())
            };
            let position = self.frame.candidates.iter().enumerate().position(same);
            let index =
                position.or_else(|| {
                    let channels = timed(&self.frame.measured.channels, deviation.effect)?;
                    let rows = stated.rows(records, &scope);
                    let value = |row: usize| match deviation.effect {
                        ShopEffect::FeedOverride => Some(self.durations[row]),
                        ShopEffect::OperatorDelay => Some(1.0),
                        ShopEffect::ToolChangeDelay => Some(firsts[row]),
                        ShopEffect::MicroStops => Some(MICRO_STOP * self.durations[row]),
                        ShopEffect::FeedHold => Some(deviation.share),
                        // They decide which operations come, and add no time to one that was cut.
                        ShopEffect::ToolChangePolicy | ShopEffect::BreakdownShape => None,
                    };
                    let column: Option<Vec<f64>> =
                        rows.iter().enumerate().map(|(row, on)| Some(on * value(row)?)).collect();
                    let (id, column) = (EffectId::from(deviation.effect), column?);
                    let typical = if deviation.size == 0.0 { 1.0 } else { deviation.size.abs() };
                    let shape = if scope.is_everywhere() { "planned times".to_owned() } else { scope.words() };
                    let recorded = deviation.recorded;
                    let action = Action::Reading { channels, column, scope: scope.clone(), recorded };
                    Some(self.append(
                        Candidate { id, shape, typical, greatest: f64::INFINITY, least: 0.0, onset: 0.0 },
                        action,
                    ))
                });
            if let Some(index) = index {
                self.frame.words.effects.push((index, deviation.size));
            }
        }
    }

    /// Calibration that no parameter or surface has yet: with a scope, or of something else.
    fn move_others(&mut self, records: &Records, stated: &mut Declarations) {
        let known = |own: &Movable, parameter: &str, target: &Target, scope: &Scope, summand: bool| {
            own.parameter == parameter && own.target == *target && own.scope == *scope && own.summand == summand
        };
        let cycle = self.frame.measured.channels.iter().position(|channel| channel.id == ChannelId::CycleTime);
        for (number, calibration) in stated.calibrations.clone().into_iter().enumerate() {
            let scope = stated.normal(&calibration.scope);
            let summand = matches!(calibration.moved, CalibrationShift::Summand(_));
            let words = &self.frame.words.movable;
            if words.iter().any(|(_, word)| known(word, &calibration.parameter, &calibration.target, &scope, summand)) {
                continue;
            }
            let of_other_tool = matches!(&calibration.target, Target::Tool(name) if Some(name) != stated.tool.as_ref());
            if of_other_tool {
                stated.calibrations.retain(|other| *other != calibration);
                continue;
            }
            let mut rows = stated.rows(records, &scope);
            for (row, on) in rows.iter_mut().enumerate() {
                let occasion = occasion(records, row, stated.tool.as_deref());
                *on *= f64::from(u8::from(calibration.target.has(&occasion)));
            }
            let name = format!("{} of {}, {}", calibration.parameter, calibration.target.words(), number + 1);
            let movable = Movable {
                scope: scope.clone(),
                summand,
                ..Movable::factor(calibration.parameter.clone(), calibration.target.clone())
            };
            let spread = calibration.prior.unwrap_or(UNKNOWN);
            let channel =
                |name: &str| self.frame.measured.channels.iter().position(|channel| channel.id.word() == name);
            let mut surface = |channel: Option<usize>, feature: Vec<f64>, absolute: bool| {
                let Some(channel) = channel else { return false };
                let (name, channels) = (name.clone(), vec![channel]);
                let deviation = spread;
                self.frame.surfaces.push(Surface {
                    name,
                    channels,
                    feature,
                    deviation,
                    role: Role::Constant,
                    absolute,
                });
                true
            };
            let moved = match (calibration.parameter.as_str(), calibration.moved) {
                ("wear_rate", CalibrationShift::Factor(_)) => {
                    self.frame.parameters.push(Parameter {
                        name: name.clone(),
                        deviation: spread,
                        role: Role::Constant,
                    });
                    self.changes.push(Change::WearFeature(rows));
                    true
                }
                ("handling_time", CalibrationShift::Summand(_)) => surface(cycle, rows, true),
                ("handling_time" | "programmed_time", CalibrationShift::Factor(factor)) => {
                    // A share of a time: as a summand it is its logarithm that moves.
                    let times = if calibration.parameter == "handling_time" { &self.handling } else { &self.durations };
                    let share = (factor - 1.0) / factor.ln();
                    let share = if share.is_finite() { share } else { 1.0 };
                    let feature = rows.iter().zip(times).map(|(on, time)| on * time * share).collect();
                    surface(cycle, feature, true)
                }
                (parameter, moved) => match (parameter.split_once('.'), moved) {
                    (Some(("gain", name)), CalibrationShift::Factor(_)) => surface(channel(name), rows, false),
                    (Some(("offset", name)), CalibrationShift::Summand(_)) => surface(channel(name), rows, true),
                    (Some((group, field)), moved) if calibration.constant().is_some() => {
                        let rows = (!scope.is_everywhere()).then_some(rows);
                        self.fixed.push(Fixed { group: group.to_owned(), field: field.to_owned(), moved, rows });
                        stated.calibrations.retain(|other| *other != calibration);
                        continue;
                    }
                    _ => false,
                },
            };
            if moved {
                self.frame.words.movable.push((name, movable));
            }
        }
    }

    /// Which processes the rows need.
    fn vary(&mut self) {
        let scoped = self.actions.iter().filter_map(|action| match action {
            Action::Scoped(_, _, rows) => Some(rows),
            Action::Effect(_) | Action::Lot(..) | Action::Reading { .. } => None,
        });
        let items: Vec<&Vec<f64>> = scoped.chain(self.fixed.iter().filter_map(|own| own.rows.as_ref())).collect();
        let (mut masks, mut of_row) = (Vec::new(), Vec::with_capacity(self.durations.len()));
        for row in 0..self.durations.len() {
            let mask = items.iter().enumerate().map(|(bit, rows)| u128::from(rows[row] != 0.0) << bit).sum::<u128>();
            let index = masks.iter().position(|own| *own == mask).unwrap_or_else(|| {
                masks.push(mask);
                masks.len() - 1
            });
            of_row.push(index);
        }
        if masks.is_empty() {
            masks.push(0);
        }
        (self.masks, self.variant_of_row) = (masks, of_row);
    }

    /// How a scenario says a candidate.
    pub(super) fn written_effect(&self, candidate: usize) -> WrittenEffect {
        match &self.actions[candidate] {
            Action::Effect(effect) => WrittenEffect::from_effect(effect, &Scope::default()),
            Action::Scoped(effect, scope, _) => WrittenEffect::from_effect(effect, scope),
            Action::Lot(_, name, _) => WrittenEffect { scope: of_lot(name), ..WrittenEffect::default() },
            Action::Reading { scope, recorded, .. } => {
                WrittenEffect { scope: scope.clone(), recorded: *recorded, ..WrittenEffect::default() }
            }
        }
    }
}

/// The operations on one lot.
fn of_lot(name: &str) -> Scope {
    Scope { names: vec![("lot", vec![name.to_owned()])], ..Scope::default() }
}

/// Shape and scope for people.
fn words(effect: Effect, scope: &Scope) -> String {
    let default = effect.default_shape();
    let record = effect.parameters();
    let fields = record
        .fields()
        .iter()
        .enumerate()
        .filter(|(i, field)| field.name != "size" && record.value(*i) != default.parameters().value(*i));
    let shape = fields.map(|(i, field)| {
        let value = field.to_display(record.value(i).unwrap_or(f64::NAN));
        if field.display == "1" {
            format!("{} {value}", field.name)
        } else {
            format!("{} {value} {}", field.name, field.display)
        }
    });
    shape.chain((!scope.is_everywhere()).then(|| scope.words())).collect::<Vec<_>>().join(", ")
}
