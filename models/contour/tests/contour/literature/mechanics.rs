//! Geometry, engagement, forces, life, constraints, form along the axis.

use super::fixture::{RPM, beginning, decimals, mc1, models, rk3, setting, six};
use std::f64::consts::{PI, TAU};
use toolroom_contour::{
    Constraint, Cutter, Economics, EdgeForce, Engagement, Forces, HandbookForce, HelicalCut, MillLife, Milling,
    Parameters, Pass, Planner, Shape,
};

#[test]
fn m1_lengths_of_the_reference_contours() {
    let contour = mc1();
    six("MC-1", contour.length() * 1e3, 463.409);
    six("MC-1 centre path", contour.centre_length(16e-3) * 1e3, 488.542);
    let angles: Vec<f64> = contour.corners.iter().map(|corner| corner.interior_angle.to_degrees()).collect();
    for (angle, expected) in angles.iter().zip([90.0, 90.0, 146.31, 123.69]) {
        decimals("corner", *angle, expected, 2);
    }
    let hole = rk3(3.5e-3, 18);
    six("RK-3 (Barbier)", hole.length() * 1e3, 314.159);
    six("RK-3 centre path", hole.centre_length(16e-3) * 1e3, 213.628);
    let fine = rk3(3.5e-3, 7200);
    decimals("smallest radius", fine.smallest_concave_radius() * 1e3, 22.0, 3);
    decimals("ratio", 16e-3 / fine.smallest_concave_radius(), 0.727273, 5);
}

#[test]
fn m2_engagement_angle_and_immersion() {
    let mm = |shape: fn(f64) -> Shape, radius: f64| shape(radius * 1e-3);
    #[rustfmt::skip]
    let table = [
        (Shape::Straight, [14.3615, 0.5, 35.6591, 3.0]),
        (mm(Shape::Convex, 22.0), [10.9774, 0.292763, 27.8656, 1.85526]),
        (mm(Shape::Convex, 30.0), [11.6357, 0.328804, 29.3545, 2.05435]),
        (mm(Shape::Convex, 1e6), [14.3614, 0.499992, 35.6588, 2.99996]),
        (mm(Shape::Concave, 22.0), [27.5362, 1.8125, 68.9382, 10.25]),
        (mm(Shape::Concave, 30.0), [20.9979, 1.0625, 51.8076, 6.10714]),
        (mm(Shape::Concave, 50.0), [17.3936, 0.731618, 42.9005, 4.27941]),
        (mm(Shape::Concave, 78.0), [16.0933, 0.627016, 39.7673, 3.70161]),
        (mm(Shape::Concave, 1e6), [14.3616, 0.500008, 35.6594, 3.00004]),
    ];
    for (shape, [thin_angle, thin, thick_angle, thick]) in table {
        for (allowance, angle, immersion) in [(0.5e-3, thin_angle, thin), (3e-3, thick_angle, thick)] {
            let engagement = Engagement::new(shape, 16e-3, allowance);
            six(&format!("{shape:?} angle"), engagement.angle.to_degrees(), angle);
            six(&format!("{shape:?} immersion"), engagement.immersion * 1e3, immersion);
        }
    }
}

#[test]
fn m3_mean_forces() {
    let force = EdgeForce::default();
    let angle = |allowance: f64| Engagement::new(Shape::Straight, 16e-3, allowance).angle;
    let concave = Engagement::new(Shape::Concave(22e-3), 16e-3, 3e-3).angle;
    #[rustfmt::skip]
    let table = [
        (angle(0.5e-3), Milling::Down, [276.235, 191.265, -251.006]),
        (angle(0.5e-3), Milling::Up, [276.235, 107.827, 293.865]),
        (angle(3e-3), Milling::Down, [1307.21, 1039.47, -978.023]),
        (angle(3e-3), Milling::Up, [1307.21, 49.7993, 1406.34]),
        (concave, Milling::Down, [4099.54, 3902.67, -1744.66]),
        (concave, Milling::Up, [4099.54, -1512.32, 3919.84]),
    ];
    for (angle, milling, [tangential, normal, feed]) in table {
        let forces = force.mean(angle, 30e-3, 4.0, milling).at(0.1e-3);
        six("tangential", forces.tangential, tangential);
        six("normal", forces.normal, normal);
        six("feed", forces.feed, feed);
        // The same by quadrature over 20 000 points of a tooth's way.
        let n = 20_000;
        let mut sum = Forces::default();
        for i in 0..n {
            let tooth = force.of_tooth(0.1e-3, (f64::from(i) + 0.5) / f64::from(n) * angle, milling);
            let share = 30e-3 * 4.0 / TAU * angle / f64::from(n);
            sum.tangential += share * tooth.tangential;
            sum.normal += share * tooth.normal;
            sum.feed += share * tooth.feed;
        }
        for (a, b) in [(sum.tangential, tangential), (sum.normal, normal), (sum.feed, feed)] {
            assert!((a / b - 1.0).abs() < 1e-5);
        }
    }
    decimals("angle", angle(0.5e-3), 0.250656, 6);
    decimals("angle", angle(3e-3), 0.622368, 6);
    decimals("angle", concave, 1.2032, 4);
}

