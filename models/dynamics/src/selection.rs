//! Modes that a user asks for, against what a measurement can tell.

/// Greatest number of modes that may be asked for (assumption: a tap test of a cutting tool shows a dozen at most, and each more
/// is a fit of its own).
const MOST_WANTED: usize = 20;
/// Relative distance from a picked frequency within which a fitted mode is the one that was meant (assumption).
const NEAR: f64 = 0.05;

/// Why the modes that were asked for are not fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SelectionProblem {
    /// A picked frequency outside of the measured range.
    #[error(
        "a mode is picked at {pick} Hz, outside of the measured range of {first} to {last} Hz; pick a resonance within it, or measure \
         a wider range"
    )]
    Outside {
        /// The picked frequency (Hz).
        pick: f64,
        /// First frequency of the measurement (Hz).
        first: f64,
        /// Last frequency of the measurement (Hz).
        last: f64,
    },
    /// Two picks that the measurement cannot tell apart.
    #[error(
        "modes are picked at {one} Hz and at {other} Hz, nearer to each other than two lines of the measurement; pick one of them, \
         or measure with finer lines"
    )]
    Together {
        /// The lower frequency (Hz).
        one: f64,
        /// The higher frequency (Hz).
        other: f64,
    },
    /// More modes than can be asked for.
    #[error(
        "{wanted} modes are asked for; ask for {most} at most, or leave the number out: then all that stand out are taken"
    )]
    TooMany {
        /// Modes that were asked for.
        wanted: usize,
        /// Modes that may be.
        most: usize,
    },
    /// More modes than can be fitted.
    #[error(
        "{wanted} modes are asked for, and the fit found {told}; those that stand out of this measurement are at {standing_out}: \
         ask for as many, or leave the number out"
    )]
    Fewer {
        /// Modes that were asked for.
        wanted: usize,
        /// Modes that could be fitted.
        told: usize,
        /// Frequencies of the modes that are found without being asked for, in words.
        standing_out: String,
    },
    /// A picked frequency without a mode.
    #[error(
        "a mode is picked at {pick} Hz, and the fit finds none within {within} % of it; those that stand out of this measurement are at \
         {standing_out}: pick one of them, or leave the picks out"
    )]
    Missed {
        /// The picked frequency (Hz).
        pick: f64,
        /// Greatest distance of a mode from it (%).
        within: f64,
        /// Frequencies of the modes that are found without being asked for, in words.
        standing_out: String,
    },
}

/// Whether the modes that are asked for can be looked for on the lines `frequencies` (Hz, ascending, two at least).
pub(crate) fn check(frequencies: &[f64], modes: Option<usize>, picks: &[f64]) -> Result<(), SelectionProblem> {
    let wanted = modes.unwrap_or(0).max(picks.len());
    if wanted > MOST_WANTED {
        return Err(SelectionProblem::TooMany { wanted, most: MOST_WANTED });
    }
    let (first, last) = (frequencies[0], frequencies[frequencies.len() - 1]);
    if let Some(pick) = picks.iter().find(|pick| !(first..=last).contains(*pick)) {
        return Err(SelectionProblem::Outside { pick: *pick, first, last });
    }
    let mut sorted = picks.to_vec();
    sorted.sort_by(f64::total_cmp);
    let apart = 2.0 * (last - first) / (frequencies.len() - 1) as f64;
    match sorted.windows(2).find(|pair| pair[1] - pair[0] < apart) {
        Some(pair) => Err(SelectionProblem::Together { one: pair[0], other: pair[1] }),
        None => Ok(()),
    }
}

/// Why modes of the natural frequencies `found` (Hz) are not those that were asked for; none where they are. `standing_out` tells the
/// frequencies (Hz) of the modes that are found without being asked for.
pub(crate) fn unmet(
    found: &[f64],
    modes: Option<usize>,
    picks: &[f64],
    standing_out: impl FnOnce() -> Vec<f64>,
) -> Option<SelectionProblem> {
    let near = |pick: &f64| found.iter().any(|frequency| (frequency / pick - 1.0).abs() <= NEAR);
    let missed = picks.iter().find(|pick| !near(pick));
    let wanted = modes.unwrap_or(0).max(picks.len());
    if missed.is_none() && found.len() >= wanted {
        return None;
    }
    let standing_out =
        standing_out().iter().map(|frequency| format!("{frequency:.1} Hz")).collect::<Vec<_>>().join(", ");
    let standing_out = if standing_out.is_empty() { "none".to_owned() } else { standing_out };
    Some(match missed {
        Some(pick) => SelectionProblem::Missed { pick: *pick, within: 100.0 * NEAR, standing_out },
        None => SelectionProblem::Fewer { wanted, told: found.len(), standing_out },
    })
}
