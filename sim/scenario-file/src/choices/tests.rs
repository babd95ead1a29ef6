//! Every word has its rule, and every rule its word.

use super::*;
use crate::keys::SCENARIO;
use crate::names::Names;
use crate::random::distribution;
use crate::speed::speed_rule;
use crate::{planned, processes, rules, stability};
use toml::de::DeTable;
use toolroom_form::{Form, Key, Kind, Need, Section, Walk, example};
use toolroom_scenario::{
    ArrivalPattern, Distribution, DressingRule, GrindingRule, Interruption, ProcessModel, SpeedRule, StabilityRule,
    ToolChangeRule,
};
use toolroom_wear::Scatter;

// Each function from a rule to its word matches without a wildcard: a rule without a word does not
// compile.

fn word_of_chatter(rule: StabilityRule) -> ChatterWord {
    match rule {
        StabilityRule::Ignore => ChatterWord::Ignore,
        StabilityRule::BestLobe => ChatterWord::BestLobe,
        StabilityRule::Reactive { .. } => ChatterWord::Reactive,
        StabilityRule::SpeedVariation { .. } => ChatterWord::SpeedVariation,
        StabilityRule::DepthReduction { .. } => ChatterWord::DepthReduction,
        StabilityRule::RobustLobe { .. } => ChatterWord::RobustLobe,
        StabilityRule::Constraint { .. } => ChatterWord::Constraint,
    }
}

fn word_of_tool_change(rule: ToolChangeRule) -> ToolChangeWord {
    match rule {
        ToolChangeRule::WearLimit { .. } => ToolChangeWord::WearLimit,
        ToolChangeRule::PartCount { .. } => ToolChangeWord::PartCount,
        ToolChangeRule::CuttingTime { .. } => ToolChangeWord::CuttingTime,
        ToolChangeRule::Predicted { .. } => ToolChangeWord::Predicted,
    }
}

fn word_of_grinding(rule: GrindingRule) -> GrindingWord {
    match rule {
        GrindingRule::Fixed { .. } => GrindingWord::Fixed,
        GrindingRule::ForceAdaptive { .. } => GrindingWord::ForceAdaptive,
        GrindingRule::TimeConstantAdaptive { .. } => GrindingWord::TimeConstantAdaptive,
    }
}

fn word_of_dressing(rule: DressingRule) -> DressingWord {
    match rule {
        DressingRule::Limit => DressingWord::Limit,
        DressingRule::PartCount { .. } => DressingWord::PartCount,
        DressingRule::Dulling { .. } => DressingWord::Dulling,
    }
}

fn word_of_family(family: Distribution) -> FamilyWord {
    match family {
        Distribution::Constant(_) => FamilyWord::Constant,
        Distribution::Exponential { .. } => FamilyWord::Exponential,
        Distribution::Erlang { .. } => FamilyWord::Erlang,
        Distribution::Gamma { .. } => FamilyWord::Gamma,
        Distribution::Lognormal { .. } => FamilyWord::Lognormal,
        Distribution::Weibull { .. } => FamilyWord::Weibull,
        Distribution::Triangular { .. } => FamilyWord::Triangular,
        Distribution::Beta { .. } => FamilyWord::Beta,
        Distribution::Normal { .. } => FamilyWord::Normal,
        Distribution::Uniform { .. } => FamilyWord::Uniform,
        Distribution::DiscreteUniform { .. } => FamilyWord::DiscreteUniform,
        Distribution::Empirical(_) => FamilyWord::Empirical,
    }
}

fn word_of_pattern(pattern: &ArrivalPattern) -> PatternWord {
    match pattern {
        ArrivalPattern::Renewal(_) => PatternWord::Renewal,
        ArrivalPattern::Poisson { .. } => PatternWord::Poisson,
        ArrivalPattern::Batch { .. } => PatternWord::Batch,
        ArrivalPattern::Schedule(_) => PatternWord::Schedule,
        ArrivalPattern::ConstantWork { .. } => PatternWord::ConstantWork,
    }
}

/// A process that a file can name; imported units stand in for one of the others.
fn kind_of_process(process: &ProcessModel) -> Option<ProcessKind> {
    match process {
        ProcessModel::Turning(_) => Some(ProcessKind::Turning),
        ProcessModel::Milling(_) => Some(ProcessKind::Milling),
        ProcessModel::Infeed(_) => Some(ProcessKind::Infeed),
        ProcessModel::Other(_) => None,
    }
}

