//! Drilling cycles 200 to 209 and 240, the old cycles 1 and 2, dwell, and coordinate transformations.
//!
//! # Source
//! Parameters and sequences of motions as the user's manuals of TNC 640 and iTNC 530 describe them, cited from memory
//! (assumption).

use super::{Klartext, Statement};
use crate::error::Fault;
use crate::hole::{Clearance, Exit, Hole, Pecks, stops};
use crate::kernel::{FeedMode, Kernel, Round, Target};
use crate::motion::AXES;

/// A cycle that a call runs.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cycle {
    /// 200 and on: its number; its parameters stand among the Q parameters.
    New(u32),
    /// 1 or 2: its number, with its values in mm and s by line.
    Old(u32, Vec<f64>),
}

/// Distance above the last depth at which feed begins again in cycle 200, mm (TNC 640, cycle 200, cited from memory: assumption).
const AGAIN: f64 = 0.2;
/// Number of the work offset that datum 0 is, behind those of all other datums.
const BEYOND_TABLES: u32 = 10_000;
/// A feed that stands for FMAX, mm/min.
const RAPID: f64 = 99_999.0;

impl Klartext {
    pub(super) fn define(&mut self, statement: &Statement, kernel: &mut Kernel) -> Result<(), Fault> {
        let words = &statement.words;
        let (name, column) = words.get(2).map_or(("", 1), |(word, column)| (word.as_str(), *column));
        let (number, line) = name.split_once('.').unwrap_or((name, ""));
        let number: u32 = number.parse().map_err(|_| Fault::at(column, "the number of the cycle is missing"))?;
        if number >= 200 {
            return self.define_new(number, statement, column, kernel);
        }
        let line: u32 = line.parse().map_err(|_| Fault::at(column, "an old cycle is written 7.0, 7.1 and on"))?;
        let rest = &words[3..];
        match (number, line) {
            (1 | 2 | 7..=11, 0) => {
                self.old.clear();
                if number == 8 {
                    self.transform.mirror = [false; 3];
                }
            }
            (1 | 2, line @ 1..=6) => {
                let value = self.old_value(number, line, rest, kernel)?;
                self.old.insert(line, value);
                let value_of = |line: u32| self.old.get(&line).copied().unwrap_or(0.0);
                self.cycle = Some(Cycle::Old(number, (0..6).map(value_of).collect()));
            }
            (7, 1..=9) => {
                for (word, column) in rest {
                    let (step, word) = word.strip_prefix('I').map_or((false, word.as_str()), |rest| (true, rest));
                    let axis = word.chars().next().and_then(|letter| AXES.iter().position(|known| *known == letter));
                    let axis = axis.ok_or_else(|| {
                        Fault::at(*column, "a datum shift names axes; tables of datums are not followed").refusing()
                    })?;
                    let value = self.value(&word[1..], *column)?;
                    let value = if (3..6).contains(&axis) { value } else { kernel.length(value)? };
                    if step { self.transform.shift[axis] += value } else { self.transform.shift[axis] = value }
                }
            }
            (8, 1..=9) => {
                for (word, column) in rest {
                    let axis = AXES.iter().take(3).position(|letter| word.len() == 1 && word.starts_with(*letter));
                    self.transform.mirror[axis.ok_or_else(|| Fault::at(*column, "mirroring names X, Y or Z"))?] = true;
                }
            }
            (9, 1) => {
                let text = rest.last().map_or("", |(word, _)| word.as_str());
                let text = text.trim_start_matches("DWELL");
                kernel.dwell(self.value(text, column)?)?;
            }
            (10, 1) => {
                let text = rest.first().map_or("", |(word, _)| word.as_str());
                let (step, text) = text.strip_prefix('I').map_or((false, text), |rest| (true, rest));
                let text = text.strip_prefix("ROT").unwrap_or_default();
                let text = if text.is_empty() { rest.get(1).map_or("", |(word, _)| word.as_str()) } else { text };
                let angle = self.value(text, column)?;
                self.transform.angle = if step { self.transform.angle + angle } else { angle };
            }
            (11, 1) => {
                let text = rest.first().map_or("", |(word, _)| word.as_str()).strip_prefix("SCL").unwrap_or_default();
                let text = if text.is_empty() { rest.get(1).map_or("", |(word, _)| word.as_str()) } else { text };
                let factor = self.value(text, column)?;
                if !(1e-6..=1e6).contains(&factor) {
                    return Err(Fault::at(column, "the factor of cycle 11 must be above 0"));
                }
                self.transform.factor = factor;
            }
            // Tolerance of the path: no motion, and no other time at programmed feeds.
            (32, _) => {}
            _ => {
                return Err(Fault::at(column, format!("cycle {name} is not followed; post its motions")).refusing());
            }
        }
        if matches!(number, 7 | 8 | 10 | 11) {
            kernel.frame = self.frame(kernel);
        }
        Ok(())
    }

