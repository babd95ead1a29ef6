//! Tests of the units as they are described.

use crate::abi::breaking;
use crate::{Interface, Log, Status, TurningMachine, Unit, units};
use toolroom_cutting::{Turning, TurningInput, TurningOutput, TurningState};
use toolroom_effects::Effects;
use toolroom_process::{Advance, AnyRecord, ModelError, Process, ProcessEvent};

#[test]
fn both_model_descriptions_are_well_formed_and_name_each_variable_once() {
    for unit in units() {
        let description = unit.describe();
        for xml in [description.fmi2(), description.fmi3(), description.terminals()] {
            let document = roxmltree::Document::parse(&xml).expect("well-formed");
            let mut names: Vec<&str> = document.descendants().filter_map(|node| node.attribute("name")).collect();
            let variables: Vec<&str> = description.variables.iter().map(|each| each.name.as_str()).collect();
            names.retain(|name| variables.contains(name));
            let count = names.len();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), count, "{}", unit.name);
        }
    }
}

#[test]
fn a_reset_unit_is_a_new_one() {
    for unit in units() {
        let held = Interface::CoSimulation { event_mode: false, early_return: false };
        let mut used = unit.instantiate(held, None, Log::new(None, false));
        let run = |instance: &mut dyn crate::Component| {
            instance.enter_initialization().unwrap();
            instance.exit_initialization().unwrap();
            instance.do_step(0.0, 10.0).unwrap();
            let handle = instance.save(0).unwrap();
            instance.serialise(handle).unwrap()
        };
        let first = run(&mut *used);
        used.reset().unwrap();
        assert_eq!(run(&mut *used), first, "{}", unit.name);
    }
}

/// A process that panics where a step is longer than a minute.
#[derive(Clone, Default)]
struct Breaking(Turning);

impl Process for Breaking {
    type Input = TurningInput;
    type State = TurningState;
    type Output = TurningOutput;
    const NAME: &'static str = "breaking";
    const EVENTS: &'static [ProcessEvent] = <Turning as Process>::EVENTS;

    fn initial(&self) -> TurningState {
        self.0.initial()
    }
    fn output(&self, x: &TurningState, u: &TurningInput) -> TurningOutput {
        self.0.output(x, u)
    }
    fn advance(&self, x: &mut TurningState, u: &TurningInput, dt: f64) -> Result<Advance, ModelError> {
        let minute = [0.0; 60];
        assert!(minute.len() >= dt as usize, "a step of {dt} s");
        self.0.advance(x, u, dt)
    }
    fn event_indicators(&self, x: &TurningState, u: &TurningInput, indicators: &mut [f64]) {
        self.0.event_indicators(x, u, indicators);
    }
    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        self.0.parameters_mut()
    }
}

impl Unit for Breaking {
    type Machine = TurningMachine;
    type Memory = ();
    const IDENTIFIER: &'static str = "breaking";
    const TITLE: &'static str = "";
    const ABSTRACT: &'static str = "";
    const EQUATIONS: &'static [(&'static str, &'static str)] = &[];
    const VALIDITY: &'static [&'static str] = &[];
    const STATE_GROUP: &'static str = "tool";
    const SETS: &'static [(&'static str, &'static str)] = Turning::SETS;
    const RENEWALS: &'static [crate::Renewal<Self>] = &[];
    const CONTINUOUS: bool = false;
    const VIBRATES: bool = false;
    const ADAPTIVE: bool = false;
    const EXPERIMENT: (f64, f64) = (1.0, 1.0);

    fn read(text: &str) -> Result<Self, String> {
        Turning::read(text).map(Self)
    }
    fn effects_mut(&mut self) -> &mut Effects {
        self.0.effects_mut()
    }
}

#[test]
fn a_panic_is_a_fatal_status_and_the_host_lives() {
    for call in [breaking::step, breaking::step3] {
        let held = Interface::CoSimulation { event_mode: false, early_return: false };
        let log = Log::new(None, true);
        let unit = breaking::adopt(Box::new(crate::Instance::<Breaking>::new(held, None, log)));
        let step = |time: f64, step: f64| call(unit, time, step);
        assert_eq!(breaking::initialise(unit), Status::Ok);
        assert_eq!(step(0.0, 10.0), Status::Ok);
        assert_eq!(step(10.0, 100.0), Status::Fatal);
        assert_eq!(step(10.0, 1.0), Status::Fatal, "it has stopped for good");
        breaking::free(unit);
        assert_eq!(step(10.0, 1.0), Status::Error, "and is gone");
    }
}
