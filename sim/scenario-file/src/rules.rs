//! Arrivals, dispatching, policies, output.

use super::choices::{FormatWord, GrowthWord, PatternWord, ToolChangeWord};
use super::keys::SENSORS;
use super::names::{Names, named};
use super::planned::{dressing_rule, grinding_rule};
use super::processes;
use super::queue_rules::queue_rules;
use super::random::distribution;
use super::speed::speed_rule;
use super::{Output, SelectSection, Statistics};
use super::{control, progress, stability, stocks, tune};
use toml::de::DeTable;
use toolroom_form::{Fault, Section, Span, Value, Walk};
use toolroom_scenario::{
    Arrival, ArrivalPattern, Blocking, ContourRule, Deadlock, DispatchRule, GapSection, Knowledge, MachineChoice,
    MachineType, PolicyRule, Preemption, SensorErrors, SensorSheet, ToolChangeRule,
};
use toolroom_wear::{Pair, TURNING_SETS};

pub(super) fn arrivals(walk: &mut Walk, root: &Section<'_>, names: &Names) -> Vec<Arrival> {
    let sections = walk.sections(root, "arrivals", None);
    if sections.is_empty() && ["arrivals", "order", "tables"].iter().all(|key| root.got(key).is_none()) {
        let example = "[[arrivals]] with part and pattern or [[order]], or no job ever comes";
        walk.fault(0..0, Fault::Nothing { what: "source of arrivals", example });
    }
    let mut arrivals: Vec<Arrival> = Vec::new();
    for section in sections {
        let name = section.text("name").map(str::to_owned);
        if let Some(name) = name.as_ref().filter(|name| arrivals.iter().any(|own| own.name.as_ref() == Some(name))) {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: "source", name: name.clone() });
        }
        let parts = stocks::parts_of_source(walk, &section, &names.parts);
        let quantity = stocks::quantity(walk, &section);
        let pattern = match section.chosen("pattern", PatternWord::from_word) {
            Some(PatternWord::Batch) => {
                ArrivalPattern::Batch { interval: section.required("interval"), size: section.count32("size") }
            }
            Some(PatternWord::Schedule) => {
                let lots = walk.sections(&section, "lot", None);
                let mut lots: Vec<(f64, u32)> =
                    lots.iter().map(|lot| (lot.required("time"), lot.count32("size"))).collect();
                lots.sort_by(|a, b| a.0.total_cmp(&b.0));
                ArrivalPattern::Schedule(lots)
            }
            Some(PatternWord::ConstantWork) => ArrivalPattern::ConstantWork { jobs: section.count32("jobs") },
            Some(PatternWord::Renewal) => {
                let time_between = distribution(walk, &section, "time_between");
                progress::check_interval(walk, &section, &time_between);
                ArrivalPattern::Renewal(time_between)
            }
            Some(PatternWord::Poisson) => ArrivalPattern::Poisson { rate: section.required("rate") },
            None => ArrivalPattern::Poisson { rate: f64::NAN }, // a problem was noted
        };
        let due = control::due(walk, &section);
        arrivals.push(Arrival {
            name,
            parts,
            quantity,
            priority: section.count32("priority"),
            weight: section.required("weight"),
            due,
            pattern,
        });
    }
    // What comes in the same instant, and what sources without a name draw, does not hang on the order in the file.
    let called = |own: &Arrival| {
        let of_part = |(part, _): &(usize, f64)| names.parts.get(*part).map_or("", String::as_str);
        own.name.clone().unwrap_or_else(|| own.parts.iter().map(of_part).collect::<Vec<_>>().join(" + "))
    };
    arrivals.sort_by_cached_key(called);
    arrivals
}

/// The section `[dispatch]`.
pub(super) struct Dispatch {
    pub rules: Vec<DispatchRule>,
    pub choice: MachineChoice,
    pub blocking: Blocking,
    pub deadlock: Deadlock,
    pub preemption: Preemption,
}

