//! Distributions of lives.

use super::normal;
use statrs::function::gamma::{checked_gamma_lr, checked_gamma_ur, gamma, ln_gamma};

/// A family of laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Weibull with shape and scale.
    Weibull,
    /// Weibull that starts at a location above 0.
    Weibull3,
    /// Lognormal.
    Lognormal,
    /// Normal.
    Normal,
    /// Gamma.
    Gamma,
    /// Inverse Gaussian: first passage of a drifting Wiener process through a limit.
    InverseGaussian,
    /// The earlier of a lognormal wear-out and a Weibull chipping.
    CompetingRisks,
}

impl Family {
    /// Every family, in the order of reports.
    pub const ALL: [Self; 7] = [
        Self::Weibull,
        Self::Weibull3,
        Self::Lognormal,
        Self::Normal,
        Self::Gamma,
        Self::InverseGaussian,
        Self::CompetingRisks,
    ];

    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Weibull => "weibull",
            Self::Weibull3 => "weibull_3",
            Self::Lognormal => "lognormal",
            Self::Normal => "normal",
            Self::Gamma => "gamma",
            Self::InverseGaussian => "inverse_gaussian",
            Self::CompetingRisks => "competing_risks",
        }
    }

    /// Number of parameters.
    pub fn parameters(self) -> usize {
        match self {
            Self::Weibull3 => 3,
            Self::CompetingRisks => 4,
            Self::Weibull | Self::Lognormal | Self::Normal | Self::Gamma | Self::InverseGaussian => 2,
        }
    }
}

/// What unit a parameter has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// That of lives.
    Life,
    /// None.
    Number,
}

/// One law of life.
///
/// | family | survival R(t) |
/// |---|---|
/// | Weibull | `exp(-((t - location)/scale)^shape)` |
/// | lognormal | `Phi(-(ln t - ln median)/sigma)` |
/// | normal | `Phi(-(t - mean)/deviation)`; lives below 0 are possible in it |
/// | gamma | `Q(shape, t/scale)` |
/// | inverse Gaussian | density `sqrt(shape/(2 pi t^3)) exp(-shape (t - mean)^2/(2 mean^2 t))` |
/// | competing risks | product of a lognormal and a Weibull R |
///
/// # Examples
/// ```
/// use toolroom_life::law::Law;
/// let law = Law::Weibull { shape: 2.0, scale: 10.0 };
/// assert!((law.survival(10.0) - (-1.0f64).exp()).abs() < 1e-15);
/// assert!((law.quantile(0.1) - 3.245_928).abs() < 1e-6); // B10
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Weibull; `location` is 0 with two parameters.
    Weibull {
        /// Shape β.
        shape: f64,
        /// Scale η.
        scale: f64,
    },
    /// Weibull with three parameters.
    Weibull3 {
        /// Shape β.
        shape: f64,
        /// Scale η.
        scale: f64,
        /// Location γ: no life is shorter.
        location: f64,
    },
    /// Lognormal.
    Lognormal {
        /// Median.
        median: f64,
        /// Standard deviation of the logarithm.
        sigma: f64,
    },
    /// Normal.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        deviation: f64,
    },
    /// Gamma.
    Gamma {
        /// Shape.
        shape: f64,
        /// Scale.
        scale: f64,
    },
    /// Inverse Gaussian.
    InverseGaussian {
        /// Mean.
        mean: f64,
        /// Shape λ; the variance is mean³/λ.
        shape: f64,
    },
    /// Wear-out against chipping, whichever comes first.
    CompetingRisks {
        /// Median of the lognormal wear-out.
        wear_median: f64,
        /// Standard deviation of the logarithm of the wear-out.
        wear_sigma: f64,
        /// Weibull shape of chipping.
        chipping_shape: f64,
        /// Weibull scale of chipping.
        chipping_scale: f64,
    },
}

impl Law {
    /// The family.
    pub fn family(&self) -> Family {
        match self {
            Self::Weibull { .. } => Family::Weibull,
            Self::Weibull3 { .. } => Family::Weibull3,
            Self::Lognormal { .. } => Family::Lognormal,
            Self::Normal { .. } => Family::Normal,
            Self::Gamma { .. } => Family::Gamma,
            Self::InverseGaussian { .. } => Family::InverseGaussian,
            Self::CompetingRisks { .. } => Family::CompetingRisks,
        }
    }

