//! Minimum-wear speed, wear-dependent control laws, pass plans.
//!
//! Origin: independent reference implementation in Python (bisection on the balance after a
//! scan of 400 speeds), printed with seven digits or more.

use toolroom_wear::{Pair, PassPlan, RampLimits, SpeedMode};

/// Pair, flank wear mm; speed m/min, temperature K, wear per path um/m. Tolerance 1e-6.
#[rustfmt::skip]
const MINIMUM_WEAR: [(&str, f64, [f64; 3]); 20] = [
    ("ni_vk6om", 0.0, [87.03235, 1095.117, 0.65726]),
    ("ni_vk6om", 0.1, [50.87012, 1044.727, 0.4823177]),
    ("ni_vk6om", 0.2, [39.99782, 1028.899, 0.5000083]),
    ("ni_vk6om", 0.35, [31.2264, 1011.772, 0.5682633]),
    ("ni_vk6om", 0.5, [25.76855, 996.2343, 0.6597533]),
    ("ni_vk6om_hb", 0.0, [62.87029, 1065.648, 0.9348773]),
    ("ni_vk6om_hb", 0.1, [45.75194, 1024.989, 0.5339548]),
    ("ni_vk6om_hb", 0.2, [40.00531, 1014.5, 0.4999856]),
    ("ni_vk6om_hb", 0.35, [34.83772, 1004.708, 0.5044369]),
    ("ni_vk6om_hb", 0.5, [31.25391, 996.4695, 0.5295547]),
    ("c45_t15k6", 0.0, [278.9044, 1210.586, 0.06230556]),
    ("c45_t15k6", 0.1, [204.1618, 1154.53, 0.03018771]),
    ("c45_t15k6", 0.2, [180.0153, 1140.791, 0.02699929]),
    ("c45_t15k6", 0.35, [158.3337, 1128.539, 0.02603257]),
    ("c45_t15k6", 0.5, [143.1802, 1118.568, 0.02628427]),
    ("ti_vk6", 0.0, [102.3023, 1042.436, 0.6182686]),
    ("ti_vk6", 0.1, [62.20568, 983.0375, 0.3839921]),
    ("ti_vk6", 0.2, [49.98493, 964.0997, 0.3799934]),
    ("ti_vk6", 0.35, [39.43908, 941.8481, 0.4122201]),
    ("ti_vk6", 0.5, [32.52183, 921.3123, 0.4585748]),
];

fn close(what: &str, computed: f64, expected: f64, tolerance: f64) {
    assert!((computed / expected - 1.0).abs() <= tolerance, "{what}: {computed}, reference {expected}");
}

#[test]
fn the_minimum_wear_speed_agrees_with_the_reference() {
    for (name, wear, [speed, temperature, intensity]) in MINIMUM_WEAR {
        let pair = Pair::named(name).unwrap();
        let cut = pair.reference_cut();
        let computed = pair.minimum_wear_speed(&cut, wear * 1e-3);
        let point = pair.point(&cut.at_speed(computed), wear * 1e-3);
        let what = format!("{name} at {wear} mm");
        close(&what, computed * 60.0, speed, 1e-6);
        close(&what, point.temperature, temperature, 1e-6);
        close(&what, point.wear_intensity * 1e6, intensity, 1e-6);
        assert!(point.wear_balance.abs() < 1e-9);
    }
}

/// The rule A = B/v taken literally, tolerance 1e-6.
#[test]
fn the_literal_balance_agrees_with_the_reference() {
    let pair = Pair::default();
    for (wear, speed) in [(0.1, 50.614773), (0.35, 31.448984), (0.6, 23.582878)] {
        let computed = pair.literal_balance_speed(&pair.reference_cut(), wear * 1e-3);
        close("literal balance", computed * 60.0, speed, 1e-6);
    }
}

/// mu = 0.04 min/m, tolerance 1e-6.
#[test]
fn the_shadow_price_speed_agrees_with_the_reference() {
    let pair = Pair::default();
    for (wear, speed) in [(0.05, 62.941907), (0.2, 42.603079), (0.5, 31.684177)] {
        let computed = pair.shadow_price_speed(&pair.reference_cut(), wear * 1e-3, 0.04 * 60.0);
        close("shadow price", computed * 60.0, speed, 1e-6);
    }
}

/// Highest speed at 0.8 um/m, tolerance 1e-6.
#[test]
fn the_set_intensity_speed_agrees_with_the_reference() {
    let pair = Pair::default();
    for (wear, speed) in [(0.1, 63.939452), (0.2, 49.674939), (0.5, 29.5396)] {
        let set = pair.set_intensity_speed(&pair.reference_cut(), wear * 1e-3, 0.8e-6);
        assert!(set.feasible);
        close("set intensity", set.cutting_speed * 60.0, speed, 1e-6);
    }
}

#[test]
fn an_infeasible_increment_falls_back_to_least_wear() {
    let pair = Pair::default();
    let cut = pair.reference_cut();
    let set = pair.set_intensity_speed(&cut, 0.2e-3, 0.4e-6); // least wear there is 0.5 um/m
    assert!(!set.feasible);
    assert_eq!(set.cutting_speed, pair.minimum_wear_speed(&cut, 0.2e-3));
}

/// Flank wear mm, mode; start m/min, end m/min, acceleration m/min², wear increment mm.
/// Passes of 75.4 m, tolerance 1e-5.
#[test]
fn pass_plans_agree_with_the_reference() {
    let modes = [
        (0.1, SpeedMode::MinimumWear, [50.870118, 46.031213, -3.109392, 0.036390841]),
        (0.1, SpeedMode::SetIncrement { wear_increment: 0.06e-3 }, [63.848506, 54.127696, -7.6049357, 0.061844647]),
        (0.3, SpeedMode::LiteralBalance, [33.781571, 31.810757, -0.8572298, 0.041694103]),
        (0.3, SpeedMode::MinimumWear, [33.625295, 31.599758, -0.87609947, 0.041675197]),
        (0.3, SpeedMode::ShadowPrice { shadow_price: 2.4 }, [36.999276, 35.187884, -0.86710373, 0.047283837]),
    ];
    let pair = Pair::default();
    for (wear, mode, [start, end, acceleration, increment]) in modes {
        let cut = pair.reference_cut();
        let plan = pair.plan_pass(&cut, wear * 1e-3, 75.4, mode, &RampLimits::default(), None);
        let what = format!("{mode:?}");
        close(&what, plan.start_speed * 60.0, start, 1e-5);
        close(&what, plan.end_speed * 60.0, end, 1e-5);
        close(&what, plan.acceleration * 3600.0, acceleration, 1e-5);
        close(&what, plan.wear_increment * 1e3, increment, 1e-5);
        assert!(plan.feasible);
    }
}

#[test]
fn a_plan_respects_step_and_acceleration() {
    let pair = Pair::default();
    let cut = pair.reference_cut();
    let ramp = RampLimits { largest_acceleration: 1.0 / 3600.0, largest_step: 2.0 / 60.0 };
    let plan = |wear: f64, last: f64| -> PassPlan {
        pair.plan_pass(&cut, wear, 75.4, SpeedMode::MinimumWear, &ramp, Some(last / 60.0))
    };
    let held = plan(0.1e-3, 40.0); // least wear is at 50.9 m/min
    close("start", held.start_speed * 60.0, 42.0, 1e-12);
    let steep = plan(0.05e-3, 60.0);
    close("acceleration", steep.acceleration * 3600.0, -1.0, 1e-9);
}
