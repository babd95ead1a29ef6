//! Constants by which records are believed, each with unit and reason.

/// Residuals beyond this many standard deviations lose weight (1). Source: Huber 1981, near the customary 2.5.
pub const HUBER: f64 = 2.5;
/// Consistency of the median absolute deviation with a normal standard deviation (1). Derivation: 1/Φ⁻¹(3/4).
pub const MAD: f64 = 1.4826;
/// Force over chip cross-section that materials have, Pa. Assumption: from soft aluminium in thick chips to
/// hardened steel in thin ones, with room.
pub(crate) const SPECIFIC_FORCE: [f64; 2] = [2e8, 2e10];
/// Feed and passive force over chip cross-section, Pa. Assumption: [`SPECIFIC_FORCE`] with room for worn
/// edges, which press several times harder.
pub(crate) const SPECIFIC_PRESS: [f64; 2] = [3e7, 6e10];
/// Power over force times speed (1). Assumption: efficiency and losses, with room.
pub(crate) const POWER: [f64; 2] = [0.25, 4.0];
/// Group median over the median of all beyond which a group may have been logged in another unit (1).
/// Assumption: no cause changes a group by so much.
pub(crate) const ODD: f64 = 8.0;
/// Nearness of the ratio of a group to a slip of units, in its logarithm (1). Assumption: groups differ by
/// half for other reasons.
pub(crate) const ODD_NEAR: f64 = 0.4;
/// Ratio of measurement to nominal model from which no effect of the catalogue is likely (1). Assumption.
pub(crate) const IMPOSSIBLE: f64 = 2.5;
/// Handling and stops over the time in cut, by which a cycle time may be longer (1). Assumption.
pub(crate) const HANDLING: f64 = 4.0;
/// Nearness of a channel's ratio to a slip of units, in its logarithm (1). Assumption: calibration and effects
/// move a channel by a third.
pub(crate) const NEAR: f64 = 0.3;
/// Land beyond which an edge counts as broken, m. Source: ISO 3685, the end of a life where wear is irregular.
pub(crate) const BROKEN: f64 = 0.6e-3;
/// Growth of the land from one operation to the next of an edge that breaks, m. Assumption: steady wear grows
/// by far less.
pub(crate) const BREAKING: f64 = 0.15e-3;
/// Change of the time in cut, as a share, at the greatest feed override. Source: controls go up to 200 %.
pub(crate) const FASTEST: f64 = -0.5;
/// Share of a time of people that may be saved where time may be added (1). Assumption: nobody loads in less than half of the time
/// that is planned for it.
pub(crate) const SAVED: f64 = 0.5;
/// Ordinary change of the time in cut by an override that nobody records, as a share. Assumption: an operator who turns the feed
/// down turns it down by ten per cent.
pub(crate) const OVERRIDDEN: f64 = 0.1;
