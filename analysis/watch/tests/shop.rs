//! A watch over the event log of a simulated shop.

use std::path::PathBuf;
use toolroom_gap::shop::after;
use toolroom_gap::{NominalModel, NominalProcess, Settings};
use toolroom_recording::simulated;
use toolroom_records::{RecordKind, Records};
use toolroom_scenario::{Distribution, Scenario};
use toolroom_watch::Watch;

const DAY: f64 = 86400.0;

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/gap/shop.toml")
}

/// Events of the shipped shop over some days, `changed` in what nobody says.
fn recorded(seed: u64, days: f64, changed: &dyn Fn(&mut Scenario)) -> Records {
    let mut scenario = toolroom_scenario_file::read(&path(), &[]).expect("the shipped scenario").scenario;
    (scenario.seed, scenario.horizon) = (seed, days * DAY);
    changed(&mut scenario);
    let log = toolroom_shop::run(&scenario, 0, 0).expect("it runs");
    let all = simulated(&scenario, &log, &|_, channel| Settings::default().sensor(channel)).expect("records");
    all.into_iter().find(|records| records.kind == RecordKind::Shop).expect("events")
}

#[test]
fn handling_that_takes_longer_is_seen_with_its_date_and_nothing_before() {
    let model = NominalModel::read(&path(), &[]).expect("the shipped model");
    let NominalProcess::Shop(shop) = &model.process else { panic!("a shop") };
    let before = recorded(5, 56.0, &|_| {});
    let mut watch = Watch::new("model");
    let calm = watch.look_at(&model, &before, None, 0.2).expect("complete blocks");
    assert!(calm.alarms.is_empty(), "{}", calm.text());
    let slower = |scenario: &mut Scenario| {
        let load = Distribution::Lognormal { mean: 52.0, cv: 0.2 };
        scenario.machines.iter_mut().for_each(|machine| machine.load_time = load.clone());
    };
    // Behind the first log by whole weeks: from day 63 on.
    let later = after(shop, &before, recorded(6, 28.0, &slower));
    let all = before.followed_by(&later);
    let look = watch.look_at(&model, &all, None, 0.2).expect("complete blocks");
    let alarm = look.alarms.iter().map(|(alarm, _)| alarm).find(|alarm| alarm.stream.starts_with("handling_time"));
    let alarm = alarm.unwrap_or_else(|| panic!("{}", look.text()));
    assert!(alarm.span[0] <= 63.0 * DAY && 63.0 * DAY <= alarm.span[1], "{alarm:?}");
    assert!(look.alarms.iter().all(|(alarm, _)| alarm.time >= 63.0 * DAY), "{}", look.text());
    let again = watch.look_at(&model, &all, None, 0.2).expect("complete blocks");
    assert!(again.alarms.is_empty(), "the same rows: {}", again.text());
}
