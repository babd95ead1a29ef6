//! Shares of edges that are lost at the settings that were tried, for a guard.

use super::quadratic::{Reading, Surface};

/// How many of the edges were lost at a setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// Its place on each axis, in steps of the first grid.
    pub at: Vec<f64>,
    /// Edges that were lost.
    pub lost: u32,
    /// Edges that were seen.
    pub edges: u32,
}

/// Shares that are lost, with what the counts around a setting say of it.
///
/// The angle `asin √share` of a count has nearly the same variance whatever the share, so that a surface through angles needs
/// no weights that depend on what is sought. As with [`Estimates`](super::Estimates) a setting's own count takes part as far as
/// it is borne out. A guard that looked at each count alone would exclude settings by chance, and those at its edge most:
/// of 500 edges a share of one in ten is known to one and a half in a hundred.
///
/// # Source
/// F. J. Anscombe, Biometrika 35 (1948) 246 (the angle of a count, with three eighths).
#[derive(Clone, Debug, PartialEq)]
pub struct Shares {
    /// Angle and variance of each setting.
    angles: Vec<(f64, f64)>,
    surface: Option<Surface>,
}

impl Shares {
    /// From the counts of all settings, with the surface around the setting number `best`.
    ///
    /// # Examples
    /// ```
    /// use toolroom_surface::{Count, Shares};
    /// // One in ten at every setting but one, where chance had it at 13 %: its neighbours tell what it is.
    /// let count = |x: i32| Count { at: vec![f64::from(x)], lost: if x == 3 { 26 } else { 20 }, edges: 200 };
    /// let shares = Shares::from_counts(&(0..7).map(count).collect::<Vec<_>>(), 3);
    /// assert!(shares.of(3, 0.0) < 0.12 && shares.of(3, 1.0) < 0.14);
    /// assert!(shares.at(&[2.5], 0.0).unwrap() < 0.12 && shares.of(6, 0.0) < 0.105);
    /// ```
    pub fn from_counts(counts: &[Count], best: usize) -> Self {
        let angle = |count: &Count| {
            let share = (f64::from(count.lost) + 0.375) / (f64::from(count.edges) + 0.75);
            share.sqrt().asin()
        };
        let readings: Vec<Reading<'_>> = (counts.iter())
            .map(|count| Reading {
                at: &count.at,
                mean: if count.edges == 0 { f64::INFINITY } else { angle(count) },
                error: (4.0 * f64::from(count.edges) + 2.0).recip(),
            })
            .collect();
        let surface = Surface::around(&readings, best);
        let own = |reading: &Reading<'_>| (reading.mean, reading.error);
        let mut angles: Vec<(f64, f64)> = readings.iter().map(own).collect();
        if let Some(surface) = &surface {
            for &place in &surface.fitted {
                angles[place] = surface.estimate(&readings[place]);
            }
        }
        Self { angles, surface }
    }

    /// Share at setting number `place`, so many standard deviations above its estimate; 0 where no edge was seen.
    pub fn of(&self, place: usize, deviations: f64) -> f64 {
        let (angle, variance) = self.angles[place];
        if angle.is_finite() { share(angle + deviations * variance.sqrt()) } else { 0.0 }
    }

    /// The same at a place that need not have been tried, by the surface alone; `None` without a surface.
    pub fn at(&self, at: &[f64], deviations: f64) -> Option<f64> {
        let surface = self.surface.as_ref()?;
        Some(share(surface.at(at) + deviations * surface.variance(at).sqrt()))
    }
}

/// The share whose angle this is.
fn share(angle: f64) -> f64 {
    angle.clamp(0.0, std::f64::consts::FRAC_PI_2).sin().powi(2)
}
