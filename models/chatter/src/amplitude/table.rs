//! The table of limit cycles.

use super::LimitCycle;
use crate::SimulationSettings;
use crate::error::{ChatterError, positive};
use rayon::prelude::*;
use std::sync::OnceLock;

/// Widths over their limit.
const RATIOS: [f64; 6] = [1.05, 1.1, 1.25, 1.5, 2.0, 3.0];
/// Damping ratios.
const DAMPING: [f64; 4] = [0.01, 0.02, 0.04, 0.08];
/// Positions on the lobe: fractions of a natural oscillation left over in a revolution.
const POSITIONS: usize = 8;
/// Whole oscillations in a revolution at which the table is filled.
const WHOLE_WAVES: f64 = 5.0;
/// How its entries are simulated: a kick beyond loss of contact, and time to settle.
pub(super) const SETTINGS: SimulationSettings =
    SimulationSettings { steps: 400, periods: 800, observed: 200, kick: 1.0 };

/// Limit cycles by width over limit, position on the lobe and damping ratio.
///
/// With a force linear in the chip a limit cycle, scaled by mean chip and mean force, depends on
/// nothing but these three and, weakly, on the number of whole waves in a revolution, which is five
/// here. Between entries it is interpolated linearly in `ln ratio`, position and `ln damping`.
#[derive(Clone, Debug, PartialEq)]
pub struct AmplitudeTable {
    /// By ratio, then position, then damping.
    entries: Vec<LimitCycle>,
}

impl AmplitudeTable {
    /// Fills the table by simulation: 192 runs, a few seconds.
    ///
    /// # Errors
    /// None with the constants of the table.
    pub fn generate() -> Result<Self, ChatterError> {
        let grid: Vec<(f64, f64, f64)> = RATIOS
            .iter()
            .flat_map(|ratio| {
                (0..POSITIONS).flat_map(move |position| {
                    let waves = WHOLE_WAVES + position as f64 / POSITIONS as f64;
                    DAMPING.iter().map(move |damping| (*ratio, waves, *damping))
                })
            })
            .collect();
        let entries: Result<Vec<_>, _> =
            grid.par_iter().map(|(ratio, waves, damping)| LimitCycle::simulated(*ratio, *waves, *damping)).collect();
        Ok(Self { entries: entries? })
    }

    /// The table that is shipped, as [`AmplitudeTable::generate`] filled it.
    pub fn standard() -> &'static Self {
        static TABLE: OnceLock<AmplitudeTable> = OnceLock::new();
        TABLE.get_or_init(|| Self::parse(include_str!("table.csv")))
    }

    /// The table as text: a header and one entry a line.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("amplitude,greatest_force,mean_square_force,mean_cube_force,air_fraction\n");
        for entry in &self.entries {
            let values: Vec<String> = entry.values().iter().map(|value| format!("{value:.5}")).collect();
            text.push_str(&values.join(","));
            text.push('\n');
        }
        text
    }

    /// Reads what [`AmplitudeTable::to_csv`] wrote; a unit test checks the shipped text.
    fn parse(text: &str) -> Self {
        let entries = text.lines().skip(1).map(|line| {
            let mut values = [f64::NAN; 5];
            for (value, field) in values.iter_mut().zip(line.split(',')) {
                *value = field.parse().unwrap_or(f64::NAN);
            }
            LimitCycle::from_values(values)
        });
        Self { entries: entries.collect() }
    }

    /// Limit cycle at `ratio` of width to limit with `waves` natural oscillations in a revolution
    /// (a tooth period in milling, as an approximation). No vibration up to a ratio of 1; from
    /// there to 1.05 the cycle at 1.05, for loss of contact makes it jump; beyond 3 the cycle at 3.
    ///
    /// # Errors
    /// Arguments that are not positive.
    ///
    /// # Examples
    /// ```
    /// use toolroom_chatter::AmplitudeTable;
    /// let cycle = AmplitudeTable::standard().limit_cycle(2.0, 5.409, 0.038).unwrap();
    /// assert!((cycle.greatest_force - 3.29).abs() < 0.1 && cycle.air_fraction > 0.4);
    /// ```
    pub fn limit_cycle(&self, ratio: f64, waves: f64, damping_ratio: f64) -> Result<LimitCycle, ChatterError> {
        positive("ratio", ratio)?;
        positive("waves", waves)?;
        positive("damping_ratio", damping_ratio)?;
        if ratio <= 1.0 {
            return Ok(LimitCycle::NONE);
        }
        let along_ratio = bracket(&RATIOS, ratio);
        let along_damping = bracket(&DAMPING, damping_ratio);
        let position = waves.fract() * POSITIONS as f64;
        let before = position.floor() as usize % POSITIONS;
        let along_position = [(before, 1.0 - position.fract()), ((before + 1) % POSITIONS, position.fract())];
        let mut values = [0.0; 5];
        for (i, wi) in along_ratio {
            for (j, wj) in along_position {
                for (k, wk) in along_damping {
                    let entry = &self.entries[(i * POSITIONS + j) * DAMPING.len() + k];
                    for (value, part) in values.iter_mut().zip(entry.values()) {
                        *value += wi * wj * wk * part;
                    }
                }
            }
        }
        Ok(LimitCycle::from_values(values))
    }
}

/// The two entries about `x` with their weights, linear in the logarithm, held at the ends.
fn bracket(grid: &[f64], x: f64) -> [(usize, f64); 2] {
    let right = grid.partition_point(|g| *g < x).clamp(1, grid.len() - 1);
    let share = ((x / grid[right - 1]).ln() / (grid[right] / grid[right - 1]).ln()).clamp(0.0, 1.0);
    [(right - 1, 1.0 - share), (right, share)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_table_is_complete() {
        let table = AmplitudeTable::standard();
        assert_eq!(table.entries.len(), RATIOS.len() * POSITIONS * DAMPING.len());
        assert!(table.entries.iter().all(|entry| entry.values().iter().all(|value| value.is_finite())));
        assert_eq!(AmplitudeTable::parse(&table.to_csv()), *table);
    }

    /// Entries at moderate width settle to a cycle that a new simulation repeats.
    #[test]
    fn simulation_repeats_the_shipped_entries() {
        for (ratio, position, damping) in [(1.1, 3, 0.04), (1.25, 0, 0.02), (1.5, 6, 0.08), (2.0, 4, 0.04)] {
            let waves = WHOLE_WAVES + f64::from(position) / POSITIONS as f64;
            let fresh = LimitCycle::simulated(ratio, waves, damping).unwrap().values();
            let shipped = AmplitudeTable::standard().limit_cycle(ratio, waves, damping).unwrap().values();
            for (fresh, shipped) in fresh.into_iter().zip(shipped) {
                assert!((fresh - shipped).abs() < 0.01 * shipped.abs() + 1e-3, "{ratio} {fresh} {shipped}");
            }
        }
    }
}
