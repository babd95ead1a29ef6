//! Turning: one edge in one workpiece.

mod equations;
mod held;
mod life;
mod memory;
mod records;
mod vibration;

pub use held::HeldTurning;
pub use life::LifeModel;
pub use memory::TurningMemory;
pub use records::{Finish, TurningInput, TurningOutput, TurningState};

use crate::vibration::{Ends, HeldChatter, TurningStructure, first_switch};
use equations::Engagement;
use std::borrow::Cow;
use std::cell::Cell;
use std::f64::consts::PI;
use std::sync::Arc;
use toolroom_effects::Effects;
use toolroom_process::ode::{self, Tolerance};
use toolroom_process::{Advance, AnyRecord, ModelError, Number, Process, ProcessEvent, Record};
use toolroom_wear::{Pair, WEAR_EVENTS};

/// Turning with one tool–work pair.
///
/// # Examples
/// ```
/// use toolroom_cutting::{Turning, TurningInput};
/// use toolroom_process::{Process, ProcessEvent};
/// let turning = Turning::named("ni_vk6om").unwrap();
/// let mut edge = turning.initial();
/// let end = turning.advance(&mut edge, &TurningInput::default(), 3600.0).unwrap();
/// assert_eq!(end.event, Some(ProcessEvent::WearLimit)); // a cold start at 40 m/min
/// assert!((end.elapsed / 60.0 - 14.77972).abs() < 1e-4);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Turning<N: Copy = f64> {
    /// Heat, force, EMF, wear and limits of tool and work material.
    pub pair: Pair<N>,
    /// What decides size and finish.
    pub finish: Finish<N>,
    /// Effects that are switched on.
    pub effects: Effects<N>,
    /// What vibrates around the cut; without one every cut is stable and none is asked.
    pub structure: Option<Arc<TurningStructure>>,
}

impl Default for Turning {
    /// The default pair, no effects.
    fn default() -> Self {
        Self { pair: Pair::default(), finish: Finish::default(), effects: Effects::default(), structure: None }
    }
}

/// Relative accuracy of a step of [`Process::advance`]: whole lives come out within 1e-6.
const ACCURACY: f64 = 1e-7;

/// Share of the wear limit that one stage of an integration may wear at its initial rate.
const STAGE: f64 = 0.1;

/// Number of components of [`TurningState`].
const STATES: usize = <TurningState as Record>::LEN;

impl Turning {
    /// Turning with a shipped parameter set and no effects.
    ///
    /// # Errors
    /// [`toolroom_wear::SetError::Unknown`] with the nearest name.
    pub fn named(set: &str) -> Result<Self, toolroom_wear::SetError> {
        Ok(Self { pair: Pair::named(set)?, ..Self::default() })
    }

    /// Error of a state that counts as one, with `relative` accuracy: scales of this pair.
    fn scales(&self, relative: f64) -> [f64; STATES] {
        let body = self.pair.temperature.body_time_constant;
        let speed = self.pair.limits.reference_speed;
        let wear = self.pair.limits.wear_limit;
        let scales = TurningState {
            flank_wear: wear,
            tool_body_temperature_rise: self.pair.temperature.ambient_temperature,
            thermal_damage: 1.0,
            mechanical_wear: wear,
            thermal_wear: wear,
            cutting_path: speed * body,
            cutting_time: body,
            chipping_hazard: 1.0,
            energy: self.pair.force.specific_force * speed * body,
            // Whether a cut chatters changes at once; a share of it more or less is found soon enough.
            chatter_time: 1e4 * body,
        };
        let mut absolute = [0.0; STATES];
        scales.write_to(&mut absolute);
        absolute.map(|scale| relative * scale)
    }

