//! Searches against complete enumeration, and how they behave at their limits.

use proptest::prelude::*;
use std::f64::consts::TAU;
use toolroom_contour::{
    Constraint, Contour, ContourError, CutterSide, EdgeLife, Models, Objective, Parameters, Pass, PathError, Planner,
    Point, Setting, Trace,
};

/// Four gears and eight feeds.
fn coarse() -> (Parameters, Pass) {
    let mut parameters = Parameters::default();
    parameters.machine.lowest_spindle_speed = 900.0 / 60.0 * TAU;
    let pass = Pass { highest_feed_per_tooth: 0.16e-3, feed_step: 0.02e-3, ..Pass::default() };
    (parameters, pass)
}

/// Line, hollow, line, bulge: all tangent.
fn wave(a: f64, b: f64, hollow: f64, bulge: f64) -> Contour {
    let mut trace = Trace::new(Point::default(), 0.0);
    trace.line(a).unwrap();
    trace.arc(hollow, -1.0).unwrap();
    trace.line(b).unwrap();
    trace.arc(bulge, 1.4).unwrap();
    trace.finish(CutterSide::Right, false).unwrap()
}

/// Time, edge life and feed of every admissible setting of a section.
fn options(planner: &Planner, i: usize) -> Vec<(Setting, f64, f64, f64)> {
    let mut options = Vec::new();
    for spindle_speed in planner.speeds() {
        for feed_per_tooth in planner.feeds() {
            let setting = Setting { spindle_speed: *spindle_speed, feed_per_tooth: *feed_per_tooth };
            let all = planner.plan(&[setting; 4]).unwrap();
            let section = &all.sections[i];
            if section.evaluation.ratios.admissible() {
                options.push((setting, section.time, section.life_fraction, section.evaluation.feed));
            }
        }
    }
    options
}

/// Every combination of options of four sections.
fn combinations(
    options: &[Vec<(Setting, f64, f64, f64)>; 4],
) -> impl Iterator<Item = [(Setting, f64, f64, f64); 4]> + '_ {
    options[0].iter().flat_map(move |a| {
        options[1]
            .iter()
            .flat_map(move |b| options[2].iter().flat_map(move |c| options[3].iter().map(move |d| [*a, *b, *c, *d])))
    })
}

