//! Scatter: how edges, work pieces and readings differ from nominal.

use crate::Cut;
use rand::Rng;
use rand_distr::{Distribution, Exp1, StandardNormal};
use toolroom_process::record;

record! {
    /// Standard deviations of everything that varies. Multipliers are lognormal with median 1
    /// (for those, the deviation of the logarithm), hardness and allowance are normal.
    ///
    /// # Source
    /// Level of `common_wear`: coefficient of variation of tool life about 0.3 (Wager & Barash
    /// 1971 for HSS, abstract; Machinery's Handbook 31, p. 139: 25 to 45 %); in the laboratory
    /// 0.12 to 0.25 (PHM-2010 cutters, NASA/Ames milling replicates). The rest is assumption.
    /// Defaults are [`Scatter::shop`].
    pub struct Scatter {
        /// Wear of an edge, common to the mechanical and the thermal part.
        common_wear: Real = 0.28, 0.0..=2.0;
        /// Mechanical wear of an edge on its own.
        mechanical_wear: Real = 0.15, 0.0..=2.0;
        /// Thermal wear of an edge on its own.
        thermal_wear: Real = 0.15, 0.0..=2.0;
        /// Hardness from batch to batch.
        batch_hardness: Real = 0.03, 0.0..=0.5;
        /// Hardness from piece to piece of a batch.
        piece_hardness: Real = 0.02, 0.0..=0.5;
        /// Greatest deviation of hardness from nominal.
        hardness_clip: Real = 0.15, 0.0..=0.9;
        /// Allowance, which is depth of cut, from pass to pass.
        allowance: Real["m" => "mm"] = 0.05e-3, 0.0..=1e-2;
        /// Shear stress and pressure on the land, from pair to pair, independent.
        flank_stress: Real = 0.08, 0.0..=2.0;
        /// Gain of the thermo-EMF, from edge to edge (normal).
        emf_gain: Real = 0.015, 0.0..=0.5;
        /// Wear noise during the life, an Ornstein–Uhlenbeck process.
        life_noise: Real = 0.10, 0.0..=2.0;
        /// Correlation time of the wear noise.
        life_noise_time: Real["s" => "min"] = 300.0, 1e-3..=1e7;
        /// Median land of a mounted edge.
        initial_wear: Real["m" => "mm"] = 0.005e-3, 0.0..=1e-3;
        /// Scatter of that land.
        initial_wear_scatter: Real = 0.5, 0.0..=3.0;
        /// Share of edges that chip before the wear limit, for `Chipping::for_share`.
        chipped_share: Real = 0.10, 0.0..=0.99;
    }
}

/// How one edge differs from nominal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeScatter {
    /// Multiplier of both parts of wear.
    pub wear_factor: f64,
    /// Multiplier of mechanical wear.
    pub mechanical_factor: f64,
    /// Multiplier of thermal wear.
    pub thermal_factor: f64,
    /// Land as mounted, m.
    pub initial_flank_wear: f64,
    /// Gain of its thermocouple.
    pub emf_gain: f64,
    /// Accumulated chipping hazard that it bears.
    pub chipping_resistance: f64,
}

/// How the land's stresses of one pair differ from the parameter set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairScatter {
    /// Multiplier of the shear stress.
    pub flank_shear_factor: f64,
    /// Multiplier of the pressure.
    pub flank_pressure_factor: f64,
}

impl Scatter {
    /// A production shop.
    pub fn shop() -> Self {
        Self::default()
    }

    /// A laboratory: one batch of edges under one operator.
    pub fn lab() -> Self {
        Self { common_wear: 0.15, ..Self::default() }
    }

    /// No scatter at all.
    pub fn none() -> Self {
        Self {
            common_wear: 0.0,
            mechanical_wear: 0.0,
            thermal_wear: 0.0,
            batch_hardness: 0.0,
            piece_hardness: 0.0,
            allowance: 0.0,
            flank_stress: 0.0,
            emf_gain: 0.0,
            life_noise: 0.0,
            initial_wear: 0.0,
            initial_wear_scatter: 0.0,
            chipped_share: 0.0,
            ..Self::default()
        }
    }

    /// Draws an edge: always six numbers, whatever the settings.
    ///
    /// # Examples
    /// ```
    /// use rand::SeedableRng;
    /// use toolroom_wear::Scatter;
    /// let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    /// let edge = Scatter::none().sample_edge(&mut rng);
    /// assert_eq!((edge.wear_factor, edge.initial_flank_wear, edge.emf_gain), (1.0, 0.0, 1.0));
    /// ```
    pub fn sample_edge<R: Rng + ?Sized>(&self, rng: &mut R) -> EdgeScatter {
        EdgeScatter {
            wear_factor: lognormal(self.common_wear, rng),
            mechanical_factor: lognormal(self.mechanical_wear, rng),
            thermal_factor: lognormal(self.thermal_wear, rng),
            initial_flank_wear: self.initial_wear * lognormal(self.initial_wear_scatter, rng),
            emf_gain: 1.0 + self.emf_gain * normal(rng),
            chipping_resistance: Exp1.sample(rng),
        }
    }

    /// Draws the land's stresses of a pair.
    pub fn sample_pair<R: Rng + ?Sized>(&self, rng: &mut R) -> PairScatter {
        PairScatter {
            flank_shear_factor: lognormal(self.flank_stress, rng),
            flank_pressure_factor: lognormal(self.flank_stress, rng),
        }
    }