    /// Parameters by name, in the order of the fields.
    pub fn parameters(&self) -> Vec<(&'static str, f64, Dimension)> {
        use Dimension::{Life, Number};
        match *self {
            Self::Weibull { shape, scale } | Self::Gamma { shape, scale } => {
                vec![("shape", shape, Number), ("scale", scale, Life)]
            }
            Self::Weibull3 { shape, scale, location } => {
                vec![("shape", shape, Number), ("scale", scale, Life), ("location", location, Life)]
            }
            Self::Lognormal { median, sigma } => vec![("median", median, Life), ("sigma", sigma, Number)],
            Self::Normal { mean, deviation } => vec![("mean", mean, Life), ("deviation", deviation, Life)],
            Self::InverseGaussian { mean, shape } => vec![("mean", mean, Life), ("shape", shape, Life)],
            Self::CompetingRisks { wear_median, wear_sigma, chipping_shape, chipping_scale } => vec![
                ("wear_median", wear_median, Life),
                ("wear_sigma", wear_sigma, Number),
                ("chipping_shape", chipping_shape, Number),
                ("chipping_scale", chipping_scale, Life),
            ],
        }
    }

    /// The two risks of a competition.
    fn risks(&self) -> Option<(Self, Self)> {
        let Self::CompetingRisks { wear_median, wear_sigma, chipping_shape, chipping_scale } = *self else {
            return None;
        };
        Some((
            Self::Lognormal { median: wear_median, sigma: wear_sigma },
            Self::Weibull { shape: chipping_shape, scale: chipping_scale },
        ))
    }

    /// Logarithm of the density at an age.
    pub fn ln_density(&self, age: f64) -> f64 {
        if age <= 0.0 && !matches!(self, Self::Normal { .. }) {
            return f64::NEG_INFINITY;
        }
        match *self {
            Self::Weibull { shape, scale } => weibull_ln_density(age / scale, shape, scale),
            Self::Weibull3 { shape, scale, location } => weibull_ln_density((age - location) / scale, shape, scale),
            Self::Lognormal { median, sigma } => normal::ln_density((age / median).ln() / sigma) - (sigma * age).ln(),
            Self::Normal { mean, deviation } => normal::ln_density((age - mean) / deviation) - deviation.ln(),
            Self::Gamma { shape, scale } => {
                let x = age / scale;
                (shape - 1.0) * x.ln() - x - ln_gamma(shape) - scale.ln()
            }
            Self::InverseGaussian { mean, shape } => {
                let z = (shape / age).sqrt() * (age / mean - 1.0);
                normal::ln_density(z) + 0.5 * (shape / age.powi(3)).ln()
            }
            Self::CompetingRisks { .. } => self.risks().map_or(f64::NAN, |(wear, chipping)| {
                self.ln_survival(age) + (wear.hazard(age) + chipping.hazard(age)).ln()
            }),
        }
    }

    /// Share of edges that reach an age, R(t).
    pub fn survival(&self, age: f64) -> f64 {
        if age <= 0.0 && !matches!(self, Self::Normal { .. }) {
            return 1.0;
        }
        match *self {
            Self::Gamma { shape, scale } => {
                let x = age / scale;
                checked_gamma_ur(shape, x).unwrap_or_else(|_| 1.0 - gamma_limit(shape, x))
            }
            Self::InverseGaussian { mean, shape } => {
                (normal::below(-first_passage(age, mean, shape)) - second_passage(age, mean, shape)).clamp(0.0, 1.0)
            }
            Self::Weibull { .. }
            | Self::Weibull3 { .. }
            | Self::Lognormal { .. }
            | Self::Normal { .. }
            | Self::CompetingRisks { .. } => self.ln_survival(age).exp(),
        }
    }

    /// Logarithm of R(t).
    pub fn ln_survival(&self, age: f64) -> f64 {
        if age <= 0.0 && !matches!(self, Self::Normal { .. }) {
            return 0.0;
        }
        match *self {
            Self::Weibull { shape, scale } => -(age / scale).powf(shape),
            Self::Weibull3 { shape, scale, location } => -((age - location) / scale).max(0.0).powf(shape),
            Self::Lognormal { median, sigma } => normal::ln_below(-(age / median).ln() / sigma),
            Self::Normal { mean, deviation } => normal::ln_below((mean - age) / deviation),
            Self::Gamma { .. } | Self::InverseGaussian { .. } => self.survival(age).ln(),
            Self::CompetingRisks { .. } => {
                self.risks().map_or(f64::NAN, |(wear, chipping)| wear.ln_survival(age) + chipping.ln_survival(age))
            }
        }
    }

