//! What lies beyond half of the sampling rate and stands folded in a record whose recorder has no filter.
//!
//! A line at f beyond half of the rate r stands at `|f − r round(f/r)|` (sampling theorem). Harmonics of the teeth there are where the
//! speed says and tell that there is no filter; a line of chatter is not told from one at `r − f`, which a filter or the modes of
//! the structure decide.

use crate::comb::{BAND, Comb, WholeSpectrum};
use crate::line::{Line, Origin};

/// Harmonics of the teeth beyond half of the sampling rate that tell of a missing filter (assumption: the sound of a cut fades).
const TELLING: u32 = 6;
/// Those among which a folded line is looked for once it is known that there is no filter (assumption).
const EXPLAINED: u32 = 24;
/// Least number of them that have to stand out (assumption: one may be chance).
const LEAST: usize = 2;
/// Amplitude of a folded harmonic over the last ones that are not folded up to which it is one (assumption: harmonics fade).
const FADED: f64 = 2.0;
/// Accuracy of the speed by the comb of its harmonics, relative (assumption; lines of a speed that wanders more are wider).
const ACCURACY: f64 = 2e-4;
/// Relative distance from a natural frequency within which chatter lies (assumption).
const NEAR_MODE: f64 = 0.1;
/// Part of half of the sampling rate in which a filter leaves the floor as it is (assumption).
const PASSED: [f64; 2] = [0.7, 0.85];
/// Part of it in which a filter has taken the floor away (assumption).
const STOPPED: [f64; 2] = [0.98, 1.0];
/// Floor of the second part over that of the first up to which there is a filter (assumption: 10 dB).
const LEFT: f64 = 0.316;

/// Where a frequency (Hz) stands in a record of so many samples a second.
fn place(frequency: f64, rate: f64) -> f64 {
    (frequency - rate * (frequency / rate).round()).abs()
}

/// Tells folded harmonics of the teeth from chatter. Says whether enough of them stand out to know that the recorder has no filter.
pub(crate) fn teeth(lines: &mut [Line], whole: &WholeSpectrum, comb: &Comb, rate: f64) -> bool {
    let tooth = comb.spindle_frequency * f64::from(comb.teeth);
    let last = (0.5 * rate / tooth).floor() as u32;
    let harmonic = |order: u32| f64::from(order) * tooth;
    let reach = |order: u32| whole.width() + ACCURACY * harmonic(order);
    let within = |order: &u32| harmonic(*order) < 0.5 * BAND * rate;
    let unfolded = (last.saturating_sub(2)..=last).filter(|order| *order > 0).filter(within);
    let loudest = unfolded.map(|order| whole.at(harmonic(order), reach(order))).fold(0.0, f64::max);
    let floor = whole.floor(4.0 * comb.spindle_frequency);
    // A place on the comb tells nothing, and a filter may begin at the end of the band.
    let of_its_own = |order: &u32| {
        let (at, spindle) = (place(harmonic(*order), rate), comb.spindle_frequency);
        at > spindle && at < 0.5 * BAND * rate && (at - (at / spindle).round() * spindle).abs() > 2.0 * reach(*order)
    };
    let telling: Vec<u32> = (last + 1..=last + TELLING).filter(of_its_own).collect();
    let stands = |order: &&u32| {
        let amplitude = whole.clear(&floor, place(harmonic(**order), rate), reach(**order));
        amplitude.is_some_and(|amplitude| amplitude < FADED * loudest)
    };
    let standing = telling.iter().filter(stands).count();
    if standing < LEAST || 2 * standing < telling.len() {
        return false;
    }
    for line in lines.iter_mut().filter(|line| line.origin == Origin::Unknown && line.amplitude < FADED * loudest) {
        let at = whole.refined(line.frequency, 2.0 * whole.width());
        let near = |order: &u32| (at - place(harmonic(*order), rate)).abs() < reach(*order);
        if let Some(order) = (last + 1..=last + EXPLAINED).find(near) {
            line.origin = Origin::Folded(order);
        }
    }
    true
}

