//! Working time, and the dates from which it counts.

use super::fault::ScenarioFault;
use super::keys::quantity::DECADE;
use super::names::{Names, named};
use toml::de::{DeTable, DeValue};
use toolroom_form::{Fault, Section, Span, Value, Walk};
use toolroom_scenario::{
    Dated, Interruption, PacedShift, Paces, Periodic, Shift, ShiftCalendar, WeekPlan, WorkingTime, date,
};

/// Working time of dates goes on for so long after the horizon, s: somebody may finish a part (assumption).
const BEYOND: f64 = 14.0 * 86_400.0;

/// The date of second 0, s since 1970-01-01.
pub(super) fn start(walk: &mut Walk, shop: &Section<'_>) -> Option<f64> {
    let text = shop.text("start")?;
    let start = date::parse(text);
    if start.is_none() {
        no_date(walk, shop.span_of("start"), "start", text, "date", "\"2026-03-30 00:00\"");
    }
    start
}

/// The end of the run, s: a date after the start, or a time. `None` where a problem was noted.
pub(super) fn end_of_run(walk: &mut Walk, shop: &Section<'_>, start: Option<f64>) -> Option<f64> {
    let Some(text) = shop.text("horizon") else { return shop.si("horizon") };
    let end = moment(walk, shop, "horizon", start)?;
    if end > 0.0 && end <= DECADE {
        return Some(end);
    }
    let reason = format!("the run would end at {text}, which is not within ten years after its start");
    let first = date::show(start.unwrap_or(0.0));
    let fix = format!("write a date after {first}, at which it starts, or a time such as \"6 week\"");
    walk.fault(shop.span_of("horizon"), ScenarioFault::Arrangement { reason, fix });
    None
}

fn no_date(walk: &mut Walk, span: Span, key: &'static str, read: &str, expected: &'static str, example: &'static str) {
    walk.fault(span, ScenarioFault::NoDate { key, read: read.to_owned(), expected, example });
}

/// A date written as `30.03.2026`, with or without a time of the day, in the form that is read; `None` for any other text.
fn day_first(text: &str) -> Option<String> {
    let read = |format: &str| date::by_format(text, format).map(date::show);
    read("%d.%m.%Y").or_else(|| read("%d.%m.%Y %H:%M"))
}

/// The time under `key`, s since the start: a date, or a time with its unit. `None` where it is left out or a
/// problem was noted.
pub(super) fn moment(walk: &mut Walk, section: &Section<'_>, key: &'static str, start: Option<f64>) -> Option<f64> {
    let text = section.text(key)?;
    if date::is_date(text) {
        let (time, span) = (date::parse(text), section.span_of(key));
        match (time, start) {
            (Some(time), Some(start)) => return Some(time - start),
            (Some(_), None) => walk.fault(span, ScenarioFault::DateWithoutStart { key, read: text.to_owned() }),
            (None, _) => no_date(walk, span, key, text, "date", "\"2026-03-30 06:00\""),
        }
        return None;
    }
    if let Some(date) = day_first(text) {
        let reason = format!("`{key}` is \"{text}\": dates are written year-month-day");
        let fix = format!(
            "write \"{date}\"; of a table, list its columns in `column` of [tables], this one as {{ name = \"{key}\", from = …, format = \"%d.%m.%Y\" }}"
        );
        walk.fault(section.span_of(key), ScenarioFault::Arrangement { reason, fix });
        return None;
    }
    match toolroom_process::unit::quantity(text, "s") {
        Ok(time) if time.is_finite() => return Some(time),
        Ok(_) => {
            let (name, read) = (key.to_owned(), text.to_owned());
            let fault = Fault::OutOfRange { key: name, read, range: "finite times".to_owned(), meant: Vec::new() };
            walk.fault(section.span_of(key), fault);
        }
        Err(reason) => {
            let example = "\"2026-03-30 06:00\" or \"6 h\"".to_owned();
            walk.fault(section.span_of(key), Fault::Quantity { key: key.to_owned(), reason, example });
        }
    }
    None
}

