//! Vibration of random milling cuts beyond their limit, half of them with period doubling: what `settled` and `limit_cycle`
//! say against a run of four times the steps over 2400 tooth periods.
//! `cargo run --release -p toolroom-chatter --example amplitudes 200`; a second number is that of the first case.

use rayon::prelude::*;
use std::f64::consts::TAU;
use std::io::Write;
use toolroom_chatter::{
    ChatterError, ChatterKind, Cutter, Direction, Engagement, Milling, MillingForce, Mode, SimulationSettings,
};

/// Random numbers from 0 to 1.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Even in the logarithm.
    fn scaled(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low.ln(), high.ln())).exp()
    }
}

/// A cut beyond its limit.
struct Case {
    cut: Milling,
    speed: f64,
    depth: f64,
    ratio: f64,
}

/// Case number `i`, of period doubling where it is odd.
fn case(i: usize) -> Case {
    let mut draw = Draws(977 * i as u64 + 13);
    let doubling = i % 2 == 1;
    loop {
        let frequency = draw.scaled(300.0, 2000.0);
        let mut mode = |direction, frequency: f64| Mode {
            direction,
            natural_frequency: frequency,
            damping_ratio: draw.scaled(0.01, 0.05),
            stiffness: draw.scaled(1e6, 2e7),
        };
        let mut modes = vec![mode([1.0, 0.0], frequency)];
        let other = mode([0.0, 1.0], frequency);
        if draw.next() < 0.6 {
            modes.push(Mode { natural_frequency: frequency * draw.between(0.8, 1.3), ..other });
        }
        let teeth = 1 + (draw.next() * 6.0) as usize;
        let direction = if draw.next() < 0.5 { Direction::Up } else { Direction::Down };
        let tangential = draw.scaled(500e6, 2500e6);
        let Ok(engagement) = Engagement::new(draw.scaled(0.03, 1.0), direction) else { continue };
        let cut = Milling {
            modes,
            cutter: Cutter::straight(teeth, draw.scaled(6e-3, 30e-3)),
            engagement,
            force: MillingForce::new(tangential, tangential * draw.between(0.2, 0.5)),
            feed_per_tooth: 0.1e-3,
            by_speed: None,
            along_path: None,
        };
        // Oscillations in a tooth period.
        let waves = draw.between(0.4, 4.0);
        let speed = TAU * frequency / waves / teeth as f64;
        let Ok(limit) = cut.at_speed(speed).and_then(|mut at| at.limit(10e-3)) else { continue };
        if (limit.kind == ChatterKind::Flip) == doubling {
            let ratio = draw.between(1.02, 3.0);
            return Case { cut, speed, depth: ratio * limit.depth, ratio };
        }
    }
}

/// Greatest peak-to-peak displacement (m) by a fine run, by `settled` with its band, and by `limit_cycle`; last 1 where `settled`
/// tells a range, because the vibration does not repeat or depends on its start, else 0.
fn judged(case: &Case) -> Result<[f64; 5], ChatterError> {
    let Case { cut, speed, depth, .. } = case;
    let settled = cut.settled(*speed, *depth)?;
    let greatest = |of: &dyn Fn(usize) -> f64| of(0).max(of(1));
    let period = TAU / (speed * cut.cutter.teeth as f64);
    let settings = SimulationSettings {
        steps: 4 * (period / settled.simulation.time_step).round() as usize,
        periods: 2400,
        observed: 160,
        kick: 1.0,
    };
    let fine = cut.simulate(*speed, *depth, &settings)?;
    let quick = cut.limit_cycle(*speed, *depth)?.amplitude * cut.feed_per_tooth;
    let of_settled = greatest(&|direction| settled.simulation.peak_to_peak(direction));
    let irregular = f64::from(u8::from(settled.range.is_some()));
    Ok([greatest(&|direction| fine.peak_to_peak(direction)), of_settled, settled.band, quick, irregular])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let count = std::env::args().nth(1).map_or(Ok(40), |count| count.parse::<usize>())?;
    let first = std::env::args().nth(2).map_or(Ok(0), |first| first.parse::<usize>())?;
    let cases: Vec<Case> = (first..first + count).into_par_iter().map(case).collect();
    // A cutter that is pulled into the work is refused.
    let found: Vec<Option<[f64; 5]>> = cases.par_iter().map(|case| judged(case).ok()).collect();
    let mut out = std::io::stdout();
    writeln!(out, "{} of {count} cuts are refused", found.iter().filter(|found| found.is_none()).count())?;
    let apart = |value: f64, truth: f64| (value / truth - 1.0).abs();
    for (i, (case, found)) in cases.iter().zip(&found).enumerate() {
        let Some([fine, settled, band, quick, _]) = found else { continue };
        if apart(*settled, *fine) > *band || apart(*quick, *fine) > 0.15 {
            writeln!(
                out,
                "{}: {:.2} times the limit, fine {:.1} um, settled {:.1} um with band {band:.3}, quick {:.1} um",
                first + i,
                case.ratio,
                fine * 1e6,
                settled * 1e6,
                quick * 1e6
            )?;
        }
    }
    for (doubling, name) in [(0, "quasi-periodic"), (1, "period doubling")] {
        let all = found.iter().enumerate();
        let of_kind: Vec<_> =
            all.filter(|(i, _)| (first + i) % 2 == doubling).filter_map(|(_, found)| found.as_ref()).collect();
        let share = |holds: &dyn Fn(&[f64; 5]) -> bool| {
            100.0 * of_kind.iter().filter(|found| holds(found)).count() as f64 / of_kind.len().max(1) as f64
        };
        let within_band = share(&|[fine, settled, band, ..]| apart(*settled, *fine) <= *band);
        let narrow = share(&|[_, _, band, ..]| *band <= 0.15);
        let [of_settled, of_quick] = [1, 3].map(|k| share(&|found: &[f64; 5]| apart(found[k], found[0]) <= 0.15));
        let worst = |k: usize| of_kind.iter().map(|found| (found[k] / found[0]).ln().abs()).fold(0.0, f64::max).exp();
        let regular = of_kind.iter().filter(|found| found[4] == 0.0);
        let worst_regular = regular.map(|found| (found[1] / found[0]).ln().abs()).fold(0.0, f64::max).exp();
        let irregular = share(&|found| found[4] > 0.0);
        writeln!(
            out,
            "{name}: settled within its band {within_band:.1} %, bands up to 15 % {narrow:.1} %, within 15 % \
             {of_settled:.1} %, at worst a factor of {:.2}, {worst_regular:.2} of those that repeat ({irregular:.1} % tell a range); \
             quick within 15 % {of_quick:.1} %, at worst {:.2}",
            worst(1),
            worst(3)
        )?;
    }
    Ok(())
}
