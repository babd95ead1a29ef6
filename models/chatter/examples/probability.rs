//! How long probabilities of stability take: 2000 samples at one point, and a map of 100 samples over 80 speeds and 50 depths,
//! of two modes in milling (straight and helical) and in turning:
//! `cargo run --release -p toolroom-chatter --example probability`. The sums of the shares are printed, which tell whether two
//! versions of the program agree.

use std::f64::consts::TAU;
use std::io::Write;
use std::time::Instant;
use toolroom_chatter::{
    Axis, ChatterError, Cutter, Direction, Engagement, Milling, MillingForce, Mode, Scatter, Turning,
};

const SCATTER: Scatter = Scatter { natural_frequency: 0.005, damping_ratio: 0.1, coefficients: 0.05 };

fn mode(direction: [f64; 2], natural_frequency: f64, stiffness: f64) -> Mode {
    Mode { direction, natural_frequency, damping_ratio: 0.03, stiffness }
}

fn milling(helix_angle: f64) -> Result<Milling, ChatterError> {
    Ok(Milling {
        modes: vec![mode([1.0, 0.0], 1150.0, 14e6), mode([0.0, 1.0], 1240.0, 12e6)],
        cutter: Cutter { helix_angle, ..Cutter::straight(3, 0.016) },
        engagement: Engagement::new(0.5, Direction::Down)?,
        force: MillingForce::new(796e6, 168e6),
        feed_per_tooth: 1e-4,
        by_speed: None,
        along_path: None,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axis = |from: f64, to: f64, points| Axis { start: from, end: to, points };
    let speeds = axis(4000.0 / 60.0 * TAU, 24_000.0 / 60.0 * TAU, 80).values("speed")?;
    let depths = axis(0.0, 10e-3, 50).values("depth")?;
    let mut out = std::io::stdout();
    for (name, helix) in [("straight", 0.0), ("helix", 30f64.to_radians())] {
        let cut = milling(helix)?;
        let start = Instant::now();
        let at = cut.stability_probability(8000.0 / 60.0 * TAU, 5.7e-3, &SCATTER, 2000, 1)?.value;
        let point = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let map: f64 = cut.stability_probabilities(&speeds, &depths, &SCATTER, 100, 1)?.iter().sum();
        writeln!(out, "{name}: point {at:.4} in {point:.3} s, map {map:.2} in {:.2} s", start.elapsed().as_secs_f64())?;
    }
    let turned = Turning::orthogonal(vec![mode([1.0, 0.0], 540.0, 6.5e6), mode([1.0, 0.3], 610.0, 9e6)], 1384e6, 0.035);
    let speeds = axis(1500.0 / 60.0 * TAU, 9000.0 / 60.0 * TAU, 80).values("speed")?;
    let widths = axis(0.0, 2e-3, 50).values("width")?;
    let start = Instant::now();
    let at = turned.stability_probability(3000.0 / 60.0 * TAU, 0.35e-3, &SCATTER, 2000, 1)?.value;
    let point = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let map: f64 = turned.stability_probabilities(&speeds, &widths, &SCATTER, 100, 1)?.iter().sum();
    writeln!(out, "turning: point {at:.4} in {point:.3} s, map {map:.2} in {:.2} s", start.elapsed().as_secs_f64())?;
    Ok(())
}
