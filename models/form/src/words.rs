//! Values, kinds and fixes in words.

use crate::form::{Kind, Quantity};
use crate::section::Value;
use toml::de::DeValue;
use toolroom_process::unit::{self, UnitError};

/// A value in words, in the display unit of its key; `None` for sections, which speak themselves.
pub(crate) fn understood(kind: &Kind, value: &Value<'_>) -> Option<String> {
    Some(match (kind, value) {
        (Kind::Quantity(quantity), Value::Si(si)) => display(quantity, *si),
        (_, Value::Count(count)) => count.to_string(),
        (_, Value::Text(text)) => text.clone(),
        (_, Value::Flag(flag)) => flag.to_string(),
        (Kind::Amount, Value::Raw(DeValue::String(text))) => text.to_string(),
        (Kind::Amount, Value::Raw(DeValue::Integer(number))) => number.to_string(),
        (Kind::Amount, Value::Raw(DeValue::Float(number))) => number.to_string(),
        (Kind::Shorthand { word, .. } | Kind::Fields { word, .. }, value) => return understood(word, value),
        (Kind::Dated(other) | Kind::Or { other, .. }, value) => return understood(other, value),
        (Kind::List(item), Value::List(list)) => {
            list.iter().filter_map(|got| understood(item, &got.value)).collect::<Vec<_>>().join(", ")
        }
        _ => return None,
    })
}

/// An SI value in a quantity's display unit; times in the unit that suits their length.
pub fn display(quantity: &Quantity, si: f64) -> String {
    let unit = match quantity.unit {
        "s" if si.abs() < 60.0 => "s",
        "s" if si.abs() < 7200.0 => "min",
        "s" => "h",
        _ => quantity.display,
    };
    let number = significant(unit::convert(si, quantity.unit, unit));
    if unit == "1" { number } else { format!("{number} {unit}") }
}

/// Six significant digits without trailing zeros.
///
/// ```
/// assert_eq!(toolroom_form::significant(0.12e-3 * 1e3), "0.12");
/// ```
pub fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let scientific = format!("{value:.5e}");
    let rounded: f64 = scientific.parse().unwrap_or(value);
    if (1e-4..1e9).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

pub(crate) fn range(quantity: &Quantity) -> String {
    let shown = |si| display(quantity, si);
    if quantity.above && quantity.min == 0.0 {
        format!("the range above 0 up to {}", shown(quantity.max))
    } else {
        format!("{} to {}", shown(quantity.min), shown(quantity.max))
    }
}

/// The digits of a number with or without a unit; `None` without any.
fn digits(number: &str) -> Option<&str> {
    number.trim().trim_end_matches(|c: char| !c.is_ascii_digit()).split_whitespace().next()
}

/// The same number in units in which it would be in range. Of a ratio only a share, which may be anything from nothing to a whole,
/// may have been meant in per cent: an exponent of 200 was not meant as 200 %, and nobody states a share in micrometres a metre.
pub(crate) fn meant(quantity: &Quantity, number: &str) -> Vec<String> {
    let Some(digits) = digits(number) else { return Vec::new() };
    let units = match quantity.unit {
        "1" if quantity.display == "1" && quantity.min == 0.0 && quantity.max <= 1.0 => "%".to_owned(),
        "1" => quantity.display.to_owned(),
        unit => unit::accepted(unit),
    };
    units
        .split(", ")
        .map(|unit| format!("{digits} {unit}"))
        .filter(|text| unit::quantity(text, quantity.unit).is_ok_and(|value| quantity.admits(value)))
        .take(2)
        .map(|text| quoted(&text))
        .collect()
}

/// A value that would do in place of one that could not be read.
#[expect(clippy::wildcard_enum_match_arm, reason = "whatever else is wrong, an example of the key would do")]
pub(crate) fn fix(quantity: &Quantity, number: &str, reason: &UnitError) -> String {
    match reason {
        UnitError::DecimalComma { fix, .. } => fix.clone(),
        UnitError::MissingUnit { .. } => {
            let text = format!("{} {}", number.trim(), quantity.display);
            let good = unit::quantity(&text, quantity.unit).is_ok_and(|value| quantity.admits(value));
            quoted(if good { &text } else { quantity.example })
        }
        // A ratio stands without a unit.
        _ if quantity.example.is_empty() && quantity.display == "1" => digits(number)
            .filter(|digits| digits.parse().is_ok_and(|value| quantity.admits(value)))
            .map_or_else(|| significant(quantity.min.max(quantity.max.min(1.0))), str::to_owned),
        _ if quantity.example.is_empty() => quoted(&format!("… {}", quantity.display)),
        _ => quoted(quantity.example),
    }
}