    /// A value of cycles 1 and 2: set-up clearance, depth, peck, dwell, feed.
    fn old_value(&self, number: u32, line: u32, rest: &[(String, usize)], kernel: &Kernel) -> Result<f64, Fault> {
        let text: Vec<&str> = rest.iter().map(|(word, _)| word.as_str()).collect();
        let column = rest.first().map_or(1, |(_, column)| *column);
        let last = text.last().copied().unwrap_or_default();
        let value = self.value(last.strip_prefix('F').unwrap_or(last), column)?;
        let dwell = (number == 1 && line == 4) || (number == 2 && line == 3);
        if dwell { Ok(value) } else { kernel.length(value) }
    }

    /// Cycle 247: a datum of the table, Q339. It shifts the program as a whole; where another one was in force, the place of
    /// the axes in it is not known.
    fn datum(&mut self, statement: &Statement, column: usize, kernel: &mut Kernel) -> Result<(), Fault> {
        let text = statement.words.iter().find_map(|(word, _)| word.strip_prefix("Q339="));
        let text = text.ok_or_else(|| Fault::at(column, "cycle 247 needs Q339, the number of the datum"))?;
        let number = self.value(text, column)?;
        if !(0.0..=9999.0).contains(&number) || number.fract() != 0.0 {
            return Err(Fault::at(column, format!("{number} is no number of a datum")));
        }
        let number = number as u32;
        if self.datum.is_some_and(|before| before != number) {
            kernel.forget(0..9);
        }
        // Datum 1 is the first offset; each number has its own, and 99 is none.
        let work = match number {
            0 => BEYOND_TABLES,
            1..=99 => number - 1,
            _ => number,
        };
        if self.datum == Some(number) {
            kernel.work_offset_again();
        } else {
            kernel.work_offset(work, [work == 0; 3]);
        }
        self.datum = Some(number);
        Ok(())
    }

    fn define_new(
        &mut self,
        number: u32,
        statement: &Statement,
        column: usize,
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        if number == 247 {
            return self.datum(statement, column, kernel);
        }
        if !matches!(number, 200..=203 | 205..=209 | 220 | 221 | 240) {
            return Err(Fault::at(column, format!("cycle {number} is not followed; post its motions")).refusing());
        }
        let mut words = statement.words[3..].iter();
        while let Some((word, column)) = words.next() {
            let Some((target, value)) = word.split_once('=') else { continue };
            // The value may stand apart.
            let value = if value.is_empty() { words.next().map_or("", |(word, _)| word.as_str()) } else { value };
            let value = match value {
                "MAX" | "FMAX" => RAPID,
                "AUTO" | "FAUTO" => {
                    let feed = self.tool_feed.ok_or_else(|| Fault::at(*column, "FAUTO needs F behind TOOL CALL"))?;
                    feed / kernel.unit()?
                }
                value => self.value(value, *column)?,
            };
            self.set(target, value).map_err(|fault| fault.or_at(*column))?;
        }
        if matches!(number, 220 | 221) {
            return self.holes(number, kernel).map_err(|fault| fault.or_at(column));
        }
        self.cycle = Some(Cycle::New(number));
        Ok(())
    }

    /// Runs the cycle that is defined where the tool stands.
    pub(super) fn bore(&mut self, kernel: &mut Kernel) -> Result<(), Fault> {
        let cycle = self.cycle.clone().ok_or_else(|| Fault::new("a cycle is called, but none is defined before"))?;
        kernel.feed_mode = FeedMode::Minute;
        match cycle {
            Cycle::New(number) => self.bore_new(number, kernel),
            Cycle::Old(number, values) => {
                let [_, setup, depth, third, fourth, fifth] = values[..] else {
                    return Err(Fault::new("the cycle is not complete"));
                };
                let start = kernel.program_at()[kernel.plane[2]];
                let (peck, dwell, feed) = if number == 1 { (third, fourth, fifth) } else { (0.0, third, fourth) };
                if feed <= 0.0 || depth == 0.0 {
                    return Err(Fault::new(format!("cycle {number} needs a depth and a feed")));
                }
                let reference = start;
                // The tool stands at the set-up clearance above the surface.
                let bottom = start - setup.abs() + depth;
                let whole = (reference - bottom).abs();
                let pecks = if number == 1 && peck.abs() > 0.0 && peck.abs() < depth.abs() {
                    let mut list = stops(depth.abs(), peck.abs(), 0.0, peck.abs())?;
                    list.iter_mut().for_each(|stop| *stop += whole - depth.abs());
                    Some(Pecks::new(list, None, Clearance::Depth))
                } else {
                    None
                };
                let exit = if number == 2 { Exit::Tap } else { Exit::Rapid };
                kernel.hole(&Hole { reference, bottom, level: start, pecks, dwell, exit, feed: Some(feed) })
            }
        }
    }

