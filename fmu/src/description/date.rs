//! When a unit was made.

/// Seconds since the start of 1970 as `YYYY-MM-DDThh:mm:ssZ`, the only form that the standards and their checkers take;
/// `None` after the year 9999.
///
/// # Source
/// Hinnant, chrono-compatible low-level date algorithms: days to a date of the Gregorian calendar.
fn written(seconds: u64) -> Option<String> {
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // Years begin in March here, so that a leap day is the last of a year; eras have 400 of them.
    let shifted = days + 719_468;
    let (era, day) = (shifted / 146_097, shifted % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let date = day - (153 * month + 2) / 5 + 1;
    let (month, late) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let year = era * 400 + year + late;
    let (hour, minute) = (second / 3600, second / 60 % 60);
    (year <= 9999).then(|| format!("{year:04}-{month:02}-{date:02}T{hour:02}:{minute:02}:{:02}Z", second % 60))
}

/// What `SOURCE_DATE_EPOCH` says. Without it a unit has no date: the same sources give the same bytes.
pub(super) fn generated() -> Option<String> {
    std::env::var("SOURCE_DATE_EPOCH").ok()?.trim().parse().ok().and_then(written)
}

#[cfg(test)]
mod tests {
    use super::written;

    #[test]
    fn seconds_are_a_date() {
        for (seconds, date) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_785_412_800, "2026-07-30T12:00:00Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(written(seconds).as_deref(), Some(date));
        }
        assert_eq!(written(u64::MAX / 4), None);
    }
}