    /// [`Process::advance_watched`] by the adaptive pair; what the effects refuse leaves the state as it was.
    fn integrate(
        &self,
        x: &mut TurningState,
        u: &TurningInput,
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &TurningInput, &TurningOutput),
    ) -> Result<Advance, ModelError> {
        let mut state = *x;
        let advance = self.effects.watched(|| self.integrate_unwatched(&mut state, u, None, dt, times, see))?;
        *x = state;
        Ok(advance)
    }

    /// The same without an eye on effects; `held` is the engagement of a cut that [keeps still](Self::keeps_still) and whose
    /// input was checked, where it is known.
    fn integrate_unwatched(
        &self,
        x: &mut TurningState,
        u: &TurningInput,
        held: Option<Engagement<'_>>,
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &TurningInput, &TurningOutput),
    ) -> Result<Advance, ModelError> {
        if held.is_none() {
            u.check()?;
            if !(dt >= 0.0 && dt.is_finite()) {
                return Err(ModelError::Step { seconds: dt });
            }
            TurningInput::FIELDS[0].check(u.cutting_speed + u.cutting_acceleration * dt)?;
        }
        if u.engaged == 0.0 && times.is_empty() && self.effects.is_empty() {
            *x = self.cooled(x, dt);
            return Ok(Advance { elapsed: dt, event: None });
        }
        let first = held.unwrap_or_else(|| self.engagement(x, u));
        if let Some(event) = lost_at_once(&first, x, u) {
            return Ok(Advance { elapsed: 0.0, event: Some(event) });
        }
        // What holds now and does not end the cut, which is a worn edge, is not met again.
        let passed = first.event_indicators(x, u.chipping_resistance).map(|value| value >= 0.0);
        if u.engaged == 0.0 {
            for (i, &time) in times.iter().enumerate() {
                let u = self.input_after(u, time);
                see(i, &u, &self.observe(&self.cooled(x, time), &u));
            }
            *x = self.cooled(x, dt);
            return Ok(Advance { elapsed: dt, event: None });
        }
        let mut course = Course { time: 0.0, state: [0.0; STATES], chatter: self.chatter(x, u), seen: 0 };
        x.write_to(&mut course.state);
        let (event, elapsed) = loop {
            if let Some(end) = self.follow(&mut course, passed, (u, held), dt, times, see)? {
                break end;
            }
        };
        *x = TurningState::from_slice(&course.state);
        Ok(Advance { elapsed, event })
    }

    /// The edge after `time` seconds out of cut: nothing happens but that the body cools, x' = -x/T.
    fn cooled(&self, x: &TurningState, time: f64) -> TurningState {
        let left = (-time / self.pair.temperature.body_time_constant).exp();
        TurningState { tool_body_temperature_rise: x.tool_body_temperature_rise * left, ..*x }
    }

    /// Moves a cut to the instant at which it becomes unstable or stable again or chatters in another way, or to the end of the
    /// step or an event: then it says which event, and when.
    fn follow(
        &self,
        course: &mut Course,
        passed: [bool; WEAR_EVENTS.len()],
        (u, known): (&TurningInput, Option<Engagement<'_>>),
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &TurningInput, &TurningOutput),
    ) -> Result<Option<(Option<ProcessEvent>, f64)>, ModelError> {
        let Course { time: start, chatter, .. } = *course;
        let x = TurningState::from_slice(&course.state);
        let first = known.unwrap_or_else(|| self.engagement_while(&x, &self.input_after(u, start), chatter.as_ref()));
        // Without effects and chatter the edge changes the contact by its land alone, a ramp by its speed.
        let settled = self.effects.is_empty() && chatter.is_none();
        let held = u.cutting_acceleration == 0.0;
        let engagement = |time: f64, x: &TurningState| match (settled, held) {
            (true, true) => Cow::Borrowed(&first),
            (true, false) => Cow::Owned(first.at_speed(&self.pair, u.cutting_speed + u.cutting_acceleration * time)),
            (false, _) => Cow::Owned(self.engagement_while(x, &self.input_after(u, time), chatter.as_ref())),
        };
        let rhs = |time: f64, y: &[f64; STATES]| {
            let x = TurningState::from_slice(y);
            let mut slope = [0.0; STATES];
            self.mean_rates(&engagement(start + time, &x), &x, u).write_to(&mut slope);
            slope
        };
        let switch: Cell<Option<(f64, [f64; STATES])>> = Cell::new(None);
        let events = |time: f64, y: &[f64; STATES]| {
            let x = TurningState::from_slice(y);
            let wear = engagement(start + time, &x).event_indicators(&x, u.chipping_resistance);
            let [worn, collapsed, chipped] = ode::unless_passed(passed, wear);
            // Behind a switch nothing is worth integrating.
            [worn, collapsed, chipped, if switch.get().is_some() { 1.0 } else { -1.0 }]
        };
        let stage =
            |slope: &[f64; STATES]| STAGE * self.pair.limits.wear_limit / TurningState::from_slice(slope).flank_wear;
        let mut seen = course.seen;
        let mut look = |until: f64, state_at: &dyn Fn(f64) -> [f64; STATES]| {
            while seen < times.len() && times[seen] <= until {
                let time = times[seen];
                let x = TurningState::from_slice(&state_at(time));
                let u = self.input_after(u, time);
                see(seen, &u, &self.observe_in(&engagement(time, &x), &x, &u));
                seen += 1;
            }
        };
        let tolerance = Tolerance { relative: ACCURACY, absolute: self.scales(ACCURACY) };
        let ends = if chatter.is_some() { Ends::UnstableCell } else { Ends::Verdict { unstable: false } };
        let watch = |step: &ode::Stretch<'_, STATES>| {
            if switch.get().is_some() {
                return;
            }
            let judge =
                |time| self.judge(&TurningState::from_slice(&step.at(time)), &self.input_after(u, start + time));
            let judged = self.structure.as_ref();
            let found = judged.and_then(|_| first_switch(step.start, step.end, ends, judge));
            look(start + found.unwrap_or(step.end), &|time| step.at(time - start));
            switch.set(found.map(|time| (time, step.at(time))));
        };
        let end = ode::integrate_staged(rhs, events, &course.state, dt - start, &tolerance, stage, watch)?;
        if let Some((time, state)) = switch.get() {
            let time = start + time;
            let chatter = self.chatter(&TurningState::from_slice(&state), &self.input_after(u, time));
            *course = Course { time, state, chatter, seen };
            return Ok(None);
        }
        let time = if end.event.is_none() { dt } else { start + end.time };
        look(time, &|_| end.state);
        course.state = end.state;
        Ok(Some((end.event.map(|index| WEAR_EVENTS[index]), time)))
    }
}

