//! Numbers for people: as many digits as the interval deserves, a real minus sign.

use crate::kpi::Kpi;
use crate::statistics::Interval;
use toolroom_sim::scenario::Scenario;

/// Decimals that show an uncertainty with one digit, or two if it starts with 1 or 2; without
/// uncertainty, four digits of the value.
pub(crate) fn decimals(value: f64, half_width: f64) -> usize {
    let (size, digits) = if half_width.is_finite() && half_width > 0.0 {
        let lead = half_width / 10_f64.powf(half_width.log10().floor());
        (half_width, if lead < 2.95 { 2.0 } else { 1.0 })
    } else if value.is_finite() && value != 0.0 {
        (value.abs(), 4.0)
    } else {
        return 0;
    };
    (digits - 1.0 - size.log10().floor()).clamp(0.0, 4.0) as usize
}

/// A number; `–` where it is not defined.
pub(crate) fn plain(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.decimals$}");
    // "−0.0" says nothing.
    let zero = text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.'));
    if zero { text.trim_start_matches('-').to_owned() } else { text.replace('-', "\u{2212}") }
}

/// A number with its sign.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    let text = plain(value, decimals);
    if value > 0.0 && value.is_finite() && text.chars().any(|c| matches!(c, '1'..='9')) {
        format!("+{text}")
    } else {
        text
    }
}

/// `×1.62`.
pub(crate) fn factor(value: f64) -> String {
    if value.is_finite() { format!("×{value:.2}") } else { "×–".to_owned() }
}

/// Title of a figure with the unit that its numbers are shown in.
pub(crate) fn label(scenario: &Scenario, kpi: &Kpi) -> String {
    match kpi.definition.display {
        "1" => kpi.definition.title.to_owned(),
        "currency" => format!("{}, {}", kpi.definition.title, scenario.currency),
        unit => format!("{}, {unit}", kpi.definition.title),
    }
}

/// An interval in the unit that is shown.
pub(crate) fn shown(kpi: &Kpi, interval: &Interval) -> Interval {
    interval.scaled(kpi.definition.display_scale())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_interval() {
        assert_eq!(plain(184.234, decimals(184.234, 2.5)), "184.2");
        assert_eq!(plain(6.4123, decimals(6.4123, 0.08)), "6.41");
        assert_eq!(plain(6.4123, decimals(6.4123, f64::NAN)), "6.412");
        assert_eq!(plain(12345.6, decimals(12345.6, 300.0)), "12346");
        assert_eq!(plain(0.0, decimals(0.0, 0.0)), "0");
    }

    #[test]
    fn signs_are_typographic_and_zero_has_none() {
        assert_eq!(signed(-0.53, 2), "−0.53");
        assert_eq!(signed(17.4, 1), "+17.4");
        assert_eq!(signed(-0.001, 2), "0.00");
        assert_eq!(signed(0.001, 2), "0.00");
        assert_eq!(signed(f64::NAN, 2), "–");
    }
}
