//! Time stamps of adapters.

/// Seconds since 1970-01-01T00:00:00Z of an ISO 8601 time stamp (`2017-02-07T19:38:27.609375Z`, with
/// an offset, or without one for UTC), or a bare number of seconds as relative adapters send.
pub(super) fn seconds(text: &str) -> Option<f64> {
    // `@` separates a duration that aggregating adapters append.
    let text = text.split('@').next().unwrap_or_default().trim();
    let Some((date, clock)) = text.split_once(['T', ' ']) else {
        return text.parse::<f64>().ok().filter(|seconds| seconds.is_finite());
    };
    let mut fields = date.splitn(3, '-').map(|field| field.parse::<i64>().ok());
    let (year, month, day) = (fields.next()??, fields.next()??, fields.next()??);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(0..=9999).contains(&year) {
        return None;
    }
    let (clock, offset) = match clock.find(['Z', 'z', '+', '-']) {
        Some(at) => (&clock[..at], offset(&clock[at..])?),
        None => (clock, 0.0),
    };
    let mut fields = clock.splitn(3, ':');
    let (hour, minute) = (fields.next()?.parse::<u8>().ok()?, fields.next()?.parse::<u8>().ok()?);
    let second = fields.next().map_or(Some(0.0), |field| field.parse::<f64>().ok())?;
    // 60 is a leap second.
    if hour > 23 || minute > 59 || !(0.0..61.0).contains(&second) {
        return None;
    }
    Some(
        days(year, month, day) as f64 * 86_400.0 + f64::from(hour) * 3600.0 + f64::from(minute) * 60.0 + second
            - offset,
    )
}

/// Days from 1970-01-01 in the Gregorian calendar.
///
/// # Source
/// Hinnant, "chrono-Compatible Low-Level Date Algorithms": years that begin in March put the leap day last.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// `Z`, `+02:00`, `-0500`, s.
fn offset(text: &str) -> Option<f64> {
    let digits: String = text[1..].chars().filter(|sign| *sign != ':').collect();
    let sign = match text.as_bytes()[0] {
        b'+' => 1.0,
        b'-' => -1.0,
        _ => return digits.is_empty().then_some(0.0),
    };
    let number = |range: std::ops::Range<usize>| digits.get(range)?.parse::<u8>().ok().map(f64::from);
    let minutes = if digits.len() == 2 { 0.0 } else { number(2..4)? };
    Some(sign * (number(0..2)? * 3600.0 + minutes * 60.0))
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn stamps_with_and_without_offset_are_the_same_instant() {
        let noon = 1_486_468_800.0; // 2017-02-07T12:00:00Z
        for text in
            ["2017-02-07T12:00:00Z", "2017-02-07 12:00", "2017-02-07T14:00:00+02:00", "2017-02-07T07:00:00.0-0500"]
        {
            assert_eq!(seconds(text), Some(noon), "{text}");
        }
        assert_eq!(seconds("2016-02-29T00:00:00.5Z@250.0"), Some(1_456_704_000.5));
        assert_eq!(seconds("12.25"), Some(12.25));
    }

    #[test]
    fn what_is_no_time_is_none() {
        for text in ["", "2017", "2017-13-01T00:00:00Z", "2017-01-01T25:00:00Z", "yesterday", "NaN", "2017-01-01Tü"] {
            assert!(text == "2017" || seconds(text).is_none(), "{text}");
        }
    }
}
