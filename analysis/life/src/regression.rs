//! Life against cutting data: the extended Taylor law with censored lives.

use super::maximise::maximise;
use super::normal;
use super::sample::{Observation, Sample, SampleError};
use nalgebra::{DMatrix, DVector};
use toolroom_statistics::student;

/// Why no regression was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RegressionError {
    /// The lives alone do not suffice.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// Rows and lives differ in number, or rows in length.
    #[error("row {row} has {read} covariates, but there are {names} names")]
    Shape {
        /// Row, from 1.
        row: usize,
        /// Covariates in it.
        read: usize,
        /// Names of covariates.
        names: usize,
    },
    /// A covariate that is the same everywhere.
    #[error("{name} is {value} in every row: its exponent cannot be known")]
    Constant {
        /// Covariate.
        name: String,
        /// Its value.
        value: f64,
    },
    /// Covariates that depend on each other.
    #[error("the covariates {names} depend on each other: their exponents cannot be told apart")]
    Dependent {
        /// All covariates.
        names: String,
    },
}

/// `ln T = intercept + sum_j coefficient_j · x_j + sigma · z` with normal z: where the x are
/// logarithms of speed, feed and depth, the extended Taylor law with lognormal lives.
#[derive(Clone, Debug, PartialEq)]
pub struct Regression {
    /// Names of the covariates.
    pub names: Vec<String>,
    /// Intercept, then one coefficient a covariate.
    pub coefficients: Vec<f64>,
    /// Standard errors of these, for the sample's size.
    pub standard_errors: Vec<f64>,
    /// Residual standard deviation of ln T, unbiased for the number of coefficients.
    pub sigma: f64,
    /// Logarithm of the likelihood.
    pub log_likelihood: f64,
    /// Ends seen less coefficients: degrees of freedom of the bands.
    pub freedom: f64,
    /// Covariance of the coefficients, as inflated as the standard errors.
    covariance: DMatrix<f64>,
}

/// A predicted life with bands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Median life.
    pub median: f64,
    /// Confidence band of the median.
    pub confidence: (f64, f64),
    /// Band in which the life of one more edge lies.
    pub prediction: (f64, f64),
}

