//! The answers of a small order table, and what they are made of.

use super::*;
use crate::study::{StudyOptions, run_study};
use std::sync::atomic::AtomicBool;
use toolroom_scenario_file::read;

fn shipped(changes: &[&str]) -> Scenario {
    let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/shop/orders.toml");
    read(file.as_ref(), &changes).unwrap_or_else(|error| panic!("{error}")).scenario
}

fn study(scenario: &Scenario) -> crate::study::Study {
    run_study(scenario, &StudyOptions::of(scenario), None, &|_| {}, &AtomicBool::new(false)).expect("a study")
}

#[test]
fn late_orders_stand_first_with_their_probability() {
    let scenario = shipped(&["shop.replications=3"]);
    let all = answers(&scenario, &study(&scenario), 0).expect("orders");
    let first: Vec<(&str, f64)> =
        all.orders.iter().map(|answer| (scenario.orders[answer.order].id.as_str(), answer.share)).collect();
    assert_eq!(first[..3], [("O4", 0.0), ("O6", 0.0), ("O2", 1.0)]);
    assert_eq!(all.orders[0].tardiness, 495.0 * 60.0);
    assert_eq!(all.orders[0].quantiles[2].shown(&scenario), "2026-03-31 22:15");
}

#[test]
fn an_order_that_is_not_finished_is_late_after_the_horizon() {
    let scenario = shipped(&["shop.horizon=\"1 week\""]);
    let all = answers(&scenario, &study(&scenario), 0).expect("orders");
    let last = all.orders.iter().find(|answer| scenario.orders[answer.order].id == "O6").expect("the order");
    assert_eq!((last.unfinished, last.on_time, last.mean.is_nan()), (1, 0, true));
    assert_eq!(last.quantiles[0].shown(&scenario), "after 2026-04-06 00:00");
}

#[test]
fn the_times_of_a_week_add_up_to_its_planned_time() {
    let scenario = shipped(&["dispatch.rule=edd"]);
    let all = answers(&scenario, &study(&scenario), 0).expect("orders");
    assert_eq!(
        Figures::of(&scenario).weeks.iter().map(|week| week.name.as_str()).collect::<Vec<_>>(),
        ["2026-W14", "2026-W15"]
    );
    for answer in &all.loads {
        let spent: f64 = LoadKind::ALL[1..].iter().map(|kind| answer.mean(*kind)).sum();
        assert!((spent - answer.mean(LoadKind::PlannedBusy)).abs() < 1e-6, "{answer:?}");
    }
    // Monday to Thursday and four hours on Saturday.
    assert_eq!(all.loads[0].mean(LoadKind::PlannedBusy), 36.0 * 3600.0);
}

#[test]
fn waits_and_lengths_agree_by_littles_law() {
    let scenario = shipped(&[]);
    let all = answers(&scenario, &study(&scenario), 0).expect("orders");
    for answer in &all.queues {
        // Everything that waits is begun before the horizon: six orders, or four at the washer.
        let jobs = if answer.machines == [2] { 4.0 } else { 6.0 };
        assert!((answer.length * scenario.horizon - jobs * answer.wait[0]).abs() < 1e-6, "{answer:?}");
        assert!((answer.total - jobs * answer.wait[0]).abs() < 1e-6, "{answer:?}");
    }
    let intervals = [(0.0, 2.0), (1.0, 3.0), (2.0, 4.0), (5.0, 5.0)];
    // Two wait for two units of time, one for two more, nobody for the rest.
    assert_eq!(waits::lengths(&intervals, 10.0), (2, 2));
    assert_eq!(waits::lengths(&intervals, 41.0), (2, 1));
    assert_eq!(waits::lengths(&intervals, 81.0), (2, 0));
    assert_eq!(waits::lengths(&[], 10.0), (0, 0));
}

