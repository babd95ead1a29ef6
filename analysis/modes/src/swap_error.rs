//! Why a tool cannot be put on a spindle.

/// Why a tool cannot be put on a spindle.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SwapError {
    /// A mode of the base without its slope.
    #[error("mode {mode} of the base lacks `rotation`, its slope over displacement at the face, such as \"-9 1/m\"")]
    NoRotation {
        /// Number of the mode, from 1.
        mode: usize,
    },
    /// Modes that change with the spindle speed.
    #[error("the modes of the base change with the spindle speed; put those of one speed into a file of their own")]
    Speeds,
    /// Modes that change along the path.
    #[error("the modes of the base change along the path; put those of one station into a file of their own")]
    Stations,
    /// Modes that move along different lines.
    #[error(
        "mode {mode} of the base moves along another line than the first; put the modes of each direction into a file of \
             their own"
    )]
    Directions {
        /// Number of the mode, from 1.
        mode: usize,
    },
    /// A blank that is none.
    #[error("{reason}; write for example --blank \"steel d=16 mm L=40 mm\" --second \"25 mm\"")]
    Blank {
        /// What is wrong.
        reason: String,
    },
    /// Taps without the tip of the blank.
    #[error("the taps lack the response of the tip under a force at the tip, `11.` or `xx.` in the table")]
    NoTip,
    /// Taps of one point alone.
    #[error(
        "the taps lack the second point of the blank, `21.` in the table: a hammer measures no rotation, and one point does not \
         tell how the spindle turns; measure the response at the second point under the force at the tip, and better its own too"
    )]
    NoSecond,
    /// Taps under an exponential window.
    #[error(
        "the hits on the blank had not died away within their frames, so that the responses are those under an exponential window; \
         wait longer between the hits"
    )]
    Windowed,
    /// A measured assembly that has no lines of the predicted one.
    #[error(
        "the measured assembly has {lines} clear lines in common with what is predicted, at least 20 are needed; measure it over \
         the lines of the blank, or within --range"
    )]
    NoCommonLines {
        /// Lines in common.
        lines: usize,
    },
    /// No line in the range.
    #[error("no line of the taps lies between {from} and {to} Hz; give another --range")]
    NoLines {
        /// First frequency (Hz).
        from: f64,
        /// Last frequency (Hz).
        to: f64,
    },
    /// A receptance that is infinite.
    #[error("the receptance of the tool is infinite at {frequency} Hz; give a segment a loss factor")]
    Infinite {
        /// The frequency (Hz).
        frequency: f64,
    },
}
