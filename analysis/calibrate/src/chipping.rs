//! The rate at which edges chip: a Weibull hazard in cutting path, raised by the wear that was fitted.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Gamma};
use statrs::distribution::{ContinuousCDF, Gamma as GammaDistribution};

/// Chips from which on the shape of the hazard is fitted too: fewer say nothing of it (assumption).
const SHAPED: usize = 8;
/// Shapes that are looked at, the range of the parameter file.
const SHAPES: (f64, f64) = (1.0, 10.0);
/// Prior number of chips (Jeffreys' prior of a Poisson count).
const HALF: f64 = 0.5;
/// Steps over the path of an edge.
const STEPS: usize = 200;
/// Steps of the search for the shape; each leaves 0.62 of the interval.
const SEARCH: usize = 40;

/// The path of one edge with the wear along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposure {
    /// Cutting path in km and flank wear in mm there, rising from zero.
    pub course: Vec<(f64, f64)>,
    /// Whether it ended by a chip.
    pub chipped: bool,
}

impl Exposure {
    /// Flank wear at a path, by straight lines.
    fn wear(&self, path: f64) -> f64 {
        let next = self.course.partition_point(|(known, _)| *known < path);
        match (next.checked_sub(1).and_then(|before| self.course.get(before)), self.course.get(next)) {
            (Some((a, low)), Some((b, high))) => low + (high - low) * (path - a) / (b - a),
            (Some((_, last)), None) => *last,
            (None, first) => first.map_or(0.0, |(_, wear)| *wear),
        }
    }

    /// `∫ k l^(k-1) (1 + (h/h_ref)²) dl` over the path, km^k.
    fn hazard(&self, shape: f64, land: f64) -> f64 {
        let Some((whole, _)) = self.course.last() else { return 0.0 };
        // By the midpoint rule in l^k, in which the integrand has no pole.
        let step = whole.powf(shape) / STEPS as f64;
        let at = |number: usize| {
            let path = ((number as f64 + 0.5) * step).powf(shape.recip());
            1.0 + (self.wear(path) / land).powi(2)
        };
        (0..STEPS).map(at).sum::<f64>() * step
    }
}

/// The rate of chipping with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChippingFit {
    /// Edges that chipped or broke.
    pub chips: usize,
    /// Sum of the exposures, km^shape.
    pub exposure: f64,
    /// Shape of the hazard.
    pub shape: f64,
    /// Whether the shape was fitted; else it is that of the set.
    pub shaped: bool,
    /// Most probable rate, 1/km; zero without a chip.
    pub rate: f64,
    /// 5 % and 95 % points of the rate, 1/km.
    pub ci90: [f64; 2],
}

impl ChippingFit {
    /// The rate from the paths of edges, with the shape of the set and the land in mm at which the hazard has doubled. `None`
    /// where no edge was cut.
    ///
    /// # Examples
    /// ```
    /// use toolroom_calibrate::{ChippingFit, Exposure};
    /// let edge = |course: &[(f64, f64)], chipped| Exposure { course: course.to_vec(), chipped };
    /// let edges = [
    ///     edge(&[(0.0, 0.0), (4.0, 0.30)], false),
    ///     edge(&[(0.0, 0.0), (2.5, 0.20)], true),
    ///     edge(&[(0.0, 0.0), (1.0, 0.10), (3.0, 0.30)], false),
    ///     edge(&[(0.0, 0.0), (1.2, 0.12)], true),
    ///     edge(&[(0.0, 0.0), (3.5, 0.31)], false),
    /// ];
    /// let fit = ChippingFit::from_exposures(&edges, 1.5, 0.4).unwrap();
    /// assert!((fit.rate - 0.163_139_2).abs() < 1e-5 && !fit.shaped);
    /// assert!((fit.ci90[0] - 0.070_877_6).abs() < 1e-5 && (fit.ci90[1] - 0.321_585_4).abs() < 2e-5);
    /// ```
    pub fn from_exposures(edges: &[Exposure], shape: f64, land: f64) -> Option<Self> {
        let chips = edges.iter().filter(|edge| edge.chipped).count();
        let exposure = |shape: f64| edges.iter().map(|edge| edge.hazard(shape, land)).sum::<f64>();
        let shaped = chips >= SHAPED;
        let shape = if shaped { likeliest(edges, chips, &exposure) } else { shape };
        let exposure = exposure(shape);
        if exposure <= 0.0 {
            return None;
        }
        let rate = |count: f64| (count / exposure).powf(shape.recip());
        let gamma = GammaDistribution::new(chips as f64 + HALF, 1.0).ok()?;
        let ci90 = [0.05, 0.95].map(|share| rate(gamma.inverse_cdf(share)));
        Some(Self { chips, exposure, shape, shaped, rate: rate(chips as f64), ci90 })
    }

    /// A draw of the rate, 1/km.
    pub fn draw(&self, random: &mut ChaCha8Rng) -> f64 {
        let gamma = Gamma::new(self.chips as f64 + HALF, 1.0).expect("a positive shape");
        (gamma.sample(random) / self.exposure).powf(self.shape.recip())
    }
}

/// The likeliest shape, with the likeliest rate for each: golden section over the logarithm of the shape.
fn likeliest(edges: &[Exposure], chips: usize, exposure: &dyn Fn(f64) -> f64) -> f64 {
    let count = chips as f64;
    let paths: Vec<f64> = edges
        .iter()
        .filter(|edge| edge.chipped)
        .filter_map(|edge| edge.course.last().map(|(path, _)| *path).filter(|path| *path > 0.0))
        .collect();
    let density = |ln_shape: f64| {
        let shape = ln_shape.exp();
        let of_chips = paths.iter().map(|path| shape.ln() + (shape - 1.0) * path.ln()).sum::<f64>();
        count * (count / exposure(shape)).ln() + of_chips
    };
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = (SHAPES.0.ln(), SHAPES.1.ln());
    for _ in 0..SEARCH {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if density(a) > density(b) {
            high = b;
        } else {
            low = a;
        }
    }
    (0.5 * (low + high)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_is_found_from_many_chips_and_none_still_bounds_the_rate() {
        // Paths at the quantiles of a Weibull law of scale 2 km and shape 3, no wear.
        let path = |i: usize| 2.0 * (-(1.0 - (i as f64 + 0.5) / 60.0).ln()).powf(1.0 / 3.0);
        let edges: Vec<Exposure> =
            (0..60).map(|i| Exposure { course: vec![(0.0, 0.0), (path(i), 0.0)], chipped: true }).collect();
        let fit = ChippingFit::from_exposures(&edges, 1.5, 0.4).expect("edges");
        assert!(fit.shaped && (fit.shape - 3.0).abs() < 0.25 && (fit.rate - 0.5).abs() < 0.01, "{fit:?}");
        let whole: Vec<Exposure> = edges.into_iter().map(|edge| Exposure { chipped: false, ..edge }).collect();
        let none = ChippingFit::from_exposures(&whole, 1.5, 0.4).expect("edges");
        assert!(none.rate == 0.0 && none.ci90[1] > 0.0 && none.ci90[1] < 0.2, "{none:?}");
    }
}
