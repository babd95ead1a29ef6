//! Numbers for people: as many digits as the interval deserves, a real minus sign.

use crate::kpi::Kpi;
use toolroom_scenario::Scenario;
use toolroom_statistics::Interval;

/// Decimals that show an uncertainty with one digit, or two if it starts below 5. A value that does
/// not vary gets the decimals that it has, but no more than four digits, as a value of unknown uncertainty does; never more
/// than four decimals.
pub(crate) fn decimals(value: f64, half_width: f64) -> usize {
    const MOST: f64 = 4.0;
    let half_width = if is_noise(value, half_width) { 0.0 } else { half_width };
    let (size, digits) = if half_width > 0.0 && half_width.is_finite() {
        let lead = half_width / 10_f64.powf(half_width.log10().floor());
        (half_width, if lead < 4.95 { 2.0 } else { 1.0 })
    } else if half_width == 0.0 || value == 0.0 || !value.is_finite() {
        let exact = |&digits: &i32| {
            let scaled = value * 10_f64.powi(digits);
            (scaled - scaled.round()).abs() <= 1e-9 * scaled.abs()
        };
        let four = if value == 0.0 || !value.is_finite() { 0.0 } else { 3.0 - value.abs().log10().floor() };
        let most = four.clamp(0.0, MOST) as i32;
        return (0..most).find(exact).unwrap_or(most) as usize;
    } else {
        (value.abs(), 4.0)
    };
    (digits - 1.0 - size.log10().floor()).clamp(0.0, MOST) as usize
}

/// Whether an uncertainty is nothing but rounding.
pub(crate) fn is_noise(value: f64, half_width: f64) -> bool {
    half_width <= 1e-9 * value.abs()
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
    match kpi.definition.shown_unit_in(scenario) {
        "" => kpi.definition.title.to_owned(),
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
        assert_eq!(plain(40.93, decimals(40.93, 2.2)), "40.9");
        assert_eq!(plain(12345.6, decimals(12345.6, 800.0)), "12346");
        assert_eq!(plain(0.0, decimals(0.0, f64::NAN)), "0");
    }

    #[test]
    fn what_does_not_vary_is_printed_as_it_is() {
        assert_eq!(plain(8.000_000_000_1, decimals(8.000_000_000_1, 1e-10)), "8");
        for (value, text) in [
            (0.0, "0"),
            (8.0, "8"),
            (0.25, "0.25"),
            (1.0 / 3.0, "0.3333"),
            (-1.5, "−1.5"),
            (4323.0 + 1.0 / 3.0, "4323"),
            (61.0526, "61.05"),
            (12345.6, "12346"),
        ] {
            assert_eq!(plain(value, decimals(value, 0.0)), text);
        }
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
