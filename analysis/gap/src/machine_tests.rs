//! What machines record beside a process that runs on them.

use super::shop_tests::{of_shop, shipped_shop};
use crate::{Diagnosis, EffectId, GapVerdict, Settings, ShiftLabels, add_machine_facts};
use toolroom_facts::{Fact, Quantity};
use toolroom_recording::simulated;
use toolroom_records::RecordKind;
use toolroom_scenario::{Deviation, Distribution, Scenario, Scope, ShopEffect};

/// Three days of the shipped shop, `changed` in what its planner does not know, and what they say of its constants.
fn told(seed: u64, changed: &dyn Fn(&mut Scenario)) -> Diagnosis {
    let short = |scenario: &mut Scenario| {
        scenario.horizon = 72.0 * 3600.0;
        changed(scenario);
    };
    let events = of_shop(seed, &short);
    let mut diagnosis = Diagnosis { verdict: GapVerdict::NoGap, ..Diagnosis::cannot_tell(String::new()) };
    add_machine_facts(&shipped_shop(), &events, &ShiftLabels::default(), None, &mut diagnosis, 1);
    diagnosis
}

fn found(diagnosis: &Diagnosis) -> Vec<&Fact> {
    diagnosis.findings.iter().map(|own| &diagnosis.facts[own.fact]).collect()
}

