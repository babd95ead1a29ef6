//! The nominal cycle time of a part program, by tool and by block.

mod course;
mod report;
mod study;

pub use report::report;
pub use study::{ProgramOnMachine, ProgramRequest, ProgramStudy};

use crate::change::{ChangeError, assign, parts};
use crate::tables::table;
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_drives::{Drives, Part, Spent, Timer};
use toolroom_post::Drawing;
use toolroom_process::Record;
use toolroom_process::table::Cell;
use toolroom_program::{AXES, Block, Blocks, Control, ProgramError, Source};

/// Why a change of drives or control was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DriveError {
    /// A value of the control.
    #[error("{0}")]
    Control(String),
    /// A value of the drives.
    #[error(transparent)]
    Drives(#[from] ChangeError),
}

impl DriveError {
    /// The likely way out.
    pub fn fix(&self) -> String {
        match self {
            Self::Control(_) => format!("of the control there are {}", Control::KEYS),
            Self::Drives(error @ ChangeError::NoField { .. }) => format!("{}, control.…", error.fix()),
            Self::Drives(error) => error.fix(),
        }
    }
}

/// Changes drives, or the control where the name begins with `control.`, by `name=value`.
///
/// # Errors
/// [`DriveError`]: a name that neither has, or a value that it refuses.
///
/// ```
/// use toolroom_planning::program::set_drive;
/// use toolroom_drives::Drives;
/// use toolroom_program::Control;
/// let (mut drives, mut control) = (Drives::default(), Control::default());
/// set_drive(&mut drives, &mut control, "tool_change_time=6 s").unwrap();
/// set_drive(&mut drives, &mut control, "control.m.29=0.3 s").unwrap();
/// assert_eq!((drives.tool_change_time, control.m[&29]), (6.0, 0.3));
/// let error = set_drive(&mut drives, &mut control, "jerk=1 s").unwrap_err();
/// assert!(error.fix().contains("jerk_time"));
/// ```
pub fn set_drive(drives: &mut Drives, control: &mut Control, change: &str) -> Result<(), DriveError> {
    let (name, value) = parts(change)?;
    match name.strip_prefix("control.") {
        Some(key) => control.set(key, value).map_err(DriveError::Control),
        None => Ok(assign(drives, name, value)?),
    }
}

/// Names of the values that [`set_drive`] changes, in words.
pub fn drive_names() -> String {
    let drives: Vec<&str> = Drives::<f64>::FIELDS.iter().map(|field| field.name).collect();
    format!("drives and changer ({}) or control (control. before {})", drives.join(", "), Control::KEYS)
}

