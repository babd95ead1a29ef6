//! Path errors, loops and corners, inertia.

use super::fixture::{MM_PER_MIN, decimals, six};
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use toolroom_contour::{
    Corner, CornerPolicy, Machine, PathError, VelocityLoop, corner_feed, corner_impulse, corner_undershoot,
    gain_mismatch_error, inertia_force, loop_length,
};

const GAIN: f64 = 16.667;

fn empirical(feed: f64, angle: f64) -> f64 {
    PathError::Empirical.magnitude(feed * MM_PER_MIN, 0.05, angle, GAIN) * 1e3
}

#[test]
fn m6_the_empirical_error_and_its_consistency() {
    #[rustfmt::skip]
    let table = [
        (60.0, [0.000981454, 0.00169637, 0.00197788, 0.00250352], 0.00287357),
        (250.0, [0.00834744, 0.0144279, 0.0168222, 0.0212929], 0.0244402),
        (590.0, [0.0302636, 0.0523083, 0.060989, 0.0771973], 0.088608),
        (1120.0, [0.0791535, 0.136811, 0.159515, 0.201907], 0.231751),
    ];
    for (feed, errors, around) in table {
        for (angle, error) in [0.2, 1.0, FRAC_PI_2, PI].into_iter().zip(errors) {
            six("error", empirical(feed, angle), error);
        }
        six("loop", empirical(feed, 1.5 * PI), around);
    }
    // Lukin writes the loop's limit as 9e-7·V^1.5·(180 + α)^0.34 with α in degrees.
    six("9e-7", empirical(1.0, 1.0) * (PI / 180.0).powf(0.34), 9.21576e-07);
    six("V", empirical(590.0, 1.0) / empirical(60.0, 1.0), 30.8355);
    six("l x 10", empirical(60.0, 1.0) / empirical(60.0, 0.1), 2.18776);
    decimals("R 10 to 100", empirical(60.0, 0.1) / empirical(60.0, 1.0), 0.457088, 6);
    six("a tenth of V", (empirical(590.0, 1.0) / empirical(60.0, 1.0)).powf(0.1), 1.40898);
    six("a tenth of l", 10f64.powf(0.034), 1.08143);
    decimals("a tenth of R", 10f64.powf(-0.034), 0.924698, 6);
    decimals("four intervals of R", 10f64.powf(-0.34 / 4.0), 0.822243, 6);
    decimals("three intervals of R", 10f64.powf(-0.34 / 3.0), 0.770312, 6);
    // Feed at which the error takes the whole tolerance, through its power law.
    for (angle, limit) in [(FRAC_PI_2, 516.81), (PI / 3.0, 566.559)] {
        six("limit", (0.05 / empirical(1.0, angle)).powf(2.0 / 3.0), limit);
        six("error at the limit", empirical(limit, angle), 0.05);
    }
}

#[test]
fn m7_corner_loops_and_their_alternatives() {
    let machine = Machine::default();
    let sharpest = (30f64.atan2(20.0)).to_degrees();
    // α, length for R_tr 2 and 5 mm, feed, time, undershoot at 250 mm/min, feed for 0.05 mm.
    #[rustfmt::skip]
    let table = [
        (30.0, 141.684, 175.072, 426.504, 19.932, 0.168442, 74.2097),
        (60.0, 70.7314, 93.6901, 413.788, 10.2562, 0.15331, 81.5341),
        (90.0, 45.4248, 65.5619, 402.887, 6.76489, 0.127213, 98.2602),
        (180.0 - sharpest, 29.8674, 48.9797, 392.291, 4.56815, 0.08605, 145.264),
        (90.0 + sharpest, 22.2903, 41.1925, 385.955, 3.46522, 0.0531399, 235.228),
    ];
    for (angle, short, long, feed, time, undershoot, slow) in table {
        let angle = f64::to_radians(angle);
        let corner = Corner { after: 0, interior_angle: angle };
        six("length", loop_length(angle, 16e-3, 2e-3) * 1e3, short);
        six("length", loop_length(angle, 16e-3, 5e-3) * 1e3, long);
        let policy = CornerPolicy::Loop { radius: 2e-3, tolerance: None };
        let around = policy.pass(corner, 16e-3, 0.05e-3, &machine, &PathError::Empirical);
        six("feed", around.feed / MM_PER_MIN, feed);
        six("time", around.time, time);
        let crossed = corner_undershoot(250.0 * MM_PER_MIN, angle, GAIN) * 1e3;
        // The reference takes the least of a grid of 10 us.
        assert!((crossed / undershoot - 1.0).abs() < 5e-6, "{crossed} {undershoot}");
        let slowed = corner_feed(0.05e-3, angle, GAIN) / MM_PER_MIN;
        assert!((slowed / slow - 1.0).abs() < 5e-6, "{slowed} {slow}");
    }
    six("settling", 3.0 / GAIN, 0.179996);
}

