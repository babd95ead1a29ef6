//! Zakovorotny et al.: reduced and five-degree systems.

use toolroom_chatter::paper::{FiveDegrees, Preset, Reduced};
use toolroom_chatter::{Axis, ChatterError, ChatterKind};

const KGF_PER_MM: f64 = 9806.65;

fn close(computed: f64, published: f64, relative: f64) {
    assert!((computed - published).abs() <= relative * published.abs(), "{computed} against {published}");
}

#[test]
fn routh_limits_of_the_presets() {
    let lags = [0.4e-4, 0.8e-4, 1.6e-4, 4e-4];
    let rows = [
        (Preset::Table2Literal, [397.51237, 198.76858, 99.405986, 39.818215]),
        (Preset::Table2Milli, [583.62805, 311.15854, 188.09451, 156.40244]),
        (Preset::F0_120Hz, [480.64035, 240.93141, 121.51355, 51.259945]),
    ];
    for (preset, limits) in rows {
        for (lag, limit) in lags.into_iter().zip(limits) {
            close(Reduced::from_preset(preset, lag).cutting_stiffness_limit() / KGF_PER_MM, limit, 1e-7);
        }
    }
}

#[test]
fn routh_limit_is_where_the_multiplier_crosses_one() {
    for preset in [Preset::Table2Literal, Preset::Table2Milli, Preset::F0_120Hz, Preset::Fig3Fit] {
        let mut chuck = Reduced::from_preset(preset, 0.8e-4);
        let limit = chuck.cutting_stiffness_limit();
        for (factor, stable) in [(0.999, true), (1.001, false)] {
            chuck.cutting_stiffness = factor * limit;
            assert_eq!(chuck.verdict(0.0, 1.0).unwrap().stable, stable, "{preset:?} {factor}");
        }
    }
    let chuck = Reduced::from_preset(Preset::F0_120Hz, 1e-4);
    let (lag, least) = chuck.least_limit();
    close(Reduced { lag, ..chuck }.cutting_stiffness_limit(), least, 1e-12);
}

#[test]
fn critical_modulations_at_both_tongues() {
    let lags = [0.0, 0.4e-4, 0.8e-4];
    let rows: [(Preset, f64, [Option<f64>; 3]); 7] = [
        (Preset::Table2Literal, 1.0, [Some(0.196833), Some(0.139019), Some(0.0)]),
        (Preset::Table2Literal, 2.0, [Some(0.00961726), Some(0.00477855), Some(0.0)]),
        (Preset::F0_120Hz, 1.0, [Some(0.541592), Some(0.417262), Some(0.257592)]),
        (Preset::F0_120Hz, 2.0, [Some(0.0723846), Some(0.0422591), Some(0.0128043)]),
        (Preset::Table2Milli, 1.0, [None, Some(1.12247), Some(1.05378)]),
        (Preset::Table2Milli, 2.0, [Some(0.430848), Some(0.281653), Some(0.172626)]),
        (Preset::Table2Milli, 1.9, [Some(0.510433), Some(0.385800), Some(0.259255)]),
    ];
    for (preset, speed_ratio, thresholds) in rows {
        for (lag, threshold) in lags.into_iter().zip(thresholds) {
            let computed = Reduced::from_preset(preset, lag).critical_modulation(speed_ratio, 1.2).unwrap();
            match (computed, threshold) {
                (Some(computed), Some(threshold)) => close(computed, threshold, 4e-6),
                (computed, threshold) => assert_eq!(computed, threshold, "{preset:?} {speed_ratio} {lag}"),
            }
        }
    }
}

/// The text to Fig. 3: 0.5, 0.38 and 0.24. The fitted preset is within 0.005, the default within 0.042.
#[test]
fn thresholds_of_figure_3() {
    for (lag, text) in [(0.0, 0.5), (0.4e-4, 0.38), (0.8e-4, 0.24)] {
        let fit = Reduced::from_preset(Preset::Fig3Fit, lag).critical_modulation(1.0, 1.2).unwrap().unwrap();
        let default = Reduced::from_preset(Preset::default(), lag).critical_modulation(1.0, 1.2).unwrap().unwrap();
        assert!((fit - text).abs() < 0.0052, "{lag}: {fit}");
        assert!((default - text).abs() < 0.042, "{lag}: {default}");
    }
}