fn changes(combination: &[(Setting, f64, f64, f64); 4]) -> f64 {
    combination.windows(2).filter(|pair| pair[0].0.spindle_speed != pair[1].0.spindle_speed).count() as f64
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, ..ProptestConfig::default() })]

    #[test]
    fn the_plan_is_that_of_complete_enumeration(
        a in 0.01..0.2f64, b in 0.005..0.1f64, hollow in 0.02..0.06f64, bulge in 0.01..0.06f64, switch in 0.0..1.0f64,
    ) {
        let (mut parameters, pass) = coarse();
        parameters.machine.speed_change_time = switch;
        let (contour, models) = (wave(a, b, hollow, bulge), Models::default());
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        let choices = [0, 1, 2, 3].map(|i| options(&planner, i));
        let (rate, price) = (parameters.economics.machine_rate, parameters.economics.edge_price());
        let (mut time, mut cost) = (f64::INFINITY, f64::INFINITY);
        for combination in combinations(&choices) {
            let t = combination.iter().map(|option| option.1).sum::<f64>() + switch * changes(&combination);
            let c = rate * t + price * combination.iter().map(|option| option.2).sum::<f64>();
            time = time.min(t);
            cost = cost.min(c);
        }
        prop_assert!((planner.optimal(Objective::Time).unwrap().time / time - 1.0).abs() < 1e-9);
        prop_assert!((planner.optimal(Objective::Cost).unwrap().cost / cost - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_plan_with_ramps_is_that_of_complete_enumeration(
        a in 0.002..0.02f64, b in 0.002..0.01f64, hollow in 0.02..0.06f64, bulge in 0.01..0.06f64,
        acceleration in 0.002..0.05f64,
    ) {
        let (mut parameters, pass) = coarse();
        parameters.machine.highest_acceleration = acceleration;
        let (contour, models) = (wave(a, b, hollow, bulge), Models::default());
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        let choices = [0, 1, 2, 3].map(|i| options(&planner, i));
        let lengths = [0, 1, 2, 3].map(|i| {
            let section = &contour.sections[i];
            section.length * contour.shape(section).centre_path_ratio(parameters.cutter.radius())
        });
        let mut least = f64::INFINITY;
        for combination in combinations(&choices) {
            let mut time = combination.iter().map(|option| option.1).sum::<f64>();
            let mut fits = true;
            for i in 0..3 {
                let (one, other) = (combination[i].3, combination[i + 1].3);
                let mut ramp = |from: f64, to: f64, room: f64| {
                    let (slow, fast) = (from.min(to), from.max(to));
                    fits &= (fast * fast - slow * slow) / (2.0 * acceleration) <= 0.5 * room;
                    (fast - slow).powi(2) / (2.0 * acceleration * fast)
                };
                if combination[i].0.spindle_speed == combination[i + 1].0.spindle_speed {
                    time += ramp(one, other, if one > other { lengths[i] } else { lengths[i + 1] });
                } else {
                    time += ramp(one, 0.0, lengths[i]) + ramp(0.0, other, lengths[i + 1]) + 2.0;
                }
            }
            if fits {
                least = least.min(time);
            }
        }
        match planner.optimal_with_ramps(Objective::Time) {
            Ok(plan) => prop_assert!((plan.time / least - 1.0).abs() < 1e-9, "{} {least}", plan.time),
            Err(error) => prop_assert!(least.is_infinite() && matches!(error, ContourError::NoRamp { .. }), "{error}"),
        }
    }

    #[test]
    fn the_plan_on_a_used_edge_is_that_of_complete_enumeration(
        a in 0.05..0.2f64, b in 0.05..0.1f64, hollow in 0.02..0.06f64, remaining in 0.0001..0.003f64, change in 1.0..20.0f64,
    ) {
        let (mut parameters, pass) = coarse();
        parameters.economics.edge_change_time = change;
        parameters.economics.edge_cost = 300.0;
        let (contour, models) = (wave(a, b, hollow, 0.02), Models { milling: toolroom_contour::Milling::Up, ..Models::default() });
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        let choices = [0, 1, 2, 3].map(|i| options(&planner, i));
        let mut least = f64::INFINITY;
        for combination in combinations(&choices) {
            // In time, a second change is never worth while here: a fresh edge lasts.
            let used: f64 = combination.iter().map(|option| option.2).sum();
            assert!(used < 1.0);
            let fits = used <= remaining + 1e-12;
            let time = combination.iter().map(|option| option.1).sum::<f64>() + 2.0 * changes(&combination);
            least = least.min(if fits { time } else { time + change });
        }
        let edge = EdgeLife { remaining, levels: 100_000 };
        let plan = planner.optimal_with_edge(Objective::Time, edge).unwrap();
        prop_assert!((plan.time / least - 1.0).abs() < 1e-9, "{} {least}", plan.time);
        // In cost, the place of the change decides how much of the edge is thrown away.
        let (rate, price) = (parameters.economics.machine_rate, parameters.economics.edge_price());
        let mut cheapest = f64::INFINITY;
        for combination in combinations(&choices) {
            let used = |sections: std::ops::Range<usize>| combination[sections].iter().map(|option| option.2).sum::<f64>();
            let time = combination.iter().map(|option| option.1).sum::<f64>() + 2.0 * changes(&combination);
            let cost = rate * time + price * used(0..4);
            let kept = if used(0..4) <= remaining + 1e-12 { cost } else { f64::INFINITY };
            let changed = (0..4).map(|i| remaining - used(0..i)).filter(|wasted| *wasted >= -1e-12);
            cheapest = changed.fold(cheapest.min(kept), |least, wasted| least.min(cost + price * wasted));
        }
        let plan = planner.optimal_with_edge(Objective::Cost, edge).unwrap();
        prop_assert!((plan.cost / cheapest - 1.0).abs() < 1e-9, "{} {cheapest}", plan.cost);
    }

    #[test]
    fn the_plan_with_ramps_on_a_used_edge_is_that_of_complete_enumeration(
        a in 0.002..0.02f64, b in 0.002..0.01f64, hollow in 0.02..0.06f64, remaining in 0.00001..0.0003f64,
        acceleration in 0.002..0.05f64, change in 0.1..3.0f64,
    ) {
        let (mut parameters, pass) = coarse();
        parameters.machine.highest_acceleration = acceleration;
        parameters.economics.edge_change_time = change;
        parameters.economics.edge_cost = 300.0;
        let contour = wave(a, b, hollow, 0.02);
        let models = Models { milling: toolroom_contour::Milling::Up, ..Models::default() };
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        let choices = [0, 1, 2, 3].map(|i| options(&planner, i));
        let lengths = [0, 1, 2, 3].map(|i| {
            let section = &contour.sections[i];
            section.length * contour.shape(section).centre_path_ratio(parameters.cutter.radius())
        });
        let (rate, price) = (parameters.economics.machine_rate, parameters.economics.edge_price());
        let (mut least, mut cheapest) = (f64::INFINITY, f64::INFINITY);
        for combination in combinations(&choices) {
            let used = |sections: std::ops::Range<usize>| combination[sections].iter().map(|option| option.2).sum::<f64>();
            // Before which section the edge is changed, 4 for nowhere: a fresh one lasts.
            for changed in 0..=4 {
                let lasts = if changed == 4 { used(0..4) } else { used(0..changed) } <= remaining + 1e-12;
                let (mut time, mut fits) = (combination.iter().map(|option| option.1).sum::<f64>(), lasts);
                for i in 0..3 {
                    let (one, other) = (combination[i].3, combination[i + 1].3);
                    let mut ramp = |from: f64, to: f64, room: f64| {
                        let (slow, fast) = (from.min(to), from.max(to));
                        fits &= (fast * fast - slow * slow) / (2.0 * acceleration) <= 0.5 * room;
                        (fast - slow).powi(2) / (2.0 * acceleration * fast)
                    };
                    let stays = combination[i].0.spindle_speed == combination[i + 1].0.spindle_speed;
                    if stays && changed != i + 1 {
                        time += ramp(one, other, if one > other { lengths[i] } else { lengths[i + 1] });
                    } else {
                        time += ramp(one, 0.0, lengths[i]) + ramp(0.0, other, lengths[i + 1]);
                        time += if stays { 0.0 } else { 2.0 };
                    }
                }
                if fits {
                    let wasted = if changed == 4 { 0.0 } else { remaining - used(0..changed) };
                    least = least.min(time + if changed == 4 { 0.0 } else { change });
                    cheapest = cheapest.min(rate * time + price * (used(0..4) + wasted));
                }
            }
        }
        let edge = EdgeLife { remaining, levels: 100_000 };
        match planner.optimal_with_ramps_and_edge(Objective::Time, edge) {
            Ok(plan) => {
                prop_assert!((plan.time / least - 1.0).abs() < 1e-9, "{} {least}", plan.time);
                let plan = planner.optimal_with_ramps_and_edge(Objective::Cost, edge).unwrap();
                prop_assert!((plan.cost / cheapest - 1.0).abs() < 1e-9, "{} {cheapest}", plan.cost);
            }
            Err(error) => prop_assert!(least.is_infinite() && matches!(error, ContourError::NoRamp { .. }), "{error}"),
        }
    }
}

#[test]
fn a_fresh_edge_leaves_the_plan_as_it_is() {
    let (parameters, pass, models) = (Parameters::default(), Pass::default(), Models::default());
    let contour = wave(0.1, 0.05, 0.03, 0.02);
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    for objective in [Objective::Time, Objective::Cost] {
        let with = planner.optimal_with_edge(objective, EdgeLife::default()).unwrap();
        assert_eq!(with, planner.optimal(objective).unwrap());
    }
}

#[test]
fn ramps_and_edge_together_are_each_alone_where_the_other_does_not_bind() {
    let (mut parameters, pass) = coarse();
    let contour = wave(0.1, 0.05, 0.03, 0.02);
    let models = Models::default();
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    for objective in [Objective::Time, Objective::Cost] {
        // More than the plan uses, less than the worst settings would.
        let used = planner.optimal_with_ramps(objective).unwrap().life_fraction;
        let edge = EdgeLife { remaining: 1.05 * used, levels: 1000 };
        let fresh = planner.optimal_with_ramps_and_edge(objective, edge).unwrap();
        let ramps = planner.optimal_with_ramps(objective).unwrap();
        assert!((fresh.time / ramps.time - 1.0).abs() < 1e-9 && (fresh.cost / ramps.cost - 1.0).abs() < 1e-9);
    }
    parameters.machine.highest_acceleration = 1e3;
    let used = EdgeLife { remaining: 3e-4, levels: 1000 };
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    let both = planner.optimal_with_ramps_and_edge(Objective::Cost, used).unwrap();
    let edge = planner.optimal_with_edge(Objective::Cost, used).unwrap();
    assert_eq!(both.edge_changes, edge.edge_changes);
    assert!((both.cost / edge.cost - 1.0).abs() < 1e-5, "{} {}", both.cost, edge.cost);
}

#[test]
fn a_spent_edge_is_changed_where_least_is_wasted() {
    let (parameters, pass, models) = (Parameters::default(), Pass::default(), Models::default());
    let contour = wave(0.1, 0.05, 0.03, 0.02);
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    let spent = planner.optimal_with_edge(Objective::Cost, EdgeLife { remaining: 0.0, levels: 64 }).unwrap();
    // Down milling with the cutter on the right runs the contour backwards.
    assert_eq!((spent.edge_changes.as_slice(), spent.wasted_life), (&[3][..], 0.0));
    assert!((spent.time - spent.edge_change_time - planner.optimal(Objective::Cost).unwrap().time).abs() < 1e-9);
}

#[test]
fn great_acceleration_tends_to_the_plan_without_ramps() {
    let (mut parameters, pass) = coarse();
    parameters.machine.highest_acceleration = 1e3;
    parameters.machine.speed_change_time = 1e3;
    let (contour, models) = (wave(0.1, 0.05, 0.03, 0.02), Models::default());
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    let (with, without) =
        (planner.optimal_with_ramps(Objective::Time).unwrap(), planner.optimal(Objective::Time).unwrap());
    assert!((with.time / without.time - 1.0).abs() < 1e-6);
    assert!(with.ramp_time > 0.0);
}

#[test]
fn the_front_runs_from_the_fastest_to_the_cheapest_plan() {
    let mut parameters = Parameters::default();
    parameters.economics.edge_cost = 60.0;
    parameters.machine.speed_change_time = 0.0;
    let (pass, models) = (Pass::default(), Models { path_error: PathError::Empirical, ..Models::default() });
    let contour = wave(0.1, 0.05, 0.03, 0.02);
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    let front = planner.pareto().unwrap();
    assert!(front.len() > 2, "{}", front.len());
    assert_eq!(front[0], planner.optimal(Objective::Time).unwrap());
    assert_eq!(front[front.len() - 1], planner.optimal(Objective::Cost).unwrap());
    let slopes: Vec<f64> =
        front.windows(2).map(|pair| (pair[1].cost - pair[0].cost) / (pair[1].time - pair[0].time)).collect();
    assert!(slopes.iter().all(|slope| *slope < 0.0));
    assert!(slopes.windows(2).all(|pair| pair[0] < pair[1] + 1e-12), "convex: {slopes:?}");
}

#[test]
fn an_empty_feasible_set_names_the_conflict() {
    let (parameters, models) = (Parameters::default(), Models::default());
    let contour = wave(0.1, 0.05, 0.03, 0.02);
    let conflict = |pass: &Pass, parameters: &Parameters| match Planner::new(&contour, parameters, pass, &models)
        .unwrap()
        .optimal(Objective::Time)
    {
        Err(ContourError::EmptyFeasibleSet { section, conflicting }) => (section, conflicting),
        other => panic!("{other:?}"),
    };
    // The edge force alone bends the cutter by more than this.
    let (section, alone) = conflict(&Pass { tolerance: 5e-6, ..Pass::default() }, &parameters);
    assert_eq!((section, alone), (0, vec![Constraint::Accuracy]));
    // A feed that the machine holds bends the cutter too much on the hollow section.
    let mut quick = parameters.clone();
    quick.machine.lowest_feed = 800e-3 / 60.0;
    let (section, both) = conflict(&Pass { tolerance: 0.033e-3, ..Pass::default() }, &quick);
    assert_eq!(section, 1);
    assert!(both.contains(&Constraint::Accuracy) && both.contains(&Constraint::LowestFeed), "{both:?}");
    let message = ContourError::EmptyFeasibleSet { section, conflicting: both }.to_string();
    assert!(message.contains("section 2") && message.contains("accuracy"), "{message}");
}

#[test]
fn the_active_constraint_refuses_the_next_feed() {
    let (parameters, pass, models) = (Parameters::default(), Pass::default(), Models::default());
    let contour = wave(0.1, 0.05, 0.03, 0.02);
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    let plan = planner.optimal(Objective::Time).unwrap();
    for (i, section) in plan.sections.iter().enumerate() {
        let more = Setting { feed_per_tooth: section.setting.feed_per_tooth + pass.feed_step, ..section.setting };
        let violated: Vec<Constraint> = planner.evaluate(i, more).unwrap().ratios.violated().collect();
        assert!(section.active.is_some_and(|active| violated.contains(&active)), "{i}: {:?}", section.active);
    }
}

#[test]
fn contradicting_or_impossible_input_is_refused() {
    let (parameters, pass, models) = (Parameters::default(), Pass::default(), Models::default());
    let tight = wave(0.1, 0.05, 0.015, 0.02);
    assert!(matches!(
        Planner::new(&tight, &parameters, &pass, &models),
        Err(ContourError::CutterTooLarge { section: 1, .. })
    ));
    let contour = wave(0.1, 0.05, 0.03, 0.02);
    let refused = |pass: Pass| Planner::new(&contour, &parameters, &pass, &models).map(|_| ()).unwrap_err();
    assert!(refused(Pass { allowance: f64::NAN, ..pass }).to_string().contains("allowance"));
    assert!(refused(Pass { lowest_feed_per_tooth: 1e-3, ..pass }).to_string().contains("contradict"));
    let mut gearless = parameters.clone();
    gearless.machine.lowest_spindle_speed = 2100.0 / 60.0 * TAU;
    gearless.machine.highest_spindle_speed = 2200.0 / 60.0 * TAU;
    assert_eq!(
        Planner::new(&contour, &gearless, &pass, &models).map(|_| ()).unwrap_err(),
        ContourError::NoSpindleSpeed
    );
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    assert!(matches!(planner.plan(&[]), Err(ContourError::SettingCount { settings: 0, sections: 4 })));
    assert_eq!(planner.evaluate(4, planner.optimal(Objective::Time).unwrap().sections[0].setting), None);
    let impossible = Pass { tolerance: 5e-6, ..pass };
    let planner = Planner::new(&contour, &parameters, &impossible, &models).unwrap();
    assert!(matches!(planner.handbook(), Err(ContourError::NoHandbookRegime { .. })));
    assert!(matches!(planner.best_constant(Objective::Time), Err(ContourError::NoCommonSetting { .. })));
}
