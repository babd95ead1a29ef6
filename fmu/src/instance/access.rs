//! Reading and setting variables.

use super::Instance;
use super::continuous::expect_length;
use crate::configured::Configured;
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Status};
use crate::mode::Mode;
use crate::unit::Unit;
use crate::variable::{Settable, Slot, ValueType, can_be_lost, variables};
use std::ffi::{CStr, CString};
use std::sync::Arc;
use toolroom_process::{Field, Kind, Record};

/// What setting a variable does in the present mode.
#[derive(PartialEq)]
enum Set {
    /// Takes effect.
    Now,
    /// Waits for the next event.
    AtEvent,
    /// Is refused.
    Never,
}

impl<U: Unit> Instance<U> {
    /// Type and number of elements of a slot, `None` where the unit does not have it.
    fn shape(&self, slot: Slot) -> Option<(ValueType, usize)> {
        let record = |fields: &[Field], i: usize| fields.get(i).map(|field| (field.kind.into(), field.len));
        let numbered = |value_type, i: usize, count: usize| (i < count).then_some((value_type, 1));
        match slot {
            Slot::Time => Some((ValueType::Real, 1)),
            Slot::Input(i) => record(U::Input::FIELDS, i),
            Slot::State(i) => record(U::State::FIELDS, i),
            Slot::Derivative(i) => record(U::State::FIELDS, i).filter(|_| U::CONTINUOUS),
            Slot::Output(i) => record(U::Output::FIELDS, i),
            Slot::Parameter(i) => self.parameters.get(i).map(|(_, field)| (field.kind.into(), 1)),
            Slot::Indicator(i) => numbered(ValueType::Real, i, U::EVENTS.len()),
            Slot::Event(i) => numbered(ValueType::Boolean, i, U::EVENTS.len()),
            Slot::Renewal(i) => numbered(ValueType::Boolean, i, U::RENEWALS.len()),
            Slot::Count(i) => numbered(ValueType::Integer, i, U::RENEWALS.len()),
            Slot::Lost => can_be_lost::<U>().then_some((ValueType::Boolean, 1)),
            Slot::CommandedSpeed => U::ADAPTIVE.then_some((ValueType::Real, 1)),
            Slot::Set => Some((ValueType::String, 1)),
        }
    }

    /// Slot of a reference of the wanted type, with its number of elements.
    pub(super) fn find(&self, value_type: ValueType, reference: u32) -> Outcome<(Slot, usize)> {
        let slot = Slot::of(reference).ok_or(Fault::Reference { reference })?;
        match self.shape(slot) {
            Some((found, len)) if found == value_type => Ok((slot, len)),
            _ => Err(Fault::Reference { reference }.into()),
        }
    }

    /// A real output or scalar state, which is what importers read most.
    #[inline]
    fn real(&mut self, reference: u32) -> Option<f64> {
        let is_real = |fields: &[Field], i: usize| fields.get(i).is_some_and(|field| field.kind == Kind::Real);
        // A block of references is longer than every record.
        let output = reference.wrapping_sub(const { Slot::Output(0).reference() }) as usize;
        if is_real(U::Output::FIELDS, output) {
            return self.glance(output).or_else(|| self.outputs().get(output).copied());
        }
        let state = reference.wrapping_sub(const { Slot::State(0).reference() }) as usize;
        if U::State::LEN == U::State::FIELDS.len() && is_real(U::State::FIELDS, state) {
            return self.states().get(state).copied();
        }
        None
    }

    pub(super) fn read_values(&mut self, value_type: ValueType, references: &[u32], values: &mut [f64]) -> Outcome {
        // One real value is what importers ask for most.
        if let (ValueType::Real, [reference], [target]) = (value_type, references, &mut *values)
            && let Some(value) = self.real(*reference)
        {
            *target = value;
            return Ok(Status::Ok);
        }
        let (mut index, total) = (0, values.len());
        for &reference in references {
            if let (ValueType::Real, Some(value)) = (value_type, self.real(reference))
                && let Some(target) = values.get_mut(index)
            {
                *target = value;
                index += 1;
                continue;
            }
            let (slot, len) = self.find(value_type, reference)?;
            let target = values.get_mut(index..index + len);
            self.read_slot(slot, target.ok_or(Fault::Length { values: total, expected: index + len })?)?;
            index += len;
        }
        expect_length(total, index)?;
        Ok(Status::Ok)
    }

