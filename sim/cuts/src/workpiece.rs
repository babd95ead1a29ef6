//! A workpiece as its operation finds and leaves it.

use toolroom_runlog::runlog::JobOutcome;
use toolroom_scenario::Operation;

/// A workpiece, as far as its operation has come.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Pass or phase that is due or in work.
    pub pass: u32,
    /// Share of the pass that is still to be cut.
    pub share_left: f64,
    /// The work as it came.
    pub blank: Blank,
    /// Size error at the end of the last pass, m.
    pub size_error: f64,
    /// The surface of the last pass.
    pub surface: Surface,
    /// Whether the surface is burnt.
    pub burnt: bool,
    /// Whether a broken edge spoiled the part.
    pub spoiled: bool,
    /// How far the machine moved the wheel in before the part, because of its wear, m.
    pub correction: f64,
}

impl Default for Piece {
    /// A workpiece before its first pass.
    fn default() -> Self {
        Self {
            pass: 0,
            share_left: 1.0,
            blank: Blank { hardness: 1.0, lot_deviation: 0.0 },
            size_error: 0.0,
            surface: Surface::default(),
            burnt: false,
            spoiled: false,
            correction: 0.0,
        }
    }
}

/// A workpiece as it came.
#[derive(Clone, Copy, Debug)]
pub struct Blank {
    /// Hardness against nominal: that of its lot and its own.
    pub hardness: f64,
    /// 1 in the lot that deviates, else 0.
    pub lot_deviation: f64,
}

/// The surface that the last pass leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surface {
    /// Greatest roughness Ra, m.
    pub roughness: f64,
    /// Whether chatter grew while it was cut.
    pub chattered: bool,
}

impl Piece {
    /// A pass begins anew on the surface.
    pub fn renew_surface(&mut self) {
        if self.share_left >= 1.0 {
            self.surface = Surface::default();
        }
    }

    /// Why it is no good part, if it is none.
    pub fn fault(&self, operation: &Operation) -> Option<JobOutcome> {
        let rough = self.surface.roughness > operation.roughness_limit;
        if self.spoiled {
            Some(JobOutcome::ToolFailure)
        } else if rough && self.surface.chattered {
            Some(JobOutcome::Chatter)
        } else if self.burnt {
            Some(JobOutcome::Burnt)
        } else if rough || self.size_error.abs() > operation.size_tolerance {
            Some(JobOutcome::OutOfTolerance)
        } else {
            None
        }
    }
}
