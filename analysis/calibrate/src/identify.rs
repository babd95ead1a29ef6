//! What the data determine, and what only the prior says.

use crate::model::Model;
use crate::sample::Posterior;
use nalgebra::DMatrix;

/// Share of the prior variance left in a direction beyond which the data do not determine it (assumption).
const LEFT: f64 = 0.8;
/// Share of the prior standard deviation left beyond which a single parameter is not determined: the root of [`LEFT`],
/// rounded.
const SHRINK: f64 = 0.9;
/// Components of a direction below this are not named: less than a tenth of its squared length (assumption).
const NAMED: f64 = 0.3;
/// Correlations worth a line (assumption).
const CORRELATED: f64 = 0.6;
/// Correlation of a pair of which the data fix a product rather than both (assumption).
const PRODUCT: f64 = 0.9;
/// Greatest conditional against marginal standard deviation of such a pair (assumption).
const CONDITIONAL: f64 = 1.0 / 3.0;

/// A direction of the parameters that the data leave as the prior has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Undetermined {
    /// Components in prior standard deviations, by index of the parameter; the direction has length one.
    pub direction: Vec<(usize, f64)>,
    /// Share of the prior variance that is left.
    pub variance_left: f64,
}

/// A combination that the data fix better than either of its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Product {
    /// Indices of the two parameters.
    pub pair: [usize; 2],
    /// Coefficients of their working coordinates.
    pub exponents: [f64; 2],
    /// Mean of the combination.
    pub mean: f64,
    /// Standard deviation of the combination.
    pub deviation: f64,
}

/// What data say of parameters beyond their intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Identifiability {
    /// Posterior against prior standard deviation of each parameter.
    pub shrink: Vec<f64>,
    /// Directions that only the prior speaks of.
    pub undetermined: Vec<Undetermined>,
    /// Pairs with a correlation above 0.6 in absolute value, the strongest first.
    pub correlations: Vec<(usize, usize, f64)>,
    /// Pairs of which a product is fixed.
    pub products: Vec<Product>,
    /// Parameters that act on what is the same for all edges.
    pub untold: Vec<usize>,
}

impl Identifiability {
    /// The statement for a posterior.
    pub fn from_model(model: &dyn Model, posterior: &Posterior) -> Self {
        let parameters = model.parameters();
        let size = parameters.len();
        let prior = |i: usize| parameters[i].prior.deviation;
        let covariance = &posterior.covariance;
        let shrink: Vec<f64> = (0..size).map(|i| covariance[(i, i)].sqrt() / prior(i)).collect();
        let scaled = DMatrix::from_fn(size, size, |i, j| covariance[(i, j)] / (prior(i) * prior(j)));
        let eigen = scaled.symmetric_eigen();
        let mut undetermined: Vec<Undetermined> = (0..size)
            .filter(|k| eigen.eigenvalues[*k] > LEFT)
            .map(|k| {
                let column = eigen.eigenvectors.column(k);
                let sign = if column[column.icamax()] < 0.0 { -1.0 } else { 1.0 };
                let named = (0..size).map(|i| (i, sign * column[i])).filter(|(_, part)| part.abs() >= NAMED);
                Undetermined { direction: named.collect(), variance_left: eigen.eigenvalues[k] }
            })
            .collect();
        undetermined.sort_by(|a, b| b.variance_left.total_cmp(&a.variance_left));
        let mut correlations = Vec::new();
        let mut products = Vec::new();
        for i in 0..size {
            for j in 0..i {
                let (a, b, both) = (covariance[(i, i)], covariance[(j, j)], covariance[(i, j)]);
                let correlation = both / (a * b).sqrt();
                if correlation.abs() > CORRELATED {
                    correlations.push((j, i, correlation));
                }
                if correlation.abs() > PRODUCT && (1.0 - correlation * correlation).sqrt() < CONDITIONAL {
                    // The narrow axis of the pair in units of its own deviations.
                    let exponents = [1.0 / b.sqrt(), -correlation.signum() / a.sqrt()];
                    let largest = exponents[0].abs().max(exponents[1].abs());
                    let exponents = exponents.map(|exponent| exponent / largest);
                    let variance = exponents[0] * exponents[0] * b
                        + exponents[1] * exponents[1] * a
                        + 2.0 * exponents[0] * exponents[1] * both;
                    let mean = exponents[0] * posterior.mean[j] + exponents[1] * posterior.mean[i];
                    products.push(Product { pair: [j, i], exponents, mean, deviation: variance.max(0.0).sqrt() });
                }
            }
        }
        correlations.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        Self { shrink, undetermined, correlations, products, untold: model.untold() }
    }

    /// Whether the data determine a parameter by itself.
    pub fn determined(&self, parameter: usize) -> bool {
        self.shrink[parameter] < SHRINK && !self.untold.contains(&parameter)
    }
}
