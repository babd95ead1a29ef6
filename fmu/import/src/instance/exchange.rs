//! Units of Model Exchange, with a step of their own: the unit gives derivatives and indicators of events, and the
//! equations are integrated here.
//!
//! Between two calls the unit is in Event Mode, so that inputs of every variability may be set. A communication step
//! settles what was set, integrates up to its end, and settles again, so that what is read there is what holds after
//! the events of that instant. State events are located on the dense output of the integrator, time events are met,
//! and a step event is requested after each step of the integrator.

mod dormand_prince;

use super::{CallError, Calls, Place, Port, StepResult};
use dormand_prince::{Stages, first_step};
use std::collections::BTreeMap;
use std::ffi::CStr;

/// Relative accuracy of the integration (assumption: two digits below what units of Co-Simulation are compared at).
const TOLERANCE: f64 = 1e-8;

/// Steps of the integrator within one communication step above which the equations count as stiff (assumption: an
/// explicit method spends its time on stability then).
const MOST_STEPS: u32 = 200_000;

/// Events at one instant above which the unit counts as one that never settles (assumption; the Reference FMUs need 1).
const MOST_EVENTS: u32 = 1000;

/// Most continuous states and most event indicators (assumption: more take longer than anybody waits for; a unit may say any number).
const MOST_STATES: usize = 1 << 20;

/// Share of a step to which an event is located.
const EVENT_TIME: f64 = 1e-13;

/// What an update of the discrete states came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Update {
    /// Whether it has to be repeated.
    pub again: bool,
    /// Whether the unit ends the simulation.
    pub terminate: bool,
    /// Time of the next time event, s.
    pub next: Option<f64>,
}

/// The calls of Model Exchange that FMI 2.0 and 3.0 share.
pub(super) trait Equations: Calls {
    /// Numbers of continuous states and of event indicators.
    fn sizes(&mut self) -> Result<(usize, usize), CallError>;
    fn enter_event_mode(&mut self) -> Result<(), CallError>;
    fn enter_continuous_time_mode(&mut self) -> Result<(), CallError>;
    fn update(&mut self) -> Result<Update, CallError>;
    /// Time and continuous states.
    fn set_point(&mut self, time: f64, states: &[f64]) -> Result<(), CallError>;
    fn states(&mut self, states: &mut [f64]) -> Result<(), CallError>;
    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), CallError>;
    fn derivatives(&mut self, derivatives: &mut [f64]) -> Result<(), CallError>;
    fn indicators(&mut self, indicators: &mut [f64]) -> Result<(), CallError>;
    /// After a step of the integrator: whether there is a step event, and whether the unit ends the simulation.
    fn completed(&mut self) -> Result<(bool, bool), CallError>;
    /// An error of the driver, with what the unit said.
    fn stuck(&self, reason: String) -> CallError;
}

/// A unit of Model Exchange with the integrator that drives it.
#[derive(Debug)]
pub(super) struct Exchange<E> {
    unit: E,
    /// Time at which it was initialised, s.
    start: f64,
    /// Time of the next time event, s.
    next: Option<f64>,
    /// The same of saved states.
    saved: BTreeMap<Place, Option<f64>>,
    indicators: usize,
    states: Vec<f64>,
    /// Names of the derivatives, one for each state where none is an array.
    names: Vec<String>,
}

/// The first of some numbers that is not finite, with its index.
fn not_finite(numbers: &[f64]) -> Option<(usize, f64)> {
    numbers.iter().copied().enumerate().find(|(_, number)| !number.is_finite())
}

/// Why an integration stopped.
enum Stop {
    Event,
    Goal,
    Ended,
}

impl<E: Equations> Exchange<E> {
    /// A driver of `unit`, whose derivatives have these names.
    pub fn new(unit: E, names: &[String]) -> Self {
        let names = names.to_vec();
        Self { unit, start: 0.0, next: None, saved: BTreeMap::new(), indicators: 0, states: Vec::new(), names }
    }

    /// Settles the discrete states in Event Mode; true where the unit ends the simulation.
    fn settle(&mut self, time: f64) -> Result<bool, CallError> {
        for _ in 0..MOST_EVENTS {
            let update = self.unit.update()?;
            self.next = update.next;
            if update.terminate || !update.again {
                return Ok(update.terminate);
            }
        }
        Err(self.unit.stuck(format!("at {time} s no end of its events after {MOST_EVENTS} updates")))
    }

