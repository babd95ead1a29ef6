//! Tapered cutters, and face mills by their lead angle.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use toolroom_chatter::{Cutter, Direction, Engagement, Milling, MillingForce, Mode, SimulationSettings};

const MODES: [Mode; 2] = [
    Mode { direction: [1.0, 0.0], natural_frequency: 900.0, damping_ratio: 0.02, stiffness: 6e6 },
    Mode { direction: [0.0, 1.0], natural_frequency: 1050.0, damping_ratio: 0.025, stiffness: 8e6 },
];

fn cone(taper_degrees: f64, helix_angle: f64, immersion: f64) -> Milling {
    Milling {
        modes: MODES.to_vec(),
        cutter: Cutter { helix_angle, taper_angle: taper_degrees.to_radians(), ..Cutter::straight(2, 0.01) },
        engagement: Engagement::new(immersion, Direction::Down).unwrap(),
        force: MillingForce { axial: 2.2e8, edge_tangential: 2e4, edge_radial: 3e4, ..MillingForce::new(8e8, 1.7e8) },
        feed_per_tooth: 1e-4,
        by_speed: None,
        along_path: None,
    }
}

/// The cylinder that cuts as a cone does in a slot: `K_r cos(alpha) + K_a sin(alpha)` along the radius.
fn cylinder(cone: &Milling) -> Milling {
    let (sine, cosine) = cone.cutter.taper_angle.sin_cos();
    let radial = cone.force.radial * cosine + cone.force.axial * sine;
    let force = MillingForce { radial, edge_tangential: cone.force.edge_tangential / cosine, ..cone.force };
    Milling { cutter: Cutter { taper_angle: 0.0, ..cone.cutter.clone() }, force, ..cone.clone() }
}

/// In a slot every slice of straight flutes has the same angles, so that limits and mean forces are those of a cylinder with turned
/// coefficients; `F_y = N/4 K_t f b + N/pi K_te b/cos(alpha)`.
#[test]
fn a_cone_in_a_slot_is_a_cylinder_with_turned_coefficients() {
    for taper in [3.0, 30.0, 45.0, 80.0] {
        let cone = cone(taper, 0.0, 1.0);
        let same = cylinder(&cone);
        for rpm in [5000.0, 8000.0, 13000.0] {
            let speed = rpm / 60.0 * TAU;
            let limit = |cut: &Milling| cut.at_speed(speed).unwrap().limit(20e-3).unwrap();
            let (own, expected) = (limit(&cone), limit(&same));
            assert!(
                (own.depth / expected.depth - 1.0).abs() < 1e-7 && own.kind == expected.kind,
                "{taper} {rpm}: {own:?} {expected:?}"
            );
        }
        let (depth, cosine) = (2e-3, taper.to_radians().cos());
        let mean = cone.mean_force(depth).unwrap();
        let across = 2.0 / 4.0 * 8e8 * 1e-4 * depth + 2.0 / PI * 2e4 * depth / cosine;
        let along = 2.0 / 4.0 * same.force.radial * 1e-4 * depth + 2.0 / PI * 3e4 * depth;
        assert!((mean[1] / across - 1.0).abs() < 1e-9, "{taper}: {mean:?} {across}");
        assert!((mean[0] / -along - 1.0).abs() < 1e-9, "{taper}: {mean:?} {along}");
        let load = cone.load(800.0, depth).unwrap();
        // The section of a cone that is cut in a slot: a trapezium, from the diameter at the tip to that at the surface.
        let section = depth * (0.01 + depth * taper.to_radians().tan());
        assert!((load.removal_rate / (section * 1e-4 * 2.0 * 800.0 / TAU) - 1.0).abs() < 1e-12, "{load:?}");
    }
}

/// No taper is the cylinder to the last bit, and a little of it nearly so, with a helix and beside a wall.
#[test]
fn a_cylinder_is_a_cone_without_taper() {
    for (helix, immersion) in [(0.0, 1.0), (0.5, 0.3), (0.0, 0.3)] {
        let plain = Milling { force: MillingForce::new(8e8, 1.7e8), ..cone(0.0, helix, immersion) };
        let little = Milling { cutter: Cutter { taper_angle: 1e-5, ..plain.cutter.clone() }, ..plain.clone() };
        let limit = |cut: &Milling| cut.at_speed(900.0).unwrap().limit(20e-3).unwrap().depth;
        let (expected, own) = (limit(&plain), limit(&little));
        // Slices of a helix are steps of the lag.
        assert!(
            (own / expected - 1.0).abs() < if helix > 0.0 { 2e-3 } else { 1e-4 },
            "{helix} {immersion}: {own} {expected}"
        );
    }
}

