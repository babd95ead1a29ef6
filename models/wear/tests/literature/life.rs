//! Life by quadrature and by integration in time, interrupted cutting, observer.
//!
//! Origin: independent reference implementation in Python: Simpson with 2000 panels for lives
//! (400 for mode 1), Runge–Kutta 4 with 0.005 min for trajectories.

use toolroom_process::ProcessEvent;
use toolroom_wear::{
    Cut, Estimate, Life, Measurement, Objective, Observer, ObserverNoise, Pair, Scatter, WearLaw, WearState,
};

fn close(what: &str, computed: f64, expected: f64, tolerance: f64) {
    assert!((computed / expected - 1.0).abs() <= tolerance, "{what}: {computed}, reference {expected}");
}

/// Pair, speed m/min; T min, L m. Tolerance 1e-6.
#[rustfmt::skip]
const LIVES: [(&str, f64, f64, f64); 8] = [
    ("ni_vk6om", 20.0, 24.320973, 486.41947),
    ("ni_vk6om", 30.0, 22.932801, 687.98403),
    ("ni_vk6om", 40.0, 14.932164, 597.28656),
    ("ni_vk6om", 60.0, 5.43553, 326.1318),
    ("ni_vk6om_hb", 40.0, 21.02601, 841.04041),
    ("c45_t15k6", 180.0, 111.78606, 20121.491),
    ("c45_t15k6", 220.0, 54.61216, 12014.675),
    ("ti_vk6", 50.0, 18.696459, 934.82296),
];

#[test]
fn lives_at_constant_speed_agree_with_the_reference() {
    for (name, speed, time, path) in LIVES {
        let pair = Pair::named(name).unwrap();
        let life = pair.life(&pair.reference_cut().at_speed(speed / 60.0));
        close(name, life.cutting_time / 60.0, time, 1e-6);
        close(name, life.path, path, 1e-6);
        close("sum of functionals", life.mechanical_wear + life.thermal_wear, pair.limits.wear_limit, 1e-9);
    }
}

/// Speed m/min; F_M mm, F_T mm; tolerance 1e-6.
#[test]
fn functionals_at_constant_speed_agree_with_the_reference() {
    let pair = Pair::default();
    for (speed, mechanical, thermal) in [
        (20.0, 0.57807525, 0.021924752),
        (30.0, 0.3881132, 0.2118868),
        (40.0, 0.21078447, 0.38921553),
        (60.0, 0.06118524, 0.53881476),
    ] {
        let life = pair.life(&pair.reference_cut().at_speed(speed / 60.0));
        close("mechanical", life.mechanical_wear * 1e3, mechanical, 1e-6);
        close("thermal", life.thermal_wear * 1e3, thermal, 1e-6);
    }
}

/// Tolerance 1e-6; the path there is flat, the speed itself is good to the printed digits.
#[test]
fn the_best_constant_speed_agrees_with_the_reference() {
    let pair = Pair::default();
    let best = pair.best_constant_speed(&pair.reference_cut(), Objective::Path);
    close("speed", best.cutting_speed * 60.0, 30.430343, 1e-6);
    close("T", best.life.cutting_time / 60.0, 22.619192, 1e-6);
    close("L", best.life.path, 688.30976, 1e-6);
}

fn mode_1(pair: &Pair, bounded: bool) -> Life {
    let cut = pair.reference_cut();
    pair.life_along(|wear| {
        let speed = pair.minimum_wear_speed(&cut, wear);
        cut.at_speed(if bounded { pair.limits.clip(speed) } else { speed })
    })
}

/// Tolerance 1e-5 unbounded, 1e-4 bounded (the reference does not resolve the kink).
#[test]
fn lives_under_mode_1_agree_with_the_reference() {
    let pair = Pair::default();
    let free = mode_1(&pair, false);
    close("T", free.cutting_time / 60.0, 30.385032, 1e-5);
    close("L", free.path, 1070.8654, 1e-5);
    close("F_M", free.mechanical_wear * 1e3, 0.30732701, 1e-5);
    close("F_T", free.thermal_wear * 1e3, 0.29267299, 1e-5);
    let bounded = mode_1(&pair, true);
    close("T", bounded.cutting_time / 60.0, 30.38734, 1e-4);
    close("L", bounded.path, 1070.5715, 1e-4);
}

/// Cold start, body lag; tolerance 1e-6.
#[test]
fn the_trajectory_at_constant_speed_agrees_with_the_reference() {
    let pair = Pair::default();
    let run = pair.run(&WearState::default(), |_, _| pair.reference_cut(), 1e5, 1e-10).unwrap();
    assert_eq!(run.event, Some(ProcessEvent::WearLimit));
    close("T", run.elapsed / 60.0, 14.77972, 1e-6);
    close("body", run.state.body_temperature_rise, 861.89392, 1e-6);
    close("F_M", run.state.mechanical_wear * 1e3, 0.21278695, 1e-6);
    close("F_T", run.state.thermal_wear * 1e3, 0.38721305, 1e-6);
}

