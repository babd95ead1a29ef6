//! A unit in the place of a process of the shop.

mod driven;
mod locate;
mod refused;

use crate::instance::{Action, Answer, Place, Port, StartValue, StepResult};
use crate::keeping::{Keeping, KeepingError, Maker, Reading, Turn};
use crate::notes::Notes;
use crate::parts::Parts;
use crate::unit::{Steps, Unit};
use crate::watch::Watch;
use crate::wire::{Wire, Wires, WiringError, events, inner, start_values};
use std::sync::Arc;
use toolroom_process::{Advance, Field, Kind, ModelError, ProcessEvent, Wiring};

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
    doc: "State of an imported unit, its wear and its events.",
};

/// Flank wear as it was read at the end of the last step: the shop asks for it far more often than the unit is stepped.
const SEEN_WEAR: Field = Field {
    name: "seen_flank_wear",
    unit: "m",
    display: "mm",
    doc: "Flank wear of an imported unit at the end of its last step.",
    ..UNIT_STATE
};

/// Flags of the events as they were read with it, and what a unit of fixed steps is behind.
const SEEN: Field = Field { name: "seen_flags", doc: "Flags of the events of an imported unit.", ..UNIT_STATE };

/// Mechanical energy that a unit may count; the shop reads it from the state.
const ENERGY: Field = Field { name: "energy", unit: "J", display: "J", doc: "Mechanical energy spent.", ..UNIT_STATE };

/// Where the state at the start of a step is saved while an event is located.
const START: Place = Place::MAX;

/// An imported unit that stands in for a native process.
///
/// Its state is what the unit writes with `fmi2SerializeFMUstate` or `fmi3SerializeFMUState`, as
/// numbers, or a state saved in memory, and events are located by going back and halving the step.
/// Without saved states it goes forward only ([`toolroom_process::MachineProcess::goes_back`]), and an event happens at the
/// end of its step. So it does in a unit that takes steps of one length only. Such a unit is never more than half a
/// step away from the clock of the shop: what a pass leaves over is carried to the next one.
///
/// What the unit says is not believed: every output is read before and after a step and compared with its
/// description, the range of the quantity that it feeds, and what came before.
#[derive(Debug)]
pub struct UnitProcess {
    name: &'static str,
    unit: Arc<Unit>,
    start_values: Vec<(Port, StartValue)>,
    inputs: Wires,
    outputs: Wires,
    watch: Watch,
    events: Vec<(ProcessEvent, Port)>,
    step: Option<f64>,
    /// The only step that the unit takes, s.
    grid: Option<f64>,
    keeping: Keeping,
    /// The unit's state, and the energy where the unit counts it.
    states: Vec<Field>,
    energy: Option<Wire>,
    /// State of a new edge: kept numbers, wear, flags of the events, and in a unit of fixed steps by how much the
    /// shop's clock is ahead of the unit's, s.
    fresh: Vec<f64>,
    /// Input elements of speed and its change in time.
    speed: usize,
    acceleration: Option<usize>,
    /// What is told of it.
    notes: Notes,
    /// Steps that it refused.
    refused: refused::Refused,
}