    /// Integrates from `time` to `goal` or the first event before it, and says where it is then.
    fn integrate(&mut self, time: &mut f64, goal: f64) -> Result<Stop, CallError> {
        let Self { unit, states: x, indicators, names, .. } = self;
        let count = x.len();
        let told = |time: f64, (i, value): (usize, f64)| {
            let number = format!("derivative {} of {count}", i + 1);
            let name = names.get(i).filter(|_| names.len() == count).unwrap_or(&number);
            format!("at {time} s {name} = {value}, which is no finite number")
        };
        let (mut before, mut after) = (vec![0.0; *indicators], vec![0.0; *indicators]);
        let mut stages = Stages::new(x.len());
        let mut nominals = vec![1.0; x.len()];
        if !x.is_empty() {
            unit.states(x)?;
            unit.nominals(&mut nominals)?;
            if let Some((i, value)) = not_finite(&nominals) {
                let wrong = format!(
                    "at {time} s the nominal value of state {} of {count} = {value}, which is no finite number",
                    i + 1
                );
                return Err(unit.stuck(wrong));
            }
            unit.derivatives(stages.first())?;
            if let Some(wrong) = not_finite(stages.first()) {
                return Err(unit.stuck(told(*time, wrong)));
            }
        }
        let tolerance: Vec<f64> = nominals.iter().map(|nominal| TOLERANCE * nominal.abs()).collect();
        unit.indicators(&mut before)?;
        if let Some((i, value)) = not_finite(&before) {
            let wrong = format!("at {time} s event indicator {} = {value}, which is no finite number", i + 1);
            return Err(unit.stuck(wrong));
        }
        let mut h = first_step(x, stages.first(), &tolerance, TOLERANCE, goal - *time);
        let least = f64::EPSILON * time.abs().max(goal - *time);
        let mut wrong = None;
        for _ in 0..MOST_STEPS {
            let last = x.is_empty() || *time + 1.01 * h >= goal;
            let length = if last { goal - *time } else { h };
            let from = *time;
            let slope = |share: f64, x: &[f64], k: &mut [f64]| {
                let time = from + share * length;
                match unit.set_point(time, x).and_then(|()| unit.derivatives(k)) {
                    Err(error) if error.status != "discard" => Err(error),
                    given => {
                        wrong = given.is_ok().then(|| not_finite(k)).flatten().map(|wrong| (time, wrong));
                        Ok(given.is_ok() && wrong.is_none())
                    }
                }
            };
            let error = stages.step(x, length, &tolerance, TOLERANCE, slope)?;
            if error.is_nan() || error > 1.0 {
                h = length * if error.is_nan() { 0.1 } else { (0.9 * error.powf(-0.2)).max(0.2) };
                if h <= least {
                    let why = wrong.map_or(String::new(), |(time, wrong)| format!(": {}", told(time, wrong)));
                    return Err(unit.stuck(format!("at {time} s its equations cannot be integrated any further{why}")));
                }
                continue;
            }
            let mut end = if last { goal } else { from + length };
            let crossed = |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (*a > 0.0) != (*b > 0.0));
            unit.set_point(end, stages.end())?;
            unit.indicators(&mut after)?;
            let mut event = crossed(&before, &after);
            if event {
                let (mut quiet, mut loud) = (0.0, 1.0);
                while loud - quiet > EVENT_TIME {
                    let middle = 0.5 * (quiet + loud);
                    unit.set_point(from + middle * length, stages.between(x, length, middle))?;
                    unit.indicators(&mut after)?;
                    if crossed(&before, &after) { loud = middle } else { quiet = middle }
                }
                if loud < 1.0 {
                    end = from + loud * length;
                    stages.between(x, length, loud);
                    x.copy_from_slice(stages.last_between());
                } else {
                    x.copy_from_slice(stages.end());
                }
                unit.set_point(end, x)?;
            } else {
                x.copy_from_slice(stages.end());
            }
            *time = end;
            let (step_event, terminate) = unit.completed()?;
            event |= step_event;
            if terminate {
                return Ok(Stop::Ended);
            }
            if event {
                return Ok(Stop::Event);
            }
            if end >= goal {
                return Ok(Stop::Goal);
            }
            stages.advance();
            std::mem::swap(&mut before, &mut after);
            h = length * (0.9 * error.max(1e-10).powf(-0.2)).clamp(0.2, 5.0);
        }
        let reason = format!(
            "at {time} s {MOST_STEPS} steps of the integrator since the last event: its equations are stiff, which an \
             explicit method does not solve"
        );
        Err(unit.stuck(reason))
    }
}

