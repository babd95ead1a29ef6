//! Civil dates: local wall-clock time without zone and without daylight saving. An hour is always 3600 s.

const DAY: f64 = 86_400.0;

/// Days from 1970-01-01 to a date of the Gregorian calendar, or back before it.
///
/// # Source
/// H. Hinnant, *chrono-Compatible Low-Level Date Algorithms* (2013), `days_from_civil`.
fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let of_era = year - era * 400;
    let of_year = (153 * (month + if month > 2 { -3 } else { 9 }) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// Year, month and day of a number of days since 1970-01-01.
///
/// # Source
/// H. Hinnant, the same, `civil_from_days`.
fn civil_from_days(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let era = days.div_euclid(146_097);
    let of_era = days - era * 146_097;
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let shifted = (5 * of_year + 2) / 153;
    let day = of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    (year + era * 400 + i64::from(month <= 2), month, day)
}

/// Whole number of so many digits at the start of `text`, and what follows.
fn digits(text: &str, count: usize) -> Option<(i64, &str)> {
    let (number, rest) = text.split_at_checked(count)?;
    (number.bytes().all(|byte| byte.is_ascii_digit())).then_some(())?;
    Some((number.parse().ok()?, rest))
}

/// Seconds of a time of the day, `06:00` or `06:00:30`; `24:00` is the end of the day; `None` where it is no time.
pub fn clock(text: &str) -> Option<f64> {
    let (hour, rest) = digits(text, 2)?;
    let (minute, rest) = digits(rest.strip_prefix(':')?, 2)?;
    let (second, rest) = if rest.is_empty() { (0, rest) } else { digits(rest.strip_prefix(':')?, 2)? };
    let time = (hour * 60 + minute) * 60 + second;
    (rest.is_empty() && minute < 60 && second < 60 && time <= 86_400).then_some(time as f64)
}

/// Days since 1970-01-01 of a date `2026-03-30`; `None` where there is no such day.
pub fn day(text: &str) -> Option<i64> {
    let (year, rest) = digits(text, 4)?;
    let (month, rest) = digits(rest.strip_prefix('-')?, 2)?;
    let (day, rest) = digits(rest.strip_prefix('-')?, 2)?;
    let days = days_from_civil(year, month, day);
    (rest.is_empty() && civil_from_days(days) == (year, month, day)).then_some(days)
}

/// Seconds since 1970-01-01 of a date with or without a time of the day: `2026-03-30`, `2026-03-30 06:00`,
/// `2026-03-30T06:00:00`. A date alone is its midnight.
///
/// # Examples
/// ```
/// use toolroom_calendar::date;
/// assert_eq!(date::parse("1970-01-02T00:01").unwrap(), 86_460.0);
/// assert_eq!(date::parse("2026-02-29"), None);
/// ```
pub fn parse(text: &str) -> Option<f64> {
    let (date, time) = text.split_once(['T', ' ']).unwrap_or((text, "00:00"));
    Some(day(date)? as f64 * DAY + clock(time)?)
}

/// Seconds since 1970-01-01 of a date in another form: `%d`, `%m`, `%Y`, `%H` and `%M` stand for day, month, year,
/// hour and minute, any other character for itself. Day, month, hour and minute may have one digit. `None` where the
/// text does not have that form or is no date.
///
/// # Examples
/// ```
/// use toolroom_calendar::date;
/// assert_eq!(date::by_format("1.4.2026", "%d.%m.%Y"), date::parse("2026-04-01"));
/// assert_eq!(date::by_format("04/01/2026 14:30", "%m/%d/%Y %H:%M"), date::parse("2026-04-01 14:30"));
/// assert_eq!(date::by_format("31.4.2026", "%d.%m.%Y"), None);
/// ```
pub fn by_format(text: &str, format: &str) -> Option<f64> {
    let (mut text, mut format) = (text, format.chars());
    let (mut year, mut month, mut of_month, mut hour, mut minute) = (None, None, None, 0, 0);
    while let Some(expected) = format.next() {
        if expected != '%' {
            text = text.strip_prefix(expected)?;
            continue;
        }
        let field = format.next()?;
        let most = if field == 'Y' { 4 } else { 2 };
        let count = text.bytes().take(most).take_while(u8::is_ascii_digit).count();
        let (number, rest) = digits(text, count)?;
        text = rest;
        match field {
            'Y' if count == 4 => year = Some(number),
            'm' => month = Some(number),
            'd' => of_month = Some(number),
            'H' if number < 24 => hour = number,
            'M' if number < 60 => minute = number,
            _ => return None,
        }
    }
    let (year, month, of_month) = (year?, month?, of_month?);
    let days = days_from_civil(year, month, of_month);
    let exists = text.is_empty() && civil_from_days(days) == (year, month, of_month);
    exists.then_some(days as f64 * DAY + ((hour * 60 + minute) * 60) as f64)
}

/// Whether a form of dates names year, month and day, and nothing that [`by_format`] does not know.
pub fn is_format(format: &str) -> bool {
    let sample = ["%Y", "%m", "%d", "%H", "%M"].iter().zip(["2026", "01", "02", "03", "04"]);
    let text = sample.fold(format.to_owned(), |text, (field, value)| text.replace(field, value));
    by_format(&text, format).is_some()
}

/// Whether a text looks like a date rather than a time with its unit.
pub fn is_date(text: &str) -> bool {
    let bytes = text.as_bytes();
    bytes.len() >= 8 && bytes[..4].iter().all(u8::is_ascii_digit) && bytes[4] == b'-'
}

/// `2026-03-30 06:00`, with seconds where there are any; fractions of a second are rounded.
///
/// # Examples
/// ```
/// use toolroom_calendar::date;
/// let start = date::parse("2026-03-30 06:00").unwrap();
/// assert_eq!(date::show(start + 90.4), "2026-03-30 06:01:30");
/// ```
pub fn show(seconds: f64) -> String {
    let seconds = seconds.round();
    let days = (seconds / DAY).floor();
    let (year, month, day) = civil_from_days(days as i64);
    let time = (seconds - days * DAY) as i64;
    let (hour, minute, second) = (time / 3600, time / 60 % 60, time % 60);
    let tail = if second == 0 { String::new() } else { format!(":{second:02}") };
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}{tail}")
}

