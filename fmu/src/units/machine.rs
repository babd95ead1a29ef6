//! What vibrates around the cut, as parameters of a unit.

use toolroom_process::record;

record! {
    /// One mode between tool and workpiece along the chip thickness. Off, every cut is stable.
    ///
    /// # Source
    /// Order of magnitude of Altintas, Eynian and Onozuka, CIRP Annals 57 (2008) 371-374, for
    /// carbon steel; not measured on the machine at hand.
    pub struct TurningMachine {
        /// Whether the cut is judged for chatter.
        chatter: Boolean = 0.0;
        /// Natural frequency.
        natural_frequency: Real["Hz" => "Hz"] = 540.9, 1.0..=1e5;
        /// Share of critical damping.
        damping_ratio: Real = 0.038, 1e-4..=0.9;
        /// Modal stiffness at the point of cut.
        stiffness: Real["N/m" => "N/um"] = 6.48e6, 1e3..=1e12;
        /// Cutting coefficient of the sharp nominal edge per depth of cut, along the chip thickness.
        cutting_coefficient: Real["Pa" => "N/mm2"] = 1384e6, 1e6..=1e11;
        /// Process damping of the sharp edge.
        process_damping: Real["N/m" => "N/m"] = 6.11e5, 0.0..=1e9;
    }
}

record! {
    /// The same mode of the cutter along and across the feed. Off, every cut is stable.
    ///
    /// # Source
    /// The mode of the standard case of Insperger and Stepan, Int. J. Numer. Meth. Engng 61 (2004)
    /// 117-141; not measured on the machine at hand.
    pub struct MillingMachine {
        /// Whether the cut is judged for chatter.
        chatter: Boolean = 0.0;
        /// Natural frequency.
        natural_frequency: Real["Hz" => "Hz"] = 922.0, 1.0..=1e5;
        /// Share of critical damping.
        damping_ratio: Real = 0.011, 1e-4..=0.9;
        /// Modal stiffness at the tip.
        stiffness: Real["N/m" => "N/um"] = 1.340_05e6, 1e3..=1e12;
        /// Helix angle of the cutter.
        helix_angle: Real["rad" => "deg"] = 0.0, 0.0..=1.5;
        /// Process damping of the sharp edge.
        process_damping: Real["N/m" => "N/m"] = 0.0, 0.0..=1e9;
    }
}