/// Point by point along the edge beside an upright wall: mean force of a cone whose diameter at the tip stands 30 % in the work.
#[test]
fn mean_forces_beside_a_wall_are_an_integral_along_the_edge() {
    for (taper, helix, immersion, depth) in [(20.0f64, 0.4, 0.3, 3e-3), (45.0, 0.0, 0.5, 1.5e-3)] {
        let cut = cone(taper, helix, immersion);
        let (sine, cosine) = taper.to_radians().sin_cos();
        let (tip, wall) = (5e-3, -5e-3 * cut.engagement.entry.cos());
        let (turns, pieces) = (1440, 400);
        let mut mean = [0.0; 2];
        for turn in 0..turns {
            for piece in 0..pieces {
                let height = depth * (f64::from(piece) + 0.5) / f64::from(pieces);
                let radius = tip + height * taper.to_radians().tan();
                let phi = TAU * (f64::from(turn) + 0.5) / f64::from(turns) - 2.0 * helix.tan() * height / 0.01;
                let phi = phi.rem_euclid(TAU);
                if phi > PI || -radius * phi.cos() < wall {
                    continue;
                }
                let length = depth / f64::from(pieces) / cosine;
                let chip = 1e-4 * phi.sin() * cosine;
                let t = (8e8 * chip + 2e4) * length;
                let n = (1.7e8 * cosine + 2.2e8 * sine) * chip * length + 3e4 * length * cosine;
                let (s, c) = phi.sin_cos();
                mean[0] += 2.0 * (-n * s - t * c) / f64::from(turns);
                mean[1] += 2.0 * (-n * c + t * s) / f64::from(turns);
            }
        }
        let own = cut.mean_force(depth).unwrap();
        let size = mean[0].hypot(mean[1]);
        for axis in 0..2 {
            assert!((own[axis] - mean[axis]).abs() < 5e-3 * size, "{taper}: {own:?} {mean:?}");
        }
    }
}

/// The simulation over time swings as forced below the limit and grows beyond it.
#[test]
fn a_simulated_cone_swings_as_forced_and_loses_stability_at_the_limit() {
    let cut = cone(30.0, 0.3, 0.6);
    let speed = 8000.0 / 60.0 * TAU;
    let limit = cut.at_speed(speed).unwrap().limit(8e-3).unwrap().depth;
    let settings = SimulationSettings { steps: 600, periods: 500, observed: 60, kick: 0.3 };
    let (still, forced) =
        (cut.simulate(speed, 0.6 * limit, &settings).unwrap(), cut.forced(speed, 0.6 * limit).unwrap());
    let greatest = forced.peak_to_peak[0].max(forced.peak_to_peak[1]);
    for axis in 0..2 {
        let off = (still.peak_to_peak(axis) - forced.peak_to_peak[axis]).abs() / greatest;
        assert!(off < 0.04, "{axis}: {} {:?}", still.peak_to_peak(axis), forced.peak_to_peak);
    }
    let beyond = cut.simulate(speed, 1.25 * limit, &settings).unwrap();
    let there = cut.forced(speed, 1.25 * limit).unwrap().peak_to_peak;
    assert!(beyond.peak_to_peak(0).max(beyond.peak_to_peak(1)) > 1.5 * there[0].max(there[1]));
}

#[test]
fn what_is_not_calculated_with_a_taper_is_refused() {
    let cut = cone(30.0, 0.0, 1.0);
    let with = |cutter: Cutter| Milling { cutter, ..cut.clone() }.at_speed(800.0).is_err();
    let own = cut.cutter.clone();
    assert!(with(Cutter { taper_angle: 0.9 * FRAC_PI_2, ..own.clone() }));
    assert!(with(Cutter { taper_angle: -0.1, ..own.clone() }));
    assert!(with(Cutter { corner_radius: 1e-3, ..own.clone() }));
    assert!(with(Cutter { runout: 1e-5, ..own.clone() }));
    assert!(with(Cutter { pitch: vec![3.0, TAU - 3.0], ..own }));
    assert!(cut.zeroth_order_limit(800.0).is_err());
}
