//! What intervals over replications rest on.

use super::Study;
use toolroom_statistics::Moments;

impl Study {
    /// What intervals rest on: [`values`](Self::values), or their means over the replications that share a draw of the
    /// parameters, of which only different draws are independent.
    pub fn samples(&self, policy: usize, kpi: usize) -> Vec<f64> {
        by_draw(self.values(policy, kpi), self.alike)
    }
}

/// Means of `values` over every `alike` of them in a row, of those that are defined; NaN where none is.
pub(crate) fn by_draw(values: Vec<f64>, alike: u32) -> Vec<f64> {
    if alike == 1 {
        return values;
    }
    let mean = |draw: &[f64]| draw.iter().copied().filter(|value| value.is_finite()).collect::<Moments>().mean();
    values.chunks(alike as usize).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::by_draw;

    #[test]
    fn replications_of_one_draw_count_once() {
        assert_eq!(by_draw(vec![1.0, f64::NAN, 3.0], 1)[2], 3.0);
        let means = by_draw(vec![1.0, 3.0, f64::NAN, 5.0, f64::NAN, f64::NAN, 7.0], 2);
        assert_eq!((means[0], means[1], means[3]), (2.0, 5.0, 7.0));
        assert!(means[2].is_nan() && means.len() == 4);
    }
}
