//! Plans, baselines and how their gains move.

use super::fixture::{beginning, decimals, mc1, models, rk3, six};
use std::f64::consts::TAU;
use toolroom_contour::{Contour, Models, Objective, Parameters, Pass, PathError, Plan, Planner};

/// Costs of the reference are per minute: 0.5; edge lives at 8 unless said otherwise.
fn with_edge_cost(edge_cost: f64) -> Parameters {
    let mut parameters = Parameters::default();
    parameters.economics.edge_cost = edge_cost;
    parameters
}

/// Speed in rpm and feed in µm of every section, runs of equal ones once.
fn runs(plan: &Plan) -> Vec<(u32, u32)> {
    let whole = |plan: &Plan| -> Vec<(u32, u32)> {
        let setting = |section: &toolroom_contour::PlannedSection| {
            let rpm = section.setting.spindle_speed * 60.0 / TAU;
            (rpm.round() as u32, (section.setting.feed_per_tooth * 1e6).round() as u32)
        };
        plan.sections.iter().map(setting).collect()
    };
    let mut settings = whole(plan);
    settings.dedup();
    settings
}

#[test]
fn m9_five_sections_planned_by_dynamic_programming() {
    let mut parameters = Parameters::default();
    // Six gears, 630 to 2000 rpm, as in the comparison with brute force.
    parameters.machine.lowest_spindle_speed = 600.0 / 60.0 * TAU;
    let contour = beginning(&mc1(), 5);
    let models = models();
    let rough = [(1250, 182), (1250, 184), (1250, 182), (1250, 56)];
    let fast = [(2000, 140), (2000, 56), (2000, 140), (2000, 38)];
    let cheap = [(1250, 224), (1250, 90), (1250, 224), (1250, 54)];
    for (pass, objective, value, settings) in [
        (Pass::rough(), Objective::Time, 0.305606, rough),
        (Pass::rough(), Objective::Cost, 0.175771, rough),
        (Pass::default(), Objective::Time, 0.349433, fast),
        (Pass::default(), Objective::Cost, 0.183563, cheap),
    ] {
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        assert_eq!(planner.speeds().len(), 6);
        let plan = planner.optimal(objective).unwrap();
        let corners = plan.corner_time;
        let along = match objective {
            Objective::Time => (plan.time - corners) / 60.0,
            _ => plan.cost - corners * parameters.economics.machine_rate,
        };
        // The reference adds 1e-9 of the other criterion.
        decimals("value", along, value, 6);
        assert_eq!(runs(&plan), settings);
    }
}

#[test]
fn m9b_limits_of_the_switching_time() {
    let (contour, models, pass) = (mc1(), models(), Pass::default());
    let along = |switch: f64| {
        let mut parameters = Parameters::default();
        parameters.machine.speed_change_time = switch;
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        let plan = planner.optimal(Objective::Time).unwrap();
        ((plan.time - plan.corner_time) / 60.0, plan)
    };
    let (free, plan) = along(0.0);
    six("free changes", free, 0.776943);
    assert!(plan.speed_changes() > 0);
    let (dear, plan) = along(1e4);
    six("no changes", dear, 0.782443);
    assert!(plan.sections.iter().all(|section| (section.setting.spindle_speed - 2000.0 / 60.0 * TAU).abs() < 1e-9));
}

/// Time in min, cost, edge lives, settings of the five regimes.
type Regimes<'t> = [(f64, f64, f64, &'t [(u32, u32)]); 5];

fn five(planner: &Planner) -> [Plan; 5] {
    [
        planner.handbook().unwrap(),
        planner.handbook_by_section().unwrap(),
        planner.best_constant(Objective::Time).unwrap(),
        planner.optimal(Objective::Time).unwrap(),
        planner.optimal(Objective::Cost).unwrap(),
    ]
}

