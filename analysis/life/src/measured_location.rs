//! Where in a table of measured lives an error is.

use crate::measured::MeasuredError;
use toolroom_location::{Located, Location};

impl Located for MeasuredError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Quote { file, fault } => Some(Location::line(file, fault.line())),
            Self::MissingColumn { file, .. } => Some(Location::line(file, 1)),
            Self::CellCount { file, line, .. }
            | Self::Cell { file, line, .. }
            | Self::DecimalSign { file, line, .. }
            | Self::Age { file, line, .. }
            | Self::Backwards { file, line, .. } => Some(Location::line(file, *line)),
            Self::Encoding { file, .. } | Self::NoRows { file, .. } => Some(Location::of(file)),
        }
    }
}
