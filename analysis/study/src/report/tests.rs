use super::*;
use crate::fixture;
use crate::study::{StudyOptions, study_with};
use std::sync::atomic::AtomicBool;
use toolroom_shop::runlog::RunLog;

fn html(scenario: &Scenario, policies: usize, log: &(dyn Fn() -> RunLog + Sync)) -> String {
    let mut options = StudyOptions { replications: 4, ..StudyOptions::of(scenario) };
    options.policies.truncate(policies);
    let simulate = |_: usize, _: u32| Ok(log());
    let study = study_with(scenario, &options, None, &|_| {}, &AtomicBool::new(false), &simulate).expect("a study");
    let info =
        RunInfo { version: "0.1.0".to_owned(), reproduce: "toolroom compare x.toml".to_owned(), ..RunInfo::default() };
    report(scenario, &study, &Comparison::new(scenario, &study), &info).html()
}

#[test]
fn every_picture_is_there_and_well_formed() {
    let page = html(&fixture::scenario(), 2, &fixture::log);
    for words in [
        "Cost / part against constant",
        "adaptive against constant",
        "Cutting speed over the life of one edge",
        "Wear of every edge: constant",
        "Wear of every edge: adaptive",
        "Tool life",
        "One shift: adaptive",
        "State times: constant",
        "Key figures",
        "Amdahl",
        "wear limit of insert",
        "toolroom compare x.toml",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let document = page.trim_start_matches("<!DOCTYPE html>");
    roxmltree::Document::parse(document).expect("well-formed");
    assert!(!page.contains("NaN"), "no number that is none");
}

#[test]
fn names_of_the_user_are_escaped() {
    let mut scenario = fixture::scenario();
    scenario.title = "<script>alert(1)</script>".to_owned();
    scenario.policies[0].name = "a<b>&\"c\"".to_owned();
    scenario.machines[0].name = "<L1>".to_owned();
    let page = html(&scenario, 2, &fixture::log);
    assert!(!page.contains("<script>") && !page.contains("a<b>") && !page.contains("<L1>"));
    roxmltree::Document::parse(page.trim_start_matches("<!DOCTYPE html>")).expect("well-formed");
}

#[test]
fn an_empty_shop_and_a_single_policy_have_reports() {
    let empty = || RunLog { horizon: 3600.0, ..RunLog::default() };
    for policies in [1, 2] {
        let page = html(&fixture::scenario(), policies, &empty);
        assert!(page.contains("Key figures") && !page.contains("NaN"));
        assert!(!page.contains("Cutting time per edge used"), "only key figures that have a value are explained");
        assert_eq!(page.contains("The decision compares"), policies == 2);
        let page = html(&fixture::scenario(), policies, &fixture::log);
        assert_eq!(page.contains("Which policy is better"), policies == 2);
    }
}

#[test]
fn lobes_carry_the_passes_of_the_policies_by_their_margin() {
    use toolroom_shop::runlog::{EventRow, LogEvent, PassRow};
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/chatter-policies.toml");
    let scenario = toolroom_scenario_file::read(std::path::Path::new(path), &[]).expect("shipped").scenario;
    let pass = |start: f64, stability_margin: f64| PassRow {
        speed_start: 200.0 / 60.0,
        speed_end: 200.0 / 60.0,
        depth_of_cut: 0.55e-3,
        stability_margin,
        chatter_time: if stability_margin < 0.0 { 60.0 } else { 0.0 },
        ..fixture::pass(0, 0, 0, 0, 0, start, start + 120.0)
    };
    let log = || {
        let onset =
            EventRow { time: 4000.0, event: LogEvent::ChatterOnset, machine: Some(0), job: Some(0), edge: Some(0) };
        RunLog {
            passes: vec![pass(3700.0, 0.5), pass(3900.0, 0.05), pass(4100.0, -0.1)],
            events: vec![onset],
            horizon: scenario.horizon,
            warm_up: scenario.warm_up,
            ..fixture::log()
        }
    };
    let page = html(&scenario, 2, &log);
    for words in [
        "Stability lobes: L1, insert",
        "nominal limit, new edge",
        "least limit in the run",
        "constant: unstable",
        "best lobe: unstable",
        // 200 m/min at 40 mm; three passes, of which a sixth chatters.
        "<td>1592</td>",
        "<td>−10.0</td>",
        "<td>16.7</td>",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("Stability lobes: L2"), "nothing was cut on L2");
    roxmltree::Document::parse(page.trim_start_matches("<!DOCTYPE html>")).expect("well-formed");
    // Without a structure there is nothing to say.
    assert!(!html(&fixture::scenario(), 2, &fixture::log).contains("Stability of the cuts"));
}
