//! What one trial reads.

use crate::ChannelId;
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
    /// The reading of a channel; NaN of one that a trial does not read.
    #[expect(clippy::wildcard_enum_match_arm, reason = "a trial reads these of all channels")]
    pub fn channel(&self, id: ChannelId) -> f64 {
        match id {
            ChannelId::StockRemoved => self.stock_removed,
            ChannelId::NormalForce => self.normal_force,
            ChannelId::TangentialForce => self.tangential_force,
            ChannelId::RiseRevolutions => self.rise_revolutions,
            ChannelId::ForceAfterSparkOut => self.force_after_spark_out,
            _ => f64::NAN,
        }
    }
}

/// A part under the wheel, the force growing with a power of the depth.
struct Contact<'a> {
    process: &'a Infeed,
    part: State,
    exponent: f64,
    /// Factor on the stiffness at the depth of `part`.
    factor: f64,
}

fn stiffened(u: &Input, factor: f64) -> Input {
    Input { process_stiffness_factor: u.process_stiffness_factor * factor, ..*u }
}

impl Contact<'_> {
    fn factor_at(&self, depth: f64) -> f64 {
        if self.exponent == 0.0 || depth <= 0.0 { 1.0 } else { (depth / DEPTH).max(1e-3).powf(self.exponent) }
    }

    /// The input at the stiffness that the depth of the last revolution gives.
    fn input(&self, u: &Input) -> Input {
        stiffened(u, self.factor)
    }

    /// One revolution, or a part of one.
    fn turn(&mut self, u: &Input, share: f64) {
        // The first depth is not known yet.
        let first = self.part.depth_of_cut <= 0.0;
        let stiff = stiffened(u, if first { self.factor_at(0.5 * u.infeed_per_rev) } else { self.factor });
        let part = &mut self.part;
        let commanded = State { commanded_infeed: part.commanded_infeed + u.infeed_per_rev, ..*part };
        let next = self.process.cold_revolution(&commanded, &stiff);
        if share >= 1.0 {
            *part = next;
        } else {
            part.stock_removed += share * (next.stock_removed - part.stock_removed);
            part.depth_of_cut += share * (next.depth_of_cut - part.depth_of_cut);
            part.commanded_infeed += share * u.infeed_per_rev;
            part.revolutions += share;
        }
        self.factor = self.factor_at(self.part.depth_of_cut);
    }
}

/// A stage with an infeed of its own.
#[derive(Clone, Copy)]
pub(super) struct Stage {
    /// m a revolution.
    pub infeed_per_rev: f64,
    pub revolutions: f64,
}

/// Revolutions of infeed, of a finish stage and of spark-out on `part`; what is read, and the wheel as it is then.
/// The mean radius lacks `ramp` of the last revolution's depth.
pub(super) fn plunge(
    process: &Infeed,
    part: State,
    u: &Input,
    [revolutions, spark_out]: [f64; 2],
    finish: Stage,
    exponent: f64,
    ramp: f64,
) -> (Plunge, State) {
    let shares = |count: f64| {
        let whole = count.floor().max(0.0) as u32;
        let rest = count - count.floor();
        (0..whole).map(|_| 1.0).chain((rest > 1e-6).then_some(rest))
    };
    let mut contact = Contact { process, part, exponent, factor: 1.0 };
    contact.factor = contact.factor_at(part.depth_of_cut);
    let mut rise = vec![(0.0, 0.0)];
    for share in shares(revolutions) {
        contact.turn(u, share);
        let force = process.normal_force(&contact.part, &contact.input(u));
        rise.push((rise.last().map_or(0.0, |last| last.0) + share, force));
    }
    let steady = process.output(&contact.part, &contact.input(u));
    // Heat comes in under infeed and stays until the part is gauged.
    let mut warm = contact.part.stock_removed - steady.stock_removed;
    if finish.revolutions > 0.0 {
        let slower = Input { infeed_per_rev: finish.infeed_per_rev, ..*u };
        for share in shares(finish.revolutions) {
            contact.turn(&slower, share);
        }
        let end = process.output(&contact.part, &contact.input(&slower));
        warm = contact.part.stock_removed - end.stock_removed;
    }
    let resting = Input { infeed_per_rev: 0.0, ..*u };
    for share in shares(spark_out) {
        contact.turn(&resting, share);
    }
    let part = contact.part;
    let read = Plunge {
        stock_removed: part.stock_removed - warm - ramp * part.depth_of_cut,
        normal_force: steady.normal_force,
        tangential_force: steady.tangential_force,
        rise_revolutions: risen(&rise, steady.normal_force),
        force_after_spark_out: process.normal_force(&part, &contact.input(&resting)),
    };
    (read, part)
}

