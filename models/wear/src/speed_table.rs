//! A speed law tabulated over flank wear.

/// Intervals of the table.
const INTERVALS: usize = 256;
/// Flank wear at the end of the table, in wear limits.
const REACH: f64 = 2.0;

/// The speed of a control law against flank wear for one cut, for whoever asks often.
///
/// Cubic through points evenly spaced in the square root of wear, where the laws are smooth;
/// within 1e-5 of the law itself. Beyond twice the wear limit the last speed holds.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedTable {
    longest: f64,
    speeds: Vec<f64>,
}

impl SpeedTable {
    /// Tabulates a law `speed_at(flank_wear)` for an edge with this wear limit (m).
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Pair, SpeedTable};
    /// let pair = Pair::default();
    /// let law = |h: f64| pair.minimum_wear_speed(&pair.reference_cut(), h);
    /// let table = SpeedTable::tabulate(pair.limits.wear_limit, law);
    /// assert!((table.speed_at(0.2e-3) / law(0.2e-3) - 1.0).abs() < 1e-6);
    /// ```
    pub fn tabulate(wear_limit: f64, speed_at: impl Fn(f64) -> f64) -> Self {
        let longest = REACH * wear_limit;
        let speed = |i: usize| speed_at(longest * (i as f64 / INTERVALS as f64).powi(2));
        Self { longest, speeds: (0..=INTERVALS).map(speed).collect() }
    }

    /// Speed at a flank wear (m), m/s.
    pub fn speed_at(&self, flank_wear: f64) -> f64 {
        let position = (flank_wear / self.longest).clamp(0.0, 1.0).sqrt() * INTERVALS as f64;
        let interval = (position as usize).min(INTERVALS - 1);
        let t = position - interval as f64;
        // Points outside the table continue its first and last interval in a straight line.
        let speed = |i: usize, shift: isize| match i.checked_add_signed(shift) {
            None => 2.0 * self.speeds[0] - self.speeds[1],
            Some(i) if i > INTERVALS => 2.0 * self.speeds[INTERVALS] - self.speeds[INTERVALS - 1],
            Some(i) => self.speeds[i],
        };
        let (before, left, right, after) =
            (speed(interval, -1), speed(interval, 0), speed(interval, 1), speed(interval, 2));
        let (slope_left, slope_right) = (0.5 * (right - before), 0.5 * (after - left));
        let rise = right - left;
        left + t
            * (slope_left
                + t * (3.0 * rise - 2.0 * slope_left - slope_right + t * (slope_left + slope_right - 2.0 * rise)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pair;

    #[test]
    fn the_table_follows_every_law_it_can_hold() {
        for name in ["ni_vk6om", "c45_t15k6", "ti_vk6"] {
            let pair = Pair::named(name).unwrap();
            let cut = pair.reference_cut();
            let laws: [&dyn Fn(f64) -> f64; 3] = [
                &|wear| pair.minimum_wear_speed(&cut, wear),
                &|wear| pair.literal_balance_speed(&cut, wear),
                &|wear| pair.shadow_price_speed(&cut, wear, 2.4),
            ];
            for law in laws {
                let table = SpeedTable::tabulate(pair.limits.wear_limit, law);
                for i in 0..200 {
                    let wear = pair.limits.wear_limit * f64::from(i) / 150.0;
                    let (exact, tabulated) = (law(wear), table.speed_at(wear));
                    assert!((tabulated / exact - 1.0).abs() < 1e-5, "{name} at {wear}: {tabulated}, law {exact}");
                }
            }
        }
    }
}