/// The time of a part program. It keeps no motions, and blocks only where a table of them is requested.
#[derive(Clone, Debug)]
pub struct CycleTime {
    shares: Vec<Share>,
    rows: Option<Vec<Row>>,
    unknown: Vec<usize>,
    notes: Vec<(usize, String)>,
    dialect: (&'static str, String),
    inch: bool,
    end: [Option<f64>; 9],
}

/// Time of the blocks that one tool runs, s.
#[derive(Clone, Debug, Default)]
struct Share {
    tool: Option<u32>,
    blocks: usize,
    motions: usize,
    feed: f64,
    rapid: f64,
    dwell: f64,
    auxiliary: f64,
    change_time: f64,
    spindle: f64,
    length: f64,
    changes: u32,
    holes: u32,
    /// Where the time goes, in the order of [`Part::ALL`].
    spent: [f64; 7],
    total: f64,
}

/// A block in the table.
#[derive(Clone, Debug)]
struct Row {
    line: usize,
    tool: Option<u32>,
    feed: f64,
    rapid: f64,
    dwell: f64,
    change: bool,
    holes: u32,
    total: f64,
}

/// Greatest number of lines of motions from unknown places that are kept, so that memory stays bounded (assumption).
const UNKNOWN: usize = 1000;

impl CycleTime {
    /// Follows a program and times it on a machine with `drives`; `blocks` keeps the time of every block. A text that stays in its
    /// file ([`Source::open`]) is followed in memory that does not grow with its lines.
    ///
    /// # Errors
    /// [`ProgramError`]: the first word that is not understood, or a program that moves nothing.
    pub fn new(
        text: impl Into<Source>,
        control: &Control,
        drives: &Drives,
        blocks: bool,
    ) -> Result<Self, ProgramError> {
        let mut list = Blocks::new(text, control)?;
        let mut shares: Vec<Share> = Vec::new();
        let mut rows: Option<Vec<Row>> = blocks.then(Vec::new);
        let (mut timer, mut done, mut unknown) = (Timer::new(drives), Vec::new(), Vec::new());
        // Share of each block whose time is not settled yet.
        let settle = |done: &mut Vec<Spent>, shares: &mut Vec<Share>, rows: &mut Option<Vec<Row>>, of: &[usize]| {
            for spent in done.drain(..) {
                match rows {
                    Some(rows) => {
                        rows[spent.key].total += spent.seconds;
                        shares[of[spent.key]].spend(&spent);
                    }
                    None => shares[spent.key].spend(&spent),
                }
            }
        };
        let mut tool_of: Vec<usize> = Vec::new();
        for block in list.by_ref() {
            let block = block?;
            // Blocks before the first tool go with it.
            if shares.last().is_none_or(|share| share.tool.is_some() && share.tool != block.tool) {
                shares.push(Share::default());
            }
            let index = shares.len() - 1;
            shares[index].tool = shares[index].tool.or(block.tool);
            shares[index].take(&block, drives);
            if unknown.len() < UNKNOWN {
                unknown.extend(block.unknown.filter(|line| !unknown.contains(line)));
            }
            let key = match &mut rows {
                Some(rows) => {
                    rows.push(Row::of(&block, drives));
                    tool_of.push(index);
                    rows.len() - 1
                }
                None => index,
            };
            timer.block(key, &block, &mut done);
            settle(&mut done, &mut shares, &mut rows, &tool_of);
        }
        timer.finish(rows.as_ref().map_or(shares.len(), Vec::len).saturating_sub(1), &mut done);
        settle(&mut done, &mut shares, &mut rows, &tool_of);
        let run = list.run();
        let (dialect, reason) = run.dialect();
        if shares.iter().all(|share| share.motions == 0 && share.dwell == 0.0) {
            return Err(ProgramError::still(dialect));
        }
        Ok(Self {
            shares,
            rows,
            unknown,
            notes: run.notes().to_vec(),
            dialect: (dialect.name(), reason.to_owned()),
            inch: run.unit().is_some_and(|unit| unit > 1.0),
            end: run.position(),
        })
    }

    /// Lines of blocks that move axes from places that only the machine knows; the first thousand.
    pub fn unknown(&self) -> &[usize] {
        &self.unknown
    }

    /// What the reader noticed, with its line, from 1.
    pub fn notes(&self) -> &[(usize, String)] {
        &self.notes
    }

    /// The language of the program and why it was taken.
    pub fn dialect(&self) -> (&str, &str) {
        (self.dialect.0, &self.dialect.1)
    }

    fn sum(&self, of: impl Fn(&Share) -> f64) -> f64 {
        // A sum over nothing is -0.
        self.shares.iter().map(of).fold(0.0, |sum, value| sum + value)
    }

    /// Time that goes into a part with all that the machine adds to it, s.
    fn spent(&self, part: Part) -> f64 {
        self.sum(|share| share.spent[part as usize])
    }