fn check(contour: &Contour, pass: &Pass, table: Regimes) {
    let (parameters, models) = (Parameters::default(), models());
    let planner = Planner::new(contour, &parameters, pass, &models).unwrap();
    for (plan, (time, cost, life, settings)) in five(&planner).iter().zip(table) {
        six("time", plan.time / 60.0, time);
        six("cost", plan.cost, cost);
        six("life", plan.life_fraction, life);
        // Printed lines are cut off; what there is must agree.
        assert_eq!(&runs(plan)[..settings.len()], settings);
        assert!(plan.sections.iter().all(|section| section.evaluation.ratios.admissible()));
    }
}

#[test]
#[rustfmt::skip]
fn m10_regimes_of_the_reference_contours() {
    let lobes = |a: (u32, u32), b, c| [a, b, c, b, a, b, c, b, a, b];
    let rough = lobes((1250, 144), (1250, 132), (1250, 86));
    let fine = lobes((1600, 70), (1600, 68), (1600, 58));
    let three = |a: (u32, u32), b| [a, b, a, b, a, b, a];
    let mc1_rough = [(1250, 182), (1250, 184), (1250, 182), (1250, 56), (1250, 168), (1250, 56), (1250, 182)];
    check(&mc1(), &Pass::rough(), [
        (2.39498, 1.25791, 0.00575464, &[(1250, 48)]),
        (1.39947, 0.781835, 0.0078189, &[(1600, 80), (1600, 24), (1600, 80), (1600, 24), (1600, 80)]),
        (2.10418, 1.10981, 0.00549686, &[(1250, 56)]),
        (0.952921, 0.518823, 0.00403455, &mc1_rough),
        (0.952921, 0.518823, 0.00403455, &mc1_rough),
    ]);
    check(&mc1(), &Pass::default(), [
        (2.05571, 1.0734, 0.00433783, &[(2000, 36)]),
        (1.48227, 0.781507, 0.00384521, &[(2000, 60), (2000, 54), (2000, 60), (2000, 36), (2000, 48), (2000, 36), (2000, 60)]),
        (1.96643, 1.02804, 0.00426866, &[(2000, 38)]),
        (1.14183, 0.605912, 0.00333316, &[(2000, 140), (2000, 56), (2000, 140), (2000, 38), (2000, 48), (2000, 38), (2000, 140)]),
        (1.14414, 0.585783, 0.00130611, &[(1250, 224), (1250, 90), (1250, 224), (1250, 54), (1250, 78), (1250, 54), (1250, 224)]),
    ]);
    check(&rk3(3.5e-3, 18), &Pass::rough(), [
        (0.593412, 0.327617, 0.0029439, &[(1250, 72)]),
        (0.601839, 0.35196, 0.00486099, &lobes((1600, 64), (1600, 56), (1600, 32))),
        (0.49681, 0.277725, 0.00279243, &[(1250, 86)]),
        (0.326971, 0.189474, 0.00247509, &rough),
        (0.326971, 0.189474, 0.00247509, &rough),
    ]);
    check(&rk3(3.5e-3, 18), &Pass::default(), [
        (0.556324, 0.302834, 0.0023497, &[(2000, 48)]),
        (0.501082, 0.274491, 0.00228093, &three((2000, 54), (2000, 48))),
        (0.556324, 0.302834, 0.0023497, &[(2000, 48)]),
        (0.485298, 0.266381, 0.00226018, &three((2000, 56), (2000, 48))),
        (0.492013, 0.261262, 0.00145296, &fine),
    ]);
}

/// Gains in per cent against the handbook: productivity and cost of handbook by section, best
/// constant, time and cost optimum, productivity of the time optimum against the second regime.
type Gains = ([f64; 2], [f64; 2], [f64; 2], [f64; 2], f64);

