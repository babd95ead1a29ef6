//! A unit in the place of a process of the shop.

use crate::instance::{CallError, Instance, Port, StartValue};
use crate::keeping::{Keeping, KeepingError, Maker};
use crate::unit::Unit;
use crate::wire::{Wire, Wires, WiringError, events, inner, start_values};
use std::sync::Arc;
use toolroom_process::{Advance, Field, Kind, MachineProcess, ModelError, ProcessEvent, Wiring};

/// Parts of a pass in which the speed is held where the unit knows no ramp and no step is given
/// (assumption).
const RAMP_PARTS: f64 = 16.0;

/// The state as the shop holds it.
const UNIT_STATE: Field = Field {
    name: "unit_state",
    unit: "1",
    display: "1",
    kind: Kind::Real,
    len: 1,
    start: 0.0,
    min: f64::MIN,
    max: f64::MAX,
    doc: "Time, size and bytes of the state of an imported unit.",
};

/// Mechanical energy that a unit may count; the shop reads it from the state.
const ENERGY: Field = Field { name: "energy", unit: "J", display: "J", doc: "Mechanical energy spent.", ..UNIT_STATE };

/// Share of a step to which an event is located (about the rounding of its time).
const EVENT_TIME: f64 = 1e-13;

/// An imported unit that stands in for a native process.
///
/// Its state is what the unit writes with `fmi2SerializeFMUstate` or `fmi3SerializeFMUState`, as
/// numbers, and events are located by going back and halving the step. Without that it goes
/// forward only ([`MachineProcess::goes_back`]), and an event happens at the end of its step.
#[derive(Debug)]
pub struct UnitProcess {
    name: &'static str,
    unit: Arc<Unit>,
    start_values: Vec<(Port, StartValue)>,
    inputs: Wires,
    outputs: Wires,
    events: Vec<(ProcessEvent, Port)>,
    step: Option<f64>,
    keeping: Keeping,
    /// The unit's state, and the energy where the unit counts it.
    states: Vec<Field>,
    energy: Option<Wire>,
    fresh: Vec<f64>,
    /// Input elements of speed and its change in time.
    speed: usize,
    acceleration: Option<usize>,
}

impl UnitProcess {
    /// Wires `unit` in place of the process `name` with these inputs and outputs. One instance is
    /// made and initialised, so that a unit that cannot even do that is refused here.
    ///
    /// # Errors
    /// [`WiringError`].
    pub fn new(
        unit: Arc<Unit>,
        name: &'static str,
        inputs: &[Field],
        outputs: &[Field],
        wiring: &Wiring,
    ) -> Result<Self, WiringError> {
        let description = unit.description();
        if !unit.interface().can("canHandleVariableCommunicationStepSize") {
            return Err(WiringError::FixedStep);
        }
        let mut wires = Wires::of(description, inputs, "input", &wiring.inputs)?;
        let speed = wires.index("cutting_speed").ok_or(WiringError::NoSpeed)?;
        // A unit without ramps is given the speed in small parts.
        let acceleration = wires.index("cutting_acceleration").or_else(|| {
            let field = inputs.iter().find(|field| field.name == "cutting_acceleration")?;
            wires.fields.push(*field);
            wires.wires.push(None);
            Some(wires.fields.len() - 1)
        });
        let counted: Vec<Field> = outputs.iter().copied().chain([ENERGY]).collect();
        let mut outputs = Wires::of(description, &counted, "output", &wiring.outputs)?;
        let energy = outputs.take(ENERGY.name).or_else(|| inner(description, &ENERGY));
        let events = events(description, wiring)?;
        let start_values = start_values(description, wiring)?;
        let (keeping, fresh) = Keeping::of(&Maker { unit: &unit, start_values: &start_values })?;
        let mut states = vec![Field { len: keeping.length(), ..UNIT_STATE }];
        states.extend(energy.map(|_| ENERGY));
        Ok(Self {
            name,
            unit,
            start_values,
            inputs: wires,
            outputs,
            events,
            step: wiring.step,
            keeping,
            states,
            energy,
            fresh,
            speed,
            acceleration,
        })
    }