/// What `[dispatch]` says; left out with the whole section, all are the defaults of their keys.
pub(super) fn dispatch(walk: &mut Walk, given: Option<&Section<'_>>) -> Dispatch {
    let rules = given.and_then(|section| queue_rules(walk, section)).unwrap_or(vec![DispatchRule::Fifo]);
    let choice = given.and_then(|section| section.chosen("machine_choice", MachineChoice::from_word));
    let blocking = given.and_then(|section| section.chosen("blocking", Blocking::from_word));
    let deadlock = given.and_then(|section| section.chosen("deadlock", Deadlock::from_word));
    let preemption = given.and_then(|section| section.chosen("preempt", Preemption::from_word));
    Dispatch {
        rules,
        choice: choice.unwrap_or(MachineChoice::LeastSetup),
        blocking: blocking.unwrap_or(Blocking::AfterService),
        deadlock: deadlock.unwrap_or(Deadlock::Stop),
        preemption: preemption.unwrap_or_default(),
    }
}

pub(super) fn policies(walk: &mut Walk, root: &Section<'_>, machines: &[MachineType]) -> Vec<(PolicyRule, Span)> {
    if root.got("policy").is_none() {
        return vec![(PolicyRule::default(), 0..0)];
    }
    let example = "[[policy]] with name and speed, such as speed = \"programmed\"";
    let mut policies = Vec::new();
    for (name, section) in named(walk, root, "policy", Some(example)) {
        let speed = speed_rule(walk, &section, machines);
        let tool_change = tool_change(walk, &section);
        let believed_model = believed_model(walk, &section);
        let sensors = sensors(walk, &section, &[]);
        let grinding = grinding_rule(walk, &section);
        let dressing = dressing_rule(walk, &section);
        let contour = section.chosen("contour", ContourRule::from_word);
        let stability = stability::rule(walk, &section);
        let mut rule = PolicyRule {
            name,
            speed,
            speed_factor: section.si("speed_factor").unwrap_or(1.0),
            knows: section.chosen("knows", Knowledge::from_word).unwrap_or(Knowledge::Sensors),
            stability,
            tool_change,
            grinding,
            dressing,
            contour,
            believed_model,
            sensors,
            ..PolicyRule::default()
        };
        rule.tune = tune::tunable(walk, &section, &rule);
        policies.push((rule, section.span_of("name")));
    }
    policies
}

pub(super) fn tool_change(walk: &mut Walk, section: &Section<'_>) -> ToolChangeRule {
    let Some((word, table)) = walk.rule(section, "tool_change", ToolChangeWord::from_word) else {
        return ToolChangeRule::WearLimit { limit: None }; // a problem was noted
    };
    match word {
        ToolChangeWord::WearLimit => ToolChangeRule::WearLimit { limit: table.si("limit") },
        ToolChangeWord::PartCount => ToolChangeRule::PartCount { parts: table.due().count32("parts") },
        ToolChangeWord::CuttingTime => ToolChangeRule::CuttingTime { time: table.due().required("time") },
        ToolChangeWord::Predicted => ToolChangeRule::Predicted { limit: table.si("limit") },
    }
}

fn believed_model(walk: &mut Walk, section: &Section<'_>) -> Option<Pair> {
    let set = processes::set(walk, section, "believed_model", &TURNING_SETS)?;
    Pair::of_set(&set).map_err(|reason| processes::refuse(walk, section, "believed_model", reason)).ok()
}

