//! Units at the boundary: `"60 m/min"` to SI and back.
//!
//! Dimensions are the SI base plus revolution and currency. A revolution is a dimension of its
//! own so that `500 rev/min`, `rpm` and `rad/s` convert and a bare `1/min` is refused where a
//! rotation is due; only "per revolution" may be left out or written (`0.12 mm/rev` is a length).

use std::fmt;

/// Powers of metre, kilogram, second, kelvin, ampere, mole, revolution, currency.
pub type Dimension = [i8; 8];

/// Index of the revolution in a [`Dimension`].
const REVOLUTION: usize = 6;

/// A unit: `SI value = factor · value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// SI units (and revolutions) in one of this unit.
    pub factor: f64,
    /// SI value of zero, nonzero for degrees Celsius only.
    pub offset: f64,
    /// Dimension.
    pub dimension: Dimension,
}

/// Why a quantity could not be read. `at` counts bytes from the start of the text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnitError {
    /// No number at the start.
    #[error("`{text}` does not start with a number; write for example \"{example}\"")]
    NotANumber {
        /// What was read.
        text: String,
        /// A quantity of the wanted kind.
        example: String,
    },
    /// A decimal comma.
    #[error("`{text}` has a decimal comma; write {fix}")]
    DecimalComma {
        /// What was read.
        text: String,
        /// The number with a point.
        fix: String,
    },
    /// A number without its unit.
    #[error("`{text}` has no unit; accepted: {accepted}")]
    MissingUnit {
        /// What was read.
        text: String,
        /// Units that fit.
        accepted: String,
    },
    /// A unit that is not known.
    #[error("unknown unit `{unit}`; accepted: {accepted}")]
    UnknownUnit {
        /// What was read.
        unit: String,
        /// Where it starts.
        at: usize,
        /// Units that fit.
        accepted: String,
    },
    /// A unit of another dimension.
    #[error("{}", wrong_dimension(unit, expected, accepted))]
    WrongDimension {
        /// What was read.
        unit: String,
        /// Where it starts.
        at: usize,
        /// The SI unit expected.
        expected: &'static str,
        /// Units that fit.
        accepted: String,
    },
}

impl UnitError {
    /// Byte offset of the offending text within the quantity.
    pub fn at(&self) -> usize {
        match self {
            Self::UnknownUnit { at, .. } | Self::WrongDimension { at, .. } => *at,
            Self::NotANumber { .. } | Self::DecimalComma { .. } | Self::MissingUnit { .. } => 0,
        }
    }
}

