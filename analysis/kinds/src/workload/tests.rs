//! Loads and dates against those computed independently.

use super::*;
use std::path::Path;
use toolroom_scenario_file::{ScenarioFile, read};

fn shipped(name: &str, set: &[&str]) -> ScenarioFile {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/shop").join(name);
    let set: Vec<String> = set.iter().map(|each| (*each).to_owned()).collect();
    read(&path, &set).expect("a shipped scenario")
}

#[test]
fn load_and_earliest_finish_are_those_computed_independently() {
    let found = workload(&shipped("orders.toml", &[]).scenario);
    // Turning: 320 + 360 + 300 + 240 + 480 + 960 min on two lathes that work eight weekdays of 8 h and 4 h of overtime.
    let lathes = &found.loads[0];
    assert_eq!((lathes.name.as_str(), lathes.work, lathes.capacity), ("T1 + T2", 2660.0 * 60.0, 136.0 * 3600.0));
    assert_eq!(lathes.setup, (2.0 * 30.0 + 4.0 * 45.0) * 60.0);
    // O6: turned until Thu 14:00, washed Sat 06:00 to 08:40, measured Tue 06:00 to 12:40.
    assert_eq!(found.warnings.len(), 1, "{:?}", found.warnings);
    assert!(found.warnings[0].message.starts_with("order O6 cannot be finished before 2026-04-07 12:40"), "{found:?}");
}

#[test]
fn jobs_that_replace_others_are_no_load_of_nothing() {
    let found = workload(&shipped("line.toml", &[]).scenario);
    assert!(found.loads.iter().all(|load| load.endless), "{found:?}");
    let (text, (_, json)) = (found.text(), found.json());
    assert!(text.contains("   any\n") && !text.contains("0 %"), "{text}");
    assert!(json[0]["load"].is_null() && json[0]["unlimited_demand"] == true, "{json}");
    let orders = workload(&shipped("orders.toml", &[]).scenario);
    assert!(!orders.text().contains("any") && orders.json().1[0]["load"].as_f64().is_some());
}

#[test]
fn rework_and_batches_count_in_the_load() {
    // A Jackson network: 3 jobs an hour, 15 % sent back to the first and 5 % to the second station.
    let found = workload(&shipped("rework.toml", &[]).scenario);
    let shares: Vec<f64> = found.loads.iter().map(Load::share).collect();
    for (share, exact) in shares.iter().zip([0.7125, 0.625, 0.25]) {
        assert!((share - exact).abs() < 1e-9, "{shares:?}");
    }
    // Six pieces share a time: 3.6 an hour of 45 min and 2.4 of an hour make 5.1 h of work in six hours.
    let found = workload(&shipped("furnace.toml", &[]).scenario);
    assert_eq!(found.loads[1].name, "furnace");
    assert!((found.loads[1].share() - (3.6 * 0.75 + 2.4) / 6.0).abs() < 1e-9);
}

#[test]
fn an_overload_is_told_for_the_horizon_and_for_the_dates_within() {
    let slow = |time: &str| {
        let change = format!("part.shaft.operation.measure.work=\"{time}\"");
        workload(&shipped("orders.toml", &[&change]).scenario).warnings
    };
    // 70 shafts of 2 h are more than the CMM works in two weeks.
    assert!(slow("2 h").iter().any(|told| told.message.starts_with("C is overloaded: 15")), "{:?}", slow("2 h"));
    // Of 30 min: O4 needs 15 h and the rings of O2 3 h, due on Tuesday 14:00; the CMM works 24 h by then. With O1
    // and O3 it is 40 h by Wednesday 14:00, and the CMM works 40 h: 2 + 3 + 20 + 15 = 40.08 h are more.
    let told = slow("30 min");
    assert!(
        told.iter().any(|each| each.message.starts_with("C cannot do in time what is due until 2026-04-01 14:00")),
        "{told:?}"
    );
}

#[test]
fn a_skill_is_a_station_and_sources_count_by_their_rates() {
    let people = workload(&shipped("operators.toml", &[]).scenario);
    let setter = people.loads.iter().find(|load| load.name == "skill setup").expect("the setter");
    // From small to large 20 min, from large to small 45 min; the day has one shift of 8 h.
    assert_eq!((setter.setup, setter.capacity), (65.0 * 60.0, 8.0 * 3600.0));
    let queue = workload(&shipped("queue.toml", &[]).scenario);
    assert!((queue.loads[0].share() - 0.8).abs() < 1e-9 && queue.warnings.is_empty(), "{queue:?}");
}

#[test]
fn a_machine_to_which_one_group_comes_is_set_up_no_more() {
    let text = "schema = 1\n[shop]\nname = \"one\"\nhorizon = \"200 h\"\n[[machine]]\nname = \"L\"\nprocess = \"plain\"\n\
                setup_time = \"25 min\"\n[[part]]\nname = \"shaft\"\n[[part.operation]]\nname = \"turn\"\nmachines = \"L\"\n\
                work = \"3 min\"\n[[arrivals]]\npart = \"shaft\"\npattern = \"poisson\"\nrate = \"10 1/h\"\n";
    let file = toolroom_scenario_file::parse("one.toml", text, &[]).expect("a scenario");
    let found = workload(&file.scenario);
    assert_eq!((found.loads[0].setup, found.loads[0].work), (0.0, 200.0 * 10.0 * 180.0));
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
}