    /// Share of edges that are spent at an age, F(t) = 1 − R(t), accurate where it is small.
    pub fn failed(&self, age: f64) -> f64 {
        if age <= 0.0 && !matches!(self, Self::Normal { .. }) {
            return 0.0;
        }
        match *self {
            Self::Gamma { shape, scale } => {
                let x = age / scale;
                checked_gamma_lr(shape, x).unwrap_or_else(|_| gamma_limit(shape, x))
            }
            Self::InverseGaussian { mean, shape } => {
                normal::below(first_passage(age, mean, shape)) + second_passage(age, mean, shape)
            }
            Self::Lognormal { median, sigma } => normal::below((age / median).ln() / sigma),
            Self::Normal { mean, deviation } => normal::below((age - mean) / deviation),
            Self::Weibull { .. } | Self::Weibull3 { .. } | Self::CompetingRisks { .. } => {
                -self.ln_survival(age).exp_m1()
            }
        }
    }

    /// F(t) and R(t) in one go, the smaller one of them accurate.
    pub fn shares(&self, age: f64) -> (f64, f64) {
        let both =
            |failed: f64, survival: &dyn Fn() -> f64| (failed, if failed < 0.5 { 1.0 - failed } else { survival() });
        match self {
            Self::Weibull { .. } | Self::Weibull3 { .. } | Self::CompetingRisks { .. } => {
                let ln_survival = self.ln_survival(age);
                both(-ln_survival.exp_m1(), &|| ln_survival.exp())
            }
            Self::Lognormal { .. } | Self::Normal { .. } | Self::Gamma { .. } | Self::InverseGaussian { .. } => {
                both(self.failed(age), &|| self.survival(age))
            }
        }
    }

    /// Rate at which edges of an age end, f(t)/R(t).
    pub fn hazard(&self, age: f64) -> f64 {
        (self.ln_density(age) - self.ln_survival(age)).exp()
    }

    /// The age that a share `share` of edges does not reach: 0.1 gives B10.
    pub fn quantile(&self, share: f64) -> f64 {
        let weibull = |shape: f64, scale: f64| scale * (-(-share).ln_1p()).powf(shape.recip());
        match *self {
            Self::Weibull { shape, scale } => weibull(shape, scale),
            Self::Weibull3 { shape, scale, location } => location + weibull(shape, scale),
            Self::Lognormal { median, sigma } => median * (sigma * normal::quantile(share)).exp(),
            Self::Normal { mean, deviation } => mean + deviation * normal::quantile(share),
            Self::Gamma { .. } | Self::InverseGaussian { .. } | Self::CompetingRisks { .. } => {
                let (mut low, mut high) = (self.typical(), self.typical());
                while self.failed(low) > share && low > f64::MIN_POSITIVE {
                    low *= 0.5;
                }
                while self.failed(high) < share && high < f64::MAX / 4.0 {
                    high *= 2.0;
                }
                while high / low > 1.0 + 1e-14 {
                    let middle = (low * high).sqrt();
                    if middle <= low || middle >= high {
                        break;
                    }
                    *(if self.failed(middle) < share { &mut low } else { &mut high }) = middle;
                }
                (low * high).sqrt()
            }
        }
    }

    /// An age within the bulk of the law.
    fn typical(&self) -> f64 {
        match *self {
            Self::Weibull { scale, .. } => scale,
            Self::Weibull3 { scale, location, .. } => location + scale,
            Self::Lognormal { median, .. } => median,
            Self::Normal { mean, .. } | Self::InverseGaussian { mean, .. } => mean,
            Self::Gamma { shape, scale } => shape * scale,
            Self::CompetingRisks { wear_median, chipping_scale, .. } => wear_median.min(chipping_scale),
        }
    }

    /// Mean life.
    pub fn mean(&self) -> f64 {
        match *self {
            Self::Weibull { shape, scale } => scale * gamma(1.0 + shape.recip()),
            Self::Weibull3 { shape, scale, location } => location + scale * gamma(1.0 + shape.recip()),
            Self::Lognormal { median, sigma } => median * (0.5 * sigma * sigma).exp(),
            Self::Normal { mean, .. } | Self::InverseGaussian { mean, .. } => mean,
            Self::Gamma { shape, scale } => shape * scale,
            Self::CompetingRisks { .. } => self.lived(self.quantile(1.0 - 1e-12)),
        }
    }

