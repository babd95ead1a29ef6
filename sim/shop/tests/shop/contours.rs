//! Mills around contours: times and wear as planned, form of the wall, limits of the machine.

use crate::scenarios::{self, jobs_at, operation, run, tool};
use proptest::prelude::*;
use std::sync::Arc;
use toolroom_contour::{ContourFile, FormError, Models, Pass, Planner, Setting};
use toolroom_cutting::Milling;
use toolroom_scenario::policies::ResolveError;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::policies::{ContourPlan, PlanError, PolicyError};
use toolroom_scenario::*;
use toolroom_shop::runlog::{ChangeReason, JobOutcome, LogEvent, RunLog};

const RK3: &str = include_str!("../../../../scenarios/contour/rk3.toml");
const MC1: &str = include_str!("../../../../scenarios/contour/mc1.toml");

const RULES: [ContourRule; 5] = [
    ContourRule::HandbookOneFeed,
    ContourRule::HandbookPerSection,
    ContourRule::BestConstant,
    ContourRule::Time,
    ContourRule::Cost,
];

/// The cutter of the contour files, whose edge forces double at 0.2 mm of wear.
fn mill() -> Milling {
    let mut mill = Milling::named("mill_t15k6_d32").unwrap();
    mill.force.flank_shear_stress = 104e6;
    mill.force.flank_pressure = 93.6e6;
    mill
}

/// One mill with all gears of the contour files that mills `passes` of a contour.
fn shop(contour: &str, passes: &[usize], rule: ContourRule, jobs: u32) -> Scenario {
    let mut shop = scenarios::scenario();
    shop.tools = vec![tool(scenarios::eternal())];
    shop.tools[0].process = ProcessModel::Milling(Arc::new(mill()));
    shop.tools[0].edge_cost = 16.0;
    shop.machines[0].speed_range = (0.01, 10.0);
    shop.machines[0].rate = 30.0 / 3600.0;
    shop.machines[0].tool_change_time = 300.0;
    let content = ContourFile::parse("contour.toml", contour, &[]).unwrap().content;
    let work = ContourWork::new(
        "contour",
        content,
        passes.to_vec(),
        ContourRule::HandbookOneFeed,
        &shop.tools[0],
        &shop.machines[0],
    );
    let work = Work::Contour(Arc::new(work.unwrap()));
    shop.parts[0].operations = vec![Operation { work, ..operation(&[0], &[]) }];
    shop.arrivals = vec![jobs_at(&[(0.0, jobs)])];
    shop.policies[0].contour = Some(rule);
    shop.horizon = 100_000.0;
    shop
}

fn plan(shop: &Scenario, pass: u32) -> ContourPlan {
    ResolvedPolicy::from_scenario(shop, 0).unwrap().contour(0, pass).unwrap().clone()
}

#[test]
fn a_pass_takes_the_time_that_is_published_for_it() {
    // Times in min of the reference example, finishing and roughing of the three-lobed hole.
    let golden = [
        (1, ContourRule::HandbookOneFeed, 0.5563),
        (1, ContourRule::Time, 0.5563 / 1.1464),
        (1, ContourRule::Cost, 0.5563 / 1.1307),
        (0, ContourRule::HandbookOneFeed, 0.5934),
        (0, ContourRule::Time, 0.5934 / 1.815),
    ];
    for (pass, rule, minutes) in golden {
        let log = run(&shop(RK3, &[pass], rule, 1));
        assert_eq!(log.passes.len(), 1, "one pass is one event, however many its sections");
        let time = log.passes[0].cutting_time / 60.0;
        assert!((time / minutes - 1.0).abs() < 3e-4, "{rule:?}: {time} min, published {minutes}");
        assert!((log.jobs[0].finish - log.passes[0].cutting_time).abs() < 1e-9);
    }
}