/// The key `sensors` of a section, a table of [`SENSORS`]; left out, the default sensors. The keys `unused` say nothing
/// in files of this kind and are refused.
pub fn sensors(walk: &mut Walk, section: &Section<'_>, unused: &[&'static str]) -> SensorSheet {
    let given = matches!(section.got("sensors").map(|got| &got.value), Some(Value::Raw(_)));
    let table = if given { walk.table(section, "sensors") } else { None };
    let table = table.unwrap_or_else(|| {
        let span = section.span.clone();
        walk.section(&SENSORS, &format!("{}, sensors", section.path), &DeTable::new(), span, None)
    });
    for key in unused.iter().copied().filter(|key| table.given(key)) {
        let of_use = SENSORS.keys.iter().map(|key| key.name).filter(|name| !unused.contains(name));
        let applicable = of_use.collect::<Vec<_>>().join(", ");
        walk.fault(
            table.span_of(key),
            Fault::NotApplicable { key, case: "a file of this kind".to_owned(), applicable },
        );
    }
    SensorSheet {
        sampling_period: table.required("sampling_period"),
        spindle_power: table.required("spindle_power"),
        feed_force: table.required("feed_force"),
        thermo_emf: table.required("thermo_emf"),
        thermo_emf_bias: table.required("thermo_emf_bias"),
        feed_force_bias: table.required("feed_force_bias"),
        spindle_power_bias: table.required("spindle_power_bias"),
        flank_wear: table.required("flank_wear"),
        reading_time: table.required("reading_time"),
        read_every: table.count32("read_every"),
        feed_force_gain: table.required("feed_force_gain"),
        thermo_emf_gain: table.required("thermo_emf_gain"),
        dominant_frequency: table.required("dominant_frequency"),
        normal_force: table.required("normal_force"),
        normal_force_bias: table.required("normal_force_bias"),
    }
}

/// The section `[gap]`, where there is one.
pub fn gap(walk: &mut Walk, root: &Section<'_>) -> Option<GapSection> {
    let section = walk.table(root, "gap")?;
    let text = |section: &Section<'_>, key: &str| section.text(key).map(str::to_owned);
    let sensors = walk.sections(&section, "sensor", None);
    let sensors = sensors.iter().map(|sensor| SensorErrors {
        channel: text(sensor, "channel").unwrap_or_default(),
        relative: sensor.required("relative"),
        absolute: text(sensor, "absolute"),
        resolution: text(sensor, "resolution"),
    });
    // A mark for `gap apply`, which says what its calibration rests on.
    let seen = walk.table(&section, "applied").map_or_else(Vec::new, |applied| applied.texts("data"));
    Some(GapSection {
        process: text(&section, "process"),
        conditions: section.given("conditions").then(|| section.texts("conditions")),
        channels: section.texts("channels"),
        constant_rate: section.chosen("wear_growth", GrowthWord::from_word) == Some(GrowthWord::ConstantRate),
        force: section.required("force"),
        temperature: section.required("temperature"),
        wear_level: section.required("wear_level"),
        stiffness: section.required("stiffness"),
        edge_wear: section.required("edge_wear"),
        edge_force: section.required("edge_force"),
        sensors: sensors.collect(),
        seen,
    })
}

/// The section `[statistics]`.
pub(super) fn statistics(walk: &mut Walk, root: &Section<'_>) -> Statistics {
    let Some(section) = walk.table(root, "statistics") else { return Statistics::default() };
    let select = walk.table(&section, "select").map(|select| SelectSection {
        kpi: select.text("kpi").unwrap_or_default().to_owned(),
        indifference: select.text("indifference").unwrap_or_default().to_owned(),
        // 95 % is 0.95, whatever the hundredth part of it is in binary.
        confidence: (1e12 * select.required("confidence")).round() / 1e12,
    });
    Statistics {
        primary: section.text("primary").map(str::to_owned),
        until: walk.texts(&section, "until", "{ lead_time = \"half-width 2 %\" }").into_iter().collect(),
        max_replications: section.given("max_replications").then(|| section.count32("max_replications")),
        select,
    }
}

pub(super) fn output(walk: &mut Walk, root: &Section<'_>) -> Output {
    let section = walk.table(root, "output");
    let format = section.as_ref().and_then(|section| section.chosen("format", FormatWord::from_word));
    let csv = format == Some(FormatWord::Csv);
    let logs = section.as_ref().and_then(|section| section.flag("logs")).unwrap_or(true);
    Output { csv, logs }
}