#[test]
fn before_a_hollow_arc_the_feed_that_keeps_the_force_falls_to_a_fifth() {
    // Engagement, deg; greatest feed of a tooth at a mean normal force of 2000 N, mm: a straight wall, then into the arc.
    let table = [
        (35.6591, 0.22696),
        (36.7187, 0.21068),
        (40.9388, 0.15963),
        (50.7887, 0.09195),
        (60.6377, 0.05862),
        (68.9382, 0.04260),
    ];
    let normal = |angle: f64, feed: f64| {
        EdgeForce::default().mean(angle.to_radians(), 30e-3, 4.0, Milling::Down).at(1e-3 * feed).normal
    };
    for (angle, greatest) in table {
        // The force is a straight line of the feed.
        let (low, high) = (normal(angle, 0.0), normal(angle, 1.0));
        decimals("feed", (2000.0 - low) / (high - low), greatest, 4);
    }
    decimals("before the arc", normal(35.6591, 0.18), 1645.0, 0);
    decimals("in the arc", normal(68.9382, 0.18), 6554.0, 0);
}

#[test]
fn m4_calibration_to_the_handbook_force() {
    let immersions: Vec<f64> = (1..=8).map(|i| 0.5e-3 * f64::from(i)).collect();
    let feeds: Vec<f64> = (2..=10).map(|i| 0.02e-3 * f64::from(i)).collect();
    let fit = HandbookForce::default().calibrate(&immersions, &feeds, 32e-3, 1000.0 * RPM).unwrap();
    six("Ktc", fit.tangential_cutting * 1e-6, 2962.71);
    six("Kte", fit.tangential_edge * 1e-3, 20.8096);
    decimals("rms", fit.rms, 0.043851, 6);
    decimals("greatest", fit.greatest, 0.170407, 6);
    six("tool", Cutter::default().shank_stiffness() * 1e-3, 31483.8);
    six("total", Cutter::default().stiffness() * 1e-3, 13934.9);
}

#[test]
fn m5_tool_life() {
    let life = MillLife::default();
    #[rustfmt::skip]
    let table = [
        (3.0, 0.08, 161.025, 1601.74, 428.681, 120.353),
        (3.0, 0.15, 136.745, 1360.23, 275.61, 77.3784),
        (0.5, 0.06, 266.767, 2653.58, 1677.55, 470.977),
        (0.5, 0.15, 210.217, 2091.07, 881.134, 247.381),
        (10.2499, 0.08, 119.903, 1192.69, 193.204, 54.2426),
    ];
    for (immersion, feed, speed, rpm, at_1000, at_1600) in table {
        let (immersion, feed) = (immersion * 1e-3, feed * 1e-3);
        let computed = life.speed_for(7200.0, feed, immersion, 30e-3, 4.0, 32e-3);
        six("speed", computed * 60.0, speed);
        six("rpm", computed * 60.0 / (PI * 32e-3), rpm);
        let minutes = |rpm: f64| life.tool_life(rpm * RPM, feed, immersion, 30e-3, 4.0, 32e-3) / 60.0;
        six("life at 1000", minutes(1000.0), at_1000);
        six("life at 1600", minutes(1600.0), at_1600);
    }
    let Economics { edge_change_time, edge_cost, machine_rate } = Economics::default();
    six("economic life", life.economic_life(edge_change_time, edge_cost, machine_rate) / 60.0, 35.7568);
}

#[test]
fn m8_constraint_ratios() {
    use Constraint::*;
    let contour = beginning(&mc1(), 5);
    let (parameters, pass, models) = (Parameters::default(), Pass::default(), models());
    let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
    const NAMES: [Constraint; 12] = [
        HighestFeed,
        LowestFeed,
        LowestSpindleSpeed,
        HighestSpindleSpeed,
        Power,
        FeedForce,
        ToothStrength,
        BodyStrength,
        ChipSpace,
        ToolLife,
        Accuracy,
        Roughness,
    ];
    // Ratios, then Ft Fn Ff [N], immersion, Rz [um], deflection, path error [mm], life [min].
    #[rustfmt::skip]
    let table = [
        (0, [0.457143, 0.117188, 0.025, 0.8, 0.107636, 0.0278664, 0.235661, 0.0712712, 0.00585938, 0.311872, 0.24863, 0.38],
            [240.903, 173.231, -218.277, 0.5, 3.8, 0.0124315, 0.0, 384.773]),
        (2, [0.457143, 0.117188, 0.025, 0.8, 0.0775714, 0.0203329, 0.20314, 0.0519825, 0.00385318, 0.23763, 1.16546, 0.352174],
            [173.614, 124.989, -160.375, 0.328804, 3.52174, 0.00896955, 0.0493036, 504.987]),
        (4, [0.457143, 0.117188, 0.025, 0.8, 0.31421, 0.0785027, 0.386, 0.201022, 0.0212402, 0.719069, 1.75999, 0.593333],
            [703.238, 539.224, -570.53, 1.8125, 5.93333, 0.038696, 0.0493036, 166.882]),
    ];
    for (section, ratios, [ft, fn_, ff, immersion, rz, deflection, error, life]) in table {
        let evaluation = planner.evaluate(section, setting(1600.0, 0.08)).unwrap();
        six("feed", evaluation.feed * 60e3, 512.0);
        for (name, ratio) in NAMES.into_iter().zip(ratios) {
            six(name.name(), evaluation.ratios.of(name), ratio);
        }
        six("Ft", evaluation.forces.tangential, ft);
        six("Fn", evaluation.forces.normal, fn_);
        six("Ff", evaluation.forces.feed, ff);
        six("immersion", evaluation.engagement.immersion * 1e3, immersion);
        six("Rz", evaluation.roughness * 1e6, rz);
        six("deflection", evaluation.deflection * 1e3, deflection);
        six("path error", evaluation.path_error * 1e3, error);
        six("life", evaluation.tool_life / 60.0, life);
    }
}

