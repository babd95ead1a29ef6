//! Judges 10 000 points of speed, depth, immersion and direction against the dense eigenvalues of
//! finer period maps: `cargo run --release -p toolroom-chatter --example verdicts`.

use std::f64::consts::TAU;
use std::io::Write;
use toolroom_chatter::{ChatterError, Cutter, Direction, Engagement, Milling, MillingForce, Mode};

const POINTS: usize = 10_000;

/// The standard structure with one or two degrees of freedom.
fn cut(degrees: usize, immersion: f64, direction: Direction) -> Result<Milling, ChatterError> {
    let mode = |axis| Mode::from_mass(axis, 922.0, 0.011, 0.03993);
    Ok(Milling {
        modes: [[1.0, 0.0], [0.0, 1.0]].into_iter().take(degrees).map(mode).collect(),
        cutter: Cutter::straight(2, 0.02),
        engagement: Engagement::new(immersion, direction)?,
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut judged, mut wrong, mut wrong_in_charts) = (0, 0, 0);
    let mut worst = 0f64;
    for i in 0..POINTS {
        // Fractional parts of multiples of irrational numbers fill the cube evenly.
        let [a, b, c, d] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9, 0.450_306_925_5]
            .map(|step: f64| (step * i as f64 + 0.25).fract());
        let speed = (5000.0 + 20000.0 * a) / 60.0 * TAU;
        let depth = 1e-5 + 10e-3 * b * b;
        let direction = if d < 0.5 { Direction::Up } else { Direction::Down };
        let cut = cut(1 + i % 2, 0.01 + 0.99 * c, direction)?;
        let mut at_speed = cut.at_speed(speed)?;
        let truth = at_speed.multipliers(depth, 6)?.first().map_or(0.0, |m| m.norm());
        if (truth - 1.0).abs() <= 1e-6 {
            continue;
        }
        judged += 1;
        let verdict = at_speed.verdict(depth)?;
        wrong += usize::from(verdict.stable != (truth < 1.0));
        worst = worst.max((verdict.spectral_radius / truth - 1.0).abs());
        let chart = cut.lobes(&[speed], &[depth])?;
        wrong_in_charts += usize::from(chart.at(0, 0).is_none_or(|v| v.stable != (truth < 1.0)));
    }
    let mut out = std::io::stdout();
    writeln!(
        out,
        "{judged} points with |rho - 1| > 1e-6: {wrong} wrong verdicts, {wrong_in_charts} wrong chart points"
    )?;
    writeln!(out, "greatest relative error of the spectral radius: {worst:.1e}")?;
    Ok(())
}