/// Fits by maximum likelihood; row k of `rows` belongs to life k of `sample`.
///
/// Without censoring the coefficients are those of least squares. Standard errors and bands use
/// `sigma² n/(n - p)` and Student's t with n − p degrees of freedom, where n counts the ends seen:
/// exact for complete lives, approximate otherwise.
///
/// # Errors
/// [`RegressionError`].
///
/// # Source
/// J. Tobin, Econometrica 26 (1958) 24 (censored normal regression); small-sample factors: an
/// assumption where lives are censored.
pub fn regress<S: Into<String>>(
    names: impl IntoIterator<Item = S>,
    rows: &[Vec<f64>],
    sample: &Sample,
) -> Result<Regression, RegressionError> {
    let names: Vec<String> = names.into_iter().map(Into::into).collect();
    if let Some(row) = (0..sample.lives().len()).find(|i| rows.get(*i).is_none_or(|row| row.len() != names.len())) {
        let read = rows.get(row).map_or(0, Vec::len);
        return Err(RegressionError::Shape { row: row + 1, read, names: names.len() });
    }
    let (p, n) = (names.len() + 1, rows.len() as f64);
    sample.suffices(2)?;
    let ended = sample.ended();
    if ended <= p as f64 {
        return Err(SampleError::TooFew { distinct: ended as usize, parameters: p + 1 }.into());
    }
    // Centred and scaled, so that the search works on numbers of the order of one.
    let mean: Vec<f64> = (0..names.len()).map(|j| rows.iter().map(|row| row[j]).sum::<f64>() / n).collect();
    let spread = |j: usize| (rows.iter().map(|row| (row[j] - mean[j]).powi(2)).sum::<f64>() / n).sqrt();
    let spread: Vec<f64> = (0..names.len()).map(spread).collect();
    if let Some(j) = (0..names.len()).find(|j| spread[*j] <= 1e-9 * mean[*j].abs().max(1e-300)) {
        return Err(RegressionError::Constant { name: names[j].clone(), value: mean[j] });
    }
    let design: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| std::iter::once(1.0).chain((0..names.len()).map(|j| (row[j] - mean[j]) / spread[j])).collect())
        .collect();
    let gram = DMatrix::from_fn(p, p, |i, j| design.iter().map(|z| z[i] * z[j]).sum::<f64>() / n);
    if gram.symmetric_eigenvalues().min() < 1e-10 {
        return Err(RegressionError::Dependent { names: names.join(", ") });
    }
    let centre = sample.lives().iter().map(|(life, weight)| weight * life.age().ln()).sum::<f64>() / sample.size();
    let log_likelihood = |x: &[f64]| -> f64 {
        let sigma = x[p].exp();
        let of_life = |((life, weight), z): (&(Observation, f64), &Vec<f64>)| {
            let expected = centre + (0..p).map(|j| x[j] * z[j]).sum::<f64>();
            let score = |age: f64| (age.ln() - expected) / sigma;
            weight
                * match *life {
                    Observation::Failed(age) => normal::ln_density(score(age)) - (sigma * age).ln(),
                    Observation::Censored(age) => normal::ln_below(-score(age)),
                    Observation::Between(low, high) => {
                        let (a, b) = (score(low), score(high));
                        let share = if b < 0.0 {
                            normal::below(b) - normal::below(a)
                        } else {
                            normal::below(-a) - normal::below(-b)
                        };
                        share.ln()
                    }
                }
        };
        sample.lives().iter().zip(&design).map(of_life).sum()
    };
    let mut start = vec![0.0; p + 1];
    start[p] = -0.5;
    let peak = maximise(&log_likelihood, &start).ok_or(SampleError::NoMaximum)?;
    let dependent = || RegressionError::Dependent { names: names.join(", ") };
    let covariance = peak.covariance().ok_or_else(dependent)?;
    // Back to the covariates as they were given.
    let back = DMatrix::from_fn(p, p, |i, j| match (i, j) {
        (0, 0) => 1.0,
        (0, j) => -mean[j - 1] / spread[j - 1],
        (i, j) if i == j => spread[i - 1].recip(),
        _ => 0.0,
    });
    let freedom = ended - p as f64;
    let inflation = ended / freedom;
    let mut coefficients = &back * DVector::from_column_slice(&peak.at[..p]);
    coefficients[0] += centre;
    let covariance = &back * covariance.view((0, 0), (p, p)) * back.transpose() * inflation;
    Ok(Regression {
        coefficients: coefficients.iter().copied().collect(),
        standard_errors: covariance.diagonal().map(f64::sqrt).iter().copied().collect(),
        sigma: peak.at[p].exp() * inflation.sqrt(),
        log_likelihood: peak.value,
        freedom,
        covariance,
        names,
    })
}