pub(super) fn calendars(
    walk: &mut Walk,
    root: &Section<'_>,
    names: &mut Names,
    start: Option<f64>,
    horizon: f64,
) -> Vec<ShiftCalendar> {
    let mut calendars = Vec::new();
    for (name, section) in named(walk, root, "calendar", None) {
        names.calendars.push(name.clone());
        let at_end = section.chosen("at_end", Interruption::from_word);
        let finish_within = section.required("finish_within");
        let (time, usual, paces) = if section.given("week") {
            superfluous(walk, &section, "week", &["shift", "period"]);
            let (dated, paces) = dated(walk, &section, &name, start, horizon);
            (WorkingTime::Dated(dated), Interruption::Resume, paces)
        } else {
            superfluous(walk, &section, "shift", &["breaks", "holidays", "overtime", "weeks", "first_week"]);
            let (periodic, paces) = periodic(walk, &section, horizon);
            (WorkingTime::Periodic(periodic), Interruption::Finish, paces)
        };
        let start_only_if_fits = section.flag("start_only_if_fits").unwrap_or(false);
        let at_end = at_end.unwrap_or(usual);
        calendars.push(ShiftCalendar { name, time, at_end, finish_within, start_only_if_fits, paces });
    }
    calendars
}

/// Keys that mean nothing beside another.
fn superfluous(walk: &mut Walk, section: &Section<'_>, key: &str, others: &[&'static str]) {
    for other in others.iter().filter(|other| section.given(other)) {
        let case = format!("a calendar with `{key}`");
        let applicable = "period and shift, or week, weeks, first_week, breaks, holidays and overtime".to_owned();
        walk.fault(section.span_of(other), Fault::NotApplicable { key: other, case, applicable });
    }
}

/// Shifts that repeat.
fn periodic(walk: &mut Walk, section: &Section<'_>, horizon: f64) -> (Periodic, Paces) {
    let period = section.si("period").unwrap_or(86_400.0);
    let sections = walk.sections(section, "shift", None);
    match section.got("shift") {
        None => {
            let example =
                "[{ start = \"6 h\", end = \"14 h\" }]` or `week = { mon-fri = [\"06:00-14:00\"] }".to_owned();
            let fault = Fault::MissingKey { section: section.form.title.to_owned(), key: "shift", example };
            walk.fault(section.span.clone(), fault);
        }
        Some(got) if sections.is_empty() && matches!(got.value, Value::Raw(_)) => {
            let example = "shift = [{ start = \"6 h\", end = \"14 h\" }]";
            walk.fault(section.span_of("shift"), Fault::Nothing { what: "shift", example });
        }
        Some(_) => {}
    }
    let (mut shifts, mut paced): (Vec<Shift>, Vec<PacedShift>) = (Vec::new(), Vec::new());
    for (i, stretch) in sections.iter().enumerate() {
        let shift = Shift { start: stretch.required("start"), end: stretch.required("end") };
        let hours = |seconds: f64| format!("{} h", seconds / 3600.0);
        let contradiction = |second, second_value: f64, rule| Fault::Contradiction {
            first: "end",
            first_value: hours(shift.end),
            second,
            second_value: hours(second_value),
            rule,
        };
        if shift.end <= shift.start {
            let fault = contradiction("start", shift.start, "a shift ends after it starts; over midnight write two");
            walk.fault(stretch.span_of("end"), fault);
        } else if shift.end > period {
            walk.fault(stretch.span_of("end"), contradiction("period", period, "a shift ends within the period"));
        }
        if shifts.last().is_some_and(|before| shift.start < before.end) {
            walk.fault(stretch.span_of("start"), ScenarioFault::ShiftsOverlap { first: i, second: i + 1 });
        }
        shifts.push(shift);
        paced.push(PacedShift { shift, factor: stretch.required("factor") });
    }
    (Periodic { period, shifts }, repeated(&paced, period, horizon + BEYOND))
}

/// The paces of shifts that repeat after `period`, s, until `until`, s.
fn repeated(shifts: &[PacedShift], period: f64, until: f64) -> Paces {
    let uneven: Vec<&PacedShift> = shifts.iter().filter(|own| own.factor > 0.0 && own.factor != 1.0).collect();
    let mut stretches = Vec::new();
    let mut zero = 0.0;
    // A calendar that is faulty may have no period.
    while !uneven.is_empty() && period > 0.0 && zero < until {
        let moved =
            |own: &&PacedShift| (Shift { start: zero + own.shift.start, end: zero + own.shift.end }, own.factor);
        stretches.extend(uneven.iter().map(moved));
        zero = period * (stretches.len() / uneven.len()) as f64;
    }
    Paces::new(stretches)
}

