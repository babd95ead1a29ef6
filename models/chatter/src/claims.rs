//! Published limits and those of independent computations beside the ones computed here.

use crate::error::ChatterError;
use crate::paper::{Preset, Reduced};
use crate::{Cutter, Direction, Engagement, Milling, MillingForce, Mode, Turning};
use std::f64::consts::TAU;
use toolroom_process::Claim;

const ALTINTAS: &str = "Altintas, Manufacturing Automation (2012), p. 131";
const ZAKOVOROTNY: &str = "Zakovorotny, Pham, Pham, Parametrical phenomena under on-machine process control, Fig. 3";
const CROSSINGS: &str =
    "independent computation: zeros of the loop gain at 4000 points a wave, roots counted by argument";
const SIMULATED: &str =
    "independent computation: time domain with surface memory, 200 steps a tooth or 400 a revolution";
const FOURIER: &str = "independent computation: Fourier series of the static force times the frequency response";
const COLLOCATION: &str = "independent computation: Chebyshev collocation, 50 nodes";

fn rpm(speed: f64) -> f64 {
    speed / 60.0 * TAU
}

/// What is published about stability, and what this crate computes.
///
/// # Errors
/// A search that fails.
///
/// # Examples
/// ```
/// assert!(toolroom_chatter::claims().unwrap().iter().all(toolroom_process::Claim::pass));
/// ```
pub fn claims() -> Result<Vec<Claim>, ChatterError> {
    let mut claims = textbook()?;
    claims.extend(chuck()?);
    claims.extend(crossings()?);
    claims.extend(milling()?);
    claims.extend(islands()?);
    claims.extend(vibrations()?);
    Ok(claims)
}

fn millimetres(claim: String, source: &str, published: f64, depth: f64, tolerance: f64) -> Claim {
    Claim { claim, source: source.to_owned(), published, computed: depth * 1e3, tolerance }
}

fn textbook() -> Result<Vec<Claim>, ChatterError> {
    let mode = |stiffness: f64, angle: f64, natural_frequency, damping_ratio| Mode {
        direction: [1.0, 0.0],
        natural_frequency,
        damping_ratio,
        stiffness: stiffness / angle.to_radians().cos().powi(2),
    };
    let first = mode(2.26e8, 30.0, 250.0, 0.012);
    let second = mode(2.13e8, 45.0, 150.0, 0.010);
    let absolute = |modes| Turning::orthogonal(modes, 1e9, 0.05).absolute_limit();
    let claim = |modes: &str, published, depth| {
        let claim = format!("turning, {modes}: least unstable width at any speed, mm");
        millimetres(claim, ALTINTAS, published, depth, 1e-4)
    };
    Ok(vec![
        claim("one mode at 30 degrees", 7.319, absolute(vec![first])?),
        claim("two modes at 30 and 45 degrees", 7.185, absolute(vec![first, second])?),
    ])
}

fn chuck() -> Result<Vec<Claim>, ChatterError> {
    let mut claims = Vec::new();
    for (microseconds, published) in [(0.0, 0.50), (40.0, 0.38), (80.0, 0.24)] {
        let critical = Reduced::from_preset(Preset::F0_120Hz, 1e-6 * microseconds).critical_modulation(1.0, 1.2)?;
        claims.push(Claim {
            claim: format!(
                "three-jaw chuck, chip-formation lag {microseconds} us: critical modulation, nothing fitted"
            ),
            source: ZAKOVOROTNY.to_owned(),
            published,
            computed: critical.unwrap_or(f64::NAN),
            tolerance: 0.1,
        });
    }
    Ok(claims)
}