/// Force at a rotation by the midpoint rule over slices of the axis, as the reference has it.
fn by_slices(cut: &HelicalCut, feed: f64, rotation: f64, slices: u32) -> f64 {
    let (height, pitch, sign) = (cut.depth_of_cut / f64::from(slices), TAU / cut.teeth, cut.milling.sign());
    let mut force = 0.0;
    for slice in 0..slices {
        let lag = cut.lag * (f64::from(slice) + 0.5) * height;
        for tooth in 0..cut.teeth as u32 {
            let angle = (sign * (lag - rotation) + f64::from(tooth) * pitch).rem_euclid(TAU);
            if angle < cut.engagement_angle {
                force += height * cut.force.of_tooth(feed, angle, cut.milling).normal;
            }
        }
    }
    force
}

#[test]
fn m11_surface_of_a_helical_cutter() {
    let (force, cutter) = (EdgeForce::default(), Cutter::default());
    let stiffness = cutter.stiffness();
    #[rustfmt::skip]
    let table = [
        (0.5, Milling::Down, [173.222, 0.0, 208.658], 173.231, [14.9667, 14.9667, 14.9667, 14.9667, 2.41608]),
        (0.5, Milling::Up, [101.503, 0.0, 121.877], 101.515, [2.19601, 8.74547, 8.74547, 8.74547, 8.74547]),
        (3.0, Milling::Down, [888.428, 387.636, 1066.34], 888.156, [76.0315, 76.0315, 76.0315, 31.951, 56.2127]),
        (3.0, Milling::Up, [66.607, -45.5141, 161.165], 66.6273, [-2.70913, 8.56961, 5.77895, 5.77895, 5.77895]),
    ];
    for (allowance, milling, [mean, least, greatest], closed, errors) in table {
        let engagement_angle = Engagement::new(Shape::Straight, 16e-3, allowance * 1e-3).angle;
        let cut = HelicalCut {
            force: &force,
            milling,
            engagement_angle,
            depth_of_cut: 30e-3,
            teeth: 4.0,
            lag: cutter.helix_lag(),
        };
        let feed = 0.08e-3;
        let rotations: Vec<f64> = (0..360).map(|i| (f64::from(i) + 0.5) / 360.0 * TAU / 4.0).collect();
        let forces: Vec<f64> = rotations.iter().map(|rotation| by_slices(&cut, feed, *rotation, 600)).collect();
        six("mean", forces.iter().sum::<f64>() / 360.0, mean);
        six("least", forces.iter().copied().fold(f64::MAX, f64::min), least);
        six("greatest", forces.iter().copied().fold(f64::MIN, f64::max), greatest);
        six("closed", force.mean(engagement_angle, 30e-3, 4.0, milling).at(feed).normal, closed);
        let scale = greatest.abs();
        for (rotation, sliced) in rotations.iter().zip(&forces) {
            // The slices resolve an edge of the engagement to half a slice.
            assert!((cut.normal_force(feed, *rotation) - sliced).abs() < 3e-3 * scale + 3.0);
        }
        for (share, error) in [0.05, 0.25, 0.5, 0.75, 0.95].into_iter().zip(errors) {
            let height = share * 30e-3;
            six("surface", by_slices(&cut, feed, cut.lag * height, 600) / stiffness * 1e6, error);
            let exact = cut.finishing_force(feed, height) / stiffness * 1e6;
            assert!((exact - error).abs() < 3e-3 * error.abs() + 0.25, "{exact} {error}");
        }
    }
}

#[test]
fn slices_converge_to_the_exact_force() {
    let (force, cutter) = (EdgeForce::default(), Cutter::default());
    let cut = HelicalCut {
        force: &force,
        milling: Milling::Down,
        engagement_angle: 0.622368,
        depth_of_cut: 30e-3,
        teeth: 4.0,
        lag: cutter.helix_lag(),
    };
    let error = |slices: u32| {
        let at = |i: u32| {
            let rotation = 0.0137 + 0.031 * f64::from(i);
            (by_slices(&cut, 1e-4, rotation, slices) - cut.normal_force(1e-4, rotation)).powi(2)
        };
        (0..40).map(at).sum::<f64>().sqrt()
    };
    assert!(error(6400) < 0.2 * error(400), "{} {}", error(6400), error(400));
}
