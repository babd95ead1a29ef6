//! Selection of the best of several systems, with a guarantee, on common random numbers.

use crate::Moments;

/// Replications from which the procedure knows how much differences scatter.
pub const FIRST_STAGE: u32 = 10;

/// What is asked: the best of `systems`, with probability `confidence`, if it is better than every other by at least
/// `indifference`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// Number of systems, at least 2.
    pub systems: usize,
    /// Least difference that matters, above 0.
    pub indifference: f64,
    /// Probability of a right selection, above 1/systems and below 1.
    pub confidence: f64,
    /// Whether the least mean is the best.
    pub least: bool,
    /// Most replications of a system.
    pub most: u32,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Selected {
    /// The best; `None` where [`Selection::most`] did not suffice, or a value was not there.
    pub best: Option<usize>,
    /// Systems that were not struck out.
    pub survivors: Vec<usize>,
    /// Replications that each system took part in.
    pub replications: Vec<u32>,
    /// The constant h² of the procedure, 1.
    pub h2: f64,
}

impl Selection {
    /// The procedure KN: after [`FIRST_STAGE`] replications of all systems, one replication of the survivors after the
    /// other, those that are worse than another by more than chance allows are struck out. `value` gives the value of a
    /// system in a replication, from 0; `None` ends it without result.
    ///
    /// The guarantee holds for normal values, whether or not the systems share random numbers.
    ///
    /// # Source
    /// S.-H. Kim, B. L. Nelson, A fully sequential procedure for indifference-zone selection in simulation,
    /// ACM Transactions on Modeling and Computer Simulation 11 (2001) 251, with c = 1.
    pub fn select<E>(&self, mut value: impl FnMut(usize, u32) -> Result<Option<f64>, E>) -> Result<Selected, E> {
        let (count, first) = (self.systems, FIRST_STAGE);
        let degrees = f64::from(first - 1);
        let eta = 0.5 * ((2.0 * (1.0 - self.confidence) / (count as f64 - 1.0)).powf(-2.0 / degrees) - 1.0);
        let h2 = 2.0 * eta * degrees;
        let mut selected = Selected { best: None, survivors: (0..count).collect(), replications: vec![0; count], h2 };
        let mut sums = vec![0.0; count];
        let mut early: Vec<Vec<f64>> = vec![Vec::new(); count];
        let mut variances: Vec<Vec<f64>> = Vec::new();
        let sign = if self.least { 1.0 } else { -1.0 };
        for replication in 0..self.most {
            for &system in &selected.survivors {
                let Some(value) = value(system, replication)?.filter(|value| value.is_finite()) else {
                    return Ok(selected);
                };
                sums[system] += sign * value;
                selected.replications[system] = replication + 1;
                if replication < first {
                    early[system].push(value);
                }
            }
            if replication + 1 < first {
                continue;
            }
            if variances.is_empty() {
                let variance =
                    |a: &Vec<f64>, b: &Vec<f64>| a.iter().zip(b).map(|(a, b)| a - b).collect::<Moments>().variance();
                variances = early.iter().map(|a| early.iter().map(|b| variance(a, b)).collect()).collect();
            }
            let stage = f64::from(replication + 1);
            let room = |a: usize, b: usize| {
                let needed = h2 * variances[a][b] / (self.indifference * self.indifference);
                (self.indifference / (2.0 * stage) * (needed - stage)).max(0.0)
            };
            let before = selected.survivors.clone();
            let worse = |a: usize| before.iter().any(|&b| b != a && (sums[a] - sums[b]) / stage > room(a, b));
            selected.survivors.retain(|&system| !worse(system));
            let last = before.iter().flat_map(|&a| before.iter().map(move |&b| (a, b)));
            let enough =
                last.map(|(a, b)| h2 * variances[a][b] / (self.indifference * self.indifference)).fold(0.0, f64::max);
            if selected.survivors.len() == 1 || stage > enough {
                let best = selected.survivors.iter().copied().min_by(|&a, &b| sums[a].total_cmp(&sums[b]));
                selected.best = best;
                return Ok(selected);
            }
        }
        Ok(selected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn found(selection: Selection, value: impl Fn(usize, u32) -> f64) -> Selected {
        selection.select(|system, replication| Ok::<_, Infallible>(Some(value(system, replication)))).expect("values")
    }

    const FIVE: Selection = Selection { systems: 5, indifference: 0.3, confidence: 0.95, least: true, most: 1000 };

    /// Five systems whose values were computed independently.
    fn example(system: usize, replication: u32) -> f64 {
        let (r, i) = (f64::from(replication + 1), (system + 1) as f64);
        let fraction = |value: f64| value - value.floor();
        let mean = [10.0, 10.4, 10.9, 11.6, 12.0][system];
        let golden = 0.618_033_988_749_894_9;
        mean + 8.0 * (fraction(r * golden) - 0.5) + 2.0 * (fraction(0.718_281_828_459_045_2 * r * i + 0.1 * i) - 0.5)
    }

    #[test]
    fn five_systems_are_struck_out_as_computed_independently() {
        let selected = found(FIVE, example);
        assert!((selected.h2 - 11.429_410_77).abs() < 5e-9, "{}", selected.h2);
        assert_eq!(selected.best, Some(0));
        assert_eq!(selected.replications, [14, 14, 11, 10, 10]);
        let negative = found(Selection { least: false, ..FIVE }, |system, replication| -example(system, replication));
        assert_eq!(negative, selected);
    }

    #[test]
    fn four_differences_together_are_as_computed_independently() {
        let sample = |system: usize| (0..20).map(|replication| example(system, replication)).collect::<Vec<f64>>();
        let difference = |system: usize| crate::paired(&sample(system), &sample(0), 1.0 - 0.05 / 4.0).difference;
        for (system, mean, half_width) in [(1, 0.383_918_4, 0.373_275_6), (4, 1.935_673_6, 0.438_321_6)] {
            let found = difference(system);
            assert!((found.mean - mean).abs() < 5e-8, "{}", found.mean);
            assert!((found.half_width - half_width).abs() < 5e-8, "{}", found.half_width);
        }
        let ten: Moments = (0..10).map(|replication| example(0, replication) - example(1, replication)).collect();
        assert!((ten.variance() - 0.382_984_221_1).abs() < 5e-11, "{}", ten.variance());
    }

    #[test]
    fn the_best_is_found_as_often_as_promised() {
        // Normal values that share half of their variance; the best is better by just the indifference.
        let uniform = |seed: u64| {
            let mixed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            let mixed = (mixed ^ mixed >> 29).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((mixed ^ mixed >> 32) >> 11) as f64 / (1u64 << 53) as f64
        };
        let normal = |seed: u64| (0..12).map(|part| uniform(seed * 12 + part)).sum::<f64>() - 6.0;
        let right = (0..400u64).filter(|trial| {
            let value = |system: usize, replication: u32| {
                let base = trial * 1_000_000 + u64::from(replication) * 10;
                let mean = if system == 0 { 0.0 } else { 0.3 };
                mean + normal(base) + normal(base + 1 + system as u64)
            };
            found(FIVE, value).best == Some(0)
        });
        // 95 % of 400, less three standard deviations.
        assert!(right.count() >= 367);
    }

    #[test]
    fn equal_systems_end_and_missing_values_give_nothing() {
        assert_eq!(found(FIVE, |_, _| 1.0).best, Some(0));
        let none =
            FIVE.select(|system, r| Ok::<_, Infallible>((system != 2 || r < 3).then_some(f64::from(r)))).unwrap();
        assert_eq!(none.best, None);
    }
}