    pub(super) fn bore_new(&mut self, number: u32, kernel: &mut Kernel) -> Result<(), Fault> {
        let q = |index: u32| self.store.0.get(&index).copied();
        let length = |index: u32, fallback: f64| -> Result<f64, Fault> {
            q(index).map_or(Ok(fallback), |value| kernel.length(value))
        };
        let needed = |index: u32| -> Result<f64, Fault> {
            let value = q(index).ok_or_else(|| Fault::new(format!("cycle {number} needs Q{index}")))?;
            kernel.length(value)
        };
        // Q parameters stay from cycle to cycle, and cycles without a dwell at the bottom do not look at it.
        let seconds = |index: u32| if matches!(number, 207..=209) { 0.0 } else { q(index).unwrap_or(0.0).max(0.0) };
        let (setup, depth, surface) = (needed(200)?.abs(), needed(201)?, length(203, 0.0)?);
        if depth == 0.0 {
            return Ok(());
        }
        let reference = surface + setup;
        let level = surface + length(204, 0.0)?.max(setup);
        let bottom = surface + depth;
        let clearance = |default: f64| Clearance::Fixed(kernel.control.peck_clearance.unwrap_or(default));
        let feed = if matches!(number, 207 | 209) { 1.0 } else { needed(206)? };
        if feed <= 0.0 {
            return Err(Fault::new("the feed Q206 of the cycle must be above 0"));
        }
        let mut hole =
            Hole { reference, bottom, level, pecks: None, dwell: seconds(211), exit: Exit::Rapid, feed: Some(feed) };
        // Depths count from the surface, the hole from its set-up clearance.
        let from_surface = |peck: f64, decrement: f64, least: f64| -> Result<Option<Vec<f64>>, Fault> {
            if peck <= 0.0 || peck >= depth.abs() {
                return Ok(None);
            }
            let mut list = stops(depth.abs(), peck, decrement, if decrement > 0.0 { least.max(1e-3) } else { peck })?;
            list.iter_mut().for_each(|stop| *stop += setup);
            Ok(Some(list))
        };
        let unit = kernel.unit()?;
        let out_at = |index: u32| -> Result<Exit, Fault> {
            let given = q(index).unwrap_or(0.0);
            let speed = if given == 0.0 { feed } else { given * unit };
            Ok(if given >= RAPID { Exit::Rapid } else { Exit::FeedOf(speed) })
        };
        match number {
            200 => {
                let list = from_surface(length(202, 0.0)?.abs(), 0.0, 0.0)?;
                hole.pecks =
                    list.map(|stops| Pecks { outside: seconds(210), ..Pecks::new(stops, None, clearance(AGAIN)) });
            }
            201 => hole.exit = out_at(208)?,
            202 => {
                if q(214).unwrap_or(0.0) != 0.0 {
                    kernel
                        .note("cycle 202 draws the tool off the wall by 0.2 mm before it leaves, which is not counted");
                }
                hole.exit = out_at(208)?;
            }
            203 => {
                let list = from_surface(length(202, 0.0)?.abs(), length(212, 0.0)?.abs(), length(205, 0.0)?.abs())?;
                if let Some(stops) = list {
                    // Behind so many breaks of the chip the tool is drawn out; without any, behind each depth.
                    let breaks = q(213).unwrap_or(0.0);
                    if !(0.0..=99_999.0).contains(&breaks) {
                        return Err(Fault::new(format!("Q213 = {breaks} is no number of breaks")));
                    }
                    let retract = if breaks >= 1.0 { Some(length(256, AGAIN)?.abs()) } else { None };
                    hole.pecks = Some(Pecks {
                        breaks: breaks as usize,
                        outside: seconds(210),
                        slow_out: q(208).is_some_and(|feed| feed < RAPID),
                        ..Pecks::new(stops, retract, clearance(AGAIN))
                    });
                }
                hole.exit = if q(208).is_some() { out_at(208)? } else { Exit::Rapid };
            }
            205 => {
                if q(257).unwrap_or(0.0) != 0.0 && q(257) < q(202) || q(379).unwrap_or(0.0) != 0.0 {
                    return Err(Fault::new(
                        "cycle 205 with chip breaking (Q257) or a deeper start (Q379) is not followed",
                    )
                    .refusing());
                }
                let (upper, lower) = (length(258, 0.2)?, length(259, length(258, 0.2)?)?);
                if (upper - lower).abs() > 1e-9 {
                    return Err(
                        Fault::new("cycle 205 with different advanced stops (Q258, Q259) is not followed").refusing()
                    );
                }
                let list = from_surface(length(202, 0.0)?.abs(), length(212, 0.0)?.abs(), length(205, 0.0)?.abs())?;
                hole.pecks = list.map(|stops| Pecks::new(stops, None, Clearance::Fixed(upper)));
            }
            206 => hole.exit = Exit::Tap,
            207 => {
                let pitch = needed(239)?.abs();
                if kernel.speed <= 0.0 || pitch == 0.0 {
                    return Err(Fault::new("cycle 207 needs a pitch Q239 and a speed of the spindle"));
                }
                hole.feed = Some(pitch * kernel.speed);
                hole.exit = Exit::Tap;
            }
            209 => {
                let pitch = needed(239)?.abs();
                if kernel.speed <= 0.0 || pitch == 0.0 {
                    return Err(Fault::new("cycle 209 needs a pitch Q239 and a speed of the spindle"));
                }
                let feed = pitch * kernel.speed;
                hole.feed = Some(feed);
                // Q256 counts pitches; 0 draws the tool out. Q403 is the speed on the way out over that of cutting.
                let (step, breaks) = (length(257, 0.0)?.abs(), q(256).unwrap_or(0.0).abs());
                let list = from_surface(step, 0.0, 0.0)?;
                let retract = (breaks > 0.0).then_some(breaks * pitch);
                hole.pecks = list.map(|stops| Pecks::new(stops, retract, Clearance::Fixed(0.0)));
                let faster = q(403).filter(|factor| *factor > 0.0).unwrap_or(1.0);
                hole.exit = if faster == 1.0 { Exit::Tap } else { Exit::TapAt(faster * feed) };
            }
            240 => {
                if q(343).unwrap_or(0.0) != 0.0 {
                    return Err(Fault::new(
                        "cycle 240 to a diameter (Q343 = 1) takes the point angle of the tool's table; write the depth",
                    ));
                }
            }
            _ => return self.bore_milling(hole, kernel),
        }
        kernel.hole(&hole)
    }