/// k_D 0.02/min, kap_D 0.5; tolerance 1e-6. The same through the additions of the cut.
#[test]
fn the_trajectory_with_heredity_agrees_with_the_reference() {
    let nominal = Pair::default();
    let mut inherited = nominal.clone();
    if let WearLaw::EnergyBalance(law) = &mut inherited.law {
        law.damage_rate = 0.02 / 60.0;
        law.damage_gain = 0.5;
    }
    let added = Cut { damage_rate: 0.02 / 60.0, damage_gain: 0.5, ..nominal.reference_cut() };
    for (pair, cut) in [(&inherited, nominal.reference_cut()), (&nominal, added)] {
        let run = pair.run(&WearState::default(), |_, _| cut, 1e5, 1e-10).unwrap();
        close("T", run.elapsed / 60.0, 14.736523, 1e-6);
        close("D", run.state.thermal_damage, 0.033618436, 1e-6);
    }
}

/// v = 36 m/min, 1.5 min in cut, 0.3 min out of it; values after the pause; tolerance 1e-6.
#[test]
fn interrupted_cutting_agrees_with_the_reference() {
    let pair = Pair::default();
    let cut = pair.reference_cut().at_speed(0.6);
    let idle = Cut { engaged: 0.0, ..cut };
    let mut state = WearState::default();
    for (pass, (wear, body)) in
        [(0.10095431, 259.06087), (0.15197396, 273.36952), (0.19088122, 281.48012)].into_iter().enumerate()
    {
        let worn = pair.run(&state, |_, _| cut, 90.0, 1e-10).unwrap().state;
        if pass == 0 {
            close("body at the end of the first cut", worn.body_temperature_rise, 637.19, 1e-5);
        }
        state = pair.run(&worn, |_, _| idle, 18.0, 1e-10).unwrap().state;
        assert_eq!(state.flank_wear, worn.flank_wear);
        close("wear", state.flank_wear * 1e3, wear, 1e-6);
        close("body", state.body_temperature_rise, body, 1e-6);
    }
}

/// One prediction of 0.1 min at 40 m/min from h = 0.15 mm, then an update with the noise-free
/// channels of h = 0.18 mm, kF = 1.04; tolerance 1e-5.
#[test]
fn the_observer_agrees_with_the_reference() {
    let pair = Pair::default();
    let cut = pair.reference_cut();
    let start = Estimate { flank_wear: 0.15e-3, ln_force_factor: 0.0, ln_wear_factor: 0.0 };
    let mut observer = Observer::new(&pair, ObserverNoise::default()).with_estimate(start);
    observer.predict(&cut, 6.0);
    close("predicted wear", observer.estimate().flank_wear * 1e3, 0.15217844, 1e-5);
    close("predicted variance", observer.covariance()[0][0] * 1e6, 9.8972824e-5, 1e-5);
    let truth = pair.point(&Cut { force_factor: 1.04, ..cut }, 0.18e-3);
    let measured =
        Measurement { spindle_power: truth.spindle_power, feed_force: truth.feed_force, thermo_emf: truth.thermo_emf };
    observer.update(&cut, &measured);
    let estimate = observer.estimate();
    close("wear", estimate.flank_wear * 1e3, 0.1590962, 1e-5);
    close("ln kF", estimate.ln_force_factor, 0.058733629, 1e-5);
    close("ln kJ", estimate.ln_wear_factor, 0.01363941, 1e-5);
    close("variance", observer.covariance()[0][0] * 1e6, 7.6051131e-5, 1e-5);
    // A reading of 0.17 mm ± 0.0112 mm.
    observer.read(0.17e-3, 0.0112e-3);
    close("wear read", observer.estimate().flank_wear * 1e3, 0.1632117, 1e-5);
    close("variance read", observer.covariance()[0][0] * 1e6, 4.734627e-5, 1e-5);
}

/// Life at 30 m/min with one thing changed, min; tolerance 1e-6.
#[test]
fn sensitivities_agree_with_the_reference() {
    let pair = Pair::default();
    let cut = pair.reference_cut().at_speed(0.5);
    let changed = [
        (Cut { hardness: 1.05, ..cut }, 21.704412),
        (Cut { mechanical_factor: 1.2, ..cut }, 20.508651),
        (Cut { thermal_factor: 1.2, ..cut }, 21.329871),
        (Cut { depth_of_cut: 1.2 * cut.depth_of_cut, ..cut }, 22.807957),
        (Cut { feed_per_rev: 1.2 * cut.feed_per_rev, ..cut }, 22.492081),
    ];
    for (cut, minutes) in changed {
        close("life", pair.life(&cut).cutting_time / 60.0, minutes, 1e-6);
    }
}

/// Speed m/min; mean life min, coefficient of variation, under shop scatter of edge and batch.
/// Tolerance 1e-4 (Gauss–Hermite in the reference, too).
#[test]
fn life_scatter_agrees_with_the_reference() {
    let pair = Pair::default();
    for (speed, mean, variation) in [(30.0, 23.905684, 0.30876672), (40.0, 15.627871, 0.31429559)] {
        let moments = Scatter::shop().life_moments(&pair, &pair.reference_cut().at_speed(speed / 60.0));
        close("mean", moments.mean / 60.0, mean, 1e-4);
        close("variation", moments.variation, variation, 1e-4);
    }
}
