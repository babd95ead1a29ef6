//! Words that choose among what vibrates, how it is held and how it is cut.

use toolroom_form::vocabulary;

vocabulary! {
    /// What vibrates.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum LobesProcess {
        /// A milling cutter that meets its own surface.
        Milling = "milling",
        /// A turned cut that meets its own surface.
        Turning = "turning",
        /// Work in a chuck of three jaws, over speed ratio and modulation.
        Chuck = "chuck",
        /// The same at rest, over chip-formation lag and cutting stiffness.
        ChipLag = "chip_lag",
        /// Tool and work together, over speed ratio and modulation.
        Lathe = "lathe",
    }
}

vocabulary! {
    /// Reading of the published constants of the chuck.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum PresetWord {
        /// Mass from the text's natural frequency of 120 Hz.
        F0_120Hz = "f0_120hz",
        /// Mass and damping fitted to the thresholds of Fig. 3.
        Fig3Fit = "fig3_fit",
        /// Table 2 with the factor 10⁻³ of Table 1.
        Table2Milli = "table2_milli",
        /// Table 2 to the letter.
        Table2Literal = "table2_literal",
    }
}

vocabulary! {
    /// How the cutter meets the work.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum DirectionWord {
        /// Conventional milling.
        Up = "up",
        /// Climb milling.
        Down = "down",
    }
}

vocabulary! {
    /// How a bar is held.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(super) enum SupportWord {
        /// In a chuck alone.
        Chuck = "chuck",
        /// In a chuck and by a tailstock.
        Tailstock = "tailstock",
    }
}
