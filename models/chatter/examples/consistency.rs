//! Asks charts, curves, stable intervals, single verdicts and the shop's search about the same random points of random
//! systems, and counts where they contradict each other:
//! `cargo run --release -p toolroom-chatter --example consistency 200 25 20` for 200 systems, 25 speeds of each and 20 depths
//! at each speed, 100 000 points. A fourth number is the seed.
//!
//! Points nearer than a thousandth to an end of a stable interval are left out: there a chart point may differ by its three
//! digits. The shop searches limits in 24 steps and judges a depth beyond once more, so that it can miss an island that is
//! thinner than a step; that is counted apart, since its documents say so.

use std::f64::consts::TAU;
use std::io::Write;
use toolroom_chatter::{
    Axis, ChatterError, Cutter, Direction, Draw, Engagement, Milling, MillingForce, Mode, StableIntervals, Turning,
};

/// Relative distance from the ends of stable intervals from which on answers must agree.
const BAND: f64 = 1e-3;
/// Steps in which the shop searches a limit, and how far beyond it a depth is judged by itself.
const SHOP: (usize, f64) = (24, 1.02);

/// Points, those without an answer, and contradictions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Points that were asked about.
    pub points: usize,
    /// Points for which a search failed.
    pub refused: usize,
    /// Single verdicts that differ from the stable intervals.
    pub at: usize,
    /// Chart points that differ from the single verdicts.
    pub chart: usize,
    /// Points whose side of the curve differs from the stable intervals.
    pub curve: usize,
    /// Points that the shop's search would answer otherwise.
    pub shop: usize,
}

fn modes(draw: &mut Draw, count: usize, plane: bool) -> Vec<Mode> {
    (0..count)
        .map(|_| {
            let angle = if plane { TAU * draw.uniform() } else { 1.4 * (draw.uniform() - 0.5) };
            Mode {
                direction: [angle.cos(), angle.sin()],
                natural_frequency: 300.0 * 5f64.powf(draw.uniform()),
                damping_ratio: 0.01 * 4f64.powf(draw.uniform()),
                stiffness: 4e6 * 10f64.powf(draw.uniform()),
            }
        })
        .collect()
}

/// Whether a depth lies so near to an end that answers may differ.
fn near(stable_intervals: &StableIntervals, depth: f64) -> bool {
    stable_intervals.ends.iter().any(|end| (depth / end.limit.depth - 1.0).abs() < BAND)
}

fn turning(draw: &mut Draw, speeds: usize, depths: usize, counts: &mut Counts) -> Result<(), ChatterError> {
    let count = 1 + (3.0 * draw.uniform()) as usize;
    let damping = if draw.uniform() < 0.5 { 0.0 } else { 3e4 * 30f64.powf(draw.uniform()) };
    let cut = Turning {
        force_angle: draw.uniform(),
        process_damping: damping,
        ..Turning::orthogonal(modes(draw, count, false), 5e8 * 6f64.powf(draw.uniform()), 0.04)
    };
    let start = 300.0 * 20f64.powf(draw.uniform()) / 60.0 * TAU;
    let axis = Axis { start, end: 1.5 * start, points: speeds };
    let reference = cut.absolute_limit()?;
    let greatest = 6.0 * reference;
    let depths: Vec<f64> = (0..depths).map(|_| greatest * draw.uniform()).collect();
    let columns = axis.values("speed")?;
    let (chart, curve) = (cut.lobe_chart(&columns, &depths)?, cut.boundary(&axis, greatest)?);
    for (i, speed) in columns.iter().enumerate() {
        let found = cut.stable_intervals(*speed, greatest)?;
        let column = curve.columns.iter().find(|column| (column.speed / speed - 1.0).abs() < 1e-12);
        for (j, depth) in depths.iter().enumerate().filter(|(_, depth)| !near(&found, **depth)) {
            counts.points += 1;
            let stable = found.is_stable(*depth);
            counts.at += usize::from(cut.verdict(*speed, *depth)?.stable != stable);
            counts.chart += usize::from(chart.at(i, j).is_none_or(|verdict| verdict.stable != stable));
            let below = column.map(|column| column.crossings.partition_point(|end| end.limit.depth < *depth));
            counts.curve += usize::from(below.is_none_or(|below| (below % 2 == 0) != stable));
            // The shop takes the exact limit of turning.
            let limit = found.limit().map_or(f64::INFINITY, |limit| limit.depth);
            let shop = *depth <= limit * SHOP.1 && *depth <= limit || cut.is_stable(*speed, *depth)?;
            counts.shop += usize::from(shop != stable);
        }
    }
    Ok(())
}

