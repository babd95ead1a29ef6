//! When scores moved.

/// Share of the posterior that the set of dates holds.
const SET: f64 = 0.9;

/// Posterior of the block after which scores moved by a shift of which nothing is known but that it is about a standard
/// deviation (normal prior of deviation 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Weight of a change after each number of blocks, from none on; they sum to 1.
    pub weights: Vec<f64>,
}

impl Change {
    /// Of scores that are standard normal before the change. Empty without scores.
    ///
    /// With sum S and number m of the scores after it, a change has the weight `exp(S²/(2(m + 1)))/√(m + 1)`.
    pub fn of(scores: &[f64]) -> Self {
        let logarithm = |blocks: usize| {
            let (sum, count) = (scores[blocks..].iter().sum::<f64>(), (scores.len() - blocks) as f64);
            0.5 * sum * sum / (count + 1.0) - 0.5 * count.ln_1p()
        };
        let logarithms: Vec<f64> = (0..scores.len()).map(logarithm).collect();
        let greatest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = logarithms.iter().map(|own| (own - greatest).exp()).sum();
        Self { weights: logarithms.iter().map(|own| (own - greatest).exp() / total).collect() }
    }

    /// Number of blocks before the likeliest change.
    pub fn best(&self) -> usize {
        let heavier = |best: usize, own: usize| if self.weights[own] > self.weights[best] { own } else { best };
        (0..self.weights.len()).fold(0, heavier)
    }

    /// First and last of the smallest set of changes that holds nine tenths of the posterior.
    pub fn span(&self) -> (usize, usize) {
        let mut order: Vec<usize> = (0..self.weights.len()).collect();
        order.sort_by(|a, b| self.weights[*b].total_cmp(&self.weights[*a]));
        let mut held = 0.0;
        let mut span = (self.best(), self.best());
        for blocks in order {
            if held >= SET {
                break;
            }
            held += self.weights[blocks];
            span = (span.0.min(blocks), span.1.max(blocks));
        }
        span
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_date_of_a_change_is_that_computed_independently() {
        let change = Change::of(&[0.2, -1.1, 0.5, -0.3, 0.9, -0.6, 1.4, 0.8, 1.9, 0.7, 1.6, 1.2]);
        assert_eq!((change.best(), change.span()), (6, (2, 9)));
        assert!((change.weights[6] / 0.287_840 - 1.0).abs() < 1e-5, "{}", change.weights[6]);
        assert!(Change::of(&[]).weights.is_empty());
    }
}