#[test]
fn without_scatter_the_cutter_wears_by_the_life_fractions_of_the_plan() {
    for (contour, rule) in [(RK3, ContourRule::HandbookOneFeed), (RK3, ContourRule::Cost), (MC1, ContourRule::Time)] {
        let shop = shop(contour, &[0, 1], rule, 40);
        let log = run(&shop);
        let fractions = plan(&shop, 0).life_fraction + plan(&shop, 1).life_fraction;
        let (limit, contrast) = (mill().life.wear_limit, mill().life.stage_contrast);
        let worn = log.passes.last().unwrap().flank_wear_end / limit;
        // The wear curve: life used at a share x of the limit is x + c (3 x² − 2 x³ − x).
        let used = worn + contrast * (3.0 * worn * worn - 2.0 * worn.powi(3) - worn);
        assert!((used / (40.0 * fractions) - 1.0).abs() < 1e-6, "{rule:?}: {used} of {}", 40.0 * fractions);
    }
}

#[test]
fn the_form_of_the_wall_is_that_of_the_planner_under_the_conditions_of_the_part() {
    for contour in [RK3, MC1] {
        let mut shop = shop(contour, &[1], ContourRule::Cost, 30);
        shop.tools[0].scatter = toolroom_wear::Scatter { piece_hardness: 0.05, ..toolroom_wear::Scatter::none() };
        let log = run(&shop);
        let file = ContourFile::parse("contour.toml", contour, &[]).unwrap().content;
        let plan = plan(&shop, 0);
        let settings: Vec<Setting> = plan
            .sections
            .iter()
            .map(|section| Setting {
                spindle_speed: section.cutting_speed / plan.cutter_radius,
                feed_per_tooth: section.feed_per_tooth,
            })
            .collect();
        let models = Models { form_error: FormError::Helical, ..file.models };
        let mut errors = Vec::new();
        for row in &log.passes {
            // The hardness of the part is drawn; the force at the end tells it.
            let plan_at = |hardness_ratio: f64| {
                let pass = Pass { flank_wear: row.flank_wear_end, hardness_ratio, ..*file.pass("finish").unwrap() };
                let planner = Planner::new(&file.contour, &file.parameters, &pass, &models).unwrap();
                planner.plan(&settings).unwrap()
            };
            let force = |hardness: f64| plan_at(hardness).sections.last().unwrap().evaluation.forces.tangential;
            let (mut low, mut high) = (0.7, 1.4);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                *(if force(middle) < row.cutting_force { &mut low } else { &mut high }) = middle;
            }
            let expected = plan_at(low).greatest_wall_error();
            let expected = if plan.corner_error > expected.abs() { plan.corner_error } else { expected };
            // The static stiffness of the set is rounded to six digits.
            assert!((row.size_error / expected - 1.0).abs() < 1e-5, "{} {expected}", row.size_error);
            errors.push(row.size_error);
        }
        if contour == RK3 {
            assert!(errors.iter().any(|error| (error - errors[0]).abs() > 1e-7), "hardness shows in the form");
        }
    }
}

#[test]
fn a_worn_cutter_leaves_the_tolerance_and_the_part_is_scrap() {
    let mut shop = shop(RK3, &[1], ContourRule::Time, 400);
    shop.parts[0].operations[0].size_tolerance = 65e-6;
    let log = run(&shop);
    let bad = |row: &toolroom_shop::runlog::PassRow| row.size_error.abs() > 65e-6;
    assert!(!bad(&log.passes[0]) && log.passes.iter().any(bad));
    for row in &log.passes {
        let outcome = log.jobs[row.job as usize].outcome;
        assert_eq!(outcome, if bad(row) { JobOutcome::OutOfTolerance } else { JobOutcome::Good });
    }
    // Changed early enough, no part is lost.
    shop.policies[0].tool_change = ToolChangeRule::WearLimit { limit: Some(0.05e-3) };
    let log = run(&shop);
    assert!(log.edges.iter().filter(|edge| edge.reason == ChangeReason::Rule).count() > 2);
    assert!(log.jobs.iter().all(|job| job.outcome == JobOutcome::Good));
}