/// By hand: two orders of 10 and 30 min at A, then 20 min a piece at B, all there from the start; A begins with the first.
#[test]
fn an_order_waits_longest_where_it_waits_longest_and_stock_goes_down_as_work_ends() {
    let text = "schema = 1\n[shop]\nname = \"w\"\nhorizon = \"3 h\"\nreplications = 2\n\
        [[machine]]\nname = \"A\"\nprocess = \"plain\"\n[[machine]]\nname = \"B\"\nprocess = \"plain\"\n\
        [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"first\"\nmachines = \"A\"\nwork = \"10 min\"\n\
        [[part.operation]]\nname = \"then\"\nmachines = \"B\"\nwork = \"20 min\"\n\
        [[order]]\nid = \"x\"\npart = \"p\"\nquantity = 3\n[[order]]\nid = \"y\"\npart = \"p\"\nquantity = 2\n\
        [[order]]\nid = \"z\"\npart = \"p\"\nrelease = \"2 h\"\n";
    let scenario = toolroom_scenario_file::parse("w.toml", text, &[]).expect("a scenario").scenario;
    let all = answers(&scenario, &study(&scenario), 0).expect("orders");
    let longest = |id: &str| {
        let answer = all.orders.iter().find(|answer| scenario.orders[answer.order].id == id).expect("the order");
        answer.longest.map(|own| (all.queues[own.station].machines.clone(), own.replications, own.wait / 60.0))
    };
    // y waits 30 min at A (0 to 30) and 40 min at B (50 to 90, when x ends); z waits 10 min at B (130 is the end of y).
    assert_eq!(longest("x"), None);
    assert_eq!(longest("y"), Some((vec![1], 2, 40.0)));
    assert_eq!(longest("z"), None);
    let at = |minutes: f64| all.wip.iter().find(|own| own.time == 60.0 * minutes).map(|own| (own.orders, own.work));
    let of = |orders: f64, minutes: f64| Some(([orders; 3], [60.0 * minutes; 3]));
    // 150 min of work at the start; A ends x at 30 and y at 50, B ends x at 90 and y at 130.
    assert_eq!(at(0.0), of(2.0, 150.0));
    assert_eq!(at(29.0), of(2.0, 150.0));
    assert_eq!(at(30.0), of(2.0, 120.0));
    assert_eq!(at(89.0), of(2.0, 100.0));
    assert_eq!(at(90.0), of(1.0, 40.0));
    assert_eq!(at(120.0), of(2.0, 70.0));
    assert_eq!(at(130.0), of(1.0, 20.0));
    assert_eq!(at(150.0), of(0.0, 0.0));
}

/// Pieces that an inspection sends back are stock of their operation again, and those that are scrapped none.
#[test]
fn stock_of_work_is_never_lost_by_inspections() {
    let text = "schema = 1\n[shop]\nname = \"w\"\nhorizon = \"3 h\"\nreplications = 3\n\
        [[machine]]\nname = \"A\"\nprocess = \"plain\"\n[[machine]]\nname = \"B\"\nprocess = \"plain\"\n\
        [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"first\"\nmachines = \"A\"\nwork = \"2 min\"\n\
        [[part.operation]]\nname = \"then\"\nmachines = \"B\"\nwork = \"1 min\"\noutcomes_per = \"part\"\n\
        outcomes = [{ share = 0.3, go = \"first\" }, { share = 0.1, scrap = true }]\n\
        [[order]]\nid = \"x\"\npart = \"p\"\nquantity = 20\n";
    let scenario = toolroom_scenario_file::parse("w.toml", text, &[]).expect("a scenario").scenario;
    let all = answers(&scenario, &study(&scenario), 0).expect("orders");
    // Forty minutes at A, twenty at B; then some go back.
    let work: Vec<f64> = all.wip.iter().map(|own| own.work[0] / 60.0).collect();
    assert_eq!((work[0], work[39], work[40], work[59]), (60.0, 60.0, 20.0, 20.0));
    assert!(work[60] > 0.0 && work[60] < 60.0 && (work[60] - work[60].round()).abs() < 1.0, "{}", work[60]);
    assert_eq!(work.last(), Some(&0.0));
}

