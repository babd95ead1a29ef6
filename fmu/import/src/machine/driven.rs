//! The unit as the shop drives it.

use super::{UnitProcess, refused};
use crate::instance::Answer;
use crate::keeping::{KeepingError, Turn};
use toolroom_process::{Advance, Field, MachineProcess, ModelError, ProcessEvent};

impl MachineProcess for UnitProcess {
    fn name(&self) -> &str {
        self.name
    }
    fn inputs(&self) -> &[Field] {
        &self.inputs.fields
    }
    fn states(&self) -> &[Field] {
        &self.states
    }
    fn outputs(&self) -> &[Field] {
        &self.outputs.fields
    }
    fn initial(&self) -> Vec<f64> {
        let mut x = self.fresh.clone();
        if let Some(saved) = self.keeping.begin(&self.maker()) {
            x[..saved.len()].copy_from_slice(&saved);
        }
        x.extend(self.energy.map(|_| 0.0));
        x
    }
    fn goes_back(&self) -> bool {
        self.keeping.goes_back()
    }
    fn fixed_step(&self) -> Option<f64> {
        self.grid
    }
    fn settle(&self, x: &[f64]) {
        self.keeping.settle(&x[..self.keeping.length()]);
    }
    fn retire(&self, x: &[f64]) {
        self.keeping.retire(&x[..self.keeping.length()]);
    }
    fn notes(&self) -> Vec<String> {
        self.notes.told(self.unit.path(), self.grid)
    }
    /// Outputs as the unit gives them after its inputs were set; not a number where it refuses or gives one that
    /// cannot be, which the next step from there refuses.
    fn output(&self, x: &[f64], u: &[f64], y: &mut [f64]) {
        let mut inward = |values: &[f64]| {
            let wires = self.outputs.wires.iter().flatten();
            y.iter_mut().zip(wires.zip(values)).for_each(|(y, (wire, value))| *y = wire.inward(*value));
        };
        if let Some(values) = self.keeping.read_before(&x[..self.keeping.length()], u) {
            return inward(&values);
        }
        let mut actions = Vec::new();
        self.set(u, &mut actions);
        self.get_outputs(&mut actions);
        let check = |answer: &Answer, time| self.watch.check(&answer.values, time, f64::NEG_INFINITY).map(|_| ());
        match self.read_at(x, &actions, check) {
            Ok(answer) => inward(&answer.values),
            Err(_) => y.fill(f64::NAN),
        }
    }
    /// By the flag of the unit as it was at the end of the step that led to `x`, under the inputs of that step; false where it
    /// has none for the event.
    fn holds(&self, event: ProcessEvent, x: &[f64], _u: &[f64]) -> bool {
        let flag = self.events.iter().position(|(each, _)| *each == event);
        flag.is_some_and(|flag| x[self.keeping.length() + 1 + flag] != 0.0)
    }
    fn advance(&self, x: &mut [f64], u: &mut [f64], dt: f64) -> Result<Advance, ModelError> {
        if !(dt.is_finite() && dt >= 0.0) {
            return Err(ModelError::Step { seconds: dt });
        }
        for ((field, wire), value) in self.inputs.fields.iter().zip(&self.inputs.wires).zip(&*u) {
            field.check(*value)?;
            if let Some((value, [min, max])) = wire.as_ref().and_then(|wire| wire.beyond(*value)) {
                let reason = format!("{} = {value} is outside {min} to {max} of its description", field.name);
                return Err(self.refusal(&KeepingError::Impossible(reason)));
            }
        }
        if dt == 0.0 {
            return Ok(Advance { elapsed: 0.0, event: None });
        }
        let mut input = u.to_vec();
        let (kept, rest) = x.split_at_mut(self.keeping.length());
        let (watched, counted) = rest.split_at_mut(1 + self.events.len() + usize::from(self.grid.is_some()));
        let step = |kept: &[f64], watched: &[f64]| refused::step(&self.keeping.moment(kept), watched, u, dt);
        if !self.refused.is_empty()
            && let Some(reason) = self.refused.tell(&step(kept, watched))
        {
            return Err(self.refusal(&KeepingError::Impossible(reason)));
        }
        let (mut state, mut seen, mut answer) = (kept.to_vec(), watched.to_vec(), Answer::default());
        let work = |turn: &mut Turn<'_>, answer: &mut Answer| {
            let way = self.steps(turn, answer, &mut input, dt, &mut seen)?;
            Ok((way.advance, Some(way.time)))
        };
        let advance = self.keeping.with(&self.maker(), &mut state, &mut answer, work).map_err(|error| {
            if matches!(error, KeepingError::Call(_)) {
                self.refused.keep(step(kept, watched), &error.to_string());
            }
            self.refusal(&error)
        })?;
        // The energy is what was read last.
        if let (Some(slot), Some(wire), Some(energy)) = (counted.first_mut(), self.energy, answer.values.last()) {
            *slot = wire.inward(*energy);
        }
        kept.copy_from_slice(&state);
        watched.copy_from_slice(&seen);
        u.copy_from_slice(&input);
        Ok(advance)
    }
}
