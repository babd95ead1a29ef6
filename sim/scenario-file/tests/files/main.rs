//! Good files are understood, bad ones are answered with every fault in its place.

mod flow;
mod matrices;
mod measured;
mod mills;
mod orders;

use proptest::prelude::*;
use toolroom_form::{Origin, ReadError};
use toolroom_scenario::{ArrivalPattern, Distribution, Setting, SpeedRule, ToolChangeRule, Tunable, TuneRequest, Work};
use toolroom_scenario_file::*;

const GOOD: &str = r#"schema = 1

[shop]
name = "two-cells"
title = "Two lathes"
seed = 7
replications = 3
horizon = "16 h"
warm_up = "1 h"

[[calendar]]
name = "early"
shift = [{ start = "6 h", end = "14 h" }]
at_end = "resume"

[[machine]]
name = "L"
count = 2
process = "turning"
rate = "60 EUR/h"
load_time = "45 s"
unload_time = { distribution = "triangular", low = "20 s", mode = "30 s", high = "1 min" }
tool_change_time = "2 min"
speed_range = ["15 m/min", "80 m/min"]
calendar = "early"

[[tool]]
name = "ring insert"
process = "turning"
parameter_set = "ni_vk6om"
parameters = { limits = { wear_limit = "0.5 mm" } }
effects = [{ id = "wear_force", size = 0.2 }]
edge_cost = "4.5 EUR"
scatter = "lab"

[[part]]
name = "ring"
material_cost = "40 EUR"

[[part.operation]]
name = "face"
machines = "L"
tool = "ring insert"
cutting_speed = "40 m/min"
feed_per_rev = "0.12 mm/rev"
depth_of_cut = "0.75 mm"
diameter = "120 mm"
length = "24 mm"
passes = 3
size_tolerance = "50 um"

[[arrivals]]
part = "ring"
pattern = "poisson"
rate = "5 1/h"

[[failure]]
machines = ["L1"]
time_between = { distribution = "weibull", mean = "40 h", shape = 1.5 }
time_to_repair = "30 min"

[[policy]]
name = "v0"
speed = "makarov"
at_flank_wear = "0.2 mm"

[[policy]]
name = "adaptive"
speed = "minimum_wear"
tool_change = { rule = "cutting_time", time = "12 min" }
sensors = { thermo_emf_bias = 0.05 }
"#;