/// A cut on its way through a step.
struct Course {
    /// Time since the start of the step, s.
    time: f64,
    state: [f64; STATES],
    /// How the cut chatters from here on.
    chatter: Option<HeldChatter>,
    /// Instants that were looked at.
    seen: usize,
}

/// Place of the tool after a cutting path: it moves towards the jaws by the feed. A place that is not
/// given stays so.
fn position_after(u: &TurningInput, path: f64) -> f64 {
    if u.position <= 0.0 || u.engaged == 0.0 {
        return u.position;
    }
    let revolutions = path / (PI * u.workpiece_diameter);
    (u.position - revolutions * u.feed_per_rev).max(f64::MIN_POSITIVE)
}

/// The event that keeps an edge in this state from cutting at all. A worn edge may go on past
/// its wear limit; a collapsed or chipped one may not.
fn lost_at_once(engagement: &Engagement<'_>, x: &TurningState, u: &TurningInput) -> Option<ProcessEvent> {
    lost_at(&engagement.event_indicators(x, u.chipping_resistance), u)
}

/// The same by the event functions.
#[inline]
fn lost_at(indicators: &[f64; WEAR_EVENTS.len()], u: &TurningInput) -> Option<ProcessEvent> {
    WEAR_EVENTS
        .into_iter()
        .zip(indicators)
        .find(|(event, indicator)| u.engaged > 0.0 && event.ends_cut() && **indicator >= 0.0)
        .map(|(event, _)| event)
}