#[test]
fn multipliers_of_the_reduced_system() {
    let rows: [(Preset, f64, f64, f64, &[f64]); 3] = [
        (Preset::Table2Milli, 0.4e-4, 0.3, 1.9, &[-0.923837325, -0.796117072]),
        (Preset::F0_120Hz, 0.8e-4, 0.3, 1.0, &[1.00647429, 0.968365145]),
        (Preset::F0_120Hz, 0.0, 0.5, 1.0, &[0.988823376, 0.869047433]),
    ];
    for (preset, lag, modulation, speed_ratio, published) in rows {
        let computed = Reduced::from_preset(preset, lag).multipliers(modulation, speed_ratio).unwrap();
        for (computed, published) in computed.iter().zip(published) {
            close(computed.re, *published, 1e-6);
            assert!(computed.im.abs() < 1e-9);
        }
    }
    let third = Reduced::from_preset(Preset::Table2Milli, 0.4e-4).multipliers(0.3, 1.9).unwrap()[2].re;
    close(third, 3.481e-10, 1e-2);
}

#[test]
fn a_vibration_beyond_all_numbers_and_a_speed_near_zero_are_refused() {
    // A lag of 0.4 s is a negative damping under which the tool's vibration grows by more than 1e308 in a revolution.
    let lathe = FiveDegrees::from_preset(Preset::Table2Milli, 0.4, 0.1e-3);
    let speed = 0.2 * lathe.reference_frequency();
    for regeneration in [false, true] {
        let lathe = FiveDegrees { regeneration, ..lathe.clone() };
        assert!(!lathe.verdict(speed).is_ok_and(|verdict| verdict.stable));
        assert!(matches!(lathe.verdict(1e-6 * speed), Err(ChatterError::OutOfRange { .. })));
    }
    assert!(matches!(lathe.verdict(speed), Err(ChatterError::NotConverged { .. })));
    let chuck = Reduced::from_preset(Preset::F0_120Hz, 0.8e-4);
    assert!(matches!(chuck.verdict(0.3, 1e-6), Err(ChatterError::OutOfRange { .. })));
    assert!(chuck.verdict(0.3, 2e-3).is_ok());
}

#[test]
fn liouville_holds() {
    // With the paper's lags the determinant is below the rounding of its factors.
    for (preset, lag, eta) in
        [(Preset::Table2Milli, 1e-3, 1.0), (Preset::F0_120Hz, 4e-3, 1.7), (Preset::Table2Literal, 8e-3, 3.0)]
    {
        let (computed, exact) = Reduced::from_preset(preset, lag).liouville(0.4, eta).unwrap();
        close(computed, exact, 1e-9);
    }
}

/// Perturbation theory of the damped Mathieu equation: eps = mu c/(c + c_p) at the tongues.
#[test]
fn mathieu_tongues_for_light_damping() {
    let zeta = 0.002;
    let chuck = Reduced { mass: 1.0, damping: 2.0 * zeta, stiffness: 1.0, cutting_stiffness: 0.0, lag: 0.0 };
    let principal = chuck.critical_modulation(2.0, 0.1).unwrap().unwrap();
    close(principal, 4.0 * zeta, 1e-4);
    let second = chuck.critical_modulation(1.0, 1.0).unwrap().unwrap();
    close(second, (24.0 * zeta / 5f64.sqrt()).sqrt(), 1e-2);
}

#[test]
fn five_degrees_over_one_revolution() {
    let rows = [
        (0.0, 0.3, 0.55, 1.196003135),
        (0.0, 0.2, 0.55, 0.947564657),
        (0.6, 0.3, 0.55, 1.196040506),
        (0.3, 0.5, 0.5, 1.502025864),
        (0.0, 0.5, 0.274, 0.569386055),
    ];
    let mut lathe = FiveDegrees::from_preset(Preset::Table2Milli, 0.4e-4, 0.1e-3);
    for (mu_allowance, mu_chuck, speed_ratio, published) in rows {
        lathe.mu_allowance = vec![mu_allowance];
        lathe.mu_chuck = mu_chuck;
        let verdict = lathe.verdict(speed_ratio * lathe.reference_frequency()).unwrap();
        close(verdict.spectral_radius, published, 1e-6);
    }
}

