//! Effects of a scenario that describe and are no cause.

use crate::warning::Warning;
use toolroom_scenario::Scenario;

/// One warning for every effect that its author calls empirical, with where it was seen.
pub(crate) fn empirical(scenario: &Scenario) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = Vec::new();
    let entries = scenario.tools.iter().flat_map(|tool| tool.variants.effects.iter().map(move |own| (&tool.name, own)));
    for (tool, definition) in entries.filter_map(|(tool, own)| Some((tool, own.effect.definition()?))) {
        let entry = definition.entry();
        let message = format!(
            "tool \"{tool}\" has the effect `{}`, which is empirical, not a cause ({}): where the range of its formula ends it \
             holds its value, and nothing is known of it there",
            entry.id, entry.source
        );
        if definition.is_empirical() && warnings.iter().all(|own| own.message != message) {
            warnings.push(Warning { code: "empirical", message });
        }
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_scenario_file::parse;

    #[test]
    fn an_effect_that_is_no_cause_is_told_once_with_where_it_was_seen() {
        let shop = include_str!("../../../scenarios/gap/turning.toml");
        let with = |kind: &str| {
            let entry = "{ id = \"my.heat\", size = 0.1, scope = { machine = \"L1\" } }";
            let entries = format!("scatter = \"lab\"\neffects = [{entry}, {}]", entry.replace("L1", "L2"));
            let effect = format!(
                "\n[[effect]]\nid = \"my.heat\"\nprocess = [\"turning\"]\nsize = {{ ordinary = 0.1, range = [0, 1] }}\n{kind}\
                 changes = [{{ term = \"temperature_rise\", factor = \"1 + size\" }}]\nsource = \"seen in May\"\n"
            );
            let text = shop.replacen("scatter = \"lab\"", &entries, 1) + &effect;
            empirical(&parse("x.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario)
        };
        let told = with("kind = \"empirical\"\n");
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].message.contains("not a cause (seen in May)"), "{told:?}");
        assert!(with("").is_empty());
    }
}