/// Day of the week of a number of days since 1970-01-01: Monday is 0.
pub(crate) fn weekday(days: i64) -> usize {
    (days + 3).rem_euclid(7) as usize
}

/// ISO 8601 week that holds a time, s since 1970-01-01: its name, `2026-W14`, and when it begins, s.
///
/// # Examples
/// ```
/// use toolroom_calendar::date;
/// let (name, monday) = date::week(date::parse("2027-01-01 12:00").unwrap());
/// assert_eq!((name.as_str(), date::show(monday).as_str()), ("2026-W53", "2026-12-28 00:00"));
/// ```
pub fn week(seconds: f64) -> (String, f64) {
    let days = (seconds / DAY).floor() as i64;
    let monday = days - weekday(days) as i64;
    let (year, ..) = civil_from_days(monday + 3);
    let number = (monday + 3 - days_from_civil(year, 1, 1)) / 7 + 1;
    (format!("{year:04}-W{number:02}"), monday as f64 * DAY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn days_and_weeks_are_those_of_the_calendar() {
        assert_eq!(day("2026-03-30"), Some(20_542));
        assert_eq!(weekday(20_542), 0, "a Monday");
        assert_eq!([day("1900-02-29"), day("2026-13-01"), day("2026-4-01"), day("2026-04-31")], [None; 4]);
        assert_eq!(day("2000-02-29").map(civil_from_days), Some((2000, 2, 29)));
        // ISO 8601: the week of the first Thursday of the year is its first.
        let named = |text: &str| week(parse(text).unwrap()).0;
        assert_eq!(
            [named("2024-12-30"), named("2021-01-03"), named("2026-03-30")],
            ["2025-W01", "2020-W53", "2026-W14"]
        );
    }

    #[test]
    fn times_of_the_day_end_at_midnight() {
        assert_eq!(clock("24:00"), Some(DAY));
        assert_eq!(["24:01", "6:00", "06:60", "06:00:60", "06.00", ""].map(clock), [None; 6]);
    }

    proptest! {
        #[test]
        fn what_is_shown_is_read_back(seconds in -3_000_000_000i64..8_000_000_000) {
            prop_assert_eq!(parse(&show(seconds as f64)), Some(seconds as f64));
        }

        #[test]
        fn any_text_is_read_or_refused(text in "\\PC{0,24}") {
            let _ = (parse(&text), is_date(&text), clock(&text), day(&text));
        }
    }
}