/// Symbols that take no prefix.
const PLAIN: &[(&str, f64, f64, Dimension)] = &[
    ("1", 1.0, 0.0, [0; 8]),
    ("%", 0.01, 0.0, [0; 8]),
    ("tooth", 1.0, 0.0, [0; 8]),
    ("part", 1.0, 0.0, [0; 8]),
    ("edge", 1.0, 0.0, [0; 8]),
    ("min", 60.0, 0.0, [0, 0, 1, 0, 0, 0, 0, 0]),
    ("h", 3600.0, 0.0, [0, 0, 1, 0, 0, 0, 0, 0]),
    ("day", 86400.0, 0.0, [0, 0, 1, 0, 0, 0, 0, 0]),
    ("week", 7.0 * 86400.0, 0.0, [0, 0, 1, 0, 0, 0, 0, 0]),
    ("year", 365.0 * 86400.0, 0.0, [0, 0, 1, 0, 0, 0, 0, 0]),
    ("in", 0.0254, 0.0, [1, 0, 0, 0, 0, 0, 0, 0]),
    ("ft", 0.3048, 0.0, [1, 0, 0, 0, 0, 0, 0, 0]),
    ("degC", 1.0, 273.15, [0, 0, 0, 1, 0, 0, 0, 0]),
    ("rev", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 1, 0]),
    ("rpm", 1.0 / 60.0, 0.0, [0, 0, -1, 0, 0, 0, 1, 0]),
    ("rad", 1.0 / std::f64::consts::TAU, 0.0, [0, 0, 0, 0, 0, 0, 1, 0]),
    ("deg", 1.0 / 360.0, 0.0, [0, 0, 0, 0, 0, 0, 1, 0]),
    ("EUR", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
    ("USD", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
    ("GBP", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
    ("CHF", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
    ("JPY", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
    ("CNY", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
    ("INR", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
    ("RUB", 1.0, 0.0, [0, 0, 0, 0, 0, 0, 0, 1]),
];

/// Symbols that take an SI prefix.
const PREFIXED: &[(&str, f64, Dimension)] = &[
    ("m", 1.0, [1, 0, 0, 0, 0, 0, 0, 0]),
    ("g", 1e-3, [0, 1, 0, 0, 0, 0, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0, 0, 0, 0, 0]),
    ("K", 1.0, [0, 0, 0, 1, 0, 0, 0, 0]),
    ("A", 1.0, [0, 0, 0, 0, 1, 0, 0, 0]),
    ("mol", 1.0, [0, 0, 0, 0, 0, 1, 0, 0]),
    ("Hz", 1.0, [0, 0, -1, 0, 0, 0, 0, 0]),
    ("N", 1.0, [1, 1, -2, 0, 0, 0, 0, 0]),
    ("Pa", 1.0, [-1, 1, -2, 0, 0, 0, 0, 0]),
    ("J", 1.0, [2, 1, -2, 0, 0, 0, 0, 0]),
    ("W", 1.0, [2, 1, -3, 0, 0, 0, 0, 0]),
    ("V", 1.0, [2, 1, -3, 0, -1, 0, 0, 0]),
    ("l", 1e-3, [3, 0, 0, 0, 0, 0, 0, 0]),
];

const PREFIX: &[(&str, f64)] =
    &[("n", 1e-9), ("u", 1e-6), ("m", 1e-3), ("c", 1e-2), ("d", 1e-1), ("h", 1e2), ("k", 1e3), ("M", 1e6), ("G", 1e9)];

/// Units offered in error messages, those of the wanted dimension being picked.
const OFFERED: &[&str] = &[
    "m/min", "m/s", "mm/min", "ft/min", "mm/rev", "um/rev", "mm", "um", "m", "in", "min", "s", "h", "day", "week", "N",
    "kN", "MPa", "GPa", "kW", "W", "kW h", "J", "rpm", "rad/s", "K", "degC", "mV", "N/um", "N/mm", "N/m", "deg", "rad",
    "um/m", "um/min", "mm3/mm", "1/h", "1/min", "1/km", "EUR", "EUR/h", "%", "1", "m/min2", "m/s2", "Hz", "W/m K",
    "kg/m3", "J/kg K", "kJ/mol", "mV/K", "J/mm3", "g", "kg",
];

fn symbol(text: &str) -> Option<(f64, f64, Dimension)> {
    if let Some((_, factor, offset, dimension)) = PLAIN.iter().find(|(name, ..)| *name == text) {
        return Some((*factor, *offset, *dimension));
    }
    let text = text.replace(['µ', 'μ'], "u");
    let base = |rest: &str| PREFIXED.iter().find(|(name, ..)| *name == rest);
    if let Some((_, factor, dimension)) = base(&text) {
        return Some((*factor, 0.0, *dimension));
    }
    PREFIX.iter().find_map(|(prefix, scale)| {
        let (_, factor, dimension) = base(text.strip_prefix(prefix)?)?;
        Some((factor * scale, 0.0, *dimension))
    })
}

/// Reads a unit such as `m/min`, `N/um`, `W/m K`, `mm3/mm` or `m/s2`.
///
/// Everything after a slash is a denominator up to the next slash; `·`, `*` and a space
/// multiply; a trailing whole number is a power.
///
/// # Errors
/// The offending symbol and its byte offset.
///
/// ```
/// let unit = toolroom_process::unit::parse("m/min").unwrap();
/// assert!((unit.factor * 60.0 - 1.0).abs() < 1e-15);
/// ```
pub fn parse(text: &str) -> Result<Unit, (String, usize)> {
    let mut unit = Unit { factor: 1.0, offset: 0.0, dimension: [0; 8] };
    let mut start = 0;
    for (part_index, part) in text.split('/').enumerate() {
        let mut offset = start;
        let mut seen = false;
        for token in part.split([' ', '*', '·']) {
            let here = offset;
            offset += token.len() + part[offset - start + token.len()..].chars().next().map_or(0, char::len_utf8);
            if token.is_empty() {
                continue;
            }
            seen = true;
            let unknown = || (token.to_owned(), here);
            let (name, power) = split_power(token).ok_or_else(unknown)?;
            let (factor, zero, dimension) = symbol(name).ok_or_else(unknown)?;
            let power = if part_index == 0 { power } else { -power };
            unit.factor *= factor.powi(i32::from(power));
            for (total, exponent) in unit.dimension.iter_mut().zip(dimension) {
                // Nonsense such as m9 m9 … may not overflow; it fits nothing anyway.
                *total = total.saturating_add(exponent.saturating_mul(power));
            }
            if zero != 0.0 {
                unit.offset = zero;
            }
        }
        if !seen {
            return Err((part.to_owned(), start));
        }
        start += part.len() + 1;
    }
    // An offset makes sense for a temperature alone, not for a rate per degree.
    if unit.dimension != [0, 0, 0, 1, 0, 0, 0, 0] {
        unit.offset = 0.0;
    }
    Ok(unit)
}

/// `s2`, `s^2`, `s²`, `s-1` to a symbol and its power.
fn split_power(token: &str) -> Option<(&str, i8)> {
    if token == "1" {
        return Some((token, 1));
    }
    let token_end =
        token.find(|c: char| c.is_ascii_digit() || matches!(c, '^' | '-' | '²' | '³')).unwrap_or(token.len());
    let (name, power) = token.split_at(token_end);
    let power = match power.trim_start_matches('^') {
        "" => 1,
        "²" => 2,
        "³" => 3,
        digits => digits.parse().ok().filter(|power: &i8| power.abs() <= 9)?,
    };
    (!name.is_empty()).then_some((name, power))
}

/// Whether a value in `from` may be read where `to` is due: the same dimension, "per
/// revolution" being optional.
pub fn compatible(from: Dimension, to: Dimension) -> bool {
    let mut without = from;
    if from[REVOLUTION] == -1 && to[REVOLUTION] == 0 {
        without[REVOLUTION] = 0;
    }
    without == to
}

/// Units that may stand where `si` is due, for messages.
pub fn accepted(si: &str) -> String {
    let Ok(target) = parse(si) else { return si.to_owned() };
    let fits = |name: &&&str| parse(name).is_ok_and(|unit| compatible(unit.dimension, target.dimension));
    let names: Vec<&str> = OFFERED.iter().filter(fits).copied().collect();
    if names.is_empty() { si.to_owned() } else { names.join(", ") }
}

/// That a unit does not fit. A ratio takes none, so that a list of its units would rather confuse.
fn wrong_dimension(unit: &str, expected: &str, accepted: &str) -> String {
    match expected {
        "1" => format!("`{unit}` is a unit, where a number without one is due"),
        _ => format!("`{unit}` is not a unit of {expected}; accepted: {accepted}"),
    }
}

/// Reads a quantity with its unit and returns its value in the unit `si`.
///
/// A ratio (`si` = `1`) may stand without unit.
///
/// # Errors
/// See [`UnitError`]; the offset in the text is [`UnitError::at`].
///
/// ```
/// use toolroom_process::unit::quantity;
/// assert_eq!(quantity("60 m/min", "m/s"), Ok(1.0));
/// assert_eq!(quantity("0.12 mm/rev", "m"), Ok(0.12e-3));
/// assert!(quantity("60", "m/s").unwrap_err().to_string().contains("m/min"));
/// ```
pub fn quantity(text: &str, si: &'static str) -> Result<f64, UnitError> {
    let lead = text.len() - text.trim_start().len();
    let body = text.trim();
    let end = number_end(body);
    let Ok(number) = body[..end].parse::<f64>() else {
        let example = format!("1.5 {}", accepted(si).split(", ").next().unwrap_or(si));
        return Err(UnitError::NotANumber { text: body.to_owned(), example });
    };
    let rest = &body[end..];
    if rest.starts_with(',') {
        // Points before the comma stand between thousands.
        let fix = format!("\"{}{}\"", body[..end].replace('.', ""), rest.replacen(',', ".", 1));
        return Err(UnitError::DecimalComma { text: body.to_owned(), fix });
    }
    let name = rest.trim_start();
    if name.is_empty() {
        return if si == "1" {
            Ok(number)
        } else {
            Err(UnitError::MissingUnit { text: body.to_owned(), accepted: accepted(si) })
        };
    }
    let start = lead + end + (rest.len() - name.len());
    let unit = parse(name).map_err(|(unit, offset)| UnitError::UnknownUnit {
        unit,
        at: start + offset,
        accepted: accepted(si),
    })?;
    let target = parse(si).unwrap_or(Unit { factor: 1.0, offset: 0.0, dimension: [0; 8] });
    if !compatible(unit.dimension, target.dimension) {
        return Err(UnitError::WrongDimension {
            unit: name.to_owned(),
            at: start,
            expected: si,
            accepted: accepted(si),
        });
    }
    Ok(ratio(number * unit.factor + unit.offset, target))
}

/// `value` in the unit `from`, expressed in `to`; NaN where they do not fit.
pub fn convert(value: f64, from: &str, to: &str) -> f64 {
    if from == to {
        return value;
    }
    match (parse(from), parse(to)) {
        (Ok(from), Ok(to)) if compatible(from.dimension, to.dimension) || compatible(to.dimension, from.dimension) => {
            ratio(value * from.factor + from.offset, to)
        }
        _ => f64::NAN,
    }
}

/// SI to a unit. Dividing by the reciprocal keeps `60 m/min` exactly 1 m/s.
fn ratio(si: f64, unit: Unit) -> f64 {
    (si - unit.offset) / unit.factor
}

/// Length of the number at the start of `text`; an exponent needs its digits.
fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut end = 0;
    while end < bytes.len() {
        match bytes[end] {
            b'0'..=b'9' | b'.' | b'_' => {}
            b'+' | b'-' if end == 0 || matches!(bytes[end - 1], b'e' | b'E') => {}
            b'e' | b'E' if end > 0 && exponent_follows(&bytes[end + 1..]) => {}
            _ => break,
        }
        end += 1;
    }
    end
}

fn exponent_follows(rest: &[u8]) -> bool {
    match rest {
        [b'+' | b'-', digit, ..] => digit.is_ascii_digit(),
        [digit, ..] => digit.is_ascii_digit(),
        [] => false,
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "×{} +{} {:?}", self.factor, self.offset, self.dimension)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn reads_the_units_of_the_trade() {
        let cases = [
            ("40 m/min", "m/s", 40.0 / 60.0),
            ("0.12 mm/rev", "m", 0.12e-3),
            ("0.12 mm", "m", 0.12e-3),
            ("292 rpm", "rad/s", 292.0 / 60.0 * std::f64::consts::TAU),
            ("292 rev/min", "rad/s", 292.0 / 60.0 * std::f64::consts::TAU),
            ("0.1 mm/tooth", "m", 0.1e-3),
            ("38.4 N/um", "N/m", 38.4e6),
            ("38.4 N/µm", "N/m", 38.4e6),
            ("20 degC", "K", 293.15),
            ("42 W/m K", "W/m K", 42.0),
            ("20 m/min2", "m/s2", 20.0 / 3600.0),
            ("1500 mm3/mm", "m2", 1.5e-3),
            ("60 EUR/h", "EUR/s", 60.0 / 3600.0),
            ("5 %", "1", 0.05),
            ("1e3 N", "N", 1e3),
            ("-2.5e-3 mm", "m", -2.5e-6),
            ("45 deg", "rad", std::f64::consts::FRAC_PI_4),
        ];
        for (text, si, expected) in cases {
            let value = quantity(text, si).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert!((value / expected - 1.0).abs() < 1e-14, "{text} gave {value}, not {expected}");
        }
    }

    #[test]
    fn refuses_what_does_not_fit() {
        assert!(matches!(quantity("60", "m/s"), Err(UnitError::MissingUnit { .. })));
        assert!(matches!(quantity("60 m", "m/s"), Err(UnitError::WrongDimension { at: 3, .. })));
        assert!(matches!(quantity("500 1/min", "rad/s"), Err(UnitError::WrongDimension { .. })));
        assert!(matches!(quantity("60 m/mn", "m/s"), Err(UnitError::UnknownUnit { at: 5, .. })));
        assert!(matches!(quantity("0,12 mm", "m"), Err(UnitError::DecimalComma { .. })));
        let Err(UnitError::DecimalComma { fix, .. }) = quantity("1.062,5 mm", "m") else { panic!("a decimal comma") };
        assert_eq!(fix, "\"1062.5 mm\"");
        assert!(matches!(quantity("fast", "m/s"), Err(UnitError::NotANumber { .. })));
        assert!(matches!(quantity("5 m//s", "m/s"), Err(UnitError::UnknownUnit { .. })));
    }

    proptest! {
        #[test]
        fn any_text_is_answered_without_panic(text in "\\PC{0,24}") {
            let _ = quantity(&text, "m/s");
            let _ = parse(&text);
        }

        #[test]
        fn conversion_round_trips(value in -1e6..1e6f64) {
            for (si, display) in [("m/s", "m/min"), ("K", "degC"), ("rad/s", "rpm"), ("N/m", "N/um")] {
                let back = convert(convert(value, si, display), display, si);
                prop_assert!((back - value).abs() <= 1e-9 * (1.0 + value.abs()));
            }
        }
    }
}
