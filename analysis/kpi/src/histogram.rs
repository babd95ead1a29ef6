//! Quantiles of times that are counted and not kept.

/// Parts into which each factor of two of a time is divided, as a power of two: the mean of a part is then within 1/256 of
/// every time in it.
const PARTS: u32 = 8;
/// Bits of a number below those that name its part.
const BELOW: u32 = f64::MANTISSA_DIGITS - 1 - PARTS;

/// Times counted in parts of equal width within each factor of two: a quantile is the mean of the times of its part, which is the time
/// itself where no others are near it, in memory that does not grow with their number.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Histogram {
    /// Name of the first part: the leading bits of the numbers in it.
    first: u64,
    /// Number of times by part, from the first one on, and their sum, s.
    counts: Vec<(u64, f64)>,
    /// Times of zero.
    zeros: u64,
    total: u64,
}

impl Histogram {
    /// Counts a time, s; one below zero counts as zero.
    #[inline]
    pub fn add(&mut self, time: f64) {
        self.total += 1;
        if time <= 0.0 {
            self.zeros += 1;
            return;
        }
        let part = time.to_bits() >> BELOW;
        if self.counts.is_empty() {
            self.first = part;
        } else if part < self.first {
            let more = (self.first - part) as usize;
            self.counts.splice(..0, std::iter::repeat_n((0, 0.0), more));
            self.first = part;
        }
        let place = (part - self.first) as usize;
        if place >= self.counts.len() {
            self.counts.resize(place + 1, (0, 0.0));
        }
        let (count, sum) = &mut self.counts[place];
        *count += 1;
        *sum += time;
    }

    /// The least time that is not exceeded by `share` of all, s; NaN where none was counted.
    pub fn quantile(&self, share: f64) -> f64 {
        if self.total == 0 {
            return f64::NAN;
        }
        let rank = (share * self.total as f64).ceil().max(1.0) as u64;
        let mut below = self.zeros;
        if below >= rank {
            return 0.0;
        }
        for (count, sum) in &self.counts {
            below += count;
            if below >= rank {
                return sum / *count as f64;
            }
        }
        f64::NAN
    }
}

#[cfg(test)]
mod tests {
    use super::Histogram;

    #[test]
    fn quantiles_are_within_half_a_per_cent_of_the_sorted_times() {
        // Lead times over six decades, in an order that grows at both ends.
        let mut times: Vec<f64> =
            (0..20_000).map(|i| 10.0_f64.powf(f64::from((i * 7919) % 20_000) / 20_000.0 * 6.0 - 1.0)).collect();
        let mut histogram = Histogram::default();
        times.iter().for_each(|time| histogram.add(*time));
        times.sort_by(f64::total_cmp);
        for share in [0.001, 0.1, 0.5, 0.8, 0.95, 1.0_f64] {
            let exact = times[(share * times.len() as f64).ceil() as usize - 1];
            assert!((histogram.quantile(share) / exact - 1.0).abs() < 0.004, "{share}: {exact}");
        }
    }

    #[test]
    fn no_time_has_no_quantile_and_zeros_count() {
        let mut histogram = Histogram::default();
        assert!(histogram.quantile(0.5).is_nan());
        [0.0, 0.0, 60.0].iter().for_each(|time| histogram.add(*time));
        assert_eq!(histogram.quantile(0.5), 0.0);
        assert_eq!(histogram.quantile(0.95), 60.0);
    }
}
