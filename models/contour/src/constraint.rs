//! The technological, strength and kinematic limits by name.

use std::fmt;

/// A limit of the plan; the letter is that of Lukin's system (4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Constraint {
    /// (а) Path feed at most that of the machine.
    HighestFeed,
    /// (б) Path feed at least that of the machine.
    LowestFeed,
    /// (в) Spindle speed at least the lowest.
    LowestSpindleSpeed,
    /// (г) Spindle speed at most the highest.
    HighestSpindleSpeed,
    /// (ж) Cutting power within that of the drive.
    Power,
    /// (з) Force within that of the feed mechanism.
    FeedForce,
    /// (и) Bending of the tooth within its strength.
    ToothStrength,
    /// (к) Bending and torsion of the body within its strength.
    BodyStrength,
    /// (л) Chips of a tooth within its flute.
    ChipSpace,
    /// (м) Tool life at least the nominal one.
    ToolLife,
    /// (н) Deflection and path error within the tolerance.
    Accuracy,
    /// (о) Roughness within the admissible one.
    Roughness,
}

impl Constraint {
    /// All of them, in the order of system (4).
    pub const ALL: [Self; 12] = [
        Self::HighestFeed,
        Self::LowestFeed,
        Self::LowestSpindleSpeed,
        Self::HighestSpindleSpeed,
        Self::Power,
        Self::FeedForce,
        Self::ToothStrength,
        Self::BodyStrength,
        Self::ChipSpace,
        Self::ToolLife,
        Self::Accuracy,
        Self::Roughness,
    ];

    /// Name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::HighestFeed => "highest_feed",
            Self::LowestFeed => "lowest_feed",
            Self::LowestSpindleSpeed => "lowest_spindle_speed",
            Self::HighestSpindleSpeed => "highest_spindle_speed",
            Self::Power => "power",
            Self::FeedForce => "feed_force",
            Self::ToothStrength => "tooth_strength",
            Self::BodyStrength => "body_strength",
            Self::ChipSpace => "chip_space",
            Self::ToolLife => "tool_life",
            Self::Accuracy => "accuracy",
            Self::Roughness => "roughness",
        }
    }

    /// Letter in Lukin's system (4).
    pub fn letter(self) -> char {
        const LETTERS: [char; 12] = ['а', 'б', 'в', 'г', 'ж', 'з', 'и', 'к', 'л', 'м', 'н', 'о'];
        LETTERS[self as usize]
    }
}

impl fmt::Display for Constraint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Every constraint's value over its limit; all at most 1 where a setting is admissible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratios(pub(crate) [f64; 12]);

/// Rounding that an admissible ratio may show above 1.
pub(crate) const FEASIBILITY: f64 = 1.0 + 1e-12;

/// Whether a ratio breaks its constraint; one that is not a number does.
pub(crate) fn exceeds(ratio: f64) -> bool {
    ratio.is_nan() || ratio > FEASIBILITY
}

impl Ratios {
    /// Value over limit of one constraint.
    pub fn of(&self, constraint: Constraint) -> f64 {
        self.0[constraint as usize]
    }

    /// Every constraint with its ratio.
    pub fn iter(&self) -> impl Iterator<Item = (Constraint, f64)> {
        Constraint::ALL.into_iter().zip(self.0)
    }

    /// Constraints that are not met.
    pub fn violated(&self) -> impl Iterator<Item = Constraint> {
        self.iter().filter(|(_, ratio)| exceeds(*ratio)).map(|(constraint, _)| constraint)
    }

    /// Whether all are met.
    pub fn admissible(&self) -> bool {
        self.violated().next().is_none()
    }

    /// The constraint with the greatest ratio.
    pub fn tightest(&self) -> (Constraint, f64) {
        let first = (Constraint::HighestFeed, f64::NEG_INFINITY);
        self.iter().fold(first, |best, each| if each.1 > best.1 { each } else { best })
    }
}
