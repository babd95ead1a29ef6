//! Co-simulation: a step, event by event.

use super::Instance;
use crate::component::{Interface, StepResult};
use crate::fault::{Fault, Outcome};
use crate::mode::Mode;
use crate::unit::Unit;
use toolroom_process::{Advance, ProcessEvent, Record};

/// Relative difference of communication points that is taken as rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// Most commands of the built-in policy in one step, so that they end within a second (assumption: each takes a few
/// microseconds).
const COMMANDS: f64 = 100_000.0;

/// Longest integration at once, s: 28 hours in cut. Whether the edge is worn out is looked at after each, so that a step
/// of years does not integrate a wear that nobody knows.
const LONGEST_PART: f64 = 1e5;

/// Most of these parts in one step (count), 63 years. Assumption: a part takes a few microseconds (10 000 of them took 0.03 s on a
/// shared server), so that a slow machine, too, ends such a step within a second.
const PARTS: f64 = 20_000.0;

/// Halvings by which the instant is found at which an edge is worn out: to the rounding of a step.
const HALVINGS: u32 = 52;

impl<U: Unit> Instance<U> {
    /// Takes a step. The input is held over it; the policy samples within it.
    ///
    /// An importer with Event Mode is handed each event as it happens, if it allows a step to end
    /// early; for every other the unit goes on by itself and tells of the event by its outputs.
    pub(super) fn advance(&mut self, time: f64, step: f64) -> Outcome<StepResult> {
        self.expect("DoStep", &[Mode::Step])?;
        if !(time.is_finite() && step > 0.0 && step.is_finite()) {
            return Err(Fault::Step { time, step }.into());
        }
        let current = self.core.time;
        if (time - current).abs() > ROUNDING * time.abs().max(current.abs()).max(step) {
            return Err(Fault::Time { given: time, own: current }.into());
        }
        let end = time + step;
        if let Some(stop) = self.stop.filter(|stop| end - stop > ROUNDING * stop.abs().max(step)) {
            return Err(Fault::End { end, stop }.into());
        }
        self.expect_short(step)?;
        let before = (self.core.state, self.core.discrete);
        let stepped = self.follow(time, step);
        if stepped.is_err() {
            // A refused step has not been taken.
            (self.core.state, self.core.discrete) = before;
            self.core.time = current;
            self.changed();
        }
        stepped
    }

    /// That a step is worked out within a second.
    fn expect_short(&self, step: f64) -> Outcome<()> {
        let (mut longest, mut reason) = self.core.model.process.longest_step(&self.core.input);
        let commands = COMMANDS * self.core.model.policy.sampling_period;
        if self.is_adaptive() && commands < longest {
            (longest, reason) = (commands, "the built-in policy commands a speed every adaptive.sampling_period");
        }
        if PARTS * LONGEST_PART < longest {
            (longest, reason) = (PARTS * LONGEST_PART, "it is worked out in parts of 100 000 s");
        }
        if step > longest { Err(Fault::LongStep { step, longest, reason }.into()) } else { Ok(()) }
    }

    /// Advances the process by `part` seconds, or up to the instant at which the edge is worn out; under the input as it was
    /// set, where nothing replaces that.
    fn part(&mut self, held: Option<&U::Input>, part: f64) -> Outcome<(Advance, bool)> {
        let before = self.core.state;
        let process = &self.core.model.process;
        let held = held.unwrap_or(&self.core.input);
        let advance = process.step(&mut self.core.state, held, part, &mut self.memory)?;
        if !process.worn_out(&self.core.state) || process.worn_out(&before) {
            return Ok((advance, false));
        }
        let (mut fit, mut spent) = (0.0, advance.elapsed);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (fit + spent);
            let mut state = before;
            process.advance(&mut state, held, middle)?;
            if process.worn_out(&state) { spent = middle } else { fit = middle }
        }
        let mut state = before;
        let advance = process.advance(&mut state, held, spent)?;
        self.core.state = state;
        self.memory = U::Memory::default();
        Ok((advance, advance.event.is_none()))
    }

    fn follow(&mut self, time: f64, step: f64) -> Outcome<StepResult> {
        let end = time + step;
        let stops_early = matches!(self.interface, Interface::CoSimulation { event_mode: true, early_return: true });
        self.core.time = time;
        self.settle_edges();
        let mut held = self.replaced_input();
        let mut event = false;
        let mut left = step;
        self.changed();
        while left > 0.0 {
            let due = if self.is_adaptive() { self.core.discrete.next_sample - self.core.time } else { f64::INFINITY };
            let part = left.min(due.max(0.0)).min(LONGEST_PART);
            let (advance, worn_out) = self.part(held.as_ref(), part)?;
            // What remains is counted down, so that the end of the step is met exactly.
            let whole = advance.event.is_none() && !worn_out && part == left;
            left = if whole { 0.0 } else { left - advance.elapsed };
            self.core.time = end - left;
            if left > 0.0 {
                let before = held.as_ref().unwrap_or(&self.core.input);
                held = Some(self.core.model.process.input_after(before, advance.elapsed));
            }
            if let Some(happened) = advance.event {
                let index = U::EVENTS.iter().position(|each| *each == happened);
                let new = index.is_some_and(|i| self.note(i));
                event |= new;
                if advance.elapsed == 0.0 && !new && self.core.discrete.lost {
                    // A lost edge that still stops the process: time passes, nothing else does.
                    left = 0.0;
                    self.core.time = end;
                } else if advance.elapsed == 0.0 {
                    self.lose(happened);
                }
                if new && stops_early && left > 0.0 {
                    return Ok(StepResult { time: self.core.time, event: true, early: true });
                }
            }
            if worn_out {
                self.lose(ProcessEvent::WearLimit);
            }
            if event || left > 0.0 {
                let ramp = self.core.input;
                self.settle();
                self.keep_ramp(held.get_or_insert(ramp), &ramp);
            }
        }
        self.core.time = end;
        Ok(StepResult { time: end, event: event && self.uses_event_mode(), early: false })
    }

    /// Edges of the renewal inputs, and the policy's command where it is due.
    fn settle_edges(&mut self) {
        let discrete = &self.core.discrete;
        if discrete.renewals != discrete.acted || self.is_adaptive() {
            self.settle();
        }
    }

    /// After a settlement within a step: loss of the edge and the policy replace parts of the
    /// held input, a ramp of the importer goes on.
    fn keep_ramp(&self, held: &mut U::Input, set: &U::Input) {
        let effective = self.effective_input();
        for i in 0..U::Input::LEN {
            if let (Some(value), Some(programmed)) = (effective.get(i), set.get(i))
                && value != programmed
            {
                held.set(i, value);
            }
        }
    }
}
