//! Working time of dates: shifts by weekday, breaks, holidays, overtime.

use crate::date::weekday;
use crate::{Boundary, Paces, Shift};

const DAY: f64 = 86_400.0;
/// Days of a week, s.
pub(super) const WEEK: f64 = 7.0 * DAY;

/// Difference of times that are the same, s: those of events are whole nanoseconds.
const ROUNDING: f64 = 1e-6;

/// What a calendar says about dates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeekPlan {
    /// Shifts of Monday to Sunday, s since midnight of the day on which they start; one that ends where or
    /// before it starts runs over midnight. Several weeks follow each other, again and again.
    pub weeks: Vec<[Vec<PacedShift>; 7]>,
    /// A day of a week that is the first of these, days since 1970-01-01.
    pub first: i64,
    /// Breaks of every day, s since midnight.
    pub breaks: Vec<Shift>,
    /// First and last day of holidays, days since 1970-01-01: shifts that start there are left out.
    pub holidays: Vec<(i64, i64)>,
    /// Overtime, s since 1970-01-01. It is worked on holidays and through breaks, too.
    pub overtime: Vec<Shift>,
}

/// A shift of a day, and how fast work goes in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PacedShift {
    /// From and to, s since midnight.
    pub shift: Shift,
    /// Factor on the speed of work, above 0.
    pub factor: f64,
}

impl From<Shift> for PacedShift {
    /// A shift in which work goes as planned.
    fn from(shift: Shift) -> Self {
        Self { shift, factor: 1.0 }
    }
}

impl WeekPlan {
    /// Every shift that starts on a day from that before `start` to `until` after it, whether or not on a holiday: its number
    /// in the list of its day and its times, s since `start` (itself s since 1970-01-01).
    fn shifts(&self, start: f64, until: f64) -> impl Iterator<Item = (usize, f64, PacedShift)> + '_ {
        // A shift of the day before may run over midnight into the first day.
        let days = (start / DAY).floor() as i64 - 1..=((start + until) / DAY).floor() as i64;
        let works = |day: &i64| !self.holidays.iter().any(|(first, last)| (*first..=*last).contains(day));
        days.filter(move |day| works(day)).flat_map(move |day| {
            let midnight = day as f64 * DAY - start;
            self.day(day).iter().enumerate().map(move |(number, own)| {
                let Shift { start, end } = own.shift;
                let end = if end <= start { end + DAY } else { end };
                let shift = Shift { start: midnight + start, end: midnight + end };
                (number, midnight, PacedShift { shift, ..*own })
            })
        })
    }

    /// Shifts that start on a day, days since 1970-01-01.
    fn day(&self, day: i64) -> &[PacedShift] {
        let monday = |day: i64| day - weekday(day) as i64;
        let weeks = (monday(day) - monday(self.first)) / 7;
        let count = self.weeks.len().max(1) as i64;
        self.weeks.get(weeks.rem_euclid(count) as usize).map_or(&[], |week| &week[weekday(day)])
    }

    /// How fast work goes from second 0, which is `start` (s since 1970-01-01), to `until`, s.
    pub fn paces(&self, start: f64, until: f64) -> Paces {
        Paces::new(self.shifts(start, until).map(|(_, _, own)| (own.shift, own.factor)).collect())
    }
}

/// Working time of dates, worked out from the start of a run to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Dated {
    /// Working intervals, s since the start; ascending, none touches another.
    blocks: Vec<Block>,
    /// When shifts begin, s since the start, ascending, and their number in the list of their day.
    begun: Vec<(f64, usize)>,
    /// Most shifts of a day.
    most: usize,
}

/// A working interval.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    start: f64,
    end: f64,
    /// Working time before it, s.
    before: f64,
    /// Whether a break follows, and then the same shift.
    pauses: bool,
}

