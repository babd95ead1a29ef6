//! A quadratic surface through readings that are each known with an error of their own.

use nalgebra::{DMatrix, DVector};

/// Farthest points on any axis, in steps of the first grid, that the surface has to fit (assumptions): all of them where they do not
/// deny a parabola, else those nearer by. A parabola describes a valley, not the walls around it; but where the valley is flat or the
/// readings are noisy, its floor is told by points far off.
const REACHES: [f64; 3] = [f64::INFINITY, 4.5, 2.6];
/// Standard deviations of chi square by which it may exceed its mean where readings do not deny a surface (assumption).
const DENIED: f64 = 2.0;
/// Points beside the coefficients without which no surface is fitted (assumption).
const SPARE: usize = 2;
/// Steps of the search for the least of the surface, a step of the first grid each (assumption).
const FINE: usize = 8;

/// What was read at a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading<'a> {
    /// The place on each axis, in steps of the first grid.
    pub at: &'a [f64],
    /// What was read; not finite where there is nothing to fit.
    pub mean: f64,
    /// Variance of the mean.
    pub error: f64,
}

/// A quadratic surface through points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Surface {
    centre: Vec<f64>,
    coefficients: DVector<f64>,
    /// Covariance of the coefficients.
    covariance: DMatrix<f64>,
    /// Indices of the points that it fits.
    pub fitted: Vec<usize>,
    /// Least and greatest place of these points on each axis.
    ends: Vec<(f64, f64)>,
    /// Variance of points about it.
    pub deviation: f64,
}

/// Products of positions up to the second order.
fn row(at: &[f64], centre: &[f64]) -> Vec<f64> {
    let x: Vec<f64> = at.iter().zip(centre).map(|(at, centre)| at - centre).collect();
    let squares = (0..x.len()).flat_map(|i| (i..x.len()).map(move |j| (i, j)));
    std::iter::once(1.0).chain(x.iter().copied()).chain(squares.map(|(i, j)| x[i] * x[j])).collect()
}

impl Surface {
    /// Through the points around one of them, as far as a quadratic surface describes them; `None` where there are too few.
    pub fn around(readings: &[Reading<'_>], best: usize) -> Option<Self> {
        let mut found = Self::within(readings, best, REACHES[0])?;
        for reach in &REACHES[1..] {
            if !found.1 {
                break;
            }
            found = Self::within(readings, best, *reach)?;
        }
        Some(found.0)
    }

    /// Through the points within a reach, and whether their readings deny such a surface.
    fn within(readings: &[Reading<'_>], best: usize, reach: f64) -> Option<(Self, bool)> {
        let centre = readings.get(best)?.at.to_vec();
        let near = |place: &usize| {
            let apart = readings[*place].at.iter().zip(&centre).map(|(at, centre)| (at - centre).abs());
            readings[*place].mean.is_finite() && apart.fold(0.0, f64::max) <= reach
        };
        let fitted: Vec<usize> = (0..readings.len()).filter(near).collect();
        let rows: Vec<Vec<f64>> = fitted.iter().map(|place| row(readings[*place].at, &centre)).collect();
        let size = rows.first()?.len();
        if fitted.len() < size + SPARE {
            return None;
        }
        let design = DMatrix::from_fn(fitted.len(), size, |i, j| rows[i][j]);
        let read = DVector::from_iterator(fitted.len(), fitted.iter().map(|place| readings[*place].mean));
        let errors: Vec<f64> = fitted.iter().map(|place| readings[*place].error).collect();
        let fit = |deviation: f64| {
            let weights = DVector::from_iterator(errors.len(), errors.iter().map(|error| (deviation + error).recip()));
            let weighed = DMatrix::from_fn(fitted.len(), size, |i, j| design[(i, j)] * weights[i]);
            let normal = (weighed.transpose() * &design).cholesky()?;
            let coefficients = normal.solve(&(weighed.transpose() * &read));
            let left = &read - &design * &coefficients;
            let squares = left.iter().zip(weights.iter()).map(|(left, weight)| left * left * weight).sum::<f64>();
            coefficients.iter().all(|value| value.is_finite()).then(|| (coefficients, normal.inverse(), squares))
        };
        let free = (fitted.len() - size) as f64;
        // Without noise the weights need some variance to begin with.
        let spread = read.variance();
        let least = 1e-9 * spread + f64::MIN_POSITIVE;
        let (mut low, mut high) = (least, least + spread);
        let squares = fit(low)?.2;
        let denied = squares > free + DENIED * (2.0 * free).sqrt();
        if squares <= free {
            high = low;
        }
        while high / low > 1.01 {
            let middle = (low * high).sqrt();
            if fit(middle)?.2 > free { low = middle } else { high = middle }
        }
        let (coefficients, covariance, _) = fit(high)?;
        let end = |axis: usize| {
            let places = fitted.iter().map(|place| readings[*place].at[axis]);
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
        };
        let ends = (0..centre.len()).map(end).collect();
        Some((Self { centre, coefficients, covariance, fitted, ends, deviation: high }, denied))
    }

    /// The surface at a place.
    pub fn at(&self, at: &[f64]) -> f64 {
        row(at, &self.centre).iter().zip(self.coefficients.iter()).map(|(x, c)| x * c).sum()
    }

    /// Variance of the surface at a place.
    pub fn variance(&self, at: &[f64]) -> f64 {
        let row = DVector::from_vec(row(at, &self.centre));
        (row.transpose() * &self.covariance * &row)[(0, 0)]
    }

    /// The estimate of a point with this reading of its own, and its variance.
    pub fn estimate(&self, reading: &Reading<'_>) -> (f64, f64) {
        let Reading { at, mean, error } = *reading;
        let surface = self.at(at);
        let own = if error > 0.0 { self.deviation / (self.deviation + error) } else { 1.0 };
        (surface + own * (mean - surface), own * error + (1.0 - own).powi(2) * self.variance(at))
    }

    /// Places an eighth of a step apart within the points that it fits, and the surface there.
    pub fn heights(&self) -> Vec<(Vec<f64>, f64)> {
        let lists = self.ends.iter().map(|(low, high)| {
            let steps = ((high - low) * FINE as f64).ceil().max(1.0);
            (0..=steps as usize).map(|step| low + (high - low) * step as f64 / steps).collect::<Vec<f64>>()
        });
        let grid = lists.fold(vec![Vec::new()], |combinations, list| {
            let with = |before: &Vec<f64>| {
                list.iter().map(|value| [before.as_slice(), &[*value]].concat()).collect::<Vec<_>>()
            };
            combinations.iter().flat_map(with).collect()
        });
        grid.into_iter().map(|at| (at.clone(), self.at(&at))).collect()
    }
}
