//! What each policy of a comparison does, in words.

use super::Source;
use crate::compare::Role;
use toolroom_chart::{Table, number};
use toolroom_process::unit::convert;
use toolroom_scenario::{DressingRule, PolicyRule, ProcessModel, SpeedRule, StabilityRule};

/// The policies with what they do: speed, what is done about chatter, and when wheels are dressed, where they differ in that.
pub(super) fn table(source: &Source<'_>) -> Table {
    let scenario = source.scenario;
    let rules = || source.study.policies.iter().map(|position| scenario.policies[*position].dressing);
    let grinds = scenario.tools.iter().any(|tool| matches!(tool.process, ProcessModel::Infeed(_)));
    let dressed_apart = grinds && rules().zip(rules().skip(1)).any(|(one, next)| one != next);
    let mut table = Table::new(["policy", "what it is"]);
    for (position, policy) in source.comparison.policies.iter().enumerate() {
        let rule = &scenario.policies[source.study.policies[position]];
        let mut words = vec![speed(rule, &policy.role)];
        words.extend(stability(rule.stability));
        words.extend(dressed_apart.then(|| dressing(rule.dressing)));
        table.push([policy.name.as_str().into(), words.join("; ").into()]);
    }
    table
}

fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share, 3))
}

fn speed(rule: &PolicyRule, role: &Role) -> String {
    let factor =
        if rule.speed_factor == 1.0 { String::new() } else { format!(", times {}", number(rule.speed_factor, 3)) };
    if *role != Role::Given {
        return role.describe();
    }
    // Where no speed is commanded, every other rule runs as programmed.
    if let SpeedRule::Constant { cutting_speed } = rule.speed {
        format!("constant {} m/min{factor}", number(convert(cutting_speed, "m/s", "m/min"), 4))
    } else {
        format!("speed as programmed{factor}")
    }
}

/// What is done about chatter; `None` where nothing is.
fn stability(rule: StabilityRule) -> Option<String> {
    match rule {
        StabilityRule::Ignore => None,
        StabilityRule::BestLobe => Some("speed of the greatest nominal stability limit".to_owned()),
        StabilityRule::Reactive { .. } => Some("another speed once chatter is heard".to_owned()),
        StabilityRule::SpeedVariation { amplitude, revolutions } => {
            Some(format!("speed varied by {} every {revolutions} revolutions", percent(amplitude)))
        }
        StabilityRule::DepthReduction { share } => {
            Some(format!("layers of at most {} of the stability limit", percent(share)))
        }
        StabilityRule::RobustLobe { .. } => Some("speed at which stability is most probable".to_owned()),
        StabilityRule::Constraint { margin } => {
            Some(format!("nearest speed with a margin of {} to the stability limit", percent(margin)))
        }
    }
}

fn dressing(rule: DressingRule) -> String {
    match rule {
        DressingRule::Limit => "wheels dressed at their limit".to_owned(),
        DressingRule::PartCount { parts: 1 } => "wheels dressed for every part".to_owned(),
        DressingRule::PartCount { parts } => format!("wheels dressed every {parts} parts"),
        DressingRule::Dulling { ratio } => format!("wheels dressed when dulled to {} times", number(ratio, 3)),
    }
}