impl Regression {
    /// Life at some covariates.
    pub fn predict(&self, covariates: &[f64], confidence: f64) -> Prediction {
        let z = DVector::from_iterator(
            self.coefficients.len(),
            std::iter::once(1.0).chain(covariates.iter().copied()).take(self.coefficients.len()),
        );
        let level: f64 = z.iter().zip(&self.coefficients).map(|(z, b)| z * b).sum();
        let variance = (z.transpose() * &self.covariance * &z)[(0, 0)];
        let t = student(confidence, self.freedom);
        let band = |variance: f64| ((level - t * variance.sqrt()).exp(), (level + t * variance.sqrt()).exp());
        Prediction {
            median: level.exp(),
            confidence: band(variance),
            prediction: band(variance + self.sigma * self.sigma),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Observation::{Censored, Failed};
    use rand::RngExt;
    use toolroom_kernel::Entity;
    use toolroom_kernel::{Purpose, Streams};

    #[test]
    fn two_points_give_the_textbook_exponent() {
        // Groover, Fundamentals of Modern Manufacturing, ex. 22.1: (160 m/min, 5 min), (100, 41):
        // n = 0.2234, C = 229. A third point on the line, at 130 m/min, has 12.7 min.
        let sample = Sample::new([5.0, 41.0, 5.0, 41.0].map(Failed)).unwrap();
        let rows: Vec<Vec<f64>> = [160.0f64, 100.0, 160.0, 100.0].map(|v| vec![v.ln()]).to_vec();
        // Exact data have no residual: a little scatter keeps the likelihood finite.
        let scattered = Sample::new([5.0 * 1.001, 41.0 * 1.001, 5.0 / 1.001, 41.0 / 1.001].map(Failed)).unwrap();
        assert_eq!(sample.lives().len(), rows.len());
        let fitted = regress(["ln v"], &rows, &scattered).unwrap();
        let n = -fitted.coefficients[1].recip();
        assert!((n - 0.2234).abs() < 5e-5, "{n}");
        assert!(((n * fitted.coefficients[0]).exp() - 229.0).abs() < 0.6);
        assert!((fitted.predict(&[130f64.ln()], 0.9).median - 12.7).abs() < 0.05);
    }

    #[test]
    fn complete_lives_give_least_squares() {
        // y = 1, 3, 2, 5, 4 at x = 1 … 5: slope 0.8, intercept 0.6, s² = 3.6/3; R: lm(y ~ x).
        let y = [1.0f64, 3.0, 2.0, 5.0, 4.0];
        let sample = Sample::new(y.map(f64::exp).map(Failed)).unwrap();
        let rows: Vec<Vec<f64>> = (1..=5).map(|x| vec![f64::from(x)]).collect();
        let fitted = regress(["x"], &rows, &sample).unwrap();
        assert!((fitted.coefficients[0] - 0.6).abs() < 1e-6 && (fitted.coefficients[1] - 0.8).abs() < 1e-6);
        assert!((fitted.sigma - 1.2f64.sqrt()).abs() < 1e-5);
        assert!((fitted.standard_errors[1] - 0.346_410).abs() < 1e-4, "{:?}", fitted.standard_errors);
        // predict(lm, x = 3, interval = "prediction", level = 0.9): 3 ± 2.824.
        let predicted = fitted.predict(&[3.0], 0.9);
        assert!((predicted.prediction.1.ln() - 3.0 - 2.823_95).abs() < 1e-3, "{:?}", predicted.prediction.1.ln());
    }

    #[test]
    fn censored_grids_recover_the_law_and_bands_hold_new_lives() {
        let law = |v: f64, f: f64, z: f64| (8.0 - 2.5 * v.ln() - 0.6 * f.ln() + 0.3 * z).exp();
        let (mut held, mut total) = (0, 0);
        for k in 0..60 {
            let mut stream = Streams::new(9, k).open(Entity::named("grid"), Purpose::Tool);
            let mut normal = || normal::quantile(stream.random::<f64>());
            let (mut rows, mut lives) = (Vec::new(), Vec::new());
            for v in [3.0f64, 4.0, 5.0, 6.0] {
                for f in [0.1f64, 0.2, 0.3] {
                    for _ in 0..3 {
                        let life = law(v, f, normal());
                        rows.push(vec![v.ln(), f.ln()]);
                        lives.push(if life > 400.0 { Censored(400.0) } else { Failed(life) });
                    }
                }
            }
            let fitted = regress(["ln v", "ln f"], &rows, &Sample::new(lives).unwrap()).unwrap();
            let band = fitted.predict(&[4.5f64.ln(), 0.15f64.ln()], 0.9).prediction;
            for _ in 0..20 {
                let life = law(4.5, 0.15, normal());
                held += i32::from(band.0 <= life && life <= band.1);
                total += 1;
            }
            assert!((fitted.coefficients[1] + 2.5).abs() < 5.0 * fitted.standard_errors[1]);
        }
        let share = f64::from(held) / f64::from(total);
        assert!((share - 0.9).abs() < 0.035, "{share}");
    }

    #[test]
    fn what_cannot_be_told_apart_is_named() {
        let sample = Sample::new([5.0, 6.0, 7.0, 9.0].map(Failed)).unwrap();
        let constant = vec![vec![2.0, 1.0], vec![2.0, 2.0], vec![2.0, 3.0], vec![2.0, 5.0]];
        let error = regress(["speed", "feed"], &constant, &sample).unwrap_err();
        assert_eq!(error, RegressionError::Constant { name: "speed".to_owned(), value: 2.0 });
        let twice = vec![vec![1.0, 2.0], vec![2.0, 4.0], vec![3.0, 6.0], vec![5.0, 10.0]];
        assert!(matches!(regress(["a", "b"], &twice, &sample), Err(RegressionError::Dependent { .. })));
        assert!(matches!(regress(["a"], &twice, &sample), Err(RegressionError::Shape { row: 1, read: 2, names: 1 })));
    }
}