/// Cuts with process damping that are stable again above their limit.
fn crossings() -> Result<Vec<Claim>, ChatterError> {
    let cut = |modes: &[[f64; 5]], coefficient, angle: f64, process_damping| Turning {
        force_angle: angle.to_radians(),
        process_damping,
        ..Turning::orthogonal(
            modes
                .iter()
                .map(|[x, y, natural_frequency, damping_ratio, stiffness]| Mode {
                    direction: [*x, *y],
                    natural_frequency: *natural_frequency,
                    damping_ratio: *damping_ratio,
                    stiffness: *stiffness,
                })
                .collect(),
            coefficient,
            0.04,
        )
    };
    let near_touch = cut(
        &[[0.92375, 0.38299, 208.7, 0.0288, 4.364e7], [0.99968, 0.02534, 815.0, 0.0119, 7.659e6]],
        1081e6,
        13.6,
        6.856e5,
    );
    let one_mode = cut(&[[0.81398, 0.5809, 968.5, 0.0347, 4.917e6]], 756.2e6, 34.2, 7.69e5);
    let cases: [(&str, Turning, f64, f64, &[f64]); 2] = [
        ("two modes, 2143 rpm", near_touch, 2143.19, 6e-3, &[0.83112419, 0.98851381, 1.00393934]),
        ("one mode, 4321 rpm", one_mode, 4320.58, 8e-3, &[3.40790862, 4.36082071, 4.76004717, 5.79565668]),
    ];
    let mut claims = Vec::new();
    for (name, cut, speed, greatest, published) in cases {
        let found = cut.stable_intervals(rpm(speed), greatest)?;
        for (i, published) in published.iter().enumerate() {
            let (depth, what) = match found.ends.get(i) {
                Some(end) if end.becomes_unstable => (end.limit.depth, "becomes unstable"),
                Some(end) => (end.limit.depth, "becomes stable again"),
                None => (f64::NAN, "has an end of an interval"),
            };
            let claim = format!("turning with process damping, {name}: {what} at the width, mm");
            claims.push(millimetres(claim, CROSSINGS, *published, depth, 1e-7));
        }
    }
    Ok(claims)
}

fn milling() -> Result<Vec<Claim>, ChatterError> {
    let mut claims = Vec::new();
    let cases = [
        (1, 1.0, Direction::Down, 12000.0, 2.1493095),
        (1, 0.5, Direction::Up, 8000.0, 0.40603609),
        (1, 0.05, Direction::Down, 16000.0, 5.5176757),
        (2, 0.5, Direction::Down, 8000.0, 0.14085661),
        (2, 0.05, Direction::Up, 16000.0, 1.4122232),
    ];
    for (modes, immersion, direction, speed, published) in cases {
        let mode = |axis| Mode::from_mass(axis, 922.0, 0.011, 0.03993);
        let cut = Milling {
            modes: [[1.0, 0.0], [0.0, 1.0]].into_iter().take(modes).map(mode).collect(),
            cutter: Cutter::straight(2, 0.02),
            engagement: Engagement::new(immersion, direction)?,
            force: MillingForce::new(6e8, 2e8),
            feed_per_tooth: 0.1e-3,
            by_speed: None,
            along_path: None,
        };
        let depth = cut.at_speed(rpm(speed))?.limit(12e-3)?.depth;
        let claim = format!("milling, modes in {modes} directions, a/D {immersion}, {speed} rpm: limiting depth, mm");
        claims.push(millimetres(claim, COLLOCATION, published, depth, 1e-6));
    }
    Ok(claims)
}

/// A helical cutter at low immersion: unstable islands above which the cut is stable again.
fn islands() -> Result<Vec<Claim>, ChatterError> {
    let cut = helical(0.05)?;
    let mut claims = Vec::new();
    for (speed, greatest, published) in [
        (17850.0, 4e-3, [1.78988805, 3.06628205]),
        (16800.0, 8.5e-3, [6.24774127, 7.29866957]),
        (17600.0, 4e-3, [2.67135879, 3.54511686]),
    ] {
        let found = cut.at_speed(rpm(speed))?.stable_intervals(greatest)?;
        for (i, (published, side)) in published.into_iter().zip(["lower", "upper"]).enumerate() {
            let depth = found.ends.get(i).map_or(f64::NAN, |end| end.limit.depth);
            let claim = format!("milling, helix 45 degrees, a/D 0.05, {speed} rpm: {side} end of an island, mm");
            claims.push(millimetres(claim, COLLOCATION, published, depth, 1e-6));
        }
    }
    Ok(claims)
}