    /// Cycle 208: a helix down, a full circle at the bottom, back to the middle.
    fn bore_milling(&mut self, hole: Hole, kernel: &mut Kernel) -> Result<(), Fault> {
        let q = |index: u32| self.store.0.get(&index).copied();
        let given = |index: u32| q(index).ok_or_else(|| Fault::new(format!("cycle 208 needs Q{index}")));
        let (step, diameter) = (kernel.length(given(334)?)?.abs(), kernel.length(given(335)?)?);
        let tool = self.cutter_radius(kernel).map(|radius| 2.0 * radius);
        let tool = tool.ok_or_else(|| {
            Fault::new("cycle 208 needs the diameter of the tool: give --tool D1=\"10 mm\" with its number")
        })?;
        let radius = 0.5 * (diameter - tool);
        if radius <= 0.0 || step <= 0.0 {
            return Err(Fault::new("cycle 208: the hole must be larger than the tool, and the step Q334 above 0"));
        }
        let [u, v, w] = kernel.plane;
        let feed = (kernel.feed, kernel.feed_scale);
        kernel.set_feed(hole.feed.unwrap_or(0.0), 1.0)?;
        let position = kernel.program_at();
        let centre = [position[u], position[v]];
        kernel.straight(&Target::one(w, hole.reference), true)?;
        // Half a circle leads to the wall and away from it.
        let mut wall = Target::default();
        (wall.absolute[u], wall.absolute[v]) = (Some(centre[0] + radius), Some(centre[1]));
        let half = Round::Centre([centre[0] + 0.5 * radius, centre[1]]);
        kernel.round(&wall, half, true, 0.0)?;
        let depth = hole.reference - hole.bottom;
        let turns = (depth / step).ceil().max(1.0);
        let mut helix = wall;
        helix.absolute[w] = Some(hole.bottom);
        kernel.round(&helix, Round::Centre(centre), true, turns - 1.0)?;
        kernel.round(&wall, Round::Centre(centre), true, 0.0)?;
        let mut middle = Target::default();
        (middle.absolute[u], middle.absolute[v]) = (Some(centre[0]), Some(centre[1]));
        kernel.round(&middle, half, true, 0.0)?;
        kernel.straight(&Target::one(w, hole.level), true)?;
        (kernel.feed, kernel.feed_scale) = feed;
        kernel.push(crate::motion::EventKind::Hole);
        Ok(())
    }
}