impl Dated {
    /// The working time of a plan from second 0, which is `start` (s since 1970-01-01), to `until`, s.
    ///
    /// # Examples
    /// ```
    /// use toolroom_calendar::{Dated, Shift, WeekPlan, date};
    /// let early = Shift { start: 6.0 * 3600.0, end: 14.0 * 3600.0 };
    /// let week = std::array::from_fn(|day| if day < 5 { vec![early.into()] } else { vec![] });
    /// let plan = WeekPlan { weeks: vec![week], ..WeekPlan::default() };
    /// let monday = date::parse("2026-03-30").unwrap();
    /// assert_eq!(Dated::new(&plan, monday, 14.0 * 86_400.0).worked_until(7.0 * 86_400.0), 40.0 * 3600.0);
    /// ```
    pub fn new(plan: &WeekPlan, start: f64, until: f64) -> Self {
        let (mut intervals, mut begun) = (Vec::new(), Vec::new());
        for (number, midnight, PacedShift { shift, .. }) in plan.shifts(start, until) {
            begun.push((shift.start, number));
            let pieces = without(shift.start, shift.end, &plan.breaks, midnight);
            let last = pieces.len().saturating_sub(1);
            intervals.extend(pieces.into_iter().enumerate().map(|(place, piece)| (piece, place < last)));
        }
        let overtime = plan.overtime.iter().map(|own| Shift { start: own.start - start, end: own.end - start });
        intervals.extend(overtime.map(|own| (own, false)));
        intervals.sort_by(|a, b| a.0.start.total_cmp(&b.0.start));
        begun.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut blocks: Vec<Block> = Vec::new();
        for (Shift { start, end }, pauses) in intervals {
            let start = start.max(0.0);
            if end <= start || start > until {
                continue;
            }
            match blocks.last_mut() {
                Some(last) if start <= last.end => {
                    // Of pieces that end together one that is over ends a shift.
                    if end >= last.end {
                        last.pauses = pauses && (end > last.end || last.pauses);
                        last.end = end;
                    }
                }
                Some(_) | None => blocks.push(Block { start, end, before: 0.0, pauses }),
            }
        }
        let mut worked = 0.0;
        for block in &mut blocks {
            block.before = worked;
            worked += block.end - block.start;
        }
        Self { blocks, begun, most: plan.weeks.iter().flatten().map(Vec::len).max().unwrap_or(0) }
    }

    /// Whether there is any working time.
    pub fn works(&self) -> bool {
        !self.blocks.is_empty()
    }

    /// The last block that begins at or before `time`.
    fn block(&self, time: f64) -> Option<&Block> {
        self.blocks[..self.blocks.partition_point(|block| block.start <= time)].last()
    }

    /// Whether work goes on at `time`, s.
    pub fn works_at(&self, time: f64) -> bool {
        self.block(time).is_some_and(|block| time < block.end)
    }

    /// Working time from zero to `time`, s.
    pub fn worked_until(&self, time: f64) -> f64 {
        self.block(time).map_or(0.0, |block| block.before + (time.min(block.end) - block.start))
    }

    /// The next change strictly after `time`.
    pub fn next_boundary(&self, time: f64) -> Option<Boundary> {
        if let Some(block) = self.block(time).filter(|block| time < block.end) {
            return Some(Boundary { time: block.end, starts: false, pauses: block.pauses });
        }
        let next = self.blocks.get(self.blocks.partition_point(|block| block.start <= time))?;
        Some(Boundary { time: next.start, starts: true, pauses: false })
    }

    /// Whether a break of a shift begins at `time`.
    pub fn pauses_at(&self, time: f64) -> bool {
        self.block(time).is_some_and(|block| block.pauses && (block.end - time).abs() < ROUNDING)
    }

    /// Name of the shift that began last; overtime has the name of the shift before.
    pub fn shift_at(&self, time: f64) -> Option<String> {
        let before = &self.begun[..self.begun.partition_point(|(start, _)| *start <= time)];
        before.last().or(self.begun.first()).map(|(_, number)| format!("S{}", number + 1))
    }

    /// Most shifts of a day.
    pub fn shift_count(&self) -> usize {
        self.most
    }
}

