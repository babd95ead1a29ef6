//! Codes that are refused, and why.

use super::ProgramFault;

/// Refuses M codes whose time is not known to be none of the program's.
///
/// Passed over are those of program, spindle, coolant, tool, overrides and rigid tapping. What the spindle takes to
/// run up and an operator to answer is no time of the program.
pub(super) fn auxiliary(code: u32) -> Result<(), ProgramFault> {
    let reason = match code {
        0..=9 | 13 | 14 | 19 | 29 | 30 | 48 | 49 => return Ok(()),
        17 | 96..=99 => "subprograms are not followed; write them out",
        _ => "the builder of the machine knows what it does and takes; take it out where it takes no time",
    };
    Err(ProgramFault::Unsupported { word: format!("M{code}"), reason })
}

/// The refusal of a G code with tenths.
pub(super) fn unsupported(code: u32, reason: &'static str) -> ProgramFault {
    let (word, tenth) = (code / 10, code % 10);
    let word = if tenth == 0 { format!("G{word}") } else { format!("G{word}.{tenth}") };
    ProgramFault::Unsupported { word, reason }
}

/// Why a G code that is on no list is refused.
pub(super) fn refusal(code: u32) -> &'static str {
    match code {
        50 | 61..=63 => "a spline or a mode of high speed, by control; write the motions out",
        120 | 130 | 700..=729 => "a cycle of one make of control; write its motions out",
        310 | 320..=330 | 340..=380 => "its way depends on the spindle or the work piece",
        410 | 420 | 411 | 421 => {
            "it shifts the path by a radius that only the control knows; program the path of the centre with G40"
        }
        650..=670 => "macros are not followed; write them out",
        680..=682 | 511 | 510 | 160 | 161 => "rotated, scaled, mirrored and polar coordinates are not followed",
        740 | 760 | 870 | 880 => "its time depends on the operator or the machine; write its motions out",
        901 => "centres of arcs by coordinates are not followed; write them as steps from the start with G91.1",
        930 => "feed by inverse time is not followed; write feeds a minute with G94",
        960 => "the speed of the spindle, and with it a feed a revolution, follows the diameter of a lathe",
        _ => "it is not understood and might move axes or take time; take it out where it does neither",
    }
}
