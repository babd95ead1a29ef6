//! Wear of one instant.

use toolroom_process::Number;

/// Wear of one instant, split by what drives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wear<N = f64> {
    /// Wear per cutting path (A), 1 (m of land per m of path).
    pub mechanical_per_path: N,
    /// Wear per time (B), m/s.
    pub thermal_rate: N,
}

impl<N: Number> Wear<N> {
    /// Wear per path J = A + B/v, 1; infinite at rest.
    pub fn intensity(&self, cutting_speed: N) -> N {
        self.mechanical_per_path + self.thermal_rate / cutting_speed
    }

    /// Wear per time v·A + B, m/s.
    #[inline]
    pub fn rate(&self, cutting_speed: N) -> N {
        cutting_speed * self.mechanical_per_path + self.thermal_rate
    }
}
