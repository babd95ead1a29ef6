//! The codes of refused fits, with their longer texts.

use super::Refusal;

type Code = (&'static str, &'static str);

const LOW_COHERENCE: Code = (
    "low-coherence",
    "The coherence says which share of the motion the hammer has caused. Below 0.7 at the mode that limits the cut, noise or rattling is a large part of the measured response, and a limit of stable depth computed from it would be one of the noise. Tap harder or with a harder tip, look for loose parts, average more taps.",
);
const EDGE_OF_RANGE: Code = (
    "edge-of-range",
    "A resonance lies at an end of the measured range or beyond it: only one flank of its peak is there, so that frequency and damping cannot be told. Measure a wider range of frequencies. Swapped columns of real and imaginary parts show as such resonances, too.",
);
const SENSOR_SIGN: Code = (
    "sensor-sign",
    "The imaginary part of a response at the place of the hammer is negative at every peak, because a structure does no work on the hammer. Where it is positive, a sensor or an axis is turned around, or the table has the conjugated response. Turn the sensor or its axis, and measure again.",
);
const COARSE_FREQUENCY: Code = (
    "coarse-frequency",
    "Damping is read off the width of a peak. With fewer than five lines in the half-power band of the mode that width is not resolved. Record for longer, so that the lines are closer.",
);
const WINDOW_DAMPING: Code = (
    "window-damping",
    "An exponential window adds a known damping, which is taken off again. Where nearly all damping of a mode is that of the window, its own is a small difference of two large numbers. Record for longer after every hit, so that a weaker window does.",
);
const POOR_FIT: Code = (
    "poor-fit",
    "The fitted modes leave more than 15 % of the measured response. Either there are more modes than were picked, or the structure is not linear (a joint that rattles, a bearing with play), or the record is noisy. Look at the picture, and name the modes with --modes or --pick.",
);

/// Every code of a refused fit with its explanation.
pub const REFUSAL_CODES: &[Code] =
    &[LOW_COHERENCE, EDGE_OF_RANGE, SENSOR_SIGN, COARSE_FREQUENCY, WINDOW_DAMPING, POOR_FIT];

/// The code of a refusal with its explanation.
pub(super) fn of(refusal: &Refusal) -> Code {
    match refusal {
        Refusal::LowCoherence { .. } => LOW_COHERENCE,
        Refusal::EdgeOfRange { .. } => EDGE_OF_RANGE,
        Refusal::SensorSign { .. } => SENSOR_SIGN,
        Refusal::CoarseFrequency { .. } => COARSE_FREQUENCY,
        Refusal::WindowDamping { .. } => WINDOW_DAMPING,
        Refusal::PoorFit { .. } => POOR_FIT,
    }
}
