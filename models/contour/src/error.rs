//! What a contour, a plan or a contour file is refused for.

use crate::{Constraint, SetError};
use toolroom_process::ModelError;

/// Names of constraints, for messages.
fn names(constraints: &[Constraint]) -> String {
    constraints.iter().map(|constraint| constraint.name()).collect::<Vec<_>>().join(", ")
}

/// Why there is no contour or no plan. Sections count from 0 in the field, from 1 in the message;
/// lengths are in m in the field, in mm in the message.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContourError {
    /// No section.
    #[error("the contour has no section")]
    Empty,
    /// A section of no length.
    #[error("section {} has no length", section + 1)]
    NoLength {
        /// Section.
        section: usize,
    },
    /// A profile cut into too few or too many sections.
    #[error("a profile is cut into 3 to {greatest} sections, not {sections}")]
    Division {
        /// Sections requested.
        sections: u32,
        /// Most sections.
        greatest: u32,
    },
    /// Arcs that do not follow a curve well enough.
    #[error(
        "{sections} pairs of arcs are off the profile by {:.2} um, more than the tolerance of {} um; write sections = {enough}, or leave it out",
        residual * 1e6, toolroom_form::significant(tolerance * 1e6)
    )]
    Residual {
        /// Greatest distance between arcs and curve, m.
        residual: f64,
        /// Distance that is admitted, m.
        tolerance: f64,
        /// Pairs of arcs requested.
        sections: u32,
        /// Pairs of arcs that would do.
        enough: u32,
    },
    /// A contour that does not come back to its start.
    #[error("the contour is open: its end is {:.4} mm from its start; close it, or write `closed = false`", gap * 1e3)]
    Open {
        /// Distance from end to start, m.
        gap: f64,
    },
    /// An arc whose end does not lie on its circle.
    #[error("the arc of section {} misses its end by {:.4} mm; check centre, radius and end point", section + 1, gap * 1e3)]
    ArcMissesEnd {
        /// Section.
        section: usize,
        /// Distance of the end from the circle, m.
        gap: f64,
    },
    /// A joint that turns towards the cutter at once.
    #[error(
        "a sharp inside corner of {:.2} deg follows section {}: no cutter reaches it; draw an arc larger than the cutter",
        angle.to_degrees(), section + 1
    )]
    SharpInsideCorner {
        /// Section that ends there.
        section: usize,
        /// Angle of the free side, rad.
        angle: f64,
    },
    /// A path that comes back on itself.
    #[error("the path comes back on itself after section {}", section + 1)]
    Reversal {
        /// Section that ends there.
        section: usize,
    },
    /// A cutter that a concave section does not admit.
    #[error(
        "section {} is concave with a radius of {:.4} mm: the cutter radius of {:.4} mm must be smaller",
        section + 1, radius * 1e3, cutter_radius * 1e3
    )]
    CutterTooLarge {
        /// Section.
        section: usize,
        /// Its radius, m.
        radius: f64,
        /// Radius of the cutter, m.
        cutter_radius: f64,
    },
    /// A place that is too narrow for the cutter, though every section admits it by itself.
    #[error(
        "along section {} the cutter cuts {:.4} mm into section {}: a neck or slot is narrower than the cutter, or the contour \
         crosses itself; take a smaller cutter or another contour",
        section + 1, depth * 1e3, other + 1
    )]
    Neck {
        /// Section along which the cutter runs.
        section: usize,
        /// Section that it cuts into.
        other: usize,
        /// How deep it cuts at least, m.
        depth: f64,
    },
    /// A number outside its range.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A gear series without speed.
    #[error("no preferred number lies between the lowest and the highest spindle speed")]
    NoSpindleSpeed,
    /// No spindle speed and feed meet every constraint on a section.
    #[error(
        "no spindle speed and feed suit section {}: {} cannot be met together; relax one of them",
        section + 1, names(conflicting)
    )]
    EmptyFeasibleSet {
        /// Section.
        section: usize,
        /// The fewest constraints that already conflict.
        conflicting: Vec<Constraint>,
    },
    /// No one setting suits every section.
    #[error("no single spindle speed and feed suit every section: {} cannot be met together", names(conflicting))]
    NoCommonSetting {
        /// The fewest constraints that already conflict.
        conflicting: Vec<Constraint>,
    },
    /// No step of the feed override makes the handbook regime admissible.
    #[error("the handbook regime violates {} at every step of the feed override", names(violated))]
    NoHandbookRegime {
        /// Constraints violated at the last step.
        violated: Vec<Constraint>,
    },
    /// Feeds whose ramps do not fit into the sections.
    #[error("no feed of section {} can be reached from the section before it within their lengths", section + 1)]
    NoRamp {
        /// Section.
        section: usize,
    },
    /// An edge life that one section uses up.
    #[error("a fresh edge does not last through section {}", section + 1)]
    EdgeTooShort {
        /// Section.
        section: usize,
    },
    /// A number of settings other than that of sections.
    #[error("{settings} settings for {sections} sections")]
    SettingCount {
        /// Settings given.
        settings: usize,
        /// Sections of the contour.
        sections: usize,
    },
    /// A parameter set that did not load.
    #[error(transparent)]
    Set(#[from] SetError),
    /// A part program that cannot be followed.
    #[error("{message}")]
    Program {
        /// What its reader says.
        message: String,
    },
    /// A section that is none of the known forms.
    #[error(
        "a section is one of `line`, `line_to`, `arc` with `radius`, `arc_to` with `center` or `radius` and `direction`, `spline_to`, `lobed`; this one has {read}"
    )]
    SectionForm {
        /// Keys read.
        read: String,
    },
    /// A pass that the file does not have.
    #[error("there is no pass `{name}`; there are {known}")]
    UnknownPass {
        /// What was requested.
        name: String,
        /// Names of the passes.
        known: String,
    },
    /// A contour file without passes.
    #[error("there is no pass; add [[pass]]")]
    NoPass,
    /// An arc that draws no wall.
    #[error("an arc lies in another plane than XY or turns more than once; a contour lies in XY")]
    GcodePlane,
    /// A part program that does not say on which side the cutter runs.
    #[error(
        "no compensation of the radius (G41, G42, RL, RR) says on which side the cutter runs; give cutter_side in the file"
    )]
    GcodeSide,
    /// A drawing that is no contour.
    #[error("{message}")]
    Dxf {
        /// What is wrong.
        message: String,
    },
}