    /// Standard deviation over mean, from `E T² = 2 ∫ t R dt`; for a normal law its deviation.
    pub fn variation(&self) -> f64 {
        let mean = self.mean();
        if let Self::Normal { deviation, .. } = self {
            return deviation / mean;
        }
        let second = 2.0 * integral(0.0, self.quantile(1.0 - 1e-12), |age| age * self.survival(age));
        (second / (mean * mean) - 1.0).max(0.0).sqrt()
    }

    /// Mean time that an edge still lives when it has reached an age, `∫ R du / R` from there.
    pub fn mean_residual_life(&self, age: f64) -> f64 {
        let survival = self.survival(age);
        if survival <= 0.0 {
            return f64::NAN;
        }
        let end = self.quantile(1.0 - 1e-9 * survival).max(age);
        integral(age, end, |t| self.survival(t)) / survival
    }

    /// Mean time that an edge lives up to an age, `∫ R du` from 0.
    pub fn lived(&self, age: f64) -> f64 {
        integral(0.0, age, |t| self.survival(t))
    }

    /// [`Law::lived`] at ascending ages, in one go from each to the next.
    pub fn lived_to(&self, ages: &[f64]) -> Vec<f64> {
        let (mut from, mut lived) = (0.0, 0.0);
        let next = |age: &f64| {
            lived += self.lived_between(from, *age);
            from = *age;
            lived
        };
        ages.iter().map(next).collect()
    }

    /// Mean time that an edge lives between two ages that lie close together, `∫ R du`.
    pub(super) fn lived_between(&self, start: f64, end: f64) -> f64 {
        panels(start, end, CLOSE, |t| self.survival(t))
    }

    /// [`Law::mean_residual_life`] at ascending ages, from the last one backwards.
    pub fn residual_lives(&self, ages: &[f64]) -> Vec<f64> {
        let Some(last) = ages.last() else { return Vec::new() };
        let tail = self.mean_residual_life(*last);
        let mut rest = if tail.is_nan() { 0.0 } else { tail * self.survival(*last) };
        let mut residual = vec![0.0; ages.len()];
        for i in (0..ages.len()).rev() {
            if let Some(next) = ages.get(i + 1) {
                rest += self.lived_between(ages[i], *next);
            }
            let survival = self.survival(ages[i]);
            residual[i] = if survival > 0.0 { rest / survival } else { f64::NAN };
        }
        residual
    }
}

fn weibull_ln_density(x: f64, shape: f64, scale: f64) -> f64 {
    if x <= 0.0 {
        return f64::NEG_INFINITY;
    }
    (shape / scale).ln() + (shape - 1.0) * x.ln() - x.powf(shape)
}

/// Limit of the share that has failed under a gamma law where shape or x = age/scale has left the range of
/// numbers: a search that is far from its goal asks for such laws.
fn gamma_limit(shape: f64, x: f64) -> f64 {
    if x <= 0.0 || shape == f64::INFINITY { 0.0 } else { 1.0 }
}

fn first_passage(age: f64, mean: f64, shape: f64) -> f64 {
    (shape / age).sqrt() * (age / mean - 1.0)
}

/// `exp(2 shape/mean)·Phi(-sqrt(shape/t)(t/mean + 1))`, whose factors alone leave the range of numbers.
fn second_passage(age: f64, mean: f64, shape: f64) -> f64 {
    (2.0 * shape / mean + normal::ln_below(-(shape / age).sqrt() * (age / mean + 1.0))).exp()
}

/// Nodes and weights of the 8-point Gauss–Legendre rule, positive half
/// (Abramowitz and Stegun, table 25.4).
const LEGENDRE: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Integral by 8-point Gauss–Legendre on 32 equal parts: 1e-10 for survival functions.
pub(super) fn integral(start: f64, end: f64, f: impl Fn(f64) -> f64) -> f64 {
    panels(start, end, 32, f)
}

/// Panels between ages of a curve, which are sixty or more over the whole range.
const CLOSE: usize = 2;

