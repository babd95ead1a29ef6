//! Mills that run part programs: time as the machine takes it, every tool worn by its own engagement.

use std::path::{Path, PathBuf};
use toolroom_drives::{Machine, times};
use toolroom_program::{Control, Program};
use toolroom_scenario::{ProcessModel, ProgramWork, Scenario, Work};
use toolroom_shop::runlog::{ChangeReason, RunLog};
use toolroom_stock::{Follower, Setup};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

fn shop(overrides: &[&str]) -> (Scenario, RunLog) {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let scenario = toolroom_scenario_file::read(&folder().join("part-program.toml"), &overrides)
        .expect("a shipped scenario")
        .scenario;
    let log = toolroom_shop::run(&scenario, 0, 0).expect("it runs");
    (scenario, log)
}

fn work(scenario: &Scenario) -> &ProgramWork {
    match &scenario.parts[0].operations[0].work {
        Work::Program(work) => work,
        other => panic!("{other:?}"),
    }
}

/// Cutters and work without scatter, wear in proportion to the share of a life, nothing changed, one machine.
const PLAIN: [&str; 5] = [
    "machine.M.count=1",
    "tool.facing.scatter=none",
    "tool.pocket.scatter=none",
    "tool.facing.parameters.life.stage_contrast=0",
    "tool.pocket.parameters.life.stage_contrast=0",
];

#[test]
fn an_operation_takes_the_time_of_its_part_program_on_the_machine() {
    let (scenario, log) = shop(&PLAIN);
    let path = folder().join("programs/plate.nc");
    let text = std::fs::read_to_string(&path).expect("a program");
    let machine = Machine::preset("generic-vmc").expect("a preset");
    let program = Program::read(&text, &machine.control.for_file(&path, None)).expect("a program");
    let nominal: f64 = times(&program, &machine.drives).iter().sum();
    assert!((work(&scenario).time() - nominal).abs() < 1e-9 * nominal, "{} {nominal}", work(&scenario).time());
    assert!(
        (times(&program, &Default::default()).iter().sum::<f64>() - nominal).abs() > 1.0,
        "the machine adds something"
    );
    let whole: Vec<f64> = (0..log.jobs.len() as u32)
        .map(|job| log.passes.iter().filter(|pass| pass.job == job).map(|pass| pass.cutting_time).collect::<Vec<_>>())
        .filter(|times| times.len() == work(&scenario).calls.len())
        .map(|times| times.iter().sum())
        .collect();
    assert!(whole.len() > 50, "{}", whole.len());
    // The last part of the run is cut short by its end.
    for time in &whole[..whole.len() - 1] {
        assert!((time - nominal).abs() < 1e-9 * nominal, "{time} {nominal}");
    }
}

#[test]
fn every_tool_wears_by_the_engagement_of_its_own_motions() {
    let (scenario, log) = shop(&PLAIN);
    let setup = Setup::read(&folder().join("programs/plate-setup.toml"), &[]).expect("a setup").content;
    let path = folder().join("programs/plate.nc");
    let text = std::fs::read_to_string(&path).expect("a program");
    // Share of a life that a run uses by the handbook, motion by motion, at programmed feeds.
    let mut follower = Follower::new(&setup);
    let mut shares = std::collections::BTreeMap::<u32, f64>::new();
    for event in toolroom_program::Run::new(&text, &Control::default().for_file(&path, None)).expect("a program") {
        use toolroom_program::EventKind::{Home, Motion, Spindle, ToolChange};
        let kind = event.expect("a program").kind;
        if let Motion(motion) = kind {
            let cut = follower.motion(&motion).expect("a tool");
            *shares.entry(follower.tool().unwrap_or(0)).or_default() += cut.and_then(|cut| cut.wear).unwrap_or(0.0);
        } else if let ToolChange(number) = kind {
            follower.change(number);
        } else if let Spindle { speed, sense } = kind {
            follower.spindle(speed, sense);
        } else if let Home(axes) = kind {
            follower.home(axes[2]);
        }
    }
    for (index, number, diameter) in [(0, 1, 20.0_f64), (1, 2, 10.0)] {
        let ProcessModel::Milling(milling) = &scenario.tools[index].process else { panic!("a mill") };
        let passes: Vec<_> = log
            .passes
            .iter()
            .filter(|pass| {
                log.edges[pass.edge as usize].tool as usize == index && pass.flank_wear_end > pass.flank_wear_start
            })
            .collect();
        assert!(passes.len() > 50, "{}", passes.len());
        let growth = (passes[10].flank_wear_end - passes[10].flank_wear_start) / milling.life.wear_limit;
        // The life of the set is stated for its own cutter of 32 mm; the handbook's grows with the diameter. Drives that have
        // to accelerate lower the feed, and with it the wear of a second, but lengthen the cut.
        let handbook = shares[&number] * (diameter / 32.0).powf(0.44 / 0.37);
        assert!((growth / handbook - 1.0).abs() < 0.05, "T{number}: {growth} {handbook}");
        for pass in &passes[..20] {
            let again = (pass.flank_wear_end - pass.flank_wear_start) / milling.life.wear_limit;
            assert!((again / growth - 1.0).abs() < 1e-9, "the same wear for every part");
            assert!(pass.engaged_time > 0.0 && pass.engaged_time < pass.cutting_time);
        }
    }
    let time =
        |tool: u32| -> f64 { log.edges.iter().filter(|edge| edge.tool == tool).map(|edge| edge.cutting_time).sum() };
    let engaged = |tool: u32| -> f64 {
        log.passes.iter().filter(|pass| log.edges[pass.edge as usize].tool == tool).map(|pass| pass.engaged_time).sum()
    };
    for tool in [0, 1] {
        assert!((time(tool) / engaged(tool) - 1.0).abs() < 1e-9, "the life of an edge is its time in material");
    }
}

#[test]
fn worn_tools_of_a_part_program_are_changed_one_by_one() {
    let (_, log) = shop(&["machine.M.count=1", "tool.pocket.parameters.life.reference_life=10 min"]);
    let changed =
        |tool: u32| log.edges.iter().filter(|edge| edge.tool == tool && edge.reason != ChangeReason::EndOfRun).count();
    assert!(changed(1) > 3 * changed(0).max(1), "{} {}", changed(0), changed(1));
    // An edge counts a part when no later call of the program needs it.
    let parts: u32 = log.edges.iter().filter(|edge| edge.tool == 0).map(|edge| edge.parts).sum();
    let faced = log.passes.iter().filter(|pass| pass.pass == 0 && pass.end < log.horizon).count();
    assert!(parts.abs_diff(faced as u32) <= 1, "{parts} {faced}");
}