impl<N: Number> Turning<N> {
    /// The same process over another number type, for exact derivatives.
    pub fn map<M: Copy>(&self, mut convert: impl FnMut(N) -> M) -> Turning<M> {
        Turning {
            pair: self.pair.map(&mut convert),
            finish: self.finish.map(&mut convert),
            effects: self.effects.map(&mut convert),
            structure: self.structure.clone(),
        }
    }
}

impl Process for Turning {
    type Input = TurningInput;
    type State = TurningState;
    type Output = TurningOutput;

    const NAME: &'static str = "turning";
    const EVENTS: &'static [ProcessEvent] = &WEAR_EVENTS;

    fn initial(&self) -> TurningState {
        TurningState::default()
    }

    fn output(&self, x: &TurningState, u: &TurningInput) -> TurningOutput {
        self.observe(x, u)
    }

    fn advance(&self, x: &mut TurningState, u: &TurningInput, dt: f64) -> Result<Advance, ModelError> {
        self.step(x, u, dt, &mut TurningMemory::default())
    }

    fn advance_watched(
        &self,
        x: &mut TurningState,
        u: &TurningInput,
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &TurningInput, &TurningOutput),
    ) -> Result<Advance, ModelError> {
        if times.is_empty() {
            return self.advance(x, u, dt);
        }
        self.integrate(x, u, dt, times, see)
    }

    fn advance_to_output(
        &self,
        x: &mut TurningState,
        u: &TurningInput,
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &TurningInput, &TurningOutput),
    ) -> Result<(Advance, TurningOutput), ModelError> {
        let mut memory = TurningMemory::default();
        let advance =
            if times.is_empty() { self.step(x, u, dt, &mut memory) } else { self.integrate(x, u, dt, times, see) }?;
        Ok((advance, self.output_after(x, &self.input_after(u, advance.elapsed), &memory)))
    }

    fn input_after(&self, u: &TurningInput, elapsed: f64) -> TurningInput {
        let mean_speed = u.cutting_speed + 0.5 * u.cutting_acceleration * elapsed;
        TurningInput {
            cutting_speed: u.cutting_speed + u.cutting_acceleration * elapsed,
            position: position_after(u, mean_speed * elapsed),
            ..*u
        }
    }

    fn derivative(&self, x: &TurningState, u: &TurningInput) -> Option<TurningState> {
        Some(self.rates(x, u))
    }

    fn event_indicators(&self, x: &TurningState, u: &TurningInput, indicators: &mut [f64]) {
        indicators.copy_from_slice(&self.engagement(x, u).event_indicators(x, u.chipping_resistance));
    }

    fn holds(&self, event: ProcessEvent, x: &TurningState, u: &TurningInput) -> bool {
        match event {
            // The land alone says so, whatever the contact.
            ProcessEvent::WearLimit if self.effects.is_empty() => {
                x.flank_wear / self.pair.limits.wear_limit - 1.0 >= 0.0
            }
            ProcessEvent::WearLimit | ProcessEvent::ThermalCollapse | ProcessEvent::Chipping => {
                let indicators = self.engagement(x, u).event_indicators(x, u.chipping_resistance);
                WEAR_EVENTS.iter().zip(indicators).any(|(each, value)| *each == event && value >= 0.0)
            }
            ProcessEvent::Burn | ProcessEvent::DressingDue => false,
        }
    }

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        let mut groups = self.pair.parameters_mut();
        groups.push(("finish", &mut self.finish));
        groups.extend(self.effects.parameters_mut());
        if let Some(structure) = &mut self.structure {
            groups.push(("regeneration", &mut Arc::make_mut(structure).regeneration));
        }
        groups
    }
}