/// An interval without the breaks of the days on which it lies; `midnight` is that of its first day.
fn without(start: f64, end: f64, breaks: &[Shift], midnight: f64) -> Vec<Shift> {
    let mut left = vec![Shift { start, end }];
    for of_day in [midnight, midnight + DAY] {
        for pause in breaks {
            let (from, to) = (of_day + pause.start, of_day + pause.end);
            let pieces = |shift: &Shift| {
                let before = Shift { start: shift.start, end: shift.end.min(from) };
                let after = Shift { start: shift.start.max(to), end: shift.end };
                [before, after].into_iter().filter(|piece| piece.start < piece.end)
            };
            left = left.iter().flat_map(pieces).collect();
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::date;
    use proptest::prelude::*;

    const HOUR: f64 = 3600.0;

    fn hours(start: f64, end: f64) -> Shift {
        Shift { start: start * HOUR, end: end * HOUR }
    }

    fn week(shift: Shift) -> Vec<[Vec<PacedShift>; 7]> {
        vec![std::array::from_fn(|day| if day < 5 { vec![shift.into()] } else { Vec::new() })]
    }

    fn at(text: &str) -> f64 {
        date::parse(text).unwrap() - date::parse("2026-03-30").unwrap()
    }

    fn calendar(plan: &WeekPlan) -> Dated {
        Dated::new(plan, date::parse("2026-03-30").unwrap(), 21.0 * DAY)
    }

    /// When work of some hours ends that begins at a date.
    fn end(calendar: &Dated, start: &str, hours: f64) -> String {
        let mut left = hours * HOUR;
        let mut now = at(start);
        while left > 0.0 {
            let next = calendar.next_boundary(now).unwrap();
            if calendar.works_at(now) {
                if left <= next.time - now {
                    now += left;
                    break;
                }
                left -= next.time - now;
            }
            now = next.time;
        }
        date::show(now + date::parse("2026-03-30").unwrap())
    }

    fn friday() -> (i64, i64) {
        let day = date::day("2026-04-03").unwrap();
        (day, day)
    }

    #[test]
    fn holidays_take_shifts_out_and_overtime_adds() {
        let overtime =
            Shift { start: date::parse("2026-04-04 06:00").unwrap(), end: date::parse("2026-04-04 10:00").unwrap() };
        let early = WeekPlan {
            weeks: week(hours(6.0, 14.0)),
            holidays: vec![friday()],
            overtime: vec![overtime],
            ..WeekPlan::default()
        };
        assert_eq!(end(&calendar(&early), "2026-04-02 12:00", 10.0), "2026-04-06 10:00");
        // Overtime on the holiday itself wins.
        let worked =
            WeekPlan { overtime: vec![Shift { start: overtime.start - DAY, end: overtime.end - DAY }], ..early };
        assert_eq!(end(&calendar(&worked), "2026-04-02 12:00", 5.0), "2026-04-03 09:00");
    }

    #[test]
    fn a_night_shift_belongs_to_the_day_on_which_it_starts() {
        let night = WeekPlan { weeks: week(hours(22.0, 6.0)), holidays: vec![friday()], ..WeekPlan::default() };
        let night = calendar(&night);
        assert_eq!(end(&night, "2026-04-02 23:00", 10.0), "2026-04-07 01:00");
        assert!(night.works_at(at("2026-04-03 05:59")) && !night.works_at(at("2026-04-04 01:00")));
    }

    #[test]
    fn breaks_stop_the_work() {
        let early = WeekPlan {
            weeks: week(hours(6.0, 14.0)),
            breaks: vec![hours(10.0, 10.25), hours(12.0, 12.5)],
            ..WeekPlan::default()
        };
        assert_eq!(end(&calendar(&early), "2026-03-30 07:00", 6.0), "2026-03-30 13:45");
        let pauses = ["2026-03-30 10:00", "2026-03-30 12:00", "2026-03-30 14:00"]
            .map(|time| calendar(&early).pauses_at(at(time)));
        assert_eq!(pauses, [true, true, false]);
        let night = WeekPlan { weeks: week(hours(22.0, 6.0)), breaks: vec![hours(2.0, 2.5)], ..WeekPlan::default() };
        assert_eq!(end(&calendar(&night), "2026-03-30 22:00", 5.0), "2026-03-31 03:30");
        // A break that a shift ends with is its end, and so is one that overtime fills none.
        let filled = WeekPlan {
            weeks: week(hours(6.0, 14.0)),
            breaks: vec![hours(10.0, 10.25), hours(13.5, 14.0)],
            overtime: vec![Shift {
                start: date::parse("2026-03-30 10:00").unwrap(),
                end: date::parse("2026-03-30 10:30").unwrap(),
            }],
            ..WeekPlan::default()
        };
        let pauses = ["2026-03-30 10:00", "2026-03-30 13:30", "2026-03-31 10:00"]
            .map(|time| calendar(&filled).pauses_at(at(time)));
        assert_eq!(pauses, [false, false, true]);
    }

    #[test]
    fn shifts_that_touch_are_one_and_keep_their_names() {
        let mut monday: [Vec<PacedShift>; 7] = Default::default();
        monday[0] = vec![hours(6.0, 14.0).into(), hours(14.0, 22.0).into()];
        let both = WeekPlan { weeks: vec![monday], ..WeekPlan::default() };
        let both = calendar(&both);
        assert_eq!(both.next_boundary(at("2026-03-30 07:00")).unwrap().time, at("2026-03-30 22:00"));
        let names = ["2026-03-30 07:00", "2026-03-30 14:00", "2026-03-31 03:00"].map(|time| both.shift_at(at(time)));
        assert_eq!(names.map(Option::unwrap), ["S1", "S2", "S2"]);
        assert_eq!(both.shift_count(), 2);
    }

    #[test]
    fn weeks_that_alternate_follow_each_other() {
        let both = [week(hours(6.0, 14.0)).remove(0), week(hours(14.0, 22.0)).remove(0)];
        let first = date::day("2026-04-01").unwrap(); // a Wednesday of the week in which the run starts
        let plan = WeekPlan { weeks: both.to_vec(), first, ..WeekPlan::default() };
        let alternating = calendar(&plan);
        let works = |text: &str| alternating.works_at(at(text));
        assert!(works("2026-03-30 07:00") && works("2026-04-03 13:59") && !works("2026-03-30 15:00"));
        assert!(works("2026-04-06 15:00") && works("2026-04-10 21:00") && !works("2026-04-06 07:00"));
        assert!(works("2026-04-13 07:00") && !works("2026-04-13 15:00"));
        // Ten hours from Thursday 12:00 of an early week: two then, eight on Friday; in a late week two, and eight on Friday.
        assert_eq!(end(&alternating, "2026-04-02 12:00", 10.0), "2026-04-03 14:00");
        assert_eq!(end(&alternating, "2026-04-02 12:00", 12.0), "2026-04-06 16:00");
        // Weeks count from any week, before or after the start.
        let later = WeekPlan { first: date::day("2026-04-08").unwrap(), ..plan };
        assert!(
            calendar(&later).works_at(at("2026-03-30 15:00")) && !calendar(&later).works_at(at("2026-03-30 07:00"))
        );
    }

    #[test]
    fn a_night_shift_is_slower_until_it_ends_on_the_next_day() {
        let mut week = week(hours(6.0, 14.0)).remove(0);
        week[0].push(PacedShift { shift: hours(22.0, 6.0), factor: 0.8 });
        let plan = WeekPlan { weeks: vec![week], ..WeekPlan::default() };
        let paces = plan.paces(date::parse("2026-03-30").unwrap(), 21.0 * DAY);
        let factor = |text: &str| paces.factor_at(at(text));
        let times =
            ["2026-03-30 07:00", "2026-03-30 22:00", "2026-03-31 05:59", "2026-03-31 06:00", "2026-03-31 23:00"];
        assert_eq!(times.map(factor), [1.0, 0.8, 0.8, 1.0, 1.0]);
    }

    proptest! {
        #[test]
        fn boundaries_and_working_time_agree(
            shifts in prop::collection::vec((0u32..24, 0u32..25), 7), break_at in 0u32..23, holiday in 0i64..14
        ) {
            let mut plan = WeekPlan { breaks: vec![hours(f64::from(break_at), f64::from(break_at) + 0.5)], ..WeekPlan::default() };
            let day = |(start, end): &(u32, u32)| vec![hours(f64::from(*start), f64::from(*end)).into()];
            plan.weeks = vec![std::array::from_fn(|each| day(&shifts[each]))];
            let first = date::day("2026-03-30").unwrap();
            plan.holidays = vec![(first + holiday, first + holiday + 1)];
            let calendar = calendar(&plan);
            let (mut now, mut worked) = (0.0, 0.0);
            while let Some(next) = calendar.next_boundary(now).filter(|next| next.time < 21.0 * DAY) {
                if calendar.works_at(now) {
                    prop_assert!(!next.starts);
                    worked += next.time - now;
                } else {
                    prop_assert!(next.starts);
                }
                now = next.time;
                prop_assert!((calendar.worked_until(now) - worked).abs() < 1e-6);
            }
        }
    }
}
