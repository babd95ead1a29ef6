//! Verdicts against dense eigenvalues, convergence, scaling, charts, scatter.

use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use toolroom_chatter::{
    Axis, ChatterKind, Cutter, Direction, Engagement, Milling, MillingForce, Mode, Scatter, SpeedVariation, Turning,
};

fn rpm(speed: f64) -> f64 {
    speed / 60.0 * TAU
}

fn standard(degrees: usize, immersion: f64, direction: Direction) -> Milling {
    let mode = |axis| Mode::from_mass(axis, 922.0, 0.011, 0.03993);
    Milling {
        modes: [[1.0, 0.0], [0.0, 1.0]].into_iter().take(degrees).map(mode).collect(),
        cutter: Cutter::straight(2, 0.02),
        engagement: Engagement::new(immersion, direction).unwrap(),
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    }
}

/// Fractional parts of multiples of irrational numbers: points that fill a cube evenly.
fn scatter_point(i: usize) -> [f64; 4] {
    [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9, 0.450_306_925_5].map(|a| (a * i as f64 + 0.5).fract())
}

/// 400 points here; `examples/verdicts.rs` judges 10 000 in the same way.
#[test]
fn verdicts_agree_with_dense_eigenvalues() {
    let mut judged = 0;
    for i in 0..400 {
        let [a, b, c, d] = scatter_point(i);
        let (speed, depth, immersion) = (rpm(5000.0 + 20000.0 * a), 1e-5 + 10e-3 * b * b, 0.02 + 0.98 * c);
        let direction = if d < 0.5 { Direction::Up } else { Direction::Down };
        let cut = standard(1 + i % 2, immersion, direction);
        let mut at_speed = cut.at_speed(speed).unwrap();
        let truth = at_speed.multipliers(depth, 6).unwrap()[0].norm();
        if (truth - 1.0).abs() > 1e-6 {
            let verdict = at_speed.verdict(depth).unwrap();
            assert_eq!(verdict.stable, truth < 1.0, "{speed} {depth} {immersion} {truth}");
            assert!((verdict.spectral_radius / truth - 1.0).abs() < 1e-5, "{} {truth}", verdict.spectral_radius);
            judged += 1;
        }
    }
    assert!(judged > 390);
}

/// Against 30 nodes more: the error falls faster than any power of the number of nodes.
#[test]
fn collocation_converges_exponentially() {
    let cut = standard(1, 1.0, Direction::Down);
    let mut at_speed = cut.at_speed(rpm(10000.0)).unwrap();
    let truth = at_speed.multipliers(2e-3, 16).unwrap()[0].norm();
    let verdict = at_speed.verdict(2e-3).unwrap().spectral_radius;
    let limit = at_speed.limit(12e-3).unwrap().depth;
    assert!((verdict / truth - 1.0).abs() < 1e-7, "{verdict} {truth}");
    assert!((at_speed.multipliers(limit, 16).unwrap()[0].norm() - 1.0).abs() < 1e-10);
}

proptest! {
    /// Lengths, masses and times in other units: only ratios matter.
    #[test]
    fn verdicts_do_not_depend_on_units(
        length in 0.1f64..10.0, mass in 0.1f64..10.0, time in 0.1f64..10.0,
        speed in 5000.0f64..25000.0, depth in 1e-4f64..5e-3, immersion in 0.05f64..1.0,
    ) {
        let cut = standard(2, immersion, Direction::Up);
        let mut scaled = cut.clone();
        for mode in &mut scaled.modes {
            mode.natural_frequency /= time;
            mode.stiffness *= mass / (time * time);
        }
        let pressure = mass / (length * time * time);
        scaled.force.tangential *= pressure;
        scaled.force.radial *= pressure;
        scaled.cutter.diameter *= length;
        let original = cut.verdict(rpm(speed), depth).unwrap();
        let other = scaled.verdict(rpm(speed) / time, depth * length).unwrap();
        prop_assert!((original.spectral_radius / other.spectral_radius - 1.0).abs() < 1e-7);
        prop_assert!((original.chatter_frequency / (other.chatter_frequency * time) - 1.0).abs() < 1e-5);
    }

    /// Turning structure and feed direction by any angle leaves an isotropic structure unchanged.
    #[test]
    fn isotropic_structure_has_no_axes(angle in 0.0f64..PI, speed in 6000.0f64..20000.0) {
        let cut = standard(2, 0.3, Direction::Down);
        let mut turned = cut.clone();
        turned.modes[0].direction = [angle.cos(), angle.sin()];
        turned.modes[1].direction = [-angle.sin(), angle.cos()];
        let (a, b) = (cut.verdict(rpm(speed), 1e-3).unwrap(), turned.verdict(rpm(speed), 1e-3).unwrap());
        prop_assert!((a.spectral_radius / b.spectral_radius - 1.0).abs() < 1e-7);
    }
}

