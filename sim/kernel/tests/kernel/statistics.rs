//! Batch means: how far a mean of correlated observations may be off.

/// Mean and standard error from `BATCHES` equally long batches.
pub struct Estimate {
    pub mean: f64,
    pub standard_error: f64,
}

const BATCHES: usize = 50;

impl Estimate {
    /// Of a long series; batches are taken to be uncorrelated.
    pub fn of_series(series: &[f64]) -> Self {
        let means: Vec<f64> = series
            .chunks_exact(series.len() / BATCHES)
            .map(|batch| batch.iter().sum::<f64>() / batch.len() as f64)
            .collect();
        Self::of_independent(&means)
    }

    /// Of independent observations.
    pub fn of_independent(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Self { mean, standard_error: (variance / n).sqrt() }
    }

    /// Within four standard errors of the exact value, which must be sharp enough to mean something.
    pub fn assert_agrees(&self, what: &str, exact: f64, sharpness: f64) {
        let Self { mean, standard_error } = self;
        assert!(standard_error / exact < sharpness, "{what}: {mean} ± {standard_error} is too vague to judge {exact}");
        assert!((mean - exact).abs() < 4.0 * standard_error, "{what}: {mean} ± {standard_error}, exact {exact}");
    }
}