impl<E: Equations> Calls for Exchange<E> {
    fn enter_initialization(&mut self, start: f64) -> Result<(), CallError> {
        self.start = start;
        self.unit.enter_initialization(start)
    }

    fn exit_initialization(&mut self) -> Result<(), CallError> {
        self.unit.exit_initialization()?;
        let (states, indicators) = self.unit.sizes()?;
        if states.max(indicators) > MOST_STATES {
            let said = format!(
                "{states} states and {indicators} event indicators, at most {MOST_STATES} of each are integrated"
            );
            return Err(self.unit.stuck(said));
        }
        (self.states, self.indicators) = (vec![0.0; states], indicators);
        if self.settle(self.start)? {
            return Err(self.unit.stuck("an end of the simulation at its start".to_owned()));
        }
        Ok(())
    }

    fn step(&mut self, time: f64, duration: f64) -> Result<StepResult, CallError> {
        let (end, mut now) = (time + duration, time);
        let mut events = 0;
        if self.settle(now)? {
            return Ok(StepResult::Ended(now));
        }
        loop {
            self.unit.enter_continuous_time_mode()?;
            let goal = self.next.filter(|next| *next < end).unwrap_or(end);
            let before = now;
            let stop = if goal > now { self.integrate(&mut now, goal)? } else { Stop::Goal };
            self.unit.enter_event_mode()?;
            if matches!(stop, Stop::Ended) || self.settle(now)? {
                return Ok(StepResult::Ended(now));
            }
            if now >= end {
                return Ok(StepResult::Whole);
            }
            events = if now > before { 0 } else { events + 1 };
            if events > MOST_EVENTS {
                return Err(self.unit.stuck(format!("at {now} s {MOST_EVENTS} events at one instant")));
            }
        }
    }

    fn configure(&mut self, begin: bool) -> Result<(), CallError> {
        self.unit.configure(begin)
    }

    fn set(&mut self, port: Port, values: &[f64]) -> Result<(), CallError> {
        self.unit.set(port, values)
    }

    fn set_texts(&mut self, reference: u32, texts: &[&CStr]) -> Result<(), CallError> {
        self.unit.set_texts(reference, texts)
    }

    fn get(&mut self, port: Port, values: &mut Vec<f64>) -> Result<(), CallError> {
        self.unit.get(port, values)
    }

    fn get_text(&mut self, port: Port, texts: &mut Vec<String>) -> Result<(), CallError> {
        self.unit.get_text(port, texts)
    }

    fn save(&mut self, place: Place) -> Result<(), CallError> {
        self.saved.insert(place, self.next);
        self.unit.save(place)
    }

    fn restore(&mut self, place: Place) -> Result<(), CallError> {
        self.unit.restore(place)?;
        self.next = self.saved.get(&place).copied().flatten();
        Ok(())
    }

    fn forget(&mut self, place: Place) -> Result<(), CallError> {
        self.saved.remove(&place);
        self.unit.forget(place)
    }

    /// The bytes of the unit, and behind them the time of the next time event, which is not a number where there is
    /// none.
    fn serialize(&mut self, bytes: &mut Vec<u8>) -> Result<(), CallError> {
        self.unit.serialize(bytes)?;
        bytes.extend(self.next.unwrap_or(f64::NAN).to_le_bytes());
        Ok(())
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        let Some((head, next)) = bytes.split_last_chunk() else {
            return Err(self.unit.stuck("too few bytes of a saved state".to_owned()));
        };
        self.unit.deserialize(head)?;
        self.next = Some(f64::from_le_bytes(*next)).filter(|next| !next.is_nan());
        Ok(())
    }

    fn terminate(&mut self) -> Result<(), CallError> {
        self.unit.terminate()
    }

    fn alive(&self) -> bool {
        self.unit.alive()
    }
}