pub(crate) fn quoted(text: &str) -> String {
    format!("\"{text}\"")
}

/// What a key takes, in words.
pub(crate) fn expected(kind: &Kind) -> String {
    match kind {
        Kind::Name | Kind::Text => "text in quotes".to_owned(),
        Kind::Quantity(quantity) if quantity.unit == "1" => "a number".to_owned(),
        Kind::Quantity(quantity) => format!("a number with its unit in quotes ({})", unit::accepted(quantity.unit)),
        Kind::Count { .. } => "a whole number".to_owned(),
        Kind::Flag => "true or false".to_owned(),
        Kind::Choice(choices) => format!("one of {}", choices.join(", ")),
        Kind::Or { words, other } => format!("{}, or {}", words.join(", "), expected(other)),
        Kind::Dated(other) => format!("a date, or {}", expected(other)),
        Kind::Reference(kind) => format!("the name of a {kind} in quotes"),
        Kind::List(_) => "a list in brackets".to_owned(),
        Kind::Table(form) => format!("a section {}", form.title),
        Kind::Tables(form) => format!("sections {}", form.title),
        Kind::Shorthand { word, form } => format!("{}, or a table ({})", expected(word), form.doc),
        Kind::Fields { word, fields } => {
            let names: Vec<&str> = fields.iter().map(|field| field.name).collect();
            format!("{}, or a table of {}", expected(word), names.join(", "))
        }
        Kind::Parameters => "a table of groups of parameters".to_owned(),
        Kind::Texts => "a table of names and texts".to_owned(),
        Kind::Content(content) => content.expected.to_owned(),
        Kind::Amount => "a number with its unit in quotes".to_owned(),
    }
}

/// A value that would do, as written in a file.
pub fn example(kind: &Kind) -> String {
    match kind {
        Kind::Name | Kind::Text | Kind::Reference(_) => "\"…\"".to_owned(),
        Kind::Quantity(quantity) => quoted(quantity.example),
        Kind::Count { min, .. } => min.to_string(),
        Kind::Flag => "true".to_owned(),
        Kind::Choice(choices) => quoted(choices.first().copied().unwrap_or_default()),
        Kind::List(item) => format!("[{}]", example(item)),
        Kind::Table(form) | Kind::Tables(form) => form.title.to_owned(),
        Kind::Shorthand { word, .. } | Kind::Fields { word, .. } | Kind::Or { other: word, .. } | Kind::Dated(word) => {
            example(word)
        }
        Kind::Parameters => "{ limits = { wear_limit = \"0.5 mm\" } }".to_owned(),
        Kind::Texts => "{ cutting_speed = \"vc [m/min]\" }".to_owned(),
        Kind::Content(content) => content.example.to_owned(),
        Kind::Amount => "\"12 s\"".to_owned(),
    }
}

pub(crate) fn described(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("the text {text:?}"),
        DeValue::Integer(number) => format!("the bare number {number}"),
        DeValue::Float(number) => format!("the bare number {number}"),
        DeValue::Boolean(flag) => format!("`{flag}`"),
        DeValue::Datetime(time) => format!("the date or time {time}"),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_is_meant_in_per_cent_only_where_it_is_a_share() {
        let ratio = |max| Quantity { unit: "1", display: "1", min: 0.0, max, above: false, example: "" };
        assert_eq!(meant(&ratio(0.99), "2.0"), ["\"2.0 %\""]);
        assert!(meant(&ratio(0.99), "200").is_empty(), "200 % is beyond the range as well");
        assert!(meant(&ratio(0.99), "200 %").is_empty());
        assert!(meant(&ratio(20.0), "200").is_empty(), "an exponent is no share");
        let taylor = Quantity { min: 0.01, ..ratio(1.0) };
        assert!(
            meant(&taylor, "5").is_empty(),
            "nor is the exponent n of Taylor's law, whose reciprocal may stand there"
        );
        let time = Quantity { unit: "s", display: "min", min: 0.0, max: 3600.0, above: false, example: "" };
        assert_eq!(meant(&time, "90 h"), ["\"90 s\""]);
    }

    #[test]
    fn an_example_of_a_ratio_has_no_unit() {
        let ratio = Quantity { unit: "1", display: "1", min: 1.0, max: 20.0, above: false, example: "" };
        let wrong = |text: &str| fix(&ratio, text, &unit::quantity(text, "1").expect_err("a wrong unit"));
        assert_eq!(wrong("2.0 min"), "2.0");
        assert_eq!(wrong("0.5 min"), "1");
    }
}