impl ContourError {
    /// Short name of the fault, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Empty | Self::NoPass => "empty-contour",
            Self::NoLength { .. } => "no-length",
            Self::Open { .. } => "open-contour",
            Self::ArcMissesEnd { .. } => "arc-misses-end",
            Self::SharpInsideCorner { .. } | Self::Reversal { .. } => "unreachable-corner",
            Self::CutterTooLarge { .. } | Self::Neck { .. } => "cutter-too-large",
            Self::Division { .. } | Self::Residual { .. } | Self::Model(_) | Self::NoSpindleSpeed => "out-of-range",
            Self::EmptyFeasibleSet { .. } | Self::NoCommonSetting { .. } | Self::NoHandbookRegime { .. } => {
                "limits-conflict"
            }
            Self::NoRamp { .. } => "no-ramp",
            Self::EdgeTooShort { .. } => "edge-too-short",
            Self::SettingCount { .. } | Self::SectionForm { .. } => "section-form",
            Self::Set(_) | Self::UnknownPass { .. } => "unknown-name",
            Self::Program { .. } | Self::GcodePlane | Self::GcodeSide => "gcode",
            Self::Dxf { .. } => "dxf",
        }
    }

    /// The section at fault, from 0, where there is one.
    pub fn section(&self) -> Option<usize> {
        match self {
            Self::NoLength { section }
            | Self::ArcMissesEnd { section, .. }
            | Self::SharpInsideCorner { section, .. }
            | Self::Reversal { section }
            | Self::CutterTooLarge { section, .. }
            | Self::Neck { section, .. }
            | Self::EmptyFeasibleSet { section, .. }
            | Self::NoRamp { section }
            | Self::EdgeTooShort { section } => Some(*section),
            Self::Empty
            | Self::Division { .. }
            | Self::Residual { .. }
            | Self::Open { .. }
            | Self::Model(_)
            | Self::NoSpindleSpeed
            | Self::NoCommonSetting { .. }
            | Self::NoHandbookRegime { .. }
            | Self::SettingCount { .. }
            | Self::Set(_)
            | Self::Program { .. }
            | Self::SectionForm { .. }
            | Self::UnknownPass { .. }
            | Self::NoPass
            | Self::GcodePlane
            | Self::GcodeSide
            | Self::Dxf { .. } => None,
        }
    }
}

/// A fault and its place in a file, from line and column 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {fault}")]
pub struct FileError {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
    /// What is wrong.
    pub fault: Box<ContourError>,
}