fn good() -> ScenarioFile {
    parse("shop.toml", GOOD, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Codes, lines and messages of the faults of GOOD with `from` replaced by `to`.
fn faults(from: &str, to: &str) -> Vec<(&'static str, usize, String)> {
    assert!(GOOD.contains(from), "{from}");
    faults_of(&GOOD.replacen(from, to, 1), &[])
}

fn faults_of(text: &str, overrides: &[String]) -> Vec<(&'static str, usize, String)> {
    match parse("shop.toml", text, overrides) {
        Ok(_) => Vec::new(),
        Err(ReadError::Faults(list)) => list
            .problems
            .iter()
            .map(|problem| {
                let fix = problem.fault.fix().unwrap_or_default();
                (problem.fault.code(), list.place(problem).line, format!("{} | {fix}", problem.fault))
            })
            .collect(),
        Err(other) => panic!("{other}"),
    }
}

fn only(faults: Vec<(&'static str, usize, String)>) -> (&'static str, usize, String) {
    assert_eq!(faults.len(), 1, "{faults:#?}");
    faults.into_iter().next().unwrap()
}

fn line_of(text: &str) -> usize {
    GOOD[..GOOD.find(text).unwrap()].matches('\n').count() + 1
}

#[test]
fn a_good_file_is_understood_in_si() {
    let file = good();
    let scenario = &file.scenario;
    let names: Vec<&str> = scenario.machines.iter().map(|machine| machine.name.as_str()).collect();
    assert_eq!(names, ["L1", "L2"]);
    assert_eq!(scenario.horizon, 57600.0);
    assert_eq!(scenario.shift_length, 28800.0);
    assert_eq!(scenario.machines[0].load_time, Distribution::Constant(45.0));
    assert_eq!(scenario.machines[1].unload_time, Distribution::Triangular { low: 20.0, mode: 30.0, high: 60.0 });
    assert_eq!(scenario.machines[0].speed_range, (0.25, 80.0 / 60.0));
    assert!((scenario.machines[0].rate - 1.0 / 60.0).abs() < 1e-15);
    assert_eq!(scenario.parts[0].operations[0].machines, [0, 1]);
    let Work::Cutting(cuts) = &scenario.parts[0].operations[0].work else { panic!() };
    assert_eq!(cuts.len(), 3);
    let path = std::f64::consts::PI * 0.12 * 0.024 / 0.12e-3;
    assert!((cuts[0].path_length / path - 1.0).abs() < 1e-12, "{}", cuts[0].path_length);
    assert_eq!(scenario.failures.len(), 1);
    assert!(
        matches!(scenario.arrivals[0].pattern, ArrivalPattern::Poisson { rate } if (rate * 720.0 - 1.0).abs() < 1e-12)
    );
    assert_eq!(scenario.policies[0].speed, SpeedRule::Makarov { at_flank_wear: 0.2e-3 });
    assert_eq!(scenario.policies[1].tool_change, ToolChangeRule::CuttingTime { time: 720.0 });
    assert_eq!(scenario.policies[1].sensors.thermo_emf_bias, 0.05);
    assert_eq!(scenario.policies[1].sensors.sampling_period, 6.0);
}

#[test]
fn the_echo_tells_values_in_display_units_and_defaults() {
    let file = good();
    let line = |section: &str, key: &str| {
        file.echo
            .iter()
            .find(|echo| echo.section == section && echo.key == key)
            .unwrap_or_else(|| panic!("{:#?}", file.echo))
    };
    assert_eq!(line("machine L", "tool_change_time").value, "2 min");
    assert_eq!(line("machine L", "load_time").value, "45 s");
    assert!(line("machine L", "setup_time").default);
    assert_eq!(line("part ring, operation face", "feed_per_rev").value, "0.12 mm");
    assert_eq!(line("tool ring insert, limits", "wear_limit").value, "0.5 mm");
    assert_eq!(line("policy adaptive, sensors", "thermo_emf_bias").value, "0.05");
}

#[test]
fn every_fault_is_told_at_once_each_with_its_line() {
    let text = GOOD
        .replace("tool_change_time", "tool_chnage_time")
        .replace("\"40 m/min\"", "40")
        .replace("part = \"ring\"", "part = \"rign\"")
        .replace("\"30 min\"", "\"30 mm\"");
    let found: Vec<&str> = faults_of(&text, &[]).iter().map(|fault| fault.0).collect();
    assert_eq!(found, ["unknown-key", "quantity", "unknown-name", "quantity"]);
}

#[test]
fn an_unknown_key_names_the_nearest() {
    let (code, line, text) = only(faults("rate = \"60 EUR/h\"", "rate = \"60 EUR/h\"\nspeed_rnge = 1"));
    assert_eq!((code, line), ("unknown-key", line_of("rate = \"60") + 1));
    assert!(text.contains("did you mean `speed_range`?"), "{text}");
    // The rate of a machine has one key for plain stations and one for machines that cut: it is listed once.
    assert_eq!(text.matches(" rate,").count(), 1, "{text}");
}

#[test]
fn a_calendar_without_shifts_names_both_ways_to_write_them() {
    let (code, _, text) = only(faults("shift = [{ start = \"6 h\", end = \"14 h\" }]", ""));
    assert_eq!(code, "missing-key");
    assert!(text.contains("add `shift = [{ start = \"6 h\", end = \"14 h\" }]` or `week = {"), "{text}");
}

#[test]
fn a_bare_number_names_the_accepted_units() {
    let (code, line, text) = only(faults("\"0.75 mm\"", "0.75"));
    assert_eq!((code, line), ("quantity", line_of("depth_of_cut")));
    assert!(
        text.contains("accepted: ") && text.contains("um") && text.contains("write for example \"0.75 mm\""),
        "{text}"
    );
}

#[test]
fn a_feed_rate_for_a_feed_per_revolution_is_told_apart() {
    let (code, _, text) = only(faults("\"0.12 mm/rev\"", "\"250 mm/min\""));
    assert_eq!(code, "quantity");
    assert!(text.contains("\"0.12 mm/rev\""), "{text}");
}

#[test]
fn slips_of_quantities_are_answered_in_kind() {
    let cases = [
        ("\"0.75 mm\"", "\"0,75 mm\"", "quantity", "\"0.75 mm\""),
        ("\"0.75 mm\"", "\"750 mm\"", "out-of-range", "\"750 um\""),
        ("\"0.75 mm\"", "\"nan mm\"", "quantity", "number"),
        ("\"0.75 mm\"", "nan", "out-of-range", "nan"),
        ("\"0.75 mm\"", "\"1e999 mm\"", "out-of-range", "above 0"),
        ("\"0.75 mm\"", "-inf", "out-of-range", "inf"),
        ("\"45 s\"", "\"-45 s\"", "out-of-range", "-45 s"),
        ("\"16 h\"", "\"0 h\"", "out-of-range", "above 0"),
        ("\"4.5 EUR\"", "\"4.5 USD\"", "mixed-currency", "USD"),
        ("replications = 3", "replications = 0", "out-of-range", "1 to"),
        ("replications = 3", "replications = 2.5", "wrong-type", "whole number"),
        ("\"40 m/min\"", "\"90 m/min\"", "out-of-range", "speed_range of L1"),
    ];
    for (from, to, code, text) in cases {
        let found = faults(from, to);
        assert_eq!(found.first().map(|fault| fault.0), Some(code), "{from} → {to}: {found:#?}");
        assert!(found[0].2.contains(text), "{to}: {found:#?}");
    }
}

#[test]
fn inches_are_converted() {
    let text = GOOD.replace("\"0.75 mm\"", "\"0.03 in\"");
    let file = parse("f", &text, &[]).unwrap();
    let Work::Cutting(cuts) = &file.scenario.parts[0].operations[0].work else { panic!() };
    assert!((cuts[0].depth_of_cut - 0.762e-3).abs() < 1e-15);
}

#[test]
fn another_currency_throughout_is_fine() {
    let text = GOOD.replace("EUR", "USD").replace("seed = 7", "seed = 7\ncurrency = \"USD\"");
    let file = parse("f", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.scenario.currency, "USD");
    assert!(file.echo.iter().any(|echo| echo.key == "edge_cost" && echo.value == "4.5 USD"));
}

#[test]
fn references_and_names_are_checked() {
    let cases = [
        ("machines = \"L\"", "machines = \"M\"", "unknown-name"),
        ("tool = \"ring insert\"", "tool = \"ring inset\"", "unknown-name"),
        ("calendar = \"early\"", "calendar = \"late\"", "unknown-name"),
        ("parameter_set = \"ni_vk6om\"", "parameter_set = \"ni_vk6\"", "unknown-name"),
        ("name = \"adaptive\"", "name = \"v0\"", "duplicate-name"),
        ("speed = \"minimum_wear\"", "speed = \"minimum_ware\"", "unknown-choice"),
        ("id = \"wear_force\"", "id = \"wear_farce\"", "effect"),
        ("limits = {", "limit = {", "unknown-key"),
        ("wear_limit = \"0.5 mm\"", "wear_limit = \"0.5 min\"", "quantity"),
        ("end = \"14 h\"", "end = \"5 h\"", "contradiction"),
        ("end = \"14 h\" }", "end = \"14 h\" }, { start = \"13 h\", end = \"15 h\" }", "shifts-overlap"),
        ("warm_up = \"1 h\"", "warm_up = \"16 h\"", "contradiction"),
        ("at_flank_wear = \"0.2 mm\"", "", "missing-key"),
        ("rule = \"cutting_time\"", "rule = \"wear_limit\"", "not-applicable"),
        ("pattern = \"poisson\"", "pattern = \"poisson\"\ninterval = \"1 h\"", "not-applicable"),
        ("length = \"24 mm\"", "", "missing-key"),
        ("length = \"24 mm\"", "length = \"24 mm\"\npath_length = \"75 m\"", "not-applicable"),
        ("low = \"20 s\"", "low = \"40 s\"", "contradiction"),
        ("speed_range = [\"15 m/min\", \"80 m/min\"]", "speed_range = [\"80 m/min\", \"15 m/min\"]", "wrong-type"),
        ("[[policy]]", "[[polcy]]", "unknown-key"),
        ("schema = 1", "schema = 2", "schema"),
        ("name = \"two-cells\"", "name = \"\"", "wrong-type"),
    ];
    for (from, to, code) in cases {
        let found = faults(from, to);
        assert!(found.iter().any(|fault| fault.0 == code), "{from} → {to}: {found:#?}");
    }
}

/// Two sections and their members: the second name may be that of a member of the first, whichever stands first.
#[test]
fn a_number_makes_no_name_twice() {
    let machine = |name: &str, count: &str| format!("[[machine]]\nname = \"{name}\"\nprocess = \"plain\"\n{count}\n");
    let rest = "[[part]]\nname = \"p\"\noperation = [{ name = \"o\", machines = \"L1\", work = \"1 min\" }]\n\
                [[arrivals]]\npart = \"p\"\npattern = \"poisson\"\nrate = \"1 1/h\"\n";
    let faults = |machines: &[String]| {
        faults_of(&format!("schema = 1\n[shop]\nname = \"x\"\nhorizon = \"8 h\"\n{}{rest}", machines.concat()), &[])
    };
    let (two, one, three) = (machine("L", "count = 2"), machine("L1", ""), machine("L1", "count = 3"));
    let eleven = machine("L", "count = 11");
    for machines in [[&two, &one], [&one, &two], [&two, &three], [&three, &two], [&eleven, &three]] {
        let found = faults(&machines.map(String::clone));
        assert!(found.iter().any(|fault| fault.0 == "duplicate-name"), "{machines:?}: {found:#?}");
    }
    assert!(faults(&[two, machine("L3", "count = 3")]).is_empty());
}

#[test]
fn empty_shops_are_refused() {
    let found = faults_of("schema = 1\n[shop]\nname = \"x\"\nhorizon = \"8 h\"\n", &[]);
    let nothing = found.iter().filter(|fault| fault.0 == "nothing-there").count();
    assert_eq!(nothing, 3, "machine, part, arrivals: {found:#?}");
}

#[test]
fn a_wheel_on_a_lathe_is_refused_once() {
    let text = GOOD.replace("process = \"turning\"\nparameter_set", "process = \"infeed\"\nparameter_set").replace(
        "parameters = { limits = { wear_limit = \"0.5 mm\" } }\neffects = [{ id = \"wear_force\", size = 0.2 }]\n",
        "",
    );
    let found = faults_of(&text, &[]);
    assert!(found.iter().any(|fault| fault.0 == "wrong-process"), "{found:#?}");
    assert!(found.iter().any(|fault| fault.0 == "no-machine"), "{found:#?}");
}

#[test]
fn an_unused_tool_is_refused() {
    let extra = "[[tool]]\nname = \"spare\"\nprocess = \"turning\"\nparameter_set = \"ni_vk8\"\nedge_cost = \"1 EUR\"\n\n[[part]]";
    let (code, _, text) = only(faults("[[part]]", extra));
    assert_eq!(code, "unused-tool");
    assert!(text.contains("spare"), "{text}");
}

#[test]
fn broken_toml_is_told_with_its_place_and_nothing_else() {
    let (code, line, _) = only(faults("seed = 7", "seed = = 7"));
    assert_eq!((code, line), ("syntax", line_of("seed")));
}

#[test]
fn an_override_replaces_a_value_and_its_faults_have_their_own_place() {
    let set = |text: &str| parse("f", GOOD, &[text.to_owned()]);
    let file = set("machine.L.tool_change_time=1 min").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.scenario.machines[1].tool_change_time, 60.0);
    let file = set("policy.adaptive.sensors.thermo_emf_bias=0.1").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.scenario.policies[1].sensors.thermo_emf_bias, 0.1);
    let file = set("part.ring.operation.face.passes=5").unwrap_or_else(|error| panic!("{error}"));
    let Work::Cutting(cuts) = &file.scenario.parts[0].operations[0].work else { panic!() };
    assert_eq!(cuts.len(), 5);
    let file = set("dispatch.rule=critical_ratio").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.scenario.dispatch, [toolroom_scenario::DispatchRule::CriticalRatio]);

    let overrides = ["shop.seed=3".to_owned(), "machine.L.tool_change_time=1 mm".to_owned()];
    let Err(ReadError::Faults(list)) = parse("f", GOOD, &overrides) else { panic!() };
    let place = list.place(&list.problems[0]);
    assert_eq!((place.origin, place.column), (Origin::Override(1), 30), "{list}");
    for wrong in ["machine.M.rate=1 EUR/h", "shop.sed=1", "nonsense", "shop.=1", "=", "machine.L=3", "machine=3"] {
        assert!(matches!(set(wrong), Err(ReadError::Faults(_))), "{wrong}");
    }
}