#[test]
fn m12_path_errors_on_arcs() {
    let euler = PathError::ExplicitEuler { step: 0.01 };
    let loop_120 = PathError::Servo { velocity_loop: Some(VelocityLoop { frequency: 120.0, damping: 0.7 }) };
    // V, R; eq. (14), Euler, V dt/2, servo at 16.667 and 10, V²/(2 K² R), second-order loop,
    // inertia N, deflection.
    #[rustfmt::skip]
    let table = [
        (60.0, 10.0, [1.97788, 5.00042, 5.0, 0.179988, 0.499963, 0.179993, 0.109992, 0.03, 0.00015]),
        (60.0, 50.0, [1.97788, 5.00008, 5.0, 0.0359985, 0.0999997, 0.0359986, 0.0219988, 0.006, 3e-05]),
        (60.0, 100.0, [1.97788, 5.00004, 5.0, 0.0179993, 0.05, 0.0179993, 0.0109994, 0.003, 1.5e-05]),
        (250.0, 10.0, [16.8222, 20.8406, 20.8333, 3.12341, 8.66927, 3.12488, 1.90907, 0.520833, 0.00260417]),
        (250.0, 50.0, [16.8222, 20.8348, 20.8333, 0.624963, 1.73602, 0.624975, 0.38192, 0.104167, 0.000520833]),
        (250.0, 100.0, [16.8222, 20.8341, 20.8333, 0.312486, 0.868044, 0.312488, 0.190962, 0.0520833, 0.000260417]),
        (590.0, 10.0, [60.989, 49.207, 49.1667, 17.359, 47.9994, 17.4043, 10.6188, 2.90083, 0.0145042]),
        (590.0, 50.0, [60.989, 49.1747, 49.1667, 3.4805, 9.66664, 3.48086, 2.12703, 0.580167, 0.00290083]),
        (590.0, 100.0, [60.989, 49.1707, 49.1667, 1.74038, 4.83437, 1.74043, 1.06357, 0.290083, 0.00145042]),
        (1120.0, 10.0, [159.515, 93.4752, 93.3333, 62.1336, 169.798, 62.7175, 38.1073, 10.4533, 0.0522667]),
        (1120.0, 50.0, [159.515, 93.3624, 93.3333, 12.5388, 34.8081, 12.5435, 7.66361, 2.09067, 0.0104533]),
        (1120.0, 100.0, [159.515, 93.3477, 93.3333, 6.27116, 17.4177, 6.27175, 3.83247, 1.04533, 0.00522667]),
    ];
    for (mm_per_min, mm, [law, marched, half, servo, weak, parabola, second, inertia, bent]) in table {
        let (feed, radius) = (mm_per_min * MM_PER_MIN, mm * 1e-3);
        let um = |path_error: PathError, gain: f64| path_error.magnitude(feed, radius, FRAC_PI_2, gain) * 1e6;
        six("eq. (14)", um(PathError::Empirical, GAIN), law);
        six("Euler", um(euler, GAIN), marched);
        six("V dt/2", 0.5 * feed * 0.01 * 1e6, half);
        six("servo", um(PathError::default(), GAIN), servo);
        six("servo 10", um(PathError::default(), 10.0), weak);
        six("parabola", feed * feed / (2.0 * GAIN * GAIN * radius) * 1e6, parabola);
        six("velocity loop", um(loop_120, GAIN), second);
        let force = inertia_force(300.0, feed, radius);
        six("inertia", force, inertia);
        six("bent", force / Machine::default().structural_stiffness * 1e6, bent);
    }
    for (step, error) in [(0.02, 98.3652), (0.01, 49.1747), (0.005, 24.5853), (0.001, 4.91675)] {
        let magnitude = PathError::ExplicitEuler { step }.magnitude(590.0 * MM_PER_MIN, 50e-3, FRAC_PI_2, GAIN);
        six("Euler", magnitude * 1e6, error);
    }
    six("impulse", corner_impulse(300.0, 250.0 * MM_PER_MIN, FRAC_PI_2, 0.01), 176.777);
    six("impulse", corner_impulse(300.0, 1120.0 * MM_PER_MIN, FRAC_PI_2, 0.01), 791.96);
    six("of the chord", 2.0 * (0.25 * PI).sin(), SQRT_2);
    six("mismatch", gain_mismatch_error(590.0 * MM_PER_MIN, GAIN, 1.05 * GAIN) * 1e6, 14.0473);
    // Local exponents at 300 mm/min and 50 mm, from differences of 1 %.
    let at = |law: PathError, v: f64, r: f64| law.magnitude(300.0 * v * MM_PER_MIN, 0.05 * r, FRAC_PI_2, GAIN).ln();
    let span = 1.01f64.ln() - 0.99f64.ln();
    let by_feed = |law| (at(law, 1.01, 1.0) - at(law, 0.99, 1.0)) / span;
    decimals("eq. (14) by V", by_feed(PathError::Empirical), 1.5, 5);
    decimals("servo by V", by_feed(PathError::default()), 1.99994, 4);
    let by_radius = (at(PathError::default(), 1.0, 1.01) - at(PathError::default(), 1.0, 0.99)) / span;
    decimals("servo by R", by_radius, -0.999951, 4);
}