/// Shifts of dates; nothing but a placeholder after a fault.
fn dated(walk: &mut Walk, section: &Section<'_>, name: &str, start: Option<f64>, horizon: f64) -> (Dated, Paces) {
    let noted = walk.problems.len();
    let plan = WeekPlan {
        weeks: weeks(walk, section),
        first: first_week(walk, section).unwrap_or((start.unwrap_or(0.0) / 86_400.0).floor() as i64),
        breaks: listed(walk, section, "breaks", "break", "\"10:00-10:15\"", |text| {
            interval(text).filter(|own| own.start < own.end)
        }),
        holidays: listed(
            walk,
            section,
            "holidays",
            "holiday",
            "\"2026-04-03\" or \"2026-08-03..2026-08-14\"",
            |text| {
                let (first, last) = text.split_once("..").unwrap_or((text, text));
                let days = (date::day(first.trim())?, date::day(last.trim())?);
                (days.0 <= days.1).then_some(days)
            },
        ),
        overtime: listed(walk, section, "overtime", "stretch of overtime", "\"2026-04-04 06:00-10:00\"", |text| {
            let (day, times) = text.trim().split_once([' ', 'T'])?;
            let (midnight, hours) = (date::day(day)? as f64 * 86_400.0, interval(times)?);
            let end = if hours.end <= hours.start { hours.end + 86_400.0 } else { hours.end };
            Some(Shift { start: midnight + hours.start, end: midnight + end })
        }),
    };
    if start.is_none() {
        let read = "a week of dates".to_owned();
        walk.fault(section.span_of("week"), ScenarioFault::DateWithoutStart { key: "week", read });
    }
    let paces = plan.paces(start.unwrap_or(0.0), horizon + BEYOND);
    let dated = Dated::new(&plan, start.unwrap_or(0.0), horizon + BEYOND);
    if walk.problems.len() == noted && dated.worked_until(horizon) == 0.0 {
        walk.fault(section.span_of("week"), ScenarioFault::CalendarEmpty { name: name.to_owned() });
    }
    (dated, paces)
}

/// A day of the first of several weeks, days since 1970-01-01.
fn first_week(walk: &mut Walk, section: &Section<'_>) -> Option<i64> {
    let text = section.text("first_week")?;
    let day = date::day(text.trim());
    if day.is_none() {
        no_date(walk, section.span_of("first_week"), "first_week", text, "day", "\"2026-03-30\"");
    }
    day
}

/// What the texts under `key` say; those that say nothing are faults.
fn listed<T>(
    walk: &mut Walk,
    section: &Section<'_>,
    key: &'static str,
    expected: &'static str,
    example: &'static str,
    read: impl Fn(&str) -> Option<T>,
) -> Vec<T> {
    let mut list = Vec::new();
    for got in section.list(key) {
        let Value::Text(text) = &got.value else { continue };
        match read(text) {
            Some(value) => list.push(value),
            None => no_date(walk, got.span.clone(), key, text, expected, example),
        }
    }
    list
}

/// Two times of the day, `06:00-14:00`.
fn interval(text: &str) -> Option<Shift> {
    let (start, end) = text.trim().split_once('-')?;
    let shift = Shift { start: date::clock(start.trim())?, end: date::clock(end.trim())? };
    (shift.start < 86_400.0 && shift.start != shift.end).then_some(shift)
}

/// Weekdays as in files, Monday first.
const DAYS: [&str; 7] = ["mon", "tue", "wed", "thu", "fri", "sat", "sun"];

/// The days of `mon` or `mon-fri`.
fn days(text: &str) -> Option<std::ops::RangeInclusive<usize>> {
    let place = |name: &str| DAYS.iter().position(|day| *day == name.trim());
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let days = place(first)?..=place(last)?;
    (days.start() <= days.end()).then_some(days)
}

/// `week = { mon-fri = ["06:00-14:00"] }`, or a list of such weeks.
fn weeks(walk: &mut Walk, section: &Section<'_>) -> Vec<[Vec<PacedShift>; 7]> {
    let example = || "{ mon-fri = [\"06:00-14:00\"] }".to_owned();
    let expected = "a table of weekdays with their shifts, or a list of such tables";
    let mut weeks = Vec::new();
    match section.got("week").map(|got| &got.value) {
        Some(Value::Raw(DeValue::Table(table))) => weeks.push(week(walk, table)),
        Some(Value::Raw(DeValue::Array(tables))) if !tables.is_empty() => {
            for entry in tables {
                match entry.get_ref().as_table() {
                    Some(table) => weeks.push(week(walk, table)),
                    None => walk.wrong_type("week", entry.get_ref(), expected, entry.span(), example()),
                }
            }
        }
        Some(Value::Raw(raw)) => walk.wrong_type("week", raw, expected, section.span_of("week"), example()),
        Some(_) | None => {}
    }
    if let Some(count) = section.count("weeks")
        && count as usize != weeks.len()
        && !weeks.is_empty()
    {
        let fault = Fault::Contradiction {
            first: "weeks",
            first_value: count.to_string(),
            second: "week",
            second_value: format!("{} of them", weeks.len()),
            rule: "`week` is a list of as many weeks as follow each other: week = [{ mon-fri = [\"06:00-14:00\"] }, { mon-fri = [\"14:00-22:00\"] }]",
        };
        walk.fault(section.span_of("weeks"), fault);
    }
    weeks
}