/// Name, contour, pass, models, time and cost of the handbook regime, its share of edges, gains.
type Case = (&'static str, Contour, Pass, Models, [f64; 2], f64, Gains);

fn check_gains(what: &str, planner: &Planner, norm: [f64; 2], edge_share: f64, gains: Gains) {
    let plans = five(planner);
    six(what, plans[0].time / 60.0, norm[0]);
    six(what, plans[0].cost, norm[1]);
    decimals(what, plans[0].edge_share(planner) * 100.0, edge_share, 1);
    for (plan, gain) in plans[1..].iter().zip([gains.0, gains.1, gains.2, gains.3]) {
        decimals(what, plan.productivity_gain(&plans[0]) * 100.0, gain[0], 2);
        decimals(what, plan.cost_change(&plans[0]) * 100.0, gain[1], 2);
    }
    decimals(what, plans[3].productivity_gain(&plans[1]) * 100.0, gains.4, 2);
}

#[test]
#[rustfmt::skip]
fn m10b_the_published_gains_and_the_price_of_an_edge() {
    let (contour, pass, models) = (rk3(3.5e-3, 18), Pass::default(), models());
    for (edge_cost, cost, share, gains) in [
        (8.0, 0.302834, 8.1, ([11.02, -9.36], [0.0, 0.0], [14.64, -12.04], [13.07, -13.73], 3.25)),
        (16.0, 0.321631, 13.5, ([11.02, -8.98], [0.0, 0.0], [14.64, -11.56], [13.07, -15.16], 3.25)),
        (20.0, 0.33103, 16.0, ([11.02, -8.81], [0.0, 0.0], [14.64, -11.34], [5.74, -16.60], 3.25)),
        (40.0, 0.378024, 26.4, ([11.02, -8.08], [0.0, 0.0], [14.64, -10.40], [5.74, -23.90], 3.25)),
    ] {
        let parameters = with_edge_cost(edge_cost);
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        check_gains(&format!("edge {edge_cost}"), &planner, [0.556324, cost], share, gains);
    }
}

#[test]
#[rustfmt::skip]
#[allow(clippy::approx_constant)] // a change of cost of -3.14 %
fn m10c_the_gains_move_with_the_conditions() {
    let (hole, pass, models) = (rk3(3.5e-3, 18), Pass::default(), models());
    let with = |path_error: PathError| Models { path_error, ..models };
    let compensated = Pass { deflection_compensation: 0.8, ..pass };
    let servo = with(PathError::default());
    let cases: [Case; 14] = [
        ("reference", hole.clone(), pass, models, [0.556324, 0.33103], 16.0,
            ([11.02, -8.81], [0.0, 0.0], [14.64, -11.34], [5.74, -16.60], 3.25)),
        ("tolerance 0.03", hole.clone(), Pass { tolerance: 0.03e-3, ..pass }, models, [1.11265, 0.62129], 10.5,
            ([33.95, -23.53], [16.67, -13.26], [42.86, -27.89], [38.92, -29.46], 6.65)),
        ("tolerance 0.08", hole.clone(), Pass { tolerance: 0.08e-3, ..pass }, models, [0.445059, 0.272004], 18.2,
            ([0.0, 0.0], [23.33, -16.58], [35.11, -22.80], [25.97, -30.80], 35.11)),
        ("table feed 0.04", hole.clone(), Pass { table_feed: 0.04e-3, ..pass }, models, [0.667588, 0.389607], 14.3,
            ([0.0, 0.0], [20.0, -15.03], [37.56, -24.67], [26.89, -29.14], 37.56)),
        ("table feed 0.10", hole.clone(), Pass { table_feed: 0.10e-3, ..pass }, models, [0.667588, 0.389607], 14.3,
            ([21.76, -16.10], [20.0, -15.03], [37.56, -24.67], [26.89, -29.14], 12.98)),
        ("allowance 0.2", hole.clone(), Pass { allowance: 0.2e-3, ..pass }, models, [0.49451, 0.275483], 10.2,
            ([9.81, -8.29], [7.41, -6.41], [16.00, -12.81], [12.91, -18.04], 5.63)),
        ("allowance 1.0", hole.clone(), Pass { allowance: 1e-3, ..pass }, models, [0.890118, 0.540069], 17.6,
            ([43.96, -26.91], [13.33, -10.34], [51.19, -29.88], [44.21, -32.72], 5.02)),
        ("circle", rk3(0.0, 18), pass, models, [0.49451, 0.298583], 17.2,
            ([0.0, 0.0], [3.70, -3.14], [3.70, -3.14], [-2.78, -8.05], 3.70)),
        ("e 2", rk3(2e-3, 18), pass, models, [0.49451, 0.298516], 17.2,
            ([0.0, 0.0], [0.0, 0.0], [2.93, -2.50], [-2.72, -8.09], 2.93)),
        ("e 3.8", rk3(3.8e-3, 18), pass, models, [0.635799, 0.372816], 14.7,
            ([25.46, -18.22], [9.52, -7.81], [30.86, -21.21], [25.33, -26.57], 4.31)),
        ("compensated", hole.clone(), compensated, models, [0.445059, 0.272004], 18.2,
            ([0.0, 0.0], [10.0, -7.95], [11.84, -9.25], [8.99, -22.10], 11.84)),
        ("no path error", hole.clone(), pass, with(PathError::Off), [0.445059, 0.272004], 18.2,
            ([0.0, 0.0], [100.0, -49.62], [128.12, -55.01], [128.12, -55.01], 128.12)),
        ("servo", hole.clone(), pass, servo, [0.445059, 0.272004], 18.2,
            ([0.0, 0.0], [33.33, -27.96], [115.08, -52.66], [115.08, -52.66], 115.08)),
        ("servo, compensated", hole.clone(), compensated, servo, [0.445059, 0.272004], 18.2,
            ([0.0, 0.0], [97.33, -49.03], [127.75, -54.95], [127.75, -54.95], 127.75)),
    ];
    let parameters = with_edge_cost(20.0);
    for (what, contour, pass, models, norm, share, gains) in cases {
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        check_gains(what, &planner, norm, share, gains);
    }
    let contour = mc1();
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    check_gains("MC-1", &planner, [2.05571, 1.12546], 8.7,
        ([38.69, -26.46], [4.54, -4.10], [80.04, -42.61], [79.67, -46.56], 29.82));
}

/// Inputs that no table lists, computed with a second Python implementation.
#[test]
#[rustfmt::skip]
fn fresh_inputs_agree_with_a_second_implementation() {
    let lobed = {
        let mut trace = toolroom_contour::Trace::new(toolroom_contour::Point::default(), 0.0);
        trace.lobed(0.096, 3e-3, 3, 24).unwrap();
        trace.finish(toolroom_contour::CutterSide::Left, true).unwrap()
    };
    let thin = Pass { allowance: 0.35e-3, tolerance: 0.04e-3, table_feed: 0.05e-3, ..Pass::default() };
    let thick =
        Pass { allowance: 0.8e-3, tolerance: 0.07e-3, roughness: 12e-6, table_feed: 0.07e-3, ..Pass::default() };
    let servo = Models { path_error: PathError::default(), ..models() };
    let half = Pass { deflection_compensation: 0.5, ..thick };
    // Time in min, cost and edge lives, corners aside.
    type Row = [f64; 3];
    let table: [(Contour, Pass, Models, [Row; 5]); 3] = [
        (lobed, thin, models(), [
            [0.628319, 0.341408, 0.00187921], [0.522915, 0.287316, 0.00178336], [0.571199, 0.312087, 0.00182671],
            [0.511991, 0.281669, 0.00177059], [0.536777, 0.278565, 0.000701847],
        ]),
        (mc1(), thick, servo, [
            [1.36312, 0.732766, 0.00353142], [0.906057, 0.5246, 0.00493594], [1.15659, 0.627058, 0.00336306],
            [0.466404, 0.270901, 0.00259997], [0.470313, 0.258244, 0.00159226],
        ]),
        (mc1(), half, models(), [
            [1.36312, 0.732766, 0.00353142], [0.929743, 0.536852, 0.00496418], [1.0905, 0.593167, 0.00330474],
            [0.645038, 0.362764, 0.00277548], [0.663396, 0.347595, 0.00109633],
        ]),
    ];
    let parameters = with_edge_cost(12.0);
    for (contour, pass, models, rows) in table {
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        for (plan, [time, cost, life]) in five(&planner).iter().zip(rows) {
            six("time", (plan.time - plan.corner_time) / 60.0, time);
            six("cost", plan.cost - plan.corner_time * parameters.economics.machine_rate, cost);
            six("life", plan.life_fraction, life);
        }
    }
}
