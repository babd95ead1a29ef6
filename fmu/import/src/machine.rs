//! A unit in the place of a process of the shop.

use crate::instance::{CallError, Instance, Port, StartValue};
use crate::keeping::{Keeping, KeepingError, Maker};
use crate::unit::Unit;
use crate::wire::{Wires, WiringError, events, start_values};
use std::sync::Arc;
use toolroom_process::{Advance, Field, Kind, MachineProcess, ModelError, ProcessEvent, Wiring};

/// Parts of a pass in which the speed is held where the unit knows no ramp and no step is given
/// (assumption).
const RAMP_PARTS: f64 = 16.0;

/// An imported unit that stands in for a native process.
///
/// Its state is what the unit writes with `fmi2SerializeFMUstate` or `fmi3SerializeFMUState`, as
/// numbers. Without that it goes forward only ([`MachineProcess::goes_back`]).
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
    states: [Field; 1],
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
        let outputs = Wires::of(description, outputs, "output", &wiring.outputs)?;
        let events = events(description, wiring)?;
        let start_values = start_values(description, wiring)?;
        let (keeping, fresh) = Keeping::of(&Maker { unit: &unit, start_values: &start_values })?;
        let states = [Field {
            name: "unit_state",
            unit: "1",
            display: "1",
            kind: Kind::Real,
            len: keeping.length(),
            start: 0.0,
            min: f64::MIN,
            max: f64::MAX,
            doc: "Time, size and bytes of the state of an imported unit.",
        }];
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
        let mut elapsed = 0.0;
        for part in 1..=parts as u64 {
            let end = if part as f64 == parts { dt } else { dt * (part as f64 / parts) };
            let middle = 0.5 * (elapsed + end);
            u[self.speed] = start_speed + acceleration * if native_ramp { elapsed } else { middle };
            self.set_inputs(instance, u)?;
            instance.step(time + elapsed, end - elapsed)?;
            elapsed = end;
            let now = self.flags(instance)?;
            let rose = self.events.iter().zip(before.iter().zip(&now)).find(|(_, (before, now))| !**before && **now);
            if let Some(((event, _), _)) = rose {
                u[self.speed] = start_speed + acceleration * elapsed;
                return Ok((Advance { elapsed, event: Some(*event) }, Some(time + elapsed)));
            }
        }
        u[self.speed] = start_speed + acceleration * dt;
        Ok((Advance { elapsed: dt, event: None }, Some(time + dt)))
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
        self.keeping.begin(&self.maker()).unwrap_or_else(|| self.fresh.clone())
    }
    fn goes_back(&self) -> bool {
        self.keeping.goes_back()
    }
    /// Outputs as the unit gives them after its inputs were set; not a number where it refuses.
    fn output(&self, x: &[f64], u: &[f64], y: &mut [f64]) {
        let mut state = x.to_vec();
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
        let advance = self
            .keeping
            .with(&self.maker(), x, |instance, time| self.steps(instance, time, &mut input, dt))
            .map_err(|error| self.refusal(&error))?;
        u.copy_from_slice(&input);
        Ok(advance)
    }
}
