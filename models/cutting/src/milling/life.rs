//! Life of a new cutter under constant conditions.

use super::{Milling, MillingInput};
use toolroom_process::{ModelError, Process, ProcessEvent};
use toolroom_wear::Life;

/// Longest life that is looked for, s; a cut that lasts longer does not wear the cutter out.
const LONGEST: f64 = 1e9;

impl Milling {
    /// What a new cutter gives under `u`, held, until the first event that ends it. All of its
    /// wear counts as mechanical.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] and [`ModelError::Contradiction`] for an input outside the
    /// domain; [`ModelError::NoSolution`] where the cutter is not in cut or does not wear out.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{Milling, MillingInput};
    /// let cut = MillingInput { cutting_speed: 167.4 / 60.0, ..MillingInput::default() };
    /// let (life, _) = Milling::default().life(&cut).unwrap();
    /// assert!((life.cutting_time / 3600.0 - 1.0).abs() < 1e-6); // the reference cut: 60 min
    /// ```
    pub fn life(&self, u: &MillingInput) -> Result<(Life, ProcessEvent), ModelError> {
        self.check(u)?;
        let endless = |reason| ModelError::NoSolution { quantity: "tool_life", reason };
        if u.engaged == 0.0 || u.cutting_speed == 0.0 {
            return Err(endless("the cutter is not in cut"));
        }
        let (state, advance) = self.run(&self.initial(), u, LONGEST)?;
        let event = advance.event.ok_or_else(|| endless("the cutter does not wear out"))?;
        let life = Life {
            cutting_time: state.cutting_time,
            path: state.cutting_path,
            mechanical_wear: state.flank_wear,
            thermal_wear: 0.0,
        };
        Ok((life, event))
    }
}
