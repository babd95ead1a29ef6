//! Lines of a spectrum and what explains them.

/// Where a line comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Harmonic of the tooth frequency.
    Tooth(u32),
    /// Harmonic of the spindle frequency that is none of the teeth.
    Spindle(u32),
    /// Mains.
    Mains,
    /// In the record without cutting as well.
    Machine,
    /// Harmonic of the tooth frequency beyond half of the sampling rate, folded.
    Folded(u32),
    /// At the chatter frequency plus so many tooth frequencies.
    Chatter(i32),
    /// None of these.
    Unknown,
}

/// A line of the sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its frequency (Hz).
    pub frequency: f64,
    /// Its amplitude in the unit of the record.
    pub amplitude: f64,
    /// Its level above the floor around it (dB).
    pub level: f64,
    /// Where it comes from.
    pub origin: Origin,
}