#[test]
fn neutral_options_change_nothing() {
    let cut = standard(2, 0.4, Direction::Down);
    let radius = |cut: &Milling| cut.verdict(rpm(9000.0), 0.5e-3).unwrap();
    let plain = radius(&cut);
    // Equal pitch written out, one revolution instead of one tooth period: the radius is squared.
    let mut pitched = cut.clone();
    pitched.cutter.pitch = vec![PI, PI];
    assert_eq!(radius(&pitched), plain);
    pitched.cutter.pitch = vec![PI * (1.0 + 1e-9), PI * (1.0 - 1e-9)];
    let revolution = radius(&pitched).spectral_radius;
    assert!((revolution / plain.spectral_radius.powi(2) - 1.0).abs() < 1e-6, "{revolution}");
    // A hair of helix, of runout and of process damping.
    let mut helical = cut.clone();
    helical.cutter.helix_angle = 1e-4;
    assert!((radius(&helical).spectral_radius / plain.spectral_radius - 1.0).abs() < 1e-3);
    let mut eccentric = cut.clone();
    eccentric.cutter.runout = 1e-12;
    assert!((radius(&eccentric).spectral_radius / plain.spectral_radius.powi(2) - 1.0).abs() < 1e-5);
    let mut damped = cut.clone();
    damped.force.process_damping = 1e-3;
    assert!((radius(&damped).spectral_radius / plain.spectral_radius - 1.0).abs() < 1e-6);
}

#[test]
fn process_damping_stabilises_milling() {
    let cut = standard(2, 0.5, Direction::Down);
    let mut damped = cut.clone();
    damped.force.process_damping = 2e5;
    let limit = |cut: &Milling| cut.at_speed(rpm(3000.0)).unwrap().limit(12e-3).unwrap().depth;
    assert!(limit(&damped) > 1.1 * limit(&cut), "{} {}", limit(&damped), limit(&cut));
}

/// Twice the runout of the feed: one tooth of two does all the work, as a cutter with one tooth.
#[test]
fn great_runout_leaves_one_tooth() {
    let mut eccentric = standard(1, 0.2, Direction::Down);
    eccentric.cutter.runout = 0.2e-3;
    let mut single = standard(1, 0.2, Direction::Down);
    single.cutter.teeth = 1;
    for depth in [0.5e-3, 2e-3] {
        let radius = |cut: &Milling| cut.verdict(rpm(8000.0), depth).unwrap().spectral_radius;
        assert!((radius(&eccentric) / radius(&single) - 1.0).abs() < 1e-7);
    }
}

/// A helix whose lag is one pitch makes the force constant in time; a wall of helices is averaged.
#[test]
fn helix_of_one_pitch_cannot_flip() {
    let mut cut = standard(1, 0.05, Direction::Down);
    let straight = cut.verdict(rpm(16000.0), 5.6e-3).unwrap();
    assert_eq!(straight.kind, ChatterKind::Flip);
    cut.cutter.helix_angle = (PI * cut.cutter.diameter / 2.0 / 5.6e-3).atan();
    let helical = cut.verdict(rpm(16000.0), 5.6e-3).unwrap();
    assert_ne!(helical.kind, ChatterKind::Flip);
}