/// Two helical teeth of 45 degrees on 8 mm, one mode along the feed, at a radial immersion.
fn helical(immersion: f64) -> Result<Milling, ChatterError> {
    Ok(Milling {
        modes: vec![Mode { direction: [1.0, 0.0], natural_frequency: 922.0, damping_ratio: 0.011, stiffness: 1.34e6 }],
        cutter: Cutter { helix_angle: TAU / 8.0, ..Cutter::straight(2, 8e-3) },
        engagement: Engagement::new(immersion, Direction::Down)?,
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    })
}

/// Vibration below and beyond the limit, with process damping in contact alone, and the surface that it leaves.
fn vibrations() -> Result<Vec<Claim>, ChatterError> {
    let mut claims = Vec::new();
    let mut tell = |claim: String, source: &str, published: f64, computed: f64, tolerance: f64| {
        claims.push(Claim { claim, source: source.to_owned(), published, computed, tolerance });
    };
    let (mass, damping, stiffness) = (0.561f64, 145.0, 6.48e6);
    let w = (stiffness / mass).sqrt();
    let mode = Mode {
        direction: [1.0, 0.0],
        natural_frequency: w / TAU,
        damping_ratio: damping / (2.0 * mass * w),
        stiffness,
    };
    let turning = Turning { process_damping: 6.11e5, ..Turning::orthogonal(vec![mode], 1384e6, 35e-3) };
    let width = 1.3 * turning.limit(rpm(2600.0))?.depth;
    let found = turning.settled(rpm(2600.0), width, 0.1e-3)?.simulation;
    let what = "turning with process damping, 2600 rpm, 1.3 times the limit";
    tell(format!("{what}: peak-to-peak vibration, um"), SIMULATED, 217.13, found.peak_to_peak(0) * 1e6, 0.04);
    let ratio = found.greatest_force(0) / (1384e6 * width * 0.1e-3);
    tell(format!("{what}: greatest force over the static one"), SIMULATED, 2.433, ratio, 0.04);
    let milling = Milling {
        modes: vec![Mode::from_mass([1.0, 0.0], 780.0, 0.022, 0.09), Mode::from_mass([0.0, 1.0], 905.0, 0.028, 0.07)],
        cutter: Cutter::straight(3, 0.02),
        engagement: Engagement::new(0.3, Direction::Down)?,
        force: MillingForce::new(800e6, 260e6),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    };
    let limit = milling.at_speed(rpm(7200.0))?.limit(12e-3)?.depth;
    let what = "milling, a/D 0.3, 7200 rpm";
    let forced = milling.forced(rpm(7200.0), 0.8 * limit)?;
    let left = milling.material_left(&forced) * 1e6;
    tell(format!("{what}, 0.8 times the limit: surface location error, um"), FOURIER, 15.0444, left, 1e-4);
    for (ratio, published) in [(1.15, [90.05, 200.94]), (2.0, [186.5, 439.7])] {
        let found = milling.settled(rpm(7200.0), ratio * limit)?.simulation;
        for (direction, name) in ["feed", "normal"].into_iter().enumerate() {
            let claim = format!("{what}, {ratio} times the limit: peak-to-peak vibration along the {name}, um");
            tell(claim, SIMULATED, published[direction], found.peak_to_peak(direction) * 1e6, 0.04);
        }
    }
    let slot = Milling {
        modes: vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)],
        cutter: Cutter::straight(2, 0.02),
        engagement: Engagement::new(1.0, Direction::Down)?,
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    };
    let limit = slot.at_speed(rpm(12000.0))?.limit(12e-3)?.depth;
    for (ratio, published) in [(1.1, 345.32), (1.5, 484.10)] {
        let found = slot.settled(rpm(12000.0), ratio * limit)?.simulation;
        let claim = format!("slot at 12000 rpm, period doubling, {ratio} times the limit: peak-to-peak vibration, um");
        tell(claim, SIMULATED, published, found.peak_to_peak(0) * 1e6, 0.04);
    }
    Ok(claims)
}