#[test]
fn every_code_is_explained() {
    for fault in faults("tool = \"ring insert\"", "tol = 1") {
        assert!(toolroom_form::CODES.iter().chain(CODES).any(|(code, _)| *code == fault.0), "{}", fault.0);
    }
    for (code, text) in CODES {
        assert!(text.len() > 40, "{code}");
    }
}

#[test]
fn a_section_that_says_nothing_tunes_as_no_section_does() {
    let file = parse("shop.toml", &format!("{GOOD}\n[tune]\n"), &[]).unwrap();
    assert_eq!((good().tune, file.tune), (None, Some(TuneRequest::default())));
}

#[test]
fn a_policy_says_whether_and_within_what_it_is_tuned() {
    let ranges = "tune = { time = [\"8 min\", \"16 min\"] }";
    let file = parse("shop.toml", &GOOD.replace("sensors = {", &format!("{ranges}\nsensors = {{")), &[]).unwrap();
    let expected = Tunable::Free { ranges: vec![(Setting::CuttingTime, (480.0, 960.0))], change: false };
    assert_eq!((&file.scenario.policies[0].tune, &file.scenario.policies[1].tune), (&Tunable::default(), &expected));
    // Where the rule of tool change is free, so are the settings of all rules that may take its place.
    let free = "tune = { change = true, limit = [\"0.2 mm\", \"0.4 mm\"] }";
    let file = parse("shop.toml", &GOOD.replace("sensors = {", &format!("{free}\nsensors = {{")), &[]).unwrap();
    let rules = file.scenario.policies[1].change_rules(Some(600.0));
    let expected = [
        ToolChangeRule::CuttingTime { time: 720.0 },
        ToolChangeRule::WearLimit { limit: None },
        ToolChangeRule::Predicted { limit: None },
    ];
    assert_eq!(rules, expected);
    let given = GOOD.replace("sensors = {", "tune = false\nsensors = {");
    let file = parse("shop.toml", &given, &[]).unwrap();
    assert_eq!(file.scenario.policies[1].tune, Tunable::Given);
    // A setting that the rule does not have, ends in the wrong order, and the seed that judges.
    for (text, code, word) in [
        (
            GOOD.replace("sensors = {", "tune = { price = [\"1 s/m\", \"2 s/m\"] }\nsensors = {"),
            "not-applicable",
            "speed_factor, time",
        ),
        (
            GOOD.replace("sensors = {", "tune = { time = [\"16 min\", \"8 min\"] }\nsensors = {"),
            "wrong-type",
            "16 min, 8 min",
        ),
        (format!("{GOOD}\n[tune]\nseed = 7\n"), "contradiction", "not tuned on"),
    ] {
        let (found, _, message) = only(faults_of(&text, &[]));
        assert_eq!(found, code, "{message}");
        assert!(message.contains(word), "{message}");
    }
}