    fn maker(&self) -> Maker<'_> {
        Maker { unit: &self.unit, start_values: &self.start_values }
    }

    fn refusal(&self, error: &KeepingError) -> ModelError {
        ModelError::Unit { unit: self.unit.path().display().to_string(), reason: error.to_string() }
    }

    fn set_inputs(&self, instance: &mut Instance, u: &[f64]) -> Result<(), CallError> {
        for (wire, value) in self.inputs.wires.iter().zip(u) {
            if let Some(wire) = wire {
                instance.set(wire.port, wire.outward(*value))?;
            }
        }
        Ok(())
    }

    fn flags(&self, instance: &mut Instance) -> Result<Vec<bool>, CallError> {
        self.events.iter().map(|(_, port)| Ok(instance.get(*port)? != 0.0)).collect()
    }

    /// Longest communication step of `dt` seconds at this acceleration.
    fn longest_step(&self, acceleration: f64, dt: f64) -> f64 {
        let ramp = acceleration != 0.0 && self.acceleration.is_some_and(|i| self.inputs.wires[i].is_none());
        let default = if ramp { dt / RAMP_PARTS } else { dt };
        self.step.unwrap_or(default).min(dt)
    }

    /// Steps from `time` until `dt` seconds are over or an event is flagged; moves the speed.
    fn steps(
        &self,
        instance: &mut Instance,
        time: f64,
        u: &mut [f64],
        dt: f64,
    ) -> Result<(Advance, Option<f64>), CallError> {
        let acceleration = self.acceleration.map_or(0.0, |i| u[i]);
        let start_speed = u[self.speed];
        let parts = (dt / self.longest_step(acceleration, dt)).ceil().max(1.0);
        let native_ramp = self.acceleration.is_some_and(|i| self.inputs.wires[i].is_some());
        let before = self.flags(instance)?;
        // A lost edge cuts no more; flags that were up before a step would not rise in it.
        let lost = self.events.iter().zip(&before).find(|((event, _), up)| **up && event.ends_cut());
        let in_cut = self.inputs.fields.iter().position(|field| field.name == "engaged").is_none_or(|i| u[i] > 0.0);
        if let (true, Some(((event, _), _))) = (in_cut, lost) {
            return Ok((Advance { elapsed: 0.0, event: Some(*event) }, Some(time)));
        }
        let locates = self.goes_back() && !self.events.is_empty();
        let mut saved = Vec::new();
        let mut elapsed = 0.0;
        for part in 1..=parts as u64 {
            let end = if part as f64 == parts { dt } else { dt * (part as f64 / parts) };
            let middle = 0.5 * (elapsed + end);
            u[self.speed] = start_speed + acceleration * if native_ramp { elapsed } else { middle };
            if locates {
                instance.serialize(&mut saved)?;
            }
            let (from, mut step) = (time + elapsed, end - elapsed);
            let mut event = self.step(instance, u, from, step, &before)?;
            if event.is_some() && locates {
                (step, event) = self.locate(instance, u, from, step, &before, &saved)?;
            }
            elapsed = if event.is_some() { elapsed + step } else { end };
            if event.is_some() {
                u[self.speed] = start_speed + acceleration * elapsed;
                return Ok((Advance { elapsed, event }, Some(time + elapsed)));
            }
        }
        u[self.speed] = start_speed + acceleration * dt;
        Ok((Advance { elapsed: dt, event: None }, Some(time + dt)))
    }

    /// One communication step; the first event whose flag is up and was not `before`.
    fn step(
        &self,
        instance: &mut Instance,
        u: &[f64],
        from: f64,
        step: f64,
        before: &[bool],
    ) -> Result<Option<ProcessEvent>, CallError> {
        self.set_inputs(instance, u)?;
        instance.step(from, step)?;
        let now = self.flags(instance)?;
        let rose = self.events.iter().zip(before.iter().zip(now)).find(|(_, (before, now))| !**before && *now);
        Ok(rose.map(|((event, _), _)| *event))
    }

    /// Finds the earliest event of a step by halving it, from the state `saved` at its start; the
    /// instance is left at the event.
    fn locate(
        &self,
        instance: &mut Instance,
        u: &[f64],
        from: f64,
        step: f64,
        before: &[bool],
        saved: &[u8],
    ) -> Result<(f64, Option<ProcessEvent>), CallError> {
        let (mut quiet, mut loud) = (0.0, step);
        while loud - quiet > EVENT_TIME * step {
            let middle = 0.5 * (quiet + loud);
            instance.deserialize(saved)?;
            let event = self.step(instance, u, from, middle, before)?;
            if event.is_some() { loud = middle } else { quiet = middle }
        }
        instance.deserialize(saved)?;
        Ok((loud, self.step(instance, u, from, loud, before)?))
    }
}

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
        let mut x = self.keeping.begin(&self.maker()).unwrap_or_else(|| self.fresh.clone());
        x.extend(self.energy.map(|_| 0.0));
        x
    }
    fn goes_back(&self) -> bool {
        self.keeping.goes_back()
    }
    /// Outputs as the unit gives them after its inputs were set; not a number where it refuses.
    fn output(&self, x: &[f64], u: &[f64], y: &mut [f64]) {
        let mut state = x[..self.keeping.length()].to_vec();
        let values = self.keeping.with(&self.maker(), &mut state, |instance, _| {
            self.set_inputs(instance, u)?;
            let wires = self.outputs.wires.iter().flatten();
            let values: Result<Vec<f64>, CallError> =
                wires.map(|wire| Ok(wire.inward(instance.get(wire.port)?))).collect();
            Ok((values?, None))
        });
        match values {
            Ok(values) => y.copy_from_slice(&values),
            Err(_) => y.fill(f64::NAN),
        }
    }
    /// By the flag of the unit; false where it has none for the event or refuses.
    fn holds(&self, event: ProcessEvent, x: &[f64], u: &[f64]) -> bool {
        let Some(flag) = self.events.iter().position(|(each, _)| *each == event) else { return false };
        let mut state = x[..self.keeping.length()].to_vec();
        let flags = self.keeping.with(&self.maker(), &mut state, |instance, _| {
            self.set_inputs(instance, u)?;
            Ok((self.flags(instance)?, None))
        });
        flags.is_ok_and(|flags| flags[flag])
    }
    fn advance(&self, x: &mut [f64], u: &mut [f64], dt: f64) -> Result<Advance, ModelError> {
        if !(dt.is_finite() && dt >= 0.0) {
            return Err(ModelError::Step { seconds: dt });
        }
        for (field, value) in self.inputs.fields.iter().zip(&*u) {
            field.check(*value)?;
        }
        if dt == 0.0 {
            return Ok(Advance { elapsed: 0.0, event: None });
        }
        let mut input = u.to_vec();
        let (state, counted) = x.split_at_mut(self.keeping.length());
        let work = |instance: &mut Instance, time| {
            let (advance, end) = self.steps(instance, time, &mut input, dt)?;
            let energy = self.energy.map(|wire| Ok(wire.inward(instance.get(wire.port)?))).transpose()?;
            Ok(((advance, energy), end))
        };
        let (advance, energy) = self.keeping.with(&self.maker(), state, work).map_err(|error| self.refusal(&error))?;
        if let (Some(slot), Some(energy)) = (counted.first_mut(), energy) {
            *slot = energy;
        }
        u.copy_from_slice(&input);
        Ok(advance)
    }
}
