//! How a machine may differ from the drives that its file states: each part of its time by itself.

use crate::record::Drives;

/// What a machine adds to the times that its file promises, each for one part of the time. All are neutral at size zero.
///
/// ```
/// use toolroom_drives::{Deviation, Drives};
/// let sheet = Drives { inverse_acceleration: 0.5, ..Drives::default() };
/// let slower = Deviation::RapidAcceleration.added(0.2, &sheet);
/// assert_eq!((slower.inverse_acceleration, slower.inverse_rapid_acceleration), (0.5, 0.7));
/// assert_eq!(Deviation::Jerk.added(0.0, &sheet), sheet);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deviation {
    /// Axes need time to accelerate along the path: s²/m, with the corner deviation, m, and the jerk time, s, of drives
    /// that have none so far.
    Acceleration {
        /// Distance by which corners may be rounded, m.
        corner_deviation: f64,
        /// Time in which the acceleration builds up, s.
        jerk_time: f64,
    },
    /// Rapid motions accelerate more slowly than stated: s²/m beside that of the file.
    RapidAcceleration,
    /// The acceleration builds up more slowly: s of jerk time beside that of the file.
    Jerk,
    /// Corners are passed more slowly: 1/m, added to the inverse of the corner deviation.
    CornerSlowing,
    /// The control prepares blocks more slowly: s beside the least time of a motion at feed.
    BlockTime,
    /// The end of the program takes longer: s.
    ProgramEnd,
    /// The magazine turns to the next tool: s for a pocket between the old tool and the new one.
    MagazineDistance,
    /// The spindle takes longer: s from rest to the reference speed, at constant torque up to the base speed, both rad/s;
    /// braking by the same share. A spindle that ramps already keeps its base speed.
    SpindleRamp {
        /// Speed up to which the torque is constant, rad/s.
        base_speed: f64,
        /// Speed at which the size is stated, rad/s.
        reference_speed: f64,
    },
    /// Axes settle where a stop ends a motion: s behind a motion at feed, and this share of it behind a rapid one.
    StopSettling {
        /// Share of it behind a rapid motion, 1.
        rapid: f64,
    },
}

/// Least corner deviation, m: the end of the range of [`Drives::corner_deviation`](Drives).
const LEAST_CORNER: f64 = 1e-9;

impl Deviation {
    /// `drives` with a deviation of `size`, SI. Whether corners and jerk of an acceleration hold is a matter of the
    /// drives: where these accelerate already, their own stay.
    #[must_use]
    pub fn added(self, size: f64, drives: &Drives) -> Drives {
        let mut drives = *drives;
        if size == 0.0 {
            return drives;
        }
        match self {
            Self::Acceleration { corner_deviation, jerk_time } => {
                if drives.inverse_acceleration <= 0.0 {
                    drives.corner_deviation = corner_deviation;
                    drives.jerk_time = jerk_time;
                }
                drives.inverse_acceleration += size;
            }
            Self::RapidAcceleration => drives.inverse_rapid_acceleration = drives.rapid_inertia() + size,
            Self::Jerk => drives.jerk_time += size,
            Self::CornerSlowing => {
                drives.corner_deviation = (1.0 / (1.0 / drives.corner_deviation + size)).max(LEAST_CORNER);
            }
            Self::BlockTime => drives.block_time += size,
            Self::ProgramEnd => drives.program_end += size,
            Self::MagazineDistance => drives.index_time += size,
            Self::SpindleRamp { base_speed, reference_speed } => {
                let before = drives.spindle_constant;
                if before <= 0.0 {
                    drives.spindle_base_speed = base_speed;
                }
                let unit = Drives { spindle_constant: 1.0, ..drives }.spindle_ramp(0.0, reference_speed);
                drives.spindle_constant += size / unit;
                if before > 0.0 {
                    drives.braking_constant *= drives.spindle_constant / before;
                }
            }
            Self::StopSettling { rapid } => {
                drives.feed_settling += size;
                drives.rapid_settling += size * rapid;
            }
        }
        drives
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_process::Record;

    const ALL: [Deviation; 9] = [
        Deviation::Acceleration { corner_deviation: 1e-6, jerk_time: 0.01 },
        Deviation::RapidAcceleration,
        Deviation::Jerk,
        Deviation::CornerSlowing,
        Deviation::BlockTime,
        Deviation::ProgramEnd,
        Deviation::MagazineDistance,
        Deviation::SpindleRamp { base_speed: 100.0, reference_speed: 1000.0 },
        Deviation::StopSettling { rapid: 0.5 },
    ];

    #[test]
    fn no_size_changes_nothing_and_a_small_one_little() {
        let sheet = Drives {
            inverse_acceleration: 0.5,
            spindle_constant: 1e-6,
            spindle_base_speed: 100.0,
            corner_deviation: 5e-6,
            ..Drives::default()
        };
        for deviation in ALL {
            assert_eq!(deviation.added(0.0, &sheet), sheet, "{deviation:?}");
            let near = deviation.added(1e-12, &sheet);
            for index in 0..Drives::<f64>::FIELDS.len() {
                let [before, after] = [&sheet, &near].map(|drives| drives.get(index).unwrap_or(f64::NAN));
                // Drives without a rapid acceleration of their own take that along the path, which then is written down.
                let own = Drives::<f64>::FIELDS[index].name == "inverse_rapid_acceleration";
                let before = if own { sheet.rapid_inertia() } else { before };
                let after = if own { near.rapid_inertia() } else { after };
                assert!((before - after).abs() < 1e-9, "{deviation:?}: {}", Drives::<f64>::FIELDS[index].name);
            }
        }
    }

    #[test]
    fn a_ramp_takes_its_size_longer_to_the_speed_at_which_it_is_stated() {
        let ramp = Deviation::SpindleRamp { base_speed: 300.0, reference_speed: 1000.0 };
        let sheet = Drives::default();
        assert!((ramp.added(3.0, &sheet).spindle_ramp(0.0, 1000.0) - 3.0).abs() < 1e-12);
        // A base speed of the file holds, and braking follows by the same share.
        for base in [200.0, 1500.0] {
            let sheet = Drives {
                spindle_constant: 1e-6,
                spindle_base_speed: base,
                braking_constant: 2e-6,
                braking_base_speed: base,
                ..Drives::default()
            };
            let slower = ramp.added(3.0, &sheet);
            let time = |drives: &Drives, start, end| drives.spindle_ramp(start, end);
            assert!((time(&slower, 0.0, 1000.0) - time(&sheet, 0.0, 1000.0) - 3.0).abs() < 1e-12);
            let longer = time(&slower, 0.0, 1000.0) / time(&sheet, 0.0, 1000.0);
            assert!((time(&slower, 1000.0, 0.0) / time(&sheet, 1000.0, 0.0) - longer).abs() < 1e-12);
        }
    }

    #[test]
    fn corners_are_added_as_inverse_distances() {
        // 1/5 um and 0.3/um are 1/2 um.
        let sheet = Drives { corner_deviation: 5e-6, ..Drives::default() };
        assert!((Deviation::CornerSlowing.added(0.3e6, &sheet).corner_deviation - 2e-6).abs() < 1e-18);
    }
}
