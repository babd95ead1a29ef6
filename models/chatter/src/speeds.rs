//! Modes that change with the spindle speed.

use crate::error::{ChatterError, positive};
use crate::rows::{Row, check_rows, interpolated, mapped};
use crate::structure::{Mode, check_modes};

/// Relative distance beyond the ends of a table at which the modes of the end still count: the step to which the shop rounds
/// speeds is half of it.
const EDGE: f64 = 1e-3;

/// The modes of a structure at several spindle speeds, each followed from speed to speed, as where a spindle warms its
/// bearings, loses their preload or splits its modes by turning.
///
/// Between two speeds the pole of a mode, `−zeta w + i w sqrt(1 − zeta²)`, and its shape `direction/sqrt(mass)` change
/// linearly with the speed, so that no mode is doubled or averaged away as it would be in a mean of responses. Where a mode
/// is the same at both speeds, it is the same between them, to the last bit.
///
/// | symbol | unit | range |
/// |---|---|---|
/// | spindle speeds | rad/s | > 0, ascending, two at least |
/// | modes | | the same number at each speed, in the same order |
///
/// # Not modelled
/// Modes that appear or vanish between two speeds; whirling modes whose two directions are out of phase: a mode moves along
/// a line.
///
/// # Examples
/// ```
/// use toolroom_chatter::{Mode, SpeedModes};
/// let mode = |f: f64| Mode { direction: [1.0, 0.0], natural_frequency: f, damping_ratio: 0.02, stiffness: 1e7 };
/// let table = SpeedModes::new(vec![(500.0, vec![mode(900.0)]), (1000.0, vec![mode(880.0)])]).unwrap();
/// assert!((table.at(750.0).unwrap()[0].natural_frequency - 890.0).abs() < 1e-9);
/// assert!(table.at(1100.0).is_err());
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SpeedModes {
    /// By ascending speed (rad/s).
    rows: Vec<Row>,
}

impl SpeedModes {
    /// From the modes at each speed (rad/s).
    ///
    /// # Errors
    /// Fewer than two speeds; speeds that are not positive or do not ascend; another number of modes at one speed; a mode
    /// that is none.
    pub fn new(rows: Vec<(f64, Vec<Mode>)>) -> Result<Self, ChatterError> {
        check_rows(&rows, ["spindle_speed", "spindle speeds with modes", "number of modes at each spindle speed"])?;
        for (speed, _) in &rows {
            positive("spindle_speed", *speed)?;
        }
        Ok(Self { rows })
    }

    /// Least and greatest speed (rad/s) of the table.
    pub fn range(&self) -> (f64, f64) {
        (self.rows[0].0, self.rows[self.rows.len() - 1].0)
    }

    /// The modes at the least speed of the table.
    pub fn first(&self) -> &[Mode] {
        &self.rows[0].1
    }

    /// The modes at `spindle_speed` (rad/s).
    ///
    /// # Errors
    /// [`ChatterError::SpeedOutsideTable`] outside the speeds of the table: nobody measured there.
    pub fn at(&self, spindle_speed: f64) -> Result<Vec<Mode>, ChatterError> {
        let (least, greatest) = self.range();
        if !(least * (1.0 - EDGE)..=greatest * (1.0 + EDGE)).contains(&spindle_speed) {
            return Err(ChatterError::SpeedOutsideTable { speed: spindle_speed, least, greatest });
        }
        Ok(interpolated(&self.rows, spindle_speed.clamp(least, greatest)))
    }

    /// The same speeds with other modes, of the number and the mode at each.
    pub fn map(&self, other: impl FnMut(usize, &Mode) -> Mode) -> Self {
        Self { rows: mapped(&self.rows, other) }
    }

    /// The table with one more mode, which is the same at all speeds.
    pub fn with(mut self, mode: Mode) -> Self {
        self.rows.iter_mut().for_each(|(_, modes)| modes.push(mode));
        self
    }

    /// The modes of each row, for what is asked without a speed.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &Vec<Mode>> {
        self.rows.iter().map(|(_, modes)| modes)
    }
}