/// Shifts of one week; a day alone goes before a range that holds it.
fn week(walk: &mut Walk, table: &DeTable<'_>) -> [Vec<PacedShift>; 7] {
    let mut week: [Vec<PacedShift>; 7] = Default::default();
    // By day: how many days the entry has that says its shifts, and its name.
    let mut said: [Option<(usize, &str)>; 7] = [None; 7];
    for (name, value) in table {
        let Some(days) = days(name.get_ref()) else {
            no_date(walk, name.span(), "week", name.get_ref(), "weekday", "mon or mon-fri");
            continue;
        };
        let Some(entries) = value.get_ref().as_array() else {
            let example = "[\"06:00-14:00\"]".to_owned();
            walk.wrong_type(name.get_ref(), value.get_ref(), "a list of shifts", value.span(), example);
            continue;
        };
        let mut shifts: Vec<PacedShift> = Vec::new();
        for (i, entry) in entries.iter().enumerate() {
            let Some(shift) = paced(walk, entry.get_ref(), entry.span()) else { continue };
            let overlaps =
                |before: &PacedShift| before.shift.end <= before.shift.start || shift.shift.start < before.shift.end;
            if shifts.last().is_some_and(overlaps) {
                walk.fault(entry.span(), ScenarioFault::ShiftsOverlap { first: i, second: i + 1 });
            }
            shifts.push(shift);
        }
        let count = days.clone().count();
        for day in days {
            match said[day] {
                Some((other, before)) if (other == 1) == (count == 1) => {
                    let fault = Fault::Contradiction {
                        first: "week",
                        first_value: before.to_owned(),
                        second: "week",
                        second_value: name.get_ref().to_string(),
                        rule: "a day stands in one range, or alone beside a range that holds it",
                    };
                    walk.fault(name.span(), fault);
                    break;
                }
                Some((1, _)) => {}
                Some(_) | None => {
                    week[day].clone_from(&shifts);
                    said[day] = Some((count, name.get_ref()));
                }
            }
        }
    }
    week
}

/// `"06:00-14:00"`, or `{ time = "22:00-06:00", factor = 0.8 }`.
fn paced(walk: &mut Walk, entry: &DeValue<'_>, span: Span) -> Option<PacedShift> {
    const SHIFT: &str = "\"06:00-14:00\", \"22:00-06:00\" or { time = \"22:00-06:00\", factor = 0.8 }";
    let (text, factor) = if let DeValue::Table(table) = entry {
        if let Some((key, _)) = table.iter().find(|(key, _)| !["time", "factor"].contains(&&**key.get_ref())) {
            no_date(walk, key.span(), "week", key.get_ref(), "key of a shift", SHIFT);
        }
        let factor = match table.get("factor").map(|factor| factor.get_ref()) {
            None => Some(1.0),
            Some(DeValue::Float(number)) => number.as_str().parse::<f64>().ok(),
            Some(DeValue::Integer(number)) => number.as_str().parse::<f64>().ok(),
            Some(_) => None,
        };
        let Some(factor) = factor.filter(|factor| *factor > 0.0 && *factor <= FASTEST) else {
            let place = table.get("factor").map_or(span, |factor| factor.span());
            no_date(walk, place, "week", "factor", "factor on the speed of work, above 0 and at most 10", SHIFT);
            return None;
        };
        (table.get("time").and_then(|time| time.get_ref().as_str()).unwrap_or_default(), factor)
    } else {
        (entry.as_str().unwrap_or_default(), 1.0)
    };
    match interval(text) {
        Some(shift) => Some(PacedShift { shift, factor }),
        None => {
            no_date(walk, span, "week", text, "shift", SHIFT);
            None
        }
    }
}

/// Greatest factor on the speed of work in a shift: more is a slip (assumption).
const FASTEST: f64 = 10.0;
