//! How a file says what is tuned: `tune` of a policy, and the section `[tune]`.

use super::keys::quantity::{DURATION, FACTOR, SHARE};
use toolroom_form::{Fault, Form, Key, Kind, Section, Value, Walk, example};
use toolroom_scenario::{PATH, PRICE, PolicyRule, SPEED, Setting, SettingRange, Tunable, TuneRequest, WEAR};

/// Whether the rule of tool change is tuned.
const CHANGE: &str = "change";

/// Least and greatest value of a setting.
const fn range(setting: Setting, kind: &'static Kind) -> Key {
    Key::optional(setting.key(), Kind::List(kind), "Least and greatest value that may be tried")
}

/// Ranges of the settings of a policy.
pub(super) static RANGES: Form = Form {
    title: "tune",
    doc: "Ranges that tuning may not leave; a setting that is left out is tuned around its present value",
    keys: &[
        range(Setting::CuttingSpeed, &SPEED),
        range(Setting::SpeedFactor, &FACTOR),
        range(Setting::Price, &PRICE),
        range(Setting::PathPerEdge, &PATH),
        range(Setting::WearLimit, &WEAR),
        range(Setting::CuttingTime, &DURATION),
        range(Setting::Parts, &Kind::positive("1", "1", 1e6, "12")),
        Key::default(
            CHANGE,
            Kind::Flag,
            "false",
            "Whether edges may be changed by another rule as well: wear_limit, predicted and cutting_time are tried",
        ),
    ],
};

/// How all rules are tuned.
pub(super) static TUNE: Form = Form {
    title: "[tune]",
    doc: "How `toolroom compare` tunes the policies before it judges them, all with the same budget",
    keys: &[
        Key::default("objective", Kind::Name, "cost_per_part", "Key figure that is tuned for, as in kpi.csv"),
        Key::default(
            "budget",
            Kind::Count { min: 100, max: 1_000_000 },
            "600",
            "Simulated replications for every policy",
        ),
        Key::default(
            "seed",
            Kind::Count { min: 0, max: u64::MAX },
            "1001",
            "Seed of the tuning; that of [shop] judges",
        ),
        Key::optional("guard", Kind::Table(&GUARD), "Settings that are no rivals"),
        Key::default("indifference", SHARE, "0.1 %", "Differences of the objective that do not matter, relative"),
    ],
};

static GUARD: Form = Form {
    title: "guard",
    doc: "Greatest shares of the edges of lathes, one standard deviation on the safe side",
    keys: &[
        Key::default("collapse", SHARE, "2 %", "Edges that collapse thermally"),
        Key::optional("failure", SHARE, "Edges that are lost in cut; left out: any share"),
    ],
};

/// Whether and within what a policy is tuned.
pub(super) fn tunable(walk: &mut Walk, section: &Section<'_>, rule: &PolicyRule) -> Tunable {
    let Some(table) = walk.table(section, "tune") else {
        return if section.flag("tune") == Some(false) { Tunable::Given } else { Tunable::default() };
    };
    let change = table.flag(CHANGE) == Some(true);
    let settings = PolicyRule { tune: Tunable::Free { ranges: Vec::new(), change }, ..rule.clone() }.all_settings();
    let mut ranges = Vec::new();
    for setting in Setting::ALL.into_iter().filter(|setting| table.given(setting.key())) {
        if !settings.contains(&setting) {
            let applicable = settings.iter().map(|setting| setting.key()).collect::<Vec<_>>().join(", ");
            let case = format!("the rule of {}", section.path);
            walk.fault(table.span_of(setting.key()), Fault::NotApplicable { key: setting.key(), case, applicable });
        } else if let Some(range) = ends(walk, &table, setting) {
            ranges.push(range);
        }
    }
    Tunable::Free { ranges, change }
}

fn ends(walk: &mut Walk, table: &Section<'_>, setting: Setting) -> Option<SettingRange> {
    let key = setting.key();
    if matches!(table.got(key).map(|got| &got.value), Some(Value::Faulty)) {
        return None;
    }
    match table.numbers(key)?.as_slice() {
        &[low, high] if low < high => Some((setting, (low, high))),
        others => {
            let kind = RANGES.key(key).map(|key| key.kind);
            let one = if let Some(Kind::List(kind)) = kind { example(kind) } else { String::new() };
            let fault = Fault::WrongType {
                key: key.to_owned(),
                read: others.iter().map(|value| setting.shown(*value)).collect::<Vec<_>>().join(", "),
                expected: "the least value and then the greatest".to_owned(),
                example: format!("[{one}, …]"),
            };
            walk.fault(table.span_of(key), fault);
            None
        }
    }
}

/// The section `[tune]`; `None` where the file has none.
pub(super) fn request(walk: &mut Walk, root: &Section<'_>, seed: u64) -> Option<TuneRequest> {
    let section = walk.table(root, "tune")?;
    let tuning_seed = section.count("seed").unwrap_or_default();
    if tuning_seed == seed {
        let fault = Fault::Contradiction {
            first: "seed",
            first_value: tuning_seed.to_string(),
            second: "shop.seed",
            second_value: seed.to_string(),
            rule: "settings are judged on random numbers that they were not tuned on",
        };
        walk.fault(section.span_of("seed"), fault);
    }
    let guard = walk.table(&section, "guard");
    let left_out = TuneRequest::default();
    Some(TuneRequest {
        objective: section.text("objective").unwrap_or_default().to_owned(),
        budget: section.count32("budget"),
        seed: tuning_seed,
        collapse: guard.as_ref().map_or(left_out.collapse, |guard| guard.required("collapse")),
        failure: guard.as_ref().and_then(|guard| guard.si("failure")),
        indifference: section.required("indifference"),
    })
}
