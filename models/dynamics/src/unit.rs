//! Units of responses over force.

use std::f64::consts::TAU;

/// Standard gravity (m/s²), 3rd CGPM 1901.
const GRAVITY: f64 = 9.806_65;
/// Pound-force (N), international pound of 1959 under standard gravity.
const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// What was measured of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Displacement: the response is a receptance.
    Displacement,
    /// Velocity: a mobility.
    Velocity,
    /// Acceleration: an accelerance.
    Acceleration,
}

impl Motion {
    /// How many times the displacement was differentiated.
    pub fn derivatives(self) -> i32 {
        match self {
            Self::Displacement => 0,
            Self::Velocity => 1,
            Self::Acceleration => 2,
        }
    }

    /// The quantity over force, as people call it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Displacement => "receptance",
            Self::Velocity => "mobility",
            Self::Acceleration => "accelerance",
        }
    }
}

/// Units of spindle speeds that are read.
pub(crate) const SPEEDS: &str = "rpm, 1/min, rad/s";

/// Factor to rad/s of a unit of spindle speed.
pub(crate) fn speed(unit: &str) -> Option<f64> {
    match unit {
        "rpm" | "1/min" => Some(TAU / 60.0),
        "rad/s" => Some(1.0),
        _ => None,
    }
}

/// Units of responses that are read.
pub(crate) const RESPONSES: &str = "m/N, mm/N, um/N, (m/s)/N, (m/s2)/N, g/N (g is standard gravity), in/lbf";

const MOTIONS: &[(&str, f64, Motion)] = &[
    ("m", 1.0, Motion::Displacement),
    ("mm", 1e-3, Motion::Displacement),
    ("um", 1e-6, Motion::Displacement),
    ("nm", 1e-9, Motion::Displacement),
    ("in", 0.0254, Motion::Displacement),
    ("m/s", 1.0, Motion::Velocity),
    ("mm/s", 1e-3, Motion::Velocity),
    ("in/s", 0.0254, Motion::Velocity),
    ("m/s2", 1.0, Motion::Acceleration),
    ("mm/s2", 1e-3, Motion::Acceleration),
    ("in/s2", 0.0254, Motion::Acceleration),
    ("g", GRAVITY, Motion::Acceleration),
];

const FORCES: &[(&str, f64)] = &[("N", 1.0), ("kN", 1e3), ("lbf", POUND_FORCE)];

/// Plain letters for the ways in which units are written.
fn plain(text: &str) -> String {
    text.replace(['µ', 'μ'], "u").replace(['^', ' ', '(', ')'], "").replace('²', "2").replace("m/s/s", "m/s2")
}

/// The factor to SI and the motion of a unit such as `um/N`, `(m/s2)/N` or `m`.
pub(crate) fn motion(text: &str) -> Option<(f64, Motion)> {
    let text = plain(text);
    MOTIONS.iter().find(|(name, ..)| *name == text).map(|(_, factor, motion)| (*factor, *motion))
}

/// The factor to N of a unit of force.
pub(crate) fn force(text: &str) -> Option<f64> {
    let text = plain(text);
    FORCES.iter().find(|(name, _)| *name == text).map(|(_, newtons)| *newtons)
}

/// The factor to s of a unit of time.
pub(crate) fn time(text: &str) -> Option<f64> {
    match plain(text).as_str() {
        "s" => Some(1.0),
        "ms" => Some(1e-3),
        "us" => Some(1e-6),
        _ => None,
    }
}

/// The factor to SI and the motion of a unit of a response over force.
pub(crate) fn response(text: &str) -> Option<(f64, Motion)> {
    let text = plain(text);
    let (over, force) = text.rsplit_once('/')?;
    let newtons = self::force(force)?;
    let (factor, kind) = motion(over)?;
    Some((factor / newtons, kind))
}

/// The factor to Hz of a unit of frequency.
pub(crate) fn frequency(text: &str) -> Option<f64> {
    match plain(text).as_str() {
        "Hz" => Some(1.0),
        "kHz" => Some(1e3),
        "rad/s" => Some(1.0 / TAU),
        "rpm" => Some(1.0 / 60.0),
        _ => None,
    }
}

/// The factor to radians of a unit of a phase.
pub(crate) fn phase(text: &str) -> Option<f64> {
    match plain(text).as_str() {
        "deg" | "°" => Some(TAU / 360.0),
        "rad" => Some(1.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_read_as_they_are_written() {
        assert_eq!(response("um/N"), Some((1e-6, Motion::Displacement)));
        assert_eq!(response("µm/N"), Some((1e-6, Motion::Displacement)));
        assert_eq!(response("(m/s^2)/N"), Some((1.0, Motion::Acceleration)));
        assert_eq!(response("m/s²/N"), Some((1.0, Motion::Acceleration)));
        assert_eq!(response("g/N"), Some((9.80665, Motion::Acceleration)));
        let (factor, kind) = response("in/lbf").unwrap();
        assert!((factor - 5.710_147_1e-3).abs() < 1e-9 && kind == Motion::Displacement);
        assert_eq!(response("um"), None);
        assert_eq!(response("V/N"), None);
    }
}
