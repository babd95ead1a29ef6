//! Pareto smoothing of importance weights.

use crate::normal::ln_sum;

/// Importance weights, smoothed and normalised, with the shape of their tail.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    /// Weights that add up to one.
    pub weights: Vec<f64>,
    /// Shape k of the generalised Pareto distribution of the greatest ratios; above 0.7 the weights cannot be relied on.
    pub shape: f64,
}

impl Weights {
    /// Smooths the logarithms of importance ratios: the greatest `min(0.2·S, 3·√S)` are replaced by quantiles of the
    /// generalised Pareto distribution fitted to them.
    ///
    /// # Source
    /// A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, Pareto smoothed importance sampling (arXiv 1507.02646); fit by
    /// J. Zhang and M. A. Stephens, Technometrics 51 (2009) 316.
    pub fn smoothed(ratios: &[f64]) -> Self {
        let count = ratios.len();
        let greatest = ratios.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut ratios: Vec<f64> = ratios.iter().map(|ratio| ratio - greatest).collect();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| ratios[*a].total_cmp(&ratios[*b]));
        let tail = (0.2 * count as f64).min(3.0 * (count as f64).sqrt()) as usize;
        let mut shape = f64::INFINITY;
        if tail >= 5 && tail < count {
            let cutoff = ratios[order[count - tail - 1]];
            let excesses: Vec<f64> =
                order[count - tail..].iter().map(|index| ratios[*index].exp() - cutoff.exp()).collect();
            let (k, sigma) = pareto(&excesses);
            shape = k;
            if k.is_finite() && sigma > 0.0 {
                for (rank, index) in order[count - tail..].iter().enumerate() {
                    let share = (rank as f64 + 0.5) / tail as f64;
                    let excess = if k.abs() < 1e-12 {
                        -sigma * (-share).ln_1p()
                    } else {
                        sigma * ((1.0 - share).powf(-k) - 1.0) / k
                    };
                    ratios[*index] = (cutoff.exp() + excess).ln().min(0.0);
                }
            }
        }
        let sum = ln_sum(&ratios);
        Self { weights: ratios.iter().map(|ratio| (ratio - sum).exp()).collect(), shape }
    }

    /// Number of independent draws that tell as much.
    pub fn effective(&self) -> f64 {
        1.0 / self.weights.iter().map(|weight| weight * weight).sum::<f64>()
    }
}

/// Shape and scale of the generalised Pareto distribution of ascending excesses.
fn pareto(excesses: &[f64]) -> (f64, f64) {
    let count = excesses.len();
    let last = excesses[count - 1];
    let quartile = excesses[((count as f64 / 4.0 + 0.5) as usize).clamp(1, count) - 1];
    if !(quartile > 0.0 && last.is_finite()) {
        return (f64::INFINITY, f64::NAN);
    }
    let grid = 30 + (count as f64).sqrt() as usize;
    let thetas: Vec<f64> =
        (1..=grid).map(|j| 1.0 / last + (1.0 - (grid as f64 / (j as f64 - 0.5)).sqrt()) / (3.0 * quartile)).collect();
    let k_of = |theta: f64| excesses.iter().map(|x| (-theta * x).ln_1p()).sum::<f64>() / count as f64;
    let profile: Vec<f64> = thetas
        .iter()
        .map(|theta| {
            let k = k_of(*theta);
            count as f64 * ((-theta / k).ln() - k - 1.0)
        })
        .collect();
    let sum = ln_sum(&profile);
    let theta: f64 = thetas.iter().zip(&profile).map(|(theta, profile)| theta * (profile - sum).exp()).sum();
    let k = k_of(theta);
    let sigma = -k / theta;
    // A weak prior at 0.5 with the weight of ten draws steadies short tails.
    let count = count as f64;
    ((k * count + 5.0) / (count + 10.0), sigma)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_of_a_pareto_tail_is_found() {
        for shape in [0.2, 0.6] {
            let ratios: Vec<f64> =
                (0..4000).map(|i| (-shape * (1.0 - (i as f64 + 0.5) / 4000.0_f64).ln()).exp().ln()).collect();
            let found = Weights::smoothed(&ratios);
            assert!((found.shape - shape).abs() < 0.08, "{shape}: {}", found.shape);
            assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        let equal = Weights::smoothed(&[0.3; 100]);
        assert!((equal.effective() - 100.0).abs() < 1e-9);
    }
}