fn milling(draw: &mut Draw, speeds: usize, depths: usize, counts: &mut Counts) -> Result<(), ChatterError> {
    let count = 1 + (3.0 * draw.uniform()) as usize;
    let teeth = 1 + (5.0 * draw.uniform()) as usize;
    let helix_angle = if draw.uniform() < 0.5 { 0.0 } else { 0.2 + 0.6 * draw.uniform() };
    let direction = if draw.uniform() < 0.5 { Direction::Up } else { Direction::Down };
    let tangential = 6e8 * 3f64.powf(draw.uniform());
    let damping = if draw.uniform() < 0.7 { 0.0 } else { 1e4 * 10f64.powf(draw.uniform()) };
    let modes = modes(draw, count, true);
    let fastest = modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max);
    let cut = Milling {
        modes,
        cutter: Cutter { helix_angle, ..Cutter::straight(teeth, 0.01 + 0.01 * draw.uniform()) },
        engagement: Engagement::new(0.03 * 33f64.powf(draw.uniform()), direction)?,
        force: MillingForce {
            process_damping: damping,
            ..MillingForce::new(tangential, tangential * (0.1 + 0.4 * draw.uniform()))
        },
        feed_per_tooth: 1e-4,
        by_speed: None,
        along_path: None,
    };
    // From half a wave of the fastest mode in a tooth period to twelve.
    let waves = 0.5 * 24f64.powf(draw.uniform());
    let start = fastest / waves / teeth as f64 * TAU;
    let axis = Axis { start, end: 1.4 * start, points: speeds };
    let columns = axis.values("speed")?;
    let greatest = 3e-3 * 4f64.powf(draw.uniform());
    let depths: Vec<f64> = (0..depths).map(|_| greatest * draw.uniform()).collect();
    let (chart, curve) = (cut.lobes(&columns, &depths)?, cut.boundary(&axis, greatest)?);
    for (i, speed) in columns.iter().enumerate() {
        let found = match cut.at_speed(*speed)?.stable_intervals(greatest) {
            Err(error) if error.is_failed_search() => {
                counts.refused += depths.len();
                continue;
            }
            found => found?,
        };
        let column = curve.columns.iter().find(|column| (column.speed / speed - 1.0).abs() < 1e-12);
        let rough = match cut.at_speed(*speed)?.rough_limit(2.0 * greatest, SHOP.0) {
            Ok(limit) => limit.depth,
            Err(ChatterError::NoLimit { .. }) => f64::INFINITY,
            Err(error) => return Err(error),
        };
        let mut at_speed = cut.at_speed(*speed)?;
        for (j, depth) in depths.iter().enumerate().filter(|(_, depth)| !near(&found, **depth)) {
            let Ok(verdict) = at_speed.verdict(*depth) else {
                counts.refused += 1;
                continue;
            };
            counts.points += 1;
            let stable = found.is_stable(*depth);
            counts.at += usize::from(verdict.stable != stable);
            counts.chart += usize::from(chart.at(i, j).is_some_and(|point| point.stable != verdict.stable));
            let below = column.map(|column| column.crossings.partition_point(|end| end.limit.depth < *depth));
            counts.curve += usize::from(below.is_some_and(|below| (below % 2 == 0) != stable));
            let shop = *depth < rough * SHOP.1 || verdict.stable;
            let band = (depth / rough - 1.0).abs() < 0.02;
            counts.shop += usize::from(shop != stable && !band);
        }
    }
    Ok(())
}

/// What was found of turning and of milling, each on half of the `systems`.
pub fn counted([systems, speeds, depths, seed]: [usize; 4]) -> Result<[Counts; 2], ChatterError> {
    let mut all = [Counts::default(), Counts::default()];
    for system in 0..systems {
        let mut draw = Draw::new(seed as u64, system as u64);
        let of = if system % 2 == 0 { turning } else { milling };
        of(&mut draw, speeds, depths, &mut all[system % 2])?;
    }
    Ok(all)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let numbers: Vec<usize> = std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    let number = |place: usize, otherwise: usize| numbers.get(place).copied().unwrap_or(otherwise);
    let found = counted([number(0, 200), number(1, 25), number(2, 20), number(3, 20)])?;
    let mut out = std::io::stdout();
    for (name, Counts { points, refused, at, chart, curve, shop }) in ["turning", "milling"].into_iter().zip(found) {
        writeln!(
            out,
            "{name}: {points} points, {refused} refused; against the stable intervals {at} single verdicts, {curve} of the curve; \
             {chart} chart points against the verdicts; {shop} of the shop's search"
        )?;
    }
    Ok(())
}
