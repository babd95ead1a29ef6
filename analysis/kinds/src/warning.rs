//! What is admitted and yet rarely meant: warnings beside a verdict.

use toolroom_form::Echo;
use toolroom_planning::coefficients::USUAL_FEED_PER_TOOTH;
use toolroom_process::unit;

/// A warning of `check`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// For `toolroom explain`.
    pub code: &'static str,
    /// What is strange.
    pub message: String,
}

/// Values within which shops work, by key: SI unit, unit in which people are told, least and greatest in that unit.
///
/// # Source
/// Assumption: what tables of tool makers for turning and milling span, widened by a factor of about two. A value outside is
/// no fault; the usual cause is a slip of the unit.
const USUAL: [(&str, &str, &str, f64, f64); 12] = [
    ("feed_per_rev", "m", "mm", 0.01, 1.0),
    ("feed_per_tooth", "m", "mm", USUAL_FEED_PER_TOOTH[0], USUAL_FEED_PER_TOOTH[1]),
    ("depth_of_cut", "m", "mm", 0.02, 20.0),
    ("cutting_speed", "m/s", "m/min", 3.0, 2000.0),
    ("diameter", "m", "mm", 0.5, 3000.0),
    ("length", "m", "mm", 0.5, 10_000.0),
    ("limit", "m", "mm", 0.02, 1.5),
    ("wear_limit", "m", "mm", 0.02, 1.5),
    ("size_tolerance", "m", "um", 1.0, 2000.0),
    ("tool_change_time", "s", "s", 1.0, 7200.0),
    ("load_time", "s", "s", 0.5, 7200.0),
    ("unload_time", "s", "s", 0.5, 7200.0),
];

/// The values of a file that are admitted and unusual.
pub(crate) fn unusual(echo: &[Echo]) -> Vec<Warning> {
    let strange = |value: &Echo| {
        let (key, si, shown, least, most) = *USUAL.iter().find(|(key, ..)| *key == value.key)?;
        // What is a word, a list or a table of its own is not judged; nought switches things off.
        let number = unit::convert(unit::quantity(&value.value, si).ok().filter(|number| *number != 0.0)?, si, shown);
        if value.default || (least..=most).contains(&number) {
            return None;
        }
        let place = if value.section.is_empty() { String::new() } else { format!(" of {}", value.section) };
        let message = format!("{key}{place} is {}; shops have {least} to {most} {shown}", value.value);
        Some(Warning { code: "unusual", message })
    };
    echo.iter().filter_map(strange).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(key: &str, value: &str, default: bool) -> Echo {
        Echo { section: "operation turn".to_owned(), key: key.to_owned(), value: value.to_owned(), span: 0..0, default }
    }

    #[test]
    fn a_slip_of_the_unit_is_told_and_what_shops_do_is_not() {
        let told = unusual(&[
            value("feed_per_rev", "1.2 mm/rev", false),
            value("diameter", "0.12 mm", false),
            value("diameter", "120 mm", false),
            value("unload_time", "0 s", false),
            value("load_time", "triangular", false),
            value("tool_change_time", "3 h", true),
        ]);
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told[0].message.starts_with("feed_per_rev of operation turn is 1.2 mm/rev"), "{told:?}");
    }
}