#[test]
fn corners_take_their_time_and_show_in_the_form() {
    let with = |corners: &str| {
        let shipped = "policy = \"loop\", radius = \"2 mm\", tolerance = \"0.05 mm\"";
        assert!(MC1.contains(shipped));
        let contour = MC1.replace(shipped, corners);
        let shop = shop(&contour, &[1], ContourRule::Time, 1);
        let (plan, log) = (plan(&shop, 0), run(&shop));
        assert!((log.passes[0].cutting_time - plan.time()).abs() < 1e-9);
        assert!(log.passes[0].size_error.abs() >= plan.corner_error);
        (plan.corner_error, plan.idle_time)
    };
    let [(looped, long), (stopped, short), (slowed, shortest)] = [
        "policy = \"loop\", radius = \"2 mm\", tolerance = \"0.05 mm\"",
        "policy = \"exact_stop\"",
        "policy = \"slow_down\", tolerance = \"0.05 mm\"",
    ]
    .map(with);
    // Loops and stops meet the corner; slowing down cuts it by the tolerance that the file admits.
    assert_eq!((looped, stopped), (0.0, 0.0));
    assert!((slowed - 50e-6).abs() < 1e-12, "{slowed}");
    assert!(long > short && short > shortest && shortest > 0.0, "{long} {short} {shortest}");
}

#[test]
fn a_pass_that_is_interrupted_is_the_same_pass() {
    let whole = shop(MC1, &[0, 1], ContourRule::Cost, 6);
    let mut broken = whole.clone();
    broken.failures = vec![FailureMode {
        name: None,
        machine: 0,
        time_between: Distribution::Constant(7.77),
        time_to_repair: Distribution::Constant(50.0),
        clock: FailureClock::Busy,
        crew: None,
        part: Interruption::Resume,
    }];
    let (whole, broken) = (run(&whole), run(&broken));
    assert!(broken.events.iter().filter(|row| row.event == LogEvent::Failure).count() > 20);
    let rows = |log: &RunLog| -> Vec<[f64; 5]> {
        let row = |row: &toolroom_shop::runlog::PassRow| {
            [row.cutting_time, row.path, row.flank_wear_end * 1e3, row.size_error * 1e6, row.energy * 1e-3]
        };
        log.passes.iter().map(row).collect()
    };
    for (a, b) in rows(&whole).iter().zip(rows(&broken)) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6 * (1.0 + a.abs())), "{a:?} {b:?}");
    }
}

#[test]
fn a_contour_of_another_cutter_is_refused() {
    let mut other = shop(RK3, &[1], ContourRule::Time, 1);
    other.tools[0].process = ProcessModel::Milling(Arc::new(Milling::default())); // 12 mm
    let Err(ResolveError::Policy { source, .. }) = ResolvedPolicy::from_scenario(&other, 0) else { panic!() };
    assert!(source.to_string().contains("diameter in mm of 32, the tool has 12"), "{source}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    /// No plan leaves the range of the machine; where it has no gear there, that is said.
    #[test]
    fn no_plan_leaves_the_limits_of_the_machine(
        rule in 0..RULES.len(),
        low in 0.01..3.0f64,
        width in 0.0..3.0f64,
        finish: bool,
    ) {
        let mut shop = shop(RK3, &[usize::from(finish)], RULES[rule], 1);
        shop.machines[0].speed_range = (low, low + width);
        match ResolvedPolicy::from_scenario(&shop, 0) {
            Ok(resolved) => {
                for section in &resolved.contour(0, 0).unwrap().sections {
                    let speed = section.cutting_speed;
                    prop_assert!(low * (1.0 - 1e-9) <= speed && speed <= (low + width) * (1.0 + 1e-9), "{speed}");
                    prop_assert!(section.time > 0.0 && section.feed_per_tooth > 0.0);
                }
            }
            Err(ResolveError::Policy { source, .. }) => {
                let refused = matches!(
                    *source,
                    PolicyError::Contour(PlanError::Contour { .. })
                );
                prop_assert!(refused, "{source}");
            }
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        }
    }

    /// An allowance, hardness and edge as planned give the planned part, whatever the seed.
    #[test]
    fn no_scatter_is_neutral(seed in 0..1000u64, rule in 0..RULES.len()) {
        let mut none = shop(RK3, &[0, 1], RULES[rule], 3);
        let facts = |log: RunLog| log.passes.iter().map(|row| (row.end, row.flank_wear_end, row.size_error)).collect::<Vec<_>>();
        let reference = facts(run(&none));
        none.seed = seed;
        prop_assert_eq!(facts(run(&none)), reference);
    }
}
