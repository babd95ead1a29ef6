//! The state machine and the settling of events.

use super::{Core, Instance, REACHED};
use crate::component::{Interface, Update};
use crate::fault::{Fault, Outcome};
use crate::log::{Category, Status};
use crate::mode::Mode;
use crate::unit::Unit;
use crate::variable::Settable;
use toolroom_process::{ProcessEvent, Record};

impl<U: Unit> Instance<U> {
    /// That the unit is in one of `modes`.
    pub(super) fn expect(&self, call: &'static str, modes: &[Mode]) -> Outcome<()> {
        let mode = self.core.mode;
        if modes.contains(&mode) { Ok(()) } else { Err(Fault::Mode { call, mode }.into()) }
    }

    pub(super) fn experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Outcome {
        self.expect("SetupExperiment", &[Mode::Instantiated])?;
        if !start.is_finite() {
            return Err(Fault::Step { time: start, step: 0.0 }.into());
        }
        if let Some(stop) = stop.filter(|stop| stop.is_nan() || *stop < start) {
            return Err(Fault::Step { time: start, step: stop - start }.into());
        }
        if let Some(tolerance) = tolerance.filter(|tolerance| !(*tolerance > 0.0 && tolerance.is_finite())) {
            return Err(Fault::Tolerance { tolerance }.into());
        }
        self.core.time = start;
        self.stop = stop;
        Ok(Status::Ok)
    }

    pub(super) fn end_initialization(&mut self) -> Outcome {
        self.expect("ExitInitializationMode", &[Mode::Initialization])?;
        // An input that is true from the start is no edge.
        self.core.discrete.acted = self.core.discrete.renewals;
        self.core.discrete.next_sample = self.core.time;
        self.settle();
        self.core.mode = match self.interface {
            Interface::ModelExchange | Interface::CoSimulation { event_mode: true, .. } => Mode::Event,
            Interface::CoSimulation { event_mode: false, .. } => Mode::Step,
        };
        Ok(Status::Ok)
    }

    pub(super) fn begin_event(&mut self) -> Outcome {
        let from = if self.uses_event_mode() { Mode::Step } else { Mode::Continuous };
        self.expect("EnterEventMode", &[from])?;
        self.core.mode = Mode::Event;
        self.take_waiting();
        Ok(Status::Ok)
    }

    pub(super) fn update(&mut self) -> Outcome<Update> {
        self.expect("UpdateDiscreteStates", &[Mode::Event])?;
        let states_changed = self.settle();
        let next_event = (self.is_adaptive() && self.interface == Interface::ModelExchange)
            .then_some(self.core.discrete.next_sample);
        Ok(Update { states_changed, next_event })
    }

    pub(super) fn leave_event(&mut self, call: &'static str, mode: Mode) -> Outcome {
        let fits = (mode == Mode::Continuous) == (self.interface == Interface::ModelExchange);
        if !fits {
            return Err(Fault::Mode { call, mode: self.core.mode }.into());
        }
        self.expect(call, &[Mode::Event])?;
        self.core.mode = mode;
        Ok(Status::Ok)
    }

    /// Discrete inputs that were set outside events take effect.
    fn take_waiting(&mut self) {
        for (target, value) in std::mem::take(&mut self.waiting) {
            match target {
                Settable::Input(i) => {
                    self.core.input.set(i, value);
                }
                Settable::Renewal(i) => self.core.discrete.renewals[i] = value > 0.5,
                // Neither waits: they are set at once or refused.
                Settable::State(_) | Settable::Parameter(_) => {}
            }
        }
        self.changed();
    }

    /// Renewals, events, loss of the edge and the policy's command; true where the state has
    /// new values.
    pub(super) fn settle(&mut self) -> bool {
        let renewed = self.renew();
        self.notice_events();
        self.sample();
        renewed
    }

    fn renew(&mut self) -> bool {
        let mut renewed = false;
        for (i, renewal) in U::RENEWALS.iter().enumerate() {
            let discrete = &mut self.core.discrete;
            if discrete.renewals[i] && !discrete.acted[i] {
                self.core.state = (renewal.renew)(&self.core.model.process, &self.core.state);
                discrete.counts[i] += 1;
                discrete.events = Default::default();
                discrete.lost = false;
                // A new edge is cut with the speed for a new edge.
                discrete.next_sample = self.core.time;
                let (name, count, time) = (renewal.name, discrete.counts[i], self.core.time);
                self.say(Category::Events, || format!("{name} at {time} s: {} is {count}", renewal.count));
                renewed = true;
            }
        }
        self.core.discrete.acted = self.core.discrete.renewals;
        if renewed {
            self.changed();
        }
        renewed
    }

    /// Events whose indicator has been reached, and whether the edge survives them.
    fn notice_events(&mut self) {
        let mut indicators = [0.0; super::MOST];
        let indicators = &mut indicators[..U::EVENTS.len()];
        let input = self.effective_input();
        self.core.model.process.event_indicators(&self.core.state, &input, indicators);
        for (i, indicator) in indicators.iter().enumerate() {
            if *indicator >= REACHED {
                self.note(i);
            }
        }
        // A collapsed or chipped edge stops the process at once.
        let mut copy = self.core.state;
        if crate::variable::can_be_lost::<U>() && !self.core.discrete.lost {
            let advance = self.core.model.process.advance(&mut copy, &input, 0.0);
            if let Ok(Some(event)) = advance.map(|advance| advance.event) {
                self.lose(event);
            }
        }
    }

    /// Remembers event number `i`; true where it is new.
    pub(super) fn note(&mut self, i: usize) -> bool {
        let new = !std::mem::replace(&mut self.core.discrete.events[i], true);
        if new {
            let time = self.core.time;
            self.say(Category::Events, || format!("{} at {time} s", U::EVENTS[i].name()));
        }
        new
    }

    /// The edge cuts no more.
    pub(super) fn lose(&mut self, event: ProcessEvent) {
        self.core.discrete.lost = true;
        self.core.discrete.lost_at = self.core.time;
        self.changed();
        let time = self.core.time;
        self.say(Category::Events, || format!("the edge is lost to {} at {time} s", event.name()));
    }

    /// The policy's command, where it is due.
    fn sample(&mut self) {
        let (time, period) = (self.core.time, self.core.model.policy.sampling_period);
        if !self.is_adaptive() {
            let programmed = self.speed.and_then(|i| self.core.input.get(i));
            self.core.discrete.speed = programmed.unwrap_or(0.0);
            self.core.discrete.next_sample = time;
            return;
        }
        // A hair early is in time: the sum of many steps ends there.
        if time >= self.core.discrete.next_sample - 1e-9 * period {
            let model = &self.core.model;
            let speed = model.process.commanded_speed(&model.policy, &self.core.state, &self.core.input);
            self.core.discrete.speed = speed;
            self.core.discrete.next_sample = time + period;
            self.changed();
        }
    }

    pub(super) fn end(&mut self) -> Outcome {
        self.expect("Terminate", &[Mode::Event, Mode::Continuous, Mode::Step, Mode::Initialization])?;
        self.core.mode = Mode::Terminated;
        Ok(Status::Ok)
    }

    pub(super) fn begin_anew(&mut self) -> Outcome {
        self.core = Core::fresh(self.fresh.clone());
        self.stop = None;
        self.waiting.clear();
        self.process_changed();
        Ok(Status::Ok)
    }
}