    /// Draws the hardness of a batch, against nominal.
    pub fn sample_batch_hardness<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.clip_hardness(1.0 + self.batch_hardness * normal(rng))
    }

    /// Draws the hardness of a piece of a batch, against nominal.
    pub fn sample_piece_hardness<R: Rng + ?Sized>(&self, batch_hardness: f64, rng: &mut R) -> f64 {
        self.clip_hardness(batch_hardness + self.piece_hardness * normal(rng))
    }

    pub(crate) fn clip_hardness(&self, hardness: f64) -> f64 {
        hardness.clamp(1.0 - self.hardness_clip, 1.0 + self.hardness_clip)
    }

    /// Draws the depth of cut of a pass around a nominal one (m); never below a tenth of it.
    pub fn sample_depth<R: Rng + ?Sized>(&self, depth_of_cut: f64, rng: &mut R) -> f64 {
        (depth_of_cut + self.allowance * normal(rng)).max(0.1 * depth_of_cut)
    }

    /// The wear noise `dt` seconds after it was `noise` (0 on average): the exact transition
    /// `noise·e^(-dt/τ) + σ·sqrt(1 - e^(-2dt/τ))·z`. Start from [`Scatter::sample_noise`].
    pub fn next_noise<R: Rng + ?Sized>(&self, noise: f64, dt: f64, rng: &mut R) -> f64 {
        let (decay, spread) = self.noise_transition(dt);
        noise * decay + spread * normal(rng)
    }

    /// Share of the wear noise that is left after `dt` seconds, and the standard deviation of what
    /// comes anew: [`Scatter::next_noise`] for whoever takes many equal steps.
    pub fn noise_transition(&self, dt: f64) -> (f64, f64) {
        let time = dt / self.life_noise_time;
        ((-time).exp(), self.life_noise * (-(-2.0 * time).exp_m1()).sqrt())
    }

    /// Draws stationary wear noise.
    pub fn sample_noise<R: Rng + ?Sized>(&self, rng: &mut R) -> f64 {
        self.life_noise * normal(rng)
    }

    /// The wear factor of a noise value, of mean 1: `exp(noise - σ²/2)`.
    pub fn noise_factor(&self, noise: f64) -> f64 {
        (noise - 0.5 * self.life_noise * self.life_noise).exp()
    }
}

impl EdgeScatter {
    /// `cut` as this edge meets it.
    pub fn apply(&self, cut: &Cut) -> Cut {
        Cut {
            wear_factor: cut.wear_factor * self.wear_factor,
            mechanical_factor: cut.mechanical_factor * self.mechanical_factor,
            thermal_factor: cut.thermal_factor * self.thermal_factor,
            ..*cut
        }
    }
}

impl PairScatter {
    /// `cut` as this pair meets it.
    pub fn apply(&self, cut: &Cut) -> Cut {
        Cut {
            flank_shear_factor: cut.flank_shear_factor * self.flank_shear_factor,
            flank_pressure_factor: cut.flank_pressure_factor * self.flank_pressure_factor,
            ..*cut
        }
    }
}

fn normal<R: Rng + ?Sized>(rng: &mut R) -> f64 {
    StandardNormal.sample(rng)
}

/// Median 1, standard deviation of the logarithm `sigma`; exactly 1 for `sigma` 0.
fn lognormal<R: Rng + ?Sized>(sigma: f64, rng: &mut R) -> f64 {
    (sigma * normal(rng)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    fn moments(values: &[f64]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
    }

    #[test]
    fn edges_scatter_as_declared() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let scatter = Scatter::shop();
        let edges: Vec<EdgeScatter> = (0..20_000).map(|_| scatter.sample_edge(&mut rng)).collect();
        let moments_of = |pick: fn(&EdgeScatter) -> f64| moments(&edges.iter().map(pick).collect::<Vec<_>>());
        // Standard errors at 20 000 draws are 0.7 % of a mean of spread 1, 0.5 % of a deviation.
        let (mean, deviation) = moments_of(|e| e.wear_factor.ln());
        assert!(mean.abs() < 0.008 && (deviation - 0.28).abs() < 0.006, "{mean}, {deviation}");
        let (mean, deviation) = moments_of(|e| e.emf_gain);
        assert!((mean - 1.0).abs() < 5e-4 && (deviation - 0.015).abs() < 4e-4, "{mean}, {deviation}");
        let (mean, deviation) = moments_of(|e| e.chipping_resistance);
        assert!((mean - 1.0).abs() < 0.03 && (deviation - 1.0).abs() < 0.04, "{mean}, {deviation}");
        let (mean, _) = moments_of(|e| (e.initial_flank_wear * 1e3).ln());
        assert!((mean - 0.005f64.ln()).abs() < 0.015, "{mean}");
    }

    #[test]
    fn wear_noise_keeps_its_spread_and_forgets_with_its_time() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let scatter = Scatter::shop();
        let mut noise = scatter.sample_noise(&mut rng);
        let run: Vec<f64> = (0..60_000)
            .map(|_| {
                noise = scatter.next_noise(noise, 150.0, &mut rng);
                noise
            })
            .collect();
        let (mean, deviation) = moments(&run);
        assert!(mean.abs() < 0.004 && (deviation - 0.10).abs() < 0.003, "{mean}, {deviation}");
        let lagged = run.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / run.len() as f64;
        assert!((lagged / 0.01 - (-0.5f64).exp()).abs() < 0.03, "{lagged}");
        let (factor, _) = moments(&run.iter().map(|n| scatter.noise_factor(*n)).collect::<Vec<_>>());
        assert!((factor - 1.0).abs() < 0.004, "{factor}");
    }

    #[test]
    fn hardness_stays_within_its_clip() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let wild = Scatter { batch_hardness: 0.3, piece_hardness: 0.3, ..Scatter::shop() };
        for _ in 0..1000 {
            let batch = wild.sample_batch_hardness(&mut rng);
            let piece = wild.sample_piece_hardness(batch, &mut rng);
            assert!((0.85..=1.15).contains(&batch) && (0.85..=1.15).contains(&piece));
        }
    }
}