/// The form of the sections or the table under a key.
fn form_of(form: &Form, key: &str) -> &'static Form {
    let kind = form.key(key).map(|key| key.kind);
    let Some(Kind::Table(form) | Kind::Tables(form) | Kind::Shorthand { form, .. }) = kind else {
        panic!("{}: {key} has no form", form.title)
    };
    form
}

fn needs(key: &Key, selector: &str, word: &str) -> bool {
    let chosen = key.when.is_none_or(|when| when.key == selector && when.values.contains(&word));
    matches!(key.need, Need::Required) && chosen && key.name != selector
}

/// The body of a table: the word of its selector, and an example of every key that is then due.
fn body(form: &Form, selector: &str, word: &str) -> String {
    let due = form.keys.iter().filter(|key| needs(key, selector, word)).map(|key| match key.kind {
        Kind::Tables(form) => format!("{} = [{{ {} }}]", key.name, body(form, "", "")),
        _ => format!("{} = {}", key.name, example(&key.kind)),
    });
    let selected = (!selector.is_empty()).then(|| format!("{selector} = \"{word}\""));
    selected.into_iter().chain(due).collect::<Vec<_>>().join(", ")
}

/// Reads a table of a form.
fn read<T>(form: &'static Form, body: &str, reader: impl FnOnce(&mut Walk, &Section<'_>) -> T) -> T {
    let text = format!("it = {{ {body} }}");
    let document = DeTable::parse(&text).unwrap_or_else(|error| panic!("{text}: {error}")).into_inner();
    let table = document["it"].get_ref().as_table().expect("an inline table").clone();
    let mut walk = Walk::default();
    let section = walk.section(form, "it", &table, 0..0, None);
    let result = reader(&mut walk, &section);
    assert!(walk.problems.is_empty(), "{text}: {:?}", walk.problems);
    result
}

