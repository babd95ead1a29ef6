//! How a file chooses the cutting speed: the keys of a policy beside those of its rule, their reader.

use super::choices::ProcessKind;
use super::fault::ScenarioFault;
use super::keys::quantity::FACTOR;
use toolroom_form::{Fault, Key, Kind, Section, Span, Walk, joined, significant};
use toolroom_scenario::{
    Course, Knowledge, MachineType, PolicyRule, ProcessModel, Scenario, SpeedChoice, SpeedRule, ToolChangeRule, Work,
};

/// The rule.
const RULE: &[Key] =
    &[Key::required("speed", Kind::Choice(SpeedRule::WORDS), "How the cutting speed of turning passes is chosen")];
/// What every rule has.
const OF_ALL: &[Key] = &[
    Key::default("speed_factor", FACTOR, "1", "Factor on the speed that the rule commands"),
    Key::default(
        "knows",
        Kind::Choice(Knowledge::WORDS),
        Knowledge::Sensors.word(),
        "What the rule knows of the edge; more than sensors is a bound that no real controller reaches",
    )
    .when("speed", SpeedRule::OBSERVING),
];
const COUNT: usize = RULE.len() + SpeedRule::KEYS.len() + OF_ALL.len();
/// Keys of a policy that choose its speed.
pub(super) const KEYS: &[Key] = &joined::<COUNT>(&[RULE, SpeedRule::KEYS, OF_ALL]);

pub(super) fn speed_rule(walk: &mut Walk, section: &Section<'_>, machines: &[MachineType]) -> SpeedRule {
    let word = section.chosen("speed", SpeedRule::known_word);
    let Some(rule) = word.and_then(|word| SpeedRule::of_word(word, section)) else {
        return SpeedRule::Programmed; // a problem was noted
    };
    if let SpeedRule::Constant { cutting_speed: speed } = rule {
        let within = |machine: &MachineType| (machine.speed_range.0..=machine.speed_range.1).contains(&speed);
        let mut lathes = machines.iter().filter(|machine| machine.process == ProcessKind::Turning.word()).peekable();
        if speed.is_finite() && lathes.peek().is_some() && !lathes.any(within) {
            let fault = Fault::OutOfRange {
                key: "cutting_speed".to_owned(),
                read: format!("{} m/min", significant(speed * 60.0)),
                range: "the speed_range of every turning machine".to_owned(),
                meant: Vec::new(),
            };
            walk.fault(section.span_of("cutting_speed"), fault);
        }
    }
    rule
}

/// Whether a rule plans on a model of the tool, by speed or by tool change.
fn plans(rule: &PolicyRule) -> bool {
    let by_change = matches!(rule.tool_change, ToolChangeRule::Predicted { .. });
    by_change
        || match rule.speed.entry().course {
            Course::Programmed | Course::Constant(SpeedChoice::Given(_)) => false,
            Course::Constant(_) | Course::Schedule | Course::Law(_) | Course::Price(_) | Course::SetIncrement(_) => {
                true
            }
        }
}

/// Policies that plan the speed of an imported unit need a model that they believe in: a unit tells nobody its parameters,
/// and without one they would all run as programmed.
pub(super) fn needs_model(walk: &mut Walk, scenario: &Scenario, places: &[Span]) {
    let cuts = scenario
        .parts
        .iter()
        .flat_map(|part| &part.operations)
        .filter(|operation| matches!(operation.work, Work::Cutting(_)));
    let tools = cuts.flat_map(|operation| (0..operation.work.passes()).filter_map(|pass| operation.tool_of_pass(pass)));
    let unit = tools.filter_map(|tool| scenario.tools.get(tool)).find(|tool| {
        matches!(tool.process, ProcessModel::Other(_))
            && tool.process.pair().is_none()
            && scenario.commands_speed_of(tool)
    });
    let Some(tool) = unit else { return };
    let without = |(rule, _): &(&PolicyRule, &Span)| rule.believed_model.is_none() && plans(rule);
    for (rule, place) in scenario.policies.iter().zip(places).filter(without) {
        let fault = ScenarioFault::UnbelievedUnit { policy: rule.name.clone(), tool: tool.name.clone() };
        walk.fault(place.clone(), fault);
    }
}
