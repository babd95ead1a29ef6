//! Roughness of the wall: cusps of the feed in closed form, and the forced vibration against the simulated one.

use std::f64::consts::TAU;
use toolroom_chatter::{Cutter, Direction, Engagement, Milling, MillingForce, Mode, SimulationSettings};

fn cut(direction: Direction, stiffness: f64) -> Milling {
    let mode = |direction, natural_frequency, damping_ratio, mass: f64| Mode {
        direction,
        natural_frequency,
        damping_ratio,
        stiffness: stiffness * mass * (TAU * natural_frequency).powi(2),
    };
    Milling {
        modes: vec![mode([1.0, 0.0], 780.0, 0.022, 0.09), mode([0.0, 1.0], 905.0, 0.028, 0.07)],
        cutter: Cutter::straight(3, 16e-3),
        engagement: Engagement::new(0.3, direction).unwrap(),
        force: MillingForce::new(800e6, 260e6),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    }
}

const SPEED: f64 = 7200.0 / 60.0 * TAU;

/// Parabolas of the radius: `Rz = f²/(8 R)`, `Ra = f²/(18 sqrt(3) R)`; the feed of the axis makes them 0.6 % flatter or steeper.
#[test]
fn a_stiff_cut_leaves_the_cusps_of_its_feed() {
    for direction in [Direction::Up, Direction::Down] {
        let mut cut = cut(direction, 1e9);
        let forced = cut.forced(SPEED, 1e-3).unwrap();
        let found = cut.forced_roughness(1e-3, &forced).unwrap().unwrap();
        // The axis moves on while the edge passes the wall: with it in up milling, against it in down milling.
        let along = if direction == Direction::Up { 1.0 } else { -1.0 };
        let slower = (1.0 + along * 0.3e-3 / (TAU * 8e-3)).powi(-2);
        let height = slower * 1e-8 / (8.0 * 8e-3);
        assert!((found.rz / height - 1.0).abs() < 0.02, "{found:?} {height}");
        assert!((found.ra / (slower * 1e-8 / (18.0 * 3f64.sqrt() * 8e-3)) - 1.0).abs() < 0.02, "{found:?}");
        // One tooth of three that reaches far enough has the wall to itself.
        cut.cutter.runout = 5e-6;
        let alone = cut.forced_roughness(1e-3, &cut.forced(SPEED, 1e-3).unwrap()).unwrap().unwrap();
        assert!((alone.rz / (9.0 * height) - 1.0).abs() < 0.03, "{alone:?}");
    }
}

#[test]
fn series_and_simulation_leave_the_same_wall_and_chatter_a_rougher_one() {
    let settings = SimulationSettings { steps: 400, periods: 600, observed: 100, kick: 0.1 };
    for direction in [Direction::Up, Direction::Down] {
        let cut = cut(direction, 1.0);
        let limit = cut.at_speed(SPEED).unwrap().limit(5e-3).unwrap().depth;
        let wall = |depth: f64| {
            cut.simulated_roughness(depth, &cut.simulate(SPEED, depth, &settings).unwrap(), settings.steps).unwrap()
        };
        let (depth, run) = (0.6 * limit, wall(0.6 * limit));
        let forced = cut.forced_roughness(depth, &cut.forced(SPEED, depth).unwrap()).unwrap().unwrap();
        assert!((run.ra / forced.ra - 1.0).abs() < 0.04, "{direction:?} {run:?} {forced:?}");
        assert!((run.rz / forced.rz - 1.0).abs() < 0.04, "{direction:?} {run:?} {forced:?}");
        let rough = wall(1.5 * limit);
        assert!(rough.ra > 3.0 * forced.ra && rough.rz > rough.ra, "{rough:?} {forced:?}");
    }
}