    /// Times for programs: of the whole and by tool. Every key names its unit; `rotary_end` is in degrees. The parts add up to
    /// the cycle time, and so do those of `spent`, which hold what the machine adds to the programmed times.
    pub fn json(&self) -> Value {
        let rows: Vec<Value> = self.shares.iter().map(Share::json).collect();
        let notes: Vec<Value> = self.notes.iter().map(|(line, text)| json!({ "line": line, "text": text })).collect();
        let rotary: Vec<f64> = self.end[3..6].iter().flatten().copied().collect();
        let axes: String =
            AXES.iter().zip(self.end).filter(|(_, place)| place.is_some()).map(|(letter, _)| *letter).collect();
        let parts = self.sum(Share::parts);
        let spent: Map<String, Value> =
            Part::ALL.iter().map(|part| (format!("{} [s]", part.word()), json!(self.spent(*part)))).collect();
        json!({
            "schema": 1,
            "dialect": self.dialect.0,
            "dialect_reason": self.dialect.1,
            "units": if self.inch { "inch" } else { "mm" },
            "cycle_time [s]": self.sum(|share| share.total),
            "feed_time [s]": self.sum(|share| share.feed),
            "rapid_time [s]": self.sum(|share| share.rapid),
            "dwell [s]": self.sum(|share| share.dwell),
            "change_time [s]": self.sum(|share| share.change_time),
            "spindle_wait [s]": self.sum(|share| share.spindle),
            "auxiliary_time [s]": self.sum(|share| share.auxiliary),
            "acceleration_time [s]": self.sum(|share| share.total) - parts,
            "spent": spent,
            "feed_length [mm]": self.sum(|share| share.length),
            "end [mm]": self.end[..3],
            "rotary_end": rotary,
            "axes": axes,
            "holes": self.shares.iter().map(|share| u64::from(share.holes)).sum::<u64>(),
            "tool_changes": self.shares.iter().map(|share| u64::from(share.changes)).sum::<u64>(),
            "motions": self.shares.iter().map(|share| share.motions).sum::<usize>(),
            "executed_blocks": self.shares.iter().map(|share| share.blocks).sum::<usize>(),
            "blocks": self.shares.iter().map(|share| share.blocks).sum::<usize>(),
            "blocks_from_unknown_places": self.unknown,
            "notes": notes,
            "tools": rows,
        })
    }

    /// Times by tool for a terminal, s.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{:>6} {:>8} {:>10} {:>10} {:>9} {:>10} {:>11} {:>6} {:>11}",
            "tool", "blocks", "feed [s]", "rapid [s]", "dwell [s]", "change [s]", "spindle [s]", "holes", "total [s]"
        );
        for share in &self.shares {
            let tool = share.tool.map_or("–".to_owned(), |tool| format!("T{tool}"));
            let _ = write!(
                text,
                "\n{tool:>6} {:>8} {:>10.1} {:>10.1} {:>9.1} {:>10.1} {:>11.1} {:>6} {:>11.1}",
                share.blocks,
                share.feed,
                share.rapid,
                share.dwell,
                share.change_time,
                share.spindle,
                share.holes,
                share.total
            );
        }
        let blocks: usize = self.shares.iter().map(|share| share.blocks).sum();
        let total = self.sum(|share| share.total);
        let _ = write!(text, "\n{:>6} {:>8} {:>72.1}", "all", blocks, total);
        let goes: Vec<String> = (Part::ALL.iter())
            .map(|part| (part.word(), self.spent(*part)))
            .filter(|(_, seconds)| *seconds > 0.0)
            .map(|(word, seconds)| format!("{word} {seconds:.1} s ({:.1} %)", 100.0 * seconds / total))
            .collect();
        let _ = write!(text, "\non this machine: {}", goes.join(", "));
        text
    }

    /// Times by block as CSV, s; only the header where no table was requested.
    pub fn table(&self) -> String {
        let columns =
            ["line", "tool", "feed_time [s]", "rapid_time [s]", "dwell [s]", "tool_change", "holes", "time [s]"];
        let row = |row: &Row| -> [Cell<'_>; 8] {
            [
                row.line.into(),
                row.tool.into(),
                Cell::Fixed(row.feed, 6),
                Cell::Fixed(row.rapid, 6),
                Cell::Fixed(row.dwell, 3),
                u32::from(row.change).into(),
                row.holes.into(),
                Cell::Fixed(row.total, 6),
            ]
        };
        table(columns, self.rows.iter().flatten().map(row))
    }
}

/// A program with its time, or why it is refused.
pub type Timed = (String, Result<CycleTime, ProgramError>);

