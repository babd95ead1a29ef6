//! One instance of a unit: parameters, state, inputs, events and where it is in its life.

mod access;
mod component;
mod continuous;
mod derivative;
mod life;
mod saved;
mod serial;
mod step;

pub(crate) use continuous::nominal_of;

use crate::component::Interface;
use crate::configured::Configured;
use crate::log::{Category, Log, Status};
use crate::mode::Mode;
use crate::unit::Unit;
use crate::variable::{Settable, Slot};
use saved::Saved;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::Arc;
use toolroom_process::{Field, Kind, Record};

/// Most events, and most renewals, of a process.
const MOST: usize = 8;

/// How far below zero an indicator still counts as reached: an integrator stops a hair before.
const REACHED: f64 = -1e-9;

/// What changes at events only.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Discrete {
    /// Renewal inputs as set.
    renewals: [bool; MOST],
    /// Renewal inputs as last acted upon.
    acted: [bool; MOST],
    /// Renewals so far, plus one.
    counts: [u32; MOST],
    /// Events since the last renewal.
    events: [bool; MOST],
    /// The edge cannot cut any more.
    lost: bool,
    /// Since when, s.
    lost_at: f64,
    /// Speed of the built-in policy, m/s.
    speed: f64,
    /// When it commands next, s.
    next_sample: f64,
}

impl Default for Discrete {
    fn default() -> Self {
        Self {
            renewals: [false; MOST],
            acted: [false; MOST],
            counts: [1; MOST],
            events: [false; MOST],
            lost: false,
            lost_at: 0.0,
            speed: 0.0,
            next_sample: 0.0,
        }
    }
}

/// Everything that a saved state holds.
#[derive(Clone)]
struct Core<U: Unit> {
    model: Arc<Configured<U>>,
    mode: Mode,
    time: f64,
    state: U::State,
    input: U::Input,
    discrete: Discrete,
}

impl<U: Unit> Core<U> {
    /// An instance as instantiation leaves it.
    fn fresh(model: Arc<Configured<U>>) -> Self {
        Self {
            state: model.process.initial(),
            model,
            mode: Mode::Instantiated,
            time: 0.0,
            input: U::Input::default(),
            discrete: Discrete::default(),
        }
    }
}

/// One instance of the unit `U`.
///
/// The process is immutable and shared with the saved states; what changes is a handful of
/// numbers. Instances know nothing of each other.
///
/// ```
/// use toolroom_cutting::Turning;
/// use toolroom_fmu::{Component, Instance, Interface, Log};
/// let held = Interface::CoSimulation { event_mode: false, early_return: false };
/// let mut unit = Instance::<Turning>::new(held, None, Log::new(None, false));
/// unit.enter_initialization().unwrap();
/// unit.exit_initialization().unwrap();
/// assert_eq!(unit.do_step(0.0, 0.1).unwrap().time, 0.1);
/// ```
pub struct Instance<U: Unit> {
    core: Core<U>,
    /// What the last step left for the next one.
    memory: U::Memory,
    interface: Interface,
    /// End of the simulation, s, where the importer has named one.
    stop: Option<f64>,
    log: Log,
    resources: Option<PathBuf>,
    /// Outputs at the present state and input, where they are worked out.
    outputs: Vec<f64>,
    outputs_valid: bool,
    /// Whether an output was read by itself since they were valid.
    glanced: bool,
    /// The state as numbers, where they are up to date.
    states: Vec<f64>,
    states_valid: bool,
    /// Discrete inputs that wait for an event.
    waiting: Vec<(Settable, f64)>,
    saved: Saved<U>,
    text: CString,
    /// Index of the input that says whether the edge is in cut.
    engaged: Option<usize>,
    /// Index of the input that the built-in policy replaces.
    speed: Option<usize>,
    /// First element of each state field.
    state_offsets: Vec<usize>,
    /// Name and field of every parameter.
    parameters: Arc<[(String, Field)]>,
    /// The parameters that the unit starts from.
    fresh: Arc<Configured<U>>,
}

impl<U: Unit> Instance<U> {
    /// An instance, not initialised. `resources` is the folder of the unit's resources.
    pub fn new(interface: Interface, resources: Option<PathBuf>, log: Log) -> Self {
        const { assert!(U::EVENTS.len() <= MOST && U::RENEWALS.len() <= MOST) };
        let fresh = Configured::shared();
        Self {
            core: Core::fresh(fresh.clone()),
            memory: U::Memory::default(),
            interface,
            stop: None,
            log,
            resources,
            outputs: vec![0.0; U::Output::LEN],
            outputs_valid: false,
            glanced: false,
            states: vec![0.0; U::State::LEN],
            states_valid: false,
            waiting: Vec::new(),
            saved: Saved::new(),
            text: CString::default(),
            engaged: U::Input::index_of("engaged"),
            speed: U::Input::index_of("cutting_speed"),
            state_offsets: offsets(U::State::FIELDS),
            parameters: Arc::clone(&fresh.fields),
            fresh,
        }
    }