#[test]
fn five_degrees_without_modulation() {
    let published = [(-182.22, 3139.8), (-279.18, 3142.8), (-94.14, 3502.9), (-105.75, 4917.0), (-215.64, 5990.2)];
    let mut lathe = FiveDegrees::from_preset(Preset::Table2Milli, 0.4e-4, 0.1e-3);
    for (computed, (re, im)) in lathe.eigenvalues().unwrap().iter().zip(published) {
        close(computed.re, re, 1e-4);
        close(computed.im, im, 1e-4);
    }
    // The literal extra damping term of the printed workpiece rows contradicts the paper's premise.
    lathe.workpiece_lag = true;
    let rightmost = lathe.eigenvalues().unwrap().iter().map(|l| l.re).fold(f64::MIN, f64::max);
    assert!((rightmost - 12.6).abs() < 0.05, "{rightmost}");
}

/// Threshold of the principal tongue: 0.2217 with tool dynamics; the allowance harmonic moves it
/// by less than 0.02 %, against the paper's Fig. 4.
#[test]
fn allowance_hardly_moves_the_chuck_threshold() {
    let mut lathe = FiveDegrees::from_preset(Preset::Table2Milli, 0.4e-4, 0.1e-3);
    let speed = 0.547 * lathe.reference_frequency();
    for (mu_allowance, published) in [(0.0, 0.221698), (0.6, 0.221685), (1.0, 0.221663)] {
        lathe.mu_allowance = vec![mu_allowance];
        let threshold = lathe.critical_chuck_modulation(speed, 0.8).unwrap().unwrap();
        assert!((threshold - published).abs() < 2e-4, "{threshold}");
    }
}

/// Fig. 2 and Fig. 4 as charts: the stars of Fig. 2 lie inside the default reading's region, and
/// tool dynamics put the principal tongue of Fig. 4 at low spindle speed.
#[test]
fn charts_of_figures_2_and_4() {
    let lag = Axis { start: 0.0, end: 0.8e-4, points: 3 };
    let stiffness = Axis { start: 200.0 * KGF_PER_MM, end: 700.0 * KGF_PER_MM, points: 6 };
    let region = Reduced::from_preset(Preset::default(), 0.0)
        .stability_region(&lag.values("lag").unwrap(), &stiffness.values("stiffness").unwrap())
        .unwrap();
    for (i, lag) in region.speed.iter().enumerate() {
        assert!(region.at(i, 0).unwrap().stable);
        let limit = Reduced::from_preset(Preset::default(), *lag).cutting_stiffness_limit();
        for (j, cutting_stiffness) in region.depth.iter().enumerate() {
            assert_eq!(region.at(i, j).unwrap().stable, *cutting_stiffness < limit);
        }
    }
    let lathe = FiveDegrees::from_preset(Preset::Table2Milli, 0.4e-4, 0.1e-3);
    let chart = lathe.lobes(&[0.5, 0.55, 0.6], &[0.2, 0.3]).unwrap();
    assert!(chart.at(1, 0).unwrap().stable);
    assert_eq!(chart.at(1, 1).unwrap().kind, ChatterKind::Parametric);
    // With regeneration, the feed deflection a revolution ago, the radius changes a little.
    let with = FiveDegrees { regeneration: true, mu_chuck: 0.3, ..lathe.clone() };
    let speed = 0.55 * lathe.reference_frequency();
    let radius = with.verdict(speed).unwrap().spectral_radius;
    assert!((radius / 1.196003135 - 1.0).abs() < 0.05 && (radius - 1.196003135).abs() > 1e-6, "{radius}");
    // A cut without stiffness in feed has nothing to regenerate: both solvers agree.
    let none = FiveDegrees { cutting_stiffness: 0.0, ..with };
    let direct = FiveDegrees { regeneration: false, ..none.clone() };
    close(none.verdict(speed).unwrap().spectral_radius, direct.verdict(speed).unwrap().spectral_radius, 1e-7);
}