#[test]
fn varying_speed_of_zero_amplitude_is_constant_speed() {
    let cut = standard(1, 0.3, Direction::Up);
    let still = SpeedVariation { amplitude: 0.0, revolutions: 4, phase: Some(0.0) };
    let varying = cut.at_varying_speed(rpm(12000.0), still).unwrap().verdict(1.2e-3).unwrap();
    let constant = cut.verdict(rpm(12000.0), 1.2e-3).unwrap();
    // A revolution is two tooth periods.
    assert!((varying.spectral_radius / constant.spectral_radius.powi(2) - 1.0).abs() < 1e-6);
    assert!((varying.period / (2.0 * constant.period) - 1.0).abs() < 1e-12);
    let moving = SpeedVariation { amplitude: 0.2, revolutions: 4, phase: Some(0.0) };
    let moving = cut.at_varying_speed(rpm(12000.0), moving).unwrap().verdict(1.2e-3).unwrap();
    assert!((moving.spectral_radius / varying.spectral_radius - 1.0).abs() > 1e-2);
}

#[test]
fn boundary_agrees_with_the_full_chart() {
    for (degrees, immersion) in [(1, 0.05), (1, 1.0), (2, 0.5)] {
        let cut = standard(degrees, immersion, Direction::Down);
        let speed = Axis { start: rpm(8000.0), end: rpm(20000.0), points: 81 };
        let depth = Axis { start: 0.0, end: 8e-3, points: 81 };
        let chart = cut.lobes(&speed.values("speed").unwrap(), &depth.values("depth").unwrap()).unwrap();
        let boundary = cut.boundary(&speed, 8e-3).unwrap();
        let mut compared = 0;
        for (i, n) in chart.speed.iter().enumerate() {
            for (j, b) in chart.depth.iter().enumerate() {
                // Within one cell of the boundary the two may differ.
                let (cell, column) = (1e-4, chart.speed[1] - chart.speed[0]);
                let around = [(0.0, 0.0), (0.0, cell), (0.0, -cell), (column, 0.0), (-column, 0.0)];
                let sure = around.map(|(dn, db)| boundary.is_stable(n + dn, b + db));
                if sure[0].is_some() && sure.iter().all(|s| *s == sure[0]) {
                    assert_eq!(sure[0], Some(chart.at(i, j).unwrap().stable), "{immersion} {n} {b}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 81 * 81 * 7 / 10, "{compared}");
    }
}

/// At every sampled depth of every column the curve tells the side that a verdict tells, and the
/// curve is where the radius is one.
#[test]
fn no_change_between_sampled_depths_is_missed() {
    let (greatest, steps) = (10e-3, 16);
    let (mut sampled, mut islands) = (0, 0);
    for (immersion, direction) in [
        (0.05, Direction::Down),
        (0.05, Direction::Up),
        (0.3, Direction::Down),
        (0.6, Direction::Up),
        (1.0, Direction::Down),
    ] {
        let cut = standard(1, immersion, direction);
        let speed = Axis { start: rpm(4000.0), end: rpm(22000.0), points: 61 };
        for column in cut.boundary(&speed, greatest).unwrap().columns {
            let mut at_speed = cut.at_speed(column.speed).unwrap();
            for step in 1..=steps {
                let depth = greatest * step as f64 / steps as f64;
                let verdict = at_speed.verdict(depth).unwrap();
                if (verdict.spectral_radius - 1.0).abs() > 1e-3 {
                    let below = column.crossings.iter().filter(|crossing| crossing.limit.depth < depth).count();
                    assert_eq!(verdict.stable, below % 2 == 0, "{immersion} {} rad/s {depth} m", column.speed);
                    sampled += 1;
                }
            }
            for crossing in &column.crossings {
                let radius = at_speed.verdict(crossing.limit.depth).unwrap().spectral_radius;
                assert!((radius - 1.0).abs() < 5e-3, "{immersion} {} rad/s {radius}", column.speed);
            }
            islands += usize::from(column.crossings.len() > 1);
        }
    }
    assert!(sampled > 4000 && islands > 4, "{sampled} {islands}");
}

#[test]
fn a_chart_at_varying_speed_is_that_of_constant_speed_where_nothing_varies() {
    let cut = standard(1, 1.0, Direction::Down);
    let speed = Axis { start: rpm(11000.0), end: rpm(13000.0), points: 5 };
    let still = SpeedVariation { amplitude: 0.0, revolutions: 2, phase: Some(0.0) };
    let boundary = cut.boundary_at_varying_speed(&speed, still, 4e-3).unwrap();
    for column in &boundary.columns {
        let limit = cut.at_speed(column.speed).unwrap().limit(4e-3).unwrap().depth;
        assert!((column.crossings[0].limit.depth - limit).abs() < 4e-3 / 48.0 * 2e-3, "{} rad/s", column.speed);
    }
    let chart = cut.lobes_at_varying_speed(&[rpm(12000.0)], still, &[0.2e-3, 3.9e-3]).unwrap();
    assert_eq!(chart.verdicts.iter().flatten().map(|verdict| verdict.stable).collect::<Vec<_>>(), [true, false]);
    let varying = SpeedVariation { amplitude: 0.3, revolutions: 1, phase: Some(0.0) };
    assert!(cut.boundary_at_varying_speed(&speed, varying, 4e-3).is_err());
}

#[test]
fn chart_points_are_verdicts() {
    let cut = standard(1, 0.3, Direction::Down);
    let (speed, depth) = ([6000.0, 7000.0, 8000.0, 9000.0].map(rpm), [0.5e-3, 1e-3, 1.5e-3, 2e-3]);
    let chart = cut.lobes(&speed, &depth).unwrap();
    assert_eq!(chart, cut.lobes(&speed, &depth).unwrap());
    // Filled in parts it is the same.
    let parts = [&speed[..1], &speed[1..]].map(|speed| cut.lobes(speed, &depth).unwrap().verdicts);
    assert_eq!(chart.verdicts, parts.concat());
    for (i, n) in chart.speed.iter().enumerate() {
        for (j, b) in chart.depth.iter().enumerate() {
            let (quick, slow) = (chart.at(i, j).unwrap(), cut.verdict(*n, *b).unwrap());
            assert_eq!(quick.stable, slow.stable);
            assert!((quick.spectral_radius / slow.spectral_radius - 1.0).abs() < 1e-3);
        }
    }
}

/// 12 000 rpm sits on the flank of a lobe; with 2 % scatter in frequency 12 500 is the surer choice.
#[test]
fn robust_speed_leaves_the_flank() {
    let cut = standard(2, 0.05, Direction::Down);
    let scatter = Scatter { natural_frequency: 0.02, damping_ratio: 0.2, coefficients: 0.1 };
    let probability = |speed: f64| cut.stability_probability(rpm(speed), 5e-3, &scatter, 400, 7).unwrap();
    let (flank, robust) = (probability(12000.0), probability(12800.0));
    assert!(robust.value > flank.value + 0.1, "{flank:?} {robust:?}");
    assert_eq!(flank, probability(12000.0));
    let axis = Axis { start: rpm(11000.0), end: rpm(14000.0), points: 16 };
    let best = cut.robust_speeds(&axis, 5e-3, &scatter, 200, 7).unwrap()[0];
    assert!(best.spindle_speed > rpm(12200.0) && best.spindle_speed < rpm(13600.0), "{best:?}");
    // The same without judging what cannot be the best any more: the first of the most probable, in the order given.
    for depth in [2e-3, 5e-3, 7e-3] {
        let mut speeds: Vec<f64> = axis.values("speed").unwrap();
        speeds.sort_by(|a, b| (a - rpm(12500.0)).abs().total_cmp(&(b - rpm(12500.0)).abs()));
        let ranked = cut.robust_speeds(&axis, depth, &scatter, 50, 7).unwrap();
        let value = ranked[0].probability.value;
        let equals: Vec<f64> =
            ranked.iter().filter(|each| each.probability.value == value).map(|each| each.spindle_speed).collect();
        let first = speeds.iter().find(|speed| equals.contains(speed)).copied();
        assert_eq!(cut.most_probably_stable(&speeds, depth, &scatter, 50, 7).unwrap(), first, "{depth} m");
    }
    let certain = Scatter { natural_frequency: 0.0, damping_ratio: 0.0, coefficients: 0.0 };
    assert_eq!(cut.stability_probability(rpm(12000.0), 5e-3, &certain, 3, 7).unwrap().value, 1.0);
}

/// Radii over one revolution from an independent semi-discretisation (720 steps, Richardson), whose
/// own error is about 1e-4 because teeth enter and leave between its steps; and the collocation's
/// own convergence, which is far closer.
#[test]
fn irregular_cutters_agree_with_semi_discretisation() {
    let degree = PI / 180.0;
    let mut pitched = standard(2, 0.3, Direction::Down);
    pitched.cutter.teeth = 3;
    pitched.cutter.pitch = vec![100.0 * degree, 120.0 * degree, 140.0 * degree];
    let mut helical = pitched.clone();
    helical.cutter.helix_angle = 30.0 * degree;
    let mut eccentric = standard(2, 0.6, Direction::Up);
    eccentric.cutter.runout = 30e-6;
    eccentric.cutter.runout_angle = 0.4;
    let mut damped = standard(2, 0.5, Direction::Down);
    damped.force.process_damping = 2e5;
    let rows = [
        (pitched, 9000.0, 0.4e-3, 1.115963, 1.0),
        (helical, 9000.0, 2e-3, 6.97716, 1.0),
        (eccentric, 7000.0, 0.2e-3, 0.675994, 1.0),
        (damped, 4000.0, 0.2e-3, 0.447663, 2.0),
    ];
    for (cut, speed, depth, reference, periods) in rows {
        let mut at_speed = cut.at_speed(rpm(speed)).unwrap();
        let radius = at_speed.verdict(depth).unwrap().spectral_radius;
        assert!((radius.powf(periods) / reference - 1.0).abs() < 3e-4, "{} {reference}", radius.powf(periods));
        let finer = at_speed.multipliers(depth, 8).unwrap()[0].norm();
        assert!((radius / finer - 1.0).abs() < 1e-6, "{radius} {finer}");
    }
}

#[test]
fn a_cut_of_no_depth_is_stable_and_decays_as_the_structure_does() {
    let slow = Mode { direction: [1.0, 0.2], natural_frequency: 540.9, damping_ratio: 0.038, stiffness: 6.48e6 };
    let fast = Mode { direction: [0.8, 1.0], natural_frequency: 911.0, damping_ratio: 0.011, stiffness: 2.1e7 };
    let radius = |modes: &[Mode], time: f64| {
        modes.iter().map(|mode| (-mode.damping_ratio * TAU * mode.natural_frequency * time).exp()).fold(0.0, f64::max)
    };
    let variation = SpeedVariation { amplitude: 0.2, revolutions: 5, phase: Some(0.0) };
    for modes in [vec![slow], vec![fast], vec![slow, fast]] {
        let turning = Turning { process_damping: 6e5, ..Turning::orthogonal(modes.clone(), 1384e6, 0.035) };
        let milling = Milling { modes: modes.clone(), ..standard(2, 0.5, Direction::Down) };
        for rpm_speed in [800.0, 6000.0, 23_456.0] {
            let speed = rpm(rpm_speed);
            let turn = TAU / speed;
            let still = turning.verdict(speed, 0.0).unwrap();
            let varying = turning.verdict_at_varying_speed(speed, variation, 0.0).unwrap();
            let tooth = milling.verdict(speed, 0.0).unwrap();
            let chart = milling.lobes(&[speed], &[0.0, 1e-9]).unwrap();
            let of_teeth = milling.at_varying_speed(speed, variation).unwrap().verdict(0.0).unwrap();
            for (verdict, time) in [
                (still, turn),
                (varying, turn),
                (tooth, 0.5 * turn),
                (*chart.at(0, 0).unwrap(), 0.5 * turn),
                (of_teeth, turn),
            ] {
                let expected = radius(&modes, time);
                assert!(
                    verdict.stable && (verdict.spectral_radius / expected - 1.0).abs() < 1e-9,
                    "{verdict:?} {expected}"
                );
            }
            // A cut of a nanometre is no other.
            let (none, nanometre) = (chart.at(0, 0).unwrap(), chart.at(0, 1).unwrap());
            assert!((none.spectral_radius / nanometre.spectral_radius - 1.0).abs() < 1e-3, "{none:?} {nanometre:?}");
            assert!((none.period - nanometre.period).abs() < 1e-12);
        }
    }
}
