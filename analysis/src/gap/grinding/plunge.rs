//! What one trial reads.

use toolroom_infeed::{Infeed, Input, State};
use toolroom_process::Process;

/// Depth to which an exponent of force in depth refers, m.
const DEPTH: f64 = 4.4e-6;
/// Share of the force at which the rise is read.
const RISEN: f64 = 0.95;

/// Readings of a trial, SI.
pub(super) struct Plunge {
    stock_removed: f64,
    normal_force: f64,
    tangential_force: f64,
    rise_revolutions: f64,
    force_after_spark_out: f64,
}

impl Plunge {
    /// The reading of a channel.
    pub fn channel(&self, name: &str) -> f64 {
        match name {
            "stock_removed" => self.stock_removed,
            "normal_force" => self.normal_force,
            "tangential_force" => self.tangential_force,
            "rise_revolutions" => self.rise_revolutions,
            _ => self.force_after_spark_out,
        }
    }
}

/// One revolution, or a part of one, at the stiffness that the depth of the one before gives.
fn turn(process: &Infeed, part: &mut State, u: &Input, exponent: f64, share: f64) {
    let depth = if part.depth_of_cut > 0.0 { part.depth_of_cut } else { 0.5 * u.infeed_per_rev };
    let bent = if exponent == 0.0 || depth <= 0.0 { 1.0 } else { (depth / DEPTH).max(1e-3).powf(exponent) };
    let u = Input { process_stiffness_factor: u.process_stiffness_factor * bent, ..*u };
    let mut next = *part;
    next.commanded_infeed += u.infeed_per_rev;
    let next = process.revolution(&next, &u);
    if share >= 1.0 {
        *part = next;
    } else {
        part.stock_removed += share * (next.stock_removed - part.stock_removed);
        part.depth_of_cut += share * (next.depth_of_cut - part.depth_of_cut);
        part.commanded_infeed += share * u.infeed_per_rev;
        part.revolutions += share;
    }
}

/// Revolutions of infeed and of spark-out on `part`; what is read, and the wheel as it is then.
/// The mean radius lacks `ramp` of the last revolution's depth.
pub(super) fn plunge(
    process: &Infeed,
    mut part: State,
    u: &Input,
    [revolutions, spark_out]: [f64; 2],
    exponent: f64,
    ramp: f64,
) -> (Plunge, State) {
    let shares = |count: f64| {
        let whole = count.floor().max(0.0) as u32;
        let rest = count - count.floor();
        (0..whole).map(|_| 1.0).chain((rest > 1e-6).then_some(rest))
    };
    let bent = |part: &State, u: &Input| {
        let factor = if part.depth_of_cut > 0.0 { (part.depth_of_cut / DEPTH).max(1e-3).powf(exponent) } else { 1.0 };
        Input { process_stiffness_factor: u.process_stiffness_factor * factor, ..*u }
    };
    let mut rise = vec![(0.0, 0.0)];
    for share in shares(revolutions) {
        turn(process, &mut part, u, exponent, share);
        let force = process.output(&part, &bent(&part, u)).normal_force;
        rise.push((rise.last().map_or(0.0, |last| last.0) + share, force));
    }
    let steady = process.output(&part, &bent(&part, u));
    // Heat comes in under infeed and stays until the part is gauged.
    let warm = part.stock_removed - steady.stock_removed;
    let resting = Input { infeed_per_rev: 0.0, ..*u };
    for share in shares(spark_out) {
        turn(process, &mut part, &resting, exponent, share);
    }
    let end = process.output(&part, &bent(&part, &resting));
    let read = Plunge {
        stock_removed: part.stock_removed - warm - ramp * part.depth_of_cut,
        normal_force: steady.normal_force,
        tangential_force: steady.tangential_force,
        rise_revolutions: risen(&rise, RISEN * steady.normal_force),
        force_after_spark_out: end.normal_force,
    };
    (read, part)
}

/// Where the force first comes to `level`, between revolutions on a straight line.
fn risen(rise: &[(f64, f64)], level: f64) -> f64 {
    let crossing = rise.windows(2).find(|pair| pair[1].1 >= level);
    crossing.map_or(0.0, |pair| {
        let ((from, low), (to, high)) = (pair[0], pair[1]);
        if high > low { from + (to - from) * (level - low) / (high - low) } else { to }
    })
}