/// Whether lines of chatter stand at both the places that a record without a filter has for those of the chatter line `frequency` (Hz):
/// whole tooth frequencies from it, and from the sampling rate less it.
pub(crate) fn on_both_sides(lines: &[Line], whole: &WholeSpectrum, comb: &Comb, frequency: f64, rate: f64) -> bool {
    let tooth = comb.spindle_frequency * f64::from(comb.teeth);
    let from = |line: f64, other: f64| {
        let apart = |sign: f64| (sign * line - other) / tooth;
        [1.0, -1.0].into_iter().map(apart).map(|m| (m - m.round()).abs() * tooth).fold(f64::INFINITY, f64::min)
    };
    let reach = 2.0 * whole.width() + ACCURACY * rate;
    let unknown = lines.iter().filter(|line| line.origin == Origin::Unknown);
    let places = unknown.map(|line| whole.refined(line.frequency, 2.0 * whole.width()));
    let folded = |at: &f64| from(*at, frequency) > 2.0 * reach && from(*at, rate - frequency) < reach;
    places.filter(folded).count() >= LEAST
}

/// Whether the floor falls at half of the sampling rate as behind a filter.
pub(crate) fn is_filtered(whole: &WholeSpectrum) -> bool {
    whole.median(STOPPED) < LEFT * whole.median(PASSED)
}

/// Where chatter is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Place {
    /// At one frequency (Hz).
    At(f64),
    /// At one frequency (Hz), or at others where the recorder has no filter, of which nothing speaks.
    Told(f64, Vec<f64>),
    /// At one of these frequencies (Hz).
    OneOf(Vec<f64>),
}

/// Where the chatter is whose line stands at `frequency` (Hz) in a record of `rate` samples a second, up to `highest` (Hz) at most.
/// `unfiltered` says that the recorder has no filter.
pub(crate) fn unfolded(frequency: f64, rate: f64, highest: f64, unfiltered: bool, modes: &[f64]) -> Place {
    let folds = (1..).map(f64::from).flat_map(|fold| [fold * rate - frequency, fold * rate + frequency]);
    let others: Vec<f64> = folds.take_while(|other| *other < highest).collect();
    if others.is_empty() {
        return Place::At(frequency);
    }
    let near = |place: f64| modes.iter().any(|mode| (place / mode - 1.0).abs() < NEAR_MODE);
    let all = || [frequency].into_iter().chain(others.clone());
    let mut near_modes = all().filter(|place| near(*place));
    match (near_modes.next(), near_modes.next()) {
        // A mode decides, where a filter does not speak against it.
        (Some(one), None) if unfiltered || one == frequency => Place::At(one),
        (None, _) if !unfiltered => Place::Told(frequency, others),
        (None | Some(_), _) => Place::OneOf(all().collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_or_nothing_decides_between_the_places_of_a_folded_line() {
        let place = |unfiltered, modes: &[f64]| unfolded(900.0, 4000.0, 4000.0, unfiltered, modes);
        assert_eq!(place(false, &[]), Place::Told(900.0, vec![3100.0]));
        assert_eq!(place(true, &[]), Place::OneOf(vec![900.0, 3100.0]));
        assert_eq!(place(false, &[880.0]), Place::At(900.0));
        assert_eq!(place(true, &[880.0]), Place::At(900.0));
        assert_eq!(place(true, &[3000.0]), Place::At(3100.0));
        // Nothing says that there is no filter: the mode speaks against the line as it stands, and no more.
        assert_eq!(place(false, &[3000.0]), Place::OneOf(vec![900.0, 3100.0]));
        assert_eq!(place(true, &[880.0, 3000.0]), Place::OneOf(vec![900.0, 3100.0]));
        assert_eq!(unfolded(900.0, 16_000.0, 4000.0, false, &[]), Place::At(900.0));
    }
}