/// Every mode of a table is one.
pub(crate) fn check_speeds(table: Option<&SpeedModes>) -> Result<(), ChatterError> {
    table.map_or(Ok(()), |table| table.rows().try_for_each(|modes| check_modes(modes)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Cutter, Direction, Engagement, Milling, MillingForce, Scatter, Turning};
    use std::f64::consts::TAU;

    fn mode(natural_frequency: f64) -> Mode {
        Mode { direction: [1.0, 0.0], natural_frequency, damping_ratio: 0.03, stiffness: 8e6 }
    }

    fn rpm(speed: f64) -> f64 {
        speed / 60.0 * TAU
    }

    fn side(modes: Vec<Mode>) -> Milling {
        Milling {
            modes,
            cutter: Cutter::straight(3, 0.012),
            engagement: Engagement::new(0.3, Direction::Down).unwrap(),
            force: MillingForce::new(8e8, 2.6e8),
            feed_per_tooth: 1e-4,
            by_speed: None,
            along_path: None,
        }
    }

    #[test]
    fn equal_modes_at_all_speeds_are_those_modes_to_the_last_bit() {
        let modes = vec![mode(650.0), Mode { direction: [0.6, 0.8], ..mode(910.0) }];
        let table = SpeedModes::new([2000.0, 6000.0, 14000.0].map(|n| (rpm(n), modes.clone())).to_vec()).unwrap();
        let turned = Turning { process_damping: 1e5, ..Turning::orthogonal(modes.clone(), 1.2e9, 0.04) };
        let tabled = Turning { by_speed: Some(table.clone()), ..turned.clone() };
        let milled = side(modes.clone());
        let by_table = Milling { by_speed: Some(table), ..milled.clone() };
        let axis = Axis { start: rpm(3000.0), end: rpm(9000.0), points: 7 };
        let (speeds, depths) = (axis.values("speed").unwrap(), [0.0, 0.5e-3, 2e-3]);
        for speed in &speeds {
            assert_eq!(turned.limit(*speed).unwrap(), tabled.limit(*speed).unwrap());
            assert_eq!(turned.verdict(*speed, 0.6e-3).unwrap(), tabled.verdict(*speed, 0.6e-3).unwrap());
            let greatest = 8e-3;
            let interval = |cut: &Milling| cut.at_speed(*speed).unwrap().stable_intervals(greatest).unwrap();
            assert_eq!(interval(&milled), interval(&by_table));
            assert_eq!(milled.forced(*speed, 1e-3).unwrap(), by_table.forced(*speed, 1e-3).unwrap());
        }
        assert_eq!(milled.lobes(&speeds, &depths).unwrap(), by_table.lobes(&speeds, &depths).unwrap());
        assert_eq!(milled.boundary(&axis, 4e-3).unwrap(), by_table.boundary(&axis, 4e-3).unwrap());
        assert_eq!(turned.boundary(&axis, 4e-3).unwrap(), tabled.boundary(&axis, 4e-3).unwrap());
        assert_eq!(turned.absolute_limit().unwrap(), tabled.absolute_limit().unwrap());
        let scatter = Scatter { natural_frequency: 0.02, damping_ratio: 0.2, coefficients: 0.1 };
        let probable = |cut: &Milling| cut.stability_probability(rpm(5000.0), 1e-3, &scatter, 20, 3).unwrap();
        assert_eq!(probable(&milled), probable(&by_table));
    }

    /// Both cases have a closed form. A frequency in proportion to the speed leaves the waves in a revolution as they are, and
    /// the limit with them. With a linear drift the least depth of a lobe, `2 k zeta (1 + zeta)/K` at `w = w_n sqrt(1 + 2 zeta)`,
    /// stands where `n (wave + eps/2pi) = f(n) sqrt(1 + 2 zeta)`, linear in n, with `eps = pi + 2 arg G`.
    #[test]
    fn lobes_move_with_the_frequency_as_their_closed_forms_say() {
        let table = |frequency: &dyn Fn(f64) -> f64| {
            let rows = [60.0, 100.0].map(|n| (n * TAU, vec![mode(frequency(n))])).to_vec();
            Turning {
                by_speed: Some(SpeedModes::new(rows).unwrap()),
                ..Turning::orthogonal(vec![mode(900.0)], 1.2e9, 0.04)
            }
        };
        let proportional = table(&|n| 8.3 * n);
        let limits: Vec<f64> =
            (0..9).map(|i| proportional.limit((60.0 + 5.0 * f64::from(i)) * TAU).unwrap().depth).collect();
        assert!(limits.iter().all(|limit| (limit / limits[0] - 1.0).abs() < 1e-9), "{limits:?}");
        let (zeta, drift, first) = (0.03f64, -0.4, 900.0);
        let drifting = table(&|n| first + drift * (n - 80.0));
        let fixed = Turning::orthogonal(vec![mode(first)], 1.2e9, 0.04);
        let least = 2.0 * 8e6 * zeta * (1.0 + zeta) / 1.2e9;
        let ratio = (1.0 + 2.0 * zeta).sqrt();
        let argument = f64::atan2(-2.0 * zeta * ratio, 1.0 - ratio * ratio);
        let eps = (std::f64::consts::PI + 2.0 * argument).rem_euclid(TAU);
        let mut seen = 0;
        for wave in 8..=15 {
            let turns = f64::from(wave) + eps / TAU;
            let n = ratio * (first - 80.0 * drift) / (turns - ratio * drift);
            if (n - 80.0).abs() > 19.5 {
                continue;
            }
            seen += 1;
            let limit = drifting.limit(n * TAU).unwrap();
            assert!((limit.depth / least - 1.0).abs() < 1e-9, "{wave} at {n}: {limit:?} {least}");
            let frequency = ratio * (first + drift * (n - 80.0));
            assert!((limit.chatter_frequency / frequency - 1.0).abs() < 1e-6, "{wave}: {limit:?} {frequency}");
            // With the modes of one speed the lobe stands elsewhere.
            let elsewhere = ratio * first / turns;
            assert!((fixed.limit(elsewhere * TAU).unwrap().depth / least - 1.0).abs() < 1e-9);
            assert!((elsewhere - n).abs() > 1e-3 || (n - 80.0).abs() < 0.3, "{elsewhere} {n}");
        }
        assert!(seen > 3, "{seen}");
    }

    #[test]
    fn tables_that_are_none_and_speeds_outside_are_refused() {
        let row = |speed: f64, count: usize| (speed, vec![mode(700.0); count]);
        assert!(matches!(SpeedModes::new(vec![row(100.0, 1)]), Err(ChatterError::TooFewPoints { .. })));
        assert!(SpeedModes::new(vec![row(200.0, 1), row(100.0, 1)]).is_err());
        assert!(SpeedModes::new(vec![row(100.0, 1), row(200.0, 2)]).is_err());
        assert!(SpeedModes::new(vec![row(-1.0, 1), row(200.0, 1)]).is_err());
        let table = SpeedModes::new(vec![row(100.0, 1), row(200.0, 1)]).unwrap();
        for outside in [99.0, 201.0] {
            let cut = Turning { by_speed: Some(table.clone()), ..Turning::orthogonal(vec![mode(700.0)], 1e9, 0.04) };
            assert!(matches!(cut.limit(outside), Err(ChatterError::SpeedOutsideTable { .. })), "{outside}");
            // People give rpm, and the table is in rpm.
            let told = cut.limit(outside).unwrap_err().to_string();
            assert!(told.ends_with("the table of modes has 954.9 to 1909.9 rpm"), "{told}");
            let milled = Milling { by_speed: Some(table.clone()), ..side(vec![mode(700.0)]) };
            assert!(matches!(milled.at_speed(outside), Err(ChatterError::SpeedOutsideTable { .. })), "{outside}");
        }
        assert!(table.at(f64::NAN).is_err() && table.at(f64::INFINITY).is_err());
    }

    #[test]
    fn poles_are_followed_and_signs_of_directions_do_not_matter() {
        let a = Mode { direction: [1.0, 0.0], natural_frequency: 800.0, damping_ratio: 0.02, stiffness: 1e7 };
        let b = Mode { direction: [-2.0, 0.0], natural_frequency: 760.0, damping_ratio: 0.04, stiffness: 9e6 };
        let table = SpeedModes::new(vec![(100.0, vec![a]), (200.0, vec![b])]).unwrap();
        let mean = table.at(150.0).unwrap()[0];
        let pole = 0.5 * (a.pole() + b.pole());
        assert!((mean.pole() - pole).norm() < 1e-9 * pole.norm());
        let shape = 0.5 * (1.0 / a.mass().sqrt() + 1.0 / b.mass().sqrt());
        assert!((mean.mass() * shape * shape - 1.0).abs() < 1e-12 && (mean.direction[0] - 1.0).abs() < 1e-12);
    }
}