fn panels(start: f64, end: f64, parts: usize, f: impl Fn(f64) -> f64) -> f64 {
    let half = 0.5 * (end - start) / parts as f64;
    let part = |i: usize| {
        let centre = start + half * (2 * i + 1) as f64;
        LEGENDRE.iter().map(|(x, w)| w * (f(centre - half * x) + f(centre + half * x))).sum::<f64>()
    };
    half * (0..parts).map(part).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [Law; 7] = [
        Law::Weibull { shape: 2.5, scale: 20.0 },
        Law::Weibull3 { shape: 1.7, scale: 12.0, location: 5.0 },
        Law::Lognormal { median: 18.0, sigma: 0.3 },
        Law::Normal { mean: 20.0, deviation: 4.0 },
        Law::Gamma { shape: 9.0, scale: 2.2 },
        Law::InverseGaussian { mean: 20.0, shape: 180.0 },
        Law::CompetingRisks { wear_median: 22.0, wear_sigma: 0.25, chipping_shape: 1.5, chipping_scale: 70.0 },
    ];

    #[test]
    fn values_are_those_of_scipy() {
        // scipy.stats at t = 15: logpdf, sf.
        let expected = [
            (-2.998_103_940_0, 0.614_381_450_0),
            (-2.815_389_577_7, 0.480_231_937_2),
            (-2.607_688_985_9, 0.728_319_545_5),
            (-3.086_482_894_3, 0.894_350_226_3),
            (-2.854_499_355_4, 0.752_469_876_2),
            (-2.759_535_409_4, 0.762_674_295_5),
        ];
        for (law, (ln_density, survival)) in LAWS.iter().zip(expected) {
            assert!((law.ln_density(15.0) - ln_density).abs() < 1e-9, "{law:?}: {}", law.ln_density(15.0));
            assert!((law.survival(15.0) - survival).abs() < 1e-9, "{law:?}: {}", law.survival(15.0));
        }
    }

    #[test]
    fn density_survival_quantile_and_means_agree_with_each_other() {
        for law in LAWS {
            for share in [0.01, 0.1, 0.5, 0.9, 0.999] {
                let age = law.quantile(share);
                assert!((law.failed(age) - share).abs() < 1e-10, "{law:?} at {share}");
                assert!((law.failed(age) + law.survival(age) - 1.0).abs() < 1e-12, "{law:?} at {share}");
                let step = 1e-4 * age;
                let slope = (law.failed(age + step) - law.failed(age - step)) / (2.0 * step);
                assert!((slope / law.ln_density(age).exp() - 1.0).abs() < 1e-5, "{law:?} at {share}");
                let hazard = slope / law.survival(age);
                assert!((hazard / law.hazard(age) - 1.0).abs() < 1e-5, "{law:?} at {share}");
            }
            // The mean is the residual life of a new edge; for a normal law lives below 0 are 3e-7 of all.
            assert!((law.mean_residual_life(0.0) / law.mean() - 1.0).abs() < 1e-6, "{law:?}");
        }
    }

    #[test]
    fn scatter_and_weibull_shape_belong_together() {
        // Known pairs of shape and coefficient of variation, and 0.3 for 3.70.
        for (shape, cv) in [(2.0, 0.523), (3.0, 0.363), (4.08, 0.276), (5.0, 0.229), (3.70, 0.30), (5.8, 0.20)] {
            let found = Law::Weibull { shape, scale: 7.0 }.variation();
            assert!((found - cv).abs() < 1.5e-3, "{shape}: {found}");
        }
        assert!((Law::Gamma { shape: 9.0, scale: 2.2 }.variation() - 1.0 / 3.0).abs() < 1e-6);
    }

    #[test]
    fn a_gamma_law_beyond_the_range_of_numbers_has_its_limits() {
        let shares = |shape: f64, scale: f64, age: f64| {
            let law = Law::Gamma { shape, scale };
            (law.failed(age), law.survival(age))
        };
        assert_eq!(shares(0.5, 1e300, 1e-300), (0.0, 1.0));
        assert_eq!(shares(0.5, 1e-300, 1e300), (1.0, 0.0));
        assert_eq!(shares(f64::INFINITY, 1.0, 5.0), (0.0, 1.0));
        assert_eq!(shares(0.0, 1.0, 5.0), (1.0, 0.0));
    }

    #[test]
    fn a_narrow_inverse_gaussian_does_not_overflow() {
        let law = Law::InverseGaussian { mean: 1.0, shape: 1e4 };
        assert!((law.survival(1.0) - 0.498).abs() < 2e-3 && law.survival(1.2) < 1e-10);
    }
}