/// How far the unit came, by its own events.
struct Way {
    advance: Advance,
    /// Time at its end, s.
    time: f64,
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
        let grid = match unit.steps() {
            Steps::Any => None,
            Steps::Every(step) => Some(step),
            Steps::Unknown => Some(wiring.step.ok_or(WiringError::FixedStep)?),
        };
        let mut wires = Wires::from_model_description(description, inputs, "input", &wiring.inputs)?;
        let speed = wires.index("cutting_speed").ok_or(WiringError::NoSpeed)?;
        // A unit without ramps is given the speed in small parts.
        let acceleration = wires.index("cutting_acceleration").or_else(|| {
            let field = inputs.iter().find(|field| field.name == "cutting_acceleration")?;
            wires.fields.push(*field);
            wires.wires.push(None);
            Some(wires.fields.len() - 1)
        });
        let counted: Vec<Field> = outputs.iter().copied().chain([ENERGY]).collect();
        let mut outputs = Wires::from_model_description(description, &counted, "output", &wiring.outputs)?;
        let energy = outputs.take(ENERGY.name).or_else(|| inner(description, &ENERGY));
        let events = events(description, wiring)?;
        let start_values = start_values(description, wiring)?;
        let watch = Watch::of(description, &outputs);
        let flags = events.iter().map(|(_, port)| Action::Get(*port));
        let look: Vec<Action<'_>> = watch.wear().map(Action::Get).into_iter().chain(flags).collect();
        let maker = Maker { unit: &unit, start_values: &start_values };
        let (keeping, mut fresh, seen) = Keeping::from_maker(&maker, &look)?;
        let (wear, flags) = seen.split_at(usize::from(watch.wear().is_some()));
        fresh.push(wear.first().copied().map_or(0.0, |wear| watch.inward(wear)));
        fresh.extend(flags);
        fresh.extend(grid.map(|_| 0.0));
        let kept = keeping.length();
        let mut states = vec![Field { len: kept, ..UNIT_STATE }];
        // One place for the wear, whether the unit tells it or not.
        states.push(if watch.wear().is_some() { SEEN_WEAR } else { UNIT_STATE });
        states.extend((fresh.len() > kept + 1).then(|| Field { len: fresh.len() - kept - 1, ..SEEN }));
        states.extend(energy.map(|_| ENERGY));
        Ok(Self {
            name,
            unit,
            start_values,
            inputs: wires,
            outputs,
            watch,
            events,
            step: wiring.step,
            grid,
            keeping,
            states,
            energy,
            fresh,
            speed,
            acceleration,
            notes: Notes::default(),
            refused: refused::Refused::default(),
        })
    }

    fn maker(&self) -> Maker<'_> {
        Maker { unit: &self.unit, start_values: &self.start_values }
    }

    fn refusal(&self, error: &KeepingError) -> ModelError {
        ModelError::Unit { unit: self.unit.path().display().to_string(), reason: error.to_string() }
    }

    /// Sets every input to `u`.
    fn set(&self, u: &[f64], actions: &mut Vec<Action<'_>>) {
        let wired = self.inputs.wires.iter().zip(u).filter_map(|(wire, value)| wire.map(|wire| (wire, value)));
        actions.extend(wired.map(|(wire, value)| Action::Set(wire.port, wire.outward(*value))));
    }

    fn get_outputs(&self, actions: &mut Vec<Action<'_>>) {
        actions.extend(self.outputs.wires.iter().flatten().map(|wire| Action::Get(wire.port)));
    }

    /// What is read after a step: flags of the events, outputs, energy.
    fn get_after_step(&self, actions: &mut Vec<Action<'_>>) {
        actions.extend(self.events.iter().map(|(_, port)| Action::Get(*port)));
        self.get_outputs(actions);
        actions.extend(self.energy.map(|energy| Action::Get(energy.port)));
    }

    /// Longest communication step of `dt` seconds at this acceleration.
    fn longest_step(&self, acceleration: f64, dt: f64) -> f64 {
        let ramp = acceleration != 0.0 && self.acceleration.is_some_and(|i| self.inputs.wires[i].is_none());
        let default = if ramp { dt / RAMP_PARTS } else { dt };
        self.step.unwrap_or(default).min(dt)
    }

    /// Steps until `dt` seconds are over or an event is flagged; moves the speed. `seen` is wear and flags before.
    fn steps(
        &self,
        turn: &mut Turn<'_>,
        answer: &mut Answer,
        u: &mut [f64],
        dt: f64,
        seen: &mut [f64],
    ) -> Result<Way, KeepingError> {
        let time = turn.time;
        let acceleration = self.acceleration.map_or(0.0, |i| u[i]);
        let start_speed = u[self.speed];
        let parts = (dt / self.longest_step(acceleration, dt)).ceil().max(1.0);
        let native_ramp = self.acceleration.is_some_and(|i| self.inputs.wires[i].is_some());
        let before: Vec<bool> = seen[1..=self.events.len()].iter().map(|flag| *flag != 0.0).collect();
        // A lost edge cuts no more; flags that were up before a step would not rise in it.
        let lost = self.events.iter().zip(&before).find(|((event, _), up)| **up && event.ends_cut());
        let in_cut = self.inputs.fields.iter().position(|field| field.name == "engaged").is_none_or(|i| u[i] > 0.0);
        if let (true, Some(((event, _), _))) = (in_cut, lost) {
            turn.act(&[], true, answer)?;
            return Ok(Way { advance: Advance { elapsed: 0.0, event: Some(*event) }, time });
        }
        if let Some(grid) = self.grid {
            return self.grid_steps(turn, answer, u, dt, seen, grid);
        }
        let mut elapsed = 0.0;
        for part in 1..=parts as u64 {
            let end = if part as f64 == parts { dt } else { dt * (part as f64 / parts) };
            let middle = 0.5 * (elapsed + end);
            u[self.speed] = start_speed + acceleration * if native_ramp { elapsed } else { middle };
            let step = Step { from: time + elapsed, length: end - elapsed, before: &before, first: part == 1 };
            let (length, event) = self.step(turn, answer, u, &step, seen)?;
            elapsed = if event.is_some() { elapsed + length } else { end };
            if event.is_some() {
                u[self.speed] = start_speed + acceleration * elapsed;
                return Ok(Way { advance: Advance { elapsed, event }, time: time + elapsed });
            }
        }
        u[self.speed] = start_speed + acceleration * dt;
        Ok(Way { advance: Advance { elapsed: dt, event: None }, time: time + dt })
    }

    /// [`UnitProcess::steps`] of a unit that takes steps of `grid` seconds only.
    fn grid_steps(
        &self,
        turn: &mut Turn<'_>,
        answer: &mut Answer,
        u: &mut [f64],
        dt: f64,
        seen: &mut [f64],
        grid: f64,
    ) -> Result<Way, KeepingError> {
        let (acceleration, start_speed) = (self.acceleration.map_or(0.0, |i| u[i]), u[self.speed]);
        let (seen, ahead) = seen.split_at_mut(1 + self.events.len());
        let ahead = &mut ahead[0];
        let before: Vec<bool> = seen[1..].iter().map(|flag| *flag != 0.0).collect();
        let steps = ((*ahead + dt) / grid).round();
        let (mut time, mut elapsed, mut event) = (turn.time, 0.0, None);
        for number in 1..=steps as u64 {
            let middle = ((number as f64 - 0.5) * grid - *ahead).clamp(0.0, dt);
            u[self.speed] = start_speed + acceleration * middle;
            let step = Step { from: time, length: grid, before: &before, first: number == 1 };
            event = self.step(turn, answer, u, &step, seen)?.1;
            time += grid;
            if event.is_some() {
                elapsed = (number as f64 * grid - *ahead).clamp(0.0, dt);
                *ahead += elapsed - number as f64 * grid;
                break;
            }
        }
        if steps == 0.0 {
            turn.act(&[], true, answer)?; // the unit stays where it is
        }
        if event.is_none() {
            elapsed = dt;
            *ahead += dt - steps * grid;
        }
        self.notes.left_over(*ahead);
        u[self.speed] = start_speed + acceleration * elapsed;
        Ok(Way { advance: Advance { elapsed, event }, time })
    }

    /// Whether an event is located by taking its step again in parts.
    fn halves(&self) -> bool {
        self.keeping.goes_back() && self.grid.is_none()
    }

    /// Whether a step that the unit discarded can be taken again in parts: from the state before it, which a unit of FMI
    /// 3.0 is in after that.
    fn retakes(&self) -> bool {
        self.grid.is_none() && (self.keeping.goes_back() || self.unit.description().major == 3)
    }

    /// One communication step, up to the first event in it; how long it took.
    fn step(
        &self,
        turn: &mut Turn<'_>,
        answer: &mut Answer,
        u: &[f64],
        step: &Step<'_>,
        seen: &mut [f64],
    ) -> Result<(f64, Option<ProcessEvent>), KeepingError> {
        let mut parts = Parts::of(step.length);
        while parts.left() {
            let Parts { done, part, .. } = parts;
            let from = step.from + done;
            let try_from = Try { from, length: part, save: self.halves(), check: step.first && done == 0.0 };
            let (stepped, event) = self.attempt(turn, answer, u, &try_from, step.before, seen)?;
            match stepped {
                StepResult::Whole if event.is_some() && self.halves() => {
                    let (length, event) = self.locate(turn, answer, u, from, part, step.before, seen)?;
                    self.remember(turn, answer, u);
                    return Ok((done + length, event));
                }
                StepResult::Whole => {
                    parts.taken();
                    if event.is_some() {
                        return Ok((parts.done, event));
                    }
                }
                StepResult::Part(reached) if self.retakes() && parts.discarded(reached - from) => {
                    if self.halves() {
                        turn.act(&[Action::Restore(START)], false, answer)?;
                    }
                }
                StepResult::Part(reached) => {
                    let way = if self.retakes() { "" } else { ", and cannot go back for a shorter one" };
                    return Err(KeepingError::Impossible(format!(
                        "at {from} s it discarded a step of {part} s, came to {reached} s{way}"
                    )));
                }
                StepResult::Ended(end) => {
                    return Err(KeepingError::Impossible(format!(
                        "at {end} s it ended its simulation (terminateSimulation); a machine of a shop has no end"
                    )));
                }
            }
        }
        Ok((step.length, None))
    }

    /// Tries a step; the first event whose flag is up and was not `before`. Wear and flags go to `seen`.
    fn attempt(
        &self,
        turn: &mut Turn<'_>,
        answer: &mut Answer,
        u: &[f64],
        step: &Try,
        before: &[bool],
        seen: &mut [f64],
    ) -> Result<(StepResult, Option<ProcessEvent>), KeepingError> {
        let mut actions = Vec::new();
        actions.extend(step.save.then_some(Action::Save(START)));
        self.set(u, &mut actions);
        if step.check {
            self.get_outputs(&mut actions);
        }
        actions.push(Action::Step { time: step.from, duration: step.length });
        self.get_after_step(&mut actions);
        // At the end of a ramp the speed is another one: the shop will ask for the outputs there.
        let ramp = self.ramp_end(u, step.length);
        if let Some((wire, speed)) = ramp {
            actions.push(Action::Set(wire.port, wire.outward(speed)));
            self.get_outputs(&mut actions);
        }
        turn.act(&actions, true, answer)?;
        let whole = answer.stepped == StepResult::Whole;
        let at_end = match ramp.filter(|_| whole) {
            Some(_) => answer.values.split_off(answer.values.len() - self.watch.len()),
            None => Vec::new(),
        };
        let mut values = answer.values.as_slice();
        if step.check {
            let (outputs, rest) = values.split_at(self.watch.len());
            seen[0] = self.watch.check(outputs, step.from, seen[0])?;
            values = rest;
        }
        if !whole {
            return Ok((answer.stepped, None));
        }
        let (flags, values) = values.split_at(self.events.len());
        seen[0] = self.watch.check(&values[..self.watch.len()], step.from + step.length, seen[0])?;
        seen[1..].copy_from_slice(flags);
        match ramp {
            Some((_, speed)) => {
                // Outputs that cannot be are refused where they are asked for.
                let sound = self.watch.check(&at_end, step.from + step.length, f64::NEG_INFINITY).is_ok();
                let mut inputs = u.to_vec();
                inputs[self.speed] = speed;
                turn.reading = sound.then(|| Reading::of(&inputs, &at_end));
            }
            None => self.remember(turn, answer, u),
        }
        let rose =
            self.events.iter().zip(before.iter().zip(flags)).find(|(_, (before, now))| !**before && **now != 0.0);
        Ok((StepResult::Whole, rose.map(|((event, _), _)| *event)))
    }

    /// Wire and value of the speed at the end of a step of `length` seconds in which the unit itself ramps it.
    fn ramp_end(&self, u: &[f64], length: f64) -> Option<(Wire, f64)> {
        let i = self.acceleration.filter(|i| self.inputs.wires[*i].is_some() && u[*i] != 0.0)?;
        let wire = self.inputs.wires[self.speed].filter(|_| self.grid.is_none())?;
        Some((wire, u[self.speed] + u[i] * length))
    }

    /// Keeps the outputs at the end of a step, so that nobody has to ask for them under the same inputs again. `answer` holds
    /// them behind what was read before the step and the flags, and before the energy.
    fn remember(&self, turn: &mut Turn<'_>, answer: &Answer, u: &[f64]) {
        let end = answer.values.len() - usize::from(self.energy.is_some());
        turn.reading = Some(Reading::of(u, &answer.values[end - self.watch.len()..end]));
    }

    /// What comes of `actions` at the state `x`, by another instance where the first one fails: a worker that died since
    /// the last step leaves no gap in a log, which would have no place to tell of it.
    /// [`toolroom_process::MachineProcess::notes`] does.
    fn read_at(
        &self,
        x: &[f64],
        actions: &[Action<'_>],
        check: impl Fn(&Answer, f64) -> Result<(), KeepingError>,
    ) -> Result<Answer, KeepingError> {
        let once = || {
            let (mut state, mut answer) = (x[..self.keeping.length()].to_vec(), Answer::default());
            self.keeping.with(&self.maker(), &mut state, &mut answer, |turn, answer| {
                turn.act(actions, false, answer)?;
                check(answer, turn.time)?;
                Ok(((), None))
            })?;
            Ok(answer)
        };
        once().or_else(|first: KeepingError| {
            let answer = once()?;
            self.notes.read_again(&first);
            Ok(answer)
        })
    }
}

/// A communication step.
struct Step<'a> {
    /// Start, s.
    from: f64,
    /// Length, s.
    length: f64,
    /// Flags of the events before it.
    before: &'a [bool],
    /// Whether outputs are looked at before it, too.
    first: bool,
}

/// One try of a step or of a part of it.
struct Try {
    from: f64,
    length: f64,
    /// Saves the state before it.
    save: bool,
    /// Looks at the outputs before it, too.
    check: bool,
}
