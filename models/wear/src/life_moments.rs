//! Mean and variation of tool life over the scatter of edges and batches.

use crate::{Cut, Pair, Scatter};

/// Mean and coefficient of variation of tool life over the scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LifeMoments {
    /// Mean, s.
    pub mean: f64,
    /// Standard deviation over mean.
    pub variation: f64,
}

/// Nodes and weights of 7-point Gauss–Hermite quadrature for the weight exp(-x²), positive half (Abramowitz and Stegun,
/// table 25.10).
const HERMITE: [(f64, f64); 4] = [
    (0.0, 0.810_264_617_556_807_3),
    (0.816_287_882_858_964_7, 0.425_607_252_610_127_8),
    (1.673_551_628_767_471_4, 0.054_515_582_819_127_03),
    (2.651_961_356_835_233_4, 0.000_971_781_245_099_519_2),
];

impl Scatter {
    /// Mean and variation of quasi-steady life at a constant cut over edge and batch scatter
    /// (not over noise, edge condition or chipping), by Gauss–Hermite quadrature.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Pair, Scatter};
    /// let pair = Pair::default();
    /// let moments = Scatter::shop().life_moments(&pair, &pair.reference_cut().at_speed(0.5));
    /// assert!((moments.mean / 60.0 - 23.905684).abs() < 1e-3);
    /// ```
    pub fn life_moments(&self, pair: &Pair, cut: &Cut) -> LifeMoments {
        // ∫ f(z) N(z) dz = Σ w/√π f(√2 x)
        let nodes: Vec<(f64, f64)> = HERMITE
            .iter()
            .flat_map(|(x, w)| [-1.0, 1.0].map(|sign| (sign * x, *w)).into_iter().skip(usize::from(*x == 0.0)))
            .map(|(x, w)| (x * std::f64::consts::SQRT_2, w / std::f64::consts::PI.sqrt()))
            .collect();
        let (mut first, mut second) = (0.0, 0.0);
        for (za, wa) in &nodes {
            for (zb, wb) in &nodes {
                for (zh, wh) in &nodes {
                    let varied = Cut {
                        mechanical_factor: cut.mechanical_factor * (self.mechanical_wear * za).exp(),
                        thermal_factor: cut.thermal_factor * (self.thermal_wear * zb).exp(),
                        hardness: cut.hardness * self.clip_hardness(1.0 + self.batch_hardness * zh),
                        ..*cut
                    };
                    let life = pair.life(&varied).cutting_time;
                    first += wa * wb * wh * life;
                    second += wa * wb * wh * life * life;
                }
            }
        }
        // The common factor divides the life: E exp(-σz) = exp(σ²/2), E exp(-2σz) = exp(2σ²).
        let variance = self.common_wear * self.common_wear;
        let mean = first * (0.5 * variance).exp();
        let square = second * (2.0 * variance).exp();
        LifeMoments { mean, variation: (square / (mean * mean) - 1.0).max(0.0).sqrt() }
    }
}