    /// Whether the built-in policy commands the speed.
    fn is_adaptive(&self) -> bool {
        U::ADAPTIVE && self.core.model.policy.enable > 0.5
    }

    /// The input that the process meets: commanded by the policy, out of cut where the edge is
    /// lost.
    fn effective_input(&self) -> U::Input {
        self.replaced_input().unwrap_or(self.core.input)
    }

    /// The same where it is not the input as it was set.
    fn replaced_input(&self) -> Option<U::Input> {
        let lost = self.core.discrete.lost;
        (lost || self.is_adaptive()).then(|| {
            let mut input = self.commanded_input();
            if let Some(i) = self.engaged.filter(|_| lost) {
                input.set(i, 0.0);
            }
            input
        })
    }

    /// The input as commanded by the policy.
    fn commanded_input(&self) -> U::Input {
        let mut input = self.core.input;
        if let Some(i) = self.speed.filter(|_| self.is_adaptive()) {
            input.set(i, self.core.discrete.speed);
            if let Some(ramp) = U::Input::index_of("cutting_acceleration") {
                input.set(ramp, 0.0);
            }
        }
        input
    }

    /// Outputs at the present state and input. At the instant at which the edge is lost they are those of its last cut,
    /// as in the process itself.
    fn outputs(&mut self) -> &[f64] {
        if !self.outputs_valid {
            let Discrete { lost, lost_at, .. } = self.core.discrete;
            // An importer that looks for the instant ends its step a hair after it.
            let cuts = lost && self.core.time - lost_at <= step::ROUNDING * lost_at.abs().max(1.0);
            let replaced = if cuts { Some(self.commanded_input()) } else { self.replaced_input() };
            let input = replaced.as_ref().unwrap_or(&self.core.input);
            let output = self.core.model.process.observe(&self.core.state, input, &self.memory);
            output.write_to(&mut self.outputs);
            self.outputs_valid = true;
        }
        &self.outputs
    }

    /// One output by itself, where that costs less than all of them. A second one after the same step costs less with all.
    fn glance(&mut self, output: usize) -> Option<f64> {
        if self.outputs_valid || self.glanced || self.core.discrete.lost || self.is_adaptive() {
            return None;
        }
        self.glanced = true;
        let Core { model, state, input, .. } = &self.core;
        model.process.observe_one(output, state, input, &self.memory)
    }

    /// A real output that is worked out.
    #[inline]
    fn known_output(&self, reference: u32) -> Option<f64> {
        let output = reference.wrapping_sub(const { Slot::Output(0).reference() }) as usize;
        let is_real = U::Output::FIELDS.get(output).is_some_and(|field| field.kind == Kind::Real);
        if self.outputs_valid && is_real { self.outputs.get(output).copied() } else { None }
    }

    /// The elements of the state.
    fn states(&mut self) -> &[f64] {
        if !self.states_valid {
            self.core.state.write_to(&mut self.states);
            self.states_valid = true;
        }
        &self.states
    }

    /// What was worked out of state and input is no longer true.
    fn changed(&mut self) {
        self.input_changed();
        self.states_valid = false;
    }

    /// The same where the state is still what it was.
    fn input_changed(&mut self) {
        self.outputs_valid = false;
        self.glanced = false;
    }

    /// The same where the process itself may be another one.
    fn process_changed(&mut self) {
        self.memory = U::Memory::default();
        self.changed();
    }

    fn say(&self, category: Category, text: impl FnOnce() -> String) {
        if self.log.hears(category) {
            let status = if category == Category::Warning { Status::Warning } else { Status::Ok };
            self.log.say(status, category, &text());
        }
    }

    /// Whether the importer handles events of co-simulation itself.
    fn uses_event_mode(&self) -> bool {
        matches!(self.interface, Interface::CoSimulation { event_mode: true, .. })
    }
}

/// First element of each field.
fn offsets(fields: &[Field]) -> Vec<usize> {
    fields
        .iter()
        .scan(0, |at, field| {
            let first = *at;
            *at += field.len;
            Some(first)
        })
        .collect()
}