/// A row of each of several programs for a terminal, s, and their sum.
pub fn overview_text(programs: &[Timed]) -> String {
    let width = programs.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(7);
    let mut text = format!(
        "{:<width$} {:>12} {:>10} {:>10} {:>9} {:>7} {:>6} {:>11}",
        "program", "control", "feed [s]", "rapid [s]", "dwell [s]", "changes", "holes", "total [s]"
    );
    let mut total = 0.0;
    for (name, timed) in programs {
        match timed {
            Ok(cycle) => {
                let time = cycle.sum(|share| share.total);
                total += time;
                let _ = write!(
                    text,
                    "\n{name:<width$} {:>12} {:>10.1} {:>10.1} {:>9.1} {:>7} {:>6} {time:>11.1}",
                    cycle.dialect.0,
                    cycle.sum(|share| share.feed),
                    cycle.sum(|share| share.rapid),
                    cycle.sum(|share| share.dwell),
                    cycle.shares.iter().map(|share| share.changes).sum::<u32>(),
                    cycle.shares.iter().map(|share| share.holes).sum::<u32>(),
                );
            }
            Err(error) => {
                let count = error.all().count();
                let _ = write!(text, "\n{name:<width$} {:>12} refused in {count} places", error.dialect.name());
            }
        }
    }
    let _ = write!(text, "\n{:<width$} {total:>71.1}", "all");
    text
}

/// The same for programs: of each the [document](CycleTime::json) that it has by itself, or its refusals.
pub fn overview_json(programs: &[Timed]) -> Value {
    let rows = programs.iter().map(|(name, timed)| {
        let mut row = match timed {
            Ok(cycle) => cycle.json(),
            Err(error) => json!({ "refused": error.all().map(ToString::to_string).collect::<Vec<_>>() }),
        };
        row["file"] = json!(name);
        row
    });
    let times = programs.iter().flat_map(|(_, timed)| timed).map(|cycle| cycle.sum(|share| share.total));
    let total = times.fold(0.0, |sum, time| sum + time);
    json!({ "schema": 1, "programs": rows.collect::<Vec<_>>(), "cycle_time [s]": total })
}

/// The path of a program as a drawing: a layer for the rapid motions, and one for the motions at feed of every tool.
///
/// # Errors
/// [`ProgramError`]: the program is refused.
pub fn drawing(source: &Source, control: &Control) -> Result<Drawing, ProgramError> {
    let mut drawing = Drawing::default();
    for block in Blocks::new(source.clone(), control)? {
        let block = block?;
        let layer = block.tool.map_or_else(|| "FEED".to_owned(), |tool| format!("FEED-T{tool}"));
        for motion in &block.motions {
            drawing.motion(if motion.rapid { "RAPID" } else { &layer }, motion);
        }
    }
    Ok(drawing)
}

/// Time of a block's rapid motions, s.
fn rapid(block: &Block, drives: &Drives) -> f64 {
    block.motions.iter().map(|motion| drives.rapid_time(motion)).sum()
}

impl Row {
    fn of(block: &Block, drives: &Drives) -> Self {
        Self {
            line: block.line,
            tool: block.tool,
            feed: block.feed_time(),
            rapid: rapid(block, drives),
            dwell: block.dwell,
            change: block.tool_change,
            holes: block.holes,
            total: 0.0,
        }
    }
}

impl Share {
    fn take(&mut self, block: &Block, drives: &Drives) {
        self.blocks += 1;
        self.motions += block.motions.len();
        self.feed += block.feed_time();
        self.rapid += rapid(block, drives);
        self.length += block.motions.iter().map(|motion| motion.feed_length()).sum::<f64>();
        self.changes += u32::from(block.tool_change);
        self.holes += block.holes;
    }

    /// What the machine spends beside the programmed times of motions.
    fn spend(&mut self, spent: &Spent) {
        self.total += spent.seconds;
        self.spent[spent.part as usize] += spent.seconds;
        match spent.part {
            Part::Dwell => self.dwell += spent.seconds,
            Part::Auxiliary => self.auxiliary += spent.seconds,
            Part::Change => self.change_time += spent.seconds,
            Part::Spindle => self.spindle += spent.seconds,
            // What they take beside their programmed times is reported together.
            Part::Feed | Part::Rapid | Part::Settling => {}
        }
    }

    /// Programmed times, changes and waits, without what override, accelerations and settling add, s.
    fn parts(&self) -> f64 {
        self.feed + self.rapid + self.dwell + self.auxiliary + self.change_time + self.spindle
    }

    fn json(&self) -> Value {
        json!({
            "tool": self.tool, "blocks": self.blocks, "feed_time [s]": self.feed, "rapid_time [s]": self.rapid,
            "dwell [s]": self.dwell, "change_time [s]": self.change_time, "spindle_wait [s]": self.spindle,
            "tool_changes": self.changes, "holes": self.holes, "cycle_time [s]": self.total,
        })
    }
}