/// Where the force first comes to [`RISEN`] of `steady`. Between revolutions what is missing falls by the same share in
/// equal times, as it does from one to the next: on a straight line the slope by a stiffness would jump wherever the
/// crossing passes a whole number of revolutions.
fn risen(rise: &[(f64, f64)], steady: f64) -> f64 {
    let crossing = rise.windows(2).find(|pair| pair[1].1 >= RISEN * steady);
    crossing.map_or(0.0, |pair| {
        let ((from, low), (to, high)) = (pair[0], pair[1]);
        let [before, after] = [low, high].map(|force| 1.0 - force / steady);
        let share = if after > 0.0 && before > after {
            (before / (1.0 - RISEN)).ln() / (before / after).ln()
        } else if high > low {
            (RISEN * steady - low) / (high - low)
        } else {
            1.0
        };
        from + (to - from) * share
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_of_first_order_is_read_where_its_law_has_it() {
        for lag in [0.5, 0.5493, 0.553, 0.6_f64] {
            let rise: Vec<(f64, f64)> = (0..40).map(|n| (f64::from(n), 170.0 * (1.0 - lag.powi(n)))).collect();
            let golden = toolroom_infeed::revolutions_to(RISEN, lag);
            assert!((risen(&rise, 170.0) - golden).abs() < 1e-9, "{lag}: {} instead of {golden}", risen(&rise, 170.0));
        }
        // A force that has come to its end within a revolution has no rate to go by.
        assert!((risen(&[(0.0, 0.0), (1.0, 100.0)], 100.0) - 0.95).abs() < 1e-12);
        assert_eq!(risen(&[], 100.0), 0.0);
    }

    #[test]
    fn a_finish_stage_leaves_the_stock_of_the_recursion() {
        let process = Infeed::default();
        let u = Input { infeed_per_rev: 4.43e-6, ..Input::default() };
        let ground =
            |turns: [f64; 2], finish: Stage| plunge(&process, process.initial(), &u, turns, finish, 0.0, 0.0).0;
        let lag = toolroom_infeed::lag(process.parameters.process_stiffness, process.parameters.system_stiffness);
        let (mut depth, mut stock) = (0.0, 0.0);
        for infeed in [4.43e-6; 12].into_iter().chain([1e-6; 8]).chain([0.0; 4]) {
            depth = (1.0 - lag) * infeed + lag * depth;
            stock += depth;
        }
        let two = ground([12.0, 4.0], Stage { infeed_per_rev: 1e-6, revolutions: 8.0 });
        let (found, force) = (two.channel(ChannelId::StockRemoved), two.channel(ChannelId::NormalForce));
        // The shipped process wears its wheel by a little of the stock.
        assert!((found / stock - 1.0).abs() < 5e-3, "{found} {stock}");
        let one = ground([12.0, 4.0], Stage { infeed_per_rev: 0.0, revolutions: 0.0 });
        assert_eq!(force, one.channel(ChannelId::NormalForce));
        assert!(two.channel(ChannelId::ForceAfterSparkOut) > 0.0 && one.channel(ChannelId::StockRemoved) < found);
    }
}
