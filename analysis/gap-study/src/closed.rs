//! How far a key figure closes: recorded once, simulated in paired replications.

use toolroom_statistics::{Moments, student};

/// Standard errors below which a difference is none (1). Source: two standard errors, about 95 %.
const CERTAIN: f64 = 2.0;

/// A key figure as it was recorded, and of replications of two models on common random numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Replicated {
    /// As recorded.
    pub recorded: f64,
    /// Its standard error over days or machines.
    pub error: f64,
    /// Of the nominal model, replication by replication.
    pub nominal: Vec<f64>,
    /// Of the applied model, with the same random numbers.
    pub applied: Vec<f64>,
}

/// How far a gap closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closed {
    /// One less the ratio of the gaps after and before.
    pub share: f64,
    /// Its 90 % interval.
    pub ci90: [f64; 2],
}

fn moments(values: &[f64]) -> Moments {
    values.iter().copied().collect()
}

impl Replicated {
    /// Recorded less nominal, and recorded less applied value.
    pub fn gaps(&self) -> [f64; 2] {
        [&self.nominal, &self.applied].map(|values| self.recorded - moments(values).mean())
    }

    /// Whether the nominal model is off for certain.
    fn is_gap(&self) -> bool {
        let nominal = moments(&self.nominal);
        let gap = (self.recorded - nominal.mean()).abs();
        // What never varies and agrees is no gap either.
        gap > 0.0 && gap >= CERTAIN * self.error.hypot(nominal.standard_error())
    }

    /// The share that closes, by the delta method over the error of the record and the paired replications; `None` where
    /// there is no gap.
    pub fn closed(&self) -> Option<Closed> {
        if !self.is_gap() {
            return None;
        }
        let [before, after] = self.gaps();
        let (size, ratio) = (before.abs(), after.abs() / before.abs());
        let slope = (after.signum() - ratio * before.signum()) / size;
        let differences: Vec<f64> = self
            .nominal
            .iter()
            .zip(&self.applied)
            .map(|(nominal, applied)| (ratio * before.signum() * nominal - after.signum() * applied) / size)
            .collect();
        let error = (slope * self.error).hypot(moments(&differences).standard_error());
        let half = student(0.9, differences.len() as f64 - 1.0) * error;
        let share = 1.0 - ratio;
        Some(Closed { share, ci90: [share - half, (share + half).min(1.0)] })
    }

    /// Whether there is a gap with the applied model and it is larger than before, both for certain.
    pub fn grew(&self) -> bool {
        let [before, after] = self.gaps();
        if after.abs() < CERTAIN * self.error.hypot(moments(&self.applied).standard_error()) {
            return false;
        }
        let [first, second] = [before, after].map(f64::signum);
        let differences: Vec<f64> = self
            .nominal
            .iter()
            .zip(&self.applied)
            .map(|(nominal, applied)| first * nominal - second * applied)
            .collect();
        let error = ((second - first) * self.error).hypot(moments(&differences).standard_error());
        after.abs() - before.abs() > CERTAIN * error && after != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(applied: [f64; 5]) -> Replicated {
        let nominal = vec![200.0, 199.0, 201.0, 200.0, 198.0];
        Replicated { recorded: 176.0, error: 1.5, nominal, applied: applied.to_vec() }
    }

    #[test]
    fn a_gap_of_parts_closes_as_computed_independently() {
        let closed = parts([181.0, 179.0, 182.0, 180.0, 179.0]).closed().expect("a gap");
        for (found, golden) in [(closed.share, 0.822_034), (closed.ci90[0], 0.701_768), (closed.ci90[1], 0.942_300)] {
            assert!((found / golden - 1.0).abs() < 1e-6, "{found} instead of {golden}");
        }
        let [before, after] = parts([181.0, 179.0, 182.0, 180.0, 179.0]).gaps();
        assert!((before + 23.6).abs() < 1e-9 && (after + 4.2).abs() < 1e-9);
        let truth = parts([177.5, 176.0, 178.5, 177.0, 175.5]).closed().expect("a gap");
        assert!((closed.share / truth.share - 0.854_626).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_gap_closes_by_nothing_and_what_grows_is_said() {
        let near = Replicated { recorded: 199.0, ..parts([199.0; 5]) };
        assert_eq!((near.closed(), near.grew()), (None, false));
        // Machines that never break down are available all the time, recorded and simulated.
        let always = Replicated { recorded: 1.0, error: 0.0, nominal: vec![1.0; 5], applied: vec![1.0; 5] };
        assert_eq!((always.closed(), always.grew()), (None, false));
        let worse = Replicated { recorded: 199.0, ..parts([181.0, 179.0, 182.0, 180.0, 179.0]) };
        assert!(worse.grew());
        assert!(!parts([181.0, 179.0, 182.0, 180.0, 179.0]).grew());
    }

    #[test]
    fn nothing_grows_that_is_no_gap() {
        let near = |recorded: f64, error: f64| Replicated {
            recorded,
            error,
            nominal: vec![0.9201, 0.9202, 0.9203, 0.9202, 0.9201],
            applied: vec![0.9204, 0.9205, 0.9206, 0.9205, 0.9204],
        };
        // Three ten-thousandths farther off, where the record is known to three thousandths, and to one in ten thousand.
        assert!(!near(0.9198, 0.0032).grew() && near(0.9198, 0.0001).grew());
    }
}