/// A policy with a rule under `key`, as a bare word where `alone`.
fn policy_with<T>(key: &str, word: &str, reader: impl FnOnce(&mut Walk, &Section<'_>) -> T) -> T {
    let policy = form_of(&SCENARIO, "policy");
    let rule = body(form_of(policy, key), "rule", word);
    read(policy, &format!("name = \"p\", speed = \"programmed\", {key} = {{ {rule} }}"), reader)
}

#[test]
fn every_word_of_a_speed_is_read_from_a_policy_as_its_rule() {
    let policy = form_of(&SCENARIO, "policy");
    let rule = |word: &&str| read(policy, &body(policy, "speed", word), |walk, section| speed_rule(walk, section, &[]));
    assert_eq!(SpeedRule::WORDS.iter().map(rule).map(SpeedRule::word).collect::<Vec<_>>(), SpeedRule::WORDS);
}

#[test]
fn every_word_of_a_rule_reads_as_its_rule() {
    for word in ChatterWord::WORDS {
        assert_eq!(word_of_chatter(policy_with("chatter", word, stability::rule)).word(), *word);
    }
    for word in ToolChangeWord::WORDS {
        assert_eq!(word_of_tool_change(policy_with("tool_change", word, rules::tool_change)).word(), *word);
    }
    for word in GrindingWord::WORDS {
        assert_eq!(word_of_grinding(policy_with("grinding", word, planned::grinding_rule)).word(), *word);
    }
    for word in DressingWord::WORDS {
        assert_eq!(word_of_dressing(policy_with("dressing", word, planned::dressing_rule)).word(), *word);
    }
}

#[test]
fn every_family_and_pattern_reads_as_itself() {
    let (failure, arrivals) = (form_of(&SCENARIO, "failure"), form_of(&SCENARIO, "arrivals"));
    // A law that was fitted is one of the others, and needs its file.
    for word in FamilyWord::WORDS.iter().filter(|word| **word != FamilyWord::Fitted.word()) {
        let mut times = body(form_of(failure, "time_between"), "distribution", word);
        if *word == FamilyWord::Empirical.word() {
            times += ", values = [\"5 min\"]"; // due where no file is given
        }
        // The example of a triangle ascends.
        let times =
            times.replace("low = \"1.5 min\"", "low = \"1 min\"").replace("high = \"1.5 min\"", "high = \"2 min\"");
        let text = format!("machines = \"m\", time_to_repair = \"1 min\", time_between = {{ {times} }}");
        let family = read(failure, &text, |walk, section| distribution(walk, section, "time_between"));
        // A family of two names has one word of its own.
        let own = if *word == FamilyWord::Pert.word() { FamilyWord::Beta.word() } else { word };
        assert_eq!(word_of_family(family).word(), own);
    }
    for word in PatternWord::WORDS {
        let text = format!("arrivals = [{{ part = \"…\", {} }}]", body(arrivals, "pattern", word));
        let document = DeTable::parse(&text).unwrap_or_else(|error| panic!("{text}: {error}")).into_inner();
        let mut walk = Walk::default();
        let root = walk.section(&SCENARIO, "", &document, 0..0, None);
        walk.problems.clear(); // of sections that are left out
        let names = Names { parts: vec!["…".to_owned()], ..Names::default() };
        let read = rules::arrivals(&mut walk, &root, &names);
        assert!(walk.problems.is_empty(), "{text}: {:?}", walk.problems);
        assert_eq!(word_of_pattern(&read[0].pattern).word(), *word);
    }
}

#[test]
fn every_process_reads_as_itself() {
    let tool = form_of(&SCENARIO, "tool");
    for word in ProcessKind::WORDS {
        let kind = ProcessKind::from_word(word).expect("a word of the list");
        let set = match kind {
            ProcessKind::Turning => toolroom_wear::PARAMETER_SETS[0].0,
            ProcessKind::Milling => toolroom_cutting::MILLING_SETS[0].0,
            ProcessKind::Infeed => toolroom_infeed::PARAMETER_SETS[0].0,
        };
        let text = format!("name = \"t\", process = \"{word}\", parameter_set = \"{set}\", edge_cost = \"1 EUR\"");
        let process = read(tool, &text, |walk, section| {
            let set = processes::set_of_tool(walk, section);
            processes::process(walk, section, set.as_ref(), &Scatter::none(), &[], None)
        });
        assert_eq!(process.as_ref().and_then(kind_of_process), Some(kind));
    }
}

/// All forms below `form`, itself first.
fn forms(form: &'static Form) -> Vec<&'static Form> {
    let below = form.keys.iter().filter_map(|key| match key.kind {
        Kind::Table(form) | Kind::Tables(form) | Kind::Shorthand { form, .. } => Some(form),
        _ => None,
    });
    [form].into_iter().chain(below.flat_map(forms)).collect()
}

fn words_of(kind: &Kind) -> &'static [&'static str] {
    match kind {
        Kind::Choice(words) => words,
        Kind::Shorthand { word, .. } | Kind::Fields { word, .. } => words_of(word),
        _ => &[],
    }
}

#[test]
fn keys_depend_on_words_that_exist() {
    for form in forms(&SCENARIO) {
        for (key, when) in form.keys.iter().filter_map(|key| Some((key, key.when?))) {
            let words = match form.key(when.key) {
                Some(selector) => words_of(&selector.kind),
                None if when.key == "process" => ProcessKind::OF_MACHINES, // of the operation's tool, or plain
                None => &[],
            };
            for value in when.values {
                assert!(words.contains(value), "{} {}: {} = {value}", form.title, key.name, when.key);
            }
        }
    }
}

#[test]
fn a_default_is_among_the_words_of_its_key() {
    for form in forms(&SCENARIO) {
        for key in form.keys {
            if let (Need::Default(word), words @ [_, ..]) = (key.need, words_of(&key.kind)) {
                assert!(words.contains(&word), "{} {}: {word}", form.title, key.name);
            }
        }
    }
}

/// A rule may stand as a bare word just where none of its numbers has to be given.
#[test]
fn a_bare_word_stands_for_a_rule_without_required_numbers() {
    for key in forms(&SCENARIO).into_iter().flat_map(|form| form.keys) {
        let Kind::Shorthand { word: &Kind::Choice(bare), form } = key.kind else { continue };
        // What is no rule, such as how many pieces begin more, has its numbers for another reason.
        let Some(rule) = form.key("rule") else { continue };
        let all = words_of(&rule.kind);
        let without = |word: &&str| !form.keys.iter().any(|key| needs(key, "rule", word));
        assert_eq!(bare, all.iter().copied().filter(without).collect::<Vec<_>>(), "{}", key.name);
    }
}

#[test]
fn a_breakdown_ends_with_every_interruption_but_finishing() {
    let part = form_of(&SCENARIO, "failure").key("part").expect("the key part");
    let but_finish: Vec<_> = Interruption::WORDS.iter().copied().filter(|word| *word != "finish").collect();
    assert_eq!(words_of(&part.kind), but_finish);
}
