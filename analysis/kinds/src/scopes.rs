//! Entries of a scenario whose scopes meet, and scopes that no run fills.

use crate::warning::Warning;
use toolroom_scenario::{Scenario, Scope};

/// Keys of a scope that a simulated shop does not know.
const OF_RECORDS: [&str; 2] = ["material", "operator"];

/// Everything that has a scope: what it is, and where it acts.
fn scoped(scenario: &Scenario) -> Vec<(String, &Scope)> {
    let deviations = scenario.deviations.iter().filter(|own| own.recorded.is_none());
    let deviations = deviations.map(|own| (format!("deviation `{}`", own.effect.word()), &own.scope));
    let calibrations = scenario.calibrations.iter();
    let calibrations =
        calibrations.map(|own| (format!("calibration of `{}` of {}", own.parameter, own.target.words()), &own.scope));
    let effects = scenario.tools.iter().flat_map(|tool| {
        let what = |id: &str| format!("effect `{id}` of tool \"{}\"", tool.name);
        tool.variants.effects.iter().map(move |own| (what(own.effect.entry().id), &own.scope))
    });
    deviations.chain(calibrations).chain(effects).collect()
}

/// A warning for every two entries of the same thing that can act on one operation.
pub(crate) fn together(scenario: &Scenario) -> Vec<Warning> {
    let entries = scoped(scenario);
    let place = |scope: &Scope| if scope.is_everywhere() { "everywhere".to_owned() } else { scope.words() };
    let mut warnings = Vec::new();
    for (i, (what, scope)) in entries.iter().enumerate() {
        for (_, other) in entries[..i].iter().filter(|(before, other)| before == what && scope.meets(other)) {
            let (first, second) = (place(other), place(scope));
            let message =
                format!("{what}: the entries {first} and {second} can act on one operation, and then act together");
            warnings.push(Warning { code: "acts-together", message });
        }
    }
    warnings
}

/// A warning for every entry whose scope asks for what no simulated operation has.
pub(crate) fn records_only(scenario: &Scenario) -> Vec<Warning> {
    let asks = |scope: &Scope| scope.names.iter().find(|(key, _)| OF_RECORDS.contains(key)).map(|(key, _)| *key);
    let told = |(what, scope): (String, &Scope)| {
        let message =
            format!("{what} is scoped by `{}`, which a simulated shop does not have: it acts in no run", asks(scope)?);
        Some(Warning { code: "records-only", message })
    };
    scoped(scenario).into_iter().filter_map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_scenario_file::parse;

    fn shop(entries: &str) -> Scenario {
        let text = include_str!("../../../scenarios/gap/turning.toml").to_owned() + entries;
        parse("x.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario
    }

    #[test]
    fn entries_that_can_act_on_one_operation_are_told_and_others_are_not() {
        let delay = |scope: &str| format!("\n[[deviation]]\nid = \"operator_delay\"\nsize = \"20 s\"\n{scope}\n");
        let told = |first: &str, second: &str| together(&shop(&(delay(first) + &delay(second))));
        let both = told("", "scope = { machine = \"L1\" }");
        assert_eq!(both.len(), 1, "{both:?}");
        assert!(
            both[0].message.contains("deviation `operator_delay`: the entries everywhere and machine=L1"),
            "{both:?}"
        );
        assert!(told("scope = { machine = \"L2\" }", "scope = { machine = \"L1\" }").is_empty());
        assert!(told("scope = { until = \"4 h\" }", "scope = { from = \"4 h\", part = \"part\" }").is_empty());
        assert_eq!(told("scope = { machine = \"L\" }", "scope = { machine = \"L1\", from = \"4 h\" }").len(), 1);
        let factor =
            "\n[[calibration]]\nparameter = \"handling_time\"\ntarget = \"shop\"\nfactor = 1.1\nby = \"hand\"\n";
        let moved = together(&shop(&(factor.to_owned() + factor.trim_end() + "\nscope = { machine = \"L1\" }\n")));
        assert_eq!(moved.len(), 1, "{moved:?}");
    }

    #[test]
    fn what_no_run_can_have_is_told() {
        let scope = "\n[[deviation]]\nid = \"operator_delay\"\nsize = \"20 s\"\nscope = { operator = \"Ann\" }\n";
        let told = records_only(&shop(scope));
        assert!(told.len() == 1 && told[0].message.contains("`operator`"), "{told:?}");
        assert!(records_only(&shop("")).is_empty());
    }
}