#[test]
fn the_changes_that_give_a_policy_its_settings_are_read_back() {
    let scenario = good().scenario;
    let rule = &scenario.policies[1];
    let values = [(Setting::SpeedFactor, 0.85), (Setting::CuttingTime, 660.0)];
    let changes: Vec<String> = values.iter().map(|(setting, value)| rule.override_of(*setting, *value)).collect();
    let file = parse("shop.toml", GOOD, &changes).unwrap_or_else(|error| panic!("{error}"));
    let expected = values.iter().fold(rule.clone(), |rule, (setting, value)| rule.with(*setting, *value));
    assert_eq!(file.scenario.policies[1], expected);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_text_is_answered(text in "\\PC{0,200}") {
        let _ = parse("f", &text, &[]).map_err(|error| error.to_string());
    }

    #[test]
    fn any_override_is_answered(text in "(shop|machine|part|policy|tool|arrivals|calendar)?(\\.(L|ring|v0|operation|1|seed|shift))*=?\\PC{0,12}") {
        let _ = parse("f", GOOD, &[text]).map_err(|error| error.to_string());
    }

    #[test]
    fn a_mutated_file_is_answered(at in 0usize..GOOD.len(), cut in 0usize..40, insert in "[\\[\\]{}=\",.a-z0-9 \n-]{0,6}") {
        let mut text: Vec<char> = GOOD.chars().collect();
        let end = (at + cut).min(text.len());
        text.splice(at..end, insert.chars());
        let text: String = text.into_iter().collect();
        let _ = parse("f", &text, &[]).map_err(|error| error.to_string());
    }

    #[test]
    fn any_value_of_any_key_is_answered(line in 0usize..70, value in prop_oneof![
        Just("[]"), Just("{}"), Just("[{}]"), Just("true"), Just("1"), Just("-1"), Just("1.5"), Just("nan"),
        Just("\"\""), Just("\"x\""), Just("1979-05-27"), Just("[[1]]"), Just("\"9e999 m9 m9 m9 m9 m9 m9 m9 m9 m9 m9 m9 m9 m9 m9 m9\""),
        Just("99999999999999999999"), Just("0x7f"), Just("\"1 µm\""), Just("{ distribution = 3 }"),
    ]) {
        let lines: Vec<String> = GOOD
            .lines()
            .enumerate()
            .map(|(i, each)| match each.split_once(" = ") {
                Some((key, _)) if i == line => format!("{key} = {value}"),
                _ => each.to_owned(),
            })
            .collect();
        let _ = parse("f", &lines.join("\n"), &[]).map_err(|error| error.to_string());
    }
}
