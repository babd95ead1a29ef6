//! Rules by which a queue is ordered.

use toolroom_form::{Fault, Section, SectionValue, Value, Walk};
use toolroom_scenario::{DispatchRule, MOST_RULES};

/// Rules under the key `rule`; `None` where there are none.
pub(super) fn queue_rules(walk: &mut Walk, section: &Section<'_>) -> Option<Vec<DispatchRule>> {
    rules_under(walk, section, "rule")
}

/// Rules under a key; `None` where there are none.
pub(super) fn rules_under(walk: &mut Walk, section: &Section<'_>, key: &str) -> Option<Vec<DispatchRule>> {
    let rule =
        |got: &SectionValue<'_>| if let Value::Text(word) = &got.value { DispatchRule::named(word) } else { None };
    let rules: Vec<DispatchRule> = section.list(key).iter().filter_map(rule).collect();
    if rules.len() > MOST_RULES {
        let fault = Fault::WrongType {
            key: key.to_owned(),
            read: format!("{} rules", rules.len()),
            expected: format!("at most {MOST_RULES} rules"),
            example: "[\"edd\", \"spt\"]".to_owned(),
        };
        walk.fault(section.span_of(key), fault);
    }
    (!rules.is_empty()).then_some(rules)
}
