//! How far records of chatter are to be believed.

/// Probability that a record of whether a cut chattered is wrong (assumption).
pub const WRONG_CHATTER_RECORD: f64 = 0.05;

/// Relative standard deviation of an observed chatter frequency about that of the limit (assumption: beyond the limit the
/// frequency moves by about as much). It is common to all cuts of a machine at one speed.
pub const CHATTER_FREQUENCY_DEVIATION: f64 = 0.01;