    fn read_slot(&mut self, slot: Slot, target: &mut [f64]) -> Outcome<()> {
        let core = &self.core;
        match slot {
            Slot::Output(i) => target[0] = self.outputs()[i],
            Slot::State(i) => {
                let first = self.state_offsets[i];
                target.copy_from_slice(&self.states()[first..first + target.len()]);
            }
            Slot::Derivative(i) => {
                let rates = self.rates()?;
                target[0] = rates.get(self.state_offsets[i]).unwrap_or(f64::NAN);
            }
            Slot::Indicator(i) => {
                let mut all = [0.0; super::MOST];
                self.read_indicators(&mut all[..U::EVENTS.len()])?;
                target[0] = all[i];
            }
            Slot::Time => target[0] = core.time,
            Slot::Input(i) => target[0] = core.input.get(i).unwrap_or(f64::NAN),
            Slot::Parameter(i) => target[0] = core.model.values[i],
            Slot::Event(i) => target[0] = f64::from(core.discrete.events[i]),
            Slot::Renewal(i) => target[0] = f64::from(core.discrete.renewals[i]),
            Slot::Count(i) => target[0] = f64::from(core.discrete.counts[i]),
            Slot::Lost => target[0] = f64::from(core.discrete.lost),
            Slot::CommandedSpeed => {
                let programmed = self.speed.and_then(|i| core.input.get(i)).unwrap_or(0.0);
                target[0] = if self.is_adaptive() { core.discrete.speed } else { programmed };
            }
            Slot::Set => return Err(Fault::Reference { reference: slot.reference() }.into()),
        }
        Ok(())
    }

    /// What setting `target` does now.
    fn setting(&self, target: Settable, discrete: bool) -> Set {
        let before = matches!(self.core.mode, Mode::Instantiated | Mode::Initialization);
        let running = matches!(self.core.mode, Mode::Event | Mode::Step);
        let continuous = self.core.mode == Mode::Continuous;
        let (now, at_event) = match target {
            Settable::State(_) => (before && U::CONTINUOUS, false),
            Settable::Parameter(_) => (before || running, false),
            Settable::Input(_) | Settable::Renewal(_) => {
                (before || running || continuous && !discrete, continuous && discrete)
            }
        };
        if now {
            Set::Now
        } else if at_event {
            Set::AtEvent
        } else {
            Set::Never
        }
    }

    fn name_of(&self, slot: Slot) -> String {
        variables::<U>().into_iter().find(|each| each.slot == slot).map_or_else(String::new, |each| each.name)
    }

    /// Whether `value` may stand in `slot`, which is `target`.
    fn check(&self, slot: Slot, target: Settable, value: f64) -> Outcome<()> {
        let range = match target {
            Settable::Input(i) => U::Input::FIELDS[i].check(value),
            Settable::State(i) => U::State::FIELDS[i].check(value),
            Settable::Parameter(i) => self.parameters[i].1.check(value),
            Settable::Renewal(_) => Ok(()),
        };
        range.map_err(|source| Fault::Value { variable: self.name_of(slot), source }.into())
    }