fn delayed(effect: ShopEffect, size: f64, scope: &[(&'static str, &str)]) -> impl Fn(&mut Scenario) {
    let names = scope.iter().map(|(key, name)| (*key, vec![(*name).to_owned()])).collect();
    let deviation = Deviation { scope: Scope { names, ..Scope::default() }, ..Deviation::new(effect, size) };
    move |scenario| scenario.deviations = vec![deviation.clone()]
}

#[test]
fn a_shop_that_is_as_its_file_says_contradicts_no_time_of_it() {
    for seed in 41..51 {
        let diagnosis = told(seed, &|_| {});
        let asked = |quantity| diagnosis.facts.iter().any(|fact| fact.quantity == quantity);
        assert!(asked(Quantity::HandlingTime) && asked(Quantity::ToolChangeTime), "{seed}: {:?}", diagnosis.facts);
        assert!(diagnosis.findings.is_empty(), "{seed}: {}", diagnosis.terminal());
        assert_eq!(diagnosis.verdict, GapVerdict::NoGap, "{seed}: {}", diagnosis.terminal());
    }
}

#[test]
fn changes_that_take_longer_on_one_machine_are_a_constant_of_it_or_a_delay() {
    for scope in [vec![("machine", "L1")], Vec::new()] {
        let diagnosis = told(52, &delayed(ShopEffect::ToolChangeDelay, 120.0, &scope));
        assert_eq!(diagnosis.verdict, GapVerdict::Constant, "{}", diagnosis.terminal());
        let facts = found(&diagnosis);
        let places: Vec<&str> = facts.iter().map(|fact| fact.place.as_str()).collect();
        assert_eq!(places, [if scope.is_empty() { "L1, L2, M1, M2" } else { "L1" }], "{}", diagnosis.terminal());
        assert_eq!(facts[0].quantity, Quantity::ToolChangeTime);
        assert!((facts[0].factor() - 210.0 / 90.0).abs() < 0.1, "{:?}", facts[0]);
        let delay = facts[0].told.delay.as_ref().expect("one class with a delay");
        // A change that a breakdown or a night interrupts is in pieces in the log.
        assert!(
            !delay.told && delay.effect == "tool_change_delay" && (110.0..121.0).contains(&delay.size),
            "{delay:?}"
        );
        assert!(facts[0].words().contains("do not distinguish it from tool_change_delay of 1"), "{}", facts[0].words());
    }
}

#[test]
fn a_delay_of_operators_is_told_from_a_constant_by_the_scatter_that_it_leaves() {
    let delay = told(53, &delayed(ShopEffect::OperatorDelay, 25.0, &[]));
    let [fact] = found(&delay)[..] else { panic!("{}", delay.terminal()) };
    let named = fact.told.delay.as_ref().expect("a delay");
    assert!(named.told && (named.size - 25.0).abs() < 2.0, "{named:?}");
    assert_eq!((delay.verdict, delay.effects[0].id), (GapVerdict::Effect, EffectId::OPERATOR_DELAY));
    let longer = told(54, &|scenario| {
        for machine in &mut scenario.machines {
            machine.load_time = Distribution::Lognormal { mean: 56.0, cv: 0.2 };
            machine.unload_time = Distribution::Lognormal { mean: 28.0, cv: 0.2 };
        }
    });
    let [fact] = found(&longer)[..] else { panic!("{}", longer.terminal()) };
    assert!(fact.told.delay.is_none() && (fact.factor() - 1.4).abs() < 0.03, "{fact:?}");
}

#[test]
fn a_delay_of_one_shift_is_no_constant() {
    let diagnosis = told(55, &delayed(ShopEffect::OperatorDelay, 25.0, &[("shift", "S2")]));
    let [fact] = found(&diagnosis)[..] else { panic!("{}", diagnosis.terminal()) };
    assert_eq!((fact.place.as_str(), &fact.told.shifts[..]), ("L1, L2, M1, M2", &["S2".to_owned()][..]));
    let delay = fact.told.delay.as_ref().expect("a delay");
    assert!(delay.told && (delay.size - 25.0).abs() < 2.0, "{delay:?}");
    // What the file states itself is no finding, and neither is what a constant of it states.
    let stated = Scenario { deviations: vec![Deviation::new(ShopEffect::OperatorDelay, 25.0)], ..shipped_shop() };
    let events = of_shop(56, &|scenario| {
        scenario.horizon = 72.0 * 3600.0;
        scenario.deviations = stated.deviations.clone();
    });
    let mut known = Diagnosis { verdict: GapVerdict::NoGap, ..Diagnosis::cannot_tell(String::new()) };
    add_machine_facts(&stated, &events, &ShiftLabels::default(), None, &mut known, 1);
    assert!(known.findings.is_empty(), "{}", known.terminal());
}

#[test]
fn a_shift_is_called_as_the_records_of_the_process_call_it() {
    // The delay acts in S2 of the calendar, which the records call by another name.
    let mut scenario = shipped_shop();
    scenario.horizon = 72.0 * 3600.0;
    delayed(ShopEffect::OperatorDelay, 25.0, &[("shift", "S2")])(&mut scenario);
    let log = toolroom_shop::run(&scenario, 0, 0).expect("it runs");
    let all = simulated(&scenario, &log, &|_, channel| Settings::default().sensor(channel)).expect("records");
    let of = |kind| all.iter().find(|records| records.kind == kind).expect("records");
    let mut records = of(RecordKind::Turning).clone();
    let names = records.texts("shift").expect("two shifts").iter();
    let names = names.map(|name| if name == "S2" { "late" } else { "early" }.to_owned()).collect();
    records.set_texts("shift", names);
    let mut diagnosis = Diagnosis { verdict: GapVerdict::NoGap, ..Diagnosis::cannot_tell(String::new()) };
    // Machines of the records alone: nothing is recorded of the others, whose operations bear no name of a shift.
    let mut turning = shipped_shop();
    turning.calendars.clear();
    turning.machines.iter_mut().for_each(|machine| machine.calendar = None);
    add_machine_facts(&turning, of(RecordKind::Shop), &ShiftLabels::from_records(&records), None, &mut diagnosis, 1);
    let late = |fact: &Fact| fact.place == "L1, L2" || fact.told.shifts == ["late"];
    let told: Vec<&Fact> = found(&diagnosis).into_iter().filter(|fact| fact.is_cause()).collect();
    assert!(!told.is_empty() && told.iter().all(|fact| late(fact)), "{}", diagnosis.terminal());
    assert!(told.iter().all(|fact| fact.told.shifts == ["late"]), "{}", diagnosis.terminal());
    // Without them nobody names a shift, and none is told.
    let mut unnamed = Diagnosis { verdict: GapVerdict::NoGap, ..Diagnosis::cannot_tell(String::new()) };
    add_machine_facts(&turning, of(RecordKind::Shop), &ShiftLabels::default(), None, &mut unnamed, 1);
    assert!(unnamed.facts.iter().all(|fact| fact.told.shifts.is_empty()), "{}", unnamed.terminal());
}