#[test]
fn the_schedule_of_a_run_is_followed_and_compared() {
    let first = shipped(&[]);
    let study_of_first = study(&first);
    let mut table = Vec::new();
    write_sequences(&first, &study_of_first.first_logs[0], &mut table).unwrap();
    let text = String::from_utf8(table).unwrap();
    assert!(
        text.starts_with("order,operation,machine,position,start,end\nO1,turn,T1,1,2026-03-30 06:00:00,"),
        "{text}"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plan.csv");
    std::fs::write(&file, text).unwrap();
    let followed = shipped(&[&format!("tables.schedule={:?}", file.display().to_string()), "dispatch.rule=edd"]);
    let again = study(&followed);
    // The same run whatever the rule, event for event.
    assert_eq!(again.first_logs[0].jobs, study_of_first.first_logs[0].jobs);
    let mut plan = Vec::new();
    write_plan(&followed, &again, &mut plan).unwrap();
    let plan = String::from_utf8(plan).unwrap();
    let row = plan.lines().find(|row| row.contains(",O6,turn,")).unwrap();
    assert!(row.ends_with(",0,0,0") || row.ends_with(",0.00,0.00,0"), "{row}");
    assert!(
        plan_line(&followed, &again).contains("begin 0.0 min after their planned start"),
        "{}",
        plan_line(&followed, &again)
    );
    assert!(plan_line(&first, &study_of_first).is_empty());
}

#[test]
fn people_are_loaded_by_their_shares_and_their_ways() {
    let text = "schema = 1\n[shop]\nname = \"people\"\nhorizon = \"2 h\"\nreplications = 2\n\
        [[calendar]]\nname = \"c\"\nshift = [{ start = \"0 min\", end = \"90 min\" }]\n\
        [[machine]]\nname = \"M\"\ncount = 2\nprocess = \"plain\"\nlocation = \"hall\"\nsetup_at_start = \"\"\n\
        [[operator]]\nname = \"tender\"\nskills = [\"set\", \"tend\"]\ncalendar = \"c\"\n\
        walk = { locations = [\"hall\"], times = [[\"2 min\"]] }\n[[operator]]\nname = \"idler\"\nskills = [\"none\"]\n\
        [[part]]\nname = \"p\"\n[[part.operation]]\nname = \"do\"\nmachines = \"M\"\nwork = \"20 min\"\nsetup_time = \"10 min\"\n\
        operator = { setup = \"set\", run = { skill = \"tend\", share = 0.5 } }\n\
        [[order]]\nid = \"a\"\npart = \"p\"\n[[order]]\nid = \"b\"\npart = \"p\"\n";
    let scenario = toolroom_scenario_file::parse("people.toml", text, &[]).expect("a scenario").scenario;
    let study = study(&scenario);
    let all = answers(&scenario, &study, 0).expect("orders");
    let of = |resource: usize, kind: LoadKind| all.loads[resource].mean(kind) / 60.0;
    // Two ways of two minutes, two setups of ten, half of twice twenty minutes of work; the rest of ninety is free.
    let kinds = [LoadKind::PlannedBusy, LoadKind::Delay, LoadKind::Setup, LoadKind::Production, LoadKind::Free];
    assert_eq!(kinds.map(|kind| of(2, kind)), [90.0, 4.0, 20.0, 20.0, 46.0]);
    assert_eq!(kinds.map(|kind| of(3, kind)), [120.0, 0.0, 0.0, 0.0, 120.0]);
    let mut table = Vec::new();
    write("load.csv", &scenario, &study, &mut table).expect("written");
    let table = String::from_utf8(table).expect("text");
    assert!(table.starts_with("policy,resource,week,load,load_p90,planned_busy [h]"), "{table}");
    let row = table.lines().find_map(|line| line.strip_prefix("programmed,tender,week 1,")).expect("the row");
    let numbers = row.split(',').take(6).map(|number| number.parse::<f64>().expect("a number"));
    for (number, due) in numbers.zip([22.0 / 45.0, 22.0 / 45.0, 1.5, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 15.0]) {
        assert!((number - due).abs() < 1e-12, "{row}");
    }
}

#[test]
fn times_without_a_date_are_told_to_the_second() {
    let scenario = Scenario { start: None, ..shipped(&[]) };
    for (seconds, text) in [(0.0, "0.00 h"), (2839.0, "0.7886 h"), (3132.4, "0.87 h"), (3150.0, "0.875 h")] {
        assert_eq!(shown(&scenario, seconds), text);
        // Read again it is that second.
        let read: f64 = text.trim_end_matches(" h").parse().unwrap();
        assert_eq!((read * 3600.0).round(), seconds.round());
    }
}
