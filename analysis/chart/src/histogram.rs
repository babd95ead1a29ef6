//! Counting values into equal classes.

/// A histogram with classes of equal width.
///
/// # Examples
/// ```
/// use toolroom_chart::Histogram;
/// let counts: Vec<_> = Histogram::with_bins([1.0, 2.0, 2.5, 4.0, f64::NAN], 3).counts().collect();
/// assert_eq!(counts, [(1.0, 2.0, 1.0), (2.0, 3.0, 2.0), (3.0, 4.0, 1.0)]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    low: f64,
    width: f64,
    counts: Vec<usize>,
}

impl Histogram {
    /// Classes of the width 2 · IQR · n^(-1/3), at most 60; log2(n) + 1 of them when the middle half
    /// of the values coincides. Values that are not finite are left out.
    ///
    /// # Source
    /// Freedman and Diaconis, Z. Wahrscheinlichkeitstheorie verw. Gebiete 57 (1981) 453; Sturges,
    /// J. Am. Stat. Assoc. 21 (1926) 65.
    #[must_use]
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let n = sorted.len();
        if n < 2 {
            return Self::with_bins(sorted, 1);
        }
        let span = sorted[n - 1] - sorted[0];
        let width = 2.0 * (sorted[3 * n / 4] - sorted[n / 4]) / (n as f64).cbrt();
        let bins = if width > 0.0 { span / width } else { (n as f64).log2() + 1.0 };
        Self::with_bins(sorted, bins.ceil().clamp(1.0, 60.0) as usize)
    }

    /// As many classes as told, at least one.
    #[must_use]
    pub fn with_bins(values: impl IntoIterator<Item = f64>, bins: usize) -> Self {
        let values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if low > high {
            return Self { low: 0.0, width: 1.0, counts: Vec::new() };
        }
        let mut counts = vec![0; bins.max(1)];
        // Equal values get one class around them; each bound is halved so that no span overflows.
        let (low, width) = if low == high {
            let half = if low == 0.0 { 0.5 } else { 0.05 * low.abs() };
            (low - half, 2.0 * half / counts.len() as f64)
        } else {
            (low, (high / counts.len() as f64 - low / counts.len() as f64).max(f64::MIN_POSITIVE))
        };
        let last = counts.len() - 1;
        for v in values {
            counts[((v / width - low / width) as usize).min(last)] += 1;
        }
        Self { low, width, counts }
    }

    fn columns(&self, scale: f64) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.counts.iter().enumerate().map(move |(i, &n)| {
            let from = self.low + self.width * i as f64;
            (from, from + self.width, n as f64 * scale)
        })
    }

    /// (from, to, number of values) of each class.
    pub fn counts(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.columns(1.0)
    }

    /// (from, to, density) of each class: the areas sum to one, as under a fitted density.
    pub fn density(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        let total: usize = self.counts.iter().sum();
        self.columns(1.0 / (total as f64 * self.width))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_of_the_density_sum_to_one() {
        let h = Histogram::new((0..1000).map(|i| (f64::from(i) * 0.37).sin()));
        let area: f64 = h.density().map(|(a, b, d)| (b - a) * d).sum();
        assert!((area - 1.0).abs() < 1e-12, "{area}");
    }

    #[test]
    fn every_finite_value_is_counted_whatever_the_values() {
        for values in
            [vec![], vec![3.0], vec![2.0; 9], vec![-1e308, 1e308], vec![0.0, 5e-324], vec![f64::NAN, 1.0, 2.0]]
        {
            let finite = values.iter().filter(|v| v.is_finite()).count();
            let counted: f64 = Histogram::new(values.clone()).counts().map(|c| c.2).sum();
            assert_eq!(counted, finite as f64, "{values:?}");
        }
    }
}
