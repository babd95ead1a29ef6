//! How an effect that a part program may show acts on times.

use toolroom_drives::Deviation;

/// Shape of holds that take one time each, whatever was logged.
pub(super) const EACH_ALIKE: &str = "each alike";

/// How a candidate acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Action {
    /// Time on every row, s per size.
    Feature(usize),
    /// Other drives.
    Drives(Deviation),
}

/// A parameter of a shape: name, value in SI, SI unit, unit for people.
type Written = (&'static str, f64, &'static str, &'static str);

impl Action {
    /// The shape as files and documents have it; `alike` holds take one time each.
    pub fn written(self, alike: bool) -> Vec<Written> {
        match self {
            Self::Feature(_) if alike => vec![("each_alike", 1.0, "1", "1")],
            Self::Feature(_) => Vec::new(),
            Self::Drives(deviation) => match deviation {
                Deviation::Acceleration { corner_deviation, jerk_time } => {
                    vec![("corner_deviation", corner_deviation, "m", "um"), ("jerk_time", jerk_time, "s", "ms")]
                }
                Deviation::SpindleRamp { base_speed, reference_speed } => vec![
                    ("base_speed", base_speed, "rad/s", "rpm"),
                    ("reference_speed", reference_speed, "rad/s", "rpm"),
                ],
                Deviation::StopSettling { rapid } => vec![("rapid", rapid, "1", "1")],
                Deviation::RapidAcceleration
                | Deviation::Jerk
                | Deviation::CornerSlowing
                | Deviation::BlockTime
                | Deviation::ProgramEnd
                | Deviation::MagazineDistance => Vec::new(),
            },
        }
    }
}