    pub(super) fn write_values(&mut self, value_type: ValueType, references: &[u32], values: &[f64]) -> Outcome {
        // One real input is what importers set most.
        if let (ValueType::Real, [reference], [value]) = (value_type, references, values)
            && let Some(Slot::Input(i)) = Slot::of(*reference)
            && let Some(field) = U::Input::FIELDS.get(i).filter(|field| field.kind == Kind::Real)
            && self.setting(Settable::Input(i), false) == Set::Now
        {
            if let Err(source) = field.check(*value) {
                return Err(Fault::Value { variable: self.name_of(Slot::Input(i)), source }.into());
            }
            self.core.input.set(i, *value);
            self.input_changed();
            return Ok(Status::Ok);
        }
        // First whether all can be set, then all of it.
        let mut index = 0;
        for &reference in references {
            let (slot, len) = self.find(value_type, reference)?;
            let given =
                values.get(index..index + len).ok_or(Fault::Length { values: values.len(), expected: index + len })?;
            let refused = || Fault::NotSettable { variable: self.name_of(slot), mode: self.core.mode };
            let target = slot.settable().ok_or_else(refused)?;
            let unchanged = || given.iter().enumerate().all(|(k, value)| self.present(target, k) == Some(*value));
            if self.setting(target, value_type != ValueType::Real) == Set::Never && !unchanged() {
                return Err(refused().into());
            }
            given.iter().try_for_each(|value| self.check(slot, target, *value))?;
            index += len;
        }
        expect_length(values.len(), index)?;
        let mut parameters = Vec::new();
        let mut status = Status::Ok;
        index = 0;
        for &reference in references {
            let (slot, len) = self.find(value_type, reference)?;
            let given = &values[index..index + len];
            index += len;
            let Some(target) = slot.settable() else { continue };
            match (target, self.setting(target, value_type != ValueType::Real)) {
                (_, Set::Never) => {}
                (Settable::Input(_) | Settable::Renewal(_), Set::AtEvent) => {
                    status = status.max(self.wait(slot, target, given[0]));
                }
                (Settable::Input(i), Set::Now) => {
                    self.core.input.set(i, given[0]);
                }
                (Settable::Renewal(i), Set::Now) => self.core.discrete.renewals[i] = given[0] > 0.5,
                (Settable::State(i), Set::Now | Set::AtEvent) => {
                    for (k, value) in given.iter().enumerate() {
                        self.core.state.set(self.state_offsets[i] + k, *value);
                    }
                }
                (Settable::Parameter(i), Set::Now | Set::AtEvent) => parameters.push((i, given[0])),
            }
        }
        if !parameters.is_empty() {
            self.process_changed();
            Arc::make_mut(&mut self.core.model).assign(&parameters)?;
        }
        self.changed();
        Ok(status)
    }

    /// Present value of an element of `target`.
    fn present(&self, target: Settable, element: usize) -> Option<f64> {
        match target {
            Settable::Input(i) => self.core.input.get(i),
            Settable::State(i) => self.core.state.get(self.state_offsets[i] + element),
            Settable::Parameter(i) => self.core.model.values.get(i).copied(),
            Settable::Renewal(i) => Some(f64::from(self.core.discrete.renewals[i])),
        }
    }

    /// A discrete input that is set between events: many importers do it. It waits.
    fn wait(&mut self, slot: Slot, target: Settable, value: f64) -> Status {
        let waits = self.waiting.iter().find(|(own, _)| *own == target).map(|(_, value)| *value);
        let present = self.present(target, 0);
        if waits.or(present) == Some(value) {
            return Status::Ok;
        }
        self.waiting.retain(|(own, _)| *own != target);
        if present == Some(value) {
            return Status::Ok;
        }
        self.waiting.push((target, value));
        let name = self.name_of(slot);
        self.say(Category::Warning, || format!("{name} was set in Continuous-Time Mode; it waits for the next event"));
        Status::Warning
    }

    pub(super) fn read_set(&mut self, reference: u32) -> Outcome<&CStr> {
        self.find(ValueType::String, reference)?;
        self.text = CString::new(self.core.model.set.as_str()).unwrap_or_default();
        Ok(&self.text)
    }

    pub(super) fn write_set(&mut self, reference: u32, text: &str) -> Outcome {
        let (slot, _) = self.find(ValueType::String, reference)?;
        if self.core.model.set == text {
            return Ok(Status::Ok);
        }
        if !matches!(self.core.mode, Mode::Instantiated | Mode::Initialization) {
            return Err(Fault::NotSettable { variable: self.name_of(slot), mode: self.core.mode }.into());
        }
        let mut model = Configured::clone(&self.core.model);
        model.choose_set(text, self.resources.as_deref())?;
        self.core.model = Arc::new(model);
        self.process_changed();
        Ok(Status::Ok)
    }
}
